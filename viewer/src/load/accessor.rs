//! An accessor and the lengths of its buffers → whether its numbers are all there. Asked before anything is made for them:
//! what a file says of its own size is not believed.

use gltf::Accessor;
use gltf::buffer::View;

/// Values that an accessor without a buffer may have: zeros, but for the few that a sparse one changes.
const MAX_ZEROS: usize = 1 << 24;

/// Whether all its values lie in their buffers, of which `length_of` gives the bytes.
pub(super) fn fits(accessor: &Accessor<'_>, length_of: impl Fn(usize) -> usize) -> bool {
    let holds = |view: &View<'_>, offset: usize, count: usize, size: usize| {
        let stride = view.stride().unwrap_or(size);
        let length = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        let end = length.and_then(|length| length.checked_add(offset));
        let end_of_view = view.offset().checked_add(view.length());
        end.is_some_and(|end| end <= view.length())
            && end_of_view.is_some_and(|end| end <= length_of(view.buffer().index()))
    };
    let (count, size) = (accessor.count(), accessor.size());
    let base = match accessor.view() {
        Some(view) => holds(&view, accessor.offset(), count, size),
        None => count <= MAX_ZEROS,
    };
    base && accessor.sparse().is_none_or(|sparse| {
        let (indices, values) = (sparse.indices(), sparse.values());
        sparse.count() <= count
            && holds(&indices.view(), indices.offset(), sparse.count(), indices.index_type().size())
            && holds(&values.view(), values.offset(), sparse.count(), size)
    })
}
