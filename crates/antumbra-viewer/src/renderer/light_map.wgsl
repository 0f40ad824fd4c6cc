// Light map in grey levels: surfaces near the light are bright.

struct LightMap {
    // Corner in the image, pixels.
    corner_px: vec2f,
    side_px: f32,
    is_perspective: u32,
    depth_scale: f32,
    depth_offset: f32,
    empty_depth: f32,
    nearest_m: f32,
    farthest_m: f32,
    // Packing of channels in a filtered map's words.
    packing: u32,
    size_texels: vec2u,
    // Origin of a filtered map's level in its texture.
    origin_texels: vec2u,
    // Factor of stored depths at the map position (u, v): x + y u + z v.
    depth_warp: vec4f,
    // Colour of texels without casters; sRGB.
    empty_color: vec4f,
}

@group(0) @binding(0) var<uniform> map: LightMap;
@group(0) @binding(1) var depths: texture_depth_2d;
@group(0) @binding(2) var depths_of_samples: texture_depth_multisampled_2d;
// Minimum and maximum depth of a square of texels.
@group(0) @binding(3) var extremes: texture_2d<f32>;
@group(0) @binding(4) var words: texture_2d<u32>;
// Minimum and maximum of the first channel, as words ordered like floats.
@group(0) @binding(5) var<storage, read_write> sought: array<atomic<u32>, 2>;
// The same values for reading, once they are complete.
@group(0) @binding(6) var<storage, read> ends: array<u32, 2>;

// Grey level of the farthest surface, which must differ from texels without casters.
const DARKEST = 0.08;

@vertex
fn vertex_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn texel_at(position: vec4f) -> vec2u {
    let unit = (position.xy - map.corner_px) / map.side_px;
    return min(vec2u(saturate(unit) * vec2f(map.size_texels)), map.size_texels - 1u);
}

fn color_of(stored: f32, texel: vec2u) -> vec4f {
    if stored == map.empty_depth {
        return map.empty_color;
    }
    let place = (vec2f(texel) + 0.5) / vec2f(map.size_texels);
    let depth = stored / (map.depth_warp.x + dot(map.depth_warp.yz, place));
    let along = (depth - map.depth_offset) / map.depth_scale;
    let distance_m = select(along, 1.0 / along, map.is_perspective == 1u);
    let far = saturate((distance_m - map.nearest_m) / (map.farthest_m - map.nearest_m));
    return vec4f(vec3f(mix(1.0, DARKEST, far)), 1.0);
}

@fragment
fn fragment_single(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = texel_at(position);
    return color_of(textureLoad(depths, texel, 0), texel);
}

// Uses the first sample of the texel.
@fragment
fn fragment_multisampled(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = texel_at(position);
    return color_of(textureLoad(depths_of_samples, texel, 0), texel);
}

// Uses the nearest depth: the maximum if empty texels are 0, the minimum if they are 1.
@fragment
fn fragment_extremes(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = texel_at(position);
    let both = textureLoad(extremes, texel, 0).xy;
    return color_of(select(both.x, both.y, map.empty_depth == 0.0), texel);
}

fn first_channel(texel: vec2u) -> f32 {
    let word = textureLoad(words, map.origin_texels + texel, 0).x;
    switch map.packing {
        case 1u: {
            return unpack2x16float(word).x;
        }
        case 2u: {
            return unpack2x16unorm(word).x;
        }
        case 3u: {
            return unpack4x8unorm(word).x;
        }
        default: {
            return bitcast<f32>(word);
        }
    }
}

// Maps a float to a word with the same order, negative numbers included.
fn ordered_from_float(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn float_from_ordered(ordered: u32) -> f32 {
    return bitcast<f32>(select(~ordered, ordered & 0x7fffffffu, (ordered & 0x80000000u) != 0u));
}

@compute @workgroup_size(8, 8)
fn seek_ends(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= map.size_texels) {
        return;
    }
    let value = ordered_from_float(first_channel(id.xy));
    atomicMin(&sought[0], value);
    atomicMax(&sought[1], value);
}

@fragment
fn fragment_filtered(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let least = float_from_ordered(ends[0]);
    let greatest = float_from_ordered(ends[1]);
    // If all values are equal, all texels are bright.
    let part = (first_channel(texel_at(position)) - least) / max(greatest - least, 1e-30);
    return vec4f(vec3f(mix(1.0, DARKEST, saturate(part))), 1.0);
}
