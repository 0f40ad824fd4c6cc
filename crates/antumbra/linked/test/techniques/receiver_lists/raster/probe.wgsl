// Linked from src/techniques/receiver_lists/raster/probe.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read> cases: array<vec4f>;

@group(0) @binding(1)
var<storage, read_write> answers: array<vec4f>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    if 6u * id.x >= arrayLength(&answers) {
        return;
    }
    let first = 9u * id.x;
    var regions: array<region_Region, 3>;
    for (var k = 0u; k < 3u; k++) {
        regions[k] = region_Region(cases[first + k].xy, cases[first + k].zw, false, false);
    }
    let ends = cases[first + 3u];
    let window_of_case = cases[first + 4u];
    let window = windows_window_from(u32(window_of_case.x), ends.xy, ends.zw, window_of_case.y, window_of_case.z);
    var settings: settings_SampleSettings;
    settings.projection = select(0u, settings_PROJECT_PARALLEL, window_of_case.w == 1.0);
    let light = region_LightSpan(vec3f(-0.001), vec3f(0.001));
    let corner = cases[first + 5u];
    let cut = supporting_plane_cut_of(settings, window, light, corner.xyz, cases[first + 6u].xyz, corner.w == 1.0);
    let place = cases[first + 7u];
    let direction = cases[first + 8u];
    let shadow = region_shadow_place(place.xyz, direction.xy, direction.z, place.w);
    let others = array<vec2f, 6>(window.scale, cut.xy, vec2f(cut.z, 0.0), shadow, vec2f(), vec2f());
    for (var i = 0u; i < 6u; i++) {
        var of_case = others;
        answers[6u * id.x + i] = vec4f(six_vertices_six_vertex(regions, i), of_case[i]);
    }
}

struct windows_Window {
    low: vec2f,
    scale: vec2f,
    depth: f32,
    ray_offset: f32,
    reach: f32
}

fn windows_window_from(side: u32, low: vec2f, high: vec2f, depth: f32, ray_offset: f32) -> windows_Window {
    let reach = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let size = max(high - low, vec2f(0.0001 * reach + 1e-30));
    return windows_Window(low, f32(side) / size, depth, ray_offset, reach);
}

struct region_Region {
    low: vec2f,
    high: vec2f,
    is_unbounded: bool,
    is_behind: bool
}

struct region_LightSpan {
    low: vec3f,
    high: vec3f
}

fn region_shadow_place(v: vec3f, d: vec2f, d_z: f32, z: f32) -> vec2f {
    return v.xy + d / d_z * (z - v.z);
}

const six_vertices_SHORTEST_EDGE = 0.0078125;

fn six_vertices_quadrant_of_normal(along: vec2f) -> u32 {
    let normal = vec2f(along.y, -along.x);
    let is_right = normal.x > 0.0 || (normal.x == 0.0 && along.x > 0.0);
    let is_upper = normal.y > 0.0 || (normal.y == 0.0 && along.y > 0.0);
    return select(select(2u, 3u, is_right), select(1u, 0u, is_right), is_upper);
}

fn six_vertices_corner_in(quadrant: u32) -> vec2f {
    let is_right = quadrant == 0u || quadrant == 3u;
    return vec2f(select(-1.0, 1.0, is_right), select(-1.0, 1.0, quadrant < 2u));
}

fn six_vertices_corner_of_all(regions: array<region_Region, 3>, index: u32) -> vec2f {
    var boxes = regions;
    let low = min(min(boxes[0].low, boxes[1].low), boxes[2].low);
    let high = max(max(boxes[0].high, boxes[1].high), boxes[2].high);
    return 0.5 * (low + high) + 0.5 * (high - low) * six_vertices_corner_in(min(index, 3u));
}

fn six_vertices_six_vertex(regions: array<region_Region, 3>, index: u32) -> vec2f {
    var boxes = regions;
    let half = 0.5 * max(max(boxes[0].high - boxes[0].low, boxes[1].high - boxes[1].low), boxes[2].high - boxes[2].low);
    var at: array<vec2f, 3>;
    for (var k = 0u; k < 3u; k++) {
        at[k] = 0.5 * (boxes[k].low + boxes[k].high) / half;
    }
    let first_edge = at[1] - at[0];
    let last_edge = at[2] - at[0];
    if first_edge.x * last_edge.y - first_edge.y * last_edge.x < 0.0 {
        let second = at[1];
        at[1] = at[2];
        at[2] = second;
    }
    let vertex = index / 2u;
    let before = at[vertex] - at[(vertex + 2u) % 3u];
    let after = at[(vertex + 1u) % 3u] - at[vertex];
    let shortest = min(min(length(first_edge), length(last_edge)), length(at[2] - at[1]));
    if shortest < six_vertices_SHORTEST_EDGE {
        return six_vertices_corner_of_all(regions, index);
    }
    let along_before = normalize(before);
    let along_after = normalize(after);
    let quadrant_before = six_vertices_quadrant_of_normal(along_before);
    let quadrant_after = six_vertices_quadrant_of_normal(along_after);
    let turn = (quadrant_after + 4u - quadrant_before) % 4u;
    let beyond = select(0.0, 2.0, turn > 1u);
    let is_first = (index & 1u) == 0u;
    let corner = select(six_vertices_corner_in(quadrant_after) - beyond * along_after, six_vertices_corner_in(quadrant_before) + beyond * along_before, is_first);
    return half * (at[vertex] + corner);
}

const supporting_plane_NOTHING_CUT = vec3f(0.0, 0.0, 1.0);

const supporting_plane_CUT_SLACK = 7.62939453125e-6;

fn supporting_plane_cut_of(settings: settings_SampleSettings, window: windows_Window, light: region_LightSpan, a: vec3f, normal: vec3f, is_closed: bool) -> vec3f {
    let is_parallel = settings.projection == settings_PROJECT_PARALLEL;
    let side_of_light = shaft_side_of_box(normal, select(a, vec3f(), is_parallel), shaft_Box(light.low, light.high));
    let side = select(side_of_light, -1.0, is_closed);
    let height = dot(normal, a);
    if !(side * select(height, normal.z, is_parallel) < 0.0) {
        return supporting_plane_NOTHING_CUT;
    }
    let depth_across = select(window.depth, 1.0, is_parallel);
    let terms = window.reach * abs(depth_across) * (abs(normal.x) + abs(normal.y)) + abs(normal.z * window.depth) + dot(abs(normal), abs(a));
    let slack = supporting_plane_CUT_SLACK * terms + 2.0 * length(normal) * window.ray_offset * abs(depth_across);
    let per_texel = side * depth_across * normal.xy / window.scale;
    let at_low = side * (depth_across * dot(normal.xy, window.low) + normal.z * window.depth - height);
    return vec3f(-per_texel, slack - at_low + 0.5 * (abs(per_texel.x) + abs(per_texel.y)));
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

const settings_PROJECT_PARALLEL = 1u;

const shaft_SHAFT_SLACK = 2e-6;

struct shaft_Box {
    low: vec3f,
    high: vec3f
}

fn shaft_side_of_box(normal: vec3f, a: vec3f, box: shaft_Box) -> f32 {
    let middle = 0.5 * (box.low + box.high) - a;
    let distance = dot(normal, middle);
    let terms = dot(abs(normal), abs(middle));
    let reach = dot(abs(normal), 0.5 * (box.high - box.low)) + shaft_SHAFT_SLACK * terms;
    return select(0.0, sign(distance), abs(distance) > reach);
}
