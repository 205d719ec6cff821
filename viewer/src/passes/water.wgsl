// The lake: land, trees and sky mirrored by small waves, the ground showing through where it is shallow.

// What an even surface would mirror of land and trees, seen as this picture sees it, and how far away that is. Empty where
// there is sky.
@group(1) @binding(0) var mirror: texture_2d<f32>;
@group(1) @binding(1) var mirror_depth: texture_depth_2d;

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
}

// Pixels by which the land as it is drawn may differ from what it is: so much higher may it stand and not hide the lake, whose
// edge is where the land itself goes under. On a flat shore a hand's breadth moves the edge by many metres. The ring around the
// field is drawn as it is.
const LAND_ERROR_PX: f32 = 2.0;
const HALF_M: f32 = 4096.0;
// Cells a side: the middle one is the field, and the others lie around it.
override CELLS: u32;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Out {
    // Counter-clockwise from above.
    let corner = array<vec2u, 6>(
        vec2u(0u, 0u), vec2u(0u, 1u), vec2u(1u, 1u), vec2u(0u, 0u), vec2u(1u, 1u), vec2u(1u, 0u),
    )[index % 6u];
    let cell = vec2u(index / 6u % CELLS, index / 6u / CELLS);
    var lines = array<f32, 4>(-HALF_M, -view.field.z, view.field.z, HALF_M);
    let world = vec3f(lines[cell.x + corner.x], view.water_level, lines[cell.y + corner.y]);
    var clip = view.clip_from_world * vec4f(world, 1.0);
    if (all(cell == vec2u(1u))) {
        // As deep as a surface which that many pixels are higher, in the same place of the picture.
        clip.z *= 1.0 + clip.w * LAND_ERROR_PX / (view.focal_px * max(abs(view.eye.y - view.water_level), 0.5));
    }
    return Out(clip, world);
}

const WAVES: u32 = 6u;
// Slope and length in metres of the longest: on a lake, and how many times as much at sea.
const STEEPNESS: f32 = 0.014;
const LENGTH_M: f32 = 5.3;
const AT_SEA = vec2f(3.2, 2.5);

// The surface's slope, and the variance of what of it is too fine to be seen.
struct Slope {
    seen: vec2f,
    variance: f32,
}

// How much of a sea's waves there are: they are lower over shallows and within bays. Beyond the field depths are not known.
fn swell(place: vec2f, depth: f32) -> f32 {
    let beyond = max(abs(place) - view.field.z, vec2f(0.0));
    return view.sea * max(smoothstep(2.0, 14.0, depth), smoothstep(0.0, 400.0, max(beyond.x, beyond.y)));
}

// Waves of six directions and lengths.
fn slope(place: vec2f, pixel_m: f32, swell: f32) -> Slope {
    var sum = Slope(vec2f(0.0), 0.0);
    let steepness = STEEPNESS * mix(1.0, AT_SEA.x, swell);
    var length_m = LENGTH_M * mix(1.0, AT_SEA.y, view.sea);
    var turn = 0.4;
    for (var wave = 0u; wave < WAVES; wave++) {
        let direction = vec2f(cos(turn), sin(turn));
        let k = 2.0 * PI / length_m;
        // Deep water: the square of the frequency is g·k.
        let phase = dot(direction, place) * k - sqrt(9.81 * k) * view.time_s;
        let seen = smoothstep(0.5, 0.12, pixel_m / length_m);
        sum.seen += direction * cos(phase + 1.7 * sin(dot(place.yx, direction) * k * 0.23)) * steepness * seen;
        sum.variance += 0.5 * steepness * steepness * (1.0 - seen * seen);
        turn += 2.1;
        length_m *= 0.61;
    }
    return sum;
}

// Texels by which the mirror is read lower: at the far shore a texel may have its middle beyond the lake, where the mirror is
// empty.
const LOWER_TEXELS: f32 = 1.5;

fn mirror_uv(clip: vec4f) -> vec2f {
    let lower = vec2f(0.0, LOWER_TEXELS / f32(textureDimensions(mirror).y));
    return clip.xy / max(clip.w, 1e-3) * vec2f(0.5, -0.5) + 0.5 + lower;
}

// Metres along the line of sight, as w counts them, to what is mirrored there; 0 for sky. `near`: what depth is times w.
fn mirrored_w(uv: vec2f, near: f32) -> f32 {
    let size = vec2f(textureDimensions(mirror_depth));
    let depth = textureLoad(mirror_depth, vec2i(clamp(uv * size, vec2f(0.0), size - 1.0)), 0);
    return select(0.0, near / depth, depth > 0.0);
}

const TAPS: i32 = 6;

// Land and trees that a ray meets which a place of the surface sends off in a direction, premultiplied; `spread` is how far
// the ray's rise varies within a pixel.
fn mirrored_land(world: vec3f, direction: vec3f, spread: f32) -> vec4f {
    let start = view.clip_from_world * vec4f(world, 1.0);
    // In the mirror's picture what is above is below.
    let way = view.clip_from_world * vec4f(direction.x, -direction.y, direction.z, 0.0);
    let down = -view.clip_from_world[1];
    // How far the ray goes is only known where it ends: what is there if it goes on for ever, or else what an even surface
    // would show.
    let near = start.z;
    let endless = mirrored_w(mirror_uv(start * 1e-3 + way), near);
    let even = mirrored_w(mirror_uv(start), near);
    let end = select(even, endless, endless > 0.0);
    let away = select(1e4, max(end - start.w, 0.0) / max(way.w, 1e-3), end > 0.0);
    var sum = vec4f(0.0);
    for (var tap = 0; tap < TAPS; tap++) {
        let lean = ((f32(tap) + 0.5) / f32(TAPS) - 0.5) * spread;
        sum += textureSampleLevel(mirror, clamped, mirror_uv(start + (way + down * lean) * away), 0.0);
    }
    return sum / f32(TAPS);
}

// Mip level of the light map, whose texels are 16 m wide there, for light that comes out of deep water: it went in metres away, so that
// no tree's shadow has an edge on a lake.
const SCATTER_MIP: f32 = 4.0;

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let to_eye = view.eye - in.world;
    let away = length(to_eye);
    let look = to_eye / away;
    let inside = all(abs(in.world.xz) < vec2f(view.field.z));
    // Beyond the field as at its edge: waves may not end there.
    let edge_depth = view.water_level - height_m(clamp(in.world.xz, vec2f(-view.field.z), vec2f(view.field.z)));
    let depth = select(max(edge_depth, 8.0), edge_depth, inside);
    let pixel_m = away / view.focal_px / max(look.y, 0.02);
    let sea = swell(in.world.xz, edge_depth);
    let waves = slope(in.world.xz, pixel_m, sea);
    // At low angles the backs of waves are hidden.
    let shown = smoothstep(0.0, 0.6, depth) * clamp(look.y / 0.12, 0.2, 1.0);
    // Of a sea's waves that are too fine to be seen, what faces the eye hides the rest: at low angles it mirrors the sky higher up,
    // and less of it, so that it ends in a line at the horizon (Bruneton et al., "Real-time Realistic Ocean Lighting", 2010). Not
    // so a lake, whose far shore would not be mirrored.
    let level = max(length(look.xz), 1e-3);
    let leaning = sea * waves.variance / (look.y / level + 1.25 * sqrt(waves.variance) + 1e-4);
    let tilt = waves.seen * shown - look.xz / level * leaning;
    let normal = normalize(vec3f(-tilt.x, 1.0, -tilt.y));
    var mirrored = reflect(-look, normal);
    mirrored.y = max(mirrored.y, 0.01);
    mirrored = normalize(mirrored);
    let spread = 4.0 * sqrt(waves.variance) * shown;
    let land = mirrored_land(in.world, mirrored, spread);
    // Waves blur clouds, half as wide as all that they send there; a face of the sky spans a quarter of a turn.
    let mip = log2(max(spread * f32(textureDimensions(sky_cube).x) / PI, 1.0));
    let sky = max(clear_sky(mirrored) + clouds_towards(mirrored, false, mip), vec3f(0.0));
    let facing = clamp(dot(normal, look), 0.0, 1.0);
    let reflectance = mirrored_by_water(facing);
    let half_way = normalize(look + view.sun_direction);
    var light = vec4f(1.0);
    var within = vec4f(1.0);
    if (inside) {
        light = light_on(in.world.xz);
        within = textureSampleLevel(light_map, clamped, field_uv(in.world.xz), SCATTER_MIP);
    }
    // What is too fine to be seen spreads the sun's image.
    let sharpness = 1.0 / (1.0 / 900.0 + waves.variance);
    let glint = pow(max(dot(normal, half_way), 0.0), sharpness) * (sharpness / 15.0) * light.b * (1.0 - land.a);
    let body = vec3f(0.012, 0.035, 0.032) * (view.sky_irradiance * within.r + 0.5 * view.sun_irradiance * within.b * within.a);
    let clearness = exp(-max(depth, 0.0) * vec3f(0.9, 0.55, 0.6));
    let opaque = 1.0 - (clearness.x + clearness.y + clearness.z) / 3.0;
    // A film mirrors as well as deep water does.
    let edge = smoothstep(0.0, 0.04, depth);
    let radiance = mix(body * opaque, sky * (1.0 - land.a), reflectance) + view.sun_irradiance * glint * reflectance;
    // What comes from land and trees has been through all of the air; the rest only arrives from here.
    let share = reflectance + (1.0 - reflectance) * opaque;
    let clear = exp(-away * view.haze_extinction);
    let own = radiance * clear + haze_towards(in.world - view.eye) * (1.0 - clear) * (share - reflectance * land.a);
    return vec4f((own + land.rgb * reflectance) * edge, share * edge);
}
