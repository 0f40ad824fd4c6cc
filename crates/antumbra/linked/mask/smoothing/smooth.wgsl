// Linked from src/mask/smoothing/smooth.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(0)
var noisy: texture_2d<u32>;

const REACH = 3;

const TILE = 8;

const SIDE = 14;

const COUNT = 196u;

const OF_HALF_WIDTH = 0.12;

const MAX_DEVIATION_PX = 2.0;

const MIN_HEIGHT = 0.02;

const MIN_SPREAD = 1e-6;

var<workgroup> values: array<u32, COUNT>;

var<workgroup> depths: array<f32, COUNT>;

var<workgroup> least: atomic<u32>;

var<workgroup> most: atomic<u32>;

fn unpacked(value: u32) -> vec2f {
    return unpack2x16float(value);
}

fn load_tile(corner: vec2i, lane: u32) {
    for (var i = lane; i < COUNT; i += u32(TILE * TILE)) {
        let pixel = corner + vec2i(i32(i) % SIDE, i32(i) / SIDE);
        var depth = inputs_receiver_view.background_depth;
        var value = 0u;
        if all(pixel >= vec2i(0)) && inputs_is_inside(vec2u(pixel)) {
            depth = inputs_depth_at(vec2u(pixel));
            value = textureLoad(noisy, pixel, 0).x;
        }
        depths[i] = depth;
        values[i] = value;
        if depth != inputs_receiver_view.background_depth {
            let bits = bitcast<u32>(max(unpacked(value).x, 0.0));
            atomicMin(&least, bits);
            atomicMax(&most, bits);
        }
    }
}

fn pixels_of(displacement: vec3f, right: vec3f, down: vec3f) -> vec2f {
    let gram = vec3f(dot(right, right), dot(right, down), dot(down, down));
    let along = vec2f(dot(right, displacement), dot(down, displacement));
    let determinant = max(gram.x * gram.z - gram.y * gram.y, 1e-30);
    return (gram.zx * along - gram.yy * along.yx) / determinant;
}

fn thrown_light(pixel: vec2u, receiver: inputs_Receiver, surface: surface_Surface) -> vec3f {
    let position = receiver.pos_in_world;
    let n = receiver.normal_in_world;
    let right = inputs_position_in_world(pixel + vec2u(1u, 0u), surface.depth + surface.depth_step.x) - position;
    let down = inputs_position_in_world(pixel + vec2u(0u, 1u), surface.depth + surface.depth_step.y) - position;
    let is_sun = inputs_light_source.kind == light_KIND_SUN;
    let to_light = select(normalize(inputs_light_source.center_in_world - position), -inputs_light_source.axis_in_world, is_sun);
    let height = max(dot(n, to_light), MIN_HEIGHT);
    let halves = vec3f(inputs_light_source.half_right, inputs_light_source.half_up, inputs_light_source.half_axis);
    let half = select(halves, vec3f(halves.x), inputs_light_source.kind == light_KIND_SPHERE);
    let axes = mat3x3f(inputs_light_source.right_in_world * half.x, inputs_light_source.up_in_world * half.y, inputs_light_source.axis_in_world * half.z);
    var ellipse = vec3f(MIN_SPREAD, 0.0, MIN_SPREAD);
    for (var i = 0; i < 3; i++) {
        let thrown = axes[i] - to_light * (dot(n, axes[i]) / height);
        let q = pixels_of(thrown, right, down);
        ellipse += q.xxy * q.xyy;
    }
    return ellipse;
}

fn inverse_of(m: vec3f) -> vec3f {
    return vec3f(m.z, -m.y, m.x) / max(m.x * m.z - m.y * m.y, 1e-30);
}

fn smoothed(pixel: vec2u, center: i32) -> f32 {
    let own = unpacked(values[center]);
    let receiver = inputs_load_receiver(pixel);
    let surface = surface_surface_of(pixel, receiver);
    let falloff = inverse_of(thrown_light(pixel, receiver, surface)) / (OF_HALF_WIDTH * OF_HALF_WIDTH);
    var weight = 1.0;
    var sum = own.x;
    for (var y = 0; y <= REACH; y++) {
        for (var x = -REACH; x <= REACH; x++) {
            let away = vec2i(x, y);
            let step = y * SIDE + x;
            if y == 0 && x <= 0 {
                continue;
            }
            let depth_a = depths[center + step];
            let depth_b = depths[center - step];
            if depth_a == inputs_receiver_view.background_depth || depth_b == inputs_receiver_view.background_depth || !surface_is_on_surface(surface, away, depth_a) || !surface_is_on_surface(surface, -away, depth_b) {
                continue;
            }
            let a = unpacked(values[center + step]);
            let b = unpacked(values[center - step]);
            let magnification = min(own.y, min(a.y, b.y));
            if magnification == noisy_NO_MAGNIFICATION {
                continue;
            }
            let at = vec2f(away);
            let in_penumbra = dot(falloff, at.xxy * at.xyy * vec3f(1.0, 2.0, 1.0)) / max(magnification * magnification, 1e-12);
            let share = exp(-0.5 * (in_penumbra + dot(at, at) / (MAX_DEVIATION_PX * MAX_DEVIATION_PX)));
            weight += 2.0 * share;
            sum += share * (a.x + b.x);
        }
    }
    return sum / weight;
}

@compute @workgroup_size(8, 8)
fn smooth_out(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&least, 4294967295u);
        atomicStore(&most, 0u);
    }
    workgroupBarrier();
    load_tile(TILE * vec2i(tile.xy) - REACH, lane);
    workgroupBarrier();
    let pixel = u32(TILE) * tile.xy + local.xy;
    if !inputs_is_inside(pixel) {
        return;
    }
    let center = (i32(local.y) + REACH) * SIDE + i32(local.x) + REACH;
    var visibility = 1.0;
    if depths[center] != inputs_receiver_view.background_depth {
        visibility = unpacked(values[center]).x;
        if atomicLoad(&least) != atomicLoad(&most) {
            visibility = smoothed(pixel, center);
        }
    }
    inputs_write_visibility(pixel, visibility);
}

struct surface_Surface {
    depth: f32,
    depth_step: vec2f,
    max_off_m: f32,
    max_off: f32
}

const surface_MAX_OFF_PX = 0.05;

const surface_ROUNDING = 0.0001;

fn surface_surface_of(pixel: vec2u, receiver: inputs_Receiver) -> surface_Surface {
    let n = receiver.normal_in_world;
    let plane = vec4f(n, -dot(n, receiver.pos_in_world));
    let in_clip = (plane * inputs_receiver_view.world_from_view) * inputs_receiver_view.view_from_clip;
    let depth = inputs_depth_at(pixel);
    let size = vec2f(inputs_receiver_view.size_px);
    let ndc = (vec2f(pixel) + 0.5) / size * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let here = inputs_receiver_view.view_from_clip * vec4f(ndc, depth, 1.0);
    let w = 1.0 / here.w;
    let step_ndc = vec2f(2.0, -2.0) / size;
    let corner = inputs_receiver_view.view_from_clip * vec4f(ndc + step_ndc, depth, 1.0);
    let pixel_m = distance(corner.xyz / corner.w, here.xyz / here.w);
    let max_off_m = surface_MAX_OFF_PX * pixel_m + surface_ROUNDING * distance(receiver.pos_in_world, inputs_receiver_view.eye_in_world);
    return surface_Surface(depth, -in_clip.xy / in_clip.z * step_ndc, max_off_m, max_off_m / abs(in_clip.z * w));
}

fn surface_is_on_surface(surface: surface_Surface, away: vec2i, depth: f32) -> bool {
    let far = f32(max(abs(away.x), abs(away.y)));
    return abs(surface.depth + dot(surface.depth_step, vec2f(away)) - depth) <= surface.max_off * max(far, 1.0);
}

const noisy_NO_MAGNIFICATION = 65504.0;

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

const inputs_QUOTIENT_ROUNDING = 1e-5;

fn inputs_store_mask(pixel: vec2u, layer: u32, visibility: f32) {
    let is_one = visibility > 1.0 && visibility < 1.0 + inputs_QUOTIENT_ROUNDING;
    textureStore(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer, vec4f(select(visibility, 1.0, is_one)));
}

fn inputs_write_visibility(pixel: vec2u, visibility: f32) {
    for (var layer = 0u; layer < inputs_receiver_view.mask_layers; layer++) {
        inputs_store_mask(pixel, layer, visibility);
    }
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

const light_KIND_SPHERE = 2u;

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
