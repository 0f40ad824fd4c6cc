//! The open scene on the GPU: opened, posed at another time, exposed.

use antumbra::WarmUp;
use antumbra_render::gpu_scene::GpuScene;
use antumbra_render::receivers::DrawGroups;
use antumbra_scene::{AlphaMode, Scene};
use glam::Vec3;

use super::Renderer;

/// Points of the scene that lights are exposed to before it is known what the camera sees.
pub(super) const EXPOSURE_POINTS: usize = 2048;

/// A scene and how it is shown.
#[derive(Debug)]
pub(super) struct LoadedScene {
    pub(super) generation: u64,
    /// Counts the times at which it was shown.
    pub(super) pose: u64,
    pub(super) scene: GpuScene,
    pub(super) groups: DrawGroups,
    pub(super) what: WarmUp,
    /// Where lights are exposed to: what the camera saw when the scene was opened, or else points of its surfaces.
    pub(super) exposure: Vec<Vec3>,
    pub(super) is_exposed: bool,
}

impl Renderer {
    /// Takes in a scene, which the state has opened as `generation`.
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

    /// Shows the open scene as it is at another time: `before` is what is shown, `after` the same scene then. Nothing else
    /// changes, exposure neither.
    pub fn pose(&mut self, before: &Scene, after: &Scene) {
        let Some(open) = &mut self.scene else { return };
        if !open.scene.repose(&self.gpu, before, after) {
            // Something has come or gone.
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

    /// Exposes the lights anew, to what the camera sees now.
    pub fn expose(&mut self) {
        if let (Some(scene), Some(view)) = (&mut self.scene, &mut self.view) {
            scene.is_exposed = false;
            view.seen_version = None;
        }
    }
}

/// Whether any caster changes light's colour.
fn has_tint(scene: &GpuScene) -> bool {
    scene.casters().iter().any(|caster| caster.opacity.tints())
}

/// Some points of the scene's surfaces, whoever sees them.
fn some_points(scene: &Scene) -> Vec<Vec3> {
    let every = scene.triangle_count().div_ceil(EXPOSURE_POINTS).max(1);
    scene.world_triangles().step_by(every).map(|triangle| triangle.positions.iter().sum::<Vec3>() / 3.0).collect()
}
