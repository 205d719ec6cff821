// Culling and levels of detail (thesis 4.3.2, 4.3.3): instances → for each template and level a list of the instances that
// are seen, with how far they have morphed, and the commands that draw them.

// Threads of a workgroup, and the most workgroups along one axis.
override GROUP: u32;
override MAX_GROUPS: u32;
// What is nearer is drawn as from this far.
override MIN_DISTANCE_M: f32;
// LOD modes.
override QUALITY: u32;
override SIMPLE: u32;
override DISCRETE: u32;
override OFF: u32;
// No modes: all trees are pictures, or all are meshes at one level.
override PICTURES: u32;
override MESHES: u32;
// Indices of a picture, and lists of trees that are seen as such.
override PICTURE_INDICES: u32;
override PICTURE_LISTS: u32;
// Pixels of the picture that a tree may fill before less than the usual error is allowed of it, those from which on it is least,
// and the metres that it is taken to be large at least.
override SMALL_PX: f32;
override LARGE_PX: f32;
override SMALL_TREE_M: f32;
// Sines of the angles from which on pictures are too steep to be of use, and are not used.
override STEEP: f32;
override TOO_STEEP: f32;

struct Cull {
    // Unit normals and distances of the planes that bound the view; a point p is inside if n·p + d ≥ 0.
    planes: array<vec4f, 5>,
    eye: vec3f,
    // Error in metres that is allowed for each metre of distance.
    error_per_m: f32,
    // Where the trees that are looked at end; they begin at `first`.
    instances: u32,
    // Templates, levels (the most of any template), draws of meshes for each level and template.
    templates: u32,
    levels: u32,
    mesh_draws: u32,
    lod_mode: u32,
    // Error in metres that is allowed at any distance.
    fixed_error_m: f32,
    // 0 draws all of them, wherever they stand.
    planes_used: u32,
    first: u32,
    // Where the trees of the field end; those beyond follow.
    field: u32,
    // Pixels a radian; 0 if trees are not looked at.
    focal_px: f32,
    unused: array<u32, 2>,
}

struct Template {
    center: vec3f,
    radius: f32,
    // Of each level in metres; as many as `MAX_LEVELS` in Rust.
    errors: array<f32, 12>,
    levels: u32,
    // Where its first list starts, and how long each of its lists may get.
    first: u32,
    capacity: u32,
    // Error that the simple mode gives its finest mesh.
    simple_error: f32,
    // Of its pictures in metres; beyond all errors if it has none.
    picture_error: f32,
    // The first level in which clusters stand for leaves; beyond all if there is none.
    clusters: u32,
    pad: array<f32, 2>,
}

// Shares of a tree's pixels are told in 10 bits. What does not go on to the last stays below it.
const STEPS: f32 = 1023.0;
const MAX_EDGE: f32 = 1022.0 / STEPS;

struct Visible {
    tree: u32,
    lambda: f32,
    // Which of its pixels are drawn, as `is_shown` of `common.wgsl` knows them, and before which of them it is the picture's, each
    // in 10 bits: while leaves dissolve into clusters, clusters into fewer, or all of it into the picture. Only what goes on to the
    // last draws bark, and all that is not the picture's.
    shown: u32,
}

fn in_steps(share: f32) -> f32 {
    return round(share * STEPS) / STEPS;
}

fn pack(edges: vec3f) -> u32 {
    let bits = vec3u(round(edges * STEPS));
    return bits.x | (bits.y << 10u) | (bits.z << 20u);
}

struct Command {
    indices: u32,
    instances: u32,
    first_index: u32,
    base_vertex: i32,
    first_instance: u32,
}

// No uniform buffer, because branches depend on it: see `View`.
@group(1) @binding(0) var<storage, read> cull: Cull;
@group(1) @binding(1) var<storage, read> trees: array<Tree>;
@group(1) @binding(2) var<storage, read> templates: array<Template>;
@group(1) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(4) var<storage, read_write> visible: array<Visible>;
@group(1) @binding(5) var<storage, read_write> commands: array<Command>;

// The part of the usual error that is allowed of a tree whose middle is so far away. Its twin is `lod::tree::allowance`.
fn allowance(center_distance: f32, radius: f32) -> f32 {
    let size = cull.focal_px * max(2.0 * radius, SMALL_TREE_M) / max(center_distance, MIN_DISTANCE_M);
    return SMALL_PX / clamp(size, SMALL_PX, LARGE_PX);
}

// λ of a tree whose nearest part is `distance` away, and which may be off by `error_per_m` for each metre of that. The Rust twin is
// `lod::tree::lod_number`, and a test compares them.
fn lod_number(mode: u32, template_index: u32, scale: f32, distance: f32, error_per_m: f32) -> f32 {
    let last = f32(templates[template_index].levels - 1u);
    if (mode == OFF) {
        return 0.0;
    }
    let allowed = (error_per_m * distance + cull.fixed_error_m) / scale;
    if (mode == SIMPLE) {
        let simple = templates[template_index].simple_error;
        if (!(allowed > simple)) {
            return 0.0;
        }
        return min(2.0 * log2(allowed / simple), last);
    }
    if (!(allowed > templates[template_index].errors[0])) {
        return 0.0;
    }
    var lambda = last;
    for (var i = 0u; i + 1u < templates[template_index].levels; i++) {
        let low = templates[template_index].errors[i];
        let high = templates[template_index].errors[i + 1u];
        if (allowed < high) {
            lambda = f32(i) + log2(allowed / low) / log2(high / low);
            break;
        }
    }
    if (mode == DISCRETE || mode == MESHES) {
        return floor(lambda);
    }
    return lambda;
}

// The share of a tree that its picture shows, the rest being its mesh: none up to the error of the picture, all from twice
// that on, and none from steeply above or below. Its twin is `lod::tree::pictured`.
fn pictured(mode: u32, template_index: u32, scale: f32, distance: f32, error_per_m: f32, steepness: f32) -> f32 {
    let times = error_per_m * distance / (scale * templates[template_index].picture_error);
    let share = clamp(log2(max(times, 1.0)), 0.0, 1.0) * (1.0 - smoothstep(STEEP, TOO_STEEP, steepness));
    if (mode == OFF || mode == MESHES) {
        return 0.0;
    }
    if (mode == PICTURES) {
        return 1.0;
    }
    return select(share, step(0.5, share), mode == DISCRETE);
}

fn list(template_index: u32, level: u32) -> u32 {
    return templates[template_index].first + level * templates[template_index].capacity;
}

fn bucket(template_index: u32, level: u32) -> u32 {
    return level * cull.templates + template_index;
}

// Pictures of all templates are two lists: one of the trees of the field, which is the first of all, and one of those beyond,
// which the shadow map doesn't know. A draw shows each.
fn pictures_bucket(is_beyond: bool) -> u32 {
    return cull.templates * cull.levels + select(0u, 1u, is_beyond);
}

@compute @workgroup_size(GROUP)
fn clear(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < pictures_bucket(false) + PICTURE_LISTS) {
        atomicStore(&counts[id.x], 0u);
    }
}

@compute @workgroup_size(GROUP)
fn choose(@builtin(global_invocation_id) id: vec3u) {
    let index = cull.first + id.x + id.y * MAX_GROUPS * GROUP;
    if (index >= cull.instances) {
        return;
    }
    let template_index = trees[index].template_and_sun & 0xFFFFu;
    let center = from_template(trees[index].rows, templates[template_index].center);
    let scale = trees[index].scale;
    let radius = templates[template_index].radius * scale;
    var inside = true;
    for (var plane = 0u; plane < 5u; plane++) {
        inside = inside && dot(cull.planes[plane], vec4f(center, 1.0)) >= -radius;
    }
    let seen = inside || cull.planes_used == 0u;
    // A loop, because Mesa's software driver takes both ways of an `if`, but leaves a loop when no thread of several needs it any more.
    for (var once = select(1u, 0u, seen); once < 1u; once++) {
        list_tree(index, center, radius);
    }
}

// Enters a tree that is seen into the lists of what it is drawn as.
fn list_tree(index: u32, center: vec3f, radius: f32) {
    let template_index = trees[index].template_and_sun & 0xFFFFu;
    let scale = trees[index].scale;
    let to_eye = cull.eye - center;
    let distance = max(length(to_eye) - radius, MIN_DISTANCE_M);
    let error_per_m = cull.error_per_m * allowance(length(to_eye), radius);
    // Beyond the field nobody looks at a tree so closely that its finest mesh would be worth what thousands of them cost.
    let mode = select(cull.lod_mode, QUALITY, cull.lod_mode == OFF && index >= cull.field);
    let lambda = lod_number(mode, template_index, scale, distance, error_per_m);
    let steepness = abs(to_eye.y) / max(length(to_eye), 1e-6);
    let share = in_steps(pictured(mode, template_index, scale, distance, error_per_m, steepness));
    if (share < 1.0) {
        let level = u32(lambda);
        let next = level + 1u;
        let dissolves = next >= templates[template_index].clusters && next < templates[template_index].levels;
        let edge = select(share, in_steps(mix(share, 1.0, morphed(lambda))), dissolves);
        let slot = atomicAdd(&counts[bucket(template_index, level)], 1u);
        visible[list(template_index, level) + slot] = Visible(index, lambda, pack(vec3f(min(edge, MAX_EDGE), 1.0, min(share, MAX_EDGE))));
        if (edge > share) {
            let slot = atomicAdd(&counts[bucket(template_index, next)], 1u);
            let shown = pack(vec3f(share, min(edge, MAX_EDGE), share));
            visible[list(template_index, next) + slot] = Visible(index, f32(next), shown);
        }
    }
    if (share > 0.0) {
        let is_beyond = index >= cull.field;
        let slot = atomicAdd(&counts[pictures_bucket(is_beyond)], 1u) + select(0u, cull.field, is_beyond);
        visible[slot] = Visible(index, lambda, pack(vec3f(0.0, share, share)));
    }
}

@compute @workgroup_size(GROUP)
fn write_commands(@builtin(global_invocation_id) id: vec3u) {
    let buckets = cull.templates * cull.levels;
    if (id.x < buckets * cull.mesh_draws) {
        commands[id.x].instances = atomicLoad(&counts[id.x % buckets]);
    } else if (id.x < buckets * cull.mesh_draws + PICTURE_LISTS) {
        // Corners of one instance: devices begin each with new groups of threads, or with new preparations.
        let is_beyond = id.x > buckets * cull.mesh_draws;
        commands[id.x].indices = PICTURE_INDICES * atomicLoad(&counts[pictures_bucket(is_beyond)]);
    }
}
