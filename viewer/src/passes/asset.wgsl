// Anyone's meshes: the geomorph between levels of detail, where a file has it, then glTF's metallic-roughness model, lit by
// the file's suns and by a room of soft lights. The room is a sum of spherical Gaussians, for what they look like in a
// mirror of any roughness, and how they light a wall, follows without a picture (Wang et al. 2009).

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
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uvs: vec4f,
    @location(4) color: vec4f,
    // 1 with a normal; λ.
    @location(5) normal_lambda: vec2f,
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
    out.normal_lambda = vec2f(in.tangent.w, in.lambda);
    return out;
}

// Numbers of small things may be small.
fn unit(v: vec3f) -> vec3f {
    let largest = max(max(abs(v.x), abs(v.y)), max(abs(v.z), 1e-30));
    return normalize(v / largest);
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
// behind.
fn room(direction: vec3f, blur: f32) -> vec3f {
    let steep = 0.6 + 5.0 * blur / (blur + 60.0);
    let up = clamp(0.5 + 0.5 * steep * direction.y, 0.0, 1.0);
    let ground = vec3f(0.13, 0.125, 0.12);
    let sky = vec3f(0.40, 0.41, 0.43);
    let key = lobe(direction, vec3f(0.48, 0.64, 0.6), 14.0, 4.6, blur);
    let fill = lobe(direction, vec3f(-0.8, 0.28, 0.53), 7.0, 1.0, blur);
    let rim = lobe(direction, vec3f(-0.36, 0.48, -0.8), 16.0, 3.0, blur);
    let top = lobe(direction, vec3f(0.0, 1.0, 0.0), 6.0, 0.8, blur);
    let warm = vec3f(1.0, 0.98, 0.95);
    return mix(ground, sky, up) + key * warm + (fill + rim) * vec3f(0.95, 0.98, 1.0) + top;
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

// Part of the room's light that arrives at the back of a leaf among others.
const THROUGH_OTHERS: f32 = 0.35;

fn shade(in: Out, front: bool) -> vec4f {
    let to_eye = normalize(view.eye - in.world);
    let flat_normal = unit(cross(dpdx(in.world), dpdy(in.world)));
    let faced = select(-flat_normal, flat_normal, dot(flat_normal, to_eye) > 0.0);
    let given = unit(in.normal);
    let smooth_normal = select(-given, given, front);
    var normal = select(faced, smooth_normal, in.normal_lambda.x > 0.5);
    let bumps = bumped(in, normal, uv_of(surface.uv_maps[2], in.uvs));
    normal = select(normal, bumps, surface.has_normal > 0.5);

    let texel = textureSampleBias(color_map, color_sampler, uv_of(surface.uv_maps[0], in.uvs), view.mip_bias);
    var base = surface.color * in.color * texel;
    let metal = textureSampleBias(metal_map, metal_sampler, uv_of(surface.uv_maps[1], in.uvs), view.mip_bias);
    let occluded = textureSampleBias(occlusion_map, occlusion_sampler, uv_of(surface.uv_maps[3], in.uvs), view.mip_bias).r;
    let glow = textureSampleBias(emissive_map, emissive_sampler, uv_of(surface.uv_maps[4], in.uvs), view.mip_bias).rgb;
    let tinted = view.tint_levels != 0u;
    base = vec4f(select(base.rgb, level_tint(in.normal_lambda.y), tinted), base.a);
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
    // Rough mirrors hardly see what is far from their normal: no lobe is wider than that of a wall.
    let seen = room(reflect(-to_eye, normal), 0.5 / (a * a) + 1.6);
    // What is cut out is one of many leaves, and light from behind has come through others: with all of it they would be lit alike from
    // all sides, and a crown would be flat.
    let behind = select(1.0, THROUGH_OTHERS, surface.alpha_cutoff > 0.0);
    let diffuse = point.albedo * room(normal, WALL) + point.through * (behind * room(-normal, WALL));
    var radiance = (diffuse * (1.0 - mirrored) + mirrored * seen) * open * studio.room;
    radiance += sunlight(point, studio.lights[0]) + sunlight(point, studio.lights[1]);
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
