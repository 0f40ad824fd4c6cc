// Linked from src/casters/pack.wesl by `cargo xtask shaders`: edit that, not this.

struct PackMesh {
    position_scale: vec3f,
    vertex_count: u32,
    position_offset: vec3f,
    index_count: u32,
    uv_x: vec2f,
    uv_y: vec2f,
    uv_offset: vec2f,
    position_first: u32,
    position_stride: u32,
    uv_first: u32,
    uv_stride: u32,
    index_first: u32,
    base_vertex: i32,
    position_format: u32,
    uv_format: u32,
    index_format: u32,
    first_vertex: u32,
    first_index: u32,
    is_strip: u32,
    padding_0: u32,
    padding_1: u32
}

@group(0) @binding(0)
var<uniform> pack: PackMesh;

@group(0) @binding(1)
var<storage, read> host_positions: array<u32>;

@group(0) @binding(2)
var<storage, read> host_uvs: array<u32>;

@group(0) @binding(3)
var<storage, read> host_indices: array<u32>;

@group(0) @binding(4)
var<storage, read_write> positions: array<f32>;

@group(0) @binding(5)
var<storage, read_write> uvs: array<vec2f>;

@group(0) @binding(6)
var<storage, read_write> indices: array<u32>;

const FLOAT_32 = 0u;

const SNORM_16 = 1u;

const UNORM_16 = 2u;

const FLOAT_16 = 3u;

const NO_UVS = 4u;

const NO_INDICES = 0u;

const INDICES_16 = 1u;

fn position_of(vertex: u32) -> vec3f {
    let at = pack.position_first + vertex * pack.position_stride;
    var p: vec3f;
    if pack.position_format == FLOAT_32 {
        p = bitcast<vec3f>(vec3u(host_positions[at], host_positions[at + 1u], host_positions[at + 2u]));
    }
    else {
        let words = vec2u(host_positions[at], host_positions[at + 1u]);
        if pack.position_format == SNORM_16 {
            p = vec3f(unpack2x16snorm(words.x), unpack2x16snorm(words.y).x);
        }
        else {
            p = vec3f(unpack2x16unorm(words.x), unpack2x16unorm(words.y).x);
        }
        p = p * pack.position_scale + pack.position_offset;
    }
    return p;
}

fn uv_of(vertex: u32) -> vec2f {
    let at = pack.uv_first + vertex * pack.uv_stride;
    var uv: vec2f;
    if pack.uv_format == FLOAT_32 {
        uv = bitcast<vec2f>(vec2u(host_uvs[at], host_uvs[at + 1u]));
    }
    else if pack.uv_format == FLOAT_16 {
        uv = unpack2x16float(host_uvs[at]);
    }
    else if pack.uv_format == UNORM_16 {
        uv = unpack2x16unorm(host_uvs[at]);
    }
    else {
        uv = unpack2x16snorm(host_uvs[at]);
    }
    return pack.uv_x * uv.x + pack.uv_y * uv.y + pack.uv_offset;
}

fn host_index(i: u32) -> u32 {
    if pack.index_format == NO_INDICES {
        return i;
    }
    let at = pack.index_first + i;
    if pack.index_format == INDICES_16 {
        return extractBits(host_indices[at / 2u], 16u * (at % 2u), 16u);
    }
    return host_indices[at];
}

fn is_restart(i: u32) -> bool {
    let all_ones = select(4294967295u, 65535u, pack.index_format == INDICES_16);
    return pack.index_format != NO_INDICES && host_index(i) == all_ones;
}

fn index_of(i: u32) -> u32 {
    var corner = i;
    if pack.is_strip == 1u {
        let first = i / 3u;
        if is_restart(first) || is_restart(first + 1u) || is_restart(first + 2u) {
            return 0u;
        }
        corner = first + i % 3u;
    }
    let index = host_index(corner);
    return select(u32(max(bitcast<i32>(index) + pack.base_vertex, 0)), index, pack.index_format == NO_INDICES);
}

@compute @workgroup_size(64)
fn pack_mesh(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let i = id.y * workgroups.x * 64u + id.x;
    if i < pack.vertex_count {
        let p = position_of(i);
        let at = 3u * (pack.first_vertex + i);
        positions[at] = p.x;
        positions[at + 1u] = p.y;
        positions[at + 2u] = p.z;
        if pack.uv_format != NO_UVS {
            uvs[pack.first_vertex + i] = uv_of(i);
        }
    }
    if i < pack.index_count {
        indices[pack.first_index + i] = pack.first_vertex + min(index_of(i), pack.vertex_count - 1u);
    }
}
