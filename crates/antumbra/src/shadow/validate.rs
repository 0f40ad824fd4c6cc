//! Validation of a frame: light, receivers, mask and casters, once for all techniques and before any other work.
//!
//! wgpu does not tell a view's aspect, dimension or device. So a view that is new is bound on trial, within an error scope:
//! native devices answer at once. Browsers answer later, by a message of their own.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{DVec3, Mat4, UVec2, Vec3};

use super::frame::Asked;
use super::{Casters, Frame, PointFrame};
use crate::contract::{
    Denoise, DepthConvention, DepthMapCaster, Error, MeshCaster, Opacity, PointBuffer, PointWidths, Receivers,
};
use crate::frame::points::size_of_points;
use crate::gpu::{Gpu, ViewKind, storage_complaint};

/// Validator of frames. It remembers which views and buffers could be bound.
#[derive(Debug, Default)]
pub(super) struct Validator {
    views: Good<(wgpu::TextureView, ViewKind)>,
    buffers: Good<wgpu::Buffer>,
}

/// Resources that could be bound on trial, with the last frame of each.
#[derive(Debug)]
struct Good<R> {
    found: Vec<(R, u64)>,
    frame: u64,
}

impl<R> Default for Good<R> {
    fn default() -> Self {
        Self { found: Vec::new(), frame: 0 }
    }
}

impl<R: PartialEq> Good<R> {
    /// Resources unused for this many frames are forgotten, so that they can be freed.
    const KEPT_FRAMES: u64 = 8;

    fn begin_frame(&mut self) {
        self.frame += 1;
        self.found.retain(|(_, frame)| frame + Self::KEPT_FRAMES >= self.frame);
    }

    /// What wgpu says against a resource; `None` where nothing is wrong with it. Only new resources are tried.
    fn complaint(&mut self, resource: R, trial: impl FnOnce(&R) -> Option<String>) -> Option<String> {
        if let Some((_, frame)) = self.found.iter_mut().find(|(good, _)| *good == resource) {
            *frame = self.frame;
            return None;
        }
        let complaint = trial(&resource);
        if complaint.is_none() {
            self.found.push((resource, self.frame));
        }
        complaint
    }
}

/// How far a rigid matrix's axes may be from unit length and right angles: rotations that are multiplied for hours drift.
const RIGID_TOLERANCE: f64 = 1e-2;

/// One frame, and who asks.
struct Check<'a, F> {
    technique: &'static str,
    gpu: &'a Gpu,
    frame: &'a F,
}

impl Validator {
    /// Refuses what does not fit together, or the device.
    pub(super) fn check(
        &mut self,
        technique: &'static str,
        gpu: &Gpu,
        asked: &Asked<'_>,
        denoise: Option<&Denoise>,
    ) -> Result<(), Error> {
        self.views.begin_frame();
        self.buffers.begin_frame();
        match asked {
            Asked::Mask(frame) => self.check_mask(&Check { technique, gpu, frame }, denoise),
            Asked::Points(frame) => self.check_points(&Check { technique, gpu, frame }, denoise),
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
        let Some(Denoise { most_frames, .. }) = denoise else { return Ok(()) };
        check.bad("`denoise`", format!("of {most_frames} frames"), "`None` for points, which have no neighbours")
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
                had: format!("{limit} bytes a binding"),
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
            return self.bad(what, "a texture without the usage TEXTURE_BINDING", "one with it");
        }
        let trial = |(view, kind): &(wgpu::TextureView, ViewKind)| kind.complaint(self.gpu, view);
        let complaint = validator.views.complaint((view.clone(), kind), trial);
        complaint.map_or(Ok(()), |complaint| self.bad(what, format!("one that cannot be bound ({complaint})"), needed))
    }

    fn casters(&self, casters: &Casters<'_>) -> Result<(), Error> {
        match casters {
            Casters::Set { set, .. } if !set.gpu().is_clone_of(self.gpu) => self.bad(
                "the set of casters",
                "of another device or another `Gpu`",
                "made with a clone of the light's `Gpu`: one serves a device",
            ),
            Casters::Set { .. } | Casters::DepthMap(_) => Ok(()),
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
            ("a caster's positions", mesh.positions, vertex, 0),
            ("a caster's indices", mesh.indices, wgpu::BufferUsages::INDEX, end_of(mesh.first_triangle, triangles, 12)),
            ("a caster's instances", mesh.instances, vertex, end_of(mesh.first_instance, mesh.instance_count, 64)),
        ] {
            if !buffer.usage().contains(usage) {
                return self.bad(
                    what,
                    format!("in a buffer without the usage {usage:?} (caster {i})"),
                    "in one with it",
                );
            }
            if end > buffer.size() {
                let had = format!("up to byte {end} of a buffer of {} (caster {i})", buffer.size());
                return self.bad(what, had, "within the buffer");
            }
        }
        let draws = mesh.index_count > 0 && mesh.instance_count > 0;
        if let Some(problem) = mesh.bounds.problem().filter(|_| draws) {
            let needed = "a box with its least corner first, infinite where it is not known";
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
                format!("the texture's {}", size_of(texture)),
            );
        }
        self.bindable(
            validator,
            WHAT,
            map.view,
            ViewKind::Depth,
            "a 2D view of one layer and of the depth aspect alone",
        )
    }

    fn host_map(&self, validator: &mut Validator, casters: &Casters<'_>) -> Result<(), Error> {
        if let Casters::DepthMap(map) = casters { self.depth_map(validator, map) } else { Ok(()) }
    }

    /// Refuses points that are nowhere.
    fn finite(&self, what: &'static str, points: &[Vec3]) -> Result<(), Error> {
        let Some(i) = points.iter().position(|point| !point.is_finite()) else { return Ok(()) };
        self.bad(what, format!("not finite (point {i})"), "finite points in the world")
    }
}

impl Check<'_, Frame<'_>> {
    /// Sizes of receivers, depth buffer, normals and mask.
    fn picture(&self) -> Result<(), Error> {
        let Frame { receivers, mask, .. } = self.frame;
        let size_px = receivers.size_px;
        if size_px.min_element() == 0 {
            return self.bad("the receivers' size", format!("{size_px}"), "at least 1 × 1 pixels");
        }
        if mask.size_px() != size_px {
            return self.bad("the mask's size", format!("{}", mask.size_px()), format!("the receivers' {size_px}"));
        }
        let depth = receivers.depth.texture();
        let end_px = receivers.origin_px.saturating_add(size_px);
        if end_px.cmpgt(size_of(depth)).any() {
            return self.bad(
                "the receivers' part of the depth buffer",
                format!("up to pixel {end_px} of {} × {}", depth.width(), depth.height()),
                "within the depth buffer",
            );
        }
        Ok(())
    }

    fn camera(&self) -> Result<(), Error> {
        let Receivers { view_from_world, clip_from_view, depth_convention, .. } = self.frame.receivers;
        if !view_from_world.is_finite() || !is_rigid(&view_from_world) {
            let had = if view_from_world.is_finite() { "not rigid" } else { "not finite" };
            return self.bad("the camera's pose", had, "a rotation and a translation: scale the scene instead");
        }
        let world_from_view = view_from_world.as_dmat4().inverse().as_mat4();
        if !(clip_from_view.is_finite()
            && clip_from_view.as_dmat4().inverse().as_mat4().is_finite()
            && world_from_view.is_finite())
        {
            return self.bad("the camera's matrix", "singular", "invertible and finite");
        }
        let [near, far] = [-1.0, -2.0].map(|z| clip_from_view.as_dmat4().project_point3(DVec3::Z * z).z);
        let runs = if far > near { DepthConvention::Standard } else { DepthConvention::Reversed };
        if runs != depth_convention && near != far && (near - far).is_finite() {
            return self.bad(
                "the depth convention",
                format!("{depth_convention:?}, and the projection's is not"),
                format!("{runs:?}, as the projection is"),
            );
        }
        Ok(())
    }

    /// Refuses bounds, hull, seen points and a shadow distance that are none.
    fn places(&self) -> Result<(), Error> {
        let Receivers { bounds, hull, seen, shadow_distance, .. } = self.frame.receivers;
        // A box of no receivers is empty, and does.
        if let Some(problem) = bounds.filter(|bounds| *bounds != Aabb::EMPTY).and_then(|bounds| bounds.problem()) {
            return self.bad("the receivers' box", problem, "a box with its least corner first, or `None`");
        }
        self.finite("the receivers' `hull`", hull)?;
        self.finite("the receivers' `seen`", seen)?;
        let Some(distance) = shadow_distance else { return Ok(()) };
        distance.problem().map_or(Ok(()), |(what, needed)| {
            let what =
                if what == "end_m" { "`end_m` of the shadow distance" } else { "`fade_m` of the shadow distance" };
            self.bad(what, format!("{distance:?}"), needed)
        })
    }

    fn depth(&self, validator: &mut Validator) -> Result<(), Error> {
        use wgpu::TextureFormat as Format;
        const WHAT: &str = "the depth buffer";
        let depth = self.frame.receivers.depth;
        let texture = depth.texture();
        match texture.format() {
            Format::Depth32Float | Format::Depth32FloatStencil8 | Format::R32Float => {}
            Format::Depth24Plus | Format::Depth24PlusStencil8 => {}
            Format::Depth16Unorm => {
                return self.bad(
                    WHAT,
                    "Depth16Unorm",
                    "Depth32Float or R32Float: surfaces would shade themselves by the steps of 16 bits",
                );
            }
            other => return self.bad(WHAT, format!("{other:?}"), "Depth32Float or R32Float"),
        }
        if texture.sample_count() != 1 {
            return self.bad(
                WHAT,
                format!("of {} samples a pixel", texture.sample_count()),
                "of one: SplitReceivers makes that of four",
            );
        }
        self.bindable(validator, WHAT, depth, ViewKind::Float, "a 2D view of one layer and of the depth aspect alone")
    }

    fn normals(&self, validator: &mut Validator) -> Result<(), Error> {
        const WHAT: &str = "the normals' texture";
        let Receivers { normals: Some(normals), .. } = self.frame.receivers else { return Ok(()) };
        let texture = normals.texture();
        self.as_large_as_depth(WHAT, texture)?;
        if texture.sample_count() != 1 {
            return self.bad(WHAT, format!("of {} samples a pixel", texture.sample_count()), "of one");
        }
        if !holds_directions(texture.format()) {
            return self.bad(
                WHAT,
                format!("{:?}", texture.format()),
                "signed, of three components and more: Rgba16Float, say",
            );
        }
        self.bindable(validator, WHAT, normals, ViewKind::Float, "a 2D view of one layer")
    }

    fn mask(&self, validator: &mut Validator) -> Result<(), Error> {
        const WHAT: &str = "the mask";
        let Frame { receivers, mask, .. } = self.frame;
        let read = [Some(receivers.depth), receivers.normals];
        if read.into_iter().flatten().any(|view| view.texture() == mask.texture()) {
            return self.bad(WHAT, "in the texture of the depth buffer or the normals", "in one of its own");
        }
        self.bindable(validator, WHAT, mask.layers_view(), ViewKind::FloatArray, "a texture of the light's device")
    }

    fn denoise(&self, validator: &mut Validator, denoise: &Denoise) -> Result<(), Error> {
        const WHAT: &str = "the motion vectors' texture";
        if !(1..=Denoise::MOST_FRAMES).contains(&denoise.most_frames) {
            let needed = format!("1 to {}", Denoise::MOST_FRAMES);
            return self.bad("the denoiser's frames", denoise.most_frames.to_string(), needed);
        }
        let Some(motion) = &denoise.motion else { return Ok(()) };
        self.as_large_as_depth(WHAT, motion.texture())?;
        self.bindable(validator, WHAT, motion, ViewKind::Float, "a 2D view of one layer, of floats")
    }

    /// Refuses a texture of another size than the depth buffer's.
    fn as_large_as_depth(&self, what: &'static str, texture: &wgpu::Texture) -> Result<(), Error> {
        let (size, needed) = (size_of(texture), size_of(self.frame.receivers.depth.texture()));
        if size == needed {
            return Ok(());
        }
        self.bad(what, format!("of {size}"), format!("of the depth buffer's {needed}"))
    }
}

impl Check<'_, PointFrame<'_>> {
    fn count(&self) -> Result<(), Error> {
        let receivers = &self.frame.receivers;
        if receivers.count == 0 {
            return self.bad("the points' count", "0", "1 at least");
        }
        if receivers.row_length == Some(0) {
            return self.bad("the points' `row_length`", "0", "1 at least, or `None`");
        }
        let size = size_of_points(receivers.count, receivers.row_length);
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        if size.max_element() > most {
            return self.bad(
                "the points' count",
                format!("{} in {} rows of {}", receivers.count, size.y, size.x),
                format!("at most {most} rows of {most} on this device"),
            );
        }
        Ok(())
    }

    fn buffers(&self, validator: &mut Validator) -> Result<(), Error> {
        let PointFrame { receivers, visibilities, channels, .. } = self.frame;
        let read = [("the points' positions", 3), ("the points' normals", 3), ("the points' widths", 1)];
        for ((what, floats), buffer) in read.into_iter().zip(receivers.buffers()) {
            if let Some(buffer) = buffer {
                self.point_buffer(validator, what, &buffer, floats)?;
                if buffer.buffer == *visibilities {
                    return self.bad(what, "in the buffer of the visibilities", "in another one");
                }
            }
        }
        let written = PointBuffer { buffer: visibilities, offset: 0, stride: 4 * channels.count() };
        self.point_buffer(validator, "the points' visibilities", &written, u64::from(channels.count()))
    }

    /// Refuses a buffer that does not have so many floats for each point, or cannot be bound.
    fn point_buffer(
        &self,
        validator: &mut Validator,
        what: &'static str,
        of: &PointBuffer<'_>,
        floats: u64,
    ) -> Result<(), Error> {
        let PointBuffer { buffer, offset, stride } = *of;
        if !buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return self.bad(what, "in a buffer without the usage STORAGE", "in one with it");
        }
        if !offset.is_multiple_of(4) || !stride.is_multiple_of(4) || u64::from(stride) < 4 * floats {
            return self.bad(
                what,
                format!("from byte {offset} on, {stride} bytes apart"),
                format!("at multiples of 4 bytes, {} apart at least", 4 * floats),
            );
        }
        let end = offset + u64::from(self.frame.receivers.count - 1) * u64::from(stride) + 4 * floats;
        if end > buffer.size() {
            return self.bad(what, format!("up to byte {end} of a buffer of {}", buffer.size()), "within the buffer");
        }
        let most = self.gpu.device.limits().max_storage_buffer_binding_size;
        if buffer.size() > most {
            return self.bad(
                what,
                format!("in a buffer of {} bytes", buffer.size()),
                format!("in one of {most} at most, which this device binds"),
            );
        }
        let complaint = validator.buffers.complaint(buffer.clone(), |buffer| storage_complaint(self.gpu, buffer));
        let refuse = |complaint| {
            self.bad(what, format!("in a buffer that cannot be bound ({complaint})"), "in one of the light's device")
        };
        complaint.map_or(Ok(()), refuse)
    }

    fn widths(&self) -> Result<(), Error> {
        match self.frame.receivers.widths {
            PointWidths::Same(width_m) if !(width_m >= 0.0 && width_m.is_finite()) => {
                self.bad("the points' width", format!("{width_m} m"), "0 or more, and finite")
            }
            _ => Ok(()),
        }
    }

    /// Refuses bounds, hull and seen points that are no places.
    fn point_places(&self) -> Result<(), Error> {
        let receivers = &self.frame.receivers;
        if let Some(problem) = receivers.bounds.problem() {
            return self.bad("the points' box", problem, "a box of all points with its least corner first");
        }
        self.finite("the points' `hull`", receivers.hull)?;
        self.finite("the points' `seen`", receivers.seen)
    }
}

/// Entries of the buffer that a light's points or its picture take.
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

/// Whether a matrix turns and moves, mirrors perhaps, and does nothing else.
fn is_rigid(matrix: &Mat4) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().as_dvec3());
    let is_unit = |axis: DVec3| (axis.length() - 1.0).abs() < RIGID_TOLERANCE;
    let is_right = |a: DVec3, b: DVec3| a.dot(b).abs() < RIGID_TOLERANCE;
    let is_affine = matrix.row(3).abs_diff_eq(glam::Vec4::W, 1e-6);
    is_affine && [x, y, z].into_iter().all(is_unit) && is_right(x, y) && is_right(y, z) && is_right(z, x)
}

/// Whether a format's components are signed floats or fractions, three of them at least.
fn holds_directions(format: wgpu::TextureFormat) -> bool {
    use wgpu::TextureFormat as Format;
    matches!(format, Format::Rgba32Float | Format::Rgba16Float | Format::Rgba16Snorm | Format::Rgba8Snorm)
}
