//! Brute force agrees on whole scenes: the built-in ones, and real ones if they are available.

use antumbra_light::LightShape;
use antumbra_scene::{LoadOptions, Scene, Setup, builtin, load};
use glam::UVec2;

use super::*;
use crate::SampledLight;

/// Checks a few receivers of the scene's own camera, under its own lights and a sun.
fn check(scene: &Scene, pixels: usize) {
    let setup = Setup::for_scene(scene);
    let tracer = Tracer::new(scene).unwrap();
    let receivers = tracer.primary(&setup.camera, UVec2::new(32, 18));
    let hits: Vec<_> = receivers.points.iter().flatten().copied().collect();
    assert!(!hits.is_empty(), "{}: the scene's camera sees nothing of it", scene.name);
    let few: Vec<_> = hits.iter().copied().step_by(hits.len().div_ceil(pixels)).collect();
    let mut lights = setup.lights;
    lights.truncate(1);
    let sun = LightShape::Sun { angular_diameter_rad: 0.05 };
    lights.push(Light::new(sun, Vec3::new(2.0, 5.0, 3.0), Vec3::ZERO));
    super::brute_force::check_bits_only(scene, &few, &lights, 64);

    let options = VisibilityOptions { samples: 64, ..VisibilityOptions::default() };
    for light in &lights {
        let image = visibility(&tracer, &receivers, light, &options);
        assert!(image.values.iter().flatten().all(|v| (0.0..=1.0).contains(v)), "{}", scene.name);
        let few_on = |tracer: &Tracer| tracer.visibility_at(&few, light, &options, &|_| {}, &never()).unwrap().values;
        assert_eq!(few_on(&tracer), few_on(&tracer.portable()), "{}", scene.name);
    }
}

/// Number of triangles that brute force handles in a second or two.
const MAX_TRIANGLES: usize = 100_000;

#[test]
fn builtin_scenes_equal_brute_force() {
    for info in builtin::NAMES {
        // A million hairs by brute force take a minute and test no more than thirty thousand leaves.
        if info.triangles > MAX_TRIANGLES {
            continue;
        }
        let scene = load(&format!("builtin:{}", info.name), &LoadOptions::default()).unwrap();
        // The time of brute force grows with the triangles, so there are fewer receivers for more triangles.
        check(&scene, (40_000 / info.triangles.max(1)).clamp(1, 8));
    }
}

#[test]
fn rows_are_those_of_the_whole() {
    let scene = load("builtin:stained-glass", &LoadOptions::default()).unwrap();
    let setup = Setup::for_scene(&scene);
    let tracer = Tracer::new(&scene).unwrap();
    let size = UVec2::new(40, 30);
    let receivers = tracer.primary(&setup.camera, size);
    let options = VisibilityOptions { samples: 16, seed: 3, ..VisibilityOptions::default() };
    let whole = visibility(&tracer, &receivers, &setup.lights[0], &options);
    let light = SampledLight::new(&setup.lights[0], &options).unwrap();
    let (mut points, mut values, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    // Rows not in sixteens, in which the whole image is traced; the last range exceeds the image.
    for first in (0..size.y).step_by(7) {
        points.extend(tracer.primary_in_rows(&setup.camera, size, first..(first + 7).min(size.y)));
        let part = tracer.visibility_in_rows(&receivers, first..first + 7, &light, &never()).unwrap();
        assert_eq!(part.values.len() as u32, size.x * part.size_px.y);
        values.extend(part.values);
        faces.extend(part.faces_light_center);
    }
    assert_eq!(points, receivers.points);
    assert_eq!((values, faces), (whole.values, whole.faces_light_center));
}

#[test]
fn real_scenes_equal_brute_force() {
    let Some(folder) = antumbra_testing::scenes_folder() else { return };
    for name in
        ["sponza", "fern", "stained-glass-window", "fence-chain-link-masked", "alpha-blend-mode-test", "lantern"]
    {
        let path = folder.join(name).with_extension("glb");
        if !path.exists() {
            antumbra_testing::skip(format_args!("there is no {name}.glb"));
            continue;
        }
        let scene = load(path.to_str().unwrap(), &LoadOptions::default()).unwrap();
        check(&scene, if name == "sponza" { 1 } else { 4 });
    }
}
