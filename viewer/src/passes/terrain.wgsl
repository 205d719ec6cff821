// The land: blocks of a quadtree whose vertices slide into their parents with distance (thesis 3.2.2, after Vlietinck),
// or any triangles of samples (ROAM), or every sample; and the coarse ring around it. Then what covers it.

struct Block {
    // First sample, and level: 16 × 16 cells of 2^level samples.
    @location(0) origin: vec2u,
    @location(1) level: u32,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) level: f32,
}

@group(1) @binding(0) var ground_color: texture_2d<f32>;
@group(1) @binding(1) var ground_weights: texture_2d<f32>;
@group(1) @binding(2) var details: texture_2d_array<f32>;
@group(1) @binding(3) var detail_normals: texture_2d_array<f32>;

fn sample_place(s: vec2u) -> vec3f {
    return vec3f(place_m(f32(s.x)), textureLoad(heights, vec2i(s), 0).r, place_m(f32(s.y)));
}

// The rule of `lod::morph` in Rust, which says why it leaves no cracks; the two are kept alike by a test of pictures.
const GAP: f32 = 0.25;

// λ: which level of detail a sample's place calls for. It depends on the place alone, so that neighbours agree.
fn lambda_at(s: vec2u) -> f32 {
    let place = vec2f(place_m(f32(s.x)), place_m(f32(s.y)));
    let offset = vec3f(place - view.lod_eye.xz, view.terrain_lod.z);
    return clamp(log2(length(offset) / view.terrain_lod.x), 0.0, view.terrain_lod.y);
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
fn drawn_place(sample: vec2u) -> vec3f {
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

fn normal_at(s: vec2u) -> vec3f {
    let last = i32(view.field.x) - 1;
    let c = vec2i(s);
    let west = vec2i(max(c.x - 1, 0), c.y);
    let east = vec2i(min(c.x + 1, last), c.y);
    let north = vec2i(c.x, max(c.y - 1, 0));
    let south = vec2i(c.x, min(c.y + 1, last));
    let dx = (textureLoad(heights, east, 0).r - textureLoad(heights, west, 0).r) / f32(east.x - west.x);
    let dz = (textureLoad(heights, south, 0).r - textureLoad(heights, north, 0).r) / f32(south.y - north.y);
    return normalize(vec3f(-dx, view.field.y, -dz));
}

fn out_at(world: vec3f, normal: vec3f, level: f32) -> Out {
    return Out(view.clip_from_world * vec4f(world, 1.0), world, normal, level);
}

@vertex
fn block_vertex(block: Block, @builtin(vertex_index) index: u32) -> Out {
    let s = block.origin + (vec2u(index % 17u, index / 17u) << vec2u(block.level));
    var world: vec3f;
    if ((view.flags & FLAG_MORPH) != 0u) {
        world = drawn_place(s);
    } else {
        world = sample_place(s);
    }
    return out_at(world, normal_at(s), f32(block.level));
}

// Any sample, by its number.
@vertex
fn sample_vertex(@builtin(vertex_index) index: u32) -> Out {
    let side = u32(view.field.x);
    let s = vec2u(index % side, index / side);
    return out_at(sample_place(s), normal_at(s), f32(level_of(s)));
}

// What a pixel covers, its longer side made shorter: tiling textures are to be sharp at low angles also where the device
// filters them alike in all directions, and are smooth enough to bear it.
fn less_stretched(dx: vec2f, dy: vec2f) -> array<vec2f, 2> {
    let ratio = max(length(dx), 1e-9) / max(length(dy), 1e-9);
    let keep = pow(max(ratio, 1.0 / ratio), -0.45);
    return array<vec2f, 2>(dx * select(1.0, keep, ratio > 1.0), dy * select(keep, 1.0, ratio > 1.0));
}

struct Tiles {
    factor: vec3f,
    bump: vec3f,
}

// A tiling texture seen along one axis: `uv` in metres, and how fast it changes from pixel to pixel.
fn tile_from(layer: i32, uv: vec2f, dx: vec2f, dy: vec2f) -> Tiles {
    let footprint = less_stretched(dx, dy);
    let factor = textureSampleGrad(details, repeating, uv, layer, footprint[0], footprint[1]).rgb * (255.0 / 128.0);
    let bump = textureSampleGrad(detail_normals, repeating, uv, layer, footprint[0], footprint[1]).xyz * 2.0 - 1.0;
    return Tiles(factor, bump);
}

fn add_tile(tiles: Tiles, layer: i32, weight: f32, at: Surface, tile_m: f32) -> Tiles {
    if (weight < 0.01) {
        return tiles;
    }
    let p = at.world / tile_m;
    let dx = at.dx / tile_m;
    let dy = at.dy / tile_m;
    var sum = Tiles(vec3f(0.0), vec3f(0.0));
    // From above, and on steep ground from the sides, too: else the texture is stretched.
    if (at.sides.y > 0.02) {
        let tile = tile_from(layer, p.xz, dx.xz, dy.xz);
        sum = Tiles(sum.factor + at.sides.y * tile.factor, sum.bump + at.sides.y * tile.bump);
    }
    if (at.sides.x > 0.02) {
        let tile = tile_from(layer, p.zy, dx.zy, dy.zy);
        sum = Tiles(sum.factor + at.sides.x * tile.factor, sum.bump + at.sides.x * tile.bump);
    }
    if (at.sides.z > 0.02) {
        let tile = tile_from(layer, p.xy, dx.xy, dy.xy);
        sum = Tiles(sum.factor + at.sides.z * tile.factor, sum.bump + at.sides.z * tile.bump);
    }
    return Tiles(tiles.factor + weight * sum.factor, tiles.bump + weight * sum.bump);
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

@fragment
fn ground(in: Out) -> @location(0) vec4f {
    let place = in.world.xz;
    let uv = field_uv(place);
    let away = distance(in.world, view.eye);
    var albedo = textureSample(ground_color, clamped, uv).rgb;
    let weights = textureSample(ground_weights, clamped, uv);
    let light = textureSample(light_map, clamped, uv);
    let dx = dpdx(in.world);
    let dy = dpdy(in.world);
    var normal = normalize(in.normal);
    var relief = 1.0;
    if (away < 160.0) {
        var tiles = Tiles(vec3f(0.0), vec3f(0.0));
        let at = Surface(in.world, dx, dy, sides_of(normal));
        let rest = max(1.0 - weights.r - weights.g - weights.b - weights.a, 0.0);
        tiles = add_tile(tiles, 0, rest, at, view.tiles.x);
        tiles = add_tile(tiles, 1, weights.r, at, view.tiles.y);
        tiles = add_tile(tiles, 2, weights.g, at, view.tiles.z);
        tiles = add_tile(tiles, 3, weights.b, at, view.tiles.w);
        tiles = add_tile(tiles, 4, weights.a, at, view.last_tile.x);
        let fade = 1.0 - smoothstep(80.0, 160.0, away);
        albedo *= mix(vec3f(1.0), tiles.factor, fade);
        let bump = mix(vec3f(0.0, 0.0, 1.0), tiles.bump, fade);
        // Tangent along x, bitangent along −z: as texture coordinates run, v down being south.
        let bumped = normalize(vec3f(normal.x + bump.x, normal.y * bump.z, normal.z - bump.y));
        // The light map holds n·l of the land; this turns it into that of the bumps.
        relief = clamp(dot(bumped, view.sun_direction) / max(dot(normal, view.sun_direction), 0.2), 0.0, 2.0);
        normal = bumped;
    }
    if ((view.flags & FLAG_TINT) != 0u) {
        albedo = level_tint(in.level) * 0.5;
    }
    let irradiance = view.sun_irradiance * light.g * relief + view.sky_irradiance * light.r * (0.6 + 0.4 * normal.y);
    return vec4f(through_air(albedo / PI * irradiance, away), 1.0);
}

// The ring around the field.
struct RingVertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec4f,
}

struct RingOut {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
}

@vertex
fn ring_vertex(in: RingVertex) -> RingOut {
    return RingOut(view.clip_from_world * vec4f(in.position, 1.0), in.position, in.normal, in.color.rgb);
}

@fragment
fn ring(in: RingOut) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let sun = view.sun_irradiance * max(dot(normal, view.sun_direction), 0.0);
    let sky = view.sky_irradiance * (0.5 + 0.5 * normal.y);
    return vec4f(through_air(in.color / PI * (sun + sky), distance(in.world, view.eye)), 1.0);
}
