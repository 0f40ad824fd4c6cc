//! Validation of a frame: light, receivers, mask and casters, once for all techniques and before any other work.
//!
//! wgpu does not expose a view's aspect, dimension or device, so each new view is bound on trial, within an error scope. Native
//! devices report the error at once, browsers later, by a message of their own.

use antumbra_light::{Light, LightShape};
use glam::{UVec2, Vec3};

use super::frame::FrameRequest;
use super::{Casters, Frame, PointFrame};
use crate::contract::{Denoise, DepthMapCaster, Error, MeshCaster, Opacity};
use crate::gpu::{Gpu, ViewKind};

mod on_trial;
mod pixels;
mod points;

use on_trial::BindableCache;

/// Validator of frames. It remembers which views and buffers could be bound.
#[derive(Debug, Default)]
pub(super) struct Validator {
    views: BindableCache<(wgpu::TextureView, ViewKind)>,
    buffers: BindableCache<wgpu::Buffer>,
}

/// Frame to validate, with the technique's name for errors.
struct Check<'a, F> {
    technique: &'static str,
    gpu: &'a Gpu,
    frame: &'a F,
}

impl Validator {
    /// Refuses inputs that do not fit one another or the device.
    pub(super) fn check(
        &mut self,
        technique: &'static str,
        gpu: &Gpu,
        request: &FrameRequest<'_>,
        denoise: Option<&Denoise>,
    ) -> Result<(), Error> {
        self.views.begin_frame();
        self.buffers.begin_frame();
        match request {
            FrameRequest::Mask(frame) => self.check_mask(&Check { technique, gpu, frame }, denoise),
            FrameRequest::Points(frame) => self.check_points(&Check { technique, gpu, frame }, denoise),
        }
    }

    fn check_mask(&mut self, check: &Check<'_, Frame<'_>>, denoise: Option<&Denoise>) -> Result<(), Error> {
        let frame = check.frame;
        check.light(frame.light)?;
        check.picture()?;
        check.camera()?;
        check.places()?;
        check.casters(&frame.casters)?;
        check.depth(self)?;
        check.normals(self)?;
        check.mask(self)?;
        check.host_map(self, &frame.casters)?;
        denoise.map_or(Ok(()), |denoise| check.denoise(self, denoise))
    }

    fn check_points(&mut self, check: &Check<'_, PointFrame<'_>>, denoise: Option<&Denoise>) -> Result<(), Error> {
        let frame = check.frame;
        check.light(frame.light)?;
        check.count()?;
        check.buffers(self)?;
        check.widths()?;
        check.point_places()?;
        check.casters(&frame.casters)?;
        check.host_map(self, &frame.casters)?;
        let Some(Denoise { max_frames, .. }) = denoise else { return Ok(()) };
        check.bad(
            "`denoise`",
            format!("set, with {max_frames} frames"),
            "`None`, because points have no neighbouring pixels",
        )
    }
}

impl<F> Check<'_, F> {
    fn bad(&self, what: &'static str, had: impl Into<String>, needed: impl Into<String>) -> Result<(), Error> {
        Err(Error::BadFrame { technique: self.technique, what, had: had.into(), needed: needed.into() })
    }

    fn light(&self, light: &Light) -> Result<(), Error> {
        let technique = self.technique;
        light.validate().map_err(|source| Error::Light { technique, source })?;
        let bytes = 16 * light_data_len(light) as u64;
        let limit = self.gpu.device.limits().max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("{bytes} bytes for the light's points or texture"),
                had: format!("at most {limit} bytes per binding"),
                remedy: "use fewer points or a smaller texture",
            });
        }
        Ok(())
    }

    /// Refuses a view that cannot be bound.
    fn bindable(
        &self,
        validator: &mut Validator,
        what: &'static str,
        view: &wgpu::TextureView,
        kind: ViewKind,
        needed: &str,
    ) -> Result<(), Error> {
        if !view.texture().usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
            return self.bad(what, "created without the usage TEXTURE_BINDING", "created with it");
        }
        let trial = |(view, kind): &(wgpu::TextureView, ViewKind)| kind.validation_error(self.gpu, view);
        let validation_error = validator.views.validation_error((view.clone(), kind), trial);
        validation_error.map_or(Ok(()), |validation_error| {
            self.bad(what, format!("a view that cannot be bound ({validation_error})"), needed)
        })
    }

    fn casters(&self, casters: &Casters<'_>) -> Result<(), Error> {
        match casters {
            Casters::Set { set, .. } | Casters::Within { set, .. } if !self.gpu.reads_of(set.gpu()) => self.bad(
                "the set of casters",
                "from another device or another `Gpu`",
                "created with a clone of the light's `Gpu`; use one `Gpu` per device",
            ),
            Casters::Within { center, radius_m, .. } if !center.is_finite() || radius_m.is_nan() || *radius_m < 0.0 => {
                let had = format!("{center} with a radius of {radius_m} m");
                self.bad("the casters' bounding sphere", had, "a finite centre with a radius of at least 0 m")
            }
            Casters::Set { .. } | Casters::Within { .. } | Casters::DepthMap(_) => Ok(()),
            Casters::Meshes(meshes) => meshes.iter().enumerate().try_for_each(|(i, mesh)| self.mesh(i, mesh)),
        }
    }

    fn mesh(&self, i: usize, mesh: &MeshCaster<'_>) -> Result<(), Error> {
        let vertex = wgpu::BufferUsages::VERTEX;
        let end_of = |first: u32, count: u32, bytes: u64| (u64::from(first) + u64::from(count)) * bytes;
        let (triangles, is_whole) = (mesh.index_count / 3, mesh.index_count.is_multiple_of(3));
        if !is_whole {
            return self.bad(
                "a caster's `index_count`",
                format!("{} (caster {i})", mesh.index_count),
                "a multiple of three",
            );
        }
        for (what, buffer, usage, end) in [
            ("a caster's position buffer", mesh.positions, vertex, 0),
            (
                "a caster's index buffer",
                mesh.indices,
                wgpu::BufferUsages::INDEX,
                end_of(mesh.first_triangle, triangles, 12),
            ),
            (
                "a caster's instance buffer",
                mesh.instances,
                vertex,
                end_of(mesh.first_instance, mesh.instance_count, 64),
            ),
        ] {
            if !buffer.usage().contains(usage) {
                return self.bad(what, format!("created without the usage {usage:?} (caster {i})"), "created with it");
            }
            if end > buffer.size() {
                let had = format!("{} bytes long (caster {i})", buffer.size());
                return self.bad(what, had, format!("at least {end} bytes long"));
            }
        }
        let draws = mesh.index_count > 0 && mesh.instance_count > 0;
        if let Some(problem) = mesh.bounds.problem().filter(|_| draws) {
            let needed = "a box whose first corner is the minimum; use infinite bounds if they are unknown";
            return self.bad("a caster's `bounds`", format!("{problem} (caster {i})"), needed);
        }
        let is_finite = match mesh.opacity {
            Opacity::Opaque => true,
            Opacity::Masked { alpha_factor, cutoff, .. } => alpha_factor.is_finite() && cutoff.is_finite(),
            Opacity::Translucent { coverage, transmitted, .. } => coverage.is_finite() && transmitted.is_finite(),
        };
        if is_finite { Ok(()) } else { self.bad("a caster's opacity", format!("not finite (caster {i})"), "finite") }
    }

    fn depth_map(&self, validator: &mut Validator, map: &DepthMapCaster<'_>) -> Result<(), Error> {
        const WHAT: &str = "the light's depth map";
        let texture = map.view.texture();
        if !texture.format().has_depth_aspect() || texture.format() == wgpu::TextureFormat::Depth16Unorm {
            return self.bad(WHAT, format!("{:?}", texture.format()), "Depth32Float");
        }
        let mut levels = (0..texture.mip_level_count()).map(|level| size_of(texture) >> level);
        if map.size_px.min_element() == 0 || !levels.any(|size| size.max(UVec2::ONE) == map.size_px) {
            return self.bad(
                "the depth map's `size_px`",
                format!("{}", map.size_px),
                format!("the size of the texture, {}, or of one of its mip levels", size_of(texture)),
            );
        }
        self.bindable(validator, WHAT, map.view, ViewKind::Depth, "a 2D view of one layer and only the depth aspect")
    }

    fn host_map(&self, validator: &mut Validator, casters: &Casters<'_>) -> Result<(), Error> {
        if let Casters::DepthMap(map) = casters { self.depth_map(validator, map) } else { Ok(()) }
    }

    /// Refuses points that are not finite.
    fn finite(&self, what: &'static str, points: &[Vec3]) -> Result<(), Error> {
        let Some(i) = points.iter().position(|point| !point.is_finite()) else { return Ok(()) };
        self.bad(what, format!("not finite (point {i})"), "finite positions in world space")
    }
}

/// Number of buffer entries that a light's points or emission texture take.
fn light_data_len(light: &Light) -> usize {
    match (&light.shape, &light.emission) {
        (LightShape::Points { positions_m }, _) => positions_m.len(),
        (LightShape::Rectangle { .. }, Some(texture)) => texture.luminance.len(),
        _ => 1,
    }
}

fn size_of(texture: &wgpu::Texture) -> UVec2 {
    UVec2::new(texture.width(), texture.height())
}
