// Linked from src/receivers/points/pack.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(1)
var<storage, read> position_words: array<u32>;

@group(0) @binding(2)
var<storage, read> normal_words: array<u32>;

@group(0) @binding(3)
var<storage, read> width_words: array<u32>;

@group(0) @binding(4)
var positions: texture_storage_2d<rgba32float, write>;

@group(0) @binding(5)
var normals: texture_storage_2d<rgba32float, write>;

const UNIT_ROUNDING = 4.76837158203125e-7;

fn unit(v: vec3f) -> vec3f {
    let longest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    let length_squared = dot(v, v);
    if abs(length_squared - 1.0) <= UNIT_ROUNDING {
        return v;
    }
    return select(vec3f(), normalize(v / longest), longest > 0.0);
}

fn normal_of(point: u32) -> vec3f {
    if points_points.has_normals == 0u {
        return vec3f();
    }
    let at = points_points.first_normal + points_points.normal_stride * point;
    let normal = bitcast<vec3f>(vec3u(normal_words[at], normal_words[at + 1u], normal_words[at + 2u]));
    return select(vec3f(), unit(normal), finite_all_finite(normal));
}

fn width_of(point: u32) -> f32 {
    if points_points.has_widths == 0u {
        return points_points.width_m;
    }
    let width_m = bitcast<f32>(width_words[points_points.first_width + points_points.width_stride * point]);
    return select(0.0, max(width_m, 0.0), finite_is_finite(width_m));
}

@compute @workgroup_size(8, 8)
fn read_points(@builtin(global_invocation_id) id: vec3u) {
    let point = points_point_at(id.xy);
    var place = vec4f();
    var normal = vec4f();
    if point < points_points.count {
        let at = points_points.first_position + points_points.position_stride * point;
        let position = bitcast<vec3f>(vec3u(position_words[at], position_words[at + 1u], position_words[at + 2u]));
        if finite_all_finite(position) {
            place = vec4f(position - points_points.anchor, width_of(point));
            normal = vec4f(normal_of(point), 1.0);
        }
    }
    textureStore(positions, id.xy, place);
    textureStore(normals, id.xy, normal);
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

fn finite_all_finite(v: vec3f) -> bool {
    return finite_is_finite(v.x) && finite_is_finite(v.y) && finite_is_finite(v.z);
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
