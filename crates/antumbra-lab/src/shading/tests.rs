//! Tests of irradiance against sums over light samples, and of images against expected properties.

use antumbra::Mask;
use antumbra_light::{LightShape, SampleSet};
use antumbra_scene::{AlphaMode, Instance, Material, Mesh, Scene};
use glam::{Mat4, Vec2};

use super::*;
use crate::irradiance::analytic;
use crate::picture::Visibility;
use crate::test_support::{camera_at, lab_or_skip, quad};

/// Returns the irradiance as a sum over points of the light, in double precision.
fn summed(light: &Light, x: Vec3, normal: Vec3) -> f64 {
    let frame = light.frame();
    let points = SampleSet::R2.points(1 << 15, 1);
    let pi = std::f64::consts::PI;
    let sum: f64 = points
        .iter()
        .map(|u| {
            // A sphere is sampled on its surface, not on the disc that represents it for visibility.
            if let LightShape::Sphere { radius_m } = light.shape {
                let z = 1.0 - 2.0 * u.x;
                let (s, c) = (std::f32::consts::TAU * u.y).sin_cos();
                let outward = Vec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z);
                let d = light.center + radius_m * outward - x;
                let cosines = (-outward.dot(d)).max(0.0) * normal.dot(d).max(0.0);
                return 4.0 * pi * f64::from(radius_m).powi(2) * f64::from(cosines)
                    / f64::from(d.length_squared()).powi(2);
            }
            let d = light.point(&frame, *u, x).vector_from(x);
            let received = f64::from(normal.dot(d).max(0.0));
            let d2 = f64::from(d.length_squared());
            let emitted = f64::from(-d.dot(light.axis)).max(0.0);
            match &light.shape {
                LightShape::Rectangle { size_m } => {
                    f64::from(size_m.element_product()) * emitted * received / (d2 * d2)
                }
                LightShape::Disk { radius_m } => pi * f64::from(*radius_m).powi(2) * emitted * received / (d2 * d2),
                LightShape::Ellipsoid { radii_m } => {
                    pi * f64::from(radii_m.element_product()).powf(2.0 / 3.0) * received / d2.powf(1.5)
                }
                // On the tangent disc, at a distance of 1: the solid angle decreases with the cubed cosine.
                LightShape::Sun { angular_diameter_rad } => {
                    pi * f64::from((0.5 * angular_diameter_rad).tan()).powi(2) * received / (d2 * d2)
                }
                LightShape::Points { .. } => received / d2.powf(1.5),
                LightShape::Sphere { .. } => unreachable!(),
            }
        })
        .sum();
    sum / points.len() as f64
}

/// Returns receivers below, beside and behind the light, near and far, many with the light across their horizon.
fn receivers() -> Vec<(Vec3, Vec3)> {
    let positions = [Vec3::ZERO, Vec3::new(1.5, 0.0, 0.5), Vec3::new(-3.0, 0.5, 2.0), Vec3::new(0.3, 1.0, 0.2)];
    let normals = [Vec3::Y, Vec3::new(1.0, 0.1, 0.0), Vec3::new(-1.0, 0.6, 0.3), Vec3::new(0.2, -0.3, 1.0), Vec3::Z];
    positions.into_iter().flat_map(|x| normals.map(|n| (x, n.normalize()))).collect()
}

fn assert_irradiance(lab: &LabDevice, light: &Light, tolerance: f64) {
    let receivers = receivers();
    for ((x, n), got) in receivers.iter().zip(analytic(lab, light, &receivers).unwrap()) {
        let want = summed(light, *x, *n);
        // The tolerance is relative to a receiver that faces the light, because the part above the horizon may be small.
        let facing = summed(light, *x, (light.center - *x).normalize());
        let facing = if light.is_distant() { summed(light, *x, -light.axis) } else { facing };
        let miss = (f64::from(got) - want).abs();
        assert!(miss <= tolerance * facing, "{:?} at {x} facing {n}: {got} against {want}", light.shape);
    }
    lab.check().unwrap();
}

#[test]
fn irradiance_is_the_sum_over_the_light() {
    let Some(lab) = lab_or_skip() else { return };
    let light = |shape| Light::new(shape, Vec3::new(0.2, 2.0, 0.1), Vec3::new(0.0, 0.0, -0.3));
    assert_irradiance(lab, &light(LightShape::Rectangle { size_m: Vec2::new(2.0, 0.6) }), 2e-3);
    assert_irradiance(lab, &light(LightShape::Rectangle { size_m: Vec2::new(0.02, 0.01) }), 2e-3);
    assert_irradiance(lab, &light(LightShape::Disk { radius_m: 0.8 }), 4e-3);
    assert_irradiance(lab, &light(LightShape::Sphere { radius_m: 0.6 }), 8e-3);
    assert_irradiance(lab, &light(LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) }), 6e-2);
    assert_irradiance(lab, &light(LightShape::Sun { angular_diameter_rad: 0.3 }), 4e-3);
    let positions_m = vec![Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 1.5, 0.3), Vec3::new(-0.4, 2.2, 0.6)];
    assert_irradiance(lab, &light(LightShape::Points { positions_m }), 2e-3);
}

const SIZE: UVec2 = UVec2::new(64, 48);

struct Fixture {
    images: ReceiverImages,
    shading: Shading,
}

fn fixture(lab: &LabDevice, scene: &Scene, lights: &[Light]) -> Fixture {
    let camera = camera_at(Vec3::new(0.0, 2.0, 3.0));
    let scene = GpuScene::upload(lab, scene);
    let images = ReceiverPass::new(lab).render(lab, &scene, &camera, SIZE, Layer::FirstHits).unwrap();
    let shading = Shading::new(lab, &scene, &camera, &images, lights).unwrap();
    Fixture { images, shading }
}

fn floor() -> Scene {
    Scene {
        meshes: vec![quad(1.0)],
        materials: vec![Material { base_color: Vec4::new(0.5, 0.5, 0.5, 1.0), ..Material::default() }],
        instances: vec![Instance { mesh: 0, world_from_object: Mat4::IDENTITY }],
        ..Scene::default()
    }
}

const MIDDLE: usize = (SIZE.y / 2 * SIZE.x + SIZE.x / 2) as usize;

#[test]
fn every_light_exposes_about_the_same() {
    let Some(lab) = lab_or_skip() else { return };
    let shapes = [
        LightShape::Rectangle { size_m: Vec2::new(1.0, 0.5) },
        LightShape::Rectangle { size_m: Vec2::ZERO },
        LightShape::Disk { radius_m: 0.01 },
        LightShape::Sphere { radius_m: 0.5 },
        LightShape::Sphere { radius_m: 0.0 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.3, 0.2, 0.1) },
        LightShape::Sun { angular_diameter_rad: 0.01 },
        LightShape::Sun { angular_diameter_rad: 0.0 },
        LightShape::Points { positions_m: vec![Vec3::new(0.0, 4.0, 0.0)] },
    ];
    for (shape, height) in shapes.iter().flat_map(|shape| [3.0, 300.0].map(|height| (shape.clone(), height))) {
        let light = Light::new(shape, Vec3::Y * height, Vec3::ZERO);
        let Fixture { images, shading } = fixture(lab, &floor(), std::slice::from_ref(&light));
        let picture = shading.picture(lab, &images, &[VisibilitySource::Lit]).unwrap();
        let middle = picture.linear_rgb[MIDDLE].y;
        assert!((0.15..0.75).contains(&middle), "{light:?}: {middle}");
        assert!(picture.linear_rgb.iter().all(|c| c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= 1.0));
    }
}

#[test]
fn visibility_dims_and_tints_wherever_it_comes_from() {
    let Some(lab) = lab_or_skip() else { return };
    let light = Light::new(LightShape::Disk { radius_m: 0.3 }, Vec3::new(1.0, 3.0, 0.0), Vec3::ZERO);
    let Fixture { images, shading } = fixture(lab, &floor(), &[light]);
    let n = (SIZE.x * SIZE.y) as usize;
    let middle_of = |source: VisibilitySource<'_>| shading.picture(lab, &images, &[source]).unwrap().linear_rgb[MIDDLE];
    let lit = middle_of(VisibilitySource::Lit);
    assert_eq!(middle_of(VisibilitySource::Image(&Visibility::one(SIZE, vec![1.0; n]))), lit);
    // A new mask is black.
    let umbra = middle_of(VisibilitySource::Mask(&Mask::new(&lab.device, SIZE)));
    assert_eq!(middle_of(VisibilitySource::Image(&Visibility::one(SIZE, vec![0.0; n]))), umbra);
    assert!(umbra.cmplt(0.4 * lit).all() && umbra.cmpgt(Vec3::ZERO).all(), "{umbra} against {lit}");
    let red = middle_of(VisibilitySource::Image(&Visibility::three(SIZE, vec![Vec3::X; n])));
    assert!(red.x > 2.0 * red.y, "{red}");
}

#[test]
fn glass_lets_see_what_is_behind() {
    let Some(lab) = lab_or_skip() else { return };
    let mut scene = floor();
    scene.materials[0].emissive = Vec3::new(0.0, 2.0, 0.0);
    let glass = |opacity| Material {
        base_color: Vec4::new(1.0, 0.0, 0.0, opacity),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    scene.meshes.push(Mesh { material: 1, ..quad(1.0) });
    scene.instances.push(Instance { mesh: 1, world_from_object: Mat4::from_translation(0.2 * Vec3::Y) });
    let middle = |opacity| {
        let mut scene = scene.clone();
        scene.materials.push(glass(opacity));
        let Fixture { images, shading } = fixture(lab, &scene, &[]);
        shading.picture(lab, &images, &[]).unwrap().linear_rgb[MIDDLE]
    };
    assert!(middle(0.1).y > 2.0 * middle(0.1).x && middle(1.0).x > middle(1.0).y);
    lab.check().unwrap();
}

/// Returns a sphere of visibly few triangles, with smooth normals.
fn coarse_sphere() -> Mesh {
    const RINGS: u32 = 6;
    const SEGMENTS: u32 = 10;
    let point = |ring: u32, segment: u32| {
        let polar = std::f32::consts::PI * ring as f32 / RINGS as f32;
        let azimuth = std::f32::consts::TAU * segment as f32 / SEGMENTS as f32;
        Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin())
    };
    let positions: Vec<Vec3> = (0..=RINGS).flat_map(|r| (0..SEGMENTS).map(move |s| point(r, s))).collect();
    let quads = (0..RINGS).flat_map(|r| (0..SEGMENTS).map(move |s| (r, s)));
    let indices = quads.flat_map(|(r, s)| {
        let at = |r: u32, s: u32| r * SEGMENTS + s % SEGMENTS;
        [at(r, s), at(r, s + 1), at(r + 1, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)]
    });
    Mesh { normals: positions.clone(), indices: indices.collect(), positions, closed: true, ..Mesh::default() }
}

#[test]
fn bent_normals_keep_light_off_triangles_that_face_away() {
    let Some(lab) = lab_or_skip() else { return };
    let scene = Scene { meshes: vec![coarse_sphere()], ..floor() };
    let light = Light::new(LightShape::Disk { radius_m: 0.1 }, Vec3::new(4.0, 1.0, 0.5), Vec3::ZERO);
    let camera = camera_at(Vec3::new(0.0, 2.0, 3.0));
    let uploaded = GpuScene::upload_with_faces(lab, &scene);
    let images = ReceiverPass::new(lab).render(lab, &uploaded, &camera, SIZE, Layer::FirstHits).unwrap();
    let smooth = Shading::new(lab, &uploaded, &camera, &images, std::slice::from_ref(&light)).unwrap();
    let mut coherent = Shading::new(lab, &uploaded, &camera, &images, std::slice::from_ref(&light)).unwrap();
    coherent.bend_normals(lab, &uploaded, &images);

    // Fraction of the light in front of each pixel's triangle: the whole shadow of a convex body.
    let normals = read_rgba32f(lab, &images.geometric_normal).unwrap();
    let positions = images.read_positions(lab).unwrap();
    let frame = light.frame();
    let light_points = SampleSet::R2.points(64, 0);
    let seen = |(position, normal): (&Option<Vec3>, &[f32; 4])| {
        let (x, n) = ((*position)?, Vec4::from(*normal).truncate());
        let in_front = |u: &&Vec3| light.point(&frame, **u, x).vector_from(x).dot(n) > 0.0;
        Some(light_points.iter().filter(in_front).count() as f32 / 64.0)
    };
    let visible: Vec<Option<f32>> = positions.iter().zip(&normals).map(seen).collect();
    let picture = |shading: &Shading, values: Vec<f32>| {
        let visibility = Visibility::one(SIZE, values);
        shading.picture(lab, &images, &[VisibilitySource::Image(&visibility)]).unwrap().linear_rgb
    };
    let n = visible.len();
    let dark = picture(&smooth, vec![0.0; n]);

    // Unshadowed light on triangles that face away from the whole light.
    let turned: Vec<usize> = (0..n).filter(|i| visible[*i] == Some(0.0)).collect();
    let [leak, bent_leak] = [&smooth, &coherent].map(|shading| {
        let lit = picture(shading, vec![1.0; n]);
        turned.iter().map(|i| (lit[*i] - dark[*i]).max_element()).sum::<f32>() / turned.len() as f32
    });
    // Differences of shadowed light between neighbours of which exactly one faces away.
    let width = SIZE.x as usize;
    let pairs = (0..n - width).flat_map(|i| [(i, i + 1), (i, i + width)]);
    let is_edge = |(a, b): &(usize, usize)| matches!((visible[*a], visible[*b]), (Some(a), Some(b)) if a.min(b) == 0.0 && a.max(b) > 0.5);
    let edges: Vec<_> = pairs.filter(is_edge).collect();
    let [step, bent_step] = [&smooth, &coherent].map(|shading| {
        let shadowed = picture(shading, visible.iter().map(|v| v.unwrap_or(1.0)).collect());
        let step = |(a, b): &(usize, usize)| (shadowed[*a] - shadowed[*b]).abs().max_element();
        edges.iter().map(step).sum::<f32>() / edges.len() as f32
    });
    println!(
        "{} pixels, leak {leak:.4} to {bent_leak:.4}; {} edges, step {step:.4} to {bent_step:.4}",
        turned.len(),
        edges.len()
    );
    assert!(turned.len() > 100 && edges.len() > 20);
    assert!(leak > 0.01 && bent_leak < 1e-4, "{leak} against {bent_leak}");
    assert!(bent_step < 0.5 * step, "{step} against {bent_step}");
    lab.check().unwrap();
}
