//! The open scene on the GPU: loading, posing, exposure.

use antumbra::WarmUp;
use antumbra_render::gpu_scene::GpuScene;
use antumbra_render::receivers::DrawGroups;
use antumbra_scene::{AlphaMode, Scene};
use glam::Vec3;

use super::Renderer;

/// Number of scene points that determine the exposure until the visible surfaces have been read back.
pub(super) const EXPOSURE_POINTS: usize = 2048;

/// A scene and its state on the GPU.
#[derive(Debug)]
pub(super) struct LoadedScene {
    pub(super) generation: u64,
    /// Number of pose changes.
    pub(super) pose: u64,
    pub(super) scene: GpuScene,
    pub(super) groups: DrawGroups,
    pub(super) what: WarmUp,
    /// Points that determine the exposure: visible surfaces when the scene was opened or exposed, or else samples of all surfaces.
    pub(super) exposure: Vec<Vec3>,
    pub(super) is_exposed: bool,
}

impl Renderer {
    /// Uploads a scene, which the state has opened as `generation`.
    pub fn open(&mut self, scene: &Scene, generation: u64) {
        let uploaded = GpuScene::upload(&self.gpu, scene);
        let groups = self.receivers.draw_groups(&self.gpu, &uploaded);
        let has = |is: fn(&AlphaMode) -> bool| scene.materials.iter().any(|material| is(&material.alpha));
        self.scene = Some(LoadedScene {
            generation,
            pose: 0,
            groups,
            what: WarmUp {
                masked: has(|alpha| matches!(alpha, AlphaMode::Mask { .. } | AlphaMode::Blend)),
                tinted: has_tint(&uploaded),
            },
            scene: uploaded,
            exposure: some_points(scene),
            is_exposed: false,
        });
        self.view = None;
    }

    /// Shows the open scene at another time: `before` is the shown pose, `after` the new one. The exposure does not change.
    pub fn pose(&mut self, before: &Scene, after: &Scene) {
        let Some(open) = &mut self.scene else { return };
        if !open.scene.repose(&self.gpu, before, after) {
            // An instance was added or removed.
            open.scene = GpuScene::upload(&self.gpu, after);
            open.groups = self.receivers.draw_groups(&self.gpu, &open.scene);
            open.what.tinted |= has_tint(&open.scene);
        }
        open.pose += 1;
        if let Some(view) = &mut self.view {
            view.camera = None;
            if view.behind.is_some() != open.scene.has_translucent_surfaces() {
                self.view = None;
            }
        }
    }

    /// Recomputes the exposure from the visible surfaces.
    pub fn expose(&mut self) {
        if let (Some(scene), Some(view)) = (&mut self.scene, &mut self.view) {
            scene.is_exposed = false;
            view.seen_version = None;
        }
    }
}

/// Whether any caster is tinted.
fn has_tint(scene: &GpuScene) -> bool {
    scene.casters().iter().any(|caster| caster.opacity.tints())
}

/// Returns about [`EXPOSURE_POINTS`] points of the scene's surfaces, visible or not.
fn some_points(scene: &Scene) -> Vec<Vec3> {
    let every = scene.triangle_count().div_ceil(EXPOSURE_POINTS).max(1);
    scene.world_triangles().step_by(every).map(|triangle| triangle.positions.iter().sum::<Vec3>() / 3.0).collect()
}
