// Small plants and stones: shapes with a colour at each end, rooted on the land as it is drawn and in its light. All of it
// happens for vertices: a pixel is given its colour, nothing more.

struct Plant {
    // x, z and the height of the land there.
    @location(0) place: vec3f,
    // Cosine and sine of the turn, times the scale.
    @location(1) turn: vec2f,
    // Albedo at tint 0; how far it moves in the wind.
    @location(2) root: vec4f,
    // Albedo at tint 1; 1 if light comes through.
    @location(3) tip: vec4f,
}

struct Corner {
    @location(4) position: vec3f,
    @location(5) normal: vec3f,
    @location(6) tint: f32,
}

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) radiance: vec3f,
    // Of one of the corners.
    @location(1) @interpolate(flat) corner: vec3f,
}

@vertex
fn vertex(plant: Plant, corner: Corner) -> Out {
    let size = length(plant.turn);
    let turned = mat2x2f(plant.turn, vec2f(-plant.turn.y, plant.turn.x));
    let bend = wind(plant.place.xy, plant.turn.x) * (plant.root.w * size * corner.position.y * corner.position.y);
    let at = plant.place.xy + turned * corner.position.xz + bend;
    // Every corner on its own ground, as `ground_m` of the schema has it.
    let aside = size * length(corner.position.xz);
    let middle = plant.place.z;
    let ground = clamp(drawn_height_m(at), middle - 1.2 * aside - 0.1, middle + 0.7 * aside + 0.1);
    let world = vec3f(at.x, ground + size * corner.position.y, at.y);
    let level = turned * corner.normal.xz / max(size, 1e-6);
    let normal = normalize(vec3f(level.x, corner.normal.y, level.y));

    let light = light_on(plant.place.xy);
    let albedo = mix(plant.root.rgb, plant.tip.rgb, corner.tint);
    let to_eye = view.eye - world;
    let away = length(to_eye);
    let facing = dot(normal, view.sun_direction);
    let leafy = plant.tip.w;
    // Leaves let some of the light through that falls on their other side.
    let sun_on = mix(max(facing, 0.0), max(0.25 + 0.75 * facing, -0.3 * facing), leafy);
    // Roots stand in each other's shade.
    let open = mix(1.0, 0.55 + 0.45 * clamp(3.0 * corner.position.y, 0.0, 1.0), leafy);
    let around = light_around(0.5 + 0.5 * normal.y, light.b, light.r);
    let irradiance = view.sun_irradiance * light.b * sun_on + around;
    let radiance = hazed(air_before(world), albedo / PI * irradiance * open);
    return Out(view.clip_from_world * vec4f(world, 1.0), radiance, radiance);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    // Beyond the edge of a sliver, where a pixel's middle may lie, what is interpolated is any number.
    return vec4f(clamp(in.radiance, 0.1 * in.corner, 10.0 * in.corner), 1.0);
}
