//! Testing every triangle against every light point, without a tree, shaft, tiles or vectors, gives the same bits.

use antumbra_light::{Light, LightShape, SampleSet};
use antumbra_scene::Scene;
use glam::{DVec3, Vec2, Vec3};

use super::*;
use crate::SampledLight;
use crate::lanes::{Kernel, Lanes, PortableLanes, Simd};
use crate::planes::{Block, Planes};
use crate::sampled_light::{BUNDLE, TILE};
use crate::surface::Surface;
use crate::walk::normalized;

/// Kernel that tests whether any triangle hides a light point. (A kernel only to compile fused multiply-adds to instructions.)
struct AnyOf<'a> {
    tracer: &'a Tracer,
    triangles: &'a [(Planes, Surface)],
    at: [f32; 3],
    axes: usize,
}

impl Kernel for AnyOf<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        let surfaces = &self.tracer.geometry().surfaces;
        for (planes, surface) in self.triangles {
            let mut values = [0.0f32; 4];
            for (value, terms) in values.iter_mut().zip(&planes.coefficients) {
                *value = terms[0][0];
                for axis in 0..self.axes {
                    *value = terms[1 + axis][0].mul_add(self.at[axis], *value);
                }
            }
            let [a, b, c, within] = values;
            let outside = a.is_sign_negative() || b.is_sign_negative() || c.is_sign_negative();
            if outside || within.is_sign_positive() {
                continue;
            }
            let solid = match surface {
                Surface::Masked(mask) => {
                    surfaces.masked[*mask as usize].is_solid_at(&surfaces.alpha_images, normalized([a, b, c]))
                }
                _ => true,
            };
            if solid {
                return true;
            }
        }
        false
    }
}

/// Bit mask of the visible light points by brute force, with the tracer's own arithmetic.
fn mask(tracer: &Tracer, light: &SampledLight, index: usize, point: &ReceiverPoint) -> Vec<u64> {
    let mut words = vec![0u64; (light.points as usize).div_ceil(64)];
    if !light.light.reaches(&light.frame, point.position) {
        return words;
    }
    let geometry = tracer.geometry();
    let frame = light.ray_frame(point.origin(), point.position);
    let pattern = &light.patterns[light.pattern_index(index)];
    let triangles: Vec<(Planes, Surface)> = (0..geometry.blockers.len() as u32)
        .map(|i| {
            let mut planes = Planes::ZERO;
            planes.set::<PortableLanes, 3>(&Block::new(&geometry.blockers, &[i]), &frame);
            (planes, geometry.blockers[i as usize].surface)
        })
        .collect();
    for (slot, &i) in pattern.order.iter().enumerate() {
        let tile = &pattern.bundles[slot / (TILE * BUNDLE)].tiles[slot / TILE % BUNDLE];
        let at = [0, 1, 2].map(|axis| tile.at[axis][slot % TILE]);
        let blocked = Simd::detect().run(AnyOf { tracer, triangles: &triangles, at, axes: light.axes });
        words[i as usize / 64] |= u64::from(!blocked) << (i % 64);
    }
    words
}

/// Whether a segment is blocked, by Möller and Trumbore's test in double precision; `None` if it passes within 10⁻⁵ of an
/// edge or end, where single precision may differ.
fn blocked_in_doubles(tracer: &Tracer, origin: Vec3, vector: Vec3, t_max: f64) -> Option<bool> {
    let (o, d) = (origin.as_dvec3(), vector.as_dvec3());
    let mut blocked = Some(false);
    for triangle in &tracer.geometry().blockers {
        let [a, b, c] = triangle.corners.map(Vec3::as_dvec3);
        let (e1, e2) = (b - a, c - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        let s = (o - a) / det;
        let u = s.dot(p);
        let q = s.cross(e1);
        let v = d.dot(q);
        let t = e2.dot(q);
        let margin = [u, v, 1.0 - u - v, t, t_max - t].into_iter().fold(f64::INFINITY, f64::min);
        let size = (DVec3::ONE.length() / e1.cross(e2).length().sqrt()).max(1.0);
        if margin > 1e-5 * size {
            return Some(true);
        }
        if margin > -1e-5 * size || det == 0.0 {
            blocked = None;
        }
    }
    blocked
}

pub(super) fn all_lights() -> Vec<Light> {
    let (center, target) = (Vec3::new(0.4, 3.0, -0.3), Vec3::new(0.1, 0.0, 0.2));
    [
        LightShape::Rectangle { size_m: Vec2::new(1.5, 0.6) },
        LightShape::Disk { radius_m: 0.7 },
        LightShape::Sphere { radius_m: 0.7 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.7, 0.4, 0.3) },
        LightShape::Sun { angular_diameter_rad: 0.2 },
        LightShape::Points { positions_m: offsets(90, -1.0, 1.0).map(|x| Vec3::new(x, 3.0, x * x)).collect() },
    ]
    .map(|shape| Light::new(shape, center, target))
    .into()
}

fn check(scene: &Scene, receivers: &[ReceiverPoint], lights: &[Light], samples: u32) {
    let tracer = Tracer::new(scene).unwrap();
    let portable = tracer.portable();
    let (mut agreed, mut blocked_count, mut unsure) = (0u32, 0u32, 0u32);
    for light in lights {
        for set in [SampleSet::Stratified, SampleSet::R2] {
            let options = VisibilityOptions { samples, set, ..VisibilityOptions::default() };
            let sampled = SampledLight::new(light, &options).unwrap();
            for (index, point) in receivers.iter().enumerate() {
                let want = mask(&tracer, &sampled, index, point);
                assert_eq!(tracer.visible_mask(&sampled, index, point), want, "{}: {light:?} {point:?}", scene.name);
                assert_eq!(portable.visible_mask(&sampled, index, point), want, "{}: {light:?} {point:?}", scene.name);
                if !light.reaches(&sampled.frame, point.position) {
                    continue;
                }
                for (i, light_point) in sampled.points_for(index, point.position).iter().enumerate().step_by(7) {
                    let vector = light_point.vector_from(point.origin());
                    let t_max = if light.is_distant() { f64::INFINITY } else { 1.0 };
                    match blocked_in_doubles(&tracer, point.origin(), vector, t_max) {
                        Some(blocked) => {
                            assert_eq!(want[i / 64] >> (i % 64) & 1 == 0, blocked, "{}: {light:?} {i}", scene.name);
                            blocked_count += u32::from(blocked);
                            agreed += 1;
                        }
                        None => unsure += 1,
                    }
                }
            }
        }
    }
    assert!(unsure < agreed / 20 && (1..agreed).contains(&blocked_count), "{unsure} {blocked_count} {agreed}");
}

#[test]
fn random_soups() {
    for (seed, count, size) in [(1, 3, 1.0), (2, 40, 0.5), (3, 600, 0.15), (4, 2000, 0.05), (5, 300, 0.02)] {
        let mut triangles = soup(count, 1.0, size, seed);
        triangles.extend(parallelogram(Vec3::new(-3.0, -1.3, -3.0), Vec3::X * 6.0, Vec3::Z * 6.0));
        let scene = scene_of(&triangles);
        let mut random = Random(seed);
        let receivers: Vec<ReceiverPoint> = (0..if count > 1000 { 4 } else { 12 })
            .map(|_| {
                let p = random.in_cube(1.4);
                ReceiverPoint::new(p, Vec3::Y)
            })
            .collect();
        check(&scene, &receivers, &all_lights(), 200);
    }
}

#[test]
fn slivers_and_shared_corners() {
    // Thin triangles that all meet in one point, and receivers in their planes.
    let mut random = Random(9);
    let mut triangles = Vec::new();
    for _ in 0..200 {
        let (a, b) = (random.in_cube(1.0), random.in_cube(1.0));
        triangles.push([Vec3::new(0.1, 0.4, 0.2), a, a + 1e-4 * b]);
    }
    triangles.extend(sphere(Vec3::new(0.3, 0.8, 0.0), 0.5, 24, 12));
    let receivers: Vec<_> =
        triangles.iter().step_by(50).map(|t| ReceiverPoint::new((t[0] + t[1] + t[2]) / 3.0, Vec3::Y)).collect();
    check_bits_only(&scene_of(&triangles), &receivers, &all_lights(), 300);
}

/// [`check`] without the test in double precision, for triangles so thin that this test is never certain.
pub(super) fn check_bits_only(scene: &Scene, receivers: &[ReceiverPoint], lights: &[Light], samples: u32) {
    let tracer = Tracer::new(scene).unwrap();
    for light in lights {
        let options = VisibilityOptions { samples, ..VisibilityOptions::default() };
        let sampled = SampledLight::new(light, &options).unwrap();
        for (index, point) in receivers.iter().enumerate() {
            let want = mask(&tracer, &sampled, index, point);
            assert_eq!(tracer.visible_mask(&sampled, index, point), want, "{}: {light:?} {point:?}", scene.name);
        }
    }
}

#[test]
fn many_samples_make_many_bundles() {
    let mut triangles = soup(100, 1.0, 0.3, 7);
    triangles.extend(parallelogram(Vec3::new(-3.0, -1.3, -3.0), Vec3::X * 6.0, Vec3::Z * 6.0));
    let receivers = [ReceiverPoint::new(Vec3::new(0.2, -1.3, 0.1), Vec3::Y)];
    check_bits_only(&scene_of(&triangles), &receivers, &all_lights(), 5000);
}

#[test]
fn single_rays_agree_with_brute_force() {
    let triangles = soup(500, 1.0, 0.2, 21);
    let tracer = Tracer::new(&scene_of(&triangles)).unwrap();
    let portable = tracer.portable();
    let mut random = Random(4);
    let mut blocked_count = 0;
    for _ in 0..4000 {
        let (origin, target) = (random.in_cube(1.5), random.in_cube(1.5));
        let got = tracer.occluded(origin, target);
        assert_eq!(got, portable.occluded(origin, target));
        if let Some(blocked) = blocked_in_doubles(&tracer, origin, target - origin, 1.0) {
            assert_eq!(got, blocked, "{origin} {target}");
            blocked_count += u32::from(blocked);
        }
        let nearest = tracer.first_hit(origin, (target - origin).normalize(), 0.0);
        let blocked_far = tracer.occluded_towards(origin, target - origin);
        assert_eq!(nearest.is_some(), blocked_far);
        if let Some(hit) = nearest {
            // Nothing lies before the first hit, and something lies just behind it.
            let to = |f: f32| origin + (hit.position - origin) * f;
            assert!(!tracer.occluded(origin, to(0.9999)));
            if let Some(blocked) = blocked_in_doubles(&tracer, origin, to(1.001) - origin, 1.0) {
                assert!(blocked && tracer.occluded(origin, to(1.001)));
            }
        }
    }
    assert!((1000..3500).contains(&blocked_count), "{blocked_count}");
}
