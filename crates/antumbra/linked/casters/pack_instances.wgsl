// Linked from src/casters/pack_instances.wesl by `cargo xtask shaders`: edit that, not this.

struct PackInstances {
    first: u32,
    stride: u32,
    count: u32,
    is_rows: u32,
    first_instance: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(0) @binding(0)
var<uniform> pack: PackInstances;

@group(0) @binding(1)
var<storage, read> host_instances: array<f32>;

@group(0) @binding(2)
var<storage, read_write> instances: array<mat4x4f>;

fn four(at: u32) -> vec4f {
    return vec4f(host_instances[at], host_instances[at + 1u], host_instances[at + 2u], host_instances[at + 3u]);
}

@compute @workgroup_size(64)
fn pack_instances(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let i = id.y * workgroups.x * 64u + id.x;
    if i >= pack.count {
        return;
    }
    let at = pack.first + i * pack.stride;
    var matrix: mat4x4f;
    if pack.is_rows == 1u {
        matrix = transpose(mat4x4f(four(at), four(at + 4u), four(at + 8u), vec4f(0.0, 0.0, 0.0, 1.0)));
    }
    else {
        matrix = mat4x4f(four(at), four(at + 4u), four(at + 8u), four(at + 12u));
    }
    instances[pack.first_instance + i] = matrix;
}
