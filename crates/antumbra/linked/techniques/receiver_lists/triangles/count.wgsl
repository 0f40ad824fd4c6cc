// Linked from src/techniques/receiver_lists/triangles/count.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn triangle_count(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let thread = runs_thread_index(id, group_counts);
    if thread >= runs_runs[0].thread_count {
        return;
    }
    let mesh = runs_run_of(thread);
    let triangle = runs_triangle_of(mesh, thread);
    let place = mesh.first_place + thread - mesh.first_thread;
    if !casters_matters(mesh, triangle) {
        casters_triangle_places[place] = vec2u(settings_NOWHERE, 0u);
        return;
    }
    let cell = casters_cell_of(triangle);
    casters_triangle_places[place] = vec2u(cell, atomicAdd(&casters_cells[cell], 1u));
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

struct runs_TriangleRun {
    first_thread: u32,
    thread_count: u32,
    first_triangle: u32,
    triangle_count: u32,
    first_instance: u32,
    first_place: u32,
    flags: u32,
    has_uvs: u32
}

const runs_RUNS_LOG2 = 9u;

const runs_MAX_RUNS = 1u << runs_RUNS_LOG2;

@group(1) @binding(0)
var<uniform> runs_runs: array<runs_TriangleRun, runs_MAX_RUNS>;

@group(1) @binding(1)
var<storage, read> runs_mesh_positions: array<f32>;

@group(1) @binding(2)
var<storage, read> runs_mesh_indices: array<u32>;

@group(1) @binding(3)
var<storage, read> runs_mesh_instances: array<mat4x4f>;

@group(1) @binding(4)
var<uniform> runs_anchor_in_world: vec3f;

struct runs_Triangle {
    corners: array<vec3f, 3>,
    vertices: vec3u
}

fn runs_run_of(thread: u32) -> runs_TriangleRun {
    var run = 0u;
    for (var halving = 1u; halving <= runs_RUNS_LOG2; halving++) {
        let step = runs_MAX_RUNS >> halving;
        if runs_runs[run + step].first_thread <= thread {
            run += step;
        }
    }
    return runs_runs[run];
}

fn runs_triangle_of(run: runs_TriangleRun, thread: u32) -> runs_Triangle {
    let index = thread - run.first_thread;
    let world_from_object = anchored_anchored(runs_mesh_instances[run.first_instance + index / run.triangle_count], runs_anchor_in_world);
    let first = 3u * (run.first_triangle + index % run.triangle_count);
    var triangle: runs_Triangle;
    for (var k = 0u; k < 3u; k++) {
        let vertex = runs_mesh_indices[first + k];
        triangle.vertices[k] = vertex;
        let pos_in_object = vec3f(runs_mesh_positions[3u * vertex], runs_mesh_positions[3u * vertex + 1u], runs_mesh_positions[3u * vertex + 2u]);
        triangle.corners[k] = (world_from_object * vec4f(pos_in_object, 1.0)).xyz;
    }
    return triangle;
}

fn runs_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
}

struct settings_SampleSettings {
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
    ray_offset_scale: f32,
    max_groups: u32,
    cells_across: u32,
    max_cells: u32,
    iterations_per_triangle: u32,
    max_iterations: u32,
    first_passed: u32,
    window_count: u32,
    window: u32,
    window_side: u32,
    receivers_per_instance: u32,
    subset: u32,
    window_right: vec3f,
    region_corners: u32,
    window_up: vec3f,
    matrix_rounding_m: f32,
    window_axis: vec3f,
    padding_1: u32,
    window_light_min: vec3f,
    padding_2: u32,
    window_light_max: vec3f,
    padding_3: u32,
    clip_z_row: vec4f,
    clip_w_row: vec4f
}

const settings_CULL_FACING = 8u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_NOWHERE = 4294967295u;

const settings_FLAG_CLOSED = 1u;

const shaft_SHAFT_PLANES = 18u;

const shaft_SHAFT_SLACK = 2e-6;

struct shaft_Box {
    low: vec3f,
    high: vec3f
}

fn shaft_triangle_is_outside(plane: vec4f, a: vec3f, b: vec3f, c: vec3f) -> bool {
    return min(min(dot(plane.xyz, a), dot(plane.xyz, b)), dot(plane.xyz, c)) > plane.w;
}

fn shaft_side_of_box(normal: vec3f, a: vec3f, box: shaft_Box) -> f32 {
    let middle = 0.5 * (box.low + box.high) - a;
    let distance = dot(normal, middle);
    let terms = dot(abs(normal), abs(middle));
    let reach = dot(abs(normal), 0.5 * (box.high - box.low)) + shaft_SHAFT_SLACK * terms;
    return select(0.0, sign(distance), abs(distance) > reach);
}

@group(0) @binding(0)
var<uniform> casters_settings: settings_SampleSettings;

@group(0) @binding(1)
var<uniform> casters_shaft: array<vec4f, 22>;

@group(0) @binding(2)
var<storage, read_write> casters_cells: array<atomic<u32>>;

@group(0) @binding(3)
var<storage, read_write> casters_triangle_places: array<vec2u>;

fn casters_light_box() -> shaft_Box {
    return shaft_Box(casters_shaft[shaft_SHAFT_PLANES + 2u].xyz, casters_shaft[shaft_SHAFT_PLANES + 3u].xyz);
}

fn casters_matters(run: runs_TriangleRun, triangle: runs_Triangle) -> bool {
    let a = triangle.corners[0];
    let b = triangle.corners[1];
    let c = triangle.corners[2];
    let normal = cross(b - a, c - a);
    if !(dot(normal, normal) > 0.0) {
        return false;
    }
    for (var i = 0u; i < shaft_SHAFT_PLANES; i++) {
        if shaft_triangle_is_outside(casters_shaft[i], a, b, c) {
            return false;
        }
    }
    if settings_is_on(casters_settings, settings_CULL_FACING) && (run.flags & settings_FLAG_CLOSED) != 0u && shaft_side_of_box(normal, a, casters_light_box()) > 0.0 {
        return false;
    }
    return true;
}

fn casters_spread(value: u32) -> u32 {
    var v = value & 1023u;
    v = (v | (v << 16u)) & 50331903u;
    v = (v | (v << 8u)) & 50393103u;
    v = (v | (v << 4u)) & 51130563u;
    return (v | (v << 2u)) & 153391689u;
}

fn casters_cell_of(triangle: runs_Triangle) -> u32 {
    let middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
    let extent = max(casters_settings.casters_max - casters_settings.casters_min, vec3f(1e-30));
    let part = clamp((middle - casters_settings.casters_min) / extent, vec3f(0.0), vec3f(0.999999));
    let cell = vec3u(part * casters_CELLS_PER_SIDE);
    return casters_spread(cell.x) | (casters_spread(cell.y) << 1u) | (casters_spread(cell.z) << 2u);
}

const casters_CELLS_PER_SIDE = 64.0;
