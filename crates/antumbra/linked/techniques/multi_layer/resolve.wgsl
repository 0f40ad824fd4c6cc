// Linked from src/techniques/multi_layer/resolve.wesl by `cargo xtask shaders`: edit that, not this.

const MAX_LOOKUPS = 128u;

const MIN_SINE_NEAR_LIGHT = 0.008;

const OPAQUE = 0.998;

fn share_above_horizon(receiver: inputs_Receiver) -> f32 {
    if !settings_HAS_PLANES {
        return 1.0;
    }
    if inputs_light_source.kind == light_KIND_POINTS {
        return horizon_horizon_share_of_points(receiver);
    }
    return horizon_horizon_share(receiver);
}

fn nearness_to_plane(receiver: inputs_Receiver) -> f32 {
    if !settings_HAS_PLANES || inputs_light_source.kind == light_KIND_POINTS {
        return 0.0;
    }
    let rise = horizon_rise_above_center(horizon_half_axis_heights(receiver));
    return smoothstep(0.5, 1.0, rise / max(horizon_center_height(receiver), 1e-20));
}

fn footprint_texels(receiver: inputs_Receiver, pixel: vec2u) -> f32 {
    var width_m = 0.0;
    if inputs_are_points() {
        width_m = inputs_point_width_m(pixel);
    }
    else {
        let beside = inputs_position_in_world(pixel + vec2u(1u, 0u), inputs_depth_at(pixel));
        width_m = length(beside - receiver.pos_in_world);
    }
    return settings_multi_layer.footprint_px * width_m / space_texel_width_m(map_light_view, receiver.pos_in_world);
}

var<private> shown: vec4f;

fn visibility(receiver: inputs_Receiver, pixel: vec2u) -> vec3f {
    if receiver.is_background {
        return vec3f(1.0);
    }
    if !receiver.is_reached {
        return vec3f(0.0);
    }
    let above = share_above_horizon(receiver);
    if above <= 0.0 {
        return vec3f(0.0);
    }
    let nearness = nearness_to_plane(receiver);
    let min_sine = mix(receiver_light_coarse_grazing_sine(receiver), MIN_SINE_NEAR_LIGHT, nearness);
    var plane = receiver_light_biased_plane_within(receiver, 0.0, min_sine);
    plane.farthest_depth = plane.depth;
    let footprint = footprint_texels(receiver, pixel);
    let lookup = filter_size_Lookup(space_z_of_depth(map_light_view, saturate(plane.depth)), settings_multi_layer.filter_per_g, footprint * footprint, nearness);
    let seen = above * (1.0 - occluded_share(lookup, plane));
    if settings_SHOWS_LEVELS && shown.w > 0.0 {
        return hues_shaded_hue(shown.rgb / shown.w, seen);
    }
    return seen;
}

fn occluded_share(lookup: filter_size_Lookup, plane: space_ReceiverPlane) -> vec3f {
    var sum = vec3f();
    var left = occupied_occupied_rungs(lookup, plane);
    if all(left == vec4u(0u)) {
        return sum;
    }
    var so_far = occluders_NOTHING;
    var finer = occluders_NO_SHARE;
    var before = 0u;
    var lookups = 0u;
    loop {
        let part = select(select(select(3u, 2u, left.z != 0u), 1u, left.y != 0u), 0u, left.x != 0u);
        let left_of_part = select(select(select(left.w, left.z, left.z != 0u), left.y, left.y != 0u), left.x, left.x != 0u);
        let rung = firstTrailingBit(left_of_part);
        var shares: occluders_LevelShares;
        if settings_LISTS_APART == 1u {
            shares = level_level_shares_apart(lookup, plane, settings_ladder.rungs[rung], part);
        }
        else {
            shares = level_level_shares(lookup, plane, settings_ladder.rungs[rung], part);
        }
        if settings_SHOWS_LEVELS {
            shown += occluders_own_strength(shares) * vec4f(hues_hue_of(rung), 1.0);
        }
        if rung != before + 1u {
            so_far = occluders_accumulated(so_far, finer, occluders_NO_SHARE);
            finer = occluders_NO_SHARE;
        }
        if settings_WEIGHTS_FRAGMENTS {
            so_far.opacity = fragments_accumulate(occluders_between_levels(), so_far.opacity, shares.finer.occluder.opacity, 1.0);
        }
        else {
            so_far = occluders_accumulated(so_far, finer, shares.finer);
            so_far.opacity = settings_channels(so_far.opacity);
            finer = shares.coarser;
            finer.occluder.opacity = settings_channels(finer.occluder.opacity);
        }
        before = rung;
        let is_umbra = all(so_far.opacity >= vec3f(OPAQUE));
        let rest = select(left_of_part & (left_of_part - 1u), 0u, is_umbra);
        left = select(left, vec4u(rest), occupied_PARTS == vec4u(part));
        if rest == 0u {
            so_far = occluders_accumulated(so_far, finer, occluders_NO_SHARE);
            sum = settings_channels(sum + saturate(so_far.opacity));
            so_far = occluders_NOTHING;
            finer = occluders_NO_SHARE;
        }
        continuing {
            lookups++;
            break if all(left == vec4u(0u)) | (lookups >= MAX_LOOKUPS);
        }
    }
    return sum / f32(settings_LIGHT_PARTS);
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    let pixel = inputs_known_pixel(id.xy);
    if inputs_is_inside(pixel) {
        inputs_write_visibility_rgb(pixel, visibility(inputs_load_receiver(pixel), pixel));
    }
}

@compute @workgroup_size(64)
fn resolve_missing(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    for (var i = id.x; i < missing_missing_count(); i += 64u * workgroups.x) {
        let pixel = missing_missing_pixel(i);
        shown = vec4f();
        inputs_write_visibility_rgb(pixel, visibility(inputs_load_receiver(pixel), pixel));
    }
}

const bias_HALF_TEXEL = 0.5;

const bias_SNAPPED_TEXELS = 0.00390625;

fn bias_automatic_bias_m(texel_width_m: f32, grazing_sine: f32, bias_scale: f32) -> f32 {
    return bias_scale * texel_width_m * max(bias_HALF_TEXEL, bias_SNAPPED_TEXELS / grazing_sine);
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

fn horizon_horizon_share_of_points(receiver: inputs_Receiver) -> f32 {
    var above = 0.0;
    for (var i = 0u; i < inputs_light_source.point_count; i++) {
        above += select(0.0, 1.0, dot(inputs_light_data[i].xyz - receiver.pos_in_world, receiver.normal_in_world) > 0.0);
    }
    return above / f32(inputs_light_source.point_count);
}

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

const receiver_light_MAX_COARSE_SINE = 0.0175;

fn receiver_light_coarse_grazing_sine(receiver: inputs_Receiver) -> f32 {
    let least = space_min_grazing_sine(map_light_view);
    if map_light_view.perspective == 0u {
        return least;
    }
    let rise = horizon_rise_above_center(horizon_half_axis_heights(receiver));
    return clamp(rise / distance(inputs_light_source.center_in_world, receiver.pos_in_world), least, receiver_light_MAX_COARSE_SINE);
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

const fragments_EXPONENT_BIAS = 14;

const fragments_MANTISSA_BITS = 8;

const fragments_OVERLAP_STEPS = 4094.0;

const fragments_OVERLAP_STEPS_COLORED = 14.0;

const fragments_OVERLAP_BITS = 4095u;

fn fragments_power_of_two(exponent: i32) -> f32 {
    return bitcast<f32>(u32(exponent + 127) << 23u);
}

fn fragments_unpack_rgb8e4(bits: u32) -> vec3f {
    let m = vec3u(bits & 255u, (bits >> 8u) & 255u, (bits >> 16u) & 255u);
    return vec3f(m) * fragments_power_of_two(i32((bits >> 24u) & 15u) - fragments_EXPONENT_BIAS - fragments_MANTISSA_BITS);
}

fn fragments_unpack_opacity(bits: u32, colored: u32) -> vec3f {
    if colored == 1u {
        return fragments_unpack_rgb8e4(bits);
    }
    return vec3f(bitcast<f32>(bits & ~fragments_OVERLAP_BITS));
}

fn fragments_unpack_overlap(bits: u32, colored: u32) -> f32 {
    let share = select(f32(bits & fragments_OVERLAP_BITS) / fragments_OVERLAP_STEPS, f32(bits >> 28u) / fragments_OVERLAP_STEPS_COLORED, colored == 1u);
    return share / max(1.0 - share, 1.0 / fragments_OVERLAP_STEPS);
}

fn fragments_largest(color: vec3f) -> f32 {
    return max(color.r, max(color.g, color.b));
}

const fragments_ACCUMULATE_ADD = 0u;

const fragments_ACCUMULATE_MULTIPLY = 1u;

const fragments_ACCUMULATE_MAX = 2u;

const fragments_ACCUMULATE_OVERLAP = 3u;

fn fragments_common_opacity(a: vec3f, b: vec3f, overlap: f32) -> vec3f {
    return clamp(overlap * a * b, max(a + b - 1.0, vec3f(0.0)), min(a, b));
}

fn fragments_accumulate(mode: u32, a: vec3f, b: vec3f, overlap: f32) -> vec3f {
    switch mode {
        case fragments_ACCUMULATE_ADD {
            return min(a + b, vec3f(1.0));
        }
        case fragments_ACCUMULATE_MULTIPLY {
            return a + b - a * b;
        }
        case fragments_ACCUMULATE_OVERLAP {
            return a + b - fragments_common_opacity(a, b, overlap);
        }
        case default {
            return max(a, b);
        }
    }
}

@group(0) @binding(7)
var<storage, read> missing_missing: array<u32>;

fn missing_missing_count() -> u32 {
    return min(missing_missing[0], arrayLength(&missing_missing) - 1u);
}

fn missing_missing_pixel(i: u32) -> vec2u {
    let packed = missing_missing[i + 1u];
    return vec2u(packed & 65535u, packed >> 16u);
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

fn hues_hue_of(number: u32) -> vec3f {
    let hue = fract(f32(number) * 0.381966);
    return 0.25 + 0.75 * saturate(abs(fract(hue + vec3f(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0);
}

fn hues_shaded_hue(hue: vec3f, lit: vec3f) -> vec3f {
    return hue * (0.2 + 0.8 * lit);
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

fn inputs_write_visibility_rgb(pixel: vec2u, visibility: vec3f) {
    if inputs_receiver_view.mask_layers < 3u {
        inputs_store_mask(pixel, 0u, dot(visibility, inputs_LUMINANCE));
        return;
    }
    inputs_store_mask(pixel, 0u, visibility.r);
    inputs_store_mask(pixel, 1u, visibility.g);
    inputs_store_mask(pixel, 2u, visibility.b);
}

fn inputs_known_pixel(thread: vec2u) -> vec2u {
    return inputs_receiver_view.pixel_stride * thread;
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

struct filter_size_Lookup {
    z_m: f32,
    filter_per_g: f32,
    footprint_squared: f32,
    nearness_to_plane: f32
}

fn filter_size_g_of_z(lookup: filter_size_Lookup, z_m: f32) -> f32 {
    return select(lookup.z_m - z_m, 1.0 / z_m - 1.0 / lookup.z_m, map_light_view.perspective == 1u);
}

fn filter_size_z_of_filter(lookup: filter_size_Lookup, filter_squared: f32) -> f32 {
    let g = sqrt(max(filter_squared - lookup.footprint_squared, 0.0)) / lookup.filter_per_g;
    return select(lookup.z_m - g, 1.0 / (g + 1.0 / lookup.z_m), map_light_view.perspective == 1u);
}

fn filter_size_filter_squared_at(lookup: filter_size_Lookup, z_m: f32) -> f32 {
    let filter_size = lookup.filter_per_g * filter_size_g_of_z(lookup, z_m);
    return filter_size * filter_size + lookup.footprint_squared;
}

struct filter_size_Hat {
    z_near: f32,
    z_peak: f32,
    z_far: f32
}

fn filter_size_z_near_of(lookup: filter_size_Lookup, rung: settings_MultiLayerRung) -> f32 {
    return select(-3e38, filter_size_z_of_filter(lookup, rung.squared_coarser), rung.squared_coarser >= 0.0);
}

fn filter_size_hat_of(lookup: filter_size_Lookup, rung: settings_MultiLayerRung) -> filter_size_Hat {
    let z_finer = filter_size_z_of_filter(lookup, rung.squared_finer);
    return filter_size_Hat(filter_size_z_near_of(lookup, rung), filter_size_z_of_filter(lookup, rung.squared), select(lookup.z_m, z_finer, rung.squared_finer >= 0.0));
}

fn filter_size_place_between(lookup: filter_size_Lookup, finer_squared: f32, coarser_squared: f32, z_m: f32) -> f32 {
    switch settings_LEVEL_WEIGHTS {
        case settings_BY_VARIANCE {
            return saturate((filter_size_filter_squared_at(lookup, z_m) - finer_squared) / (coarser_squared - finer_squared));
        }
        case settings_BY_DEPTH {
            let z_finer = filter_size_z_of_filter(lookup, finer_squared);
            return saturate((z_finer - z_m) / max(z_finer - filter_size_z_of_filter(lookup, coarser_squared), 1e-20));
        }
        case default {
            return 0.0;
        }
    }
}

fn filter_size_own_weight(lookup: filter_size_Lookup, rung: settings_MultiLayerRung, z_peak: f32, z_m: f32) -> f32 {
    if z_m < z_peak {
        return 1.0 - filter_size_place_towards_coarser(lookup, rung, z_m);
    }
    return filter_size_place_towards_finer(lookup, rung, z_m);
}

fn filter_size_place_towards_coarser(lookup: filter_size_Lookup, rung: settings_MultiLayerRung, z_m: f32) -> f32 {
    if rung.squared_coarser < 0.0 {
        return 0.0;
    }
    return filter_size_place_between(lookup, rung.squared, rung.squared_coarser, z_m);
}

fn filter_size_place_towards_finer(lookup: filter_size_Lookup, rung: settings_MultiLayerRung, z_m: f32) -> f32 {
    if rung.squared_finer < 0.0 {
        return 1.0;
    }
    return filter_size_place_between(lookup, rung.squared_finer, rung.squared, z_m);
}

fn level_without(opacity: vec3f, own_opacity: f32) -> vec3f {
    return max(opacity - own_opacity, vec3f(0.0)) / max(1.0 - own_opacity, 1e-6);
}

fn level_level_shares(lookup: filter_size_Lookup, plane: space_ReceiverPlane, rung: settings_MultiLayerRung, part: u32) -> occluders_LevelShares {
    var shares = occluders_LevelShares(occluders_NO_SHARE, occluders_NO_SHARE);
    let hat = filter_size_hat_of(lookup, rung);
    let pos = receiver_plane_place_of(lookup, plane, rung, part);
    let base = floor(pos);
    let quad = lists_quad_at(rung, vec2i(base));
    let z_end = min(vec4f(hat.z_far + rung.epsilon_slope * hat.z_far + rung.epsilon_m), min(quad.z_end, receiver_plane_plane_z_at(plane, rung, base)));
    let place = lists_first_beyond(quad, hat.z_near).place;
    var a = lists_corner_at(place.x, quad.end.x, z_end.x);
    var b = lists_corner_at(place.y, quad.end.y, z_end.y);
    var c = lists_corner_at(place.z, quad.end.z, z_end.z);
    var d = lists_corner_at(place.w, quad.end.w, z_end.w);
    let t = pos - base;
    let weight = vec4f((1.0 - t.x) * (1.0 - t.y), t.x * (1.0 - t.y), (1.0 - t.x) * t.y, t.x * t.y);
    var nearest = min(min(a.z_m, b.z_m), min(c.z_m, d.z_m));
    if nearest >= hat.z_far {
        return shares;
    }
    let most = min(dot(quad.end - quad.first, vec4u(1u)), arrayLength(&lists_fragments));
    var before = map_light_view.near_m;
    var surfaces = 0u;
    loop {
        let limit = nearest + abs(rung.epsilon_slope * nearest) + rung.epsilon_m;
        var sum = lists_FragmentSum(0.0, 0.0, 0.0);
        let of_a = level_without(lists_take(&a, limit, weight.x, &sum), receiver_plane_own_opacity(lookup, plane, rung, base, before, limit));
        let of_b = level_without(lists_take(&b, limit, weight.y, &sum), receiver_plane_own_opacity(lookup, plane, rung, base + vec2f(1.0, 0.0), before, limit));
        let of_c = level_without(lists_take(&c, limit, weight.z, &sum), receiver_plane_own_opacity(lookup, plane, rung, base + vec2f(0.0, 1.0), before, limit));
        let of_d = level_without(lists_take(&d, limit, weight.w, &sum), receiver_plane_own_opacity(lookup, plane, rung, base + 1.0, before, limit));
        var surface = lists_between_lists(of_a, of_b, of_c, of_d, t, rung.width / rung.spacing);
        before = limit;
        let seen = receiver_plane_share_in_front(lookup, weight, z_end, nearest);
        surface.opacity = min(surface.opacity / seen, vec3f(1.0));
        surface.edge /= seen;
        let mean = select(vec2f(nearest, 1.0), vec2f(sum.z, sum.overlap) / max(sum.weight, 1e-20), sum.weight > 1e-6);
        shares = occluders_add_to_level(shares, lookup, rung, hat.z_peak, mean.x, surface, mean.y);
        nearest = min(min(a.z_m, b.z_m), min(c.z_m, d.z_m));
        continuing {
            surfaces++;
            break if (nearest >= hat.z_far) | (surfaces >= most);
        }
    }
    return shares;
}

fn level_level_shares_apart(lookup: filter_size_Lookup, plane: space_ReceiverPlane, rung: settings_MultiLayerRung, part: u32) -> occluders_LevelShares {
    var shares = occluders_LevelShares(occluders_NO_SHARE, occluders_NO_SHARE);
    let hat = filter_size_hat_of(lookup, rung);
    let pos = receiver_plane_place_of(lookup, plane, rung, part);
    let base = floor(pos);
    let quad = lists_quad_at(rung, vec2i(base));
    let z_end = min(vec4f(hat.z_far), min(quad.z_end, receiver_plane_plane_z_at(plane, rung, base)));
    let first = lists_first_beyond(quad, hat.z_near).place;
    let t = pos - base;
    let weight = vec4f((1.0 - t.x) * (1.0 - t.y), t.x * (1.0 - t.y), (1.0 - t.x) * t.y, t.x * t.y);
    let widths = rung.width / rung.spacing;
    let change_x = vec4f(t.y - 1.0, 1.0 - t.y, -t.y, t.y) * widths;
    let change_y = vec4f(t.x - 1.0, -t.x, 1.0 - t.x, t.x) * widths;
    for (var k = 0u; k < 4u; k++) {
        var list = occluders_LevelShares(occluders_NO_SHARE, occluders_NO_SHARE);
        let end = min(quad.end[k], arrayLength(&lists_fragments));
        for (var place = first[k]; place < end; place++) {
            let fragment = lists_fragments[place];
            let z_m = bitcast<f32>(fragment.x);
            if z_m >= z_end[k] {
                break;
            }
            let surface = occluders_Occluder(fragments_unpack_opacity(fragment.y, settings_COLORED), vec2f());
            list = occluders_add_to_level(list, lookup, rung, hat.z_peak, z_m, surface, lists_overlap_of(fragment.y));
        }
        let change = vec2f(change_x[k], change_y[k]);
        shares.coarser = occluders_of_list(shares.coarser, list.coarser, weight[k], change);
        shares.finer = occluders_of_list(shares.finer, list.finer, weight[k], change);
    }
    return shares;
}

@group(1) @binding(2)
var<storage, read> lists_lists: array<vec2u>;

@group(1) @binding(3)
var<storage, read> lists_fragments: array<vec2u>;

const lists_NONE = 3e38;

struct lists_Corner {
    z_m: f32,
    opacity_bits: u32,
    place: u32,
    end: u32,
    z_end: f32
}

fn lists_set_fragment(corner: ptr<function, lists_Corner>, fragment: vec2u) {
    let z_m = bitcast<f32>(fragment.x);
    (*corner).z_m = select(lists_NONE, z_m, z_m < (*corner).z_end);
    (*corner).opacity_bits = fragment.y;
}

fn lists_read_next(corner: ptr<function, lists_Corner>) {
    (*corner).place++;
    (*corner).z_m = lists_NONE;
    if (*corner).place < (*corner).end {
        lists_set_fragment(corner, lists_fragments[(*corner).place]);
    }
}

struct lists_Quad {
    first: vec4u,
    end: vec4u,
    z_end: vec4f
}

fn lists_quad_at(rung: settings_MultiLayerRung, texel: vec2i) -> lists_Quad {
    let last = vec2i(rung.size) - 1;
    let near = clamp(texel, vec2i(0), last);
    let far = clamp(texel + 1, vec2i(0), last);
    let near_row = rung.first + u32(near.y) * rung.size.x;
    let far_row = rung.first + u32(far.y) * rung.size.x;
    let a = lists_lists[near_row + u32(near.x)];
    let b = lists_lists[near_row + u32(far.x)];
    let c = lists_lists[far_row + u32(near.x)];
    let d = lists_lists[far_row + u32(far.x)];
    let is_inside = (vec4i(near.x, far.x, near.x, far.x) == vec4i(texel.x, texel.x + 1, texel.x, texel.x + 1)) & (vec4i(near.y, near.y, far.y, far.y) == vec4i(texel.y, texel.y, texel.y + 1, texel.y + 1));
    let first = vec4u(a.x, b.x, c.x, d.x);
    let end = first + select(vec4u(0u), vec4u(a.y, b.y, c.y, d.y), is_inside | vec4<bool>(map_light_view.complete_from_m > 0.0));
    return lists_Quad(first, end, select(vec4f(map_light_view.complete_from_m), vec4f(lists_NONE), is_inside));
}

struct lists_Found {
    place: vec4u,
    z_m: vec4f
}

const lists_MAX_HALVINGS = 33u;

fn lists_first_beyond(quad: lists_Quad, z_near: f32) -> lists_Found {
    var low = quad.first;
    var high = quad.end;
    var found = vec4f(lists_NONE);
    var halvings = 0u;
    loop {
        let middle = (low + high) / 2u;
        let z_m = bitcast<vec4f>(vec4u(lists_fragments[middle.x].x, lists_fragments[middle.y].x, lists_fragments[middle.z].x, lists_fragments[middle.w].x));
        let is_open = low < high;
        let is_near = is_open & (z_m <= vec4f(z_near));
        let is_far = is_open & (z_m > vec4f(z_near));
        low = select(low, middle + 1u, is_near);
        high = select(high, middle, is_far);
        found = select(found, z_m, is_far);
        continuing {
            halvings++;
            break if all(low >= high) | (halvings >= lists_MAX_HALVINGS);
        }
    }
    return lists_Found(low, found);
}

fn lists_corner_at(place: u32, end: u32, z_end: f32) -> lists_Corner {
    var corner = lists_Corner(lists_NONE, 0u, place, end, z_end);
    if place < end {
        lists_set_fragment(&corner, lists_fragments[place]);
    }
    return corner;
}

fn lists_overlap_of(bits: u32) -> f32 {
    return select(1.0, fragments_unpack_overlap(bits, settings_COLORED), settings_LIST_ACCUMULATION == fragments_ACCUMULATE_OVERLAP);
}

struct lists_FragmentSum {
    z: f32,
    overlap: f32,
    weight: f32
}

fn lists_take(corner: ptr<function, lists_Corner>, limit: f32, weight: f32, sum: ptr<function, lists_FragmentSum>) -> vec3f {
    var opacity = vec3f();
    if (*corner).z_m > limit {
        return opacity;
    }
    let end = min((*corner).end, arrayLength(&lists_fragments));
    var place = (*corner).place;
    loop {
        let a = fragments_unpack_opacity((*corner).opacity_bits, settings_COLORED);
        let overlap = lists_overlap_of((*corner).opacity_bits);
        opacity = settings_channels(fragments_accumulate(settings_LIST_ACCUMULATION, opacity, a, overlap));
        let strength = weight * fragments_largest(a);
        (*sum).z += strength * (*corner).z_m;
        (*sum).overlap += strength * overlap;
        (*sum).weight += strength;
        lists_read_next(corner);
        continuing {
            place++;
            break if !((*corner).z_m <= limit) | (place >= end);
        }
    }
    return opacity;
}

fn lists_between_lists(a: vec3f, b: vec3f, c: vec3f, d: vec3f, t: vec2f, width_in_lists: f32) -> occluders_Occluder {
    let most = vec4f(fragments_largest(a), fragments_largest(b), fragments_largest(c), fragments_largest(d));
    let change = vec2f(mix(most.y - most.x, most.w - most.z, t.y), mix(most.z - most.x, most.w - most.y, t.x));
    return occluders_Occluder(mix(mix(a, b, t.x), mix(c, d, t.x), t.y), width_in_lists * change);
}

struct occluders_Occluder {
    opacity: vec3f,
    edge: vec2f
}

struct occluders_Share {
    occluder: occluders_Occluder,
    place_sum: f32,
    strength: f32
}

const occluders_NOTHING = occluders_Occluder(vec3f(0.0), vec2f(0.0));

const occluders_NO_SHARE = occluders_Share(occluders_NOTHING, 0.0, 0.0);

struct occluders_LevelShares {
    coarser: occluders_Share,
    finer: occluders_Share
}

fn occluders_combined(a: occluders_Occluder, b: occluders_Occluder, overlap: f32) -> occluders_Occluder {
    let related = clamp(dot(a.edge, b.edge), -1.0, 1.0);
    let random = fragments_common_opacity(a.opacity, b.opacity, overlap);
    let extreme = select(max(a.opacity + b.opacity - 1.0, vec3f(0.0)), min(a.opacity, b.opacity), related > 0.0);
    let both = mix(random, extreme, abs(related));
    let random_edge = a.edge * (1.0 - fragments_largest(b.opacity)) + b.edge * (1.0 - fragments_largest(a.opacity));
    let larger = select(b.edge, a.edge, fragments_largest(a.opacity) > fragments_largest(b.opacity));
    let extreme_edge = select(a.edge + b.edge, larger, related > 0.0);
    return occluders_Occluder(settings_channels(a.opacity + b.opacity - both), mix(random_edge, extreme_edge, abs(related)));
}

fn occluders_combined_in_level(nearer: occluders_Occluder, farther: occluders_Occluder, overlap: f32) -> occluders_Occluder {
    if settings_LEVEL_ACCUMULATION == settings_CORRELATED && !settings_WEIGHTS_FRAGMENTS {
        return occluders_combined(nearer, farther, overlap);
    }
    let opacity = fragments_accumulate(settings_LIST_ACCUMULATION, nearer.opacity, farther.opacity, overlap);
    return occluders_Occluder(settings_channels(opacity), nearer.edge + farther.edge);
}

fn occluders_add_surface(share: occluders_Share, surface: occluders_Occluder, overlap: f32, place: f32) -> occluders_Share {
    let strength = fragments_largest(surface.opacity);
    return occluders_Share(occluders_combined_in_level(share.occluder, surface, overlap), share.place_sum + strength * place, share.strength + strength);
}

fn occluders_add_to_level(shares: occluders_LevelShares, lookup: filter_size_Lookup, rung: settings_MultiLayerRung, z_peak: f32, z_m: f32, surface: occluders_Occluder, overlap: f32) -> occluders_LevelShares {
    var sum = shares;
    if settings_WEIGHTS_FRAGMENTS {
        let weight = filter_size_own_weight(lookup, rung, z_peak, z_m);
        let own = occluders_Occluder(weight * surface.opacity, weight * surface.edge);
        sum.finer = occluders_add_surface(shares.finer, own, overlap, 0.0);
    }
    else if z_m < z_peak {
        sum.coarser = occluders_add_surface(shares.coarser, surface, overlap, filter_size_place_towards_coarser(lookup, rung, z_m));
    }
    else {
        sum.finer = occluders_add_surface(shares.finer, surface, overlap, filter_size_place_towards_finer(lookup, rung, z_m));
    }
    return sum;
}

fn occluders_own_strength(shares: occluders_LevelShares) -> f32 {
    if settings_WEIGHTS_FRAGMENTS {
        return shares.finer.strength;
    }
    return shares.finer.place_sum + shares.coarser.strength - shares.coarser.place_sum;
}

fn occluders_of_list(share: occluders_Share, list: occluders_Share, weight: f32, change: vec2f) -> occluders_Share {
    return occluders_Share(occluders_Occluder(share.occluder.opacity + weight * list.occluder.opacity, share.occluder.edge + change * fragments_largest(list.occluder.opacity)), share.place_sum + weight * list.place_sum, share.strength + weight * list.strength);
}

fn occluders_mean_place(share: occluders_Share) -> f32 {
    return share.place_sum / max(share.strength, 1e-20);
}

fn occluders_mixed(finer: occluders_Share, coarser: occluders_Share) -> occluders_Occluder {
    let finer_strength = fragments_largest(finer.occluder.opacity);
    let coarser_strength = fragments_largest(coarser.occluder.opacity);
    let place = (occluders_mean_place(finer) * finer_strength + occluders_mean_place(coarser) * coarser_strength) / max(finer_strength + coarser_strength, 1e-20);
    return occluders_Occluder(mix(finer.occluder.opacity, coarser.occluder.opacity, place), mix(finer.occluder.edge, coarser.occluder.edge, place));
}

fn occluders_accumulated(so_far: occluders_Occluder, finer: occluders_Share, coarser: occluders_Share) -> occluders_Occluder {
    let pair = occluders_mixed(finer, coarser);
    switch settings_LEVEL_ACCUMULATION {
        case settings_CORRELATED {
            return occluders_combined(so_far, pair, 1.0);
        }
        case settings_PAIRS {
            return occluders_Occluder(fragments_accumulate(fragments_ACCUMULATE_MULTIPLY, so_far.opacity, pair.opacity, 1.0), vec2f());
        }
        case settings_ADD {
            let sum = finer.occluder.opacity * (1.0 - occluders_mean_place(finer)) + coarser.occluder.opacity * occluders_mean_place(coarser);
            return occluders_Occluder(fragments_accumulate(fragments_ACCUMULATE_ADD, so_far.opacity, sum, 1.0), vec2f());
        }
        case settings_MULTIPLY {
            let a = finer.occluder.opacity * (1.0 - occluders_mean_place(finer));
            let b = coarser.occluder.opacity * occluders_mean_place(coarser);
            return occluders_Occluder(fragments_accumulate(fragments_ACCUMULATE_MULTIPLY, so_far.opacity, a + b - a * b, 1.0), vec2f());
        }
        case default {
            return occluders_Occluder(max(so_far.opacity, pair.opacity), vec2f());
        }
    }
}

fn occluders_between_levels() -> u32 {
    switch settings_LEVEL_ACCUMULATION {
        case settings_ADD {
            return fragments_ACCUMULATE_ADD;
        }
        case settings_MAX {
            return fragments_ACCUMULATE_MAX;
        }
        case default {
            return fragments_ACCUMULATE_MULTIPLY;
        }
    }
}

@group(1) @binding(4)
var<storage, read> occupied_nearest_in: array<f32>;

const occupied_PARTS = vec4u(0u, 1u, 2u, 3u);

fn occupied_nearest_about(plane: space_ReceiverPlane, rung: settings_MultiLayerRung) -> f32 {
    let map_size = vec2u(map_light_view.map_size);
    let count = (map_size + ((1u << rung.square_shift) - 1u)) >> vec2u(rung.square_shift);
    let last = vec2i(map_size) - 1;
    let pos = plane.uv * map_light_view.map_size;
    let near = vec2u(clamp(vec2i(floor(pos - rung.reach)), vec2i(0), last)) >> vec2u(rung.square_shift);
    let far = vec2u(clamp(vec2i(floor(pos + rung.reach)), vec2i(0), last)) >> vec2u(rung.square_shift);
    let near_row = rung.square_first + near.y * count.x;
    let far_row = rung.square_first + far.y * count.x;
    return min(min(occupied_nearest_in[near_row + near.x], occupied_nearest_in[near_row + far.x]), min(occupied_nearest_in[far_row + near.x], occupied_nearest_in[far_row + far.x]));
}

fn occupied_candidate_rungs(lookup: filter_size_Lookup, plane: space_ReceiverPlane) -> u32 {
    var candidates = 0u;
    for (var i = 0u; i < settings_multi_layer.rung_count; i++) {
        let rung = settings_ladder.rungs[i];
        let hat = filter_size_hat_of(lookup, rung);
        if hat.z_far <= map_light_view.near_m {
            break;
        }
        if hat.z_near < lookup.z_m && occupied_nearest_about(plane, rung) < hat.z_far {
            candidates |= 1u << i;
        }
    }
    return candidates;
}

fn occupied_occupied_rungs(lookup: filter_size_Lookup, plane: space_ReceiverPlane) -> vec4u {
    var occupied = vec4u();
    var candidates = occupied_candidate_rungs(lookup, plane);
    if candidates == 0u {
        return occupied;
    }
    loop {
        let i = firstTrailingBit(candidates);
        candidates &= candidates - 1u;
        let rung = settings_ladder.rungs[i];
        let hat = filter_size_hat_of(lookup, rung);
        let is_shared = rung.squared <= lookup.footprint_squared;
        for (var part = 0u; part < select(settings_LIGHT_PARTS, 1u, is_shared); part++) {
            let base = floor(receiver_plane_place_of(lookup, plane, rung, part));
            let quad = lists_quad_at(rung, vec2i(base));
            let found = lists_first_beyond(quad, hat.z_near);
            let z_end = min(quad.z_end, receiver_plane_plane_z_at(plane, rung, base));
            let is_occupied = any(found.z_m < min(vec4f(hat.z_far), z_end));
            let is_meant = (occupied_PARTS == vec4u(part)) | (vec4<bool>(is_shared) & (occupied_PARTS < vec4u(settings_LIGHT_PARTS)));
            occupied |= select(vec4u(0u), vec4u(1u << i), is_meant & vec4<bool>(is_occupied));
        }
        continuing {
        
            break if candidates == 0u;
        }
    }
    return occupied;
}

const receiver_plane_OWN_SURFACE_TEXELS = 1.0;

const receiver_plane_OTHER_SURFACE_TEXELS = 4.0;

const receiver_plane_MIN_IN_FRONT = 0.1;

fn receiver_plane_share_in_front(lookup: filter_size_Lookup, weight: vec4f, z_end: vec4f, z_m: f32) -> f32 {
    let is_in_front = vec4f(z_m) < z_end;
    if !settings_HAS_PLANES || all(is_in_front) {
        return 1.0;
    }
    let share = dot(weight, select(vec4f(0.0), vec4f(1.0), is_in_front));
    let texel_m = map_light_view.texel_in_plane * select(1.0, lookup.z_m, map_light_view.perspective == 1u);
    let gap_texels = (lookup.z_m - z_m) / texel_m;
    return mix(1.0, max(share, receiver_plane_MIN_IN_FRONT), smoothstep(receiver_plane_OWN_SURFACE_TEXELS, receiver_plane_OTHER_SURFACE_TEXELS, gap_texels));
}

fn receiver_plane_plane_z_at(plane: space_ReceiverPlane, rung: settings_MultiLayerRung, texel: vec2f) -> vec4f {
    if !settings_HAS_PLANES {
        return vec4f(space_z_of_depth(map_light_view, saturate(plane.depth)));
    }
    let uv_step = rung.spacing / map_light_view.map_size;
    let step = plane.depth_per_uv * uv_step;
    let near = plane.depth + dot(plane.depth_per_uv, (texel + rung.offset) * uv_step - plane.uv);
    let depth = space_held(map_light_view, plane, near + vec4f(0.0, step.x, step.y, step.x + step.y));
    return vec4f(space_z_of_depth(map_light_view, depth.x), space_z_of_depth(map_light_view, depth.y), space_z_of_depth(map_light_view, depth.z), space_z_of_depth(map_light_view, depth.w));
}

fn receiver_plane_own_opacity(lookup: filter_size_Lookup, plane: space_ReceiverPlane, rung: settings_MultiLayerRung, texel: vec2f, from_m: f32, to_m: f32) -> f32 {
    if lookup.nearness_to_plane * rung.merged <= 0.0 {
        return 0.0;
    }
    let place = (texel + rung.offset) * rung.spacing / map_light_view.map_size;
    let middle = map_light_view.depth_sign * (plane.depth + dot(plane.depth_per_uv, place - plane.uv));
    let per_texel = dot(abs(plane.depth_per_uv), 1.0 / map_light_view.map_size);
    let texels = sqrt(rung.merged * rung.merged + 1.0);
    let nearest = middle + 0.5 * (texels + 1.0) * per_texel;
    let range = max(texels * per_texel, 1e-20);
    let before = saturate((nearest - receiver_plane_own_depth(from_m)) / range);
    let within = saturate((nearest - receiver_plane_own_depth(to_m)) / range);
    return lookup.nearness_to_plane * (within - before);
}

fn receiver_plane_own_depth(fragment_m: f32) -> f32 {
    let bias = settings_multi_layer.bias_texels * map_light_view.texel_in_plane;
    let z_m = select(fragment_m - bias, fragment_m / (1.0 + bias), map_light_view.perspective == 1u);
    return map_light_view.depth_sign * space_depth_of_z(map_light_view, z_m);
}

fn receiver_plane_place_of(lookup: filter_size_Lookup, plane: space_ReceiverPlane, rung: settings_MultiLayerRung, part: u32) -> vec2f {
    var shift = vec2f();
    if settings_LIGHT_PARTS > 1u {
        let side = vec2f(vec2u(part & 1u, part >> 1u)) - 0.5;
        shift = side * sqrt(max(rung.squared - lookup.footprint_squared, 0.0));
    }
    return (plane.uv * map_light_view.map_size + shift) / rung.spacing - rung.offset;
}

struct settings_MultiLayerRung {
    size: vec2u,
    first: u32,
    spacing: f32,
    offset: f32,
    width: f32,
    epsilon_slope: f32,
    epsilon_m: f32,
    squared: f32,
    squared_finer: f32,
    squared_coarser: f32,
    reach: f32,
    square_shift: u32,
    square_first: u32,
    merged: f32,
    padding_0: u32
}

struct settings_MultiLayerLadder {
    rungs: array<settings_MultiLayerRung, 32>
}

struct settings_MultiLayerUniform {
    rung_count: u32,
    filter_per_g: f32,
    footprint_px: f32,
    bias_texels: f32
}

@group(1) @binding(1)
var<uniform> settings_multi_layer: settings_MultiLayerUniform;

@group(1) @binding(5)
var<uniform> settings_ladder: settings_MultiLayerLadder;

override settings_COLORED: u32 = 0u;

override settings_LIST_ACCUMULATION: u32 = 0u;

override settings_LEVEL_ACCUMULATION: u32 = 0u;

override settings_LIGHT_PARTS: u32 = 1u;

override settings_LEVEL_WEIGHTS: u32 = 0u;

override settings_WEIGHTS_FRAGMENTS: bool = false;

override settings_LISTS_APART: u32 = 0u;

override settings_HAS_PLANES: bool = true;

override settings_SHOWS_LEVELS: bool = false;

fn settings_channels(opacity: vec3f) -> vec3f {
    return select(opacity, opacity.xxx, settings_COLORED == 0u);
}

const settings_CORRELATED = 0u;

const settings_PAIRS = 1u;

const settings_ADD = 2u;

const settings_MULTIPLY = 3u;

const settings_MAX = 4u;

const settings_BY_VARIANCE = 0u;

const settings_BY_DEPTH = 1u;
