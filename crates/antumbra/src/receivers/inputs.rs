//! Bind group 0 of every pass over the receivers: receivers, light and mask. The shader side is
//! `receivers/inputs.wesl`.

use antumbra_light::{Light, LightShape};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3, Vec4};

use super::blue_noise;
use crate::contract::{Camera, Mask, PreparedFrame, PreparedReceivers, Surfaces};
use crate::gpu::{
    Bindings, EmbeddedGroup, Gpu, Stage, bindings, create_uniform, gpu_structs, texels, upload_storage, write_uniform,
};

/// Width of a workgroup over the receivers, threads.
const TILE: u32 = 8;

gpu_structs! {
    /// Receivers: the camera of a depth buffer, or the layout of points, which have no camera.
    pub(crate) struct ReceiverView {
        view_from_clip: Mat4,
        world_from_view: Mat4,
        eye_in_world: Vec3,
        background_depth: f32,
        size_px: UVec2,
        has_normals: u32,
        mask_layers: u32,
        origin_px: UVec2,
        mask_origin_px: UVec2,
        noise_frame: u32,
        pixel_stride: u32,
        matrix_rounding_m: f32,
        pixel_m_per_w: f32,
        clip_z_row: Vec4,
        clip_w_row: Vec4,
        are_points: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
        anchor_in_world: Vec3,
        padding_3: u32,
    }

    /// Light for visibility: shape, pose, reach. The host applies its colour.
    pub(crate) struct LightSource {
        center_in_world: Vec3,
        kind: u32,
        right_in_world: Vec3,
        /// Half the extent along right: half width, radius, half-axis, or tangent of the half-angle.
        half_right: f32,
        up_in_world: Vec3,
        half_up: f32,
        axis_in_world: Vec3,
        half_axis: f32,
        /// Tangent of the frustum's half-angle; 0 if the frustum is unbounded.
        max_angle_tangent: f32,
        /// Number of entries in the data buffer: positions of a list of points.
        point_count: u32,
        /// Size of the emission texture in the data buffer; 0 for uniform emission.
        emission_size: UVec2,
        /// Cosine of a spot's outer angle; −1 without a cone.
        cone_cosine: f32,
        padding_0: f32,
        padding_1: f32,
        padding_2: f32,
    }
}

bindings! {
    /// Vertex and fragment shaders may read receivers, but only compute shaders write the mask. Checked against shaders as
    /// part of `MissingInputs`.
    struct Inputs = "frame inputs", COMPUTE | VERTEX_FRAGMENT {
        0 receiver_view: Uniform,
        1 light_source: Uniform,
        2 receiver_depth: Texture(texels::FLOAT),
        3 receiver_normals: Texture(texels::FLOAT),
        4 mask: ReadWriteArray(Mask::FORMAT) in COMPUTE,
        5 light_data: Storage in COMPUTE,
        6 noise_tile: Texture(texels::FLOAT),
    }

    /// Bindings that functions in hosts' shaders read. Checked against shaders as part of the embedded groups.
    struct EmbeddedInputs = "frame inputs of hosts' shaders", COMPUTE {
        0 receiver_view: Uniform,
        1 light_source: Uniform,
        5 light_data: Storage,
        6 noise_tile: Texture(texels::FLOAT),
    }

    /// Bindings of entry points that write the pixels that interpolation left missing.
    struct MissingInputs = "frame inputs of missing pixels", COMPUTE, group 0 of [PCSS_RESOLVE, LISTS_MARK_MISSING], with inputs: Inputs {
        /// Number of missing pixels, then each as x | y << 16.
        7 missing: Storage,
    }
}

/// Returns `LightSource::kind`, the shaders' `KIND_…`; a test compares the numbers.
pub(crate) fn kind_of(shape: &LightShape) -> u32 {
    match shape {
        LightShape::Rectangle { .. } => 0,
        LightShape::Disk { .. } => 1,
        LightShape::Sphere { .. } => 2,
        LightShape::Ellipsoid { .. } => 3,
        LightShape::Sun { .. } => 4,
        LightShape::Points { .. } => 5,
    }
}

fn light_source(light: &Light) -> LightSource {
    let frame = light.frame();
    let half = match &light.shape {
        LightShape::Rectangle { size_m } => (0.5 * *size_m).extend(0.0),
        LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => Vec3::new(*radius_m, *radius_m, 0.0),
        LightShape::Ellipsoid { radii_m } => *radii_m,
        LightShape::Sun { .. } => Vec3::new(light.bounding_radius(), light.bounding_radius(), 0.0),
        LightShape::Points { .. } => Vec3::ZERO,
    };
    let (point_count, emission_size) = match (&light.shape, &light.emission) {
        (LightShape::Points { positions_m }, _) => (positions_m.len() as u32, UVec2::ZERO),
        (LightShape::Rectangle { .. }, Some(texture)) => (0, UVec2::new(texture.width, texture.height)),
        _ => (0, UVec2::ZERO),
    };
    LightSource {
        center_in_world: frame.center,
        kind: kind_of(&light.shape),
        right_in_world: frame.right,
        half_right: half.x,
        up_in_world: frame.up,
        half_up: half.y,
        axis_in_world: frame.axis,
        half_axis: half.z,
        max_angle_tangent: light.fov_rad.map_or(0.0, |fov| (0.5 * fov).tan()),
        point_count,
        emission_size,
        cone_cosine: light.cone.map_or(-1.0, |cone| cone.outer_rad.cos()),
        padding_0: 0.0,
        padding_1: 0.0,
        padding_2: 0.0,
    }
}

/// Returns the positions of a list of points, or the luminances of an emission texture in x. It has at least one entry,
/// because a binding cannot be empty.
fn light_data(light: &Light) -> Vec<Vec4> {
    match (&light.shape, &light.emission) {
        (LightShape::Points { positions_m }, _) => positions_m.iter().map(|p| p.extend(1.0)).collect(),
        (LightShape::Rectangle { .. }, Some(texture)) => {
            texture.luminance.iter().map(|l| Vec4::new(*l, 0.0, 0.0, 0.0)).collect()
        }
        _ => vec![Vec4::ZERO],
    }
}

/// Buffers of bind group 0.
#[derive(Debug)]
pub(crate) struct FrameInputs {
    pub(crate) layout: wgpu::BindGroupLayout,
    receiver_view: wgpu::Buffer,
    light_source: wgpu::Buffer,
    light_data: Option<wgpu::Buffer>,
    no_normals: wgpu::TextureView,
    noise_tile: wgpu::TextureView,
}

/// Bind group 0 of one frame, and the size of its image.
#[derive(Clone, Debug)]
pub(crate) struct PreparedInputs {
    group: wgpu::BindGroup,
    light_data: wgpu::Buffer,
    size_px: UVec2,
    /// Distance between [known](Self::dispatch_known) pixels.
    stride_px: u32,
}

impl FrameInputs {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let no_normals = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra no normals"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let no_normals = gpu.device.create_view(&no_normals, &wgpu::TextureViewDescriptor::default());
        Self {
            layout: Inputs::layout(gpu),
            receiver_view: create_uniform::<ReceiverView>(gpu, "antumbra receiver view"),
            light_source: create_uniform::<LightSource>(gpu, "antumbra light source"),
            light_data: None,
            no_normals,
            noise_tile: blue_noise::tile(gpu).clone(),
        }
    }

    /// Uploads a frame that has been validated.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, frame: &PreparedFrame<'_>) -> PreparedInputs {
        self.prepare_known(stage, frame, 1)
    }

    /// Uploads a frame whose known pixels are those with column and row a multiple of `stride_px`.
    pub(crate) fn prepare_known(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        stride_px: u32,
    ) -> PreparedInputs {
        let view = ReceiverView { pixel_stride: stride_px, ..receiver_view(stage, frame) };
        write_uniform(stage, &self.receiver_view, &view);
        write_uniform(stage, &self.light_source, &light_source(frame.light));
        let light_data =
            upload_storage(stage, &mut self.light_data, "antumbra light data", &light_data(frame.light)).clone();
        let group = self.inputs_of(frame, &light_data).group(stage, &self.layout);
        PreparedInputs { group, light_data, size_px: frame.receivers.size_px, stride_px }
    }

    /// Returns the layout of [`missing_group`](Self::missing_group).
    pub(crate) fn missing_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        MissingInputs::layout(gpu)
    }

    /// Returns group 0 of a frame, with a list of pixels.
    pub(crate) fn missing_group(
        &self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        prepared: &PreparedInputs,
        layout: &wgpu::BindGroupLayout,
        missing: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        MissingInputs { inputs: self.inputs_of(frame, &prepared.light_data), missing }.group(stage, layout)
    }

    /// Returns the part of group 0 that functions in hosts' shaders read, for the last prepared frame; `None` before the first.
    pub(crate) fn embedded(&self) -> Option<EmbeddedGroup> {
        Some(EmbeddedGroup::of(&EmbeddedInputs {
            receiver_view: &self.receiver_view,
            light_source: &self.light_source,
            light_data: self.light_data.as_ref()?,
            noise_tile: &self.noise_tile,
        }))
    }

    fn inputs_of<'a>(&'a self, frame: &PreparedFrame<'a>, light_data: &'a wgpu::Buffer) -> Inputs<'a> {
        Inputs {
            receiver_view: &self.receiver_view,
            light_source: &self.light_source,
            receiver_depth: frame.receivers.texels(),
            receiver_normals: frame.receivers.normals.unwrap_or(&self.no_normals),
            mask: frame.mask.layers_view(),
            light_data,
            noise_tile: &self.noise_tile,
        }
    }
}

impl PreparedInputs {
    /// Binds group 0.
    pub(crate) fn bind(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.group, &[]);
    }

    /// Binds group 0 in a render pass.
    pub(crate) fn bind_drawn(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.group, &[]);
    }

    /// Dispatches one thread per pixel.
    pub(crate) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.dispatch_rows(pass, self.size_px.y);
    }

    /// Dispatches one thread per known pixel: `known_pixel` in the shader.
    pub(crate) fn dispatch_known(&self, pass: &mut wgpu::ComputePass<'_>) {
        let known = self.size_px.map(|px| px.div_ceil(self.stride_px).div_ceil(TILE));
        pass.dispatch_workgroups(known.x, known.y, 1);
    }

    /// Dispatches one thread per pixel and layer.
    pub(crate) fn dispatch_layers(&self, pass: &mut wgpu::ComputePass<'_>, layers: u32) {
        pass.dispatch_workgroups(self.size_px.x.div_ceil(TILE), self.size_px.y.div_ceil(TILE), layers);
    }

    /// Dispatches one thread per pixel for a number of rows.
    pub(crate) fn dispatch_rows(&self, pass: &mut wgpu::ComputePass<'_>, rows: u32) {
        pass.dispatch_workgroups(self.size_px.x.div_ceil(TILE), rows.div_ceil(TILE), 1);
    }
}

/// Error of positions due to rounding in the host's matrices, metres; 0 without an anchor, because coordinates then show it. The
/// rounded entries of a translation and a rotation, and as much again for the products at each vertex, sum to eight half units
/// in the last place of the camera's distance from the world's origin.
pub(crate) fn matrix_rounding_m(stage: &Stage<'_>, receivers: &PreparedReceivers<'_>) -> f32 {
    let anchor = stage.anchor();
    if anchor == Vec3::ZERO {
        return 0.0;
    }
    // For points, coordinates and the casters' matrices are rounded at the anchor's scale.
    let eye = receivers.camera().map_or(DVec3::ZERO, Camera::eye_in_world);
    4.0 * f32::EPSILON * (eye + anchor.as_dvec3()).length() as f32
}

/// Returns the larger side of a pixel, metres, where the clip position's w is 1: 1 m in front of a perspective camera,
/// anywhere in front of an orthographic one.
fn pixel_m_per_w(view_from_clip: &Mat4, size_px: UVec2) -> f32 {
    // At constant w and depth, a step of the clip position's x or y over w moves the view position by the inverse's column.
    let Mat4 { x_axis, y_axis, .. } = view_from_clip;
    let per_ndc = Vec2::new(x_axis.truncate().length(), y_axis.truncate().length());
    (2.0 * per_ndc / size_px.as_vec2()).max_element()
}

fn receiver_view(stage: &Stage<'_>, frame: &PreparedFrame<'_>) -> ReceiverView {
    let receivers = &frame.receivers;
    let common = ReceiverView {
        size_px: receivers.size_px,
        has_normals: receivers.normals.is_some().into(),
        mask_layers: frame.mask.channels().count(),
        origin_px: receivers.origin_px,
        mask_origin_px: frame.mask.place().origin_px,
        noise_frame: stage.noise_frame(),
        pixel_stride: 1,
        matrix_rounding_m: matrix_rounding_m(stage, receivers),
        anchor_in_world: stage.anchor(),
        ..ReceiverView::default()
    };
    let Surfaces::Depth { camera, .. } = &receivers.surfaces else {
        return ReceiverView { are_points: 1, ..common };
    };
    // Shared by all lights, and all their parts, that one camera sees.
    let of_camera = stage.device.shared_values().get_or_make(*camera, CameraMatrices::of);
    let CameraMatrices { view_from_clip, world_from_view, clip_depth_rows: [clip_z_row, clip_w_row] } = of_camera.1;
    ReceiverView {
        view_from_clip,
        world_from_view,
        eye_in_world: world_from_view.w_axis.truncate(),
        background_depth: camera.depth_convention.background(),
        pixel_m_per_w: pixel_m_per_w(&view_from_clip, receivers.size_px),
        clip_z_row,
        clip_w_row,
        ..common
    }
}

/// Matrices that follow from a camera.
#[derive(Clone, Copy)]
struct CameraMatrices {
    view_from_clip: Mat4,
    world_from_view: Mat4,
    clip_depth_rows: [Vec4; 2],
}

impl CameraMatrices {
    fn of(camera: &Camera) -> Self {
        Self {
            view_from_clip: camera.clip_from_view.as_dmat4().inverse().as_mat4(),
            world_from_view: camera.view_from_world.as_dmat4().inverse().as_mat4(),
            clip_depth_rows: camera.clip_depth_rows(),
        }
    }
}

/// Returns the rows of the camera's matrix that yield depth; zero for points, whose positions do not come from depth.
pub(crate) fn clip_depth_rows(receivers: &PreparedReceivers<'_>) -> [Vec4; 2] {
    receivers.camera().map_or([Vec4::ZERO; 2], |camera| camera.clip_depth_rows())
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::proj::directx::{orthographic, perspective_infinite_reverse};

    use super::*;

    /// The width equals the distance to a neighbour at the same clip position, computed with the inverse matrix.
    #[test]
    fn a_pixel_is_as_wide_as_to_its_neighbour() {
        let size_px = UVec2::new(160, 90);
        let perspective = perspective_infinite_reverse(0.8, 16.0 / 9.0, 0.1);
        let turned = Mat4::from_rotation_z(std::f32::consts::FRAC_PI_2);
        for (name, clip_from_view) in [
            ("perspective", perspective),
            ("shifted", Mat4::from_translation(Vec3::new(0.3, -0.2, 0.0)) * perspective),
            ("drawn sideways", turned * perspective),
            ("orthographic", orthographic(-4.0, 4.0, -2.0, 2.0, 0.0, 20.0)),
        ] {
            let clip = clip_from_view * Vec3::new(0.4, -0.3, -7.0).extend(1.0);
            let view_of = |offset_px: Vec2| {
                let offset = (2.0 * offset_px / size_px.as_vec2()).extend(0.0);
                clip_from_view.inverse().project_point3(clip.truncate() / clip.w + offset)
            };
            let widths = [Vec2::X, Vec2::Y].map(|step_px| view_of(step_px).distance(view_of(Vec2::ZERO)));
            let view_from_clip = clip_from_view.as_dmat4().inverse().as_mat4();
            let got = pixel_m_per_w(&view_from_clip, size_px) * clip.w.abs();
            let want = widths[0].max(widths[1]);
            assert!((got - want).abs() < 2e-3 * want, "{name}: {got} m, {want} to the neighbour");
        }
    }
}
