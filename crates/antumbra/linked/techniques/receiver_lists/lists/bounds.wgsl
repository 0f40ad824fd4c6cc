// Linked from src/techniques/receiver_lists/lists/bounds.wesl by `cargo xtask shaders`: edit that, not this.

var<workgroup> group_state: array<atomic<u32>, settings_STATE_LENGTH>;

fn bound_window(x: vec3f) {
    let p = windows_to_windows(bindings_settings, inputs_light_source, x);
    let index = windows_window_of(bindings_settings, p);
    let along = windows_along_axes_of(index, p);
    let direction = windows_direction_to(bindings_settings, along);
    let ray_offset = ray_offset_ray_offset_m(bindings_settings, x);
    let first = settings_STATE_WINDOWS + settings_STATE_WINDOW_LENGTH * index;
    for (var axis = 0u; axis < 2u; axis++) {
        atomicMax(&group_state[first + axis], settings_sortable(direction[axis]));
        atomicMax(&group_state[first + 2u + axis], ~settings_sortable(direction[axis]));
    }
    atomicMax(&group_state[first + 4u], settings_sortable(along.z + ray_offset));
    atomicMax(&group_state[first + 5u], settings_sortable(select(ray_offset / max(along.z, 1e-30), ray_offset, bindings_settings.projection == settings_PROJECT_PARALLEL)));
}

@compute @workgroup_size(8, 8)
fn bounds(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    if lane < settings_STATE_LENGTH {
        atomicStore(&group_state[lane], 0u);
    }
    workgroupBarrier();
    if inputs_is_inside(id.xy) && bindings_is_asked(id.xy) {
        let receiver = inputs_load_receiver(id.xy);
        if bindings_is_listed(receiver) {
            let x = receiver.pos_in_world;
            let as_seen = projection_project(bindings_settings, inputs_light_source, x);
            for (var axis = 0u; axis < 3u; axis++) {
                atomicMax(&group_state[settings_STATE_LIGHT_MAX + axis], settings_sortable(as_seen[axis]));
                atomicMax(&group_state[settings_STATE_LIGHT_MIN + axis], ~settings_sortable(as_seen[axis]));
                atomicMax(&group_state[settings_STATE_WORLD_MAX + axis], settings_sortable(x[axis]));
                atomicMax(&group_state[settings_STATE_WORLD_MIN + axis], ~settings_sortable(x[axis]));
            }
            if bindings_settings.window_count > 0u {
                bound_window(x);
            }
            if settings_is_on(bindings_settings, settings_CHOOSES) {
                atomicAdd(&group_state[settings_STATE_LISTED], 1u);
            }
        }
        else {
            inputs_write_visibility(id.xy, select(0.0, 1.0, receiver.is_background));
        }
    }
    workgroupBarrier();
    if lane == settings_STATE_LISTED {
        atomicAdd(&bindings_state[lane], atomicLoad(&group_state[lane]));
    }
    else if lane < settings_STATE_LENGTH {
        atomicMax(&bindings_state[lane], atomicLoad(&group_state[lane]));
    }
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

const ray_offset_ROUNDING = 3.814697265625e-6;

fn ray_offset_ray_offset_from(pos_in_world: vec3f, snapped_texels: f32, matrix_rounding_m: f32) -> f32 {
    let rounding_m = ray_offset_ROUNDING * (length(pos_in_world) + inputs_eye_distance_m(pos_in_world));
    return rounding_m + inputs_OFFSET_SNAPS * inputs_snapped_m(snapped_texels, pos_in_world) + matrix_rounding_m;
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

fn points_at_point(plane: vec4f, point: vec3f) -> f32 {
    return plane.x + plane.y * point.x + plane.z * point.y + plane.w * point.z;
}

fn points_reach_over(plane: vec4f, half_box: vec3f) -> f32 {
    return abs(plane.y) * half_box.x + abs(plane.z) * half_box.y + abs(plane.w) * half_box.z;
}

@group(1) @binding(14)
var<uniform> ray_offset_snapped_texels: f32;

fn ray_offset_ray_offset_m(settings: settings_SampleSettings, pos_in_world: vec3f) -> f32 {
    return settings.ray_offset_scale * ray_offset_ray_offset_from(pos_in_world, ray_offset_snapped_texels, settings.matrix_rounding_m);
}

@group(1) @binding(0)
var<uniform> bindings_settings: settings_SampleSettings;

@group(1) @binding(1)
var<storage, read_write> bindings_state: array<atomic<u32>>;

@group(1) @binding(3)
var<storage, read_write> bindings_places: array<vec2u>;

@group(1) @binding(6)
var<storage, read> bindings_light_points: array<vec4f>;

fn bindings_is_asked(pixel: vec2u) -> bool {
    switch bindings_settings.subset {
        case settings_SUBSET_ALL {
            return true;
        }
        case settings_SUBSET_KNOWN {
            return all(pixel % vec2u(inputs_receiver_view.pixel_stride) == vec2u(0u));
        }
        case settings_SUBSET_MISSING {
            return bindings_places[pixel.y * inputs_receiver_view.size_px.x + pixel.x].x == settings_MISSING;
        }
        case default {
            return false;
        }
    }
}

fn bindings_is_listed(receiver: inputs_Receiver) -> bool {
    if receiver.is_background || !receiver.is_reached {
        return false;
    }
    let x = receiver.pos_in_world;
    let rays = points_rays_from(bindings_settings, inputs_light_source, x, x, 0.0);
    let plane = points_plane_for(rays, receiver.normal_in_world);
    var half_box = bindings_light_points[1].xyz;
    if bindings_settings.rotations > 0u {
        half_box = vec3f(vec2f(length(half_box.xy)), half_box.z);
    }
    return points_at_point(plane, bindings_light_points[0].xyz) + points_reach_over(plane, half_box) > 0.0;
}

const projection_RADIANS_OF_MAP = 1.7724538509055159;

fn projection_to_light(light: light_LightSource, x: vec3f) -> vec3f {
    let p = x - light.center_in_world;
    return vec3f(dot(p, light.right_in_world), dot(p, light.up_in_world), dot(p, light.axis_in_world));
}

fn projection_project(settings: settings_SampleSettings, light: light_LightSource, x: vec3f) -> vec3f {
    let p = projection_to_light(light, x);
    if settings.projection == settings_PROJECT_SPHERE {
        let on_octahedron = p / max(abs(p.x) + abs(p.y) + abs(p.z), 1e-30);
        let signs = select(vec2f(-1.0), vec2f(1.0), on_octahedron.xy >= vec2f(0.0));
        let folded = (1.0 - abs(on_octahedron.yx)) * signs;
        let plane = select(folded, on_octahedron.xy, on_octahedron.z >= 0.0);
        return vec3f(projection_RADIANS_OF_MAP * plane, log(max(length(p), 1e-12)));
    }
    return p;
}

fn windows_to_windows(settings: settings_SampleSettings, light: light_LightSource, x: vec3f) -> vec3f {
    return windows_vector_to_windows(settings, x - light.center_in_world);
}

fn windows_vector_to_windows(settings: settings_SampleSettings, v: vec3f) -> vec3f {
    return vec3f(dot(v, settings.window_right), dot(v, settings.window_up), dot(v, settings.window_axis));
}

fn windows_along_axes_of(window: u32, p: vec3f) -> vec3f {
    var turned = p;
    if window / 2u == 1u {
        turned = p.yzx;
    }
    else if window / 2u == 2u {
        turned = p.zxy;
    }
    return vec3f(turned.xy, select(turned.z, -turned.z, (window & 1u) == 1u));
}

fn windows_window_of(settings: settings_SampleSettings, p: vec3f) -> u32 {
    if settings.window_count == 1u {
        return 0u;
    }
    let size = abs(p);
    if size.z >= max(size.x, size.y) {
        return select(0u, 1u, p.z < 0.0);
    }
    if size.x >= size.y {
        return select(2u, 3u, p.x < 0.0);
    }
    return select(4u, 5u, p.y < 0.0);
}

fn windows_direction_to(settings: settings_SampleSettings, p: vec3f) -> vec2f {
    return select(p.xy / max(p.z, 1e-30), p.xy, settings.projection == settings_PROJECT_PARALLEL);
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

const settings_PROJECT_SPHERE = 0u;

const settings_PROJECT_PARALLEL = 1u;

const settings_CHOOSES = 256u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_STATE_LIGHT_MAX = 0u;

const settings_STATE_LIGHT_MIN = 3u;

const settings_STATE_WORLD_MAX = 6u;

const settings_STATE_WORLD_MIN = 9u;

const settings_STATE_WINDOWS = 12u;

const settings_STATE_WINDOW_LENGTH = 6u;

const settings_STATE_LISTED = 49u;

const settings_STATE_LENGTH = 51u;

const settings_SUBSET_ALL = 0u;

const settings_SUBSET_KNOWN = 1u;

const settings_SUBSET_MISSING = 2u;

const settings_MISSING = 4294967294u;

fn settings_sortable(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 2147483648u, ~bits, bits >= 2147483648u);
}
