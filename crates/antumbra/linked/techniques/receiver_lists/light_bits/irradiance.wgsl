// Linked from src/techniques/receiver_lists/light_bits/irradiance.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(0)
var<uniform> settings: settings_SampleSettings;

@group(1) @binding(1)
var<storage, read> bits: array<u32>;

@group(1) @binding(2)
var<storage, read> places: array<vec2u>;

@group(1) @binding(3)
var<storage, read> emitters: array<vec4f>;

fn passed_by_tints(pixel: vec2u, open_weight: f32) -> vec3f {
    if settings.first_passed == 0u {
        return vec3f(1.0);
    }
    return saturate(inputs_read_visibility_rgb(pixel) * (settings.total_weight / max(open_weight, 1e-20)));
}

@compute @workgroup_size(8, 8)
fn irradiance(@builtin(global_invocation_id) id: vec3u) {
    if !inputs_is_inside(id.xy) {
        return;
    }
    let pixel_index = id.y * inputs_receiver_view.size_px.x + id.x;
    if places[pixel_index].x == settings_NOWHERE {
        return;
    }
    let receiver = inputs_load_receiver(id.xy);
    let x = receiver.pos_in_world;
    let rays = points_rays_from(settings, inputs_light_source, x, x, noise_noise_of_pixel(id.xy));
    let first_word = pixel_index * settings.pixel_words;
    var all = vec4f();
    var seen = vec4f();
    var open_weight = 0.0;
    for (var i = 0u; i < settings.point_count; i++) {
        let place = emitters[2u * i];
        let emission = vec4f(emitters[2u * i + 1u].rgb, place.w);
        let d = rays.to_center + place.x * rays.right + place.y * rays.up + place.z * rays.axis;
        let given = irradiance_given_by_point(inputs_light_source, rays.axis, receiver.normal_in_world, d) * emission;
        let open = f32((bits[first_word + i / 32u] >> (i & 31u)) & 1u);
        all += given;
        seen += open * given;
        open_weight += open * place.w;
    }
    let parts = select(vec4f(0.0), seen / max(all, vec4f(1e-37)), all > vec4f(0.0));
    let has_channel = (all.rgb > vec3f(0.0)) & vec3<bool>(inputs_receiver_view.mask_layers >= 3u);
    let arriving = select(vec3f(parts.w), parts.rgb, has_channel);
    inputs_write_visibility_rgb(id.xy, min(arriving, vec3f(1.0)) * passed_by_tints(id.xy, open_weight));
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

const settings_NOWHERE = 4294967295u;
