// What all passes share: the view, the light, aerial perspective. Right-handed, y up, metres; reversed depth.

struct View {
    clip_from_world: mat4x4f,
    // Directions of the world from clip space; the eye is the origin.
    ray_from_clip: mat4x4f,
    shadow_from_world: mat4x4f,
    eye: vec3f,
    time_s: f32,
    // Towards the sun.
    sun_direction: vec3f,
    sun_angular_radius: f32,
    sun_irradiance: vec3f,
    exposure: f32,
    sky_irradiance: vec3f,
    haze_extinction: f32,
    // Surface of the lake; far below everything if there is none.
    water_level: f32,
    // How much of a sea it is, 0 to 1.
    sea: f32,
    // Pixels that one radian covers in the middle of the picture.
    focal_px: f32,
    // 1 if colours say the level of detail. For `select`: no `if` or loop may depend on a uniform buffer alone, or Mesa's
    // software driver (22.3) compiles the shader for each draw and leaks it.
    tint_levels: u32,
    // How much is seen of the clouds that `drift` names last, 0 to ½.
    other_clouds: f32,
    // Pixels a radian for each pixel by which the land may be off.
    lod_pixels: f32,
    // Moves numbers by chance, [0, 1): another in each of the pictures of which a still one is the mean.
    noise: f32,
    // Added to the mip levels of textures that cover much of the picture: less than 0 in those pictures, whose mean is as smooth.
    mip_bias: f32,
    // Altitude and extent in metres of the cumulus layer, then of the cirrus layer; extent 0 if there is none.
    clouds: vec4f,
    // How far clouds have drifted, x and z in metres: those that are seen more of, and those into or out of which they fade.
    drift: vec4f,
    // The eye for which levels of detail are chosen: that of the walker, also when one looks on from above.
    lod_eye: vec3f,
    // How far it is above the highest land.
    lod_above: f32,
    // Samples a side, metres between them, half the extent in metres, height of the highest land.
    field: vec4f,
    // Where `near_shade` lies: its middle as x and z, how wide it is in metres, and 1 if it is known, or else 0.
    shade: vec4f,
    // Kinds of ground: linear colour on average, and metres that a tile of its texture covers.
    ground_kinds: array<vec4f, 5>,
    // Of the field, on average, linear.
    ground_albedo: vec3f,
    // Up to so many metres away turf lies in the shade of blades of grass; 0 where none are drawn.
    turf_m: f32,
    // The terrain's greatest level.
    lod_top: f32,
    // Sides of the picture as a part of full resolution.
    part: f32,
    // Up to so many metres the terrain's blocks have level 0.
    lod_unit: f32,
    // Fills the row of four.
    unused: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var repeating: sampler;
@group(0) @binding(2) var clamped: sampler;
@group(0) @binding(3) var sky_cube: texture_cube<f32>;
// The cloudless sky down to the horizon, which is all around the edge: see `on_dome`.
@group(0) @binding(4) var clear_dome: texture_2d<f32>;
@group(0) @binding(5) var cumulus_layer: texture_2d<f32>;
@group(0) @binding(6) var cirrus_layer: texture_2d<f32>;
@group(0) @binding(7) var shadow_map: texture_depth_2d;
@group(0) @binding(8) var nearest: sampler;
@group(0) @binding(9) var heights: texture_2d<f32>;
@group(0) @binding(10) var light_map: texture_2d<f32>;
@group(0) @binding(12) var near_shade: texture_2d<f32>;

// A tree, as `TreeData` in Rust.
struct Tree {
    // World from the template's space, by rows.
    rows: array<vec4f, 3>,
    // Number of its template, and the share of the sun that the land around leaves, as halves.
    template_and_sun: u32,
    // Greatest singular value of its linear part.
    scale: f32,
    // Of the ellipsoid around its leaves, in the template's space, as halves: height of its middle, semi-axes; 0 if there
    // is none.
    crown: vec2u,
}

// What a part of a tree is made of, as `MaterialUniform` in Rust.
struct Material {
    factor: vec4f,
    alpha_cutoff: f32,
    has_normal: f32,
    unused: vec2f,
}

// A point of a template in the world.
fn from_template(rows: array<vec4f, 3>, point: vec3f) -> vec3f {
    let local = vec4f(point, 1.0);
    return vec3f(dot(rows[0], local), dot(rows[1], local), dot(rows[2], local));
}

// A direction of a template in the world; as long as it becomes.
fn way_from_template(rows: array<vec4f, 3>, way: vec3f) -> vec3f {
    return vec3f(dot(rows[0].xyz, way), dot(rows[1].xyz, way), dot(rows[2].xyz, way));
}

// A normal of a template in the world, of any length: normals take the cofactors of the linear part, whose rows are crosses of
// its rows.
fn normal_from_template(rows: array<vec4f, 3>, normal: vec3f) -> vec3f {
    return vec3f(
        dot(cross(rows[1].xyz, rows[2].xyz), normal),
        dot(cross(rows[2].xyz, rows[0].xyz), normal),
        dot(cross(rows[0].xyz, rows[1].xyz), normal),
    );
}

const PI: f32 = 3.14159265;

// How much light comes through leaves, as a part of the sun's, to an eye that looks against it: by the cosine of the angle between eye
// and sun.
fn glow(cosine: f32) -> f32 {
    let facing = max(-cosine, 0.0);
    return 0.6 * facing * facing * facing * facing * facing * facing;
}

// The albedo that a texel says, which is its root (`ImageUse::Albedo`).
fn albedo_of(texel: vec3f) -> vec3f {
    return texel * texel;
}

// Where `clear_dome` has a direction, up to a factor, that is not downwards: Meyer's octahedron (2010), of which the upper half is a square.
// Its corners are the axes, and the middles of the outermost texels its edge.
fn on_dome(way: vec3f) -> vec2f {
    let flat = way.xz / (abs(way.x) + way.y + abs(way.z));
    let size = f32(textureDimensions(clear_dome).x);
    return 0.5 + vec2f(flat.x + flat.y, flat.x - flat.y) * (0.5 - 0.5 / size);
}

// Of that direction or, if it is downwards, the horizon below which it is: any of it straight down. Software takes less time for this
// than for a cube.
fn clear_sky(way: vec3f) -> vec3f {
    let above = vec3f(way.x + 1e-4, max(way.y, 0.0), way.z);
    return textureSampleLevel(clear_dome, clamped, on_dome(above), 0.0).rgb;
}

// The light of endless haze in a direction: that of the cloudless sky at the horizon, brighter towards the sun, so that land
// fades into the sky behind it.
fn haze_towards(way: vec3f) -> vec3f {
    return clear_sky(vec3f(way.x, 0.0, way.z));
}

// Aerial perspective: the haze's own light before a place in the world, and the share of that place's light that comes through.
fn air_before(world: vec3f) -> vec4f {
    let way = world - view.eye;
    let clear = exp(-length(way) * view.haze_extinction);
    return vec4f(haze_towards(way) * (1.0 - clear), clear);
}

// Light as it is seen through that. Plants give their vertices the air: it changes little across so small a triangle, and a shader of
// pixels runs for whole blocks of them however small one is. Land is asked for it by the pixel: its triangles may span the
// glow around a low sun, or be slivers beyond whose edge, where a pixel's middle may lie, what is interpolated is any number.
fn hazed(air: vec4f, radiance: vec3f) -> vec3f {
    return radiance * air.a + air.rgb;
}

// How much light is lost on the way through half of a crown.
const CROWN_DENSITY: f32 = 0.8;

// Whether a tree stands beyond the field, of which the shadow map doesn't tell.
fn is_beyond_field(rows: array<vec4f, 3>) -> bool {
    return max(abs(rows[0].w), abs(rows[2].w)) > view.field.z;
}

// Sunlight that is left on its way through a crown to a place in it, both as in the space where the crown is a sphere of radius 1
// around the origin, `to_sun` of unit length (Beer and Lambert).
fn sun_through_crown(place: vec3f, to_sun: vec3f) -> f32 {
    let along = dot(place, to_sun);
    let way = sqrt(along * along + max(1.0 - dot(place, place), 0.0)) - along;
    return exp(-CROWN_DENSITY * way);
}

// How bright a colour is, by the weights of Rec. 709.
fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// How far out of a crown a leaf is, by how open it is: 0 where no sun comes straight, 1 where nothing is before it.
fn outwardness(open: f32) -> f32 {
    return smoothstep(0.0, 0.7, open);
}

// The part of the sun on a crown that a leaf gives back after two others did: next to nothing of it among green ones, but the
// inside of a tree in blossom is bright. What is outside has less around it.
fn by_way_of_others(albedo: vec3f, outwardness: f32) -> vec3f {
    let bright = luminance(albedo);
    return albedo * (1.2 * bright * bright * (1.0 - 0.7 * outwardness));
}

// The share of the sun that the land leaves to a tree, where its foot is: the light map tells in the field. For vertices.
fn sun_past_land(rows: array<vec4f, 3>, template_and_sun: u32) -> f32 {
    let foot = field_uv(vec2f(rows[0].w, rows[2].w));
    let beyond = unpack2x16unorm(template_and_sun).y;
    return select(textureSampleLevel(light_map, clamped, foot, 0.0).b, beyond, is_beyond_field(rows));
}

// The rows of the linear part, weighted, are its transpose: for what is turned and scaled alike, the way back.
fn way_to_template(rows: array<vec4f, 3>, way: vec3f) -> vec3f {
    return rows[0].xyz * way.x + rows[1].xyz * way.y + rows[2].xyz * way.z;
}

// Irradiance from the sky above and the ground below on what faces upwards by that share of the way from straight down to
// straight up, where as much of the sun and of the sky arrives.
fn light_around(up: f32, sun: f32, sky: f32) -> vec3f {
    return mix(light_from_ground(sun, sky), view.sky_irradiance * sky, up);
}

// The part of it that the ground gives back, on what faces straight down.
fn light_from_ground(sun: f32, sky: f32) -> vec3f {
    let on_ground = view.sun_irradiance * (sun * max(view.sun_direction.y, 0.0)) + view.sky_irradiance * sky;
    return view.ground_albedo * on_ground;
}

// The same in the open: what a crown among other crowns gets on average.
fn ambient_light(up: f32) -> vec3f {
    return light_around(up, 1.0, 1.0);
}

// Share of the open sky and ground that leaves see between their neighbours, by their place within the ellipsoid around the
// crown, a sphere of radius 1: little in its middle, much at its surface and top.
fn openness(place: vec3f) -> f32 {
    let outside = clamp((length(place) - 0.15) / 0.85, 0.0, 1.0);
    return 0.12 + 0.7 * outside + 0.18 * clamp(0.5 + 0.5 * place.y, 0.0, 1.0);
}

// A number in [0, 1) for each pixel, evenly spread among neighbours: interleaved gradient noise (Jimenez 2014).
fn dither(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))) + view.noise);
}

// Whether a pixel belongs to a share of all: those with a number of `dither` from the first to below the second, which counts
// as beyond all numbers where it is 1.
fn is_shown(pixel: vec2f, shown: vec2f) -> bool {
    let number = dither(pixel);
    return number >= shown.x && (number < shown.y || shown.y == 1.0);
}

// Light of a pixel, and the samples that it is for.
struct Pixel {
    @location(0) radiance: vec4f,
    @builtin(sample_mask) samples: u32,
}

// Which samples of a pixel show what covers a share of it: of four so many, of one now and then.
fn samples_of(share: f32, noise: f32) -> u32 {
    let is_covered = vec4f(share) > fract(vec4f(noise) + vec4f(0.0, 0.25, 0.5, 0.75));
    return dot(select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), is_covered), vec4u(1u));
}

// Which samples of a pixel a texture covers where its alpha is at least the cutoff: the edge runs straight through the pixel, at a
// distance that alpha and its slope tell (Golus, "Anti-aliased Alpha Test: The Esoteric Alpha To Coverage", 2017). Steeper slopes
// are those of a leaf smaller than a pixel, beside which there is nothing. One sample in four is covered from an eighth on.
fn cut_out(alpha: f32, cutoff: f32) -> u32 {
    let slope = length(vec2f(dpdx(alpha), dpdy(alpha)));
    return samples_of(saturate((alpha - cutoff) / clamp(slope, 1e-4, 0.5) + 0.5), 0.375);
}

// Of the light that falls on a matt surface in all directions, what an eye sees of it receives so much on average; the cosine
// is that of the angle between light and eye.
fn phase(cosine: f32) -> f32 {
    let c = clamp(cosine, -1.0, 1.0);
    let angle = acos(c);
    return 2.0 / (3.0 * PI) * (sqrt(1.0 - c * c) + (PI - angle) * c);
}

// A number in [0, 1) by chance, for each cell of a grid (Hoskins, "Hash without sine", 2014).
fn scattered(cell: vec2f) -> f32 {
    var p = fract(cell.xyx * 0.1031);
    p += dot(p, p.yzx + 33.33);
    return fract((p.x + p.y) * p.z);
}

// The same in each of the pictures of which a still one is the mean: each time as far on as others of its cell, once around in all, so
// that what covers a share is covered in as many of them. By an odd number of steps, which differs from cell to cell: else it
// would be hidden in all of them or in none by what lies before it and covers a share, too.
fn scattered_anew(cell: vec2f) -> f32 {
    let odd = 2.0 * floor(8.0 * scattered(cell + 19.3)) + 1.0;
    return fract(scattered(cell) + odd * view.noise);
}

// Whether a card shows its picture there: a triangle that holds all of it reaches beyond.
fn is_on_picture(uv: vec2f) -> bool {
    return all(uv == saturate(uv));
}

// 1 where the sun reaches a point, 0 in shadow: in that of what lies more than `bias_m` before it. Shade sets in over a stretch
// as long, half of it farther and half of it nearer than that: at one distance it would have a straight edge across each leaf
// that leads there. To its sides it has an edge a texel wide.
fn sun_visibility(world: vec3f, bias_m: f32) -> f32 {
    let shadow = view.shadow_from_world * vec4f(world, 1.0);
    let uv = shadow.xy * vec2f(0.5, -0.5) + 0.5;
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) || shadow.z > 1.0 || shadow.z < 0.0) {
        return 1.0;
    }
    // From the lower left on against the clock.
    let four = textureGather(shadow_map, nearest, uv);
    let columns = view.shadow_from_world;
    let depth_per_m = -dot(vec3f(columns[0].z, columns[1].z, columns[2].z), view.sun_direction);
    let lit = saturate(1.5 - (shadow.z - four) / (depth_per_m * bias_m));
    return between(lit, uv, textureDimensions(shadow_map));
}

// What is at a place of a texture of that size between the values of four texels, as `textureGather` orders them.
fn between(four: vec4f, uv: vec2f, size: vec2u) -> f32 {
    let part = fract(uv * vec2f(size) - 0.5);
    let sides = mix(four.wx, four.zy, part.x);
    return mix(sides.x, sides.y, part.y);
}

// From how far on the shade of near trees on the ground begins to be that of the light map, and from where on it is; metres.
const NEAR_SHADE_M = vec2f(32.0, 44.0);

// Where a place on the ground is in `near_shade`, and how much that counts there instead of the light map.
fn near_shade_at(place: vec2f) -> vec3f {
    let at = (place - view.shade.xy) / view.shade.z;
    let inside = 1.0 - smoothstep(0.42, 0.46, length(at));
    let near = 1.0 - smoothstep(NEAR_SHADE_M.x, NEAR_SHADE_M.y, distance(place, view.lod_eye.xz));
    return vec3f(at + 0.5, view.shade.w * inside * near);
}

// `light_map` at a place on the ground, with its shade of trees in G and B; for vertices.
fn light_on(place: vec2f) -> vec4f {
    let light = textureSampleLevel(light_map, clamped, field_uv(place), 0.0);
    let near = near_shade_at(place);
    let shade = mix(light.a, textureSampleLevel(near_shade, clamped, near.xy, 1.0).r, near.z);
    return vec4f(light.r, light.gb * shade, shade);
}

// The part of the light that water mirrors, by the cosine of the angle from which one looks: Schlick's approximation (1994).
fn mirrored_by_water(cosine: f32) -> f32 {
    return 0.02 + 0.98 * pow(1.0 - cosine, 5.0);
}

// The corners of one triangle that covers the picture.
fn corner_of_picture(index: u32) -> vec2f {
    return vec2f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
}

// Place of a sample's line in the world.
fn place_m(line: f32) -> f32 {
    return (line - 0.5 * (view.field.x - 1.0)) * view.field.y;
}

// Texture coordinates of the pictures that cover the field once.
fn field_uv(world: vec2f) -> vec2f {
    return world / (2.0 * view.field.z) + 0.5;
}

// The four samples around a place: their heights (north-west, north-east, south-west, south-east), the number of the first, and
// how far the place is on the way from it to the others.
struct Cell {
    heights: vec4f,
    number: vec2i,
    part: vec2f,
}

fn cell_at(world: vec2f) -> Cell {
    let last = view.field.x - 1.0;
    let at = clamp(world / view.field.y + 0.5 * last, vec2f(0.0), vec2f(last));
    let cell = min(floor(at), vec2f(last - 1.0));
    let c = vec2i(cell);
    let nw = textureLoad(heights, c, 0).r;
    let ne = textureLoad(heights, c + vec2i(1, 0), 0).r;
    let sw = textureLoad(heights, c + vec2i(0, 1), 0).r;
    let se = textureLoad(heights, c + vec2i(1, 1), 0).r;
    return Cell(vec4f(nw, ne, sw, se), c, at - cell);
}

// Bilinear height of the land.
fn height_m(world: vec2f) -> f32 {
    let cell = cell_at(world);
    let sides = mix(cell.heights.xz, cell.heights.yw, cell.part.x);
    return mix(sides.x, sides.y, cell.part.y);
}

// Height of the land as its triangles have it at full resolution: the diagonals of cells take turns.
fn drawn_height_m(world: vec2f) -> f32 {
    let cell = cell_at(world);
    let p = cell.part;
    let h = cell.heights;
    if (((cell.number.x + cell.number.y) & 1) == 0) {
        // North-west to south-east.
        return select(h.x + p.x * (h.y - h.x) + p.y * (h.w - h.y), h.x + p.y * (h.z - h.x) + p.x * (h.w - h.z), p.y > p.x);
    }
    if (p.x + p.y < 1.0) {
        return h.x + p.x * (h.y - h.x) + p.y * (h.z - h.x);
    }
    return h.w + (1.0 - p.x) * (h.z - h.w) + (1.0 - p.y) * (h.y - h.w);
}

// Wind that comes in gusts and bends the top of a plant by so many times its height.
fn wind(place: vec2f, own: f32) -> vec2f {
    let along = dot(place, vec2f(0.91, 0.41));
    let across = dot(place, vec2f(-0.41, 0.91));
    let gust = 0.5 + 0.5 * sin(0.23 * along + 0.9 * sin(0.11 * across) - 1.1 * view.time_s);
    let flutter = sin(3.1 * view.time_s + 6.283 * own + 1.7 * along);
    return vec2f(0.91, 0.41) * (0.30 * gust + 0.07 * flutter * (0.4 + gust));
}

// A direction from two signed numbers (Meyer et al. 2010).
fn octahedral(packed: vec2f) -> vec3f {
    var n = vec3f(packed, 1.0 - abs(packed.x) - abs(packed.y));
    let t = max(-n.z, 0.0);
    n.x -= select(-t, t, n.x >= 0.0);
    n.y -= select(-t, t, n.y >= 0.0);
    return normalize(n);
}

// The way that a mesh has gone to the next level. It stands for most of its band, since its triangles are paid for as long as
// any of it is drawn, and goes over in the rest.
const MORPHS_FROM = 0.6;

fn morphed(lambda: f32) -> f32 {
    return max((fract(lambda) - MORPHS_FROM) / (1.0 - MORPHS_FROM), 0.0);
}

// A colour for each level of detail.
fn level_tint(level: f32) -> vec3f {
    let phase = level * 2.4;
    return 0.55 + 0.45 * cos(vec3f(phase, phase + 2.1, phase + 4.2));
}

// Where a cloud that is seen in `direction` was painted before it drifted by `moved` metres.
fn before_drift(direction: vec3f, moved: vec2f) -> vec3f {
    let away = max(view.clouds.x, 400.0) / max(direction.y, 0.02);
    let place = direction.xz * away - moved;
    return normalize(vec3f(place.x, direction.y * away, place.y));
}

// Two random numbers of a lattice's point, -1 to 1: PCG (Jarzynski and Olano 2020).
fn random_pair(point: vec2f) -> vec2f {
    var v = vec2u(vec2i(point)) * 1664525u + 1013904223u;
    v += vec2u(v.y, 0u) * 1664525u;
    v += vec2u(0u, v.x) * 1664525u;
    v ^= v >> vec2u(16u);
    v += vec2u(v.y, 0u) * 1664525u;
    v += vec2u(0u, v.x) * 1664525u;
    return vec2f(v >> vec2u(16u)) / 32767.5 - 1.0;
}

fn noise_pair(place: vec2f) -> vec2f {
    let corner = floor(place);
    let part = smoothstep(vec2f(0.0), vec2f(1.0), place - corner);
    let near = mix(random_pair(corner), random_pair(corner + vec2f(1.0, 0.0)), part.x);
    let far = mix(random_pair(corner + vec2f(0.0, 1.0)), random_pair(corner + vec2f(1.0, 1.0)), part.x);
    return mix(near, far, part.y);
}

// How far edges of clouds are frayed, in texels of the painted sky. Displacements that differ by more than the way between two
// places would tear clouds into shreds, so finer ones are smaller, as billows are.
const FRAYED: f32 = 1.6;

// A direction beside, by about a texel of the painted sky: its clouds, magnified, get edges finer than its texels. Where a
// pixel covers a texel there is nothing to add.
fn frayed(direction: vec3f) -> vec3f {
    let texels = f32(textureDimensions(sky_cube).x) / 2.0;
    // Lambert's azimuthal projection, in texels: alike in all directions up to the horizon, below which there is haze alone.
    let place = direction.xz * (1.2 * texels * inverseSqrt(1.0 + max(direction.y, 0.0)));
    let beside = noise_pair(place / 4.3) + 0.6 * noise_pair(place / 1.9 + 17.0) + 0.32 * noise_pair(place / 0.83 + 31.0);
    let right = normalize(vec3f(direction.z, 0.0, -direction.x) + vec3f(1e-4, 0.0, 0.0));
    // Around the sun the clear sky, which is taken from the painted one, changes within a texel.
    let beside_sun = smoothstep(0.9990, 0.9900, dot(direction, view.sun_direction));
    let reach = FRAYED / texels * smoothstep(0.7, 1.8, view.focal_px / texels) * beside_sun;
    return direction + (right * beside.x + cross(direction, right) * beside.y) * reach;
}

// What clouds that stand still add to the clear sky, or take from it.
fn painted_clouds(direction: vec3f, are_frayed: bool, mip: f32) -> vec3f {
    var there = direction;
    if (are_frayed) {
        there = frayed(direction);
    }
    return textureSampleLevel(sky_cube, clamped, there, mip).rgb - clear_sky(there);
}

// How much of the way that clouds drift is seen in a direction: at the horizon they stand still.
fn drifting(direction: vec3f) -> f32 {
    return smoothstep(0.005, 0.06, direction.y);
}

// What all clouds that are seen add to the clear sky, or take from it. A loop, because Mesa's software driver leaves a loop early but takes both ways of an `if`.
fn clouds_towards(direction: vec3f, are_frayed: bool, mip: f32) -> vec3f {
    let lift = drifting(direction);
    let other = select(view.other_clouds, 0.0, lift <= 0.0);
    let copies = select(1, 2, other > 0.0);
    var radiance = vec3f(0.0);
    for (var copy = 0; copy < copies; copy++) {
        let share = select(other, 1.0 - other, copy == 0);
        let moved = select(view.drift.zw, view.drift.xy, copy == 0) * lift;
        radiance += share * painted_clouds(before_drift(direction, moved), are_frayed, mip);
    }
    return radiance;
}

fn layer_alpha(image: texture_2d<f32>, direction: vec3f, altitude: f32, extent: f32, moved: vec2f) -> f32 {
    let place = direction.xz * altitude / max(direction.y, 0.02) - moved;
    let alpha = textureSampleLevel(image, repeating, place / max(extent, 1.0), 0.0).a;
    return select(0.0, alpha, extent > 0.0);
}

// Share of the sun's disc that clouds let through which have drifted so far.
fn clearness(moved: vec2f) -> f32 {
    let low = layer_alpha(cumulus_layer, view.sun_direction, view.clouds.x, view.clouds.y, moved);
    let high = layer_alpha(cirrus_layer, view.sun_direction, view.clouds.z, view.clouds.w, moved);
    return (1.0 - low) * (1.0 - 0.7 * high);
}

fn sun_clearness() -> f32 {
    return mix(clearness(view.drift.xy), clearness(view.drift.zw), view.other_clouds);
}

// What a tiling texture of the ground says: a factor on the colour, and a normal of the texture's.
struct Tiles {
    factor: vec3f,
    bump: vec3f,
}

// What a texel of `details` says. Ground varies between dark and light and between warm and cool, never between green and
// purple: so green follows from red and blue, and colour and normal are one look at a texture instead of two.
fn tiles_of(texel: vec4f) -> Tiles {
    let tone = texel.rg * (255.0 / 128.0);
    let bump = texel.ba * 2.0 - 1.0;
    return Tiles(
        vec3f(tone.x, dot(tone, vec2f(0.6, 0.4)), tone.y),
        vec3f(bump, sqrt(saturate(1.0 - dot(bump, bump)))),
    );
}
