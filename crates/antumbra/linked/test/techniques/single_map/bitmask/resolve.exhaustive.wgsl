// Linked from src/techniques/single_map/bitmask/resolve.wesl with exhaustive by `cargo xtask shaders`: edit that, not this.

const LEVELS = 13u;

struct Hidden {
    words: array<u32, settings_MAX_WORDS>
}

fn below_horizon(light: light_taps_LightPlane, share: f32) -> Hidden {
    var hidden = Hidden();
    let is_whole = horizon_has_horizon_share() && share >= 1.0;
    for (var word = 0u; word < min(settings_WORD_COUNT, settings_MAX_WORDS); word++) {
        for (var i = 0u; i < 32u; i++) {
            let point = 32u * word + i;
            if point >= settings_bitmask.sample_count {
                hidden.words[word] |= 1u << i;
            }
            else if !is_whole && !light_taps_is_above_horizon(light, light_taps_place_of(light, light_taps_taps[point].xyz)) {
                hidden.words[word] |= 1u << i;
            }
        }
    }
    return hidden;
}

fn is_all_hidden(hidden: Hidden) -> bool {
    var bits = 4294967295u;
    for (var word = 0u; word < min(settings_WORD_COUNT, settings_MAX_WORDS); word++) {
        bits &= hidden.words[word];
    }
    return bits == 4294967295u;
}

fn open_points(bits: u32, bins: light_bits_Bins, word: u32) -> u32 {
    var rest = ~bits;
    return rest;
}

fn hide_by(patch_: patch_Patch, wider: patch_Patch, bins: light_bits_Bins, light: light_taps_LightPlane, hidden: ptr<function, Hidden>) -> bool {
    var has_more = false;
    for (var word = 0u; word < min(settings_WORD_COUNT, settings_MAX_WORDS); word++) {
        let before = (*hidden).words[word];
        var bits = before;
        for (var rest = open_points(before, bins, word); rest > 0u; rest &= rest - 1u) {
            let i = countTrailingZeros(rest);
            let offset = light_taps_texels_of(light, light_taps_place_of(light, light_taps_taps[32u * word + i].xyz));
            let is_hidden = patch_hides(patch_, offset);
            bits |= select(0u, 1u << i, is_hidden);
            has_more |= !is_hidden && patch_hides(wider, offset);
        }
        (*hidden).words[word] = bits;
    }
    return has_more;
}

struct Layers {
    first: u32,
    end: u32
}

fn hide_in(window: window_Window, square: window_Square, layers: Layers, light: light_taps_LightPlane, hidden: ptr<function, Hidden>) {
    let slope = max(settings_bitmask.steepest_gap, 0.0);
    for (var layer = layers.first; layer < min(layers.end, behind_LAYER_COUNT); layer++) {
        let scale = window_scale_in(window, square, layer);
        if scale <= 0.0 {
            break;
        }
        let widest = window_widest_patch(window, square, scale, slope);
        let bins = light_bits_bins_of(light, window_near_open(window, widest));
        if hide_by(window_own_patch(window, square, scale), widest, bins, light, hidden) {
            let filled = window_joined_patch(window, square, scale, layer, slope);
            _ = hide_by(filled, filled, bins, light, hidden);
        }
    }
}

fn hide_whole(window: window_Window, square: window_Square, depths: window_Depths, light: light_taps_LightPlane, hidden: ptr<function, Hidden>) -> bool {
    let slope = max(settings_bitmask.steepest_gap, 0.0);
    let outer = window_outer_patch(window, square, depths, slope);
    return hide_by(window_inner_patch(window, square, depths, slope), outer, light_bits_bins_of(light, window_near_open(window, outer)), light, hidden);
}

const SKIP = 0u;

const SHOW = 1u;

const SPLIT = 2u;

fn step_at(window: window_Window, square: window_Square, layers: Layers, light: light_taps_LightPlane, hidden: ptr<function, Hidden>) -> u32 {
    if square.level == 0u {
        return SHOW;
    }
    let depths = window_depths_in(window, square);
    if depths.most <= 0.0 {
        return SKIP;
    }
    if window_side_of(square) <= window.widest * depths.most {
        return SHOW;
    }
    {
        if layers.end == 1u && depths.least > 0.0 && !hide_whole(window, square, depths, light, hidden) {
            return SKIP;
        }
    }
    return SPLIT;
}

fn hide_below(window: window_Window, root: vec2u, layers: Layers, light: light_taps_LightPlane, hidden: ptr<function, Hidden>) {
    let across = 2u * settings_bitmask.patches + 4u;
    let end = 1u << (2u * window.level);
    var level = window.level;
    var code = 0u;
    for (var i = 0u; i < LEVELS * across * across; i++) {
        if code >= end || is_all_hidden(*hidden) {
            break;
        }
        let square = window_square_at(window, root, code, level);
        let step = step_at(window, square, layers, light, hidden);
        if step == SPLIT {
            level -= 1u;
            continue;
        }
        if step == SHOW {
            hide_in(window, square, layers, light, hidden);
        }
        code += 1u << (2u * level);
        level = min(countTrailingZeros(code) / 2u, window.level);
    }
}

fn visible_share(light: light_taps_LightPlane, hidden: Hidden) -> f32 {
    var sums = vec2f();
    for (var word = 0u; word < min(settings_WORD_COUNT, settings_MAX_WORDS); word++) {
        if !light_taps_HAS_EMISSION {
            sums += vec2f(f32(countOneBits(~hidden.words[word])), 0.0);
            continue;
        }
        for (var i = 0u; i < 32u; i++) {
            let point = 32u * word + i;
            if point < settings_bitmask.sample_count {
                let weight = light_taps_weight_of(light_taps_place_of(light, light_taps_taps[point].xyz));
                sums += weight * vec2f(select(1.0, 0.0, (hidden.words[word] & (1u << i)) != 0u), 1.0);
            }
        }
    }
    return sums.x / max(select(f32(settings_bitmask.sample_count), sums.y, light_taps_HAS_EMISSION), 1e-20);
}

fn hide_all(window: window_Window, layers: Layers, light: light_taps_LightPlane, hidden: ptr<function, Hidden>) {
    for (var y = 0u; y < min(window.count.y, window_ROOTS + 1u); y++) {
        for (var x = 0u; x < min(window.count.x, window_ROOTS + 1u); x++) {
            hide_below(window, window.first + vec2u(x, y), layers, light, hidden);
        }
    }
}

fn open_bounds(light: light_taps_LightPlane, hidden: Hidden) -> patch_Patch {
    var bounds = patch_Patch(vec2f(1e30), vec2f(-1e30));
    for (var word = 0u; word < min(settings_WORD_COUNT, settings_MAX_WORDS); word++) {
        for (var rest = ~hidden.words[word]; rest > 0u; rest &= rest - 1u) {
            let offset = light_taps_texels_of(light, light_taps_place_of(light, light_taps_taps[32u * word + countTrailingZeros(rest)].xyz));
            bounds = patch_Patch(min(bounds.low, offset), max(bounds.high, offset));
        }
    }
    return bounds;
}

fn visibility(receiver: inputs_Receiver, pixel: vec2u) -> f32 {
    if receiver.is_background {
        return 1.0;
    }
    let share = horizon_horizon_share(receiver);
    if !receiver.is_reached || (horizon_has_horizon_share() && share <= 0.0) {
        return 0.0;
    }
    let plane = receiver_light_biased_plane(receiver, map_receiver_TEXEL_BIAS * settings_bitmask.bias_scale);
    let pos_in_light = space_light_from_world(map_light_view, receiver.pos_in_world);
    let extent = blocker_range_seen_extent(settings_bitmask.light_extent, settings_bitmask.light_extent_axis, pos_in_light);
    let max_g = blocker_range_largest_g(plane, extent);
    if max_g <= 0.0 && horizon_has_horizon_share() {
        return share;
    }
    let shift = select(vec2f(), noise_shift_of_pixel(pixel), settings_bitmask.rotate == 1u);
    let light = light_taps_light_plane(receiver, pos_in_light, shift);
    let texels = light_taps_texels_per_offset();
    let reach = abs(texels[0]) * extent.x + abs(texels[1]) * extent.y;
    let at = map_receiver_map_receiver(plane, pos_in_light.z);
    var window = window_window_of(at, pos_in_light.z, reach, max_g, settings_bitmask.patches, shown_texel_shown_share(shift));
    var hidden = below_horizon(light, share);
    for (var part = 0u; part < min(behind_LAYER_COUNT, 2u) && !is_all_hidden(hidden); part++) {
        if part == 1u {
            window.open = open_bounds(light, hidden);
        }
        hide_all(window, Layers(part, select(behind_LAYER_COUNT, 1u, part == 0u)), light, &hidden);
    }
    return visible_share(light, hidden);
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    if light_bits_has_table() {
        light_bits_make_prefix(lane);
    }
    workgroupBarrier();
    let pixel = inputs_known_pixel(id.xy);
    if inputs_is_inside(pixel) {
        inputs_write_visibility(pixel, visibility(inputs_load_receiver(pixel), pixel));
    }
}

const bias_HALF_TEXEL = 0.5;

const bias_SNAPPED_TEXELS = 0.00390625;

fn bias_automatic_bias_m(texel_width_m: f32, grazing_sine: f32, bias_scale: f32) -> f32 {
    return bias_scale * texel_width_m * max(bias_HALF_TEXEL, bias_SNAPPED_TEXELS / grazing_sine);
}

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

const light_bits_BINS = 32u;

const light_bits_PREFIXES = 33u;

fn light_bits_has_table() -> bool {
    return light_taps_LIGHT_KIND != light_KIND_ELLIPSOID && light_taps_LIGHT_KIND != light_KIND_POINTS;
}

var<workgroup> light_bits_prefixes: array<u32, 2u * light_bits_PREFIXES * settings_MAX_WORDS>;

fn light_bits_word_of(axis: u32, bins: u32, word: u32) -> u32 {
    return (axis * light_bits_PREFIXES + bins) * settings_MAX_WORDS + word;
}

fn light_bits_table_place(tap: vec2f) -> vec2f {
    return select(0.5 * tap + 0.5, tap, light_taps_LIGHT_KIND == light_KIND_RECTANGLE);
}

fn light_bits_make_prefix(lane: u32) {
    let axis = lane / light_bits_BINS;
    let bin = lane % light_bits_BINS;
    for (var word = 0u; word < min(settings_WORD_COUNT, settings_MAX_WORDS); word++) {
        var bits = 0u;
        for (var i = 0u; i < 32u; i++) {
            let point = 32u * word + i;
            if point < settings_bitmask.sample_count {
                let place = light_bits_table_place(light_taps_taps[point].xy)[axis];
                bits |= select(0u, 1u << i, u32(clamp(f32(light_bits_BINS) * place, 0.0, f32(light_bits_BINS) - 1.0)) <= bin);
            }
        }
        light_bits_prefixes[light_bits_word_of(axis, bin + 1u, word)] = bits;
        if bin == 0u {
            light_bits_prefixes[light_bits_word_of(axis, 0u, word)] = 0u;
        }
    }
}

struct light_bits_Bins {
    first: vec2i,
    last: vec2i
}

const light_bits_ROUNDING = 0.01;

const light_bits_FAR_OUT = 100000000.0;

fn light_bits_bins_of(light: light_taps_LightPlane, patch_: patch_Patch) -> light_bits_Bins {
    let farthest = max(abs(patch_.low), abs(patch_.high));
    if max(farthest.x, farthest.y) > light_bits_FAR_OUT || light_place_is_thin(light) {
        return light_bits_Bins(vec2i(), vec2i(i32(light_bits_BINS) - 1));
    }
    let a = light_place_place_at(light, patch_.low);
    let b = light_place_place_at(light, vec2f(patch_.high.x, patch_.low.y));
    let c = light_place_place_at(light, patch_.high);
    let d = light_place_place_at(light, vec2f(patch_.low.x, patch_.high.y));
    var low = clamp(min(min(a, b), min(c, d)), vec2f(-1.0), vec2f(1.0));
    var high = clamp(max(max(a, b), max(c, d)), vec2f(-1.0), vec2f(1.0));
    if light_taps_LIGHT_KIND == light_KIND_RECTANGLE {
        low = 0.5 * low + 0.5 - light.shift;
        high = 0.5 * high + 0.5 - light.shift;
    }
    else {
        let middle = (0.5 * (low + high)) * light.turn;
        let half = 0.5 * (high - low);
        let turned = vec2f(dot(abs(light.turn[0]), half), dot(abs(light.turn[1]), half));
        low = clamp(0.5 * (middle - turned) + 0.5, vec2f(), vec2f(1.0));
        high = clamp(0.5 * (middle + turned) + 0.5, vec2f(), vec2f(1.0));
    }
    return light_bits_Bins(vec2i(floor(f32(light_bits_BINS) * low - light_bits_ROUNDING)), vec2i(floor(f32(light_bits_BINS) * high + light_bits_ROUNDING)));
}

struct settings_BitmaskUniform {
    sample_count: u32,
    patches: u32,
    rotate: u32,
    steepest_gap: f32,
    light_extent: vec2f,
    light_extent_axis: f32,
    bias_scale: f32
}

@group(2) @binding(0)
var<uniform> settings_bitmask: settings_BitmaskUniform;

override settings_WORD_COUNT: u32 = 2u;

const settings_MAX_WORDS: u32 = 8;

override light_taps_LIGHT_KIND: u32 = 0u;

override light_taps_HAS_EMISSION: bool = false;

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

fn map_receiver_held(receiver: map_receiver_MapReceiver, depth: f32) -> f32 {
    return clamp(max(depth, receiver.depth), map_receiver_min_depth(), map_receiver_max_depth());
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

fn light_place_place_at(light: light_taps_LightPlane, offset: vec2f) -> vec2f {
    let right = light.right + offset * light.nearness.x;
    let up = light.up + offset * light.nearness.y;
    let to = offset * (1.0 - light.center_nearness) - light.origin;
    let determinant = right.x * up.y - right.y * up.x;
    let inverse = 1.0 / select(determinant, 1e-30, determinant == 0.0);
    return clamp(vec2f(to.x * up.y - to.y * up.x, right.x * to.y - right.y * to.x) * inverse, vec2f(-1000000.0), vec2f(1000000.0));
}

const light_place_THINNEST = 0.001;

fn light_place_is_thin(light: light_taps_LightPlane) -> bool {
    let determinant = light.right.x * light.up.y - light.right.y * light.up.x;
    return abs(determinant) <= light_place_THINNEST * max(dot(light.right, light.right), dot(light.up, light.up));
}

struct patch_Patch {
    low: vec2f,
    high: vec2f
}

fn patch_patch_of(low: vec2f, high: vec2f, scale: f32) -> patch_Patch {
    return patch_Patch(low * scale, high * scale);
}

fn patch_hides(patch_: patch_Patch, offset: vec2f) -> bool {
    return all(offset >= patch_.low) && all(offset < patch_.high);
}

struct patch_Neighbours {
    below: vec3f,
    beside: vec2f,
    above: vec3f
}

fn patch_reach_of(edge: f32, own: f32, neighbours: vec3f) -> vec2f {
    let places = edge * select(vec3f(own), neighbours, neighbours > vec3f());
    let least = min(min(places.x, places.y), places.z);
    let most = max(max(places.x, places.y), places.z);
    return vec2f(min(least, edge * own), max(most, edge * own));
}

fn patch_joined(low: vec2f, high: vec2f, own: f32, around: patch_Neighbours) -> patch_Patch {
    let left = vec3f(around.below.x, around.beside.x, around.above.x);
    let right = vec3f(around.below.z, around.beside.y, around.above.z);
    return patch_Patch(vec2f(patch_reach_of(low.x, own, left).x, patch_reach_of(low.y, own, around.below).x), vec2f(patch_reach_of(high.x, own, right).y, patch_reach_of(high.y, own, around.above).y));
}

fn patch_widest_of(low: vec2f, high: vec2f, scales: vec3f) -> patch_Patch {
    return patch_Patch(min(min(low * scales.x, low * scales.y), low * scales.z), max(max(high * scales.x, high * scales.y), high * scales.z));
}

fn patch_innermost_of(low: vec2f, high: vec2f, scales: vec2f) -> patch_Patch {
    return patch_Patch(max(low * scales.x, low * scales.y), min(high * scales.x, high * scales.y));
}

const shown_texel_GOLDEN = 0.618033989;

const shown_texel_R2 = vec2f(0.754877666, 0.569840291);

fn shown_texel_shown_share(shift: vec2f) -> vec2f {
    return shift + shown_texel_R2;
}

fn shown_texel_shown_texel(place: vec2i, level: u32, share: vec2f) -> vec2i {
    let within = fract(share + shown_texel_GOLDEN * vec2f(place.yx & vec2i(63)));
    return (place << vec2u(level)) + vec2i(within * f32(1u << level));
}

fn surface_step_surface_steps(inverse_z: f32, side: f32, g: vec4f, slope: f32) -> vec4f {
    let per_slope = map_light_view.texel_in_plane * side;
    return slope * space_SURFACE_SLOPE * per_slope * select(vec4f(1.0), g + inverse_z, map_light_view.perspective == 1u);
}

fn surface_step_surface_step(inverse_z: f32, side: f32, g: f32, slope: f32) -> f32 {
    return surface_step_surface_steps(inverse_z, side, vec4f(g), slope).x;
}

struct window_Window {
    at: map_receiver_MapReceiver,
    inverse_z: f32,
    open: patch_Patch,
    widest: f32,
    level: u32,
    first: vec2u,
    count: vec2u,
    share: vec2f
}

struct window_Square {
    place: vec2u,
    level: u32
}

const window_ROOTS = 4u;

fn window_window_of(at: map_receiver_MapReceiver, z_m: f32, extent: vec2f, max_g: f32, parts: u32, share: vec2f) -> window_Window {
    let last = map_light_view.map_size - 1.0;
    let low = vec2u(clamp(at.center - extent * max_g, vec2f(), last));
    let high = vec2u(clamp(at.center + extent * max_g, vec2f(), last));
    let span = max(high.x - low.x, high.y - low.y);
    let level = 32u - countLeadingZeros(span / window_ROOTS);
    let first = low >> vec2u(level);
    let widest = 2.0 * sqrt(extent.x * extent.y) / f32(parts);
    return window_Window(at, 1.0 / z_m, patch_Patch(-extent, extent), widest, level, first, (high >> vec2u(level)) - first + 1u, share);
}

fn window_square_at(window: window_Window, root: vec2u, code: u32, level: u32) -> window_Square {
    let texel = (root << vec2u(window.level)) + vec2u(bits_even_bits(code), bits_even_bits(code >> 1u));
    return window_Square(texel >> vec2u(level), level);
}

fn window_side_of(square: window_Square) -> f32 {
    return f32(1u << square.level);
}

struct window_Sides {
    low: vec2f,
    high: vec2f
}

fn window_sides_of(window: window_Window, square: window_Square) -> window_Sides {
    let low = vec2f(square.place << vec2u(square.level)) - window.at.center;
    return window_Sides(low, low + window_side_of(square));
}

struct window_Depths {
    least: f32,
    most: f32
}

fn window_depths_in(window: window_Window, square: window_Square) -> window_Depths {
    let ends = textureLoad(blocker_range_light_map_pyramid, square.place, square.level - 1u).xy;
    let ordered = select(-ends.yx, ends, map_light_view.depth_sign > 0.0);
    let g = (ordered - window.at.depth) * window.at.g_per_depth;
    let sides = window_sides_of(window, square);
    let is_beside = any(sides.low > g.y * max(window.open.high, vec2f())) || any(sides.high < g.y * min(window.open.low, vec2f()));
    let most = select(g.y, 0.0, g.y <= 0.0 || (is_beside && g.y < window.at.edge_g));
    let half = 0.5 * (window_side_of(square) - 1.0);
    let center = vec2f(square.place << vec2u(square.level)) + half;
    let plane = map_receiver_held(window.at, map_receiver_plane_depth_at(window.at, center) + half * dot(abs(window.at.slope), vec2f(1.0)));
    let is_in_front = ordered.x > plane && !map_receiver_faces_away(window.at);
    return window_Depths(select(0.0, max(g.x, 0.0), is_in_front), most);
}

fn window_texel_of(window: window_Window, place: vec2i, level: u32) -> vec2u {
    return min(vec2u(shown_texel_shown_texel(place, level, window.share)), vec2u(map_light_view.map_size) - 1u);
}

fn window_scale_of(g: f32) -> f32 {
    return select(0.0, 1.0 / max(g, 1e-20), g > 0.0);
}

fn window_scale_in(window: window_Window, square: window_Square, layer: u32) -> f32 {
    return window_scale_of(map_receiver_blocking_g_about(window.at, vec2f(window_texel_of(window, vec2i(square.place), square.level)), layer));
}

fn window_scale_beside(window: window_Window, square: window_Square, step: vec2i, layer: u32) -> f32 {
    let place = vec2i(square.place) + step;
    if !map_receiver_is_texel(vec2f(place) * window_side_of(square)) {
        return 0.0;
    }
    let texel = window_texel_of(window, place, square.level);
    return window_scale_of(map_receiver_blocking_g(window.at, vec2f(texel), map_receiver_stored_depth(texel, layer)));
}

fn window_joining_row(window: window_Window, square: window_Square, y: i32, layer: u32, g: f32, step: f32) -> vec3f {
    let scales = vec3f(window_scale_beside(window, square, vec2i(-1, y), layer), window_scale_beside(window, square, vec2i(0, y), layer), window_scale_beside(window, square, vec2i(1, y), layer));
    let steps = abs(1.0 / max(scales, vec3f(1e-30)) - g);
    return select(vec3f(), scales, (scales > vec3f()) & (steps <= vec3f(step)));
}

fn window_neighbours_of(window: window_Window, square: window_Square, scale: f32, layer: u32, slope: f32) -> patch_Neighbours {
    let g = 1.0 / scale;
    let step = surface_step_surface_step(window.inverse_z, window_side_of(square), g, slope);
    return patch_Neighbours(window_joining_row(window, square, -1, layer, g, step), window_joining_row(window, square, 0, layer, g, step).xz, window_joining_row(window, square, 1, layer, g, step));
}

fn window_beyond_edge(window: window_Window, square: window_Square, scale: f32, inside: patch_Patch) -> patch_Patch {
    var patch_ = inside;
    if scale * window.at.edge_g < 1.0 {
        let last = (vec2u(map_light_view.map_size) - 1u) >> vec2u(square.level);
        patch_.low = select(patch_.low, vec2f(-1e30), square.place == vec2u());
        patch_.high = select(patch_.high, vec2f(1e30), square.place == last);
    }
    return patch_;
}

fn window_own_patch(window: window_Window, square: window_Square, scale: f32) -> patch_Patch {
    let sides = window_sides_of(window, square);
    return window_beyond_edge(window, square, scale, patch_patch_of(sides.low, sides.high, scale));
}

fn window_widest_patch(window: window_Window, square: window_Square, scale: f32, slope: f32) -> patch_Patch {
    let sides = window_sides_of(window, square);
    let g = 1.0 / scale;
    let step = surface_step_surface_step(window.inverse_z, window_side_of(square), g, slope);
    let scales = vec3f(1.0 / (g + step), scale, 1.0 / max(g - step, 1e-20));
    return window_beyond_edge(window, square, scale, patch_widest_of(sides.low, sides.high, scales));
}

fn window_joined_patch(window: window_Window, square: window_Square, scale: f32, layer: u32, slope: f32) -> patch_Patch {
    let sides = window_sides_of(window, square);
    let around = window_neighbours_of(window, square, scale, layer, slope);
    return window_beyond_edge(window, square, scale, patch_joined(sides.low, sides.high, scale, around));
}

fn window_parts_side(window: window_Window, square: window_Square, depths: window_Depths) -> f32 {
    return clamp(window.widest * depths.most, 1.0, window_side_of(square));
}

fn window_inner_patch(window: window_Window, square: window_Square, depths: window_Depths, slope: f32) -> patch_Patch {
    let sides = window_sides_of(window, square);
    let step = surface_step_surface_step(window.inverse_z, window_parts_side(window, square, depths), depths.least, slope);
    let whole = patch_innermost_of(sides.low, sides.high, 1.0 / vec2f(depths.least, depths.most));
    let is_whole = depths.most - depths.least <= step;
    return patch_Patch(whole.low, select(whole.low, whole.high, is_whole));
}

fn window_outer_patch(window: window_Window, square: window_Square, depths: window_Depths, slope: f32) -> patch_Patch {
    let sides = window_sides_of(window, square);
    let step = surface_step_surface_step(window.inverse_z, window_parts_side(window, square, depths), depths.most, slope);
    let ends = 1.0 / vec2f(max(depths.least - step, 1e-20), depths.most + step);
    return window_beyond_edge(window, square, 1.0 / depths.most, patch_widest_of(sides.low, sides.high, ends.xyy));
}

fn window_near_open(window: window_Window, patch_: patch_Patch) -> patch_Patch {
    let margin = 0.01 * (window.open.high - window.open.low);
    return patch_Patch(max(patch_.low, window.open.low - margin), min(patch_.high, window.open.high + margin));
}
