//! `GSC_instances`, on the node that holds all trees: their exact affine transforms, templates and trunks. The
//! nodes below it say the same in core glTF, but an affine transform takes two of them.

use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::svd;

/// The extension's name.
pub const GSC_INSTANCES: &str = "GSC_instances";
/// The node of the trees beyond the field.
pub const FAR_TREES_NODE: &str = "far trees";
/// Bytes before the first record.
const INSTANCES_HEADER_BYTES: usize = 16;
/// Bytes of a record.
const INSTANCE_BYTES: usize = size_of::<Instance>();

const MAGIC: &[u8; 4] = b"GSCI";
const VERSION: u32 = 1;

/// The extension's object on a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InstancesExtension {
    /// The bufferView with the header and the records.
    pub buffer_view: usize,
    /// How many records there are.
    pub count: usize,
    /// What a record's template index means.
    pub templates: Vec<InstancesTemplate>,
}

/// A kind of tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InstancesTemplate {
    /// Its name.
    pub name: String,
    /// The mesh of its finest level, which carries `GSC_progressive_mesh`.
    pub mesh: usize,
}

/// A tree that stands in the scene. Its bytes are a record of the binary data.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// The transform from the template's space to the node's: 3 rows of 4, row-major, metres, determinant above 0.
    pub world_from_tree: [[f32; 4]; 3],
    /// Index into `templates`.
    pub template: u32,
    /// The infinite vertical cylinder around the trunk, for collision: x, z and radius in metres.
    pub trunk_cylinder_m: [f32; 3],
}

impl Instance {
    /// The linear part of the transform, by columns.
    pub fn linear(&self) -> svd::Columns {
        let rows = &self.world_from_tree;
        [0, 1, 2].map(|column| [0, 1, 2].map(|row| f64::from(rows[row][column])))
    }

    /// The greatest factor by which the transform makes anything longer: its greatest singular value.
    pub fn max_scale(&self) -> f32 {
        let linear = self.linear();
        let factors = svd::decompose(linear).map(|factors| factors.scale.into_iter().fold(0.0, f64::max));
        // The Frobenius norm is no less, should a damaged file hold a flattened tree.
        let norm = || linear.as_flattened().iter().map(|x| x * x).sum::<f64>().sqrt();
        factors.unwrap_or_else(norm) as f32
    }
}

/// Why instances could not be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum InstancesError {
    /// Not this format, or a later version of it.
    #[error("not GSC_instances version {VERSION} data: it opens with {0:02x?}")]
    Header(Vec<u8>),
    /// Fewer or more bytes than the header promises.
    #[error("GSC_instances data of {count} records should be {expected} bytes long but is {found}")]
    Length {
        /// Records promised.
        count: u32,
        /// Bytes that they take with the header.
        expected: usize,
        /// Bytes there are.
        found: usize,
    },
}

/// Header and records, little-endian, as `schema/docs/GSC_instances.md` says.
pub fn write_instances(records: &[Instance]) -> Vec<u8> {
    let mut out = Vec::with_capacity(INSTANCES_HEADER_BYTES + records.len() * INSTANCE_BYTES);
    out.extend_from_slice(MAGIC);
    for word in [VERSION, records.len() as u32, INSTANCE_BYTES as u32] {
        out.extend_from_slice(&word.to_le_bytes());
    }
    out.extend_from_slice(bytemuck::cast_slice(records));
    out
}

/// How many records a file of that many bytes holds.
pub fn instance_count(bytes: usize) -> usize {
    bytes.saturating_sub(INSTANCES_HEADER_BYTES) / INSTANCE_BYTES
}

/// The inverse of [`write_instances`].
pub fn read_instances(bytes: &[u8]) -> Result<Vec<Instance>, InstancesError> {
    let header = || InstancesError::Header(bytes.iter().copied().take(8).collect());
    let word = |at: usize| -> Option<[u8; 4]> { bytes.get(at..at + 4)?.try_into().ok() };
    let number = |at: usize| word(at).map(u32::from_le_bytes).ok_or_else(header);
    if word(0) != Some(*MAGIC) || number(4)? != VERSION || number(12)? != INSTANCE_BYTES as u32 {
        return Err(header());
    }
    let count = number(8)?;
    let expected = (count as usize).saturating_mul(INSTANCE_BYTES).saturating_add(INSTANCES_HEADER_BYTES);
    if bytes.len() != expected {
        return Err(InstancesError::Length { count, expected, found: bytes.len() });
    }
    Ok(bytemuck::pod_collect_to_vec(&bytes[INSTANCES_HEADER_BYTES..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records() -> Vec<Instance> {
        (0..7u32)
            .map(|i| Instance {
                world_from_tree: [0, 1, 2].map(|r| [0, 1, 2, 3].map(|c| (i * 12 + r * 4 + c) as f32 - 0.25)),
                template: i % 3,
                trunk_cylinder_m: [i as f32, -1.5, 0.3],
            })
            .collect()
    }

    #[test]
    fn records_survive_a_round_trip() {
        assert_eq!(read_instances(&write_instances(&records())).unwrap(), records());
        assert_eq!(read_instances(&write_instances(&[])).unwrap(), []);
        assert_eq!(instance_count(write_instances(&records()).len()), records().len());
    }

    #[test]
    fn anything_else_is_an_error() {
        let good = write_instances(&records());
        for n in 0..good.len() {
            assert!(read_instances(&good[..n]).is_err(), "{n} bytes were taken for whole");
        }
        let mut later = good.clone();
        later[4] = 2;
        assert!(matches!(read_instances(&later), Err(InstancesError::Header(_))));
        let mut endless = good;
        endless[8..12].fill(0xFF);
        assert!(matches!(read_instances(&endless), Err(InstancesError::Length { .. })));
    }
}
