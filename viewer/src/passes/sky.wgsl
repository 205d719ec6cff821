// The sky at infinity behind everything, with the sun's disc.

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    // One triangle that covers the picture, at depth 0: infinitely far.
    let ndc = vec2f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
    return Corner(vec4f(ndc, 0.0, 1.0), ndc);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    let ray = view.ray_from_clip * vec4f(corner.ndc, 1.0, 1.0);
    let direction = normalize(ray.xyz);
    var radiance = sky_radiance(direction);
    // Below the horizon there is only haze: land ends where the apron ends.
    radiance = mix(radiance, haze_towards(direction), smoothstep(0.0, -0.02, direction.y));
    let beside = acos(clamp(dot(direction, view.sun_direction), -1.0, 1.0)) / view.sun_angular_radius;
    if (beside < 40.0 && direction.y > -0.01) {
        // The disc itself, and what the eye and the lens scatter around it. Far above white either way.
        let disc = smoothstep(1.1, 0.9, beside);
        let glare = 0.02 / (1.0 + beside * beside);
        radiance += view.sun_irradiance * sun_clearness() * (disc * 12.0 + glare);
    }
    return vec4f(radiance, 1.0);
}
