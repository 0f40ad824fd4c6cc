// Skinning by the host: joints transform the vertices of one buffer into another.

// Same layout as the vertex buffer, 40 bytes.
struct Vertex {
    x: f32, y: f32, z: f32,
    normal_x: f32, normal_y: f32, normal_z: f32,
    u: f32, v: f32,
    joints: u32,
    weights: u32,
}

@group(0) @binding(0) var<uniform> joints: array<mat4x4f, 4>;
@group(0) @binding(1) var<storage, read> modelled: array<Vertex>;
@group(0) @binding(2) var<storage, read_write> skinned: array<Vertex>;

@compute @workgroup_size(64)
fn skin_vertices(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&modelled) {
        return;
    }
    var vertex = modelled[id.x];
    let numbers = unpack4xU8(vertex.joints);
    let weights = unpack4x8unorm(vertex.weights);
    var position = vec3f(0.0);
    var normal = vec3f(0.0);
    for (var j = 0; j < 4; j++) {
        let joint = joints[numbers[j]];
        position += weights[j] * (joint * vec4f(vertex.x, vertex.y, vertex.z, 1.0)).xyz;
        normal += weights[j] * (joint * vec4f(vertex.normal_x, vertex.normal_y, vertex.normal_z, 0.0)).xyz;
    }
    vertex.x = position.x;
    vertex.y = position.y;
    vertex.z = position.z;
    normal = normalize(normal);
    vertex.normal_x = normal.x;
    vertex.normal_y = normal.y;
    vertex.normal_z = normal.z;
    skinned[id.x] = vertex;
}
