// Linked from src/techniques/receiver_lists/light_bits/make_lookup.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<uniform> settings: settings_SampleSettings;

@group(0) @binding(1)
var<uniform> light_words: array<vec4f, settings_LIGHT_WORDS_LENGTH>;

@group(0) @binding(2)
var table: texture_storage_3d<rgba32uint, write>;

@compute @workgroup_size(4, 4, 4)
fn make_lookup(@builtin(global_invocation_id) id: vec3u) {
    let size = settings.lookup_size;
    if any(id >= textureDimensions(table)) {
        return;
    }
    let block = id.z / size;
    let middle = light_words[0].xyz;
    let half_box = light_words[1].xyz;
    let plane = lookup_index_lookup_plane(size, half_box.z == 0.0, vec3u(id.xy, id.z % size));
    let scale = 1.0 / max(half_box, vec3f(1e-30));
    var behind = vec4u();
    let first = 128u * block;
    let count = min(128u, settings.point_count - min(first, settings.point_count));
    for (var k = 0u; k < count; k++) {
        let at = settings_FIRST_POINT + 4u * ((first + k) / 4u);
        let point = vec3f(light_words[at][k & 3u], light_words[at + 1u][k & 3u], light_words[at + 2u][k & 3u]);
        let scaled = (point - middle) * scale;
        if dot(plane.normal, scaled) >= plane.distance {
            behind[k / 32u] |= 1u << (k % 32u);
        }
    }
    textureStore(table, id, behind);
}

const lookup_index_TAU = 6.283185307179586;

const lookup_index_MAX_DISTANCE_FLAT = 1.4142135623730951;

const lookup_index_MAX_DISTANCE = 1.7320508075688772;

struct lookup_index_LookupPlane {
    normal: vec3f,
    distance: f32
}

fn lookup_index_lookup_plane(size: u32, is_flat: bool, cell: vec3u) -> lookup_index_LookupPlane {
    let n = f32(size);
    if is_flat {
        let angles = size * size / 4u;
        let index = cell.x + size * (cell.y + size * cell.z);
        let angle = lookup_index_TAU * (f32(index % angles) + 0.5) / f32(angles);
        let distance = lookup_index_MAX_DISTANCE_FLAT * (2.0 * (f32(index / angles) + 0.5) / (4.0 * n) - 1.0);
        return lookup_index_LookupPlane(vec3f(cos(angle), sin(angle), 0.0), distance);
    }
    let azimuth = lookup_index_TAU * (f32(cell.x) + 0.5) / n;
    let polar = 0.5 * lookup_index_TAU * (f32(cell.y) + 0.5) / n;
    let distance = lookup_index_MAX_DISTANCE * (2.0 * (f32(cell.z) + 0.5) / n - 1.0);
    return lookup_index_LookupPlane(vec3f(sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), cos(polar)), distance);
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
