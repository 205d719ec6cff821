//! Long lists of numbers ↔ one run of little-endian bytes, so that reading and writing a landform is a copy and not a
//! call for each of its samples: `#[serde(with = "floats")]`.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserializer, Serializer};

pub fn serialize<S: Serializer>(values: &[f32], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bytes(bytemuck::cast_slice(values))
}

pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
    deserializer.deserialize_bytes(Floats)
}

struct Floats;

impl Visitor<'_> for Floats {
    type Value = Vec<f32>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the bytes of 32-bit numbers")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<f32>, E> {
        match bytes.len() % 4 {
            0 => Ok(bytemuck::pod_collect_to_vec(bytes)),
            _ => Err(E::invalid_length(bytes.len(), &self)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Heightfield;

    #[test]
    fn numbers_come_back_bit_by_bit_and_cut_bytes_are_refused() {
        let heights_m = vec![0.0, -0.0, 1.5e-42, f32::MAX, -1234.567];
        let field = Heightfield { side: 1, spacing_m: 2.0, heights_m };
        let bytes = postcard::to_allocvec(&field).unwrap();
        let read: Heightfield = postcard::from_bytes(&bytes).unwrap();
        let bits = |field: &Heightfield| field.heights_m.iter().map(|h| h.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read), bits(&field));
        assert!(postcard::from_bytes::<Heightfield>(&bytes[..bytes.len() - 1]).is_err());
    }
}
