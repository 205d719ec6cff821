//! Heights and what their levels of detail need ↔ the binary data of `GSC_heightfield` (`schema/docs/`).
//!
//! Little-endian, no padding but at the end; n = side, k = log2(n−1):
//!
//! | byte | type | what |
//! |---|---|---|
//! | 0 | 4 × u8 | magic `GSCH` |
//! | 4 | u32 | version, 1 |
//! | 8 | u32 | side: samples a side, 2^k+1, k ≥ 1 |
//! | 12 | f32 | spacing between samples in metres |
//! | 16 | 2 × f32 | lowest and highest sample in metres |
//! | 24 | u32 | k: levels of blocks in the block ranges |
//! | 28 | u32 | 0, reserved |
//! | 32 | 5 × (u32, u32) | byte offset from the payload's start and byte length of the five arrays that follow |
//! | 72 | n² × f32 | heights in metres |
//! | | n² × f32 | wedgie half thicknesses in metres |
//! | | n² × f32 | displacements in metres |
//! | | Σ 4^l × 2 × f32, l = 0 … k−1 | lowest and highest height of each block in metres |
//! | | n² × u8 | level numbers, then zeros up to a multiple of four bytes |

use std::borrow::Cow;

use thiserror::Error;

const MAGIC: &[u8; 4] = b"GSCH";
const VERSION: u32 = 1;
const HEADER_BYTES: usize = 72;
/// A field of 2^15+1 samples a side would need more bytes than the offsets can count.
const GREATEST_K: u32 = 14;

/// Heights and what their levels of detail need; the page on `GSC_heightfield` says what each array means. Arrays of
/// side² values have entry j·side + i for the sample i east, j south.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightfieldData<'a> {
    /// Samples a side, 2^k+1, k ≥ 1.
    pub side: u32,
    /// Metres between samples.
    pub spacing_m: f32,
    /// side² heights in metres.
    pub heights_m: Cow<'a, [f32]>,
    /// side² half thicknesses in metres.
    pub wedgies_m: Cow<'a, [f32]>,
    /// side² displacements in metres.
    pub displacements_m: Cow<'a, [f32]>,
    /// (4^k − 1)/3 pairs: lowest and highest of each block in metres.
    pub block_ranges_m: Cow<'a, [[f32; 2]]>,
    /// side² level numbers.
    pub levels: Cow<'a, [u8]>,
}

/// Why bytes are no payload of `GSC_heightfield`.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum HeightfieldError {
    /// Not ours.
    #[error("not a GSC_heightfield payload: it does not begin with \"GSCH\"")]
    Magic,
    /// From another time.
    #[error("GSC_heightfield version {0} is unknown; this program reads version {VERSION}")]
    Version(u32),
    /// The number of samples or the spacing makes no sense.
    #[error("GSC_heightfield of {side} samples a side is damaged: sides are 2^k+1 samples, 3 to 16385")]
    Side {
        /// What the header says.
        side: u32,
    },
    /// The distance between samples makes no sense.
    #[error("GSC_heightfield is damaged: samples {spacing_m} m apart")]
    Spacing {
        /// What the header says.
        spacing_m: f32,
    },
    /// An array lies outside the payload or has the wrong length.
    #[error(
        "GSC_heightfield is cut short or damaged: {array} should have {expected} bytes within the payload"
    )]
    Array {
        /// Which.
        array: &'static str,
        /// How many bytes it should have.
        expected: usize,
    },
}

/// The data's bytes.
pub fn write_heightfield(data: &HeightfieldData<'_>) -> Vec<u8> {
    let arrays = [
        le_bytes(&data.heights_m),
        le_bytes(&data.wedgies_m),
        le_bytes(&data.displacements_m),
        le_bytes(data.block_ranges_m.as_flattened()),
        data.levels.to_vec(),
    ];
    let span = data.heights_m.iter().fold((f32::MAX, f32::MIN), |(lo, hi), &h| (lo.min(h), hi.max(h)));
    let (lowest, highest) = span;
    let total = HEADER_BYTES + arrays.iter().map(Vec::len).sum::<usize>();
    let mut bytes = Vec::with_capacity(total.next_multiple_of(4));
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(data.side.to_le_bytes());
    bytes.extend(data.spacing_m.to_le_bytes());
    bytes.extend(lowest.to_le_bytes());
    bytes.extend(highest.to_le_bytes());
    bytes.extend((data.side - 1).trailing_zeros().to_le_bytes());
    bytes.extend(0_u32.to_le_bytes());
    let mut offset = HEADER_BYTES;
    for array in &arrays {
        bytes.extend((offset as u32).to_le_bytes());
        bytes.extend((array.len() as u32).to_le_bytes());
        offset += array.len();
    }
    arrays.iter().for_each(|array| bytes.extend(array));
    bytes.resize(total.next_multiple_of(4), 0);
    bytes
}

/// What [`write_heightfield`] wrote, exactly.
///
/// # Errors
/// When the bytes are no data of this version, or are damaged.
pub fn read_heightfield(bytes: &[u8]) -> Result<HeightfieldData<'static>, HeightfieldError> {
    if !bytes.starts_with(MAGIC) {
        return Err(HeightfieldError::Magic);
    }
    let header = bytes.get(..HEADER_BYTES);
    let header = header.ok_or(HeightfieldError::Array { array: "the header", expected: HEADER_BYTES })?;
    let word = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    if word(4) != VERSION {
        return Err(HeightfieldError::Version(word(4)));
    }
    let side = word(8);
    let cells = side.wrapping_sub(1);
    if !cells.is_power_of_two() || !(1..=GREATEST_K).contains(&cells.trailing_zeros()) {
        return Err(HeightfieldError::Side { side });
    }
    let spacing_m = f32::from_bits(word(12));
    if !spacing_m.is_finite() || spacing_m <= 0.0 {
        return Err(HeightfieldError::Spacing { spacing_m });
    }
    let samples = side as usize * side as usize;
    let blocks = (cells as usize * cells as usize - 1) / 3;
    let array = |index: usize, array: &'static str, expected: usize| {
        let (offset, length) = (word(32 + 8 * index) as usize, word(36 + 8 * index) as usize);
        let found = offset.checked_add(length).and_then(|end| bytes.get(offset..end));
        found.filter(|found| found.len() == expected).ok_or(HeightfieldError::Array { array, expected })
    };
    let heights_m = floats(array(0, "the heights", 4 * samples)?);
    let wedgies_m = floats(array(1, "the wedgies", 4 * samples)?);
    let displacements_m = floats(array(2, "the displacements", 4 * samples)?);
    let ranges = floats(array(3, "the block ranges", 8 * blocks)?);
    let block_ranges_m = ranges.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    let levels = array(4, "the levels", samples)?.to_vec();
    Ok(HeightfieldData {
        side,
        spacing_m,
        heights_m: heights_m.into(),
        wedgies_m: wedgies_m.into(),
        displacements_m: displacements_m.into(),
        block_ranges_m: Cow::Owned(block_ranges_m),
        levels: levels.into(),
    })
}

fn le_bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}
