// The image: sum over the lights of unshadowed irradiance times visibility; then ambient light, emission, surfaces behind
// translucent ones, and a tone curve.
//
//   diffuse    Lambert
//   specular   GGX (Walter, Marschner, Li, Torrance, EGSR 2007) towards the light's most representative point (Karis,
//              "Real Shading in Unreal Engine 4", SIGGRAPH course 2013), scaled by the irradiance itself and never
//              brighter than the light's own mirror image
//   ambient    a sky above, a ground below; reflections of the same by Karis, "Physically Based Shading on Mobile",
//              2014
//   tones      AgX (Sobotka 2022) in the polynomial form of Wrensch, "Minimal AgX Implementation", 2023
//
// Visibility is only multiplied, never interpreted: shading is the same for every technique and for the ray tracer.

struct Frame {
    view_from_clip: mat4x4f,
    world_from_view: mat4x4f,
    eye_in_world: vec3f,
    has_layer_behind: u32,
}

// Storage instead of uniform buffers: software drivers specialise shaders for uniform values, here for every image.
@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var depth_image: texture_depth_2d;
@group(0) @binding(2) var surface_image: texture_2d<u32>;

@group(1) @binding(0) var<storage, read> light: Light;
@group(1) @binding(1) var<storage, read> light_points: array<vec4f>;
// Visibility mask of the image's size, or one texel for all pixels.
@group(1) @binding(2) var visibility_image: texture_2d<f32>;
// Input of coherent shading (bent.wgsl), of the image's size; or one texel of 1 for all pixels.
@group(1) @binding(3) var bent_image: texture_2d<f32>;

// Layer behind translucent surfaces, and the direct lighting of both layers.
@group(2) @binding(0) var behind_depth_image: texture_depth_2d;
@group(2) @binding(1) var behind_surface_image: texture_2d<u32>;
@group(2) @binding(2) var direct_image: texture_2d<f32>;
@group(2) @binding(3) var behind_direct_image: texture_2d<f32>;

// Reflectance of dielectrics along the normal: glass, plastics, stone.
const DIELECTRIC_F0 = 0.04;
// Minimum perceptual roughness; a smaller highlight would fall between pixels.
const SMOOTHEST = 0.09;
// Maximum radiance, within the range of half floats (65504).
const BRIGHTEST = 3e4;

// Radiance of the surroundings if the key light gives a white surface the radiance 2.5: a clear sky has about a seventh of
// the sun's. Blue above and warm below, so that umbrae have form and colour.
const SKY = vec3f(0.24, 0.31, 0.43);
const GROUND = vec3f(0.18, 0.16, 0.14);
// Additional ambient light from the camera's side, so that surfaces facing away from the sky keep their shape.
const FILL = 0.07;

const BACKGROUND_HORIZON = vec3f(0.90, 0.98, 1.08);
const BACKGROUND_ZENITH = vec3f(0.24, 0.40, 0.66);
const BACKGROUND_NADIR = vec3f(0.31, 0.33, 0.36);

struct Surface {
    base_color: vec3f,
    opacity: f32,
    normal: vec3f,
    metallic: f32,
    roughness: f32,
    transmission: f32,
    emissive: vec3f,
}

fn unit_from_octahedral(p: vec2f) -> vec3f {
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f());
    return normalize(vec3f(select(folded, p, z >= 0.0), z));
}

fn unpack_rgbe(packed: u32) -> vec3f {
    let rgbe = unpack4x8unorm(packed);
    return select(vec3f(), rgbe.rgb * exp2(round(rgbe.a * 255.0) - 128.0), packed != 0u);
}

fn unpack_surface(packed: vec4u) -> Surface {
    let color = unpack4x8unorm(packed.x);
    let material = unpack4x8unorm(packed.w);
    return Surface(
        color.rgb * color.rgb,
        color.a,
        unit_from_octahedral(unpack2x16snorm(packed.y)),
        material.x,
        max(material.y, SMOOTHEST),
        material.z,
        unpack_rgbe(packed.z),
    );
}

fn position_in_world(pixel: vec2u, depth: f32) -> vec3f {
    let size = vec2f(textureDimensions(depth_image));
    let ndc = (vec2f(pixel) + 0.5) / size * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = frame.view_from_clip * vec4f(ndc, depth, 1.0);
    return (frame.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

// Returns the direction of a pixel. It uses a point halfway to the near plane; any depth gives the same direction.
fn direction_from_eye(pixel: vec2u) -> vec3f {
    return normalize(position_in_world(pixel, 0.5) - frame.eye_in_world);
}

// Representative point of the light (Karis 2013), nearest to the mirrored ray as seen from the receiver, and the light's size
// over its distance.
struct Representative {
    to_light: vec3f,
    size_ratio: f32,
}

fn nearest_on_ball(to_center: vec3f, radius: f32, mirrored: vec3f) -> vec3f {
    let off_ray = dot(to_center, mirrored) * mirrored - to_center;
    return to_center + off_ray * saturate(radius / max(length(off_ray), 1e-6));
}

fn nearest_on_plane_shape(to_center: vec3f, mirrored: vec3f) -> vec3f {
    // Intersection of the mirrored ray and the light's plane; if there is none, the point nearest to the ray's far end.
    let slope = dot(mirrored, light.axis);
    let t = select(1e4 * length(to_center), dot(to_center, light.axis) / slope, slope < -1e-4);
    let offset = clamp(t, 0.0, 1e4 * length(to_center)) * mirrored - to_center;
    var p = vec2f(dot(offset, light.right), dot(offset, light.up));
    if light.kind == RECTANGLE {
        let half_size = vec2f(light.half_width, light.half_height);
        p = clamp(p, -half_size, half_size);
    } else {
        p *= saturate(light.half_width / max(length(p), 1e-6));
    }
    return to_center + light.right * p.x + light.up * p.y;
}

fn representative(x: vec3f, mirrored: vec3f) -> Representative {
    let to_center = light.center - x;
    var to_light: vec3f;
    var size: f32;
    switch light.kind {
        case SUN: {
            to_light = nearest_on_ball(-light.axis, light.half_width, mirrored);
            size = light.half_width;
        }
        case SPHERE: {
            to_light = nearest_on_ball(to_center, light.half_width, mirrored);
            size = light.half_width;
        }
        case ELLIPSOID: {
            to_light = nearest_on_ball(to_center, reach_along(light, mirrored), mirrored);
            size = pow(light.half_width * light.half_height * light.half_depth, 1.0 / 3.0);
        }
        case POINTS: {
            to_light = to_center;
            size = 0.0;
        }
        default: {
            to_light = nearest_on_plane_shape(to_center, mirrored);
            size = select(light.half_width, sqrt(light.half_width * light.half_height), light.kind == RECTANGLE);
        }
    }
    let light_distance = max(length(to_light), 1e-6);
    return Representative(to_light / light_distance, size / light_distance);
}

fn fresnel(f0: vec3f, cosine: f32) -> vec3f {
    return f0 + (1.0 - f0) * pow(1.0 - saturate(cosine), 5.0);
}

// Returns the fraction that is neither reflected by metal nor transmitted; metals transmit nothing.
fn diffuse_share(surface: Surface) -> f32 {
    return saturate(1.0 - surface.metallic - surface.transmission);
}

fn f0_of(surface: Surface) -> vec3f {
    return mix(vec3f(DIELECTRIC_F0), surface.base_color, surface.metallic);
}

// GGX with Smith's masking in the form of Karis 2013, without Fresnel: reflected radiance over irradiance.
fn ggx(alpha: f32, widened_alpha: f32, n_dot_h: f32, n_dot_l: f32, n_dot_v: f32) -> f32 {
    let a2 = alpha * alpha;
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    // Ratio of the peaks of the distribution and its widened form: spreads the energy over the light.
    let narrowing = alpha / widened_alpha;
    let distribution = a2 / (PI * d * d) * narrowing * narrowing;
    let k = 0.5 * alpha;
    let masking = (n_dot_l * (1.0 - k) + k) * (n_dot_v * (1.0 - k) + k);
    return distribution / (4.0 * masking);
}

// Returns the irradiance of the smooth normal, darkened where triangles around the vertex face away.
fn coherent_irradiance(x: vec3f, normal: vec3f, bent: f32) -> f32 {
    let smooth_irradiance = irradiance(light, x, normal);
    let facing = facing_irradiance(light, x);
    if bent >= 1.0 || facing <= 0.0 {
        return smooth_irradiance;
    }
    return facing * coherent_cosine(smooth_irradiance / facing, bent);
}

// Returns the strength of a spot towards `x`, as in KHR_lights_punctual.
fn cone_strength(x: vec3f) -> f32 {
    let cosine = dot(normalize(x - light.center), light.axis);
    let falloff = (cosine - light.cone_outer_cosine) / max(light.cone_inner_cosine - light.cone_outer_cosine, 1e-3);
    let strength = saturate(falloff);
    return strength * strength;
}

fn lit_radiance(surface: Surface, x: vec3f, bent: f32) -> vec3f {
    let normal = surface.normal;
    let to_eye = normalize(frame.eye_in_world - x);
    let received = coherent_irradiance(x, normal, bent);
    let albedo = surface.base_color * diffuse_share(surface);
    let diffuse = albedo / PI * received * light.radiance;

    let nearest = representative(x, reflect(-to_eye, normal));
    let half_way = normalize(nearest.to_light + to_eye);
    let alpha = surface.roughness * surface.roughness;
    // Karis 2013, "alpha prime".
    let widened_alpha = saturate(alpha + nearest.size_ratio / 3.0);
    let reflected = ggx(
        alpha,
        widened_alpha,
        saturate(dot(normal, half_way)),
        saturate(dot(normal, nearest.to_light)),
        saturate(dot(normal, to_eye)),
    );
    // A list of points has no mirror image as a limit.
    let mirror_image = select(1.0, BRIGHTEST, light.kind == POINTS);
    let specular = fresnel(f0_of(surface), dot(to_eye, half_way)) * min(reflected * received, mirror_image);
    return (diffuse + specular * light.radiance) * cone_strength(x);
}

fn bent_at(pixel: vec2u) -> f32 {
    return textureLoad(bent_image, min(pixel, textureDimensions(bent_image) - 1u), 0).r;
}

fn visibility_at(pixel: vec2u) -> vec3f {
    let last = textureDimensions(visibility_image) - 1u;
    let visibility = textureLoad(visibility_image, min(pixel, last), 0).rgb;
    return select(vec3f(visibility.r), visibility, light.is_tinted == 1u);
}

fn surroundings(direction: vec3f) -> vec3f {
    return mix(GROUND, SKY, smoothstep(-1.0, 1.0, direction.y));
}

// Returns the fitted integral of GGX over uniform surroundings (Karis 2014).
fn ambient_reflectance(f0: vec3f, roughness: f32, n_dot_v: f32) -> vec3f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    let scale_bias = vec2f(-1.04, 1.04) * a + r.zw;
    return f0 * scale_bias.x + scale_bias.y;
}

fn ambient_radiance(surface: Surface, from_eye: vec3f) -> vec3f {
    let n_dot_v = saturate(-dot(surface.normal, from_eye));
    let albedo = surface.base_color * diffuse_share(surface);
    let mirrored = reflect(from_eye, surface.normal);
    return albedo * (surroundings(surface.normal) + FILL * n_dot_v)
        + ambient_reflectance(f0_of(surface), surface.roughness, n_dot_v) * surroundings(mirrored)
        + surface.emissive;
}

fn background_radiance(from_eye: vec3f) -> vec3f {
    let up = from_eye.y;
    let beyond = select(BACKGROUND_NADIR, BACKGROUND_ZENITH, up > 0.0);
    return mix(BACKGROUND_HORIZON, beyond, smoothstep(0.0, 0.75, sqrt(abs(up)) * 0.9));
}

// Returns the radiance of a layer towards the eye: the background if it has no geometry.
fn layer_radiance(surface: Surface, has_geometry: bool, direct: vec3f, from_eye: vec3f) -> vec3f {
    if !has_geometry {
        return background_radiance(from_eye);
    }
    return ambient_radiance(surface, from_eye) + direct;
}

// Composites a surface over the one behind: blended by opacity; transmission is tinted by base colour.
fn over(surface: Surface, front: vec3f, behind: vec3f) -> vec3f {
    return surface.opacity * (front + surface.transmission * surface.base_color * behind)
        + (1.0 - surface.opacity) * behind;
}

// Conversion to AgX's primaries and back (Wrensch 2023).
const AGX_FROM_LINEAR = mat3x3f(
    vec3f(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
    vec3f(0.0784335999999992, 0.878468636469772, 0.0784336),
    vec3f(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
);
const LINEAR_FROM_AGX = mat3x3f(
    vec3f(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
    vec3f(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
    vec3f(-0.0990297440797205, -0.0989611768448433, 1.15107367264116),
);
// Range of exposures of the curve, as powers of two.
const AGX_DARKEST = -12.47393;
const AGX_BRIGHTEST = 4.026069;
// Sobotka's "punchy" look with less saturation than its 1.4, so that shadows of strong colours do not turn neon.
const AGX_POWER = 1.35;
const AGX_SATURATION = 1.25;

fn agx_contrast(x: vec3f) -> vec3f {
    let x2 = x * x;
    let x4 = x2 * x2;
    return 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
}

// Converts linear scene radiance to linear display values in [0, 1].
fn tone_mapped(radiance: vec3f) -> vec3f {
    let exposure = log2(max(AGX_FROM_LINEAR * radiance, vec3f(1e-10)));
    let encoded = saturate((exposure - AGX_DARKEST) / (AGX_BRIGHTEST - AGX_DARKEST));
    let punchy = pow(max(agx_contrast(encoded), vec3f()), vec3f(AGX_POWER));
    let luma = dot(punchy, vec3f(0.2126, 0.7152, 0.0722));
    let saturated = luma + AGX_SATURATION * (punchy - luma);
    // The curve assumes a display with a power of 2.2.
    return pow(saturate(LINEAR_FROM_AGX * saturated), vec3f(2.2));
}

@vertex
fn vertex_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Returns one light's radiance from each pixel's surface; blended additively.
@fragment
fn fragment_light(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let depth = textureLoad(depth_image, pixel, 0);
    if depth == 0.0 {
        discard;
    }
    // Pixels in full shadow skip shading, because highlights are the most expensive part of the image.
    let visibility = visibility_at(pixel);
    if all(visibility == vec3f()) {
        discard;
    }
    let surface = unpack_surface(textureLoad(surface_image, pixel, 0));
    let radiance = lit_radiance(surface, position_in_world(pixel, depth), bent_at(pixel)) * visibility;
    return vec4f(clamp(radiance, vec3f(), vec3f(BRIGHTEST)), 1.0);
}

@fragment
fn fragment_picture(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let from_eye = direction_from_eye(pixel);
    let surface = unpack_surface(textureLoad(surface_image, pixel, 0));
    let has_geometry = textureLoad(depth_image, pixel, 0) > 0.0;
    var radiance = layer_radiance(surface, has_geometry, textureLoad(direct_image, pixel, 0).rgb, from_eye);
    if has_geometry && frame.has_layer_behind == 1u && (surface.opacity < 1.0 || surface.transmission > 0.0) {
        let behind = layer_radiance(
            unpack_surface(textureLoad(behind_surface_image, pixel, 0)),
            textureLoad(behind_depth_image, pixel, 0) > 0.0,
            textureLoad(behind_direct_image, pixel, 0).rgb,
            from_eye,
        );
        radiance = over(surface, radiance, behind);
    }
    return vec4f(tone_mapped(radiance), 1.0);
}
