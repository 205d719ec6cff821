// Small plants and stones: shapes with a colour at each end, rooted on the land as it is drawn and in its light. Of most of them all
// of it happens for vertices: a pixel is given its colour, nothing more. Those with a texture, as stones, are lit by pixels.

// As in `terrain.wgsl`.
@group(1) @binding(2) var details: texture_2d_array<f32>;

struct Plant {
    // x, z and the height of the land there.
    @location(0) place: vec3f,
    // Cosine and sine of the turn, times the scale.
    @location(1) turn: vec2f,
    // Albedo at tint 0; how far it moves in the wind.
    @location(2) root: vec4f,
    // Albedo at tint 1; 1 if light comes through, or the number of its texture.
    @location(3) tip: vec4f,
}

struct Corner {
    @location(4) position: vec3f,
    @location(5) normal: vec3f,
    @location(6) tint: f32,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) radiance: vec3f,
    // Of one of the corners.
    @location(1) @interpolate(flat) corner: vec3f,
}

// A corner of a plant where it is drawn.
struct Placed {
    world: vec3f,
    normal: vec3f,
    // Factor on the shape.
    size: f32,
}

fn placed(plant: Plant, corner: Corner) -> Placed {
    let size = length(plant.turn);
    let turned = mat2x2f(plant.turn, vec2f(-plant.turn.y, plant.turn.x));
    let bend = wind(plant.place.xy, plant.turn.x) * (plant.root.w * size * corner.position.y * corner.position.y);
    let at = plant.place.xy + turned * corner.position.xz + bend;
    // Every corner on its own ground, as `ground_m` of the schema has it.
    let aside = size * length(corner.position.xz);
    let middle = plant.place.z;
    let ground = clamp(drawn_height_m(at), middle - 1.2 * aside - 0.1, middle + 0.7 * aside + 0.1);
    let world = vec3f(at.x, ground + size * corner.position.y, at.y);
    let level = turned * corner.normal.xz / max(size, 1e-6);
    return Placed(world, normalize(vec3f(level.x, corner.normal.y, level.y)), size);
}

@vertex
fn vertex(plant: Plant, corner: Corner) -> Out {
    let here = placed(plant, corner);
    let light = light_on(plant.place.xy);
    let albedo = mix(plant.root.rgb, plant.tip.rgb, corner.tint);
    let facing = dot(here.normal, view.sun_direction);
    let leafy = plant.tip.w;
    // Leaves let some of the light through that falls on their other side.
    let sun_on = mix(max(facing, 0.0), max(0.25 + 0.75 * facing, -0.3 * facing), leafy);
    // Roots stand in each other's shade.
    let open = mix(1.0, 0.55 + 0.45 * clamp(3.0 * corner.position.y, 0.0, 1.0), leafy);
    let around = light_around(0.5 + 0.5 * here.normal.y, light.b, light.r);
    let irradiance = view.sun_irradiance * light.b * sun_on + around;
    let radiance = hazed(air_before(here.world), albedo / PI * irradiance * open);
    return Out(view.clip_from_world * vec4f(here.world, 1.0), radiance, radiance);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    // Beyond the edge of a sliver, where a pixel's middle may lie, what is interpolated is any number.
    return vec4f(clamp(in.radiance, 0.1 * in.corner, 10.0 * in.corner), 1.0);
}

struct Textured {
    @builtin(position) clip: vec4f,
    // In the shape's space, in metres of the world.
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) albedo: vec3f,
    // Cosine and sine of its turn.
    @location(3) @interpolate(flat) turn: vec2f,
    // Share of the sun and of the sky that arrives where it stands.
    @location(4) @interpolate(flat) light: vec2f,
    // Share of what is around that is seen beside the ground that it stands on.
    @location(5) open: f32,
    @location(6) @interpolate(flat) layer: u32,
    // See `air_before`.
    @location(7) @interpolate(flat) air: vec4f,
}

@vertex
fn textured_vertex(plant: Plant, corner: Corner) -> Textured {
    let here = placed(plant, corner);
    let light = light_on(plant.place.xy);
    var out: Textured;
    out.clip = view.clip_from_world * vec4f(here.world, 1.0);
    out.place = here.size * corner.position;
    out.normal = corner.normal;
    out.albedo = mix(plant.root.rgb, plant.tip.rgb, corner.tint);
    out.turn = plant.turn / max(here.size, 1e-6);
    out.light = light.br;
    out.open = 0.4 + 0.6 * clamp(3.0 * corner.position.y, 0.0, 1.0);
    out.layer = u32(plant.tip.w);
    out.air = air_before(here.world);
    return out;
}

// Metres of a tile on them, twice: of what is seen a few metres away, and of what is at one's feet.
const TILE_M: f32 = 2.1;
const FINE_TILE_M: f32 = 0.55;

// The texture from three sides, in proportion to how much each sees of the surface.
fn from_three_sides(place: vec3f, sides: vec3f, layer: u32) -> Tiles {
    let x = tiles_of(textureSampleBias(details, repeating, place.zy, layer, view.mip_bias));
    let y = tiles_of(textureSampleBias(details, repeating, place.xz, layer, view.mip_bias));
    let z = tiles_of(textureSampleBias(details, repeating, place.xy, layer, view.mip_bias));
    // v runs against the bitangent.
    let bump = sides.x * vec3f(0.0, -x.bump.y, x.bump.x) + sides.y * vec3f(y.bump.x, 0.0, -y.bump.y)
        + sides.z * vec3f(z.bump.x, -z.bump.y, 0.0);
    return Tiles(sides.x * x.factor + sides.y * y.factor + sides.z * z.factor, bump);
}

@fragment
fn textured(in: Textured) -> @location(0) vec4f {
    let smooth_normal = normalize(in.normal);
    let squares = smooth_normal * smooth_normal;
    let sides = squares * squares / dot(squares, squares);
    let wide = from_three_sides(in.place / TILE_M, sides, in.layer);
    let fine = from_three_sides(in.place.zxy / FINE_TILE_M, sides.zxy, in.layer);
    let bumped = normalize(smooth_normal + 0.7 * wide.bump + 0.5 * fine.bump.yzx);
    let turned = mat2x2f(in.turn, vec2f(-in.turn.y, in.turn.x)) * bumped.xz;
    let normal = vec3f(turned.x, bumped.y, turned.y);
    // Beyond the edge of a sliver it may be any number.
    let albedo = clamp(in.albedo, vec3f(0.0), vec3f(1.0)) * wide.factor * mix(vec3f(1.0), fine.factor, 0.7);
    let around = light_around(0.5 + 0.5 * normal.y, in.light.x, in.light.y) * clamp(in.open, 0.0, 1.0);
    let irradiance = view.sun_irradiance * (in.light.x * max(dot(normal, view.sun_direction), 0.0)) + around;
    return vec4f(hazed(in.air, albedo / PI * irradiance), 1.0);
}

struct Foot {
    @builtin(position) clip: vec4f,
    // 1 under what stands there, 0 where nothing is shaded any more.
    @location(0) near: f32,
}

// So much nearer than the ground: both are drawn from the same heights, but with other triangles.
const FOOT_NEARER: f32 = 1.01;

@vertex
fn foot_vertex(plant: Plant, corner: Corner) -> Foot {
    var clip = view.clip_from_world * vec4f(placed(plant, corner).world, 1.0);
    clip.z *= FOOT_NEARER;
    return Foot(clip, corner.tint);
}

// Share of the light that is missing right beside what stands there.
const FOOT_SHADE: f32 = 0.75;

// A factor on what is there.
@fragment
fn foot(in: Foot) -> @location(0) vec4f {
    return vec4f(vec3f(1.0 - FOOT_SHADE * smoothstep(0.0, 0.7, in.near)), 1.0);
}
