// Linked from src/techniques/receiver_lists/triangle_count.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn triangle_count(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let thread = package__1light_map__1caster_triangles_runs__1thread_index(id, group_counts);
    if thread >= package__1light_map__1caster_triangles_runs_runs[0].thread_count {
        return;
    }
    let mesh = package__1light_map__1caster_triangles_runs__1run_of(thread);
    let triangle = package__1light_map__1caster_triangles_runs__1triangle_of(mesh, thread);
    let place = mesh.first_place + thread - mesh.first_thread;
    if !package_techniques__1receiver_lists_casters_matters(mesh, triangle) {
        package_techniques__1receiver_lists_casters__1triangle_places[place] = vec2u(package_techniques__1receiver_lists_settings_NOWHERE, 0u);
        return;
    }
    let cell = package_techniques__1receiver_lists_casters__1cell_of(triangle);
    package_techniques__1receiver_lists_casters__1triangle_places[place] = vec2u(cell, atomicAdd(&package_techniques__1receiver_lists_casters_cells[cell], 1u));
}

fn package_casters_anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

struct package__1light_map__1caster_triangles_runs_TriangleRun {
    first_thread: u32,
    thread_count: u32,
    first_triangle: u32,
    triangle_count: u32,
    first_instance: u32,
    first_place: u32,
    flags: u32,
    has_uvs: u32
}

const package__1light_map__1caster_triangles_runs__1RUNS_LOG2 = 8u;

const package__1light_map__1caster_triangles_runs__1MOST_RUNS = 1u << package__1light_map__1caster_triangles_runs__1RUNS_LOG2;

@group(1) @binding(0)
var<uniform> package__1light_map__1caster_triangles_runs_runs: array<package__1light_map__1caster_triangles_runs_TriangleRun, package__1light_map__1caster_triangles_runs__1MOST_RUNS>;

@group(1) @binding(1)
var<storage, read> package__1light_map__1caster_triangles_runs__1mesh_positions: array<f32>;

@group(1) @binding(2)
var<storage, read> package__1light_map__1caster_triangles_runs__1mesh_indices: array<u32>;

@group(1) @binding(3)
var<storage, read> package__1light_map__1caster_triangles_runs__1mesh_instances: array<mat4x4f>;

@group(1) @binding(4)
var<uniform> package__1light_map__1caster_triangles_runs__2anchor_in_world: vec3f;

struct package__1light_map__1caster_triangles_runs_Triangle {
    corners: array<vec3f, 3>,
    vertices: vec3u
}

fn package__1light_map__1caster_triangles_runs__1run_of(thread: u32) -> package__1light_map__1caster_triangles_runs_TriangleRun {
    var run = 0u;
    for (var halving = 1u; halving <= package__1light_map__1caster_triangles_runs__1RUNS_LOG2; halving++) {
        let step = package__1light_map__1caster_triangles_runs__1MOST_RUNS >> halving;
        if package__1light_map__1caster_triangles_runs_runs[run + step].first_thread <= thread {
            run += step;
        }
    }
    return package__1light_map__1caster_triangles_runs_runs[run];
}

fn package__1light_map__1caster_triangles_runs__1triangle_of(run: package__1light_map__1caster_triangles_runs_TriangleRun, thread: u32) -> package__1light_map__1caster_triangles_runs_Triangle {
    let index = thread - run.first_thread;
    let world_from_object = package_casters_anchored_anchored(package__1light_map__1caster_triangles_runs__1mesh_instances[run.first_instance + index / run.triangle_count], package__1light_map__1caster_triangles_runs__2anchor_in_world);
    let first = 3u * (run.first_triangle + index % run.triangle_count);
    var triangle: package__1light_map__1caster_triangles_runs_Triangle;
    for (var k = 0u; k < 3u; k++) {
        let vertex = package__1light_map__1caster_triangles_runs__1mesh_indices[first + k];
        triangle.vertices[k] = vertex;
        let pos_in_object = vec3f(package__1light_map__1caster_triangles_runs__1mesh_positions[3u * vertex], package__1light_map__1caster_triangles_runs__1mesh_positions[3u * vertex + 1u], package__1light_map__1caster_triangles_runs__1mesh_positions[3u * vertex + 2u]);
        triangle.corners[k] = (world_from_object * vec4f(pos_in_object, 1.0)).xyz;
    }
    return triangle;
}

fn package__1light_map__1caster_triangles_runs__1thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
}

@group(0) @binding(0)
var<uniform> package_techniques__1receiver_lists_casters_settings: package_techniques__1receiver_lists_settings_SampleSettings;

@group(0) @binding(1)
var<uniform> package_techniques__1receiver_lists_casters_shaft: array<vec4f, 22>;

@group(0) @binding(2)
var<storage, read_write> package_techniques__1receiver_lists_casters_cells: array<atomic<u32>>;

@group(0) @binding(3)
var<storage, read_write> package_techniques__1receiver_lists_casters__1triangle_places: array<vec2u>;

fn package_techniques__1receiver_lists_casters__1light_box() -> package_techniques__1receiver_lists_shaft_Box {
    return package_techniques__1receiver_lists_shaft_Box(package_techniques__1receiver_lists_casters_shaft[package_techniques__1receiver_lists_shaft__1SHAFT_PLANES + 2u].xyz, package_techniques__1receiver_lists_casters_shaft[package_techniques__1receiver_lists_shaft__1SHAFT_PLANES + 3u].xyz);
}

fn package_techniques__1receiver_lists_casters_matters(run: package__1light_map__1caster_triangles_runs_TriangleRun, triangle: package__1light_map__1caster_triangles_runs_Triangle) -> bool {
    let a = triangle.corners[0];
    let b = triangle.corners[1];
    let c = triangle.corners[2];
    let normal = cross(b - a, c - a);
    if !(dot(normal, normal) > 0.0) {
        return false;
    }
    for (var i = 0u; i < package_techniques__1receiver_lists_shaft__1SHAFT_PLANES; i++) {
        if package_techniques__1receiver_lists_shaft__2triangle_is_outside(package_techniques__1receiver_lists_casters_shaft[i], a, b, c) {
            return false;
        }
    }
    if package_techniques__1receiver_lists_settings__1is_on(package_techniques__1receiver_lists_casters_settings, package_techniques__1receiver_lists_settings__1CULL_FACING) && (run.flags & package_techniques__1receiver_lists_settings__1FLAG_CLOSED) != 0u && package_techniques__1receiver_lists_shaft__2side_of_box(normal, a, package_techniques__1receiver_lists_casters__1light_box()) > 0.0 {
        return false;
    }
    return true;
}

fn package_techniques__1receiver_lists_casters_spread(value: u32) -> u32 {
    var v = value & 1023u;
    v = (v | (v << 16u)) & 50331903u;
    v = (v | (v << 8u)) & 50393103u;
    v = (v | (v << 4u)) & 51130563u;
    return (v | (v << 2u)) & 153391689u;
}

fn package_techniques__1receiver_lists_casters__1cell_of(triangle: package__1light_map__1caster_triangles_runs_Triangle) -> u32 {
    let middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
    let extent = max(package_techniques__1receiver_lists_casters_settings.casters_max - package_techniques__1receiver_lists_casters_settings.casters_min, vec3f(1e-30));
    let part = clamp((middle - package_techniques__1receiver_lists_casters_settings.casters_min) / extent, vec3f(0.0), vec3f(0.999999));
    let cell = vec3u(part * package_techniques__1receiver_lists_casters__2CELLS_PER_SIDE);
    return package_techniques__1receiver_lists_casters_spread(cell.x) | (package_techniques__1receiver_lists_casters_spread(cell.y) << 1u) | (package_techniques__1receiver_lists_casters_spread(cell.z) << 2u);
}

const package_techniques__1receiver_lists_casters__2CELLS_PER_SIDE = 64.0;

struct package_techniques__1receiver_lists_settings_SampleSettings {
    light_min: vec3f,
    point_count: u32,
    light_max: vec3f,
    word_count: u32,
    casters_min: vec3f,
    list_bits: u32,
    casters_max: vec3f,
    projection: u32,
    total_weight: f32,
    switches: u32,
    cell_count: u32,
    list_count: u32,
    super_first: u32,
    is_weighted: u32,
    triangle_stride: u32,
    lookup_size: u32,
    first_word: u32,
    pixel_words: u32,
    rotations: u32,
    turn: f32,
    hair_scale: f32,
    most_groups: u32,
    first_in_cells: u32,
    cells_across: u32,
    most_cells: u32,
    turns_per_triangle: u32,
    most_turns: u32,
    first_passed: u32,
    window_count: u32,
    window: u32,
    window_side: u32,
    receivers_per_instance: u32,
    window_right: vec3f,
    region_corners: u32,
    window_up: vec3f,
    padding_0: u32,
    window_axis: vec3f,
    padding_1: u32,
    window_light_min: vec3f,
    padding_2: u32,
    window_light_max: vec3f,
    padding_3: u32
}

const package_techniques__1receiver_lists_settings__1CULL_FACING = 8u;

fn package_techniques__1receiver_lists_settings__1is_on(settings: package_techniques__1receiver_lists_settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const package_techniques__1receiver_lists_settings_NOWHERE = 4294967295u;

const package_techniques__1receiver_lists_settings__1FLAG_CLOSED = 1u;

const package_techniques__1receiver_lists_shaft__1SHAFT_PLANES = 18u;

const package_techniques__1receiver_lists_shaft__1SHAFT_SLACK = 2e-6;

struct package_techniques__1receiver_lists_shaft_Box {
    low: vec3f,
    high: vec3f
}

fn package_techniques__1receiver_lists_shaft__2triangle_is_outside(plane: vec4f, a: vec3f, b: vec3f, c: vec3f) -> bool {
    return min(min(dot(plane.xyz, a), dot(plane.xyz, b)), dot(plane.xyz, c)) > plane.w;
}

fn package_techniques__1receiver_lists_shaft__2side_of_box(normal: vec3f, a: vec3f, box: package_techniques__1receiver_lists_shaft_Box) -> f32 {
    let middle = 0.5 * (box.low + box.high) - a;
    let distance = dot(normal, middle);
    let terms = dot(abs(normal), abs(middle));
    let reach = dot(abs(normal), 0.5 * (box.high - box.low)) + package_techniques__1receiver_lists_shaft__1SHAFT_SLACK * terms;
    return select(0.0, sign(distance), abs(distance) > reach);
}
