// Linked from src/receivers/points/write.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(1)
var mask: texture_2d_array<f32>;

@group(0) @binding(2)
var<storage, read_write> visibilities: array<f32>;

@compute @workgroup_size(8, 8)
fn write_points(@builtin(global_invocation_id) id: vec3u) {
    let point = points_point_at(id.xy);
    if point >= points_points.count {
        return;
    }
    for (var channel = 0u; channel < points_points.channels; channel++) {
        visibilities[points_points.channels * point + channel] = textureLoad(mask, id.xy, channel, 0).x;
    }
}

struct points_PointLayout {
    anchor: vec3f,
    count: u32,
    row_length: u32,
    are_in_rows: u32,
    first_position: u32,
    position_stride: u32,
    has_normals: u32,
    first_normal: u32,
    normal_stride: u32,
    has_widths: u32,
    first_width: u32,
    width_stride: u32,
    width_m: f32,
    channels: u32
}

@group(0) @binding(0)
var<uniform> points_points: points_PointLayout;

const points_TILE = 8u;

fn points_point_at(texel: vec2u) -> u32 {
    if texel.x >= points_points.row_length {
        return points_points.count;
    }
    if points_points.are_in_rows == 1u {
        return texel.y * points_points.row_length + texel.x;
    }
    let tile = texel / points_TILE;
    let within = texel % points_TILE;
    return points_TILE * points_TILE * (tile.y * (points_points.row_length / points_TILE) + tile.x) + points_TILE * within.y + within.x;
}
