// Linked from src/techniques/light_views/reprojection/collect_surfels.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(3)
var<storage, read_write> names: array<u32>;

@group(1) @binding(4)
var<storage, read_write> counts: array<atomic<u32>>;

var<workgroup> group_count: atomic<u32>;

var<workgroup> group_first: u32;

fn begin_group() {
    let count = atomicLoad(&group_count);
    if count == 0u {
        return;
    }
    let first = atomicAdd(&counts[surfels_piece.first_count + 3u], count);
    group_first = first;
    atomicMax(&counts[surfels_piece.first_count], (first + count + surfels_SCATTER_WORKGROUP - 1u) / surfels_SCATTER_WORKGROUP);
    atomicMax(&counts[surfels_piece.first_count + 1u], 1u);
    atomicMax(&counts[surfels_piece.first_count + 2u], 1u);
}

@compute @workgroup_size(8, 8)
fn collect(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) thread: u32) {
    let first = 2u * id.xy + vec2u(0u, surfels_piece.first_row);
    let depths = surfels_depths_at(first);
    let is_there = depths > vec4f(0.0);
    let is_flat = surfels_are_flat(first, depths);
    let fragments = select(vec4u(0u), vec4u(1u), is_there);
    var count = select(fragments.x + fragments.y + fragments.z + fragments.w, 1u, is_flat);
    if is_flat && surfels_hides_nothing(surfels_whole(first, depths)) {
        count = 0u;
    }
    var place = 0u;
    if count > 0u {
        place = atomicAdd(&group_count, count);
    }
    workgroupBarrier();
    if thread == 0u {
        begin_group();
    }
    workgroupBarrier();
    if count == 0u {
        return;
    }
    place += surfels_piece.first_name + group_first;
    if is_flat {
        names[place] = surfels_name_of(first, true);
        return;
    }
    for (var k = 0u; k < 4u; k++) {
        if is_there[k] {
            names[place] = surfels_name_of(first + vec2u(k & 1u, k >> 1u), false);
            place++;
        }
    }
}

const layer_GRADIENT_UNIT = 1.0 / 1024.0;

@group(1) @binding(0)
var central_central_depth: texture_depth_2d_array;

@group(1) @binding(1)
var central_central_gradient: texture_2d_array<f32>;

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

@group(2) @binding(0)
var<uniform> splat_batch: splat_SplatBatch;

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

const surfels_FLAT = 0.0625;

struct surfels_Surfel {
    pos: vec2f,
    depth: f32,
    gradient: vec2f
}

fn surfels_name_of(texel: vec2u, is_flat: bool) -> u32 {
    return texel.x | (texel.y << surfels_NAME_BITS) | select(0u, surfels_IS_FLAT, is_flat);
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

const surfels_ROOM_TEXELS = 0.125;

fn surfels_hides_nothing(surfel: surfels_Surfel) -> bool {
    if splat_batch.has_receivers == 0u {
        return false;
    }
    let g = surfel.gradient;
    let at_origin = surfel.depth - dot(g, surfel.pos);
    let on_axis = at_origin + dot(g, splat_batch.light_axis.xy) - splat_batch.light_axis.z;
    let across = abs(dot(g, splat_batch.light_reach.xy)) + abs(dot(g, splat_batch.light_reach.zw));
    var is_before = across + abs(on_axis * splat_batch.light_axis.w) < 1.0;
    for (var i = 0u; i < 8u; i++) {
        let corner = splat_batch.receivers[i];
        let behind = at_origin * corner.w + dot(g, corner.xy) - corner.z;
        let texel_width = max(splat_batch.width_of_depth * corner.z + splat_batch.width * corner.w, 0.0);
        is_before = is_before && behind <= surfels_ROOM_TEXELS * texel_width;
    }
    return is_before;
}

fn surfels_depths_at(first: vec2u) -> vec4f {
    return vec4f(surfels_depth_at(first), surfels_depth_at(first + vec2u(1u, 0u)), surfels_depth_at(first + vec2u(0u, 1u)), surfels_depth_at(first + vec2u(1u, 1u)));
}

fn surfels_whole(first: vec2u, d: vec4f) -> surfels_Surfel {
    let middle = 0.25 * ((d.x + d.y) + (d.z + d.w));
    let rise = 0.5 * vec2f((d.y - d.x) + (d.w - d.z), (d.z - d.x) + (d.w - d.y));
    return surfels_Surfel(vec2f(first) + 1.0, middle, rise);
}

fn surfels_are_flat(first: vec2u, d: vec4f) -> bool {
    let piece_of_all = surfels_whole(first, d);
    let g0 = surfels_gradient_at(first, d.x);
    let g1 = surfels_gradient_at(first + vec2u(1u, 0u), d.y);
    let g2 = surfels_gradient_at(first + vec2u(0u, 1u), d.z);
    let g3 = surfels_gradient_at(first + vec2u(1u, 1u), d.w);
    let rise = piece_of_all.gradient;
    let differs = max(abs(vec4f(g0.x, g1.x, g2.x, g3.x) - rise.x), abs(vec4f(g0.y, g1.y, g2.y, g3.y) - rise.y));
    let off = max(abs((d.x + d.w) - (d.y + d.z)), max(max(differs.x, differs.y), max(differs.z, differs.w)));
    return all(d > vec4f(0.0)) && off <= surfels_FLAT * (splat_batch.width_of_depth * piece_of_all.depth + splat_batch.width);
}
