// Unshadowed irradiance of a light of unit radiance at a point with a normal. Functions only: the including module has to
// declare `light_points`, the positions of a list of points in xyz.
//
//   rectangle, disk   Lambert 1760 for polygons, as in Baum, Rushmeier, Winget, "Improving Radiosity Solutions Through
//                     the Use of Analytically Determined Form-Factors", SIGGRAPH 1989, clipped at the horizon; exact
//                     for the rectangle. A disk is a regular polygon of the same area: within 0.4 % of exact.
//   sphere, sun       Snyder, "Area Light Sources for Real-Time Graphics", MSR-TR-96-11, 1996, in the form of Lagarde
//                     and de Rousiers, "Moving Frostbite to PBR", SIGGRAPH course 2014: exact, the horizon included.
//   ellipsoid         Glowing volume with the strength of a sphere of the same volume. Its extent along the normal
//                     determines how far it rises above the horizon. Exact from afar, within 6 % at two of its largest
//                     radii.
//   points            Mean of the inverse square over the list.

const RECTANGLE = 0u;
const DISK = 1u;
const SPHERE = 2u;
const ELLIPSOID = 3u;
const SUN = 4u;
const POINTS = 5u;

const PI = 3.14159265;

struct Light {
    center: vec3f,
    kind: u32,
    right: vec3f,
    // Rectangle: half the width. Disk, sphere: radius. Ellipsoid: radius along right. Sun: tangent of half its angle.
    half_width: f32,
    up: vec3f,
    // Rectangle: half the height. Ellipsoid: radius along up.
    half_height: f32,
    axis: vec3f,
    // Ellipsoid: radius along the axis.
    half_depth: f32,
    // Radiance, linear RGB; radiant intensity of a point.
    radiance: vec3f,
    point_count: u32,
    // Whether visibility has three channels instead of one.
    is_tinted: u32,
    // Cosines of a spot's inner and outer angle; −2 and −3 without a cone.
    cone_inner_cosine: f32,
    cone_outer_cosine: f32,
    padding: u32,
}

// Polygon boundary clipped at the horizon, summed edge by edge.
struct HorizonClip {
    sum: f32,
    is_crossed: bool,
    // Points where the boundary goes below the horizon and where it comes up again.
    leaves: vec3f,
    enters: vec3f,
}

// Lambert's integral of an edge: the angle that it subtends times the cosine between the normal and the normal of the edge's
// plane through the receiver. `p` and `q` are relative to the receiver and need not be unit.
fn edge_integral(p: vec3f, q: vec3f, normal: vec3f) -> f32 {
    let c = cross(p, q - p);
    let length_c = length(c);
    if length_c == 0.0 {
        return 0.0;
    }
    return atan2(length_c, dot(p, q)) * dot(normal, c) / length_c;
}

fn add_edge(clip: ptr<function, HorizonClip>, a: vec3f, b: vec3f, normal: vec3f) {
    let height_a = dot(a, normal);
    let height_b = dot(b, normal);
    if height_a <= 0.0 && height_b <= 0.0 {
        return;
    }
    let at_horizon = a + (b - a) * (height_a / (height_a - height_b));
    var p = a;
    var q = b;
    if height_a <= 0.0 {
        p = at_horizon;
        (*clip).enters = p;
        (*clip).is_crossed = true;
    }
    if height_b <= 0.0 {
        q = at_horizon;
        (*clip).leaves = q;
        (*clip).is_crossed = true;
    }
    (*clip).sum += edge_integral(p, q, normal);
}

fn closed_sum(clip: HorizonClip, normal: vec3f) -> f32 {
    var sum = clip.sum;
    if clip.is_crossed {
        sum += edge_integral(clip.leaves, clip.enters, normal);
    }
    return 0.5 * abs(sum);
}

fn rectangle_irradiance(light: Light, to_center: vec3f, normal: vec3f) -> f32 {
    let right = light.right * light.half_width;
    let up = light.up * light.half_height;
    var clip = HorizonClip();
    add_edge(&clip, to_center - right - up, to_center + right - up, normal);
    add_edge(&clip, to_center + right - up, to_center + right + up, normal);
    add_edge(&clip, to_center + right + up, to_center - right + up, normal);
    add_edge(&clip, to_center - right + up, to_center - right - up, normal);
    return closed_sum(clip, normal);
}

// Number of corners of the polygon that approximates a disk, and its circumradius for the disk's area, relative to the disk's
// radius: sqrt(2 pi / (n sin(2 pi / n))).
const DISK_CORNERS = 24;
const DISK_CORNER_RADIUS = 1.0057411;

fn disk_irradiance(light: Light, to_center: vec3f, normal: vec3f) -> f32 {
    let radius = DISK_CORNER_RADIUS * light.half_width;
    var clip = HorizonClip();
    var last = to_center + light.right * radius;
    for (var i = 1; i <= DISK_CORNERS; i++) {
        let angle = f32(i) * (2.0 * PI / f32(DISK_CORNERS));
        let corner = to_center + (light.right * cos(angle) + light.up * sin(angle)) * radius;
        add_edge(&clip, last, corner, normal);
        last = corner;
    }
    return closed_sum(clip, normal);
}

// Irradiance of a sphere whose centre is `ratio` radii away in a direction at `cosine` to the normal. Lagarde and
// de Rousiers 2014, listing 7.
fn sphere_irradiance(cosine: f32, ratio: f32) -> f32 {
    let ratio_2 = ratio * ratio;
    let below = 1.0 - ratio_2 * cosine * cosine;
    if below <= 0.0 {
        return PI * max(cosine, 0.0) / ratio_2;
    }
    let sine = sqrt(max(1.0 - cosine * cosine, 1e-12));
    let x = sqrt(ratio_2 - 1.0);
    let angle = acos(clamp(-x * cosine / sine, -1.0, 1.0));
    return max((cosine * angle - x * sqrt(below)) / ratio_2 + atan(sqrt(below) / x), 0.0);
}

// Returns the ellipsoid's extent along a direction from its centre.
fn reach_along(light: Light, direction: vec3f) -> f32 {
    return length(vec3f(
        light.half_width * dot(light.right, direction),
        light.half_height * dot(light.up, direction),
        light.half_depth * dot(light.axis, direction),
    ));
}

// Minimum distance over radius. A receiver on or inside a sphere sees it fill half of all directions.
const NEAREST_RATIO = 1.0001;

fn ellipsoid_irradiance(light: Light, to_center: vec3f, normal: vec3f) -> f32 {
    let center_distance = max(length(to_center), 1e-6);
    let reach = reach_along(light, normal);
    let strength_radius_2 = pow(light.half_width * light.half_height * light.half_depth, 2.0 / 3.0);
    let ratio = max(center_distance / reach, NEAREST_RATIO);
    return sphere_irradiance(dot(to_center, normal) / center_distance, ratio) * strength_radius_2 / (reach * reach);
}

// Minimum squared distance to a point light, m², because point lights have some size: one centimetre.
const NEAREST_POINT_M_2 = 1e-4;

fn points_irradiance(light: Light, x: vec3f, normal: vec3f) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < light.point_count; i++) {
        let to_point = light_points[i].xyz - x;
        let distance_2 = max(dot(to_point, to_point), NEAREST_POINT_M_2);
        sum += max(dot(to_point, normal), 0.0) / (distance_2 * sqrt(distance_2));
    }
    return sum / f32(light.point_count);
}

// Size over distance below which a flat emitter counts as a point. The error is below 1e-6, and Lambert's differences of
// angles would lose digits.
const POINT_LIKE_RATIO = 1e-3;

fn flat_irradiance(light: Light, to_center: vec3f, normal: vec3f) -> f32 {
    let emitted_cosine = -dot(to_center, light.axis);
    if emitted_cosine <= 0.0 {
        return 0.0;
    }
    let distance_2 = dot(to_center, to_center);
    let size = max(light.half_width, light.half_height);
    if size * size < POINT_LIKE_RATIO * POINT_LIKE_RATIO * distance_2 {
        let area = select(PI * size * size, 4.0 * light.half_width * light.half_height, light.kind == RECTANGLE);
        return area * emitted_cosine * max(dot(to_center, normal), 0.0) / (distance_2 * distance_2);
    }
    if light.kind == RECTANGLE {
        return rectangle_irradiance(light, to_center, normal);
    }
    return disk_irradiance(light, to_center, normal);
}

fn irradiance(light: Light, x: vec3f, normal: vec3f) -> f32 {
    let to_center = light.center - x;
    switch light.kind {
        case SPHERE: {
            let center_distance = max(length(to_center), 1e-6);
            let ratio = max(center_distance / light.half_width, NEAREST_RATIO);
            return sphere_irradiance(dot(to_center, normal) / center_distance, ratio);
        }
        case ELLIPSOID: {
            return ellipsoid_irradiance(light, to_center, normal);
        }
        case SUN: {
            // A disc with this tangent subtends the same cone as a sphere with this sine.
            let sine = light.half_width * inverseSqrt(1.0 + light.half_width * light.half_width);
            return sphere_irradiance(-dot(light.axis, normal), 1.0 / sine);
        }
        case POINTS: {
            return points_irradiance(light, x, normal);
        }
        default: {
            return flat_irradiance(light, to_center, normal);
        }
    }
}

// Returns the irradiance of a surface at x that faces the light's centre.
fn facing_irradiance(light: Light, x: vec3f) -> f32 {
    let to_center = select(light.center - x, -light.axis, light.kind == SUN);
    return irradiance(light, x, to_center / max(length(to_center), 1e-6));
}
