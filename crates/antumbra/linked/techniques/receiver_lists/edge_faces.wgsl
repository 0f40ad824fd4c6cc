// Linked from src/techniques/receiver_lists/edge_faces.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn edge_faces(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let thread = package__1light_map__1caster_triangles_runs__1thread_index(id, group_counts);
    if thread >= package__1light_map__1caster_triangles_runs_runs[0].thread_count {
        return;
    }
    let mesh = package__1light_map__1caster_triangles_runs__1run_of(thread);
    if (mesh.flags & package_techniques__1receiver_lists_settings__1FLAG_CLOSED) == 0u {
        return;
    }
    let triangle = package__1light_map__1caster_triangles_runs__1triangle_of(mesh, thread);
    let face = package_techniques__1receiver_lists_edges__1face_of(triangle, package_techniques__1receiver_lists_casters__1light_box());
    for (var k = 0u; k < 3u; k++) {
        atomicOr(&package_techniques__1receiver_lists_casters_edges[package__1light_map__1caster_triangles_edges__1edge_slot(triangle.corners[k], triangle.corners[(k + 1u) % 3u], arrayLength(&package_techniques__1receiver_lists_casters_edges))], face);
    }
}

fn package_casters_anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
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

@group(0) @binding(1)
var<uniform> package_techniques__1receiver_lists_casters_shaft: array<vec4f, 22>;

@group(0) @binding(5)
var<storage, read_write> package_techniques__1receiver_lists_casters_edges: array<atomic<u32>>;

fn package_techniques__1receiver_lists_casters__1light_box() -> package_techniques__1receiver_lists_shaft_Box {
    return package_techniques__1receiver_lists_shaft_Box(package_techniques__1receiver_lists_casters_shaft[package_techniques__1receiver_lists_shaft__1SHAFT_PLANES + 2u].xyz, package_techniques__1receiver_lists_casters_shaft[package_techniques__1receiver_lists_shaft__1SHAFT_PLANES + 3u].xyz);
}

const package_techniques__1receiver_lists_edges__1FACE_FRONT = 1u;

const package_techniques__1receiver_lists_edges__1FACE_BACK = 2u;

const package_techniques__1receiver_lists_edges__1FACE_BOTH = 3u;

fn package_techniques__1receiver_lists_edges__1face_of(triangle: package__1light_map__1caster_triangles_runs_Triangle, light: package_techniques__1receiver_lists_shaft_Box) -> u32 {
    let a = triangle.corners[0];
    let side = package_techniques__1receiver_lists_shaft__2side_of_box(cross(triangle.corners[1] - a, triangle.corners[2] - a), a, light);
    return select(select(package_techniques__1receiver_lists_edges__1FACE_BOTH, package_techniques__1receiver_lists_edges__1FACE_BACK, side < 0.0), package_techniques__1receiver_lists_edges__1FACE_FRONT, side > 0.0);
}

const package_techniques__1receiver_lists_settings__1FLAG_CLOSED = 1u;

const package_techniques__1receiver_lists_shaft__1SHAFT_PLANES = 18u;

const package_techniques__1receiver_lists_shaft__1SHAFT_SLACK = 2e-6;

struct package_techniques__1receiver_lists_shaft_Box {
    low: vec3f,
    high: vec3f
}

fn package_techniques__1receiver_lists_shaft__2side_of_box(normal: vec3f, a: vec3f, box: package_techniques__1receiver_lists_shaft_Box) -> f32 {
    let middle = 0.5 * (box.low + box.high) - a;
    let distance = dot(normal, middle);
    let terms = dot(abs(normal), abs(middle));
    let reach = dot(abs(normal), 0.5 * (box.high - box.low)) + package_techniques__1receiver_lists_shaft__1SHAFT_SLACK * terms;
    return select(0.0, sign(distance), abs(distance) > reach);
}
