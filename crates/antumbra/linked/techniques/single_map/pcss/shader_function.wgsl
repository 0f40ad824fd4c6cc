// Linked from src/techniques/single_map/pcss/shader_function.wesl by `cargo xtask shaders`: edit that, not this.

fn visibility_at(position: vec3f, normal: vec3f, pixel: vec2u) -> f32 {
    return resolve_visibility(inputs_receiver_at(position, normal), pixel);
}

@compute @workgroup_size(1)
fn keep_visibility_at() {
    _ = visibility_at(vec3f(), vec3f(), vec2u());
}

const bias_HALF_TEXEL = 0.5;

const bias_SNAPPED_TEXELS = 0.00390625;

fn bias_automatic_bias_m(texel_width_m: f32, grazing_sine: f32, bias_scale: f32) -> f32 {
    return bias_scale * texel_width_m * max(bias_HALF_TEXEL, bias_SNAPPED_TEXELS / grazing_sine);
}

const blocker_range_RIM: f32 = 1.25;

@group(1) @binding(3)
var blocker_range_light_map_pyramid: texture_2d<f32>;

fn blocker_range_g_of_depth(plane: space_ReceiverPlane, depth: f32) -> f32 {
    let own = space_unwarped_depth(map_light_view, plane.depth, plane.uv);
    return map_light_view.depth_sign * (depth - own) / abs(map_light_view.depth_scale);
}

fn blocker_range_half_extent_uv_at_1(uv: vec2f, extent: vec2f) -> vec2f {
    return abs(space_uv_step_at(map_light_view, uv, vec2f(extent.x, 0.0))) + abs(space_uv_step_at(map_light_view, uv, vec2f(0.0, extent.y)));
}

fn blocker_range_nearest_depth(uv: vec2f, half_extent_uv: vec2f) -> f32 {
    let last = map_light_view.map_size - 1.0;
    let low = vec2u(clamp((uv - half_extent_uv) * map_light_view.map_size, vec2f(0.0), last));
    let high = vec2u(clamp((uv + half_extent_uv) * map_light_view.map_size, vec2f(0.0), last));
    let span = max(high.x - low.x, high.y - low.y);
    let top = max(textureNumLevels(blocker_range_light_map_pyramid), 2u) - 2u;
    let shift = clamp(select(32u - countLeadingZeros(span), 0u, span == 0u), 1u, top + 1u);
    let a = low >> vec2u(shift);
    let b = high >> vec2u(shift);
    let level = shift - 1u;
    let p = textureLoad(blocker_range_light_map_pyramid, a, level);
    let q = textureLoad(blocker_range_light_map_pyramid, vec2u(b.x, a.y), level);
    let r = textureLoad(blocker_range_light_map_pyramid, vec2u(a.x, b.y), level);
    let s = textureLoad(blocker_range_light_map_pyramid, b, level);
    let least = min(min(p.x, q.x), min(r.x, s.x));
    let greatest = max(max(p.y, q.y), max(r.y, s.y));
    return select(least, greatest, map_light_view.depth_sign > 0.0);
}

fn blocker_range_seen_extent(extent: vec2f, extent_axis: f32, receiver_in_light: vec3f) -> vec2f {
    if extent_axis == 0.0 {
        return extent;
    }
    let tangent = abs(receiver_in_light.xy) / receiver_in_light.z;
    let a = min(extent_axis, 0.9 * receiver_in_light.z);
    return (extent + a * tangent) / (1.0 - a / receiver_in_light.z);
}

const blocker_range_FAR_FROM_CUT = 2.0;

fn blocker_range_largest_g_that_matters(plane: space_ReceiverPlane) -> f32 {
    let ends = textureLoad(blocker_range_light_map_pyramid, vec2u(0u), textureNumLevels(blocker_range_light_map_pyramid) - 1u);
    let nearest = select(ends.x, ends.y, map_light_view.depth_sign > 0.0);
    let own_z = space_z_of_depth(map_light_view, space_unwarped_depth(map_light_view, plane.depth, plane.uv));
    let is_far = map_light_view.perspective == 0u || own_z >= blocker_range_FAR_FROM_CUT * space_z_of_depth(map_light_view, nearest);
    return select(1e30, max(blocker_range_g_of_depth(plane, nearest), 0.0), is_far);
}

fn blocker_range_largest_g(plane: space_ReceiverPlane, extent: vec2f) -> f32 {
    let most = blocker_range_largest_g_that_matters(plane);
    var g = min(blocker_range_g_of_depth(plane, blocker_range_nearest_depth(vec2f(0.5), vec2f(0.5))), most);
    let at_1 = blocker_range_half_extent_uv_at_1(plane.uv, extent);
    for (var i = 0; i < 3; i++) {
        let half_extent_uv = at_1 * g;
        g = clamp(blocker_range_g_of_depth(plane, blocker_range_nearest_depth(plane.uv, half_extent_uv + 1.0 / map_light_view.map_size)), 0.0, most);
    }
    return g;
}

@group(1) @binding(4)
var behind_further_layers: texture_depth_2d_array;

override behind_LAYER_COUNT: u32 = 1u;

fn horizon_has_horizon_share() -> bool {
    return inputs_light_source.kind != light_KIND_POINTS && inputs_light_source.emission_size.x == 0u;
}

fn horizon_center_height(receiver: inputs_Receiver) -> f32 {
    if inputs_light_source.kind == light_KIND_SUN {
        return -dot(inputs_light_source.axis_in_world, receiver.normal_in_world);
    }
    return dot(inputs_light_source.center_in_world - receiver.pos_in_world, receiver.normal_in_world);
}

fn horizon_half_axis_heights(receiver: inputs_Receiver) -> vec3f {
    let n = receiver.normal_in_world;
    let along = vec3f(dot(inputs_light_source.right_in_world, n), dot(inputs_light_source.up_in_world, n), dot(inputs_light_source.axis_in_world, n));
    if inputs_light_source.kind == light_KIND_SPHERE {
        let facing = dot(normalize(inputs_light_source.center_in_world - receiver.pos_in_world), n);
        return vec3f(inputs_light_source.half_right * sqrt(max(1.0 - facing * facing, 0.0)), 0.0, 0.0);
    }
    return abs(along) * vec3f(inputs_light_source.half_right, inputs_light_source.half_up, inputs_light_source.half_axis);
}

fn horizon_rise_above_center(half_axis_heights: vec3f) -> f32 {
    let is_rectangle = inputs_light_source.kind == light_KIND_RECTANGLE;
    return select(length(half_axis_heights), half_axis_heights.x + half_axis_heights.y, is_rectangle);
}

fn horizon_rectangle_share(height: f32, across: vec2f) -> f32 {
    let a = max(max(across.x, across.y), 1e-20);
    let b = max(min(across.x, across.y) / a, 0.01);
    let h = height / a;
    let edges = max(vec4f(h + 1.0 + b, h + 1.0 - b, h - 1.0 + b, h - 1.0 - b), vec4f(0.0));
    let squares = edges * edges;
    return saturate((squares.x - squares.y - squares.z + squares.w) / (8.0 * b));
}

fn horizon_horizon_share(receiver: inputs_Receiver) -> f32 {
    let height = horizon_center_height(receiver);
    let half = horizon_half_axis_heights(receiver);
    let reach = horizon_rise_above_center(half);
    if abs(height) >= reach {
        return select(0.0, 1.0, height > 0.0);
    }
    if inputs_light_source.kind == light_KIND_RECTANGLE {
        return horizon_rectangle_share(height, half.xy);
    }
    let h = height / max(reach, 1e-20);
    if inputs_light_source.kind == light_KIND_ELLIPSOID {
        return saturate(0.25 * (1.0 + h) * (1.0 + h) * (2.0 - h));
    }
    return saturate((acos(-h) + h * sqrt(max(1.0 - h * h, 0.0))) / light_PI);
}

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

@group(1) @binding(1)
var map_light_map: texture_depth_2d;

@group(1) @binding(2)
var map_light_map_sampler: sampler;

fn map_widest_blur_texels(plane: space_ReceiverPlane, gap: f32, widest_tangent: f32) -> f32 {
    let rise_per_texel = length(plane.depth_per_uv / map_light_view.map_size);
    let texel_width = plane.surface_step / space_SURFACE_SLOPE;
    return 2.0 * max(gap, 0.0) / max(rise_per_texel, texel_width / widest_tangent);
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

fn space_inverse_divisor(view: space_LightViewGpu, uv: vec2f) -> f32 {
    return max(1.0 - dot(view.warp, space_warped_plane(view, uv)), 0.0001);
}

fn space_unwarped_depth(view: space_LightViewGpu, depth: f32, uv: vec2f) -> f32 {
    if !space_is_warped(view) {
        return depth;
    }
    return depth / space_inverse_divisor(view, uv);
}

fn space_uv_step_at(view: space_LightViewGpu, uv: vec2f, step: vec2f) -> vec2f {
    if !space_is_warped(view) {
        return space_uv_step_of_plane(view, step);
    }
    let in_warp = (step - space_warped_plane(view, uv) * dot(view.warp, step)) * space_inverse_divisor(view, uv);
    return space_uv_step_of_plane(view, in_warp);
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

fn space_bilinear(quad: vec4f, t: vec2f) -> f32 {
    return mix(mix(quad.w, quad.z, t.x), mix(quad.x, quad.y, t.x), t.y);
}

fn space_g_beyond_window(view: space_LightViewGpu, z_m: f32) -> f32 {
    return select(1e30, 1.0 / max(view.complete_from_m, 1e-30) - 1.0 / z_m, view.complete_from_m > 0.0);
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

@group(0) @binding(5)
var<storage, read> inputs_light_data: array<vec4f>;

struct inputs_Receiver {
    pos_in_world: vec3f,
    normal_in_world: vec3f,
    is_background: bool,
    is_reached: bool
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

fn inputs_receiver_at(position: vec3f, normal: vec3f) -> inputs_Receiver {
    return inputs_point_receiver(position - inputs_receiver_view.anchor_in_world, normal);
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

override light_taps_LIGHT_KIND: u32 = 0u;

override light_taps_HAS_EMISSION: bool = false;

override light_taps_IS_PROGRESSIVE: bool = false;

@group(2) @binding(1)
var<storage, read> light_taps_taps: array<vec4f>;

const light_taps_TAU = 6.283185307179586;

struct light_taps_LightPlane {
    origin: vec2f,
    right: vec2f,
    up: vec2f,
    axis: vec2f,
    nearness: vec3f,
    center_nearness: f32,
    heights: vec3f,
    center_height: f32,
    facing: vec3f,
    shift: vec2f,
    turn: mat2x2f
}

fn light_taps_half_axes(receiver: inputs_Receiver) -> mat3x3f {
    if light_taps_LIGHT_KIND == light_KIND_POINTS {
        return mat3x3f(inputs_light_source.right_in_world, inputs_light_source.up_in_world, inputs_light_source.axis_in_world);
    }
    if light_taps_LIGHT_KIND == light_KIND_SPHERE {
        let towards = normalize(inputs_light_source.center_in_world - receiver.pos_in_world);
        let across = cross(inputs_light_source.up_in_world, towards);
        let across_length = length(across);
        let right = select(inputs_light_source.right_in_world, across / max(across_length, 1e-20), across_length > 1e-6);
        return mat3x3f(right * inputs_light_source.half_right, cross(towards, right) * inputs_light_source.half_right, vec3f());
    }
    return mat3x3f(inputs_light_source.right_in_world * inputs_light_source.half_right, inputs_light_source.up_in_world * inputs_light_source.half_up, inputs_light_source.axis_in_world * inputs_light_source.half_axis);
}

fn light_taps_in_light(v: vec3f) -> vec3f {
    return vec3f(dot(v, map_light_view.right_in_world), dot(v, map_light_view.up_in_world), dot(v, map_light_view.axis_in_world));
}

fn light_taps_texels_per_offset() -> mat2x2f {
    let size = map_light_view.map_size;
    return mat2x2f(map_light_view.uv_from_plane.xy * size, map_light_view.uv_from_plane.zw * size);
}

fn light_taps_shifted(light: light_taps_LightPlane, shift: vec2f) -> light_taps_LightPlane {
    let angle = light_taps_TAU * shift.x;
    var plane = light;
    plane.shift = shift;
    plane.turn = mat2x2f(cos(angle), sin(angle), -sin(angle), cos(angle));
    return plane;
}

fn light_taps_light_plane(receiver: inputs_Receiver, receiver_in_light: vec3f, shift: vec2f) -> light_taps_LightPlane {
    let axes = light_taps_half_axes(receiver);
    let right = light_taps_in_light(axes[0]);
    let up = light_taps_in_light(axes[1]);
    let axis = light_taps_in_light(axes[2]);
    let texels = light_taps_texels_per_offset();
    var plane = light_taps_shifted(light_taps_LightPlane(), shift);
    plane.heights = receiver.normal_in_world * axes;
    plane.center_height = horizon_center_height(receiver);
    if light_taps_LIGHT_KIND == light_KIND_SUN {
        plane.right = texels * right.xy;
        plane.up = texels * up.xy;
        return plane;
    }
    let center = space_light_from_world(map_light_view, inputs_light_source.center_in_world);
    let per_z = 1.0 / receiver_in_light.z;
    let tangent = receiver_in_light.xy * per_z;
    plane.origin = texels * (center.xy - tangent * center.z);
    plane.right = texels * (right.xy - tangent * right.z);
    plane.up = texels * (up.xy - tangent * up.z);
    plane.axis = texels * (axis.xy - tangent * axis.z);
    plane.nearness = vec3f(right.z, up.z, axis.z) * per_z;
    plane.center_nearness = center.z * per_z;
    let half = max(vec3f(inputs_light_source.half_right, inputs_light_source.half_up, inputs_light_source.half_axis), vec3f(1e-20));
    plane.facing = normalize((receiver.pos_in_world - inputs_light_source.center_in_world) * axes / (half * half));
    return plane;
}

fn light_taps_place_of(plane: light_taps_LightPlane, tap: vec3f) -> vec3f {
    if light_taps_LIGHT_KIND == light_KIND_RECTANGLE {
        return vec3f(2.0 * fract(tap.xy + plane.shift) - 1.0, 0.0);
    }
    if light_taps_LIGHT_KIND == light_KIND_POINTS {
        return tap;
    }
    return vec3f(plane.turn * tap.xy, tap.z);
}

fn light_taps_texels_of(plane: light_taps_LightPlane, place: vec3f) -> vec2f {
    let across = plane.origin + plane.right * place.x + plane.up * place.y;
    if light_taps_LIGHT_KIND == light_KIND_RECTANGLE || light_taps_LIGHT_KIND == light_KIND_DISK || light_taps_LIGHT_KIND == light_KIND_SUN {
        return across;
    }
    let divisor = 1.0 - plane.center_nearness - dot(plane.nearness, place);
    return (across + plane.axis * place.z) / max(divisor, 0.001);
}

fn light_taps_is_above_horizon(plane: light_taps_LightPlane, place: vec3f) -> bool {
    return plane.center_height + dot(plane.heights, place) > 0.0;
}

fn light_taps_gauge(plane: light_taps_LightPlane, place: vec3f) -> f32 {
    if light_taps_LIGHT_KIND == light_KIND_RECTANGLE {
        return max(abs(place.x), abs(place.y));
    }
    if light_taps_LIGHT_KIND == light_KIND_POINTS {
        return 1.0;
    }
    if light_taps_LIGHT_KIND == light_KIND_ELLIPSOID {
        return length(cross(place, plane.facing));
    }
    return length(place.xy);
}

fn light_taps_weight_of(place: vec3f) -> f32 {
    if !light_taps_HAS_EMISSION {
        return 1.0;
    }
    return inputs_light_data[light_emission_index(inputs_light_source, 0.5 * place.xy + 0.5)].x;
}

const map_receiver_NO_G = 1e20;

struct map_receiver_MapReceiver {
    center: vec2f,
    depth: f32,
    depth_at_origin: f32,
    slope: vec2f,
    g_per_depth: f32,
    edge_g: f32,
    away_margin: f32
}

const map_receiver_MIN_MARGIN = 1e-30;

fn map_receiver_faces_away(receiver: map_receiver_MapReceiver) -> bool {
    return receiver.away_margin > 0.0;
}

fn map_receiver_map_receiver(plane: space_ReceiverPlane, z_m: f32) -> map_receiver_MapReceiver {
    let sign = map_light_view.depth_sign;
    let center = plane.uv * map_light_view.map_size;
    let slope = sign * plane.depth_per_uv / map_light_view.map_size;
    let depth = sign * plane.depth;
    return map_receiver_MapReceiver(center, depth, depth + dot(slope, 0.5 - center), slope, 1.0 / abs(map_light_view.depth_scale), space_g_beyond_window(map_light_view, z_m), select(0.0, max(2.0 * abs(plane.bias), map_receiver_MIN_MARGIN), plane.faces_away));
}

fn map_receiver_g_of(receiver: map_receiver_MapReceiver, depth: f32) -> f32 {
    return (depth - receiver.depth) * receiver.g_per_depth;
}

fn map_receiver_stored_depth(texel: vec2u, layer: u32) -> f32 {
    if layer == 0u {
        return map_light_view.depth_sign * textureLoad(map_light_map, texel, 0);
    }
    return map_light_view.depth_sign * textureLoad(behind_further_layers, texel, layer - 1u, 0);
}

fn map_receiver_min_depth() -> f32 {
    return min(map_light_view.depth_sign, 0.0);
}

fn map_receiver_max_depth() -> f32 {
    return max(map_light_view.depth_sign, 0.0);
}

fn map_receiver_plane_depth_at(receiver: map_receiver_MapReceiver, texel: vec2f) -> f32 {
    return receiver.depth_at_origin + dot(receiver.slope, texel);
}

struct map_receiver_BlockingDepths {
    least: vec4f,
    most: vec4f
}

fn map_receiver_blocking_depths(receiver: map_receiver_MapReceiver, plane_depths: vec4f) -> map_receiver_BlockingDepths {
    let least = select(max(plane_depths, vec4f(receiver.depth)), vec4f(receiver.depth), map_receiver_faces_away(receiver));
    return map_receiver_BlockingDepths(clamp(least, vec4f(map_receiver_min_depth()), vec4f(map_receiver_max_depth())), select(vec4f(map_receiver_NO_G), plane_depths - receiver.away_margin, map_receiver_faces_away(receiver)));
}

fn map_receiver_blocking_depths_at(receiver: map_receiver_MapReceiver, texel: vec2f) -> vec2f {
    let depths = map_receiver_blocking_depths(receiver, vec4f(map_receiver_plane_depth_at(receiver, texel)));
    return vec2f(depths.least.x, depths.most.x);
}

fn map_receiver_texel_in_front(receiver: map_receiver_MapReceiver, texel: vec2f, passed_depth: f32) -> vec2f {
    let steepness = max(length(receiver.slope), 1e-30);
    let towards_light = select(1.0, -1.0, map_receiver_faces_away(receiver));
    let forward = -towards_light * receiver.slope / steepness;
    let behind = max(towards_light * (map_receiver_plane_depth_at(receiver, texel) - passed_depth), 0.0) / steepness;
    return floor(texel + 0.5 + forward * (behind + 0.5 * (abs(forward.x) + abs(forward.y))));
}

fn map_receiver_may_block(receiver: map_receiver_MapReceiver, depths: vec4f, plane_depths: vec4f) -> vec4<bool> {
    let blocking = map_receiver_blocking_depths(receiver, plane_depths);
    return (depths > blocking.least) & (depths < blocking.most);
}

fn map_receiver_is_texel(texel: vec2f) -> bool {
    return all(texel >= vec2f(0.0)) && all(texel < map_light_view.map_size);
}

fn map_receiver_blocking_g(receiver: map_receiver_MapReceiver, texel: vec2f, stored: f32) -> f32 {
    let blocking = map_receiver_blocking_depths_at(receiver, texel);
    return select(0.0, max(map_receiver_g_of(receiver, stored), 1e-20), stored > blocking.x && stored < blocking.y);
}

fn map_receiver_blocking_g_about(receiver: map_receiver_MapReceiver, texel: vec2f, layer: u32) -> f32 {
    let stored = map_receiver_stored_depth(vec2u(texel), layer);
    let passed_depth = max(stored, receiver.depth);
    if !map_receiver_faces_away(receiver) || passed_depth < map_receiver_blocking_depths_at(receiver, texel).y {
        return map_receiver_blocking_g(receiver, texel, stored);
    }
    let in_front = map_receiver_texel_in_front(receiver, texel, passed_depth);
    return select(0.0, map_receiver_blocking_g(receiver, in_front, map_receiver_stored_depth(vec2u(in_front), layer)), map_receiver_is_texel(in_front));
}

fn map_receiver_place_in_map(receiver: map_receiver_MapReceiver, place: vec2f, g: f32) -> vec2f {
    return select(place, clamp(place, vec2f(0.5), map_light_view.map_size - 0.5), g > receiver.edge_g);
}

struct map_receiver_Look {
    texel: vec2f,
    hiding_g: f32
}

fn map_receiver_look_at_scale(receiver: map_receiver_MapReceiver, light: light_taps_LightPlane, g: f32, index: u32) -> map_receiver_Look {
    let place = light_taps_place_of(light, light_taps_taps[index].xyz);
    let texel = floor(map_receiver_place_in_map(receiver, receiver.center + light_taps_texels_of(light, place) * (blocker_range_RIM * g), g));
    return map_receiver_Look(texel, select(map_receiver_NO_G, light_taps_gauge(light, place) * g, map_receiver_is_texel(texel)));
}

fn map_receiver_scale_share(index: u32, scale_shift: f32) -> f32 {
    return fract(light_taps_taps[index].w + scale_shift);
}

fn map_receiver_look_at(receiver: map_receiver_MapReceiver, light: light_taps_LightPlane, max_g: f32, scale_shift: f32, index: u32) -> map_receiver_Look {
    let scale = map_receiver_scale_share(index, scale_shift);
    return map_receiver_look_at_scale(receiver, light, max_g * (scale * scale), index);
}

const comparison_WIDEST_TANGENT = 0.05;

const comparison_LOOKS = 2u;

fn comparison_edge_sharpness(plane: space_ReceiverPlane, g: f32) -> f32 {
    let widest = map_widest_blur_texels(plane, g * abs(map_light_view.depth_scale), comparison_WIDEST_TANGENT);
    return select(1.0, 1.0 / clamp(widest, 0.001, 1.0), settings_pcss.attach_contacts == 1u);
}

struct comparison_Quad {
    corner_uv: vec2f,
    t: vec2f,
    at_centers: vec4f,
    here: f32,
    is_in_map: bool
}

fn comparison_quad_about(receiver: map_receiver_MapReceiver, offset: vec2f, g: f32) -> comparison_Quad {
    let place = map_receiver_place_in_map(receiver, receiver.center + offset * g, g);
    let corner = floor(place - 0.5);
    let t = place - 0.5 - corner;
    let low = receiver.depth_at_origin + dot(receiver.slope, corner);
    let lows = vec2f(low, low + receiver.slope.x);
    let centers = vec4f(lows + receiver.slope.y, lows.yx);
    return comparison_Quad((corner + 1.0) / map_light_view.map_size, t, centers, low + dot(receiver.slope, t), all(place >= vec2f(0.0)) && all(place <= map_light_view.map_size));
}

fn comparison_occluding(window: search_Window, quad: comparison_Quad, depths: vec4f) -> vec4<bool> {
    let across = depths.yxwz - depths;
    let along = depths.wzyx - depths;
    let from_here = abs(vec4f(quad.t, 1.0 - quad.t));
    let step = vec4f(window.surface_step);
    let carried = depths + from_here.xzzx * select(vec4f(), across, abs(across) < step) + from_here.wwyy * select(vec4f(), along, abs(along) < step);
    return map_receiver_may_block(window.at, depths, quad.at_centers) & map_receiver_may_block(window.at, carried, vec4f(quad.here));
}

fn comparison_lit_of(occluding: vec4<bool>, t: vec2f, sharpness: f32) -> f32 {
    return space_bilinear(select(vec4f(1.0), vec4f(), occluding), saturate((t - 0.5) * sharpness + 0.5));
}

fn comparison_hiding_g_in_front(window: search_Window, texels: vec2f, layer: u32, g: f32) -> f32 {
    let texel = floor(map_receiver_place_in_map(window.at, window.at.center + texels * g, g));
    if !map_receiver_is_texel(texel) {
        return 0.0;
    }
    return map_receiver_blocking_g_about(window.at, texel, layer);
}

fn comparison_lit_at_scale(plane: space_ReceiverPlane, window: search_Window, texels: vec2f, scale: penumbra_width_Scale) -> f32 {
    if map_receiver_faces_away(window.at) {
        for (var layer = scale.layers.x; layer < min(scale.layers.y, behind_LAYER_COUNT); layer++) {
            let g = comparison_hiding_g_in_front(window, texels, layer, scale.g);
            if g > 0.0 && g >= scale.g_range.x && g <= scale.g_range.y {
                return 0.0;
            }
        }
        return 1.0;
    }
    let quad = comparison_quad_about(window.at, texels, scale.g);
    let sharpness = comparison_edge_sharpness(plane, scale.g);
    let depths = window.at.depth + scale.g_range / window.at.g_per_depth;
    var lit = 1.0;
    var goes_on = quad.is_in_map;
    for (var layer = scale.layers.x; layer < min(scale.layers.y, behind_LAYER_COUNT) && goes_on && lit > 0.0; layer++) {
        let stored = map_light_view.depth_sign * comparison_gathered(quad, layer);
        let occluding = comparison_occluding(window, quad, stored);
        let counts = (stored >= vec4f(depths.x)) & (stored <= vec4f(depths.y));
        lit = min(lit, comparison_lit_of(occluding & counts, quad.t, sharpness));
        goes_on = any(occluding);
    }
    return lit;
}

fn comparison_gathered(quad: comparison_Quad, layer: u32) -> vec4f {
    if layer == 0u {
        return textureGather(map_light_map, map_light_map_sampler, quad.corner_uv);
    }
    return textureGather(behind_further_layers, map_light_map_sampler, quad.corner_uv, layer - 1u);
}

fn comparison_lit_in_layer(window: search_Window, texels: vec2f, share: f32, layer: u32, g: f32, sharpness: f32) -> f32 {
    var scale = g;
    if map_receiver_faces_away(window.at) {
        for (var look = 0u; look < comparison_LOOKS; look++) {
            let own_g = comparison_hiding_g_in_front(window, texels, layer, scale);
            if own_g <= 0.0 || own_g >= share * scale {
                return select(1.0, 0.0, own_g > 0.0);
            }
            scale = own_g;
        }
        return 1.0;
    }
    var lit = 1.0;
    for (var look = 0u; look < comparison_LOOKS; look++) {
        let quad = comparison_quad_about(window.at, texels, scale);
        let stored = map_light_view.depth_sign * comparison_gathered(quad, layer);
        let occluding = comparison_occluding(window, quad, stored);
        let own_g = (stored - window.at.depth) * window.at.g_per_depth;
        let hides = own_g >= vec4f(share * scale);
        lit = min(lit, select(1.0, comparison_lit_of(occluding & hides, quad.t, sharpness), quad.is_in_map));
        let nearer = select(vec4f(), vec4f(1.0), occluding & !hides);
        let count = dot(nearer, vec4f(1.0));
        if !quad.is_in_map || count == 0.0 {
            break;
        }
        scale = dot(nearer, own_g) / count;
    }
    return lit;
}

fn filter_hiding_share(light: light_taps_LightPlane, place: vec3f) -> f32 {
    return select(0.0, light_taps_gauge(light, place) / blocker_range_RIM, settings_pcss.attach_contacts == 1u);
}

fn filter_filter_once(window: search_Window, light: light_taps_LightPlane, g: f32, sharpness: f32, begin: u32, end: u32) -> vec2f {
    var sums = vec2f();
    for (var i = begin; i < end; i++) {
        let place = light_taps_place_of(light, light_taps_taps[settings_pcss.search_count + i].xyz);
        let lit = select(1.0, comparison_lit_in_layer(window, light_taps_texels_of(light, place), filter_hiding_share(light, place), 0u, g, sharpness), g > 0.0);
        sums += light_taps_weight_of(place) * vec2f(1.0, select(0.0, lit, light_taps_is_above_horizon(light, place)));
    }
    return sums;
}

fn filter_filter_layers(plane: space_ReceiverPlane, window: search_Window, light: light_taps_LightPlane, blockers: search_Blockers, count: u32) -> vec2f {
    var sums = vec2f();
    var sharpness = vec4f(comparison_edge_sharpness(plane, blockers.g.x), 0.0, 0.0, 0.0);
    for (var layer = 1u; layer < behind_LAYER_COUNT; layer++) {
        sharpness[layer] = comparison_edge_sharpness(plane, blockers.g[layer]);
    }
    for (var i = 0u; i < min(count, settings_pcss.filter_count); i++) {
        let place = light_taps_place_of(light, light_taps_taps[settings_pcss.search_count + i].xyz);
        let texels = light_taps_texels_of(light, place);
        let share = filter_hiding_share(light, place);
        var lit = comparison_lit_in_layer(window, texels, share, 0u, blockers.g.x, sharpness.x);
        for (var layer = 1u; layer < behind_LAYER_COUNT; layer++) {
            let behind = comparison_lit_in_layer(window, texels, share, layer, blockers.g[layer], sharpness[layer]);
            lit = select(lit, min(lit, behind), blockers.g[layer] > 0.0);
        }
        sums += light_taps_weight_of(place) * vec2f(1.0, select(0.0, lit, light_taps_is_above_horizon(light, place)));
    }
    return sums;
}

fn filter_filter_scales(plane: space_ReceiverPlane, window: search_Window, light: light_taps_LightPlane, scales: penumbra_width_Scales, count: u32) -> vec2f {
    var sums = vec2f();
    for (var i = 0u; i < min(count, settings_pcss.filter_count); i++) {
        let place = light_taps_place_of(light, light_taps_taps[settings_pcss.search_count + i].xyz);
        let texels = light_taps_texels_of(light, place);
        var lit = select(0.0, 1.0, light_taps_is_above_horizon(light, place));
        for (var rest = scales.some; rest > 0u && lit > 0.0; rest &= rest - 1u) {
            lit = min(lit, comparison_lit_at_scale(plane, window, texels, penumbra_width_scale_of(scales, countTrailingZeros(rest))));
        }
        sums += light_taps_weight_of(place) * vec2f(1.0, lit);
    }
    return sums;
}

const penumbra_width_NEAR_SHARE = 0.7;

const penumbra_width_CONTACT_TEXELS = 1.5;

const penumbra_width_ANY_G = vec2f(-map_receiver_NO_G, map_receiver_NO_G);

struct penumbra_width_Scale {
    g: f32,
    g_range: vec2f,
    layers: vec2u
}

const penumbra_width_NEAREST = 4u;

struct penumbra_width_Scales {
    blockers: search_Blockers,
    near: penumbra_width_Scale,
    some: u32
}

fn penumbra_width_scales_of(blockers: search_Blockers, extent: vec2f) -> penumbra_width_Scales {
    let near_extent = abs(space_uv_step_of_plane(map_light_view, extent * blockers.min_g)) * map_light_view.map_size;
    let is_contact = max(near_extent.x, near_extent.y) < penumbra_width_CONTACT_TEXELS;
    let means = select(vec4f(map_receiver_NO_G), blockers.g, blockers.g > vec4f());
    let min_mean = min(min(means.x, means.y), min(means.z, means.w));
    let is_near = is_contact && min_mean < map_receiver_NO_G && blockers.min_g < penumbra_width_NEAR_SHARE * min_mean;
    let near_range = vec2f(-map_receiver_NO_G, sqrt(blockers.min_g * min_mean));
    let near = penumbra_width_Scale(blockers.min_g, near_range, vec2u(0u, behind_LAYER_COUNT));
    return penumbra_width_Scales(blockers, near, blockers.groups | select(0u, 1u << penumbra_width_NEAREST, is_near && settings_pcss.attach_contacts == 1u));
}

fn penumbra_width_scale_of(scales: penumbra_width_Scales, index: u32) -> penumbra_width_Scale {
    if index == penumbra_width_NEAREST {
        return scales.near;
    }
    let g = scales.blockers.g[index];
    if settings_MEANS_OF_RANGES {
        return penumbra_width_Scale(g, search_range_of_group(index, scales.blockers.max_g), vec2u(0u, behind_LAYER_COUNT));
    }
    return penumbra_width_Scale(g, penumbra_width_ANY_G, vec2u(index, index + 1u));
}

const resolve_PROBES = 40u;

const resolve_CONTACT_TAPS = 16u;

const resolve_LAYER_TAPS = 48u;

fn resolve_fraction(sums: vec2f) -> f32 {
    return sums.y / max(sums.x, 1e-20);
}

fn resolve_visibility(receiver: inputs_Receiver, pixel: vec2u) -> f32 {
    if receiver.is_background {
        return 1.0;
    }
    if !receiver.is_reached {
        return 0.0;
    }
    let above_horizon = horizon_horizon_share(receiver);
    if horizon_has_horizon_share() && above_horizon <= 0.0 {
        return 0.0;
    }
    let plane = search_comparison_plane(receiver);
    let pos_in_light = space_light_from_world(map_light_view, receiver.pos_in_world);
    let extent = blocker_range_seen_extent(settings_pcss.light_extent, settings_pcss.light_extent_axis, pos_in_light);
    let shift = select(vec2f(), noise_shift_of_pixel(pixel), settings_pcss.rotate == 1u);
    let light = light_taps_light_plane(receiver, pos_in_light, shift);
    let window = search_window_of(plane, extent, shift, pos_in_light.z);
    let found = search_search(window, light);
    let nearest = search_blockers_of(found, window);
    if nearest.groups == 0u && horizon_has_horizon_share() {
        return above_horizon;
    }
    let sharpness = comparison_edge_sharpness(plane, nearest.g.x);
    let probes = select(0u, settings_part_of(settings_pcss.filter_count, resolve_PROBES), light_taps_IS_PROGRESSIVE && !settings_MEANS_OF_RANGES);
    let probed = filter_filter_once(window, light, nearest.g.x, sharpness, 0u, probes);
    if probes > 0u && probed.y <= 0.0 {
        return 0.0;
    }
    let blockers = search_blockers_of(search_search_behind(window, light, found), window);
    let scales = penumbra_width_scales_of(blockers, extent);
    if !settings_MEANS_OF_RANGES && scales.some <= 1u {
        let is_lit = probes > 0u && probed.x == probed.y;
        let count = select(settings_pcss.filter_count, 0u, is_lit);
        return resolve_fraction(probed + filter_filter_once(window, light, nearest.g.x, sharpness, probes, count));
    }
    if !settings_MEANS_OF_RANGES && scales.some < (1u << penumbra_width_NEAREST) {
        return resolve_fraction(filter_filter_layers(plane, window, light, blockers, settings_part_of(settings_pcss.filter_count, resolve_LAYER_TAPS)));
    }
    let count = select(settings_part_of(settings_pcss.filter_count, resolve_CONTACT_TAPS), settings_pcss.filter_count, settings_MEANS_OF_RANGES);
    return resolve_fraction(filter_filter_scales(plane, window, light, scales, count));
}

const search_ENOUGH_BLOCKERS = 4u;

const search_MIN_TAPS = 8u;

const search_BEHIND_TAPS = 8u;

const search_NARROW_TAPS = 12u;

fn search_comparison_plane(receiver: inputs_Receiver) -> space_ReceiverPlane {
    var plane = receiver_light_biased_plane(receiver, settings_pcss.bias_scale);
    plane.farthest_depth = plane.depth;
    let is_flat = settings_pcss.is_flat == 1u;
    plane.depth_per_uv = select(plane.depth_per_uv, vec2f(0.0), is_flat);
    plane.faces_away = plane.faces_away && !is_flat;
    return plane;
}

struct search_Window {
    at: map_receiver_MapReceiver,
    surface_step: f32,
    max_g: f32,
    scale_shift: f32,
    search_count: u32
}

fn search_search_count(reach: vec2f) -> u32 {
    let sides = 2.0 * reach + 2.0;
    return settings_part_of(settings_pcss.search_count, max(u32(min(sides.x * sides.y, 64.0)), search_NARROW_TAPS));
}

fn search_window_of(plane: space_ReceiverPlane, extent: vec2f, shift: vec2f, z_m: f32) -> search_Window {
    let max_g = blocker_range_largest_g(plane, extent);
    let texels = light_taps_texels_per_offset();
    return search_Window(map_receiver_map_receiver(plane, z_m), plane.surface_step, max_g, shift.x + shift.y, search_search_count(blocker_range_RIM * max_g * (abs(texels[0]) * extent.x + abs(texels[1]) * extent.y)));
}

struct search_Blockers {
    g: vec4f,
    groups: u32,
    min_g: f32,
    max_g: f32
}

struct search_Sums {
    g: vec4f,
    weight: vec4f,
    min_g: f32,
    found: u32
}

const search_RIM_WEIGHT = 0.0625;

const search_GROUPS = 4.0;

const search_OVERLAP = 1.25;

fn search_group_of(g: f32, max_g: f32, layer: u32) -> u32 {
    if !settings_MEANS_OF_RANGES {
        return layer;
    }
    return u32(clamp(floor(search_GROUPS * sqrt(saturate(g / max(max_g, 1e-20)))), 0.0, search_GROUPS - 1.0));
}

fn search_range_of_group(group: u32, max_g: f32) -> vec2f {
    let ends = vec2f(f32(group), f32(group + 1u)) / search_GROUPS;
    return ends * ends * vec2f(1.0 / search_OVERLAP, search_OVERLAP) * max_g;
}

fn search_add(sums: search_Sums, window: search_Window, look: map_receiver_Look, layer: u32) -> search_Sums {
    let g = map_receiver_blocking_g_about(window.at, look.texel, layer);
    let counts = g > 0.0 && g >= look.hiding_g;
    let min_g = select(sums.min_g, min(sums.min_g, g), counts);
    let weight = select(0.0, select(search_RIM_WEIGHT, 1.0, g >= blocker_range_RIM * look.hiding_g), counts);
    let found = sums.found + select(0u, 1u, counts);
    if !settings_MEANS_OF_RANGES && layer == 0u {
        return search_Sums(vec4f(sums.g.x + weight * g, sums.g.yzw), vec4f(sums.weight.x + weight, sums.weight.yzw), min_g, found);
    }
    let group = vec4u(0u, 1u, 2u, 3u) == vec4u(search_group_of(g, window.max_g, layer));
    return search_Sums(sums.g + select(vec4f(), vec4f(weight * g), group), sums.weight + select(vec4f(), vec4f(weight), group), min_g, found);
}

fn search_search(window: search_Window, light: light_taps_LightPlane) -> search_Sums {
    let own = floor(window.at.center);
    let own_g = map_receiver_blocking_g_about(window.at, own, 0u);
    var sums = search_Sums(vec4f(), vec4f(), select(map_receiver_NO_G, own_g, map_receiver_is_texel(own) && own_g > 0.0), 0u);
    let least = settings_part_of(settings_pcss.search_count, search_MIN_TAPS);
    let enough = settings_part_of(settings_pcss.search_count, search_ENOUGH_BLOCKERS);
    for (var i = 0u; i < min(window.search_count, settings_pcss.search_count); i++) {
        let look = map_receiver_look_at(window.at, light, window.max_g, window.scale_shift, i);
        sums = search_add(sums, window, look, 0u);
        if (light_taps_IS_PROGRESSIVE && i + 1u >= least && sums.found >= enough) || (i + 1u >= settings_pcss.search_enough && sums.found > 0u) {
            break;
        }
    }
    return sums;
}

fn search_search_behind(window: search_Window, light: light_taps_LightPlane, first: search_Sums) -> search_Sums {
    let own = floor(window.at.center);
    var sums = first;
    var found = first.found;
    let count = min(min(window.search_count, settings_part_of(settings_pcss.search_count, search_BEHIND_TAPS)), settings_pcss.search_count);
    for (var layer = 1u; layer < behind_LAYER_COUNT && found > 0u; layer++) {
        let before = sums.found;
        let own_g = map_receiver_blocking_g_about(window.at, own, layer);
        sums.min_g = select(sums.min_g, min(sums.min_g, own_g), map_receiver_is_texel(own) && own_g > 0.0);
        for (var i = 0u; i < count; i++) {
            let look = map_receiver_look_at(window.at, light, window.max_g, window.scale_shift, i);
            sums = search_add(sums, window, look, layer);
        }
        found = sums.found - before;
    }
    return sums;
}

fn search_blockers_of(sums: search_Sums, window: search_Window) -> search_Blockers {
    let some = sums.weight > vec4f();
    let groups = dot(select(vec4u(), vec4u(1u, 2u, 4u, 8u), some), vec4u(1u));
    return search_Blockers(sums.g / max(sums.weight, vec4f(search_RIM_WEIGHT)), groups, sums.min_g, window.max_g);
}

struct settings_PcssUniform {
    search_count: u32,
    filter_count: u32,
    rotate: u32,
    bias_scale: f32,
    light_extent: vec2f,
    light_extent_axis: f32,
    is_ellipse: u32,
    light_covariance: vec3f,
    is_flat: u32,
    light_mean: vec2f,
    attach_contacts: u32,
    search_enough: u32
}

@group(2) @binding(0)
var<uniform> settings_pcss: settings_PcssUniform;

override settings_MEANS_OF_RANGES: bool = false;

fn settings_part_of(count: u32, part: u32) -> u32 {
    return select(count, min(count, max(part, part * count / 64u)), light_taps_IS_PROGRESSIVE);
}
