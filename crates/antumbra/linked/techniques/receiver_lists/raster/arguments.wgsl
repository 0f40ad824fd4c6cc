// Linked from src/techniques/receiver_lists/raster/arguments.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<uniform> settings: settings_SampleSettings;

@group(0) @binding(1)
var<storage, read> state: array<u32>;

@group(0) @binding(2)
var<storage, read> totals: array<u32>;

@group(0) @binding(3)
var<storage, read_write> draw: array<u32>;

@compute @workgroup_size(1)
fn raster_arguments() {
    let parts = (state[settings_STATE_LONGEST] + settings.receivers_per_instance - 1u) / settings.receivers_per_instance;
    draw[0] = settings.region_corners;
    draw[1] = select(totals[settings_TOTAL_TRIANGLES] * parts, 0u, totals[settings_TOTAL_CELLS] == 1u);
    draw[2] = 0u;
    draw[3] = 0u;
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

const settings_STATE_LONGEST = 48u;

const settings_TOTAL_TRIANGLES = 1u;

const settings_TOTAL_CELLS = 4u;
