//! Two lines of vertices side by side → the triangles that fill the strip between them.

/// Each triangle has its first corner on `a`, its second on `b`, and its third on the line whose next vertex comes
/// first: on `a`, where both are level. `along` ascends on both lines, which have at least one vertex each.
pub fn fill(a: &[u32], b: &[u32], along: impl Fn(u32) -> f32) -> Vec<[u32; 3]> {
    let ahead = |line: &[u32]| line.get(1).map_or(f32::MAX, |&vertex| along(vertex));
    let (mut a, mut b) = (a, b);
    let mut triangles = Vec::with_capacity(a.len() + b.len());
    while a.len() > 1 || b.len() > 1 {
        let on_a = ahead(a) <= ahead(b);
        triangles.push([a[0], b[0], if on_a { a[1] } else { b[1] }]);
        if on_a { a = &a[1..] } else { b = &b[1..] }
    }
    triangles
}
