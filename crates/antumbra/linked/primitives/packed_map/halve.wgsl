// Linked from src/primitives/packed_map/halve.wesl by `cargo xtask shaders`: edit that, not this.

override PACKING: u32;

@group(0) @binding(0)
var previous: texture_2d_array<u32>;

@group(0) @binding(1)
var level: texture_storage_2d_array<r32uint, write>;

@compute @workgroup_size(8, 8)
fn halve_level(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(level);
    if any(id.xy >= size) {
        return;
    }
    let scale = vec2f(textureDimensions(previous)) / vec2f(size);
    let low = vec2f(id.xy) * scale;
    let high = low + scale;
    let first = vec2u(low);
    let end = min(vec2u(ceil(high)), textureDimensions(previous));
    var sum = vec4f();
    for (var y = first.y; y < end.y; y++) {
        let height = min(high.y, f32(y + 1u)) - max(low.y, f32(y));
        for (var x = first.x; x < end.x; x++) {
            let width = min(high.x, f32(x + 1u)) - max(low.x, f32(x));
            sum += width * height * packing_unpack_word(textureLoad(previous, vec2u(x, y), id.z, 0).x, PACKING);
        }
    }
    textureStore(level, id.xy, id.z, vec4u(packing_pack_word(sum / (scale.x * scale.y), PACKING)));
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
