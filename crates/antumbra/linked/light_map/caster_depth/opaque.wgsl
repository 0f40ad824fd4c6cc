// Linked from src/light_map/caster_depth/opaque.wesl by `cargo xtask shaders`: edit that, not this.

struct CasterView {
    clip_from_world: mat4x4f,
    anchor_in_world: vec3f,
    light_point: u32,
    color_weights: vec3f,
    padding: u32
}

@group(0) @binding(0)
var<uniform> caster_view: CasterView;

fn clip_from_object(pos_in_object: vec3f, world_from_object: mat4x4f) -> vec4f {
    let near = anchored_anchored(world_from_object, caster_view.anchor_in_world);
    return caster_view.clip_from_world * (near * vec4f(pos_in_object, 1.0));
}

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> @builtin(position) vec4f {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return clip_from_object(pos_in_object, world_from_object);
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}
