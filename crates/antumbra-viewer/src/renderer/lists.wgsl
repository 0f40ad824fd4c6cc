// Lists per texel of a light's map, as colours by how long they are.

struct Lists {
    // In the picture, pixels.
    corner_px: vec2f,
    extent_px: vec2f,
    size_texels: vec2u,
    // The level's first list.
    first: u32,
    // 1: a list's words are where it begins and how long it is. 0: where it begins.
    is_counted: u32,
    // 1: texels lie along a curve of halvings. 0: row after row. 2: a word tells which.
    order: u32,
    told_by: u32,
    padding_1: u32,
    padding_2: u32,
    // Where nothing is listed; sRGB.
    empty_color: vec4f,
}

// How long the longest list is, and how much is listed in all.
struct Totals {
    longest: atomic<u32>,
    sum: atomic<u32>,
}

@group(0) @binding(0) var<uniform> lists: Lists;
@group(0) @binding(1) var<storage, read> words: array<u32>;
@group(0) @binding(2) var<storage, read_write> totals: Totals;
// The same, once all are counted: longest, sum.
@group(0) @binding(3) var<storage, read> counted: array<u32, 2>;

// Bits of a map's side: 65536 texels, more than any device has.
const MAX_BITS = 16u;

fn length_at(texel: vec2u) -> u32 {
    var i = texel.y * lists.size_texels.x + texel.x;
    if lists.order == 1u || (lists.order == 2u && words[lists.told_by] == 1u) {
        i = 0u;
        for (var bit = 0u; bit < MAX_BITS; bit++) {
            // Chromium's compiler wants every parenthesis.
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

// From dark violet over red to light yellow, ever brighter; sRGB.
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
    // The longest is the brightest, also where none has more than one; of others, one is the darkest, and twice as long is a
    // step brighter, whatever the length.
    let part = log2(f32(length)) / log2(f32(max(counted[0], 2u)));
    return vec4f(ramp(select(part, 1.0, length == counted[0])), 1.0);
}
