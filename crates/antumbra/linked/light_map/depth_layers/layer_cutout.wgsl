// Linked from src/light_map/depth_layers/layer_cutout.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f, @location(5) uv: vec2f) -> cutout_Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return cutout_cutout_varyings(pos_in_object, world_from_object, uv);
}

@fragment
fn nearest(varyings: cutout_Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec2f {
    let gradient = layer_gradient_of(varyings.pos_in_clip.z);
    if cutout_is_hole(varyings, is_front) {
        discard;
    }
    return gradient / layer_GRADIENT_UNIT;
}

@fragment
fn next(varyings: cutout_Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec2f {
    let gradient = layer_gradient_of(varyings.pos_in_clip.z);
    if layer_is_peeled(varyings.pos_in_clip) || cutout_is_hole(varyings, is_front) {
        discard;
    }
    return gradient / layer_GRADIENT_UNIT;
}

@fragment
fn next_depth(varyings: cutout_Varyings, @builtin(front_facing) is_front: bool) {
    if layer_is_peeled(varyings.pos_in_clip) || cutout_is_hole(varyings, is_front) {
        discard;
    }
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

@group(2) @binding(0)
var layer_nearer_layer: texture_depth_2d;

const layer_SAME_DEPTH = 1e-6;

fn layer_is_peeled(position: vec4f) -> bool {
    let nearer = textureLoad(layer_nearer_layer, vec2u(position.xy), 0);
    return position.z >= nearer * (1.0 - layer_SAME_DEPTH);
}

fn layer_gradient_of(depth: f32) -> vec2f {
    let gradient = vec2f(dpdx(depth), dpdy(depth));
    return select(vec2f(), gradient, depth < 1.0);
}

const layer_GRADIENT_UNIT = 1.0 / 1024.0;

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
