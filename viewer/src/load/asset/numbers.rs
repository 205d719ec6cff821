//! Accessors → rows of numbers: any component type, normalised, strided, sparse. Nothing is believed that a file says of its
//! own size.

use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, buffer};

use super::file::AssetFile;

/// Rows that an accessor without a buffer may have: zeros, but for the few that a sparse one changes.
const MAX_ZEROS: usize = 1 << 20;

impl AssetFile {
    /// Rows of `N` numbers; integers that are `normalized` become fractions. `None` if the accessor has another shape, is
    /// not there or reaches beyond its buffer.
    pub fn rows<const N: usize>(&self, index: Index<Accessor>) -> Option<Vec<[f32; N]>> {
        let accessor = self.root.accessors.get(index.value())?;
        let kind = component(accessor)?;
        if columns(accessor)? != N {
            return None;
        }
        let size = kind.size();
        self.read(accessor, N * size, |bytes| {
            let mut row = [0.0; N];
            let numbers = bytes.chunks_exact(size).map(|bytes| number(kind, accessor.normalized, bytes));
            row.iter_mut().zip(numbers).for_each(|(value, number)| *value = number);
            row
        })
    }

    /// Colours, of three numbers or four.
    pub fn colors(&self, index: Index<Accessor>) -> Option<Vec<[f32; 4]>> {
        let opaque =
            || self.rows::<3>(index).map(|rows| rows.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect());
        self.rows::<4>(index).or_else(opaque)
    }

    /// Whole numbers of any width.
    pub fn indices(&self, index: Index<Accessor>) -> Option<Vec<u32>> {
        let accessor = self.root.accessors.get(index.value())?;
        let kind = component(accessor)?;
        let is_whole = matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if !is_whole || columns(accessor)? != 1 {
            return None;
        }
        self.read(accessor, kind.size(), whole)
    }

    fn read<T: Clone>(&self, accessor: &Accessor, size: usize, row: impl Fn(&[u8]) -> T) -> Option<Vec<T>> {
        let count = usize::try_from(accessor.count.0).ok()?;
        self.rows_left.set(self.rows_left.get().saturating_sub(count));
        if self.rows_left.get() == 0 {
            return None;
        }
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let mut rows: Vec<T> = match accessor.buffer_view {
            Some(view) => self.strided(view, offset, count, size)?.map(&row).collect(),
            None if count <= MAX_ZEROS => vec![row(&vec![0; size]); count],
            None => return None,
        };
        let Some(sparse) = &accessor.sparse else { return Some(rows) };
        let (places, values) = (&sparse.indices, &sparse.values);
        let changed = usize::try_from(sparse.count.0).ok()?;
        let Checked::Valid(width) = places.component_type else { return None };
        let at = self.strided(places.buffer_view, places.byte_offset.0, changed, width.0.size())?;
        let with = self.strided(values.buffer_view, values.byte_offset.0, changed, size)?;
        for (place, bytes) in at.zip(with) {
            *rows.get_mut(whole(place) as usize)? = row(bytes);
        }
        Some(rows)
    }

    /// `count` pieces of `size` bytes each; `None` if they are not all there.
    fn strided(
        &self,
        view: Index<buffer::View>,
        offset: u64,
        count: usize,
        size: usize,
    ) -> Option<impl Iterator<Item = &[u8]>> {
        let stride = self.root.buffer_views.get(view.value())?.byte_stride.map_or(size, |stride| stride.0);
        // A stride that is too short would make much out of little.
        let stride = stride.max(size).max(1);
        let bytes = self.view(view)?.get(usize::try_from(offset).ok()?..)?;
        let end = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size))?;
        (end <= bytes.len()).then(|| (0..count).map(move |k| &bytes[k * stride..k * stride + size]))
    }
}

fn component(accessor: &Accessor) -> Option<ComponentType> {
    let Checked::Valid(GenericComponentType(kind)) = accessor.component_type else { return None };
    Some(kind)
}

fn columns(accessor: &Accessor) -> Option<usize> {
    match accessor.type_ {
        Checked::Valid(kind @ (Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Mat4)) => {
            Some(kind.multiplicity())
        }
        _ => None,
    }
}

fn whole(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

fn number(kind: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, max) = match kind {
        ComponentType::F32 => return f32::from_bits(whole(bytes)),
        ComponentType::U32 => return whole(bytes) as f32,
        ComponentType::I8 => (f32::from(whole(bytes) as u8 as i8), 127.0),
        ComponentType::U8 => (whole(bytes) as f32, 255.0),
        ComponentType::I16 => (f32::from(whole(bytes) as u16 as i16), 32_767.0),
        ComponentType::U16 => (whole(bytes) as f32, 65_535.0),
    };
    if normalized { (value / max).max(-1.0) } else { value }
}
