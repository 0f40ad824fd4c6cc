// Linked from src/mask/sparse_upsample/upsample.wesl by `cargo xtask shaders`: edit that, not this.

struct MissingList {
    count: atomic<u32>,
    pixels: array<u32>
}

struct MissingDispatch {
    x: atomic<u32>,
    y: atomic<u32>,
    z: atomic<u32>
}

@group(1) @binding(0)
var<storage, read_write> missing_list: MissingList;

@group(1) @binding(1)
var<storage, read_write> missing_dispatch: MissingDispatch;

const MISSING_WORKGROUP = 64u;

const MAX_WORKGROUPS = 65535u;

const HALF_SLOPE = 0.1;

const NORMAL_POWER = 11.0;

const MIN_WEIGHT = 0.2;

const MAX_DIFFERENCE = 0.25;

fn list_as_missing(pixel: vec2u) {
    let place = atomicAdd(&missing_list.count, 1u);
    missing_list.pixels[place] = pixel.x | (pixel.y << 16u);
    if place % MISSING_WORKGROUP == 0u && place / MISSING_WORKGROUP < MAX_WORKGROUPS {
        atomicAdd(&missing_dispatch.x, 1u);
        atomicMax(&missing_dispatch.y, 1u);
        atomicMax(&missing_dispatch.z, 1u);
    }
}

struct Known {
    receiver: inputs_Receiver,
    visibility: vec3f
}

struct Sum {
    visibility: vec3f,
    weight: f32,
    low: vec3f,
    high: vec3f
}

fn known_at(pixel: vec2u) -> Known {
    return Known(inputs_load_receiver(pixel), inputs_read_visibility_rgb(pixel));
}

fn add(sum: Sum, receiver: inputs_Receiver, other: Known, share: f32) -> Sum {
    if other.receiver.is_background {
        return sum;
    }
    let away = other.receiver.pos_in_world - receiver.pos_in_world;
    let normal = other.receiver.normal_in_world;
    let off_plane = max(abs(dot(away, receiver.normal_in_world)), abs(dot(away, normal))) / max(length(away), 1e-20);
    let in_plane = exp2(-(off_plane * off_plane) / (HALF_SLOPE * HALF_SLOPE));
    let alike = pow(saturate(dot(receiver.normal_in_world, normal)), NORMAL_POWER);
    let weight = share * in_plane * alike;
    if weight < 0.1 * share {
        return sum;
    }
    return Sum(sum.visibility + weight * other.visibility, sum.weight + weight, min(sum.low, other.visibility), max(sum.high, other.visibility));
}

fn write_or_list(pixel: vec2u, sum: Sum) {
    if sum.weight < MIN_WEIGHT || any(sum.high - sum.low > vec3f(MAX_DIFFERENCE)) {
        list_as_missing(pixel);
        return;
    }
    inputs_write_visibility_rgb(pixel, sum.visibility / sum.weight);
}

fn fill_between(pixel: vec2u, a: Known, b: Known) {
    if !inputs_is_inside(pixel) {
        return;
    }
    let receiver = inputs_load_receiver(pixel);
    if receiver.is_background {
        inputs_write_visibility(pixel, 1.0);
        return;
    }
    write_or_list(pixel, add(add(NOTHING, receiver, a, 0.5), receiver, b, 0.5));
}

fn fill_amid(pixel: vec2u, a: Known, b: Known, c: Known, d: Known) {
    if !inputs_is_inside(pixel) {
        return;
    }
    let receiver = inputs_load_receiver(pixel);
    if receiver.is_background {
        inputs_write_visibility(pixel, 1.0);
        return;
    }
    let upper = add(add(NOTHING, receiver, a, 0.25), receiver, b, 0.25);
    write_or_list(pixel, add(add(upper, receiver, c, 0.25), receiver, d, 0.25));
}

const NOTHING = Sum(vec3f(0.0), 0.0, vec3f(1.0), vec3f(0.0));

@compute @workgroup_size(8, 8)
fn upsample(@builtin(global_invocation_id) id: vec3u) {
    let here = inputs_known_pixel(id.xy);
    if !inputs_is_inside(here) {
        return;
    }
    let last_known = (inputs_receiver_view.size_px - 1u) / 2u * 2u;
    let next = min(here + 2u, last_known);
    let a = known_at(here);
    let b = known_at(vec2u(next.x, here.y));
    let c = known_at(vec2u(here.x, next.y));
    let d = known_at(next);
    fill_between(here + vec2u(1u, 0u), a, b);
    fill_between(here + vec2u(0u, 1u), a, c);
    fill_amid(here + vec2u(1u, 1u), a, b, c, d);
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

struct inputs_ReceiverView {
    view_from_clip: mat4x4f,
    world_from_view: mat4x4f,
    eye_in_world: vec3f,
    background_depth: f32,
    size_px: vec2u,
    has_normals: u32,
    mask_layers: u32,
    origin_px: vec2u,
    mask_origin_px: vec2u,
    noise_frame: u32,
    pixel_stride: u32,
    matrix_rounding_m: f32,
    pixel_m_per_w: f32,
    clip_z_row: vec4f,
    clip_w_row: vec4f,
    are_points: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
    anchor_in_world: vec3f,
    padding_3: u32
}

@group(0) @binding(0)
var<uniform> inputs_receiver_view: inputs_ReceiverView;

@group(0) @binding(1)
var<uniform> inputs_light_source: light_LightSource;

@group(0) @binding(2)
var inputs_receiver_depth: texture_2d<f32>;

@group(0) @binding(3)
var inputs_receiver_normals: texture_2d<f32>;

@group(0) @binding(4)
var inputs_mask: texture_storage_2d_array<r32float, read_write>;

struct inputs_Receiver {
    pos_in_world: vec3f,
    normal_in_world: vec3f,
    is_background: bool,
    is_reached: bool
}

const inputs_LUMINANCE = vec3f(0.2126, 0.7152, 0.0722);

const inputs_QUOTIENT_ROUNDING = 1e-5;

fn inputs_store_mask(pixel: vec2u, layer: u32, visibility: f32) {
    let is_one = visibility > 1.0 && visibility < 1.0 + inputs_QUOTIENT_ROUNDING;
    textureStore(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer, vec4f(select(visibility, 1.0, is_one)));
}

fn inputs_load_mask(pixel: vec2u, layer: u32) -> f32 {
    return textureLoad(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer).x;
}

fn inputs_write_visibility(pixel: vec2u, visibility: f32) {
    for (var layer = 0u; layer < inputs_receiver_view.mask_layers; layer++) {
        inputs_store_mask(pixel, layer, visibility);
    }
}

fn inputs_write_visibility_rgb(pixel: vec2u, visibility: vec3f) {
    if inputs_receiver_view.mask_layers < 3u {
        inputs_store_mask(pixel, 0u, dot(visibility, inputs_LUMINANCE));
        return;
    }
    inputs_store_mask(pixel, 0u, visibility.r);
    inputs_store_mask(pixel, 1u, visibility.g);
    inputs_store_mask(pixel, 2u, visibility.b);
}

fn inputs_read_visibility_rgb(pixel: vec2u) -> vec3f {
    let first = inputs_load_mask(pixel, 0u);
    if inputs_receiver_view.mask_layers < 3u {
        return vec3f(first);
    }
    return vec3f(first, inputs_load_mask(pixel, 1u), inputs_load_mask(pixel, 2u));
}

fn inputs_known_pixel(thread: vec2u) -> vec2u {
    return inputs_receiver_view.pixel_stride * thread;
}

fn inputs_is_inside(pixel: vec2u) -> bool {
    return all(pixel < inputs_receiver_view.size_px);
}

fn inputs_are_points() -> bool {
    return inputs_receiver_view.are_points == 1u;
}

fn inputs_depth_at(pixel: vec2u) -> f32 {
    return textureLoad(inputs_receiver_depth, inputs_receiver_view.origin_px + pixel, 0).x;
}

fn inputs_position_in_world(pixel: vec2u, depth: f32) -> vec3f {
    let ndc = (vec2f(pixel) + 0.5) / vec2f(inputs_receiver_view.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = inputs_receiver_view.view_from_clip * vec4f(ndc, depth, 1.0);
    return (inputs_receiver_view.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

fn inputs_camera_ray(pos_in_world: vec3f) -> vec3f {
    let is_parallel = all(inputs_receiver_view.clip_w_row.xyz == vec3f());
    return select(pos_in_world - inputs_receiver_view.eye_in_world, -inputs_receiver_view.world_from_view[2].xyz, is_parallel);
}

fn inputs_best_difference(pixel: vec2u, step: vec2i, center: vec3f, depth: f32) -> vec3f {
    let last = vec2i(inputs_receiver_view.size_px) - 1;
    let ahead = vec2u(clamp(vec2i(pixel) + step, vec2i(0), last));
    let behind = vec2u(clamp(vec2i(pixel) - step, vec2i(0), last));
    let ahead_2 = vec2u(clamp(vec2i(pixel) + 2 * step, vec2i(0), last));
    let behind_2 = vec2u(clamp(vec2i(pixel) - 2 * step, vec2i(0), last));
    let depth_ahead = inputs_depth_at(ahead);
    let depth_behind = inputs_depth_at(behind);
    let miss_ahead = abs(2.0 * depth_ahead - inputs_depth_at(ahead_2) - depth);
    let miss_behind = abs(2.0 * depth_behind - inputs_depth_at(behind_2) - depth);
    if all(behind == pixel) || (miss_ahead < miss_behind && any(ahead != pixel)) {
        return inputs_position_in_world(ahead, depth_ahead) - center;
    }
    return center - inputs_position_in_world(behind, depth_behind);
}

fn inputs_geometric_normal(pixel: vec2u, pos_in_world: vec3f, depth: f32) -> vec3f {
    var normal: vec3f;
    if inputs_receiver_view.has_normals == 1u {
        normal = textureLoad(inputs_receiver_normals, inputs_receiver_view.origin_px + pixel, 0).xyz;
    }
    else {
        normal = cross(inputs_best_difference(pixel, vec2i(1, 0), pos_in_world, depth), inputs_best_difference(pixel, vec2i(0, 1), pos_in_world, depth));
    }
    let to_camera = -inputs_camera_ray(pos_in_world);
    let length_squared = dot(normal, normal);
    if length_squared <= 0.0 || !finite_is_finite(length_squared) {
        return normalize(to_camera);
    }
    normal *= inverseSqrt(length_squared);
    return select(-normal, normal, dot(normal, to_camera) >= 0.0);
}

fn inputs_point_normal(normal: vec3f, pos_in_world: vec3f) -> vec3f {
    if any(normal != vec3f()) {
        return normal;
    }
    if inputs_light_source.kind == light_KIND_SUN {
        return -inputs_light_source.axis_in_world;
    }
    let towards = inputs_light_source.center_in_world - pos_in_world;
    return select(-inputs_light_source.axis_in_world, normalize(towards), dot(towards, towards) > 0.0);
}

fn inputs_point_receiver(pos_in_world: vec3f, normal: vec3f) -> inputs_Receiver {
    return inputs_Receiver(pos_in_world, inputs_point_normal(normal, pos_in_world), false, light_reaches(inputs_light_source, pos_in_world));
}

fn inputs_load_point(pixel: vec2u) -> inputs_Receiver {
    let normal = textureLoad(inputs_receiver_normals, inputs_receiver_view.origin_px + pixel, 0);
    if normal.w == 0.0 {
        return inputs_Receiver(vec3f(), vec3f(), true, true);
    }
    return inputs_point_receiver(textureLoad(inputs_receiver_depth, inputs_receiver_view.origin_px + pixel, 0).xyz, normal.xyz);
}

fn inputs_load_receiver(pixel: vec2u) -> inputs_Receiver {
    if inputs_are_points() {
        return inputs_load_point(pixel);
    }
    let depth = inputs_depth_at(pixel);
    if depth == inputs_receiver_view.background_depth {
        return inputs_Receiver(vec3f(), vec3f(), true, true);
    }
    let pos_in_world = inputs_position_in_world(pixel, depth);
    return inputs_Receiver(pos_in_world, inputs_geometric_normal(pixel, pos_in_world, depth), false, light_reaches(inputs_light_source, pos_in_world));
}

const light_KIND_RECTANGLE = 0u;

const light_KIND_DISK = 1u;

const light_KIND_SUN = 4u;

struct light_LightSource {
    center_in_world: vec3f,
    kind: u32,
    right_in_world: vec3f,
    half_right: f32,
    up_in_world: vec3f,
    half_up: f32,
    axis_in_world: vec3f,
    half_axis: f32,
    max_angle_tangent: f32,
    point_count: u32,
    emission_size: vec2u,
    cone_cosine: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32
}

fn light_reaches(light: light_LightSource, x: vec3f) -> bool {
    if light.kind == light_KIND_SUN {
        return true;
    }
    let from_center = x - light.center_in_world;
    let depth = dot(from_center, light.axis_in_world);
    if light.cone_cosine > 0.0 && depth < light.cone_cosine * length(from_center) {
        return false;
    }
    if light.max_angle_tangent == 0.0 {
        let has_front = light.kind == light_KIND_RECTANGLE || light.kind == light_KIND_DISK;
        return depth > 0.0 || !has_front;
    }
    let half_width = depth * light.max_angle_tangent;
    return depth > 0.0 && abs(dot(from_center, light.right_in_world)) <= half_width && abs(dot(from_center, light.up_in_world)) <= half_width;
}
