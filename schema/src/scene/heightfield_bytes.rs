//! [`TerrainLod`] ↔ the binary data of `GSC_heightfield` (`schema/docs/`).
//!
//! Little-endian, no padding; n = side, k = log2(n−1):
//!
//! | byte | type | what |
//! |---|---|---|
//! | 0 | 4 × u8 | magic `GSCH` |
//! | 4 | u32 | version, 2 |
//! | 8 | u32 | side: samples a side, 2^k+1, k ≥ 1 |
//! | 12 | f32 | spacing between samples in metres |
//! | 16 | 2 × f32 | lowest and highest sample in metres |
//! | 24 | u32 | k: levels of blocks in the block ranges |
//! | 28 | u32 | 0, reserved |
//! | 32 | 3 × (u32, u32) | byte offset from the payload's start and byte length of the three arrays that follow |
//! | 56 | n² × f32 | heights in metres |
//! | | n² × f32 | wedgie half thicknesses in metres |
//! | | Σ 4^l × 2 × f32, l = 0 … k−1 | lowest and highest height of each block in metres |

use std::sync::Arc;

use thiserror::Error;

use super::{Heightfield, TerrainLod};

const MAGIC: &[u8; 4] = b"GSCH";
const VERSION: u32 = 2;
const HEADER_BYTES: usize = 56;
/// A field of 2^15+1 samples a side would need more bytes than the offsets can count.
const MAX_K: u32 = 14;

/// Why bytes are no payload of `GSC_heightfield`.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum HeightfieldError {
    #[error("not a GSC_heightfield payload: it does not begin with \"GSCH\"")]
    Magic,
    #[error("GSC_heightfield version {0} is unknown; this program reads version {VERSION}")]
    Version(u32),
    /// The number of samples or the spacing makes no sense.
    #[error("GSC_heightfield of {side} samples a side is damaged: sides are 2^k+1 samples, 3 to 16385")]
    Side { side: u32 },
    /// The distance between samples makes no sense.
    #[error("GSC_heightfield is damaged: samples {spacing_m} m apart")]
    Spacing { spacing_m: f32 },
    /// An array lies outside the payload or has the wrong length.
    #[error(
        "GSC_heightfield is cut short or damaged: {array} should have {expected} bytes within the payload"
    )]
    Array {
        array: &'static str,
        /// How many bytes it should have.
        expected: usize,
    },
}

impl TerrainLod {
    /// The binary data of `GSC_heightfield`.
    pub fn to_bytes(&self) -> Vec<u8> {
        let field = &self.field;
        let arrays: [&[f32]; 3] = [&field.heights_m, &self.wedgies_m, self.block_ranges_m.as_flattened()];
        let floats = arrays.iter().map(|array| array.len()).sum::<usize>();
        let mut bytes = Vec::with_capacity(HEADER_BYTES + 4 * floats);
        bytes.extend(MAGIC);
        let [lowest, highest] = field.range_m().map(f32::to_bits);
        let header = [VERSION, field.side, field.spacing_m.to_bits(), lowest, highest, field.depth(), 0];
        header.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
        let mut offset = HEADER_BYTES;
        for array in &arrays {
            bytes.extend((offset as u32).to_le_bytes());
            bytes.extend((4 * array.len() as u32).to_le_bytes());
            offset += 4 * array.len();
        }
        arrays.into_iter().flatten().for_each(|value| bytes.extend(value.to_le_bytes()));
        bytes
    }

    /// What [`TerrainLod::to_bytes`] wrote, exactly.
    ///
    /// # Errors
    /// When the bytes are no data of this version, or are damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, HeightfieldError> {
        if !bytes.starts_with(MAGIC) {
            return Err(HeightfieldError::Magic);
        }
        let header = bytes.get(..HEADER_BYTES);
        let header = header.ok_or(HeightfieldError::Array { array: "the header", expected: HEADER_BYTES })?;
        let word =
            |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        if word(4) != VERSION {
            return Err(HeightfieldError::Version(word(4)));
        }
        let side = word(8);
        let cells = side.wrapping_sub(1);
        if !cells.is_power_of_two() || !(1..=MAX_K).contains(&cells.trailing_zeros()) {
            return Err(HeightfieldError::Side { side });
        }
        let spacing_m = f32::from_bits(word(12));
        if !spacing_m.is_finite() || spacing_m <= 0.0 {
            return Err(HeightfieldError::Spacing { spacing_m });
        }
        let array = |index: usize, array: &'static str, floats: usize| {
            let (offset, length) = (word(32 + 8 * index) as usize, word(36 + 8 * index) as usize);
            let found = offset.checked_add(length).and_then(|end| bytes.get(offset..end));
            let (words, rest) = found.unwrap_or_default().as_chunks();
            let fits = words.len() == floats && rest.is_empty();
            let values = || words.iter().map(|word| f32::from_le_bytes(*word)).collect::<Vec<_>>();
            fits.then(values).ok_or(HeightfieldError::Array { array, expected: 4 * floats })
        };
        let samples = side as usize * side as usize;
        let blocks = (cells as usize * cells as usize - 1) / 3;
        let ranges = array(2, "the block ranges", 2 * blocks)?;
        Ok(Self {
            field: Arc::new(Heightfield { side, spacing_m, heights_m: array(0, "the heights", samples)? }),
            wedgies_m: array(1, "the wedgies", samples)?,
            block_ranges_m: ranges.as_chunks().0.to_vec(),
        })
    }
}
