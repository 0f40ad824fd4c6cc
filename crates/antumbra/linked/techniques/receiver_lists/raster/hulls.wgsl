// Linked from src/techniques/receiver_lists/raster/hulls.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(9)
var<storage, read> totals: array<u32>;

@group(1) @binding(12)
var<storage, read_write> hulls: array<vec2f>;

@group(1) @binding(13)
var<storage, read> ellipsoid: array<vec4f>;

const HEXAGON: u32 = 6u;

const POINTS: u32 = 18u;

const HEXAGON_SCALE = 1.1547006;

const SIXTH_OF_TURN_RAD = 1.0471976;

const NEAREST_SQUARED = 1.01;

const SAME = 0.001;

const MIN_TURN = 0.01;

fn silhouette_corner(v: vec3f, corner: u32) -> vec4f {
    let along = cos(SIXTH_OF_TURN_RAD * f32(corner));
    let across = sin(SIXTH_OF_TURN_RAD * f32(corner));
    if bits_settings.projection == settings_PROJECT_PARALLEL {
        let offset = HEXAGON_SCALE * (along * ellipsoid[1].xyz + across * ellipsoid[2].xyz);
        return vec4f(ellipsoid[0].xyz + offset, 1.0);
    }
    let from_centre = v - ellipsoid[0].xyz;
    var y: vec3f;
    for (var i = 0u; i < 3u; i++) {
        y[i] = dot(ellipsoid[1u + i].xyz, from_centre) / dot(ellipsoid[1u + i].xyz, ellipsoid[1u + i].xyz);
    }
    let squared = dot(y, y);
    if squared <= NEAREST_SQUARED {
        return vec4f();
    }
    let least = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(y.x) > abs(y.y));
    let first = normalize(cross(y, least));
    let second = normalize(cross(y, first));
    let radius = HEXAGON_SCALE * sqrt(1.0 - 1.0 / squared);
    let at = y / squared + radius * (along * first + across * second);
    let scaled = at.x * ellipsoid[1].xyz + at.y * ellipsoid[2].xyz + at.z * ellipsoid[3].xyz;
    return vec4f(ellipsoid[0].xyz + scaled, 1.0);
}

struct Points {
    at: array<vec2f, POINTS>,
    slack: vec2f,
    is_behind: bool,
    is_unbounded: bool
}

fn points_of(triangle: u32, window: windows_Window) -> Points {
    let is_parallel = bits_settings.projection == settings_PROJECT_PARALLEL;
    let light = region_light_span(bits_settings, bits_settings.window);
    let side = f32(bits_settings.window_side);
    var points: Points;
    var nearest = 1e38;
    var slack = 0.0;
    points.is_behind = !is_parallel;
    for (var i = 0u; i < POINTS; i++) {
        let corner = bits_triangles[bits_settings.triangle_stride * triangle + i / HEXAGON].xyz;
        let v_first = windows_to_windows(bits_settings, inputs_light_source, corner);
        let silhouette = silhouette_corner(v_first, i % HEXAGON);
        let v = windows_along_axes_of(bits_settings.window, v_first);
        let l = windows_along_axes_of(bits_settings.window, silhouette.xyz);
        nearest = min(nearest, v.z);
        points.is_behind &= v.z < light.low.z;
        let beyond = v.z - l.z;
        if silhouette.w == 0.0 || (!is_parallel && beyond < 0.001 * (abs(v.z) + abs(l.z)) + 1e-30) {
            points.is_unbounded = true;
            continue;
        }
        let at = select(region_shadow_direction(v, l.xy, l.z, window.depth), region_shadow_place(v, l.xy, l.z, window.depth), is_parallel);
        let reach = max(window.reach, max(abs(at.x), abs(at.y)));
        let terms = select((length(v) + length(l)) / beyond, length(v) + length(l) * (abs(v.z) + abs(window.depth)), is_parallel);
        slack = max(slack, region_DIRECTION_SLACK * reach + region_SHADOW_SLACK * terms);
        points.at[i] = windows_texel_at(window, at);
        points.is_unbounded |= !all(abs(points.at[i] - 0.5 * side) < vec2f(region_MAX_SIDES * side));
    }
    points.is_behind |= nearest > window.depth + 1e-5 * abs(window.depth);
    points.slack = (slack + 2.0 * window.ray_offset * (1.0 + window.reach)) * window.scale;
    return points;
}

fn cross_of(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

struct Hull {
    at: array<vec2f, POINTS>,
    count: u32
}

fn hull_of(given: array<vec2f, POINTS>) -> Hull {
    var points = given;
    var lowest = points[0];
    for (var i = 1u; i < POINTS; i++) {
        let p = points[i];
        if p.y < lowest.y || (p.y == lowest.y && p.x < lowest.x) {
            lowest = p;
        }
    }
    var sorted: array<vec2f, POINTS>;
    var sorted_count = 0u;
    for (var i = 0u; i < POINTS; i++) {
        let p = points[i] - lowest;
        if dot(p, p) < SAME * SAME {
            continue;
        }
        var place = sorted_count;
        for (var k = 0u; k < POINTS; k++) {
            if place == 0u {
                break;
            }
            let before = sorted[place - 1u];
            let turn = cross_of(before, p);
            if turn > 0.0 || (turn == 0.0 && dot(before, before) <= dot(p, p)) {
                break;
            }
            sorted[place] = before;
            place -= 1u;
        }
        sorted[place] = p;
        sorted_count += 1u;
    }
    var hull: Hull;
    hull.at[0] = vec2f();
    hull.count = 1u;
    for (var i = 0u; i < sorted_count; i++) {
        let p = sorted[i];
        for (var k = 0u; k < POINTS; k++) {
            if hull.count < 2u {
                break;
            }
            let last = hull.at[hull.count - 1u];
            if cross_of(last - hull.at[hull.count - 2u], p - last) > 0.0 {
                break;
            }
            hull.count -= 1u;
        }
        hull.at[hull.count] = p;
        hull.count += 1u;
    }
    for (var i = 0u; i < min(hull.count, POINTS); i++) {
        hull.at[i] += lowest;
    }
    return hull;
}

fn fill(first: u32, count: u32, at: vec2f) {
    for (var i = count; i < influence_HULL_CORNERS; i++) {
        hulls[first + i] = at;
    }
}

fn write_box(first: u32, low: vec2f, high: vec2f) {
    for (var i = 0u; i < 4u; i++) {
        hulls[first + i] = 0.5 * (low + high) + 0.5 * (high - low) * six_vertices_corner_in(i);
    }
    fill(first, 4u, 0.5 * (low + high) + 0.5 * (high - low) * six_vertices_corner_in(3u));
}

fn write_widened(first: u32, given: Hull, half: vec2f) {
    var hull = given;
    var written = 0u;
    var last: vec2f;
    for (var i = 0u; i < min(hull.count, POINTS); i++) {
        let at = hull.at[i];
        let before = normalize(at - hull.at[(i + hull.count - 1u) % hull.count]);
        let after = normalize(hull.at[(i + 1u) % hull.count] - at);
        let quadrant_before = six_vertices_quadrant_of_normal(before);
        let quadrant_after = six_vertices_quadrant_of_normal(after);
        let turn = (quadrant_after + 4u - quadrant_before) % 4u;
        let corner_before = six_vertices_corner_in(quadrant_before);
        let corner_after = six_vertices_corner_in(quadrant_after);
        let sine = cross_of(before, after);
        last = half * (at + corner_before);
        if turn == 1u && dot(before, after) > 0.0 && sine > MIN_TURN {
            last = half * (at + corner_before + cross_of(corner_after - corner_before, after) / sine * before);
        }
        else if turn > 0u {
            let beyond = select(0.0, 2.0, turn > 1u);
            hulls[first + min(written, influence_HULL_CORNERS - 1u)] = half * (at + corner_before + beyond * before);
            written += 1u;
            last = half * (at + corner_after - beyond * after);
        }
        hulls[first + min(written, influence_HULL_CORNERS - 1u)] = last;
        written += 1u;
    }
    fill(first, written, last);
}

@compute @workgroup_size(64)
fn region_hulls(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    let triangle = runs_thread_index(id, group_counts);
    if triangle >= totals[settings_TOTAL_TRIANGLES] || totals[settings_TOTAL_CELLS] == 1u {
        return;
    }
    let first = influence_HULL_CORNERS * triangle;
    let window = influence_drawn_window();
    var points = points_of(triangle, window);
    let side = f32(bits_settings.window_side);
    if points.is_behind {
        write_box(first, vec2f(-2.0 * side), vec2f(-2.0 * side));
        return;
    }
    if points.is_unbounded {
        write_box(first, vec2f(-1.0), vec2f(side + 1.0));
        return;
    }
    let half = 0.5 + region_TEXEL_SLACK + points.slack;
    var low = points.at[0];
    var high = low;
    for (var i = 0u; i < POINTS; i++) {
        low = min(low, points.at[i]);
        high = max(high, points.at[i]);
        points.at[i] /= half;
    }
    let hull = hull_of(points.at);
    if hull.count < 3u {
        write_box(first, low - half, high + half);
        return;
    }
    write_widened(first, hull, half);
}

fn runs_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
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

const influence_HULL_CORNERS: u32 = 22u;

fn influence_drawn_window() -> windows_Window {
    let first = settings_STATE_WINDOWS + settings_STATE_WINDOW_LENGTH * bits_settings.window;
    let high = vec2f(settings_unsortable(influence_state[first]), settings_unsortable(influence_state[first + 1u]));
    let low = vec2f(settings_unsortable(~influence_state[first + 2u]), settings_unsortable(~influence_state[first + 3u]));
    return windows_window_from(bits_settings.window_side, low, high, settings_unsortable(influence_state[first + 4u]), settings_unsortable(influence_state[first + 5u]));
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

const settings_STATE_WINDOWS = 12u;

const settings_STATE_WINDOW_LENGTH = 6u;

const settings_TOTAL_TRIANGLES = 1u;

const settings_TOTAL_CELLS = 4u;

fn settings_unsortable(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 2147483647u, bits >= 2147483648u));
}
