// Linked from src/techniques/single_map/pcf/resolve.wesl by `cargo xtask shaders`: edit that, not this.

struct PcfUniform {
    kernel_size_texels: f32,
    tap_count: u32,
    rotate: u32,
    bias_scale: f32,
    attach_contacts: u32
}

@group(2) @binding(0)
var<uniform> pcf: PcfUniform;

@group(2) @binding(1)
var<storage, read> taps: array<vec2f>;

const TAU = 6.283185307179586;

const WIDEST_TANGENT = 0.1;

const MIN_SIZE_TEXELS = 0.25;

struct Found {
    lit: f32,
    widest: f32
}

fn look_in_box(plane: space_ReceiverPlane, size: f32) -> Found {
    let center = plane.uv * map_light_view.map_size;
    let low = center - 0.5 * size;
    let high = center + 0.5 * size;
    let first = vec2i(floor(low));
    let last = vec2i(ceil(high)) - 1;
    let map_last = vec2i(map_light_view.map_size) - 1;
    var occluded = 0.0;
    var widest = size;
    for (var y = max(first.y, 0); y <= min(last.y, map_last.y); y++) {
        let weight_y = min(high.y, f32(y + 1)) - max(low.y, f32(y));
        for (var x = max(first.x, 0); x <= min(last.x, map_last.x); x++) {
            let texel = vec2i(x, y);
            let stored = textureLoad(map_light_map, texel, 0);
            if map_depth_in_front(plane, texel, stored) > 0.0 {
                let weight = weight_y * (min(high.x, f32(x + 1)) - max(low.x, f32(x)));
                occluded += weight;
                let beyond = max(abs(vec2f(texel) + 0.5 - center) - 0.5, vec2f(0.0));
                let own_widest = map_widest_blur_texels(plane, map_gap_of(plane, stored), WIDEST_TANGENT);
                widest = min(widest, max(own_widest, 2.0 * max(beyond.x, beyond.y)));
            }
        }
    }
    return Found(saturate(1.0 - occluded / (size * size)), widest);
}

fn widest_disc(plane: space_ReceiverPlane, size: f32, turn: mat2x2f) -> f32 {
    var widest = size;
    for (var i = 0u; i < pcf.tap_count; i++) {
        let uv = plane.uv + turn * taps[i] * 0.5 * size / map_light_view.map_size;
        let texel = map_texel_of_uv(uv);
        let stored = textureLoad(map_light_map, texel, 0);
        if map_is_in_map(uv) && map_depth_in_front(plane, texel, stored) > 0.0 {
            let own_widest = map_widest_blur_texels(plane, map_gap_of(plane, stored), WIDEST_TANGENT);
            widest = min(widest, max(own_widest, size * length(taps[i])));
        }
    }
    return widest;
}

fn lit_disc(plane: space_ReceiverPlane, size: f32, turn: mat2x2f) -> f32 {
    var lit = 0.0;
    for (var i = 0u; i < pcf.tap_count; i++) {
        let uv = plane.uv + turn * taps[i] * 0.5 * size / map_light_view.map_size;
        lit += map_lit_narrowed(plane, uv, min(size, 1.0), map_ANY_GAP);
    }
    return lit / f32(pcf.tap_count);
}

fn visibility(receiver: inputs_Receiver, pixel: vec2u) -> f32 {
    if receiver.is_background {
        return 1.0;
    }
    if !receiver.is_reached || !receiver_light_faces_light_center(receiver) {
        return 0.0;
    }
    var plane = receiver_light_biased_plane_within(receiver, pcf.bias_scale, receiver_light_coarse_grazing_sine(receiver));
    let attach = pcf.attach_contacts == 1u;
    if attach {
        plane.farthest_depth = plane.depth;
    }
    let size = pcf.kernel_size_texels;
    if pcf.tap_count == 0u {
        let found = look_in_box(plane, size);
        if !attach || found.widest >= size {
            return found.lit;
        }
        return look_in_box(plane, max(found.widest, MIN_SIZE_TEXELS)).lit;
    }
    let angle = select(0.0, TAU * noise_noise_of_pixel(pixel), pcf.rotate == 1u);
    let turn = mat2x2f(cos(angle), sin(angle), -sin(angle), cos(angle));
    if !attach {
        return lit_disc(plane, size, turn);
    }
    return lit_disc(plane, widest_disc(plane, size, turn), turn);
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    if inputs_is_inside(id.xy) {
        inputs_write_visibility(id.xy, visibility(inputs_load_receiver(id.xy), id.xy));
    }
}

const bias_HALF_TEXEL = 0.5;

const bias_SNAPPED_TEXELS = 0.00390625;

fn bias_automatic_bias_m(texel_width_m: f32, grazing_sine: f32, bias_scale: f32) -> f32 {
    return bias_scale * texel_width_m * max(bias_HALF_TEXEL, bias_SNAPPED_TEXELS / grazing_sine);
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

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

@group(1) @binding(1)
var map_light_map: texture_depth_2d;

@group(1) @binding(2)
var map_light_map_sampler: sampler;

fn map_is_in_map(uv: vec2f) -> bool {
    return all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
}

fn map_texel_of_uv(uv: vec2f) -> vec2i {
    return clamp(vec2i(floor(uv * map_light_view.map_size)), vec2i(0), vec2i(map_light_view.map_size) - 1);
}

fn map_uv_of_texel(texel: vec2i) -> vec2f {
    return (vec2f(texel) + 0.5) / map_light_view.map_size;
}

fn map_depth_in_front(plane: space_ReceiverPlane, texel: vec2i, stored: f32) -> f32 {
    return map_light_view.depth_sign * (stored - space_plane_depth(map_light_view, plane, map_uv_of_texel(texel)));
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

fn map_widest_blur_texels(plane: space_ReceiverPlane, gap: f32, widest_tangent: f32) -> f32 {
    let rise_per_texel = length(plane.depth_per_uv / map_light_view.map_size);
    let texel_width = plane.surface_step / space_SURFACE_SLOPE;
    return 2.0 * max(gap, 0.0) / max(rise_per_texel, texel_width / widest_tangent);
}

fn map_gap_of(plane: space_ReceiverPlane, stored: f32) -> f32 {
    return map_light_view.depth_sign * (stored - plane.depth);
}

const map_ANY_GAP = 1e20;

fn map_lit_narrowed(plane: space_ReceiverPlane, uv: vec2f, width: f32, max_gap: f32) -> f32 {
    if !map_is_in_map(uv) {
        return 1.0;
    }
    return map_narrowed(map_quad_at(plane, uv), plane, width, vec2f(-map_ANY_GAP, max_gap));
}

fn map_narrowed(quad: map_Quad, plane: space_ReceiverPlane, width: f32, gaps: vec2f) -> f32 {
    let gap = map_light_view.depth_sign * (quad.stored - plane.depth);
    let lit = select(quad.lit, vec4f(1.0), (gap < vec4f(gaps.x)) | (gap > vec4f(gaps.y)));
    return space_bilinear(lit, saturate((quad.t - 0.5) / max(width, 0.001) + 0.5));
}

const receiver_light_MAX_COARSE_SINE = 0.0175;

fn receiver_light_coarse_grazing_sine(receiver: inputs_Receiver) -> f32 {
    let least = space_min_grazing_sine(map_light_view);
    if map_light_view.perspective == 0u {
        return least;
    }
    let rise = horizon_rise_above_center(horizon_half_axis_heights(receiver));
    return clamp(rise / distance(inputs_light_source.center_in_world, receiver.pos_in_world), least, receiver_light_MAX_COARSE_SINE);
}

fn receiver_light_faces_light_center(receiver: inputs_Receiver) -> bool {
    let towards = select(inputs_light_source.center_in_world - receiver.pos_in_world, -inputs_light_source.axis_in_world, inputs_light_source.kind == light_KIND_SUN);
    return dot(receiver.normal_in_world, towards) > 0.0;
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

fn space_plane_depth(view: space_LightViewGpu, plane: space_ReceiverPlane, uv: vec2f) -> f32 {
    return space_held(view, plane, vec4f(plane.depth + dot(plane.depth_per_uv, uv - plane.uv))).x;
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

const light_KIND_SPHERE = 2u;

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
