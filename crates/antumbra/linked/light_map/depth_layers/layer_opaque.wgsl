// Linked from src/light_map/depth_layers/layer_opaque.wesl by `cargo xtask shaders`: edit that, not this.

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> @builtin(position) vec4f {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return opaque_clip_from_object(pos_in_object, world_from_object);
}

@fragment
fn nearest(@builtin(position) position: vec4f) -> @location(0) vec2f {
    return layer_gradient_of(position.z) / layer_GRADIENT_UNIT;
}

@fragment
fn next(@builtin(position) position: vec4f) -> @location(0) vec2f {
    let gradient = layer_gradient_of(position.z);
    if layer_is_peeled(position) {
        discard;
    }
    return gradient / layer_GRADIENT_UNIT;
}

@fragment
fn next_depth(@builtin(position) position: vec4f) {
    if layer_is_peeled(position) {
        discard;
    }
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

struct opaque_CasterView {
    clip_from_world: mat4x4f,
    anchor_in_world: vec3f,
    light_point: u32,
    color_weights: vec3f,
    padding: u32
}

@group(0) @binding(0)
var<uniform> opaque_caster_view: opaque_CasterView;

fn opaque_clip_from_object(pos_in_object: vec3f, world_from_object: mat4x4f) -> vec4f {
    let near = anchored_anchored(world_from_object, opaque_caster_view.anchor_in_world);
    return opaque_caster_view.clip_from_world * (near * vec4f(pos_in_object, 1.0));
}

@group(2) @binding(0)
var layer_nearer_layer: texture_depth_2d;

const layer_SAME_DEPTH = 1e-6;

fn layer_is_peeled(position: vec4f) -> bool {
    let nearer = textureLoad(layer_nearer_layer, vec2u(position.xy), 0);
    return position.z >= nearer * (1.0 - layer_SAME_DEPTH);
}

fn layer_gradient_of(depth: f32) -> vec2f {
    let gradient = vec2f(dpdx(depth), dpdy(depth));
    return select(vec2f(), gradient, depth < 1.0);
}

const layer_GRADIENT_UNIT = 1.0 / 1024.0;
