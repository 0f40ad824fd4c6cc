// Linked from src/techniques/summed/encode.wesl with float by `cargo xtask shaders`: edit that, not this.

@group(3) @binding(0)
var basis: texture_storage_2d<rgba32float, write>;

override PART: u32 = 0u;

fn encode(range: depth_range_DepthRange, stored: f32) -> vec4f {
    let t = depth_range_t_of_depth(range, stored);
    let is_empty = stored == uniform_soft.empty_depth;
    switch uniform_BASIS {
        case uniform_BASIS_EXPONENTIAL {
            return select(vec4f(exponential_encode_exponential_z(t, uniform_soft.exponent), 1.0), vec4f(), is_empty);
        }
        case uniform_BASIS_EXPONENTIAL_VARIANCE {
            let c = vec2f(uniform_soft.exponent, uniform_soft.negative_exponent);
            let w = exponential_variance_encode_exponential_variance(t, c);
            let scale = exp(-c);
            return vec4f(w.x * scale.x, w.y * scale.x * scale.x, -w.z * scale.y, w.w * scale.y * scale.y);
        }
        case uniform_BASIS_MOMENT {
            return moment_quantize_moments(moment_encode_moments(t));
        }
        case uniform_BASIS_CONVOLUTION {
            if PART == 4u {
                return vec4f(t, 0.0, 0.0, 0.0);
            }
            let k = 1u + 2u * (PART % 2u);
            let terms = vec4f(convolution_encode_convolution(t, k), convolution_encode_convolution(t, k + 1u));
            return 0.5 + 0.5 * terms * select(1.0, t, PART >= 2u);
        }
        case default {
            return vec4f(variance_encode_variance(t), 0.0, 0.0);
        }
    }
}

@compute @workgroup_size(8, 8)
fn encode_texel(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(basis)) {
        return;
    }
    let value = encode(depth_range_depth_range(), map_unwarped_texel(vec2i(id.xy)));
    textureStore(basis, id.xy, value);
}

@group(1) @binding(3)
var blocker_range_light_map_pyramid: texture_2d<f32>;

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

@group(1) @binding(1)
var map_light_map: texture_depth_2d;

fn map_uv_of_texel(texel: vec2i) -> vec2f {
    return (vec2f(texel) + 0.5) / map_light_view.map_size;
}

fn map_unwarped_texel(texel: vec2i) -> f32 {
    return space_unwarped_depth(map_light_view, textureLoad(map_light_map, texel, 0), map_uv_of_texel(texel));
}

struct space_LightViewGpu {
    origin_in_world: vec3f,
    perspective: u32,
    right_in_world: vec3f,
    depth_scale: f32,
    up_in_world: vec3f,
    depth_offset: f32,
    axis_in_world: vec3f,
    depth_sign: f32,
    uv_from_plane: vec4f,
    plane_from_uv: vec4f,
    uv_origin: vec2f,
    map_size: vec2f,
    near_m: f32,
    far_m: f32,
    texel_in_plane: f32,
    complete_from_m: f32,
    warp: vec2f,
    plane_center: vec2f
}

fn space_is_warped(view: space_LightViewGpu) -> bool {
    return any(view.warp != vec2f());
}

fn space_warped_plane(view: space_LightViewGpu, uv: vec2f) -> vec2f {
    let from_origin = uv - view.uv_origin;
    return view.plane_from_uv.xy * from_origin.x + view.plane_from_uv.zw * from_origin.y;
}

fn space_inverse_divisor(view: space_LightViewGpu, uv: vec2f) -> f32 {
    return max(1.0 - dot(view.warp, space_warped_plane(view, uv)), 0.0001);
}

fn space_unwarped_depth(view: space_LightViewGpu, depth: f32, uv: vec2f) -> f32 {
    if !space_is_warped(view) {
        return depth;
    }
    return depth / space_inverse_divisor(view, uv);
}

fn space_z_of_depth(view: space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}

const convolution_PI = 3.141592653589793;

fn convolution_convolution_frequency(k: u32) -> f32 {
    return (2.0 * f32(k) - 1.0) * convolution_PI;
}

fn convolution_encode_convolution(z: f32, k: u32) -> vec2f {
    let angle = convolution_convolution_frequency(k) * z;
    return vec2f(sin(angle), cos(angle));
}

fn exponential_encode_exponential(z: f32, c: f32) -> f32 {
    return exp(c * (z - 1.0));
}

fn exponential_encode_exponential_z(z: f32, c: f32) -> vec3f {
    let e = exponential_encode_exponential(z, c);
    return vec3f(e, z * e, z);
}

fn exponential_variance_warp_exponential(t: f32, c: vec2f) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(exp(c.x * u), -exp(-c.y * u));
}

fn exponential_variance_encode_exponential_variance(t: f32, c: vec2f) -> vec4f {
    let w = exponential_variance_warp_exponential(t, c);
    return vec4f(w.x, w.x * w.x, w.y, w.y * w.y);
}

fn moment_encode_moments(t: f32) -> vec4f {
    let u = 2.0 * t - 1.0;
    let u2 = u * u;
    return vec4f(u, u2, u * u2, u2 * u2);
}

fn moment_quantize_moments(m: vec4f) -> vec4f {
    return vec4f(1.5 * m.x - 2.0 * m.z + 0.5, 4.0 * (m.y - m.w), 0.8660254 * m.x - 0.3849002 * m.z + 0.5, 0.5 * (m.y + m.w));
}

fn variance_encode_variance(t: f32) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(t, u * u);
}

const depth_range_FARTHEST_M = 10000000.0;

struct depth_range_DepthRange {
    near_m: f32,
    far_m: f32
}

fn depth_range_depth_range() -> depth_range_DepthRange {
    let view_far_m = min(map_light_view.far_m, depth_range_FARTHEST_M);
    var range = depth_range_DepthRange(map_light_view.near_m, view_far_m);
    if uniform_soft.range_from_map == 1u {
        let ends = textureLoad(blocker_range_light_map_pyramid, vec2u(0u), textureNumLevels(blocker_range_light_map_pyramid) - 1u);
        let a = space_z_of_depth(map_light_view, ends.x);
        let b = space_z_of_depth(map_light_view, ends.y);
        let farthest_m = view_far_m + 0.001 * (view_far_m - map_light_view.near_m);
        range = depth_range_DepthRange(clamp(min(a, b), -depth_range_FARTHEST_M, farthest_m), clamp(max(a, b), -depth_range_FARTHEST_M, farthest_m));
    }
    range.far_m = max(range.far_m, range.near_m + 0.001 * max(abs(range.near_m), 1.0));
    return range;
}

fn depth_range_t_of_z(range: depth_range_DepthRange, z_m: f32) -> f32 {
    return (z_m - range.near_m) / (range.far_m - range.near_m);
}

fn depth_range_t_of_depth(range: depth_range_DepthRange, depth: f32) -> f32 {
    return saturate(depth_range_t_of_z(range, space_z_of_depth(map_light_view, depth)));
}

override uniform_BASIS: u32 = 0u;

const uniform_BASIS_EXPONENTIAL = 1u;

const uniform_BASIS_EXPONENTIAL_VARIANCE = 3u;

const uniform_BASIS_MOMENT = 4u;

const uniform_BASIS_CONVOLUTION = 5u;

struct uniform_SoftUniform {
    light_extent: vec2f,
    light_extent_axis: f32,
    bias_scale: f32,
    light_covariance: vec3f,
    exponent: f32,
    light_mean: vec2f,
    negative_exponent: f32,
    value_scale: f32,
    tile_log2: u32,
    range_from_map: u32,
    empty_depth: f32,
    non_planar: f32,
    subdivisions: u32,
    search_scales: u32,
    search_taps: u32,
    row_height: f32,
    is_ellipse: u32,
    with_footprint: u32,
    direct_texels: f32,
    max_part_texels: f32,
    bleeding_reduction: f32,
    may_read_map: u32,
    padding_0: f32,
    padding_1: f32
}

@group(2) @binding(0)
var<uniform> uniform_soft: uniform_SoftUniform;
