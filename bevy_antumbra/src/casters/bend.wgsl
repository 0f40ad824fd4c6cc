// Deforms a mesh with morph targets, a skeleton or both: adds the weighted targets to each vertex, then applies the weighted
// joint matrices, which transform it to world space. Without a skeleton the vertex stays in object space.

struct Layout {
    // Offset of the first vertex from the start of the binding, in words of four bytes.
    first: u32,
    stride: u32,
    position: u32,
    // Whether positions are four 16-bit integers that encode −1 to 1 within a box, instead of floats.
    positions_are_packed: u32,
    joints: u32,
    weights: u32,
    // Whether weights are four 16-bit integers that encode 0 to 1, instead of floats.
    weights_are_packed: u32,
    vertex_count: u32,
    // Number of joints; 0 without a skeleton.
    joint_count: u32,
    // Offset of the first target's first vertex, in words as above.
    first_target: u32,
    // Number of morph targets; 0 without morphing.
    target_count: u32,
    padding: u32,
    // Half extents and centre of the box that decodes packed positions.
    half_extents: vec4<f32>,
    center: vec4<f32>,
}

@group(0) @binding(0) var<uniform> mesh: Layout;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> world_from_object: array<mat4x4<f32>>;
// Deformed positions: three floats per vertex.
@group(0) @binding(3) var<storage, read_write> positions: array<f32>;
// Morph targets, one after the other: for each vertex the differences of position, normal and tangent, four words each.
@group(0) @binding(4) var<storage, read> targets: array<f32>;
@group(0) @binding(5) var<storage, read> target_weights: array<f32>;

const TARGET_WORDS: u32 = 12u;

fn modelled(vertex: u32) -> vec3<f32> {
    let at = vertex + mesh.position;
    if mesh.positions_are_packed != 0u {
        let packed = vec3<f32>(unpack2x16snorm(vertices[at]), unpack2x16snorm(vertices[at + 1u]).x);
        return mesh.center.xyz + mesh.half_extents.xyz * packed;
    }
    return vec3<f32>(bitcast<f32>(vertices[at]), bitcast<f32>(vertices[at + 1u]), bitcast<f32>(vertices[at + 2u]));
}

fn morphed(i: u32, pos_in_object: vec3<f32>) -> vec3<f32> {
    var pos = pos_in_object;
    for (var k = 0u; k < mesh.target_count; k += 1u) {
        let weight = target_weights[k];
        if weight != 0.0 {
            let at = mesh.first_target + TARGET_WORDS * (k * mesh.vertex_count + i);
            pos += weight * vec3<f32>(targets[at], targets[at + 1u], targets[at + 2u]);
        }
    }
    return pos;
}

fn skinned(vertex: u32, pos_in_object: vec3<f32>) -> vec3<f32> {
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
    var pos_in_world = vec3<f32>(0.0);
    for (var k = 0u; k < 4u; k += 1u) {
        let joint = min(joints[k], mesh.joint_count - 1u);
        pos_in_world += weights[k] * (world_from_object[joint] * vec4<f32>(pos_in_object, 1.0)).xyz;
    }
    return pos_in_world;
}

@compute @workgroup_size(64)
fn bend(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = id.y * groups.x * 64u + id.x;
    if i >= mesh.vertex_count {
        return;
    }
    let vertex = mesh.first + i * mesh.stride;
    var pos = morphed(i, modelled(vertex));
    if mesh.joint_count > 0u {
        pos = skinned(vertex, pos);
    }
    positions[3u * i] = pos.x;
    positions[3u * i + 1u] = pos.y;
    positions[3u * i + 2u] = pos.z;
}
