// Samples the depth buffer at points spread evenly over the view.

struct Grid {
    origin_px: vec2<u32>,
    size_px: vec2<u32>,
    cells: vec2<u32>,
    padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> grid: Grid;
@group(0) @binding(1) var depth: texture_depth_2d;
// Sampled depths, row by row from the top left.
@group(0) @binding(2) var<storage, read_write> depths: array<f32>;

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= grid.cells) {
        return;
    }
    let pixel = grid.origin_px + (2u * id.xy + 1u) * grid.size_px / (2u * grid.cells);
    depths[id.y * grid.cells.x + id.x] = textureLoad(depth, pixel, 0);
}
