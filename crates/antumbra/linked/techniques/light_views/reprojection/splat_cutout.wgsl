// Linked from src/techniques/light_views/reprojection/splat_cutout.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f, @location(5) uv: vec2f) -> package__1light_map__1caster_depth_cutout_Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return package__1light_map__1caster_depth_cutout_Varyings(package__1light_map__1caster_depth_opaque__2clip_from_object(pos_in_object, world_from_object), uv);
}

@fragment
fn splat(varyings: package__1light_map__1caster_depth_cutout_Varyings) {
    let position = varyings.pos_in_clip;
    let gradient = package__1light_map__1depth_layers_layer__1gradient_of(position.z);
    if package__1light_map__1caster_depth_cutout__1is_hole(varyings.uv) {
        discard;
    }
    package_techniques__1light_views_reprojection_rasterised_scatter(position.xy, clamp(position.z, 0.0, 1.0), gradient);
}

fn package_casters_anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

struct package__1light_map__1caster_depth_cutout_Cutout {
    factor: vec4f,
    cutoff: f32,
    stops_light: u32,
    texture_tints_only: u32,
    padding: u32
}

@group(1) @binding(0)
var<uniform> package__1light_map__1caster_depth_cutout_cutout: package__1light_map__1caster_depth_cutout_Cutout;

@group(1) @binding(1)
var package__1light_map__1caster_depth_cutout_surface: texture_2d<f32>;

@group(1) @binding(2)
var package__1light_map__1caster_depth_cutout__1surface_sampler: sampler;

struct package__1light_map__1caster_depth_cutout_Varyings {
    @builtin(position)
    pos_in_clip: vec4f,
    @location(0)
    uv: vec2f
}

fn package__1light_map__1caster_depth_cutout__1light_stopped(tinted: vec4f) -> f32 {
    let transmittance = 1.0 - tinted.a * (1.0 - tinted.rgb);
    return 1.0 - dot(transmittance, vec3f(0.2126, 0.7152, 0.0722));
}

fn package__1light_map__1caster_depth_cutout__1is_hole(uv: vec2f) -> bool {
    var texel = textureSampleLevel(package__1light_map__1caster_depth_cutout_surface, package__1light_map__1caster_depth_cutout__1surface_sampler, uv, 0.0);
    if package__1light_map__1caster_depth_cutout_cutout.texture_tints_only == 1u {
        texel.a = 1.0;
    }
    let value = texel * package__1light_map__1caster_depth_cutout_cutout.factor;
    let coverage = select(value.a, package__1light_map__1caster_depth_cutout__1light_stopped(value), package__1light_map__1caster_depth_cutout_cutout.stops_light == 1u);
    return coverage < package__1light_map__1caster_depth_cutout_cutout.cutoff;
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

fn package__1light_map__1depth_layers_layer__1gradient_of(depth: f32) -> vec2f {
    let gradient = vec2f(dpdx(depth), dpdy(depth));
    return select(vec2f(), gradient, depth < 1.0);
}

@id(4)
override package_techniques__1light_views_reprojection_rasterised__1IS_SURFEL: bool = false;

@group(2) @binding(1)
var<storage, read> package_techniques__1light_views_reprojection_rasterised__1view_groups: array<package_techniques__1light_views_reprojection_splat_ViewGroup>;

fn package_techniques__1light_views_reprojection_rasterised_scatter(pos: vec2f, depth: f32, gradient: vec2f) {
    for (var k = 0u; k < package_techniques__1light_views_reprojection_splat_batch.group_count; k++) {
        let group = package_techniques__1light_views_reprojection_splat_batch.first_group + k;
        if package_techniques__1light_views_reprojection_splat__1TRIES_FACES && !package_techniques__1light_views_reprojection_splat__2may_be_seen(package_techniques__1light_views_reprojection_rasterised__1view_groups[group].metres_from_central, pos, depth) {
            continue;
        }
        for (var i = 0u; i < package_techniques__1light_views_reprojection_splat__1GROUP_SIZE; i++) {
            let m = package_techniques__1light_views_reprojection_rasterised__1view_groups[group].target_from_central[i];
            let map = package_techniques__1light_views_reprojection_rasterised__1view_groups[group].first_map + i * package_techniques__1light_views_reprojection_rasterised__1view_groups[group].map_step;
            if package_techniques__1light_views_reprojection_rasterised__1IS_SURFEL {
                package_techniques__1light_views_reprojection_splat__1scatter_surfel(m, map, pos, depth, package_techniques__1light_views_reprojection_splat_held(gradient, depth), package_techniques__1light_views_reprojection_splat_batch.reach);
            }
            else {
                package_techniques__1light_views_reprojection_splat__1scatter_point(m, map, pos, depth);
            }
        }
    }
}

struct package_techniques__1light_views_reprojection_splat_SplatBatch {
    view_size: u32,
    row_texels: u32,
    first_group: u32,
    group_count: u32,
    first_slice: u32,
    padding: u32,
    reach: f32,
    steepest: f32,
    width_of_depth: f32,
    width: f32,
    face_half_size: f32,
    face_slack_m: f32
}

const package_techniques__1light_views_reprojection_splat__1GROUP_SIZE = 8u;

struct package_techniques__1light_views_reprojection_splat_ViewGroup {
    target_from_central: array<mat4x4f, 8>,
    metres_from_central: mat4x4f,
    first_map: u32,
    map_step: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: array<vec4u, 11>
}

@id(0)
override package_techniques__1light_views_reprojection_splat_SYNCHRONIZED: bool = true;

@id(1)
override package_techniques__1light_views_reprojection_splat__1IS_AFFINE: bool = false;

@id(2)
override package_techniques__1light_views_reprojection_splat__1TRIES_FACES: bool = false;

@id(3)
override package_techniques__1light_views_reprojection_splat__1HAS_REACH: bool = false;

const package_techniques__1light_views_reprojection_splat__1MOST_TEXELS = 4.0;

const package_techniques__1light_views_reprojection_splat__1MOST_COVERED = 81u;

@group(2) @binding(0)
var<uniform> package_techniques__1light_views_reprojection_splat_batch: package_techniques__1light_views_reprojection_splat_SplatBatch;

@group(2) @binding(2)
var<storage, read_write> package_techniques__1light_views_reprojection_splat_targets: array<atomic<u32>>;

fn package_techniques__1light_views_reprojection_splat__1index_of(map: u32, texel: vec2u) -> u32 {
    return (map * package_techniques__1light_views_reprojection_splat_batch.view_size + texel.y) * package_techniques__1light_views_reprojection_splat_batch.row_texels + texel.x;
}

fn package_techniques__1light_views_reprojection_splat_keep(index: u32, depth_bits: u32) {
    if package_techniques__1light_views_reprojection_splat_SYNCHRONIZED {
        atomicMax(&package_techniques__1light_views_reprojection_splat_targets[index], depth_bits);
    }
    else {
        atomicStore(&package_techniques__1light_views_reprojection_splat_targets[index], depth_bits);
    }
}

fn package_techniques__1light_views_reprojection_splat_project(m: mat4x4f, pos: vec2f, depth: f32) -> vec4f {
    return m[0] * pos.x + (m[1] * pos.y + (m[2] * depth + m[3]));
}

fn package_techniques__1light_views_reprojection_splat__2may_be_seen(metres_from_central: mat4x4f, pos: vec2f, depth: f32) -> bool {
    let h = package_techniques__1light_views_reprojection_splat_project(metres_from_central, pos, depth);
    return max(abs(h.x), abs(h.y)) <= package_techniques__1light_views_reprojection_splat_batch.face_half_size * h.z + package_techniques__1light_views_reprojection_splat_batch.face_slack_m * h.w;
}

fn package_techniques__1light_views_reprojection_splat__1scatter_point(m: mat4x4f, map: u32, pos: vec2f, depth: f32) {
    let size = f32(package_techniques__1light_views_reprojection_splat_batch.view_size);
    let h = package_techniques__1light_views_reprojection_splat_project(m, pos, depth);
    var p = h.xyz;
    if !package_techniques__1light_views_reprojection_splat__1IS_AFFINE {
        p = h.xyz / h.w;
    }
    if h.w <= 0.0 || any(p.xy < vec2f(0.0)) || any(p.xy >= vec2f(size)) || !(p.z > 0.0) {
        return;
    }
    let texel = floor(p.xy);
    if package_techniques__1light_views_reprojection_splat__1HAS_REACH {
        let off_centre = abs(p.xy - texel - 0.5);
        if max(off_centre.x, off_centre.y) > package_techniques__1light_views_reprojection_splat_batch.reach {
            return;
        }
    }
    package_techniques__1light_views_reprojection_splat_keep(package_techniques__1light_views_reprojection_splat__1index_of(map, vec2u(texel)), bitcast<u32>(min(p.z, 1.0)));
}

fn package_techniques__1light_views_reprojection_splat__1scatter_surfel(m: mat4x4f, map: u32, pos: vec2f, depth: f32, gradient: vec2f, reach: f32) {
    let h = package_techniques__1light_views_reprojection_splat_project(m, pos, depth);
    if !package_techniques__1light_views_reprojection_splat__1IS_AFFINE && h.w <= 0.0 {
        return;
    }
    let a = m[0] + m[2] * gradient.x;
    let b = m[1] + m[2] * gradient.y;
    var p = h.xy;
    var extent = (abs(a.xy) + abs(b.xy)) * reach;
    if !package_techniques__1light_views_reprojection_splat__1IS_AFFINE {
        p = h.xy / h.w;
        extent = (abs(a.xy - p * a.w) + abs(b.xy - p * b.w)) * (reach / h.w);
    }
    let half_extent = min(extent, vec2f(package_techniques__1light_views_reprojection_splat__1MOST_TEXELS));
    let low = max(ceil(p - half_extent - 0.5), vec2f(0.0));
    let high = min(floor(p + half_extent - 0.5), vec2f(f32(package_techniques__1light_views_reprojection_splat_batch.view_size) - 1.0));
    if any(low > high) {
        return;
    }
    var texel = low;
    for (var i = 0u; i < package_techniques__1light_views_reprojection_splat__1MOST_COVERED; i++) {
        let c = texel + 0.5;
        var ac = a.xy;
        var bc = b.xy;
        var hc = c - h.xy;
        if !package_techniques__1light_views_reprojection_splat__1IS_AFFINE {
            ac = a.xy - c * a.w;
            bc = b.xy - c * b.w;
            hc = c * h.w - h.xy;
        }
        let e = vec2f(hc.x * bc.y - hc.y * bc.x, ac.x * hc.y - ac.y * hc.x) / (ac.x * bc.y - ac.y * bc.x);
        var w = 1.0;
        var z = h.z + (a.z * e.x + b.z * e.y);
        if !package_techniques__1light_views_reprojection_splat__1IS_AFFINE {
            w = h.w + (a.w * e.x + b.w * e.y);
            z /= w;
        }
        if abs(e.x) <= reach && abs(e.y) <= reach && w > 0.0 && z > 0.0 {
            package_techniques__1light_views_reprojection_splat_keep(package_techniques__1light_views_reprojection_splat__1index_of(map, vec2u(texel)), bitcast<u32>(min(z, 1.0)));
        }
        let is_row_done = texel.x >= high.x;
        if is_row_done && texel.y >= high.y {
            break;
        }
        texel = select(vec2f(texel.x + 1.0, texel.y), vec2f(low.x, texel.y + 1.0), is_row_done);
    }
}

fn package_techniques__1light_views_reprojection_splat_held(gradient: vec2f, depth: f32) -> vec2f {
    let steepest = package_techniques__1light_views_reprojection_splat_batch.steepest * (package_techniques__1light_views_reprojection_splat_batch.width_of_depth * depth + package_techniques__1light_views_reprojection_splat_batch.width);
    return clamp(gradient, vec2f(-steepest), vec2f(steepest));
}
