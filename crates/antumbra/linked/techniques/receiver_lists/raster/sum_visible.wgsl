// Linked from src/techniques/receiver_lists/raster/sum_visible.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(1)
var<storage, read> list: array<u32>;

@group(1) @binding(6)
var<storage, read> totals: array<u32>;

@compute @workgroup_size(64)
fn raster_after(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let slot = runs_thread_index(id, group_counts);
    if slot >= totals[settings_TOTAL_LISTED] {
        return;
    }
    let pixel_index = list[slot];
    let first_word = bits_first_word_of(pixel_index);
    var seen = 0.0;
    for (var word = 0u; word < bits_settings.word_count; word++) {
        seen += bits_weight_of(word, open_bits_bits[first_word + word]);
    }
    open_bits_write_open(bits_pixel_of(pixel_index), pixel_index, seen);
}

fn runs_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
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

@group(0) @binding(4)
var inputs_mask: texture_storage_2d_array<r32float, read_write>;

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

@group(1) @binding(0)
var<uniform> bits_settings: settings_SampleSettings;

@group(1) @binding(4)
var<uniform> bits_light_words: array<vec4f, settings_LIGHT_WORDS_LENGTH>;

fn bits_pixel_of(pixel_index: u32) -> vec2u {
    return vec2u(pixel_index % inputs_receiver_view.size_px.x, pixel_index / inputs_receiver_view.size_px.x);
}

fn bits_first_word_of(pixel_index: u32) -> u32 {
    return pixel_index * bits_settings.pixel_words + bits_settings.first_word;
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

@group(1) @binding(5)
var<storage, read_write> open_bits_bits: array<u32>;

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

const settings_FIRST_POINTS = 128u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_TOTAL_LISTED = 0u;
