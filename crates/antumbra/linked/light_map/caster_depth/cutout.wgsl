// Linked from src/light_map/caster_depth/cutout.wesl by `cargo xtask shaders`: edit that, not this.

struct Cutout {
    factor: vec4f,
    cutoff: f32,
    stops_light: u32,
    texture_tints_only: u32,
    padding: u32
}

@group(1) @binding(0)
var<uniform> cutout: Cutout;

@group(1) @binding(1)
var surface: texture_2d<f32>;

@group(1) @binding(2)
var surface_sampler: sampler;

struct Varyings {
    @builtin(position)
    pos_in_clip: vec4f,
    @location(0)
    uv: vec2f
}

fn light_stopped(tinted: vec4f) -> f32 {
    let transmittance = 1.0 - tinted.a * (1.0 - tinted.rgb);
    return 1.0 - dot(transmittance, vec3f(0.2126, 0.7152, 0.0722));
}

fn is_hole(uv: vec2f) -> bool {
    var texel = textureSampleLevel(surface, surface_sampler, uv, 0.0);
    if cutout.texture_tints_only == 1u {
        texel.a = 1.0;
    }
    let value = texel * cutout.factor;
    let coverage = select(value.a, light_stopped(value), cutout.stops_light == 1u);
    return coverage < cutout.cutoff;
}

@vertex
fn vertex(@location(0) pos_in_object: vec3f, @location(1) world_from_object_x: vec4f, @location(2) world_from_object_y: vec4f, @location(3) world_from_object_z: vec4f, @location(4) world_from_object_w: vec4f, @location(5) uv: vec2f) -> Varyings {
    let world_from_object = mat4x4f(world_from_object_x, world_from_object_y, world_from_object_z, world_from_object_w);
    return Varyings(opaque_clip_from_object(pos_in_object, world_from_object), uv);
}

@fragment
fn fragment(varyings: Varyings) {
    if is_hole(varyings.uv) {
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
    padding: u32
}

@group(0) @binding(0)
var<uniform> opaque_caster_view: opaque_CasterView;

fn opaque_clip_from_object(pos_in_object: vec3f, world_from_object: mat4x4f) -> vec4f {
    let near = anchored_anchored(world_from_object, opaque_caster_view.anchor_in_world);
    return opaque_caster_view.clip_from_world * (near * vec4f(pos_in_object, 1.0));
}
