// Linked from src/techniques/single_map/hard/shader_function.wesl by `cargo xtask shaders`: edit that, not this.

fn visibility_at(position: vec3f, normal: vec3f, pixel: vec2u) -> f32 {
    return resolve_visibility(inputs_receiver_at(position, normal));
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

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

@group(1) @binding(1)
var map_light_map: texture_depth_2d;

@group(1) @binding(2)
var map_light_map_sampler: sampler;

fn map_is_in_map(uv: vec2f) -> bool {
    return all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
}

struct map_Quad {
    lit: vec4f,
    stored: vec4f,
    t: vec2f
}

fn map_quad_at(plane: space_ReceiverPlane, uv: vec2f) -> map_Quad {
    return map_quad_of(plane, uv, textureGather(map_light_map, map_light_map_sampler, map_corner_uv(uv)));
}

fn map_corner_uv(uv: vec2f) -> vec2f {
    return (floor(uv * map_light_view.map_size - 0.5) + 1.0) / map_light_view.map_size;
}

fn map_quad_of(plane: space_ReceiverPlane, uv: vec2f, stored: vec4f) -> map_Quad {
    let pos = uv * map_light_view.map_size - 0.5;
    let t = pos - floor(pos);
    return map_Quad(space_lit_quad(map_light_view, plane, uv, t, stored), stored, t);
}

fn map_lit_nearest(plane: space_ReceiverPlane, uv: vec2f) -> f32 {
    if !map_is_in_map(uv) {
        return 1.0;
    }
    let quad = map_quad_at(plane, uv);
    return space_bilinear(quad.lit, round(quad.t));
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

fn space_lit_quad(view: space_LightViewGpu, plane: space_ReceiverPlane, uv: vec2f, t: vec2f, stored: vec4f) -> vec4f {
    let here = plane.depth + dot(plane.depth_per_uv, uv - plane.uv);
    let from_here = space_from_quad_center(t);
    let across = stored.yxwz - stored;
    let along = stored.wzyx - stored;
    let carried = stored + abs(from_here.x) * select(vec4f(0.0), across, abs(across) < vec4f(plane.surface_step)) + abs(from_here.y) * select(vec4f(0.0), along, abs(along) < vec4f(plane.surface_step));
    let in_front = space_in_front_of_plane(view, plane, here, from_here, stored, carried);
    return select(vec4f(1.0), vec4f(0.0), in_front > vec4f(0.0));
}

struct space_Quad2 {
    x: vec4f,
    y: vec4f
}

fn space_from_quad_center(t: vec2f) -> space_Quad2 {
    return space_Quad2(vec4f(-t.x, 1.0 - t.x, 1.0 - t.x, -t.x), vec4f(1.0 - t.y, 1.0 - t.y, -t.y, -t.y));
}

fn space_in_front_of_plane(view: space_LightViewGpu, plane: space_ReceiverPlane, here: f32, from_here: space_Quad2, stored: vec4f, carried: vec4f) -> vec4f {
    let step = plane.depth_per_uv / view.map_size;
    let at_centers = space_held(view, plane, here + from_here.x * step.x + from_here.y * step.y);
    return min(view.depth_sign * (stored - at_centers), view.depth_sign * (carried - space_held(view, plane, vec4f(here))));
}

fn space_bilinear(quad: vec4f, t: vec2f) -> f32 {
    return mix(mix(quad.w, quad.z, t.x), mix(quad.x, quad.y, t.x), t.y);
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

struct resolve_HardUniform {
    bias_scale: f32
}

@group(2) @binding(0)
var<uniform> resolve_hard: resolve_HardUniform;

fn resolve_visibility(receiver: inputs_Receiver) -> f32 {
    if receiver.is_background {
        return 1.0;
    }
    if !receiver.is_reached || !receiver_light_faces_light_center(receiver) {
        return 0.0;
    }
    var plane = receiver_light_biased_plane(receiver, resolve_hard.bias_scale);
    plane.farthest_depth = plane.depth - plane.bias;
    return map_lit_nearest(plane, plane.uv);
}
