// Linked from src/techniques/filterable/lvsm/targets_cutout.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f, @location(5) uv: vec2f) -> cutout_Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return cutout_cutout_varyings(pos_in_object, world_from_object, uv);
}

@fragment
fn fragment(varyings: cutout_Varyings, @builtin(front_facing) is_front: bool) -> targets_Words {
    if cutout_is_hole(varyings, is_front) {
        discard;
    }
    return targets_words_of(varyings.pos_in_clip);
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

struct cutout_Cutout {
    factor: vec4f,
    cutoff: f32,
    coverage: u32,
    padding_0: u32,
    padding_1: u32
}

@group(1) @binding(0)
var<uniform> cutout_cutout: cutout_Cutout;

@group(1) @binding(1)
var cutout_surface: texture_2d<f32>;

@group(1) @binding(2)
var cutout_surface_sampler: sampler;

const cutout_HALF_OF_THE_LIGHT = 0.5;

struct cutout_Varyings {
    @builtin(position)
    pos_in_clip: vec4f,
    @location(0)
    uv: vec2f,
    @location(1) @interpolate(flat)
    color_weights: vec3f,
    @location(2) @interpolate(flat)
    light_point: u32,
    @location(3) @interpolate(flat)
    seed: u32
}

fn cutout_cutout_varyings(pos_in_object: vec3f, world_from_object: mat4x4f, uv: vec2f) -> cutout_Varyings {
    return cutout_Varyings(opaque_clip_from_object(pos_in_object, world_from_object), uv, opaque_caster_view.color_weights, opaque_caster_view.light_point, thresholds_hash_of_position(thresholds_hash_of_position(0u, world_from_object[3].xyz), pos_in_object));
}

fn cutout_is_hole(varyings: cutout_Varyings, is_front: bool) -> bool {
    let value = cutout_cutout.factor * textureSampleLevel(cutout_surface, cutout_surface_sampler, varyings.uv, 0.0);
    let stopped = dot(caster_surface_stopped_light(cutout_cutout.coverage, cutout_cutout.cutoff, value), varyings.color_weights);
    var least = cutout_HALF_OF_THE_LIGHT;
    if varyings.light_point > 0u {
        least = thresholds_stochastic_threshold(varyings.light_point - 1u, varyings.seed ^ select(0u, 1u, is_front));
    }
    return stopped < least;
}

struct opaque_CasterView {
    clip_from_world: mat4x4f,
    anchor_in_world: vec3f,
    light_point: u32,
    color_weights: vec3f,
    padding: u32
}

@group(0) @binding(0)
var<uniform> opaque_caster_view: opaque_CasterView;

fn opaque_clip_from_object(pos_in_object: vec3f, world_from_object: mat4x4f) -> vec4f {
    let near = anchored_anchored(world_from_object, opaque_caster_view.anchor_in_world);
    return opaque_caster_view.clip_from_world * (near * vec4f(pos_in_object, 1.0));
}

const caster_surface_COVERAGE_WHOLE: u32 = 0u;

const caster_surface_COVERAGE_ALPHA: u32 = 1u;

fn caster_surface_coverage_of(coverage: u32, cutoff: f32, alpha: f32) -> f32 {
    switch coverage {
        case caster_surface_COVERAGE_WHOLE {
            return 1.0;
        }
        case caster_surface_COVERAGE_ALPHA {
            return saturate(alpha);
        }
        case default {
            return select(0.0, 1.0, alpha >= cutoff);
        }
    }
}

fn caster_surface_stopped_light(coverage: u32, cutoff: f32, value: vec4f) -> vec3f {
    return caster_surface_coverage_of(coverage, cutoff, value.a) * (1.0 - saturate(value.rgb));
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

struct layered_DepthLayer {
    near: f32,
    far: f32
}

fn layered_layer_between(low: f32, high: f32, overlap: f32) -> layered_DepthLayer {
    return layered_DepthLayer(max(low - overlap, 0.0), min(high + overlap, 1.0));
}

fn layered_warp_to_layer(layer: layered_DepthLayer, t: f32) -> f32 {
    return saturate((t - layer.near) / (layer.far - layer.near));
}

fn layered_encode_layered(layer: layered_DepthLayer, t: f32) -> vec2f {
    return variance_encode_variance(layered_warp_to_layer(layer, t));
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

fn thresholds_hash_combine(seed: u32, value: u32) -> u32 {
    return seed ^ (value + (seed << 6u) + (seed >> 2u));
}

fn thresholds_hash(value: u32) -> u32 {
    var x = value;
    x ^= x >> 16u;
    x *= 2146121005u;
    x ^= x >> 15u;
    x *= 2221713035u;
    return x ^ (x >> 16u);
}

fn thresholds_hash_of_position(seed: u32, position: vec3f) -> u32 {
    let bits = bitcast<vec3u>(position);
    return thresholds_hash(thresholds_hash_combine(thresholds_hash(thresholds_hash_combine(thresholds_hash(thresholds_hash_combine(seed, bits.x)), bits.y)), bits.z));
}

fn thresholds_laine_karras_permutation(value: u32, seed: u32) -> u32 {
    var x = value + seed;
    x ^= x * 1817228412u;
    x ^= x * 3090095698u;
    x ^= x * 3350193720u;
    return x ^ (x * 2367878886u);
}

fn thresholds_stochastic_threshold(point: u32, seed: u32) -> f32 {
    let shuffled = reverseBits(thresholds_laine_karras_permutation(reverseBits(point), thresholds_hash(seed)));
    let scrambled = reverseBits(thresholds_laine_karras_permutation(shuffled, thresholds_hash(seed ^ 2654435769u)));
    return (f32(scrambled >> 8u) + 0.5) / 16777216.0;
}

struct encode_LvsmUniform {
    layer_count: u32,
    overlap: f32,
    layer_step: f32,
    blends: u32,
    shows_layers: u32,
    least_variance: f32,
    padding_y: u32,
    padding_z: u32
}

struct targets_LayerDraw {
    first_word: u32,
    padding_x: u32,
    padding_y: u32,
    padding_z: u32
}

@group(2) @binding(0)
var<uniform> targets_light_view: space_LightViewGpu;

@group(2) @binding(1)
var<uniform> targets_settings: source_FilterUniform;

@group(2) @binding(2)
var<uniform> targets_lvsm: encode_LvsmUniform;

@group(2) @binding(3)
var<storage, read> targets_splits: array<f32>;

@group(2) @binding(4)
var<uniform> targets_draw: targets_LayerDraw;

struct targets_Words {
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

fn targets_word_of(t: f32, i: u32) -> u32 {
    let word = targets_draw.first_word + i;
    let is_wide = targets_settings.packing == packing_PACKING_FLOAT32;
    let index = min(select(word, word / 2u, is_wide), targets_lvsm.layer_count - 1u);
    let low = select(targets_splits[max(index, 1u) - 1u], 0.0, index == 0u);
    let high = select(targets_splits[min(index, 14u)], 1.0, index + 1u == targets_lvsm.layer_count);
    let moments = layered_encode_layered(layered_layer_between(low, high, targets_lvsm.overlap), t);
    let packed = select(moments, moments.yx, is_wide && word % 2u == 1u);
    return packing_pack_word(vec4f(packed, 0.0, 0.0), targets_settings.packing);
}

fn targets_words_of(position: vec4f) -> targets_Words {
    let z_m = space_z_of_depth(targets_light_view, saturate(position.z));
    let t = source_t_at(targets_light_view, targets_settings, position.xy / targets_light_view.map_size, z_m);
    return targets_Words(targets_word_of(t, 0u), targets_word_of(t, 1u), targets_word_of(t, 2u), targets_word_of(t, 3u), targets_word_of(t, 4u), targets_word_of(t, 5u), targets_word_of(t, 6u), targets_word_of(t, 7u));
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
