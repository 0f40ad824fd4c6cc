//! The shadow map view: the depth maps of a side's technique, their peeled layers and derived levels, in grey.

use antumbra::contract::{LevelTexels, MapLevel};
use antumbra::{DrawnMap, Gpu, programs};
use antumbra_render::screen_pipeline;
use glam::{UVec2, Vec2};
use wgpu::util::DeviceExt;

use super::present::{NOT_JUDGED_COLOR, OUTPUT_FORMAT};

/// Margin between and around maps, pixels.
const MARGIN_PX: f32 = 6.0;
/// Grey value of the farthest depth that a map can store, 0 to 1; the nearest depth is 1.
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
    packing: u32,
    size_texels: [u32; 2],
    origin_texels: [u32; 2],
    padding: [u32; 2],
    depth_warp: [f32; 4],
    empty_color: [f32; 4],
}

/// Bindings of a filtered level's minimum and maximum: while they are computed, and when they are read.
const SOUGHT_ENDS: u32 = 5;
const KNOWN_ENDS: u32 = 6;

/// Threads along each side of a workgroup.
const TILE: u32 = 8;

/// Numbers of choices in a view of maps or lists; a choice is offered if there are at least two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapChoices {
    /// Number of levels, including the map itself.
    pub levels: usize,
    /// Number of peeled layers, including the map itself.
    pub layers: usize,
    /// Number of light samples with maps.
    pub points: usize,
}

impl MapChoices {
    /// Returns the choices of a light's maps.
    pub fn of(maps: &[DrawnMap]) -> Self {
        let most = |count: fn(&DrawnMap) -> usize| maps.iter().map(|map| count(map) + 1).max().unwrap_or(0);
        Self {
            levels: most(|map| map.levels.len()),
            layers: most(|map| map.layers_behind.len()),
            points: points_of(maps).len(),
        }
    }

    /// Returns the larger of both numbers, choice by choice.
    pub fn or_more(self, other: Self) -> Self {
        Self {
            levels: self.levels.max(other.levels),
            layers: self.layers.max(other.layers),
            points: self.points.max(other.points),
        }
    }
}

/// Indices of the light samples that have maps of their own.
fn points_of(maps: &[DrawnMap]) -> Vec<u32> {
    let mut points: Vec<u32> = maps.iter().filter_map(|map| map.light_point).collect();
    points.dedup();
    points
}

/// Returns the maps of one light sample, or of the last one if there are fewer; all maps if they do not belong to samples.
pub fn of_point(mut maps: Vec<DrawnMap>, wanted: usize) -> Vec<DrawnMap> {
    let points = points_of(&maps);
    if let Some(last) = points.len().checked_sub(1) {
        maps.retain(|map| map.light_point == Some(points[wanted.min(last)]));
    }
    maps
}

/// A level or layer of a map to show.
#[derive(Clone, Debug)]
pub struct ShownMap {
    /// The map.
    pub map: DrawnMap,
    /// View of the level's or layer's texture.
    pub view: wgpu::TextureView,
    /// Origin of the level in the texture, texels.
    pub origin_px: UVec2,
    /// Size of the level in the texture, texels.
    pub size_px: UVec2,
    /// Content of the level's texels; `None` for depths.
    texels: Option<LevelTexels>,
    /// Index of the level; 0 is the map itself.
    level: usize,
    layer: usize,
}

impl ShownMap {
    /// Selects a peeled layer, or a level of the first layer; the last one if there are fewer.
    pub fn of(map: DrawnMap, level: usize, layer: usize) -> Self {
        let layer = layer.min(map.layers_behind.len());
        let level = if layer > 0 { 0 } else { level.min(map.levels.len()) };
        let behind = layer.checked_sub(1).map(|i| map.layers_behind[i].clone());
        let (view, origin_px, size_px, texels) = match level.checked_sub(1).map(|i| map.levels[i].clone()) {
            Some(MapLevel { view, origin_px, size_px, texels }) => (view, origin_px, size_px, Some(texels)),
            None => (behind.unwrap_or_else(|| map.depth.clone()), UVec2::ZERO, map.size_px, None),
        };
        Self { map, view, origin_px, size_px, texels, level, layer }
    }

    /// Whether this is a level derived from the map.
    pub fn is_level(&self) -> bool {
        self.texels.is_some()
    }

    /// Whether the texels hold filtered channels instead of depths.
    pub fn is_filtered(&self) -> bool {
        self.texels.is_some_and(|texels| texels != LevelTexels::Extremes)
    }

    /// Describes the selection, as text that follows the size.
    pub fn which(&self, choices: MapChoices) -> String {
        let MapChoices { levels, layers, .. } = choices;
        if self.layer > 0 {
            return format!(", layer {} of {layers}", self.layer + 1);
        }
        let point = self.map.light_point.map(|point| format!(" of light sample {}", point + 1));
        let is_one_of = if levels > 1 { format!(", level {} of {levels}", self.level + 1) } else { String::new() };
        let made = match self.texels {
            None => "",
            Some(LevelTexels::Extremes) => ", minimum depths of squares of the map",
            Some(_) => ", filtered",
        };
        let layer = if layers > 1 { format!(", layer 1 of {layers}") } else { String::new() };
        format!("{}{is_one_of}{made}{layer}", point.unwrap_or_default())
    }
}

/// A pipeline for one kind of texture.
#[derive(Debug)]
struct Program {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    /// Binding of the texture.
    binding: u32,
}

/// Pipeline that computes a level's minimum and maximum.
#[derive(Debug)]
struct Seek {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// The pass that draws maps.
#[derive(Debug)]
pub struct LightMapPass {
    single: Program,
    multisampled: Program,
    extremes: Program,
    filtered: Program,
    seek: Seek,
}

/// A map with its place in the image.
#[derive(Debug)]
struct Placed<'a> {
    program: &'a Program,
    group: wgpu::BindGroup,
    /// Bind group for the minimum and maximum of a filtered level, with the level's size.
    seek: Option<(wgpu::BindGroup, UVec2)>,
    corner_px: UVec2,
    side_px: u32,
}

impl LightMapPass {
    /// Creates the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let module = programs::create_shader_module(device, "light map", include_str!("light_map.wgsl").into());
        let depth = |multisampled| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled,
        };
        let texels = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let floats = texels(wgpu::TextureSampleType::Float { filterable: false });
        let words = texels(wgpu::TextureSampleType::Uint);
        let program = |fragment, binding, ty| Program::new(device, &module, fragment, binding, ty);
        Self {
            single: program("fragment_single", 1, depth(false)),
            multisampled: program("fragment_multisampled", 2, depth(true)),
            extremes: program("fragment_extremes", 3, floats),
            filtered: program("fragment_filtered", 4, words),
            seek: Seek::new(device, &module, words),
        }
    }

    /// Records the maps of both sides over `output`, the left side's left of the divider. A side without maps stays empty.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sides: [&[ShownMap]; 2],
        divider_px: u32,
        output: &wgpu::TextureView,
        size_px: UVec2,
    ) {
        let empty = NOT_JUDGED_COLOR.map(|v| f64::from(v) / 255.0);
        let clear = wgpu::Color { r: 0.5 * empty[0], g: 0.5 * empty[1], b: 0.5 * empty[2], a: 1.0 };
        let divider_px = divider_px.min(size_px.x);
        let rooms = [(0, divider_px), (divider_px, size_px.x - divider_px)];
        let mut placed = Vec::new();
        for (maps, (left_px, width_px)) in sides.into_iter().zip(rooms) {
            let room = Vec2::new(width_px as f32, size_px.y as f32);
            let (corners, side_px) = places(maps.len(), room);
            if side_px >= 1.0 {
                let corners = corners.into_iter().map(|corner| corner + Vec2::X * left_px as f32);
                placed.extend(maps.iter().zip(corners).map(|(map, corner)| self.place(gpu, map, corner, side_px)));
            }
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.seek.pipeline);
        for (group, size) in placed.iter().filter_map(|map| map.seek.as_ref()) {
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(size.x.div_ceil(TILE), size.y.div_ceil(TILE), 1);
        }
        drop(pass);
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
        for Placed { program, group, corner_px, side_px, .. } in &placed {
            pass.set_pipeline(&program.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.set_scissor_rect(corner_px.x, corner_px.y, *side_px, *side_px);
            pass.draw(0..3, 0..1);
        }
    }

    fn place(&self, gpu: &Gpu, shown: &ShownMap, corner: Vec2, side_px: f32) -> Placed<'_> {
        let program = match shown.texels {
            Some(LevelTexels::Extremes) => &self.extremes,
            Some(_) => &self.filtered,
            None if shown.layer == 0 && shown.map.sample_count > 1 => &self.multisampled,
            None => &self.single,
        };
        let uniform = uniform_of(gpu, shown, corner, side_px);
        let group = |layout, binding, ends: Option<(u32, &wgpu::Buffer)>| {
            let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
            let mut entries = vec![
                entry(0, uniform.as_entire_binding()),
                entry(binding, wgpu::BindingResource::TextureView(&shown.view)),
            ];
            entries.extend(ends.map(|(binding, ends)| entry(binding, ends.as_entire_binding())));
            let label = Some("light map");
            gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
        };
        let ends = shown.is_filtered().then(|| {
            gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("light map's ends"),
                // The initial minimum and maximum; unsigned words that sort as the floats do.
                contents: bytemuck::bytes_of(&[u32::MAX, 0]),
                usage: wgpu::BufferUsages::STORAGE,
            })
        });
        let known = ends.as_ref().map(|ends| (KNOWN_ENDS, ends));
        let sought = ends.as_ref().map(|ends| (SOUGHT_ENDS, ends));
        Placed {
            group: group(&program.layout, program.binding, known),
            seek: sought.map(|ends| (group(&self.seek.layout, program.binding, Some(ends)), shown.size_px)),
            program,
            corner_px: corner.as_uvec2(),
            side_px: side_px as u32,
        }
    }
}

/// Corners and side of `count` equal squares in a rectangle, as large as possible, in whole pixels.
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

fn layout_entry(visibility: wgpu::ShaderStages, binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer_type(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

impl Program {
    fn new(
        device: &wgpu::Device,
        module: &wgpu::ShaderModule,
        fragment: &str,
        binding: u32,
        texture: wgpu::BindingType,
    ) -> Self {
        let entry = |binding, ty| layout_entry(wgpu::ShaderStages::FRAGMENT, binding, ty);
        let mut entries = vec![entry(0, buffer_type(wgpu::BufferBindingType::Uniform)), entry(binding, texture)];
        if fragment == "fragment_filtered" {
            entries.push(entry(KNOWN_ENDS, buffer_type(wgpu::BufferBindingType::Storage { read_only: true })));
        }
        let layout = programs::create_bind_group_layout(
            device,
            &wgpu::BindGroupLayoutDescriptor { label: Some("light map"), entries: &entries },
        );
        let pipeline = screen_pipeline(device, module, fragment, &[Some(&layout)], OUTPUT_FORMAT.into());
        Self { layout, pipeline, binding }
    }
}

impl Seek {
    fn new(device: &wgpu::Device, module: &wgpu::ShaderModule, words: wgpu::BindingType) -> Self {
        let entry = |binding, ty| layout_entry(wgpu::ShaderStages::COMPUTE, binding, ty);
        let layout = programs::create_bind_group_layout(
            device,
            &wgpu::BindGroupLayoutDescriptor {
                label: Some("light map's ends"),
                entries: &[
                    entry(0, buffer_type(wgpu::BufferBindingType::Uniform)),
                    entry(4, words),
                    entry(SOUGHT_ENDS, buffer_type(wgpu::BufferBindingType::Storage { read_only: false })),
                ],
            },
        );
        let pipeline_layout = programs::create_pipeline_layout(
            device,
            &wgpu::PipelineLayoutDescriptor {
                label: Some("light map's ends"),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            },
        );
        let pipeline = programs::create_compute_pipeline(
            device,
            &wgpu::ComputePipelineDescriptor {
                label: Some("light map's ends"),
                layout: Some(&pipeline_layout),
                module,
                entry_point: Some("seek_ends"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            },
        );
        Self { layout, pipeline }
    }
}

/// Returns the shader's code for the format of a texel's first channel.
fn packing_of(texels: Option<LevelTexels>) -> u32 {
    match texels {
        None | Some(LevelTexels::Extremes | LevelTexels::Float32) => 0,
        Some(LevelTexels::Float16) => 1,
        Some(LevelTexels::Unorm16) => 2,
        Some(LevelTexels::Unorm8) => 3,
    }
}

fn uniform_of(gpu: &Gpu, shown: &ShownMap, corner: Vec2, side_px: f32) -> wgpu::Buffer {
    let empty = NOT_JUDGED_COLOR.map(|v| f32::from(v) / 255.0);
    let map = &shown.map;
    // Derived levels do not contain the map's depth warp.
    let [constant, by_u, by_v] = if shown.is_level() { [1.0, 0.0, 0.0] } else { map.depth_warp };
    let uniform = LightMapUniform {
        corner_px: corner.to_array(),
        side_px,
        is_perspective: map.is_perspective.into(),
        depth_scale: map.depth_scale,
        depth_offset: map.depth_offset,
        empty_depth: map.empty_depth,
        nearest_m: map.range_m[0],
        farthest_m: map.range_m[1],
        packing: packing_of(shown.texels),
        size_texels: shown.size_px.to_array(),
        origin_texels: shown.origin_px.to_array(),
        padding: [0; 2],
        depth_warp: [constant, by_u, by_v, 0.0],
        empty_color: [empty[0], empty[1], empty[2], 1.0],
    };
    gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("light map"),
        contents: bytemuck::bytes_of(&uniform),
        usage: wgpu::BufferUsages::UNIFORM,
    })
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
        // A rectangle that is too narrow holds no squares.
        assert_eq!(places(1, Vec2::new(3.0, 200.0)).1, 0.0);
        assert_eq!(places(0, Vec2::ONE).0, []);
    }

    #[test]
    fn the_shader_has_the_darkest_grey_that_tests_know() {
        assert!(include_str!("light_map.wgsl").contains(&format!("const DARKEST = {DARKEST};")));
    }
}
