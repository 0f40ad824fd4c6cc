// Linked from src/techniques/light_views/reprojection/splat_surfels.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(3)
var<storage, read> names: array<u32>;

@group(1) @binding(4)
var<storage, read> counts: array<u32>;

fn scatter_into(surfel: surfels_Surfel, reach: f32, i: u32) {
    let map = group_views.first_map + i * group_views.map_step;
    splat_scatter_surfel(group_views.target_from_central[i], map, surfel.pos, surfel.depth, surfel.gradient, reach);
}

@compute @workgroup_size(surfels_SCATTER_WORKGROUP)
fn splat(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= counts[surfels_piece.first_count + 3u] {
        return;
    }
    let name = names[surfels_piece.first_name + id.x];
    let surfel = surfels_surfel_of(name);
    let reach = select(splat_batch.reach, splat_batch.reach + 0.5, (name & surfels_IS_FLAT) != 0u);
    if splat_TRIES_FACES && !splat_may_be_seen(group_views.metres_from_central, surfel.pos, surfel.depth) {
        return;
    }
    scatter_into(surfel, reach, 0u);
    scatter_into(surfel, reach, 1u);
    scatter_into(surfel, reach, 2u);
    scatter_into(surfel, reach, 3u);
    scatter_into(surfel, reach, 4u);
    scatter_into(surfel, reach, 5u);
    scatter_into(surfel, reach, 6u);
    scatter_into(surfel, reach, 7u);
}

const layer_GRADIENT_UNIT = 1.0 / 1024.0;

@group(1) @binding(0)
var central_central_depth: texture_depth_2d_array;

@group(1) @binding(1)
var central_central_gradient: texture_2d_array<f32>;

@group(2) @binding(1)
var<uniform> group_views: splat_ViewGroup;

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

struct surfels_SurfelPiece {
    slice: u32,
    first_row: u32,
    first_name: u32,
    first_count: u32,
    padding: array<vec4u, 15>
}

@group(1) @binding(2)
var<uniform> surfels_piece: surfels_SurfelPiece;

const surfels_SCATTER_WORKGROUP = 128u;

const surfels_NAME_BITS = 14u;

const surfels_IS_FLAT = 268435456u;

struct surfels_Surfel {
    pos: vec2f,
    depth: f32,
    gradient: vec2f
}

fn surfels_depth_at(texel: vec2u) -> f32 {
    let size = textureDimensions(central_central_depth);
    let depth = textureLoad(central_central_depth, min(texel, size - 1u), surfels_piece.slice, 0);
    let is_before_light = dot(splat_batch.light_front, vec4f(vec2f(texel) + 0.5, depth, 1.0)) > 0.0;
    return select(0.0, depth, all(texel < size) && is_before_light);
}

fn surfels_gradient_at(texel: vec2u, depth: f32) -> vec2f {
    let stored = min(texel, textureDimensions(central_central_depth) - 1u);
    return splat_held(textureLoad(central_central_gradient, stored, surfels_piece.slice, 0).xy * layer_GRADIENT_UNIT, depth);
}

fn surfels_depths_at(first: vec2u) -> vec4f {
    return vec4f(surfels_depth_at(first), surfels_depth_at(first + vec2u(1u, 0u)), surfels_depth_at(first + vec2u(0u, 1u)), surfels_depth_at(first + vec2u(1u, 1u)));
}

fn surfels_whole(first: vec2u, d: vec4f) -> surfels_Surfel {
    let middle = 0.25 * ((d.x + d.y) + (d.z + d.w));
    let rise = 0.5 * vec2f((d.y - d.x) + (d.w - d.z), (d.z - d.x) + (d.w - d.y));
    return surfels_Surfel(vec2f(first) + 1.0, middle, rise);
}

fn surfels_surfel_of(name: u32) -> surfels_Surfel {
    let mask = (1u << surfels_NAME_BITS) - 1u;
    let first = vec2u(name & mask, (name >> surfels_NAME_BITS) & mask);
    let d = surfels_depths_at(first);
    if (name & surfels_IS_FLAT) != 0u {
        return surfels_whole(first, d);
    }
    return surfels_Surfel(vec2f(first) + 0.5, d.x, surfels_gradient_at(first, d.x));
}
