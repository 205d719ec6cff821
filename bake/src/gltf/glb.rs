//! The GLB container (glTF 2.0, section 4): a header, a JSON chunk and a BIN chunk.

use std::borrow::Cow;

use ::gltf::binary::{Error, Glb, Header};
use serde_json::Value;

use super::ExportError;

/// Header and chunks around a document's JSON and the contents of its buffer 0.
pub fn write_glb(json: Vec<u8>, bin: Vec<u8>) -> Vec<u8> {
    let header = Header { magic: *b"glTF", version: 2, length: 0 };
    let bin = (!bin.is_empty()).then_some(Cow::Owned(bin));
    Glb { header, json: Cow::Owned(json), bin }.to_vec().expect("memory can be written to")
}

/// The chunks of a .glb. Checks what `Glb::from_slice` subtracts from without a check: the stated length.
pub fn split_glb(bytes: &[u8]) -> Result<Glb<'_>, ::gltf::Error> {
    const HEADER_BYTES: u32 = 12;
    match bytes.get(8..).and_then(<[u8]>::first_chunk).map(|word| u32::from_le_bytes(*word)) {
        Some(length) if length < HEADER_BYTES => {
            Err(::gltf::Error::Binary(Error::Length { length, length_read: bytes.len() }))
        }
        _ => Glb::from_slice(bytes),
    }
}

/// A .glb's JSON, and where its BIN chunk's contents begin, counted from the start of the file; `name` is for messages.
pub struct GlbDocument {
    pub json: Value,
    pub bin_offset: usize,
}

pub fn read_glb(name: &str, bytes: &[u8]) -> Result<GlbDocument, ExportError> {
    let bad = |why: &dyn ToString| ExportError::NotGltf(name.into(), why.to_string());
    let glb = split_glb(bytes).map_err(|error| bad(&error))?;
    let json = serde_json::from_slice(&glb.json).map_err(|error| bad(&error))?;
    // Three words of header, and two before each chunk.
    Ok(GlbDocument { json, bin_offset: 12 + 8 + glb.json.len() + 8 })
}
