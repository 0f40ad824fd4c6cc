//! Ray tracer of a scene in which a caster moves.

use antumbra_reference::{Receivers, Tracer, VisibilityOptions};
use antumbra_scene::Scene;
use glam::{Mat4, UVec2, Vec3};

use super::caster::MovingCaster;
use super::trajectory::Pose;
use crate::error::LabError;

/// Tracer of a scene with moving instances.
pub(super) struct Tracing {
    scene: Scene,
    /// Moving instances with their final transforms.
    moving: Vec<(usize, Mat4)>,
    pub(super) tracer: Tracer,
    samples: u32,
}

impl Tracing {
    pub(super) fn new(scene: Scene, caster: Option<&MovingCaster>, samples: u32) -> Result<Self, LabError> {
        let moving = caster.map_or(&[][..], |caster| &caster.instances);
        let moving = moving.iter().map(|i| (*i, scene.instances[*i].world_from_object)).collect();
        let tracer = Tracer::new(&scene)?;
        Ok(Self { scene, moving, tracer, samples })
    }

    /// Updates the tracer to a pose and returns what the camera sees.
    pub(super) fn receivers(&mut self, pose: &Pose, size_px: UVec2) -> Result<Receivers, LabError> {
        if !self.moving.is_empty() {
            for (instance, place) in &self.moving {
                let offset = pose.caster_offset_m;
                self.scene.instances[*instance].world_from_object =
                    if offset == Vec3::ZERO { *place } else { Mat4::from_translation(offset) * *place };
            }
            self.tracer = Tracer::new(&self.scene)?;
        }
        Ok(self.tracer.primary(&pose.camera, size_px))
    }

    pub(super) fn options(&self, seed: u32) -> VisibilityOptions {
        let samples = self.samples;
        VisibilityOptions { samples, seed, same_set_for_all_pixels: true, ..VisibilityOptions::default() }
    }
}
