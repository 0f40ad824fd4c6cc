// Shader of the host: depth and normals first, then colour at equal depth.

struct Globals {
    clip_from_world: mat4x4f,
    // Scale and offset of packed vertices.
    packed_scale: vec4f,
    packed_offset: vec4f,
    // Origin of the view in the window.
    origin_px: vec2u,
}

struct Light {
    // Position (w = 1), or direction towards the light (w = 0).
    place: vec4f,
    color: vec4f,
}

@group(0) @binding(0) var<uniform> globals: Globals;
@group(0) @binding(1) var leaf: texture_2d<f32>;
@group(0) @binding(2) var leaf_sampler: sampler;
@group(1) @binding(0) var<uniform> lights: array<Light, 8>;
// Visibility masks: one layer per light, of the view's size; 1 lit, 0 in shadow.
@group(1) @binding(1) var masks: texture_2d_array<f32>;

struct Instance {
    // World-from-object matrix, 3 × 4.
    @location(4) row_x: vec4f,
    @location(5) row_y: vec4f,
    @location(6) row_z: vec4f,
    // Colour; fragments with an alpha below w are discarded.
    @location(7) color: vec4f,
}

struct Varyings {
    @builtin(position) @invariant clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) @interpolate(flat) color: vec4f,
}

fn place(position: vec3f, normal: vec3f, uv: vec2f, instance: Instance) -> Varyings {
    let object_from_world_transposed = mat3x4f(instance.row_x, instance.row_y, instance.row_z);
    let world = vec4f(position, 1.0) * object_from_world_transposed;
    // Matrices are rigid here, so normals need no inverse transpose.
    let normal_in_world = vec4f(normal, 0.0) * object_from_world_transposed;
    return Varyings(globals.clip_from_world * vec4f(world, 1.0), world, normal_in_world, uv, instance.color);
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    instance: Instance,
) -> Varyings {
    return place(position, normal, uv, instance);
}

@vertex
fn vertex_packed(@location(0) position: vec4f, @location(1) normal: vec4f, instance: Instance) -> Varyings {
    let unpacked = position.xyz * globals.packed_scale.xyz + globals.packed_offset.xyz;
    return place(unpacked, normal.xyz, vec2f(0.0), instance);
}

// Writes the geometric normal of the triangle beside depth. Shadows work without it, but silhouettes and features a few pixels
// wide then get their neighbours' normals.
@fragment
fn fragment_depth(in: Varyings) -> @location(0) vec4f {
    let normal = normalize(cross(dpdy(in.world), dpdx(in.world)));
    if textureSample(leaf, leaf_sampler, in.uv).a < in.color.w {
        discard;
    }
    return vec4f(normal, 0.0);
}

@fragment
fn fragment_color(in: Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let normal = normalize(select(-in.normal, in.normal, is_front));
    let pixel = vec2u(in.clip.xy) - globals.origin_px;
    // A little ambient light.
    var sum = vec3f(0.03);
    for (var i = 0u; i < 8u; i++) {
        let to_light = lights[i].place.xyz - lights[i].place.w * in.world;
        let facing = max(dot(normal, normalize(to_light)), 0.0);
        let visibility = textureLoad(masks, pixel, i, 0).x;
        sum += visibility * facing * lights[i].color.rgb / mix(1.0, dot(to_light, to_light), lights[i].place.w);
    }
    return vec4f(in.color.rgb * sum, 1.0);
}
