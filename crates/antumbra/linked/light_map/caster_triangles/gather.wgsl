// Linked from src/light_map/caster_triangles/gather.wesl by `cargo xtask shaders`: edit that, not this.

struct TriangleRun {
    first_thread: u32,
    thread_count: u32,
    first_triangle: u32,
    triangle_count: u32,
    first_instance: u32,
    first_place: u32,
    padding_0: u32,
    padding_1: u32
}

@group(0) @binding(0)
var<storage, read_write> triangle_words: array<u32>;

@group(0) @binding(1)
var<storage, read_write> slots: array<atomic<u32>>;

@group(0) @binding(2)
var<storage, read_write> links: array<u32>;

const RUNS_LOG2 = 8u;

const MOST_RUNS = 1u << RUNS_LOG2;

@group(1) @binding(0)
var<uniform> runs: array<TriangleRun, MOST_RUNS>;

@group(1) @binding(1)
var<storage, read> mesh_positions: array<f32>;

@group(1) @binding(2)
var<storage, read> mesh_indices: array<u32>;

@group(1) @binding(3)
var<storage, read> mesh_instances: array<mat4x4f>;

fn run_of(thread: u32) -> TriangleRun {
    var run = 0u;
    for (var halving = 1u; halving <= RUNS_LOG2; halving++) {
        let step = MOST_RUNS >> halving;
        if runs[run + step].first_thread <= thread {
            run += step;
        }
    }
    return runs[run];
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let thread = id.y * workgroups.x * 64u + id.x;
    if thread >= runs[0].thread_count {
        return;
    }
    let run = run_of(thread);
    let index = thread - run.first_thread;
    let world_from_object = mesh_instances[run.first_instance + index / run.triangle_count];
    let triangle = run.first_place + index;
    var corners: array<vec3f, 3>;
    for (var k = 0u; k < 3u; k++) {
        let vertex = mesh_indices[3u * (run.first_triangle + index % run.triangle_count) + k];
        let pos_in_object = vec3f(mesh_positions[3u * vertex], mesh_positions[3u * vertex + 1u], mesh_positions[3u * vertex + 2u]);
        corners[k] = (world_from_object * vec4f(pos_in_object, 1.0)).xyz;
        let word = package__1light_map__1caster_triangles_triangles__1first_word(triangle, k);
        let bits = bitcast<vec3u>(corners[k]);
        triangle_words[word] = bits.x;
        triangle_words[word + 1u] = bits.y;
        triangle_words[word + 2u] = bits.z;
        triangle_words[word + 3u] = package__1light_map__1caster_triangles_triangles__1NO_NEIGHBOUR;
    }
    for (var k = 0u; k < 3u; k++) {
        let slot = package__1light_map__1caster_triangles_edges__1edge_slot(corners[(k + 1u) % 3u], corners[(k + 2u) % 3u], arrayLength(&slots));
        links[3u * triangle + k] = atomicExchange(&slots[slot], 3u * triangle + k + 1u);
    }
}

fn package__1light_map__1caster_triangles_edges_hash(x: u32) -> u32 {
    let state = x * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn package__1light_map__1caster_triangles_edges__2hash_of_corner(p: vec3f) -> u32 {
    let bits = bitcast<vec3u>(p + vec3f(0.0));
    return package__1light_map__1caster_triangles_edges_hash(bits.x ^ package__1light_map__1caster_triangles_edges_hash(bits.y ^ package__1light_map__1caster_triangles_edges_hash(bits.z)));
}

fn package__1light_map__1caster_triangles_edges__1edge_slot(a: vec3f, b: vec3f, slots: u32) -> u32 {
    return package__1light_map__1caster_triangles_edges_hash(package__1light_map__1caster_triangles_edges__2hash_of_corner(a) + package__1light_map__1caster_triangles_edges__2hash_of_corner(b)) & (slots - 1u);
}

const package__1light_map__1caster_triangles_triangles__1NO_NEIGHBOUR = 4294967295u;

fn package__1light_map__1caster_triangles_triangles__1first_word(triangle: u32, k: u32) -> u32 {
    return 12u * triangle + 4u * k;
}
