// What the user interface consists of: egui's vertices, a texture, a colour as a factor.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var linear: sampler;

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
    @location(1) color: vec4f,
}

@vertex
fn vertex(@location(0) clip: vec2f, @location(1) uv: vec2f, @location(2) color: vec4f) -> Out {
    return Out(vec4f(clip, 0.0, 1.0), uv, color);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    return in.color * textureSample(picture, linear, in.uv);
}
