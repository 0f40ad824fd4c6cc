// Linked from src/techniques/filterable/lvsm/targets_opaque.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> @builtin(position) vec4f {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return package__1light_map__1caster_depth_opaque__2clip_from_object(pos_in_object, world_from_object);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> package_techniques_filterable_lvsm_targets_Words {
    return package_techniques_filterable_lvsm_targets__1words_of(position);
}

fn package_casters_anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

struct package__1light_map__1caster_depth_opaque_CasterView {
    clip_from_world: mat4x4f,
    anchor_in_world: vec3f,
    padding: u32
}

@group(0) @binding(0)
var<uniform> package__1light_map__1caster_depth_opaque__1caster_view: package__1light_map__1caster_depth_opaque_CasterView;

fn package__1light_map__1caster_depth_opaque__2clip_from_object(pos_in_object: vec3f, world_from_object: mat4x4f) -> vec4f {
    let near = package_casters_anchored_anchored(world_from_object, package__1light_map__1caster_depth_opaque__1caster_view.anchor_in_world);
    return package__1light_map__1caster_depth_opaque__1caster_view.clip_from_world * (near * vec4f(pos_in_object, 1.0));
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

struct package_primitives__1depth_basis_layered_DepthLayer {
    near: f32,
    far: f32
}

fn package_primitives__1depth_basis_layered__1layer_between(low: f32, high: f32, overlap: f32) -> package_primitives__1depth_basis_layered_DepthLayer {
    return package_primitives__1depth_basis_layered_DepthLayer(max(low - overlap, 0.0), min(high + overlap, 1.0));
}

fn package_primitives__1depth_basis_layered__2warp_to_layer(layer: package_primitives__1depth_basis_layered_DepthLayer, t: f32) -> f32 {
    return saturate((t - layer.near) / (layer.far - layer.near));
}

fn package_primitives__1depth_basis_layered__1encode_layered(layer: package_primitives__1depth_basis_layered_DepthLayer, t: f32) -> vec2f {
    return package_primitives__1depth_basis_variance__1encode_variance(package_primitives__1depth_basis_layered__2warp_to_layer(layer, t));
}

fn package_primitives__1depth_basis_variance__1encode_variance(t: f32) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(t, u * u);
}

const package_primitives_packing__1PACKING_FLOAT32 = 0u;

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

struct package_techniques_filterable_lvsm_encode_LvsmUniform {
    layer_count: u32,
    overlap: f32,
    layer_step: f32,
    blends: u32,
    shows_layers: u32,
    padding_x: u32,
    padding_y: u32,
    padding_z: u32
}

struct package_techniques_filterable_lvsm_targets_LayerDraw {
    first_word: u32,
    padding_x: u32,
    padding_y: u32,
    padding_z: u32
}

@group(2) @binding(0)
var<uniform> package_techniques_filterable_lvsm_targets__1light_view: package__1light_map_space_LightViewGpu;

@group(2) @binding(1)
var<uniform> package_techniques_filterable_lvsm_targets_settings: package_techniques_filterable_source_FilterUniform;

@group(2) @binding(2)
var<uniform> package_techniques_filterable_lvsm_targets_lvsm: package_techniques_filterable_lvsm_encode_LvsmUniform;

@group(2) @binding(3)
var<storage, read> package_techniques_filterable_lvsm_targets_splits: array<f32>;

@group(2) @binding(4)
var<uniform> package_techniques_filterable_lvsm_targets_draw: package_techniques_filterable_lvsm_targets_LayerDraw;

struct package_techniques_filterable_lvsm_targets_Words {
    @location(0)
    word_0: u32,
    @location(1)
    word_1: u32,
    @location(2)
    word_2: u32,
    @location(3)
    word_3: u32,
    @location(4)
    word_4: u32,
    @location(5)
    word_5: u32,
    @location(6)
    word_6: u32,
    @location(7)
    word_7: u32
}

fn package_techniques_filterable_lvsm_targets__1word_of(t: f32, i: u32) -> u32 {
    let word = package_techniques_filterable_lvsm_targets_draw.first_word + i;
    let is_wide = package_techniques_filterable_lvsm_targets_settings.packing == package_primitives_packing__1PACKING_FLOAT32;
    let index = min(select(word, word / 2u, is_wide), package_techniques_filterable_lvsm_targets_lvsm.layer_count - 1u);
    let low = select(package_techniques_filterable_lvsm_targets_splits[max(index, 1u) - 1u], 0.0, index == 0u);
    let high = select(package_techniques_filterable_lvsm_targets_splits[min(index, 14u)], 1.0, index + 1u == package_techniques_filterable_lvsm_targets_lvsm.layer_count);
    let moments = package_primitives__1depth_basis_layered__1encode_layered(package_primitives__1depth_basis_layered__1layer_between(low, high, package_techniques_filterable_lvsm_targets_lvsm.overlap), t);
    let packed = select(moments, moments.yx, is_wide && word % 2u == 1u);
    return package_primitives_packing__1pack_word(vec4f(packed, 0.0, 0.0), package_techniques_filterable_lvsm_targets_settings.packing);
}

fn package_techniques_filterable_lvsm_targets__1words_of(position: vec4f) -> package_techniques_filterable_lvsm_targets_Words {
    let z_m = package__1light_map_space__2z_of_depth(package_techniques_filterable_lvsm_targets__1light_view, saturate(position.z));
    let t = package_techniques_filterable_source__1t_at(package_techniques_filterable_lvsm_targets__1light_view, package_techniques_filterable_lvsm_targets_settings, position.xy / package_techniques_filterable_lvsm_targets__1light_view.map_size, z_m);
    return package_techniques_filterable_lvsm_targets_Words(package_techniques_filterable_lvsm_targets__1word_of(t, 0u), package_techniques_filterable_lvsm_targets__1word_of(t, 1u), package_techniques_filterable_lvsm_targets__1word_of(t, 2u), package_techniques_filterable_lvsm_targets__1word_of(t, 3u), package_techniques_filterable_lvsm_targets__1word_of(t, 4u), package_techniques_filterable_lvsm_targets__1word_of(t, 5u), package_techniques_filterable_lvsm_targets__1word_of(t, 6u), package_techniques_filterable_lvsm_targets__1word_of(t, 7u));
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
