// The lake: sky mirrored by small waves, the ground showing through where it is shallow.

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Out {
    // Counter-clockwise from above.
    let corner = array<vec2f, 6>(
        vec2f(-1.0, -1.0), vec2f(-1.0, 1.0), vec2f(1.0, 1.0), vec2f(-1.0, -1.0), vec2f(1.0, 1.0), vec2f(1.0, -1.0),
    )[index];
    let world = vec3f(corner.x * 4096.0, view.water_level, corner.y * 4096.0);
    return Out(view.clip_from_world * vec4f(world, 1.0), world);
}

// Slope of the surface: waves of five directions and lengths, none shorter than a pixel.
fn slope(place: vec2f, pixel_m: f32) -> vec2f {
    var sum = vec2f(0.0);
    var turn = 0.4;
    var length_m = 5.3;
    for (var wave = 0; wave < 6; wave++) {
        let direction = vec2f(cos(turn), sin(turn));
        let k = 2.0 * PI / length_m;
        // Deep water: the square of the frequency is g·k.
        let phase = dot(direction, place) * k - sqrt(9.81 * k) * view.time_s;
        let seen = smoothstep(0.7, 0.2, pixel_m / length_m);
        sum += direction * cos(phase + 1.7 * sin(dot(place.yx, direction) * k * 0.23)) * 0.014 * seen;
        turn += 2.1;
        length_m *= 0.61;
    }
    return sum;
}

// Where a mirrored ray meets the land: 1 where it does, and how far away.
fn meets_land(start: vec3f, direction: vec3f) -> vec2f {
    var away = 6.0;
    for (var i = 0; i < 14; i++) {
        let at = start + direction * away;
        if (any(abs(at.xz) > vec2f(view.field.z)) || at.y > view.field.w) {
            break;
        }
        if (at.y < height_m(at.xz)) {
            return vec2f(1.0, away);
        }
        away *= 1.45;
    }
    return vec2f(0.0, away);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let to_eye = view.eye - in.world;
    let away = length(to_eye);
    let look = to_eye / away;
    let inside = all(abs(in.world.xz) < vec2f(view.field.z));
    var depth = 8.0;
    if (inside) {
        depth = view.water_level - height_m(in.world.xz);
    }
    let pixel_m = away / view.focal_px / max(look.y, 0.02);
    let tilt = slope(in.world.xz, pixel_m) * smoothstep(0.0, 0.6, depth);
    let normal = normalize(vec3f(-tilt.x, 1.0, -tilt.y));
    var mirrored = reflect(-look, normal);
    mirrored.y = max(mirrored.y, 0.01);
    mirrored = normalize(mirrored);
    var sky = sky_radiance(mirrored);
    let hit = meets_land(in.world, mirrored);
    if (hit.x > 0.5) {
        let shore = field_uv(in.world.xz + mirrored.xz * hit.y);
        let light = textureSampleLevel(light_map, clamped, shore, 0.0);
        let lit = vec3f(0.07, 0.075, 0.05) / PI * (view.sun_irradiance * light.g + view.sky_irradiance * light.r);
        sky = aerial_perspective(lit, hit.y);
    }
    // Schlick's fresnel with the reflectance of water.
    let facing = clamp(dot(normal, look), 0.0, 1.0);
    let mirror = 0.02 + 0.98 * pow(1.0 - facing, 5.0);
    let half_way = normalize(look + view.sun_direction);
    var light = vec4f(1.0);
    if (inside) {
        light = textureSampleLevel(light_map, clamped, field_uv(in.world.xz), 0.0);
    }
    let glint = pow(max(dot(normal, half_way), 0.0), 900.0) * 60.0 * light.b;
    let body = vec3f(0.012, 0.035, 0.032) * (view.sky_irradiance * light.r + 0.5 * view.sun_irradiance * light.b);
    let clearness = exp(-max(depth, 0.0) * vec3f(0.9, 0.55, 0.6));
    let opaque = 1.0 - (clearness.x + clearness.y + clearness.z) / 3.0;
    let edge = smoothstep(0.0, 0.12, depth);
    let radiance = mix(body * opaque, sky, mirror) + view.sun_irradiance * glint * mirror;
    let alpha = (mirror + (1.0 - mirror) * opaque) * edge;
    return vec4f(aerial_perspective(radiance, away) * edge, alpha);
}
