//! The GLB container (glTF 2.0, section 4): a header, a JSON chunk and a BIN chunk.

use serde_json::Value;

use super::ExportError;
use super::document::pad;

const MAGIC: u32 = 0x4654_6C67;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// Header and chunks around a document's JSON and the contents of its buffer 0.
pub fn write_glb(mut json: Vec<u8>, mut bin: Vec<u8>) -> Vec<u8> {
    pad(&mut json, b' ');
    pad(&mut bin, 0);
    let total = 12 + 8 + json.len() + if bin.is_empty() { 0 } else { 8 + bin.len() };
    let mut out = Vec::with_capacity(total);
    let words = |out: &mut Vec<u8>, list: &[u32]| {
        list.iter().for_each(|word| out.extend_from_slice(&word.to_le_bytes()));
    };
    words(&mut out, &[MAGIC, 2, total as u32, json.len() as u32, JSON]);
    out.append(&mut json);
    if !bin.is_empty() {
        words(&mut out, &[bin.len() as u32, BIN]);
        out.append(&mut bin);
    }
    out
}

/// A .glb taken apart.
pub struct Glb {
    /// Its JSON.
    pub json: Value,
    /// Where its BIN chunk's contents begin, counted from the start of the file.
    pub bin_offset: usize,
}

/// Finds the parts of a .glb; `name` is for messages.
pub fn read_glb(name: &str, bytes: &[u8]) -> Result<Glb, ExportError> {
    let bad = |why: &str| ExportError::NotGltf(name.into(), why.into());
    let word = |at: usize| -> Result<u32, ExportError> {
        let four = bytes.get(at..at + 4).and_then(|slice| slice.try_into().ok());
        four.map(u32::from_le_bytes).ok_or_else(|| bad("it ends too early"))
    };
    if word(0)? != MAGIC || word(4)? != 2 {
        return Err(bad("it is no GLB of version 2"));
    }
    if word(16)? != JSON {
        return Err(bad("its first chunk is not JSON"));
    }
    let end = 20usize.saturating_add(word(12)? as usize);
    let text = bytes.get(20..end).ok_or_else(|| bad("its JSON chunk is cut off"))?;
    let json = serde_json::from_slice(text).map_err(|e| bad(&e.to_string()))?;
    Ok(Glb { json, bin_offset: end + 8 })
}
