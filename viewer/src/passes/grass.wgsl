// Blades of grass around the eye: a clump's number → blades of three triangles, rooted on the land as it is drawn, in the
// ground's colour and light. All of it happens for vertices: a pixel is given its colour, nothing more.

// Metres a side of a cell, clumps that it has at most, blades of a clump, vertices of a blade.
override CELL_M: f32;
override CLUMPS: u32;
override BLADES: u32;
override BLADE_VERTICES: u32;
// Distances in metres up to which all of them stand, and beyond which there are none.
override DENSE_M: f32;
override REACH_M: f32;
// From this distance on blades are drawn as one triangle each; before it they straighten.
override FINE_M: f32;
// Blades of one tuft.
const TUFT: u32 = 8u;

@group(1) @binding(0) var ground_color: texture_2d<f32>;
@group(1) @binding(1) var ground_weights: texture_2d<f32>;

struct Clump {
    // Cell of the world: from cell · CELL_M one cell east and south.
    @location(0) cell: vec2i,
    // Number within the cell; higher ones are drawn only near by.
    @location(1) number: u32,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) radiance: vec3f,
}

// Three numbers from three (Jarzynski & Olano 2020).
fn pcg3d(seed: vec3u) -> vec3u {
    var v = seed * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// In [0, 1).
fn unit(v: vec3u) -> vec3f {
    return vec3f(v >> vec3u(8u)) / 16777216.0;
}

// Smooth noise in [-1, 1], one hill or hollow a metre.
fn noise(place: vec2f) -> f32 {
    let cell = floor(place);
    let part = place - cell;
    let t = part * part * (3.0 - 2.0 * part);
    let c = bitcast<vec2u>(vec2i(cell));
    let a = f32(pcg3d(vec3u(c, 7u)).x >> 8u);
    let b = f32(pcg3d(vec3u(c + vec2u(1u, 0u), 7u)).x >> 8u);
    let d = f32(pcg3d(vec3u(c + vec2u(0u, 1u), 7u)).x >> 8u);
    let e = f32(pcg3d(vec3u(c + vec2u(1u, 1u), 7u)).x >> 8u);
    return mix(mix(a, b, t.x), mix(d, e, t.x), t.y) / 8388608.0 - 1.0;
}

// Share of the blades that stand at a distance from the eye; they get wider as they get fewer.
fn density(away: f32) -> f32 {
    return min(DENSE_M / max(away, 0.01), 1.0) * (1.0 - smoothstep(0.6 * REACH_M, REACH_M, away));
}

// A triangle covers less than a blade that is wide up to its middle: by so much wider it covers as much.
const SLENDER: f32 = 1.22;

const NOWHERE = Out(vec4f(0.0, 0.0, -1.0, 1.0), vec3f(0.0));

@vertex
fn vertex(clump: Clump, @builtin(vertex_index) index: u32) -> Out {
    let blade = clump.number * BLADES + index / BLADE_VERTICES;
    let cell = bitcast<vec2u>(clump.cell);
    let tuft_dice = unit(pcg3d(vec3u(cell, blade / TUFT)));
    let seed = pcg3d(vec3u(cell, blade + 8191u));
    let dice = unit(seed);
    let more = unit(pcg3d(seed));
    let turn = 6.2831853 * dice.x;
    let outward = vec2f(cos(turn), sin(turn));
    let root = (vec2f(clump.cell) + tuft_dice.xy) * CELL_M + outward * (0.17 * dice.y);

    let ground_m = drawn_height_m(root);
    let away = distance(vec3f(root.x, ground_m, root.y), view.eye);
    // What has as few pixels at full resolution is so far away.
    let seeming = away / view.part;
    // Fewer with distance, by rank: each shrinks into the ground as its turn comes.
    let rank = (f32(blade) + 1.0) / f32(CLUMPS * BLADES);
    let present = clamp((density(seeming) - rank) / (0.25 * rank + 0.004), 0.0, 1.0);
    let inside = all(abs(root) < vec2f(view.field.z));
    if (present <= 0.0 || !inside) {
        return NOWHERE;
    }
    let uv = field_uv(root);
    let weights = textureSampleLevel(ground_weights, clamped, uv, 0.0);
    // Where there is as much snow as grass, it is under the snow.
    let grass = 1.0 - weights.r - weights.g - 2.0 * weights.b - weights.a;
    let lush = noise(root / 1.3);
    let growth = min((grass - 0.3) * 1.7 + 0.45 * lush + 0.4 * (tuft_dice.z - 0.5), 1.0);
    if (growth < 0.03 || grass < 0.3 || ground_m < view.water_level + 0.12) {
        return NOWHERE;
    }
    let taller = select(1.0, 1.7, tuft_dice.z > 0.93);
    let height = (0.05 + 0.15 * growth) * (0.55 + 0.8 * more.x) * taller * present;
    // 0 at the root, 1 at the tip; two vertices, two vertices, one.
    let corner = index % BLADE_VERTICES;
    let up = f32(corner / 2u) * 0.5;
    let side = select(f32(corner & 1u) * 2.0 - 1.0, 0.0, corner == BLADE_VERTICES - 1u);

    let to_eye = normalize(view.eye - vec3f(root.x, ground_m, root.y));
    let facing = normalize(vec2f(to_eye.z, -to_eye.x) + 1.3 * (dice.z - 0.5) * to_eye.xz + vec2f(1e-4));
    let pixel_m = away / view.focal_px;
    // Never much thinner than a pixel, and wider where there are fewer.
    let half_m = max((0.0028 + 0.0026 * more.y) * (1.0 + 0.09 * seeming), 0.42 * pixel_m) * min(present * 3.0, 1.0);
    let bend = outward * (0.2 + 0.65 * more.z) + wind(root, dice.y);
    let straight = smoothstep(0.6 * FINE_M, FINE_M, seeming);
    let bow = mix(up * up, up, straight);
    let lean = bend * (height * bow);
    let width = half_m * mix(1.0, SLENDER, straight) * (1.0 - mix(0.56, 1.0, straight) * up);
    let world = vec3f(
        root.x + lean.x + facing.x * side * width,
        // A bent blade reaches less high; its root is in the ground.
        ground_m - 0.015 + height * (up - 0.22 * bow * dot(bend, bend)),
        root.y + lean.y + facing.y * side * width,
    );

    let light = light_on(root);
    var albedo = albedo_of(textureSampleLevel(ground_color, clamped, uv, 0.0).rgb);
    // Some blades are straw, some tufts are fresher.
    albedo *= select(vec3f(1.0, 1.0 + 0.12 * lush, 1.0 - 0.2 * lush), vec3f(1.8, 1.42, 1.15), more.z > 0.88);
    albedo *= 0.8 + 0.5 * dice.z;
    let far = smoothstep(4.0, REACH_M * 0.7, seeming);
    // Roots stand in each other's shade, tips in the open.
    let open = mix(mix(0.5, 2.1, up), 1.05, far);
    let side_lit = abs(dot(normalize(vec2f(-facing.y, facing.x)), view.sun_direction.xz));
    let sun_on = mix(light.g, 0.35 * light.b * (0.5 + side_lit), 0.4);
    var radiance = albedo / PI * open * (view.sun_irradiance * sun_on + view.sky_irradiance * light.r);
    // Seen against the sun they glow: chlorophyll takes red and blue on the way through.
    let against = max(dot(-to_eye, view.sun_direction), 0.0);
    let glow = against * against * against * 0.9 * up * (1.0 - far);
    radiance += albedo * vec3f(0.9, 1.0, 0.35) / PI * view.sun_irradiance * light.b * glow;
    return Out(view.clip_from_world * vec4f(world, 1.0), hazed(air_before(world), radiance));
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    return vec4f(in.radiance, 1.0);
}
