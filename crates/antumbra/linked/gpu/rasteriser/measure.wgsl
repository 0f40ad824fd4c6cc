// Linked from src/gpu/rasteriser/measure.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var drawn: texture_depth_2d;

@group(0) @binding(1)
var<storage, read_write> snapped_texels: f32;

const THREADS = 256u;

const SIZE = package_gpu_rasteriser_planes_CELLS * package_gpu_rasteriser_planes__1CELL_TEXELS;

const MARGIN = 1.25;

const EXACT = 0.00025;

const MOST = 0.125;

var<workgroup> worst: atomic<u32>;

fn moved_texels(texel: vec2u) -> f32 {
    let depth = textureLoad(drawn, texel, 0);
    if depth == 0.0 {
        return 0.0;
    }
    let in_grid = texel / package_gpu_rasteriser_planes__1CELL_TEXELS;
    let cell = in_grid.y * package_gpu_rasteriser_planes_CELLS + in_grid.x;
    let from_center = vec2f(texel % package_gpu_rasteriser_planes__1CELL_TEXELS) + 0.5 - 0.5 * f32(package_gpu_rasteriser_planes__1CELL_TEXELS);
    let slope = abs(package_gpu_rasteriser_planes__1slope_of(cell));
    return abs(depth - package_gpu_rasteriser_planes__1depth_at(cell, from_center)) / (slope.x + slope.y);
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

const package_gpu_rasteriser_planes_CELLS = 16u;

const package_gpu_rasteriser_planes__1CELL_TEXELS = 16u;

const package_gpu_rasteriser_planes_SLOPE = 0.015625;

fn package_gpu_rasteriser_planes__1slope_of(cell: u32) -> vec2f {
    let angle = 2.3999632 * f32(cell);
    return package_gpu_rasteriser_planes_SLOPE * vec2f(cos(angle), sin(angle));
}

fn package_gpu_rasteriser_planes__1depth_at(cell: u32, from_center: vec2f) -> f32 {
    return 0.5 + dot(package_gpu_rasteriser_planes__1slope_of(cell), from_center);
}
