// Linked from src/techniques/receiver_lists/scatter.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(8, 8)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if !package_frame_inputs__1is_inside(id.xy) {
        return;
    }
    let pixel_index = id.y * package_frame_inputs__1receiver_view.size_px.x + id.x;
    let place = package_techniques__1receiver_lists_lists_places[pixel_index];
    if place.x != package_techniques__1receiver_lists_settings_NOWHERE {
        package_techniques__1receiver_lists_lists_list[atomicLoad(&package_techniques__1receiver_lists_lists_counts[place.x]) + place.y] = pixel_index;
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

fn package_frame_inputs__1is_inside(pixel: vec2u) -> bool {
    return all(pixel < package_frame_inputs__1receiver_view.size_px);
}

@group(1) @binding(2)
var<storage, read_write> package_techniques__1receiver_lists_lists_counts: array<atomic<u32>>;

@group(1) @binding(3)
var<storage, read_write> package_techniques__1receiver_lists_lists_places: array<vec2u>;

@group(1) @binding(4)
var<storage, read_write> package_techniques__1receiver_lists_lists_list: array<u32>;

const package_techniques__1receiver_lists_settings_NOWHERE = 4294967295u;
