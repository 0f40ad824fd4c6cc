// Lengths of a light map's lists per texel, as colours.

struct Lists {
    // Corner in the image, pixels.
    corner_px: vec2f,
    extent_px: vec2f,
    size_texels: vec2u,
    // Index of the level's first list.
    first: u32,
    // 1: a list's words are its offset and its length. 0: its offset alone.
    is_counted: u32,
    // Order of texels. 1: Z-order curve. 0: row by row. 2: the word at `told_by` is 1 for the curve.
    order: u32,
    told_by: u32,
    padding_1: u32,
    padding_2: u32,
    // Colour of empty lists; sRGB.
    empty_color: vec4f,
}

// Length of the longest list, and sum of all lengths.
struct Totals {
    longest: atomic<u32>,
    sum: atomic<u32>,
}

@group(0) @binding(0) var<uniform> lists: Lists;
@group(0) @binding(1) var<storage, read> words: array<u32>;
@group(0) @binding(2) var<storage, read_write> totals: Totals;
// The same values for reading, once they are complete: longest, sum.
@group(0) @binding(3) var<storage, read> counted: array<u32, 2>;

// Number of bits of a map's side: 65536 texels, more than any device supports.
const MAX_BITS = 16u;

fn length_at(texel: vec2u) -> u32 {
    var i = texel.y * lists.size_texels.x + texel.x;
    if lists.order == 1u || (lists.order == 2u && words[lists.told_by] == 1u) {
        i = 0u;
        for (var bit = 0u; bit < MAX_BITS; bit++) {
            // Chromium's compiler requires all parentheses.
            i |= (((texel.x >> bit) & 1u) << (2u * bit)) | (((texel.y >> bit) & 1u) << (2u * bit + 1u));
        }
    }
    i += lists.first;
    if lists.is_counted == 1u {
        return words[2u * i + 1u];
    }
    return words[i + 1u] - words[i];
}

@compute @workgroup_size(8, 8)
fn count(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= lists.size_texels) {
        return;
    }
    let length = length_at(id.xy);
    if length > 0u {
        atomicMax(&totals.longest, length);
        atomicAdd(&totals.sum, length);
    }
}

@vertex
fn vertex_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Colour ramp from dark violet over red to light yellow, of increasing brightness; sRGB.
fn ramp(part: f32) -> vec3f {
    let from_violet = mix(vec3f(0.20, 0.07, 0.42), vec3f(0.86, 0.30, 0.26), saturate(2.0 * part));
    return mix(from_violet, vec3f(1.0, 0.96, 0.62), saturate(2.0 * part - 1.0));
}

@fragment
fn fragment_lists(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let unit = saturate((position.xy - lists.corner_px) / lists.extent_px);
    let texel = min(vec2u(unit * vec2f(lists.size_texels)), lists.size_texels - 1u);
    let length = length_at(texel);
    if length == 0u {
        return lists.empty_color;
    }
    // The longest list is the brightest, even if its length is 1. Otherwise length 1 is the darkest, and each doubling is one
    // equal step brighter.
    let part = log2(f32(length)) / log2(f32(max(counted[0], 2u)));
    return vec4f(ramp(select(part, 1.0, length == counted[0])), 1.0);
}
