//! Changes of a mesh → the log of a simplification: for each step, what undoes it.

use bytemuck::NoUninit;
use glam::Vec3;

/// All that a vertex carries; attributes that the mesh lacks are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, NoUninit)]
#[repr(C)]
pub struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub uv: [f32; 2],
    pub color: [u8; 4],
}

impl Vertex {
    /// The unit vector along its normal; zero without one.
    pub fn outward(&self) -> Vec3 {
        Vec3::from_array(self.normal).normalize_or_zero()
    }
}

/// What undoes one step: a vertex split, or a piece that appears whole.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Vertices that were changed, and what they were.
    pub changed: &'a [(u32, Vertex)],
    /// Vertices that were removed, the vertex that each merged into (or `NONE`), and what they were.
    pub removed: &'a [(u32, u32, Vertex)],
    /// Corners (3·triangle + 0…2) that were given another vertex, and the vertex they had.
    pub corners: &'a [(u32, u32)],
    /// Triangles that were removed, and their vertices.
    pub triangles: &'a [(u32, [u32; 3])],
}

/// All records in the order in which they were made, in flat lists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    pub changed: Vec<(u32, Vertex)>,
    pub removed: Vec<(u32, u32, Vertex)>,
    pub corners: Vec<(u32, u32)>,
    pub triangles: Vec<(u32, [u32; 3])>,
    /// Where each record ends in each of the four lists.
    ends: Vec<[usize; 4]>,
}

impl Log {
    /// Ends a record: what was pushed onto the lists since the last one.
    pub fn finish_record(&mut self) {
        self.ends.push([self.changed.len(), self.removed.len(), self.corners.len(), self.triangles.len()]);
    }

    pub fn len(&self) -> usize {
        self.ends.len()
    }

    pub fn record(&self, index: usize) -> Record<'_> {
        let start = if index == 0 { [0; 4] } else { self.ends[index - 1] };
        let end = self.ends[index];
        Record {
            changed: &self.changed[start[0]..end[0]],
            removed: &self.removed[start[1]..end[1]],
            corners: &self.corners[start[2]..end[2]],
            triangles: &self.triangles[start[3]..end[3]],
        }
    }
}
