// Linked from src/gpu/rasteriser/draw.wesl by `cargo xtask shaders`: edit that, not this.

fn corner_in_cell(i: u32) -> vec2f {
    let spread = fract(0.5 + f32(i + 1u) * vec2f(0.7548777, 0.5698403));
    return f32(planes_CELL_TEXELS) * (spread - 0.5);
}

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    let cell = i / 3u;
    let from_center = corner_in_cell(i);
    let center = f32(planes_CELL_TEXELS) * (vec2f(vec2u(cell % planes_CELLS, cell / planes_CELLS)) + 0.5);
    let pos = (center + from_center) / f32(planes_CELLS * planes_CELL_TEXELS);
    return vec4f(vec2f(2.0, -2.0) * pos + vec2f(-1.0, 1.0), planes_depth_at(cell, from_center), 1.0);
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
