// Linked from src/gpu/rasteriser/measure.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var drawn: texture_depth_2d;

@group(0) @binding(1)
var<storage, read_write> snapped_texels: f32;

const THREADS = 256u;

const SIZE = planes_CELLS * planes_CELL_TEXELS;

const MARGIN = 1.25;

const EXACT = 0.00025;

const MOST = 0.125;

var<workgroup> worst: atomic<u32>;

fn moved_texels(texel: vec2u) -> f32 {
    let depth = textureLoad(drawn, texel, 0);
    if depth == 0.0 {
        return 0.0;
    }
    let in_grid = texel / planes_CELL_TEXELS;
    let cell = in_grid.y * planes_CELLS + in_grid.x;
    let from_center = vec2f(texel % planes_CELL_TEXELS) + 0.5 - 0.5 * f32(planes_CELL_TEXELS);
    let slope = abs(planes_slope_of(cell));
    return abs(depth - planes_depth_at(cell, from_center)) / (slope.x + slope.y);
}

@compute @workgroup_size(THREADS)
fn measure(@builtin(local_invocation_index) thread: u32) {
    var own = 0.0;
    for (var i = thread; i < SIZE * SIZE; i += THREADS) {
        own = max(own, moved_texels(vec2u(i % SIZE, i / SIZE)));
    }
    atomicMax(&worst, bitcast<u32>(own));
    workgroupBarrier();
    if thread == 0u {
        let found = bitcast<f32>(atomicLoad(&worst));
        snapped_texels = select(0.0, min(MARGIN * found, MOST), found > EXACT);
    }
}

const planes_CELLS = 16u;

const planes_CELL_TEXELS = 16u;

const planes_SLOPE = 0.015625;

fn planes_slope_of(cell: u32) -> vec2f {
    let angle = 2.3999632 * f32(cell);
    return planes_SLOPE * vec2f(cos(angle), sin(angle));
}

fn planes_depth_at(cell: u32, from_center: vec2f) -> f32 {
    return 0.5 + dot(planes_slope_of(cell), from_center);
}
