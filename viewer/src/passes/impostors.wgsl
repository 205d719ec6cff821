// Trees that are far away: a rectangle around the tree's axis turns to the eye and shows the picture from the nearest of eight
// sides (`GSC_impostor`), lit as its leaves and branches are on average.

// Leaves whose normals are known of each template.
override LEAVES: u32;
// Rows of which a template's middle is known.
override ROWS: u32;
// The number by which tints know pictures from meshes.
override PICTURES_LEVEL: f32;
// Threads of a workgroup, and the most workgroups along one axis.
override GROUP: u32;
override MAX_GROUPS: u32;

@group(1) @binding(0) var<storage, read> trees: array<Tree>;
@group(1) @binding(1) var<storage, read> frames: array<Frame>;
@group(1) @binding(2) var colors: texture_2d_array<f32>;
@group(1) @binding(3) var reliefs: texture_2d_array<f32>;
@group(1) @binding(4) var<storage, read> visible: array<Visible>;
// What `leaf_light` is of each of them: for corners, and while it is worked out.
@group(1) @binding(5) var<storage, read> lights: array<vec3f>;
@group(1) @binding(6) var<storage, read_write> new_lights: array<vec3f>;
// The last is how many of `visible` are pictures.
@group(1) @binding(7) var<storage, read> counts: array<u32>;

// As in `cull.wgsl`.
struct Visible {
    tree: u32,
    lambda: f32,
    shown: u32,
}

// The pictures of a template, as `ImpostorData` in Rust.
struct Frame {
    axis: vec2f,
    size: vec2f,
    crown_middle: vec3f,
    low: f32,
    crown_half: vec3f,
    // How wide a leaf is.
    leaf_m: f32,
    // Of as many leaves as `LEAVES` in Rust, octahedral: the normal by which each is lit, and that by which the eye sees more or less of it.
    leaves: array<vec2u, 32>,
    // Where the tree's middle is in each row from the top, x and z from the axis.
    middles: array<vec2f, 32>,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    // The same in the template's space.
    @location(1) local: vec3f,
    @location(2) uv: vec2f,
    // Towards the eye in the template's space, level, of unit length; and what that is in the world.
    @location(3) @interpolate(flat) ahead: vec2f,
    @location(4) @interpolate(flat) toward: vec3f,
    // Direction of the eye in eighths of a turn, [0, 8]; number of the template.
    @location(5) @interpolate(flat) turn: f32,
    @location(6) @interpolate(flat) template_index: u32,
    // Which of its pixels are drawn.
    @location(7) @interpolate(flat) shown: vec2f,
    // Of the leaves that the eye sees, on average: how much sun falls on the side that it sees and on the other one, and how
    // far they face upwards.
    @location(8) @interpolate(flat) leaf_light: vec3f,
    // See `air_before`.
    @location(9) @interpolate(flat) air: vec4f,
    // Towards the eye and towards the sun in the template's space, of unit length.
    @location(10) @interpolate(flat) to_eye: vec3f,
    @location(11) @interpolate(flat) to_sun: vec3f,
    // By chance, [0, 1): another for each tree.
    @location(12) @interpolate(flat) chance: f32,
    // 1 beyond the field.
    @location(13) @interpolate(flat) is_beyond_field: f32,
}

// What `leaf` of `trees.wgsl` makes of the sun and of a leaf's normal. Directions are in the template's space.
fn light_of(template_index: u32, leaf: u32, to_eye: vec3f, to_sun: vec3f) -> vec3f {
    let normal = octahedral(unpack2x16snorm(frames[template_index].leaves[leaf].x));
    let toward_sun = dot(normal, to_sun);
    let lit = abs(toward_sun) * 0.75 + 0.25;
    let sides = select(vec2f(0.0, lit), vec2f(lit, 0.0), toward_sun * dot(normal, to_eye) > 0.0);
    return vec3f(sides, 0.5 + 0.5 * abs(normal.y));
}

// How much of a leaf the eye sees, as a share of its area.
fn share_of(template_index: u32, leaf: u32, to_eye: vec3f) -> f32 {
    return abs(dot(octahedral(unpack2x16snorm(frames[template_index].leaves[leaf].y)), to_eye));
}

// The light of all leaves, averaged by how much of each the eye sees.
fn leaf_light(template_index: u32, to_eye: vec3f, to_sun: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    var seen = 1e-6;
    for (var leaf = 0u; leaf < LEAVES; leaf++) {
        let share = share_of(template_index, leaf, to_eye);
        sum += share * light_of(template_index, leaf, to_eye, to_sun);
        seen += share;
    }
    return sum / seen;
}

// Towards the eye in a template's space, from the middle of its picture; as far as it is.
fn way_to_eye(rows: array<vec4f, 3>, template_index: u32) -> vec3f {
    let axis = frames[template_index].axis;
    let middle = vec3f(axis.x, frames[template_index].low + 0.5 * frames[template_index].size.y, axis.y);
    return way_to_template(rows, view.eye - from_template(rows, middle));
}

// Once for each of the trees that are visible: as a part of `vertex`, four times, it took a sixth of a frame in software.
@compute @workgroup_size(GROUP)
fn light_leaves(@builtin(global_invocation_id) id: vec3u) {
    let slot = id.x + id.y * MAX_GROUPS * GROUP;
    if (slot >= counts[arrayLength(&counts) - 1u]) {
        return;
    }
    let tree = visible[slot].tree;
    let rows = trees[tree].rows;
    let template_index = trees[tree].template_index;
    let to_eye = normalize(way_to_eye(rows, template_index));
    let to_sun = normalize(way_to_template(rows, view.sun_direction));
    new_lights[slot] = leaf_light(template_index, to_eye, to_sun);
}

// Four vertices for each of the trees that are visible.
@vertex
fn vertex(@builtin(vertex_index) vertex: u32) -> Out {
    let slot = vertex >> 2u;
    let tree = visible[slot].tree;
    let shown = visible[slot].shown;
    let index = vertex & 3u;
    let rows = trees[tree].rows;
    let template_index = trees[tree].template_index;
    let axis = frames[template_index].axis;
    let size = frames[template_index].size;
    let low = frames[template_index].low;
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    let back = way_to_eye(rows, template_index);
    let ahead = normalize(back.xz + vec2f(0.0, 1e-6));
    let across = vec3f(ahead.y, 0.0, -ahead.x) * ((corner.x - 0.5) * size.x);
    let local = vec3f(axis.x, low + corner.y * size.y, axis.y) + across;
    var out: Out;
    out.world = from_template(rows, local);
    out.clip = view.clip_from_world * vec4f(out.world, 1.0);
    out.local = local;
    out.uv = vec2f(corner.x, 1.0 - corner.y);
    out.ahead = ahead;
    out.toward = way_from_template(rows, vec3f(ahead.x, 0.0, ahead.y));
    out.turn = fract(atan2(ahead.x, ahead.y) / (2.0 * PI) + 1.0) * 8.0;
    out.template_index = template_index;
    out.shown = vec2f(vec2u(shown, shown >> 10u) & vec2u(1023u)) / 1023.0;
    out.air = air_before(out.world);
    out.to_eye = normalize(back);
    out.to_sun = normalize(way_to_template(rows, view.sun_direction));
    out.leaf_light = lights[slot];
    out.chance = scattered(vec2f(f32(tree), 5.3));
    out.is_beyond_field = select(0.0, 1.0, is_beyond_field(rows));
    return out;
}

// The light of the leaf at a place of a picture, `place` in leaves' widths: one of those that are known, of two that which shows
// more of itself to the eye more often. Single leaves gleam and are dark, also where all are of one size with the pixels; where
// they are smaller, and `sharp` less than 1, nearly their mean is seen.
fn one_leaf(in: Out, place: vec2f, sharp: f32) -> vec3f {
    let cell = floor(place);
    let first = min(u32(scattered(cell) * f32(LEAVES)), LEAVES - 1u);
    let second = min(u32(scattered(cell + 71.7) * f32(LEAVES)), LEAVES - 1u);
    let one = share_of(in.template_index, first, in.to_eye);
    let other = share_of(in.template_index, second, in.to_eye);
    let leaf = select(first, second, scattered(cell + 37.3) * (one + other) < other);
    return mix(in.leaf_light, light_of(in.template_index, leaf, in.to_eye, in.to_sun), sharp);
}

// The relief of a pixel is a mean: so far before it are the outermost leaves, which are not in their own shade.
const SHADOW_BIAS_M = 1.1;

// Leaves are as open as their corners are on average, which reach farther out than a pixel's mean; and those that are more open
// than others have more sun, too. By so much farther out a leaf would be that is as bright as all of them.
const OUTWARD = 1.08;

// How far the middle of a tree lies to the right, at a height, as a part of its picture's width: as it is seen from `ahead` beyond
// what the picture from a side shows.
fn shift(template_index: u32, v: f32, ahead: vec2f, side: u32) -> f32 {
    let row = clamp(v * f32(ROWS) - 0.5, 0.0, f32(ROWS - 1u));
    let first = u32(row);
    let above = frames[template_index].middles[first];
    let below = frames[template_index].middles[min(first + 1u, ROWS - 1u)];
    let middle = mix(above, below, row - f32(first));
    let angle = f32(side) * PI / 4.0;
    return dot(middle, vec2f(ahead.y - cos(angle), sin(angle) - ahead.x)) / frames[template_index].size.x;
}

fn pixel(in: Out, is_kept: bool) -> Pixel {
    // Half-way between two sides some places of the tree are seen from the one, some from the other.
    let part = smoothstep(0.35, 0.65, fract(in.turn));
    let place = floor(in.uv * 32.0);
    let side = u32(in.turn) + select(0u, 1u, scattered(place) < part);
    let beside = in.uv.x - shift(in.template_index, in.uv.y, in.ahead, side);
    // From behind it is its own mirror image.
    let u = clamp(select(beside, 1.0 - beside, (side & 4u) != 0u), 0.0, 1.0);
    let at = vec2f((f32(side & 3u) + u) * 0.25, in.uv.y);
    // By `uv`: `at` leaps from place to place.
    let moved = max(length(dpdx(in.uv)), length(dpdy(in.uv)));
    let level = log2(moved * f32(textureDimensions(colors).y)) + view.mip_bias;
    let seen = textureSampleLevel(colors, clamped, at, in.template_index, level);
    let relief = textureSampleLevel(reliefs, clamped, at, in.template_index, level).rgb;
    // The share of the pixel that the tree covers: leaves and twigs are smaller than it, and the sky shows between them.
    let samples = samples_of(relief.b, scattered_anew(floor(in.clip.xy) + 977.0 * in.chance));
    if (samples == 0u || !is_kept) {
        discard;
    }
    let before = (relief.r - 0.5) * frames[in.template_index].size.x;
    let local = in.local + vec3f(in.ahead.x, 0.0, in.ahead.y) * before;
    let world = in.world + in.toward * before;
    let albedo = select(seen.rgb, level_tint(PICTURES_LEVEL) * 0.5, view.tint_levels != 0u);

    let to_eye = normalize(view.eye - in.world);
    let cosine = dot(to_eye, view.sun_direction);
    let in_crown = (local - frames[in.template_index].crown_middle) / frames[in.template_index].crown_half;
    let open = openness(OUTWARD * in_crown);
    // As `leaf` and `bark` of `trees.wgsl`; bark averaged over all directions that face the eye.
    let through = albedo * vec3f(0.75, 0.9, 0.3);
    let facing = max(-cosine, 0.0);
    let glow = 0.6 * facing * facing * facing * facing * facing * facing;
    let leaf_m = frames[in.template_index].leaf_m;
    let at_leaf = in.uv * frames[in.template_index].size / leaf_m;
    let sharp = saturate(leaf_m * view.focal_px / distance(view.eye, in.world));
    let leaf = one_leaf(in, at_leaf, sharp);
    let leaf_sun = (albedo * 0.8 * leaf.x + through * (0.6 * leaf.y + glow)) * smoothstep(0.0, 0.7, open);
    // Where no shadow map tells, by what is between the place and the sun if it is leaves.
    let left = sun_through_crown(in_crown, in.to_sun / frames[in.template_index].crown_half);
    let shade = sun_visibility(world, SHADOW_BIAS_M) * mix(1.0, left, in.is_beyond_field * relief.g);
    let sun = mix(albedo * phase(cosine), leaf_sun, relief.g) * shade;
    let up = mix(0.5, leaf.z, relief.g);
    let ambient = ambient_light(up) * mix(0.8, 0.15 + 0.75 * open * open, relief.g);
    let radiance = (albedo * ambient + view.sun_irradiance * sun) / PI;
    return Pixel(vec4f(hazed(in.air, radiance), 1.0), samples);
}

@fragment
fn fragment(in: Out) -> Pixel {
    return pixel(in, is_shown(in.clip.xy, in.shown));
}

// As a lake mirrors it: what is above the water.
@fragment
fn mirrored(in: Out) -> Pixel {
    return pixel(in, in.world.y > view.water_level);
}
