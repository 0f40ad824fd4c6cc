// Linked from src/techniques/single_map/pcss_anisotropic/resolve.wesl by `cargo xtask shaders`: edit that, not this.

fn visibility(receiver: inputs_Receiver, pixel: vec2u) -> f32 {
    if receiver.is_background {
        return 1.0;
    }
    if !receiver.is_reached {
        return 0.0;
    }
    let above = horizon_horizon_share(receiver);
    if above <= 0.0 {
        return 0.0;
    }
    var plane = search_comparison_plane(receiver);
    plane.faces_away = false;
    let receiver_in_light = space_light_from_world(map_light_view, receiver.pos_in_world);
    let shift = select(vec2f(), noise_shift_of_pixel(pixel), settings_pcss.rotate == 1u);
    let extent = blocker_range_seen_extent(settings_pcss.light_extent, settings_pcss.light_extent_axis, receiver_in_light);
    let window = search_window_of(plane, extent, shift, receiver_in_light.z);
    let mean_g = search_blockers_of(search_search(window, light_taps_light_plane(receiver, receiver_in_light, shift)), window).g.x;
    let grown = extent / max(settings_pcss.light_extent, vec2f(1e-20));
    let on_plane = settings_pcss.light_covariance * vec3f(grown.x * grown.x, grown.x * grown.y, grown.y * grown.y);
    let covariance = soft_kernel_light_covariance_texels(on_plane, plane.uv, mean_g) + soft_kernel_ending_footprint_covariance(receiver, plane.uv, pixel);
    let center = (plane.uv + space_uv_step_of_plane(map_light_view, settings_pcss.light_mean * mean_g)) * map_light_view.map_size;
    let kernel = soft_kernel_kernel_of_covariance(center, covariance, settings_pcss.is_ellipse == 1u);
    var lit = 0.0;
    for (var i = 0u; i < settings_pcss.filter_count; i++) {
        let u = fract(light_taps_taps[settings_pcss.search_count + i].xy + shift);
        let place = select(2.0 * u - 1.0, light_disk_from_square(u), kernel.is_ellipse) * kernel.half_size;
        let at = center + vec2f(place.x + kernel.shear * place.y, place.y);
        lit += map_lit_bilinear(plane, map_receiver_place_in_map(window.at, at, mean_g) / map_light_view.map_size);
    }
    return above * lit / f32(settings_pcss.filter_count);
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    let pixel = inputs_known_pixel(id.xy);
    if inputs_is_inside(pixel) {
        inputs_write_visibility(pixel, visibility(inputs_load_receiver(pixel), pixel));
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

fn receiver_light_biased_plane(receiver: inputs_Receiver, bias_scale: f32) -> space_ReceiverPlane {
    return receiver_light_biased_plane_within(receiver, bias_scale, space_min_grazing_sine(map_light_view));
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

fn light_disk_from_square(u: vec2f) -> vec2f {
    let p = 2.0 * u - 1.0;
    if all(p == vec2f()) {
        return vec2f();
    }
    var radius = p.y;
    var angle = 0.5 * light_PI - 0.25 * light_PI * (p.x / p.y);
    if abs(p.x) > abs(p.y) {
        radius = p.x;
        angle = 0.25 * light_PI * (p.y / p.x);
    }
    return radius * vec2f(cos(angle), sin(angle));
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

const search_ENOUGH_BLOCKERS = 4u;

const search_MIN_TAPS = 8u;

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

fn search_group_of(g: f32, max_g: f32, layer: u32) -> u32 {
    if !settings_MEANS_OF_RANGES {
        return layer;
    }
    return u32(clamp(floor(search_GROUPS * sqrt(saturate(g / max(max_g, 1e-20)))), 0.0, search_GROUPS - 1.0));
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
