// Linked from src/techniques/summed/resolve.wesl with count by `cargo xtask shaders`: edit that, not this.

override HAS_HORIZON: bool = true;

override FOOTPRINT_ENDS: bool = true;

const FOOTPRINT_DEVIATIONS = 2.0;

var<private> search_reads: u32;

fn visibility(receiver: inputs_Receiver, pixel: vec2u) -> f32 {
    if receiver.is_background {
        return 1.0;
    }
    if !receiver.is_reached {
        return 0.0;
    }
    var above = horizon_horizon_share(receiver);
    if above <= 0.0 {
        return 0.0;
    }
    if !HAS_HORIZON {
        above = 1.0;
    }
    sums_tile_shift = uniform_soft.tile_log2;
    if sums_tile_shift == 0u {
        sums_tile_shift = sums_chosen_tile_log2();
    }
    let p = space_light_from_world(map_light_view, receiver.pos_in_world);
    let min_sine = receiver_light_coarse_grazing_sine(receiver);
    let extent = blocker_range_seen_extent(uniform_soft.light_extent, uniform_soft.light_extent_axis, p);
    let compared = compared_compared_of(receiver_light_biased_plane_within(receiver, uniform_soft.bias_scale, min_sine), space_receiver_plane_within(map_light_view, receiver.pos_in_world, receiver.normal_in_world, 0.0, min_sine), p.z, depth_range_depth_range(), extent);
    if !blocker_range_may_be_blocked(compared.own_depth) {
        return above;
    }
    let blockers = search_search_blockers(compared);
    search_reads = sums_reads;
    let grown = extent / max(uniform_soft.light_extent, vec2f(1e-20));
    let on_plane = uniform_soft.light_covariance * vec3f(grown.x * grown.x, grown.x * grown.y, grown.y * grown.y);
    var covariance = soft_kernel_light_covariance_texels(on_plane, compared.plane.uv, blockers.x);
    var footprint = vec3f();
    if uniform_soft.with_footprint == 1u {
        if FOOTPRINT_ENDS {
            footprint = soft_kernel_ending_footprint_covariance(receiver, compared.plane.uv, pixel);
        }
        else {
            footprint = soft_kernel_footprint_covariance(receiver, compared.plane.uv, pixel);
        }
        covariance += footprint;
    }
    else if blockers.y <= 0.0 {
        return above;
    }
    let center_uv = compared.plane.uv + space_uv_step_at(map_light_view, compared.plane.uv, uniform_soft.light_mean * blockers.x);
    let center = center_uv * map_light_view.map_size;
    let kernel = soft_kernel_kernel_of_covariance(center, covariance, uniform_soft.is_ellipse == 1u);
    let footprint_texels = FOOTPRINT_DEVIATIONS * sqrt(max(footprint.x, footprint.z));
    return above * kernel_kernel_lit(compared_asking_of_kernel(compared, blockers.x, footprint_texels), kernel);
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    let pixel = inputs_known_pixel(id.xy);
    if inputs_is_inside(pixel) {
        let lit = visibility(inputs_load_receiver(pixel), pixel);
        inputs_write_visibility_rgb(pixel, vec3f(f32(search_reads), f32(sums_reads - search_reads), kernel_kernel_texels));
    }
}

@compute @workgroup_size(64)
fn resolve_missing(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    for (var i = id.x; i < missing_missing_count(); i += 64u * workgroups.x) {
        let pixel = missing_missing_pixel(i);
        inputs_write_visibility(pixel, visibility(inputs_load_receiver(pixel), pixel));
    }
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

fn blocker_range_gauge(offset: vec2f, extent: vec2f) -> f32 {
    let p = abs(offset) / max(extent, vec2f(1e-20));
    switch inputs_light_source.kind {
        case light_KIND_RECTANGLE {
            return max(p.x, p.y);
        }
        case light_KIND_POINTS {
            return 1.0;
        }
        case default {
            return length(p);
        }
    }
}

fn blocker_range_may_be_blocked(own_depth: f32) -> bool {
    let nearest = blocker_range_nearest_depth(vec2f(0.5), vec2f(0.5));
    return map_light_view.depth_sign * (nearest - saturate(own_depth)) > 0.0;
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

fn map_lit_bilinear(plane: space_ReceiverPlane, uv: vec2f) -> f32 {
    if !map_is_in_map(uv) {
        return 1.0;
    }
    let quad = map_quad_at(plane, uv);
    return space_bilinear(quad.lit, quad.t);
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

fn receiver_light_biased_plane_within(receiver: inputs_Receiver, bias_scale: f32, min_sine: f32) -> space_ReceiverPlane {
    let sine = max(space_grazing_sine(map_light_view, receiver.pos_in_world, receiver.normal_in_world), min_sine);
    let bias_m = bias_automatic_bias_m(space_texel_width_m(map_light_view, receiver.pos_in_world), sine, bias_scale);
    return space_receiver_plane_within(map_light_view, receiver.pos_in_world, receiver.normal_in_world, bias_m, min_sine);
}

struct soft_kernel_SoftKernel {
    center: vec2f,
    half_size: vec2f,
    shear: f32,
    is_ellipse: bool
}

const soft_kernel_MAX_FOOTPRINT_TEXELS = 512.0;

fn soft_kernel_unproject(ndc: vec2f, depth: f32) -> vec3f {
    let p = inputs_receiver_view.view_from_clip * vec4f(ndc, depth, 1.0);
    return (inputs_receiver_view.world_from_view * vec4f(p.xyz / p.w, 1.0)).xyz;
}

fn soft_kernel_texels_of_step(receiver: inputs_Receiver, uv: vec2f, step_in_world: vec3f) -> vec2f {
    let step = vec3f(dot(step_in_world, map_light_view.right_in_world), dot(step_in_world, map_light_view.up_in_world), dot(step_in_world, map_light_view.axis_in_world));
    let p = space_light_from_world(map_light_view, receiver.pos_in_world);
    let in_plane = select(step.xy, (step.xy - p.xy / p.z * step.z) / p.z, map_light_view.perspective == 1u);
    let texels = space_uv_step_at(map_light_view, uv, in_plane) * map_light_view.map_size;
    return texels * min(1.0, soft_kernel_MAX_FOOTPRINT_TEXELS / max(length(texels), 1e-6));
}

fn soft_kernel_footprint_step(receiver: inputs_Receiver, uv: vec2f, pixel: vec2u, offset_px: vec2f) -> vec2f {
    let ndc = (vec2f(pixel) + 0.5 + offset_px) / vec2f(inputs_receiver_view.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let a = soft_kernel_unproject(ndc, 1.0 - inputs_receiver_view.background_depth);
    let ray = soft_kernel_unproject(ndc, inputs_depth_at(pixel)) - a;
    let facing = dot(ray, receiver.normal_in_world);
    let t = dot(receiver.pos_in_world - a, receiver.normal_in_world) / min(facing, -0.0001 * length(ray));
    return soft_kernel_texels_of_step(receiver, uv, a + ray * t - receiver.pos_in_world);
}

const soft_kernel_SHARE_AT_EDGE = 0.75;

fn soft_kernel_share_towards(receiver: inputs_Receiver, pixel: vec2u, step_px: vec2i) -> f32 {
    let neighbour = vec2u(clamp(vec2i(pixel) + step_px, vec2i(0), vec2i(inputs_receiver_view.size_px) - 1));
    let depth = inputs_depth_at(neighbour);
    if depth == inputs_receiver_view.background_depth {
        return soft_kernel_SHARE_AT_EDGE;
    }
    let position = inputs_position_in_world(neighbour, depth);
    let step = position - receiver.pos_in_world;
    if abs(dot(step, receiver.normal_in_world)) <= 0.25 * length(step) {
        return 1.0;
    }
    let normal = inputs_geometric_normal(neighbour, position, depth);
    let here = dot(normal, step) / min(dot(normal, inputs_camera_ray(position)), -1e-20);
    let there = dot(receiver.normal_in_world, step) / min(dot(receiver.normal_in_world, inputs_camera_ray(receiver.pos_in_world)), -1e-20);
    return select(soft_kernel_SHARE_AT_EDGE, min(2.0 * here / (here - there), 1.0), here * there < 0.0);
}

fn soft_kernel_square_covariance(x: vec2f, y: vec2f) -> vec3f {
    return vec3f(x.x * x.x + y.x * y.x, x.x * x.y + y.x * y.y, x.y * x.y + y.y * y.y) / 12.0;
}

fn soft_kernel_ending_footprint_covariance(receiver: inputs_Receiver, uv: vec2f, pixel: vec2u) -> vec3f {
    let sides = soft_kernel_footprint_sides(receiver, uv, pixel);
    if inputs_are_points() {
        return soft_kernel_square_covariance(sides[0], sides[1]);
    }
    var shares = vec4f();
    for (var i = 0u; i < 4u; i++) {
        let step = select(-1, 1, (i & 1u) == 1u);
        shares[i] = soft_kernel_share_towards(receiver, pixel, select(vec2i(0, step), vec2i(step, 0), i < 2u));
    }
    let size_px = min(shares.xz, shares.yw);
    return soft_kernel_square_covariance(size_px.x * sides[0], size_px.y * sides[1]);
}

fn soft_kernel_footprint_sides(receiver: inputs_Receiver, uv: vec2f, pixel: vec2u) -> array<vec2f, 2> {
    if inputs_are_points() {
        let sides = inputs_point_sides_m(receiver, pixel);
        return array<vec2f, 2>(soft_kernel_texels_of_step(receiver, uv, sides[0]), soft_kernel_texels_of_step(receiver, uv, sides[1]));
    }
    return array<vec2f, 2>(2.0 * soft_kernel_footprint_step(receiver, uv, pixel, vec2f(0.5, 0.0)), 2.0 * soft_kernel_footprint_step(receiver, uv, pixel, vec2f(0.0, 0.5)));
}

fn soft_kernel_footprint_covariance(receiver: inputs_Receiver, uv: vec2f, pixel: vec2u) -> vec3f {
    let sides = soft_kernel_footprint_sides(receiver, uv, pixel);
    return soft_kernel_square_covariance(sides[0], sides[1]);
}

fn soft_kernel_light_covariance_texels(on_plane: vec3f, uv: vec2f, g: f32) -> vec3f {
    let right = g * space_uv_step_at(map_light_view, uv, vec2f(1.0, 0.0)) * map_light_view.map_size;
    let up = g * space_uv_step_at(map_light_view, uv, vec2f(0.0, 1.0)) * map_light_view.map_size;
    return on_plane.x * vec3f(right.x * right.x, right.x * right.y, right.y * right.y) + on_plane.y * vec3f(2.0 * right.x * up.x, right.x * up.y + right.y * up.x, 2.0 * right.y * up.y) + on_plane.z * vec3f(up.x * up.x, up.x * up.y, up.y * up.y);
}

fn soft_kernel_kernel_of_covariance(center: vec2f, covariance: vec3f, is_ellipse: bool) -> soft_kernel_SoftKernel {
    let yy = max(covariance.z, 1e-8);
    let shear = covariance.y / yy;
    let across = max(covariance.x - covariance.y * shear, 0.0);
    let half_size = select(sqrt(3.0), 2.0, is_ellipse) * sqrt(vec2f(across, max(covariance.z, 0.0)));
    return soft_kernel_SoftKernel(center, half_size, select(shear, 0.0, covariance.z < 1e-8), is_ellipse);
}

fn soft_kernel_row_half_width(kernel: soft_kernel_SoftKernel, y: f32) -> f32 {
    if !kernel.is_ellipse {
        return kernel.half_size.x;
    }
    let v = y / max(kernel.half_size.y, 1e-6);
    return kernel.half_size.x * sqrt(max(1.0 - v * v, 0.0));
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

fn space_plane_step_of_uv(view: space_LightViewGpu, uv: vec2f, uv_step: vec2f) -> vec2f {
    let in_warp = view.plane_from_uv.xy * uv_step.x + view.plane_from_uv.zw * uv_step.y;
    if !space_is_warped(view) {
        return in_warp;
    }
    let from_center = space_warped_plane(view, uv) / space_inverse_divisor(view, uv);
    return (in_warp + from_center * dot(view.warp, in_warp)) / space_inverse_divisor(view, uv + uv_step);
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

@group(0) @binding(7)
var<storage, read> missing_missing: array<u32>;

fn missing_missing_count() -> u32 {
    return min(missing_missing[0], arrayLength(&missing_missing) - 1u);
}

fn missing_missing_pixel(i: u32) -> vec2u {
    let packed = missing_missing[i + 1u];
    return vec2u(packed & 65535u, packed >> 16u);
}

const convolution_PI = 3.141592653589793;

fn convolution_convolution_frequency(k: u32) -> f32 {
    return (2.0 * f32(k) - 1.0) * convolution_PI;
}

fn convolution_convolution_term(filtered: vec2f, t: f32, k: u32) -> f32 {
    let c = convolution_convolution_frequency(k);
    return 2.0 / c * (filtered.x * cos(c * t) - filtered.y * sin(c * t));
}

fn convolution_convolution_offset(term_count: u32) -> f32 {
    return 0.5 / f32(term_count);
}

fn convolution_convolution_visibility(term_sum: f32) -> f32 {
    return saturate(0.5 + term_sum);
}

fn convolution_convolution_blocker_depth(mean: f32, z_term_sum: f32, t: f32, visibility: f32) -> f32 {
    return variance_blocker_depth_of_sums(mean, 0.5 * mean + z_term_sum, t, visibility);
}

fn exponential_variance_warp_exponential(t: f32, c: vec2f) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(exp(c.x * u), -exp(-c.y * u));
}

fn exponential_variance_exponential_bound(moments: vec2f, warped_t: f32, c: f32, least_deviation: f32) -> f32 {
    let least = 2.0 * c * warped_t * least_deviation;
    let variance = max(moments.y - moments.x * moments.x, least * least);
    return variance_chebyshev(moments.x, variance, warped_t);
}

fn exponential_variance_exponential_variance_visibility_4(filtered: vec4f, t: f32, c: vec2f, least_variance: f32) -> f32 {
    let w = exponential_variance_warp_exponential(t, c);
    let deviation = sqrt(least_variance);
    return min(exponential_variance_exponential_bound(filtered.xy, w.x, c.x, deviation), exponential_variance_exponential_bound(filtered.zw, w.y, c.y, deviation));
}

fn exponential_variance_exponential_variance_blocker_depth(filtered: vec4f, t: f32, c: vec2f, visibility: f32) -> f32 {
    let blocked = 1.0 - visibility;
    if blocked < 0.0001 {
        return t;
    }
    let w = exponential_variance_warp_exponential(t, c);
    let nearest = exponential_variance_warp_exponential(0.0, c);
    let positive = clamp((filtered.x - visibility * w.x) / blocked, nearest.x, w.x);
    let negative = clamp((filtered.z - visibility * w.y) / blocked, nearest.y, w.y);
    let u = vec2f(log(positive), -log(-negative)) / c;
    return clamp(0.25 * (u.x + u.y) + 0.5, 0.0, t);
}

fn moment_dequantize_moments(q: vec4f) -> vec4f {
    let odd = q.xz - 0.5;
    return vec4f(-0.3333333 * odd.x + 1.7320508 * odd.y, 0.125 * q.y + q.w, -0.75 * odd.x + 1.2990381 * odd.y, q.w - 0.125 * q.y);
}

fn moment_bias_moments(m: vec4f, amount: f32) -> vec4f {
    return mix(m, vec4f(0.0, 0.375, 0.0, 0.375), amount);
}

struct moment_Blocked {
    share: f32,
    mean_u: f32
}

fn moment_other_points(m: vec4f, u: f32) -> vec2f {
    let d22 = max(m.y - m.x * m.x, 1e-9);
    let l32_d22 = m.z - m.x * m.y;
    let l32 = l32_d22 / d22;
    let d33 = max(m.w - m.y * m.y - l32 * l32_d22, 1e-9);
    var c = vec3f(1.0, u, u * u);
    c.y -= m.x;
    c.z -= m.y + l32 * c.y;
    c.y /= d22;
    c.z /= d33;
    c.y -= l32 * c.z;
    c.x -= m.x * c.y + m.y * c.z;
    let leading = select(min(c.z, -1e-6), max(c.z, 1e-6), c.z >= 0.0);
    let half = -0.5 * c.y / leading;
    let root = sqrt(max(half * half - c.x / leading, 0.0));
    return vec2f(half - root, half + root);
}

fn moment_product_2(m: vec4f, a: f32, b: f32) -> f32 {
    return m.y - (a + b) * m.x + a * b;
}

fn moment_apart(difference: f32) -> f32 {
    return select(min(difference, -1e-6), max(difference, 1e-6), difference >= 0.0);
}

fn moment_hamburger(m: vec4f, u: f32) -> moment_Blocked {
    let x = moment_other_points(m, u);
    var share = 0.0;
    var sum = 0.0;
    if x.x < u {
        let weight = saturate(moment_product_2(m, u, x.y) / moment_apart((x.x - u) * (x.x - x.y)));
        share += weight;
        sum += weight * x.x;
    }
    if x.y < u {
        let weight = saturate(moment_product_2(m, u, x.x) / moment_apart((x.y - u) * (x.y - x.x)));
        share += weight;
        sum += weight * x.y;
    }
    return moment_Blocked(saturate(share), select(u, sum / max(share, 1e-6), share > 1e-6));
}

fn moment_moment_blocker_depth(blocked: moment_Blocked, t: f32) -> f32 {
    return clamp(0.5 * blocked.mean_u + 0.5, 0.0, t);
}

struct variance_MeanVariance {
    mean: f32,
    variance: f32
}

fn variance_mean_variance(filtered: vec2f) -> variance_MeanVariance {
    let u = 2.0 * filtered.x - 1.0;
    return variance_MeanVariance(filtered.x, max(0.25 * (filtered.y - u * u), 0.0));
}

fn variance_minimum_variance(t_per_texel: vec2f, quantum: f32) -> f32 {
    let spread = 8.0 * quantum;
    return 0.25 * dot(t_per_texel, t_per_texel) + spread * spread;
}

fn variance_chebyshev(mean: f32, variance: f32, t: f32) -> f32 {
    let beyond = t - mean;
    if beyond <= 0.0 {
        return 1.0;
    }
    return select(variance / (variance + beyond * beyond), 1.0, variance + beyond * beyond == 0.0);
}

fn variance_variance_visibility(filtered: vec2f, t: f32, least_variance: f32) -> f32 {
    let distribution = variance_mean_variance(filtered);
    return variance_chebyshev(distribution.mean, max(distribution.variance, least_variance), t);
}

fn variance_reduce_bleeding(visibility: f32, amount: f32) -> f32 {
    return saturate((visibility - amount) / (1.0 - amount));
}

fn variance_mean_blocker_depth(mean: f32, t: f32, visibility: f32) -> f32 {
    return variance_blocker_depth_of_sums(mean, visibility * t, t, visibility);
}

fn variance_blocker_depth_of_sums(mean: f32, lit_sum: f32, t: f32, visibility: f32) -> f32 {
    let blocked = 1.0 - visibility;
    if blocked < 0.0001 {
        return t;
    }
    return clamp((mean - lit_sum) / blocked, 0.0, t);
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

fn inputs_write_visibility(pixel: vec2u, visibility: f32) {
    for (var layer = 0u; layer < inputs_receiver_view.mask_layers; layer++) {
        inputs_store_mask(pixel, layer, visibility);
    }
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

@group(3) @binding(1)
var basis_visibility_tiles: texture_2d<f32>;

override basis_visibility_IS_MIPS: bool = false;

const basis_visibility_TILE_TOLERANCE = 0.002;

const basis_visibility_MAX_TILT = 0.7;

const basis_visibility_MAX_BEHIND = 1.0;

const basis_visibility_TERM_COUNT = 4u;

const basis_visibility_MOMENT_BIAS = 6e-5;

const basis_visibility_WHOLE = 0u;

const basis_visibility_CUT_ONCE = 1u;

const basis_visibility_CUT_ALL_ROUND = 2u;

const basis_visibility_FARTHEST_ROUNDING = 0.05;

struct basis_visibility_Answer {
    lit: f32,
    blocker_g: f32,
    is_good: bool
}

fn basis_visibility_summed_piece(texels: sums_Texels, cuts: u32) -> sums_Piece {
    let with_cuts = select(1.0, 0.0, cuts == basis_visibility_WHOLE);
    return sums_Piece(vec2f(texels.low) - with_cuts * texels.cut_low, vec2f(texels.high) + with_cuts * texels.cut_high);
}

fn basis_visibility_summed_count(texels: sums_Texels, cuts: u32) -> f32 {
    switch cuts {
        case basis_visibility_WHOLE {
            return sums_area(basis_visibility_summed_piece(texels, basis_visibility_WHOLE));
        }
        case basis_visibility_CUT_ONCE {
            return sums_count_of(texels);
        }
        case default {
            return sums_area(basis_visibility_summed_piece(texels, basis_visibility_CUT_ALL_ROUND));
        }
    }
}

fn basis_visibility_sum_of(which: u32, texels: sums_Texels, cuts: u32) -> vec4f {
    if cuts == basis_visibility_CUT_ALL_ROUND {
        return sums_all_cut_sum(which, texels);
    }
    return sums_row_sum(which, texels, cuts == basis_visibility_CUT_ONCE);
}

fn basis_visibility_mean_of_exponential(a: f32) -> f32 {
    let s = a * a;
    return 1.0 + s * (1.0 / 6.0 + s * (1.0 / 120.0));
}

fn basis_visibility_is_too_tilted(tilt: vec2f) -> bool {
    return !(abs(tilt.x) + abs(tilt.y) <= basis_visibility_MAX_TILT);
}

struct basis_visibility_Exponentials {
    lit: f32,
    offset: f32,
    is_planar: bool
}

fn basis_visibility_exponentials_of(sums: vec4f, count: f32) -> basis_visibility_Exponentials {
    let blocked = sums.w - sums.x;
    let is_planar = blocked >= -uniform_soft.non_planar * sums.w - 0.001 * count;
    let is_lit = blocked <= 2.0 * basis_visibility_TILE_TOLERANCE * count;
    let offset = min((sums.z - sums.y) / max(blocked, 1e-20), 0.0);
    return basis_visibility_Exponentials(select(saturate(1.0 - blocked / max(count, 1e-6)), 1.0, is_lit), select(offset, 0.0, is_lit), is_planar);
}

fn basis_visibility_tile_answer(compared: compared_Compared, texels: sums_Texels, cuts: u32, part: vec4f) -> basis_visibility_Answer {
    let place = texels.low >> vec2u(sums_tile_shift);
    sums_note_reads(1u);
    let tile = textureLoad(basis_visibility_tiles, place, 0);
    let summed = basis_visibility_summed_piece(texels, cuts);
    let center = sums_middle(summed);
    let bare = compared_bare_plane_at(compared, center);
    let own = tile_basis_nearness(bare.depth);
    let plane = tile_basis_plane_nearness(tile, center - vec2f(place << vec2u(sums_tile_shift)));
    let ahead = tile_basis_exponent_between(plane, own);
    let own_step = bare.step / map_light_view.depth_scale * select(-1.0, 1.0, map_light_view.perspective == 1u);
    let is_perspective = map_light_view.perspective == 1u;
    let tilt = 0.5 * uniform_soft.exponent * (own_step / select(1.0, own, is_perspective) - tile.yz / select(1.0, plane, is_perspective)) * (summed.high - summed.low);
    let gain = exp(clamp(ahead, -80.0, 80.0)) / (basis_visibility_mean_of_exponential(tilt.x) * basis_visibility_mean_of_exponential(tilt.y));
    let is_even = !basis_visibility_is_too_tilted(tilt) || gain * part.x <= basis_visibility_TILE_TOLERANCE * part.w;
    let has_casters = tile.w >= 0.0;
    let is_precise = !has_casters || (gain < 2.0 * basis_visibility_TILE_TOLERANCE * uniform_soft.value_scale && is_even);
    let sums = vec4f(gain * part.x, gain * (ahead * part.x - part.y), ahead * part.w - tile.w * part.z, part.w);
    let found = basis_visibility_exponentials_of(select(vec4f(), sums, has_casters), basis_visibility_summed_count(texels, cuts));
    let is_one_sided = !has_casters || ahead <= basis_visibility_MAX_BEHIND || found.lit <= 2.0 * basis_visibility_TILE_TOLERANCE;
    let blocker = select(own - found.offset / uniform_soft.exponent, own * exp(-found.offset / uniform_soft.exponent), is_perspective);
    let own_nearness = select(-compared.z_m, 1.0 / compared.z_m, is_perspective);
    return basis_visibility_Answer(found.lit, blocker - own_nearness, found.is_planar && is_precise && is_one_sided);
}

fn basis_visibility_exponential_answer(compared: compared_Compared, summed: sums_Piece, count: f32, s: vec4f, z: f32, t_step: vec2f) -> basis_visibility_Answer {
    let c = uniform_soft.exponent;
    let t = depth_range_t_of_z(compared.range, z);
    let tilt = 0.5 * c * t_step * (summed.high - summed.low);
    let gain = exp(clamp(c * (1.0 - t), -80.0, 80.0)) / (basis_visibility_mean_of_exponential(tilt.x) * basis_visibility_mean_of_exponential(tilt.y));
    let sums = vec4f(gain * s.x, gain * c * (s.y - t * s.x), c * (s.z - t * s.w), s.w);
    let found = basis_visibility_exponentials_of(sums, count);
    let blocker_z = z + found.offset / c * (compared.range.far_m - compared.range.near_m);
    return basis_visibility_Answer(found.lit, compared_g_of_z(compared, blocker_z), found.is_planar && !basis_visibility_is_too_tilted(tilt));
}

fn basis_visibility_basis_answer(compared: compared_Compared, piece: sums_Piece, cuts: u32) -> basis_visibility_Answer {
    let inside = sums_Piece(clamp(piece.low, vec2f(0.0), map_light_view.map_size), clamp(piece.high, vec2f(0.0), map_light_view.map_size));
    var asked = inside;
    if uniform_BASIS == uniform_BASIS_TILES {
        asked = piece;
    }
    let texels = sums_texels_of(asked);
    var sum: vec4f;
    if !basis_visibility_IS_MIPS {
        sum = basis_visibility_sum_of(0u, texels, cuts);
    }
    if uniform_BASIS == uniform_BASIS_TILES {
        return basis_visibility_tile_answer(compared, texels, cuts, sum);
    }
    let summed = basis_visibility_summed_piece(texels, cuts);
    let count = basis_visibility_summed_count(texels, cuts);
    let bare = compared_bare_plane_at(compared, sums_middle(summed));
    let z = space_z_of_depth(map_light_view, bare.depth);
    let slope = select(1.0, -z * z, map_light_view.perspective == 1u) / map_light_view.depth_scale;
    let range_m = compared.range.far_m - compared.range.near_m;
    let t = depth_range_t_of_z(compared.range, z);
    let t_step = slope / range_m * bare.step;
    if uniform_BASIS == uniform_BASIS_EXPONENTIAL {
        return basis_visibility_exponential_answer(compared, summed, count, sum, z, t_step);
    }
    var mean = sum / max(count, 1e-6);
    let spread = t_step * (summed.high - summed.low);
    let quantum = 1.0 / uniform_soft.value_scale;
    let least_variance = dot(spread, spread) / 12.0 + variance_minimum_variance(t_step, quantum);
    let max_lit = select(1.0, 0.0, depth_range_t_of_z(compared.range, compared.z_m) > 1.0 + basis_visibility_FARTHEST_ROUNDING);
    var lit = 1.0;
    var blocker_t = t;
    var is_good = true;
    switch uniform_BASIS {
        case uniform_BASIS_VARIANCE {
            let held = saturate(t);
            is_good = mean.x < held;
            lit = min(variance_variance_visibility(mean.xy, held, least_variance), max_lit);
            blocker_t = variance_mean_blocker_depth(mean.x, held, lit);
        }
        case uniform_BASIS_EXPONENTIAL_VARIANCE {
            let c = vec2f(uniform_soft.exponent, uniform_soft.negative_exponent);
            let scale = exp(c);
            let moments = mean * vec4f(scale.x, scale.x * scale.x, -scale.y, scale.y * scale.y);
            let held = saturate(t);
            lit = min(exponential_variance_exponential_variance_visibility_4(moments, held, c, least_variance), max_lit);
            blocker_t = exponential_variance_exponential_variance_blocker_depth(moments, held, c, lit);
        }
        case uniform_BASIS_MOMENT {
            let moments = moment_bias_moments(moment_dequantize_moments(mean), basis_visibility_MOMENT_BIAS);
            let held = saturate(t - 1.5 * sqrt(least_variance));
            let blocked = moment_hamburger(moments, 2.0 * held - 1.0);
            lit = min(1.0 - blocked.share, max_lit);
            blocker_t = moment_moment_blocker_depth(blocked, held);
        }
        case default {
            let held = saturate(t - convolution_convolution_offset(basis_visibility_TERM_COUNT));
            let further = array<vec4f, 4>(basis_visibility_sum_of(1u, texels, cuts) / max(count, 1e-6), basis_visibility_sum_of(2u, texels, cuts) / max(count, 1e-6), basis_visibility_sum_of(3u, texels, cuts) / max(count, 1e-6), basis_visibility_sum_of(4u, texels, cuts) / max(count, 1e-6));
            let terms = basis_visibility_convolution_sum(2.0 * mean - 1.0, 2.0 * further[0] - 1.0, held);
            lit = min(convolution_convolution_visibility(terms), max_lit);
            let terms_t = basis_visibility_convolution_sum(2.0 * further[1] - 1.0, 2.0 * further[2] - 1.0, held);
            blocker_t = convolution_convolution_blocker_depth(further[3].x, terms_t, held, lit);
        }
    }
    lit = variance_reduce_bleeding(lit, uniform_soft.bleeding_reduction);
    let share = count / max(sums_area(piece), 1e-6);
    let blocker_g = compared_g_of_z(compared, compared.range.near_m + blocker_t * range_m);
    return basis_visibility_Answer(mix(1.0, lit, saturate(share)), blocker_g, is_good);
}

fn basis_visibility_convolution_sum(a: vec4f, b: vec4f, t: f32) -> f32 {
    return convolution_convolution_term(a.xy, t, 1u) + convolution_convolution_term(a.zw, t, 2u) + convolution_convolution_term(b.xy, t, 3u) + convolution_convolution_term(b.zw, t, 4u);
}

struct compared_Compared {
    plane: space_ReceiverPlane,
    place: vec2f,
    bare_depth: f32,
    bare_step: vec2f,
    depth_step: vec2f,
    inverse_divisor: f32,
    inverse_divisor_step: vec2f,
    own_depth: f32,
    z_m: f32,
    range: depth_range_DepthRange,
    edge_g: f32,
    goes_on: bool,
    kernel_g: f32,
    extent: vec2f,
    finest: f32
}

const compared_FINEST_TEXELS = 0.75;

fn compared_compared_of(plane: space_ReceiverPlane, bare: space_ReceiverPlane, z_m: f32, range: depth_range_DepthRange, extent: vec2f) -> compared_Compared {
    let warp_per_uv = vec2f(dot(map_light_view.warp, map_light_view.plane_from_uv.xy), dot(map_light_view.warp, map_light_view.plane_from_uv.zw));
    return compared_Compared(plane, plane.uv * map_light_view.map_size, bare.depth, bare.depth_per_uv / map_light_view.map_size, plane.depth_per_uv / map_light_view.map_size, space_inverse_divisor(map_light_view, plane.uv), -warp_per_uv / map_light_view.map_size, space_unwarped_depth(map_light_view, plane.depth, plane.uv), z_m, range, space_g_beyond_window(map_light_view, z_m), false, 0.0, extent, compared_FINEST_TEXELS * compared_texel_in_plane(plane));
}

fn compared_texel_in_plane(plane: space_ReceiverPlane) -> f32 {
    return space_texel_in_plane_at(map_light_view, space_warped_plane(map_light_view, plane.uv) / space_inverse_divisor(map_light_view, plane.uv));
}

override compared_EDGE_GOES_ON: bool = true;

fn compared_asking_for(compared: compared_Compared, g: f32) -> compared_Compared {
    var asking = compared;
    asking.goes_on = compared_EDGE_GOES_ON && g > compared.edge_g;
    return asking;
}

fn compared_asking_of_kernel(compared: compared_Compared, g: f32, footprint_texels: f32) -> compared_Compared {
    var asking = compared_asking_for(compared, g);
    asking.kernel_g = g;
    asking.finest = max(asking.finest, footprint_texels * compared_texel_in_plane(compared.plane));
    return asking;
}

fn compared_place_in_map(compared: compared_Compared, place: vec2f) -> vec2f {
    return select(place, clamp(place, vec2f(0.5), map_light_view.map_size - 0.5), compared.goes_on);
}

fn compared_piece_in_map(compared: compared_Compared, piece: sums_Piece) -> sums_Piece {
    if !compared.goes_on {
        return piece;
    }
    let size = map_light_view.map_size;
    return sums_Piece(clamp(piece.low, vec2f(0.0), size - 1.0), clamp(piece.high, vec2f(1.0), size));
}

fn compared_inverse_divisor_at(compared: compared_Compared, place: vec2f) -> f32 {
    return max(compared.inverse_divisor + dot(compared.inverse_divisor_step, place - compared.place), 0.0001);
}

struct compared_BarePlane {
    depth: f32,
    step: vec2f
}

fn compared_bare_plane_at(compared: compared_Compared, place: vec2f) -> compared_BarePlane {
    let in_map = compared.bare_depth + dot(compared.bare_step, place - compared.place);
    let divisor = 1.0 / compared_inverse_divisor_at(compared, place);
    let depth = in_map * divisor;
    return compared_BarePlane(depth, (compared.bare_step - depth * compared.inverse_divisor_step) * divisor);
}

fn compared_z_of_g(compared: compared_Compared, g: f32) -> f32 {
    return select(compared.z_m - g, 1.0 / (g + 1.0 / compared.z_m), map_light_view.perspective == 1u);
}

fn compared_g_of_z(compared: compared_Compared, z: f32) -> f32 {
    return select(compared.z_m - z, 1.0 / z - 1.0 / compared.z_m, map_light_view.perspective == 1u);
}

fn compared_hides(compared: compared_Compared, piece: sums_Piece, blocker_g: f32) -> bool {
    return compared_hides_at(compared, sums_middle(piece), blocker_g);
}

fn compared_hides_at(compared: compared_Compared, at: vec2f, blocker_g: f32) -> bool {
    let offset_uv = (at - compared.place) / map_light_view.map_size;
    let place = space_plane_step_of_uv(map_light_view, compared.plane.uv, offset_uv);
    return blocker_range_gauge(place, max(blocker_range_RIM * blocker_g * compared.extent, vec2f(compared.finest))) <= 1.0;
}

const depth_range_FARTHEST_M = 10000000.0;

struct depth_range_DepthRange {
    near_m: f32,
    far_m: f32
}

fn depth_range_depth_range() -> depth_range_DepthRange {
    let view_far_m = min(map_light_view.far_m, depth_range_FARTHEST_M);
    var range = depth_range_DepthRange(map_light_view.near_m, view_far_m);
    if uniform_soft.range_from_map == 1u {
        let ends = textureLoad(blocker_range_light_map_pyramid, vec2u(0u), textureNumLevels(blocker_range_light_map_pyramid) - 1u);
        let a = space_z_of_depth(map_light_view, ends.x);
        let b = space_z_of_depth(map_light_view, ends.y);
        let farthest_m = view_far_m + 0.001 * (view_far_m - map_light_view.near_m);
        range = depth_range_DepthRange(clamp(min(a, b), -depth_range_FARTHEST_M, farthest_m), clamp(max(a, b), -depth_range_FARTHEST_M, farthest_m));
    }
    range.far_m = max(range.far_m, range.near_m + 0.001 * max(abs(range.near_m), 1.0));
    return range;
}

fn depth_range_t_of_z(range: depth_range_DepthRange, z_m: f32) -> f32 {
    return (z_m - range.near_m) / (range.far_m - range.near_m);
}

var<private> kernel_kernel_texels: f32;

const kernel_MAX_NARROW_TAPS = 10.0;

fn kernel_narrow_lit(compared: compared_Compared, kernel: soft_kernel_SoftKernel) -> f32 {
    let asked = select(2.0 * kernel.half_size, 2.6667 * kernel.half_size - 1.0, uniform_soft.with_footprint == 1u);
    let taps = vec2u(clamp(ceil(asked), vec2f(1.0), vec2f(kernel_MAX_NARROW_TAPS)));
    let count = taps.x * taps.y;
    let plane = map_visibility_plane_about(compared, kernel.center);
    var sum = vec2f();
    var i = 0u;
    loop {
        let place = (vec2f(vec2u(i % taps.x, i / taps.x)) + 0.5) / vec2f(taps) * 2.0 - 1.0;
        let y = place.y * kernel.half_size.y;
        let half = soft_kernel_row_half_width(kernel, y);
        sums_note_reads(1u);
        let at = kernel.center + vec2f(place.x * half + kernel.shear * y, y);
        sum += half * vec2f(map_lit_bilinear(plane, compared_place_in_map(compared, at) / map_light_view.map_size), 1.0);
        continuing {
            i++;
            break if i >= count;
        }
    }
    return sum.x / max(sum.y, 1e-12);
}

fn kernel_min_cuts() -> u32 {
    return select(2u, 1u, uniform_IS_ONE_PIECE);
}

fn kernel_wide_lit(compared: compared_Compared, asked: soft_kernel_SoftKernel) -> f32 {
    let count = max(kernel_rows_rows_of(asked), kernel_min_cuts());
    var kernel = asked;
    if asked.is_ellipse && kernel_rows_REFINEMENTS == 0u {
        kernel = kernel_rows_ellipse_of_rows(asked, count);
    }
    let high = kernel.center.y + kernel.half_size.y;
    var sum = vec2f();
    var rows = pieces_cuts_from(kernel.center.y - kernel.half_size.y, count);
    var j = 0u;
    loop {
        var height = (high - rows.at) / rows.left;
        if kernel.is_ellipse {
            height = kernel_rows_ellipse_row_height(kernel, rows, count);
        }
        let row_high = pieces_cut_after(rows, height, high, map_light_view.map_size.y);
        if row_high > rows.at {
            sum += kernel_row_lit(compared, kernel, rows.at, row_high);
            if kernel_rows_REFINEMENTS > 0u {
                sum += kernel_ends_end_lit(compared, kernel, rows.at - kernel.center.y, row_high - kernel.center.y);
            }
        }
        if kernel.is_ellipse {
            rows = kernel_rows_ellipse_rows_after(rows, row_high, height);
        }
        else {
            rows = pieces_cuts_after(rows, row_high, high);
        }
        continuing {
            j++;
            break if j >= pieces_MAX_PIECES || rows.at >= high;
        }
    }
    return sum.x / max(sum.y, 1e-12);
}

fn kernel_row_lit(compared: compared_Compared, kernel: soft_kernel_SoftKernel, y_low: f32, y_high: f32) -> vec2f {
    let half = kernel_rows_row_half(kernel, y_low - kernel.center.y, y_high - kernel.center.y);
    let row_middle = kernel.center.x + kernel.shear * (0.5 * (y_low + y_high) - kernel.center.y);
    let high = row_middle + half;
    var sum = vec2f();
    sums_begin_row();
    var columns = pieces_cuts_from(row_middle - half, max(pieces_pieces_of(2.0 * half, uniform_soft.subdivisions), kernel_min_cuts()));
    var i = 0u;
    loop {
        let end = pieces_next_cut(columns, high, map_light_view.map_size.x);
        let piece = sums_Piece(vec2f(columns.at, y_low), vec2f(end, y_high));
        sum += sums_area(piece) * vec2f(kernel_piece_piece_lit(compared, piece), 1.0);
        columns = pieces_cuts_after(columns, end, high);
        continuing {
            i++;
            break if i >= pieces_MAX_PIECES || columns.at >= high;
        }
    }
    return sum;
}

const kernel_MAX_PRINTED_ROWS = 128u;

fn kernel_lit_by_squares(compared: compared_Compared, kernel: soft_kernel_SoftKernel) -> f32 {
    let count = clamp(u32(ceil(2.0 * kernel.half_size.y / uniform_soft.row_height)), 1u, kernel_MAX_PRINTED_ROWS);
    var sum = vec2f();
    for (var j = 0u; j < count; j++) {
        let low = mix(-kernel.half_size.y, kernel.half_size.y, f32(j) / f32(count));
        let high = mix(-kernel.half_size.y, kernel.half_size.y, f32(j + 1u) / f32(count));
        let half = kernel_rows_row_half(kernel, low, high);
        let row_middle = kernel.center.x + kernel.shear * 0.5 * (low + high);
        let y = kernel.center.y + vec2f(low, high);
        sum += kernel_ends_square_lit(compared, sums_Piece(vec2f(row_middle - half, y.x), vec2f(row_middle + half, y.y)));
        if kernel_rows_REFINEMENTS > 0u {
            sum += kernel_ends_end_lit(compared, kernel, low, high);
        }
    }
    return sum.x / max(sum.y, 1e-12);
}

fn kernel_kernel_lit(compared: compared_Compared, asked: soft_kernel_SoftKernel) -> f32 {
    var kernel = asked;
    kernel.half_size = max(kernel.half_size, vec2f(0.5));
    let longest = 2.0 * max(kernel.half_size.x, kernel.half_size.y);
    kernel_kernel_texels = longest;
    if longest <= uniform_soft.direct_texels * f32(uniform_soft.subdivisions) {
        return kernel_narrow_lit(compared, kernel);
    }
    if uniform_CUTS_SQUARES {
        return kernel_lit_by_squares(compared, kernel);
    }
    return kernel_wide_lit(compared, kernel);
}

fn kernel_ends_square_lit(compared: compared_Compared, whole: sums_Piece) -> vec2f {
    var sum = vec2f();
    var rows = pieces_cuts_from(whole.low.y, pieces_pieces_of(whole.high.y - whole.low.y, uniform_soft.subdivisions));
    for (var j = 0u; j < pieces_MAX_PIECES && rows.at < whole.high.y; j++) {
        let row_high = pieces_next_cut(rows, whole.high.y, map_light_view.map_size.y);
        var columns = pieces_cuts_from(whole.low.x, pieces_pieces_of(whole.high.x - whole.low.x, uniform_soft.subdivisions));
        for (var i = 0u; i < pieces_MAX_PIECES && columns.at < whole.high.x; i++) {
            let end = pieces_next_cut(columns, whole.high.x, map_light_view.map_size.x);
            let piece = sums_Piece(vec2f(columns.at, rows.at), vec2f(end, row_high));
            sum += sums_area(piece) * vec2f(kernel_piece_piece_lit(compared, piece), 1.0);
            columns = pieces_cuts_after(columns, end, whole.high.x);
        }
        rows = pieces_cuts_after(rows, row_high, whole.high.y);
    }
    return sum;
}

fn kernel_ends_end_lit(compared: compared_Compared, kernel: soft_kernel_SoftKernel, low: f32, high: f32) -> vec2f {
    var sum = vec2f();
    if !kernel_rows_has_ends(kernel, low, high) {
        return sum;
    }
    let at_low = soft_kernel_row_half_width(kernel, low);
    let at_high = soft_kernel_row_half_width(kernel, high);
    let inner = min(at_low, at_high);
    let outer = max(at_low, at_high);
    let is_upper = low > 0.0;
    let steps = 1u << kernel_rows_REFINEMENTS;
    for (var i = 0u; i < steps; i++) {
        let near = f32(i) / f32(steps);
        let far = f32(i + 1u) / f32(steps);
        let y = select(vec2f(mix(high, low, far), mix(high, low, near)), vec2f(mix(low, high, near), mix(low, high, far)), is_upper);
        let x = vec2f(mix(outer, inner, far), mix(outer, inner, near));
        for (var j = 0; j < 2; j++) {
            sum += select(0.5, 1.0, j == 1) * kernel_ends_side_lit(compared, kernel, y, select(x, vec2f(inner, x.x), j == 1));
        }
    }
    return sum;
}

fn kernel_ends_side_lit(compared: compared_Compared, kernel: soft_kernel_SoftKernel, y: vec2f, x: vec2f) -> vec2f {
    if abs(x.y - x.x) < 0.001 || y.y - y.x < 0.001 {
        return vec2f();
    }
    let row_middle = kernel.center + vec2f(kernel.shear * 0.5 * (y.x + y.y), 0.0);
    var sum = vec2f();
    for (var side = 0; side < 2; side++) {
        let across = select(x, -x.yx, side == 0);
        let part = sums_Piece(row_middle + vec2f(across.x, y.x), row_middle + vec2f(across.y, y.y));
        if uniform_CUTS_SQUARES {
            sum += kernel_ends_square_lit(compared, part);
        }
        else {
            sums_begin_row();
            sum += (x.y - x.x) * (y.y - y.x) * vec2f(kernel_piece_piece_lit(compared, part), 1.0);
        }
    }
    return sum;
}

fn kernel_piece_holds_to_depth() -> bool {
    return (uniform_BASIS == uniform_BASIS_TILES || uniform_BASIS == uniform_BASIS_EXPONENTIAL) && uniform_HAS_SECOND_LOOK && !uniform_IS_ONE_WINDOW;
}

fn kernel_piece_kernel_answer(compared: compared_Compared, asked: sums_Piece) -> basis_visibility_Answer {
    let piece = compared_piece_in_map(compared, asked);
    var answer = basis_visibility_Answer(1.0, 0.0, false);
    if map_visibility_is_summed(piece) {
        answer = basis_visibility_basis_answer(compared, piece, select(basis_visibility_CUT_ONCE, basis_visibility_CUT_ALL_ROUND, uniform_IS_ONE_PIECE || uniform_CUTS_SQUARES));
    }
    if !answer.is_good && (uniform_soft.may_read_map != 0u || !map_visibility_is_summed(piece)) {
        answer = basis_visibility_Answer(map_visibility_map_lit(compared, piece), 0.0, true);
        if answer.lit < 1.0 && (kernel_piece_holds_to_depth() || map_visibility_is_beyond(asked, piece)) {
            answer.blocker_g = map_visibility_map_answer(compared, piece).blocker_g;
        }
    }
    if !map_visibility_is_of_asked(compared, asked, piece, answer.blocker_g) {
        return basis_visibility_Answer(1.0, 0.0, true);
    }
    return answer;
}

const kernel_piece_ONE_DEPTH = 0.1;

fn kernel_piece_piece_lit(compared: compared_Compared, asked: sums_Piece) -> f32 {
    let first = kernel_piece_kernel_answer(compared, asked);
    let is_of_light = kernel_piece_holds_to_depth() && compared.kernel_g > 0.0;
    if !is_of_light || first.lit >= 1.0 || compared_hides(compared, asked, first.blocker_g) {
        return first.lit;
    }
    let scale = first.blocker_g / compared.kernel_g;
    let own = sums_Piece(mix(compared.place, asked.low, scale), mix(compared.place, asked.high, scale));
    let piece = compared_piece_in_map(compared, own);
    let blocker_g = map_visibility_map_answer(compared, piece).blocker_g;
    if blocker_g > 0.0 && compared_hides(compared, own, blocker_g) && map_visibility_is_of_asked(compared, own, piece, blocker_g) {
        return map_visibility_map_lit(compared, piece);
    }
    if blocker_g <= 0.0 || abs(blocker_g - first.blocker_g) <= kernel_piece_ONE_DEPTH * first.blocker_g {
        return 1.0;
    }
    return kernel_piece_lit_by_texels(compared, compared_piece_in_map(compared, asked));
}

fn kernel_piece_lit_by_texels(compared: compared_Compared, piece: sums_Piece) -> f32 {
    let center = sums_middle(piece);
    let quarter = 0.25 * (piece.high - piece.low);
    let hidden = vec2<bool>(kernel_piece_texel_hides(compared, center - quarter), kernel_piece_texel_hides(compared, center + quarter));
    return 1.0 - 0.5 * dot(vec2f(hidden), vec2f(1.0));
}

fn kernel_piece_texel_hides(compared: compared_Compared, place: vec2f) -> bool {
    let at_place = map_visibility_texel_blocks(compared, map_visibility_about(compared, place), place);
    if at_place.x == 0.0 || compared_hides_at(compared, place, at_place.y) {
        return at_place.x > 0.0;
    }
    let nearer = mix(compared.place, place, at_place.y / compared.kernel_g);
    let at_nearer = map_visibility_texel_blocks(compared, map_visibility_about(compared, nearer), nearer);
    return at_nearer.x > 0.0 && compared_hides_at(compared, nearer, at_nearer.y);
}

override kernel_rows_REFINEMENTS: u32 = 0u;

const kernel_rows_SHEAR_SHARE = 0.2;

const kernel_rows_MAX_SHEARED_ROWS = 8u;

const kernel_rows_MIN_ELLIPSE_ROWS = 5u;

fn kernel_rows_rows_of(kernel: soft_kernel_SoftKernel) -> u32 {
    let size = 2.0 * kernel.half_size;
    let by_shear = ceil(abs(kernel.shear) * size.y / max(kernel_rows_SHEAR_SHARE * size.x, 1.0));
    let least = select(uniform_soft.subdivisions, max(uniform_soft.subdivisions, kernel_rows_MIN_ELLIPSE_ROWS), kernel.is_ellipse);
    return clamp(u32(by_shear), pieces_pieces_of(size.y, least), pieces_pieces_of(size.y, max(2u * least, kernel_rows_MAX_SHEARED_ROWS)));
}

const kernel_rows_ROW_SPREAD: f32 = 1.2;

const kernel_rows_ROW_SHORTER: f32 = 0.75;

const kernel_rows_ROW_WIDER: f32 = 0.38;

const kernel_rows_ROW_SHORTEST: f32 = 0.8660254;

const kernel_rows_ROW_WIDEST: f32 = 1.09;

fn kernel_rows_ellipse_of_rows(kernel: soft_kernel_SoftKernel, rows: u32) -> soft_kernel_SoftKernel {
    let per_square = 1.0 / f32(rows * rows);
    var scaled = kernel;
    let wider = min(1.0 + kernel_rows_ROW_WIDER * per_square, kernel_rows_ROW_WIDEST);
    scaled.half_size *= vec2f(wider, max(1.0 - kernel_rows_ROW_SHORTER * per_square, kernel_rows_ROW_SHORTEST));
    return scaled;
}

fn kernel_rows_ellipse_row_height(kernel: soft_kernel_SoftKernel, rows: pieces_Cuts, count: u32) -> f32 {
    let place = 1.0 - 2.0 * (rows.left - 1.0) / f32(count);
    return kernel.center.y + kernel.half_size.y * (sin(kernel_rows_ROW_SPREAD * place) / sin(kernel_rows_ROW_SPREAD)) - rows.at;
}

fn kernel_rows_ellipse_rows_after(rows: pieces_Cuts, next: f32, height: f32) -> pieces_Cuts {
    let is_done = next <= rows.at || next - rows.at >= 0.5 * height;
    return pieces_Cuts(next, max(rows.left - select(0.0, 1.0, is_done), 1.0));
}

const kernel_rows_GAUSS: f32 = 0.28867513;

fn kernel_rows_row_half(kernel: soft_kernel_SoftKernel, low: f32, high: f32) -> f32 {
    if kernel_rows_REFINEMENTS > 0u && kernel_rows_has_ends(kernel, low, high) {
        return min(soft_kernel_row_half_width(kernel, low), soft_kernel_row_half_width(kernel, high));
    }
    let between = 0.5 * (low + high);
    if uniform_CUTS_SQUARES || !kernel.is_ellipse {
        return max(soft_kernel_row_half_width(kernel, between), 0.5);
    }
    let aside = kernel_rows_GAUSS * (high - low);
    return max(0.5 * (soft_kernel_row_half_width(kernel, between - aside) + soft_kernel_row_half_width(kernel, between + aside)), 0.5);
}

fn kernel_rows_has_ends(kernel: soft_kernel_SoftKernel, low: f32, high: f32) -> bool {
    return kernel.is_ellipse && min(soft_kernel_row_half_width(kernel, low), soft_kernel_row_half_width(kernel, high)) > 1.0 && low * high > 0.0;
}

fn map_visibility_plane_about(compared: compared_Compared, place: vec2f) -> space_ReceiverPlane {
    var about = compared.plane;
    about.farthest_depth = compared.own_depth * compared_inverse_divisor_at(compared, place);
    return about;
}

struct map_visibility_About {
    inverse_divisor: f32,
    farthest: f32,
    is_in_map: bool
}

fn map_visibility_about(compared: compared_Compared, place: vec2f) -> map_visibility_About {
    let inverse_divisor = compared_inverse_divisor_at(compared, place);
    let is_in_map = all(place >= vec2f(0.0)) && all(place <= map_light_view.map_size);
    return map_visibility_About(inverse_divisor, compared.own_depth * inverse_divisor, is_in_map);
}

fn map_visibility_texel_blocks(compared: compared_Compared, about: map_visibility_About, place: vec2f) -> vec2f {
    let texel = clamp(floor(place), vec2f(0.0), map_light_view.map_size - 1.0);
    sums_note_reads(1u);
    let stored = textureLoad(map_light_map, vec2i(texel), 0);
    let in_plane = compared.plane.depth + dot(compared.depth_step, texel + 0.5 - compared.place);
    let sign = map_light_view.depth_sign;
    let held = saturate(sign * max(sign * in_plane, sign * about.farthest));
    let g = sign * (stored / about.inverse_divisor - compared.own_depth) / abs(map_light_view.depth_scale);
    return select(vec2f(), vec2f(1.0, g), sign * (stored - held) > 0.0 && about.is_in_map);
}

fn map_visibility_map_answer(compared: compared_Compared, piece: sums_Piece) -> basis_visibility_Answer {
    let center = sums_middle(piece);
    let quarter = 0.25 * (piece.high - piece.low);
    let about = map_visibility_about(compared, center);
    let blocks = map_visibility_texel_blocks(compared, about, center - quarter) + map_visibility_texel_blocks(compared, about, center + quarter) + map_visibility_texel_blocks(compared, about, center + vec2f(quarter.x, -quarter.y)) + map_visibility_texel_blocks(compared, about, center + vec2f(-quarter.x, quarter.y));
    return basis_visibility_Answer(1.0 - 0.25 * blocks.x, blocks.y / max(blocks.x, 1.0), true);
}

fn map_visibility_map_lit(compared: compared_Compared, piece: sums_Piece) -> f32 {
    let center = sums_middle(piece);
    let plane = map_visibility_plane_about(compared, center);
    let uv = center / map_light_view.map_size;
    let quarter = 0.25 * (piece.high - piece.low) / map_light_view.map_size;
    sums_note_reads(4u);
    return 0.25 * (map_lit_bilinear(plane, uv - quarter) + map_lit_bilinear(plane, uv + quarter) + map_lit_bilinear(plane, uv + vec2f(quarter.x, -quarter.y)) + map_lit_bilinear(plane, uv + vec2f(-quarter.x, quarter.y)));
}

fn map_visibility_is_summed(piece: sums_Piece) -> bool {
    let size = piece.high - piece.low;
    return max(size.x, size.y) > uniform_soft.direct_texels && sums_area(piece) <= uniform_soft.max_part_texels;
}

fn map_visibility_is_beyond(asked: sums_Piece, piece: sums_Piece) -> bool {
    return any(asked.low != piece.low) || any(asked.high != piece.high);
}

fn map_visibility_is_of_asked(compared: compared_Compared, asked: sums_Piece, piece: sums_Piece, blocker_g: f32) -> bool {
    return !map_visibility_is_beyond(asked, piece) || blocker_g > compared.edge_g;
}

const pieces_MAX_PIECES = 1024u;

struct pieces_Cuts {
    at: f32,
    left: f32
}

fn pieces_cuts_from(low: f32, count: u32) -> pieces_Cuts {
    return pieces_Cuts(low, f32(count));
}

fn pieces_tile_end(at: f32, size: f32) -> f32 {
    let end = min(f32((i32(floor(at)) | ((1 << sums_tile_shift) - 1)) + 1), size);
    return select(select(end, 1e30, at >= size), 0.0, at < 0.0);
}

fn pieces_next_cut(cuts: pieces_Cuts, high: f32, size: f32) -> f32 {
    return pieces_cut_after(cuts, (high - cuts.at) / cuts.left, high, size);
}

fn pieces_cut_after(cuts: pieces_Cuts, width: f32, high: f32, size: f32) -> f32 {
    let cut = select(round(cuts.at + width), high, cuts.left <= 1.5);
    let border = pieces_tile_end(cuts.at, size);
    let is_border = border - cuts.at >= 1.0 && high - border >= 1.0 && border < cut + 0.5 * width;
    return select(cut, border, is_border);
}

const pieces_SLIVER = 0.25;

fn pieces_cuts_after(cuts: pieces_Cuts, next: f32, high: f32) -> pieces_Cuts {
    let left = round((high - next) * cuts.left / (high - cuts.at) - select(pieces_SLIVER, 0.0, uniform_CUTS_SQUARES));
    return pieces_Cuts(next, clamp(left, 1.0, cuts.left));
}

fn pieces_pieces_of(length_texels: f32, most: u32) -> u32 {
    let least = u32(min(ceil(length_texels / (sqrt(uniform_soft.max_part_texels) - 1.0)), f32(pieces_MAX_PIECES)));
    return clamp(u32(ceil(0.5 * length_texels)), 1u, max(most, least));
}

override search_HAS_SEARCH_TAPS: bool = false;

override search_AVERAGES_DEPTH: bool = false;

fn search_averaged(compared: compared_Compared, g: f32) -> f32 {
    if search_AVERAGES_DEPTH {
        return compared_z_of_g(compared, g);
    }
    return g;
}

fn search_g_of_mean(compared: compared_Compared, sum: f32, count: f32) -> f32 {
    let mean = sum / max(count, 1e-12);
    if search_AVERAGES_DEPTH {
        return select(0.0, max(compared_g_of_z(compared, mean), 0.0), count > 0.0);
    }
    return mean;
}

fn search_piece_blockers(compared: compared_Compared, asked: sums_Piece) -> basis_visibility_Answer {
    let piece = compared_piece_in_map(compared, asked);
    var answer = basis_visibility_Answer(1.0, 0.0, false);
    if map_visibility_is_summed(piece) {
        answer = basis_visibility_basis_answer(compared, piece, basis_visibility_WHOLE);
    }
    if !answer.is_good && (uniform_soft.may_read_map != 0u || !map_visibility_is_summed(piece)) {
        answer = map_visibility_map_answer(compared, piece);
    }
    if !map_visibility_is_of_asked(compared, asked, piece, answer.blocker_g) {
        return basis_visibility_Answer(1.0, 0.0, true);
    }
    return answer;
}

fn search_search_side(k: u32) -> u32 {
    if uniform_IS_ONE_WINDOW {
        return uniform_soft.subdivisions;
    }
    return max(u32(round(f32(uniform_soft.subdivisions) * (f32(k) + 0.5) / f32(uniform_soft.search_scales))), 1u);
}

struct search_Search {
    g: f32,
    window_g: f32,
    center: vec2f,
    half_at_1: vec2f
}

fn search_search_of(compared: compared_Compared) -> search_Search {
    let g = blocker_range_largest_g(compared.plane, compared.extent);
    let half_at_1 = blocker_range_half_extent_uv_at_1(compared.plane.uv, compared.extent) * map_light_view.map_size;
    return search_Search(g, g, compared.place, half_at_1);
}

fn search_window_g(search: search_Search, k: u32) -> f32 {
    if uniform_IS_ONE_WINDOW {
        return search.window_g;
    }
    let scale = (f32(k) + 0.5) / f32(uniform_soft.search_scales);
    return blocker_range_RIM * search.window_g * scale * scale;
}

fn search_window_half(search: search_Search, k: u32) -> vec2f {
    return max(search.half_at_1 * search_window_g(search, k), vec2f(1.0));
}

fn search_counted(search: search_Search, compared: compared_Compared, piece: sums_Piece, answer: basis_visibility_Answer) -> vec2f {
    let g = clamp(answer.blocker_g, 0.0, search.g);
    if uniform_IS_ONE_WINDOW {
        return (1.0 - answer.lit) * sums_area(piece) * vec2f(1.0, search_averaged(compared, g));
    }
    let counts = g > 0.0 && compared_hides(compared, piece, g);
    return select(vec2f(), (1.0 - answer.lit) * sums_area(piece) * vec2f(1.0, search_averaged(compared, g)), counts);
}

fn search_search_tables(search: search_Search, compared: compared_Compared) -> vec2f {
    var sum = vec2f();
    if search.g <= 0.0 {
        return sum;
    }
    var k = 0u;
    loop {
        sum += search_window_blockers(search, compared, k);
        continuing {
            k++;
            break if k >= uniform_soft.search_scales;
        }
    }
    return sum;
}

fn search_window_blockers(search: search_Search, receiver: compared_Compared, k: u32) -> vec2f {
    let compared = compared_asking_for(receiver, search_window_g(search, k));
    let half = search_window_half(search, k);
    let most = search_search_side(k);
    let is_summed = 2.0 * max(half.x, half.y) > uniform_soft.direct_texels;
    let low = select(search.center - half, round(search.center - half), is_summed);
    let high = select(search.center + half, round(search.center + half), is_summed);
    var sum = vec2f();
    var rows = pieces_cuts_from(low.y, pieces_pieces_of(2.0 * half.y, most));
    var j = 0u;
    loop {
        let row_high = pieces_next_cut(rows, high.y, map_light_view.map_size.y);
        sums_begin_row();
        var columns = pieces_cuts_from(low.x, pieces_pieces_of(2.0 * half.x, most));
        var i = 0u;
        loop {
            let end = pieces_next_cut(columns, high.x, map_light_view.map_size.x);
            let piece = sums_Piece(vec2f(columns.at, rows.at), vec2f(end, row_high));
            sum += search_counted(search, compared, piece, search_piece_blockers(compared, piece));
            columns = pieces_cuts_after(columns, end, high.x);
            continuing {
                i++;
                break if i >= pieces_MAX_PIECES || columns.at >= high.x;
            }
        }
        rows = pieces_cuts_after(rows, row_high, high.y);
        continuing {
            j++;
            break if j >= pieces_MAX_PIECES || rows.at >= high.y;
        }
    }
    return sum / (4.0 * half.x * half.y);
}

fn search_search_taps(search: search_Search, compared: compared_Compared) -> vec2f {
    let side = max(u32(round(sqrt(f32(uniform_soft.search_taps) / f32(uniform_soft.search_scales)))), 1u);
    let count = select(0u, uniform_soft.search_scales * side * side, search.g > 0.0);
    var sum = vec2f();
    for (var i = 0u; i < count; i++) {
        let k = i / (side * side);
        let half = search_window_half(search, k);
        let size = 2.0 * half / f32(side);
        let low = search.center - half + size * vec2f(vec2u(i % side, i / side % side));
        let piece = sums_Piece(low, low + size);
        let place = compared_place_in_map(compared_asking_for(compared, search_window_g(search, k)), sums_middle(piece));
        let found = map_visibility_texel_blocks(compared, map_visibility_about(compared, place), place);
        let is_of_asked = all(place == sums_middle(piece)) || found.y > compared.edge_g;
        let blocks = select(vec2f(), found, is_of_asked);
        sum += search_counted(search, compared, piece, basis_visibility_Answer(1.0 - blocks.x, blocks.y, true)) / (4.0 * half.x * half.y);
    }
    return sum;
}

const search_MUCH_NEARER = 0.5;

const search_MAX_LOOKS = 2u;

fn search_search_blockers(compared: compared_Compared) -> vec2f {
    var search = search_search_of(compared);
    var sum: vec2f;
    var mean_g: f32;
    for (var look = 0u; look < search_MAX_LOOKS; look++) {
        if search_HAS_SEARCH_TAPS {
            sum = search_search_taps(search, compared);
        }
        else {
            sum = search_search_tables(search, compared);
        }
        mean_g = search_g_of_mean(compared, sum.y, sum.x);
        if !uniform_HAS_SECOND_LOOK || sum.x <= 0.0 || mean_g >= search_MUCH_NEARER * search.g {
            break;
        }
        search.window_g = mean_g;
    }
    return vec2f(mean_g, sum.x / f32(uniform_soft.search_scales));
}

const overflow_BITS_OF_TWO_TO_32 = 1333788672u;

fn overflow_overflows(largest_sum: u32) -> bool {
    return largest_sum >= overflow_BITS_OF_TWO_TO_32;
}

alias sums_Sum = vec4u;

@group(3) @binding(0)
var sums_table: texture_2d<u32>;

@group(3) @binding(2)
var<storage, read> sums_largest: array<u32>;

@group(3) @binding(3)
var sums_table_1: texture_2d<u32>;

@group(3) @binding(4)
var sums_table_2: texture_2d<u32>;

@group(3) @binding(5)
var sums_table_3: texture_2d<u32>;

@group(3) @binding(6)
var sums_table_4: texture_2d<u32>;

var<private> sums_tile_shift: u32;

var<private> sums_reads: u32;

fn sums_note_reads(count: u32) {
    sums_reads += count;
}

fn sums_chosen_tile_log2() -> u32 {
    const BLOCK_LOG2 = 4u;
    var log2 = 0u;
    for (; log2 + 1u < arrayLength(&sums_largest); log2++) {
        if overflow_overflows(sums_largest[log2 + 1u]) {
            break;
        }
    }
    return BLOCK_LOG2 + log2;
}

struct sums_Piece {
    low: vec2f,
    high: vec2f
}

fn sums_area(piece: sums_Piece) -> f32 {
    let size = piece.high - piece.low;
    return size.x * size.y;
}

fn sums_middle(piece: sums_Piece) -> vec2f {
    return 0.5 * (piece.low + piece.high);
}

struct sums_Texels {
    low: vec2i,
    high: vec2i,
    cut_low: vec2f,
    cut_high: vec2f
}

fn sums_texels_of(piece: sums_Piece) -> sums_Texels {
    let tile_mask = (1 << sums_tile_shift) - 1;
    let low = max(vec2i(ceil(piece.low)), vec2i(0));
    let tile_end = min((low | vec2i(tile_mask)) + 1, vec2i(map_light_view.map_size));
    let high = max(min(vec2i(floor(piece.high)), tile_end), low);
    let has_before = (low & vec2i(tile_mask)) != vec2i(0);
    let has_after = high < tile_end;
    return sums_Texels(low, high, select(vec2f(), saturate(vec2f(low) - piece.low), has_before), select(vec2f(), saturate(piece.high - vec2f(high)), has_after));
}

fn sums_count_of(texels: sums_Texels) -> f32 {
    let whole = vec2f(texels.high - texels.low);
    let cut = texels.cut_low + texels.cut_high;
    return whole.x * whole.y + cut.x * whole.y + cut.y * whole.x;
}

fn sums_load_table(which: u32, texel: vec2i) -> sums_Sum {
    sums_note_reads(1u);
    if uniform_BASIS == uniform_BASIS_CONVOLUTION && which > 0u {
        switch which {
            case 1u {
                return textureLoad(sums_table_1, texel, 0);
            }
            case 2u {
                return textureLoad(sums_table_2, texel, 0);
            }
            case 3u {
                return textureLoad(sums_table_3, texel, 0);
            }
            case default {
                return textureLoad(sums_table_4, texel, 0);
            }
        }
    }
    return textureLoad(sums_table, texel, 0);
}

fn sums_corner(which: u32, x: i32, y: i32, is_first: bool) -> sums_Sum {
    return select(sums_load_table(which, max(vec2i(x, y) - 1, vec2i(0))), sums_Sum(0), is_first);
}

struct sums_Rows {
    low: i32,
    high: i32,
    is_first_low: bool,
    is_first_high: bool,
    cut: f32,
    cut_end: i32,
    is_cut_low: bool,
    is_first_cut: bool
}

fn sums_rows_of_texels(texels: sums_Texels) -> sums_Rows {
    let tile_mask = (1 << sums_tile_shift) - 1;
    let is_first = (texels.low.y & tile_mask) == 0;
    let is_cut_low = texels.cut_low.y > 0.0;
    let cut_end = select(texels.high.y + 1, texels.low.y - 1, is_cut_low);
    return sums_Rows(texels.low.y, texels.high.y, is_first, is_first && texels.high.y == texels.low.y, select(texels.cut_high.y, texels.cut_low.y, is_cut_low), cut_end, is_cut_low, is_cut_low && (cut_end & tile_mask) == 0);
}

struct sums_Column {
    whole: sums_Sum,
    cut: sums_Sum
}

fn sums_column_at(which: u32, rows: sums_Rows, x: i32, is_first: bool, with_cuts: bool) -> sums_Column {
    let low = sums_corner(which, x, rows.low, is_first || rows.is_first_low);
    let high = sums_corner(which, x, rows.high, is_first || rows.is_first_high);
    var cut: sums_Sum;
    if with_cuts && rows.cut > 0.0 {
        let outer = sums_corner(which, x, rows.cut_end, is_first || rows.is_first_cut);
        cut = select(outer - high, low - outer, rows.is_cut_low);
    }
    return sums_Column(high - low, cut);
}

var<private> sums_end_column: sums_Column;

var<private> sums_end_x: i32;

const sums_NO_COLUMN = -1;

fn sums_begin_row() {
    sums_end_x = sums_NO_COLUMN;
}

fn sums_row_sum(which: u32, texels: sums_Texels, with_cuts: bool) -> vec4f {
    let tile_mask = (1 << sums_tile_shift) - 1;
    let rows = sums_rows_of_texels(texels);
    let is_first = (texels.low.x & tile_mask) == 0;
    var low: sums_Column;
    if !is_first {
        low = sums_end_column;
        if which > 0u || texels.low.x != sums_end_x {
            low = sums_column_at(which, rows, texels.low.x, false, with_cuts);
        }
    }
    let high = sums_column_at(which, rows, texels.high.x, is_first && texels.high.x == texels.low.x, with_cuts);
    if which == 0u {
        sums_end_column = high;
        sums_end_x = texels.high.x;
    }
    var sum = vec4f(high.whole - low.whole);
    if with_cuts {
        let is_cut_low = texels.cut_low.x > 0.0;
        let share = select(texels.cut_high.x, texels.cut_low.x, is_cut_low);
        if share > 0.0 {
            let x = select(texels.high.x + 1, texels.low.x - 1, is_cut_low);
            let outer = sums_column_at(which, rows, x, is_cut_low && (x & tile_mask) == 0, false).whole;
            sum += share * vec4f(select(outer - high.whole, low.whole - outer, is_cut_low));
        }
        sum += rows.cut * vec4f(high.cut - low.cut);
    }
    return sum / uniform_soft.value_scale;
}

fn sums_all_cut_sum(which: u32, texels: sums_Texels) -> vec4f {
    let weights_x = vec3f(texels.cut_low.x, 1.0, texels.cut_high.x);
    let y = vec4i(texels.low.y - 1, texels.low.y, texels.high.y, texels.high.y + 1);
    let weights_y = vec3f(texels.cut_low.y, 1.0, texels.cut_high.y);
    var sum = vec4f();
    for (var i = 0u; i < 3u; i++) {
        sum += weights_y[i] * sums_strip_sum(which, texels, vec2i(y[i], y[i + 1u]), weights_x);
    }
    return sum / uniform_soft.value_scale;
}

fn sums_strip_sum(which: u32, texels: sums_Texels, y: vec2i, weights_x: vec3f) -> vec4f {
    let begin = texels.low & vec2i(~((1 << sums_tile_shift) - 1));
    let is_first = y <= vec2i(begin.y);
    let a = sums_strip_end(which, texels.low.x - 1, y, is_first, texels.low.x - 1 <= begin.x);
    let b = sums_strip_end(which, texels.low.x, y, is_first, texels.low.x <= begin.x);
    let c = sums_strip_end(which, texels.high.x, y, is_first, texels.high.x <= begin.x);
    let d = sums_strip_end(which, texels.high.x + 1, y, is_first, false);
    return weights_x.x * vec4f(b - a) + weights_x.y * vec4f(c - b) + weights_x.z * vec4f(d - c);
}

fn sums_strip_end(which: u32, x: i32, y: vec2i, is_first_y: vec2<bool>, is_first_x: bool) -> sums_Sum {
    return sums_corner(which, x, y.y, is_first_x || is_first_y.y) - sums_corner(which, x, y.x, is_first_x || is_first_y.x);
}

alias tile_basis_TilePlane = vec4f;

fn tile_basis_nearness(depth: f32) -> f32 {
    let scaled = (depth - map_light_view.depth_offset) / map_light_view.depth_scale;
    return select(-scaled, max(scaled, 1e-7), map_light_view.perspective == 1u);
}

fn tile_basis_exponent_between(a: f32, b: f32) -> f32 {
    return uniform_soft.exponent * select(b - a, log(max(b, 1e-7) / max(a, 1e-7)), map_light_view.perspective == 1u);
}

fn tile_basis_plane_nearness(tile: tile_basis_TilePlane, offset: vec2f) -> f32 {
    return tile.x + dot(tile.yz, offset);
}

override uniform_BASIS: u32 = 0u;

const uniform_BASIS_TILES = 0u;

const uniform_BASIS_EXPONENTIAL = 1u;

const uniform_BASIS_VARIANCE = 2u;

const uniform_BASIS_EXPONENTIAL_VARIANCE = 3u;

const uniform_BASIS_MOMENT = 4u;

const uniform_BASIS_CONVOLUTION = 5u;

override uniform_CUTS_SQUARES: bool = false;

override uniform_IS_ONE_PIECE: bool = false;

override uniform_IS_ONE_WINDOW: bool = false;

override uniform_HAS_SECOND_LOOK: bool = false;

struct uniform_SoftUniform {
    light_extent: vec2f,
    light_extent_axis: f32,
    bias_scale: f32,
    light_covariance: vec3f,
    exponent: f32,
    light_mean: vec2f,
    negative_exponent: f32,
    value_scale: f32,
    tile_log2: u32,
    range_from_map: u32,
    empty_depth: f32,
    non_planar: f32,
    subdivisions: u32,
    search_scales: u32,
    search_taps: u32,
    row_height: f32,
    is_ellipse: u32,
    with_footprint: u32,
    direct_texels: f32,
    max_part_texels: f32,
    bleeding_reduction: f32,
    may_read_map: u32,
    padding_0: f32,
    padding_1: f32
}

@group(2) @binding(0)
var<uniform> uniform_soft: uniform_SoftUniform;
