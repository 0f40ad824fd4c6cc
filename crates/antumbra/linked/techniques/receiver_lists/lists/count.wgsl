// Linked from src/techniques/receiver_lists/lists/count.wesl by `cargo xtask shaders`: edit that, not this.

fn make_shaft() {
    var low = vec3f();
    var high = vec3f();
    for (var axis = 0u; axis < 3u; axis++) {
        low[axis] = settings_unsortable(~atomicLoad(&bindings_state[settings_STATE_WORLD_MIN + axis]));
        high[axis] = settings_unsortable(atomicLoad(&bindings_state[settings_STATE_WORLD_MAX + axis]));
    }
    if atomicLoad(&bindings_state[settings_STATE_WORLD_MAX]) == 0u {
        for (var i = 0u; i < shaft_SHAFT_PLANES; i++) {
            bindings_shaft[i] = vec4f(0.0, 0.0, 0.0, -1.0);
        }
        return;
    }
    let room = 4.0 * ray_offset_max_ray_offset_m(bindings_settings, low, high);
    let asked = shaft_Box(low - room, high + room);
    var light = shaft_Box(bindings_settings.light_min, bindings_settings.light_max);
    if inputs_light_source.kind == light_KIND_SUN {
        let all = shaft_union_of(asked, shaft_Box(bindings_settings.casters_min, bindings_settings.casters_max));
        let far = 1.01 * distance(all.low, all.high);
        light = shaft_Box(asked.low + far * light.low, asked.high + far * light.high);
    }
    for (var i = 0u; i < shaft_SHAFT_PLANES; i++) {
        bindings_shaft[i] = shaft_shaft_plane(i, asked, light);
    }
    bindings_shaft[shaft_SHAFT_PLANES] = vec4f(asked.low, 0.0);
    bindings_shaft[shaft_SHAFT_PLANES + 1u] = vec4f(asked.high, 0.0);
    bindings_shaft[shaft_SHAFT_PLANES + 2u] = vec4f(light.low, 0.0);
    bindings_shaft[shaft_SHAFT_PLANES + 3u] = vec4f(light.high, 0.0);
}

override IS_AGAIN: bool = false;

@compute @workgroup_size(8, 8)
fn count(@builtin(global_invocation_id) id: vec3u) {
    if IS_AGAIN {
        if !bindings_is_by_cells() {
            return;
        }
    }
    else if all(id.xy == vec2u(0u)) {
        make_shaft();
    }
    if !inputs_is_inside(id.xy) {
        return;
    }
    let pixel_index = id.y * inputs_receiver_view.size_px.x + id.x;
    let receiver = inputs_load_receiver(id.xy);
    let is_among = select(bindings_is_asked(id.xy), bindings_places[pixel_index].x != settings_NOWHERE, IS_AGAIN);
    if !is_among || !bindings_is_listed(receiver) {
        bindings_places[pixel_index] = vec2u(settings_NOWHERE, 0u);
        return;
    }
    let list = bindings_list_of(receiver.pos_in_world);
    let place = atomicAdd(&bindings_counts[list], 1u);
    bindings_places[pixel_index] = vec2u(list, place);
    if !IS_AGAIN && bindings_settings.window_count > 0u {
        atomicMax(&bindings_state[settings_STATE_LONGEST], place + 1u);
        if settings_is_on(bindings_settings, settings_CHOOSES) && place % settings_CROWD == settings_CROWD - 1u {
            atomicAdd(&bindings_state[settings_STATE_CROWDED], 1u);
        }
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

fn ray_offset_max_ray_offset_m(settings: settings_SampleSettings, low: vec3f, high: vec3f) -> f32 {
    let across = distance(low, high);
    let distances = length(max(abs(low), abs(high))) + across + inputs_eye_distance_m(low);
    let row = inputs_receiver_view.clip_w_row;
    let most_w = abs(dot(row, vec4f(low, 1.0))) + length(row.xyz) * across;
    return max(settings.ray_offset_scale, 1.0) * (ray_offset_ROUNDING * distances + inputs_OFFSET_SNAPS * inputs_snapped_at_w(ray_offset_snapped_texels, most_w) + settings.matrix_rounding_m);
}

@group(1) @binding(0)
var<uniform> bindings_settings: settings_SampleSettings;

@group(1) @binding(1)
var<storage, read_write> bindings_state: array<atomic<u32>>;

@group(1) @binding(2)
var<storage, read_write> bindings_counts: array<atomic<u32>>;

@group(1) @binding(3)
var<storage, read_write> bindings_places: array<vec2u>;

@group(1) @binding(5)
var<storage, read_write> bindings_shaft: array<vec4f>;

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

fn bindings_is_by_cells() -> bool {
    return bindings_settings.window_count == 0u || atomicLoad(&bindings_counts[bindings_settings.list_count + 1u]) == 1u;
}

fn bindings_list_of(x: vec3f) -> u32 {
    if !bindings_is_by_cells() {
        return bindings_list_in_windows(x);
    }
    var low = vec3f();
    var high = vec3f();
    for (var axis = 0u; axis < 3u; axis++) {
        low[axis] = settings_unsortable(~atomicLoad(&bindings_state[settings_STATE_LIGHT_MIN + axis]));
        high[axis] = settings_unsortable(atomicLoad(&bindings_state[settings_STATE_LIGHT_MAX + axis]));
    }
    return projection_cell_in(projection_project(bindings_settings, inputs_light_source, x), low, high, bindings_settings.list_bits);
}

fn bindings_list_in_windows(x: vec3f) -> u32 {
    let p = windows_to_windows(bindings_settings, inputs_light_source, x);
    let index = windows_window_of(bindings_settings, p);
    let first = settings_STATE_WINDOWS + settings_STATE_WINDOW_LENGTH * index;
    let high = vec2f(settings_unsortable(atomicLoad(&bindings_state[first])), settings_unsortable(atomicLoad(&bindings_state[first + 1u])));
    let low = vec2f(settings_unsortable(~atomicLoad(&bindings_state[first + 2u])), settings_unsortable(~atomicLoad(&bindings_state[first + 3u])));
    let window = windows_window_from(bindings_settings.window_side, low, high, 0.0, 0.0);
    let at = windows_texel_at(window, windows_direction_to(bindings_settings, windows_along_axes_of(index, p)));
    let texel = vec2u(clamp(at, vec2f(0.0), vec2f(f32(bindings_settings.window_side) - 1.0)));
    return (index * bindings_settings.window_side + texel.y) * bindings_settings.window_side + texel.x;
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

fn projection_cell_in(point: vec3f, low: vec3f, high: vec3f, bits: u32) -> u32 {
    var size = max(high - low, vec3f(1e-30));
    var part = clamp((point - low) / size, vec3f(0.0), vec3f(0.999999));
    var cell = 0u;
    for (var i = 0u; i < bits; i++) {
        var axis = select(0u, 1u, size.y > size.x);
        axis = select(axis, 2u, size.z > max(size.x, size.y));
        size[axis] *= 0.5;
        part[axis] *= 2.0;
        let is_upper = part[axis] >= 1.0;
        part[axis] -= select(0.0, 1.0, is_upper);
        cell = 2u * cell + select(0u, 1u, is_upper);
    }
    return cell;
}

struct windows_Window {
    low: vec2f,
    scale: vec2f,
    depth: f32,
    ray_offset: f32,
    reach: f32
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

fn windows_window_from(side: u32, low: vec2f, high: vec2f, depth: f32, ray_offset: f32) -> windows_Window {
    let reach = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let size = max(high - low, vec2f(0.0001 * reach + 1e-30));
    return windows_Window(low, f32(side) / size, depth, ray_offset, reach);
}

fn windows_texel_at(window: windows_Window, direction: vec2f) -> vec2f {
    return (direction - window.low) * window.scale;
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

const settings_STATE_LONGEST = 48u;

const settings_STATE_CROWDED = 50u;

const settings_CROWD = 64u;

const settings_SUBSET_ALL = 0u;

const settings_SUBSET_KNOWN = 1u;

const settings_SUBSET_MISSING = 2u;

const settings_NOWHERE = 4294967295u;

const settings_MISSING = 4294967294u;

fn settings_unsortable(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 2147483647u, bits >= 2147483648u));
}

const shaft_SHAFT_PLANES = 18u;

const shaft_SHAFT_SLACK = 2e-6;

struct shaft_Box {
    low: vec3f,
    high: vec3f
}

fn shaft_union_of(a: shaft_Box, b: shaft_Box) -> shaft_Box {
    return shaft_Box(min(a.low, b.low), max(a.high, b.high));
}

fn shaft_shaft_plane(index: u32, a: shaft_Box, b: shaft_Box) -> vec4f {
    var normal = vec3f();
    if index < 6u {
        normal[index / 2u] = select(-1.0, 1.0, (index & 1u) == 1u);
    }
    else {
        let pair = (index - 6u) / 4u;
        let first = select(0u, 1u, pair == 2u);
        let second = select(2u, 1u, pair == 0u);
        let sign_first = select(-1.0, 1.0, (index & 1u) == 1u);
        let sign_second = select(-1.0, 1.0, (index & 2u) == 2u);
        let step_first = select(b.low[first] - a.low[first], b.high[first] - a.high[first], sign_first > 0.0);
        let step_second = select(b.low[second] - a.low[second], b.high[second] - a.high[second], sign_second > 0.0);
        normal[first] = sign_first * abs(step_second);
        normal[second] = sign_second * abs(step_first);
    }
    let corner_a = select(a.low, a.high, normal > vec3f(0.0));
    let corner_b = select(b.low, b.high, normal > vec3f(0.0));
    let terms = dot(abs(normal), max(abs(corner_a), abs(corner_b)));
    return vec4f(normal, max(dot(normal, corner_a), dot(normal, corner_b)) + shaft_SHAFT_SLACK * terms);
}
