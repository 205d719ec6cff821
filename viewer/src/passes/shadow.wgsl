// Depth as seen from the sun: of trees at a fixed level of detail, and of the land. Drawn once for each landscape, for
// nothing in it moves. Of closed surfaces only the sides that face away are drawn (Wang & Molnar 1994), so that small
// shifts of the lit side by a geomorph never shade it.

@group(1) @binding(0) var<storage, read> trees: array<Tree>;
@group(2) @binding(0) var<uniform> material: Material;
@group(2) @binding(1) var color_map: texture_2d<f32>;
@group(2) @binding(2) var normal_map: texture_2d<f32>;

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn tree(
    @location(0) position: vec3f,
    @location(4) uv: vec2f,
    @location(8) tree: u32,
) -> Out {
    let world = from_template(trees[tree].rows, position);
    return Out(view.shadow_from_world * vec4f(world, 1.0), uv);
}

@fragment
fn leaf(in: Out) {
    if (textureSample(color_map, clamped, in.uv).a < material.alpha_cutoff || !is_on_picture(in.uv)) {
        discard;
    }
}

// Alpha is the share that twigs cover.
@fragment
fn twig(in: Out) {
    if (textureSample(color_map, clamped, in.uv).a <= scattered(in.clip.xy) || !is_on_picture(in.uv)) {
        discard;
    }
}

// The land as a grid of so many cells a side, or of as many as it has, two triangles a cell, without buffers.
override LAND_CELLS: u32;

@vertex
fn land(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let side = u32(view.field.x) - 1u;
    let cells = min(side, LAND_CELLS);
    let cell = index / 6u;
    let corner = array<vec2u, 6>(vec2u(0, 0), vec2u(0, 1), vec2u(1, 0), vec2u(1, 0), vec2u(0, 1), vec2u(1, 1))[index % 6u];
    let sample = (vec2u(cell % cells, cell / cells) + corner) * (side / cells);
    // A little lower than it is, lest what stands on it be shaded by it.
    let height = textureLoad(heights, vec2i(sample), 0).r - 0.5;
    let world = vec4f(place_m(f32(sample.x)), height, place_m(f32(sample.y)), 1.0);
    return view.shadow_from_world * world;
}
