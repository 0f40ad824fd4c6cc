// Linked from src/techniques/light_views/reprojection/splat_cutout.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f, @location(5) uv: vec2f) -> cutout_Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return cutout_cutout_varyings(pos_in_object, world_from_object, uv);
}

@fragment
fn splat(varyings: cutout_Varyings, @builtin(front_facing) is_front: bool) {
    let position = varyings.pos_in_clip;
    let gradient = layer_gradient_of(position.z);
    if cutout_is_hole(varyings, is_front) {
        discard;
    }
    rasterised_scatter(position.xy, clamp(position.z, 0.0, 1.0), gradient);
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

fn layer_gradient_of(depth: f32) -> vec2f {
    let gradient = vec2f(dpdx(depth), dpdy(depth));
    return select(vec2f(), gradient, depth < 1.0);
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

override rasterised_IS_SURFEL: bool = false;

@group(2) @binding(1)
var<storage, read> rasterised_view_groups: array<splat_ViewGroup>;

fn rasterised_scatter(pos: vec2f, depth: f32, gradient: vec2f) {
    for (var k = 0u; k < splat_batch.group_count; k++) {
        let group = splat_batch.first_group + k;
        if splat_TRIES_FACES && !splat_may_be_seen(rasterised_view_groups[group].metres_from_central, pos, depth) {
            continue;
        }
        for (var i = 0u; i < splat_GROUP_SIZE; i++) {
            let m = rasterised_view_groups[group].target_from_central[i];
            let map = rasterised_view_groups[group].first_map + i * rasterised_view_groups[group].map_step;
            if rasterised_IS_SURFEL {
                splat_scatter_surfel(m, map, pos, depth, splat_held(gradient, depth), splat_batch.reach);
            }
            else {
                splat_scatter_point(m, map, pos, depth);
            }
        }
    }
}

struct splat_SplatBatch {
    view_size: u32,
    row_texels: u32,
    first_group: u32,
    group_count: u32,
    first_slice: u32,
    has_receivers: u32,
    reach: f32,
    steepest: f32,
    width_of_depth: f32,
    width: f32,
    face_half_size: f32,
    face_slack_m: f32,
    light_reach: vec4f,
    light_axis: vec4f,
    light_front: vec4f,
    receivers: array<vec4f, 8>
}

const splat_GROUP_SIZE = 8u;

struct splat_ViewGroup {
    target_from_central: array<mat4x4f, 8>,
    metres_from_central: mat4x4f,
    first_map: u32,
    map_step: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: array<vec4u, 11>
}

override splat_SYNCHRONIZED: bool = true;

override splat_IS_AFFINE: bool = false;

override splat_TRIES_FACES: bool = false;

override splat_HAS_REACH: bool = false;

const splat_MAX_TEXELS = 16.0;

const splat_MAX_COVERED = 1089u;

@group(2) @binding(0)
var<uniform> splat_batch: splat_SplatBatch;

@group(2) @binding(2)
var<storage, read_write> splat_targets: array<atomic<u32>>;

fn splat_first_texel(map: u32) -> u32 {
    return map * splat_batch.view_size * splat_batch.row_texels;
}

fn splat_keep(index: u32, depth_bits: u32) {
    if splat_SYNCHRONIZED {
        atomicMax(&splat_targets[index], depth_bits);
    }
    else {
        atomicStore(&splat_targets[index], depth_bits);
    }
}

fn splat_project(m: mat4x4f, pos: vec2f, depth: f32) -> vec4f {
    return m[0] * pos.x + (m[1] * pos.y + (m[2] * depth + m[3]));
}

fn splat_may_be_seen(metres_from_central: mat4x4f, pos: vec2f, depth: f32) -> bool {
    let h = splat_project(metres_from_central, pos, depth);
    return max(abs(h.x), abs(h.y)) <= splat_batch.face_half_size * h.z + splat_batch.face_slack_m * h.w;
}

fn splat_scatter_point(m: mat4x4f, map: u32, pos: vec2f, depth: f32) {
    let size = f32(splat_batch.view_size);
    let h = splat_project(m, pos, depth);
    var p = h.xyz;
    if !splat_IS_AFFINE {
        p = h.xyz / h.w;
    }
    if h.w <= 0.0 || any(p.xy < vec2f(0.0)) || any(p.xy >= vec2f(size)) || p.z <= 0.0 {
        return;
    }
    let texel = floor(p.xy);
    if splat_HAS_REACH {
        let off_centre = abs(p.xy - texel - 0.5);
        if max(off_centre.x, off_centre.y) > splat_batch.reach {
            return;
        }
    }
    let stored = vec2u(texel);
    splat_keep(splat_first_texel(map) + stored.y * splat_batch.row_texels + stored.x, bitcast<u32>(min(p.z, 1.0)));
}

fn splat_scatter_surfel(m: mat4x4f, map: u32, pos: vec2f, depth: f32, gradient: vec2f, reach: f32) {
    let h = splat_project(m, pos, depth);
    if !splat_IS_AFFINE && h.w <= 0.0 {
        return;
    }
    let a = m[0] + m[2] * gradient.x;
    let b = m[1] + m[2] * gradient.y;
    var p = h.xy;
    var extent = (abs(a.xy) + abs(b.xy)) * reach;
    if !splat_IS_AFFINE {
        p = h.xy / h.w;
        extent = (abs(a.xy - p * a.w) + abs(b.xy - p * b.w)) * (reach / h.w);
    }
    let half_extent = min(extent, vec2f(splat_MAX_TEXELS));
    let low = max(ceil(p - half_extent - 0.5), vec2f(0.0));
    let high = min(floor(p + half_extent - 0.5), vec2f(f32(splat_batch.view_size) - 1.0));
    if any(low > high) {
        return;
    }
    let first = splat_first_texel(map);
    let row_texels = splat_batch.row_texels;
    var texel = low;
    for (var i = 0u; i < splat_MAX_COVERED; i++) {
        let c = texel + 0.5;
        var ac = a.xy;
        var bc = b.xy;
        var hc = c - h.xy;
        if !splat_IS_AFFINE {
            ac = a.xy - c * a.w;
            bc = b.xy - c * b.w;
            hc = c * h.w - h.xy;
        }
        let e = vec2f(hc.x * bc.y - hc.y * bc.x, ac.x * hc.y - ac.y * hc.x) / (ac.x * bc.y - ac.y * bc.x);
        var w = 1.0;
        var z = h.z + (a.z * e.x + b.z * e.y);
        if !splat_IS_AFFINE {
            w = h.w + (a.w * e.x + b.w * e.y);
            z /= w;
        }
        if abs(e.x) <= reach && abs(e.y) <= reach && w > 0.0 && z > 0.0 {
            let stored = vec2u(texel);
            splat_keep(first + stored.y * row_texels + stored.x, bitcast<u32>(min(z, 1.0)));
        }
        let is_row_done = texel.x >= high.x;
        if is_row_done && texel.y >= high.y {
            break;
        }
        texel = select(vec2f(texel.x + 1.0, texel.y), vec2f(low.x, texel.y + 1.0), is_row_done);
    }
}

fn splat_held(gradient: vec2f, depth: f32) -> vec2f {
    let steepest = splat_batch.steepest * (splat_batch.width_of_depth * depth + splat_batch.width);
    return clamp(gradient, vec2f(-steepest), vec2f(steepest));
}
