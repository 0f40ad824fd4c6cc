//! Alpha-tested and translucent surfaces.

use antumbra_light::{Light, LightShape};
use antumbra_scene::{AlphaMode, Image, Material, Wrap};
use glam::{Vec2, Vec3, Vec4};

use super::*;

/// A square sheet at height 1, 2 m wide, with texture coordinates from `low` to `high`.
fn sheet(material: Material, image: Option<Image>, low: f32, high: f32) -> antumbra_scene::Scene {
    let mut scene = antumbra_scene::Scene { name: "sheet".into(), ..Default::default() };
    let triangles = parallelogram(Vec3::new(-1.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0);
    let mesh =
        add_mesh(&mut scene, &triangles, Material { base_color_image: image.is_some().then_some(0), ..material });
    scene.images.extend(image);
    let uv = |p: &Vec3| Vec2::splat(low) + (Vec2::new(p.x, p.z) + 1.0) * 0.5 * (high - low);
    scene.meshes[mesh].uvs = scene.meshes[mesh].positions.iter().map(uv).collect();
    scene
}

fn image_of(n: u32, wrap: Wrap, texel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let rgba8 = (0..n * n).map(|i| texel(i % n, i / n)).collect();
    Image { width: n, height: n, rgba8, wrap: [wrap; 2] }
}

fn masked() -> Material {
    Material { alpha: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() }
}

fn high_sun(angle: f32) -> Light {
    Light::new(LightShape::Sun { angular_diameter_rad: angle }, Vec3::Y * 5.0, Vec3::ZERO)
}

#[test]
fn masks_cut_where_bilinear_alpha_crosses_the_cutoff() {
    // Checkers of 8 texels; a sun of no size straight above projects the sheet as it is.
    let checker = |x: u32, y: u32| [255, 255, 255, if (x / 2 + y / 2).is_multiple_of(2) { 255 } else { 0 }];
    for (low, high, wrap) in [(0.0, 1.0, Wrap::Repeat), (-1.3, 2.1, Wrap::Repeat), (-1.3, 2.1, Wrap::Mirror)] {
        let image = image_of(8, wrap, checker);
        let tracer = Tracer::new(&sheet(masked(), Some(image.clone()), low, high)).unwrap();
        let mut random = Random(3);
        let alpha_at =
            |p: Vec3| image.sample_alpha(Vec2::splat(low) + (Vec2::new(p.x, p.z) + 1.0) * 0.5 * (high - low));
        let points: Vec<Vec3> = std::iter::repeat_with(|| random.in_cube(0.99) * Vec3::new(1.0, 0.0, 1.0))
            .take(400)
            .filter(|p| (alpha_at(*p) - 0.5).abs() >= 1e-3)
            .collect();
        let mut solid = 0;
        for (p, v) in points.iter().zip(visibility_on_floor(&tracer, &high_sun(0.0), &points)) {
            let alpha = alpha_at(*p);
            assert_eq!(v, if alpha >= 0.5 { 0.0 } else { 1.0 }, "{p} {alpha}");
            solid += u32::from(alpha >= 0.5);
        }
        assert!((100..300).contains(&solid), "{solid}");
    }
}

#[test]
fn factors_and_vertex_colours_multiply_the_mask() {
    // Alpha runs from 0 to 1 along x by vertex colours; the factor moves the cut.
    for (factor, cut) in [(1.0, 0.0), (0.75, 1.0 / 3.0), (0.4, 2.0)] {
        let mut scene = sheet(Material { base_color: Vec4::new(1.0, 1.0, 1.0, factor), ..masked() }, None, 0.0, 1.0);
        scene.meshes[0].colors =
            scene.meshes[0].positions.iter().map(|p| Vec4::new(1.0, 1.0, 1.0, 0.5 * (p.x + 1.0))).collect();
        let tracer = Tracer::new(&scene).unwrap();
        for x in [-0.9, -0.1, 0.1, 0.3, 0.4, 0.9] {
            let v = visibility_on_floor(&tracer, &high_sun(0.0), &[Vec3::new(x, 0.0, 0.2)])[0];
            assert_eq!(v, if x > cut { 0.0 } else { 1.0 }, "{factor} {x}");
        }
    }
}

#[test]
fn settled_masks_cost_nothing() {
    let solid = image_of(32, Wrap::Repeat, |_, _| [0, 0, 0, 255]);
    let tracer = Tracer::new(&sheet(masked(), Some(solid), 0.0, 3.0)).unwrap();
    assert!(tracer.geometry().surfaces.masked.is_empty());
    assert_eq!(tracer.triangle_count(), 2);
    let hole = image_of(32, Wrap::Repeat, |_, _| [0, 0, 0, 127]);
    let tracer = Tracer::new(&sheet(masked(), Some(hole), 0.0, 3.0)).unwrap();
    assert_eq!(tracer.triangle_count(), 0);
    // Half of the image is solid: a triangle within that half is opaque.
    let half = image_of(64, Wrap::Clamp, |x, _| [0, 0, 0, if x < 32 { 255 } else { 0 }]);
    let tracer = Tracer::new(&sheet(masked(), Some(half), 0.01, 0.2)).unwrap();
    assert!(tracer.geometry().surfaces.masked.is_empty() && tracer.triangle_count() == 2);
}

#[test]
fn masked_soup_equals_brute_force() {
    let holes = image_of(16, Wrap::Repeat, |x, y| [255, 255, 255, (hash_u32(x + 16 * y) >> 24) as u8]);
    let mut scene = sheet(masked(), Some(holes), 0.0, 2.0);
    let triangles = soup(200, 0.8, 0.3, 5);
    let mesh = add_mesh(&mut scene, &triangles, Material { base_color_image: Some(0), ..masked() });
    scene.meshes[mesh].uvs = (0..600).map(|i| Vec2::new((i % 3) as f32, (i % 2) as f32)).collect();
    let receivers: Vec<_> =
        (0..6).map(|i| ReceiverPoint::new(Vec3::new(0.2 * i as f32 - 0.5, -1.0, 0.1), Vec3::Y)).collect();
    super::brute_force::check_bits_only(&scene, &receivers, &super::brute_force::all_lights(), 256);
}

#[test]
fn translucent_surfaces_multiply_once_each() {
    // Three panes: two of them overlap above the receiver, and both splits of each count once. The material passes
    // 1 − 0.8·(1 − tint).
    let color = Vec4::new(1.0, 0.5, 0.0, 0.8);
    let glass = Material { base_color: color, alpha: AlphaMode::Blend, transmission: 1.0, ..Material::default() };
    let pane = 1.0 - 0.8 * (1.0 - Vec3::new(1.0, 0.5, 0.0));
    let mut scene = sheet(glass.clone(), None, 0.0, 1.0);
    let second = parallelogram(Vec3::new(-50.0, 1.5, -50.0), Vec3::X * 100.0, Vec3::Z * 100.0);
    add_mesh(&mut scene, &second, glass);
    let tracer = Tracer::new(&scene).unwrap();
    assert_eq!(tracer.channels(), 3);
    let [both, second] = [0.07, 4.0].map(|x| through(&tracer, Vec3::new(x, 0.0, -0.031), 0.2));
    assert!(both.abs_diff_eq(pane * pane, 1e-5), "{both}");
    assert!(second.abs_diff_eq(pane, 1e-5), "{second}");
}

/// Light that reaches a point of the floor from a square light 3 m up.
fn through(tracer: &Tracer, at: Vec3, light_size_m: f32) -> Vec3 {
    let light = Light::new(square(light_size_m), Vec3::Y * 3.0, Vec3::ZERO);
    let points = [ReceiverPoint::new(at, Vec3::Y)];
    let image = tracer.visibility_at(&points, &light, &VisibilityOptions::default(), &|_| {}, &never()).unwrap();
    Vec3::from(image.values[0])
}

#[test]
fn blended_surfaces_cover_whatever_their_colour() {
    let red = |alpha| Material {
        base_color: Vec4::new(1.0, 0.0, 0.0, alpha),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    for alpha in [0.0, 0.25, 0.5, 1.0] {
        let tracer = Tracer::new(&sheet(red(alpha), None, 0.0, 1.0)).unwrap();
        assert_eq!(tracer.channels(), 1, "what covers does not tint");
        let v = through(&tracer, Vec3::ZERO, 0.2);
        assert!(v.abs_diff_eq(Vec3::splat(1.0 - alpha), 1e-5), "{alpha}: {v}");
    }
    // Alpha of a texture and of vertices multiply; a triangle with product 1 equals an opaque one.
    let image = image_of(64, Wrap::Clamp, |x, _| [0, 255, 0, if x < 32 { 255 } else { 51 }]);
    let tracer = Tracer::new(&sheet(red(0.5), Some(image.clone()), 0.0, 1.0)).unwrap();
    for (x, passes) in [(-0.5, 0.5), (0.5, 0.9)] {
        let v = through(&tracer, Vec3::X * x, 0.001);
        assert!(v.abs_diff_eq(Vec3::splat(passes), 1e-5), "{x}: {v}");
    }
    let mut scene = sheet(red(1.0), Some(image), 0.01, 0.2);
    let tracer = Tracer::new(&scene).unwrap();
    assert!(tracer.geometry().translucents.is_empty() && tracer.triangle_count() == 2);
    scene.meshes[0].colors = vec![Vec4::new(1.0, 1.0, 1.0, 0.5); scene.meshes[0].positions.len()];
    let v = through(&Tracer::new(&scene).unwrap(), Vec3::ZERO, 0.2);
    assert!(v.abs_diff_eq(Vec3::splat(0.5), 1e-5), "{v}");
}

#[test]
fn masked_glass_tints_where_it_is_and_eyes_see_through_its_holes() {
    let hole = image_of(4, Wrap::Clamp, |x, _| [255, 255, 255, if x < 2 { 255 } else { 0 }]);
    let color = Vec4::new(1.0, 0.5, 0.0, 1.0);
    let tracer =
        Tracer::new(&sheet(Material { base_color: color, transmission: 1.0, ..masked() }, Some(hole), 0.0, 1.0));
    let tracer = tracer.unwrap();
    for (x, passes) in [(-0.5, Vec3::new(1.0, 0.5, 0.0)), (0.5, Vec3::ONE)] {
        let v = through(&tracer, Vec3::X * x, 0.001);
        assert!(v.abs_diff_eq(passes, 1e-5), "{x}: {v}");
        assert_eq!(tracer.first_hit(Vec3::new(x, 4.0, 0.0), -Vec3::Y, 0.0).is_some(), x < 0.0);
    }
}

#[test]
fn a_solid_absorbs_over_its_thickness_once() {
    let red = Material {
        transmission: 1.0,
        volume: Some(antumbra_scene::Volume {
            thickness_m: 0.1,
            thickness_image: None,
            attenuation_color: Vec3::new(1.0, 0.1, 0.1),
            attenuation_distance_m: 0.1,
        }),
        ..Material::default()
    };
    // Two faces of a slab, then one.
    let mut scene = sheet(red.clone(), None, 0.0, 1.0);
    scene.meshes[0].closed = true;
    let back = parallelogram(Vec3::new(-1.0, 0.9, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let back = add_mesh(&mut scene, &back, red);
    scene.meshes[back].closed = true;
    let v = through(&Tracer::new(&scene).unwrap(), Vec3::new(0.07, 0.0, -0.031), 0.2);
    assert!(v.abs_diff_eq(Vec3::new(1.0, 0.1, 0.1), 1e-5), "{v}");
    scene.meshes[0].closed = false;
    scene.instances.truncate(1);
    let v = through(&Tracer::new(&scene).unwrap(), Vec3::new(0.07, 0.0, -0.031), 0.2);
    assert!(v.abs_diff_eq(Vec3::new(1.0, 0.1, 0.1), 1e-5), "{v}");
}

#[test]
fn tint_over_half_of_the_light_averages() {
    // A textured, transmitting pane whose edge halves the light: the mean of 1 and its transmittance.
    let image = image_of(4, Wrap::Repeat, |_, _| [255, 0, 255, 255]);
    let glass = Material { transmission: 0.9, ..Material::default() };
    let mut scene = sheet(glass, Some(image), 0.0, 1.0);
    for p in &mut scene.meshes[0].positions {
        p.x += 1.0;
    }
    let tracer = Tracer::new(&scene).unwrap();
    let light = Light::new(square(0.5), Vec3::Y * 3.0, Vec3::ZERO);
    let points = [ReceiverPoint::new(Vec3::ZERO, Vec3::Y)];
    let image = tracer.visibility_at(&points, &light, &VisibilityOptions::default(), &|_| {}, &never()).unwrap();
    assert!(Vec3::from(image.values[0]).abs_diff_eq(Vec3::new(0.95, 0.5, 0.95), 0.01), "{:?}", image.values[0]);
}

#[test]
fn opaque_things_behind_glass_still_block() {
    let glass = Material { transmission: 1.0, ..Material::default() };
    let mut scene = sheet(glass, None, 0.0, 1.0);
    add_mesh(&mut scene, &parallelogram(Vec3::new(-1.0, 1.2, -1.0), Vec3::X, Vec3::Z * 2.0), Material::default());
    let tracer = Tracer::new(&scene).unwrap();
    let points = [-0.5, 0.5].map(|x| ReceiverPoint::new(Vec3::new(x, 0.0, 0.0), Vec3::Y));
    let light = high_sun(0.01);
    let image = tracer.visibility_at(&points, &light, &VisibilityOptions::default(), &|_| {}, &never()).unwrap();
    assert_eq!(image.values[0], [0.0; 3]);
    assert!((image.values[1][0] - 1.0).abs() < 1e-5, "a white tint takes nothing away: {:?}", image.values[1]);
}

#[test]
fn primary_rays_see_through_holes_and_stop_at_glass() {
    let hole = image_of(4, Wrap::Clamp, |x, _| [255, 255, 255, if x < 2 { 255 } else { 0 }]);
    let mut scene = sheet(masked(), Some(hole), 0.0, 1.0);
    add_mesh(
        &mut scene,
        &parallelogram(Vec3::new(-5.0, 0.0, -5.0), Vec3::X * 10.0, Vec3::Z * 10.0),
        Material::default(),
    );
    let clear = Material { base_color: Vec4::new(1.0, 1.0, 1.0, 0.0), alpha: AlphaMode::Blend, ..Material::default() };
    add_mesh(&mut scene, &parallelogram(Vec3::new(-1.0, 2.0, 0.5), Vec3::X * 2.0, Vec3::Z * 0.5), clear);
    let tracer = Tracer::new(&scene).unwrap();
    let height = |x: f32, z: f32| {
        let hit = tracer.first_hit(Vec3::new(x, 4.0, z), -Vec3::Y, 0.0).unwrap();
        assert_eq!(hit.normal, Vec3::Y);
        (hit.position.y, hit.instance)
    };
    assert_eq!(height(-0.5, 0.0), (1.0, 0));
    assert_eq!(height(0.5, 0.0), (0.0, 1));
    assert_eq!(height(0.5, 0.7), (2.0, 2));
}
