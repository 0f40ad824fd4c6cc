// Linked from src/techniques/filterable/lvsm/bleeding.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(1)
var<uniform> settings: source_FilterUniform;

@group(1) @binding(3)
var depth_map: texture_depth_2d;

@group(2) @binding(0)
var<uniform> receivers: histogram_LvsmHistogramUniform;

@group(2) @binding(1)
var<storage, read_write> histogram: array<atomic<u32>>;

const SIDE = 5u;

const TAP_COUNT = SIDE * SIDE;

fn bound_of(taps: array<f32, TAP_COUNT>, near: f32, t: f32, least_variance: f32) -> f32 {
    var held = taps;
    var sum = 0.0;
    var squares = 0.0;
    for (var i = 0u; i < TAP_COUNT; i++) {
        let off = max(held[i], near) - t;
        sum += off;
        squares += off * off;
    }
    let mean = sum / f32(TAP_COUNT);
    let variance = max(squares / f32(TAP_COUNT) - mean * mean, least_variance);
    return variance_chebyshev(mean, variance, 0.0);
}

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy * receivers.stride + receivers.stride / 2u;
    if !inputs_is_inside(pixel) {
        return;
    }
    let receiver = inputs_load_receiver(pixel);
    if receiver.is_background || !receiver.is_reached || !receiver_light_faces_light_center(receiver) {
        return;
    }
    let plane = receiver_light_biased_plane(receiver, settings.bias_scale);
    if !map_is_in_map(plane.uv) {
        return;
    }
    let t = source_t_at(map_light_view, settings, plane.uv, space_z_of_depth(map_light_view, plane.depth));
    var taps: array<f32, TAP_COUNT>;
    var second = 0.0;
    for (var i = 0u; i < TAP_COUNT; i++) {
        let place = (vec2f(f32(i % SIDE), f32(i / SIDE)) + 0.5) / f32(SIDE) - 0.5;
        let texel = map_texel_of_uv(plane.uv + place * receivers.kernel_size / map_light_view.map_size);
        let stored = textureLoad(depth_map, texel, 0);
        taps[i] = source_t_at(map_light_view, settings, map_uv_of_texel(texel), space_z_of_depth(map_light_view, stored));
        if map_light_view.depth_sign * (stored - space_plane_depth(map_light_view, plane, map_uv_of_texel(texel))) > 0.0 {
            second = max(second, min(taps[i], t));
        }
    }
    if second == 0.0 {
        return;
    }
    let split = min(second + receivers.overlap, t);
    let least_variance = 1e-6;
    let bleeding = bound_of(taps, 0.0, t, least_variance) - bound_of(taps, split - receivers.overlap, t, least_variance);
    let weight = u32(saturate(bleeding) * histogram_WEIGHT_SCALE + 0.5);
    if weight > 0u {
        atomicAdd(&histogram[min(u32(split * histogram_BIN_COUNT), u32(histogram_BIN_COUNT) - 1u)], weight);
    }
}

const bias_HALF_TEXEL = 0.5;

const bias_SNAPPED_TEXELS = 0.00390625;

fn bias_automatic_bias_m(texel_width_m: f32, grazing_sine: f32, bias_scale: f32) -> f32 {
    return bias_scale * texel_width_m * max(bias_HALF_TEXEL, bias_SNAPPED_TEXELS / grazing_sine);
}

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

fn map_is_in_map(uv: vec2f) -> bool {
    return all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
}

fn map_texel_of_uv(uv: vec2f) -> vec2i {
    return clamp(vec2i(floor(uv * map_light_view.map_size)), vec2i(0), vec2i(map_light_view.map_size) - 1);
}

fn map_uv_of_texel(texel: vec2i) -> vec2f {
    return (vec2f(texel) + 0.5) / map_light_view.map_size;
}

fn receiver_light_faces_light_center(receiver: inputs_Receiver) -> bool {
    let towards = select(inputs_light_source.center_in_world - receiver.pos_in_world, -inputs_light_source.axis_in_world, inputs_light_source.kind == light_KIND_SUN);
    return dot(receiver.normal_in_world, towards) > 0.0;
}

fn receiver_light_biased_plane(receiver: inputs_Receiver, bias_scale: f32) -> space_ReceiverPlane {
    return receiver_light_biased_plane_within(receiver, bias_scale, space_min_grazing_sine(map_light_view));
}

fn receiver_light_biased_plane_within(receiver: inputs_Receiver, bias_scale: f32, min_sine: f32) -> space_ReceiverPlane {
    let sine = max(space_grazing_sine(map_light_view, receiver.pos_in_world, receiver.normal_in_world), min_sine);
    let bias_m = bias_automatic_bias_m(space_texel_width_m(map_light_view, receiver.pos_in_world), sine, bias_scale);
    return space_receiver_plane_within(map_light_view, receiver.pos_in_world, receiver.normal_in_world, bias_m, min_sine);
}

struct space_LightViewGpu {
    origin_in_world: vec3f,
    perspective: u32,
    right_in_world: vec3f,
    depth_scale: f32,
    up_in_world: vec3f,
    depth_offset: f32,
    axis_in_world: vec3f,
    depth_sign: f32,
    uv_from_plane: vec4f,
    plane_from_uv: vec4f,
    uv_origin: vec2f,
    map_size: vec2f,
    near_m: f32,
    far_m: f32,
    texel_in_plane: f32,
    complete_from_m: f32,
    warp: vec2f,
    plane_center: vec2f
}

const space_MIN_GRAZING_SINE = 0.00390625;

const space_MIN_GRAZING_SINE_OF_PARALLEL = 0.0078;

fn space_min_grazing_sine(view: space_LightViewGpu) -> f32 {
    return select(space_MIN_GRAZING_SINE_OF_PARALLEL, space_MIN_GRAZING_SINE, view.perspective == 1u);
}

struct space_ReceiverPlane {
    uv: vec2f,
    depth: f32,
    depth_per_uv: vec2f,
    farthest_depth: f32,
    surface_step: f32,
    bias: f32,
    faces_away: bool
}

const space_SURFACE_SLOPE = 8.0;

fn space_light_from_world(view: space_LightViewGpu, x: vec3f) -> vec3f {
    let p = x - view.origin_in_world;
    return vec3f(dot(p, view.right_in_world), dot(p, view.up_in_world), dot(p, view.axis_in_world));
}

fn space_depth_of_z(view: space_LightViewGpu, z_m: f32) -> f32 {
    return view.depth_scale * select(z_m, 1.0 / z_m, view.perspective == 1u) + view.depth_offset;
}

fn space_texel_in_plane_at(view: space_LightViewGpu, from_center: vec2f) -> f32 {
    if !space_is_warped(view) {
        return view.texel_in_plane;
    }
    let w = 1.0 + dot(view.warp, from_center);
    let u = view.plane_from_uv.xy / view.map_size.x;
    let v = view.plane_from_uv.zw / view.map_size.y;
    return w * max(length(u + from_center * dot(view.warp, u)), length(v + from_center * dot(view.warp, v)));
}

fn space_uv_step_of_plane(view: space_LightViewGpu, step: vec2f) -> vec2f {
    return view.uv_from_plane.xy * step.x + view.uv_from_plane.zw * step.y;
}

fn space_is_warped(view: space_LightViewGpu) -> bool {
    return any(view.warp != vec2f());
}

fn space_warped_plane(view: space_LightViewGpu, uv: vec2f) -> vec2f {
    let from_origin = uv - view.uv_origin;
    return view.plane_from_uv.xy * from_origin.x + view.plane_from_uv.zw * from_origin.y;
}

fn space_receiver_plane_within(view: space_LightViewGpu, x: vec3f, normal_in_world: vec3f, bias_m: f32, min_sine: f32) -> space_ReceiverPlane {
    let p = space_light_from_world(view, x);
    let n = vec3f(dot(normal_in_world, view.right_in_world), dot(normal_in_world, view.up_in_world), dot(normal_in_world, view.axis_in_world));
    var plane: vec2f;
    var biased_z: f32;
    var depth_per_plane: vec2f;
    var faces_away: bool;
    if view.perspective == 1u {
        let distance = length(p);
        plane = p.xy / p.z;
        let toward = max(1.0 - bias_m / distance, 0.001);
        biased_z = p.z * toward;
        let k = dot(n, p) * toward;
        let k_min = min_sine * distance;
        depth_per_plane = view.depth_scale * n.xy / select(max(k, k_min), min(k, -k_min), k < 0.0);
        faces_away = k > 0.0;
    }
    else {
        plane = p.xy;
        biased_z = p.z - bias_m;
        let nz = select(max(n.z, min_sine), min(n.z, -min_sine), n.z < 0.0);
        depth_per_plane = -view.depth_scale * n.xy / nz;
        faces_away = n.z > 0.0;
    }
    let from_center = plane - view.plane_center;
    let divisor = 1.0 + dot(view.warp, from_center);
    let unwarped_depth = space_depth_of_z(view, biased_z);
    let bias = (unwarped_depth - space_depth_of_z(view, p.z)) / divisor;
    let texel_in_plane = space_texel_in_plane_at(view, from_center);
    let surface_step = space_SURFACE_SLOPE * texel_in_plane * abs(view.depth_scale) / divisor * select(1.0, 1.0 / p.z, view.perspective == 1u);
    depth_per_plane -= view.warp * (unwarped_depth - dot(depth_per_plane, from_center));
    let depth_per_uv = vec2f(dot(view.plane_from_uv.xy, depth_per_plane), dot(view.plane_from_uv.zw, depth_per_plane));
    return space_ReceiverPlane(view.uv_origin + space_uv_step_of_plane(view, from_center / divisor), unwarped_depth / divisor, depth_per_uv, select(1.0, 0.0, view.depth_sign > 0.0), surface_step, bias, faces_away);
}

fn space_held(view: space_LightViewGpu, plane: space_ReceiverPlane, depth: vec4f) -> vec4f {
    let no_farther = view.depth_sign * max(view.depth_sign * depth, vec4f(view.depth_sign * plane.farthest_depth));
    return saturate(no_farther);
}

fn space_plane_depth(view: space_LightViewGpu, plane: space_ReceiverPlane, uv: vec2f) -> f32 {
    return space_held(view, plane, vec4f(plane.depth + dot(plane.depth_per_uv, uv - plane.uv))).x;
}

fn space_grazing_sine(view: space_LightViewGpu, x: vec3f, normal_in_world: vec3f) -> f32 {
    let ray = select(view.axis_in_world, normalize(x - view.origin_in_world), view.perspective == 1u);
    return abs(dot(normal_in_world, ray));
}

fn space_texel_width_m(view: space_LightViewGpu, x: vec3f) -> f32 {
    let p = space_light_from_world(view, x);
    if view.perspective == 1u {
        return space_texel_in_plane_at(view, p.xy / p.z - view.plane_center) * p.z;
    }
    return space_texel_in_plane_at(view, p.xy - view.plane_center);
}

fn space_z_of_depth(view: space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}

fn variance_chebyshev(mean: f32, variance: f32, t: f32) -> f32 {
    let beyond = t - mean;
    if beyond <= 0.0 {
        return 1.0;
    }
    return select(variance / (variance + beyond * beyond), 1.0, variance + beyond * beyond == 0.0);
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

struct histogram_LvsmHistogramUniform {
    stride: u32,
    overlap: f32,
    kernel_size: f32,
    min_weight: f32,
    max_weight: f32,
    padding_x: u32,
    padding_y: u32,
    padding_z: u32
}

const histogram_BIN_COUNT = 4096.0;

const histogram_WEIGHT_SCALE = 65535.0;

struct source_FilterUniform {
    packing: u32,
    sample_count: u32,
    kernel_radius: u32,
    max_anisotropy: u32,
    bias_scale: f32,
    t_step: f32,
    near_m: f32,
    far_m: f32,
    depth_axis: vec3f,
    level_count: u32
}

override source_IS_DISTANCE: bool = false;

fn source_along_axis_m(view: space_LightViewGpu, range: source_FilterUniform, uv: vec2f, z_m: f32) -> f32 {
    let plane = space_warped_plane(view, uv);
    if source_IS_DISTANCE {
        return z_m * length(vec3f(plane, 1.0));
    }
    if view.perspective == 1u {
        return z_m * dot(range.depth_axis, vec3f(plane, 1.0));
    }
    return dot(range.depth_axis, vec3f(plane, z_m));
}

fn source_t_at(view: space_LightViewGpu, range: source_FilterUniform, uv: vec2f, z_m: f32) -> f32 {
    return saturate((source_along_axis_m(view, range, uv, z_m) - range.near_m) / (range.far_m - range.near_m));
}
