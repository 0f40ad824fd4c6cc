//! Rasterises casters into a light's depth map: opaque ones from positions alone, cut-out ones with a texture lookup.
//!
//! All faces are drawn: open meshes cast from both sides, and the receiver-plane comparison needs no help from culling.

mod bound;
mod program;
mod view_sides;

use glam::{Mat4, Vec3, Vec4};

use crate::contract::{Error, MeshCaster, Opacity};
use crate::gpu::{Bindings, Gpu, Stage, bindings, gpu_structs, samples, texels, white_texture};
use crate::light_map::caster_surface::SurfaceValues;
use crate::shaders;
pub(crate) use bound::Bound;
pub(crate) use program::{CasterProgram, CasterProgramDescriptor, INSTANCES, POSITIONS, UVS, caster_primitives};
use program::{Kind, program};
pub(crate) use view_sides::ViewSides;

gpu_structs! {
    /// Light view that a pass renders.
    pub(crate) struct CasterView {
        clip_from_world: Mat4,
        anchor_in_world: Vec3,
        /// Light point of the view, counted from 1; 0 for a view of the whole light.
        light_point: u32,
        /// Weights of the colours of stopped light: luminance, or one colour.
        color_weights: Vec3,
        padding: u32,
    }

    /// Values of a surface that is not opaque: [`SurfaceValues`].
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

/// Stride of views in the uniform buffer, bytes: WebGPU's default alignment of dynamic offsets.
const UNIFORM_STRIDE: u64 = 256;

/// View in which casters are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnView {
    pub(crate) clip_from_world: Mat4,
    /// Light point of the view, if it is one of many: translucent casters block for a share of the points equal to the
    /// light that they stop. In a view of the whole light (`None`) they block where they stop at least half of it.
    pub(crate) light_point: Option<u32>,
    /// Weights of the colours of stopped light.
    pub(crate) color_weights: Vec3,
}

impl DrawnView {
    /// Colour weights of luminance, by Rec. 709.
    pub(crate) const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

    /// View of the whole light.
    pub(crate) fn whole(clip_from_world: Mat4) -> Self {
        Self { clip_from_world, light_point: None, color_weights: Self::LUMINANCE }
    }
}

/// Checks that the device supports square maps of `size` texels a side.
pub(crate) fn check_map_size(gpu: &Gpu, technique: &'static str, size: u32, remedy: &'static str) -> Result<(), Error> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if size <= limit {
        return Ok(());
    }
    Err(Error::Unsupported {
        technique,
        needed: format!("shadow maps of {size} × {size} texels"),
        had: format!("at most {limit} × {limit}"),
        remedy,
    })
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
    /// Surfaces' bind groups, one per caster; `None` for opaque ones.
    cutouts: Vec<Option<wgpu::BindGroup>>,
    /// Whether any view may see the caster, one per caster.
    is_in_views: Vec<bool>,
    /// Zero texture coordinates for translucent casters without a texture.
    no_uvs: Option<wgpu::Buffer>,
}

impl CasterDepth {
    /// The maps' format: 32-bit float, reversed.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// Clear value of maps: the far plane.
    pub(crate) const CLEAR_DEPTH: f32 = 0.0;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self::multisampled(gpu, 1)
    }

    /// Creates the rasteriser of maps with `sample_count` samples per texel.
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

    /// Creates another program for the same casters.
    pub(crate) fn program(&self, gpu: &Gpu, descriptor: &CasterProgramDescriptor<'_>) -> CasterProgram {
        program(gpu, &self.view_layout, &self.cutout_layout, descriptor)
    }

    /// Uploads the views of the whole light that the frame's passes will render, and the casters' surfaces.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, clip_from_world: &[Mat4], casters: &[MeshCaster<'_>]) {
        let views: Vec<_> = clip_from_world.iter().copied().map(DrawnView::whole).collect();
        self.prepare_views(stage, &views, casters);
    }

    /// [`prepare`](Self::prepare) for any views.
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
        let (buffer, _) = self.views.as_ref().expect("created above if missing");
        stage.upload(buffer, 0, &bytes);

        self.cutouts = casters.iter().map(|caster| self.cutout_bind_group(stage, &caster.opacity)).collect();
        let sides = || views.iter().map(|view| ViewSides::of(&view.clip_from_world)).collect::<Vec<_>>();
        let asked = (views.len() <= MAX_VIEWS_ASKED).then(sides);
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

    /// Layout of group 0, which [`bind_view`](Self::bind_view) binds.
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
                    let no_uvs = || self.no_uvs.as_ref().expect("`prepare` creates it for such casters");
                    bound.vertices(pass, 2, caster.opacity.texture().map_or_else(no_uvs, |texture| texture.uvs));
                }
                bound.indices(pass, caster.indices);
                pass.draw_indexed(caster.index_range(), 0, caster.instance_range());
            }
        }
    }
}

/// Largest number of views for which casters are culled; more views together see most casters.
const MAX_VIEWS_ASKED: usize = 8;

/// Creates stand-in texture coordinates for translucent casters without a texture, since their shader reads some; as many as
/// the largest caster has vertices.
pub(crate) fn make_no_uvs(stage: &Stage<'_>, no_uvs: &mut Option<wgpu::Buffer>, casters: &[MeshCaster<'_>]) {
    let max_vertices = casters
        .iter()
        .filter(|caster| matches!(caster.opacity, Opacity::Translucent { texture: None, .. }))
        .map(|caster| caster.positions.size() / 12)
        .max()
        .unwrap_or(0);
    if max_vertices > 0 && no_uvs.as_ref().is_none_or(|buffer| buffer.size() < max_vertices * 8) {
        *no_uvs = Some(stage.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("antumbra no texture coordinates"),
            size: max_vertices * 8,
            usage: wgpu::BufferUsages::VERTEX,
            mapped_at_creation: false,
        }));
    }
}
