// What the sun sees of trees → how much of its light they let through to each texel of a square of ground. The edge of a shadow
// is as wide as the sun's disc makes it, by how far away on average is what throws it (Fernando, "Percentage-Closer Soft
// Shadows", 2005).

@group(1) @binding(0) var seen_by_sun: texture_depth_2d;
@group(1) @binding(1) var finer: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(corner_of_picture(index), 0.0, 1.0);
}

const TAPS: u32 = 8u;
// Columns of the rotation by the golden angle, from one tap to the next: a sine and a cosine for each take longer.
const GOLDEN_TURN = mat2x2f(vec2f(-0.737368878, 0.675490294), vec2f(-0.675490294, -0.737368878));
// From so far away edges are as wide as they get.
const FAR_M: f32 = 30.0;
const MAX_TEXELS: f32 = 9.0;

// How much light comes past what is seen at a place, between four texels.
fn is_lit(uv: vec2f, depth: f32) -> f32 {
    let four = textureGather(seen_by_sun, nearest, uv);
    let lit = select(vec4f(0.0), vec4f(1.0), four >= vec4f(depth));
    return between(lit, uv, textureDimensions(seen_by_sun));
}

@fragment
fn fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    // What the sun sees has as many texels.
    let at = pixel.xy / vec2f(textureDimensions(seen_by_sun)) - 0.5;
    let place = view.shade.xy + at * view.shade.z;
    let seen = view.shadow_from_world * vec4f(place.x, height_m(place), place.y, 1.0);
    let uv = seen.xy * vec2f(0.5, -0.5) + 0.5;
    let rows = transpose(view.shadow_from_world);
    let uv_per_m = 0.5 * vec2f(length(rows[0].xyz), length(rows[1].xyz));
    let depth_per_m = length(rows[2].xyz);
    let texel = 1.0 / vec2f(textureDimensions(seen_by_sun));
    let widest = min(view.sun_angular_radius * FAR_M * uv_per_m, MAX_TEXELS * texel);
    var lit = 1.0;
    // Beyond this disc nothing is looked up.
    if (length(at) < 0.48) {
        var away = 0.0;
        var count = 0.0;
        // Four around, and what lies right before it.
        for (var k = 0u; k < 5u; k++) {
            let corner = select(vec2f(f32(k & 1u), f32(k >> 1u)) - 0.5, vec2f(0.0), k == 4u);
            let before = (seen.z - textureGather(seen_by_sun, nearest, uv + corner * widest)) / depth_per_m;
            let hides = select(vec4f(0.0), vec4f(1.0), before > vec4f(0.0));
            away += dot(before, hides);
            count += dot(hides, vec4f(1.0));
        }
        let edge = view.sun_angular_radius * away / max(count, 1.0) * uv_per_m;
        let reach = clamp(edge, 0.6 * texel, widest + 0.6 * texel);
        let turn = 6.2831853 * dither(pixel.xy);
        var way = vec2f(cos(turn), sin(turn));
        // Where nothing is before it, nothing more is looked up.
        for (var k = 0u; k < TAPS && count > 0.0; k++) {
            let out = sqrt((f32(k) + 0.5) / f32(TAPS));
            lit -= (1.0 - is_lit(uv + out * way * reach, seen.z)) / f32(TAPS);
            way = GOLDEN_TURN * way;
        }
    }
    return vec4f(lit);
}

// The mean of four texels of the next finer version.
@fragment
fn halve(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let corner = 2 * vec2i(pixel.xy);
    var sum = 0.0;
    for (var k = 0; k < 4; k++) {
        sum += textureLoad(finer, corner + vec2i(k & 1, k >> 1u), 0).r;
    }
    return vec4f(0.25 * sum);
}
