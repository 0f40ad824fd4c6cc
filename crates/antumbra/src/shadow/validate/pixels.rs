//! Validation of receivers that are pixels: sizes, camera, depth, normals, mask, denoising.

use antumbra_light::Aabb;
use glam::{DVec3, Mat4};

use super::{Check, Validator, size_of};
use crate::contract::{Denoise, DepthConvention, Error, Receivers};
use crate::gpu::ViewKind;
use crate::shadow::Frame;

/// Tolerance of a rigid matrix's axes, in length and in the cosine between two: rotations multiplied for hours drift.
const RIGID_TOLERANCE: f64 = 1e-2;

impl Check<'_, Frame<'_>> {
    /// Checks the sizes of receivers, mask and depth buffer.
    pub(super) fn picture(&self) -> Result<(), Error> {
        let Frame { receivers, mask, .. } = self.frame;
        let size_px = receivers.size_px;
        if size_px.min_element() == 0 {
            return self.bad("the receivers' size", format!("{size_px}"), "at least 1 × 1 pixel");
        }
        if mask.size_px() != size_px {
            return self.bad(
                "the mask's size",
                format!("{}", mask.size_px()),
                format!("the size of the receivers, {size_px}"),
            );
        }
        let depth = receivers.depth.texture();
        let end_px = receivers.origin_px.saturating_add(size_px);
        if end_px.cmpgt(size_of(depth)).any() {
            return self.bad(
                "the receivers' rectangle",
                format!(
                    "outside of the depth buffer: it ends at pixel {end_px} of {} × {}",
                    depth.width(),
                    depth.height()
                ),
                "within the depth buffer",
            );
        }
        Ok(())
    }

    pub(super) fn camera(&self) -> Result<(), Error> {
        let Receivers { view_from_world, clip_from_view, depth_convention, .. } = self.frame.receivers;
        if !view_from_world.is_finite() || !is_rigid(&view_from_world) {
            let had = if view_from_world.is_finite() { "not rigid" } else { "not finite" };
            return self.bad(
                "the camera's pose",
                had,
                "a rotation and a translation; to scale, scale the scene instead",
            );
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
                format!("{depth_convention:?}, but that of the projection is not"),
                format!("{runs:?}, as in the projection"),
            );
        }
        Ok(())
    }

    /// Refuses invalid bounds, hull, seen points and shadow distance.
    pub(super) fn places(&self) -> Result<(), Error> {
        let Receivers { bounds, hull, seen, shadow_distance, .. } = self.frame.receivers;
        // An empty box is valid: there are no receivers.
        if let Some(problem) = bounds.filter(|bounds| *bounds != Aabb::EMPTY).and_then(|bounds| bounds.problem()) {
            return self.bad(
                "the receivers' bounding box",
                problem,
                "a box whose first corner is the minimum, or `None`",
            );
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

    pub(super) fn depth(&self, validator: &mut Validator) -> Result<(), Error> {
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
                    "Depth32Float or R32Float: with 16 bits, surfaces would shadow themselves",
                );
            }
            other => return self.bad(WHAT, format!("{other:?}"), "Depth32Float or R32Float"),
        }
        if texture.sample_count() != 1 {
            return self.bad(
                WHAT,
                format!("multisampled with {} samples per pixel", texture.sample_count()),
                "one sample per pixel: `SplitReceivers` converts four",
            );
        }
        self.bindable(validator, WHAT, depth, ViewKind::Float, "a 2D view of one layer and only the depth aspect")
    }

    pub(super) fn normals(&self, validator: &mut Validator) -> Result<(), Error> {
        const WHAT: &str = "the normals' texture";
        let Receivers { normals: Some(normals), .. } = self.frame.receivers else { return Ok(()) };
        let texture = normals.texture();
        self.as_large_as_depth(WHAT, texture)?;
        if texture.sample_count() != 1 {
            return self.bad(
                WHAT,
                format!("multisampled with {} samples per pixel", texture.sample_count()),
                "one sample per pixel",
            );
        }
        if !holds_directions(texture.format()) {
            return self.bad(
                WHAT,
                format!("{:?}", texture.format()),
                "a signed format with at least three components, such as Rgba16Float",
            );
        }
        self.bindable(validator, WHAT, normals, ViewKind::Float, "a 2D view of one layer")
    }

    pub(super) fn mask(&self, validator: &mut Validator) -> Result<(), Error> {
        const WHAT: &str = "the mask";
        let Frame { receivers, mask, .. } = self.frame;
        let read = [Some(receivers.depth), receivers.normals];
        if read.into_iter().flatten().any(|view| view.texture() == mask.texture()) {
            return self.bad(WHAT, "in the same texture as the depth buffer or the normals", "in a separate texture");
        }
        self.bindable(validator, WHAT, mask.layers_view(), ViewKind::FloatArray, "a texture of the light's device")
    }

    pub(super) fn denoise(&self, validator: &mut Validator, denoise: &Denoise) -> Result<(), Error> {
        const WHAT: &str = "the motion vectors' texture";
        if !(1..=Denoise::MAX_FRAMES).contains(&denoise.max_frames) {
            let needed = format!("1 to {}", Denoise::MAX_FRAMES);
            return self.bad("the denoiser's `max_frames`", denoise.max_frames.to_string(), needed);
        }
        let Some(motion) = &denoise.motion else { return Ok(()) };
        self.as_large_as_depth(WHAT, motion.texture())?;
        self.bindable(validator, WHAT, motion, ViewKind::Float, "a 2D view of one layer with a float format")
    }

    /// Refuses a texture of another size than the depth buffer's.
    pub(super) fn as_large_as_depth(&self, what: &'static str, texture: &wgpu::Texture) -> Result<(), Error> {
        let (size, needed) = (size_of(texture), size_of(self.frame.receivers.depth.texture()));
        if size == needed {
            return Ok(());
        }
        self.bad(what, format!("{size} texels large"), format!("as large as the depth buffer, {needed}"))
    }
}

/// Whether a matrix is a rotation and a translation, possibly with a reflection.
fn is_rigid(matrix: &Mat4) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().as_dvec3());
    let is_unit = |axis: DVec3| (axis.length() - 1.0).abs() < RIGID_TOLERANCE;
    let is_right = |a: DVec3, b: DVec3| a.dot(b).abs() < RIGID_TOLERANCE;
    let is_affine = matrix.row(3).abs_diff_eq(glam::Vec4::W, 1e-6);
    is_affine && [x, y, z].into_iter().all(is_unit) && is_right(x, y) && is_right(y, z) && is_right(z, x)
}

/// Whether a format has at least three components, signed floats or fractions.
fn holds_directions(format: wgpu::TextureFormat) -> bool {
    use wgpu::TextureFormat as Format;
    matches!(format, Format::Rgba32Float | Format::Rgba16Float | Format::Rgba16Snorm | Format::Rgba8Snorm)
}
