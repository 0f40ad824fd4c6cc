// Linked from src/techniques/receiver_lists/triangles/super_boxes.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn super_boxes(@builtin(global_invocation_id) id: vec3u) {
    let cluster_count = (bindings_totals[settings_TOTAL_TRIANGLES] + 63u) / 64u;
    let first = 32u * id.x;
    if first >= cluster_count {
        return;
    }
    var low = bindings_boxes[2u * first].xyz;
    var high = bindings_boxes[2u * first + 1u].xyz;
    var flags = 0u;
    for (var i = first; i < min(first + 32u, cluster_count); i++) {
        flags |= u32(bindings_boxes[2u * i].w);
        low = min(low, bindings_boxes[2u * i].xyz);
        high = max(high, bindings_boxes[2u * i + 1u].xyz);
    }
    let at = bindings_settings.super_first + id.x;
    bindings_boxes[2u * at] = vec4f(low, f32(flags));
    bindings_boxes[2u * at + 1u] = vec4f(high, 0.0);
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

const settings_TOTAL_TRIANGLES = 1u;

@group(0) @binding(0)
var<uniform> bindings_settings: settings_SampleSettings;

@group(0) @binding(1)
var<storage, read> bindings_totals: array<u32>;

@group(0) @binding(3)
var<storage, read_write> bindings_boxes: array<vec4f>;
