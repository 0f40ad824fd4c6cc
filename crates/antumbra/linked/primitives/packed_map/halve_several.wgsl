// Linked from src/primitives/packed_map/halve_several.wesl by `cargo xtask shaders`: edit that, not this.

override PACKING: u32;

var<workgroup> words: array<u32, 340>;

fn mean(a: u32, b: u32, c: u32, d: u32) -> u32 {
    let upper = packing_unpack_word(a, PACKING) + packing_unpack_word(b, PACKING);
    return packing_pack_word((upper + packing_unpack_word(c, PACKING) + packing_unpack_word(d, PACKING)) / 4.0, PACKING);
}

fn make_first(texel: vec2u, layer: u32) -> u32 {
    let corner = 2u * texel;
    let word = mean(mips_word_before(corner, layer), mips_word_before(corner + vec2u(1, 0), layer), mips_word_before(corner + vec2u(0, 1), layer), mips_word_before(corner + vec2u(1, 1), layer));
    mips_store_word(1u, texel, layer, word);
    return word;
}

@compute @workgroup_size(16, 16)
fn halve_several(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let layer = group.z;
    let texel = 16u * group.xy + local.xy;
    let corner = 2u * texel;
    let second = mean(make_first(corner, layer), make_first(corner + vec2u(1, 0), layer), make_first(corner + vec2u(0, 1), layer), make_first(corner + vec2u(1, 1), layer));
    mips_store_word(2u, texel, layer, second);
    words[16u * local.y + local.x] = second;
    var begin = 0u;
    var side = 16u;
    for (var step = 3u; step <= min(mips_mips.count, 6u); step++) {
        workgroupBarrier();
        let half = side / 2u;
        if all(local.xy < vec2u(half)) {
            let i = begin + 2u * (side * local.y + local.x);
            let word = mean(words[i], words[i + 1u], words[i + side], words[i + side + 1u]);
            mips_store_word(step, half * group.xy + local.xy, layer, word);
            if half > 1u {
                words[begin + side * side + half * local.y + local.x] = word;
            }
        }
        begin += side * side;
        side = half;
    }
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
