// Linked from src/mask/denoise/over_pixels.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(0)
var means: texture_2d_array<f32>;

struct Fit {
    weight: f32,
    first: vec2f,
    second: vec3f,
    v: f32,
    v_at: vec2f,
    v_v: f32,
    low: f32,
    high: f32
}

const REACH = 3;

const SIDE = tile_TILE + 2 * REACH;

var<workgroup> fetched: array<vec3f, SIDE * SIDE>;

fn fetch(group: vec2u, thread: u32, layer: u32) {
    for (var i = i32(thread); i < SIDE * SIDE; i += tile_TILE * tile_TILE) {
        let pixel = tile_fetched_pixel(group, i, REACH);
        fetched[i] = vec3f(textureLoad(means, pixel, layer, 0).xz, inputs_depth_at(pixel));
    }
    workgroupBarrier();
}

fn fetched_at(place: tile_Place, away: vec2i) -> vec3f {
    return fetched[tile_index_of(place, away, REACH)];
}

struct Window {
    reach: i32,
    falloff: f32,
    value: f32,
    slope: vec2f,
    max_off: f32
}

fn fit(place: tile_Place, surface: surface_Surface, window: Window) -> Fit {
    var sums = Fit(0.0, vec2f(), vec3f(), 0.0, vec2f(), 0.0, 1.0, 0.0);
    for (var y = max(-window.reach, -REACH); y <= min(window.reach, REACH); y++) {
        for (var x = max(-window.reach, -REACH); x <= min(window.reach, REACH); x++) {
            let known = fetched_at(place, vec2i(x, y));
            let other = surface_neighbour(place.pixel, vec2i(x, y));
            if !surface_is_on_surface(surface, vec2i(other) - vec2i(place.pixel), known.z) {
                continue;
            }
            let at = vec2f(f32(x), f32(y));
            if abs(known.x - window.value - dot(window.slope, at)) > window.max_off {
                continue;
            }
            let share = exp(-window.falloff * dot(at, at));
            let weight = known.y * share;
            sums.weight += weight;
            sums.first += weight * at;
            sums.second += weight * at.xxy * at.xyy;
            sums.v += weight * known.x;
            sums.v_at += weight * known.x * at;
            sums.v_v += weight * known.x * known.x;
            sums.low = min(sums.low, known.x);
            sums.high = max(sums.high, known.x);
        }
    }
    return sums;
}

struct Plane {
    value: f32,
    slope: vec2f,
    variance: f32
}

fn plane_of(sums: Fit) -> Plane {
    let mean = sums.first / sums.weight;
    let spread = sums.second / sums.weight - mean.xxy * mean.xyy;
    let value = sums.v / sums.weight;
    let variance = sums.v_v / sums.weight - value * value;
    let determinant = spread.x * spread.z - spread.y * spread.y;
    if determinant < 0.01 * spread.x * spread.z || determinant <= 1e-6 {
        return Plane(value, vec2f(), max(variance, 0.0));
    }
    let along = sums.v_at / sums.weight - mean * value;
    let slope = (spread.zx * along - spread.yy * along.yx) / determinant;
    return Plane(value - dot(slope, mean), slope, max(variance - dot(slope, along), 0.0));
}

const TELLING_FRAMES = 4.0;

const OF_PENUMBRA = 0.125;

const MAX_DEVIATION = 2.0;

const NOISE_LEFT = 0.01;

const ROOT_4_PI = 3.5449077;

const ALIKE_DEVIATIONS = 3.0;

const MIN_DEVIATION = 0.3;

fn smoothed(place: tile_Place, known: vec3f) -> f32 {
    var differs = false;
    for (var i = 0; i < 9; i++) {
        differs |= fetched_at(place, 2 * (vec2i(i % 3, i / 3) - 1)).x != known.x;
    }
    if !differs {
        return known.x;
    }
    let surface = surface_surface_of(place.pixel, inputs_load_receiver(place.pixel));
    let wide = fit(place, surface, Window(2, 0.0, 0.0, vec2f(), 2.0));
    let ramp = plane_of(wide);
    let own_variance = max(known.y - known.x * known.x, 0.0) / (known.z * sqrt(known.z));
    let variance = select(own_variance, ramp.variance, known.z < TELLING_FRAMES);
    let deviation = min(MAX_DEVIATION, min(OF_PENUMBRA / max(length(ramp.slope), 0.0001), sqrt(variance) / (NOISE_LEFT * ROOT_4_PI)));
    if deviation < MIN_DEVIATION {
        return known.x;
    }
    let reach = i32(ceil(1.5 * deviation));
    let max_off = ALIKE_DEVIATIONS * sqrt(variance) + NOISE_LEFT;
    let sums = fit(place, surface, Window(reach, 0.5 / (deviation * deviation), known.x, ramp.slope, max_off));
    return clamp(plane_of(sums).value, sums.low, sums.high);
}

@compute @workgroup_size(8, 8)
fn smooth_out(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(local_invocation_index) thread: u32) {
    let pixel = id.xy;
    let layer = id.z;
    fetch(group.xy, thread, layer);
    if !inputs_is_inside(pixel) {
        return;
    }
    let known = textureLoad(means, pixel, layer, 0).xyz;
    var visibility = 1.0;
    if known.z > 0.0 {
        visibility = smoothed(tile_place_of(pixel, local.xy, REACH), known);
    }
    inputs_store_mask(pixel, layer, visibility);
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
