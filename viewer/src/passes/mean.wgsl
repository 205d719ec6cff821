// Accumulation: radiance → its share in the mean of several pictures of the same; blending weighs it.

@group(1) @binding(0) var radiance: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(corner_of_picture(index), 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    return textureLoad(radiance, vec2i(pixel.xy), 0);
}
