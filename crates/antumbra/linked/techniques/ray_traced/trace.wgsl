// Linked from src/techniques/ray_traced/trace.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(6)
var<uniform> snapped_texels: f32;

@group(1) @binding(7)
var<storage, read_write> passed_before: array<u32>;

const END_MARGIN = 9.5367431640625e-7;

struct Point {
    at: vec4f,
    weight: f32
}

const GOLDEN = 0.618033989;

fn point_of(index: u32, shift: vec2f, x: vec3f) -> Point {
    if inputs_light_source.kind == light_KIND_POINTS {
        return Point(vec4f(inputs_light_data[index].xyz, 1.0), 1.0);
    }
    let shifts = vec3f(shift, fract(shift.x + GOLDEN * shift.y));
    let u = fract(bitcast<vec3f>(traversal_tables[index].xyz) + shifts);
    var weight = 1.0;
    if inputs_light_source.emission_size.x > 0u {
        weight = inputs_light_data[light_emission_index(inputs_light_source, u.xy)].x;
    }
    return Point(light_light_point(inputs_light_source, u, x), weight);
}

struct Start {
    x: vec3f,
    offset_m: f32,
    normal: vec3f,
    depth_error_m: vec3f
}

fn start_of(receiver: inputs_Receiver) -> Start {
    let x = receiver.pos_in_world;
    let offset_m = traversal_rays.bias_scale * ray_offset_ray_offset_from(x, snapped_texels, inputs_receiver_view.matrix_rounding_m);
    return Start(x, offset_m, receiver.normal_in_world, inputs_depth_error_m(x));
}

fn visibility_of(start: Start, point: vec4f) -> vec3f {
    let towards = point.xyz - point.w * start.x;
    if dot(towards, start.normal) <= 0.0 {
        return vec3f();
    }
    let x_open = start.x + start.offset_m * start.normal;
    let is_distant = inputs_light_source.kind == light_KIND_SUN;
    let sight = traversal_ShadowSegments(traversal_Segment(start.x, towards), traversal_Segment(x_open, point.xyz - point.w * x_open), select(1.0 + END_MARGIN, 0.0, is_distant), start.depth_error_m);
    return traversal_passes(sight, start.offset_m);
}

fn given_to(start: Start, point: vec4f) -> f32 {
    let facing = irradiance_facing_of_points(inputs_light_source, start.x);
    return irradiance_given_by_point(inputs_light_source, facing, start.normal, point.xyz - point.w * start.x);
}

const MAX_PACKED = 1023.0;

fn pack(passed: vec3f) -> u32 {
    let levels = vec3u(round(saturate(passed) * MAX_PACKED));
    return levels.x | (levels.y << 10u) | (levels.z << 20u);
}

fn unpack(word: u32) -> vec3f {
    return vec3f(vec3u(word, word >> 10u, word >> 20u) & vec3u(1023u)) / MAX_PACKED;
}

fn with_earlier(pixel: vec2u, i: u32, passed: vec3f) -> vec3f {
    if traversal_rays.passed_stride == 0u {
        return passed;
    }
    let at = traversal_rays.passed_stride * (pixel.y * inputs_receiver_view.size_px.x + pixel.x) + i;
    var all = passed;
    if traversal_rays.texture_group > 0u {
        all *= unpack(passed_before[at]);
    }
    passed_before[at] = pack(all);
    return all;
}

fn add(pixel: vec2u, share: vec3f) {
    if traversal_rays.first_point == 0u {
        inputs_write_visibility_rgb(pixel, min(share, vec3f(1.0)));
    }
    else {
        inputs_write_visibility_rgb(pixel, min(inputs_read_visibility_rgb(pixel) + share, vec3f(1.0)));
    }
}

fn add_irradiance(pixel: vec2u, arriving: vec3f, given: f32) {
    var all = given;
    if traversal_rays.point_count < traversal_rays.all_points {
        let size = inputs_receiver_view.size_px;
        let at = traversal_rays.passed_stride * size.x * size.y + pixel.y * size.x + pixel.x;
        if traversal_rays.first_point > 0u {
            all += bitcast<f32>(passed_before[at]);
        }
        passed_before[at] = bitcast<u32>(all);
    }
    if all <= 0.0 {
        inputs_write_visibility(pixel, 0.0);
        return;
    }
    var part = arriving / all;
    if traversal_rays.first_point > 0u {
        part += inputs_read_visibility_rgb(pixel) * ((all - given) / all);
    }
    inputs_write_visibility_rgb(pixel, min(part, vec3f(1.0)));
}

@compute @workgroup_size(8, 8)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy;
    if !inputs_is_inside(pixel) {
        return;
    }
    let receiver = inputs_load_receiver(pixel);
    if receiver.is_background || !receiver.is_reached {
        inputs_write_visibility(pixel, select(0.0, 1.0, receiver.is_background));
        return;
    }
    let start = start_of(receiver);
    let shift = select(vec2f(), noise_shift_of_pixel(pixel), traversal_rays.rotate == 1u);
    traversal_turns_left = traversal_rays.max_iterations;
    var seen = vec3f();
    var sum = 0.0;
    let point_count = traversal_rays.point_count;
    for (var i = 0u; i < point_count; i++) {
        let point = point_of(traversal_rays.first_point + i, shift, start.x);
        var weight = point.weight;
        if traversal_rays.weighs_irradiance == 1u {
            weight *= given_to(start, point.at);
        }
        seen += weight * with_earlier(pixel, i, visibility_of(start, point.at));
        sum += weight;
        if traversal_turns_left == 0u {
            break;
        }
    }
    if traversal_rays.is_last_group == 0u {
        return;
    }
    if traversal_rays.weighs_irradiance == 1u {
        add_irradiance(pixel, seen, sum);
    }
    else {
        add(pixel, traversal_rays.share * seen / max(sum, 1e-20));
    }
}

const caster_surface_COVERAGE_WHOLE: u32 = 0u;

const caster_surface_COVERAGE_ALPHA: u32 = 1u;

fn caster_surface_coverage_of(coverage: u32, cutoff: f32, alpha: f32) -> f32 {
    switch coverage {
        case caster_surface_COVERAGE_WHOLE {
            return 1.0;
        }
        case caster_surface_COVERAGE_ALPHA {
            return saturate(alpha);
        }
        case default {
            return select(0.0, 1.0, alpha >= cutoff);
        }
    }
}

fn caster_surface_stopped_light(coverage: u32, cutoff: f32, value: vec4f) -> vec3f {
    return caster_surface_coverage_of(coverage, cutoff, value.a) * (1.0 - saturate(value.rgb));
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

const depth_error_ROUNDING = 4.76837158203125e-7;

fn depth_error_displacement_by_depth(clip_z_row: vec4f, clip_w_row: vec4f, pos_in_world: vec3f, along: vec3f) -> vec3f {
    let at = vec2f(dot(clip_z_row, vec4f(pos_in_world, 1.0)), dot(clip_w_row, vec4f(pos_in_world, 1.0)));
    let step = vec2f(dot(clip_z_row.xyz, along), dot(clip_w_row.xyz, along));
    let depth_per_step = (step.x * at.y - at.x * step.y) / (at.y * at.y);
    return along * (depth_error_ROUNDING / max(abs(depth_per_step), 1e-30));
}

fn depth_error_corner_depth(clip_z_row: vec4f, clip_w_row: vec4f, corner: vec3f) -> f32 {
    let z = dot(clip_z_row, vec4f(corner, 1.0));
    let w = dot(clip_w_row, vec4f(corner, 1.0));
    return select(1.0, z / w, z >= 0.0 && z <= w && w > 0.0);
}

fn depth_error_largest_depth(clip_z_row: vec4f, clip_w_row: vec4f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let depth_a = depth_error_corner_depth(clip_z_row, clip_w_row, a);
    let depth_b = depth_error_corner_depth(clip_z_row, clip_w_row, b);
    let depth_c = depth_error_corner_depth(clip_z_row, clip_w_row, c);
    return max(depth_a, max(depth_b, depth_c));
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

@group(0) @binding(5)
var<storage, read> inputs_light_data: array<vec4f>;

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

fn inputs_is_inside(pixel: vec2u) -> bool {
    return all(pixel < inputs_receiver_view.size_px);
}

fn inputs_are_points() -> bool {
    return inputs_receiver_view.are_points == 1u;
}

fn inputs_eye_distance_m(pos_in_world: vec3f) -> f32 {
    return select(distance(pos_in_world, inputs_receiver_view.eye_in_world), 0.0, inputs_are_points());
}

fn inputs_depth_at(pixel: vec2u) -> f32 {
    return textureLoad(inputs_receiver_depth, inputs_receiver_view.origin_px + pixel, 0).x;
}

fn inputs_position_in_world(pixel: vec2u, depth: f32) -> vec3f {
    let ndc = (vec2f(pixel) + 0.5) / vec2f(inputs_receiver_view.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = inputs_receiver_view.view_from_clip * vec4f(ndc, depth, 1.0);
    return (inputs_receiver_view.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

fn inputs_snapped_m(snapped_px: f32, pos_in_world: vec3f) -> f32 {
    return inputs_snapped_at_w(snapped_px, abs(dot(inputs_receiver_view.clip_w_row, vec4f(pos_in_world, 1.0))));
}

fn inputs_snapped_at_w(snapped_px: f32, w: f32) -> f32 {
    return snapped_px * inputs_receiver_view.pixel_m_per_w * w;
}

const inputs_OFFSET_SNAPS = 1.5;

fn inputs_camera_ray(pos_in_world: vec3f) -> vec3f {
    let is_parallel = all(inputs_receiver_view.clip_w_row.xyz == vec3f());
    return select(pos_in_world - inputs_receiver_view.eye_in_world, -inputs_receiver_view.world_from_view[2].xyz, is_parallel);
}

fn inputs_depth_error_m(pos_in_world: vec3f) -> vec3f {
    if inputs_are_points() {
        return vec3f();
    }
    return depth_error_displacement_by_depth(inputs_receiver_view.clip_z_row, inputs_receiver_view.clip_w_row, pos_in_world, inputs_camera_ray(pos_in_world));
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

fn irradiance_facing_of_points(light: light_LightSource, x: vec3f) -> vec3f {
    if light.kind == light_KIND_SPHERE {
        return -normalize(light.center_in_world - x);
    }
    return light.axis_in_world;
}

fn irradiance_given_by_point(light: light_LightSource, facing: vec3f, normal: vec3f, d: vec3f) -> f32 {
    let inverse_squared = 1.0 / max(dot(d, d), 1e-30);
    let towards = sqrt(inverse_squared) * d;
    let arriving = max(dot(normal, towards), 0.0);
    let has_surface = light.kind != light_KIND_ELLIPSOID && light.kind != light_KIND_POINTS;
    let leaving = select(1.0, max(-dot(facing, towards), 0.0), has_surface);
    return arriving * leaving * inverse_squared;
}

const light_KIND_RECTANGLE = 0u;

const light_KIND_DISK = 1u;

const light_KIND_SPHERE = 2u;

const light_KIND_ELLIPSOID = 3u;

const light_KIND_SUN = 4u;

const light_KIND_POINTS = 5u;

const light_PI = 3.141592653589793;

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

fn light_disk_from_square(u: vec2f) -> vec2f {
    let p = 2.0 * u - 1.0;
    if all(p == vec2f()) {
        return vec2f();
    }
    var radius = p.y;
    var angle = 0.5 * light_PI - 0.25 * light_PI * (p.x / p.y);
    if abs(p.x) > abs(p.y) {
        radius = p.x;
        angle = 0.25 * light_PI * (p.y / p.x);
    }
    return radius * vec2f(cos(angle), sin(angle));
}

fn light_ball_from_cube(u: vec3f) -> vec3f {
    let cos_theta = 1.0 - 2.0 * u.x;
    let sin_theta = sqrt(max(1.0 - cos_theta * cos_theta, 0.0));
    return pow(u.z, 1.0 / 3.0) * vec3f(sin_theta * cos(2.0 * light_PI * u.y), sin_theta * sin(2.0 * light_PI * u.y), cos_theta);
}

fn light_light_point(light: light_LightSource, u: vec3f, x: vec3f) -> vec4f {
    let center = light.center_in_world;
    switch light.kind {
        case light_KIND_RECTANGLE {
            let offset = (2.0 * u.xy - 1.0) * vec2f(light.half_right, light.half_up);
            return vec4f(center + light.right_in_world * offset.x + light.up_in_world * offset.y, 1.0);
        }
        case light_KIND_DISK {
            let offset = light_disk_from_square(u.xy) * light.half_right;
            return vec4f(center + light.right_in_world * offset.x + light.up_in_world * offset.y, 1.0);
        }
        case light_KIND_SPHERE {
            let offset = light_disk_from_square(u.xy) * light.half_right;
            let towards = normalize(center - x);
            let across = cross(light.up_in_world, towards);
            let across_length = length(across);
            let right = select(light.right_in_world, across / max(across_length, 1e-20), across_length > 1e-6);
            return vec4f(center + right * offset.x + cross(towards, right) * offset.y, 1.0);
        }
        case light_KIND_ELLIPSOID {
            let p = light_ball_from_cube(u) * vec3f(light.half_right, light.half_up, light.half_axis);
            return vec4f(center + light.right_in_world * p.x + light.up_in_world * p.y + light.axis_in_world * p.z, 1.0);
        }
        case default {
            let offset = light_disk_from_square(u.xy) * light.half_right;
            return vec4f(light.right_in_world * offset.x + light.up_in_world * offset.y - light.axis_in_world, 0.0);
        }
    }
}

fn light_emission_index(light: light_LightSource, u: vec2f) -> u32 {
    let size = light.emission_size;
    let column = min(u32(u.x * f32(size.x)), size.x - 1u);
    let row = min(u32((1.0 - u.y) * f32(size.y)), size.y - 1u);
    return row * size.x + column;
}

@group(0) @binding(6)
var noise_noise_tile: texture_2d<f32>;

const noise_TILE_SIDE: u32 = 64;

fn noise_blue_noise(pixel: vec2u) -> f32 {
    return (255.0 * textureLoad(noise_noise_tile, pixel % noise_TILE_SIDE, 0).x + 0.5) / 256.0;
}

const noise_SECOND_TILE_X: u32 = 29;

const noise_SECOND_TILE_Y: u32 = 41;

fn noise_shift_of_pixel(pixel: vec2u) -> vec2f {
    return vec2f(noise_blue_noise(pixel), noise_blue_noise(pixel + vec2u(noise_SECOND_TILE_X, noise_SECOND_TILE_Y)));
}

const ray_offset_ROUNDING = 3.814697265625e-6;

fn ray_offset_ray_offset_from(pos_in_world: vec3f, snapped_texels: f32, matrix_rounding_m: f32) -> f32 {
    let rounding_m = ray_offset_ROUNDING * (length(pos_in_world) + inputs_eye_distance_m(pos_in_world));
    return rounding_m + inputs_OFFSET_SNAPS * inputs_snapped_m(snapped_texels, pos_in_world) + matrix_rounding_m;
}

const surfaces_MAX_TEXTURES: u32 = 12;

@group(2) @binding(0)
var surfaces_surface_0: texture_2d<f32>;

@group(2) @binding(1)
var surfaces_sampler_0: sampler;

@group(2) @binding(2)
var surfaces_surface_1: texture_2d<f32>;

@group(2) @binding(3)
var surfaces_sampler_1: sampler;

@group(2) @binding(4)
var surfaces_surface_2: texture_2d<f32>;

@group(2) @binding(5)
var surfaces_sampler_2: sampler;

@group(2) @binding(6)
var surfaces_surface_3: texture_2d<f32>;

@group(2) @binding(7)
var surfaces_sampler_3: sampler;

@group(2) @binding(8)
var surfaces_surface_4: texture_2d<f32>;

@group(2) @binding(9)
var surfaces_sampler_4: sampler;

@group(2) @binding(10)
var surfaces_surface_5: texture_2d<f32>;

@group(2) @binding(11)
var surfaces_sampler_5: sampler;

@group(2) @binding(12)
var surfaces_surface_6: texture_2d<f32>;

@group(2) @binding(13)
var surfaces_sampler_6: sampler;

@group(2) @binding(14)
var surfaces_surface_7: texture_2d<f32>;

@group(2) @binding(15)
var surfaces_sampler_7: sampler;

@group(2) @binding(16)
var surfaces_surface_8: texture_2d<f32>;

@group(2) @binding(17)
var surfaces_sampler_8: sampler;

@group(2) @binding(18)
var surfaces_surface_9: texture_2d<f32>;

@group(2) @binding(19)
var surfaces_sampler_9: sampler;

@group(2) @binding(20)
var surfaces_surface_10: texture_2d<f32>;

@group(2) @binding(21)
var surfaces_sampler_10: sampler;

@group(2) @binding(22)
var surfaces_surface_11: texture_2d<f32>;

@group(2) @binding(23)
var surfaces_sampler_11: sampler;

fn surfaces_sample_surface(slot: u32, uv: vec2f) -> vec4f {
    switch slot {
        case 0u {
            return textureSampleLevel(surfaces_surface_0, surfaces_sampler_0, uv, 0.0);
        }
        case 1u {
            return textureSampleLevel(surfaces_surface_1, surfaces_sampler_1, uv, 0.0);
        }
        case 2u {
            return textureSampleLevel(surfaces_surface_2, surfaces_sampler_2, uv, 0.0);
        }
        case 3u {
            return textureSampleLevel(surfaces_surface_3, surfaces_sampler_3, uv, 0.0);
        }
        case 4u {
            return textureSampleLevel(surfaces_surface_4, surfaces_sampler_4, uv, 0.0);
        }
        case 5u {
            return textureSampleLevel(surfaces_surface_5, surfaces_sampler_5, uv, 0.0);
        }
        case 6u {
            return textureSampleLevel(surfaces_surface_6, surfaces_sampler_6, uv, 0.0);
        }
        case 7u {
            return textureSampleLevel(surfaces_surface_7, surfaces_sampler_7, uv, 0.0);
        }
        case 8u {
            return textureSampleLevel(surfaces_surface_8, surfaces_sampler_8, uv, 0.0);
        }
        case 9u {
            return textureSampleLevel(surfaces_surface_9, surfaces_sampler_9, uv, 0.0);
        }
        case 10u {
            return textureSampleLevel(surfaces_surface_10, surfaces_sampler_10, uv, 0.0);
        }
        case 11u {
            return textureSampleLevel(surfaces_surface_11, surfaces_sampler_11, uv, 0.0);
        }
        case default {
            return vec4f(1.0);
        }
    }
}

const instance_INSTANCE_VECTORS: u32 = 7;

const instance_IS_FLAT = 1u;

const instance_CASTER_VECTORS: u32 = 3;

const instance_FLAG_CLOSED: u32 = 1;

const instance_FLAG_OPEN: u32 = 2;

struct traversal_RayBatch {
    first_point: u32,
    point_count: u32,
    share: f32,
    bias_scale: f32,
    all_points: u32,
    instance_count: u32,
    texture_group: u32,
    is_last_group: u32,
    rotate: u32,
    max_iterations: u32,
    passed_stride: u32,
    weighs_irradiance: u32
}

@group(1) @binding(0)
var<uniform> traversal_rays: traversal_RayBatch;

@group(1) @binding(1)
var<storage, read> traversal_tables: array<vec4u>;

@group(1) @binding(2)
var<storage, read> traversal_top_nodes: array<vec4u>;

@group(1) @binding(3)
var<storage, read> traversal_instances: array<vec4u>;

@group(1) @binding(4)
var<storage, read> traversal_nodes: array<vec4u>;

@group(1) @binding(5)
var<storage, read> traversal_triangles: array<vec4u>;

struct traversal_Segment {
    start: vec3f,
    along: vec3f
}

struct traversal_ShadowSegments {
    closed: traversal_Segment,
    open: traversal_Segment,
    inverse_end: f32,
    depth_error_m: vec3f
}

struct traversal_BoxRay {
    start: vec3f,
    inverse: vec3f,
    margin: vec3f,
    end: f32
}

const traversal_FARTHEST = 3e38;

fn traversal_inverse_of(along: vec3f) -> vec3f {
    return 1.0 / select(along, select(vec3f(1e-20), vec3f(-1e-20), along < vec3f()), abs(along) < vec3f(1e-20));
}

fn traversal_meets(ray: traversal_BoxRay, low: vec3f, high: vec3f) -> bool {
    let a = (low - ray.margin - ray.start) * ray.inverse;
    let b = (high + ray.margin - ray.start) * ray.inverse;
    let nearer = min(a, b);
    let farther = max(a, b);
    let enters = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
    let leaves = min(min(farther.x, farther.y), min(farther.z, ray.end));
    return enters <= leaves;
}

const traversal_ROUNDING = 2e-6;

fn traversal_world_ray(segment: traversal_Segment, end: f32, offset_m: f32) -> traversal_BoxRay {
    let margin = traversal_ROUNDING * (abs(segment.start) + abs(segment.along)) + offset_m;
    return traversal_BoxRay(segment.start, traversal_inverse_of(segment.along), margin, end);
}

struct traversal_MeshWalk {
    node: u32,
    end: u32,
    caster: u32,
    first_node: u32,
    is_flat: bool,
    is_closed: bool,
    ray: traversal_BoxRay,
    to_world_x: vec4f,
    to_world_y: vec4f,
    to_world_z: vec4f
}

fn traversal_no_walk() -> traversal_MeshWalk {
    var walk: traversal_MeshWalk;
    return walk;
}

fn traversal_row(at: u32) -> vec4f {
    return bitcast<vec4f>(traversal_instances[at]);
}

fn traversal_frame_at(first_node: u32) -> nodes_Box {
    return nodes_Box(bitcast<vec3f>(traversal_nodes[first_node].xyz), bitcast<vec3f>(traversal_nodes[first_node + 1u].xyz));
}

fn traversal_ray_in_steps(segment: traversal_Segment, instance: u32, frame: nodes_Box, end: f32) -> traversal_BoxRay {
    let step = nodes_step_of(frame);
    let largest = max(abs(frame.low), abs(frame.high));
    var start: vec3f;
    var along: vec3f;
    var margin: vec3f;
    for (var k = 0u; k < 3u; k++) {
        let to_object = traversal_row(instance + k);
        start[k] = dot(to_object.xyz, segment.start) + to_object.w;
        along[k] = dot(to_object.xyz, segment.along);
        margin[k] = dot(abs(to_object.xyz), abs(segment.start) + abs(segment.along)) + abs(to_object.w) + largest[k];
    }
    return traversal_BoxRay((start - frame.low) / step, traversal_inverse_of(along / step), traversal_ROUNDING * margin / step, end);
}

fn traversal_entered(sight: traversal_ShadowSegments, number: u32, end: f32) -> traversal_MeshWalk {
    let instance = instance_INSTANCE_VECTORS * number;
    let info = traversal_instances[instance + 6u];
    let caster = traversal_rays.all_points + instance_CASTER_VECTORS * info.x;
    let mesh = traversal_tables[caster];
    if traversal_tables[caster + 2u].w != traversal_rays.texture_group {
        return traversal_no_walk();
    }
    let is_closed = (mesh.x & instance_FLAG_CLOSED) != 0u;
    let is_flat = (info.y & instance_IS_FLAT) != 0u;
    var segment = sight.open;
    if is_closed {
        segment = sight.closed;
    }
    let frame = traversal_frame_at(mesh.y);
    var ray: traversal_BoxRay;
    if is_flat {
        ray = traversal_world_ray(segment, end, 0.0);
    }
    else {
        ray = traversal_ray_in_steps(segment, instance, frame, end);
    }
    let root = traversal_nodes[mesh.y + 2u].w;
    return traversal_MeshWalk(0u, select(root, 1u, nodes_is_leaf(root)), caster, mesh.y + 2u, is_flat, is_closed, ray, traversal_row(instance + 3u), traversal_row(instance + 4u), traversal_row(instance + 5u));
}

fn traversal_meets_node(walk: traversal_MeshWalk, packed: vec3u) -> bool {
    let low = nodes_unpacked_low(packed);
    let high = nodes_unpacked_high(packed);
    if !walk.is_flat {
        return traversal_meets(walk.ray, low, high);
    }
    let frame = traversal_frame_at(walk.first_node - 2u);
    let step = nodes_step_of(frame);
    let middle = vec4f(frame.low + step * (0.5 * low + 0.5 * high), 1.0);
    let half = vec4f(step * 0.5 * (high - low), 0.0);
    let at = traversal_in_world(walk, middle);
    let across = vec3f(dot(abs(walk.to_world_x), half + traversal_ROUNDING * abs(middle)), dot(abs(walk.to_world_y), half + traversal_ROUNDING * abs(middle)), dot(abs(walk.to_world_z), half + traversal_ROUNDING * abs(middle)));
    return traversal_meets(walk.ray, at - across, at + across);
}

fn traversal_in_world(walk: traversal_MeshWalk, pos_in_object: vec4f) -> vec3f {
    return vec3f(dot(walk.to_world_x, pos_in_object), dot(walk.to_world_y, pos_in_object), dot(walk.to_world_z, pos_in_object));
}

fn traversal_corner_in_world(walk: traversal_MeshWalk, words: vec4u) -> vec3f {
    return traversal_in_world(walk, vec4f(bitcast<vec3f>(words.xyz), 1.0));
}

fn traversal_passes_surface(caster: u32, at: u32, values: vec3f) -> vec3f {
    let surface = traversal_tables[caster + 2u];
    var value = bitcast<vec4f>(traversal_tables[caster + 1u]);
    if surface.z < surfaces_MAX_TEXTURES {
        let weights = values / max(values.x + values.y + values.z, 1e-37);
        let rest = bitcast<vec4f>(traversal_triangles[at + 3u]);
        let uv = weights.x * bitcast<vec2f>(vec2u(traversal_triangles[at + 1u].w, traversal_triangles[at + 2u].w)) + weights.y * rest.xy + weights.z * rest.zw;
        value *= surfaces_sample_surface(surface.z, uv);
    }
    return 1.0 - caster_surface_stopped_light(surface.y, bitcast<f32>(surface.x), value);
}

fn traversal_passes_triangle(sight: traversal_ShadowSegments, walk: traversal_MeshWalk, at: u32) -> vec3f {
    var segment = sight.open;
    if walk.is_closed {
        segment = sight.closed;
    }
    let corner_a = traversal_corner_in_world(walk, traversal_triangles[at]);
    let corner_b = traversal_corner_in_world(walk, traversal_triangles[at + 1u]);
    let corner_c = traversal_corner_in_world(walk, traversal_triangles[at + 2u]);
    let a = corner_a - segment.start;
    let b = corner_b - segment.start;
    let c = corner_c - segment.start;
    let n = cross(corner_b - corner_a, corner_c - corner_a);
    if !(dot(n, n) > 0.0) {
        return vec3f(1.0);
    }
    let height = dot(a, n);
    var side = sign(height);
    let away = dot(sight.depth_error_m, n);
    if !walk.is_closed && abs(height) <= abs(away) {
        let largest = depth_error_largest_depth(inputs_receiver_view.clip_z_row, inputs_receiver_view.clip_w_row, corner_a, corner_b, corner_c);
        side = select(side, sign(away), abs(height) <= largest * abs(away));
    }
    if side == 0.0 || (walk.is_closed && height > 0.0) {
        return vec3f(1.0);
    }
    let d = side * segment.along;
    if !(abs(height) * sight.inverse_end < dot(n, d)) {
        return vec3f(1.0);
    }
    let values = vec3f(dot(cross(corner_b - corner_c, b + c), d), dot(cross(corner_c - corner_a, c + a), d), dot(cross(corner_a - corner_b, a + b), d));
    if !(min(values.x, min(values.y, values.z)) >= 0.0) {
        return vec3f(1.0);
    }
    if (traversal_tables[walk.caster].x & instance_FLAG_OPEN) == 0u {
        return vec3f();
    }
    return traversal_passes_surface(walk.caster, at, values);
}

var<private> traversal_turns_left: u32;

fn traversal_top_node_count() -> u32 {
    if traversal_rays.instance_count == 0u {
        return 0u;
    }
    let root = traversal_top_nodes[2u].w;
    return select(root, 1u, nodes_is_leaf(root));
}

fn traversal_passes(sight: traversal_ShadowSegments, offset_m: f32) -> vec3f {
    var passed = vec3f(1.0);
    let end = select(1.0, traversal_FARTHEST, sight.inverse_end == 0.0);
    let top_ray = traversal_world_ray(sight.open, end, offset_m);
    let top_count = traversal_top_node_count();
    let max_iterations = traversal_turns_left;
    var tests = 0u;
    var turns = 0u;
    var top = 0u;
    var walk = traversal_no_walk();
    for (var turn = 0u; turn < max_iterations; turn++) {
        turns = turn + 1u;
        if turns + tests >= max_iterations {
            break;
        }
        if walk.node < walk.end {
            let node = traversal_nodes[walk.first_node + walk.node];
            let is_met = traversal_meets_node(walk, node.xyz);
            walk.node = select(node.w, walk.node + 1u, is_met || nodes_is_leaf(node.w));
            if is_met && nodes_is_leaf(node.w) {
                let mesh = traversal_tables[walk.caster];
                let count = nodes_count_of_leaf(node.w);
                tests += count;
                for (var k = 0u; k < min(count, 64u); k++) {
                    passed *= traversal_passes_triangle(sight, walk, mesh.z + mesh.w * (nodes_first_of_leaf(node.w) + k));
                }
                if all(passed <= vec3f()) {
                    break;
                }
            }
            continue;
        }
        if top >= top_count {
            break;
        }
        let first = traversal_top_nodes[2u + 2u * top];
        let second = traversal_top_nodes[3u + 2u * top];
        let is_met = traversal_meets(top_ray, bitcast<vec3f>(first.xyz), bitcast<vec3f>(second.xyz));
        top = select(first.w, top + 1u, is_met || nodes_is_leaf(first.w));
        if is_met && nodes_is_leaf(first.w) {
            walk = traversal_entered(sight, second.w, end);
        }
    }
    traversal_turns_left = max_iterations - min(turns + tests, max_iterations);
    return passed;
}

const nodes_LEAF = 2147483648u;

const nodes_COUNT_SHIFT = 25u;

const nodes_COUNT_MASK = 63u;

const nodes_FIRST_MASK: u32 = 33554431;

fn nodes_is_leaf(word: u32) -> bool {
    return (word & nodes_LEAF) != 0u;
}

fn nodes_first_of_leaf(word: u32) -> u32 {
    return word & nodes_FIRST_MASK;
}

fn nodes_count_of_leaf(word: u32) -> u32 {
    return ((word >> nodes_COUNT_SHIFT) & nodes_COUNT_MASK) + 1u;
}

struct nodes_Box {
    low: vec3f,
    high: vec3f
}

const nodes_STEPS = 65535.0;

fn nodes_step_of(frame: nodes_Box) -> vec3f {
    let size = max(abs(frame.low), abs(frame.high));
    let largest = max(size.x, max(size.y, size.z));
    return max(frame.high - frame.low, vec3f(max(1e-6 * largest, 1e-30))) / nodes_STEPS;
}

fn nodes_unpacked_low(packed: vec3u) -> vec3f {
    return vec3f(f32(packed.x & 65535u), f32(packed.x >> 16u), f32(packed.y & 65535u));
}

fn nodes_unpacked_high(packed: vec3u) -> vec3f {
    return vec3f(f32(packed.y >> 16u), f32(packed.z & 65535u), f32(packed.z >> 16u));
}
