// A light map as grey levels: what is near to the light is bright.

struct LightMap {
    // In the picture, pixels.
    corner_px: vec2f,
    side_px: f32,
    is_perspective: u32,
    depth_scale: f32,
    depth_offset: f32,
    empty_depth: f32,
    nearest_m: f32,
    farthest_m: f32,
    size_texels: u32,
    padding: vec2u,
    // Where nothing casts; sRGB.
    empty_color: vec4f,
}

@group(0) @binding(0) var<uniform> map: LightMap;
@group(0) @binding(1) var depths: texture_depth_2d;
@group(0) @binding(2) var depths_of_samples: texture_depth_multisampled_2d;

// The farthest is told from where nothing casts.
const DARKEST = 0.08;

@vertex
fn vertex_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn texel_at(position: vec4f) -> vec2u {
    let unit = (position.xy - map.corner_px) / map.side_px;
    return min(vec2u(saturate(unit) * f32(map.size_texels)), vec2u(map.size_texels - 1u));
}

fn color_of(depth: f32) -> vec4f {
    if depth == map.empty_depth {
        return map.empty_color;
    }
    let along = (depth - map.depth_offset) / map.depth_scale;
    let distance_m = select(along, 1.0 / along, map.is_perspective == 1u);
    let far = saturate((distance_m - map.nearest_m) / (map.farthest_m - map.nearest_m));
    return vec4f(vec3f(mix(1.0, DARKEST, far)), 1.0);
}

@fragment
fn fragment_single(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return color_of(textureLoad(depths, texel_at(position), 0));
}

// The first sample stands for its texel.
@fragment
fn fragment_multisampled(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return color_of(textureLoad(depths_of_samples, texel_at(position), 0));
}
