//! What a node says of its place, and of the nodes below it.

use glam::{DAffine3, DMat4, DQuat, Vec3};
use gltf::json::scene::Node;

/// The nodes that move with it.
pub(super) fn children(node: &Node) -> impl Iterator<Item = usize> + use<'_> {
    node.children.iter().flatten().map(|child| child.value())
}

/// Where a node is in its parent.
pub(super) fn local(node: &Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let vector = |value: Option<[f32; 3]>, usual: f32| Vec3::from(value.unwrap_or([usual; 3])).as_dvec3();
    let turn = node.rotation.map_or(DQuat::IDENTITY, |quaternion| rotation(quaternion.0));
    DAffine3::from_scale_rotation_translation(vector(node.scale, 1.0), turn, vector(node.translation, 0.0))
}

/// That of a quaternion; none for one without length.
pub(super) fn rotation(quaternion: [f32; 4]) -> DQuat {
    let turn = DQuat::from_array(quaternion.map(f64::from));
    if turn.length_squared() > 1e-12 { turn.normalize() } else { DQuat::IDENTITY }
}
