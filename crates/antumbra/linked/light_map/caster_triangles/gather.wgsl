// Linked from src/light_map/caster_triangles/gather.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read_write> triangle_words: array<u32>;

@group(0) @binding(1)
var<storage, read_write> slots: array<atomic<u32>>;

@group(0) @binding(2)
var<storage, read_write> links: array<u32>;

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let thread = runs_thread_index(id, workgroups);
    if thread >= runs_runs[0].thread_count {
        return;
    }
    let run = runs_run_of(thread);
    let triangle = run.first_place + thread - run.first_thread;
    let corners = runs_triangle_of(run, thread).corners;
    for (var k = 0u; k < 3u; k++) {
        let word = triangles_first_word(triangle, k);
        let bits = bitcast<vec3u>(corners[k]);
        triangle_words[word] = bits.x;
        triangle_words[word + 1u] = bits.y;
        triangle_words[word + 2u] = bits.z;
        triangle_words[word + 3u] = triangles_NO_NEIGHBOUR;
    }
    for (var k = 0u; k < 3u; k++) {
        let slot = edges_edge_slot(corners[(k + 1u) % 3u], corners[(k + 2u) % 3u], arrayLength(&slots));
        links[3u * triangle + k] = atomicExchange(&slots[slot], 3u * triangle + k + 1u);
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

const triangles_NO_NEIGHBOUR = 4294967295u;

fn triangles_first_word(triangle: u32, k: u32) -> u32 {
    return 12u * triangle + 4u * k;
}
