//! Maps whose texels hold several channels, packed into 32-bit words: a texture array of `R32Uint`, a layer for each word.
//! They are blurred by a separable kernel and have a mip chain, whose further levels are a second texture (`mips`). Filtering is linear
//! in the channels, whatever the technique stores in them.
//!
//! A reader of some channels reads the words that hold them and no others.

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

/// How channels are stored. The numbers are those of `primitives/packing.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    /// One 32-bit float a word.
    Float32 = 0,
    /// Two 16-bit floats a word.
    Float16 = 1,
    /// Two 16-bit fractions of [0, 1] a word.
    Unorm16 = 2,
    /// Four 8-bit fractions of [0, 1] a word.
    Unorm8 = 3,
}

impl Packing {
    /// The constant of every pipeline that packs or unpacks words.
    fn constants(self) -> [(&'static str, f64); 1] {
        [("PACKING", f64::from(self as u32))]
    }

    /// Channels in a word.
    pub(crate) fn channels(self) -> u32 {
        match self {
            Self::Float32 => 1,
            Self::Float16 | Self::Unorm16 => 2,
            Self::Unorm8 => 4,
        }
    }

    /// A word all of whose channels are 1.
    pub(crate) fn word_of_ones(self) -> u32 {
        match self {
            Self::Float32 => 1.0f32.to_bits(),
            Self::Float16 => 0x3c00_3c00,
            Self::Unorm16 | Self::Unorm8 => u32::MAX,
        }
    }

    /// The largest error that storing and filtering leave in a value of [0, 1]. In 32-bit floats the sums of filters
    /// round, not the storage: sixteen units in the last place.
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
    /// One direction of a blur.
    pub(crate) struct BlurUniform {
        direction: IVec2,
        radius: i32,
        padding: u32,
    }

    /// Levels that one dispatch makes.
    pub(crate) struct MipsUniform {
        map_size: UVec2,
        before: u32,
        count: u32,
    }
}

bindings! {
    struct Blur = "packed blur", COMPUTE, group 0 of [PACKED_BLUR] {
        0 blur: Uniform,
        1 weights: Storage,
        2 source: TextureArray(texels::UINT),
        3 target_layers: WrittenArray(PackedMap::FORMAT),
    }
}

/// What a map is allocated for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    size: UVec2,
    words: u32,
    level_count: u32,
    blurred: bool,
    /// Whether passes that draw write it.
    drawn: bool,
}

#[derive(Debug)]
struct Maps {
    shape: Shape,
    /// The first level of every word.
    texture: wgpu::Texture,
    first: wgpu::TextureView,
    /// Rows, then columns; none without a blur.
    blurs: Vec<wgpu::BindGroup>,
    /// What rows write and columns read, shared by all maps of the size, is kept for as long as it is bound.
    _rows: Option<Arc<wgpu::Texture>>,
    /// None of a map of one level.
    mips: Option<Mips>,
    /// Of the first level of each word, where passes that draw write it.
    drawn: Vec<wgpu::TextureView>,
}

#[derive(Clone, Debug)]
struct Pipelines {
    blur: wgpu::ComputePipeline,
    mips: MipPipelines,
}

/// A map, its blur and its mips.
#[derive(Debug)]
pub(crate) struct PackedMap {
    blur_layout: wgpu::BindGroupLayout,
    mips_layout: wgpu::BindGroupLayout,
    /// For the packing that is prepared.
    pipelines: Cached<Packing, Pipelines>,
    rows: wgpu::Buffer,
    columns: wgpu::Buffer,
    weights: Option<wgpu::Buffer>,
    is_drawn: bool,
    maps: Option<Arc<Maps>>,
}

/// A map of one frame, its blur and its mips.
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
            blur: compute_pipeline_without_zeroing(gpu, "packed blur", shaders::PACKED_BLUR, &constants, &[blur]),
            mips: MipPipelines::new(gpu, mips, packing),
        }
    }
}

/// Texels along each side of what a workgroup of the blur makes.
const BLUR_TILE: u32 = 16;

impl PackedMap {
    /// The texture's format.
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

    /// Sets whether passes that draw write the map that is prepared next.
    pub(crate) fn set_drawn(&mut self, is_drawn: bool) {
        self.is_drawn = is_drawn;
    }

    /// Allocates a map of `words` words a texel, and its passes.
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
                Blur { blur: uniform, weights, source, target_layers }.kept_group(gpu, &self.blur_layout)
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

    /// Each level's first word alone, for whoever wants to look at it.
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

    /// Bytes of the map with its levels; what rows of its blur are written to is shared by all maps.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.maps.as_ref().map_or(0, |maps| {
            texture_bytes(&maps.texture) + maps.mips.as_ref().map_or(0, |mips| texture_bytes(mips.texture()))
        })
    }

    /// The first level's texture, for tests.
    #[cfg(test)]
    pub(crate) fn texture(&self) -> &wgpu::Texture {
        &self.maps.as_ref().expect("a map was prepared").texture
    }
}

impl PreparedPackedMap {
    /// The first level of each word, for drawing, where passes that draw write the map.
    pub(crate) fn layer_views(&self) -> &[wgpu::TextureView] {
        &self.maps.drawn
    }

    /// The first level of every word.
    pub(crate) fn first(&self) -> &wgpu::TextureView {
        &self.maps.first
    }

    /// The further levels of every word, side by side (`levels.wesl`); of a map of one level something else, which is not read.
    pub(crate) fn mips(&self) -> &wgpu::TextureView {
        self.maps.mips.as_ref().map_or(&self.maps.first, Mips::view)
    }

    /// How many levels there are.
    pub(crate) fn level_count(&self) -> u32 {
        self.maps.shape.level_count
    }

    /// The kernel's weights, and their running sums.
    pub(crate) fn weights(&self) -> &wgpu::Buffer {
        &self.weights
    }

    /// Blurs the first level, where the kernel has a width, and makes the further levels, where there are any.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let Self { maps, pipelines, .. } = self;
        let Shape { size, words, .. } = maps.shape;
        // A pass for each dispatch, here and for mips: within one, wgpu 30 lost the layouts of a texture array's levels, as the
        // validation layers saw it. Whether it loses those of layers, of which the textures consist now, is not known.
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

/// The texture of a map's first level, of its further ones, or of what lies between the directions of its blur.
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
