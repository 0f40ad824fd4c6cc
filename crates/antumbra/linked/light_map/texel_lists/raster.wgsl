// Linked from src/light_map/texel_lists/raster.wesl by `cargo xtask shaders`: edit that, not this.

struct ListView {
    clip_from_world: mat4x4f,
    origin_in_world: vec3f,
    capacity: u32,
    axis_in_world: vec3f,
    colored: u32,
    map_size: vec2u,
    open_slope: f32,
    open_m: f32,
    near_m: f32,
    far_m: f32,
    padding_0: u32,
    padding_1: u32,
    anchor_in_world: vec3f,
    padding_2: u32
}

struct ListSurface {
    factor: vec4f,
    size_texels: vec2f,
    cutoff: f32,
    coverage: u32,
    mip_count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(0) @binding(0)
var<uniform> list_view: ListView;

@group(0) @binding(1)
var<storage, read_write> cursors: array<atomic<u32>>;

@group(0) @binding(2)
var<storage, read_write> fragments: array<vec2u>;

@group(0) @binding(3)
var<storage, read_write> counters: fragments_ListCounters;

@group(0) @binding(4)
var<storage, read_write> links: array<u32>;

@group(1) @binding(0)
var<storage, read> caster_positions: array<f32>;

@group(1) @binding(1)
var<storage, read> caster_indices: array<u32>;

@group(2) @binding(0)
var<uniform> surface: ListSurface;

@group(2) @binding(1)
var surface_sampler: sampler;

@group(2) @binding(2)
var surface_texture: texture_2d<f32>;

@group(2) @binding(3)
var surface_mip_1: texture_2d<f32>;

@group(2) @binding(4)
var surface_mip_2: texture_2d<f32>;

@group(2) @binding(5)
var surface_mip_3: texture_2d<f32>;

@group(2) @binding(6)
var surface_mip_4: texture_2d<f32>;

@group(2) @binding(7)
var surface_mip_5: texture_2d<f32>;

@group(2) @binding(8)
var surface_mip_6: texture_2d<f32>;

struct CoveredVaryings {
    @builtin(position) @invariant
    pos_in_clip: vec4f,
    @location(0)
    z_m: f32,
    @location(1) @interpolate(flat)
    a: vec2f,
    @location(2) @interpolate(flat)
    b: vec2f,
    @location(3) @interpolate(flat)
    c: vec2f,
    @location(4) @interpolate(flat)
    z_range_m: vec2f
}

struct Varyings {
    @builtin(position) @invariant
    pos_in_clip: vec4f,
    @location(0)
    z_m: f32,
    @location(1)
    uv: vec2f
}

fn depth_of(pos_in_world: vec4f) -> f32 {
    return dot(pos_in_world.xyz - list_view.origin_in_world, list_view.axis_in_world);
}

fn open_depth_of(pos_in_world: vec4f) -> f32 {
    let z_m = depth_of(pos_in_world);
    return z_m + list_view.open_slope * z_m + list_view.open_m;
}

@vertex
fn vertex_closed(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    let pos_in_world = anchored_anchored(world_from_object, list_view.anchor_in_world) * vec4f(pos_in_object, 1.0);
    return Varyings(list_view.clip_from_world * pos_in_world, depth_of(pos_in_world), vec2f());
}

@vertex
fn vertex_open(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    let pos_in_world = anchored_anchored(world_from_object, list_view.anchor_in_world) * vec4f(pos_in_object, 1.0);
    return Varyings(list_view.clip_from_world * pos_in_world, open_depth_of(pos_in_world), vec2f());
}

@vertex
fn vertex_surface(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f, @location(5) uv: vec2f) -> Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    let pos_in_world = anchored_anchored(world_from_object, list_view.anchor_in_world) * vec4f(pos_in_object, 1.0);
    return Varyings(list_view.clip_from_world * pos_in_world, open_depth_of(pos_in_world), uv);
}

fn corner_in_object(index: u32) -> vec4f {
    let first = 3u * caster_indices[index];
    return vec4f(caster_positions[first], caster_positions[first + 1u], caster_positions[first + 2u], 1.0);
}

fn snapped_in_map(pos_in_clip: vec4f) -> vec2f {
    let in_map = (vec2f(0.5, -0.5) * pos_in_clip.xy / pos_in_clip.w + 0.5) * vec2f(list_view.map_size);
    return round(256.0 * in_map) / 256.0;
}

fn covered(vertex: u32, world_from_object: mat4x4f, is_closed: bool) -> CoveredVaryings {
    let triangle = vertex - vertex % 3u;
    var in_clip: array<vec4f, 3>;
    var z_m: vec3f;
    for (var i = 0u; i < 3u; i++) {
        let pos_in_world = anchored_anchored(world_from_object, list_view.anchor_in_world) * corner_in_object(triangle + i);
        in_clip[i] = list_view.clip_from_world * pos_in_world;
        z_m[i] = select(open_depth_of(pos_in_world), depth_of(pos_in_world), is_closed);
    }
    let own = vertex - triangle;
    var out = CoveredVaryings(in_clip[own], z_m[own], vec2f(), vec2f(), vec2f(), vec2f());
    out.z_range_m = max(vec2f(min(z_m.x, min(z_m.y, z_m.z)), max(z_m.x, max(z_m.y, z_m.z))), vec2f(list_view.near_m));
    if min(in_clip[0].w, min(in_clip[1].w, in_clip[2].w)) > 1e-6 {
        out.a = snapped_in_map(in_clip[0]);
        out.b = snapped_in_map(in_clip[1]);
        out.c = snapped_in_map(in_clip[2]);
    }
    return out;
}

@vertex
fn vertex_covered_closed(@builtin(vertex_index) vertex: u32, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> CoveredVaryings {
    return covered(vertex, mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w), true);
}

@vertex
fn vertex_covered_open(@builtin(vertex_index) vertex: u32, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> CoveredVaryings {
    return covered(vertex, mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w), false);
}

fn cross_2d(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

fn is_inside_edge(a: vec2f, b: vec2f, p: vec2f) -> bool {
    let side = cross_2d(b - a, p - a);
    return side > 0.0 || (side == 0.0 && ((a.y == b.y && b.x > a.x) || b.y < a.y));
}

fn samples_covered(in: CoveredVaryings) -> u32 {
    let center = floor(in.pos_in_clip.xy) + 0.5;
    let a = in.a - center;
    var b = in.b - center;
    var c = in.c - center;
    let area = cross_2d(b - a, c - a);
    if area == 0.0 {
        return fragments_ALL_SAMPLES;
    }
    if area < 0.0 {
        let swapped = b;
        b = c;
        c = swapped;
    }
    var samples = 0u;
    for (var i = 0u; i < 4u; i++) {
        let p = vec2f(vec4f(-0.125, 0.375, -0.375, 0.125)[i], vec4f(-0.375, -0.125, 0.125, 0.375)[i]);
        if is_inside_edge(a, b, p) && is_inside_edge(b, c, p) && is_inside_edge(c, a, p) {
            samples |= 1u << i;
        }
    }
    return samples;
}

fn covered_fragment(in: CoveredVaryings, samples: u32) -> fragments_GatheredFragment {
    return fragments_GatheredFragment(clamp(in.z_m, in.z_range_m.x, in.z_range_m.y), vec3f(1.0), samples);
}

fn value_at_mip(uv: vec2f, mip: u32) -> vec4f {
    switch mip {
        case 0u {
            return textureSampleLevel(surface_texture, surface_sampler, uv, 0.0);
        }
        case 1u {
            return textureSampleLevel(surface_mip_1, surface_sampler, uv, 0.0);
        }
        case 2u {
            return textureSampleLevel(surface_mip_2, surface_sampler, uv, 0.0);
        }
        case 3u {
            return textureSampleLevel(surface_mip_3, surface_sampler, uv, 0.0);
        }
        case 4u {
            return textureSampleLevel(surface_mip_4, surface_sampler, uv, 0.0);
        }
        case 5u {
            return textureSampleLevel(surface_mip_5, surface_sampler, uv, 0.0);
        }
        case default {
            return textureSampleLevel(surface_mip_6, surface_sampler, uv, 0.0);
        }
    }
}

fn mip_count() -> u32 {
    let begins_at_first = all(textureDimensions(surface_texture) == vec2u(surface.size_texels));
    return select(1u, min(surface.mip_count, textureNumLevels(surface_texture)), begins_at_first);
}

fn value_of_footprint(uv: vec2f, footprint_texels: f32) -> vec4f {
    let last = mip_count() - 1u;
    let level = clamp(log2(max(footprint_texels, 1e-6)), 0.0, f32(last));
    let finer = u32(level);
    let coarser = min(finer + 1u, last);
    return mix(value_at_mip(uv, finer), value_at_mip(uv, coarser), fract(level));
}

fn surface_opacity(uv: vec2f) -> vec3f {
    let across = dpdx(uv);
    let along = dpdy(uv);
    let size_texels = vec2f(textureDimensions(surface_texture));
    let footprint = max(length(across * size_texels), length(along * size_texels));
    if surface.coverage != caster_surface_COVERAGE_CUTOFF {
        var stopped = vec3f();
        for (var i = 0u; i < 4u; i++) {
            let a = vec4f(-0.125, 0.375, -0.375, 0.125)[i];
            let b = vec4f(-0.375, -0.125, 0.125, 0.375)[i];
            let value = surface.factor * value_of_footprint(uv + a * across + b * along, 0.5 * footprint);
            stopped += 0.25 * caster_surface_stopped_light(surface.coverage, surface.cutoff, value);
        }
        return stopped;
    }
    let value = surface.factor * value_of_footprint(uv, footprint);
    let alpha = value.a;
    let change = abs(dpdx(alpha)) + abs(dpdy(alpha));
    let edge = saturate((alpha - surface.cutoff) / max(change, 0.0001) + 0.5);
    let coverage = mix(edge, saturate(alpha), saturate(log2(max(footprint, 1e-6))));
    return coverage * (1.0 - saturate(value.rgb));
}

fn held_between_planes(z_m: f32) -> f32 {
    let far_m = list_view.far_m + list_view.open_slope * list_view.far_m + list_view.open_m;
    return select(list_view.near_m, min(z_m, far_m), z_m >= list_view.near_m);
}

fn texel_index(pos_in_map: vec4f) -> u32 {
    let texel = min(vec2u(pos_in_map.xy), list_view.map_size - 1u);
    return texel.y * list_view.map_size.x + texel.x;
}

fn count(pos_in_map: vec4f) {
    atomicAdd(&cursors[texel_index(pos_in_map)], 1u);
}

fn collect(pos_in_map: vec4f, fragment: fragments_GatheredFragment) {
    let texel = texel_index(pos_in_map);
    let place = atomicAdd(&cursors[texel], 1u);
    let is_last = texel + 1u == list_view.map_size.x * list_view.map_size.y;
    let end = select(links[texel + select(1u, 0u, is_last)], list_view.capacity, is_last);
    if place < min(end, list_view.capacity) {
        fragments[place] = fragments_pack_gathered(fragment, list_view.colored);
    }
}

fn link(pos_in_map: vec4f, fragment: fragments_GatheredFragment) {
    let node = atomicAdd(&counters.fragments, 1u);
    if node < list_view.capacity {
        fragments[node] = fragments_pack_gathered(fragment, list_view.colored);
        links[node] = atomicExchange(&cursors[texel_index(pos_in_map)], node + 1u);
    }
}

@fragment
fn count_opaque(in: Varyings) {
    count(in.pos_in_clip);
}

@fragment
fn count_surface(in: Varyings) {
    if any(surface_opacity(in.uv) > vec3f(0.0)) {
        count(in.pos_in_clip);
    }
}

@fragment
fn count_covered(in: CoveredVaryings) {
    if samples_covered(in) != 0u {
        count(in.pos_in_clip);
    }
}

@fragment
fn collect_opaque(in: Varyings) {
    collect(in.pos_in_clip, fragments_GatheredFragment(held_between_planes(in.z_m), vec3f(1.0), fragments_ALL_SAMPLES));
}

@fragment
fn collect_surface(in: Varyings) {
    let opacity = surface_opacity(in.uv);
    if any(opacity > vec3f(0.0)) {
        collect(in.pos_in_clip, fragments_GatheredFragment(held_between_planes(in.z_m), opacity, fragments_ALL_SAMPLES));
    }
}

@fragment
fn collect_covered(in: CoveredVaryings) {
    let samples = samples_covered(in);
    if samples != 0u {
        collect(in.pos_in_clip, covered_fragment(in, samples));
    }
}

@fragment
fn link_opaque(in: Varyings) {
    link(in.pos_in_clip, fragments_GatheredFragment(held_between_planes(in.z_m), vec3f(1.0), fragments_ALL_SAMPLES));
}

@fragment
fn link_surface(in: Varyings) {
    let opacity = surface_opacity(in.uv);
    if any(opacity > vec3f(0.0)) {
        link(in.pos_in_clip, fragments_GatheredFragment(held_between_planes(in.z_m), opacity, fragments_ALL_SAMPLES));
    }
}

@fragment
fn link_covered(in: CoveredVaryings) {
    let samples = samples_covered(in);
    if samples != 0u {
        link(in.pos_in_clip, covered_fragment(in, samples));
    }
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

const caster_surface_COVERAGE_WHOLE: u32 = 0u;

const caster_surface_COVERAGE_ALPHA: u32 = 1u;

const caster_surface_COVERAGE_CUTOFF: u32 = 2u;

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

struct fragments_GatheredFragment {
    z_m: f32,
    opacity: vec3f,
    samples: u32
}

const fragments_ALL_SAMPLES = 15u;

fn fragments_pack_gathered(fragment: fragments_GatheredFragment, colored: u32) -> vec2u {
    var bits = (bitcast<u32>(fragment.opacity.x) & ~fragments_ALL_SAMPLES) | fragment.samples;
    if colored == 1u {
        let m = vec3u(round(511.0 * saturate(fragment.opacity)));
        bits = m.r | (m.g << 9u) | (m.b << 18u) | (fragment.samples << 27u);
    }
    return vec2u(bitcast<u32>(fragment.z_m), bits);
}

struct fragments_ListCounters {
    fragments: atomic<u32>,
    end: atomic<u32>
}
