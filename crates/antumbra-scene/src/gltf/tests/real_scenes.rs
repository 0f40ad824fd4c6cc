//! Test scenes have the triangle counts, bounds and materials that their README lists.

use glam::Vec3;

use super::{scenes_folder, unsound};
use crate::gltf::{Limits, Loaded, Pose, load_file};

/// Files with vertices that no triangle uses: the README's bounds include them, a scene's do not. The leaves of this one
/// have 129 168 vertices and indices that end at 65 535.
const COUNTS_UNUSED_VERTICES: &[&str] = &["tree-oak-masked.glb"];

/// A row of the README's tables.
struct Row {
    file: String,
    triangles: usize,
    min: Vec3,
    max: Vec3,
    mask: bool,
    blend: bool,
    closed: bool,
}

fn rows(readme: &str) -> Vec<Row> {
    let vec3 = |text: &str| {
        let numbers: Vec<f32> = text.split(',').map(|n| n.trim().parse().unwrap()).collect();
        Vec3::from_slice(&numbers)
    };
    readme
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let (min, max) = cells[4].split_once(';').unwrap();
            Row {
                file: cells[0].split('`').nth(1).unwrap().into(),
                triangles: cells[3].replace(',', "").parse().unwrap(),
                min: vec3(min),
                max: vec3(max),
                mask: cells[5] == "yes",
                blend: cells[6] == "yes",
                closed: cells[8] == "yes",
            }
        })
        .collect()
}

#[test]
fn counts_and_bounds_are_those_of_the_readme() {
    let Some(folder) = scenes_folder() else { return };
    let rows = rows(&std::fs::read_to_string(folder.join("README.md")).unwrap());
    assert!(rows.len() > 20);
    let mut failures = Vec::new();
    for row in &rows {
        let mut check = |ok: bool, what: String| {
            if !ok {
                failures.push(format!("{}: {what}", row.file));
            }
        };
        let scene = match load_file(&folder.join(&row.file), Pose::Rest, Limits::GENEROUS) {
            Ok(loaded) => loaded.scene,
            Err(e) => {
                check(false, e.to_string());
                continue;
            }
        };
        check(unsound(&scene).is_none(), format!("{:?}", unsound(&scene)));
        check(scene.warnings.is_empty(), scene.warnings.join("; "));
        check(scene.triangle_count() == row.triangles, format!("{} triangles", scene.triangle_count()));
        let bounds = scene.bounds();
        // The README rounds to a centimetre.
        const ROUNDING_M: f32 = 0.0051;
        let near = if COUNTS_UNUSED_VERTICES.contains(&row.file.as_str()) {
            bounds.min.cmpge(row.min - ROUNDING_M).all() && bounds.max.cmple(row.max + ROUNDING_M).all()
        } else {
            bounds.min.abs_diff_eq(row.min, ROUNDING_M) && bounds.max.abs_diff_eq(row.max, ROUNDING_M)
        };
        check(near, format!("bounds {} {} against {} {}", bounds.min, bounds.max, row.min, row.max));
        let used =
            |mode: fn(&crate::AlphaMode) -> bool| scene.meshes.iter().any(|m| mode(&scene.materials[m.material].alpha));
        check(used(|a| matches!(a, crate::AlphaMode::Mask { .. })) == row.mask, "mask".into());
        check(used(|a| matches!(a, crate::AlphaMode::Blend)) == row.blend, "blend".into());
        // The README judges the whole file, but `closed` is a property of each mesh.
        if let ([mesh], [_]) = (&scene.meshes[..], &scene.instances[..]) {
            check(mesh.closed == row.closed, format!("closed: {}", mesh.closed));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A scene at another time, without images, equals the scene loaded at that time: skins, nodes and morph targets.
#[test]
fn animated_scenes_are_had_at_other_times() {
    let Some(folder) = scenes_folder() else { return };
    let mut moved = 0;
    for file in ["cesium-man.glb", "fox.glb", "cesium-milk-truck.glb", "morph-stress-test.glb"] {
        let at = |time_s: f32| load_file(&folder.join(file), Pose::At(time_s), Limits::GENEROUS).unwrap();
        let Loaded { scene: first, animations } = at(0.0);
        let animations = animations.expect("it is animated");
        for part in [0.3, 1.0] {
            let [from_s, to_s] = animations.ends_s();
            let time_s = from_s + part * (to_s - from_s);
            let (posed, mut loaded) = (animations.scene_at(time_s).unwrap(), at(time_s).scene);
            assert!(posed.images.is_empty() && loaded.images.len() == first.images.len());
            loaded.images.clear();
            assert!(format!("{posed:?}") == format!("{loaded:?}"), "{file} at {time_s} s");
            moved += usize::from(
                posed.world_triangles().zip(first.world_triangles()).any(|(a, b)| a.positions != b.positions),
            );
        }
    }
    assert!(moved >= 4, "nothing moves");
}
