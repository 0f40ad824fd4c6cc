// Linked from src/techniques/light_views/multi_view/accumulate_triangles.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(3)
var maps: texture_depth_2d_array;

@group(1) @binding(4)
var gather_sampler: sampler;

@group(1) @binding(6)
var<storage, read_write> life_tables: array<array<u32, SPANS>>;

@group(1) @binding(7)
var triangle_maps: texture_2d_array<u32>;

const SPANS = 8u;

const LAST_SPAN_TEXELS = 0.25;

const SPAN_GROWTH = 2.5;

struct LifeTable {
    hidden: array<f32, SPANS>,
    lost: array<f32, SPANS>
}

const KERNEL_TEXELS = 0.35;

const LOST_OF_FOUND = 0.5;

fn span_of(gap_texels: f32) -> u32 {
    let growths = ceil(log2(max(gap_texels / LAST_SPAN_TEXELS, 1e-6)) / log2(SPAN_GROWTH));
    return SPANS - 1u - u32(clamp(growths, 0.0, f32(SPANS) - 1.0));
}

fn bits_of(flags: vec4<bool>) -> u32 {
    return dot(select(vec4u(), vec4u(1u, 2u, 4u, 8u), flags), vec4u(1u));
}

struct Quad {
    ids: vec4u,
    is_lost: vec4<bool>,
    is_hidden: vec4<bool>,
    spans: vec4u,
    weight: vec4f
}

fn farthest_around(segment: walk_Segment, known: vec4u, corner: vec2f, texel: vec2f, layer: u32) -> f32 {
    var around: array<vec4u, 8>;
    var pending = 0u;
    for (var b = 0u; b < 8u; b++) {
        let cell = select(b, b + 1u, b > 3u);
        let offset = 2.0 * (vec2f(vec2u(cell % 3u, cell / 3u)) - 1.0);
        around[b] = textureGather(0, triangle_maps, gather_sampler, corner + offset * texel, layer);
        pending |= bits_of(around[b] != vec4u()) << (4u * b);
    }
    var farthest = -1.0;
    while (pending != 0u) {
        let i = firstTrailingBit(pending);
        pending &= pending - 1u;
        let id = around[i >> 2u][i & 3u];
        for (var b = 0u; b < 8u; b++) {
            pending &= ~(bits_of(around[b] == vec4u(id)) << (4u * b));
        }
        if all(known != vec4u(id)) {
            let met = walk_meeting(segment, id - 1u);
            farthest = select(farthest, max(farthest, met.t), met.kind == walk_MEETS);
        }
    }
    return farthest;
}

fn observe(seen: sample_views_Look, segment: walk_Segment, moved_share: f32, weight: f32, table: ptr<function, LifeTable>) {
    if !seen.asks_map {
        (*table).hidden[0] += weight * (1.0 - seen.lit);
        return;
    }
    let view = sample_views_views[seen.view];
    let plane = seen.plane;
    let pos = plane.uv * view.map_size - 0.5;
    let base = floor(pos);
    let texel = 1.0 / view.map_size;
    let corner = (base + 1.0) * texel;
    let from_here = space_from_quad_center(pos - base);
    let stored = textureGather(maps, gather_sampler, corner, seen.layer);
    let step = plane.depth_per_uv * texel;
    let here = plane.depth - plane.bias;
    let at_centers = space_held(view, plane, here + from_here.x * step.x + from_here.y * step.y);
    let tolerance = (bias_BIAS_SHARE + moved_share) * abs(plane.bias) + bias_texels_to_allow() * sample_views_batch.bias_scale * (abs(step.x) + abs(step.y));
    let gaps = view.depth_sign * (stored - here) * (space_SURFACE_SLOPE / plane.surface_step);
    let kernel = exp(-0.5 / (KERNEL_TEXELS * KERNEL_TEXELS) * (from_here.x * from_here.x + from_here.y * from_here.y));
    var quad: Quad;
    quad.ids = textureGather(0, triangle_maps, gather_sampler, corner, seen.layer);
    quad.is_lost = view.depth_sign * (stored - at_centers) > vec4f(tolerance);
    quad.spans = vec4u(span_of(gaps.x), span_of(gaps.y), span_of(gaps.z), span_of(gaps.w));
    quad.weight = kernel * (weight / dot(kernel, vec4f(1.0)));
    let texels_of_segment = seen.distance / seen.texel_m;
    let is_in_front = quad.is_lost;
    var farthest = -1.0;
    var pending = bits_of(quad.ids != vec4u());
    while (pending != 0u) {
        let id = quad.ids[firstTrailingBit(pending)];
        pending &= pending - 1u;
        let is_this = quad.ids == vec4u(id);
        pending &= ~bits_of(is_this);
        let met = walk_meeting(segment, id - 1u);
        if met.kind == walk_GOES_ON {
            quad.is_hidden |= is_this & is_in_front;
        }
        else if met.kind == walk_STARTS_ON {
            quad.is_lost &= !is_this;
        }
        else if met.kind == walk_MEETS {
            farthest = max(farthest, met.t);
            quad.is_lost &= !is_this;
        }
        else if met.kind == walk_PASSES_BY {
            quad.is_lost |= is_this;
            quad.spans = select(quad.spans, vec4u(span_of(met.t * texels_of_segment)), is_this);
        }
    }
    if farthest < 0.0 {
        farthest = farthest_around(segment, quad.ids, corner, texel, seen.layer);
    }
    let is_found = farthest >= 0.0;
    let span = span_of(farthest * texels_of_segment);
    for (var i = 0u; i < 4u; i++) {
        let weight_of_texel = quad.weight[i];
        if quad.is_hidden[i] {
            (*table).hidden[quad.spans[i]] += weight_of_texel;
        }
        else if is_found {
            let lost = select(0.0, LOST_OF_FOUND * weight_of_texel, quad.is_lost[i] && quad.spans[i] < span);
            (*table).lost[quad.spans[i]] += lost;
            (*table).hidden[span] += weight_of_texel - lost;
        }
        else if quad.is_lost[i] {
            (*table).lost[quad.spans[i]] += weight_of_texel;
        }
    }
}

fn visibility_of(table: LifeTable) -> f32 {
    var visibility = 1.0;
    var known = 1.0;
    for (var s = 0u; s < SPANS; s++) {
        visibility *= 1.0 - saturate(table.hidden[s] / max(known, 1e-6));
        known -= table.hidden[s] + table.lost[s];
    }
    return visibility;
}

fn segment_start(receiver: inputs_Receiver, displacement: bias_Displacement) -> vec3f {
    let ray_offset_m = RAY_OFFSET_ROUNDINGS * displacement.rounding_m + inputs_OFFSET_SNAPS * displacement.snapped_m + displacement.matrix_m;
    return receiver.pos_in_world + sample_views_batch.bias_scale * ray_offset_m * receiver.normal_in_world;
}

const RAY_OFFSET_ROUNDINGS = 16.0;

fn accumulate_pixel(id: vec2u, receiver: inputs_Receiver) {
    let index = band_index_in_band(id, inputs_receiver_view.size_px.x);
    var table: LifeTable;
    if sample_views_batch.first > 0u {
        for (var s = 0u; s < SPANS; s++) {
            let shares = unpack2x16unorm(life_tables[index][s]);
            table.hidden[s] = shares.x;
            table.lost[s] = shares.y;
        }
    }
    let displacement = bias_displacement_of(id, receiver.pos_in_world);
    let start = segment_start(receiver, displacement);
    let error_m = inputs_depth_error_m(receiver.pos_in_world);
    for (var i = 0u; i < sample_views_batch.count; i++) {
        let sample = sample_views_samples[sample_views_batch.first + i];
        let seen = sample_views_look(receiver, i);
        let segment = walk_Segment(start, sample.point.xyz - sample.point.w * start, sample.point.w, error_m);
        observe(seen, segment, bias_displaced_share(seen, displacement), sample.weight, &table);
    }
    if sample_views_batch.first + sample_views_batch.count < arrayLength(&sample_views_samples) {
        for (var s = 0u; s < SPANS; s++) {
            life_tables[index][s] = pack2x16unorm(vec2f(table.hidden[s], table.lost[s]));
        }
        return;
    }
    inputs_write_visibility(id, visibility_of(table));
}

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3u) {
    let at = band_pixel_of_thread(id.xy);
    let pixel = sample_views_load_pixel(at);
    sample_views_write_known(at, pixel);
    if pixel.is_inside && !pixel.is_known {
        accumulate_pixel(at, pixel.receiver);
    }
}

const bias_HALF_TEXEL = 0.5;

const bias_SNAPPED_TEXELS = 0.00390625;

fn bias_automatic_bias_m(texel_width_m: f32, grazing_sine: f32, bias_scale: f32) -> f32 {
    return bias_scale * texel_width_m * max(bias_HALF_TEXEL, bias_SNAPPED_TEXELS / grazing_sine);
}

const triangles_NO_NEIGHBOUR = 4294967295u;

fn triangles_corner_of(word: vec4u) -> vec3f {
    return bitcast<vec3f>(word.xyz);
}

@group(1) @binding(8)
var<storage, read> walk_caster_triangles: array<vec4u>;

struct walk_Segment {
    start: vec3f,
    towards: vec3f,
    inverse_end: f32,
    depth_error_m: vec3f
}

const walk_STAYS_ASIDE = 0u;

const walk_PASSES_BY = 1u;

const walk_GOES_ON = 2u;

const walk_MEETS = 3u;

const walk_STARTS_ON = 4u;

struct walk_Meeting {
    kind: u32,
    t: f32
}

const walk_MAX_STEPS = 8u;

fn walk_meeting(segment: walk_Segment, first: u32) -> walk_Meeting {
    var result = walk_Meeting(walk_STAYS_ASIDE, 0.0);
    var at = first;
    var passed = vec3f();
    for (var step = 0u; step < walk_MAX_STEPS && at != triangles_NO_NEIGHBOUR; step++) {
        let word_a = walk_caster_triangles[3u * at];
        let word_b = walk_caster_triangles[3u * at + 1u];
        let word_c = walk_caster_triangles[3u * at + 2u];
        let corner_a = triangles_corner_of(word_a);
        let corner_b = triangles_corner_of(word_b);
        let corner_c = triangles_corner_of(word_c);
        let a = corner_a - segment.start;
        let b = corner_b - segment.start;
        let c = corner_c - segment.start;
        let beyond = vec3f(dot(passed, a), dot(passed, b), dot(passed, c));
        if max(beyond.x, max(beyond.y, beyond.z)) < -min(beyond.x, min(beyond.y, beyond.z)) {
            break;
        }
        let n = cross(corner_b - corner_a, corner_c - corner_a);
        let height = dot(a, n);
        var away = dot(segment.depth_error_m, n);
        if abs(height) <= abs(away) {
            away *= depth_error_largest_depth(inputs_receiver_view.clip_z_row, inputs_receiver_view.clip_w_row, corner_a, corner_b, corner_c);
        }
        let starts_on = abs(height) <= abs(away);
        let side = sign(select(height, away, starts_on));
        let approach = dot(segment.towards, n);
        if side == 0.0 || side * approach <= abs(height) * segment.inverse_end {
            result.kind = select(result.kind, walk_STARTS_ON, starts_on && step == 0u);
            break;
        }
        result = walk_Meeting(walk_PASSES_BY, max(height / approach, 0.0));
        let n_a = side * cross(corner_b - corner_c, b + c);
        let n_b = side * cross(corner_c - corner_a, c + a);
        let n_c = side * cross(corner_a - corner_b, a + b);
        let inside = vec3f(dot(n_a, segment.towards), dot(n_b, segment.towards), dot(n_c, segment.towards));
        let least = min(inside.x, min(inside.y, inside.z));
        if least >= 0.0 {
            result.kind = walk_MEETS;
            break;
        }
        at = word_c.w;
        passed = -n_c;
        if inside.x == least {
            at = word_a.w;
            passed = -n_a;
        }
        else if inside.y == least {
            at = word_b.w;
            passed = -n_b;
        }
        if step + 1u == walk_MAX_STEPS && at != triangles_NO_NEIGHBOUR {
            result.kind = walk_GOES_ON;
        }
    }
    return result;
}

struct space_LightViewGpu {
    origin_in_world: vec3f,
    perspective: u32,
    right_in_world: vec3f,
    depth_scale: f32,
    up_in_world: vec3f,
    depth_offset: f32,
    axis_in_world: vec3f,
    depth_sign: f32,
    uv_from_plane: vec4f,
    plane_from_uv: vec4f,
    uv_origin: vec2f,
    map_size: vec2f,
    near_m: f32,
    far_m: f32,
    texel_in_plane: f32,
    complete_from_m: f32,
    warp: vec2f,
    plane_center: vec2f
}

const space_MIN_GRAZING_SINE = 0.00390625;

const space_MIN_GRAZING_SINE_OF_PARALLEL = 0.0078;

fn space_min_grazing_sine(view: space_LightViewGpu) -> f32 {
    return select(space_MIN_GRAZING_SINE_OF_PARALLEL, space_MIN_GRAZING_SINE, view.perspective == 1u);
}

struct space_ReceiverPlane {
    uv: vec2f,
    depth: f32,
    depth_per_uv: vec2f,
    farthest_depth: f32,
    surface_step: f32,
    bias: f32,
    faces_away: bool
}

const space_SURFACE_SLOPE = 8.0;

fn space_light_from_world(view: space_LightViewGpu, x: vec3f) -> vec3f {
    let p = x - view.origin_in_world;
    return vec3f(dot(p, view.right_in_world), dot(p, view.up_in_world), dot(p, view.axis_in_world));
}

fn space_depth_of_z(view: space_LightViewGpu, z_m: f32) -> f32 {
    return view.depth_scale * select(z_m, 1.0 / z_m, view.perspective == 1u) + view.depth_offset;
}

fn space_texel_in_plane_at(view: space_LightViewGpu, from_center: vec2f) -> f32 {
    if !space_is_warped(view) {
        return view.texel_in_plane;
    }
    let w = 1.0 + dot(view.warp, from_center);
    let u = view.plane_from_uv.xy / view.map_size.x;
    let v = view.plane_from_uv.zw / view.map_size.y;
    return w * max(length(u + from_center * dot(view.warp, u)), length(v + from_center * dot(view.warp, v)));
}

fn space_uv_step_of_plane(view: space_LightViewGpu, step: vec2f) -> vec2f {
    return view.uv_from_plane.xy * step.x + view.uv_from_plane.zw * step.y;
}

fn space_is_warped(view: space_LightViewGpu) -> bool {
    return any(view.warp != vec2f());
}

fn space_receiver_plane(view: space_LightViewGpu, x: vec3f, normal_in_world: vec3f, bias_m: f32) -> space_ReceiverPlane {
    return space_receiver_plane_within(view, x, normal_in_world, bias_m, space_min_grazing_sine(view));
}

fn space_receiver_plane_within(view: space_LightViewGpu, x: vec3f, normal_in_world: vec3f, bias_m: f32, min_sine: f32) -> space_ReceiverPlane {
    let p = space_light_from_world(view, x);
    let n = vec3f(dot(normal_in_world, view.right_in_world), dot(normal_in_world, view.up_in_world), dot(normal_in_world, view.axis_in_world));
    var plane: vec2f;
    var biased_z: f32;
    var depth_per_plane: vec2f;
    var faces_away: bool;
    if view.perspective == 1u {
        let distance = length(p);
        plane = p.xy / p.z;
        let toward = max(1.0 - bias_m / distance, 0.001);
        biased_z = p.z * toward;
        let k = dot(n, p) * toward;
        let k_min = min_sine * distance;
        depth_per_plane = view.depth_scale * n.xy / select(max(k, k_min), min(k, -k_min), k < 0.0);
        faces_away = k > 0.0;
    }
    else {
        plane = p.xy;
        biased_z = p.z - bias_m;
        let nz = select(max(n.z, min_sine), min(n.z, -min_sine), n.z < 0.0);
        depth_per_plane = -view.depth_scale * n.xy / nz;
        faces_away = n.z > 0.0;
    }
    let from_center = plane - view.plane_center;
    let divisor = 1.0 + dot(view.warp, from_center);
    let unwarped_depth = space_depth_of_z(view, biased_z);
    let bias = (unwarped_depth - space_depth_of_z(view, p.z)) / divisor;
    let texel_in_plane = space_texel_in_plane_at(view, from_center);
    let surface_step = space_SURFACE_SLOPE * texel_in_plane * abs(view.depth_scale) / divisor * select(1.0, 1.0 / p.z, view.perspective == 1u);
    depth_per_plane -= view.warp * (unwarped_depth - dot(depth_per_plane, from_center));
    let depth_per_uv = vec2f(dot(view.plane_from_uv.xy, depth_per_plane), dot(view.plane_from_uv.zw, depth_per_plane));
    return space_ReceiverPlane(view.uv_origin + space_uv_step_of_plane(view, from_center / divisor), unwarped_depth / divisor, depth_per_uv, select(1.0, 0.0, view.depth_sign > 0.0), surface_step, bias, faces_away);
}

fn space_held(view: space_LightViewGpu, plane: space_ReceiverPlane, depth: vec4f) -> vec4f {
    let no_farther = view.depth_sign * max(view.depth_sign * depth, vec4f(view.depth_sign * plane.farthest_depth));
    return saturate(no_farther);
}

struct space_Quad2 {
    x: vec4f,
    y: vec4f
}

fn space_from_quad_center(t: vec2f) -> space_Quad2 {
    return space_Quad2(vec4f(-t.x, 1.0 - t.x, 1.0 - t.x, -t.x), vec4f(1.0 - t.y, 1.0 - t.y, -t.y, -t.y));
}

fn space_grazing_sine(view: space_LightViewGpu, x: vec3f, normal_in_world: vec3f) -> f32 {
    let ray = select(view.axis_in_world, normalize(x - view.origin_in_world), view.perspective == 1u);
    return abs(dot(normal_in_world, ray));
}

fn space_texel_width_m(view: space_LightViewGpu, x: vec3f) -> f32 {
    let p = space_light_from_world(view, x);
    if view.perspective == 1u {
        return space_texel_in_plane_at(view, p.xy / p.z - view.plane_center) * p.z;
    }
    return space_texel_in_plane_at(view, p.xy - view.plane_center);
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

const depth_error_ROUNDING = 4.76837158203125e-7;

fn depth_error_displacement_by_depth(clip_z_row: vec4f, clip_w_row: vec4f, pos_in_world: vec3f, along: vec3f) -> vec3f {
    let at = vec2f(dot(clip_z_row, vec4f(pos_in_world, 1.0)), dot(clip_w_row, vec4f(pos_in_world, 1.0)));
    let step = vec2f(dot(clip_z_row.xyz, along), dot(clip_w_row.xyz, along));
    let depth_per_step = (step.x * at.y - at.x * step.y) / (at.y * at.y);
    return along * (depth_error_ROUNDING / max(abs(depth_per_step), 1e-30));
}

fn depth_error_corner_depth(clip_z_row: vec4f, clip_w_row: vec4f, corner: vec3f) -> f32 {
    let z = dot(clip_z_row, vec4f(corner, 1.0));
    let w = dot(clip_w_row, vec4f(corner, 1.0));
    return select(1.0, z / w, z >= 0.0 && z <= w && w > 0.0);
}

fn depth_error_largest_depth(clip_z_row: vec4f, clip_w_row: vec4f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let depth_a = depth_error_corner_depth(clip_z_row, clip_w_row, a);
    let depth_b = depth_error_corner_depth(clip_z_row, clip_w_row, b);
    let depth_c = depth_error_corner_depth(clip_z_row, clip_w_row, c);
    return max(depth_a, max(depth_b, depth_c));
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

@group(0) @binding(4)
var inputs_mask: texture_storage_2d_array<r32float, read_write>;

struct inputs_Receiver {
    pos_in_world: vec3f,
    normal_in_world: vec3f,
    is_background: bool,
    is_reached: bool
}

const inputs_QUOTIENT_ROUNDING = 1e-5;

fn inputs_store_mask(pixel: vec2u, layer: u32, visibility: f32) {
    let is_one = visibility > 1.0 && visibility < 1.0 + inputs_QUOTIENT_ROUNDING;
    textureStore(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer, vec4f(select(visibility, 1.0, is_one)));
}

fn inputs_write_visibility(pixel: vec2u, visibility: f32) {
    for (var layer = 0u; layer < inputs_receiver_view.mask_layers; layer++) {
        inputs_store_mask(pixel, layer, visibility);
    }
}

fn inputs_is_inside(pixel: vec2u) -> bool {
    return all(pixel < inputs_receiver_view.size_px);
}

fn inputs_are_points() -> bool {
    return inputs_receiver_view.are_points == 1u;
}

fn inputs_depth_at(pixel: vec2u) -> f32 {
    return textureLoad(inputs_receiver_depth, inputs_receiver_view.origin_px + pixel, 0).x;
}

fn inputs_position_in_world(pixel: vec2u, depth: f32) -> vec3f {
    let ndc = (vec2f(pixel) + 0.5) / vec2f(inputs_receiver_view.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = inputs_receiver_view.view_from_clip * vec4f(ndc, depth, 1.0);
    return (inputs_receiver_view.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

fn inputs_position_rounding_m(pixel: vec2u, pos_in_world: vec3f) -> f32 {
    if inputs_are_points() {
        return inputs_RELATIVE_ROUNDING * length(pos_in_world);
    }
    let next_depth = inputs_depth_at(pixel) * (1.0 + 2.0 * inputs_RELATIVE_ROUNDING);
    return distance(inputs_position_in_world(pixel, next_depth), pos_in_world) + inputs_RELATIVE_ROUNDING * length(pos_in_world);
}

fn inputs_snapped_m(snapped_px: f32, pos_in_world: vec3f) -> f32 {
    return inputs_snapped_at_w(snapped_px, abs(dot(inputs_receiver_view.clip_w_row, vec4f(pos_in_world, 1.0))));
}

fn inputs_snapped_at_w(snapped_px: f32, w: f32) -> f32 {
    return snapped_px * inputs_receiver_view.pixel_m_per_w * w;
}

const inputs_OFFSET_SNAPS = 1.5;

const inputs_RELATIVE_ROUNDING = 1.1920929e-7;

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

const light_KIND_SUN = 4u;

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

struct band_PixelBand {
    first_row: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(1) @binding(9)
var<uniform> band_band: band_PixelBand;

fn band_pixel_of_thread(thread: vec2u) -> vec2u {
    return vec2u(thread.x, band_band.first_row + thread.y);
}

fn band_index_in_band(pixel: vec2u, width: u32) -> u32 {
    return (pixel.y - band_band.first_row) * width + pixel.x;
}

@group(1) @binding(10)
var<uniform> bias_snapped_texels: f32;

const bias_BIAS_SHARE = 0.03;

const bias_MIN_SNAPPED_TEXELS = 0.004;

fn bias_texels_to_allow() -> f32 {
    return max(bias_MIN_SNAPPED_TEXELS, bias_snapped_texels);
}

struct bias_Displacement {
    rounding_m: f32,
    snapped_m: f32,
    matrix_m: f32
}

fn bias_displacement_of(pixel: vec2u, pos_in_world: vec3f) -> bias_Displacement {
    return bias_Displacement(inputs_position_rounding_m(pixel, pos_in_world), inputs_snapped_m(bias_snapped_texels, pos_in_world), inputs_receiver_view.matrix_rounding_m);
}

fn bias_displaced_share(seen: sample_views_Look, displacement: bias_Displacement) -> f32 {
    return 2.0 * (displacement.rounding_m + displacement.snapped_m + displacement.matrix_m) / (seen.texel_m * max(seen.cosine, 0.01));
}

struct sample_views_ViewBatch {
    first: u32,
    count: u32,
    faces: u32,
    hardware_compare: u32,
    bias_scale: f32,
    slope_bias_texels: f32,
    kernel_texels: f32,
    light_radius: f32,
    channel: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

struct sample_views_ViewSample {
    point: vec4f,
    weight: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32
}

@group(1) @binding(0)
var<uniform> sample_views_batch: sample_views_ViewBatch;

@group(1) @binding(1)
var<storage, read> sample_views_views: array<space_LightViewGpu>;

@group(1) @binding(2)
var<storage, read> sample_views_samples: array<sample_views_ViewSample>;

struct sample_views_Look {
    asks_map: bool,
    lit: f32,
    view: u32,
    layer: u32,
    plane: space_ReceiverPlane,
    distance: f32,
    cosine: f32,
    texel_m: f32
}

fn sample_views_face_of(view: space_LightViewGpu, towards: vec3f) -> u32 {
    let p = vec3f(dot(towards, view.right_in_world), dot(towards, view.up_in_world), dot(towards, view.axis_in_world));
    let a = abs(p);
    if a.z >= max(a.x, a.y) {
        return select(0u, 5u, p.z < 0.0);
    }
    if a.x >= a.y {
        return select(1u, 2u, p.x < 0.0);
    }
    return select(3u, 4u, p.y < 0.0);
}

fn sample_views_look(receiver: inputs_Receiver, index_in_batch: u32) -> sample_views_Look {
    var seen: sample_views_Look;
    let point = sample_views_samples[sample_views_batch.first + index_in_batch].point;
    let towards = point.xyz - point.w * receiver.pos_in_world;
    let height = dot(towards, receiver.normal_in_world);
    if height <= 0.0 {
        return seen;
    }
    let first_face = (sample_views_batch.first + index_in_batch) * sample_views_batch.faces;
    var face = 0u;
    if sample_views_batch.faces > 1u {
        face = sample_views_face_of(sample_views_views[first_face], -towards);
        if face >= sample_views_batch.faces {
            seen.lit = 1.0;
            return seen;
        }
    }
    seen.view = first_face + face;
    seen.layer = index_in_batch * sample_views_batch.faces + face;
    let view = sample_views_views[seen.view];
    seen.texel_m = space_texel_width_m(view, receiver.pos_in_world);
    let sine = max(space_grazing_sine(view, receiver.pos_in_world, receiver.normal_in_world), space_min_grazing_sine(view));
    let bias_m = bias_automatic_bias_m(seen.texel_m, sine, sample_views_batch.bias_scale);
    seen.plane = space_receiver_plane(view, receiver.pos_in_world, receiver.normal_in_world, bias_m);
    seen.plane.depth += view.depth_sign * sample_views_batch.bias_scale * sample_views_batch.slope_bias_texels * dot(abs(seen.plane.depth_per_uv), 1.0 / view.map_size);
    seen.distance = length(towards);
    seen.cosine = height / seen.distance;
    seen.lit = 1.0;
    seen.asks_map = all(seen.plane.uv >= vec2f(0.0)) && all(seen.plane.uv <= vec2f(1.0));
    return seen;
}

struct sample_views_Pixel {
    is_inside: bool,
    is_known: bool,
    receiver: inputs_Receiver
}

fn sample_views_load_pixel(id: vec2u) -> sample_views_Pixel {
    var pixel: sample_views_Pixel;
    pixel.is_inside = inputs_is_inside(id);
    if pixel.is_inside {
        pixel.receiver = inputs_load_receiver(id);
        pixel.is_known = pixel.receiver.is_background || !pixel.receiver.is_reached;
    }
    return pixel;
}

fn sample_views_write_known(id: vec2u, pixel: sample_views_Pixel) {
    if pixel.is_inside && pixel.is_known {
        inputs_write_visibility(id, select(0.0, 1.0, pixel.receiver.is_background));
    }
}
