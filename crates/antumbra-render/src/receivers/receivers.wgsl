// The first surface behind each pixel's centre: depth, exact geometric normal, and inputs of shading.
//
// One pass with 32 bytes of colour per pixel, WebGPU's default limit:
//   depth             Depth32Float  reversed, infinite far
//   geometric_normal  Rgba32Float   xyz unit, world space, on the camera's side; w 1 where there is geometry
//   surface           Rgba32Uint    see `pack_surface`
//
// The geometric normal is the triangle's own: the vertex shader fetches all three corners of its triangle, so every corner
// computes the same cross product. Screen-space derivatives of position lose half of the digits, which a bias at grazing light
// needs.

struct View {
    view_from_world: mat4x4f,
    clip_from_view: mat4x4f,
    eye_in_world: vec3f,
    padding: f32,
}

struct Material {
    base_color: vec4f,
    emissive: vec3f,
    metallic: f32,
    roughness: f32,
    alpha_cutoff: f32,
    transmission: f32,
    flags: u32,
}

@group(0) @binding(0) var<uniform> view: View;

@group(1) @binding(0) var<storage, read> positions: array<f32>;
@group(1) @binding(1) var<storage, read> normals: array<f32>;
@group(1) @binding(2) var<storage, read> uvs: array<vec2f>;
@group(1) @binding(3) var<storage, read> colors: array<vec4f>;
@group(1) @binding(4) var<storage, read> indices: array<u32>;
@group(1) @binding(5) var<storage, read> world_from_object: array<mat4x4f>;
@group(1) @binding(6) var<uniform> material: Material;
@group(1) @binding(7) var base_color_texture: texture_2d<f32>;
@group(1) @binding(8) var level_0_sampler: sampler;
@group(1) @binding(9) var smooth_sampler: sampler;

const HAS_UVS = 1u;
const HAS_COLORS = 2u;
const IS_BLENDED = 4u;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) geometric_normal: vec3f,
    @location(1) shading_normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
}

struct Surface {
    @location(0) geometric_normal: vec4f,
    @location(1) packed: vec4u,
}

fn position_in_object(vertex: u32) -> vec3f {
    return vec3f(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
}

fn normal_in_object(vertex: u32) -> vec3f {
    return vec3f(normals[3u * vertex], normals[3u * vertex + 1u], normals[3u * vertex + 2u]);
}

fn largest_component(v: vec3f) -> f32 {
    let a = abs(v);
    return max(a.x, max(a.y, a.z));
}

// Returns the unit cross product, or zero for a triangle without area. Edges are scaled first, so that squares stay in range
// for triangles from a micrometre to a thousand kilometres.
fn unit_cross(a: vec3f, b: vec3f) -> vec3f {
    let n = cross(a / max(largest_component(a), 1e-37), b / max(largest_component(b), 1e-37));
    let scale = largest_component(n);
    return select(vec3f(), normalize(n / max(scale, 1e-37)), scale > 0.0);
}

// Transforms by the inverse transpose up to a positive factor: the cofactors, with the determinant's sign.
fn transform_normal(to_world: mat3x3f, normal: vec3f) -> vec3f {
    let cofactors = mat3x3f(
        cross(to_world[1], to_world[2]),
        cross(to_world[2], to_world[0]),
        cross(to_world[0], to_world[1]),
    );
    let determinant = dot(to_world[0], cofactors[0]);
    return (cofactors * normal) * select(1.0, -1.0, determinant < 0.0);
}

// Octahedral map of a unit vector. Meyer, Süßmuth, Sußner, Stamminger, Greiner, "On Floating-Point Normal Vectors", EGSR 2010.
fn octahedral_from_unit(n: vec3f) -> vec2f {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f());
    return select(folded, p, n.z >= 0.0);
}

// Packs a colour with a shared exponent. Ward, "Real Pixels", Graphics Gems II, 1991.
fn pack_rgbe(color: vec3f) -> u32 {
    let largest = largest_component(color);
    if !(largest > 1e-9) {
        return 0u;
    }
    let exponent = ceil(log2(largest));
    return pack4x8unorm(vec4f(color / exp2(exponent), (exponent + 128.0) / 255.0));
}

// Packs a surface. x: base colour as square roots, close to perceptual steps, and opacity; y: shading normal, octahedral;
// z: emission, shared exponent; w: metallic, roughness, transmission.
fn pack_surface(base_color: vec4f, shading_normal: vec3f) -> vec4u {
    return vec4u(
        pack4x8unorm(vec4f(sqrt(max(base_color.rgb, vec3f())), base_color.a)),
        pack2x16snorm(octahedral_from_unit(shading_normal)),
        pack_rgbe(material.emissive),
        pack4x8unorm(vec4f(material.metallic, material.roughness, material.transmission, 0.0)),
    );
}

fn unmapped_color(corner: Corner) -> vec4f {
    return material.base_color * corner.color;
}

// Returns the smooth shading normal of the first hit, on the side of the geometric normal.
fn visible_shading_normal(corner: Corner) -> vec3f {
    let length_squared = dot(corner.shading_normal, corner.shading_normal);
    if !(length_squared > 0.0) {
        return corner.geometric_normal;
    }
    let normal = corner.shading_normal * inverseSqrt(length_squared);
    return select(-normal, normal, dot(normal, corner.geometric_normal) >= 0.0);
}

fn shaded(corner: Corner, color: vec4f) -> Surface {
    let opacity = select(1.0, saturate(color.a), (material.flags & IS_BLENDED) != 0u);
    return Surface(
        vec4f(corner.geometric_normal, 1.0),
        pack_surface(vec4f(color.rgb, opacity), visible_shading_normal(corner)),
    );
}

fn pulled_corner(corner_index: u32, instance: u32) -> Corner {
    let to_world = world_from_object[instance];
    let to_world_linear = mat3x3f(to_world[0].xyz, to_world[1].xyz, to_world[2].xyz);
    let first = corner_index - corner_index % 3u;
    let a = position_in_object(indices[first]);
    let edge_ab = to_world_linear * (position_in_object(indices[first + 1u]) - a);
    let edge_ac = to_world_linear * (position_in_object(indices[first + 2u]) - a);
    let normal = unit_cross(edge_ab, edge_ac);
    let to_eye = view.eye_in_world - (to_world * vec4f(a, 1.0)).xyz;

    let vertex = indices[corner_index];
    let pos_in_world = to_world * vec4f(position_in_object(vertex), 1.0);
    var corner: Corner;
    corner.position = view.clip_from_view * (view.view_from_world * vec4f(pos_in_world.xyz, 1.0));
    corner.geometric_normal = select(-normal, normal, dot(normal, to_eye) >= 0.0);
    corner.shading_normal = transform_normal(to_world_linear, normal_in_object(vertex));
    corner.uv = vec2f();
    if (material.flags & HAS_UVS) != 0u {
        corner.uv = uvs[vertex];
    }
    corner.color = vec4f(1.0);
    if (material.flags & HAS_COLORS) != 0u {
        corner.color = colors[vertex];
    }
    return corner;
}

@vertex
fn vertex_pull(@builtin(vertex_index) corner_index: u32, @builtin(instance_index) instance: u32) -> Corner {
    return pulled_corner(corner_index, instance);
}

// Samples the base colour. If coordinates are constant over the pixels (a mesh without any, or one colour per triangle), an
// anisotropic sampler has no ellipse to filter, and Mesa 25.0 returns black; the texel of the largest level is used instead.
fn base_color_texel(uv: vec2f) -> vec4f {
    let filtered = textureSample(base_color_texture, smooth_sampler, uv);
    let at_once = textureSampleLevel(base_color_texture, level_0_sampler, uv, 0.0);
    return select(filtered, at_once, all(fwidth(uv) == vec2f()));
}

@fragment
fn fragment_solid(corner: Corner) -> Surface {
    return shaded(corner, unmapped_color(corner) * base_color_texel(corner.uv));
}

// Keeps fragments whose bilinear alpha of the largest level reaches the cutoff, as the definition of visibility does.
@fragment
fn fragment_masked(corner: Corner) -> Surface {
    let texel = base_color_texel(corner.uv);
    let alpha = textureSampleLevel(base_color_texture, level_0_sampler, corner.uv, 0.0).a;
    if unmapped_color(corner).a * alpha < material.alpha_cutoff {
        discard;
    }
    return shaded(corner, unmapped_color(corner) * texel);
}
