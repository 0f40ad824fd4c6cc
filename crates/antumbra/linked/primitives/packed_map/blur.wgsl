// Linked from src/primitives/packed_map/blur.wesl by `cargo xtask shaders`: edit that, not this.

override PACKING: u32;

const TILE = 16;

struct BlurUniform {
    direction: vec2i,
    radius: i32,
    padding: u32
}

@group(0) @binding(0)
var<uniform> blur: BlurUniform;

@group(0) @binding(1)
var<storage, read> weights: array<f32>;

@group(0) @binding(2)
var source: texture_2d_array<u32>;

@group(0) @binding(3)
var target_layers: texture_storage_2d_array<r32uint, write>;

var<workgroup> words: array<u32, 3840>;

@compute @workgroup_size(16, 16)
fn blur_line(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) group: vec3u) {
    let size = vec2i(textureDimensions(target_layers));
    let first = vec2i(group.xy) * TILE;
    let count = TILE + 2 * blur.radius;
    let is_row = blur.direction.x == 1;
    let step = select(TILE, 1, is_row);
    var start = i32(local.x);
    if is_row {
        start = i32(local.y) * count;
        for (var i = i32(local.x); i < count; i += TILE) {
            let texel = clamp(first + vec2i(i - blur.radius, i32(local.y)), vec2i(0), size - 1);
            words[start + i] = textureLoad(source, texel, group.z, 0).x;
        }
        start += i32(local.x);
    }
    else {
        for (var i = i32(local.y); i < count; i += TILE) {
            let texel = clamp(first + vec2i(i32(local.x), i - blur.radius), vec2i(0), size - 1);
            words[start + i * TILE] = textureLoad(source, texel, group.z, 0).x;
        }
        start += i32(local.y) * TILE;
    }
    workgroupBarrier();
    var sum = vec4f();
    for (var i = 0; i <= 2 * blur.radius; i++) {
        sum += weights[i] * packing_unpack_word(words[start + i * step], PACKING);
    }
    if all(vec2i(id.xy) < size) {
        textureStore(target_layers, id.xy, group.z, vec4u(packing_pack_word(sum, PACKING)));
    }
}

const packing_PACKING_FLOAT16 = 1u;

const packing_PACKING_UNORM16 = 2u;

const packing_PACKING_UNORM8 = 3u;

fn packing_unpack_word(word: u32, packing: u32) -> vec4f {
    switch packing {
        case packing_PACKING_FLOAT16 {
            return vec4f(unpack2x16float(word), 0.0, 0.0);
        }
        case packing_PACKING_UNORM16 {
            return vec4f(unpack2x16unorm(word), 0.0, 0.0);
        }
        case packing_PACKING_UNORM8 {
            return unpack4x8unorm(word);
        }
        case default {
            return vec4f(bitcast<f32>(word), 0.0, 0.0, 0.0);
        }
    }
}

fn packing_pack_word(channels: vec4f, packing: u32) -> u32 {
    switch packing {
        case packing_PACKING_FLOAT16 {
            return pack2x16float(channels.xy);
        }
        case packing_PACKING_UNORM16 {
            return pack2x16unorm(channels.xy);
        }
        case packing_PACKING_UNORM8 {
            return pack4x8unorm(channels);
        }
        case default {
            return bitcast<u32>(channels.x);
        }
    }
}
