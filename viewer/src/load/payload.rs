//! The binary part of `GSC_heightfield` → heights and what their levels of detail need. The page on that extension
//! is the source for every offset here.

use crate::scene::Heightfield;

/// Bytes before the arrays.
const HEADER_BYTES: usize = 72;
/// 2^14+1 samples a side: more bytes than that cannot be named.
const GREATEST_DEPTH: u32 = 14;

/// Reads the payload; a message for people if it is none.
pub(super) fn read(bytes: &[u8]) -> Result<Heightfield, String> {
    if bytes.len() < HEADER_BYTES || bytes[..4] != *b"GSCH" {
        return Err("it does not begin with GSCH".to_owned());
    }
    let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    if word(4) != 1 {
        return Err(format!("its version is {}; this program reads version 1", word(4)));
    }
    let (side, spacing_m, depth) = (word(8), f32::from_bits(word(12)), word(24));
    let sound = (1..=GREATEST_DEPTH).contains(&depth) && side == (1 << depth) + 1;
    if !sound || !spacing_m.is_finite() || spacing_m <= 0.0 {
        return Err(format!("{side} samples at {spacing_m} m make no field: a side has 2^k+1 samples"));
    }
    let array = |index: usize, expected: usize| -> Result<&[u8], String> {
        let (offset, length) = (word(32 + 8 * index) as usize, word(36 + 8 * index) as usize);
        let found = bytes.get(offset..offset + length).filter(|found| found.len() == expected);
        found.ok_or_else(|| format!("its array {index} is cut short or damaged"))
    };
    let floats = |index: usize, count: usize| -> Result<Vec<f32>, String> {
        let words = array(index, 4 * count)?.chunks_exact(4);
        Ok(words.map(|w| f32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect())
    };
    let samples = (side * side) as usize;
    let blocks = ((1usize << (2 * depth)) - 1) / 3;
    Ok(Heightfield {
        side,
        spacing_m,
        heights_m: floats(0, samples)?,
        wedgies_m: floats(1, samples)?,
        displacements_m: floats(2, samples)?,
        block_ranges_m: floats(3, 2 * blocks)?.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect(),
        levels: array(4, samples)?.to_vec(),
    })
}
