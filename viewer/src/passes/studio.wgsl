// What is around a file that is shown alone: an even backdrop, and a grid on the ground that says how large things are.

@group(1) @binding(0) var<uniform> studio: Studio;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    // At depth 0: infinitely far.
    let ndc = corner_of_picture(index);
    return Corner(vec4f(ndc, 0.0, 1.0), ndc);
}

fn ray(corner: Corner) -> vec3f {
    return normalize((view.ray_from_clip * vec4f(corner.ndc, 1.0, 1.0)).xyz);
}

@fragment
fn backdrop(corner: Corner) -> @location(0) vec4f {
    let up = ray(corner).y;
    let above = mix(vec3f(0.165, 0.17, 0.175), vec3f(0.075, 0.08, 0.088), smoothstep(0.0, 0.8, up));
    let below = mix(vec3f(0.165, 0.17, 0.175), vec3f(0.1, 0.102, 0.105), smoothstep(0.0, 0.6, -up));
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

struct Ground {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn grid(corner: Corner) -> Ground {
    let direction = ray(corner);
    let away = -view.eye.y / direction.y;
    let place = view.eye + away * direction;
    let near = 1.0 - smoothstep(1.5 * studio.radius, 7.0 * studio.radius, length(place.xz));
    let fine = lines(place.xz, studio.cell * 0.1);
    let coarse = lines(place.xz, studio.cell);
    let clip = view.clip_from_world * vec4f(place, 1.0);
    let amount = near * max(0.09 * fine, 0.25 * coarse);
    if (!(away > 0.0) || amount < 0.002) {
        discard;
    }
    return Ground(vec4f(vec3f(0.5) / view.exposure, amount), clip.z / clip.w);
}
