//! Visibility by brute force: every shadow ray is tested against every triangle in double precision.

use std::f64::consts::TAU;

use antumbra::light::{Light, LightShape};
use glam::{DMat4, DVec2, DVec3, UVec2};

use crate::scene::{Camera, Scene};

/// Reference visibility by pixel; `None` if the pixel sees no surface, or more than one.
pub type Truth = Vec<Option<f32>>;

/// Distance in pixels of four rays around a pixel's primary ray. All must see the same plane for the pixel to be judged.
const ABOUT_PX: f64 = 0.05;

/// A scene's triangles for ray casting.
#[derive(Clone, Debug)]
pub struct Rays {
    triangles: Vec<Triangle>,
}

#[derive(Clone, Copy, Debug)]
struct Triangle {
    corner: DVec3,
    edges: [DVec3; 2],
    normal: DVec3,
}

/// Intersection of a ray with a surface.
#[derive(Clone, Copy, Debug)]
struct Hit {
    distance: f64,
    triangle: usize,
}

impl Rays {
    /// Collects the triangles of a scene.
    pub fn new(scene: &Scene) -> Self {
        let triangle = |[a, b, c]: [glam::Vec3; 3]| {
            let [a, b, c] = [a, b, c].map(|corner| corner.as_dvec3());
            let edges = [b - a, c - a];
            Triangle { corner: a, edges, normal: edges[0].cross(edges[1]).normalize_or_zero() }
        };
        Self { triangles: scene.triangles().into_iter().map(triangle).collect() }
    }

    /// Computes visibility at every pixel, with `points` light samples that differ between pixels.
    pub fn visibility(&self, camera: &Camera, light: &Light, points: u32) -> Truth {
        let size = camera.size_px;
        let mut truth = vec![None; size.element_product() as usize];
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let rows = (size.y as usize).div_ceil(threads);
        std::thread::scope(|scope| {
            for (i, part) in truth.chunks_mut(rows * size.x as usize).enumerate() {
                scope.spawn(move || {
                    for (k, value) in part.iter_mut().enumerate() {
                        let index = (i * rows * size.x as usize + k) as u32;
                        *value = self.at_pixel(camera, light, UVec2::new(index % size.x, index / size.x), points);
                    }
                });
            }
        });
        truth
    }

    fn at_pixel(&self, camera: &Camera, light: &Light, pixel: UVec2, points: u32) -> Option<f32> {
        let (x, hit, direction) = self.seen(camera, pixel.as_dvec2() + 0.5)?;
        let plane = &self.triangles[hit.triangle];
        for about in [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y] {
            let (beside, other, _) = self.seen(camera, pixel.as_dvec2() + 0.5 + ABOUT_PX * about)?;
            let is_level = self.triangles[other.triangle].normal.dot(plane.normal).abs() > 1.0 - 1e-9;
            let is_near = (beside - x).dot(plane.normal).abs() < 1e-6 * (1.0 + hit.distance);
            if !(is_level && is_near) {
                return None;
            }
        }
        let normal = if plane.normal.dot(direction) > 0.0 { -plane.normal } else { plane.normal };
        Some(self.light_seen(light, x, normal, hit.triangle, pixel, points))
    }

    /// Returns the surface at an image position, with the direction of the primary ray.
    fn seen(&self, camera: &Camera, place_px: DVec2) -> Option<(DVec3, Hit, DVec3)> {
        let ndc = place_px / camera.size_px.as_dvec2() * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
        let aspect = f64::from(camera.size_px.x) / f64::from(camera.size_px.y);
        let across = ndc * DVec2::new(aspect, 1.0);
        let (origin, direction) = match camera.height_m {
            Some(height_m) => ((0.5 * f64::from(height_m) * across).extend(0.0), DVec3::NEG_Z),
            None => (DVec3::ZERO, ((0.5 * f64::from(camera.fov_y_rad)).tan() * across).extend(-1.0)),
        };
        let world_from_view: DMat4 = camera.view_from_world().as_dmat4().inverse();
        let origin = world_from_view.transform_point3(origin);
        let direction = world_from_view.transform_vector3(direction);
        let far = camera.far_m.map_or(f64::INFINITY, f64::from);
        let hit = self.first_hit(origin, direction, f64::from(camera.near_m), far)?;
        Some((origin + hit.distance * direction, hit, direction))
    }

    fn first_hit(&self, origin: DVec3, direction: DVec3, from: f64, to: f64) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for (triangle, it) in self.triangles.iter().enumerate() {
            if let Some(distance) = it.meets(origin, direction)
                && distance > from
                && distance < nearest.map_or(to, |hit| hit.distance)
            {
                nearest = Some(Hit { distance, triangle });
            }
        }
        nearest
    }

    /// Whether any triangle but `own`, on which the origin lies, is nearer than `to` times the direction.
    fn is_blocked(&self, origin: DVec3, direction: DVec3, own: usize, to: f64) -> bool {
        let least = 1e-7 / direction.length();
        self.triangles.iter().enumerate().any(|(i, triangle)| {
            i != own && triangle.meets(origin, direction).is_some_and(|distance| distance > least && distance < to)
        })
    }

    /// Returns the visible fraction of the light at a surface point.
    fn light_seen(&self, light: &Light, x: DVec3, normal: DVec3, own: usize, pixel: UVec2, points: u32) -> f32 {
        if !reaches(light, x) {
            return 0.0;
        }
        let sampler = Sampler::of(light, x);
        let shift = shift_of(pixel);
        let (mut seen, mut all) = (0.0, 0.0);
        for i in 0..sampler.count(points) {
            let (to_light, weight) = sampler.point(i, sampler.count(points), shift);
            all += weight;
            let to = if light.is_distant() { f64::INFINITY } else { 1.0 };
            if to_light.dot(normal) > 0.0 && !self.is_blocked(x, to_light, own, to) {
                seen += weight;
            }
        }
        (seen / all) as f32
    }
}

impl Triangle {
    /// Returns the ray parameter of an intersection (Möller and Trumbore, "Fast, minimum storage ray-triangle intersection", 1997).
    fn meets(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let [e, f] = self.edges;
        let across = direction.cross(f);
        let determinant = e.dot(across);
        if determinant == 0.0 {
            return None;
        }
        let from_corner = origin - self.corner;
        let u = from_corner.dot(across) / determinant;
        let other = from_corner.cross(e);
        let v = direction.dot(other) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| f.dot(other) / determinant)
    }
}

/// Whether a point is on the emitting side of the light and inside its frustum or cone.
fn reaches(light: &Light, x: DVec3) -> bool {
    if light.is_distant() {
        return true;
    }
    let frame = light.frame();
    let p = x - frame.center.as_dvec3();
    let [right, up, axis] = [frame.right, frame.up, frame.axis].map(|v| p.dot(v.as_dvec3()));
    let has_front = matches!(light.shape, LightShape::Rectangle { .. } | LightShape::Disk { .. });
    let in_frustum = light.fov_rad.is_none_or(|fov| {
        let most = axis * f64::from(0.5 * fov).tan();
        right.abs() <= most && up.abs() <= most
    });
    let in_cone = light.cone.is_none_or(|cone| axis >= f64::from(cone.outer_rad).cos() * p.length());
    in_frustum && in_cone && (!has_front || axis > 0.0)
}

/// Samples of a light for one receiver.
struct Sampler<'a> {
    light: &'a Light,
    x: DVec3,
    axes: [DVec3; 3],
}

impl<'a> Sampler<'a> {
    fn of(light: &'a Light, x: DVec3) -> Self {
        let frame = light.frame();
        let own = [frame.right, frame.up, frame.axis].map(|axis| axis.as_dvec3());
        let axes = if let LightShape::Sphere { .. } = light.shape {
            // The disc of the sphere that faces the receiver.
            let towards = (x - light.center.as_dvec3()).normalize_or(own[2]);
            let (right, up) = towards.any_orthonormal_pair();
            [right, up, towards]
        } else {
            own
        };
        Self { light, x, axes }
    }

    fn count(&self, points: u32) -> u32 {
        if let LightShape::Points { positions_m } = &self.light.shape { positions_m.len() as u32 } else { points }
    }

    /// Returns the vector to sample `i` of `count` and its weight: a Hammersley set, shifted on the unit torus by `shift`.
    fn point(&self, i: u32, count: u32, shift: DVec3) -> (DVec3, f64) {
        let u = (DVec3::new((f64::from(i) + 0.5) / f64::from(count), radical_inverse(i, 2), radical_inverse(i, 3))
            + shift)
            .fract();
        let at = |p: DVec3| {
            let [right, up, axis] = self.axes;
            self.light.center.as_dvec3() + right * p.x + up * p.y + axis * p.z - self.x
        };
        let in_disc = || {
            let (sine, cosine) = (TAU * u.y).sin_cos();
            u.x.sqrt() * DVec3::new(cosine, sine, 0.0)
        };
        match &self.light.shape {
            LightShape::Rectangle { size_m } => {
                let place = (u - 0.5).truncate() * size_m.as_dvec2();
                let weight = self.light.emission.as_ref().map_or(1.0, |texture| {
                    let column = ((u.x * f64::from(texture.width)) as u32).min(texture.width - 1);
                    let row = (((1.0 - u.y) * f64::from(texture.height)) as u32).min(texture.height - 1);
                    f64::from(texture.luminance[(row * texture.width + column) as usize])
                });
                (at(place.extend(0.0)), weight)
            }
            LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => {
                (at(f64::from(*radius_m) * in_disc()), 1.0)
            }
            LightShape::Ellipsoid { radii_m } => {
                let z = 2.0 * u.z - 1.0;
                let (sine, cosine) = (TAU * u.y).sin_cos();
                let across = (1.0 - z * z).sqrt();
                let in_ball = u.x.cbrt() * DVec3::new(across * cosine, across * sine, z);
                (at(in_ball * radii_m.as_dvec3()), 1.0)
            }
            LightShape::Sun { angular_diameter_rad } => {
                let p = (0.5 * f64::from(*angular_diameter_rad)).tan() * in_disc();
                let [right, up, axis] = self.axes;
                (right * p.x + up * p.y - axis, 1.0)
            }
            LightShape::Points { positions_m } => (positions_m[i as usize].as_dvec3() - self.x, 1.0),
        }
    }
}

/// Radical inverse of a number: its digits in a base, mirrored about the point.
fn radical_inverse(mut i: u32, base: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0 / f64::from(base));
    while i > 0 {
        value += digit * f64::from(i % base);
        digit /= f64::from(base);
        i /= base;
    }
    value
}

/// Random shift of each pixel, from a hash (Jarzynski and Olano, "Hash functions for GPU rendering", 2020: `pcg3d`).
fn shift_of(pixel: UVec2) -> DVec3 {
    let mut v = [pixel.x, pixel.y, 0x9e37].map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for _ in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        v = v.map(|x| x ^ (x >> 16));
    }
    DVec3::from(v.map(f64::from)) / f64::from(u32::MAX)
}

/// Root-mean-square difference of a mask and the reference.
///
/// # Panics
/// Panics if fewer than a tenth of the pixels can be judged.
pub fn rmse(mask: &[f32], truth: &Truth) -> f64 {
    let squares: Vec<f64> =
        mask.iter().zip(truth).filter_map(|(had, right)| Some(f64::from(had - (*right)?).powi(2))).collect();
    assert!(squares.len() * 10 >= mask.len(), "only {} of {} pixels are judged", squares.len(), mask.len());
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Mean occlusion of a mask over the pixels that see the whole light.
///
/// # Panics
/// Panics if fewer than a tenth of the pixels do.
pub fn lit_loss(mask: &[f32], truth: &Truth) -> f64 {
    let lit = mask.iter().zip(truth).filter(|(_, right)| **right == Some(1.0));
    let losses: Vec<f64> = lit.map(|(had, _)| 1.0 - f64::from(*had)).collect();
    assert!(losses.len() * 10 >= mask.len(), "only {} of {} pixels are lit", losses.len(), mask.len());
    losses.iter().sum::<f64>() / losses.len() as f64
}

/// Mean visibility of a mask over the umbra.
///
/// # Panics
/// Panics if less than a tenth of the pixels is in the umbra.
pub fn umbra_leak(mask: &[f32], truth: &Truth) -> f64 {
    let dark = mask.iter().zip(truth).filter(|(_, right)| **right == Some(0.0));
    let leaks: Vec<f64> = dark.map(|(had, _)| f64::from(*had)).collect();
    assert!(leaks.len() * 10 >= mask.len(), "only {} of {} pixels are dark", leaks.len(), mask.len());
    leaks.iter().sum::<f64>() / leaks.len() as f64
}

/// Fraction of judged pixels within a range of visibility.
pub fn share_between(truth: &Truth, low: f32, high: f32) -> f64 {
    let judged: Vec<f32> = truth.iter().flatten().copied().collect();
    judged.iter().filter(|v| (low..=high).contains(*v)).count() as f64 / judged.len().max(1) as f64
}
