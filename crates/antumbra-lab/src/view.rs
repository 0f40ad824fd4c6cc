//! A scene as one camera sees it: everything that stays the same while techniques change.

use std::cell::OnceCell;
use std::rc::Rc;

use antumbra::{AnyShadow, Casters, MeshCaster};
use antumbra_scene::{Scene, Setup};
use glam::UVec2;

use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::picture::{Picture, Visibility};
use crate::receivers::{Layer, ReceiverImages, ReceiverPass};
use crate::shading::{Shading, VisibilitySource};
use crate::technique_run::{Drawn, FrameCount, TechniqueChoice, TechniqueRun, Timing, create, draw, run};
use crate::truth::SurfacePoint;

/// A scene on the GPU, seen and lit as a setup says.
#[derive(Debug)]
pub struct View<'a> {
    lab: &'a LabDevice,
    setup: &'a Setup,
    scene: Rc<GpuScene>,
    images: ReceiverImages,
    /// Made when the first picture is asked for: times and errors need none.
    shading: OnceCell<Shading>,
    is_coherent: bool,
}

impl<'a> View<'a> {
    /// Uploads the scene and draws what the setup's camera sees of it.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn new(lab: &'a LabDevice, scene: &Scene, setup: &'a Setup, size_px: UVec2) -> Result<Self, LabError> {
        Self::of_uploaded(lab, &Rc::new(GpuScene::upload(lab, scene)), setup, size_px)
    }

    /// The same, shaded coherently; see [`Shading::bend_normals`].
    ///
    /// # Errors
    /// Where the device failed.
    pub fn coherent(lab: &'a LabDevice, scene: &Scene, setup: &'a Setup, size_px: UVec2) -> Result<Self, LabError> {
        let uploaded = Rc::new(GpuScene::upload_with_faces(lab, scene));
        Ok(Self { is_coherent: true, ..Self::of_uploaded(lab, &uploaded, setup, size_px)? })
    }

    /// The same of a scene that several views share.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn of_uploaded(
        lab: &'a LabDevice,
        scene: &Rc<GpuScene>,
        setup: &'a Setup,
        size_px: UVec2,
    ) -> Result<Self, LabError> {
        let images = ReceiverPass::new(lab).render(lab, scene, &setup.camera, size_px, Layer::FirstHits)?;
        Ok(Self { lab, setup, scene: Rc::clone(scene), images, shading: OnceCell::new(), is_coherent: false })
    }

    /// Triangles as drawn.
    pub fn triangle_count(&self) -> usize {
        self.scene.triangle_count
    }

    /// The surface that is drawn at each pixel; `None` for background.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn surface_points(&self) -> Result<Vec<Option<SurfacePoint>>, LabError> {
        Ok(self.images.read_surface_points(self.lab)?)
    }

    /// Milliseconds for drawing what the camera sees, by the processor's clock: the median, and of how many drawings.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn scene_ms(&self, timing: &Timing) -> Result<(f64, FrameCount), LabError> {
        let pass = ReceiverPass::new(self.lab);
        Ok(pass.time(self.lab, &self.scene, &self.images, Layer::FirstHits, timing)?)
    }

    /// Makes a technique on this view's device.
    ///
    /// # Errors
    /// Where the device lacks something, or a setting is wrong.
    pub fn create(&self, choice: &TechniqueChoice) -> Result<AnyShadow, LabError> {
        Ok(create(&self.lab.gpu(), choice)?)
    }

    /// A technique's mask for a light of the setup: drawn once, or so many times where it changes from frame to frame.
    ///
    /// # Errors
    /// As [`draw`].
    pub fn draw(&self, technique: &mut AnyShadow, light: usize, frames: u32) -> Result<Drawn, LabError> {
        let light = &self.setup.lights[light];
        let casters: Vec<MeshCaster<'_>> = self.scene.casters_for(light);
        draw(self.lab, technique, light, Casters::Meshes(&casters), self.images.receivers(), frames)
    }

    /// Runs a technique for a light of the setup, and times it.
    ///
    /// # Errors
    /// As [`run`].
    pub fn run(&self, technique: &mut AnyShadow, light: usize, timing: &Timing) -> Result<TechniqueRun, LabError> {
        let light = &self.setup.lights[light];
        let casters: Vec<MeshCaster<'_>> = self.scene.casters_for(light);
        run(self.lab, technique, light, Casters::Meshes(&casters), self.images.receivers(), timing)
    }

    /// The picture with the visibility of each of the setup's lights.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn shade(&self, visibilities: &[&Visibility]) -> Result<Picture, LabError> {
        let shading = match self.shading.get() {
            Some(shading) => shading,
            None => {
                let Setup { camera, lights } = self.setup;
                let mut made = Shading::new(self.lab, &self.scene, camera, &self.images, lights)?;
                if self.is_coherent {
                    made.bend_normals(self.lab, &self.scene, &self.images);
                }
                self.shading.get_or_init(|| made)
            }
        };
        let sources: Vec<_> = visibilities.iter().map(|visibility| VisibilitySource::Image(visibility)).collect();
        Ok(shading.picture(self.lab, &self.images, &sources)?)
    }
}
