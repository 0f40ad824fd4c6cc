// Linked from src/techniques/filterable/lvsm/histogram.wesl by `cargo xtask shaders`: edit that, not this.

struct LvsmHistogramUniform {
    stride: u32,
    overlap: f32,
    kernel_size: f32,
    min_weight: f32,
    max_weight: f32,
    padding_x: u32,
    padding_y: u32,
    padding_z: u32
}

override AS_PUBLISHED: bool = false;

override COUNTS_BACKGROUND: bool = false;

const BIN_COUNT = 4096.0;

const WEIGHT_SCALE = 65535.0;

@group(1) @binding(0)
var<uniform> neighbourhoods: LvsmHistogramUniform;

@group(1) @binding(1)
var<storage, read_write> histogram: array<atomic<u32>>;

const MAX_STRIDE = 16u;

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let stride = min(neighbourhoods.stride, MAX_STRIDE);
    for (var y = 0u; y < stride; y++) {
        for (var x = 0u; x < stride; x++) {
            gather_at(id.xy * neighbourhoods.stride + vec2u(x, y), WEIGHT_SCALE / f32(stride * stride));
        }
    }
}

fn gather_at(first: vec2u, scale: f32) {
    if any(first + 1u >= textureDimensions(source_light_map)) {
        return;
    }
    let t = vec4f(source_sample_t(first, 0u), source_sample_t(first + vec2u(1, 0), 0u), source_sample_t(first + vec2u(0, 1), 0u), source_sample_t(first + vec2u(1, 1), 0u));
    let deepest = max(max(t.x, t.y), max(t.z, t.w));
    if !COUNTS_BACKGROUND && deepest >= 1.0 {
        return;
    }
    let mean = dot(t, vec4f(0.25));
    let off = t - mean;
    let variance = dot(off, off) * 0.25;
    let counted = select(min(variance, neighbourhoods.max_weight), 0.0, variance < neighbourhoods.min_weight);
    let weight = u32(counted * scale + 0.5);
    if weight > 0u {
        let second = min(mean + sqrt(variance), select(deepest, 1.0, AS_PUBLISHED));
        atomicAdd(&histogram[min(u32(second * BIN_COUNT), u32(BIN_COUNT) - 1u)], weight);
    }
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

fn space_warped_plane(view: space_LightViewGpu, uv: vec2f) -> vec2f {
    let from_origin = uv - view.uv_origin;
    return view.plane_from_uv.xy * from_origin.x + view.plane_from_uv.zw * from_origin.y;
}

fn space_z_of_depth(view: space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}

struct source_FilterUniform {
    packing: u32,
    sample_count: u32,
    kernel_radius: u32,
    max_anisotropy: u32,
    bias_scale: f32,
    t_step: f32,
    near_m: f32,
    far_m: f32,
    depth_axis: vec3f,
    level_count: u32
}

override source_IS_DISTANCE: bool = false;

fn source_along_axis_m(view: space_LightViewGpu, range: source_FilterUniform, uv: vec2f, z_m: f32) -> f32 {
    let plane = space_warped_plane(view, uv);
    if source_IS_DISTANCE {
        return z_m * length(vec3f(plane, 1.0));
    }
    if view.perspective == 1u {
        return z_m * dot(range.depth_axis, vec3f(plane, 1.0));
    }
    return dot(range.depth_axis, vec3f(plane, z_m));
}

fn source_t_at(view: space_LightViewGpu, range: source_FilterUniform, uv: vec2f, z_m: f32) -> f32 {
    return saturate((source_along_axis_m(view, range, uv, z_m) - range.near_m) / (range.far_m - range.near_m));
}

@group(0) @binding(0)
var<uniform> source_map_view: space_LightViewGpu;

@group(0) @binding(1)
var<uniform> source_settings: source_FilterUniform;

@group(0) @binding(2)
var source_light_map: texture_depth_2d;

fn source_is_background_depth(depth: f32) -> bool {
    return depth == select(1.0, 0.0, source_map_view.depth_sign > 0.0);
}

fn source_sample_t(texel: vec2u, sample: u32) -> f32 {
    let depth = textureLoad(source_light_map, texel, 0);
    if source_is_background_depth(depth) {
        return 1.0;
    }
    let uv = (vec2f(texel) + 0.5) / source_map_view.map_size;
    return source_t_at(source_map_view, source_settings, uv, space_z_of_depth(source_map_view, depth));
}
