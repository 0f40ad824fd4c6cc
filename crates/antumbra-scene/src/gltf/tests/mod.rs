//! Tests of the loader with good, odd and broken files.

mod bombs;
mod broken;
mod features;
mod mutations;
mod real_scenes;
mod surfaces;

use std::time::Duration;

use antumbra_testing::scenes_folder;

use crate::{Scene, Setup};

/// Runs `work` on a thread of its own; a panic or a time beyond `limit` is reported as an error.
fn guarded<T: Send + 'static>(limit: Duration, work: impl FnOnce() -> T + Send + 'static) -> Result<T, String> {
    let (sender, receiver) = std::sync::mpsc::channel();
    let thread = std::thread::spawn(move || {
        let _ = sender.send(work());
    });
    match receiver.recv_timeout(limit) {
        Ok(value) => Ok(value),
        Err(std::sync::mpsc::RecvTimeoutError::Timeout) => Err(format!("took longer than {limit:?}")),
        Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => Err(match thread.join() {
            Err(panic) => panic
                .downcast_ref::<String>()
                .cloned()
                .or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()))
                .unwrap_or_else(|| "panicked".into()),
            Ok(()) => "sent nothing".into(),
        }),
    }
}

/// Checks everything that other modules rely on. Returns what is wrong.
fn unsound(scene: &Scene) -> Option<String> {
    let all = |ok: bool, what: &str| if ok { None } else { Some(what.to_owned()) };
    for (k, mesh) in scene.meshes.iter().enumerate() {
        let n = mesh.positions.len();
        let lengths_ok = mesh.normals.len() == n
            && (mesh.uvs.is_empty() || mesh.uvs.len() == n)
            && (mesh.colors.is_empty() || mesh.colors.len() == n)
            && mesh.indices.len().is_multiple_of(3);
        let problem = all(lengths_ok, "lists of differing length")
            .or_else(|| all(mesh.indices.iter().all(|&i| (i as usize) < n), "an index out of range"))
            .or_else(|| all(mesh.material < scene.materials.len(), "a material out of range"))
            .or_else(|| all(mesh.positions.iter().all(|p| p.is_finite()), "a position that is not finite"))
            .or_else(|| all(mesh.normals.iter().all(|v| v.is_normalized()), "a normal that is not unit"))
            .or_else(|| all(mesh.uvs.iter().all(|v| v.is_finite()), "a texture coordinate that is not finite"))
            .or_else(|| all(mesh.colors.iter().all(|v| v.is_finite()), "a colour that is not finite"));
        if let Some(problem) = problem {
            return Some(format!("mesh {k}: {problem}"));
        }
    }
    for material in &scene.materials {
        let image_ok = material.images().all(|i| i < scene.images.len());
        let numbers = [material.transmission, material.metallic, material.roughness];
        let volume_ok = material.volume.as_ref().is_none_or(|volume| {
            let lengths = [volume.thickness_m, volume.attenuation_distance_m];
            volume.attenuation_color.is_finite() && lengths.iter().all(|v| v.is_finite() && *v > 0.0)
        });
        let finite = material.base_color.is_finite() && material.emissive.is_finite() && volume_ok;
        if !image_ok || !finite || numbers.iter().any(|v| !(0.0..=1.0).contains(v)) {
            return Some(format!("material {}", material.name));
        }
    }
    for image in &scene.images {
        if image.rgba8.len() != image.width as usize * image.height as usize || image.rgba8.is_empty() {
            return Some("an image of the wrong size".into());
        }
    }
    for instance in &scene.instances {
        let matrix = glam::DMat4::from_cols_array(&instance.world_from_object.to_cols_array().map(f64::from));
        if instance.mesh >= scene.meshes.len() || !instance.world_from_object.is_finite() || matrix.determinant() == 0.0
        {
            return Some("an instance that is not finite or is singular".into());
        }
    }
    if scene.world_triangles().any(|t| t.positions.iter().any(|p| !p.is_finite())) {
        return Some("a world position that is not finite".into());
    }
    let setup = Setup::for_scene(scene);
    if let Err(problem) = crate::setup::check_camera(&setup.camera) {
        return Some(format!("camera: {problem}"));
    }
    setup.lights.iter().find_map(|light| light.validate().err()).map(|e| e.to_string())
}
