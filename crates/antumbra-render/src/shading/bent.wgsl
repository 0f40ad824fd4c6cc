// Upper limit of a light's shading where triangles around a vertex face away: the minimum irradiance of these triangles per
// vertex, relative to a surface that faces the light, interpolated over the image.
// Source: Sintorn, Eisemann, Assarsson 2008, section 4.3, with an area light's irradiance in the cosine's place.
//
// Appended to receivers.wgsl and irradiance.wgsl.

@group(2) @binding(0) var<uniform> light: Light;
@group(2) @binding(1) var<storage, read> light_points: array<vec4f>;
// Offset of each vertex's normals and the end of the last ones; then the normals.
@group(2) @binding(2) var<storage, read> vertex_faces: array<u32>;

struct BentCorner {
    @builtin(position) position: vec4f,
    @location(0) bent: f32,
    @location(1) uv: vec2f,
    @location(2) alpha: f32,
}

fn min_irradiance(x: vec3f, vertex: u32, to_world: mat3x3f, side: f32) -> f32 {
    var least = facing_irradiance(light, x);
    let end = min(vertex_faces[vertex + 1u], arrayLength(&vertex_faces));
    for (var i = vertex_faces[vertex]; i < end; i += 3u) {
        let normal_in_object =
            bitcast<vec3f>(vec3u(vertex_faces[i], vertex_faces[i + 1u], vertex_faces[i + 2u]));
        let normal = side * normalize(transform_normal(to_world, normal_in_object));
        least = min(least, irradiance(light, x, normal));
    }
    return least;
}

@vertex
fn vertex_bent(@builtin(vertex_index) corner_index: u32, @builtin(instance_index) instance: u32) -> BentCorner {
    let corner = pulled_corner(corner_index, instance);
    let to_world = world_from_object[instance];
    let to_world_linear = mat3x3f(to_world[0].xyz, to_world[1].xyz, to_world[2].xyz);
    let vertex = indices[corner_index];
    let x = (to_world * vec4f(position_in_object(vertex), 1.0)).xyz;
    // The back of a sheet is shaded with opposite normals.
    let first = corner_index - corner_index % 3u;
    let a = position_in_object(indices[first]);
    let front = cross(
        position_in_object(indices[first + 1u]) - a,
        position_in_object(indices[first + 2u]) - a,
    );
    let is_front = dot(transform_normal(to_world_linear, front), corner.geometric_normal) >= 0.0;
    let least = min_irradiance(x, vertex, to_world_linear, select(-1.0, 1.0, is_front));
    let bent = least / max(facing_irradiance(light, x), 1e-30);
    return BentCorner(corner.position, bent, corner.uv, unmapped_color(corner).a);
}

@fragment
fn fragment_bent_solid(corner: BentCorner) -> @location(0) vec4f {
    return vec4f(corner.bent);
}

@fragment
fn fragment_bent_masked(corner: BentCorner) -> @location(0) vec4f {
    let alpha = textureSampleLevel(base_color_texture, level_0_sampler, corner.uv, 0.0).a;
    if corner.alpha * alpha < material.alpha_cutoff {
        discard;
    }
    return vec4f(corner.bent);
}
