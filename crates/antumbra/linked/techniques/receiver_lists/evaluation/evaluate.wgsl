// Linked from src/techniques/receiver_lists/evaluation/evaluate.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(1)
var<storage, read> list: array<u32>;

@group(1) @binding(8)
var<storage, read_write> work: array<atomic<u32>>;

var<workgroup> shared_group: u32;

var<workgroup> shared_progress: vec2u;

fn hand_on(group_index: u32, end: u32, is_single: bool, queue: u32) {
    let entry = work_progress_entry(bits_settings, group_index);
    atomicStore(&work[entry], end);
    atomicStore(&work[entry + 1u], select(0u, 1u, is_single));
    let place = atomicAdd(&work[queue], 1u);
    atomicStore(&work[work_queue_entry(bits_settings, queue, place)], group_index);
}

fn write_tinted(pixel: vec2u, pixel_index: u32, seen: f32) {
    let passed_before = open_bits_load_passed(pixel_index);
    let part = max(seen, 1e-20);
    let passed = passed_before * saturate(1.0 - open_points_stopped[0] / part) * saturate(1.0 - open_points_stopped[1] / part);
    open_bits_store_passed(pixel_index, passed);
    let lost = seen / bits_settings.total_weight * (passed_before - passed);
    inputs_write_visibility_rgb(pixel, max(inputs_read_visibility_rgb(pixel) - lost, vec3f(0.0)));
}

fn group_in_queue(lane: u32, place: u32, pass_number: u32) -> u32 {
    if pass_number == 0u {
        return place;
    }
    if lane == 0u {
        shared_group = atomicLoad(&work[work_queue_entry(bits_settings, pass_number & 1u, place)]);
    }
    return workgroupUniformLoad(&shared_group);
}

fn progress_of(lane: u32, group_index: u32) -> vec2u {
    if lane == 0u {
        let entry = work_progress_entry(bits_settings, group_index);
        shared_progress = vec2u(atomicLoad(&work[entry]), atomicLoad(&work[entry + 1u]));
    }
    return workgroupUniformLoad(&shared_progress);
}

@compute @workgroup_size(64)
fn evaluate(@builtin(workgroup_id) group_id: vec3u, @builtin(num_workgroups) group_counts: vec3u, @builtin(local_invocation_index) lane: u32) {
    let linear = group_id.y * group_counts.x + group_id.x;
    if linear >= walk_totals[settings_TOTAL_GROUPS] {
        return;
    }
    let pass_number = walk_totals[settings_TOTAL_PASS];
    let is_first_pass = pass_number == 0u;
    let group_index = group_in_queue(lane, linear, pass_number);
    let first_slot = group_GROUP * group_index;
    let listed = walk_totals[settings_TOTAL_LISTED];
    let is_live = first_slot + lane < listed;
    let pixel_index = list[min(first_slot + lane, listed - 1u)];
    let pixel = bits_pixel_of(pixel_index);
    let receiver = inputs_load_receiver(pixel);
    let sight = sight_shadow_segments_of(bits_settings, pixel, receiver);
    group_share_box_and_shaft(lane, receiver.pos_in_world);
    waiting_clear_waiting(lane);
    workgroupBarrier();
    let bits_at = bits_first_word_of(pixel_index);
    if is_first_pass && settings_is_on(bits_settings, settings_FIRST_TRIANGLES) {
        open_points_open_before_casters(receiver, sight_rays_of(sight, true));
    }
    else {
        for (var word = 0u; word < bits_settings.word_count; word++) {
            open_points_open[word] = open_bits_bits[bits_at + word];
        }
    }
    var progress = vec2u(0u);
    if !is_first_pass {
        progress = progress_of(lane, group_index);
    }
    let before = open_points_open[0];
    let was_single = progress.y == 1u;
    if was_single {
        open_points_open[0] = 1u;
    }
    let searches = is_first_pass && settings_is_on(bits_settings, settings_PENUMBRA_ONLY);
    let outcome = walk_walk_triangles(lane, is_live, sight, progress.x, was_single, searches);
    if outcome.is_single {
        let is_lit = open_points_open[0] != 0u;
        open_points_open[0] = before;
        for (var word = 0u; word < bits_settings.word_count; word++) {
            open_points_open[word] = select(0u, open_points_open[word], is_lit);
        }
    }
    if outcome.end != walk_ALL_DONE && lane == 0u {
        hand_on(group_index, outcome.end, outcome.is_single, 1u - (pass_number & 1u));
    }
    if counters_COUNTS {
        for (var k = 0u; k < work_COUNTERS; k++) {
            atomicAdd(&work[work_FIRST_COUNTER + k], counters_tests[k]);
        }
    }
    if !is_live {
        return;
    }
    if outcome.end != walk_ALL_DONE || settings_is_on(bits_settings, settings_KEEP_BITS) {
        for (var word = 0u; word < bits_settings.word_count; word++) {
            open_bits_bits[bits_at + word] = open_points_open[word];
        }
    }
    let seen = open_points_weight_of_open();
    if open_points_HAS_TINT {
        write_tinted(pixel, pixel_index, seen);
    }
    else if settings_is_on(bits_settings, settings_LAST_TRIANGLES) && outcome.end == walk_ALL_DONE {
        open_bits_write_open(pixel, pixel_index, seen);
    }
}

const caster_surface_COVERAGE_WHOLE: u32 = 0u;

const caster_surface_COVERAGE_ALPHA: u32 = 1u;

const caster_surface_COVERAGE_CUTOFF: u32 = 2u;

fn caster_surface_coverage_of(coverage: u32, cutoff: f32, alpha: f32) -> f32 {
    switch coverage {
        case caster_surface_COVERAGE_WHOLE {
            return 1.0;
        }
        case caster_surface_COVERAGE_ALPHA {
            return saturate(alpha);
        }
        case default {
            return select(0.0, 1.0, alpha >= cutoff);
        }
    }
}

fn caster_surface_stopped_light(coverage: u32, cutoff: f32, value: vec4f) -> vec3f {
    return caster_surface_coverage_of(coverage, cutoff, value.a) * (1.0 - saturate(value.rgb));
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

fn thresholds_hash_combine(seed: u32, value: u32) -> u32 {
    return seed ^ (value + (seed << 6u) + (seed >> 2u));
}

fn thresholds_hash(value: u32) -> u32 {
    var x = value;
    x ^= x >> 16u;
    x *= 2146121005u;
    x ^= x >> 15u;
    x *= 2221713035u;
    return x ^ (x >> 16u);
}

fn thresholds_hash_of_position(seed: u32, position: vec3f) -> u32 {
    let bits = bitcast<vec3u>(position);
    return thresholds_hash(thresholds_hash_combine(thresholds_hash(thresholds_hash_combine(thresholds_hash(thresholds_hash_combine(seed, bits.x)), bits.y)), bits.z));
}

fn thresholds_laine_karras_permutation(value: u32, seed: u32) -> u32 {
    var x = value + seed;
    x ^= x * 1817228412u;
    x ^= x * 3090095698u;
    x ^= x * 3350193720u;
    return x ^ (x * 2367878886u);
}

fn thresholds_stochastic_threshold(point: u32, seed: u32) -> f32 {
    let shuffled = reverseBits(thresholds_laine_karras_permutation(reverseBits(point), thresholds_hash(seed)));
    let scrambled = reverseBits(thresholds_laine_karras_permutation(shuffled, thresholds_hash(seed ^ 2654435769u)));
    return (f32(scrambled >> 8u) + 0.5) / 16777216.0;
}

const depth_error_ROUNDING = 4.76837158203125e-7;

fn depth_error_displacement_by_depth(clip_z_row: vec4f, clip_w_row: vec4f, pos_in_world: vec3f, along: vec3f) -> vec3f {
    let at = vec2f(dot(clip_z_row, vec4f(pos_in_world, 1.0)), dot(clip_w_row, vec4f(pos_in_world, 1.0)));
    let step = vec2f(dot(clip_z_row.xyz, along), dot(clip_w_row.xyz, along));
    let depth_per_step = (step.x * at.y - at.x * step.y) / (at.y * at.y);
    return along * (depth_error_ROUNDING / max(abs(depth_per_step), 1e-30));
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

fn inputs_load_mask(pixel: vec2u, layer: u32) -> f32 {
    return textureLoad(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer).x;
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

fn inputs_read_visibility_rgb(pixel: vec2u) -> vec3f {
    let first = inputs_load_mask(pixel, 0u);
    if inputs_receiver_view.mask_layers < 3u {
        return vec3f(first);
    }
    return vec3f(first, inputs_load_mask(pixel, 1u), inputs_load_mask(pixel, 2u));
}

fn inputs_are_points() -> bool {
    return inputs_receiver_view.are_points == 1u;
}

fn inputs_eye_distance_m(pos_in_world: vec3f) -> f32 {
    return select(distance(pos_in_world, inputs_receiver_view.eye_in_world), 0.0, inputs_are_points());
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

const inputs_OFFSET_SNAPS = 1.5;

fn inputs_camera_ray(pos_in_world: vec3f) -> vec3f {
    let is_parallel = all(inputs_receiver_view.clip_w_row.xyz == vec3f());
    return select(pos_in_world - inputs_receiver_view.eye_in_world, -inputs_receiver_view.world_from_view[2].xyz, is_parallel);
}

fn inputs_depth_error_m(pos_in_world: vec3f) -> vec3f {
    if inputs_are_points() {
        return vec3f();
    }
    return depth_error_displacement_by_depth(inputs_receiver_view.clip_z_row, inputs_receiver_view.clip_w_row, pos_in_world, inputs_camera_ray(pos_in_world));
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

const ray_offset_ROUNDING = 3.814697265625e-6;

fn ray_offset_ray_offset_from(pos_in_world: vec3f, snapped_texels: f32, matrix_rounding_m: f32) -> f32 {
    let rounding_m = ray_offset_ROUNDING * (length(pos_in_world) + inputs_eye_distance_m(pos_in_world));
    return rounding_m + inputs_OFFSET_SNAPS * inputs_snapped_m(snapped_texels, pos_in_world) + matrix_rounding_m;
}

struct block_shafts_LightFrame {
    origin: vec3f,
    right: vec3f,
    up: vec3f,
    ahead: vec3f,
    low: vec3f,
    high: vec3f,
    is_distant: bool,
    rounding_m: f32
}

struct block_shafts_BlockShaft {
    across: vec4f,
    upwards: vec4f
}

fn block_shafts_light_frame(light: light_LightSource, origin: vec3f, middle: vec3f, half_box: vec3f, is_turned: bool) -> block_shafts_LightFrame {
    var half_own = half_box;
    let turned = length(half_box.xy) + 2.0 * length(middle.xy);
    if is_turned {
        half_own = vec3f(vec2f(turned), half_box.z);
    }
    if light.kind == light_KIND_SPHERE {
        half_own = vec3f(turned);
    }
    var frame: block_shafts_LightFrame;
    frame.origin = origin;
    frame.is_distant = light.kind == light_KIND_SUN;
    if frame.is_distant {
        frame.right = light.right_in_world;
        frame.up = light.up_in_world;
        frame.ahead = -light.axis_in_world;
        frame.low = middle - half_own;
        frame.high = middle + half_own;
        frame.rounding_m = shaft_SHAFT_SLACK * dot(abs(origin), vec3f(1.0));
        return frame;
    }
    let to_middle = light.center_in_world - origin + middle.x * light.right_in_world + middle.y * light.up_in_world + middle.z * light.axis_in_world;
    frame.ahead = to_middle / max(length(to_middle), 1e-20);
    let side = light.right_in_world - dot(light.right_in_world, frame.ahead) * frame.ahead;
    let other_side = light.up_in_world - dot(light.up_in_world, frame.ahead) * frame.ahead;
    let is_seen = dot(side, side) > 0.01;
    let sideways = select(cross(other_side, frame.ahead), side, is_seen);
    frame.right = sideways / max(length(sideways), 1e-20);
    frame.up = cross(frame.ahead, frame.right);
    let center = vec3f(dot(to_middle, frame.right), dot(to_middle, frame.up), dot(to_middle, frame.ahead));
    var reach = half_own;
    if light.kind != light_KIND_SPHERE {
        reach = half_own.x * abs(block_shafts_in_frame(frame, light.right_in_world)) + half_own.y * abs(block_shafts_in_frame(frame, light.up_in_world)) + half_own.z * abs(block_shafts_in_frame(frame, light.axis_in_world));
    }
    frame.rounding_m = shaft_SHAFT_SLACK * (dot(abs(origin), vec3f(1.0)) + dot(abs(to_middle), vec3f(1.0)));
    frame.low = center - reach - frame.rounding_m;
    frame.high = center + reach + frame.rounding_m;
    return frame;
}

fn block_shafts_in_frame(frame: block_shafts_LightFrame, direction: vec3f) -> vec3f {
    return vec3f(dot(direction, frame.right), dot(direction, frame.up), dot(direction, frame.ahead));
}

fn block_shafts_holding_plane(frame: block_shafts_LightFrame, axis: u32, side: f32, low: vec3f, high: vec3f) -> vec2f {
    let receivers = max(side * low[axis], side * high[axis]);
    let light = max(side * frame.low[axis], side * frame.high[axis]);
    if frame.is_distant {
        let slope = light + shaft_SHAFT_SLACK * (1.0 + abs(light));
        return vec2f(slope, receivers - slope * select(low.z, high.z, slope < 0.0));
    }
    let ahead = 0.5 * (frame.low.z + frame.high.z - low.z - high.z);
    let slope = clamp((light - receivers) / max(ahead, 0.001 * (high.z - low.z) + 1e-20), -8.0, 8.0);
    return vec2f(slope, max(receivers - slope * select(low.z, high.z, slope < 0.0), light - slope * select(frame.low.z, frame.high.z, slope < 0.0)));
}

fn block_shafts_block_shaft(frame: block_shafts_LightFrame, low: vec3f, high: vec3f) -> block_shafts_BlockShaft {
    return block_shafts_BlockShaft(vec4f(block_shafts_holding_plane(frame, 0u, 1.0, low, high), block_shafts_holding_plane(frame, 0u, -1.0, low, high)), vec4f(block_shafts_holding_plane(frame, 1u, 1.0, low, high), block_shafts_holding_plane(frame, 1u, -1.0, low, high)));
}

fn block_shafts_is_beside(shaft: block_shafts_BlockShaft, across: vec3f, upwards: vec3f, ahead: vec3f, rounding_m: f32) -> bool {
    let room = rounding_m + shaft_SHAFT_SLACK * (abs(across) + abs(upwards) + abs(ahead));
    let room_across = (1.0 + max(abs(shaft.across.x), abs(shaft.across.z))) * room;
    let room_upwards = (1.0 + max(abs(shaft.upwards.x), abs(shaft.upwards.z))) * room;
    return all(across - shaft.across.x * ahead > shaft.across.y + room_across) || all(-across - shaft.across.z * ahead > shaft.across.w + room_across) || all(upwards - shaft.upwards.x * ahead > shaft.upwards.y + room_upwards) || all(-upwards - shaft.upwards.z * ahead > shaft.upwards.w + room_upwards);
}

override counters_COUNTS: bool = false;

var<private> counters_tests: array<u32, work_COUNTERS>;

fn counters_tally(what: u32, tests_here: u32) {
    if counters_COUNTS {
        counters_tests[what] += tests_here;
    }
}

const group_GROUP = 64u;

const group_BLOCK = 8u;

const group_BLOCKS = 8u;

var<workgroup> group_positions: array<vec4f, group_GROUP>;

var<workgroup> group_group_low: vec3f;

var<workgroup> group_group_high: vec3f;

var<workgroup> group_light_low: vec3f;

var<workgroup> group_light_high: vec3f;

var<workgroup> group_shared_frame: block_shafts_LightFrame;

var<workgroup> group_shaft: array<vec4f, shaft_SHAFT_PLANES>;

var<workgroup> group_block_low: array<vec3f, group_BLOCKS>;

var<workgroup> group_block_high: array<vec3f, group_BLOCKS>;

var<workgroup> group_block_across: array<vec4f, group_BLOCKS>;

var<workgroup> group_block_upwards: array<vec4f, group_BLOCKS>;

fn group_group_box() -> shaft_Box {
    return shaft_Box(group_group_low, group_group_high);
}

fn group_shared_light_box() -> shaft_Box {
    return shaft_Box(group_light_low, group_light_high);
}

fn group_light_box(group: shaft_Box, low: vec3f, high: vec3f) -> shaft_Box {
    if inputs_light_source.kind == light_KIND_SUN {
        let all = shaft_union_of(group, shaft_Box(bits_settings.casters_min, bits_settings.casters_max));
        let far = 1.01 * distance(all.low, all.high);
        return shaft_Box(group.low + far * low, group.high + far * high);
    }
    return shaft_Box(low, high);
}

fn group_shaft_meets_box(box: shaft_Box) -> bool {
    var is_outside = false;
    for (var i = 0u; i < shaft_SHAFT_PLANES; i += 3u) {
        is_outside |= shaft_box_is_outside(group_shaft[i], box);
        is_outside |= shaft_box_is_outside(group_shaft[i + 1u], box);
        is_outside |= shaft_box_is_outside(group_shaft[i + 2u], box);
    }
    return !is_outside;
}

fn group_shaft_meets_triangle(a: vec3f, b: vec3f, c: vec3f, flags: u32) -> bool {
    var is_outside = false;
    for (var i = 0u; i < shaft_SHAFT_PLANES; i += 3u) {
        is_outside |= shaft_triangle_is_outside(group_shaft[i], a, b, c);
        is_outside |= shaft_triangle_is_outside(group_shaft[i + 1u], a, b, c);
        is_outside |= shaft_triangle_is_outside(group_shaft[i + 2u], a, b, c);
    }
    if is_outside {
        return false;
    }
    if settings_is_on(bits_settings, settings_CUT_BY_PLANE) {
        let normal = cross(b - a, c - a);
        let side_of_group = shaft_side_of_box(normal, a, group_group_box());
        let side_of_light = shaft_side_of_box(normal, a, group_shared_light_box());
        if side_of_group != 0.0 && side_of_group == side_of_light {
            return false;
        }
        if (flags & settings_FLAG_CLOSED) != 0u && (side_of_group < 0.0 || side_of_light > 0.0) {
            return false;
        }
    }
    return true;
}

fn group_group_light_frame() -> block_shafts_LightFrame {
    return block_shafts_light_frame(inputs_light_source, group_positions[0].xyz, bits_light_words[0].xyz, bits_light_words[1].xyz, bits_settings.rotations > 0u);
}

fn group_share_block(block: u32) {
    let frame = group_shared_frame;
    var low = group_positions[group_BLOCK * block].xyz;
    var high = low;
    var low_in_frame = block_shafts_in_frame(frame, low - frame.origin);
    var high_in_frame = low_in_frame;
    for (var i = 0u; i < group_BLOCK; i++) {
        let receiver = group_positions[group_BLOCK * block + i];
        low = min(low, receiver.xyz - receiver.w);
        high = max(high, receiver.xyz + receiver.w);
        let along = block_shafts_in_frame(frame, receiver.xyz - frame.origin);
        let room = receiver.w + frame.rounding_m;
        low_in_frame = min(low_in_frame, along - room);
        high_in_frame = max(high_in_frame, along + room);
    }
    group_block_low[block] = low;
    group_block_high[block] = high;
    let shaft_of_block = block_shafts_block_shaft(frame, low_in_frame, high_in_frame);
    group_block_across[block] = shaft_of_block.across;
    group_block_upwards[block] = shaft_of_block.upwards;
}

fn group_share_box_and_shaft(lane: u32, x: vec3f) {
    group_positions[lane] = vec4f(x, ray_offset_ray_offset_m(bits_settings, x));
    workgroupBarrier();
    if lane == 0u {
        group_shared_frame = group_group_light_frame();
    }
    workgroupBarrier();
    if lane < group_BLOCKS {
        group_share_block(lane);
    }
    workgroupBarrier();
    if lane == 0u {
        var low = group_block_low[0];
        var high = group_block_high[0];
        for (var i = 1u; i < group_BLOCKS; i++) {
            low = min(low, group_block_low[i]);
            high = max(high, group_block_high[i]);
        }
        group_group_low = low;
        group_group_high = high;
        let light = group_light_box(group_group_box(), bits_settings.light_min, bits_settings.light_max);
        group_light_low = light.low;
        group_light_high = light.high;
    }
    workgroupBarrier();
    if lane < shaft_SHAFT_PLANES {
        group_shaft[lane] = shaft_shaft_plane(lane, group_group_box(), group_shared_light_box());
    }
}

override open_points_HAS_HOLES: bool = false;

override open_points_HAS_TINT: bool = false;

var<private> open_points_open: array<u32, bits_MAX_WORDS>;

var<private> open_points_stopped: array<vec3f, 2>;

fn open_points_apply(planes: triangle_test_Planes, word: u32, hidden_points: u32, flags: u32, source: u32, facing: u32) {
    var hidden = hidden_points & open_points_open[word];
    if hidden == 0u {
        return;
    }
    if open_points_HAS_TINT && (flags & settings_FLAG_TINTED) != 0u {
        open_points_stopped[facing] += bits_stopped_by(planes, word, hidden, source);
        return;
    }
    if open_points_HAS_HOLES && (flags & settings_FLAG_MASKED) != 0u {
        hidden = bits_solid_of(planes, word, hidden, source);
    }
    open_points_open[word] &= ~hidden;
}

fn open_points_any_open(word_count: u32) -> bool {
    var any = 0u;
    for (var word = 0u; word < word_count; word++) {
        any |= open_points_open[word];
    }
    return any != 0u;
}

fn open_points_open_before_casters(receiver: inputs_Receiver, rays: points_Rays) {
    let plane = points_plane_for(rays, receiver.normal_in_world);
    for (var word = 0u; word < bits_settings.word_count; word++) {
        open_points_open[word] = open_bits_in_front_of(plane, word);
    }
}

fn open_points_weight_of_open() -> f32 {
    var sum = 0.0;
    for (var word = 0u; word < bits_settings.word_count; word++) {
        sum += bits_weight_of(word, open_points_open[word]);
    }
    return sum;
}

@group(1) @binding(9)
var<storage, read> test_triangles_light_cells: array<vec4f>;

const test_triangles_MAX_ROWS = 4u;

override test_triangles_USES_TABLE: bool = false;

var<workgroup> test_triangles_open_count: atomic<u32>;

struct test_triangles_Grid {
    low: vec2f,
    cells_per_m: vec2f,
    across: u32,
    max_cells: u32,
    point_count: u32
}

fn test_triangles_grid_of_cells() -> test_triangles_Grid {
    return test_triangles_Grid(bits_light_words[0].xy - bits_light_words[1].xy, vec2f(bits_light_words[0].w, bits_light_words[1].w), bits_settings.cells_across, bits_settings.max_cells, bits_settings.point_count);
}

fn test_triangles_first_in_cell(grid: test_triangles_Grid, cell: u32) -> u32 {
    return u32(test_triangles_light_cells[grid.point_count + cell / 4u][cell & 3u]);
}

struct test_triangles_Cells {
    low: vec2u,
    high: vec2u
}

fn test_triangles_cells_of(grid: test_triangles_Grid, shadow: shadow_window_ShadowBox) -> test_triangles_Cells {
    let last = f32(grid.across) - 1.0;
    return test_triangles_Cells(vec2u(clamp((shadow.low - grid.low) * grid.cells_per_m, vec2f(0.0), vec2f(last))), vec2u(clamp((shadow.high - grid.low) * grid.cells_per_m, vec2f(0.0), vec2f(last))));
}

fn test_triangles_test_point(index: u32, planes: triangle_test_Planes, flags: u32, source: u32, facing: u32) {
    let point = test_triangles_light_cells[index];
    if triangle_test_is_hit(triangle_test_values_at(planes, point.xyz)) {
        let bit = u32(point.w);
        open_points_apply(planes, bit / 32u, 1u << (bit & 31u), flags, source, facing);
    }
}

fn test_triangles_test_few(index: u32, sight: sight_ShadowSegments, window: shadow_window_LightWindow, grid: test_triangles_Grid, middle: vec3f, half_box: vec3f) {
    let triangle = waiting_waiting_at(index, sight);
    let cells = test_triangles_cells_of(grid, shadow_window_shadow_box(window, sight.axis, triangle.x, triangle.a, triangle.b, triangle.c));
    let planes = waiting_planes_of_waiting(triangle, sight, middle, half_box);
    if planes.is_missed {
        return;
    }
    let source = waiting_waiting_source[index];
    let facing = waiting_facing_of(triangle, sight.x);
    for (var row = cells.low.y; row <= cells.high.y; row++) {
        let first = test_triangles_first_in_cell(grid, row * grid.across + cells.low.x);
        let end = min(test_triangles_first_in_cell(grid, row * grid.across + cells.high.x + 1u), grid.point_count);
        counters_tally(work_COUNT_POINTS, end - first);
        for (var i = first; i < end; i += 2u) {
            test_triangles_test_point(i, planes, triangle.flags, source, facing);
            test_triangles_test_point(min(i + 1u, end - 1u), planes, triangle.flags, source, facing);
        }
    }
}

fn test_triangles_test_many(index: u32, sight: sight_ShadowSegments, middle: vec3f, half_box: vec3f, axes: lookup_index_LookupAxes, is_single: bool) {
    let triangle = waiting_waiting_at(index, sight);
    let planes = waiting_planes_of_waiting(triangle, sight, middle, half_box);
    if planes.is_missed {
        return;
    }
    if is_single {
        if triangle_test_is_hit(triangle_test_values_at(planes, middle)) {
            open_points_open[0] = 0u;
        }
        return;
    }
    let source = waiting_waiting_source[index];
    let facing = waiting_facing_of(triangle, sight.x);
    if test_triangles_USES_TABLE {
        for (var block = 0u; 4u * block < bits_settings.word_count; block++) {
            let hidden = bits_hidden_by_table(axes, planes, block);
            for (var word = 4u * block; word < min(4u * block + 4u, bits_settings.word_count); word++) {
                open_points_apply(planes, word, hidden[word & 3u], triangle.flags, source, facing);
            }
        }
        return;
    }
    var partly = 0u;
    let word_count = bits_settings.word_count;
    for (var word = 0u; word < word_count; word++) {
        if open_points_open[word] == 0u {
            continue;
        }
        counters_tally(work_COUNT_WORDS, 1u);
        let box = bits_FIRST_BOX + 2u * word;
        let cover = triangle_test_box_cover(planes, bits_light_words[box].xyz, bits_light_words[box + 1u].xyz);
        if cover == 2u {
            open_points_apply(planes, word, 4294967295u, triangle.flags, source, facing);
        }
        partly |= select(0u, 1u << word, cover == 1u);
    }
    counters_tally(work_COUNT_POINTS, 32u * countOneBits(partly));
    for (; partly != 0u; partly &= partly - 1u) {
        let word = firstTrailingBit(partly);
        open_points_apply(planes, word, bits_hidden_exactly(planes, word), triangle.flags, source, facing);
    }
}

fn test_triangles_test_block(block: u32, sight: sight_ShadowSegments, is_single: bool) {
    let count = min(atomicLoad(&waiting_waiting_count), waiting_MAX_WAITING);
    let middle = bits_light_words[0].xyz;
    var half_box = bits_light_words[1].xyz;
    let axes = lookup_index_LookupAxes(middle, half_box);
    if is_single {
        half_box = vec3f();
    }
    let rays = sight_rays_of(sight, true);
    let window = shadow_window_light_window(rays, middle, half_box, length(sight_rays_of(sight, false).to_center - rays.to_center));
    let grid = test_triangles_grid_of_cells();
    let takes_few = !test_triangles_USES_TABLE && !open_points_HAS_TINT && !is_single;
    for (var first = 0u; first < count; first += 32u) {
        var few = 0u;
        var many = 0u;
        var candidates = atomicLoad(&waiting_block_waiting[waiting_WAITING_WORDS * block + first / 32u]);
        counters_tally(work_COUNT_PAIRS, countOneBits(candidates));
        for (; candidates != 0u; candidates &= candidates - 1u) {
            let k = firstTrailingBit(candidates);
            let triangle = waiting_waiting_at(first + k, sight);
            let shadow = shadow_window_shadow_box(window, sight.axis, triangle.x, triangle.a, triangle.b, triangle.c);
            let is_near = !shadow.is_beside && (!shadow.is_bounded || (all(shadow.low <= middle.xy + half_box.xy) && all(shadow.high >= middle.xy - half_box.xy)));
            let cells = test_triangles_cells_of(grid, shadow);
            let touched = cells.high - cells.low + 1u;
            let is_few = takes_few && shadow.is_bounded && touched.x * touched.y <= grid.max_cells && touched.y <= test_triangles_MAX_ROWS;
            few |= select(0u, 1u << k, is_near && is_few);
            many |= select(0u, 1u << k, is_near && !is_few);
        }
        counters_tally(work_COUNT_PAIRS_NEAR, countOneBits(few | many));
        if !test_triangles_USES_TABLE && !open_points_HAS_TINT {
            for (; few != 0u; few &= few - 1u) {
                test_triangles_test_few(first + firstTrailingBit(few), sight, window, grid, middle, half_box);
            }
        }
        for (; many != 0u; many &= many - 1u) {
            test_triangles_test_many(first + firstTrailingBit(many), sight, middle, half_box, axes, is_single);
        }
    }
}

fn test_triangles_turns_of(triangle_count: u32, is_single: bool) -> u32 {
    return 36u + 2u * bits_settings.word_count + triangle_count * select(bits_settings.iterations_per_triangle, 2u, is_single);
}

fn test_triangles_test_waiting_triangles(lane: u32, is_live: bool, sight: sight_ShadowSegments, is_single: bool) -> bool {
    let word_count = select(bits_settings.word_count, 1u, is_single);
    if lane == 0u {
        atomicStore(&test_triangles_open_count, 0u);
    }
    waiting_meet_blocks(lane);
    workgroupBarrier();
    if is_live && open_points_any_open(word_count) {
        test_triangles_test_block(lane / group_BLOCK, sight, is_single);
    }
    workgroupBarrier();
    waiting_clear_waiting(lane);
    if is_live && open_points_any_open(word_count) {
        atomicAdd(&test_triangles_open_count, 1u);
    }
    return workgroupUniformLoad(&test_triangles_open_count) == 0u;
}

const waiting_MAX_WAITING = 128u;

const waiting_WAITING_WORDS = 4u;

var<workgroup> waiting_waiting_count: atomic<u32>;

var<workgroup> waiting_waiting: array<vec4f, 3u * waiting_MAX_WAITING>;

var<workgroup> waiting_block_waiting: array<atomic<u32>, waiting_WAITING_WORDS * group_BLOCKS>;

var<workgroup> waiting_waiting_source: array<u32, waiting_MAX_WAITING>;

fn waiting_clear_waiting(lane: u32) {
    if lane < waiting_WAITING_WORDS * group_BLOCKS {
        atomicStore(&waiting_block_waiting[lane], 0u);
    }
    if lane == 0u {
        atomicStore(&waiting_waiting_count, 0u);
    }
}

fn waiting_add_waiting(a: vec4f, b: vec4f, c: vec3f, source: u32) {
    let slot = atomicAdd(&waiting_waiting_count, 1u);
    waiting_waiting[3u * slot] = a;
    waiting_waiting[3u * slot + 1u] = b;
    waiting_waiting[3u * slot + 2u] = vec4f(c, 0.0);
    waiting_waiting_source[slot] = source;
}

struct waiting_Waiting {
    a: vec3f,
    b: vec3f,
    c: vec3f,
    flags: u32,
    is_closed: bool,
    x: vec3f,
    depth_error_m: vec3f
}

fn waiting_waiting_at(index: u32, sight: sight_ShadowSegments) -> waiting_Waiting {
    let a = waiting_waiting[3u * index];
    let flags = u32(a.w);
    let is_closed = (flags & settings_FLAG_CLOSED) != 0u;
    let b = waiting_waiting[3u * index + 1u];
    return waiting_Waiting(a.xyz, b.xyz, waiting_waiting[3u * index + 2u].xyz, flags, is_closed, sight_origin_of(sight, is_closed), b.w * sight.depth_error_m);
}

fn waiting_planes_of_waiting(triangle: waiting_Waiting, sight: sight_ShadowSegments, middle: vec3f, half_box: vec3f) -> triangle_test_Planes {
    let rays = sight_rays_of(sight, triangle.is_closed);
    return triangle_test_planes_of(rays, triangle.x, triangle.a, triangle.b, triangle.c, triangle.is_closed, triangle.depth_error_m, middle, half_box);
}

fn waiting_facing_of(triangle: waiting_Waiting, x: vec3f) -> u32 {
    let normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
    return select(0u, 1u, dot(normal, triangle.a - x) > 0.0);
}

fn waiting_meet_blocks(lane: u32) {
    let frame = group_shared_frame;
    let count = min(atomicLoad(&waiting_waiting_count), waiting_MAX_WAITING);
    for (var slot = lane; slot < count; slot += group_GROUP) {
        let a = block_shafts_in_frame(frame, waiting_waiting[3u * slot].xyz - frame.origin);
        let b = block_shafts_in_frame(frame, waiting_waiting[3u * slot + 1u].xyz - frame.origin);
        let c = block_shafts_in_frame(frame, waiting_waiting[3u * slot + 2u].xyz - frame.origin);
        let across = vec3f(a.x, b.x, c.x);
        let upwards = vec3f(a.y, b.y, c.y);
        let ahead = vec3f(a.z, b.z, c.z);
        counters_tally(work_COUNT_TRIANGLES, 1u);
        for (var block = 0u; block < group_BLOCKS; block++) {
            let shaft_of_block = block_shafts_BlockShaft(group_block_across[block], group_block_upwards[block]);
            if !block_shafts_is_beside(shaft_of_block, across, upwards, ahead, frame.rounding_m) {
                atomicOr(&waiting_block_waiting[waiting_WAITING_WORDS * block + slot / 32u], 1u << (slot & 31u));
            }
        }
    }
}

@group(1) @binding(3)
var<storage, read> walk_boxes: array<vec4f>;

@group(1) @binding(6)
var<storage, read> walk_totals: array<u32>;

var<workgroup> walk_boxes_met: atomic<u32>;

fn walk_box_at(index: u32) -> shaft_Box {
    return shaft_Box(walk_boxes[2u * index].xyz, walk_boxes[2u * index + 1u].xyz);
}

fn walk_box_flags(index: u32) -> u32 {
    return u32(walk_boxes[2u * index].w);
}

struct walk_Walk {
    first_cluster: u32,
    next_super: u32,
    super_base: u32,
    supers: u32,
    cluster_base: u32,
    clusters: u32
}

fn walk_walk_from(first_cluster: u32, supers: u32) -> walk_Walk {
    let next_super = 32u * (first_cluster / 1024u);
    if supers == 1u && next_super == 0u {
        return walk_Walk(first_cluster, 32u, 0u, 1u, 0u, 0u);
    }
    return walk_Walk(first_cluster, next_super, 0u, 0u, 0u, 0u);
}

struct walk_Extent {
    triangles: u32,
    clusters: u32,
    supers: u32
}

fn walk_extent_of_walks() -> walk_Extent {
    let triangle_count = walk_totals[settings_TOTAL_TRIANGLES];
    let cluster_count = (triangle_count + 63u) / 64u;
    return walk_Extent(triangle_count, cluster_count, (cluster_count + 31u) / 32u);
}

const walk_ALL_DONE = 4294967295u;

fn walk_rest_of(at: walk_Walk, extent: walk_Extent) -> u32 {
    if at.clusters != 0u {
        return at.cluster_base + firstTrailingBit(at.clusters);
    }
    if at.supers != 0u {
        return 32u * (at.super_base + firstTrailingBit(at.supers));
    }
    return select(walk_ALL_DONE, 32u * at.next_super, at.next_super < extent.supers);
}

fn walk_enter_cluster(at: ptr<function, walk_Walk>, lane: u32, required: u32, triangle_count: u32) {
    let cluster = (*at).cluster_base + firstTrailingBit((*at).clusters);
    (*at).clusters &= (*at).clusters - 1u;
    let index = 64u * cluster + lane;
    if index >= triangle_count {
        return;
    }
    counters_tally(work_COUNT_TRIANGLES, 1u);
    let source = bits_settings.triangle_stride * index;
    let corner_a = bits_triangles[source];
    let corner_b = bits_triangles[source + 1u];
    let corner_c = bits_triangles[source + 2u].xyz;
    let flags = u32(corner_a.w);
    if (flags & required) == required && group_shaft_meets_triangle(corner_a.xyz, corner_b.xyz, corner_c, flags) {
        waiting_add_waiting(corner_a, corner_b, corner_c, source);
    }
}

fn walk_meet_boxes(at: ptr<function, walk_Walk>, lane: u32, required: u32, extent: walk_Extent) {
    let enters_super = (*at).supers != 0u;
    var box_index = bits_settings.super_first + (*at).next_super + lane;
    var is_box = lane < 32u && (*at).next_super + lane < extent.supers;
    if enters_super {
        (*at).cluster_base = 32u * ((*at).super_base + firstTrailingBit((*at).supers));
        (*at).supers &= (*at).supers - 1u;
        box_index = (*at).cluster_base + lane;
        is_box = lane < 32u && box_index < extent.clusters && box_index >= (*at).first_cluster;
    }
    if lane == 0u {
        atomicStore(&walk_boxes_met, 0u);
    }
    workgroupBarrier();
    if is_box && (walk_box_flags(box_index) & required) == required && group_shaft_meets_box(walk_box_at(box_index)) {
        atomicOr(&walk_boxes_met, 1u << lane);
    }
    counters_tally(work_COUNT_BOXES, select(0u, 1u, is_box));
    let met = workgroupUniformLoad(&walk_boxes_met);
    if enters_super {
        (*at).clusters = met;
    }
    else {
        (*at).super_base = (*at).next_super;
        (*at).supers = met;
        (*at).next_super += 32u;
    }
}

struct walk_Outcome {
    end: u32,
    is_single: bool
}

fn walk_walk_triangles(lane: u32, is_live: bool, sight: sight_ShadowSegments, first_cluster: u32, was_single: bool, searches: bool) -> walk_Outcome {
    let extent = walk_extent_of_walks();
    var at = walk_walk_from(first_cluster, extent.supers);
    var waits = 0u;
    var is_search = searches;
    var is_single = was_single;
    var turns = 10u * bits_settings.word_count + group_BLOCK + group_BLOCKS + 8u;
    for (var step = 0u; step < bits_settings.max_iterations; step++) {
        let required = select(0u, settings_FLAG_SILHOUETTE, is_search);
        var is_last = false;
        turns += 8u;
        if at.clusters != 0u {
            walk_enter_cluster(&at, lane, required, extent.triangles);
            if waits == 0u && at.clusters != 0u {
                walk_enter_cluster(&at, lane, required, extent.triangles);
            }
        }
        else if at.supers == 0u && at.next_super >= extent.supers {
            is_last = true;
        }
        else {
            walk_meet_boxes(&at, lane, required, extent);
        }
        waits = workgroupUniformLoad(&waiting_waiting_count);
        if is_search {
            let is_long = turns > bits_settings.max_iterations / 4u;
            if waits > 0u || is_last || is_long {
                is_single = waits == 0u && !is_long;
                if is_single {
                    open_points_open[0] = 1u;
                }
                is_search = false;
                at = walk_walk_from(0u, extent.supers);
                waits = 0u;
                if lane == 0u {
                    atomicStore(&waiting_waiting_count, 0u);
                }
                workgroupBarrier();
            }
            continue;
        }
        let is_over = turns > bits_settings.max_iterations;
        if waits > waiting_MAX_WAITING - group_GROUP || is_last || is_over {
            turns += test_triangles_turns_of(waits, is_single);
            let is_dark = test_triangles_test_waiting_triangles(lane, is_live, sight, is_single);
            waits = 0u;
            if is_last || (is_dark && settings_is_on(bits_settings, settings_STOP_WHEN_OCCLUDED)) {
                break;
            }
            if is_over {
                let rest = walk_rest_of(at, extent);
                if rest != walk_ALL_DONE {
                    return walk_Outcome(rest, is_single);
                }
            }
        }
    }
    return walk_Outcome(walk_ALL_DONE, is_single);
}

@group(1) @binding(0)
var<uniform> bits_settings: settings_SampleSettings;

@group(1) @binding(2)
var<storage, read> bits_triangles: array<vec4f>;

@group(1) @binding(4)
var<uniform> bits_light_words: array<vec4f, settings_LIGHT_WORDS_LENGTH>;

@group(1) @binding(7)
var bits_lookup: texture_3d<u32>;

struct bits_SampleSurface {
    factor: vec4f,
    cutoff: f32,
    coverage: u32,
    padding_0: u32,
    padding_1: u32
}

@group(2) @binding(0)
var<uniform> bits_surface: bits_SampleSurface;

@group(2) @binding(1)
var bits_surface_texture: texture_2d<f32>;

@group(2) @binding(2)
var bits_surface_sampler: sampler;

const bits_MAX_WORDS = 32u;

const bits_FIRST_BOX = 2u;

override bits_IS_FLAT: bool = false;

fn bits_pixel_of(pixel_index: u32) -> vec2u {
    return vec2u(pixel_index % inputs_receiver_view.size_px.x, pixel_index / inputs_receiver_view.size_px.x);
}

fn bits_first_word_of(pixel_index: u32) -> u32 {
    return pixel_index * bits_settings.pixel_words + bits_settings.first_word;
}

fn bits_point_at(index: u32) -> vec3f {
    let at = settings_FIRST_POINT + 4u * (index / 4u);
    return vec3f(bits_light_words[at][index & 3u], bits_light_words[at + 1u][index & 3u], bits_light_words[at + 2u][index & 3u]);
}

fn bits_at_four(plane: vec4f, at: u32) -> vec4f {
    let across = plane.x + plane.y * bits_light_words[at] + plane.z * bits_light_words[at + 1u];
    if bits_IS_FLAT {
        return across;
    }
    return across + plane.w * bits_light_words[at + 2u];
}

fn bits_bits_of_four(is_set: vec4<bool>) -> u32 {
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), is_set);
    return bits.x | bits.y | bits.z | bits.w;
}

fn bits_at_one(plane: vec4f, point: vec3f) -> f32 {
    if bits_IS_FLAT {
        return plane.x + plane.y * point.x + plane.z * point.y;
    }
    return points_at_point(plane, point);
}

fn bits_is_hidden(planes: triangle_test_Planes, point: vec3f) -> bool {
    return triangle_test_is_hit(vec4f(bits_at_one(planes.edge_a, point), bits_at_one(planes.edge_b, point), bits_at_one(planes.edge_c, point), bits_at_one(planes.support, point)));
}

fn bits_hidden_of_four(planes: triangle_test_Planes, at: u32) -> u32 {
    let x = bits_light_words[at];
    let y = bits_light_words[at + 1u];
    let z = bits_light_words[at + 2u];
    return select(0u, 1u, bits_is_hidden(planes, vec3f(x.x, y.x, z.x))) | select(0u, 2u, bits_is_hidden(planes, vec3f(x.y, y.y, z.y))) | select(0u, 4u, bits_is_hidden(planes, vec3f(x.z, y.z, z.z))) | select(0u, 8u, bits_is_hidden(planes, vec3f(x.w, y.w, z.w)));
}

fn bits_hidden_exactly(planes: triangle_test_Planes, word: u32) -> u32 {
    let at = settings_FIRST_POINT + 32u * word;
    return bits_hidden_of_four(planes, at) | (bits_hidden_of_four(planes, at + 4u) << 4u) | (bits_hidden_of_four(planes, at + 8u) << 8u) | (bits_hidden_of_four(planes, at + 12u) << 12u) | (bits_hidden_of_four(planes, at + 16u) << 16u) | (bits_hidden_of_four(planes, at + 20u) << 20u) | (bits_hidden_of_four(planes, at + 24u) << 24u) | (bits_hidden_of_four(planes, at + 28u) << 28u);
}

fn bits_hidden_by_table(axes: lookup_index_LookupAxes, planes: triangle_test_Planes, block: u32) -> vec4u {
    let layer = vec3u(0u, 0u, block * bits_settings.lookup_size);
    return textureLoad(bits_lookup, lookup_index_lookup_texel(axes, bits_settings.lookup_size, planes.edge_a) + layer, 0) & textureLoad(bits_lookup, lookup_index_lookup_texel(axes, bits_settings.lookup_size, planes.edge_b) + layer, 0) & textureLoad(bits_lookup, lookup_index_lookup_texel(axes, bits_settings.lookup_size, planes.edge_c) + layer, 0) & textureLoad(bits_lookup, lookup_index_lookup_texel(axes, bits_settings.lookup_size, -planes.support) + layer, 0);
}

fn bits_surface_from(values: vec3f, source: u32) -> vec4f {
    let weights = values / max(values.x + values.y + values.z, 1e-37);
    let uv_ab = bits_triangles[source + 3u];
    let uv_c = bits_triangles[source + 4u].xy;
    let uv = weights.x * uv_ab.xy + weights.y * uv_ab.zw + weights.z * uv_c;
    return bits_surface.factor * textureSampleLevel(bits_surface_texture, bits_surface_sampler, uv, 0.0);
}

fn bits_surface_at(planes: triangle_test_Planes, point: vec3f, source: u32) -> vec4f {
    return bits_surface_from(triangle_test_values_at(planes, point).xyz, source);
}

fn bits_stopped_white(value: vec4f) -> f32 {
    return caster_surface_stopped_light(bits_surface.coverage, bits_surface.cutoff, value).x;
}

fn bits_seed_of(source: u32) -> u32 {
    var seed = inputs_receiver_view.noise_frame;
    for (var corner = 0u; corner < 3u; corner++) {
        seed = thresholds_hash_of_position(seed, bits_triangles[source + corner].xyz);
    }
    return seed;
}

fn bits_solid_of(planes: triangle_test_Planes, word: u32, hidden: u32, source: u32) -> u32 {
    let is_masked = bits_surface.coverage == caster_surface_COVERAGE_CUTOFF;
    var seed = 0u;
    if !is_masked {
        seed = bits_seed_of(source);
    }
    var left = hidden;
    var solid = 0u;
    while (left != 0u) {
        let k = firstTrailingBit(left);
        left &= left - 1u;
        let point = 32u * word + k;
        let stopped = bits_stopped_white(bits_surface_at(planes, bits_point_at(point), source));
        var least = 0.5;
        if !is_masked {
            least = thresholds_stochastic_threshold(point, seed);
        }
        solid |= select(0u, 1u << k, stopped >= least);
    }
    return solid;
}

fn bits_weight_of(word: u32, points: u32) -> f32 {
    if bits_settings.is_weighted == 0u {
        return f32(countOneBits(points));
    }
    let at = settings_FIRST_POINT + 32u * word + 3u;
    return bits_weight_of_four(at, points) + bits_weight_of_four(at + 4u, points >> 4u) + bits_weight_of_four(at + 8u, points >> 8u) + bits_weight_of_four(at + 12u, points >> 12u) + bits_weight_of_four(at + 16u, points >> 16u) + bits_weight_of_four(at + 20u, points >> 20u) + bits_weight_of_four(at + 24u, points >> 24u) + bits_weight_of_four(at + 28u, points >> 28u);
}

fn bits_weight_of_four(at: u32, points: u32) -> f32 {
    let is_in = (vec4u(points) & vec4u(1u, 2u, 4u, 8u)) != vec4u(0u);
    return dot(bits_light_words[at], select(vec4f(0.0), vec4f(1.0), is_in));
}

fn bits_stopped_by(planes: triangle_test_Planes, word: u32, hidden: u32, source: u32) -> vec3f {
    var stopped_here = vec3f();
    for (var four = 0u; four < 8u; four++) {
        let points = hidden & (15u << (4u * four));
        if points == 0u {
            continue;
        }
        let value = bits_surface_at(planes, bits_point_at(32u * word + firstTrailingBit(points)), source);
        stopped_here += bits_weight_of(word, points) * caster_surface_stopped_light(bits_surface.coverage, bits_surface.cutoff, value);
    }
    return stopped_here;
}

fn bits_in_front_of_four(plane: vec4f, at: u32) -> u32 {
    return bits_bits_of_four(bits_at_four(plane, at) > vec4f(0.0));
}

struct lookup_index_LookupAxes {
    middle: vec3f,
    half_box: vec3f
}

const lookup_index_TAU = 6.283185307179586;

const lookup_index_MAX_DISTANCE_FLAT = 1.4142135623730951;

const lookup_index_MAX_DISTANCE = 1.7320508075688772;

fn lookup_index_lookup_texel(axes: lookup_index_LookupAxes, size: u32, plane: vec4f) -> vec3u {
    let n = f32(size);
    let scaled = axes.half_box * plane.yzw;
    let length_scaled = max(length(scaled), 1e-30);
    let normal = scaled / length_scaled;
    let distance = -(plane.x + dot(plane.yzw, axes.middle)) / length_scaled;
    let azimuth = fract(atan2(normal.y, normal.x) / lookup_index_TAU + 1.0);
    if axes.half_box.z == 0.0 {
        let angles = size * size / 4u;
        let angle = min(u32(azimuth * f32(angles)), angles - 1u);
        let part = clamp(0.5 * (distance / lookup_index_MAX_DISTANCE_FLAT + 1.0), 0.0, 1.0);
        let index = angle + angles * min(u32(part * 4.0 * n), 4u * size - 1u);
        return vec3u(index % size, (index / size) % size, index / (size * size));
    }
    let polar = acos(clamp(normal.z, -1.0, 1.0)) / (0.5 * lookup_index_TAU);
    let part = clamp(0.5 * (distance / lookup_index_MAX_DISTANCE + 1.0), 0.0, 1.0);
    return min(vec3u(vec3f(azimuth, polar, part) * n), vec3u(size - 1u));
}

@group(1) @binding(5)
var<storage, read_write> open_bits_bits: array<u32>;

fn open_bits_in_front_of(plane: vec4f, word: u32) -> u32 {
    var in_front = 0u;
    for (var four = 0u; four < 8u; four++) {
        in_front |= bits_in_front_of_four(plane, settings_FIRST_POINT + 32u * word + 4u * four) << (4u * four);
    }
    let count = min(32u, bits_settings.point_count - 32u * word);
    return in_front & (4294967295u >> (32u - count));
}

fn open_bits_load_passed(pixel_index: u32) -> vec3f {
    let at = bits_settings.first_passed + 3u * pixel_index;
    return vec3f(bitcast<f32>(open_bits_bits[at]), bitcast<f32>(open_bits_bits[at + 1u]), bitcast<f32>(open_bits_bits[at + 2u]));
}

fn open_bits_store_passed(pixel_index: u32, passed: vec3f) {
    let at = bits_settings.first_passed + 3u * pixel_index;
    open_bits_bits[at] = bitcast<u32>(passed.x);
    open_bits_bits[at + 1u] = bitcast<u32>(passed.y);
    open_bits_bits[at + 2u] = bitcast<u32>(passed.z);
}

fn open_bits_write_open(pixel: vec2u, pixel_index: u32, seen: f32) {
    if bits_settings.first_passed > 0u {
        open_bits_store_passed(pixel_index, vec3f(1.0));
    }
    let visibility = seen / bits_settings.total_weight;
    if settings_is_on(bits_settings, settings_FIRST_POINTS) {
        inputs_write_visibility(pixel, min(visibility, 1.0));
    }
    else {
        inputs_write_visibility_rgb(pixel, min(inputs_read_visibility_rgb(pixel) + visibility, vec3f(1.0)));
    }
}

const points_END_MARGIN = 9.5367431640625e-7;

struct points_Rays {
    to_center: vec3f,
    right: vec3f,
    up: vec3f,
    axis: vec3f,
    inverse_end: f32
}

fn points_turned(settings: settings_SampleSettings, noise: f32, right: vec3f, up: vec3f) -> mat2x3f {
    var part = noise;
    if settings.rotations > 1u {
        part = floor(noise * f32(settings.rotations)) / f32(settings.rotations);
    }
    let angle = 2.0 * light_PI * part;
    return mat2x3f(cos(angle) * right + sin(angle) * up, cos(angle) * up - sin(angle) * right);
}

fn points_to_center_from(light: light_LightSource, axis: vec3f, origin: vec3f) -> vec3f {
    return select(light.center_in_world - origin, -axis, light.kind == light_KIND_SUN);
}

fn points_inverse_end_of(light: light_LightSource) -> f32 {
    return select(1.0 + points_END_MARGIN, 0.0, light.kind == light_KIND_SUN);
}

fn points_rays_from(settings: settings_SampleSettings, light: light_LightSource, origin: vec3f, position: vec3f, noise: f32) -> points_Rays {
    var rays = points_Rays(points_to_center_from(light, light.axis_in_world, origin), light.right_in_world, light.up_in_world, light.axis_in_world, points_inverse_end_of(light));
    if light.kind == light_KIND_SPHERE {
        let towards = normalize(light.center_in_world - position);
        let across = cross(light.up_in_world, towards);
        let across_length = length(across);
        rays.right = select(light.right_in_world, across / max(across_length, 1e-20), across_length > 1e-6);
        rays.up = cross(towards, rays.right);
        rays.axis = -towards;
    }
    if settings.rotations > 0u {
        let frame = points_turned(settings, fract(noise + settings.turn), rays.right, rays.up);
        rays.right = frame[0];
        rays.up = frame[1];
    }
    return rays;
}

fn points_plane_for(rays: points_Rays, normal: vec3f) -> vec4f {
    return vec4f(dot(normal, rays.to_center), dot(normal, rays.right), dot(normal, rays.up), dot(normal, rays.axis));
}

fn points_at_point(plane: vec4f, point: vec3f) -> f32 {
    return plane.x + plane.y * point.x + plane.z * point.y + plane.w * point.z;
}

fn points_reach_over(plane: vec4f, half_box: vec3f) -> f32 {
    return abs(plane.y) * half_box.x + abs(plane.z) * half_box.y + abs(plane.w) * half_box.z;
}

@group(1) @binding(14)
var<uniform> ray_offset_snapped_texels: f32;

fn ray_offset_ray_offset_m(settings: settings_SampleSettings, pos_in_world: vec3f) -> f32 {
    return settings.ray_offset_scale * ray_offset_ray_offset_from(pos_in_world, ray_offset_snapped_texels, settings.matrix_rounding_m);
}

struct shadow_window_LightWindow {
    right: vec3f,
    up: vec3f,
    side: f32,
    to_light: vec3f,
    half_depth: f32,
    tangent_low: vec2f,
    tangent_high: vec2f,
    slack: f32,
    has_cone: bool,
    is_before: bool
}

struct shadow_window_ShadowBox {
    low: vec2f,
    high: vec2f,
    is_bounded: bool,
    is_beside: bool
}

const shadow_window_MAX_TANGENT = 4.0;

const shadow_window_WINDOW_SLACK = 3.0517578125e-5;

const shadow_window_CONE_SLACK = 9.5367431640625e-7;

fn shadow_window_light_window(rays: points_Rays, middle: vec3f, half_box: vec3f, ray_offset: f32) -> shadow_window_LightWindow {
    var window: shadow_window_LightWindow;
    window.right = rays.right;
    window.up = rays.up;
    let along = dot(rays.to_center, rays.axis) + middle.z;
    window.side = select(-1.0, 1.0, along >= 0.0);
    window.to_light = vec3f(dot(rays.to_center, rays.right), dot(rays.to_center, rays.up), abs(along));
    window.half_depth = half_box.z;
    let depth = window.to_light.z;
    let reach = abs(window.to_light.xy + middle.xy) + half_box.xy;
    let tangent = (reach.x + reach.y) / max(depth, 1e-30);
    window.slack = (shadow_window_WINDOW_SLACK * depth + ray_offset) * (1.0 + tangent) * (1.0 + tangent);
    window.has_cone = depth > 1.01 * half_box.z + 2.0 * ray_offset;
    window.is_before = window.has_cone && tangent < shadow_window_MAX_TANGENT;
    let low = window.to_light.xy + middle.xy - half_box.xy - window.slack;
    let high = window.to_light.xy + middle.xy + half_box.xy + window.slack;
    let nearest = 1.0 / (depth - half_box.z - ray_offset);
    let farthest = 1.0 / (depth + half_box.z + ray_offset);
    window.tangent_low = low * select(vec2f(farthest), vec2f(nearest), low < vec2f(0.0));
    window.tangent_high = high * select(vec2f(farthest), vec2f(nearest), high > vec2f(0.0));
    return window;
}

fn shadow_window_shadow_box(window: shadow_window_LightWindow, axis: vec3f, x: vec3f, corner_a: vec3f, corner_b: vec3f, corner_c: vec3f) -> shadow_window_ShadowBox {
    let a = corner_a - x;
    let b = corner_b - x;
    let c = corner_c - x;
    let across = vec3f(dot(a, window.right), dot(b, window.right), dot(c, window.right));
    let upwards = vec3f(dot(a, window.up), dot(b, window.up), dot(c, window.up));
    let ahead = window.side * vec3f(dot(a, axis), dot(b, axis), dot(c, axis));
    let room = shadow_window_CONE_SLACK * (abs(across) + abs(upwards) + abs(ahead));
    let is_beside = window.has_cone && (all(across > window.tangent_high.x * ahead + room) || all(across < window.tangent_low.x * ahead - room) || all(upwards > window.tangent_high.y * ahead + room) || all(upwards < window.tangent_low.y * ahead - room) || all(ahead < -room));
    let is_bounded = window.is_before && all(abs(across) + abs(upwards) < shadow_window_MAX_TANGENT * ahead);
    let tangent_across = across / ahead;
    let tangent_up = upwards / ahead;
    let low_across = tangent_across * window.to_light.z - abs(tangent_across) * window.half_depth;
    let high_across = tangent_across * window.to_light.z + abs(tangent_across) * window.half_depth;
    let low_up = tangent_up * window.to_light.z - abs(tangent_up) * window.half_depth;
    let high_up = tangent_up * window.to_light.z + abs(tangent_up) * window.half_depth;
    let low = vec2f(min(min(low_across.x, low_across.y), low_across.z), min(min(low_up.x, low_up.y), low_up.z));
    let high = vec2f(max(max(high_across.x, high_across.y), high_across.z), max(max(high_up.x, high_up.y), high_up.z));
    return shadow_window_ShadowBox(low - window.to_light.xy - window.slack, high - window.to_light.xy + window.slack, is_bounded, is_beside);
}

struct sight_ShadowSegments {
    right: vec3f,
    up: vec3f,
    axis: vec3f,
    x: vec3f,
    x_open: vec3f,
    depth_error_m: vec3f
}

fn sight_shadow_segments_from(settings: settings_SampleSettings, pixel: vec2u, x: vec3f, x_open: vec3f) -> sight_ShadowSegments {
    let rays = points_rays_from(settings, inputs_light_source, x, x, noise_noise_of_pixel(pixel));
    return sight_ShadowSegments(rays.right, rays.up, rays.axis, x, x_open, inputs_depth_error_m(x));
}

fn sight_shadow_segments_of(settings: settings_SampleSettings, pixel: vec2u, receiver: inputs_Receiver) -> sight_ShadowSegments {
    let x = receiver.pos_in_world;
    return sight_shadow_segments_from(settings, pixel, x, x + ray_offset_ray_offset_m(settings, x) * receiver.normal_in_world);
}

fn sight_origin_of(sight: sight_ShadowSegments, is_closed: bool) -> vec3f {
    return select(sight.x_open, sight.x, is_closed);
}

fn sight_rays_of(sight: sight_ShadowSegments, is_closed: bool) -> points_Rays {
    let to_center = points_to_center_from(inputs_light_source, sight.axis, sight_origin_of(sight, is_closed));
    return points_Rays(to_center, sight.right, sight.up, sight.axis, points_inverse_end_of(inputs_light_source));
}

const triangle_test_PLANE_SLACK = 9.5367431640625e-7;

struct triangle_test_Planes {
    edge_a: vec4f,
    edge_b: vec4f,
    edge_c: vec4f,
    support: vec4f,
    slack: vec4f,
    is_missed: bool
}

fn triangle_test_slack_of(plane: vec4f, largest: vec3f) -> f32 {
    return triangle_test_PLANE_SLACK * (abs(plane.x) + dot(abs(plane.yzw), largest));
}

fn triangle_test_planes_of(rays: points_Rays, x: vec3f, corner_a: vec3f, corner_b: vec3f, corner_c: vec3f, is_closed: bool, depth_error_m: vec3f, middle: vec3f, half_box: vec3f) -> triangle_test_Planes {
    var planes: triangle_test_Planes;
    planes.is_missed = true;
    let a = corner_a - x;
    let b = corner_b - x;
    let c = corner_c - x;
    let n = cross(corner_b - corner_a, corner_c - corner_a);
    let height = dot(a, n);
    let away = dot(depth_error_m, n);
    let side = sign(select(height, away, abs(height) <= abs(away)));
    if side == 0.0 || (is_closed && height > 0.0) {
        return planes;
    }
    let largest = abs(middle) + half_box;
    let through = points_plane_for(rays, side * n);
    planes.support = vec4f(abs(height) * rays.inverse_end - through.x, -through.yzw);
    planes.slack.w = triangle_test_slack_of(planes.support, largest) + triangle_test_PLANE_SLACK * abs(height);
    if points_at_point(planes.support, middle) - points_reach_over(planes.support, half_box) > planes.slack.w {
        return planes;
    }
    planes.edge_a = points_plane_for(rays, side * cross(corner_b - corner_c, b + c));
    planes.slack.x = triangle_test_slack_of(planes.edge_a, largest);
    if points_at_point(planes.edge_a, middle) + points_reach_over(planes.edge_a, half_box) < -planes.slack.x {
        return planes;
    }
    planes.edge_b = points_plane_for(rays, side * cross(corner_c - corner_a, c + a));
    planes.slack.y = triangle_test_slack_of(planes.edge_b, largest);
    if points_at_point(planes.edge_b, middle) + points_reach_over(planes.edge_b, half_box) < -planes.slack.y {
        return planes;
    }
    planes.edge_c = points_plane_for(rays, side * cross(corner_a - corner_b, a + b));
    planes.slack.z = triangle_test_slack_of(planes.edge_c, largest);
    planes.is_missed = points_at_point(planes.edge_c, middle) + points_reach_over(planes.edge_c, half_box) < -planes.slack.z;
    return planes;
}

fn triangle_test_values_at(planes: triangle_test_Planes, point: vec3f) -> vec4f {
    return vec4f(points_at_point(planes.edge_a, point), points_at_point(planes.edge_b, point), points_at_point(planes.edge_c, point), points_at_point(planes.support, point));
}

fn triangle_test_is_hit(values: vec4f) -> bool {
    return min(min(values.x, values.y), values.z) >= 0.0 && values.w < 0.0;
}

fn triangle_test_box_cover(planes: triangle_test_Planes, middle: vec3f, half_box: vec3f) -> u32 {
    let at_middle = triangle_test_values_at(planes, middle);
    let reach = vec4f(points_reach_over(planes.edge_a, half_box), points_reach_over(planes.edge_b, half_box), points_reach_over(planes.edge_c, half_box), points_reach_over(planes.support, half_box));
    let inside = at_middle * vec4f(1.0, 1.0, 1.0, -1.0);
    let most = inside + reach + planes.slack;
    let least = inside - reach - planes.slack;
    if min(min(most.x, most.y), min(most.z, most.w)) < 0.0 {
        return 0u;
    }
    return select(1u, 2u, min(min(least.x, least.y), min(least.z, least.w)) > 0.0);
}

struct settings_SampleSettings {
    light_min: vec3f,
    point_count: u32,
    light_max: vec3f,
    word_count: u32,
    casters_min: vec3f,
    list_bits: u32,
    casters_max: vec3f,
    projection: u32,
    total_weight: f32,
    switches: u32,
    cell_count: u32,
    list_count: u32,
    super_first: u32,
    is_weighted: u32,
    triangle_stride: u32,
    lookup_size: u32,
    first_word: u32,
    pixel_words: u32,
    rotations: u32,
    turn: f32,
    ray_offset_scale: f32,
    max_groups: u32,
    cells_across: u32,
    max_cells: u32,
    iterations_per_triangle: u32,
    max_iterations: u32,
    first_passed: u32,
    window_count: u32,
    window: u32,
    window_side: u32,
    receivers_per_instance: u32,
    subset: u32,
    window_right: vec3f,
    region_corners: u32,
    window_up: vec3f,
    matrix_rounding_m: f32,
    window_axis: vec3f,
    padding_1: u32,
    window_light_min: vec3f,
    padding_2: u32,
    window_light_max: vec3f,
    padding_3: u32,
    clip_z_row: vec4f,
    clip_w_row: vec4f
}

const settings_FIRST_POINT = 66u;

const settings_LIGHT_WORDS_LENGTH = 1090u;

const settings_STOP_WHEN_OCCLUDED = 1u;

const settings_PENUMBRA_ONLY = 2u;

const settings_CUT_BY_PLANE = 4u;

const settings_KEEP_BITS = 16u;

const settings_FIRST_TRIANGLES = 32u;

const settings_LAST_TRIANGLES = 64u;

const settings_FIRST_POINTS = 128u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_TOTAL_LISTED = 0u;

const settings_TOTAL_TRIANGLES = 1u;

const settings_TOTAL_GROUPS = 2u;

const settings_TOTAL_PASS = 3u;

const settings_FLAG_CLOSED = 1u;

const settings_FLAG_SILHOUETTE = 2u;

const settings_FLAG_MASKED = 4u;

const settings_FLAG_TINTED = 8u;

const shaft_SHAFT_PLANES = 18u;

const shaft_SHAFT_SLACK = 2e-6;

struct shaft_Box {
    low: vec3f,
    high: vec3f
}

fn shaft_union_of(a: shaft_Box, b: shaft_Box) -> shaft_Box {
    return shaft_Box(min(a.low, b.low), max(a.high, b.high));
}

fn shaft_shaft_plane(index: u32, a: shaft_Box, b: shaft_Box) -> vec4f {
    var normal = vec3f();
    if index < 6u {
        normal[index / 2u] = select(-1.0, 1.0, (index & 1u) == 1u);
    }
    else {
        let pair = (index - 6u) / 4u;
        let first = select(0u, 1u, pair == 2u);
        let second = select(2u, 1u, pair == 0u);
        let sign_first = select(-1.0, 1.0, (index & 1u) == 1u);
        let sign_second = select(-1.0, 1.0, (index & 2u) == 2u);
        let step_first = select(b.low[first] - a.low[first], b.high[first] - a.high[first], sign_first > 0.0);
        let step_second = select(b.low[second] - a.low[second], b.high[second] - a.high[second], sign_second > 0.0);
        normal[first] = sign_first * abs(step_second);
        normal[second] = sign_second * abs(step_first);
    }
    let corner_a = select(a.low, a.high, normal > vec3f(0.0));
    let corner_b = select(b.low, b.high, normal > vec3f(0.0));
    let terms = dot(abs(normal), max(abs(corner_a), abs(corner_b)));
    return vec4f(normal, max(dot(normal, corner_a), dot(normal, corner_b)) + shaft_SHAFT_SLACK * terms);
}

fn shaft_box_is_outside(plane: vec4f, box: shaft_Box) -> bool {
    let nearest = select(box.high, box.low, plane.xyz > vec3f(0.0));
    return dot(plane.xyz, nearest) > plane.w;
}

fn shaft_triangle_is_outside(plane: vec4f, a: vec3f, b: vec3f, c: vec3f) -> bool {
    return min(min(dot(plane.xyz, a), dot(plane.xyz, b)), dot(plane.xyz, c)) > plane.w;
}

fn shaft_side_of_box(normal: vec3f, a: vec3f, box: shaft_Box) -> f32 {
    let middle = 0.5 * (box.low + box.high) - a;
    let distance = dot(normal, middle);
    let terms = dot(abs(normal), abs(middle));
    let reach = dot(abs(normal), 0.5 * (box.high - box.low)) + shaft_SHAFT_SLACK * terms;
    return select(0.0, sign(distance), abs(distance) > reach);
}

const work_FIRST_COUNTER = 2u;

const work_COUNTERS = 6u;

const work_FIRST_GROUP = 8u;

const work_COUNT_BOXES = 0u;

const work_COUNT_TRIANGLES = 1u;

const work_COUNT_PAIRS = 2u;

const work_COUNT_PAIRS_NEAR = 3u;

const work_COUNT_WORDS = 4u;

const work_COUNT_POINTS = 5u;

fn work_progress_entry(settings: settings_SampleSettings, group_index: u32) -> u32 {
    return work_FIRST_GROUP + 2u * group_index;
}

fn work_queue_entry(settings: settings_SampleSettings, queue: u32, place: u32) -> u32 {
    return work_FIRST_GROUP + (2u + queue) * settings.max_groups + place;
}
