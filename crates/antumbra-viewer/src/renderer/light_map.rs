//! The view of the light: the depth maps that a side's technique has drawn of it, as grey levels.

use antumbra::{DrawnMap, Gpu};
use antumbra_render::screen_pipeline;
use glam::{UVec2, Vec2};
use wgpu::util::DeviceExt;

use super::present::{NOT_JUDGED_COLOR, OUTPUT_FORMAT};

/// Between maps, and around them, pixels.
const MARGIN_PX: f32 = 6.0;
/// The grey of the farthest place that a map has room for, of 1; the nearest's is 1.
#[cfg(test)]
pub const DARKEST: f32 = 0.08;

/// Uniform `LightMap` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct LightMapUniform {
    corner_px: [f32; 2],
    side_px: f32,
    is_perspective: u32,
    depth_scale: f32,
    depth_offset: f32,
    empty_depth: f32,
    nearest_m: f32,
    farthest_m: f32,
    size_texels: u32,
    padding: [u32; 2],
    empty_color: [f32; 4],
}

/// A pipeline for maps of one sample a texel, or of several.
#[derive(Debug)]
struct Program {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    /// Of the map.
    binding: u32,
}

/// The pass.
#[derive(Debug)]
pub struct LightMapPass {
    single: Program,
    multisampled: Program,
}

impl LightMapPass {
    /// Makes the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("light map"),
            source: wgpu::ShaderSource::Wgsl(include_str!("light_map.wgsl").into()),
        });
        Self { single: Program::new(device, &module, false), multisampled: Program::new(device, &module, true) }
    }

    /// Records the maps of both sides over `output`, the left ones left of the divider. A side without maps stays empty.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sides: [&[DrawnMap]; 2],
        divider_px: u32,
        output: &wgpu::TextureView,
        size_px: UVec2,
    ) {
        let empty = NOT_JUDGED_COLOR.map(|v| f64::from(v) / 255.0);
        let clear = wgpu::Color { r: 0.5 * empty[0], g: 0.5 * empty[1], b: 0.5 * empty[2], a: 1.0 };
        let divider_px = divider_px.min(size_px.x);
        let rooms = [(0, divider_px), (divider_px, size_px.x - divider_px)];
        let mut draws = Vec::new();
        for (maps, (left_px, width_px)) in sides.into_iter().zip(rooms) {
            let room = Vec2::new(width_px as f32, size_px.y as f32);
            let (corners, side_px) = places(maps.len(), room);
            for (map, corner) in maps.iter().zip(corners) {
                let corner = corner + Vec2::X * left_px as f32;
                let program = if map.sample_count > 1 { &self.multisampled } else { &self.single };
                draws.push((program, program.group(gpu, map, corner, side_px), corner, side_px));
            }
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("light map"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: output,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        for (program, group, corner, side_px) in draws.iter().filter(|(_, _, _, side_px)| *side_px >= 1.0) {
            let (corner, side) = (corner.as_uvec2(), *side_px as u32);
            pass.set_pipeline(&program.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.set_scissor_rect(corner.x, corner.y, side, side);
            pass.draw(0..3, 0..1);
        }
    }
}

/// The corners of so many squares in a room, and their side, all as large as they can be and whole pixels.
pub(super) fn places(count: usize, room: Vec2) -> (Vec<Vec2>, f32) {
    let side = |columns: usize| {
        let rows = count.div_ceil(columns);
        let cell = room / Vec2::new(columns as f32, rows as f32);
        (cell.min_element() - 2.0 * MARGIN_PX).floor().max(0.0)
    };
    let columns = (1..=count.max(1)).max_by(|a, b| side(*a).total_cmp(&side(*b))).unwrap_or(1);
    let rows = count.div_ceil(columns).max(1);
    let cell = room / Vec2::new(columns as f32, rows as f32);
    let corner = |i: usize| {
        let middle = (Vec2::new((i % columns) as f32, (i / columns) as f32) + 0.5) * cell;
        (middle - 0.5 * side(columns)).floor()
    };
    ((0..count).map(corner).collect(), side(columns))
}

impl Program {
    fn new(device: &wgpu::Device, module: &wgpu::ShaderModule, multisampled: bool) -> Self {
        let binding = if multisampled { 2 } else { 1 };
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let depth = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("light map"),
            entries: &[entry(0, uniform), entry(binding, depth)],
        });
        let fragment = if multisampled { "fragment_multisampled" } else { "fragment_single" };
        let pipeline = screen_pipeline(device, module, fragment, &[Some(&layout)], OUTPUT_FORMAT.into());
        Self { layout, pipeline, binding }
    }

    fn group(&self, gpu: &Gpu, map: &DrawnMap, corner: Vec2, side_px: f32) -> wgpu::BindGroup {
        let empty = NOT_JUDGED_COLOR.map(|v| f32::from(v) / 255.0);
        let uniform = LightMapUniform {
            corner_px: corner.to_array(),
            side_px,
            is_perspective: map.is_perspective.into(),
            depth_scale: map.depth_scale,
            depth_offset: map.depth_offset,
            empty_depth: map.empty_depth,
            nearest_m: map.range_m[0],
            farthest_m: map.range_m[1],
            size_texels: map.size_px.x,
            padding: [0; 2],
            empty_color: [empty[0], empty[1], empty[2], 1.0],
        };
        let uniform = gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("light map"),
            contents: bytemuck::bytes_of(&uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("light map"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: self.binding,
                    resource: wgpu::BindingResource::TextureView(&map.depth),
                },
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_fit_their_room_apart_from_one_another() {
        for (count, room) in [(1, Vec2::new(300.0, 200.0)), (6, Vec2::new(300.0, 200.0)), (5, Vec2::new(90.0, 400.0))] {
            let (corners, side) = places(count, room);
            assert!(corners.len() == count && side >= 30.0, "{count}: {side}");
            for (i, corner) in corners.iter().enumerate() {
                assert!(corner.cmpge(Vec2::ZERO).all() && (*corner + side).cmple(room).all(), "{corner} of {count}");
                assert!(corners[..i].iter().all(|other| (*corner - *other).abs().max_element() > side));
            }
        }
        // A room without space takes none.
        assert_eq!(places(1, Vec2::new(3.0, 200.0)).1, 0.0);
        assert_eq!(places(0, Vec2::ONE).0, []);
    }

    #[test]
    fn the_shader_has_the_darkest_grey_that_tests_know() {
        assert!(include_str!("light_map.wgsl").contains(&format!("const DARKEST = {DARKEST};")));
    }
}
