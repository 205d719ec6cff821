//! A flat card → one triangle that shows all of its picture: three vertices instead of four, one triangle instead of two.
//!
//! Pictures of leaves leave the corners of their cards empty, so the smallest triangle around what is opaque is hardly larger
//! than the card. It reaches beyond the picture, where texture coordinates are below 0 or above 1; there nothing is drawn.

use glam::{Vec2, Vec3};

use super::log::Vertex;
use super::state::{PartSpan, State};
use crate::model::AlphaMask;

/// Directions in which triangles may have their sides.
const DIRECTIONS: usize = 64;
/// The triangle keeps so far away from opaque texels of the mask, which is coarser than the picture.
const MARGIN: f32 = 1.0 / 32.0;

/// The smallest triangle, in texture coordinates, around what a mask has opaque; `None` if that is nothing or all.
pub fn triangle(mask: &AlphaMask) -> Option<[Vec2; 3]> {
    let corners: Vec<Vec2> = mask.outline().map(Vec2::from_array).collect();
    if corners.is_empty() || mask.is_full() {
        return None;
    }
    let normals: Vec<Vec2> = (0..DIRECTIONS).map(direction).collect();
    // How far the opaque part reaches in each direction, but not beyond the picture.
    let reach = |normal: &Vec2| {
        let support = |points: &[Vec2]| points.iter().map(|p| p.dot(*normal)).fold(f32::MIN, f32::max);
        let picture = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE];
        (support(&corners) + MARGIN).min(support(&picture))
    };
    let reaches: Vec<f32> = normals.iter().map(reach).collect();
    let meet = |i: usize, j: usize| {
        let (p, q) = (normals[i], normals[j]);
        let across = p.perp_dot(q);
        Vec2::new(reaches[i] * q.y - reaches[j] * p.y, reaches[j] * p.x - reaches[i] * q.x) / across
    };
    let mut best = (f32::MAX, None);
    // No two of the normals may be half a turn apart or more, or what they enclose is open.
    for i in 0..DIRECTIONS {
        for j in i + 1..(i + DIRECTIONS / 2).min(DIRECTIONS) {
            let first = meet(i, j);
            for k in (i + DIRECTIONS / 2 + 1)..(j + DIRECTIONS / 2).min(DIRECTIONS) {
                let (second, third) = (meet(j, k), meet(k, i));
                let area = 0.5 * (second - first).perp_dot(third - first).abs();
                if area < best.0 {
                    best = (area, Some([first, second, third]));
                }
            }
        }
    }
    best.1
}

fn direction(index: usize) -> Vec2 {
    let (sin, cos) = libm::sincosf(index as f32 * std::f32::consts::TAU / DIRECTIONS as f32);
    Vec2::new(cos, sin)
}

/// How far, in metres, a card's vertices lie from the plane in which its picture is laid on evenly: the root of their mean square;
/// `None` if its texture coordinates lie in a line.
pub fn error_m(vertices: &[Vertex]) -> Option<f32> {
    let plane = Plane::of(vertices)?;
    let off =
        |v: &Vertex| plane.position(Vec2::from_array(v.uv)).distance_squared(Vec3::from_array(v.position));
    Some((vertices.iter().map(off).sum::<f32>() / vertices.len() as f32).sqrt())
}

/// Makes a living card of four vertices and two triangles a triangle with these texture coordinates, in the plane that is nearest to
/// all vertices that the element had. Its first vertex stays. Nothing happens to a card whose texture coordinates lie in a line.
pub fn fit(state: &mut State, span: &PartSpan, element: u32, triangle: [Vec2; 3]) {
    let [ids, triangles] = span.element(element);
    let plane = Plane::of(&state.vertices[ids.clone()]);
    let ids: Vec<u32> = ids.filter(|&id| state.vertex_lives[id]).map(|id| id as u32).collect();
    let triangles: Vec<usize> = triangles.filter(|&t| state.triangle_lives[t]).collect();
    let (Some(plane), &[a, b, c, d], &[kept, gone]) = (plane, &ids[..], &triangles[..]) else {
        return;
    };
    let uv = |id: u32| Vec2::from_array(state.vertices[id as usize].uv);
    let corners = [a, b, c, d].map(|id| (id, uv(id)));
    let (leaves, stay) = nearest(corners, triangle);
    let before = facing(&state.triangles[kept].map(|v| state.vertices[v as usize].position));
    let into = (0..3)
        .min_by(|&p, &q| {
            let away = |k: usize| uv(leaves).distance_squared(triangle[k]);
            away(p).total_cmp(&away(q))
        })
        .map_or(stay[0], |k| stay[k]);
    let changed = std::array::from_fn(|k| plane.vertex(triangle[k], state.vertices[stay[k] as usize].color));
    state.remove_triangle(gone as u32);
    let turned = facing(&changed.map(|v: Vertex| v.position)).dot(before) < 0.0;
    let order = if turned { [stay[0], stay[2], stay[1]] } else { stay };
    for (corner, vertex) in order.into_iter().enumerate() {
        let corner = (3 * kept + corner) as u32;
        if state.vertex_at(corner) != vertex {
            state.change_corner(corner, vertex);
        }
    }
    stay.into_iter().zip(changed).for_each(|(id, vertex)| state.change_vertex(id, vertex));
    state.remove_vertex(leaves, into);
}

/// Which of four vertices leaves, and which becomes each corner of the triangle: those that have the shortest ways, the first
/// among them.
fn nearest(vertices: [(u32, Vec2); 4], triangle: [Vec2; 3]) -> (u32, [u32; 3]) {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let ways = vertices.map(|(_, from)| triangle.map(|to| from.distance_squared(to)));
    let without = |left: usize| [0, 1, 2].map(|k| if k < left { k } else { k + 1 });
    let mut best = (f32::INFINITY, 3, without(3));
    for left in 1..4 {
        for stay in ORDERS.map(|order| order.map(|k| without(left)[k])) {
            let way = ways[stay[0]][0] + ways[stay[1]][1] + ways[stay[2]][2];
            if way < best.0 {
                best = (way, left, stay);
            }
        }
    }
    let (_, left, stay) = best;
    (vertices[left].0, stay.map(|k| vertices[k].0))
}

fn facing(corners: &[[f32; 3]; 3]) -> Vec3 {
    let [a, b, c] = corners.map(Vec3::from_array);
    (b - a).cross(c - a)
}

/// The linear function of texture coordinates that is nearest to a card's positions and normals by least squares.
struct Plane {
    /// Texture coordinates of the middle.
    middle: Vec2,
    positions: Linear,
    normals: Linear,
}

/// What is in the middle, and how it changes along u and v.
struct Linear {
    mean: Vec3,
    along: [Vec3; 2],
}

impl Linear {
    fn at(&self, away: Vec2) -> Vec3 {
        self.mean + self.along[0] * away.x + self.along[1] * away.y
    }
}

impl Plane {
    fn of(vertices: &[Vertex]) -> Option<Self> {
        let count = vertices.len() as f32;
        let middle = vertices.iter().map(|v| Vec2::from_array(v.uv)).sum::<Vec2>() / count;
        let away: Vec<Vec2> = vertices.iter().map(|v| Vec2::from_array(v.uv) - middle).collect();
        let sum = |product: &dyn Fn(&Vec2) -> f32| away.iter().map(product).sum::<f32>();
        let (uu, uv, vv) = (sum(&|t| t.x * t.x), sum(&|t| t.x * t.y), sum(&|t| t.y * t.y));
        let determinant = uu * vv - uv * uv;
        if determinant <= 1e-9 {
            return None;
        }
        let linear = |value: &dyn Fn(&Vertex) -> [f32; 3]| {
            let values = || vertices.iter().map(value).map(Vec3::from_array);
            let by = |axis: usize| values().zip(&away).map(|(value, t)| value * t[axis]).sum::<Vec3>();
            let (u, v) = (by(0), by(1));
            let along = [(u * vv - v * uv) / determinant, (v * uu - u * uv) / determinant];
            Linear { mean: values().sum::<Vec3>() / count, along }
        };
        Some(Self { middle, positions: linear(&|v| v.position), normals: linear(&|v| v.normal) })
    }

    fn position(&self, uv: Vec2) -> Vec3 {
        self.positions.at(uv - self.middle)
    }

    /// A vertex there, of that colour: colours do not morph, and would jump.
    fn vertex(&self, uv: Vec2, color: [u8; 4]) -> Vertex {
        let normal = self.normals.at(uv - self.middle).normalize_or_zero();
        Vertex { position: self.position(uv).to_array(), normal: normal.to_array(), uv: uv.to_array(), color }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Image8, Material, Mesh, Part, PartKind};

    /// A leaf: a lozenge that reaches to the lower edge, and leaves the corners empty.
    fn lozenge() -> AlphaMask {
        let mut image = Image8::new(32, 32, 4);
        for (i, pixel) in image.data.chunks_exact_mut(4).enumerate() {
            let away = |t: usize| (t as f32 - 15.5).abs();
            pixel[3] = if away(i % 32) + away(i / 32) < 15.5 { 255 } else { 0 };
        }
        AlphaMask::of(&image, 0.5)
    }

    fn is_inside([a, b, c]: [Vec2; 3], p: Vec2) -> bool {
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
        sides.iter().all(|side| *side >= -1e-4) || sides.iter().all(|side| *side <= 1e-4)
    }

    fn area([a, b, c]: [Vec2; 3]) -> f32 {
        0.5 * (b - a).perp_dot(c - a).abs()
    }

    #[test]
    fn the_triangle_holds_all_that_is_opaque_and_is_hardly_larger_than_the_card() {
        let mask = lozenge();
        let triangle = triangle(&mask).expect("a triangle");
        assert!(mask.outline().all(|p| is_inside(triangle, Vec2::from_array(p))), "{triangle:?}");
        // Twice the area of what it holds is the least for a lozenge (a parallelogram).
        assert!((1.0..1.25).contains(&area(triangle)), "{}", area(triangle));
    }

    #[test]
    fn what_is_not_cut_out_stays_a_card() {
        assert!(triangle(&AlphaMask::default()).is_none());
        assert!(triangle(&AlphaMask::of(&Image8::new(32, 32, 4), 0.5)).is_none(), "nothing to show");
    }

    /// Two cards, one of them mirrored, with vertices by rows from the root.
    fn cards() -> Mesh {
        let mut mesh = Mesh::default();
        let mut triangles = Vec::new();
        for mirrored in [false, true] {
            let first = mesh.positions.len() as u32;
            for (across, up) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0f32, 1.0f32)] {
                mesh.positions.push([2.0 * across, 3.0 * up, 0.5 * up + f32::from(u8::from(mirrored))]);
                mesh.normals.push([0.0, 0.0, 1.0]);
                mesh.uvs.push([if mirrored { 1.0 - across } else { across }, 1.0 - up]);
                mesh.colors.push([200, 100, 50, 255]);
            }
            triangles.extend([[first, first + 1, first + 3], [first, first + 3, first + 2]]);
        }
        let kind = PartKind::Aggregate { vertices: 4, triangles: 2 };
        mesh.parts.push(Part { material: Material::Leaf, kind, triangles });
        mesh
    }

    #[test]
    fn a_fitted_card_shows_the_same_picture_in_the_same_place() {
        let mesh = cards();
        let mut state = State::new(&mesh);
        let span = state.parts[0].clone();
        let triangle = triangle(&lozenge()).expect("a triangle");
        for element in 0..2 {
            fit(&mut state, &span, element, triangle);
        }
        let (fitted, _) = state.to_mesh(&[1.0]);
        assert_eq!((fitted.positions.len(), fitted.triangle_count()), (6, 2));
        for (element, corners) in fitted.parts[0].triangles.iter().enumerate() {
            let mirrored = element == 1;
            for &v in corners {
                let [u, v_up] = fitted.uvs[v as usize];
                let (across, up) = (if mirrored { 1.0 - u } else { u }, 1.0 - v_up);
                let place = Vec3::new(2.0 * across, 3.0 * up, 0.5 * up + f32::from(u8::from(mirrored)));
                let there = Vec3::from_array(fitted.positions[v as usize]);
                assert!(there.distance(place) < 1e-4, "{there} is not {place}");
            }
            let before = facing(&mesh.parts[0].triangles[2 * element].map(|v| mesh.positions[v as usize]));
            let after = facing(&corners.map(|v| fitted.positions[v as usize]));
            assert!(before.dot(after) > 0.0, "turned over");
        }
    }
}
