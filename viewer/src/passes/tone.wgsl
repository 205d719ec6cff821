// Tone mapping: radiance → display values, encoded as sRGB shows them: exposure, a film-like curve (AgX, Sobotka 2022, as
// fitted by Wrensch 2023), dither.

@group(1) @binding(0) var radiance: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(corner_of_picture(index), 0.0, 1.0);
}

// From linear Rec. 709 into AgX's wider primaries, column by column.
const INSET = mat3x3f(
    vec3f(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
    vec3f(0.0784335999999992, 0.878468636469772, 0.0784336),
    vec3f(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
);
const OUTSET = mat3x3f(
    vec3f(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
    vec3f(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
    vec3f(-0.0990297440797205, -0.0989611768448433, 1.15107367264116),
);
const MIN_EV: f32 = -12.47393;
const MAX_EV: f32 = 4.026069;

fn curve(x: vec3f) -> vec3f {
    let x2 = x * x;
    let x4 = x2 * x2;
    return 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
}

fn film(linear: vec3f) -> vec3f {
    let wide = max(INSET * linear, vec3f(1e-10));
    let ev = clamp((log2(wide) - MIN_EV) / (MAX_EV - MIN_EV), vec3f(0.0), vec3f(1.0));
    let toned = max(curve(ev), vec3f(0.0));
    // A little more contrast and colour than the neutral look (Troy Sobotka's "Punchy", two thirds of the way).
    let luma = luminance(toned);
    // To the power of 1.25, without a logarithm.
    let color = toned * sqrt(sqrt(toned));
    let grey = vec3f(luma * sqrt(sqrt(luma)));
    return clamp(OUTSET * (grey + 1.22 * (color - grey)), vec3f(0.0), vec3f(1.0));
}

// A grain of less than one step of 8 bits, the same every frame: without it skies show bands.
fn grain(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5;
}

@fragment
fn fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let linear = textureLoad(radiance, vec2i(pixel.xy), 0).rgb * view.exposure;
    let encoded = film(linear) + grain(pixel.xy) / 255.0;
    return vec4f(encoded, 1.0);
}

// Keeps the colours of materials under a neutral light (Khronos PBR Neutral, 2024).
fn kept(linear: vec3f) -> vec3f {
    let low = min(min(linear.r, linear.g), linear.b);
    let color = linear - select(0.04, low - 6.25 * low * low, low < 0.08);
    let peak = max(max(color.r, color.g), color.b);
    let start = 0.76;
    let room = 1.0 - start;
    let lowered = 1.0 - room * room / max(peak + room - start, room);
    let white = 1.0 - 1.0 / (0.15 * (peak - lowered) + 1.0);
    return select(mix(color * lowered / peak, vec3f(lowered), white), color, peak < start);
}

fn srgb(linear: vec3f) -> vec3f {
    let bright = 1.055 * pow(max(linear, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055;
    return select(bright, 12.92 * linear, linear < vec3f(0.0031308));
}

@fragment
fn neutral(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let linear = max(textureLoad(radiance, vec2i(pixel.xy), 0).rgb * view.exposure, vec3f(0.0));
    return vec4f(srgb(kept(linear)) + grain(pixel.xy) / 255.0, 1.0);
}
