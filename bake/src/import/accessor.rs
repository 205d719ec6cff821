//! glTF accessors → numbers, with every offset checked: a damaged file gives `None`, never a panic.

use gltf::accessor::{DataType, Dimensions};

/// Rows of `N` numbers; integers that are `normalized` become fractions. `None` if the accessor has another shape or
/// reaches beyond its buffer.
pub fn rows<const N: usize>(accessor: &gltf::Accessor<'_>, buffers: &[Vec<u8>]) -> Option<Vec<[f32; N]>> {
    if accessor.dimensions().multiplicity() != N || matches!(accessor.dimensions(), Dimensions::Mat2) {
        return None;
    }
    let (kind, normalized) = (accessor.data_type(), accessor.normalized());
    let number = move |bytes: &[u8]| -> f32 {
        let scale = |value: f32, most: f32| if normalized { (value / most).max(-1.0) } else { value };
        match *bytes {
            [b] if kind == DataType::I8 => scale(f32::from(b as i8), 127.0),
            [b] => scale(f32::from(b), 255.0),
            [a, b] if kind == DataType::I16 => scale(f32::from(i16::from_le_bytes([a, b])), 32_767.0),
            [a, b] => scale(f32::from(u16::from_le_bytes([a, b])), 65_535.0),
            [a, b, c, d] if kind == DataType::F32 => f32::from_le_bytes([a, b, c, d]),
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]) as f32,
            _ => 0.0,
        }
    };
    let size = kind.size();
    read(accessor, buffers, N * size, |row| {
        let mut values = [0.0; N];
        values.iter_mut().zip(row.chunks_exact(size)).for_each(|(value, bytes)| *value = number(bytes));
        values
    })
}

/// Indices of any width.
pub fn indices(accessor: &gltf::Accessor<'_>, buffers: &[Vec<u8>]) -> Option<Vec<u32>> {
    let size = accessor.data_type().size();
    let whole = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
    (whole && accessor.dimensions() == Dimensions::Scalar)
        .then(|| read(accessor, buffers, size, little_endian))
        .flatten()
}

fn little_endian(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

fn read<T: Clone>(
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
    size: usize,
    row: impl Fn(&[u8]) -> T,
) -> Option<Vec<T>> {
    let count = accessor.count();
    let mut values = match accessor.view() {
        Some(view) => strided(&view, accessor.offset(), count, size, buffers)?.map(&row).collect(),
        // An accessor without a view is all zeros, but only a sparse one says anything; don't believe any count.
        None => match accessor.sparse() {
            Some(_) if count <= buffers.iter().map(Vec::len).sum::<usize>().max(1 << 20) => {
                vec![row(&vec![0; size]); count]
            }
            _ => return None,
        },
    };
    if let Some(sparse) = accessor.sparse() {
        let (at, with) = (sparse.indices(), sparse.values());
        let changed = sparse.count();
        let width = at.index_type().size();
        let places = strided(&at.view(), at.offset(), changed, width, buffers)?;
        let rows = strided(&with.view(), with.offset(), changed, size, buffers)?;
        for (place, bytes) in places.zip(rows) {
            *values.get_mut(little_endian(place) as usize)? = row(bytes);
        }
    }
    Some(values)
}

/// `count` pieces of `size` bytes each, or `None` if they aren't all there.
fn strided<'a>(
    view: &gltf::buffer::View<'_>,
    offset: usize,
    count: usize,
    size: usize,
    buffers: &'a [Vec<u8>],
) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
    let buffer = buffers.get(view.buffer().index())?;
    let end = view.offset().checked_add(view.length())?;
    let bytes = buffer.get(view.offset()..end)?.get(offset..)?;
    let stride = view.stride().unwrap_or(size).max(1);
    let last = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size))?;
    (last <= bytes.len()).then(|| (0..count).map(move |k| &bytes[k * stride..k * stride + size]))
}
