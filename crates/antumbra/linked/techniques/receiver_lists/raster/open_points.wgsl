// Linked from src/techniques/receiver_lists/raster/open_points.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(1)
var<storage, read> list: array<u32>;

@group(1) @binding(6)
var<storage, read> totals: array<u32>;

@compute @workgroup_size(64)
fn raster_before(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let slot = runs_thread_index(id, group_counts);
    if slot >= totals[settings_TOTAL_LISTED] {
        return;
    }
    let pixel_index = list[slot];
    let pixel = bits_pixel_of(pixel_index);
    let receiver = inputs_load_receiver(pixel);
    let sight = sight_shadow_segments_of(bits_settings, pixel, receiver);
    let plane = points_plane_for(sight_rays_of(sight, true), receiver.normal_in_world);
    let first_word = bits_first_word_of(pixel_index);
    for (var word = 0u; word < bits_settings.word_count; word++) {
        open_bits_bits[first_word + word] = open_bits_in_front_of(plane, word);
    }
}

fn runs_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
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

const light_KIND_RECTANGLE = 0u;

const light_KIND_DISK = 1u;

const light_KIND_SPHERE = 2u;

const light_KIND_SUN = 4u;

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

@group(0) @binding(6)
var noise_noise_tile: texture_2d<f32>;

const noise_TILE_SIDE: u32 = 64;

fn noise_blue_noise(pixel: vec2u) -> f32 {
    return (255.0 * textureLoad(noise_noise_tile, pixel % noise_TILE_SIDE, 0).x + 0.5) / 256.0;
}

const noise_GOLDEN = 0.618033989;

fn noise_noise_of_pixel(pixel: vec2u) -> f32 {
    return fract(noise_blue_noise(pixel) + noise_GOLDEN * f32(inputs_receiver_view.noise_frame));
}

const ray_offset_ROUNDING = 3.814697265625e-6;

fn ray_offset_ray_offset_from(pos_in_world: vec3f, snapped_texels: f32, matrix_rounding_m: f32) -> f32 {
    let rounding_m = ray_offset_ROUNDING * (length(pos_in_world) + inputs_eye_distance_m(pos_in_world));
    return rounding_m + inputs_OFFSET_SNAPS * inputs_snapped_m(snapped_texels, pos_in_world) + matrix_rounding_m;
}

@group(1) @binding(0)
var<uniform> bits_settings: settings_SampleSettings;

@group(1) @binding(4)
var<uniform> bits_light_words: array<vec4f, settings_LIGHT_WORDS_LENGTH>;

override bits_IS_FLAT: bool = false;

fn bits_pixel_of(pixel_index: u32) -> vec2u {
    return vec2u(pixel_index % inputs_receiver_view.size_px.x, pixel_index / inputs_receiver_view.size_px.x);
}

fn bits_first_word_of(pixel_index: u32) -> u32 {
    return pixel_index * bits_settings.pixel_words + bits_settings.first_word;
}

fn bits_at_four(plane: vec4f, at: u32) -> vec4f {
    let across = plane.x + plane.y * bits_light_words[at] + plane.z * bits_light_words[at + 1u];
    if bits_IS_FLAT {
        return across;
    }
    return across + plane.w * bits_light_words[at + 2u];
}

fn bits_bits_of_four(is_set: vec4<bool>) -> u32 {
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), is_set);
    return bits.x | bits.y | bits.z | bits.w;
}

fn bits_in_front_of_four(plane: vec4f, at: u32) -> u32 {
    return bits_bits_of_four(bits_at_four(plane, at) > vec4f(0.0));
}

@group(1) @binding(5)
var<storage, read_write> open_bits_bits: array<u32>;

fn open_bits_in_front_of(plane: vec4f, word: u32) -> u32 {
    var in_front = 0u;
    for (var four = 0u; four < 8u; four++) {
        in_front |= bits_in_front_of_four(plane, settings_FIRST_POINT + 32u * word + 4u * four) << (4u * four);
    }
    let count = min(32u, bits_settings.point_count - 32u * word);
    return in_front & (4294967295u >> (32u - count));
}

const points_END_MARGIN = 9.5367431640625e-7;

struct points_Rays {
    to_center: vec3f,
    right: vec3f,
    up: vec3f,
    axis: vec3f,
    inverse_end: f32
}

fn points_turned(settings: settings_SampleSettings, noise: f32, right: vec3f, up: vec3f) -> mat2x3f {
    var part = noise;
    if settings.rotations > 1u {
        part = floor(noise * f32(settings.rotations)) / f32(settings.rotations);
    }
    let angle = 2.0 * light_PI * part;
    return mat2x3f(cos(angle) * right + sin(angle) * up, cos(angle) * up - sin(angle) * right);
}

fn points_to_center_from(light: light_LightSource, axis: vec3f, origin: vec3f) -> vec3f {
    return select(light.center_in_world - origin, -axis, light.kind == light_KIND_SUN);
}

fn points_inverse_end_of(light: light_LightSource) -> f32 {
    return select(1.0 + points_END_MARGIN, 0.0, light.kind == light_KIND_SUN);
}

fn points_rays_from(settings: settings_SampleSettings, light: light_LightSource, origin: vec3f, position: vec3f, noise: f32) -> points_Rays {
    var rays = points_Rays(points_to_center_from(light, light.axis_in_world, origin), light.right_in_world, light.up_in_world, light.axis_in_world, points_inverse_end_of(light));
    if light.kind == light_KIND_SPHERE {
        let towards = normalize(light.center_in_world - position);
        let across = cross(light.up_in_world, towards);
        let across_length = length(across);
        rays.right = select(light.right_in_world, across / max(across_length, 1e-20), across_length > 1e-6);
        rays.up = cross(towards, rays.right);
        rays.axis = -towards;
    }
    if settings.rotations > 0u {
        let frame = points_turned(settings, fract(noise + settings.turn), rays.right, rays.up);
        rays.right = frame[0];
        rays.up = frame[1];
    }
    return rays;
}

fn points_plane_for(rays: points_Rays, normal: vec3f) -> vec4f {
    return vec4f(dot(normal, rays.to_center), dot(normal, rays.right), dot(normal, rays.up), dot(normal, rays.axis));
}

@group(1) @binding(14)
var<uniform> ray_offset_snapped_texels: f32;

fn ray_offset_ray_offset_m(settings: settings_SampleSettings, pos_in_world: vec3f) -> f32 {
    return settings.ray_offset_scale * ray_offset_ray_offset_from(pos_in_world, ray_offset_snapped_texels, settings.matrix_rounding_m);
}

struct sight_ShadowSegments {
    right: vec3f,
    up: vec3f,
    axis: vec3f,
    x: vec3f,
    x_open: vec3f,
    depth_error_m: vec3f
}

fn sight_shadow_segments_from(settings: settings_SampleSettings, pixel: vec2u, x: vec3f, x_open: vec3f) -> sight_ShadowSegments {
    let rays = points_rays_from(settings, inputs_light_source, x, x, noise_noise_of_pixel(pixel));
    return sight_ShadowSegments(rays.right, rays.up, rays.axis, x, x_open, inputs_depth_error_m(x));
}

fn sight_shadow_segments_of(settings: settings_SampleSettings, pixel: vec2u, receiver: inputs_Receiver) -> sight_ShadowSegments {
    let x = receiver.pos_in_world;
    return sight_shadow_segments_from(settings, pixel, x, x + ray_offset_ray_offset_m(settings, x) * receiver.normal_in_world);
}

fn sight_origin_of(sight: sight_ShadowSegments, is_closed: bool) -> vec3f {
    return select(sight.x_open, sight.x, is_closed);
}

fn sight_rays_of(sight: sight_ShadowSegments, is_closed: bool) -> points_Rays {
    let to_center = points_to_center_from(inputs_light_source, sight.axis, sight_origin_of(sight, is_closed));
    return points_Rays(to_center, sight.right, sight.up, sight.axis, points_inverse_end_of(inputs_light_source));
}

struct settings_SampleSettings {
    light_min: vec3f,
    point_count: u32,
    light_max: vec3f,
    word_count: u32,
    casters_min: vec3f,
    list_bits: u32,
    casters_max: vec3f,
    projection: u32,
    total_weight: f32,
    switches: u32,
    cell_count: u32,
    list_count: u32,
    super_first: u32,
    is_weighted: u32,
    triangle_stride: u32,
    lookup_size: u32,
    first_word: u32,
    pixel_words: u32,
    rotations: u32,
    turn: f32,
    ray_offset_scale: f32,
    max_groups: u32,
    cells_across: u32,
    max_cells: u32,
    iterations_per_triangle: u32,
    max_iterations: u32,
    first_passed: u32,
    window_count: u32,
    window: u32,
    window_side: u32,
    receivers_per_instance: u32,
    subset: u32,
    window_right: vec3f,
    region_corners: u32,
    window_up: vec3f,
    matrix_rounding_m: f32,
    window_axis: vec3f,
    padding_1: u32,
    window_light_min: vec3f,
    padding_2: u32,
    window_light_max: vec3f,
    padding_3: u32,
    clip_z_row: vec4f,
    clip_w_row: vec4f
}

const settings_FIRST_POINT = 66u;

const settings_LIGHT_WORDS_LENGTH = 1090u;

const settings_TOTAL_LISTED = 0u;
