// Linked from src/techniques/receiver_lists/raster/draw.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(11)
var<storage, read_write> penumbrae: array<atomic<u32>>;

override USES_TABLE: bool = false;

override HAS_HOLES: bool = false;

override COUNTS: bool = false;

override STORED_POSITIONS: bool = false;

struct Fragment {
    @builtin(position)
    position: vec4f,
    @location(0) @interpolate(flat, either)
    triangle: u32,
    @location(1) @interpolate(flat, either)
    first_place: u32,
    @location(2) @interpolate(flat, either)
    cut: vec3f
}

@vertex
fn vertex(@builtin(vertex_index) vertex_index: u32, @builtin(instance_index) instance: u32) -> Fragment {
    let influence = influence_influence_of(vertex_index, instance, 0u);
    return Fragment(influence.corner, influence.triangle, influence.first_place, influence.cut);
}

@fragment
fn fragment(fragment: Fragment) {
    if COUNTS {
        texel_receivers_tally(work_COUNT_TRIANGLES, 1u);
    }
    let cell = texel_receivers_cell_of_texel(fragment.position.xy);
    let part = texel_receivers_part_of_list(cell, fragment.first_place);
    if part.count == 0u || supporting_plane_is_cut_off(fragment.cut, fragment.position.xy) {
        return;
    }
    let is_single = settings_is_on(bits_settings, settings_PENUMBRA_ONLY) && atomicLoad(&penumbrae[cell]) == 0u;
    let source = bits_settings.triangle_stride * fragment.triangle;
    let corner_a = bits_triangles[source];
    let corner_b = bits_triangles[source + 1u];
    let corner_c = bits_triangles[source + 2u].xyz;
    let is_closed = (u32(corner_a.w) & settings_FLAG_CLOSED) != 0u;
    let middle = bits_light_words[0].xyz;
    let half_box = bits_light_words[1].xyz;
    let axes = lookup_index_LookupAxes(middle, half_box);
    for (var i = 0u; i < min(part.count, bits_settings.receivers_per_instance); i++) {
        if COUNTS {
            texel_receivers_tally(work_COUNT_PAIRS, 1u);
        }
        let pixel_index = texel_receivers_list[part.first + i];
        let first_word = bits_first_word_of(pixel_index);
        if settings_is_on(bits_settings, settings_STOP_WHEN_OCCLUDED) && !texel_receivers_any_open(first_word) {
            continue;
        }
        let place = texel_receivers_place_of(part.first + i, pixel_index, STORED_POSITIONS);
        let sight = sight_shadow_segments_from(bits_settings, bits_pixel_of(pixel_index), place.x, place.x_open);
        let planes = triangle_test_planes_of(sight_rays_of(sight, is_closed), sight_origin_of(sight, is_closed), corner_a.xyz, corner_b.xyz, corner_c, is_closed, corner_b.w * sight.depth_error_m, middle, half_box);
        if planes.is_missed {
            continue;
        }
        if COUNTS {
            texel_receivers_tally(work_COUNT_PAIRS_NEAR, 1u);
        }
        if is_single {
            if COUNTS {
                texel_receivers_tally(work_COUNT_POINTS, 1u);
            }
            if !triangle_test_is_hit(triangle_test_values_at(planes, middle)) {
                continue;
            }
        }
        var by_table = vec4u();
        for (var word = 0u; word < bits_settings.word_count; word++) {
            var hidden = 0u;
            if is_single {
                hidden = 4294967295u;
            }
            else if USES_TABLE {
                if (word & 3u) == 0u {
                    by_table = bits_hidden_by_table(axes, planes, word / 4u);
                }
                hidden = by_table[word & 3u];
            }
            else {
                if COUNTS {
                    texel_receivers_tally(work_COUNT_WORDS, 1u);
                }
                let box = bits_FIRST_BOX + 2u * word;
                let cover = triangle_test_box_cover(planes, bits_light_words[box].xyz, bits_light_words[box + 1u].xyz);
                if cover == 1u {
                    if COUNTS {
                        texel_receivers_tally(work_COUNT_POINTS, 32u);
                    }
                    hidden = bits_hidden_exactly(planes, word);
                }
                else if cover == 2u {
                    hidden = 4294967295u;
                }
            }
            if HAS_HOLES && hidden != 0u {
                hidden = bits_solid_of(planes, word, hidden & atomicLoad(&texel_receivers_bits[first_word + word]), source);
            }
            if hidden != 0u {
                atomicAnd(&texel_receivers_bits[first_word + word], ~hidden);
            }
        }
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

struct inputs_Receiver {
    pos_in_world: vec3f,
    normal_in_world: vec3f,
    is_background: bool,
    is_reached: bool
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

fn supporting_plane_is_cut_off(cut: vec3f, centre: vec2f) -> bool {
    return dot(cut, vec3f(centre, 1.0)) < 0.0;
}

@group(1) @binding(1)
var<storage, read> texel_receivers_list: array<u32>;

@group(1) @binding(5)
var<storage, read_write> texel_receivers_bits: array<atomic<u32>>;

@group(1) @binding(6)
var<storage, read> texel_receivers_firsts: array<u32>;

@group(1) @binding(8)
var<storage, read_write> texel_receivers_work: array<atomic<u32>>;

@group(1) @binding(10)
var<storage, read> texel_receivers_positions: array<vec4f>;

fn texel_receivers_cell_of_texel(position: vec2f) -> u32 {
    let texel = vec2u(position);
    return (bits_settings.window * bits_settings.window_side + texel.y) * bits_settings.window_side + texel.x;
}

struct texel_receivers_Part {
    first: u32,
    count: u32
}

fn texel_receivers_part_of_list(cell: u32, first_place: u32) -> texel_receivers_Part {
    let first = texel_receivers_firsts[cell] + first_place;
    return texel_receivers_Part(first, min(max(texel_receivers_firsts[cell + 1u], first) - first, bits_settings.receivers_per_instance));
}

struct texel_receivers_Place {
    x: vec3f,
    x_open: vec3f
}

fn texel_receivers_place_of(slot: u32, pixel_index: u32, is_stored: bool) -> texel_receivers_Place {
    if is_stored {
        return texel_receivers_Place(texel_receivers_positions[2u * slot].xyz, texel_receivers_positions[2u * slot + 1u].xyz);
    }
    let receiver = inputs_load_receiver(bits_pixel_of(pixel_index));
    let x = receiver.pos_in_world;
    return texel_receivers_Place(x, x + ray_offset_ray_offset_m(bits_settings, x) * receiver.normal_in_world);
}

fn texel_receivers_any_open(first_word: u32) -> bool {
    var any = 0u;
    for (var word = 0u; word < bits_settings.word_count; word++) {
        any |= atomicLoad(&texel_receivers_bits[first_word + word]);
    }
    return any != 0u;
}

fn texel_receivers_tally(what: u32, tests: u32) {
    atomicAdd(&texel_receivers_work[work_FIRST_COUNTER + what], tests);
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

const settings_PROJECT_PARALLEL = 1u;

const settings_STOP_WHEN_OCCLUDED = 1u;

const settings_PENUMBRA_ONLY = 2u;

const settings_CUT_BY_PLANE = 4u;

fn settings_is_on(settings: settings_SampleSettings, bit: u32) -> bool {
    return (settings.switches & bit) != 0u;
}

const settings_STATE_WINDOWS = 12u;

const settings_STATE_WINDOW_LENGTH = 6u;

const settings_TOTAL_TRIANGLES = 1u;

const settings_FLAG_CLOSED = 1u;

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

const work_FIRST_COUNTER = 2u;

const work_COUNT_TRIANGLES = 1u;

const work_COUNT_PAIRS = 2u;

const work_COUNT_PAIRS_NEAR = 3u;

const work_COUNT_WORDS = 4u;

const work_COUNT_POINTS = 5u;
