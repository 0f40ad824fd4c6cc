// Linked from src/techniques/multi_layer/nearest.wesl by `cargo xtask shaders`: edit that, not this.

struct NearestStep {
    map_size: vec2u,
    level: u32,
    first: u32,
    source_first: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(0) @binding(0)
var<storage, read> nearest_step: NearestStep;

@group(0) @binding(1)
var<storage, read> lists: array<vec2u>;

@group(0) @binding(2)
var<storage, read> fragments: array<vec2u>;

@group(0) @binding(3)
var<storage, read_write> nearest: array<f32>;

const NONE = 3e38;

const TILE = 8u;

const TEXELS = 4u;

const SIZES = 4u;

var<workgroup> tile: array<f32, 64>;

fn size_of(level: u32) -> vec2u {
    return (nearest_step.map_size + ((TEXELS << level) - 1u)) >> vec2u(2u + level);
}

fn nearest_of_texels(square: vec2u) -> f32 {
    var z_m = NONE;
    let end = min(TEXELS * (square + 1u), nearest_step.map_size);
    for (var y = TEXELS * square.y; y < end.y; y++) {
        for (var x = TEXELS * square.x; x < end.x; x++) {
            let list = lists[y * nearest_step.map_size.x + x];
            if list.y > 0u {
                z_m = min(z_m, bitcast<f32>(fragments[list.x].x));
            }
        }
    }
    return z_m;
}

fn nearest_of_squares(square: vec2u) -> f32 {
    let size = size_of(nearest_step.level - 1u);
    let near = min(2u * square, size - 1u);
    let far = min(2u * square + 1u, size - 1u);
    let near_row = nearest_step.source_first + near.y * size.x;
    let far_row = nearest_step.source_first + far.y * size.x;
    return min(min(nearest[near_row + near.x], nearest[near_row + far.x]), min(nearest[far_row + near.x], nearest[far_row + far.x]));
}

fn keep(found: f32, id: vec2u, group: vec2u, local: vec2u) {
    var z_m = found;
    var first = nearest_step.first;
    for (var i = 0u; i < SIZES; i++) {
        let side = TILE >> i;
        let size = size_of(nearest_step.level + i);
        let square = side * group + local;
        let is_kept = all(local < vec2u(side));
        if is_kept && all(square < size) {
            nearest[first + square.y * size.x + square.x] = z_m;
        }
        first += size.x * size.y;
        workgroupBarrier();
        if is_kept {
            tile[local.y * TILE + local.x] = z_m;
        }
        workgroupBarrier();
        if all(2u * local < vec2u(side)) {
            let corner = 2u * local.y * TILE + 2u * local.x;
            z_m = min(min(tile[corner], tile[corner + 1u]), min(tile[corner + TILE], tile[corner + TILE + 1u]));
        }
    }
}

@compute @workgroup_size(8, 8)
fn of_lists(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    keep(nearest_of_texels(id.xy), id.xy, group.xy, local.xy);
}

@compute @workgroup_size(8, 8)
fn of_squares(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    keep(nearest_of_squares(id.xy), id.xy, group.xy, local.xy);
}
