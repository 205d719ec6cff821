// Trees that are far away: a rectangle around the tree's axis turns to the eye and shows the picture from the nearest of eight
// sides (`GSC_impostor`), lit as its leaves and branches are on average.

// Rows of which a template's middle is known.
override ROWS: u32;
// The number by which tints know pictures from meshes.
override PICTURES_LEVEL: f32;

@group(1) @binding(0) var<storage, read> trees: array<Tree>;
@group(1) @binding(1) var<storage, read> frames: array<Frame>;
@group(1) @binding(2) var colors: texture_2d_array<f32>;
@group(1) @binding(3) var reliefs: texture_2d_array<f32>;
@group(1) @binding(4) var<storage, read> visible: array<Visible>;
// How leaves are lit, by the cosine of the angle between eye and sun as seen from above and by the sine of the eye's height: what
// `entry` of `leaf_light.rs` says.
@group(1) @binding(5) var leaf_lights: texture_2d_array<f32>;

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
    // Where the tree's middle is in each row from the top, x and z from the axis.
    middles: array<vec2f, 32>,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    // The same in the space in which the ellipsoid around the leaves is a sphere of radius 1.
    @location(1) in_crown: vec3f,
    @location(2) uv: vec2f,
    // Towards the eye, level, as far as the picture is wide: in the world and in that space.
    @location(3) @interpolate(flat) toward: vec3f,
    @location(4) @interpolate(flat) toward_in_crown: vec3f,
    // Towards the sun in that space, of unit length.
    @location(5) @interpolate(flat) sun_in_crown: vec3f,
    // Between which of the eight sides one looks: the first, and how much of the next is seen.
    @location(6) @interpolate(flat) side: u32,
    @location(7) @interpolate(flat) next: f32,
    // For either side, what to take of `middles` for how far to the right they are, as parts of the picture's width.
    @location(8) @interpolate(flat) aside: vec4f,
    @location(9) @interpolate(flat) template_index: u32,
    // Which of its pixels are drawn; a number by chance, [0, 1), another for each tree.
    @location(10) @interpolate(flat) shown: vec3f,
    // See `leaf_lights`.
    @location(11) @interpolate(flat) leaf: vec4f,
    // How many leaves the picture is wide and high; how many pixels a leaf is wide, at most 1.
    @location(12) @interpolate(flat) leaves: vec3f,
    // See `air_before`.
    @location(13) @interpolate(flat) air: vec4f,
    // What is seen of the sun's light by bark, averaged over all directions that face the eye, and through leaves.
    @location(14) @interpolate(flat) sun: vec3f,
}

// What to take of a place beside the axis, x and z, for how far it is to the right as it is seen from `ahead` beyond what the picture
// from a side shows.
fn aside(ahead: vec2f, side: u32) -> vec2f {
    let angle = f32(side) * PI / 4.0;
    return vec2f(ahead.y - cos(angle), sin(angle) - ahead.x);
}

// Four vertices for each of the trees that are visible.
@vertex
fn vertex(@builtin(vertex_index) vertex: u32) -> Out {
    let slot = vertex >> 2u;
    let tree = visible[slot].tree;
    let shown = visible[slot].shown;
    let index = vertex & 3u;
    let rows = trees[tree].rows;
    let template_index = trees[tree].template_and_sun & 0xFFFFu;
    let axis = frames[template_index].axis;
    let size = frames[template_index].size;
    let low = frames[template_index].low;
    let crown_half = frames[template_index].crown_half;
    let leaf_m = frames[template_index].leaf_m;
    // Towards the eye in the template's space, from the middle of the picture; as far as it is.
    let middle = from_template(rows, vec3f(axis.x, low + 0.5 * size.y, axis.y));
    let way = view.eye - middle;
    let away = length(way);
    let back = way_to_template(rows, way);
    let ahead = normalize(back.xz + vec2f(0.0, 1e-6));
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    let across = vec3f(ahead.y, 0.0, -ahead.x) * ((corner.x - 0.5) * size.x);
    let local = vec3f(axis.x, low + corner.y * size.y, axis.y) + across;
    let toward = vec3f(ahead.x, 0.0, ahead.y) * size.x;
    let to_eye = normalize(back);
    let to_sun = way_to_template(rows, view.sun_direction);
    let turn = fract(atan2(ahead.x, ahead.y) / (2.0 * PI) + 1.0) * 8.0;
    let side = u32(turn);
    var out: Out;
    out.world = from_template(rows, local);
    out.clip = view.clip_from_world * vec4f(out.world, 1.0);
    out.in_crown = (local - frames[template_index].crown_middle) / crown_half;
    out.uv = vec2f(corner.x, 1.0 - corner.y);
    out.toward = way_from_template(rows, toward);
    out.toward_in_crown = toward / crown_half;
    out.sun_in_crown = normalize(to_sun / crown_half);
    out.side = side;
    // Half-way between two sides some places of the tree are seen from the one, some from the other.
    out.next = smoothstep(0.35, 0.65, fract(turn));
    out.aside = vec4f(aside(ahead, side), aside(ahead, side + 1u)) / size.x;
    out.template_index = template_index;
    let chance = scattered(vec2f(f32(tree), 5.3));
    let edges = vec2f(vec2u(shown, shown >> 10u) & vec2u(1023u)) / 1023.0;
    out.shown = vec3f(edges, chance);
    let from_sun = dot(ahead, normalize(to_sun.xz + vec2f(0.0, 1e-6)));
    let at = 0.5 + 0.5 * vec2f(from_sun, to_eye.y);
    out.leaf = textureSampleLevel(leaf_lights, clamped, at, template_index, 0.0);
    out.leaves = vec3f(size / leaf_m, saturate(leaf_m * view.focal_px / away));
    out.air = air_before(out.world);
    let cosine = dot(way / away, view.sun_direction);
    out.sun = vec3f(phase(cosine), glow(cosine), sun_past_land(rows, trees[tree].template_and_sun));
    return out;
}

// The light of the leaf at a place of a picture, `place` in leaves' widths: how much sun falls on the side that the eye sees and on
// the other one. Single leaves gleam and are dark, also where all are of one size with the pixels; where they are smaller, and
// `sharp` less than 1, nearly their mean is seen. A leaf that lies by chance meets the sun at each cosine equally often, and so
// gets from 0.4 to 1.6 times the mean: see `entry` of `leaf_light.rs`.
fn one_leaf(leaf: vec4f, place: vec2f, sharp: f32) -> vec2f {
    let number = scattered(floor(place));
    let is_front = number < leaf.x;
    let part = select((number - leaf.x) / (1.0 - leaf.x), number / leaf.x, is_front);
    let one = select(vec2f(0.0, leaf.z), vec2f(leaf.y, 0.0), is_front) * (0.4 + 1.2 * part);
    return mix(vec2f(leaf.x * leaf.y, (1.0 - leaf.x) * leaf.z), one, sharp);
}

// The relief of a pixel is a mean: so far before it are the outermost leaves, which are not in their own shade.
const SHADOW_BIAS_M = 1.1;

// Leaves are as open as their corners are on average, which reach farther out than a pixel's mean; and those that are more open
// than others have more sun, too. By so much farther out a leaf would be that is as bright as all of them.
const OUTWARD = 1.08;

// How far the middle of a tree lies to the right, at a height, as a part of its picture's width: see `aside`.
fn shift(template_index: u32, v: f32, aside: vec2f) -> f32 {
    let row = clamp(v * f32(ROWS) - 0.5, 0.0, f32(ROWS - 1u));
    let first = u32(row);
    let above = frames[template_index].middles[first];
    let below = frames[template_index].middles[min(first + 1u, ROWS - 1u)];
    return dot(mix(above, below, row - f32(first)), aside);
}

// The sun that is left at a place of a tree of the field: the shadow map tells. Beyond the field what is between the place and the sun
// does, if it is leaves. Either is much of what a pixel takes, so each kind of tree has a draw that leaves the other out.
fn sun_left(in: Out, world: vec3f, in_crown: vec3f, leafy: f32, is_beyond: bool) -> f32 {
    if (is_beyond) {
        return mix(1.0, sun_through_crown(in_crown, in.sun_in_crown), leafy);
    }
    return sun_visibility(world, SHADOW_BIAS_M);
}

// `is_beyond` is a constant of its entry point.
fn pixel(in: Out, is_kept: bool, is_beyond: bool) -> Pixel {
    let is_next = scattered(floor(in.uv * 32.0)) < in.next;
    let side = in.side + select(0u, 1u, is_next);
    let beside = in.uv.x - shift(in.template_index, in.uv.y, select(in.aside.xy, in.aside.zw, is_next));
    // From behind it is its own mirror image.
    let u = clamp(select(beside, 1.0 - beside, (side & 4u) != 0u), 0.0, 1.0);
    let at = vec2f((f32(side & 3u) + u) * 0.25, in.uv.y);
    // By `uv`: `at` leaps from place to place.
    let moved = max(length(dpdx(in.uv)), length(dpdy(in.uv)));
    let level = log2(moved * f32(textureDimensions(colors).y)) + view.mip_bias;
    let seen = textureSampleLevel(colors, clamped, at, in.template_index, level).rgb;
    let relief = textureSampleLevel(reliefs, clamped, at, in.template_index, level).rgb;
    // The share of the pixel that the tree covers: leaves and twigs are smaller than it, and the sky shows between them.
    let samples = samples_of(relief.b, scattered_anew(floor(in.clip.xy) + 977.0 * in.shown.z));
    if (samples == 0u || !is_kept) {
        discard;
    }
    let before = relief.r - 0.5;
    let world = in.world + in.toward * before;
    let in_crown = in.in_crown + in.toward_in_crown * before;
    let albedo = select(albedo_of(seen), level_tint(PICTURES_LEVEL) * 0.5, view.tint_levels != 0u);

    let open = openness(OUTWARD * in_crown);
    // As `leaf` and `bark` of `trees.wgsl`.
    let through = albedo * vec3f(0.75, 0.9, 0.3);
    let leaf = one_leaf(in.leaf, in.uv * in.leaves.xy, in.leaves.z);
    let outward = outwardness(open);
    let leaf_sun = (albedo * 0.8 * leaf.x + through * (0.6 * leaf.y + in.sun.y)) * outward;
    var sun = mix(albedo * in.sun.x, leaf_sun, relief.g) * sun_left(in, world, in_crown, relief.g, is_beyond);
    sun += by_way_of_others(albedo, outward) * (relief.g * in.sun.z);
    let up = mix(0.5, in.leaf.w, relief.g);
    let ambient = ambient_light(up) * mix(0.8, 0.15 + 0.75 * open * open, relief.g);
    let radiance = (albedo * ambient + view.sun_irradiance * sun) / PI;
    return Pixel(vec4f(hazed(in.air, radiance), 1.0), samples);
}

@fragment
fn field(in: Out) -> Pixel {
    return pixel(in, is_shown(in.clip.xy, in.shown.xy), false);
}

@fragment
fn beyond(in: Out) -> Pixel {
    return pixel(in, is_shown(in.clip.xy, in.shown.xy), true);
}

// As a lake mirrors it: what is above the water.
@fragment
fn mirrored_field(in: Out) -> Pixel {
    return pixel(in, in.world.y > view.water_level, false);
}

@fragment
fn mirrored_beyond(in: Out) -> Pixel {
    return pixel(in, in.world.y > view.water_level, true);
}
