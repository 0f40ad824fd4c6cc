//! View: a scene seen by one camera, the state that is shared by all techniques.

use std::cell::OnceCell;
use std::rc::Rc;

use antumbra::{AnyShadow, Casters, MeshCaster};
use antumbra_render::antialiasing::OFFSETS_PX;
use antumbra_render::shading::ShadingPrograms;
use antumbra_scene::{Scene, Setup};
use glam::{UVec2, Vec2, Vec3};

use crate::antialiasing::{Samples, gathered};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::limits::End;
use crate::picture::{Picture, Visibility, pixel_count};
use crate::receivers::{Layer, ReceiverImages, ReceiverPass};
use crate::shading::{Shading, VisibilitySource};
use crate::technique_run::{Drawn, FrameCount, TechniqueChoice, TechniqueRun, Timing, create, draw_until, run};
use crate::truth::SurfacePoint;

/// A scene on the GPU with camera and lights of a setup.
#[derive(Debug)]
pub struct View<'a> {
    lab: &'a LabDevice,
    setup: &'a Setup,
    scene: Rc<GpuScene>,
    images: ReceiverImages,
    /// Shading state, created for the first image: times and errors need none.
    pictures: OnceCell<Pictures>,
    is_coherent: bool,
}

/// State for shading images.
#[derive(Debug)]
struct Pictures {
    pass: ReceiverPass,
    programs: ShadingPrograms,
    /// Surfaces of the mask's samples.
    samples: Samples,
    /// Points at which the lights' exposure is computed.
    seen: Vec<Vec3>,
    /// Shading at the pixels' centres.
    centred: Shading,
    /// Shifted images, created once unless they are too large to keep.
    kept: OnceCell<Vec<Shifted>>,
}

/// Images shifted by a fraction of a pixel, with their shading.
#[derive(Debug)]
struct Shifted {
    images: ReceiverImages,
    shading: Shading,
    /// Source of each pixel's visibility if it shows another surface than its centre.
    sources: Vec<Option<u32>>,
}

/// Maximum number of pixels for which shifted images are kept: with both layers about 72 bytes per pixel and shift,
/// 600 MB. Larger ones are rendered again.
const MAX_KEPT_PX: usize = 1 << 20;

impl<'a> View<'a> {
    /// Uploads the scene and renders what the setup's camera sees.
    ///
    /// # Errors
    /// If the device fails.
    pub fn new(lab: &'a LabDevice, scene: &Scene, setup: &'a Setup, size_px: UVec2) -> Result<Self, LabError> {
        Self::of_uploaded(lab, &Rc::new(GpuScene::upload(lab, scene)), setup, size_px)
    }

    /// Creates a view with coherent shading; see [`Shading::bend_normals`].
    ///
    /// # Errors
    /// If the device fails.
    pub fn coherent(lab: &'a LabDevice, scene: &Scene, setup: &'a Setup, size_px: UVec2) -> Result<Self, LabError> {
        let uploaded = Rc::new(GpuScene::upload_with_faces(lab, scene));
        Ok(Self { is_coherent: true, ..Self::of_uploaded(lab, &uploaded, setup, size_px)? })
    }

    /// Creates a view of a scene that several views share.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of_uploaded(
        lab: &'a LabDevice,
        scene: &Rc<GpuScene>,
        setup: &'a Setup,
        size_px: UVec2,
    ) -> Result<Self, LabError> {
        let images = ReceiverPass::new(lab).render(lab, scene, &setup.camera, size_px, Layer::FirstHits)?;
        Ok(Self { lab, setup, scene: Rc::clone(scene), images, pictures: OnceCell::new(), is_coherent: false })
    }

    /// Returns the number of drawn triangles.
    pub fn triangle_count(&self) -> usize {
        self.scene.triangle_count
    }

    /// Reads the surface drawn at each pixel; `None` for background.
    ///
    /// # Errors
    /// If the device fails.
    pub fn surface_points(&self) -> Result<Vec<Option<SurfacePoint>>, LabError> {
        Ok(self.images.read_surface_points(self.lab)?)
    }

    /// Measures the time to render the camera's view, on the CPU's clock. Returns median milliseconds and number of frames.
    ///
    /// # Errors
    /// If the device fails.
    pub fn scene_ms(&self, timing: &Timing) -> Result<(f64, FrameCount), LabError> {
        let pass = ReceiverPass::new(self.lab);
        Ok(pass.time(self.lab, &self.scene, &self.images, Layer::FirstHits, timing)?)
    }

    /// Creates a technique on this view's device.
    ///
    /// # Errors
    /// If the device lacks a feature, or a setting is wrong.
    pub fn create(&self, choice: &TechniqueChoice) -> Result<AnyShadow, LabError> {
        Ok(create(&self.lab.gpu(), choice)?)
    }

    /// Draws a technique's mask for a light of the setup: once, or `frames` times if it changes from frame to frame.
    ///
    /// # Errors
    /// As [`crate::technique_run::draw`].
    pub fn draw(&self, technique: &mut AnyShadow, light: usize, frames: u32) -> Result<Drawn, LabError> {
        self.draw_until(technique, light, frames, None)
    }

    /// Draws as [`Self::draw`], until an end time.
    ///
    /// # Errors
    /// As [`crate::technique_run::draw`], and if the end passes.
    pub fn draw_until(
        &self,
        technique: &mut AnyShadow,
        light: usize,
        frames: u32,
        end: Option<End>,
    ) -> Result<Drawn, LabError> {
        let light = &self.setup.lights[light];
        let casters: Vec<MeshCaster<'_>> = self.scene.casters_for(light);
        draw_until(self.lab, technique, light, Casters::Meshes(&casters), self.images.receivers(), frames, end)
    }

    /// Runs and times a technique for a light of the setup.
    ///
    /// # Errors
    /// As [`run`].
    pub fn run(&self, technique: &mut AnyShadow, light: usize, timing: &Timing) -> Result<TechniqueRun, LabError> {
        let light = &self.setup.lights[light];
        let casters: Vec<MeshCaster<'_>> = self.scene.casters_for(light);
        run(self.lab, technique, light, Casters::Meshes(&casters), self.images.receivers(), timing)
    }

    /// Returns the antialiased image with the visibility of each of the setup's lights. Masks and truths have one sample per pixel; eight
    /// positions within each pixel are lit by the samples of the same surface.
    ///
    /// # Errors
    /// If the device fails.
    pub fn shade(&self, visibilities: &[&Visibility]) -> Result<Picture, LabError> {
        let pictures = match self.pictures.get() {
            Some(pictures) => pictures,
            None => {
                let made = self.pictures()?;
                self.pictures.get_or_init(|| made)
            }
        };
        let pixels = pixel_count(self.images.size_px);
        if pixels <= MAX_KEPT_PX && pictures.kept.get().is_none() {
            let made = OFFSETS_PX.map(|offset_px| self.shifted(pictures, offset_px));
            let made = made.into_iter().collect::<Result<Vec<_>, _>>()?;
            pictures.kept.get_or_init(|| made);
        }
        let sources: Vec<_> = visibilities.iter().map(|visibility| VisibilitySource::Image(visibility)).collect();
        let centred = pictures.centred.picture(self.lab, &self.images, &sources)?.linear_rgb;
        let mut sums = vec![Vec3::ZERO; pixels];
        for (i, offset_px) in OFFSETS_PX.into_iter().enumerate() {
            let made;
            let shifted = match pictures.kept.get() {
                Some(kept) => &kept[i],
                None => {
                    made = self.shifted(pictures, offset_px)?;
                    &made
                }
            };
            let one = self.shade_shifted(shifted, visibilities)?;
            let at_centre = shifted.sources.iter().map(Option::is_none).zip(&centred);
            for ((sum, color), (is_at_centre, centre)) in sums.iter_mut().zip(&one.linear_rgb).zip(at_centre) {
                *sum += if is_at_centre { *centre } else { *color };
            }
        }
        let means = sums.into_iter().map(|sum| sum / OFFSETS_PX.len() as f32).collect();
        Ok(Picture::new(self.images.size_px, means))
    }

    fn pictures(&self) -> Result<Pictures, LabError> {
        let size_px = self.images.size_px;
        let points = self.surface_points()?;
        let seen: Vec<Vec3> = points.iter().flatten().map(|point| point.position).collect();
        let camera = &self.setup.camera;
        let pixel_at_1_m = 2.0 * (0.5 * camera.fov_y_rad).tan() / size_px.y as f32;
        let (pass, programs) = (ReceiverPass::new(self.lab), ShadingPrograms::new(&self.lab.device));
        let centred = self.shading(&pass, &programs, &seen, &self.images, Vec2::ZERO);
        Ok(Pictures {
            pass,
            programs,
            centred,
            samples: Samples { size_px, points, eye: camera.eye, pixel_at_1_m },
            seen,
            kept: OnceCell::new(),
        })
    }

    fn shifted(&self, pictures: &Pictures, offset_px: Vec2) -> Result<Shifted, LabError> {
        let Pictures { pass, programs, samples, seen, .. } = pictures;
        let (camera, size_px) = (&self.setup.camera, self.images.size_px);
        let images = pass.render_shifted(self.lab, &self.scene, camera, size_px, Layer::FirstHits, offset_px);
        let shading = self.shading(pass, programs, seen, &images, offset_px);
        let sources = samples.sources(&images.read_surface_points(self.lab)?, offset_px);
        Ok(Shifted { images, shading, sources })
    }

    fn shading(
        &self,
        pass: &ReceiverPass,
        programs: &ShadingPrograms,
        seen: &[Vec3],
        images: &ReceiverImages,
        offset_px: Vec2,
    ) -> Shading {
        let Setup { camera, lights } = self.setup;
        let behind = self.scene.has_translucent_surfaces().then(|| {
            pass.render_shifted(self.lab, &self.scene, camera, images.size_px, Layer::BehindTranslucent, offset_px)
        });
        let mut shading = Shading::of_layers(self.lab, programs, images, behind, lights, seen);
        if self.is_coherent {
            shading.bend_normals(self.lab, &self.scene, images);
        }
        shading
    }

    fn shade_shifted(&self, shifted: &Shifted, visibilities: &[&Visibility]) -> Result<Picture, LabError> {
        let visibilities: Vec<Visibility> =
            visibilities.iter().map(|visibility| gathered(visibility, &shifted.sources)).collect();
        let sources: Vec<_> = visibilities.iter().map(VisibilitySource::Image).collect();
        Ok(shifted.shading.picture(self.lab, &shifted.images, &sources)?)
    }
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{LoadOptions, load};

    use super::*;
    use crate::test_support::lab_or_skip;

    /// Antialiasing blends the colours on both sides of an edge, but neither blurs nor moves a mask's own steps.
    #[test]
    fn pictures_are_antialiased_and_masks_are_not_blurred() {
        let Some(lab) = lab_or_skip() else { return };
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        let size_px = UVec2::new(96, 54);
        let view = View::new(lab, &scene, &setup, size_px).unwrap();
        let pixels = pixel_count(size_px);
        let lit = Visibility::one(size_px, vec![1.0; pixels]);
        // Each pixel differs from its neighbours in row and column.
        let chequered = Visibility::one(size_px, (0..pixels).map(|i| ((i % 96 + i / 96) % 2) as f32).collect());
        for mask in [&lit, &chequered] {
            let smooth = view.shade(&[mask]).unwrap().linear_rgb;
            let pictures = view.pictures.get().unwrap();
            let source = VisibilitySource::Image(mask);
            let jagged = pictures.centred.picture(lab, &view.images, &[source]).unwrap().linear_rgb;
            let kept = pictures.kept.get().unwrap();
            let is_edge = |i: usize| kept.iter().any(|one| one.sources[i].is_some());
            let apart = |i: usize| (smooth[i] - jagged[i]).abs().max_element();
            let edges: Vec<usize> = (0..pixels).filter(|i| is_edge(*i)).collect();
            let changed = edges.iter().filter(|i| apart(**i) > 0.01).count();
            assert!(edges.len() > 200 && edges.len() < pixels / 4, "{} pixels at edges", edges.len());
            assert!(changed > edges.len() / 2, "{changed} of {} pixels at edges changed", edges.len());
            assert!((0..pixels).all(|i| is_edge(i) || apart(i) < 1e-5));
        }
    }

    /// Images are the same whether shifted images are kept or rendered again.
    #[test]
    fn shifted_images_that_are_drawn_again_are_the_same() {
        let Some(lab) = lab_or_skip() else { return };
        let scene = load("builtin:stained-glass", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        let size_px = UVec2::new(64, 36);
        let view = View::new(lab, &scene, &setup, size_px).unwrap();
        let mask = Visibility::one(size_px, vec![0.5; pixel_count(size_px)]);
        let all = vec![&mask; setup.lights.len()];
        let first = view.shade(&all).unwrap();
        let pictures = view.pictures.get().unwrap();
        let (again, kept) = (view.shifted(pictures, OFFSETS_PX[3]).unwrap(), &pictures.kept.get().unwrap()[3]);
        assert_eq!(again.sources, kept.sources);
        assert_eq!(view.shade_shifted(&again, &all).unwrap(), view.shade_shifted(kept, &all).unwrap());
        assert_eq!(view.shade(&all).unwrap(), first);
    }
}
