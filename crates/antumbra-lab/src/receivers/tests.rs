//! Tests of receivers against traced rays: same point, same normal, same holes.

use antumbra_scene::{AlphaMode, Image, Instance, Material, Mesh, Scene, WorldTriangle, Wrap};
use glam::{DVec3, EulerRot, Mat4, Quat, Vec2};

use super::*;
use crate::device::DeviceOptions;
use crate::readback::{read_buffer, read_rgba32f, read_rgba32u};
use crate::test_support::{camera_at, lab_or_skip, quad};

const SIZE: UVec2 = UVec2::new(96, 64);

/// Intersection of a ray and a triangle: distance, and barycentric weights of the second and third corner.
struct Hit {
    t: f64,
    barycentric: Vec2,
    triangle: WorldTriangle,
    /// Smallest barycentric weight, which measures the distance from the triangle's edges.
    inside: f64,
}

/// Returns the nearest hit that `hits_at` accepts, in double precision; `None` without one.
fn first_hit(scene: &Scene, origin: Vec3, direction: Vec3, hits_at: impl Fn(&Hit) -> bool) -> Option<Hit> {
    let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3());
    let meet = |triangle: WorldTriangle| {
        let [a, b, c] = triangle.positions.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a);
        let t = (a - origin).dot(normal) / direction.dot(normal);
        let x = origin + t * direction;
        let weight = |p: DVec3, q: DVec3| (q - p).cross(x - p).dot(normal) / normal.length_squared();
        let (u, v) = (weight(c, a), weight(a, b));
        let inside = (1.0 - u - v).min(u).min(v);
        (t > 0.0 && inside >= 0.0).then_some(Hit { t, barycentric: Vec2::new(u as f32, v as f32), triangle, inside })
    };
    scene.world_triangles().filter_map(meet).filter(hits_at).min_by(|a, b| a.t.total_cmp(&b.t))
}

fn base_color(scene: &Scene, hit: &Hit) -> Vec4 {
    let mesh = &scene.meshes[scene.instances[hit.triangle.instance as usize].mesh];
    scene.base_color_at(mesh, hit.triangle.triangle, hit.barycentric)
}

/// Returns a floor, a tilted and a mirrored copy of it, and one seen from behind.
fn planes() -> Scene {
    let pose = |scale: Vec3, x: f32, z: f32, at: Vec3| {
        let turn = Quat::from_euler(EulerRot::XYZ, x, 0.0, z);
        Instance { mesh: 0, world_from_object: Mat4::from_scale_rotation_translation(scale, turn, at) }
    };
    Scene {
        meshes: vec![quad(1.0)],
        materials: vec![Material::default()],
        instances: vec![
            pose(Vec3::splat(6.0), 0.0, 0.0, Vec3::ZERO),
            pose(Vec3::new(0.7, 1.0, 1.3), 0.4, 0.3, Vec3::new(1.0, 0.8, 0.0)),
            pose(Vec3::new(-0.5, 1.0, 0.5), 0.2, -0.6, Vec3::new(-1.2, 0.9, 0.5)),
            pose(Vec3::splat(0.4), 2.8, 0.1, Vec3::new(0.0, 1.2, 1.0)),
        ],
        ..Scene::default()
    }
}

#[test]
fn positions_and_normals_are_those_of_the_rays() {
    let Some(lab) = lab_or_skip() else { return };
    let scene = planes();
    let camera = camera_at(Vec3::new(2.0, 3.0, 5.0));
    let uploaded = GpuScene::upload(lab, &scene);
    let images = ReceiverPass::new(lab).render(lab, &uploaded, &camera, SIZE, Layer::FirstHits).unwrap();
    let positions = images.read_positions(lab).unwrap();
    let normals = read_rgba32f(lab, &images.geometric_normal).unwrap();
    let snapped_px = read_buffer::<f32>(lab, lab.snapped_texels(), 1).unwrap()[0];
    let pixel_m_per_m = 2.0 * (0.5 * camera.fov_y_rad).tan() / SIZE.y as f32;
    let mut seen = [0; 4];
    for (i, (position, normal)) in positions.iter().zip(&normals).enumerate() {
        let pixel = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        let direction = camera.ray_direction(SIZE, pixel.as_vec2() + 0.5);
        let hit = first_hit(&scene, camera.eye, direction, |_| true);
        let Some(hit) = hit else {
            assert!(position.is_none() && normal[3] == 0.0, "{pixel} sees {position:?}, and no ray does");
            continue;
        };
        // On an edge between two triangles, either may be shown.
        if hit.inside < 1e-3 {
            continue;
        }
        seen[hit.triangle.instance as usize] += 1;
        let expected = (camera.eye.as_dvec3() + hit.t * direction.as_dvec3()).as_vec3();
        let got = position.unwrap();
        let [a, b, c] = hit.triangle.positions.map(|p| p.as_dvec3());
        let exact = (b - a).cross(c - a).normalize();
        let exact = if exact.dot(direction.as_dvec3()) > 0.0 { -exact } else { exact };
        // The rasteriser may displace the surface by a fraction of a pixel in both directions, which is more along a grazing ray.
        let moved_m = 1.5 * snapped_px * pixel_m_per_m * hit.t as f32 / -exact.dot(direction.as_dvec3()) as f32;
        assert!(got.distance(expected) < 3e-6 * hit.t as f32 + moved_m, "{pixel}: {got} against {expected}");
        let got = Vec4::from(*normal).truncate().as_dvec3();
        assert!(got.distance(exact) < 1e-6 && normal[3] == 1.0, "{pixel}: {got} against {exact}");
        assert!(images.bounds.unwrap().min.cmple(expected).all() && images.bounds.unwrap().max.cmpge(expected).all());
    }
    assert!(seen.iter().all(|n| *n > 10), "{seen:?}");
}

/// Returns a fence: opaque bars in a texture with soft edges, tiled twice.
fn fence(alpha: AlphaMode) -> Scene {
    let texel = |i: u32| [255, 255, 255, if i % 8 < 3 { 255 } else { 40 * (i % 5) as u8 }];
    let image = Image { width: 8, height: 8, rgba8: (0..64).map(texel).collect(), wrap: [Wrap::Repeat, Wrap::Mirror] };
    let mut mesh = quad(1.0);
    mesh.uvs.iter_mut().for_each(|uv| *uv *= 2.0);
    mesh.colors = [1.0, 0.9, 1.0, 0.7].map(|a| Vec4::new(1.0, 1.0, 1.0, a)).to_vec();
    let material = Material { alpha, base_color_image: Some(0), ..Material::default() };
    let instance = Instance { mesh: 0, world_from_object: Mat4::from_rotation_x(0.9) };
    Scene {
        meshes: vec![mesh],
        materials: vec![material],
        images: vec![image],
        instances: vec![instance],
        ..Scene::default()
    }
}

/// A deformed mesh is drawn as if uploaded deformed, also when its vertices follow another mesh's in shared buffers.
#[test]
fn what_is_bent_is_drawn_as_if_it_had_been_uploaded_so() {
    let Some(lab) = lab_or_skip() else { return };
    let mut before = planes();
    before.meshes.push(quad(1.0));
    before.instances[1].mesh = 1;
    let mut after = before.clone();
    after.meshes[1].positions.iter_mut().for_each(|p| *p += Vec3::new(0.0, 0.3 * p.x, 0.0));
    let camera = camera_at(Vec3::new(2.0, 3.0, 5.0));
    let positions = |scene: &GpuScene| {
        let images = ReceiverPass::new(lab).render(lab, scene, &camera, SIZE, Layer::FirstHits).unwrap();
        images.read_positions(lab).unwrap()
    };
    let mut bent = GpuScene::upload(lab, &before);
    let straight = positions(&bent);
    assert!(bent.repose(lab, &before, &after), "built alike");
    let got = positions(&bent);
    assert_eq!(got, positions(&GpuScene::upload(lab, &after)));
    let moved = got.iter().zip(&straight).filter(|(got, straight)| got != straight).count();
    assert!(moved > 50, "{moved} pixels show that it was bent");
}

#[test]
fn masked_holes_are_where_the_definition_has_them() {
    let Some(lab) = lab_or_skip() else { return };
    let cutoff = 0.5;
    let scene = fence(AlphaMode::Mask { cutoff });
    let camera = camera_at(Vec3::new(0.3, 1.0, 3.0));
    let uploaded = GpuScene::upload(lab, &scene);
    let images = ReceiverPass::new(lab).render(lab, &uploaded, &camera, SIZE, Layer::FirstHits).unwrap();
    let positions = images.read_positions(lab).unwrap();
    let (mut holes, mut solid) = (0, 0);
    for (i, position) in positions.iter().enumerate() {
        let pixel = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        let direction = camera.ray_direction(SIZE, pixel.as_vec2() + 0.5);
        let Some(hit) = first_hit(&scene, camera.eye, direction, |hit| hit.inside > 1e-3) else { continue };
        let alpha = base_color(&scene, &hit).w;
        // Hardware filters texels with 8-bit weights.
        if (alpha - cutoff).abs() < 0.01 {
            continue;
        }
        assert_eq!(position.is_some(), alpha >= cutoff, "{pixel}: alpha {alpha}");
        if alpha >= cutoff { solid += 1 } else { holes += 1 }
    }
    assert!(holes > 100 && solid > 100, "{holes} holes, {solid} solid");
}

#[test]
fn translucent_surfaces_are_first_hits_and_the_layer_behind_is_without_them() {
    let Some(lab) = lab_or_skip() else { return };
    let mut scene = fence(AlphaMode::Blend);
    scene.materials.push(Material::default());
    scene.meshes.push(Mesh { material: 1, ..quad(2.0) });
    let behind = Mat4::from_translation(Vec3::new(0.0, 0.0, -2.0)) * Mat4::from_rotation_x(1.5);
    scene.instances.push(Instance { mesh: 1, world_from_object: behind });
    let uploaded = GpuScene::upload(lab, &scene);
    let camera = camera_at(Vec3::new(0.0, 1.0, 3.0));
    let pass = ReceiverPass::new(lab);
    let middle = (SIZE.y / 2 * SIZE.x + SIZE.x / 2) as usize;
    let distance = |layer| {
        let images = pass.render(lab, &uploaded, &camera, SIZE, layer).unwrap();
        images.read_positions(lab).unwrap()[middle].unwrap().distance(camera.eye)
    };
    assert!(distance(Layer::FirstHits) < 3.5);
    assert!(distance(Layer::BehindTranslucent) > 4.0);
}

/// Base colour is right for meshes without texture coordinates, with constant ones, and with ones along a line, as for palettes.
#[test]
fn surfaces_have_their_colour_where_texture_coordinates_stand_still() {
    let Some(lab) = lab_or_skip() else { return };
    let texel = [64, 128, 192, 255];
    let image = Image { width: 4, height: 4, rgba8: vec![texel; 16], wrap: [Wrap::Repeat; 2] };
    let camera = camera_at(Vec3::new(0.3, 3.0, 1.0));
    let all = quad(1.0).uvs;
    for uvs in [Vec::new(), vec![Vec2::new(0.3, 0.6); 4], all.iter().map(|uv| Vec2::new(uv.x, 0.6)).collect(), all] {
        let material = Material { base_color_image: Some(0), ..Material::default() };
        let scene = Scene {
            meshes: vec![Mesh { uvs: uvs.clone(), ..quad(1.0) }],
            materials: vec![material],
            images: vec![image.clone()],
            instances: vec![Instance { mesh: 0, world_from_object: Mat4::IDENTITY }],
            ..Scene::default()
        };
        let uploaded = GpuScene::upload(lab, &scene);
        let images = ReceiverPass::new(lab).render(lab, &uploaded, &camera, SIZE, Layer::FirstHits).unwrap();
        let middle = (SIZE.y / 2 * SIZE.x + SIZE.x / 2) as usize;
        let stored = read_rgba32u(lab, &images.surface).unwrap()[middle][0].to_le_bytes();
        let color = scene.base_color_at(&scene.meshes[0], 0, Vec2::splat(0.3));
        // Stored as square roots of linear colours, with opacity.
        let expected = [color.x.sqrt(), color.y.sqrt(), color.z.sqrt(), 1.0].map(|v| (255.0 * v).round() as u8);
        assert!(stored.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{uvs:?}: {stored:?}, not {expected:?}");
    }
}

#[test]
fn an_empty_scene_is_all_background() {
    let Some(lab) = lab_or_skip() else { return };
    let uploaded = GpuScene::upload(lab, &Scene::default());
    let camera = camera_at(Vec3::ONE);
    let images = ReceiverPass::new(lab).render(lab, &uploaded, &camera, UVec2::ONE, Layer::FirstHits).unwrap();
    assert_eq!(images.bounds, None);
    assert_eq!(read_f32(lab, &images.depth).unwrap(), [0.0]);
}

#[test]
fn a_size_that_no_texture_can_have_is_an_error() {
    if lab_or_skip().is_none() {
        return;
    }
    // A separate device, because this test provokes errors.
    let lab = LabDevice::new(&DeviceOptions::default()).unwrap();
    let uploaded = GpuScene::upload(&lab, &planes());
    for size in [UVec2::ZERO, UVec2::new(lab.device.limits().max_texture_dimension_2d + 1, 1)] {
        let images = ReceiverPass::new(&lab).render(&lab, &uploaded, &camera_at(Vec3::ONE), size, Layer::FirstHits);
        assert!(matches!(images, Err(DeviceError::Failed { .. })), "{size}: {images:?}");
    }
}
