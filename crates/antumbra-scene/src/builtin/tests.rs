//! Every built-in scene is sound: counts, closed meshes, finite numbers, a light and a camera that see it.

use std::collections::HashMap;

use glam::{UVec2, Vec2, Vec3};

use super::*;
use crate::{AlphaMode, Mesh};

fn scenes() -> impl Iterator<Item = (&'static BuiltinInfo, Scene)> {
    NAMES.iter().map(|info| (info, build(info.name).expect(info.name)))
}

/// Joins equal positions; returns the directed edges that have no opposite, or occur twice.
fn stray_edges(mesh: &Mesh) -> usize {
    let mut ids: HashMap<[u32; 3], u32> = HashMap::new();
    let joined: Vec<u32> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = ids.len() as u32;
            // Adding zero turns −0 into 0.
            *ids.entry(p.to_array().map(|v| (v + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(mesh.indices.len());
    for t in mesh.indices.chunks_exact(3) {
        let t = [t[0], t[1], t[2]].map(|i| joined[i as usize]);
        edges.extend([(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    }
    edges.sort_unstable();
    let repeated = edges.windows(2).filter(|pair| pair[0] == pair[1]).count();
    let unmatched = edges.iter().filter(|(a, b)| a == b || edges.binary_search(&(*b, *a)).is_err()).count();
    repeated + unmatched
}

#[test]
fn counts_are_as_listed() {
    let wrong: Vec<String> = scenes()
        .filter(|(info, scene)| scene.triangle_count() != info.triangles)
        .map(|(info, scene)| format!("{} has {}", info.name, scene.triangle_count()))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join(", "));
}

#[test]
fn meshes_are_well_formed() {
    for (info, scene) in scenes() {
        for mesh in &scene.meshes {
            let what = format!("{}: {}", info.name, mesh.name);
            assert!(!mesh.indices.is_empty() && mesh.indices.len().is_multiple_of(3), "{what}");
            assert!(mesh.indices.iter().all(|i| (*i as usize) < mesh.positions.len()), "{what}");
            assert_eq!(mesh.normals.len(), mesh.positions.len(), "{what}");
            assert!(mesh.uvs.is_empty() || mesh.uvs.len() == mesh.positions.len(), "{what}");
            assert!(mesh.colors.is_empty() || mesh.colors.len() == mesh.positions.len(), "{what}");
            assert!(mesh.material < scene.materials.len(), "{what}");
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{what}");
            assert!(mesh.uvs.iter().all(|p| p.is_finite()), "{what}");
            assert!(
                mesh.colors.iter().all(|c| c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= 1.0),
                "{what}"
            );
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "{what}");
        }
        for instance in &scene.instances {
            assert!(instance.mesh < scene.meshes.len(), "{}", info.name);
            assert!(instance.world_from_object.is_finite(), "{}", info.name);
        }
        for material in &scene.materials {
            let c = material.base_color;
            assert!(c.min_element() >= 0.0 && c.max_element() <= 1.0, "{}: {} {c}", info.name, material.name);
        }
        let is_opaque = scene.materials.iter().all(|m| m.alpha == AlphaMode::Opaque && m.transmission == 0.0);
        assert_eq!(is_opaque, info.opaque, "{}", info.name);
        assert!(scene.warnings.is_empty(), "{}", info.name);
    }
}

#[test]
fn closed_meshes_are_closed_and_open_ones_are_not() {
    for (info, scene) in scenes() {
        for mesh in &scene.meshes {
            assert_eq!(mesh.closed, stray_edges(mesh) == 0, "{}: {}: {}", info.name, mesh.name, stray_edges(mesh));
        }
    }
}

#[test]
fn closed_meshes_face_outwards() {
    for (info, scene) in scenes() {
        for mesh in scene.meshes.iter().filter(|mesh| mesh.closed) {
            // Six times the enclosed volume, by the divergence theorem, about a corner of the mesh for precision.
            let origin = mesh.positions[0];
            let corner = |i: u32| (mesh.positions[i as usize] - origin).as_dvec3();
            let volume: f64 =
                mesh.indices.chunks_exact(3).map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2])))).sum();
            assert!(volume > 0.0, "{}: {}: {volume}", info.name, mesh.name);
        }
    }
}

#[test]
fn shading_normals_agree_with_winding() {
    for (info, scene) in scenes() {
        for mesh in &scene.meshes {
            let mut opposed = 0;
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
                let face = (b - a).cross(c - a).normalize_or_zero();
                let mean: Vec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
                opposed += usize::from(face.dot(mean) < 0.0);
            }
            // A bent leaf may turn one of its triangles from the normal of the whole.
            assert!(opposed * 100 <= mesh.indices.len() / 3, "{}: {}: {opposed}", info.name, mesh.name);
        }
    }
}

#[test]
fn two_builds_are_equal() {
    for (info, scene) in scenes() {
        let again = build(info.name).unwrap();
        assert_eq!(scene.meshes.len(), again.meshes.len(), "{}", info.name);
        for (a, b) in scene.meshes.iter().zip(&again.meshes) {
            assert!(a.positions == b.positions && a.indices == b.indices && a.colors == b.colors, "{}", info.name);
        }
        for (a, b) in scene.instances.iter().zip(&again.instances) {
            assert!(a.mesh == b.mesh && a.world_from_object == b.world_from_object, "{}", info.name);
        }
    }
}

#[test]
fn the_camera_sees_the_scene() {
    for (info, scene) in scenes() {
        let bounds = scene.bounds();
        let camera = scene.cameras[0];
        let size_px = UVec2::new(16, 9);
        let hits = |pos_px: Vec2| {
            let direction = camera.ray_direction(size_px, pos_px);
            let (a, b) = ((bounds.min - camera.eye) / direction, (bounds.max - camera.eye) / direction);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            near.max(0.0) <= far
        };
        let pixels = (0..16).flat_map(|x| (0..9).map(move |y| Vec2::new(x as f32 + 0.5, y as f32 + 0.5)));
        let seen = pixels.filter(|p| hits(*p)).count();
        assert!(seen > 72, "{}: {seen} of 144 rays meet the scene's box", info.name);
    }
}

/// Scenes with geometry beside or behind their light.
const AROUND_THEIR_LIGHT: [&str; 3] = ["lamp-room", "hall", "staircase"];

#[test]
fn scenes_are_in_front_of_their_light() {
    for (info, scene) in scenes().filter(|(info, _)| !AROUND_THEIR_LIGHT.contains(&info.name)) {
        assert!(!scene.lights.is_empty(), "{}", info.name);
        for light in &scene.lights {
            light.validate().expect(info.name);
            if light.is_distant() {
                continue;
            }
            let behind = scene
                .instances
                .iter()
                .flat_map(|i| scene.meshes[i.mesh].positions.iter().map(|p| i.world_from_object.transform_point3(*p)))
                .filter(|p| (*p - light.center).dot(light.axis) <= light.bounding_radius())
                .count();
            assert_eq!(behind, 0, "{}: vertices behind the plane of light `{}`", info.name, light.name);
        }
    }
}

#[test]
fn no_triangle_is_degenerate() {
    for (info, scene) in scenes() {
        for mesh in &scene.meshes {
            let thin = mesh.indices.chunks_exact(3).filter(|t| {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
                (b - a).cross(c - a).length() < 1e-9
            });
            assert_eq!(thin.count(), 0, "{}: {}", info.name, mesh.name);
        }
    }
}

#[test]
fn the_knot_has_as_many_triangles_as_asked_for() {
    for asked in [1_000, 12_345, 300_000, 4_000_000] {
        let scene = build(&format!("knot?triangles={asked}")).unwrap();
        let ratio = scene.triangle_count() as f64 / f64::from(asked);
        assert!((ratio - 1.0).abs() < 0.01, "{asked}: {}", scene.triangle_count());
        assert!(scene.meshes.iter().all(|mesh| asked > 300_000 || stray_edges(mesh) == 0), "{asked}");
    }
}

#[test]
fn both_fences_have_the_same_holes() {
    let alpha = build("fence-alpha").unwrap();
    let image = &alpha.images[0];
    let covered = image.rgba8.iter().filter(|texel| texel[3] >= 128).count() as f64 / image.rgba8.len() as f64;
    // Two wires of width w cross a diamond of side a: their length is 2 √2 a; the crossings count once.
    let (width, side) = (2.0 * 0.005f64, 0.12f64);
    let expected = (2.0 * 2f64.sqrt() * side * width - 2.0 * width * width) / (side * side);
    assert!((covered - expected).abs() < 0.01, "{covered} of the tile is wire, {expected} expected");
}

#[test]
fn specifications_are_checked() {
    let message = |spec: &str| build(spec).expect_err(spec).to_string();
    assert!(message("overlaps").starts_with("there is no built-in scene `overlaps`; nearest: overlap, "));
    assert_eq!(message("overlap?x=1"), "built-in scene `overlap` has no parameter `x`; available: none");
    assert_eq!(
        message("spheres?light_elevation_deg=2"),
        "built-in scene `spheres`: `light_elevation_deg` is `2`, and must be a number from 5 to 90 degrees"
    );
    for spec in ["spheres?light_elevation_deg", "spheres?light_elevation_deg=9&light_elevation_deg=8"] {
        assert!(message(spec).contains("is not of the form `key=value`"), "{spec}");
    }
    assert!(message("spheres?light_elevation_deg=NaN").contains("must be a number"));
    assert_eq!(
        message("spheres?elevation=9"),
        "built-in scene `spheres` has no parameter `elevation`; available: `light_elevation_deg` (a number from 5 to 90 \
         degrees, default 40)"
    );
}

#[test]
fn the_light_rises_to_the_elevation_asked_for() {
    for scene in ["spheres", "tilted-planes"] {
        for elevation in [5.0f32, 40.0, 90.0] {
            let scene = build(&format!("{scene}?light_elevation_deg={elevation}")).unwrap();
            let light = &scene.lights[0];
            light.validate().unwrap();
            assert!(((-light.axis.y).asin().to_degrees() - elevation).abs() < 0.1);
            // All of it shines from above the ground.
            let low = light.center.y - 0.5 * 0.5;
            assert!(low > 0.1, "{low}");
        }
    }
}
