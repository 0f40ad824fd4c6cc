// Linked from src/techniques/receiver_lists/raster/silhouettes.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(11)
var<storage, read_write> penumbrae: array<atomic<u32>>;

@vertex
fn vertex(@builtin(vertex_index) vertex_index: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4f {
    let influence = influence_influence_of(vertex_index, instance, settings_FLAG_SILHOUETTE);
    return select(vec4f(2.0, 2.0, 0.0, 1.0), influence.corner, influence.first_place == 0u);
}

@fragment
fn fragment(@builtin(position) position: vec4f) {
    atomicStore(&penumbrae[texel_receivers_cell_of_texel(position.xy)], 1u);
}

@group(0) @binding(1)
var<uniform> inputs_light_source: light_LightSource;

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

@group(1) @binding(0)
var<uniform> bits_settings: settings_SampleSettings;

@group(1) @binding(2)
var<storage, read> bits_triangles: array<vec4f>;

struct windows_Window {
    low: vec2f,
    scale: vec2f,
    depth: f32,
    ray_offset: f32,
    reach: f32
}

fn windows_to_windows(settings: settings_SampleSettings, light: light_LightSource, x: vec3f) -> vec3f {
    return windows_vector_to_windows(settings, x - light.center_in_world);
}

fn windows_vector_to_windows(settings: settings_SampleSettings, v: vec3f) -> vec3f {
    return vec3f(dot(v, settings.window_right), dot(v, settings.window_up), dot(v, settings.window_axis));
}

fn windows_along_axes_of(window: u32, p: vec3f) -> vec3f {
    var turned = p;
    if window / 2u == 1u {
        turned = p.yzx;
    }
    else if window / 2u == 2u {
        turned = p.zxy;
    }
    return vec3f(turned.xy, select(turned.z, -turned.z, (window & 1u) == 1u));
}

fn windows_direction_to(settings: settings_SampleSettings, p: vec3f) -> vec2f {
    return select(p.xy / max(p.z, 1e-30), p.xy, settings.projection == settings_PROJECT_PARALLEL);
}

fn windows_window_from(side: u32, low: vec2f, high: vec2f, depth: f32, ray_offset: f32) -> windows_Window {
    let reach = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let size = max(high - low, vec2f(0.0001 * reach + 1e-30));
    return windows_Window(low, f32(side) / size, depth, ray_offset, reach);
}

fn windows_texel_at(window: windows_Window, direction: vec2f) -> vec2f {
    return (direction - window.low) * window.scale;
}

@group(1) @binding(3)
var<storage, read> influence_state: array<u32>;

@group(1) @binding(9)
var<storage, read> influence_totals: array<u32>;

@group(1) @binding(12)
var<storage, read> influence_hulls: array<vec2f>;

const influence_SIX_VERTICES: u32 = 6u;

const influence_HULL_CORNERS: u32 = 22u;

struct influence_Influence {
    corner: vec4f,
    triangle: u32,
    first_place: u32,
    cut: vec3f
}

fn influence_drawn_window() -> windows_Window {
    let first = settings_STATE_WINDOWS + settings_STATE_WINDOW_LENGTH * bits_settings.window;
    let high = vec2f(settings_unsortable(influence_state[first]), settings_unsortable(influence_state[first + 1u]));
    let low = vec2f(settings_unsortable(~influence_state[first + 2u]), settings_unsortable(~influence_state[first + 3u]));
    return windows_window_from(bits_settings.window_side, low, high, settings_unsortable(influence_state[first + 4u]), settings_unsortable(influence_state[first + 5u]));
}

fn influence_flags_of(triangle: u32) -> u32 {
    return u32(bits_triangles[bits_settings.triangle_stride * triangle].w);
}

fn influence_corner_of_region(window: windows_Window, light: region_LightSpan, given: array<vec3f, 3>, index: u32) -> vec3f {
    var corners = given;
    var regions: array<region_Region, 3>;
    var is_behind = true;
    var is_unbounded = false;
    var nearest = 1e38;
    for (var k = 0u; k < 3u; k++) {
        regions[k] = region_region_of(bits_settings, window, light, corners[k]);
        is_behind &= regions[k].is_behind;
        is_unbounded |= regions[k].is_unbounded;
        nearest = min(nearest, corners[k].z);
    }
    if is_behind || nearest > window.depth + 1e-5 * abs(window.depth) {
        return vec3f();
    }
    if is_unbounded {
        for (var k = 0u; k < 3u; k++) {
            regions[k].low = vec2f(-1.0);
            regions[k].high = vec2f(f32(bits_settings.window_side) + 1.0);
        }
    }
    if bits_settings.region_corners == influence_SIX_VERTICES {
        return vec3f(six_vertices_six_vertex(regions, index), 1.0);
    }
    return vec3f(region_hull_corner(regions, index), 1.0);
}

fn influence_influence_of(vertex_index: u32, instance: u32, required: u32) -> influence_Influence {
    let triangle_count = influence_totals[settings_TOTAL_TRIANGLES];
    let triangle = instance % triangle_count;
    let first_place = instance / triangle_count * bits_settings.receivers_per_instance;
    var influence = influence_Influence(vec4f(2.0, 2.0, 0.0, 1.0), triangle, first_place, supporting_plane_NOTHING_CUT);
    let flags = influence_flags_of(triangle);
    if influence_state[settings_STATE_WINDOWS + settings_STATE_WINDOW_LENGTH * bits_settings.window] == 0u || (flags & required) != required {
        return influence;
    }
    let window = influence_drawn_window();
    let light = region_light_span(bits_settings, bits_settings.window);
    let source = bits_settings.triangle_stride * triangle;
    var corners: array<vec3f, 3>;
    for (var k = 0u; k < 3u; k++) {
        corners[k] = windows_along_axes_of(bits_settings.window, windows_to_windows(bits_settings, inputs_light_source, bits_triangles[source + k].xyz));
    }
    if settings_is_on(bits_settings, settings_CUT_BY_PLANE) {
        let a = bits_triangles[source].xyz;
        let normal_in_world = cross(bits_triangles[source + 1u].xyz - a, bits_triangles[source + 2u].xyz - a);
        let normal = windows_along_axes_of(bits_settings.window, windows_vector_to_windows(bits_settings, normal_in_world));
        influence.cut = supporting_plane_cut_of(bits_settings, window, light, corners[0], normal, (flags & settings_FLAG_CLOSED) != 0u);
    }
    let count = bits_settings.region_corners;
    let index = select((count - vertex_index / 2u) % count, (vertex_index + 1u) / 2u, (vertex_index & 1u) == 1u);
    var at: vec3f;
    if count == influence_HULL_CORNERS {
        at = vec3f(influence_hulls[influence_HULL_CORNERS * triangle + index], 1.0);
    }
    else {
        at = influence_corner_of_region(window, light, corners, index);
    }
    if at.z == 1.0 {
        let part = at.xy / f32(bits_settings.window_side);
        influence.corner = vec4f(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y, 0.5, 1.0);
    }
    return influence;
}

struct region_Region {
    low: vec2f,
    high: vec2f,
    is_unbounded: bool,
    is_behind: bool
}

const region_MAX_SIDES = 16.0;

const region_DIRECTION_SLACK = 7.62939453125e-6;

const region_SHADOW_SLACK = 9.5367431640625e-7;

const region_TEXEL_SLACK = 0.015625;

struct region_LightSpan {
    low: vec3f,
    high: vec3f
}

fn region_light_span(settings: settings_SampleSettings, window: u32) -> region_LightSpan {
    let a = windows_along_axes_of(window, settings.window_light_min);
    let b = windows_along_axes_of(window, settings.window_light_max);
    return region_LightSpan(min(a, b), max(a, b));
}

fn region_shadow_direction(v: vec3f, l: vec2f, l_z: f32, z: f32) -> vec2f {
    return (l * (v.z - z) + v.xy * (z - l_z)) / ((v.z - l_z) * z);
}

fn region_shadow_place(v: vec3f, d: vec2f, d_z: f32, z: f32) -> vec2f {
    return v.xy + d / d_z * (z - v.z);
}

fn region_region_of(settings: settings_SampleSettings, window: windows_Window, light: region_LightSpan, v: vec3f) -> region_Region {
    let is_parallel = settings.projection == settings_PROJECT_PARALLEL;
    var region: region_Region;
    region.is_behind = !is_parallel && v.z < light.low.z;
    let beyond = v.z - light.high.z;
    region.is_unbounded = !is_parallel && beyond < 0.001 * (abs(v.z) + abs(light.high.z)) + 1e-30;
    if region.is_unbounded {
        return region;
    }
    let own = windows_direction_to(settings, v);
    var low = own;
    var high = own;
    for (var i = 0u; i < 4u; i++) {
        let l = select(light.low.xy, light.high.xy, vec2<bool>((i & 1u) == 1u));
        let l_z = select(light.low.z, light.high.z, (i & 2u) == 2u);
        let at = select(region_shadow_direction(v, l, l_z, window.depth), region_shadow_place(v, l, l_z, window.depth), is_parallel);
        low = min(low, at);
        high = max(high, at);
    }
    let reach = max(window.reach, max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y))));
    let largest = max(abs(light.low), abs(light.high));
    let terms = select((length(v) + length(largest)) / beyond, length(v) + length(largest) * (abs(v.z) + abs(window.depth)), is_parallel);
    let slack = region_DIRECTION_SLACK * reach + region_SHADOW_SLACK * terms + 2.0 * window.ray_offset * (1.0 + window.reach);
    let room = 0.5 + region_TEXEL_SLACK;
    region.low = windows_texel_at(window, low - slack) - room;
    region.high = windows_texel_at(window, high + slack) + room;
    let side = f32(settings.window_side);
    let middle = 0.5 * side;
    region.is_unbounded = !(all(abs(region.low - middle) < vec2f(region_MAX_SIDES * side)) && all(abs(region.high - middle) < vec2f(region_MAX_SIDES * side)));
    return region;
}

fn region_box_corner(region: region_Region, quadrant: u32) -> vec2f {
    let is_right = quadrant == 0u || quadrant == 3u;
    let is_upper = quadrant < 2u;
    return vec2f(select(region.low.x, region.high.x, is_right), select(region.low.y, region.high.y, is_upper));
}

fn region_hull_corner(regions: array<region_Region, 3>, index: u32) -> vec2f {
    var boxes = regions;
    let quadrant = index / 3u;
    let from_axis = array<vec2f, 4>(vec2f(1.0, 0.0), vec2f(0.0, 1.0), vec2f(-1.0, 0.0), vec2f(0.0, -1.0));
    var axes = from_axis;
    let first_axis = axes[quadrant];
    let last_axis = axes[(quadrant + 1u) % 4u];
    var corners: array<vec2f, 3>;
    var first = 0u;
    var last = 0u;
    for (var i = 0u; i < 3u; i++) {
        corners[i] = region_box_corner(boxes[i], quadrant);
        if region_is_farther(corners[i], corners[first], first_axis, last_axis) {
            first = i;
        }
        if region_is_farther(corners[i], corners[last], last_axis, first_axis) {
            last = i;
        }
    }
    let step = index % 3u;
    if step == 0u || first == last {
        return corners[first];
    }
    if step == 2u {
        return corners[last];
    }
    let third = corners[3u - first - last];
    let along = corners[last] - corners[first];
    let to_third = third - corners[first];
    let stands_out = along.x * to_third.y - along.y * to_third.x < 0.0;
    return select(corners[first], third, stands_out);
}

fn region_is_farther(a: vec2f, b: vec2f, axis: vec2f, next_axis: vec2f) -> bool {
    let more = dot(a - b, axis);
    return more > 0.0 || (more == 0.0 && dot(a - b, next_axis) > 0.0);
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

const settings_PROJECT_PARALLEL = 1u;

const settings_CUT_BY_PLANE = 4u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_STATE_WINDOWS = 12u;

const settings_STATE_WINDOW_LENGTH = 6u;

const settings_TOTAL_TRIANGLES = 1u;

const settings_FLAG_CLOSED = 1u;

const settings_FLAG_SILHOUETTE = 2u;

fn settings_unsortable(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 2147483647u, bits >= 2147483648u));
}

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
