//! Shading of `antumbra-render`, executed synchronously, with its image on the CPU.

use antumbra_light::Light;
pub use antumbra_render::shading::VisibilitySource;
use antumbra_render::shading::{self, ShadingPrograms};
use antumbra_scene::Camera;
use glam::{UVec2, Vec3, Vec4};

use crate::device::{DeviceError, LabDevice};
use crate::gpu_scene::GpuScene;
use crate::picture::Picture;
use crate::readback::read_rgba32f;
use crate::receivers::{Layer, ReceiverImages, ReceiverPass};

/// Shading of one view with one set of lights, for any number of visibility masks.
#[derive(Debug)]
pub struct Shading {
    shading: shading::Shading,
    size_px: UVec2,
}

impl Shading {
    /// Prepares the shading of `images` of `scene` with `lights`.
    ///
    /// # Errors
    /// If the device fails.
    pub fn new(
        lab: &LabDevice,
        scene: &GpuScene,
        camera: &Camera,
        images: &ReceiverImages,
        lights: &[Light],
    ) -> Result<Self, DeviceError> {
        let behind = if scene.has_translucent_surfaces() {
            Some(ReceiverPass::new(lab).render(lab, scene, camera, images.size_px, Layer::BehindTranslucent)?)
        } else {
            None
        };
        let seen: Vec<Vec3> = images.read_positions(lab)?.into_iter().flatten().collect();
        Ok(Self::of_layers(lab, &ShadingPrograms::new(&lab.device), images, behind, lights, &seen))
    }

    /// Prepares the shading of both layers, already rendered. The lights' exposure is computed at the points `seen`.
    pub(crate) fn of_layers(
        lab: &LabDevice,
        programs: &ShadingPrograms,
        images: &ReceiverImages,
        behind: Option<ReceiverImages>,
        lights: &[Light],
        seen: &[Vec3],
    ) -> Self {
        let behind = behind.map(ReceiverImages::into_inner);
        let shading = shading::Shading::new(lab, programs, images, behind, lights, seen);
        Self { shading, size_px: images.size_px }
    }

    /// Switches to coherent shading; see [`shading::Shading::bend_normals`].
    pub fn bend_normals(&mut self, lab: &LabDevice, scene: &GpuScene, images: &ReceiverImages) {
        let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("bent") });
        self.shading.bend_normals(lab, &mut encoder, scene, images);
        lab.queue.submit([encoder.finish()]);
    }

    /// Returns the shaded image of the same `images`, each light multiplied by its visibility.
    ///
    /// # Errors
    /// If the device fails.
    ///
    /// # Panics
    /// If the numbers of visibilities and lights differ, or one has another size than the image.
    pub fn picture(
        &self,
        lab: &LabDevice,
        images: &ReceiverImages,
        visibilities: &[VisibilitySource<'_>],
    ) -> Result<Picture, DeviceError> {
        let targets = shading::PictureTargets::new(&lab.device, self.size_px);
        let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("shading") });
        self.shading.record(lab, &mut encoder, images, visibilities, &targets);
        lab.queue.submit([encoder.finish()]);
        let texels = read_rgba32f(lab, &targets.picture)?;
        Ok(Picture::new(self.size_px, texels.into_iter().map(|texel| Vec4::from(texel).truncate()).collect()))
    }
}

#[cfg(test)]
mod tests;
