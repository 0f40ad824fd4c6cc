// Bends a mesh with a skeleton: each vertex goes where its joints take it, weighted, and so into the world.

struct Layout {
    // Of the first vertex, in words of four bytes from where the binding begins.
    first: u32,
    stride: u32,
    position: u32,
    joints: u32,
    weights: u32,
    // Weights are four 16-bit integers that stand for 0 to 1, and not floats.
    weights_are_packed: u32,
    vertex_count: u32,
    joint_count: u32,
}

@group(0) @binding(0) var<uniform> mesh: Layout;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> world_from_object: array<mat4x4<f32>>;
// Three floats a vertex.
@group(0) @binding(3) var<storage, read_write> positions: array<f32>;

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = id.y * groups.x * 64u + id.x;
    if i >= mesh.vertex_count {
        return;
    }
    let vertex = mesh.first + i * mesh.stride;
    let at = vertex + mesh.position;
    let modelled = vec4<f32>(
        bitcast<f32>(vertices[at]), bitcast<f32>(vertices[at + 1u]), bitcast<f32>(vertices[at + 2u]), 1.0,
    );
    let joints_at = vertex + mesh.joints;
    let words = vec2<u32>(vertices[joints_at], vertices[joints_at + 1u]);
    let joints = vec4<u32>(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
    let weights_at = vertex + mesh.weights;
    var weights: vec4<f32>;
    if mesh.weights_are_packed != 0u {
        weights = vec4<f32>(unpack2x16unorm(vertices[weights_at]), unpack2x16unorm(vertices[weights_at + 1u]));
    } else {
        weights = vec4<f32>(
            bitcast<f32>(vertices[weights_at]), bitcast<f32>(vertices[weights_at + 1u]),
            bitcast<f32>(vertices[weights_at + 2u]), bitcast<f32>(vertices[weights_at + 3u]),
        );
    }
    var bent = vec3<f32>(0.0);
    for (var k = 0u; k < 4u; k += 1u) {
        let joint = min(joints[k], mesh.joint_count - 1u);
        bent += weights[k] * (world_from_object[joint] * modelled).xyz;
    }
    positions[3u * i] = bent.x;
    positions[3u * i + 1u] = bent.y;
    positions[3u * i + 2u] = bent.z;
}
