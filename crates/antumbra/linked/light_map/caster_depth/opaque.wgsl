// Linked from src/light_map/caster_depth/opaque.wesl by `cargo xtask shaders`: edit that, not this.

struct CasterView {
    clip_from_world: mat4x4f
}

@group(0) @binding(0)
var<uniform> caster_view: CasterView;

fn clip_from_object(pos_in_object: vec3f, world_from_object: mat4x4f) -> vec4f {
    return caster_view.clip_from_world * (world_from_object * vec4f(pos_in_object, 1.0));
}

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f) -> @builtin(position) vec4f {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return clip_from_object(pos_in_object, world_from_object);
}
