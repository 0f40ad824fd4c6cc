// Linked from src/primitives/packed_map/halve_four.wesl by `cargo xtask shaders`: edit that, not this.

override PACKING: u32;

@group(0) @binding(0)
var previous: texture_2d_array<u32>;

@group(0) @binding(1)
var first_level: texture_storage_2d_array<r32uint, write>;

@group(0) @binding(2)
var second_level: texture_storage_2d_array<r32uint, write>;

@group(0) @binding(3)
var third_level: texture_storage_2d_array<r32uint, write>;

@group(0) @binding(4)
var fourth_level: texture_storage_2d_array<r32uint, write>;

var<workgroup> of_second: array<u32, 64>;

var<workgroup> of_third: array<u32, 16>;

fn mean(a: u32, b: u32, c: u32, d: u32) -> u32 {
    let upper = packing_unpack_word(a, PACKING) + packing_unpack_word(b, PACKING);
    return packing_pack_word((upper + packing_unpack_word(c, PACKING) + packing_unpack_word(d, PACKING)) / 4.0, PACKING);
}

fn word_at(texel: vec2u, layer: u32) -> u32 {
    return textureLoad(previous, texel, layer, 0).x;
}

fn make_first(texel: vec2u, layer: u32) -> u32 {
    let corner = 2u * texel;
    let word = mean(word_at(corner, layer), word_at(corner + vec2u(1, 0), layer), word_at(corner + vec2u(0, 1), layer), word_at(corner + vec2u(1, 1), layer));
    if all(texel < textureDimensions(first_level)) {
        textureStore(first_level, texel, layer, vec4u(word));
    }
    return word;
}

@compute @workgroup_size(64)
fn halve_four(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let layer = group.z;
    let texel = 8u * group.xy + vec2u(thread % 8u, thread / 8u);
    let corner = 2u * texel;
    let second = mean(make_first(corner, layer), make_first(corner + vec2u(1, 0), layer), make_first(corner + vec2u(0, 1), layer), make_first(corner + vec2u(1, 1), layer));
    of_second[thread] = second;
    if all(texel < textureDimensions(second_level)) {
        textureStore(second_level, texel, layer, vec4u(second));
    }
    workgroupBarrier();
    if thread < 16u {
        let place = vec2u(thread % 4u, thread / 4u);
        let texel = 4u * group.xy + place;
        let i = 16u * place.y + 2u * place.x;
        let word = mean(of_second[i], of_second[i + 1u], of_second[i + 8u], of_second[i + 9u]);
        of_third[thread] = word;
        if all(texel < textureDimensions(third_level)) {
            textureStore(third_level, texel, layer, vec4u(word));
        }
    }
    workgroupBarrier();
    if thread < 4u {
        let place = vec2u(thread % 2u, thread / 2u);
        let texel = 2u * group.xy + place;
        let i = 8u * place.y + 2u * place.x;
        if all(texel < textureDimensions(fourth_level)) {
            let word = mean(of_third[i], of_third[i + 1u], of_third[i + 4u], of_third[i + 5u]);
            textureStore(fourth_level, texel, layer, vec4u(word));
        }
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
