// Trees: the geomorph between D_i and D_{i+1} (thesis 4.3), then light on bark and leaves.

@group(1) @binding(0) var<storage, read> trees: array<Tree>;
@group(2) @binding(0) var<uniform> material: Material;
@group(2) @binding(1) var color_map: texture_2d<f32>;
@group(2) @binding(2) var normal_map: texture_2d<f32>;

struct In {
    @builtin(vertex_index) vertex: u32,
    @location(0) position: vec3f,
    @location(1) color: vec4f,
    @location(2) delta: vec3f,
    @location(3) normal: vec2f,
    @location(4) uv: vec2f,
    @location(5) uv_delta: vec2f,
    @location(6) normal_end: vec2f,
    @location(7) tangent: vec2f,
    @location(8) tree: u32,
    // λ: level of detail and, after the point, how far it has morphed to the next.
    @location(9) lambda: f32,
    // Which of its leaves' pixels are drawn, from where to where: the others show clusters or its picture. Bark is drawn from the
    // third number on.
    @location(10) shown: vec4f,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    // Within the triangle.
    @location(3) @interpolate(perspective, centroid) uv: vec2f,
    @location(4) color: vec3f,
    // Leaves: share of the open sky and ground that they see between their neighbours.
    @location(5) open: f32,
    @location(6) @interpolate(flat) shown: vec2f,
    // See `air_before`.
    @location(7) @interpolate(flat) air: vec4f,
    // By chance, [0, 1): another for each triangle.
    @location(8) @interpolate(flat) chance: f32,
    // Beyond the field, what is left of the sun behind the crown; else 1.
    @location(9) sun: f32,
    // At the middle of the pixel.
    @location(10) middle: vec2f,
    // What the land leaves of the sun.
    @location(11) @interpolate(flat) past_land: f32,
}

fn placed(in: In) -> Out {
    let rows = trees[in.tree].rows;
    let alpha = morphed(in.lambda);
    let world = from_template(rows, in.position + alpha * in.delta);
    let turned = normalize(mix(octahedral(in.normal), octahedral(in.normal_end), alpha));
    let tangent = way_from_template(rows, octahedral(in.tangent));
    var out: Out;
    out.clip = view.clip_from_world * vec4f(world, 1.0);
    out.world = world;
    out.normal = normalize(normal_from_template(rows, turned));
    out.tangent = vec4f(normalize(tangent), in.color.a * 2.0 - 1.0);
    out.uv = in.uv + alpha * in.uv_delta;
    out.middle = out.uv;
    out.color = select(in.color.rgb, level_tint(in.lambda) * 1.6, view.tint_levels != 0u);
    out.open = in.color.a;
    out.shown = in.shown.xy;
    out.air = air_before(world);
    out.chance = scattered(vec2f(f32(in.vertex), f32(in.tree)));
    out.past_land = sun_past_land(rows, trees[in.tree].template_and_sun);
    out.sun = 1.0;
    if (is_beyond_field(rows) && trees[in.tree].crown.x != 0u) {
        out.sun = sun_behind_crown(in.tree, in.position + alpha * in.delta);
    }
    return out;
}

fn sun_behind_crown(tree: u32, place: vec3f) -> f32 {
    let height_and_x = unpack2x16float(trees[tree].crown.x);
    let half = vec3f(height_and_x.y, unpack2x16float(trees[tree].crown.y));
    let to_sun = way_to_template(trees[tree].rows, view.sun_direction);
    return sun_through_crown((place - vec3f(0.0, height_and_x.x, 0.0)) / half, normalize(to_sun / half));
}

@vertex
fn vertex(in: In) -> Out {
    return placed(in);
}

// Bark is of the level that goes on to the last of the pixels, and there whole but for what its picture shows.
@vertex
fn bark_vertex(in: In) -> Out {
    var out = placed(in);
    if (in.shown.y < 1.0) {
        // Outside of all pictures.
        out.clip = vec4f(0.0, 0.0, 2.0, 1.0);
    }
    out.shown = vec2f(in.shown.z, 1.0);
    return out;
}

// Pixels of slivers may lie beyond their edges, where what is interpolated is any number, black or glaring. They are left to what
// is behind.
fn is_beyond(color: vec3f) -> bool {
    return any(color < vec3f(0.0)) || any(color > vec3f(2.0));
}

fn ambient(normal: vec3f, albedo: vec3f) -> vec3f {
    return albedo / PI * ambient_light(0.5 + 0.5 * normal.y);
}

@fragment
fn bark(in: Out) -> @location(0) vec4f {
    var albedo = in.color * material.factor.rgb;
    var normal = normalize(in.normal);
    albedo *= albedo_of(textureSampleBias(color_map, repeating, in.uv, view.mip_bias).rgb);
    let bump = textureSampleBias(normal_map, repeating, in.uv, view.mip_bias).xyz * 2.0 - 1.0;
    // Not before its textures are read: their mip levels depend on the pixels around.
    if ((in.shown.x > 0.0 && !is_shown(in.clip.xy, in.shown)) || is_beyond(in.color)) {
        discard;
    }
    let tangent = normalize(in.tangent.xyz - normal * dot(in.tangent.xyz, normal));
    let bitangent = cross(normal, tangent) * in.tangent.w;
    let bumped = normalize(tangent * bump.x + bitangent * bump.y + normal * bump.z);
    normal = select(normal, bumped, material.has_normal > 0.5);
    let facing = max(dot(normal, view.sun_direction), 0.0);
    var radiance = ambient(normal, albedo) * 0.8;
    if (facing > 0.0) {
        radiance += albedo / PI * view.sun_irradiance * facing * in.sun * sun_visibility(in.world, 0.25);
    }
    return vec4f(hazed(in.air, radiance), 1.0);
}

// A leaf has two sides and lets light through: seen from the side that the sun doesn't shine on it glows. In its own shade is
// what lies less than `bias_m` behind others.
fn leaf_light(in: Out, card: Card, normal: vec3f, bias_m: f32) -> Pixel {
    let albedo = card.albedo;
    let to_eye = normalize(view.eye - in.world);
    let toward_sun = dot(normal, view.sun_direction);
    let same_side = toward_sun * dot(normal, to_eye) > 0.0;
    let lit = abs(toward_sun) * 0.75 + 0.25;
    // Chlorophyll takes red and blue on the way through.
    let through = albedo * vec3f(0.75, 0.9, 0.3);
    let reflected = select(through * 0.6, albedo * 0.8, same_side) * lit;
    let outward = outwardness(in.open);
    let sun = sun_visibility(in.world, bias_m) * outward;
    let upper = select(-normal, normal, normal.y > 0.0);
    var radiance = ambient(upper, albedo) * (0.15 + 0.75 * in.open * in.open);
    let given_back = (reflected + through * glow(dot(to_eye, view.sun_direction))) * sun + by_way_of_others(albedo, outward) * in.past_land;
    radiance += given_back / PI * view.sun_irradiance * in.sun;
    return Pixel(vec4f(hazed(in.air, radiance), 1.0), card.samples);
}

// What a card shows at a pixel, and at which of its samples.
struct Card {
    albedo: vec3f,
    samples: u32,
}

// Colour, and alpha: where the pixel's middle is, as other triangles of the same card have it. Within the triangle, pixels at the
// card's edges would all show what is farther in, and the card cover more than it does. But a leaf smaller than a pixel seldom
// holds the pixel's middle.
fn picture_at(in: Out) -> vec4f {
    let uv = select(in.uv, in.middle, is_on_picture(in.middle));
    let texel = textureSampleBias(color_map, clamped, uv, view.mip_bias);
    return vec4f(in.color, 1.0) * material.factor * vec4f(albedo_of(texel.rgb), texel.a);
}

// A number in [0, 1) by chance: another for each of the cards that may lie at a pixel.
fn card_noise(in: Out) -> f32 {
    return scattered_anew(floor(in.clip.xy) + 977.0 * in.chance);
}

// Metres from the eye within which no leaf is drawn, and beyond which all are: who walks under branches parts them.
const PARTED_M = vec2f(0.5, 1.3);

// Those samples of a leaf's pixel that are left of it.
fn left_by_the_eye(in: Out) -> u32 {
    let away_m = distance(in.world, view.eye);
    if (away_m > PARTED_M.y) {
        return 15u;
    }
    return samples_of(smoothstep(PARTED_M.x, PARTED_M.y, away_m), card_noise(in));
}

fn is_drawn(in: Out, samples: u32) -> bool {
    return samples != 0u && is_on_picture(in.uv) && is_shown(in.clip.xy, in.shown) && !is_beyond(in.color);
}

fn card_at(in: Out) -> Card {
    let picture = picture_at(in);
    let samples = cut_out(picture.a, material.alpha_cutoff) & left_by_the_eye(in);
    if (!is_drawn(in, samples)) {
        discard;
    }
    return Card(picture.rgb, samples);
}

@fragment
fn leaf(in: Out) -> Pixel {
    return leaf_light(in, card_at(in), normalize(in.normal), 0.4);
}

// Twigs in winter are thinner than the texels of their picture, whose alpha is the share that they cover, and than pixels, so that
// their sides cannot be told: light as in a picture of the whole tree, `pixel` of `impostors.wgsl`.
@fragment
fn twig(in: Out) -> Pixel {
    let picture = picture_at(in);
    let samples = samples_of(picture.a, card_noise(in)) & left_by_the_eye(in);
    if (!is_drawn(in, samples)) {
        discard;
    }
    let cosine = dot(normalize(view.eye - in.world), view.sun_direction);
    let sun = view.sun_irradiance * phase(cosine) * in.sun * sun_visibility(in.world, 0.4);
    let radiance = picture.rgb / PI * (0.8 * ambient_light(0.5) + sun);
    return Pixel(vec4f(hazed(in.air, radiance), 1.0), samples);
}

// So far before a card are the outermost of the leaves that it shows, which are not in their own shade.
const CLUSTER_BIAS_M = 0.45;

@fragment
fn cluster(in: Out) -> Pixel {
    let bump = textureSampleBias(normal_map, clamped, in.uv, view.mip_bias).xyz * 2.0 - 1.0;
    let right = normalize(in.tangent.xyz);
    let front = normalize(in.normal);
    let normal = normalize(right * bump.x + cross(front, right) * bump.y + front * bump.z);
    return leaf_light(in, card_at(in), normal, CLUSTER_BIAS_M);
}
