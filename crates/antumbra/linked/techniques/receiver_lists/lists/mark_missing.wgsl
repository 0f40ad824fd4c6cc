// Linked from src/techniques/receiver_lists/lists/mark_missing.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn mark_missing(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    for (var i = id.x; i < missing_missing_count(); i += 64u * workgroups.x) {
        let pixel = missing_missing_pixel(i);
        bindings_places[pixel.y * inputs_receiver_view.size_px.x + pixel.x] = vec2u(settings_MISSING, 0u);
    }
}

@group(0) @binding(7)
var<storage, read> missing_missing: array<u32>;

fn missing_missing_count() -> u32 {
    return min(missing_missing[0], arrayLength(&missing_missing) - 1u);
}

fn missing_missing_pixel(i: u32) -> vec2u {
    let packed = missing_missing[i + 1u];
    return vec2u(packed & 65535u, packed >> 16u);
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

@group(1) @binding(3)
var<storage, read_write> bindings_places: array<vec2u>;

const settings_MISSING = 4294967294u;
