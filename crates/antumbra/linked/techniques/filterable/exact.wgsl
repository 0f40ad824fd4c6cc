// Linked from src/techniques/filterable/exact.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(3)
var depth_map: texture_depth_2d;

@group(1) @binding(4)
var<storage, read> weights: array<f32>;

fn lit_texel(plane: space_ReceiverPlane, texel: vec2i) -> f32 {
    let uv = (vec2f(texel) + 0.5) / map_light_view.map_size;
    let on_plane = map_light_view.depth_sign * space_plane_depth(map_light_view, plane, uv);
    var lit = 0.0;
    {
        lit = select(1.0, 0.0, map_light_view.depth_sign * textureLoad(depth_map, texel, 0) > on_plane);
    }
    return lit / f32(lookup_settings.sample_count);
}

struct Line {
    low: i32,
    high: i32,
    between: f32,
    scale: f32,
    size: i32
}

fn line_of(uv: f32, level_size: i32, map_size: i32) -> Line {
    let pos = uv * f32(level_size) - 0.5;
    let base = i32(floor(pos));
    return Line(clamp(base, 0, level_size - 1), clamp(base + 1, 0, level_size - 1), pos - floor(pos), f32(map_size) / f32(level_size), map_size);
}

fn kernel_integral(y: f32) -> f32 {
    let radius = i32(lookup_settings.kernel_radius);
    let held = clamp(y, f32(-radius - 1), f32(radius));
    let below = i32(floor(held));
    let first = 2 * radius + 1 + below + radius + 1;
    let last = i32(arrayLength(&weights)) - 1;
    return mix(weights[first], weights[min(first + 1, last)], held - f32(below));
}

fn weight_in(line: Line, level_texel: i32, i: i32) -> f32 {
    let low = f32(level_texel) * line.scale;
    return (kernel_integral(f32(i) - low) - kernel_integral(f32(i) - low - line.scale)) / line.scale;
}

fn weight_of(line: Line, i: i32) -> f32 {
    return (1.0 - line.between) * weight_in(line, line.low, i) + line.between * weight_in(line, line.high, i);
}

fn first_of(line: Line) -> i32 {
    return i32(f32(line.low) * line.scale) - i32(lookup_settings.kernel_radius);
}

fn end_of(line: Line) -> i32 {
    return i32(ceil(f32(line.high + 1) * line.scale)) + i32(lookup_settings.kernel_radius);
}

fn lit_bilinear_level(plane: space_ReceiverPlane, uv: vec2f, level: u32) -> f32 {
    let texels = lookup_level_size(level);
    let map_size = vec2i(map_light_view.map_size);
    let columns = line_of(uv.x, texels.x, map_size.x);
    let rows = line_of(uv.y, texels.y, map_size.y);
    var lit = 0.0;
    let radius = i32(lookup_settings.kernel_radius);
    let low = max(vec2i(first_of(columns), first_of(rows)), vec2i(-radius - 1));
    let high = min(vec2i(end_of(columns), end_of(rows)), map_size + radius + 1);
    for (var x = low.x; x < high.x; x++) {
        let weight_x = weight_of(columns, x);
        for (var y = low.y; y < high.y; y++) {
            let texel = clamp(vec2i(x, y), vec2i(0), map_size - 1);
            lit += weight_x * weight_of(rows, y) * lit_texel(plane, texel);
        }
    }
    return lit;
}

fn visibility(found: lookup_MapReceiver) -> f32 {
    if found.known >= 0.0 {
        return found.known;
    }
    let footprint = found.footprint;
    let last = lookup_settings.level_count - 1u;
    let level = min(u32(footprint.level), last);
    let between = footprint.level - f32(level);
    var sum = 0.0;
    for (var i = 0u; i < min(footprint.count, lookup_settings.max_anisotropy); i++) {
        let uv = footprint.uv + (f32(i) - 0.5 * f32(footprint.count - 1u)) * footprint.step;
        var probe = lit_bilinear_level(found.plane, uv, level);
        if between > 0.0 {
            probe = mix(probe, lit_bilinear_level(found.plane, uv, min(level + 1u, last)), between);
        }
        sum += probe;
    }
    return saturate(sum / f32(footprint.count));
}

@compute @workgroup_size(8, 8)
fn exact(@builtin(global_invocation_id) id: vec3u) {
    if inputs_is_inside(id.xy) {
        inputs_write_visibility(id.xy, visibility(lookup_map_receiver(id.xy)));
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

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

fn levels_level_size(map_size: vec2u, level: u32) -> vec2u {
    return map_size >> vec2u(level);
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

fn inputs_point_width_m(pixel: vec2u) -> f32 {
    return textureLoad(inputs_receiver_depth, inputs_receiver_view.origin_px + pixel, 0).w;
}

fn inputs_point_sides_m(receiver: inputs_Receiver, pixel: vec2u) -> array<vec3f, 2> {
    let n = receiver.normal_in_world;
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.5);
    let right = inputs_point_width_m(pixel) * normalize(cross(axis, n));
    return array<vec3f, 2>(right, cross(n, right));
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

@group(1) @binding(1)
var<uniform> lookup_settings: source_FilterUniform;

@group(1) @binding(5)
var<uniform> lookup_snapped_texels: f32;

const lookup_CLOSE_BIAS = 1.0 / 16.0;

const lookup_CLOSE_BIAS_OF_SNAPPED = 16.0;

fn lookup_close_bias() -> f32 {
    return clamp(lookup_CLOSE_BIAS_OF_SNAPPED * lookup_snapped_texels, lookup_CLOSE_BIAS, 1.0);
}

struct lookup_Footprint {
    uv: vec2f,
    step: vec2f,
    count: u32,
    level: f32
}

struct lookup_MapReceiver {
    known: f32,
    plane: space_ReceiverPlane,
    t: f32,
    t_close: f32,
    t_per_texel: vec2f,
    footprint: lookup_Footprint
}

fn lookup_uv_offset(receiver: inputs_Receiver, pixel: vec2u, depth: f32, neighbour: vec2u) -> vec2f {
    let a = inputs_position_in_world(neighbour, depth);
    let b = inputs_position_in_world(neighbour, select(0.5 * depth, 0.5 * depth + 0.5, depth < 0.5));
    let along = b - a;
    let fall = dot(along, receiver.normal_in_world);
    let least = 0.01 * length(along);
    let divisor = select(max(fall, least), min(fall, -least), fall < 0.0);
    let offset = a - receiver.pos_in_world - along * (dot(a - receiver.pos_in_world, receiver.normal_in_world) / divisor);
    return lookup_uv_of_step(receiver, offset);
}

fn lookup_uv_of_step(receiver: inputs_Receiver, offset: vec3f) -> vec2f {
    let p = space_light_from_world(map_light_view, receiver.pos_in_world);
    let d = space_light_from_world(map_light_view, map_light_view.origin_in_world + offset);
    let step = select(d.xy, (d.xy - p.xy / p.z * d.z) / p.z, map_light_view.perspective == 1u);
    return space_uv_step_of_plane(map_light_view, step);
}

fn lookup_sides_in_uv(receiver: inputs_Receiver, pixel: vec2u) -> array<vec2f, 2> {
    if inputs_are_points() {
        let sides = inputs_point_sides_m(receiver, pixel);
        return array<vec2f, 2>(lookup_uv_of_step(receiver, sides[0]), lookup_uv_of_step(receiver, sides[1]));
    }
    let depth = inputs_depth_at(pixel);
    return array<vec2f, 2>(lookup_uv_offset(receiver, pixel, depth, pixel + vec2u(1, 0)), lookup_uv_offset(receiver, pixel, depth, pixel + vec2u(0, 1)));
}

fn lookup_footprint_of(receiver: inputs_Receiver, pixel: vec2u, uv: vec2f) -> lookup_Footprint {
    if lookup_settings.level_count == 1u {
        return lookup_Footprint(uv, vec2f(), 1u, 0.0);
    }
    let sides = lookup_sides_in_uv(receiver, pixel);
    let dx = sides[0] * map_light_view.map_size;
    let dy = sides[1] * map_light_view.map_size;
    let xx = dx.x * dx.x + dy.x * dy.x;
    let xy = dx.x * dx.y + dy.x * dy.y;
    let yy = dx.y * dx.y + dy.y * dy.y;
    let middle = 0.5 * (xx + yy);
    let spread = length(vec2f(0.5 * (xx - yy), xy));
    let major = sqrt(middle + spread);
    let minor = sqrt(max(middle - spread, 0.0));
    let most = f32(lookup_settings.max_anisotropy);
    let count = clamp(ceil(major / max(minor, 1.0)), 1.0, most);
    let level = clamp(log2(max(major / count, 1.0)), 0.0, f32(lookup_settings.level_count - 1u));
    var axis = select(vec2f(xy, middle + spread - xx), vec2f(middle + spread - yy, xy), xx > yy);
    axis = select(vec2f(), normalize(axis), dot(axis, axis) > 1e-20);
    return lookup_Footprint(uv, axis * (major / count) / map_light_view.map_size, u32(count), level);
}

fn lookup_along_axis_per_uv(uv: vec2f, z_m: f32, z_per_uv: vec2f) -> vec2f {
    let axis = source_depth_direction(map_light_view, lookup_settings, uv);
    let across = vec2f(dot(axis.xy, map_light_view.plane_from_uv.xy), dot(axis.xy, map_light_view.plane_from_uv.zw));
    if map_light_view.perspective == 1u {
        return z_per_uv * dot(axis, vec3f(space_warped_plane(map_light_view, uv), 1.0)) + z_m * across;
    }
    return z_per_uv * axis.z + across;
}

fn lookup_map_receiver(pixel: vec2u) -> lookup_MapReceiver {
    let receiver = inputs_load_receiver(pixel);
    var found: lookup_MapReceiver;
    found.known = 1.0;
    if receiver.is_background {
        return found;
    }
    if !receiver.is_reached || !receiver_light_faces_light_center(receiver) {
        found.known = 0.0;
        return found;
    }
    found.plane = receiver_light_biased_plane(receiver, lookup_settings.bias_scale);
    if !map_is_in_map(found.plane.uv) {
        return found;
    }
    found.known = -1.0;
    let z_m = space_z_of_depth(map_light_view, found.plane.depth);
    found.t = max(source_t_at(map_light_view, lookup_settings, found.plane.uv, z_m) - 2.0 * lookup_settings.t_step, 0.0);
    let own_z_m = space_light_from_world(map_light_view, receiver.pos_in_world).z;
    let t_close = source_t_at(map_light_view, lookup_settings, found.plane.uv, mix(own_z_m, z_m, lookup_close_bias()));
    found.t_close = max(t_close - 2.0 * lookup_settings.t_step, 0.0);
    let z_per_depth = select(1.0, -z_m * z_m, map_light_view.perspective == 1u) / map_light_view.depth_scale;
    found.t_per_texel = lookup_along_axis_per_uv(found.plane.uv, z_m, found.plane.depth_per_uv * z_per_depth) / map_light_view.map_size / (lookup_settings.far_m - lookup_settings.near_m);
    found.footprint = lookup_footprint_of(receiver, pixel, found.plane.uv);
    return found;
}

fn lookup_level_size(level: u32) -> vec2i {
    return vec2i(levels_level_size(vec2u(map_light_view.map_size), level));
}

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

fn source_depth_direction(view: space_LightViewGpu, range: source_FilterUniform, uv: vec2f) -> vec3f {
    if source_IS_DISTANCE {
        return normalize(vec3f(space_warped_plane(view, uv), 1.0));
    }
    return range.depth_axis;
}

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
