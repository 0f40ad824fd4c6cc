//! Rasterises casters into a light's depth map: opaque ones from positions alone, cut-out ones with a texture lookup.
//!
//! All faces are drawn: open meshes cast from both sides, and the receiver-plane comparison needs no help from culling.

use antumbra_light::Aabb;
use glam::{Mat4, Vec3, Vec4};

use crate::contract::{Error, MeshCaster, Opacity};
use crate::gpu::{
    Bindings, DrawPipeline, Gpu, Stage, bindings, depth_state, gpu_structs, samples, texels, white_texture,
};
use crate::light_map::caster_surface::SurfaceValues;
use crate::shaders;

gpu_structs! {
    /// The view that a pass renders.
    pub(crate) struct CasterView {
        clip_from_world: Mat4,
        anchor_in_world: Vec3,
        /// Of the light point that the view is from, counted from 1; 0: of the light as a whole.
        light_point: u32,
        /// What stopped light is weighed by.
        color_weights: Vec3,
        padding: u32,
    }

    /// A surface that is not opaque: [`SurfaceValues`].
    pub(crate) struct Cutout {
        factor: Vec4,
        cutoff: f32,
        coverage: u32,
        padding_0: u32,
        padding_1: u32,
    }
}

bindings! {
    struct OneOfViews = "caster view", VERTEX, group 0 of [CASTER_DEPTH_OPAQUE] {
        0 caster_view: DynamicUniform(size_of::<CasterView>()),
    }

    struct Holes = "cut-out", FRAGMENT, group 1 of [CASTER_DEPTH_CUTOUT] {
        0 cutout: Uniform,
        1 surface: Texture(texels::FILTERED),
        2 surface_sampler: Sampler(samples::FILTERS),
    }
}

/// Dynamic uniform offsets are multiples of WebGPU's default alignment.
const UNIFORM_STRIDE: u64 = 256;

/// A view to draw casters in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnView {
    pub(crate) clip_from_world: Mat4,
    /// The light point that it is from, where it is one of many: translucent casters are there for as many of them as
    /// they stop light. In a view of the light as a whole they are there where they stop half of it or more.
    pub(crate) light_point: Option<u32>,
    /// What light of each colour counts.
    pub(crate) color_weights: Vec3,
}

impl DrawnView {
    /// Of white light's luminance, by Rec. 709.
    pub(crate) const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

    /// A view of the light as a whole.
    pub(crate) fn whole(clip_from_world: Mat4) -> Self {
        Self { clip_from_world, light_point: None, color_weights: Self::LUMINANCE }
    }
}

/// Whether the device has square maps of `size` texels a side.
pub(crate) fn check_map_size(gpu: &Gpu, technique: &'static str, size: u32, remedy: &'static str) -> Result<(), Error> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if size <= limit {
        return Ok(());
    }
    Err(Error::Unsupported {
        technique,
        needed: format!("light maps of {size}² texels"),
        had: format!("at most {limit}²"),
        remedy,
    })
}

/// What to do with the casters' fragments: a pipeline for opaque casters and one for those with holes.
#[derive(Debug)]
pub(crate) struct CasterProgram {
    opaque: wgpu::RenderPipeline,
    /// For closed meshes, where their back faces are left out.
    opaque_closed: Option<wgpu::RenderPipeline>,
    cutout: wgpu::RenderPipeline,
}

/// The makings of a [`CasterProgram`]. Both shaders have the entry point `vertex` of this block's own ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CasterProgramDescriptor<'a> {
    pub(crate) label: &'a str,
    pub(crate) opaque_wgsl: &'static str,
    pub(crate) cutout_wgsl: &'static str,
    /// The fragment entry point; opaque casters have none where it is `None`.
    pub(crate) opaque_fragment: Option<&'a str>,
    pub(crate) cutout_fragment: &'a str,
    /// The fragment entry points' overridable constants.
    pub(crate) constants: &'a [(&'a str, f64)],
    /// Group 2, which is the program's own.
    pub(crate) layout: Option<&'a wgpu::BindGroupLayout>,
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) depth_compare: wgpu::CompareFunction,
    pub(crate) depth_write: bool,
    /// Leaves out the back faces of closed, opaque meshes.
    pub(crate) front_faces_of_solids: bool,
    /// Samples a texel of the attachments.
    pub(crate) sample_count: u32,
}

/// Rasterises casters into depth maps.
#[derive(Debug)]
pub(crate) struct CasterDepth {
    view_layout: wgpu::BindGroupLayout,
    cutout_layout: wgpu::BindGroupLayout,
    depth_alone: CasterProgram,
    white: wgpu::TextureView,
    sampler: wgpu::Sampler,
    views: Option<(wgpu::Buffer, wgpu::BindGroup)>,
    /// One a caster; `None` where it is opaque.
    cutouts: Vec<Option<wgpu::BindGroup>>,
    /// Casters that a view may see.
    is_in_views: Vec<bool>,
    /// Zero texture coordinates for translucent casters without a texture.
    no_uvs: Option<wgpu::Buffer>,
}

impl CasterDepth {
    /// The maps' format: 32-bit float, reversed.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// What a map is cleared to: the far plane.
    pub(crate) const CLEAR_DEPTH: f32 = 0.0;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self::multisampled(gpu, 1)
    }

    /// For maps with `sample_count` samples a texel.
    pub(crate) fn multisampled(gpu: &Gpu, sample_count: u32) -> Self {
        let (view_layout, cutout_layout) = (OneOfViews::layout(gpu), Holes::layout(gpu));
        let depth_alone = program(
            gpu,
            &view_layout,
            &cutout_layout,
            &CasterProgramDescriptor {
                label: "antumbra caster depth",
                opaque_wgsl: shaders::CASTER_DEPTH_OPAQUE,
                cutout_wgsl: shaders::CASTER_DEPTH_CUTOUT,
                opaque_fragment: None,
                cutout_fragment: "fragment",
                constants: &[],
                layout: None,
                targets: &[],
                depth_compare: wgpu::CompareFunction::Greater,
                depth_write: true,
                front_faces_of_solids: false,
                sample_count,
            },
        );
        Self {
            view_layout,
            cutout_layout,
            depth_alone,
            white: white_texture(gpu),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
            views: None,
            cutouts: Vec::new(),
            is_in_views: Vec::new(),
            no_uvs: None,
        }
    }

    /// Another program for the same casters.
    pub(crate) fn program(&self, gpu: &Gpu, descriptor: &CasterProgramDescriptor<'_>) -> CasterProgram {
        program(gpu, &self.view_layout, &self.cutout_layout, descriptor)
    }

    /// Uploads the views of the light as a whole that the frame's passes will render, and the casters' surfaces.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, clip_from_world: &[Mat4], casters: &[MeshCaster<'_>]) {
        let views: Vec<_> = clip_from_world.iter().copied().map(DrawnView::whole).collect();
        self.prepare_views(stage, &views, casters);
    }

    /// The same of any views.
    pub(crate) fn prepare_views(&mut self, stage: &Stage<'_>, views: &[DrawnView], casters: &[MeshCaster<'_>]) {
        let needed = views.len() as u64 * UNIFORM_STRIDE;
        if self.views.as_ref().is_none_or(|(buffer, _)| buffer.size() < needed) {
            let buffer = stage.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra caster views"),
                size: needed,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let bind_group = OneOfViews { caster_view: &buffer }.group(stage, &self.view_layout);
            self.views = Some((buffer, bind_group));
        }
        let mut bytes = vec![0u8; needed as usize];
        for (chunk, view) in bytes.chunks_exact_mut(UNIFORM_STRIDE as usize).zip(views) {
            let view = CasterView {
                clip_from_world: view.clip_from_world,
                anchor_in_world: stage.anchor(),
                light_point: view.light_point.map_or(0, |point| point + 1),
                color_weights: view.color_weights,
                padding: 0,
            };
            chunk[..size_of::<CasterView>()].copy_from_slice(bytemuck::bytes_of(&view));
        }
        let (buffer, _) = self.views.as_ref().expect("made above where it was missing");
        stage.upload(buffer, 0, &bytes);

        self.cutouts = casters.iter().map(|caster| self.cutout_bind_group(stage, &caster.opacity)).collect();
        let sides = || views.iter().map(|view| ViewSides::of(&view.clip_from_world)).collect::<Vec<_>>();
        let asked = (views.len() <= MOST_VIEWS_ASKED).then(sides);
        let sees = |caster: &MeshCaster<'_>| {
            asked.as_ref().is_none_or(|asked| asked.iter().any(|sides| sides.may_hold(&caster.bounds)))
        };
        self.is_in_views.clear();
        self.is_in_views.extend(casters.iter().map(sees));
        make_no_uvs(stage, &mut self.no_uvs, casters);
    }

    fn cutout_bind_group(&self, stage: &Stage<'_>, opacity: &Opacity<'_>) -> Option<wgpu::BindGroup> {
        let SurfaceValues { factor, cutoff, coverage } = SurfaceValues::of(opacity)?;
        let texture = opacity.texture();
        let cutout = Cutout { factor, cutoff, coverage, ..Cutout::default() };
        let buffer = stage.uniform("antumbra cut-out", &cutout);
        let holes = Holes {
            cutout: &buffer,
            surface: texture.map_or(&self.white, |texture| texture.view),
            surface_sampler: texture.map_or(&self.sampler, |texture| texture.sampler),
        };
        Some(holes.group(stage, &self.cutout_layout))
    }

    /// Of group 0, which [`bind_view`](Self::bind_view) binds.
    pub(crate) fn view_layout(&self) -> &wgpu::BindGroupLayout {
        &self.view_layout
    }

    /// Binds a prepared view, as group 0.
    pub(crate) fn bind_view(&self, pass: &mut wgpu::RenderPass<'_>, view_index: u32) {
        let views = self.views.as_ref().map(|(_, bind_group)| bind_group);
        pass.set_bind_group(0, views, &[view_index * UNIFORM_STRIDE as u32]);
    }

    /// Draws the prepared casters into a pass, as view `view_index` sees them.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view_index: u32, casters: &[MeshCaster<'_>]) {
        self.draw_with(&self.depth_alone, pass, view_index, casters);
    }

    /// [`draw`](Self::draw) with another program, whose group 2 the pass has set.
    pub(crate) fn draw_with(
        &self,
        program: &CasterProgram,
        pass: &mut wgpu::RenderPass<'_>,
        view_index: u32,
        casters: &[MeshCaster<'_>],
    ) {
        self.bind_view(pass, view_index);
        for kind in [Kind::Opaque, Kind::OpaqueClosed, Kind::CutOut] {
            let pipeline = match kind {
                Kind::Opaque => Some(&program.opaque),
                Kind::OpaqueClosed => program.opaque_closed.as_ref(),
                Kind::CutOut => Some(&program.cutout),
            };
            let Some(pipeline) = pipeline else { continue };
            let mut bound = Bound::default();
            let of_views = casters.iter().zip(&self.cutouts).zip(&self.is_in_views);
            for ((caster, cutout), _) in of_views.filter(|(_, is_in_views)| **is_in_views) {
                let is_of = match cutout {
                    Some(_) => Kind::CutOut,
                    None if caster.closed && program.opaque_closed.is_some() => Kind::OpaqueClosed,
                    None => Kind::Opaque,
                };
                if is_of != kind || caster.index_count == 0 || caster.instance_count == 0 {
                    continue;
                }
                bound.pipeline(pass, pipeline);
                bound.vertices(pass, 0, caster.positions);
                bound.vertices(pass, 1, caster.instances);
                if let Some(cutout) = cutout {
                    pass.set_bind_group(1, cutout, &[]);
                    let no_uvs = || self.no_uvs.as_ref().expect("made by prepare for casters like this");
                    bound.vertices(pass, 2, caster.opacity.texture().map_or_else(no_uvs, |texture| texture.uvs));
                }
                bound.indices(pass, caster.indices);
                pass.draw_indexed(caster.index_range(), 0, caster.instance_range());
            }
        }
    }
}

/// What a pass has bound for its draws: what the next draw has too is not bound again.
#[derive(Default)]
pub(crate) struct Bound<'a> {
    pipeline: Option<&'a wgpu::RenderPipeline>,
    vertices: [Option<&'a wgpu::Buffer>; 3],
    indices: Option<&'a wgpu::Buffer>,
}

impl<'a> Bound<'a> {
    pub(crate) fn pipeline(&mut self, pass: &mut wgpu::RenderPass<'_>, pipeline: &'a wgpu::RenderPipeline) {
        if self.pipeline.replace(pipeline) != Some(pipeline) {
            pass.set_pipeline(pipeline);
        }
    }

    pub(crate) fn vertices(&mut self, pass: &mut wgpu::RenderPass<'_>, slot: usize, buffer: &'a wgpu::Buffer) {
        if self.vertices[slot].replace(buffer) != Some(buffer) {
            pass.set_vertex_buffer(slot as u32, buffer.slice(..));
        }
    }

    /// Of 32 bits each.
    pub(crate) fn indices(&mut self, pass: &mut wgpu::RenderPass<'_>, buffer: &'a wgpu::Buffer) {
        if self.indices.replace(buffer) != Some(buffer) {
            pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
        }
    }
}

/// As many views are asked which casters they see; more see most of them, each others.
const MOST_VIEWS_ASKED: usize = 8;

/// The sides of what a view of a matrix has texels for, to ask which boxes lie beyond one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ViewSides {
    clip_from_world: Mat4,
    /// Each component negative inside: of a clip position, and of half a box along the world's axes at the most.
    sides: [(Vec4, Vec3); 6],
}

impl ViewSides {
    pub(crate) fn of(clip_from_world: &Mat4) -> Self {
        // Beyond x = w, x = −w, y = w, y = −w, behind the light, and beyond the far plane, where depth is 0.
        let sides = [
            Vec4::new(1.0, 0.0, 0.0, -1.0),
            Vec4::new(-1.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 1.0, 0.0, -1.0),
            Vec4::new(0.0, -1.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, -1.0, 0.0),
        ];
        let Mat4 { x_axis, y_axis, z_axis, .. } = *clip_from_world;
        let sides = sides.map(|side| (side, Vec3::new(side.dot(x_axis), side.dot(y_axis), side.dot(z_axis)).abs()));
        Self { clip_from_world: *clip_from_world, sides }
    }

    /// Whether any of a box can be where the view has texels. Nothing of a box is drawn that lies beyond one side, since sides are
    /// planes in homogeneous coordinates.
    pub(crate) fn may_hold(&self, bounds: &Aabb) -> bool {
        let (middle, half) = (0.5 * bounds.min + 0.5 * bounds.max, 0.5 * bounds.max - 0.5 * bounds.min);
        let Mat4 { x_axis, y_axis, z_axis, w_axis } = self.clip_from_world;
        let middle = x_axis * middle.x + y_axis * middle.y + z_axis * middle.z + w_axis;
        let reach = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
        // The rasteriser's own rounding, at the corner where it is largest.
        let slack = 1e-4 * (middle.abs() + reach).max_element();
        !self.sides.iter().any(|(side, of_half)| side.dot(middle) - of_half.dot(half) > slack)
    }
}

/// Which pipeline draws a caster.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Opaque,
    OpaqueClosed,
    CutOut,
}

fn program(
    gpu: &Gpu,
    view_layout: &wgpu::BindGroupLayout,
    cutout_layout: &wgpu::BindGroupLayout,
    descriptor: &CasterProgramDescriptor<'_>,
) -> CasterProgram {
    CasterProgram {
        opaque: pipeline(gpu, descriptor, [Some(view_layout), None, descriptor.layout], Kind::Opaque),
        opaque_closed: descriptor
            .front_faces_of_solids
            .then(|| pipeline(gpu, descriptor, [Some(view_layout), None, descriptor.layout], Kind::OpaqueClosed)),
        cutout: pipeline(gpu, descriptor, [Some(view_layout), Some(cutout_layout), descriptor.layout], Kind::CutOut),
    }
}

fn pipeline(
    gpu: &Gpu,
    descriptor: &CasterProgramDescriptor<'_>,
    bind_group_layouts: [Option<&wgpu::BindGroupLayout>; 3],
    kind: Kind,
) -> wgpu::RenderPipeline {
    let cut_out = kind == Kind::CutOut;
    let (wgsl, fragment) = if cut_out {
        (descriptor.cutout_wgsl, Some(descriptor.cutout_fragment))
    } else {
        (descriptor.opaque_wgsl, descriptor.opaque_fragment)
    };
    let used = bind_group_layouts.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let buffers = [Some(POSITIONS), Some(INSTANCES), Some(UVS)];
    DrawPipeline {
        label: descriptor.label,
        wgsl,
        layouts: &bind_group_layouts[..used],
        vertex_buffers: if cut_out { &buffers } else { &buffers[..2] },
        fragment,
        constants: descriptor.constants,
        targets: descriptor.targets,
        primitive: caster_primitives(gpu, (kind == Kind::OpaqueClosed).then_some(wgpu::Face::Back)),
        depth: Some(depth_state(CasterDepth::FORMAT, descriptor.depth_compare, descriptor.depth_write)),
        sample_count: descriptor.sample_count,
        ..DrawPipeline::default()
    }
    .create(gpu)
}

/// Casters' positions.
pub(crate) const POSITIONS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 12,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3],
};

/// Casters' matrices, column by column.
pub(crate) const INSTANCES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Float32x4],
};

/// Casters' texture coordinates.
pub(crate) const UVS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 8,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![5 => Float32x2],
};

/// How casters' triangles are drawn: those nearer than the near plane, where the light's plane cuts them, are kept at it.
pub(crate) fn caster_primitives(gpu: &Gpu, cull_mode: Option<wgpu::Face>) -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        cull_mode,
        unclipped_depth: gpu.has(wgpu::Features::DEPTH_CLIP_CONTROL),
        ..wgpu::PrimitiveState::default()
    }
}

/// Stand-in texture coordinates for translucent casters without a texture, as many as the largest has vertices: their shader
/// reads some.
pub(crate) fn make_no_uvs(stage: &Stage<'_>, no_uvs: &mut Option<wgpu::Buffer>, casters: &[MeshCaster<'_>]) {
    let most_vertices = casters
        .iter()
        .filter(|caster| matches!(caster.opacity, Opacity::Translucent { texture: None, .. }))
        .map(|caster| caster.positions.size() / 12)
        .max()
        .unwrap_or(0);
    if most_vertices > 0 && no_uvs.as_ref().is_none_or(|buffer| buffer.size() < most_vertices * 8) {
        *no_uvs = Some(stage.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("antumbra no texture coordinates"),
            size: most_vertices * 8,
            usage: wgpu::BufferUsages::VERTEX,
            mapped_at_creation: false,
        }));
    }
}

#[cfg(test)]
mod tests {
    use antumbra_light::{hash_u32, unit_f32};

    use super::*;

    /// A box of which any place is in a view is never left out; most others are, whose corners lie beyond one side.
    #[test]
    fn views_leave_out_boxes_beside_them_alone() {
        let unit = |i: u32| unit_f32(hash_u32(i)) * 2.0 - 1.0;
        let place = |i: u32| Vec3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2));
        let projections = [
            glam::camera::rh::proj::directx::perspective(1.2, 1.3, 40.0, 0.2),
            glam::camera::rh::proj::directx::orthographic(-3.0, 3.0, -2.0, 2.0, 20.0, 0.1),
        ];
        let (mut held, mut beside, mut left_out) = (0, 0, 0);
        for case in 0..4000 {
            let first = 50 * case;
            let pose = glam::camera::rh::view::look_at_mat4(4.0 * place(first), place(first + 1), Vec3::Y);
            let clip_from_world = projections[case as usize % 2] * pose;
            let (middle, half) = (8.0 * place(first + 2), place(first + 3).abs() * 1.5);
            let bounds = Aabb { min: middle - half, max: middle + half };
            let may_hold = ViewSides::of(&clip_from_world).may_hold(&bounds);
            // The near plane clips nothing: what is nearer is drawn at it.
            let is_inside = |x: Vec3| {
                let clip = clip_from_world * x.extend(1.0);
                clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z >= 0.0
            };
            let corners = bounds.corners().map(|x| clip_from_world * x.extend(1.0));
            if (4..40).any(|i| is_inside(middle + half * place(first + i))) {
                held += 1;
                assert!(may_hold, "case {case}: {bounds:?}");
            }
            let sides: [fn(Vec4) -> f32; 4] = [|c| c.x - c.w, |c| -c.x - c.w, |c| c.y - c.w, |c| -c.y - c.w];
            if sides.iter().any(|side| corners.iter().all(|clip| side(*clip) > 1e-3 * clip.abs().max_element())) {
                beside += 1;
                left_out += u32::from(!may_hold);
            }
        }
        assert!(
            held > 400 && beside > 1000 && 100 * left_out > 95 * beside,
            "{held} held, {left_out} of {beside} left out"
        );
    }
}
