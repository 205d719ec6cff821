// The land: triangles whose corners rise as one comes near, or blocks of a quadtree whose vertices slide into their parents with
// distance (thesis 3.2.2, after Vlietinck), or any triangles of samples (ROAM), or every sample; and the coarse ring around it.
// Then what covers it.

struct Block {
    // First sample, and level: 8 × 8 cells of 2^level samples.
    @location(0) origin: vec2u,
    @location(1) level: u32,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    // That of the first corner.
    @location(1) @interpolate(flat) level: f32,
}

// Error and radius of each sample, as `lod::nested` has them.
@group(0) @binding(11) var bounds: texture_2d<f32>;
@group(1) @binding(0) var ground_color: texture_2d<f32>;
@group(1) @binding(1) var ground_weights: texture_2d<f32>;
// Tiling textures: red and blue of the factor on the colour, which is 1 at 128, then the first two parts of the normal.
@group(1) @binding(2) var details: texture_2d_array<f32>;
// x and z of the land's normals, however coarse its triangles.
@group(1) @binding(3) var ground_normals: texture_2d<f32>;
// What far trees leave of the sun on the ring.
@group(1) @binding(4) var far_shade: texture_2d<f32>;

fn sample_place(s: vec2u) -> vec3f {
    return vec3f(place_m(f32(s.x)), textureLoad(heights, vec2i(s), 0).r, place_m(f32(s.y)));
}

// The rule of `lod::morph` in Rust, which says why it leaves no cracks and what the gap is; a test of pictures keeps the
// two alike.
override GAP: f32;
// Of a block, along a side.
override BLOCK_VERTICES: u32;

// λ: which level of detail a sample's place calls for. It depends on the place alone, so that neighbours agree.
fn lambda_at(s: vec2u) -> f32 {
    let place = vec2f(place_m(f32(s.x)), place_m(f32(s.y)));
    let distance = length(vec3f(place - view.lod_eye.xz, view.lod_above));
    return min(log2(max(distance / view.lod_unit, 1.0)), view.lod_top);
}

// The coarsest level that uses a sample.
fn level_of(s: vec2u) -> u32 {
    return countTrailingZeros(s.x | s.y | 0x80000000u);
}

// The parent that a sample slides into: of a block's centre the northern end of its diagonal, of the middle of an edge
// the end with the lower coordinate.
fn parent(s: vec2u) -> vec2u {
    let l = level_of(s);
    let step = 1u << l;
    let odd = (s >> vec2u(l)) & vec2u(1u);
    if (odd.x == 1u && odd.y == 1u) {
        let block = s >> vec2u(l + 1u);
        if (((block.x + block.y) & 1u) == 0u) {
            return s - vec2u(step, step);
        }
        return vec2u(s.x + step, s.y - step);
    }
    return s - odd * step;
}

// The way that a vertex has gone to its parent.
fn slide(s: vec2u) -> f32 {
    return clamp((lambda_at(s) - f32(level_of(s))) / (1.0 - GAP), 0.0, 1.0);
}

// Where a vertex is drawn: at the first ancestor that has not arrived at its own parent, on the way there. No block needs
// more than two steps.
fn slid_place(sample: vec2u) -> vec3f {
    var s = sample;
    var way = slide(s);
    for (var i = 0; i < 2; i++) {
        if (way >= 1.0) {
            s = parent(s);
            way = slide(s);
        }
    }
    let place = sample_place(s);
    if (way <= 0.0) {
        return place;
    }
    return mix(place, sample_place(parent(s)), way);
}

// What the samples around one that is in use must have of its error, at least, as a factor.
override RATIO: f32;

// Where a sample that is in use is drawn: on its way from the middle of the edge that it splits. The rule of `lod::nested` in
// Rust, which says why the ends of that edge stand; a test of pictures keeps the two alike.
fn risen_place(s: vec2u) -> vec3f {
    let place = sample_place(s);
    let first = parent(s);
    let flat = 0.5 * (sample_place(first).y + sample_place(2u * s - first).y);
    let own = textureLoad(bounds, vec2i(s), 0).rg;
    let part = (distance(place, view.lod_eye) - own.g) / (view.lod_pixels * own.r);
    let risen = clamp((1.0 - part) / (1.0 - 1.0 / RATIO), 0.0, 1.0);
    return vec3f(place.x, mix(flat, place.y, risen), place.z);
}

fn normal_at(place: vec2f) -> vec3f {
    let side = view.field.x;
    // Samples are the middles of texels.
    let uv = (field_uv(place) * (side - 1.0) + 0.5) / side;
    let xz = textureSampleBias(ground_normals, clamped, uv, view.mip_bias).rg * 2.0 - 1.0;
    return vec3f(xz.x, sqrt(saturate(1.0 - dot(xz, xz))), xz.y);
}

fn out_at(world: vec3f, level: f32) -> Out {
    return Out(view.clip_from_world * vec4f(world, 1.0), world, level);
}

fn sample_of(index: u32) -> vec2u {
    let side = u32(view.field.x);
    return vec2u(index % side, index / side);
}

@vertex
fn block_vertex(block: Block, @builtin(vertex_index) index: u32) -> Out {
    let s = block.origin + (vec2u(index % BLOCK_VERTICES, index / BLOCK_VERTICES) << vec2u(block.level));
    return out_at(slid_place(s), f32(block.level));
}

// Any sample, by its number.
@vertex
fn sample_vertex(@builtin(vertex_index) index: u32) -> Out {
    let s = sample_of(index);
    return out_at(sample_place(s), f32(level_of(s)));
}

@vertex
fn risen_vertex(@builtin(vertex_index) index: u32) -> Out {
    let s = sample_of(index);
    let last = u32(view.field.x) - 1u;
    // The field's corners always stand, and split nothing.
    let is_corner = s.x % last == 0u && s.y % last == 0u;
    let inner = select(s, vec2u(1u), is_corner);
    return out_at(select(risen_place(inner), sample_place(s), is_corner), f32(level_of(s)));
}

// What a pixel covers, its longer side made shorter, to the mean of both: tiling textures are to be sharp at low angles
// also where the device filters them alike in all directions, and are smooth enough to bear it.
fn less_stretched(dx: vec3f, dy: vec3f) -> vec2f {
    let squares = vec2f(max(dot(dx, dx), 1e-18), max(dot(dy, dy), 1e-18));
    let mean = sqrt(squares.x * squares.y);
    return min(inverseSqrt(squares) * sqrt(mean), vec2f(1.0));
}

// An entry by its number. Spelt out: Mesa's software driver keeps what is indexed in memory, and a third of the time of
// all ground went into that.
fn entry(all: array<f32, 5>, number: u32) -> f32 {
    let first = select(select(all[2], all[1], number == 1u), all[0], number == 0u);
    return select(select(first, all[3], number == 3u), all[4], number == 4u);
}

fn along(axis: u32, place: vec3f) -> vec2f {
    return select(select(place.xy, place.zy, axis == 1u), place.xz, axis == 0u);
}

// Scales of the tiling textures: each is larger than the one before and turned by some 35°, and takes over with distance, so
// that no pattern of tiles shows and a hillside has as much on it as the ground at one's feet.
const WIDER: f32 = 4.3;

// How a scale is turned.
fn turn_of(scale: u32) -> mat2x2f {
    let axis = select(select(vec2f(1.0, 0.0), vec2f(0.82, 0.57), scale == 1u), vec2f(0.347, 0.938), scale == 2u);
    return mat2x2f(axis.x, axis.y, -axis.y, axis.x);
}

// How vivid one is: from afar a texture stands for patches, not for giant blades and pebbles. Rock, the second layer, is as
// rough from afar as from near by.
fn vividness_of(scale: u32, layer: u32) -> f32 {
    let soft = select(select(1.0, 0.8, scale == 1u), 0.5, scale == 2u);
    return select(soft, min(1.0, 0.4 * soft + 0.58), layer == 1u);
}

// The finer of the two scales that a distance mixes, and the share of the other.
struct Scales {
    finer: u32,
    far: f32,
}

fn scales_at(away: f32) -> Scales {
    if (away < 60.0) {
        return Scales(0u, smoothstep(10.0, 14.0, away));
    }
    return Scales(1u, smoothstep(140.0, 185.0, away));
}

// Where no texture is seen any more.
const SMOOTH_M: f32 = 1200.0;

// What one or several kinds of ground look like, each multiplied by its share.
struct Look {
    tiles: Tiles,
    // Linear, as far as it is the kinds' own; and the sum of the shares.
    color: vec4f,
}

// Powers of two by which a kind's share grows from where it is black to its mean, where it meets another one: what is dark is low.
const RELIEF: f32 = 12.0;

// One look at a tiling texture: which texture, seen along which axis, at which of the two scales. Where kinds meet, each comes through
// where it is high, and none is seen through the other (A. Mishkinis, Advanced Terrain Texture Splatting, 2013): with weights
// alone, of a texel a metre, rock would lie under turf as under mist.
fn look(k: u32, at: Surface, parts: array<f32, 5>, relief: f32, scales: Scales) -> Look {
    let layer = min(k / 6u, 4u);
    let axis = (k / 2u) % 3u;
    let is_coarser = (k & 1u) == 1u;
    let scale = scales.finer + (k & 1u);
    let tile_m = view.ground_kinds[layer].w * select(select(1.0, WIDER, scale == 1u), WIDER * WIDER, scale == 2u);
    let turn = turn_of(scale);
    let to_tile = turn * (1.0 / tile_m);
    let p = to_tile * along(axis, at.world);
    let dx = to_tile * along(axis, at.dx);
    let dy = to_tile * along(axis, at.dy);
    let tiles = tiles_of(textureSampleGrad(details, repeating, p, layer, dx, dy));
    let vividness = vividness_of(scale, layer);
    let seen = select(select(at.sides.z, at.sides.x, axis == 1u), at.sides.y, axis == 0u);
    let part = entry(parts, layer);
    let comes_through = part * part * part * exp2(relief * tiles.factor.g);
    let share = comes_through * seen * select(1.0 - scales.far, scales.far, is_coarser);
    // v runs against the bitangent: normals turn back the other way.
    let bump = vec3f(turn * tiles.bump.xy * vividness, tiles.bump.z);
    let looks = Tiles(share * mix(vec3f(1.0), tiles.factor, vividness), share * bump);
    return Look(looks, share * vec4f(view.ground_kinds[layer].rgb, 1.0));
}

// All looks that count. Mesa's software driver takes both ways of every `if`, but ends a loop when no pixel needs it any
// more: so a loop over the looks, of which there are one or two nearly everywhere, and not thirty conditions.
fn looks(at: Surface, parts: array<f32, 5>, scales: Scales) -> Look {
    let far = scales.far;
    let both = select(0u, 1u, far < 1.0) | select(0u, 2u, far > 0.0);
    // From above, and on steep ground from the sides, too: else the texture is stretched.
    let seen = select(0u, both, at.sides.y > 0.02) | select(0u, both << 2u, at.sides.x > 0.02)
        | select(0u, both << 4u, at.sides.z > 0.02);
    var left = 0u;
    var alone = 0.0;
    for (var layer = 0u; layer < 5u; layer++) {
        let part = entry(parts, layer);
        left |= select(0u, seen << (6u * layer), part > 0.0);
        alone += part * part;
    }
    // The scales and axes of a kind that lies alone are mixed as they are.
    let relief = RELIEF * saturate(4.0 - 4.0 * alone);
    var factor = vec3f(0.0);
    var bump = vec3f(0.0);
    var color = vec4f(0.0);
    loop {
        let one = look(countTrailingZeros(left), at, parts, relief, scales);
        factor += one.tiles.factor;
        bump += one.tiles.bump;
        color += one.color;
        left &= left - 1u;
        if (left == 0u) {
            break;
        }
    }
    // The mean of two scales varies less than either; this is as if it did not (Heitz & Neyret 2018, equation 2).
    let vivid = inverseSqrt(far * far + (1.0 - far) * (1.0 - far));
    let all = 1.0 / max(color.a, 1e-6);
    let mean = Tiles(1.0 + vivid * (all * factor - 1.0), all * vec3f(vivid * bump.xy, bump.z));
    return Look(mean, all * color);
}

// Colour of the kinds of ground, mixed as the map does.
fn mixed_color(weights: vec4f) -> vec3f {
    let first = max(1.0 - dot(weights, vec4f(1.0)), 0.0);
    let others = mat4x3f(view.ground_kinds[1].rgb, view.ground_kinds[2].rgb, view.ground_kinds[3].rgb, view.ground_kinds[4].rgb);
    return first * view.ground_kinds[0].rgb + others * weights;
}

// Where the eye is so near that a texel of the usual scale covers several pixels: the strongest texture once more, five
// times as fine. A factor on the looks; a loop, for the reason given there.
fn close_up(at: Surface, parts: array<f32, 5>, near: f32) -> Tiles {
    var best = 0u;
    for (var layer = 1u; layer < 5u; layer++) {
        best = select(best, layer, entry(parts, layer) > entry(parts, best));
    }
    let side = select(2u, 1u, at.sides.x > at.sides.z);
    let axis = select(side, 0u, at.sides.y > 0.5);
    let turn = mat2x2f(0.29, 0.957, -0.957, 0.29) * (FINER / view.ground_kinds[best].w);
    var result = Tiles(vec3f(1.0), vec3f(0.0));
    for (var once = select(1u, 0u, near > 0.0); once < 1u; once++) {
        let p = turn * along(axis, at.world);
        let dx = turn * along(axis, at.dx);
        let dy = turn * along(axis, at.dy);
        let fine = tiles_of(textureSampleGrad(details, repeating, p, best, dx, dy));
        result.factor = mix(vec3f(1.0), fine.factor, 0.6 * near);
        result.bump = vec3f(vec2f(0.29, 0.957) * fine.bump.x + vec2f(-0.957, 0.29) * fine.bump.y, 0.0) * (0.5 * near);
    }
    return result;
}

const FINER: f32 = 5.3;

// What covers less of the ground is not worth a look.
const LEAST_PART: f32 = 0.2;

// How much each tiling texture counts, from the weights of all but the first: nothing, or their sum is 1.
fn parts_of(weights: vec4f) -> array<f32, 5> {
    let first = max(1.0 - dot(weights, vec4f(1.0)) - LEAST_PART, 0.0);
    let others = max(weights - LEAST_PART, vec4f(0.0));
    let scale = 1.0 / max(first + dot(others, vec4f(1.0)), 1e-3);
    let scaled = scale * others;
    return array<f32, 5>(scale * first, scaled.r, scaled.g, scaled.b, scaled.a);
}

// A place on the ground, its change from pixel to pixel, and how much of it each axis sees.
struct Surface {
    world: vec3f,
    dx: vec3f,
    dy: vec3f,
    sides: vec3f,
}

// Shares of the three axes; gentle slopes are all seen from above, which costs one look.
fn sides_of(normal: vec3f) -> vec3f {
    let steep = smoothstep(0.86, 0.70, normal.y);
    let across = normal.xz * normal.xz;
    let shares = across * across / max(dot(across, across), 1e-6);
    return vec3f(shares.x * steep, 1.0 - steep, shares.y * steep);
}

// Share of the light that blades of grass keep from the turf between them.
const BETWEEN_BLADES: f32 = 0.35;

// What is left of it, as a factor: without, blades near by are hardly seen before ground of their own colour. From afar that colour is
// the mean of them and of what is between them.
fn between_blades(weights: vec4f, away: f32) -> f32 {
    let turf = smoothstep(0.3, 0.8, 1.0 - dot(weights, vec4f(1.0)) - weights.b);
    let near = 1.0 - smoothstep(0.2 * view.turf_m, max(view.turf_m, 1e-3), away);
    return 1.0 - BETWEEN_BLADES * turf * near;
}

// Light of the ground before that of the air, and how much of it is under still water.
struct Ground {
    radiance: vec3f,
    water: f32,
    // Share of the sky that arrives there.
    open: f32,
}

// From this alpha of the colour on no water stands there.
override DRY_ALPHA: f32;

// Part of the land that a slope sees which is not in the shade itself.
const LAND_IN_LIGHT: f32 = 0.8;

// Irradiance from the land around on a slope, which sees the more of it the steeper it is. Without it, slopes in the shade are as blue
// as the sky alone.
fn from_land(up: f32) -> vec3f {
    return light_from_ground(1.0, 1.0) * (LAND_IN_LIGHT * (0.5 - 0.5 * up));
}

// Irradiance from sky and land on the land, where that share of the sky arrives.
fn ambient_on_land(up: f32, open: f32) -> vec3f {
    return view.sky_irradiance * (open * (0.6 + 0.4 * up)) + from_land(up);
}

fn ground_at(in: Out) -> Ground {
    let place = in.world.xz;
    let uv = field_uv(place);
    let away = distance(in.world, view.eye);
    let color = textureSampleBias(ground_color, clamped, uv, view.mip_bias);
    var albedo = albedo_of(color.rgb);
    let weights = textureSampleBias(ground_weights, clamped, uv, view.mip_bias);
    let light = textureSampleBias(light_map, clamped, uv, view.mip_bias);
    let near = near_shade_at(place);
    let shade = mix(light.a, textureSample(near_shade, clamped, near.xy).r, near.z);
    let finer = exp2(view.mip_bias);
    let dx = finer * dpdx(in.world);
    let dy = finer * dpdy(in.world);
    var normal = normal_at(place);
    var relief = 1.0;
    if (away < SMOOTH_M) {
        let shorter = less_stretched(dx, dy);
        let at = Surface(in.world, dx * shorter.x, dy * shorter.y, sides_of(normal));
        let parts = parts_of(weights);
        let seen = looks(at, parts, scales_at(away));
        let close = close_up(at, parts, smoothstep(3.5, 1.5, away));
        let tiles = Tiles(seen.tiles.factor * close.factor, seen.tiles.bump + close.bump);
        let fade = 1.0 - smoothstep(0.4 * SMOOTH_M, SMOOTH_M, away);
        // The map's mixture becomes what comes through, as much darker or warmer as the map is here.
        albedo *= mix(vec3f(1.0), seen.color.rgb / max(mixed_color(weights), vec3f(1e-3)), fade);
        albedo *= mix(vec3f(1.0), tiles.factor, fade);
        let bump = mix(vec3f(0.0, 0.0, 1.0), tiles.bump, fade);
        // Tangent along x, bitangent along −z: as texture coordinates run, v down being south.
        let bumped = normalize(vec3f(normal.x + bump.x, normal.y * bump.z, normal.z - bump.y));
        // The light map holds n·l of the land; this turns it into that of the bumps.
        relief = clamp(dot(bumped, view.sun_direction) / max(dot(normal, view.sun_direction), 0.2), 0.0, 2.0);
        normal = bumped;
    }
    albedo = select(albedo * wetness(in.world.y) * between_blades(weights, away), level_tint(in.level) * 0.5, view.tint_levels != 0u);
    let irradiance = view.sun_irradiance * (light.g * shade * relief) + ambient_on_land(normal.y, light.r);
    return Ground(albedo / PI * irradiance, smoothstep(DRY_ALPHA, 0.3, color.a), light.r);
}

// Where no water stands on the land.
@fragment
fn ground(in: Out) -> @location(0) vec4f {
    return vec4f(hazed(air_before(in.world), ground_at(in).radiance), 1.0);
}

// Where some does, as on rice terraces. It shows the sky. A loop, because Mesa's software driver leaves one early; but land without
// water would pay a tenth of its light's time for it, or more.
@fragment
fn wet_ground(in: Out) -> @location(0) vec4f {
    let here = ground_at(in);
    var radiance = here.radiance;
    for (var water = here.water; water > 0.0; water = 0.0) {
        radiance = mix(radiance, flooded(radiance, in.world, here.open), water);
    }
    return vec4f(hazed(air_before(in.world), radiance), 1.0);
}

// Of young rice, the area that it shows from the side, over that of its field.
const RICE: f32 = 0.12;
// Metres between which single plants give way to their mean.
const RICE_NEAR_M: f32 = 20.0;
const RICE_FAR_M: f32 = 60.0;
// How much brighter rice is than the ground under it, half of which is mud.
const RICE_TONE: f32 = 1.5;

// Ground with that light under still water a hand deep; `open` is the share of the sky that arrives there.
fn flooded(under: vec3f, world: vec3f, open: f32) -> vec3f {
    let look = normalize(view.eye - world);
    let up = max(look.y, 0.0);
    let ripple = 0.012 * noise_pair(world.xz * 1.7 + vec2f(0.35, 0.2) * view.time_s);
    let mirrored = normalize(vec3f(-look.x + ripple.x, max(up, 0.015) + abs(ripple.y), -look.z));
    let sky = max(clear_sky(mirrored) + clouds_towards(mirrored, false, 0.0), vec3f(0.0)) * open;
    // Banks and trees around, about which nothing is known here, stand in the way of level rays.
    let seen = mix(under, sky, mix(0.5, 1.0, smoothstep(0.0, 0.12, mirrored.y)));
    let water = mix(under * 0.8, seen, mirrored_by_water(up));
    // Beyond where rice is drawn it hides the water, the more the flatter one looks across it (Beer's law, as of any crop).
    let hidden = (1.0 - exp(-RICE / max(up, 0.01))) * smoothstep(RICE_NEAR_M, RICE_FAR_M, distance(view.eye, world));
    return mix(water, under * RICE_TONE, hidden);
}

// Metres above the lake up to which the ground is wet.
const WET_M: f32 = 0.16;

// Factor on the albedo of ground at a height: what is wet, on the shore and under water, is darker.
fn wetness(height: f32) -> f32 {
    return mix(0.55, 1.0, smoothstep(0.3 * WET_M, WET_M, height - view.water_level));
}

// Whether a place of land as it is drawn is under water. Drawn coarsely, land may be lower there than it is, and would leave a gap
// to the shore, or higher, and bars under water be mirrored as if they stood in it: the samples tell.
fn is_sunk(world: vec3f) -> bool {
    return height_m(world.xz) < view.water_level;
}

// As a lake mirrors it: what is above the water, with no detail.
@fragment
fn mirrored_ground(in: Out) -> @location(0) vec4f {
    let uv = field_uv(in.world.xz);
    let albedo = albedo_of(textureSample(ground_color, clamped, uv).rgb);
    let light = textureSample(light_map, clamped, uv);
    if (is_sunk(in.world)) {
        discard;
    }
    let irradiance = view.sun_irradiance * (light.g * light.a) + ambient_on_land(normal_at(in.world.xz).y, light.r);
    return vec4f(hazed(air_before(in.world), albedo * wetness(in.world.y) / PI * irradiance), 1.0);
}

// Metres beyond the field that `far_shade` shows.
override SHADED_M: f32;

// The ring around the field.
struct RingVertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    // Albedo, and the share of the sun that the land around leaves.
    @location(2) color_and_sun: vec4f,
    @location(3) weights: vec4f,
}

struct RingOut {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color_and_sun: vec4f,
    @location(3) weights: vec4f,
}

@vertex
fn ring_vertex(in: RingVertex) -> RingOut {
    return RingOut(view.clip_from_world * vec4f(in.position, 1.0), in.position, in.normal, in.color_and_sun, in.weights);
}

// Metres of a tile of far rock, which stands for crags and gullies that the ring is too coarse for, and how far its bumps
// lean.
const CRAGS_M: f32 = 230.0;
const CRAGS_LEAN: f32 = 0.8;

// How much more patches differ than crags.
const PATCHES: f32 = 4.0;

// Crags at two scales: their bumps and a factor on the colour.
fn crags(place: vec2f) -> Tiles {
    let turn = turn_of(1u);
    let wide = tiles_of(textureSampleBias(details, repeating, place / CRAGS_M, 1, view.mip_bias));
    let fine = tiles_of(textureSampleBias(details, repeating, turn * place / (0.23 * CRAGS_M), 1, view.mip_bias));
    return Tiles(0.5 * (wide.factor + fine.factor), vec3f(wide.bump.xy + turn * fine.bump.xy, 1.0));
}

// What grows on gentle land is dry here and lush there, as crags are light and dark, where it is not snow: a factor on its colour.
fn patches(color: vec3f, crag: vec3f) -> vec3f {
    let dry = clamp(PATCHES * (dot(crag, vec3f(1.0 / 3.0)) - 1.0), -1.0, 1.0);
    return 1.0 + dry * vec3f(0.2, 0.1, -0.05) * (1.0 - smoothstep(0.35, 0.6, color.b));
}

// The kind of ground of which there is most, from the side that sees most of it, as the field shows it. With all looks of a place, as
// the field has, a frame of the starters took a twentieth longer, and no walk comes so near that one misses them.
fn strongest_look(at: Surface, weights: vec4f, scales: Scales) -> Tiles {
    let parts = array<f32, 5>(1.0 - dot(weights, vec4f(1.0)), weights.r, weights.g, weights.b, weights.a);
    var best = 0u;
    for (var layer = 1u; layer < 5u; layer++) {
        best = select(best, layer, entry(parts, layer) > entry(parts, best));
    }
    let side = select(2u, 1u, at.sides.x > at.sides.z);
    let first = 6u * best + 2u * select(side, 0u, at.sides.y > 0.5);
    let whole = array<f32, 5>(1.0, 1.0, 1.0, 1.0, 1.0);
    let finer = look(first, at, whole, 0.0, scales);
    let coarser = look(first + 1u, at, whole, 0.0, scales);
    let all = 1.0 / max(finer.color.a + coarser.color.a, 1e-6);
    return Tiles(all * (finer.tiles.factor + coarser.tiles.factor), all * (finer.tiles.bump + coarser.tiles.bump));
}

// A factor on the colours' mixture by which kinds of which there is more count for more, as if each came through somewhere: vertices are
// too far apart to say where.
fn less_mixed(weights: vec4f) -> vec3f {
    let first = max(1.0 - dot(weights, vec4f(1.0)), 0.0);
    let most = weights * weights * weights;
    let most_of_first = first * first * first;
    let all = 1.0 / max(most_of_first + dot(most, vec4f(1.0)), 1e-3);
    return mixed_color(all * most) / max(mixed_color(weights), vec3f(1e-3));
}

// From how far on crags begin to stand for what the kinds of ground look like, and from where on they do.
const CRAGS_FROM_M = vec2f(150.0, 500.0);

fn ring_radiance(in: RingOut) -> vec3f {
    let smooth_normal = normalize(in.normal);
    let color = in.color_and_sun.rgb;
    let away = distance(in.world, view.eye);
    let far = smoothstep(CRAGS_FROM_M.x, CRAGS_FROM_M.y, away);
    let tiles = crags(in.world.xz);
    // Plains are smooth, slopes are not.
    let rough = mix(0.12, 1.0, smoothstep(0.97, 0.78, smooth_normal.y));
    var lean = tiles.bump.xy * (CRAGS_LEAN * rough * far);
    var albedo = color * mix(vec3f(1.0), mix(patches(color, tiles.factor), tiles.factor, rough), far);
    let finer = exp2(view.mip_bias);
    let dx = finer * dpdx(in.world);
    let dy = finer * dpdy(in.world);
    let shorter = less_stretched(dx, dy);
    let at = Surface(in.world, dx * shorter.x, dy * shorter.y, sides_of(smooth_normal));
    let near = strongest_look(at, in.weights, scales_at(away));
    albedo *= mix(near.factor * less_mixed(in.weights), vec3f(1.0), far);
    lean += near.bump.xy * (1.0 - far);
    let normal = normalize(vec3f(smooth_normal.x + lean.x, smooth_normal.y, smooth_normal.z - lean.y));
    let shaded = in.world.xz / (2.0 * (view.field.z + SHADED_M)) + 0.5;
    let left = textureSample(far_shade, clamped, shaded).r * in.color_and_sun.a;
    let sun = view.sun_irradiance * (max(dot(normal, view.sun_direction), 0.0) * left);
    return hazed(air_before(in.world), albedo / PI * (sun + ambient_on_land(normal.y, 1.0)));
}

@fragment
fn ring(in: RingOut) -> @location(0) vec4f {
    return vec4f(ring_radiance(in), 1.0);
}

@fragment
fn mirrored_ring(in: RingOut) -> @location(0) vec4f {
    let radiance = ring_radiance(in);
    if (in.world.y < view.water_level) {
        discard;
    }
    return vec4f(radiance, 1.0);
}
