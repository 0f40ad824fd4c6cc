// Linked from src/techniques/summed/summed_area_table/doubling.wesl with float by `cargo xtask shaders`: edit that, not this.

struct DoublingUniform {
    size: vec2u,
    stride: vec2u,
    tile: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(0) @binding(0)
var source: texture_2d<f32>;

@group(0) @binding(1)
var table: texture_storage_2d<rgba32float, write>;

@group(0) @binding(2)
var<uniform> shape: DoublingUniform;

@group(0) @binding(6)
var<storage, read_write> largest: array<atomic<u32>>;

@group(1) @binding(0)
var<storage, read_write> late_dispatch: array<u32, 3>;

const DOUBLING_READS = 8u;

const GROUP_SIDE = 16u;

fn tile_side() -> u32 {
    if shape.tile > 0u {
        return shape.tile;
    }
    var log2 = 0u;
    for (; log2 + 1u < arrayLength(&largest); log2++) {
        if overflow_overflows(atomicLoad(&largest[log2 + 1u])) {
            break;
        }
    }
    return 16u << log2;
}

@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn double(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= shape.size) {
        return;
    }
    let first = id.xy & vec2u(~(tile_side() - 1u));
    var sum = textureLoad(source, id.xy, 0);
    for (var i = 1u; i < DOUBLING_READS; i++) {
        let back = i * shape.stride;
        if all(id.xy >= first + back) {
            sum += textureLoad(source, id.xy - back, 0);
        }
    }
    textureStore(table, id.xy, sum);
}

@compute @workgroup_size(1)
fn count_late() {
    let is_taken = max(shape.stride.x, shape.stride.y) < tile_side();
    let groups = select(vec2u(), (shape.size + GROUP_SIDE - 1u) / GROUP_SIDE, is_taken);
    late_dispatch[0] = groups.x;
    late_dispatch[1] = groups.y;
    late_dispatch[2] = 1u;
}

const overflow_BITS_OF_TWO_TO_32 = 1333788672u;

fn overflow_overflows(largest_sum: u32) -> bool {
    return largest_sum >= overflow_BITS_OF_TWO_TO_32;
}
