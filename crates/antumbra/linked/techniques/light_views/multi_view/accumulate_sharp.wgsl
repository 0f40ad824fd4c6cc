// Linked from src/techniques/light_views/multi_view/accumulate_sharp.wesl by `cargo xtask shaders`: edit that, not this.

@group(1) @binding(3)
var maps: texture_depth_2d_array;

@group(1) @binding(4)
var gather_sampler: sampler;

@group(1) @binding(6)
var<storage, read_write> edge_sums: array<EdgeSums>;

@group(1) @binding(7)
var gradients: texture_2d_array<f32>;

struct EdgeSums {
    contact: vec2f,
    near: vec2f,
    far: f32
}

const TAU = 6.283185307179586;

const CONTACT_TEXELS = 0.25;

const NEAR_TEXELS = 1.5;

const CONTACT_KERNEL = 0.4;

fn sharp_share(seen: package_techniques__1light_views__1sample_views_Look, displacement: package_techniques__1light_views__1multi_view_bias_Displacement) -> EdgeSums {
    let near_variance = package_techniques__1light_views__1sample_views_batch.kernel_texels * package_techniques__1light_views__1sample_views_batch.kernel_texels;
    let contact_variance = near_variance * CONTACT_KERNEL * CONTACT_KERNEL;
    if !seen.asks_map {
        let asked = TAU * seen.lit * vec2f(contact_variance, near_variance);
        return EdgeSums(vec2f(0.0, asked.x), vec2f(0.0, asked.y), 1.0 - seen.lit);
    }
    let view = package_techniques__1light_views__1sample_views_views[seen.view];
    let pos = seen.plane.uv * view.map_size - 0.5;
    let base = floor(pos);
    let corner = (base + 1.0) / view.map_size;
    let stored = textureGather(maps, gather_sampler, corner, seen.layer);
    let gradient = package__1light_map_space_Quad2(package__1light_map__1depth_layers_layer__1GRADIENT_UNIT * textureGather(0, gradients, gather_sampler, corner, seen.layer), package__1light_map__1depth_layers_layer__1GRADIENT_UNIT * textureGather(1, gradients, gather_sampler, corner, seen.layer));
    let t = pos - base;
    let bias_share = package_techniques__1light_views__1multi_view_bias__1BIAS_SHARE + package_techniques__1light_views__1multi_view_bias__1displaced_share(seen, displacement);
    let allowed_texels = package_techniques__1light_views__1multi_view_bias__2texels_to_allow() * package_techniques__1light_views__1sample_views_batch.bias_scale;
    let hidden = 1.0 - package__1light_map_space__3lit_quad_of_surfaces(view, seen.plane, t, stored, gradient, bias_share, allowed_texels);
    let gap = abs(stored - (seen.plane.depth - seen.plane.bias));
    let gap_texels = gap * (package__1light_map_space__1SURFACE_SLOPE / seen.plane.surface_step);
    let blur_texels = gap_texels * (2.0 * package_techniques__1light_views__1sample_views_batch.light_radius / seen.distance);
    let is_far = select(vec4f(0.0), hidden, blur_texels > vec4f(NEAR_TEXELS));
    let is_contact = select(vec4f(0.0), hidden, blur_texels <= vec4f(CONTACT_TEXELS));
    let is_near = hidden - is_far - is_contact;
    let dx = vec4f(t.x, 1.0 - t.x, 1.0 - t.x, t.x);
    let dy = vec4f(1.0 - t.y, 1.0 - t.y, t.y, t.y);
    let exponent = -0.5 * (dx * dx + dy * dy);
    let by_contact = exp(exponent / contact_variance);
    let by_near = exp(exponent / near_variance);
    let by_bilinear = (1.0 - dx) * (1.0 - dy);
    return EdgeSums(vec2f(dot(by_contact, is_contact), dot(by_contact, 1.0 - is_far - is_near)), vec2f(dot(by_near, is_near), dot(by_near, 1.0 - is_far)), dot(by_bilinear, is_far));
}

fn passing(sums: vec2f) -> f32 {
    return 1.0 - sums.x / max(sums.y, 1e-20);
}

fn accumulate_pixel(id: vec2u, receiver: package_frame_inputs_Receiver) {
    let index = package_techniques__1light_views__1multi_view_band__2index_in_band(id, package_frame_inputs__1receiver_view.size_px.x);
    var sums: EdgeSums;
    if package_techniques__1light_views__1sample_views_batch.first > 0u {
        sums = edge_sums[index];
    }
    let displacement = package_techniques__1light_views__1multi_view_bias__1displacement_of(id, receiver.pos_in_world);
    for (var i = 0u; i < package_techniques__1light_views__1sample_views_batch.count; i++) {
        let weight = package_techniques__1light_views__1sample_views_samples[package_techniques__1light_views__1sample_views_batch.first + i].weight;
        let share = sharp_share(package_techniques__1light_views__1sample_views_look(receiver, i), displacement);
        sums.contact += weight * share.contact;
        sums.near += weight * share.near;
        sums.far += weight * share.far;
    }
    if package_techniques__1light_views__1sample_views_batch.first + package_techniques__1light_views__1sample_views_batch.count < arrayLength(&package_techniques__1light_views__1sample_views_samples) {
        edge_sums[index] = sums;
        return;
    }
    package_frame_inputs__1write_visibility(id, clamp((1.0 - sums.far) * passing(sums.near) * passing(sums.contact), 0.0, 1.0));
}

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3u) {
    let at = package_techniques__1light_views__1multi_view_band__2pixel_of_thread(id.xy);
    let pixel = package_techniques__1light_views__1sample_views__1load_pixel(at);
    package_techniques__1light_views__1sample_views__1write_known(at, pixel);
    if pixel.is_inside && !pixel.is_known {
        accumulate_pixel(at, pixel.receiver);
    }
}

struct package_frame_inputs_ReceiverView {
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
    padding_0: u32,
    padding_1: u32
}

@group(0) @binding(0)
var<uniform> package_frame_inputs__1receiver_view: package_frame_inputs_ReceiverView;

@group(0) @binding(1)
var<uniform> package_frame_inputs__1light_source: package_frame_light_LightSource;

@group(0) @binding(2)
var package_frame_inputs__1receiver_depth: texture_2d<f32>;

@group(0) @binding(3)
var package_frame_inputs__1receiver_normals: texture_2d<f32>;

@group(0) @binding(4)
var package_frame_inputs_mask: texture_storage_2d_array<r32float, read_write>;

struct package_frame_inputs_Receiver {
    pos_in_world: vec3f,
    normal_in_world: vec3f,
    is_background: bool,
    is_reached: bool
}

fn package_frame_inputs__1store_mask(pixel: vec2u, layer: u32, visibility: f32) {
    textureStore(package_frame_inputs_mask, package_frame_inputs__1receiver_view.mask_origin_px + pixel, layer, vec4f(visibility));
}

fn package_frame_inputs__1write_visibility(pixel: vec2u, visibility: f32) {
    for (var layer = 0u; layer < package_frame_inputs__1receiver_view.mask_layers; layer++) {
        package_frame_inputs__1store_mask(pixel, layer, visibility);
    }
}

fn package_frame_inputs__1is_inside(pixel: vec2u) -> bool {
    return all(pixel < package_frame_inputs__1receiver_view.size_px);
}

fn package_frame_inputs__1depth_at(pixel: vec2u) -> f32 {
    return textureLoad(package_frame_inputs__1receiver_depth, package_frame_inputs__1receiver_view.origin_px + pixel, 0).x;
}

fn package_frame_inputs__2position_in_world(pixel: vec2u, depth: f32) -> vec3f {
    let ndc = (vec2f(pixel) + 0.5) / vec2f(package_frame_inputs__1receiver_view.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = package_frame_inputs__1receiver_view.view_from_clip * vec4f(ndc, depth, 1.0);
    return (package_frame_inputs__1receiver_view.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

fn package_frame_inputs__2position_rounding_m(pixel: vec2u, pos_in_world: vec3f) -> f32 {
    let next_depth = package_frame_inputs__1depth_at(pixel) * (1.0 + 2.0 * package_frame_inputs__1RELATIVE_ROUNDING);
    return distance(package_frame_inputs__2position_in_world(pixel, next_depth), pos_in_world) + package_frame_inputs__1RELATIVE_ROUNDING * length(pos_in_world);
}

const package_frame_inputs__1RELATIVE_ROUNDING = 1.1920929e-7;

fn package_frame_inputs__1best_difference(pixel: vec2u, step: vec2i, center: vec3f, depth: f32) -> vec3f {
    let last = vec2i(package_frame_inputs__1receiver_view.size_px) - 1;
    let ahead = vec2u(clamp(vec2i(pixel) + step, vec2i(0), last));
    let behind = vec2u(clamp(vec2i(pixel) - step, vec2i(0), last));
    let ahead_2 = vec2u(clamp(vec2i(pixel) + 2 * step, vec2i(0), last));
    let behind_2 = vec2u(clamp(vec2i(pixel) - 2 * step, vec2i(0), last));
    let depth_ahead = package_frame_inputs__1depth_at(ahead);
    let depth_behind = package_frame_inputs__1depth_at(behind);
    let miss_ahead = abs(2.0 * depth_ahead - package_frame_inputs__1depth_at(ahead_2) - depth);
    let miss_behind = abs(2.0 * depth_behind - package_frame_inputs__1depth_at(behind_2) - depth);
    if all(behind == pixel) || (miss_ahead < miss_behind && any(ahead != pixel)) {
        return package_frame_inputs__2position_in_world(ahead, depth_ahead) - center;
    }
    return center - package_frame_inputs__2position_in_world(behind, depth_behind);
}

fn package_frame_inputs__1geometric_normal(pixel: vec2u, pos_in_world: vec3f, depth: f32) -> vec3f {
    var normal: vec3f;
    if package_frame_inputs__1receiver_view.has_normals == 1u {
        normal = textureLoad(package_frame_inputs__1receiver_normals, package_frame_inputs__1receiver_view.origin_px + pixel, 0).xyz;
    }
    else {
        normal = cross(package_frame_inputs__1best_difference(pixel, vec2i(1, 0), pos_in_world, depth), package_frame_inputs__1best_difference(pixel, vec2i(0, 1), pos_in_world, depth));
    }
    let to_eye = package_frame_inputs__1receiver_view.eye_in_world - pos_in_world;
    let length_squared = dot(normal, normal);
    if !(length_squared > 0.0) {
        return normalize(to_eye);
    }
    normal *= inverseSqrt(length_squared);
    return select(-normal, normal, dot(normal, to_eye) >= 0.0);
}

fn package_frame_inputs__1load_receiver(pixel: vec2u) -> package_frame_inputs_Receiver {
    let depth = package_frame_inputs__1depth_at(pixel);
    if depth == package_frame_inputs__1receiver_view.background_depth {
        return package_frame_inputs_Receiver(vec3f(), vec3f(), true, true);
    }
    let pos_in_world = package_frame_inputs__2position_in_world(pixel, depth);
    return package_frame_inputs_Receiver(pos_in_world, package_frame_inputs__1geometric_normal(pixel, pos_in_world, depth), false, package_frame_light_reaches(package_frame_inputs__1light_source, pos_in_world));
}

const package_frame_light__1KIND_RECTANGLE = 0u;

const package_frame_light__1KIND_DISK = 1u;

const package_frame_light__1KIND_SUN = 4u;

struct package_frame_light_LightSource {
    center_in_world: vec3f,
    kind: u32,
    right_in_world: vec3f,
    half_right: f32,
    up_in_world: vec3f,
    half_up: f32,
    axis_in_world: vec3f,
    half_axis: f32,
    reach_tangent: f32,
    point_count: u32,
    emission_size: vec2u,
    cone_cosine: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32
}

fn package_frame_light_reaches(light: package_frame_light_LightSource, x: vec3f) -> bool {
    if light.kind == package_frame_light__1KIND_SUN {
        return true;
    }
    let from_center = x - light.center_in_world;
    let depth = dot(from_center, light.axis_in_world);
    if light.cone_cosine > 0.0 && depth < light.cone_cosine * length(from_center) {
        return false;
    }
    if light.reach_tangent == 0.0 {
        let has_front = light.kind == package_frame_light__1KIND_RECTANGLE || light.kind == package_frame_light__1KIND_DISK;
        return depth > 0.0 || !has_front;
    }
    let half_width = depth * light.reach_tangent;
    return depth > 0.0 && abs(dot(from_center, light.right_in_world)) <= half_width && abs(dot(from_center, light.up_in_world)) <= half_width;
}

const package__1light_map_bias__1HALF_TEXEL = 0.5;

fn package__1light_map_bias__2automatic_bias_m(texel_width_m: f32, bias_scale: f32) -> f32 {
    return package__1light_map_bias__1HALF_TEXEL * bias_scale * texel_width_m;
}

const package__1light_map__1depth_layers_layer__1GRADIENT_UNIT = 1.0 / 1024.0;

struct package__1light_map_space_LightViewGpu {
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
    padding: f32,
    warp: vec2f,
    plane_center: vec2f
}

const package__1light_map_space__2MIN_GRAZING_SINE = 0.0175;

struct package__1light_map_space_ReceiverPlane {
    uv: vec2f,
    depth: f32,
    depth_per_uv: vec2f,
    farthest_depth: f32,
    surface_step: f32,
    bias: f32
}

const package__1light_map_space__1SURFACE_SLOPE = 8.0;

fn package__1light_map_space__2light_from_world(view: package__1light_map_space_LightViewGpu, x: vec3f) -> vec3f {
    let p = x - view.origin_in_world;
    return vec3f(dot(p, view.right_in_world), dot(p, view.up_in_world), dot(p, view.axis_in_world));
}

fn package__1light_map_space__2depth_of_z(view: package__1light_map_space_LightViewGpu, z_m: f32) -> f32 {
    return view.depth_scale * select(z_m, 1.0 / z_m, view.perspective == 1u) + view.depth_offset;
}

fn package__1light_map_space__3texel_in_plane_at(view: package__1light_map_space_LightViewGpu, from_center: vec2f) -> f32 {
    if !package__1light_map_space__1is_warped(view) {
        return view.texel_in_plane;
    }
    let w = 1.0 + dot(view.warp, from_center);
    let u = view.plane_from_uv.xy / view.map_size.x;
    let v = view.plane_from_uv.zw / view.map_size.y;
    return w * max(length(u + from_center * dot(view.warp, u)), length(v + from_center * dot(view.warp, v)));
}

fn package__1light_map_space__3uv_step_of_plane(view: package__1light_map_space_LightViewGpu, step: vec2f) -> vec2f {
    return view.uv_from_plane.xy * step.x + view.uv_from_plane.zw * step.y;
}

fn package__1light_map_space__1is_warped(view: package__1light_map_space_LightViewGpu) -> bool {
    return any(view.warp != vec2f());
}

fn package__1light_map_space__1receiver_plane(view: package__1light_map_space_LightViewGpu, x: vec3f, normal_in_world: vec3f, bias_m: f32) -> package__1light_map_space_ReceiverPlane {
    let p = package__1light_map_space__2light_from_world(view, x);
    let n = vec3f(dot(normal_in_world, view.right_in_world), dot(normal_in_world, view.up_in_world), dot(normal_in_world, view.axis_in_world));
    var plane: vec2f;
    var biased_z: f32;
    var depth_per_plane: vec2f;
    if view.perspective == 1u {
        let distance = length(p);
        plane = p.xy / p.z;
        let toward = max(1.0 - bias_m / distance, 0.001);
        biased_z = p.z * toward;
        let k = dot(n, p) * toward;
        let k_min = package__1light_map_space__2MIN_GRAZING_SINE * distance;
        depth_per_plane = view.depth_scale * n.xy / select(max(k, k_min), min(k, -k_min), k < 0.0);
    }
    else {
        plane = p.xy;
        biased_z = p.z - bias_m;
        let nz = select(max(n.z, package__1light_map_space__2MIN_GRAZING_SINE), min(n.z, -package__1light_map_space__2MIN_GRAZING_SINE), n.z < 0.0);
        depth_per_plane = -view.depth_scale * n.xy / nz;
    }
    let from_center = plane - view.plane_center;
    let divisor = 1.0 + dot(view.warp, from_center);
    let unwarped_depth = package__1light_map_space__2depth_of_z(view, biased_z);
    let bias = (unwarped_depth - package__1light_map_space__2depth_of_z(view, p.z)) / divisor;
    let texel_in_plane = package__1light_map_space__3texel_in_plane_at(view, from_center);
    let surface_step = package__1light_map_space__1SURFACE_SLOPE * texel_in_plane * abs(view.depth_scale) / divisor * select(1.0, 1.0 / p.z, view.perspective == 1u);
    depth_per_plane -= view.warp * (unwarped_depth - dot(depth_per_plane, from_center));
    let depth_per_uv = vec2f(dot(view.plane_from_uv.xy, depth_per_plane), dot(view.plane_from_uv.zw, depth_per_plane));
    return package__1light_map_space_ReceiverPlane(view.uv_origin + package__1light_map_space__3uv_step_of_plane(view, from_center / divisor), unwarped_depth / divisor, depth_per_uv, select(1.0, 0.0, view.depth_sign > 0.0), surface_step, bias);
}

fn package__1light_map_space_held(view: package__1light_map_space_LightViewGpu, plane: package__1light_map_space_ReceiverPlane, depth: vec4f) -> vec4f {
    let no_farther = view.depth_sign * max(view.depth_sign * depth, vec4f(view.depth_sign * plane.farthest_depth));
    return saturate(no_farther);
}

fn package__1light_map_space__3lit_quad_of_surfaces(view: package__1light_map_space_LightViewGpu, plane: package__1light_map_space_ReceiverPlane, t: vec2f, stored: vec4f, gradient: package__1light_map_space_Quad2, bias_share: f32, snapped_texels: f32) -> vec4f {
    let from_here = package__1light_map_space__2from_quad_center(t);
    let carried = stored - from_here.x * gradient.x - from_here.y * gradient.y;
    let step = abs(plane.depth_per_uv / view.map_size);
    let tolerance = bias_share * abs(plane.bias) + snapped_texels * (step.x + step.y + abs(gradient.x) + abs(gradient.y));
    let in_front = package__1light_map_space__3in_front_of_plane(view, plane, plane.depth - plane.bias, from_here, stored, carried);
    return select(vec4f(1.0), vec4f(0.0), in_front > tolerance);
}

struct package__1light_map_space_Quad2 {
    x: vec4f,
    y: vec4f
}

fn package__1light_map_space__2from_quad_center(t: vec2f) -> package__1light_map_space_Quad2 {
    return package__1light_map_space_Quad2(vec4f(-t.x, 1.0 - t.x, 1.0 - t.x, -t.x), vec4f(1.0 - t.y, 1.0 - t.y, -t.y, -t.y));
}

fn package__1light_map_space__3in_front_of_plane(view: package__1light_map_space_LightViewGpu, plane: package__1light_map_space_ReceiverPlane, here: f32, from_here: package__1light_map_space_Quad2, stored: vec4f, carried: vec4f) -> vec4f {
    let step = plane.depth_per_uv / view.map_size;
    let at_centers = package__1light_map_space_held(view, plane, here + from_here.x * step.x + from_here.y * step.y);
    return min(view.depth_sign * (stored - at_centers), view.depth_sign * (carried - package__1light_map_space_held(view, plane, vec4f(here))));
}

fn package__1light_map_space__2texel_width_m(view: package__1light_map_space_LightViewGpu, x: vec3f) -> f32 {
    let p = package__1light_map_space__2light_from_world(view, x);
    if view.perspective == 1u {
        return package__1light_map_space__3texel_in_plane_at(view, p.xy / p.z - view.plane_center) * p.z;
    }
    return package__1light_map_space__3texel_in_plane_at(view, p.xy - view.plane_center);
}

struct package_techniques__1light_views__1multi_view_band_PixelBand {
    first_row: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(1) @binding(9)
var<uniform> package_techniques__1light_views__1multi_view_band_band: package_techniques__1light_views__1multi_view_band_PixelBand;

fn package_techniques__1light_views__1multi_view_band__2pixel_of_thread(thread: vec2u) -> vec2u {
    return vec2u(thread.x, package_techniques__1light_views__1multi_view_band_band.first_row + thread.y);
}

fn package_techniques__1light_views__1multi_view_band__2index_in_band(pixel: vec2u, width: u32) -> u32 {
    return (pixel.y - package_techniques__1light_views__1multi_view_band_band.first_row) * width + pixel.x;
}

@group(1) @binding(10)
var<uniform> package_techniques__1light_views__1multi_view_bias__1snapped_texels: f32;

const package_techniques__1light_views__1multi_view_bias__1BIAS_SHARE = 0.03;

const package_techniques__1light_views__1multi_view_bias__2LEAST_SNAPPED_TEXELS = 0.004;

fn package_techniques__1light_views__1multi_view_bias__2texels_to_allow() -> f32 {
    return max(package_techniques__1light_views__1multi_view_bias__2LEAST_SNAPPED_TEXELS, package_techniques__1light_views__1multi_view_bias__1snapped_texels);
}

struct package_techniques__1light_views__1multi_view_bias_Displacement {
    rounding_m: f32,
    snapped_m: f32
}

fn package_techniques__1light_views__1multi_view_bias__1displacement_of(pixel: vec2u, pos_in_world: vec3f) -> package_techniques__1light_views__1multi_view_bias_Displacement {
    let beside = package_frame_inputs__2position_in_world(pixel + vec2u(1, 0), package_frame_inputs__1depth_at(pixel));
    return package_techniques__1light_views__1multi_view_bias_Displacement(package_frame_inputs__2position_rounding_m(pixel, pos_in_world), package_techniques__1light_views__1multi_view_bias__1snapped_texels * distance(beside, pos_in_world));
}

fn package_techniques__1light_views__1multi_view_bias__1displaced_share(seen: package_techniques__1light_views__1sample_views_Look, displacement: package_techniques__1light_views__1multi_view_bias_Displacement) -> f32 {
    return 2.0 * (displacement.rounding_m + displacement.snapped_m) / (seen.texel_m * max(seen.cosine, 0.01));
}

struct package_techniques__1light_views__1sample_views_ViewBatch {
    first: u32,
    count: u32,
    faces: u32,
    hardware_compare: u32,
    bias_scale: f32,
    slope_bias_texels: f32,
    kernel_texels: f32,
    light_radius: f32
}

struct package_techniques__1light_views__1sample_views_ViewSample {
    point: vec4f,
    weight: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32
}

@group(1) @binding(0)
var<uniform> package_techniques__1light_views__1sample_views_batch: package_techniques__1light_views__1sample_views_ViewBatch;

@group(1) @binding(1)
var<storage, read> package_techniques__1light_views__1sample_views_views: array<package__1light_map_space_LightViewGpu>;

@group(1) @binding(2)
var<storage, read> package_techniques__1light_views__1sample_views_samples: array<package_techniques__1light_views__1sample_views_ViewSample>;

struct package_techniques__1light_views__1sample_views_Look {
    asks_map: bool,
    lit: f32,
    view: u32,
    layer: u32,
    plane: package__1light_map_space_ReceiverPlane,
    distance: f32,
    cosine: f32,
    texel_m: f32
}

fn package_techniques__1light_views__1sample_views__1face_of(view: package__1light_map_space_LightViewGpu, towards: vec3f) -> u32 {
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

fn package_techniques__1light_views__1sample_views_look(receiver: package_frame_inputs_Receiver, index_in_batch: u32) -> package_techniques__1light_views__1sample_views_Look {
    var seen: package_techniques__1light_views__1sample_views_Look;
    let point = package_techniques__1light_views__1sample_views_samples[package_techniques__1light_views__1sample_views_batch.first + index_in_batch].point;
    let towards = point.xyz - point.w * receiver.pos_in_world;
    let height = dot(towards, receiver.normal_in_world);
    if height <= 0.0 {
        return seen;
    }
    let first_face = (package_techniques__1light_views__1sample_views_batch.first + index_in_batch) * package_techniques__1light_views__1sample_views_batch.faces;
    var face = 0u;
    if package_techniques__1light_views__1sample_views_batch.faces > 1u {
        face = package_techniques__1light_views__1sample_views__1face_of(package_techniques__1light_views__1sample_views_views[first_face], -towards);
        if face >= package_techniques__1light_views__1sample_views_batch.faces {
            seen.lit = 1.0;
            return seen;
        }
    }
    seen.view = first_face + face;
    seen.layer = index_in_batch * package_techniques__1light_views__1sample_views_batch.faces + face;
    let view = package_techniques__1light_views__1sample_views_views[seen.view];
    seen.texel_m = package__1light_map_space__2texel_width_m(view, receiver.pos_in_world);
    let bias_m = package__1light_map_bias__2automatic_bias_m(seen.texel_m, package_techniques__1light_views__1sample_views_batch.bias_scale);
    seen.plane = package__1light_map_space__1receiver_plane(view, receiver.pos_in_world, receiver.normal_in_world, bias_m);
    seen.plane.depth += view.depth_sign * package_techniques__1light_views__1sample_views_batch.bias_scale * package_techniques__1light_views__1sample_views_batch.slope_bias_texels * dot(abs(seen.plane.depth_per_uv), 1.0 / view.map_size);
    seen.distance = length(towards);
    seen.cosine = height / seen.distance;
    seen.lit = 1.0;
    seen.asks_map = all(seen.plane.uv >= vec2f(0.0)) && all(seen.plane.uv <= vec2f(1.0));
    return seen;
}

struct package_techniques__1light_views__1sample_views_Pixel {
    is_inside: bool,
    is_known: bool,
    receiver: package_frame_inputs_Receiver
}

fn package_techniques__1light_views__1sample_views__1load_pixel(id: vec2u) -> package_techniques__1light_views__1sample_views_Pixel {
    var pixel: package_techniques__1light_views__1sample_views_Pixel;
    pixel.is_inside = package_frame_inputs__1is_inside(id);
    if pixel.is_inside {
        pixel.receiver = package_frame_inputs__1load_receiver(id);
        pixel.is_known = pixel.receiver.is_background || !pixel.receiver.is_reached;
    }
    return pixel;
}

fn package_techniques__1light_views__1sample_views__1write_known(id: vec2u, pixel: package_techniques__1light_views__1sample_views_Pixel) {
    if pixel.is_inside && pixel.is_known {
        package_frame_inputs__1write_visibility(id, select(0.0, 1.0, pixel.receiver.is_background));
    }
}
