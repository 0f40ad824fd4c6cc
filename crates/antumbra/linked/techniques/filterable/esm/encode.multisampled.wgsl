// Linked from src/techniques/filterable/esm/encode.wesl with multisampled by `cargo xtask shaders`: edit that, not this.

struct EsmUniform {
    exponent: f32,
    padding_x: f32,
    padding_y: f32,
    padding_z: f32
}

@group(1) @binding(0)
var<uniform> esm: EsmUniform;

@compute @workgroup_size(8, 8)
fn encode(@builtin(global_invocation_id) id: vec3u) {
    if !package_techniques_filterable_source__2is_in_target(id.xy) {
        return;
    }
    var sum = 0.0;
    for (var i = 0u; i < package_techniques_filterable_source_settings.sample_count; i++) {
        sum += package_primitives__1depth_basis_exponential__1encode_exponential(package_techniques_filterable_source__1sample_t(id.xy, i), esm.exponent);
    }
    package_techniques_filterable_source__1store_1(id.xy, 0u, sum / f32(package_techniques_filterable_source_settings.sample_count));
}

struct package__1light_map_space_LightViewGpu {
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
    padding: f32,
    warp: vec2f,
    plane_center: vec2f
}

fn package__1light_map_space__1warped_plane(view: package__1light_map_space_LightViewGpu, uv: vec2f) -> vec2f {
    let from_origin = uv - view.uv_origin;
    return view.plane_from_uv.xy * from_origin.x + view.plane_from_uv.zw * from_origin.y;
}

fn package__1light_map_space__2z_of_depth(view: package__1light_map_space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}

fn package_primitives__1depth_basis_exponential__1encode_exponential(z: f32, c: f32) -> f32 {
    return exp(c * (z - 1.0));
}

const package_primitives_packing__1PACKING_FLOAT16 = 1u;

const package_primitives_packing__1PACKING_UNORM16 = 2u;

const package_primitives_packing__1PACKING_UNORM8 = 3u;

fn package_primitives_packing__1pack_word(channels: vec4f, packing: u32) -> u32 {
    switch packing {
        case package_primitives_packing__1PACKING_FLOAT16 {
            return pack2x16float(channels.xy);
        }
        case package_primitives_packing__1PACKING_UNORM16 {
            return pack2x16unorm(channels.xy);
        }
        case package_primitives_packing__1PACKING_UNORM8 {
            return pack4x8unorm(channels);
        }
        case default {
            return bitcast<u32>(channels.x);
        }
    }
}

struct package_techniques_filterable_source_FilterUniform {
    packing: u32,
    sample_count: u32,
    kernel_radius: u32,
    max_anisotropy: u32,
    bias_scale: f32,
    t_step: f32,
    near_m: f32,
    far_m: f32,
    depth_axis: vec3f,
    padding: f32
}

@id(7)
override package_techniques_filterable_source__1IS_DISTANCE: bool = false;

fn package_techniques_filterable_source__2along_axis_m(view: package__1light_map_space_LightViewGpu, range: package_techniques_filterable_source_FilterUniform, uv: vec2f, z_m: f32) -> f32 {
    let plane = package__1light_map_space__1warped_plane(view, uv);
    if package_techniques_filterable_source__1IS_DISTANCE {
        return z_m * length(vec3f(plane, 1.0));
    }
    if view.perspective == 1u {
        return z_m * dot(range.depth_axis, vec3f(plane, 1.0));
    }
    return dot(range.depth_axis, vec3f(plane, z_m));
}

fn package_techniques_filterable_source__1t_at(view: package__1light_map_space_LightViewGpu, range: package_techniques_filterable_source_FilterUniform, uv: vec2f, z_m: f32) -> f32 {
    return saturate((package_techniques_filterable_source__2along_axis_m(view, range, uv, z_m) - range.near_m) / (range.far_m - range.near_m));
}

@group(0) @binding(0)
var<uniform> package_techniques_filterable_source__1map_view: package__1light_map_space_LightViewGpu;

@group(0) @binding(1)
var<uniform> package_techniques_filterable_source_settings: package_techniques_filterable_source_FilterUniform;

@group(0) @binding(2)
var package_techniques_filterable_source__1light_map: texture_depth_multisampled_2d;

@group(0) @binding(3)
var package_techniques_filterable_source__1packed_target: texture_storage_2d_array<r32uint, write>;

fn package_techniques_filterable_source__2is_in_target(texel: vec2u) -> bool {
    return all(texel < textureDimensions(package_techniques_filterable_source__1packed_target));
}

fn package_techniques_filterable_source__2is_background_depth(depth: f32) -> bool {
    return depth == select(1.0, 0.0, package_techniques_filterable_source__1map_view.depth_sign > 0.0);
}

fn package_techniques_filterable_source__1sample_t(texel: vec2u, sample: u32) -> f32 {
    let depth = textureLoad(package_techniques_filterable_source__1light_map, texel, i32(sample));
    if package_techniques_filterable_source__2is_background_depth(depth) {
        return 1.0;
    }
    let uv = (vec2f(texel) + 0.5) / package_techniques_filterable_source__1map_view.map_size;
    return package_techniques_filterable_source__1t_at(package_techniques_filterable_source__1map_view, package_techniques_filterable_source_settings, uv, package__1light_map_space__2z_of_depth(package_techniques_filterable_source__1map_view, depth));
}

fn package_techniques_filterable_source__1store_1(texel: vec2u, channel: u32, value: f32) {
    textureStore(package_techniques_filterable_source__1packed_target, texel, channel, vec4u(package_primitives_packing__1pack_word(vec4f(value, 0.0, 0.0, 0.0), package_techniques_filterable_source_settings.packing)));
}
