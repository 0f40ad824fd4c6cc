//! Maps whose texels hold several channels, packed into 32-bit words: a texture array of `R32Uint`, a layer for each word.
//! They are blurred by a separable kernel and have a mip chain. What the channels mean is the user's affair; filtering is
//! linear in them.
//!
//! A reader of some channels reads the words that hold them and no others.

use std::sync::Arc;

use glam::{IVec2, UVec2};

use crate::contract::{LevelTexels, MapLevel};
use crate::gpu::{
    Bindings, Cached, Gpu, Recorder, Scratch, Span, Stage, array_view, bindings, compute_pipeline_without_zeroing,
    create_uniform, gpu_structs, level_views, slice_views, texels, texture_bytes, upload_storage, write_uniform,
};
use crate::shaders;

#[cfg(test)]
pub(crate) mod cpu;
#[cfg(test)]
mod tests;

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

/// A symmetric kernel of unit sum.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kernel {
    /// `2 · radius + 1` weights.
    pub(crate) weights: Vec<f32>,
}

impl Kernel {
    /// The box of `width` texels; its outermost texels count for the part that it covers.
    pub(crate) fn boxed(width: f32) -> Self {
        let half = f64::from(0.5 * width.max(1.0));
        let radius = (half - 0.5).ceil().max(0.0) as i32;
        Self::of(radius, |i| (half - (f64::from(i.abs()) - 0.5)).clamp(0.0, 1.0))
    }

    /// The Gaussian with the standard deviation of a box of `width` texels, cut at three of them: the integral over each
    /// texel.
    pub(crate) fn gaussian(width: f32) -> Self {
        if width <= 1.0 {
            return Self::boxed(1.0);
        }
        let sigma = f64::from(width) / 12f64.sqrt();
        let radius = (3.0 * sigma).ceil() as i32;
        // Simpson's rule over the texel.
        let at = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
        Self::of(radius, |i| {
            let x = f64::from(i);
            (at(x - 0.5) + 4.0 * at(x) + at(x + 0.5)) / 6.0
        })
    }

    fn of(radius: i32, weight: impl Fn(i32) -> f64) -> Self {
        let weights: Vec<f64> = (-radius..=radius).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        Self { weights: weights.into_iter().map(|w| (w / sum) as f32).collect() }
    }

    /// The weights, then their running sums from 0 before the first to 1 at the last.
    fn with_running_sums(&self) -> Vec<f32> {
        let mut sum = 0.0;
        let sums = self.weights.iter().map(|weight| {
            sum += f64::from(*weight);
            sum as f32
        });
        self.weights.iter().copied().chain([0.0]).chain(sums).collect()
    }

    /// Texels to each side of the centre.
    pub(crate) fn radius(&self) -> u32 {
        self.weights.len() as u32 / 2
    }
}

gpu_structs! {
    /// One direction of a blur.
    pub(crate) struct BlurUniform {
        direction: IVec2,
        radius: i32,
        padding: u32,
    }
}

bindings! {
    struct Blur = "packed blur", COMPUTE, group 0 of [PACKED_BLUR] {
        0 blur: Uniform,
        1 weights: Storage,
        2 source: TextureArray(texels::UINT),
        3 target_layers: WrittenArray(PackedMap::FORMAT),
    }

    struct Halve = "packed mips", COMPUTE, group 0 of [PACKED_HALVE] {
        0 previous: TextureArray(texels::UINT),
        1 level: WrittenArray(PackedMap::FORMAT),
    }

    struct HalveFour = "four packed mips", COMPUTE, group 0 of [PACKED_HALVE_FOUR] {
        0 previous: TextureArray(texels::UINT),
        1 first_level: WrittenArray(PackedMap::FORMAT),
        2 second_level: WrittenArray(PackedMap::FORMAT),
        3 third_level: WrittenArray(PackedMap::FORMAT),
        4 fourth_level: WrittenArray(PackedMap::FORMAT),
    }
}

/// What a map is allocated for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    size: UVec2,
    words: u32,
    levels: u32,
    blurred: bool,
    /// Whether passes that draw write it.
    drawn: bool,
}

#[derive(Debug)]
struct Maps {
    shape: Shape,
    texture: wgpu::Texture,
    /// Of every level, for reading.
    all: wgpu::TextureView,
    /// Of the first level, for writing.
    first: wgpu::TextureView,
    /// Rows, then columns; none without a blur.
    blurs: Vec<wgpu::BindGroup>,
    /// What rows write and columns read, shared by all maps of the size, is kept for as long as it is bound.
    _rows: Option<Arc<wgpu::Texture>>,
    mips: Vec<Mips>,
    /// Of the first level of each word, where passes that draw write it.
    drawn: Vec<wgpu::TextureView>,
}

/// What makes some levels from the one before them.
#[derive(Debug)]
struct Mips {
    bind_group: wgpu::BindGroup,
    step: MipStep,
    /// Of the first of them.
    size: UVec2,
}

/// A dispatch that makes mip levels, by the level before them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MipStep {
    /// The next level, of any size.
    One(u32),
    /// The next four, where the level before has multiples of 16 texels.
    Four(u32),
}

#[derive(Clone, Debug)]
struct Pipelines {
    blur: wgpu::ComputePipeline,
    halve: wgpu::ComputePipeline,
    halve_four: wgpu::ComputePipeline,
}

/// A map, its blur and its mips.
#[derive(Debug)]
pub(crate) struct PackedMap {
    blur_layout: wgpu::BindGroupLayout,
    halve_layout: wgpu::BindGroupLayout,
    halve_four_layout: wgpu::BindGroupLayout,
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
    /// `layouts` are of the blur, of one level and of four.
    fn new(gpu: &Gpu, layouts: [&wgpu::BindGroupLayout; 3], packing: Packing) -> Self {
        let constants = [("PACKING", f64::from(packing as u32))];
        let make = |label, wgsl, layout| compute_pipeline_without_zeroing(gpu, label, wgsl, &constants, &[layout]);
        Self {
            blur: make("packed blur", shaders::PACKED_BLUR, layouts[0]),
            halve: make("packed mips", shaders::PACKED_HALVE, layouts[1]),
            halve_four: make("four packed mips", shaders::PACKED_HALVE_FOUR, layouts[2]),
        }
    }
}

/// Texels along each side of what a workgroup makes: of the blur, of one level, and of the first of four.
const BLUR_TILE: u32 = 16;
const HALVE_TILE: u32 = 8;
const HALVE_FOUR_TILE: u32 = 16;

impl PackedMap {
    /// The texture's format.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipelines: Cached::default(),
            blur_layout: Blur::layout(gpu),
            halve_layout: Halve::layout(gpu),
            halve_four_layout: HalveFour::layout(gpu),
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
        let levels = if with_mips { size.max_element().ilog2() + 1 } else { 1 };
        let shape = Shape { size, words, levels, blurred: kernel.radius() > 0, drawn: self.is_drawn };
        for (buffer, direction) in [(&self.rows, IVec2::X), (&self.columns, IVec2::Y)] {
            let uniform = BlurUniform { direction, radius: kernel.radius() as i32, padding: 0 };
            write_uniform(stage, buffer, &uniform);
        }
        let layouts = [&self.blur_layout, &self.halve_layout, &self.halve_four_layout];
        let pipelines = self.pipelines.get_or_make(packing, || Pipelines::new(stage, layouts, packing)).clone();
        let weights = kernel.with_running_sums();
        let bytes = size_of_val(weights.as_slice()) as u64;
        let weights_stay = self.weights.as_ref().is_some_and(|buffer| buffer.size() == bytes);
        let weights = upload_storage(stage, &mut self.weights, "antumbra blur weights", &weights).clone();
        let made = self.maps.take().filter(|maps| weights_stay && maps.shape == shape);
        let maps = made.unwrap_or_else(|| Arc::new(self.allocate(stage, shape, &weights)));
        self.maps = Some(Arc::clone(&maps));
        PreparedPackedMap { maps, weights, pipelines }
    }

    fn allocate(&self, gpu: &Gpu, shape: Shape, weights: &wgpu::Buffer) -> Maps {
        let texture = gpu.device.create_texture(&descriptor("antumbra packed map", shape));
        let levels = level_views(gpu, &texture);
        let rows = shape.blurred.then(|| {
            let shape = Shape { levels: 1, drawn: false, ..shape };
            gpu.device.scratch_texture(Scratch::BlurredRows, &descriptor("antumbra blurred rows", shape))
        });
        let blurs = rows.iter().flat_map(|rows| {
            let rows = array_view(gpu, rows);
            let blur = |uniform, source, target_layers| {
                Blur { blur: uniform, weights, source, target_layers }.kept_group(gpu, &self.blur_layout)
            };
            [blur(&self.rows, &levels[0], &rows), blur(&self.columns, &rows, &levels[0])]
        });
        Maps {
            shape,
            blurs: blurs.collect(),
            mips: mip_steps(shape.size, shape.levels).map(|step| self.mips(gpu, shape, &levels, step)).collect(),
            _rows: rows,
            all: array_view(gpu, &texture),
            first: levels[0].clone(),
            drawn: if shape.drawn { slice_views(gpu, &texture) } else { Vec::new() },
            texture,
        }
    }

    /// A dispatch that makes levels of a map.
    fn mips(&self, gpu: &Gpu, shape: Shape, levels: &[wgpu::TextureView], step: MipStep) -> Mips {
        let (MipStep::One(before) | MipStep::Four(before)) = step;
        let level = |i: u32| &levels[(before + i) as usize];
        let bind_group = match step {
            MipStep::One(_) => Halve { previous: level(0), level: level(1) }.kept_group(gpu, &self.halve_layout),
            MipStep::Four(_) => HalveFour {
                previous: level(0),
                first_level: level(1),
                second_level: level(2),
                third_level: level(3),
                fourth_level: level(4),
            }
            .kept_group(gpu, &self.halve_four_layout),
        };
        Mips { bind_group, step, size: shape.level_size(before + 1) }
    }

    /// Each level's first word alone, for whoever wants to look at it.
    pub(crate) fn drawn(&self) -> Vec<MapLevel> {
        let (Some(maps), Some((packing, _))) = (&self.maps, self.pipelines.pair()) else { return Vec::new() };
        let level = |base_mip_level: u32| MapLevel {
            view: maps.texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_mip_level,
                mip_level_count: Some(1),
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            }),
            size_px: maps.shape.level_size(base_mip_level),
            texels: match packing {
                Packing::Float32 => LevelTexels::Float32,
                Packing::Float16 => LevelTexels::Float16,
                Packing::Unorm16 => LevelTexels::Unorm16,
                Packing::Unorm8 => LevelTexels::Unorm8,
            },
        };
        (0..maps.shape.levels).map(level).collect()
    }

    /// Bytes of the map with its levels; what rows of its blur are written to is shared by all maps.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.maps.as_ref().map_or(0, |maps| texture_bytes(&maps.texture))
    }

    /// The texture, for tests.
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

    /// The first level of every word, for writing.
    pub(crate) fn target(&self) -> &wgpu::TextureView {
        &self.maps.first
    }

    /// Every level of every word, for reading.
    pub(crate) fn view(&self) -> &wgpu::TextureView {
        &self.maps.all
    }

    /// The kernel's weights, and their running sums.
    pub(crate) fn weights(&self) -> &wgpu::Buffer {
        &self.weights
    }

    /// Blurs the first level, where the kernel has a width, and makes the further levels, where there are any.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let Self { maps, pipelines, .. } = self;
        let Shape { size, words, .. } = maps.shape;
        // A pass for each dispatch, here and below: within one, wgpu 30 loses a texture array's layouts from level to level, as
        // the validation layers see it.
        for (i, group) in maps.blurs.iter().enumerate() {
            recorder.compute_apart("blur", Span::of(i, maps.blurs.len()), |pass| {
                pass.set_pipeline(&pipelines.blur);
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(size.x.div_ceil(BLUR_TILE), size.y.div_ceil(BLUR_TILE), words);
            });
        }
        for (i, Mips { bind_group, step, size }) in maps.mips.iter().enumerate() {
            recorder.compute_apart("mips", Span::of(i, maps.mips.len()), |pass| {
                let (pipeline, tile) = match step {
                    MipStep::One(_) => (&pipelines.halve, HALVE_TILE),
                    MipStep::Four(_) => (&pipelines.halve_four, HALVE_FOUR_TILE),
                };
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, bind_group, &[]);
                pass.dispatch_workgroups(size.x.div_ceil(tile), size.y.div_ceil(tile), words);
            });
        }
    }
}

impl Shape {
    fn level_size(&self, level: u32) -> UVec2 {
        (self.size >> level).max(UVec2::ONE)
    }
}

/// The dispatches that make all levels after the first: four at once where sizes allow, if need be some of them once more.
fn mip_steps(size: UVec2, levels: u32) -> impl Iterator<Item = MipStep> {
    let is_start = move |level: u32| {
        let texels = size >> level;
        level + 4 < levels && texels % 16 == UVec2::ZERO && texels.min_element() > 0
    };
    let mut made = 0;
    std::iter::from_fn(move || {
        if made + 1 >= levels {
            return None;
        }
        let start = (made.saturating_sub(3)..=made).rev().find(|level| is_start(*level));
        let step = start.map_or(MipStep::One(made), MipStep::Four);
        made = start.map_or(made + 1, |level| level + 4);
        Some(step)
    })
}

/// The texture of a map, or of one between the directions of its blur.
fn descriptor(label: &str, shape: Shape) -> wgpu::TextureDescriptor<'_> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: shape.size.x, height: shape.size.y, depth_or_array_layers: shape.words },
        mip_level_count: shape.levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: PackedMap::FORMAT,
        usage: wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST
            | if shape.drawn { wgpu::TextureUsages::RENDER_ATTACHMENT } else { wgpu::TextureUsages::empty() },
        view_formats: &[],
    }
}
