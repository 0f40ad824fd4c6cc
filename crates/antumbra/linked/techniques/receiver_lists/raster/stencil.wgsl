// Linked from src/techniques/receiver_lists/raster/stencil.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@builtin(vertex_index) vertex_index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(vertex_index & 1u), f32(vertex_index / 2u));
    return vec4f(4.0 * corner - 1.0, 1.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) {
    let cell = texel_receivers_cell_of_texel(position.xy);
    if texel_receivers_firsts[cell] == texel_receivers_firsts[cell + 1u] {
        discard;
    }
}

@group(1) @binding(0)
var<uniform> bits_settings: settings_SampleSettings;

@group(1) @binding(6)
var<storage, read> texel_receivers_firsts: array<u32>;

fn texel_receivers_cell_of_texel(position: vec2f) -> u32 {
    let texel = vec2u(position);
    return (bits_settings.window * bits_settings.window_side + texel.y) * bits_settings.window_side + texel.x;
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
