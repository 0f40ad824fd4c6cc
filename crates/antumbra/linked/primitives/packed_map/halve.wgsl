// Linked from src/primitives/packed_map/halve.wesl by `cargo xtask shaders`: edit that, not this.

override PACKING: u32;

@compute @workgroup_size(8, 8)
fn halve_level(@builtin(global_invocation_id) id: vec3u) {
    let size_before = levels_level_size(mips_mips.map_size, mips_mips.before);
    let size = levels_level_size(mips_mips.map_size, mips_mips.before + 1u);
    if any(id.xy >= size) {
        return;
    }
    let scale = vec2f(size_before) / vec2f(size);
    let low = vec2f(id.xy) * scale;
    let high = low + scale;
    let first = vec2u(low);
    let end = min(vec2u(ceil(high)), size_before);
    var sum = vec4f();
    for (var y = first.y; y < end.y; y++) {
        let height = min(high.y, f32(y + 1u)) - max(low.y, f32(y));
        for (var x = first.x; x < end.x; x++) {
            let width = min(high.x, f32(x + 1u)) - max(low.x, f32(x));
            sum += width * height * packing_unpack_word(mips_word_before(vec2u(x, y), id.z), PACKING);
        }
    }
    mips_store_word(1u, id.xy, id.z, packing_pack_word(sum / (scale.x * scale.y), PACKING));
}

fn levels_level_size(map_size: vec2u, level: u32) -> vec2u {
    return map_size >> vec2u(level);
}

fn levels_level_origin(map_size: vec2u, level: u32) -> vec2u {
    if level <= 1u {
        return vec2u();
    }
    return vec2u(map_size.x >> 1u, (map_size.y >> 1u) - (map_size.y >> (level - 1u)));
}

struct mips_MipsUniform {
    map_size: vec2u,
    before: u32,
    count: u32
}

@group(0) @binding(0)
var<uniform> mips_mips: mips_MipsUniform;

@group(0) @binding(1)
var mips_first_level: texture_2d_array<u32>;

@group(0) @binding(2)
var mips_further_levels: texture_storage_2d_array<r32uint, read_write>;

fn mips_word_before(texel: vec2u, layer: u32) -> u32 {
    if mips_mips.before == 0u {
        return textureLoad(mips_first_level, texel, layer, 0).x;
    }
    return textureLoad(mips_further_levels, levels_level_origin(mips_mips.map_size, mips_mips.before) + texel, layer).x;
}

fn mips_store_word(step: u32, texel: vec2u, layer: u32, word: u32) {
    let level = mips_mips.before + step;
    if step <= mips_mips.count && all(texel < levels_level_size(mips_mips.map_size, level)) {
        textureStore(mips_further_levels, levels_level_origin(mips_mips.map_size, level) + texel, layer, vec4u(word));
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
