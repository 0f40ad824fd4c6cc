// Linked from src/techniques/receiver_lists/lists/choose.wesl by `cargo xtask shaders`: edit that, not this.

const CROWDED_PART = 4u;

@compute @workgroup_size(256)
fn choose(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let crowded = settings_CROWD * atomicLoad(&bindings_state[settings_STATE_CROWDED]);
    if crowded <= atomicLoad(&bindings_state[settings_STATE_LISTED]) / CROWDED_PART {
        return;
    }
    for (var i = id.x; i <= bindings_settings.list_count; i += 256u * group_counts.x) {
        atomicStore(&bindings_counts[i], 0u);
    }
    if id.x == 0u {
        atomicStore(&bindings_counts[bindings_settings.list_count + 1u], 1u);
    }
}

@group(1) @binding(0)
var<uniform> bindings_settings: settings_SampleSettings;

@group(1) @binding(1)
var<storage, read_write> bindings_state: array<atomic<u32>>;

@group(1) @binding(2)
var<storage, read_write> bindings_counts: array<atomic<u32>>;

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

const settings_STATE_LISTED = 49u;

const settings_STATE_CROWDED = 50u;

const settings_CROWD = 64u;
