//! The list view: lengths of the lists that a side's technique keeps per texel of the light's map, as colours.

use antumbra::contract::{ListLengths, ListLevel, ListOrder};
use antumbra::{DrawnLists, Gpu, programs};
use antumbra_render::screen_pipeline;
use glam::{UVec2, Vec2};
use wgpu::util::DeviceExt;

use super::light_map::places;
use super::present::{NOT_JUDGED_COLOR, OUTPUT_FORMAT};

/// Threads along each side of a workgroup.
const TILE: u32 = 8;

/// Bindings of the totals: while they are computed, and when they are read.
const COUNT_TOTALS: u32 = 2;
const DRAW_TOTALS: u32 = 3;

/// Size of the shader's `Totals`, bytes.
const TOTALS_BYTES: u64 = 8;

/// Uniform `Lists` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct ListsUniform {
    corner_px: [f32; 2],
    extent_px: [f32; 2],
    size_texels: [u32; 2],
    first: u32,
    is_counted: u32,
    order: u32,
    told_by: u32,
    padding: [u32; 2],
    empty_color: [f32; 4],
}

/// The passes that count and draw lists.
#[derive(Debug)]
pub struct ListsPass {
    count_layout: wgpu::BindGroupLayout,
    count: wgpu::ComputePipeline,
    draw_layout: wgpu::BindGroupLayout,
    draw: wgpu::RenderPipeline,
}

/// A map of lists with its place in the image.
#[derive(Debug)]
struct Placed {
    count: wgpu::BindGroup,
    draw: wgpu::BindGroup,
    corner_px: UVec2,
    extent_px: UVec2,
    size_texels: UVec2,
}

/// Selects a level of `lists` by its index from the finest; the coarsest level if there are fewer.
pub fn level_of(lists: &DrawnLists, wanted: usize) -> Option<(usize, ListLevel)> {
    let index = wanted.min(lists.levels.len().checked_sub(1)?);
    Some((index, lists.levels[index]))
}

impl ListsPass {
    /// Creates the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let module = programs::create_shader_module(device, "lists", include_str!("lists.wgsl").into());
        let layout = |visibility, totals_binding, is_counting: bool| {
            let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
                binding,
                visibility,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            };
            let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
            programs::create_bind_group_layout(
                device,
                &wgpu::BindGroupLayoutDescriptor {
                    label: Some("lists"),
                    entries: &[
                        entry(0, wgpu::BufferBindingType::Uniform),
                        entry(1, storage(true)),
                        entry(totals_binding, storage(!is_counting)),
                    ],
                },
            )
        };
        let count_layout = layout(wgpu::ShaderStages::COMPUTE, COUNT_TOTALS, true);
        let draw_layout = layout(wgpu::ShaderStages::FRAGMENT, DRAW_TOTALS, false);
        let pipeline_layout = programs::create_pipeline_layout(
            device,
            &wgpu::PipelineLayoutDescriptor {
                label: Some("lists"),
                bind_group_layouts: &[Some(&count_layout)],
                immediate_size: 0,
            },
        );
        let count = programs::create_compute_pipeline(
            device,
            &wgpu::ComputePipelineDescriptor {
                label: Some("lists"),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some("count"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            },
        );
        let draw = screen_pipeline(device, &module, "fragment_lists", &[Some(&draw_layout)], OUTPUT_FORMAT.into());
        Self { count_layout, count, draw_layout, draw }
    }

    /// Records level `level` of both sides' lists over `output`, the left side's left of the divider. Colours range up to
    /// the side's longest list. A side without lists stays empty. Returns a buffer of totals per side, valid once the
    /// commands have run: the length of the longest list and the sum of all lengths.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sides: [&[DrawnLists]; 2],
        level: usize,
        divider_px: u32,
        output: &wgpu::TextureView,
        size_px: UVec2,
    ) -> [Option<wgpu::Buffer>; 2] {
        let divider_px = divider_px.min(size_px.x);
        let rooms = [(0, divider_px), (divider_px, size_px.x - divider_px)];
        let placed = [0, 1].map(|side| {
            let (left_px, width_px) = rooms[side];
            self.place(gpu, sides[side], level, left_px, UVec2::new(width_px, size_px.y))
        });
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.count);
        for map in placed.iter().flat_map(|(_, maps)| maps) {
            let groups = map.size_texels.map(|texels| texels.div_ceil(TILE));
            pass.set_bind_group(0, &map.count, &[]);
            pass.dispatch_workgroups(groups.x, groups.y, 1);
        }
        drop(pass);
        let empty = NOT_JUDGED_COLOR.map(|v| f64::from(v) / 255.0);
        let clear = wgpu::Color { r: 0.5 * empty[0], g: 0.5 * empty[1], b: 0.5 * empty[2], a: 1.0 };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lists"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: output,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.draw);
        for map in placed.iter().flat_map(|(_, maps)| maps).filter(|map| map.extent_px.cmpge(UVec2::ONE).all()) {
            pass.set_bind_group(0, &map.draw, &[]);
            pass.set_scissor_rect(map.corner_px.x, map.corner_px.y, map.extent_px.x, map.extent_px.y);
            pass.draw(0..3, 0..1);
        }
        placed.map(|(totals, maps)| (!maps.is_empty()).then_some(totals))
    }

    /// Places a side's maps in its half of the image; also returns the buffer of their totals.
    fn place(
        &self,
        gpu: &Gpu,
        lists: &[DrawnLists],
        level: usize,
        left_px: u32,
        room_px: UVec2,
    ) -> (wgpu::Buffer, Vec<Placed>) {
        let totals = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("list totals"),
            size: TOTALS_BYTES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let (corners, side_px) = places(lists.len(), room_px.as_vec2());
        let place = |(lists, corner): (&DrawnLists, Vec2)| {
            let (_, level) = level_of(lists, level)?;
            // The image keeps the map's aspect ratio.
            let size = level.size_texels.as_vec2();
            let extent = (side_px * size / size.max_element()).floor();
            let corner = (corner + 0.5 * (side_px - extent)).floor() + Vec2::X * left_px as f32;
            let uniform = uniform_of(gpu, lists, level, corner, extent);
            let group = |layout, totals_binding| {
                let buffers = [(0, &uniform), (1, &lists.words), (totals_binding, &totals)];
                let entries = buffers
                    .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
                gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("lists"),
                    layout,
                    entries: &entries,
                })
            };
            Some(Placed {
                count: group(&self.count_layout, COUNT_TOTALS),
                draw: group(&self.draw_layout, DRAW_TOTALS),
                corner_px: corner.as_uvec2(),
                extent_px: extent.as_uvec2(),
                size_texels: level.size_texels,
            })
        };
        let maps = lists.iter().zip(corners).filter_map(place).collect();
        (totals, maps)
    }
}

fn uniform_of(gpu: &Gpu, lists: &DrawnLists, level: ListLevel, corner: Vec2, extent: Vec2) -> wgpu::Buffer {
    let empty = NOT_JUDGED_COLOR.map(|v| f32::from(v) / 255.0);
    let (order, told_by) = match lists.order {
        ListOrder::Rows => (0, 0),
        ListOrder::Halvings => (1, 0),
        ListOrder::Chosen { word } => (2, word),
    };
    let uniform = ListsUniform {
        corner_px: corner.to_array(),
        extent_px: extent.to_array(),
        size_texels: level.size_texels.to_array(),
        first: level.first,
        is_counted: (lists.lengths == ListLengths::Counted).into(),
        order,
        told_by,
        padding: [0; 2],
        empty_color: [empty[0], empty[1], empty[2], 1.0],
    };
    gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("lists"),
        contents: bytemuck::bytes_of(&uniform),
        usage: wgpu::BufferUsages::UNIFORM,
    })
}
