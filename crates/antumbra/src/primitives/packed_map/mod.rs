//! Maps with several channels per texel, packed into 32-bit words: a texture array of `R32Uint`, with one layer per word. They
//! are blurred by a separable kernel and have a mip chain, whose further levels are in a second texture (`mips`). Filtering is
//! linear in the channels, for any content.
//!
//! A shader that needs some channels reads only the words that contain them.

use std::sync::Arc;

use glam::{IVec2, UVec2};

use crate::contract::{LevelTexels, MapLevel};
use crate::gpu::{
    Bindings, Cached, Gpu, Recorder, Scratch, Span, Stage, array_view, bindings, compute_pipeline_without_zeroing,
    create_uniform, gpu_structs, slice_views, texels, texture_bytes, upload_storage, write_uniform,
};
use crate::shaders;

#[cfg(test)]
pub(crate) mod cpu;
mod kernel;
mod mips;
#[cfg(test)]
mod tests;

pub(crate) use kernel::Kernel;
use mips::{MipPipelines, Mips, full_level_count, level_origin, level_size};

/// Storage format of channels. The numbers are those of `primitives/packing.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    /// One 32-bit float per word.
    Float32 = 0,
    /// Two 16-bit floats per word.
    Float16 = 1,
    /// Two 16-bit fractions of [0, 1] per word.
    Unorm16 = 2,
    /// Four 8-bit fractions of [0, 1] per word.
    Unorm8 = 3,
}

impl Packing {
    /// Overridable constants of every pipeline that packs or unpacks words.
    fn constants(self) -> [(&'static str, f64); 1] {
        [("PACKING", f64::from(self as u32))]
    }

    /// Number of channels per word.
    pub(crate) fn channels(self) -> u32 {
        match self {
            Self::Float32 => 1,
            Self::Float16 | Self::Unorm16 => 2,
            Self::Unorm8 => 4,
        }
    }

    /// Word whose channels are all 1.
    pub(crate) fn word_of_ones(self) -> u32 {
        match self {
            Self::Float32 => 1.0f32.to_bits(),
            Self::Float16 => 0x3c00_3c00,
            Self::Unorm16 | Self::Unorm8 => u32::MAX,
        }
    }

    /// Largest error of a value in [0, 1] after storage and filtering. For 32-bit floats it comes from the filters' sums, not
    /// from storage: sixteen units in the last place.
    pub(crate) fn step(self) -> f32 {
        match self {
            Self::Float32 => 1.0 / (1 << 20) as f32,
            Self::Float16 => 1.0 / (1 << 11) as f32,
            Self::Unorm16 => 1.0 / 65535.0,
            Self::Unorm8 => 1.0 / 255.0,
        }
    }
}

gpu_structs! {
    /// Parameters of one direction of a blur.
    pub(crate) struct BlurUniform {
        direction: IVec2,
        radius: i32,
        padding: u32,
    }

    /// Source level, and number of levels that one dispatch computes.
    pub(crate) struct MipsUniform {
        map_size: UVec2,
        before: u32,
        count: u32,
    }
}

bindings! {
    struct Blur = "packed blur", COMPUTE, group 0 of [PACKED_MAP_BLUR] {
        0 blur: Uniform,
        1 weights: Storage,
        2 source: TextureArray(texels::UINT),
        3 target_layers: WrittenArray(PackedMap::FORMAT),
    }
}

/// Allocation key of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    size: UVec2,
    words: u32,
    level_count: u32,
    blurred: bool,
    /// Whether render passes write the map.
    drawn: bool,
}

#[derive(Debug)]
struct Maps {
    shape: Shape,
    /// First level of every word.
    texture: wgpu::Texture,
    first: wgpu::TextureView,
    /// Bind groups of the blur: rows, then columns; empty without a blur.
    blurs: Vec<wgpu::BindGroup>,
    /// Texture between the two directions of the blur, shared by all maps of the size; held while it is bound.
    _rows: Option<Arc<wgpu::Texture>>,
    /// Further levels; `None` if the map has only one.
    mips: Option<Mips>,
    /// Views of the first level, one per word; empty unless render passes write the map.
    drawn: Vec<wgpu::TextureView>,
}

#[derive(Clone, Debug)]
struct Pipelines {
    blur: wgpu::ComputePipeline,
    mips: MipPipelines,
}

/// Packed map, with its blur and its mips.
#[derive(Debug)]
pub(crate) struct PackedMap {
    blur_layout: wgpu::BindGroupLayout,
    mips_layout: wgpu::BindGroupLayout,
    /// Pipelines of the last prepared packing.
    pipelines: Cached<Packing, Pipelines>,
    rows: wgpu::Buffer,
    columns: wgpu::Buffer,
    weights: Option<wgpu::Buffer>,
    is_drawn: bool,
    maps: Option<Arc<Maps>>,
}

/// Packed map of one frame, with its blur and its mips.
#[derive(Debug)]
pub(crate) struct PreparedPackedMap {
    maps: Arc<Maps>,
    weights: wgpu::Buffer,
    pipelines: Pipelines,
}

impl Pipelines {
    fn new(gpu: &Gpu, blur: &wgpu::BindGroupLayout, mips: &wgpu::BindGroupLayout, packing: Packing) -> Self {
        let constants = packing.constants();
        Self {
            blur: compute_pipeline_without_zeroing(gpu, "packed blur", shaders::PACKED_MAP_BLUR, &constants, &[blur]),
            mips: MipPipelines::new(gpu, mips, packing),
        }
    }
}

/// Side of the texels that a workgroup of the blur computes, texels.
const BLUR_TILE: u32 = 16;

impl PackedMap {
    /// Format of the texture.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipelines: Cached::default(),
            blur_layout: Blur::layout(gpu),
            mips_layout: MipPipelines::layout(gpu),
            rows: create_uniform::<BlurUniform>(gpu, "antumbra blur rows"),
            columns: create_uniform::<BlurUniform>(gpu, "antumbra blur columns"),
            weights: None,
            is_drawn: false,
            maps: None,
        }
    }

    /// Sets whether render passes write the next prepared map.
    pub(crate) fn set_drawn(&mut self, is_drawn: bool) {
        self.is_drawn = is_drawn;
    }

    /// Allocates a map with `words` words per texel, and prepares its passes.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        size: UVec2,
        words: u32,
        packing: Packing,
        kernel: &Kernel,
        with_mips: bool,
    ) -> PreparedPackedMap {
        let level_count = if with_mips { full_level_count(size) } else { 1 };
        let shape = Shape { size, words, level_count, blurred: kernel.radius() > 0, drawn: self.is_drawn };
        for (buffer, direction) in [(&self.rows, IVec2::X), (&self.columns, IVec2::Y)] {
            let uniform = BlurUniform { direction, radius: kernel.radius() as i32, padding: 0 };
            write_uniform(stage, buffer, &uniform);
        }
        let (blur, mips) = (&self.blur_layout, &self.mips_layout);
        let pipelines = self.pipelines.get_or_make(packing, || Pipelines::new(stage, blur, mips, packing)).clone();
        let weights = kernel.with_running_sums();
        let bytes = size_of_val(weights.as_slice()) as u64;
        let weights_stay = self.weights.as_ref().is_some_and(|buffer| buffer.size() == bytes);
        let weights = upload_storage(stage, &mut self.weights, "antumbra blur weights", &weights).clone();
        let made = self.maps.take().filter(|maps| weights_stay && maps.shape == shape);
        let maps = made.unwrap_or_else(|| Arc::new(self.allocate(stage, shape, &weights)));
        if let Some(mips) = &maps.mips {
            mips.upload(stage);
        }
        self.maps = Some(Arc::clone(&maps));
        PreparedPackedMap { maps, weights, pipelines }
    }

    fn allocate(&self, gpu: &Gpu, shape: Shape, weights: &wgpu::Buffer) -> Maps {
        let texture =
            gpu.device.create_texture(&descriptor("antumbra packed map", shape.size, shape.words, shape.drawn));
        let first = array_view(gpu, &texture);
        let rows = shape.blurred.then(|| {
            let descriptor = descriptor("antumbra blurred rows", shape.size, shape.words, false);
            gpu.device.scratch_texture(Scratch::BlurredRows, &descriptor)
        });
        let blurs = rows.iter().flat_map(|rows| {
            let rows = array_view(gpu, rows);
            let blur = |uniform, source, target_layers| {
                Blur { blur: uniform, weights, source, target_layers }.cached_group(gpu, &self.blur_layout)
            };
            [blur(&self.rows, &first, &rows), blur(&self.columns, &rows, &first)]
        });
        Maps {
            shape,
            blurs: blurs.collect(),
            mips: (shape.level_count > 1)
                .then(|| Mips::new(gpu, &self.mips_layout, &first, shape.size, shape.words, shape.level_count)),
            _rows: rows,
            drawn: if shape.drawn { slice_views(gpu, &texture) } else { Vec::new() },
            first,
            texture,
        }
    }

    /// Views of the first word of each level, for display.
    pub(crate) fn drawn(&self) -> Vec<MapLevel> {
        let (Some(maps), Some((packing, _))) = (&self.maps, self.pipelines.pair()) else { return Vec::new() };
        let first_word = |texture: &wgpu::Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let level = |level: u32| MapLevel {
            view: first_word(maps.mips.as_ref().filter(|_| level > 0).map_or(&maps.texture, Mips::texture)),
            origin_px: level_origin(maps.shape.size, level),
            size_px: level_size(maps.shape.size, level),
            texels: match packing {
                Packing::Float32 => LevelTexels::Float32,
                Packing::Float16 => LevelTexels::Float16,
                Packing::Unorm16 => LevelTexels::Unorm16,
                Packing::Unorm8 => LevelTexels::Unorm8,
            },
        };
        (0..maps.shape.level_count).map(level).collect()
    }

    /// Memory of the map with its levels, bytes; the texture between the blur's directions is shared by all maps.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.maps.as_ref().map_or(0, |maps| {
            texture_bytes(&maps.texture) + maps.mips.as_ref().map_or(0, |mips| texture_bytes(mips.texture()))
        })
    }

    /// Texture of the first level, for tests.
    #[cfg(test)]
    pub(crate) fn texture(&self) -> &wgpu::Texture {
        &self.maps.as_ref().expect("a map was prepared").texture
    }
}

impl PreparedPackedMap {
    /// Views of the first level, one per word, for drawing; empty unless render passes write the map.
    pub(crate) fn layer_views(&self) -> &[wgpu::TextureView] {
        &self.maps.drawn
    }

    /// View of the first level of every word.
    pub(crate) fn first(&self) -> &wgpu::TextureView {
        &self.maps.first
    }

    /// View of the further levels of every word, side by side (`levels.wesl`); a placeholder if there is only one level.
    pub(crate) fn mips(&self) -> &wgpu::TextureView {
        self.maps.mips.as_ref().map_or(&self.maps.first, Mips::view)
    }

    /// Number of levels.
    pub(crate) fn level_count(&self) -> u32 {
        self.maps.shape.level_count
    }

    /// Weights of the kernel, and their running sums.
    pub(crate) fn weights(&self) -> &wgpu::Buffer {
        &self.weights
    }

    /// Blurs the first level if the kernel is wider than a texel, and computes further levels, if any.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let Self { maps, pipelines, .. } = self;
        let Shape { size, words, .. } = maps.shape;
        // Each dispatch, also for mips, has its own pass: within one pass, wgpu 30 lost the layouts of a texture array's
        // levels, according to the validation layers. Whether it loses those of layers, which these textures have, is unknown.
        for (i, group) in maps.blurs.iter().enumerate() {
            recorder.compute_apart("blur", Span::of(i, maps.blurs.len()), |pass| {
                pass.set_pipeline(&pipelines.blur);
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(size.x.div_ceil(BLUR_TILE), size.y.div_ceil(BLUR_TILE), words);
            });
        }
        if let Some(mips) = &maps.mips {
            mips.record(recorder, &pipelines.mips);
        }
    }
}

/// Descriptor of the texture of a map's first level, of its further levels, or between the two directions of its blur.
fn descriptor(label: &str, size: UVec2, words: u32, is_drawn: bool) -> wgpu::TextureDescriptor<'_> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: words },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: PackedMap::FORMAT,
        usage: wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST
            | if is_drawn { wgpu::TextureUsages::RENDER_ATTACHMENT } else { wgpu::TextureUsages::empty() },
        view_formats: &[],
    }
}
