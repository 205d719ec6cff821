// Anyone's meshes: the geomorph between levels of detail, where a file has it, then glTF's metallic-roughness model, lit by
// the file's suns and by a room of soft lights. The room is a sum of spherical Gaussians, for what they look like in a
// mirror of any roughness, and how they light a wall, follows without a picture (Wang et al. 2009). How much of it arrives is told by
// depths as the key light and sixteen lamps of a sky see them. Then what is around the file: a backdrop and the ground.

// A sun of the file.
struct Light {
    // Unit vector towards it.
    direction: vec4f,
    // On a surface that faces it; 0 for none.
    irradiance: vec4f,
}

// Unit vectors: towards a lamp of the room, and to the right of what it sees.
struct Lamp {
    towards: vec4f,
    right: vec4f,
}

// What the file is lit by, and how large it is.
struct Studio {
    lights: array<Light, 2>,
    // Factor on the room's light.
    room: f32,
    // Of a sphere around what is shown, and side of a square of the grid: for the ground.
    radius: f32,
    cell: f32,
    // How high the sphere's middle is.
    middle: f32,
    // The key light, then the sky's lamps by quarters of the compass.
    lamps: array<Lamp, 17>,
}

// How texture coordinates are looked up: 2 × 2 by rows, what is added, and which set.
struct UvMap {
    matrix: vec4f,
    offset: vec2f,
    uv_set: f32,
    unused: f32,
}

struct Surface {
    color: vec4f,
    emissive: vec3f,
    alpha_cutoff: f32,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    // 1 if it is so.
    unlit: f32,
    has_normal: f32,
    // The part of diffuse light that comes through, its colour, and 1 if the map of colours tints it, too.
    transmission: f32,
    transmission_textured: f32,
    transmission_tint: vec3f,
    // Factor on what is mirrored by what is no metal.
    specular: f32,
    // Of colour, metal and roughness, normals, occlusion, glow.
    uv_maps: array<UvMap, 5>,
}

@group(1) @binding(0) var<uniform> studio: Studio;
@group(1) @binding(1) var<storage, read> places: array<Tree>;
@group(1) @binding(2) var lamp_maps: texture_depth_2d_array;
@group(1) @binding(3) var nearest_depth: sampler;
@group(2) @binding(0) var<uniform> surface: Surface;
@group(2) @binding(1) var color_map: texture_2d<f32>;
@group(2) @binding(2) var metal_map: texture_2d<f32>;
@group(2) @binding(3) var normal_map: texture_2d<f32>;
@group(2) @binding(4) var occlusion_map: texture_2d<f32>;
@group(2) @binding(5) var emissive_map: texture_2d<f32>;
@group(2) @binding(6) var color_sampler: sampler;
@group(2) @binding(7) var metal_sampler: sampler;
@group(2) @binding(8) var normal_sampler: sampler;
@group(2) @binding(9) var occlusion_sampler: sampler;
@group(2) @binding(10) var emissive_sampler: sampler;

struct In {
    @location(0) position: vec3f,
    @location(1) color: vec4f,
    @location(2) delta: vec3f,
    @location(3) normal: vec2f,
    @location(4) uv0: vec2f,
    @location(5) uv1: vec2f,
    @location(6) uv_delta: vec2f,
    @location(7) normal_end: vec2f,
    // Octahedral tangent; sign of the bitangent, 0 without a tangent; 0 without a normal.
    @location(8) tangent: vec4f,
    @location(9) place: u32,
    // λ, as of trees.
    @location(10) lambda: f32,
    // Metres by which it is off at that λ.
    @location(11) error: f32,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uvs: vec4f,
    @location(4) color: vec4f,
    // 1 with a normal; λ; metres by which it is off.
    @location(5) normal_lambda_error: vec3f,
}

@vertex
fn vertex(in: In) -> Out {
    let rows = places[in.place].rows;
    let alpha = morphed(in.lambda);
    let world = from_template(rows, in.position + alpha * in.delta);
    let turned = normalize(mix(octahedral(in.normal), octahedral(in.normal_end), alpha));
    let normal = normal_from_template(rows, turned);
    // Of a mirrored copy they point inwards.
    let mirrored = dot(cross(rows[0].xyz, rows[1].xyz), rows[2].xyz) < 0.0;
    let tangent = way_from_template(rows, octahedral(in.tangent.xy));
    var out: Out;
    out.clip = view.clip_from_world * vec4f(world, 1.0);
    out.world = world;
    out.normal = unit(select(normal, -normal, mirrored));
    out.tangent = vec4f(unit(tangent), select(in.tangent.z, -in.tangent.z, mirrored));
    out.uvs = vec4f(in.uv0 + alpha * in.uv_delta, in.uv1);
    out.color = in.color;
    out.normal_lambda_error = vec3f(in.tangent.w, in.lambda, in.error);
    return out;
}

// Numbers of small things may be small.
fn unit(v: vec3f) -> vec3f {
    let largest = max(max(abs(v.x), abs(v.y)), max(abs(v.z), 1e-30));
    return normalize(v / largest);
}

// As a lamp sees it, at the level that was chosen.
struct Seen {
    @builtin(position) clip: vec4f,
    @location(0) uvs: vec4f,
    @location(1) alpha: f32,
}

@vertex
fn seen_by_lamp(in: In) -> Seen {
    let world = from_template(places[in.place].rows, in.position);
    return Seen(view.shadow_from_world * vec4f(world, 1.0), vec4f(in.uv0, in.uv1), in.color.a);
}

@fragment
fn hole(in: Seen) {
    let texel = textureSample(color_map, color_sampler, uv_of(surface.uv_maps[0], in.uvs));
    if (surface.color.a * in.alpha * texel.a < surface.alpha_cutoff) {
        discard;
    }
}

fn uv_of(map: UvMap, uvs: vec4f) -> vec2f {
    let uv = select(uvs.xy, uvs.zw, map.uv_set > 0.5);
    return vec2f(dot(map.matrix.xy, uv), dot(map.matrix.zw, uv)) + map.offset;
}

// A soft light as seen in a direction, blurred: `own` and `blur` are the sharpness of the two Gaussians.
fn lobe(direction: vec3f, towards: vec3f, own: f32, amount: f32, blur: f32) -> f32 {
    let sharpness = own * blur / (own + blur);
    return amount * sharpness / own * exp(sharpness * (dot(direction, towards) - 1.0));
}

// How sharp the cosine of a wall's light is, as a Gaussian.
const WALL: f32 = 2.1;

// The room: brighter above than below, a key light at the right of whoever looks at the front, a fill at the left, a rim
// behind; and how much of the key and of all else arrives.
fn room(direction: vec3f, blur: f32, key_reached: f32, sky_reached: f32) -> vec3f {
    let steep = 0.6 + 5.0 * blur / (blur + 60.0);
    let up = clamp(0.5 + 0.5 * steep * direction.y, 0.0, 1.0);
    let ground = vec3f(0.30, 0.29, 0.27);
    let sky = vec3f(0.52, 0.56, 0.62);
    let key = lobe(direction, vec3f(0.48, 0.64, 0.6), 14.0, 11.0, blur);
    let fill = lobe(direction, vec3f(-0.8, 0.28, 0.53), 7.0, 1.3, blur);
    let rim = lobe(direction, vec3f(-0.36, 0.48, -0.8), 16.0, 4.0, blur);
    let top = lobe(direction, vec3f(0.0, 1.0, 0.0), 6.0, 1.0, blur);
    let warm = vec3f(1.0, 0.98, 0.95);
    let around = mix(ground, sky, up) + (fill + rim) * vec3f(0.95, 0.98, 1.0) + top;
    return key * key_reached * warm + around * sky_reached;
}

// Lamps of the sky in a quarter of the compass, one to a ring: a place asks one of each quarter, each in another ring, and which they
// are is by chance.
override RINGS: u32;
// Part of a lamp's depths, beside a half, that what is shown takes.
override HALF_DEPTH: f32;

// Whether light of a lamp reaches a place, by what the lamp sees; between four texels. What shades it lies so far before it as
// the place is off its wall.
fn lamp_reaches(number: u32, off_wall: vec4f) -> f32 {
    let place = off_wall.xyz;
    let lamp = studio.lamps[number];
    let up = cross(lamp.towards.xyz, lamp.right.xyz);
    let uv = 0.5 + 0.5 * vec2f(dot(lamp.right.xyz, place), -dot(up, place));
    let depth = 0.5 - HALF_DEPTH * dot(lamp.towards.xyz, place);
    let four = textureGather(lamp_maps, nearest_depth, uv, number);
    // Where nothing is, it is as far as can be told; and outside all is lit.
    let lit = select(saturate(1.5 - (depth - four) / (HALF_DEPTH * off_wall.w)), vec4f(1.0), four > vec4f(0.999));
    return select(1.0, between(lit, uv, textureDimensions(lamp_maps)), all(uv == saturate(uv)));
}

// A place off its wall in units of the sphere, and by how much: for `error`, metres by which the wall may be elsewhere in what lamps see.
fn beside_wall(world: vec3f, flat_normal: vec3f, error: f32) -> vec4f {
    let beside = 3.0 / f32(textureDimensions(lamp_maps).x) + 2.0 * error / studio.radius;
    return vec4f((world - vec3f(0.0, studio.middle, 0.0)) / studio.radius + flat_normal * beside, beside);
}

// What of the sky's light reaches such a place on a wall that faces one way, and on one that faces the other.
fn sky_reaches(place: vec4f, normal: vec3f, chance: f32) -> vec2f {
    var light = vec2f(0.0);
    var most = vec2f(0.0);
    for (var quarter = 0u; quarter < RINGS; quarter++) {
        let ring = u32(fract(chance + 0.25 * f32(quarter)) * f32(RINGS));
        let number = 1u + quarter * RINGS + min(ring, RINGS - 1u);
        let facing = dot(normal, studio.lamps[number].towards.xyz);
        // Light from the ground, too, arrives where the sky's does.
        let share = 0.1 + max(vec2f(facing, -facing), vec2f(0.0));
        light += share * lamp_reaches(number, place);
        most += share;
    }
    return light / most;
}

// What a rough mirror reflects of light from everywhere (Karis 2014): factor on the reflectance, and what is added.
fn mirrored_part(roughness: f32, facing: f32) -> vec2f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * facing)) * r.x + r.y;
    return vec2f(-1.04, 1.04) * a + r.zw;
}

struct Point {
    albedo: vec3f,
    // The same of light from behind.
    through: vec3f,
    // Reflectance of a mirror at right angles.
    mirror: vec3f,
    // The same along its surface.
    grazing: f32,
    normal: vec3f,
    to_eye: vec3f,
    roughness: f32,
}

fn sunlight(point: Point, light: Light) -> vec3f {
    let to_sun = light.direction.xyz;
    let half = normalize(to_sun + point.to_eye);
    let sun = max(dot(point.normal, to_sun), 0.0);
    let facing = max(dot(point.normal, point.to_eye), 1e-3);
    let h = max(dot(point.normal, half), 0.0);
    let a2 = max(point.roughness * point.roughness * point.roughness * point.roughness, 1e-5);
    let d = h * h * (a2 - 1.0) + 1.0;
    let spread = a2 / (PI * d * d);
    let shade = 0.5 / mix(2.0 * sun * facing, sun + facing, sqrt(a2));
    let away = 1.0 - clamp(dot(half, point.to_eye), 0.0, 1.0);
    let graze = away * away * away * away * away;
    let fresnel = point.mirror + (point.grazing - point.mirror) * graze;
    // Where the room's camera sees a mirror of the sun it is bright, and no brighter than can be shown.
    let gloss = min(spread * max(shade, 0.0), 200.0);
    let behind = max(-dot(point.normal, to_sun), 0.0) * point.through / PI;
    return ((point.albedo / PI * (1.0 - fresnel) + fresnel * gloss) * sun + behind) * light.irradiance.xyz;
}

fn bumped(in: Out, normal: vec3f, uv: vec2f) -> vec3f {
    let bump = (textureSampleBias(normal_map, normal_sampler, uv, view.mip_bias).xyz * 2.0 - 1.0) * vec3f(vec2f(surface.normal_scale), 1.0);
    // A file without tangents: where texture coordinates grow on the surface (Schüler 2013).
    let across = cross(dpdy(in.world), normal);
    let along = cross(normal, dpdx(in.world));
    let t = across * dpdx(uv.x) + along * dpdy(uv.x);
    let b = across * dpdx(uv.y) + along * dpdy(uv.y);
    let size = inverseSqrt(max(max(dot(t, t), dot(b, b)), 1e-30));
    let made = t * size * bump.x + b * size * bump.y;
    let tangent = normalize(in.tangent.xyz - normal * dot(in.tangent.xyz, normal) + vec3f(1e-9));
    let told = tangent * bump.x + cross(normal, tangent) * sign(in.tangent.w) * bump.y;
    let aside = select(made, told, abs(in.tangent.w) > 0.5);
    return normalize(aside + normal * bump.z);
}

// What is left of the key light and of all else where nothing of it reaches a place straight: what other walls give back, and among
// leaves, which are cut out, what comes through them.
const FROM_OTHERS: f32 = 0.12;
const THROUGH_LEAVES = vec2f(0.05, 0.22);

fn shade(in: Out, front: bool) -> vec4f {
    let to_eye = normalize(view.eye - in.world);
    let flat_normal = unit(cross(dpdx(in.world), dpdy(in.world)));
    let faced = select(-flat_normal, flat_normal, dot(flat_normal, to_eye) > 0.0);
    let given = unit(in.normal);
    let smooth_normal = select(-given, given, front);
    var normal = select(faced, smooth_normal, in.normal_lambda_error.x > 0.5);
    let bumps = bumped(in, normal, uv_of(surface.uv_maps[2], in.uvs));
    normal = select(normal, bumps, surface.has_normal > 0.5);

    let texel = textureSampleBias(color_map, color_sampler, uv_of(surface.uv_maps[0], in.uvs), view.mip_bias);
    var base = surface.color * in.color * texel;
    let metal = textureSampleBias(metal_map, metal_sampler, uv_of(surface.uv_maps[1], in.uvs), view.mip_bias);
    let occluded = textureSampleBias(occlusion_map, occlusion_sampler, uv_of(surface.uv_maps[3], in.uvs), view.mip_bias).r;
    let glow = textureSampleBias(emissive_map, emissive_sampler, uv_of(surface.uv_maps[4], in.uvs), view.mip_bias).rgb;
    let tinted = view.tint_levels != 0u;
    base = vec4f(select(base.rgb, level_tint(in.normal_lambda_error.y), tinted), base.a);
    let metallic = select(clamp(surface.metallic * metal.b, 0.0, 1.0), 0.0, tinted);
    let open = mix(1.0, occluded, surface.occlusion_strength);

    var point: Point;
    let transmission = surface.transmission * (1.0 - metallic);
    let tint = surface.transmission_tint * mix(vec3f(1.0), texel.rgb, surface.transmission_textured);
    point.albedo = base.rgb * (1.0 - metallic) * (1.0 - transmission);
    point.through = transmission * select(tint, base.rgb, tinted);
    point.mirror = mix(vec3f(0.04 * surface.specular), base.rgb, metallic);
    point.grazing = mix(surface.specular, 1.0, metallic);
    point.normal = normal;
    point.to_eye = to_eye;
    point.roughness = clamp(surface.roughness * metal.g, 0.045, 1.0);
    let facing = max(dot(normal, to_eye), 1e-3);
    let a = point.roughness * point.roughness;
    let mirror = mirrored_part(point.roughness, facing);
    // With what is reflected twice and more between the facets of a rough mirror (Turquin 2019).
    let again = 1.0 + point.mirror * (1.0 / max(mirror.x + mirror.y, 0.05) - 1.0);
    let mirrored = (point.mirror * mirror.x + point.grazing * mirror.y) * again;
    // Leaves shade each other whether or not they are where others were; less so the large ones of coarse levels, which reach into the
    // shade of a crown with what stands for its outside.
    let is_leaf = surface.alpha_cutoff > 0.0;
    let error = in.normal_lambda_error.z * select(1.0, 0.5, is_leaf);
    let place = beside_wall(in.world, faced, error);
    let left = select(vec2f(0.0, FROM_OTHERS), THROUGH_LEAVES, is_leaf);
    let from_key = mix(left.x, 1.0, lamp_reaches(0u, place));
    let from_sky = mix(vec2f(left.y), vec2f(1.0), sky_reaches(place, normal, dither(in.clip.xy)));
    // Under a sun of the file the room's own key light, which no lamp stands for then, is as the rest of the room.
    let key = select(vec2f(from_key), from_sky, studio.room < 1.0);
    // Rough mirrors hardly see what is far from their normal: no lobe is wider than that of a wall. A smooth one sees beside what shades it.
    let seen = room(reflect(-to_eye, normal), 0.5 / (a * a) + 1.6, key.x, mix(1.0, from_sky.x, a));
    let diffuse = point.albedo * room(normal, WALL, key.x, from_sky.x) + point.through * room(-normal, WALL, key.y, from_sky.y);
    var radiance = (diffuse * (1.0 - mirrored) + mirrored * seen) * open * studio.room;
    radiance += sunlight(point, studio.lights[0]) * from_key + sunlight(point, studio.lights[1]);
    radiance += surface.emissive * select(glow, vec3f(0.0), tinted);
    return vec4f(select(radiance, unlit(base.rgb), surface.unlit > 0.5), base.a);
}

// What tone mapping turns into the very colour: the inverse of what it takes from dark colours.
fn unlit(color: vec3f) -> vec3f {
    let low = min(min(color.r, color.g), color.b);
    let taken = select(0.04, 0.4 * sqrt(max(low, 0.0)) - low, low < 0.04);
    return (color + taken) / view.exposure;
}

@fragment
fn solid(in: Out, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return vec4f(shade(in, front).rgb, 1.0);
}

@fragment
fn masked(in: Out, @builtin(front_facing) front: bool) -> Pixel {
    let shaded = shade(in, front);
    let samples = cut_out(shaded.a, surface.alpha_cutoff);
    if (samples == 0u) {
        discard;
    }
    return Pixel(vec4f(shaded.rgb, 1.0), samples);
}

@fragment
fn blended(in: Out, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return shade(in, front);
}

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    // At depth 0: infinitely far.
    let ndc = corner_of_picture(index);
    return Corner(vec4f(ndc, 0.0, 1.0), ndc);
}

fn ray(in: Corner) -> vec3f {
    return normalize((view.ray_from_clip * vec4f(in.ndc, 1.0, 1.0)).xyz);
}

// Like a room's wall that goes over into its floor: light at the horizon, darker above and at one's feet.
@fragment
fn backdrop(in: Corner) -> @location(0) vec4f {
    let up = ray(in).y;
    let horizon = vec3f(0.46, 0.472, 0.485);
    let above = mix(horizon, vec3f(0.17, 0.205, 0.26), smoothstep(0.0, 0.9, up));
    let below = mix(horizon, vec3f(0.28, 0.276, 0.268), smoothstep(0.0, 0.6, -up));
    return vec4f(select(below, above, up > 0.0) / view.exposure, 1.0);
}

// How much of a pixel the lines of a grid cover; nothing where they would run into each other.
fn lines(place: vec2f, cell: f32) -> f32 {
    let at = place / cell;
    let width = max(fwidth(at), vec2f(1e-6));
    let beside = abs(fract(at - 0.5) - 0.5) / width;
    let line = (1.0 - clamp(beside, vec2f(0.0), vec2f(1.0))) * (1.0 - smoothstep(vec2f(0.1), vec2f(0.4), width));
    return max(line.x, line.y);
}

// Part of the light on the ground that is the key light's.
const KEY_ON_GROUND: f32 = 0.48;
// How wide shadows by lamps of the sky are smeared there, as a part of the way from the middle.
const BLUR: f32 = 0.3;

struct Ground {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn grid(in: Corner) -> Ground {
    let direction = ray(in);
    let away = -view.eye.y / direction.y;
    let place = view.eye + away * direction;
    let near = 1.0 - smoothstep(1.5 * studio.radius, 7.0 * studio.radius, length(place.xz));
    let up = vec3f(0.0, 1.0, 0.0);
    // The farther from what stands there, the softer: or one would see sixteen shadows.
    let chance = dither(in.clip.xy);
    let turn = 2.0 * PI * fract(7.0 * chance);
    let aside = BLUR * min(length(place.xz), studio.radius) * sqrt(chance) * vec3f(cos(turn), 0.0, sin(turn));
    let from_key = lamp_reaches(0u, beside_wall(place, up, 0.0));
    // Of both halves of each quarter, for here nothing hides what is by chance.
    let off_ground = beside_wall(place + aside, up, 0.0);
    let from_sky = 0.5 * (sky_reaches(off_ground, up, chance).x + sky_reaches(off_ground, up, fract(chance + 0.5)).x);
    // How much of its light the ground lacks.
    let shade = near * (1.0 - mix(from_sky, from_key, KEY_ON_GROUND));
    let fine = lines(place.xz, studio.cell * 0.1);
    let coarse = lines(place.xz, studio.cell);
    let clip = view.clip_from_world * vec4f(place, 1.0);
    let line = near * max(0.14 * fine, 0.35 * coarse);
    // Lines, too, lie in the shade, which is black before what is behind.
    let amount = 1.0 - (1.0 - line) * (1.0 - shade);
    if (!(away > 0.0) || amount < 0.002) {
        discard;
    }
    let color = vec3f(0.8) * (line * (1.0 - shade) / amount);
    return Ground(vec4f(color / view.exposure, amount), clip.z / clip.w);
}
