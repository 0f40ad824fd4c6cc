// Linked from src/techniques/receiver_lists/triangles/scatter.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(5)
var<storage, read> mesh_uvs: array<f32>;

fn uv_of(mesh: runs_TriangleRun, vertex: u32) -> vec2f {
    if mesh.has_uvs == 0u {
        return vec2f();
    }
    return vec2f(mesh_uvs[2u * vertex], mesh_uvs[2u * vertex + 1u]);
}

fn largest_depth_of(triangle: runs_Triangle, flags: u32) -> f32 {
    let corners = triangle.corners;
    let largest = depth_error_largest_depth(casters_settings.clip_z_row, casters_settings.clip_w_row, corners[0], corners[1], corners[2]);
    return select(largest, 0.0, (flags & settings_FLAG_CLOSED) != 0u);
}

@compute @workgroup_size(64)
fn triangle_scatter(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let thread = runs_thread_index(id, group_counts);
    if thread >= runs_runs[0].thread_count {
        return;
    }
    let mesh = runs_run_of(thread);
    let place = casters_triangle_places[mesh.first_place + thread - mesh.first_thread];
    if place.x == settings_NOWHERE {
        return;
    }
    let triangle = runs_triangle_of(mesh, thread);
    var flags = mesh.flags;
    if (flags & settings_FLAG_CLOSED) == 0u {
        flags |= settings_FLAG_SILHOUETTE;
    }
    else if settings_is_on(casters_settings, settings_PENUMBRA_ONLY) {
        for (var k = 0u; k < 3u; k++) {
            let slot = edges_edge_slot(triangle.corners[k], triangle.corners[(k + 1u) % 3u], arrayLength(&casters_edges));
            if atomicLoad(&casters_edges[slot]) == edges_FACE_BOTH {
                flags |= settings_FLAG_SILHOUETTE;
            }
        }
    }
    let at = casters_settings.triangle_stride * (atomicLoad(&casters_cells[place.x]) + place.y);
    casters_triangles[at] = vec4f(triangle.corners[0], f32(flags));
    casters_triangles[at + 1u] = vec4f(triangle.corners[1], largest_depth_of(triangle, flags));
    casters_triangles[at + 2u] = vec4f(triangle.corners[2], 0.0);
    if casters_settings.triangle_stride > 3u {
        casters_triangles[at + 3u] = vec4f(uv_of(mesh, triangle.vertices[0]), uv_of(mesh, triangle.vertices[1]));
        casters_triangles[at + 4u] = vec4f(uv_of(mesh, triangle.vertices[2]), 0.0, 0.0);
    }
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

fn edges_hash(x: u32) -> u32 {
    let state = x * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn edges_hash_of_corner(p: vec3f) -> u32 {
    let bits = bitcast<vec3u>(p + vec3f(0.0));
    return edges_hash(bits.x ^ edges_hash(bits.y ^ edges_hash(bits.z)));
}

fn edges_edge_slot(a: vec3f, b: vec3f, slots: u32) -> u32 {
    return edges_hash(edges_hash_of_corner(a) + edges_hash_of_corner(b)) & (slots - 1u);
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

fn depth_error_corner_depth(clip_z_row: vec4f, clip_w_row: vec4f, corner: vec3f) -> f32 {
    let z = dot(clip_z_row, vec4f(corner, 1.0));
    let w = dot(clip_w_row, vec4f(corner, 1.0));
    return select(1.0, z / w, z >= 0.0 && z <= w && w > 0.0);
}

fn depth_error_largest_depth(clip_z_row: vec4f, clip_w_row: vec4f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let depth_a = depth_error_corner_depth(clip_z_row, clip_w_row, a);
    let depth_b = depth_error_corner_depth(clip_z_row, clip_w_row, b);
    let depth_c = depth_error_corner_depth(clip_z_row, clip_w_row, c);
    return max(depth_a, max(depth_b, depth_c));
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

const settings_PENUMBRA_ONLY = 2u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_NOWHERE = 4294967295u;

const settings_FLAG_CLOSED = 1u;

const settings_FLAG_SILHOUETTE = 2u;

@group(0) @binding(0)
var<uniform> casters_settings: settings_SampleSettings;

@group(0) @binding(2)
var<storage, read_write> casters_cells: array<atomic<u32>>;

@group(0) @binding(3)
var<storage, read_write> casters_triangle_places: array<vec2u>;

@group(0) @binding(4)
var<storage, read_write> casters_triangles: array<vec4f>;

@group(0) @binding(5)
var<storage, read_write> casters_edges: array<atomic<u32>>;

const edges_FACE_BOTH = 3u;
