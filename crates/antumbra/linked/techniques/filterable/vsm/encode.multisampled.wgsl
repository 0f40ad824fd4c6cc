// Linked from src/techniques/filterable/vsm/encode.wesl with multisampled by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(8, 8)
fn encode(@builtin(global_invocation_id) id: vec3u) {
    if !source_is_in_target(id.xy) {
        return;
    }
    var sum = vec2f();
    for (var i = 0u; i < source_settings.sample_count; i++) {
        sum += variance_encode_variance(source_sample_t(id.xy, i));
    }
    source_store_2(id.xy, 0u, sum / f32(source_settings.sample_count));
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

fn variance_encode_variance(t: f32) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(t, u * u);
}

const packing_PACKING_FLOAT32 = 0u;

const packing_PACKING_FLOAT16 = 1u;

const packing_PACKING_UNORM16 = 2u;

const packing_PACKING_UNORM8 = 3u;

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
var source_light_map: texture_depth_multisampled_2d;

@group(0) @binding(3)
var source_packed_target: texture_storage_2d_array<r32uint, write>;

fn source_is_in_target(texel: vec2u) -> bool {
    return all(texel < textureDimensions(source_packed_target));
}

fn source_is_background_depth(depth: f32) -> bool {
    return depth == select(1.0, 0.0, source_map_view.depth_sign > 0.0);
}

fn source_sample_t(texel: vec2u, sample: u32) -> f32 {
    let depth = textureLoad(source_light_map, texel, i32(sample));
    if source_is_background_depth(depth) {
        return 1.0;
    }
    let uv = (vec2f(texel) + 0.5) / source_map_view.map_size;
    return source_t_at(source_map_view, source_settings, uv, space_z_of_depth(source_map_view, depth));
}

fn source_store_1(texel: vec2u, channel: u32, value: f32) {
    textureStore(source_packed_target, texel, channel, vec4u(packing_pack_word(vec4f(value, 0.0, 0.0, 0.0), source_settings.packing)));
}

fn source_store_2(texel: vec2u, pair: u32, value: vec2f) {
    if source_settings.packing == packing_PACKING_FLOAT32 {
        source_store_1(texel, 2u * pair, value.x);
        source_store_1(texel, 2u * pair + 1u, value.y);
    }
    else {
        textureStore(source_packed_target, texel, pair, vec4u(packing_pack_word(vec4f(value, 0.0, 0.0), source_settings.packing)));
    }
}
