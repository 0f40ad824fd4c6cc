// Linked from src/mask/accumulation/accumulate.wesl by `cargo xtask shaders`: edit that, not this.

struct AccumulationFrame {
    generation: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(1) @binding(0)
var<uniform> accumulation: AccumulationFrame;

@group(1) @binding(1)
var<storage, read_write> state: array<u32>;

@group(1) @binding(2)
var<storage, read_write> means: array<f32>;

@group(1) @binding(3)
var<storage, read_write> seen: array<vec2u>;

const STATE_FINGERPRINT = 0u;

const STATE_LAST_FINGERPRINT = 1u;

const STATE_LAST_GENERATION = 2u;

fn has_changed() -> bool {
    return state[STATE_FINGERPRINT] != state[STATE_LAST_FINGERPRINT] || state[STATE_LAST_GENERATION] != accumulation.generation;
}

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy;
    if !inputs_is_inside(pixel) {
        return;
    }
    let size_px = inputs_receiver_view.size_px;
    let index = pixel.y * size_px.x + pixel.x;
    let place = inputs_place_bits(pixel);
    var frames = 0u;
    if !has_changed() && seen[index].x == place {
        frames = seen[index].y;
    }
    for (var layer = 0u; layer < inputs_receiver_view.mask_layers; layer++) {
        let at = layer * size_px.x * size_px.y + index;
        var mean = inputs_load_mask(pixel, layer);
        if frames > 0u {
            mean = means[at] + (mean - means[at]) / f32(frames + 1u);
        }
        means[at] = mean;
        inputs_store_mask(pixel, layer, mean);
    }
    seen[index] = vec2u(place, frames + 1u);
}

@compute @workgroup_size(1)
fn remember() {
    state[STATE_LAST_FINGERPRINT] = state[STATE_FINGERPRINT];
    state[STATE_LAST_GENERATION] = accumulation.generation;
    state[STATE_FINGERPRINT] = 0u;
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

@group(0) @binding(2)
var inputs_receiver_depth: texture_2d<f32>;

@group(0) @binding(4)
var inputs_mask: texture_storage_2d_array<r32float, read_write>;

const inputs_QUOTIENT_ROUNDING = 1e-5;

fn inputs_store_mask(pixel: vec2u, layer: u32, visibility: f32) {
    let is_one = visibility > 1.0 && visibility < 1.0 + inputs_QUOTIENT_ROUNDING;
    textureStore(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer, vec4f(select(visibility, 1.0, is_one)));
}

fn inputs_load_mask(pixel: vec2u, layer: u32) -> f32 {
    return textureLoad(inputs_mask, inputs_receiver_view.mask_origin_px + pixel, layer).x;
}

fn inputs_is_inside(pixel: vec2u) -> bool {
    return all(pixel < inputs_receiver_view.size_px);
}

fn inputs_are_points() -> bool {
    return inputs_receiver_view.are_points == 1u;
}

fn inputs_place_bits(pixel: vec2u) -> u32 {
    let texel = bitcast<vec4u>(textureLoad(inputs_receiver_depth, inputs_receiver_view.origin_px + pixel, 0));
    if !inputs_are_points() {
        return texel.x;
    }
    return (((texel.x * 747796405u) ^ texel.y) * 2891336453u) ^ texel.z;
}
