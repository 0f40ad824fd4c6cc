// Linked from src/light_map/caster_triangles/join.wesl by `cargo xtask shaders`: edit that, not this.

const MAX_LINKS = 256u;

fn corner(triangle: u32, k: u32) -> vec3f {
    let word = triangles_first_word(triangle, k % 3u);
    return bitcast<vec3f>(vec3u(gather_triangle_words[word], gather_triangle_words[word + 1u], gather_triangle_words[word + 2u]));
}

fn neighbour_of(triangle: u32, k: u32) -> u32 {
    let from_corner = corner(triangle, k + 1u);
    let to_corner = corner(triangle, k + 2u);
    let opposite = corner(triangle, k);
    var onward = triangles_NO_NEIGHBOUR;
    var turned = triangles_NO_NEIGHBOUR;
    var link = atomicLoad(&gather_slots[edges_edge_slot(from_corner, to_corner, arrayLength(&gather_slots))]);
    for (var i = 0u; i < MAX_LINKS && link != 0u; i++) {
        let other = (link - 1u) / 3u;
        let j = (link - 1u) % 3u;
        link = gather_links[link - 1u];
        if other == triangle || all(corner(other, j) == opposite) {
            continue;
        }
        let other_from = corner(other, j + 1u);
        let other_to = corner(other, j + 2u);
        if all(other_from == to_corner) && all(other_to == from_corner) {
            onward = min(onward, other);
        }
        else if all(other_from == from_corner) && all(other_to == to_corner) {
            turned = min(turned, other);
        }
    }
    return select(onward, turned, onward == triangles_NO_NEIGHBOUR);
}

@compute @workgroup_size(64)
fn join(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let thread = runs_thread_index(id, workgroups);
    if thread >= runs_runs[0].thread_count {
        return;
    }
    let triangle = runs_runs[0].first_place + thread;
    for (var k = 0u; k < 3u; k++) {
        gather_triangle_words[triangles_first_word(triangle, k) + 3u] = neighbour_of(triangle, k);
    }
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

@group(0) @binding(0)
var<storage, read_write> gather_triangle_words: array<u32>;

@group(0) @binding(1)
var<storage, read_write> gather_slots: array<atomic<u32>>;

@group(0) @binding(2)
var<storage, read_write> gather_links: array<u32>;

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

fn runs_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
}

const triangles_NO_NEIGHBOUR = 4294967295u;

fn triangles_first_word(triangle: u32, k: u32) -> u32 {
    return 12u * triangle + 4u * k;
}
