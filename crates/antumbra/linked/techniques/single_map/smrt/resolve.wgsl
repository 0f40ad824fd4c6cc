// Linked from src/techniques/single_map/smrt/resolve.wesl by `cargo xtask shaders`: edit that, not this.

struct SmrtUniform {
    tile_search_count: u32,
    search_count: u32,
    ray_count: u32,
    max_steps: u32,
    rotate: u32,
    bias_scale: f32,
    light_extent: vec2f,
    light_extent_axis: f32,
    cells: f32,
    thickness_texels: vec2f,
    narrow_half_extent: f32,
    padding: u32
}

@group(2) @binding(0)
var<uniform> smrt: SmrtUniform;

override IS_SMOOTHED: bool = false;

override WEIGHS_IRRADIANCE: bool = false;

@group(3) @binding(0)
var noisy: texture_storage_2d<r32uint, write>;

const TILE_PROBES = 16u;

const PIXEL_PROBES = 32u;

const WIDE_PX = 8.0;

const GOLDEN = 0.618033989;

const R3 = vec3f(0.819172513, 0.671043607, 0.549700478);

const CROSSING_ROOM = 0.25;

const CROSSING_READS = 2;

struct Open {
    has_rays: bool,
    visibility: f32,
    shift: vec2f,
    max_g: f32,
    magnification_per_g: f32,
    min_magnification: f32,
    pixel_m: f32,
    fan: fan_Fan,
    light: light_taps_LightPlane,
    receiver: inputs_Receiver
}

fn known(visibility: f32) -> Open {
    var open = Open();
    open.visibility = visibility;
    return open;
}

fn shift_of(pixel: vec2u) -> vec2f {
    return select(vec2f(), noise_shift_of_pixel(pixel), smrt.rotate == 1u);
}

fn opened(receiver: inputs_Receiver, pixel: vec2u) -> Open {
    if receiver.is_background {
        return known(1.0);
    }
    let share = horizon_horizon_share(receiver);
    if !receiver.is_reached || (horizon_has_horizon_share() && share <= 0.0) {
        return known(0.0);
    }
    let plane = receiver_light_biased_plane(receiver, map_receiver_TEXEL_BIAS * smrt.bias_scale);
    let receiver_in_light = space_light_from_world(map_light_view, receiver.pos_in_world);
    let extent = blocker_range_seen_extent(smrt.light_extent, smrt.light_extent_axis, receiver_in_light);
    let shift = shift_of(pixel);
    let fan = fan_fan_of(plane, receiver_in_light.z, smrt.thickness_texels);
    let per_g = select(1.0, receiver_in_light.z, map_light_view.perspective == 1u);
    let texel_magnification = per_g * map_light_view.texel_in_plane / (2.0 * smrt.narrow_half_extent);
    let light = light_taps_light_plane(receiver, receiver_in_light, shift);
    let pixel_m = inputs_snapped_m(1.0, receiver.pos_in_world);
    let seen = select(share, 1.0, WEIGHS_IRRADIANCE);
    return Open(true, seen, shift, blocker_range_largest_g(plane, extent), per_g, texel_magnification, pixel_m, fan, light, receiver);
}

fn texel_at(fan: fan_Fan, offset: vec2f, g: f32, jitter: vec2f) -> vec2f {
    return floor(map_receiver_place_in_map(fan.at, fan.at.center + offset * g + (jitter - 0.5), g));
}

struct Beside {
    g: f32,
    nearer_by: f32
}

fn may_be_crossed(fan: fan_Fan, offset: vec2f, behind: Beside, in_front: Beside) -> bool {
    let passed_g = in_front.g - behind.g;
    let most = space_SURFACE_SLOPE * fan_texel_in_g(fan, in_front.g) * (abs(offset.x) + abs(offset.y)) * passed_g;
    let rise = behind.nearer_by - in_front.nearer_by - passed_g;
    return behind.nearer_by > 0.0 && in_front.nearer_by < 0.0 && rise <= most;
}

fn crossed_g(fan: fan_Fan, offset: vec2f, jitter: vec2f, behind: Beside, in_front: Beside) -> f32 {
    let room = CROSSING_ROOM * min(behind.nearer_by, -in_front.nearer_by);
    var a = behind;
    var b = in_front;
    for (var i = 0; i < CROSSING_READS && b.nearer_by < 0.0; i++) {
        let g = mix(a.g, b.g, a.nearer_by / (a.nearer_by - b.nearer_by));
        let found = fan_found_in(fan, texel_at(fan, offset, g, jitter), g - room, g + room, 0.0);
        if found.g != map_receiver_NO_G {
            return found.g;
        }
        if found.nearer_g > g {
            a = Beside(g, found.nearer_g - g);
        }
        else {
            b = Beside(g, found.farther_g - g);
        }
    }
    return map_receiver_NO_G;
}

fn found_in_step(fan: fan_Fan, offset: vec2f, steps: bins_Steps, step: u32, read_g: f32, jitter: vec2f) -> fan_Found {
    let begin_g = map_receiver_g_of(fan.at, bins_begin_of_step(steps, step));
    let end_g = map_receiver_g_of(fan.at, bins_begin_of_step(steps, step + 1u));
    let texel = texel_at(fan, offset, read_g, jitter);
    var found = fan_found_about(fan, texel, read_g, begin_g, end_g);
    if found.g == map_receiver_NO_G {
        return found;
    }
    let passed_g = clamp(found.g, max(begin_g, 0.0), end_g);
    let passed = texel_at(fan, offset, passed_g, jitter);
    if all(abs(passed - texel) <= vec2f(1.0)) {
        return found;
    }
    if found.g > read_g {
        found.nearer_g = found.g;
    }
    else {
        found.farther_g = found.g;
    }
    found.g = fan_found_about(fan, passed, passed_g, begin_g, end_g).g;
    return found;
}

fn blocker_g(fan: fan_Fan, offset: vec2f, steps: bins_Steps, jitter: vec3f) -> f32 {
    var along = jitter.z;
    var behind = Beside(0.0, fan.nearer_g);
    for (var rest = steps.some; rest > 0u; rest &= rest - 1u) {
        let step = countTrailingZeros(rest);
        let read_g = bins_g_in_step(fan.at, steps, step, along);
        let found = found_in_step(fan, offset, steps, step, read_g, jitter.xy);
        if found.g != map_receiver_NO_G {
            return found.g;
        }
        let in_front = Beside(read_g, found.farther_g - read_g);
        if may_be_crossed(fan, offset, behind, in_front) {
            let hit_g = crossed_g(fan, offset, jitter.xy, behind, in_front);
            if hit_g != map_receiver_NO_G {
                return hit_g;
            }
        }
        behind = Beside(read_g, found.nearer_g - read_g);
        along = fract(along + GOLDEN);
    }
    return map_receiver_NO_G;
}

fn end_of(light: light_taps_LightPlane, tap: vec3f) -> vec3f {
    if light_taps_LIGHT_KIND == light_KIND_RECTANGLE {
        let in_cells = smrt.cells * tap.xy;
        return vec3f(2.0 * (floor(in_cells) + fract(in_cells + light.shift)) / smrt.cells - 1.0, 0.0);
    }
    return light_taps_place_of(light, tap);
}

struct Rays {
    weight: f32,
    free: f32,
    min_g: f32
}

fn is_undecided(rays: Rays) -> bool {
    return rays.weight <= 0.0 || (rays.free > 0.0 && rays.free < rays.weight);
}

fn findings(rays: Rays) -> u32 {
    return select(0u, FREE, rays.free > 0.0 || rays.weight <= 0.0) | select(0u, BLOCKED, rays.free < rays.weight || rays.weight <= 0.0);
}

fn weight_at(receiver: inputs_Receiver, place: vec3f) -> f32 {
    let emitted = light_taps_weight_of(place);
    if !WEIGHS_IRRADIANCE {
        return emitted;
    }
    let facing = irradiance_facing_of_points(inputs_light_source, receiver.pos_in_world);
    return emitted * irradiance_given_by_point(inputs_light_source, facing, receiver.normal_in_world, light_taps_segment_to(receiver, place));
}

fn follow(open: Open, steps: bins_Steps, before: Rays, begin: u32, end: u32) -> Rays {
    let first = vec3f(open.shift, fract(open.shift.x + GOLDEN * open.shift.y));
    var sums = before;
    for (var i = begin; i < min(end, smrt.ray_count); i++) {
        let place = end_of(open.light, light_taps_taps[smrt.tile_search_count + i].xyz);
        let weight = weight_at(open.receiver, place);
        let is_above = light_taps_is_above_horizon(open.light, place);
        sums.weight += select(0.0, weight, is_above || !horizon_has_horizon_share());
        if is_above {
            let jitter = fract(first + f32(i) * R3);
            let g = blocker_g(open.fan, light_taps_texels_of(open.light, place), steps, jitter);
            sums.free += select(0.0, weight, g == map_receiver_NO_G);
            sums.min_g = min(sums.min_g, g);
        }
    }
    return sums;
}

fn probes(of_64: u32) -> u32 {
    return select(smrt.ray_count, min(smrt.ray_count, max(of_64, of_64 * smrt.ray_count / 64u)), light_taps_IS_PROGRESSIVE);
}

var<workgroup> farthest_bits: atomic<u32>;

var<workgroup> nearest_bits: atomic<u32>;

var<workgroup> rays_found: atomic<u32>;

const FREE = 1u;

const BLOCKED = 2u;

fn tile_bins() -> bins_Bins {
    return bins_bins_between(bins_depth_of_bits(atomicLoad(&farthest_bits)), bins_depth_of_bits(atomicLoad(&nearest_bits)));
}

fn magnification(open: Open, min_g: f32) -> f32 {
    if !open.has_rays {
        return noisy_NO_SMOOTHING;
    }
    if min_g == map_receiver_NO_G {
        return noisy_NO_MAGNIFICATION;
    }
    return max(open.magnification_per_g * min_g, open.min_magnification);
}

fn is_narrow(open: Open, min_g: f32) -> bool {
    return 2.0 * smrt.narrow_half_extent * magnification(open, min_g) < WIDE_PX * open.pixel_m;
}

fn write_pixel(pixel: vec2u, visibility: f32, magnification: f32) {
    if IS_SMOOTHED {
        textureStore(noisy, pixel, vec4u(noisy_packed_noisy(visibility, magnification)));
    }
    else {
        inputs_write_visibility(pixel, visibility);
    }
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_id) place: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = inputs_known_pixel(id.xy);
    let is_pixel = inputs_is_inside(pixel);
    if lane == 0u {
        atomicStore(&farthest_bits, bins_depth_bits(map_receiver_max_depth()));
        atomicStore(&nearest_bits, 0u);
        atomicStore(&rays_found, 0u);
    }
    bins_empty_bins(lane);
    workgroupBarrier();
    var open = known(1.0);
    var is_receiver = false;
    if is_pixel {
        let receiver = inputs_load_receiver(pixel);
        is_receiver = !receiver.is_background;
        open = opened(receiver, pixel);
    }
    let may_be_blocked = open.has_rays && open.max_g > 0.0;
    if may_be_blocked {
        atomicMin(&farthest_bits, bins_depth_bits(open.fan.at.depth));
        atomicMax(&nearest_bits, bins_depth_bits(map_receiver_depth_at_g(open.fan.at, open.max_g)));
    }
    workgroupBarrier();
    let bins = tile_bins();
    if may_be_blocked {
        let shift = shift_of(id.xy - place.xy);
        let search_taps = bins_SearchTaps(smrt.tile_search_count, lane, shift.x + shift.y);
        bins_search(open.fan.at, light_taps_shifted(open.light, shift), open.max_g, search_taps, smrt.search_count, bins);
    }
    workgroupBarrier();
    bins_join_bins(lane);
    workgroupBarrier();
    let steps = bins_steps_of(open.fan.at, bins, smrt.max_steps);
    let has_rays = open.has_rays && (steps.some > 0u || !horizon_has_horizon_share());
    var sums = Rays(0.0, 0.0, map_receiver_NO_G);
    if has_rays {
        sums = follow(open, steps, sums, 0u, probes(TILE_PROBES));
        atomicOr(&rays_found, findings(sums));
    }
    workgroupBarrier();
    if has_rays && atomicLoad(&rays_found) == (FREE | BLOCKED) {
        if !IS_SMOOTHED || is_narrow(open, sums.min_g) || sums.weight <= 0.0 {
            sums = follow(open, steps, sums, probes(TILE_PROBES), probes(PIXEL_PROBES));
            if is_undecided(sums) {
                sums = follow(open, steps, sums, probes(PIXEL_PROBES), smrt.ray_count);
            }
        }
    }
    if select(is_pixel, is_receiver, IS_SMOOTHED) {
        let share = select(1.0, open.visibility, horizon_has_horizon_share());
        let visibility = select(open.visibility, share * sums.free / max(sums.weight, 1e-20), has_rays);
        write_pixel(pixel, visibility, magnification(open, sums.min_g));
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

const noisy_NO_MAGNIFICATION = 65504.0;

const noisy_NO_SMOOTHING = 0.0;

fn noisy_packed_noisy(visibility: f32, magnification: f32) -> u32 {
    return pack2x16float(vec2f(visibility, min(magnification, noisy_NO_MAGNIFICATION)));
}

fn bits_even_bits(number: u32) -> u32 {
    var x = number & 1431655765u;
    x = (x | (x >> 1u)) & 858993459u;
    x = (x | (x >> 2u)) & 252645135u;
    x = (x | (x >> 4u)) & 16711935u;
    return (x | (x >> 8u)) & 65535u;
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

@group(0) @binding(5)
var<storage, read> inputs_light_data: array<vec4f>;

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

fn inputs_snapped_m(snapped_px: f32, pos_in_world: vec3f) -> f32 {
    return inputs_snapped_at_w(snapped_px, abs(dot(inputs_receiver_view.clip_w_row, vec4f(pos_in_world, 1.0))));
}

fn inputs_snapped_at_w(snapped_px: f32, w: f32) -> f32 {
    return snapped_px * inputs_receiver_view.pixel_m_per_w * w;
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

fn irradiance_facing_of_points(light: light_LightSource, x: vec3f) -> vec3f {
    if light.kind == light_KIND_SPHERE {
        return -normalize(light.center_in_world - x);
    }
    return light.axis_in_world;
}

fn irradiance_given_by_point(light: light_LightSource, facing: vec3f, normal: vec3f, d: vec3f) -> f32 {
    let inverse_squared = 1.0 / max(dot(d, d), 1e-30);
    let towards = sqrt(inverse_squared) * d;
    let arriving = max(dot(normal, towards), 0.0);
    let has_surface = light.kind != light_KIND_ELLIPSOID && light.kind != light_KIND_POINTS;
    let leaving = select(1.0, max(-dot(facing, towards), 0.0), has_surface);
    return arriving * leaving * inverse_squared;
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

fn light_taps_segment_to(receiver: inputs_Receiver, place: vec3f) -> vec3f {
    let is_sun = light_taps_LIGHT_KIND == light_KIND_SUN;
    let to_center = select(inputs_light_source.center_in_world - receiver.pos_in_world, -inputs_light_source.axis_in_world, is_sun);
    return to_center + light_taps_half_axes(receiver) * place;
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

const map_receiver_TEXEL_BIAS = 2.0;

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

fn map_receiver_depth_at_g(receiver: map_receiver_MapReceiver, g: f32) -> f32 {
    return receiver.depth + g / receiver.g_per_depth;
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

const bins_BIN_COUNT = 32u;

const bins_TILE_PIXELS = 64u;

const bins_ROOM = 0.5;

const bins_BESIDE = 4.0;

var<workgroup> bins_bins_found: atomic<u32>;

var<workgroup> bins_least_found: array<atomic<u32>, bins_BIN_COUNT>;

var<workgroup> bins_greatest_found: array<atomic<u32>, bins_BIN_COUNT>;

var<workgroup> bins_last_found: atomic<u32>;

var<workgroup> bins_beside_found: atomic<u32>;

var<workgroup> bins_free_found: atomic<u32>;

var<workgroup> bins_found_between: array<vec2f, 2u * bins_BIN_COUNT>;

struct bins_Bins {
    begin: f32,
    range: f32
}

fn bins_bins_between(begin: f32, end: f32) -> bins_Bins {
    return bins_Bins(begin, max(end - begin, 1e-20));
}

fn bins_place_among(bins: bins_Bins, depth: f32) -> f32 {
    return f32(bins_BIN_COUNT) * sqrt(saturate((depth - bins.begin) / bins.range));
}

fn bins_depth_at(bins: bins_Bins, place: f32) -> f32 {
    let share = place / f32(bins_BIN_COUNT);
    return bins.begin + bins.range * share * share;
}

fn bins_bin_at(place: f32) -> u32 {
    return u32(clamp(place, 0.0, f32(bins_BIN_COUNT) - 1.0));
}

fn bins_depth_bits(depth: f32) -> u32 {
    return bitcast<u32>(clamp(depth, map_receiver_min_depth(), map_receiver_max_depth()) - map_receiver_min_depth());
}

fn bins_depth_of_bits(bits: u32) -> f32 {
    return bitcast<f32>(bits) + map_receiver_min_depth();
}

fn bins_empty_bins(lane: u32) {
    if lane < bins_BIN_COUNT {
        atomicStore(&bins_least_found[lane], 4294967295u);
        atomicStore(&bins_greatest_found[lane], 0u);
    }
    if lane == 0u {
        atomicStore(&bins_bins_found, 0u);
        atomicStore(&bins_last_found, 0u);
        atomicStore(&bins_beside_found, 0u);
        atomicStore(&bins_free_found, 0u);
    }
}

struct bins_SearchTaps {
    tile_count: u32,
    first: u32,
    scale_shift: f32
}

struct bins_Marks {
    found: u32,
    last: u32,
    beside: u32,
    free: u32
}

fn bins_search(receiver: map_receiver_MapReceiver, light: light_taps_LightPlane, max_g: f32, search_taps: bins_SearchTaps, count: u32, bins: bins_Bins) {
    let own = floor(receiver.center);
    var marks = bins_with_blockers_at(bins_Marks(0u, 0u, 0u, 0u), receiver, map_receiver_Look(own, select(map_receiver_NO_G, 0.0, map_receiver_is_texel(own))), bins);
    for (var i = 0u; i < count; i++) {
        let tap = (search_taps.first + bins_TILE_PIXELS * i) % search_taps.tile_count;
        let share = map_receiver_scale_share(tap, search_taps.scale_shift);
        let g = max_g * share * select(share, 1.0, i % 2u == 0u);
        marks = bins_with_blockers_at(marks, receiver, map_receiver_look_at_scale(receiver, light, g, tap), bins);
    }
    atomicOr(&bins_bins_found, marks.found);
    atomicOr(&bins_last_found, marks.last);
    atomicOr(&bins_beside_found, marks.beside);
    atomicOr(&bins_free_found, marks.free);
}

fn bins_with_blockers_at(before: bins_Marks, receiver: map_receiver_MapReceiver, look: map_receiver_Look, bins: bins_Bins) -> bins_Marks {
    var marks = before;
    if look.hiding_g == map_receiver_NO_G {
        return marks;
    }
    let least = map_receiver_blocking_depths_at(receiver, look.texel).x;
    let hiding_place = bins_place_among(bins, map_receiver_depth_at_g(receiver, look.hiding_g)) + 1.0;
    var free = select(0u, 4294967295u << bins_bin_at(hiding_place), hiding_place < f32(bins_BIN_COUNT));
    for (var layer = 0u; layer < behind_LAYER_COUNT; layer++) {
        let depth = map_receiver_stored_depth(vec2u(look.texel), layer);
        if depth <= least {
            break;
        }
        let g = map_receiver_g_of(receiver, depth);
        let place = bins_place_among(bins, depth);
        let bin = bins_bin_at(place);
        let is_last = layer + 1u == behind_LAYER_COUNT;
        let about = (1u << bin) | (1u << bins_bin_at(place - bins_ROOM)) | (1u << bins_bin_at(place + bins_ROOM));
        free &= select(~about, 4294967294u << bin, is_last);
        if g >= look.hiding_g {
            marks.found |= about;
            atomicMin(&bins_least_found[bin], bins_depth_bits(depth));
            atomicMax(&bins_greatest_found[bin], bins_depth_bits(depth));
            marks.last |= select(0u, 1u << bin, is_last);
        }
        else if bins_BESIDE * g >= look.hiding_g {
            marks.beside |= 1u << bin;
        }
    }
    marks.free |= free;
    return marks;
}

fn bins_bins_behind_last() -> u32 {
    let last = atomicLoad(&bins_last_found);
    let behind = select(0u, 4294967295u >> countLeadingZeros(last), last != 0u);
    return atomicLoad(&bins_beside_found) & ~atomicLoad(&bins_free_found) & behind;
}

fn bins_join_bins(lane: u32) {
    let level = min(countLeadingZeros(63u - min(lane, 62u)) - 26u, 5u);
    let begin = (lane - (64u - (64u >> level))) << level;
    var least = 4294967295u;
    var greatest = 0u;
    for (var i = 0u; i < bins_BIN_COUNT; i++) {
        if i >= begin && i < begin + (1u << level) {
            least = min(least, atomicLoad(&bins_least_found[i]));
            greatest = max(greatest, atomicLoad(&bins_greatest_found[i]));
        }
    }
    bins_found_between[lane] = vec2f(bins_depth_of_bits(min(least, greatest)), bins_depth_of_bits(greatest));
}

struct bins_Steps {
    bins: bins_Bins,
    width: f32,
    some: u32,
    first: u32
}

fn bins_steps_of(receiver: map_receiver_MapReceiver, bins: bins_Bins, most: u32) -> bins_Steps {
    var steps = bins_Steps(bins, 1.0, atomicLoad(&bins_bins_found) | bins_bins_behind_last(), 0u);
    steps.some &= 4294967295u << bins_bin_at(bins_place_among(bins, receiver.depth));
    for (var i = 0; i < 5 && countOneBits(steps.some) > most; i++) {
        steps.some = bins_of_pairs(steps.some);
        steps.width *= 2.0;
        steps.first = 32u + steps.first / 2u;
    }
    return steps;
}

fn bins_begin_of_step(steps: bins_Steps, step: u32) -> f32 {
    return bins_depth_at(steps.bins, steps.width * f32(step));
}

fn bins_g_in_step(receiver: map_receiver_MapReceiver, steps: bins_Steps, step: u32, along: f32) -> f32 {
    var between = bins_found_between[steps.first + step];
    if between.y <= map_receiver_min_depth() {
        between = vec2f(bins_begin_of_step(steps, step), bins_begin_of_step(steps, step + 1u));
    }
    return max(map_receiver_g_of(receiver, mix(between.x, between.y, along)), 0.0);
}

fn bins_of_pairs(bits: u32) -> u32 {
    return bits_even_bits(bits | (bits >> 1u));
}

struct fan_Fan {
    at: map_receiver_MapReceiver,
    widening: vec2f,
    thickness: vec2f,
    nearer_g: f32
}

fn fan_thickness_of(texels: f32) -> f32 {
    let tangent = texels * map_light_view.texel_in_plane;
    return select(tangent, tangent / (1.0 + tangent), map_light_view.perspective == 1u);
}

fn fan_fan_of(plane: space_ReceiverPlane, z_m: f32, thickness_texels: vec2f) -> fan_Fan {
    let thickness = vec2f(fan_thickness_of(thickness_texels.x), fan_thickness_of(thickness_texels.y));
    let widening = select(vec2f(1.0, 0.0), vec2f(1.0 / z_m, 1.0), map_light_view.perspective == 1u);
    var fan = fan_Fan(map_receiver_map_receiver(plane, z_m), widening, thickness, -map_receiver_NO_G);
    let at_receiver = fan_found_in(fan, floor(fan.at.center), 0.0, 0.0, 1.0);
    fan.nearer_g = select(at_receiver.nearer_g, at_receiver.g, at_receiver.g != map_receiver_NO_G);
    return fan;
}

fn fan_texel_in_g(fan: fan_Fan, g: f32) -> f32 {
    return map_light_view.texel_in_plane * (fan.widening.x + fan.widening.y * g);
}

struct fan_Found {
    g: f32,
    behind_g: f32,
    nearer_g: f32,
    farther_g: f32
}

fn fan_found_in(fan: fan_Fan, texel: vec2f, begin_g: f32, end_g: f32, slab: f32) -> fan_Found {
    var found = fan_Found(map_receiver_NO_G, map_receiver_NO_G, -map_receiver_NO_G, map_receiver_NO_G);
    if !map_receiver_is_texel(texel) {
        return found;
    }
    let begin = max(fan.at.depth, map_receiver_depth_at_g(fan.at, begin_g));
    let depths = max(map_receiver_blocking_depths_at(fan.at, texel), vec2f(begin));
    for (var layer = 0u; layer < behind_LAYER_COUNT; layer++) {
        let depth = map_receiver_stored_depth(vec2u(texel), layer);
        let g = map_receiver_g_of(fan.at, depth);
        if depth <= depths.x {
            found.behind_g = select(found.behind_g, g, depth > begin);
            found.farther_g = g;
            break;
        }
        if fan_far_side(fan, g, layer, slab) <= end_g {
            if depth < depths.y {
                found.g = g;
                break;
            }
            found.behind_g = g;
        }
        else {
            found.nearer_g = g;
        }
    }
    return found;
}

fn fan_found_about(fan: fan_Fan, texel: vec2f, g: f32, begin_g: f32, end_g: f32) -> fan_Found {
    var found = fan_found_in(fan, texel, begin_g, end_g, 1.0);
    if found.g != map_receiver_NO_G || found.behind_g == map_receiver_NO_G {
        return found;
    }
    let passed_depth = map_receiver_depth_at_g(fan.at, select(g, found.behind_g, map_receiver_faces_away(fan.at)));
    found.g = fan_found_in(fan, map_receiver_texel_in_front(fan.at, texel, passed_depth), begin_g, end_g, 1.0).g;
    return found;
}

fn fan_far_side(fan: fan_Fan, g: f32, layer: u32, slab: f32) -> f32 {
    let thickness = slab * select(fan.thickness.x, fan.thickness.y, layer + 1u == behind_LAYER_COUNT);
    return g - thickness * (fan.widening.x + fan.widening.y * g);
}
