// Linked from src/mask/denoise/over_time.wesl by `cargo xtask shaders`: edit that, not this.

struct DenoiseFrame {
    clip_from_world_before: mat4x4f,
    world_from_clip_before: mat4x4f,
    background_depth_before: f32,
    max_frames: f32,
    has_before: u32,
    has_motion: u32
}

@group(1) @binding(0)
var<uniform> denoise: DenoiseFrame;

@group(1) @binding(1)
var noisy: texture_2d_array<f32>;

@group(1) @binding(2)
var means_before: texture_2d_array<f32>;

@group(1) @binding(3)
var depth_before: texture_2d<f32>;

@group(1) @binding(4)
var motion: texture_2d<f32>;

@group(1) @binding(5)
var means_now: texture_storage_2d_array<rgba16float, write>;

@group(1) @binding(6)
var depth_now: texture_storage_2d<r32float, write>;

struct Known {
    mean: f32,
    square: f32,
    frames: f32
}

const NOTHING = Known(0.0, 0.0, 0.0);

struct Around {
    mean: f32,
    variance: f32,
    count: f32
}

const AROUND = 2;

const SIDE = tile_TILE + 2 * AROUND;

var<workgroup> fetched: array<vec2f, SIDE * SIDE>;

fn fetch(group: vec2u, thread: u32, layer: u32) {
    for (var i = i32(thread); i < SIDE * SIDE; i += tile_TILE * tile_TILE) {
        let pixel = tile_fetched_pixel(group, i, AROUND);
        fetched[i] = vec2f(textureLoad(noisy, pixel, layer, 0).x, inputs_depth_at(pixel));
    }
    workgroupBarrier();
}

fn fetched_at(place: tile_Place, away: vec2i) -> vec2f {
    return fetched[tile_index_of(place, away, AROUND)];
}

fn around(place: tile_Place, surface: surface_Surface, now: f32) -> Around {
    var differs = false;
    for (var i = 0; i < 9; i++) {
        differs |= fetched_at(place, AROUND * (vec2i(i % 3, i / 3) - 1)).x != now;
    }
    if !differs {
        return Around(now, 0.0, 25.0);
    }
    var sum = 0.0;
    var squares = 0.0;
    var count = 0.0;
    for (var y = -AROUND; y <= AROUND; y++) {
        for (var x = -AROUND; x <= AROUND; x++) {
            let seen = fetched_at(place, vec2i(x, y));
            let other = surface_neighbour(place.pixel, vec2i(x, y));
            if surface_is_on_surface(surface, vec2i(other) - vec2i(place.pixel), seen.y) {
                let visibility = seen.x;
                sum += visibility;
                squares += visibility * visibility;
                count += 1.0;
            }
        }
    }
    let mean = sum / count;
    return Around(mean, max(squares / count - mean * mean, 0.0), count);
}

fn pixel_before(pixel: vec2u, pos_in_world: vec3f) -> vec2f {
    let size = vec2f(inputs_receiver_view.size_px);
    if denoise.has_motion == 1u {
        return vec2f(pixel) + 0.5 - size * textureLoad(motion, inputs_receiver_view.origin_px + pixel, 0).xy;
    }
    let clip = denoise.clip_from_world_before * vec4f(pos_in_world, 1.0);
    if clip.w <= 0.0 {
        return vec2f(-1.0);
    }
    return (clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5) * size;
}

fn position_before(pixel: vec2u, depth: f32) -> vec3f {
    let ndc = (vec2f(pixel) + 0.5) / vec2f(inputs_receiver_view.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let position = denoise.world_from_clip_before * vec4f(ndc, depth, 1.0);
    return position.xyz / position.w;
}

const MAX_DEPTH_RATIO = 1.1;

fn was_same_surface(receiver: inputs_Receiver, surface: surface_Surface, depth: f32, pixel: vec2u) -> bool {
    if depth == denoise.background_depth_before {
        return false;
    }
    let position = position_before(pixel, depth);
    if denoise.has_motion == 1u {
        let w = (denoise.clip_from_world_before * vec4f(position, 1.0)).w;
        let w_now = (denoise.clip_from_world_before * vec4f(receiver.pos_in_world, 1.0)).w;
        return max(w, w_now) < MAX_DEPTH_RATIO * min(w, w_now);
    }
    return abs(dot(receiver.normal_in_world, position - receiver.pos_in_world)) <= surface.max_off_m;
}

const MIN_SHARE = 0.01;

fn before(pixel: vec2u, layer: u32, receiver: inputs_Receiver, surface: surface_Surface) -> Known {
    if denoise.has_before == 0u {
        return NOTHING;
    }
    let at = pixel_before(pixel, receiver.pos_in_world) - 0.5;
    if !finite_is_finite(at.x) || !finite_is_finite(at.y) || any(at <= vec2f(-1.0)) || any(at >= vec2f(inputs_receiver_view.size_px)) {
        return NOTHING;
    }
    let low = floor(at);
    let part = at - low;
    var sum = vec3f();
    var weights = 0.0;
    for (var corner = 0u; corner < 4u; corner++) {
        let step = vec2f(f32(corner & 1u), f32(corner >> 1u));
        let tap = vec2i(low + step);
        let shares = select(1.0 - part, part, step > vec2f(0.5));
        let share = shares.x * shares.y;
        if share < MIN_SHARE || any(tap < vec2i(0)) || any(tap >= vec2i(inputs_receiver_view.size_px)) {
            continue;
        }
        if was_same_surface(receiver, surface, textureLoad(depth_before, tap, 0).x, vec2u(tap)) {
            sum += share * textureLoad(means_before, tap, layer, 0).xyz;
            weights += share;
        }
    }
    if weights < MIN_SHARE {
        return NOTHING;
    }
    return Known(sum.x / weights, sum.y / weights, floor(sum.z + 0.5));
}

const MAX_DEVIATIONS = 1.5;

const STANDARD_ERRORS = 2.0;

const UNSEEN = 0.1;

fn kept(earlier: Known, seen: Around, now: f32) -> Known {
    let variance = max(seen.variance, UNSEEN * UNSEEN);
    let deviation = sqrt(variance);
    let off = seen.mean - earlier.mean;
    let own_off = max((now - earlier.mean) * sign(off), 0.0);
    let unlikely = min(abs(off) - STANDARD_ERRORS * deviation * inverseSqrt(seen.count), 2.0 * own_off);
    let telling = select(earlier.frames, variance / (unlikely * unlikely), unlikely > 0.0);
    let reach = MAX_DEVIATIONS * deviation;
    return Known(clamp(earlier.mean, min(seen.mean - reach, now), max(seen.mean + reach, now)), earlier.square, min(earlier.frames, telling));
}

fn joined(held: Known, now: f32) -> Known {
    let frames = min(held.frames + 1.0, denoise.max_frames);
    return Known(held.mean + (now - held.mean) / frames, held.square + (now * now - held.square) / frames, max(floor(frames), 1.0));
}

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(local_invocation_index) thread: u32) {
    let pixel = id.xy;
    let layer = id.z;
    fetch(group.xy, thread, layer);
    if !inputs_is_inside(pixel) {
        return;
    }
    let place = tile_place_of(pixel, local.xy, AROUND);
    let seen = fetched_at(place, vec2i());
    if layer == 0u {
        textureStore(depth_now, pixel, vec4f(seen.y));
    }
    let receiver = inputs_load_receiver(pixel);
    if receiver.is_background {
        textureStore(means_now, pixel, layer, vec4f(1.0, 1.0, 0.0, 0.0));
        return;
    }
    let now = seen.x;
    let surface = surface_surface_of(pixel, receiver);
    var known = before(pixel, layer, receiver, surface);
    if known.frames >= 1.0 && known.mean != now {
        known = kept(known, around(place, surface, now), now);
    }
    known = joined(known, now);
    textureStore(means_now, pixel, layer, vec4f(known.mean, known.square, known.frames, 0.0));
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

fn surface_neighbour(pixel: vec2u, away: vec2i) -> vec2u {
    return vec2u(clamp(vec2i(pixel) + away, vec2i(0), vec2i(inputs_receiver_view.size_px) - 1));
}

const tile_TILE = 8;

struct tile_Place {
    pixel: vec2u,
    in_fetched: i32
}

fn tile_side_of(reach: i32) -> i32 {
    return tile_TILE + 2 * reach;
}

fn tile_fetched_pixel(group: vec2u, i: i32, reach: i32) -> vec2u {
    return surface_neighbour(u32(tile_TILE) * group, vec2i(i % tile_side_of(reach), i / tile_side_of(reach)) - reach);
}

fn tile_place_of(pixel: vec2u, local: vec2u, reach: i32) -> tile_Place {
    let at = vec2i(local) + reach;
    return tile_Place(pixel, at.y * tile_side_of(reach) + at.x);
}

fn tile_index_of(place: tile_Place, away: vec2i, reach: i32) -> i32 {
    return place.in_fetched + away.y * tile_side_of(reach) + away.x;
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

struct inputs_Receiver {
    pos_in_world: vec3f,
    normal_in_world: vec3f,
    is_background: bool,
    is_reached: bool
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
