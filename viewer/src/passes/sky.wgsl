// The sky at infinity behind everything, with the sun's disc.

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec2f,
    // Of the sun's disc.
    @location(1) @interpolate(flat) sun_clearness: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    // At depth 0: infinitely far.
    let ndc = corner_of_picture(index);
    return Corner(vec4f(ndc, 0.0, 1.0), ndc, sun_clearness());
}

fn direction_of(corner: Corner) -> vec3f {
    let ray = view.ray_from_clip * vec4f(corner.ndc, 1.0, 1.0);
    return normalize(ray.xyz);
}

// Below the horizon there is only haze, as there is at it: land ends where the apron ends.
fn above_horizon(direction: vec3f) -> vec3f {
    return vec3f(direction.x, max(direction.y, 0.0), direction.z);
}

// Nearly always: one copy of the clouds is all that is seen. Without the other one all of it takes four fifths of the time.
@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    let direction = direction_of(corner);
    let above = above_horizon(direction);
    let clouds = painted_clouds(before_drift(above, view.drift.xy * drifting(above)), true, 0.0);
    return radiance_of(corner, direction, clouds);
}

// While one copy fades into the other.
@fragment
fn fading(corner: Corner) -> @location(0) vec4f {
    let direction = direction_of(corner);
    return radiance_of(corner, direction, clouds_towards(above_horizon(direction), true, 0.0));
}

fn radiance_of(corner: Corner, direction: vec3f, clouds: vec3f) -> vec4f {
    let seen = clouds * smoothstep(-0.02, 0.0, direction.y);
    var radiance = max(clear_sky(direction) + seen, vec3f(0.0));
    // The chord is the angle, within two thousandths where it counts.
    let beside = distance(direction, view.sun_direction) / view.sun_angular_radius;
    if (beside < 40.0 && direction.y > -0.01) {
        // The disc itself, and what the eye and the lens scatter around it. Far above white either way.
        let disc = smoothstep(1.1, 0.9, beside);
        let glare = 0.02 / (1.0 + beside * beside);
        radiance += view.sun_irradiance * corner.sun_clearness * (disc * 12.0 + glare);
    }
    return vec4f(radiance, 1.0);
}
