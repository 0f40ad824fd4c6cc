//! Nearest fragment of every square of texels, from 4 × 4 to the whole map, with which lookups skip empty levels.

use std::sync::Arc;

use glam::UVec2;

use super::gpu_types::NearestStep;
use super::{STEP_STRIDE, TILE};
use crate::gpu::{Bindings, Gpu, Scratch, Stage, bindings, compute_entry, upload_growable};
use crate::light_map::texel_lists::PreparedLists;
use crate::shaders;

bindings! {
    struct Nearest = "multi_layer nearest", COMPUTE, group 0 of [MULTI_LAYER_NEAREST] {
        /// [`NearestStep`]s, [`STEP_STRIDE`] bytes apart.
        0 nearest_step: DynamicStorage(size_of::<NearestStep>()),
        1 lists: Storage,
        2 fragments: Storage,
        3 nearest: ReadWrite,
    }
}

/// Number of sizes of squares that a dispatch makes.
const SIZES_A_STEP: u32 = 4;

/// Squares of one size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Squares {
    /// Log2 of their side: `1 << shift` texels of the base.
    pub(crate) shift: u32,
    /// Number of squares along each side of the map.
    pub(crate) count: UVec2,
    /// Index of the first square of this size.
    pub(crate) first: u32,
}

/// Returns all sizes of squares of a map up to a single square, and further ones that complete the last dispatch.
pub(crate) fn all_squares(map_size: UVec2) -> Vec<Squares> {
    let mut all: Vec<Squares> = Vec::new();
    let mut first = 0;
    let is_whole = |all: &[Squares]| all.last().is_some_and(|squares| squares.count == UVec2::ONE);
    while !is_whole(&all) || !(all.len() as u32).is_multiple_of(SIZES_A_STEP) {
        let shift = 2 + all.len() as u32;
        let count = map_size.map(|texels| texels.div_ceil(1 << shift));
        all.push(Squares { shift, count, first });
        first += count.element_product();
    }
    all
}

/// Returns the smallest size of which two squares per side cover all within `reach` of any position.
pub(crate) fn squares_for(all: &[Squares], reach: f32) -> Squares {
    let holds = |squares: &&Squares| squares.count == UVec2::ONE || (1 << squares.shift) as f32 >= 2.0 * reach;
    *all.iter().find(holds).expect("the last is the whole map")
}

/// Passes that find the nearest fragment of every square.
#[derive(Debug)]
pub(crate) struct NearestSquares {
    layout: wgpu::BindGroupLayout,
    of_lists: wgpu::ComputePipeline,
    of_squares: wgpu::ComputePipeline,
    steps: Option<wgpu::Buffer>,
    /// Buffer of depths, and whether it is the light's own.
    depths: Option<(Arc<wgpu::Buffer>, bool)>,
    /// Number of squares that are made, for tests.
    #[cfg(test)]
    pub(crate) made: u64,
}

/// Passes of one frame.
#[derive(Debug)]
pub(crate) struct PreparedNearest {
    /// Nearest depths, metres, size after size.
    pub(crate) depths: Arc<wgpu::Buffer>,
    group: wgpu::BindGroup,
    /// Number of squares of each dispatch.
    steps: Vec<UVec2>,
}

impl NearestSquares {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = Nearest::layout(gpu);
        let pipeline = |entry| {
            compute_entry(gpu, "multi_layer nearest", shaders::MULTI_LAYER_NEAREST, Some(entry), &[], &[&layout])
        };
        Self {
            of_lists: pipeline("of_lists"),
            of_squares: pipeline("of_squares"),
            layout,
            steps: None,
            depths: None,
            #[cfg(test)]
            made: 0,
        }
    }

    /// Returns the size of the depths of a map of `map_size`² texels, bytes, whatever its sides: a twelfth of the texels in
    /// squares, and rounding along the sides.
    pub(crate) fn bytes_of(map_size: u32) -> u64 {
        let side = u64::from(map_size);
        4 * (side * side / 8 + 16 * side + 64)
    }

    /// Prepares the squares up to the size `largest` in a buffer of `room_bytes`, from [`bytes_of`](Self::bytes_of).
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        of_frame: &PreparedLists,
        room_bytes: u64,
        all: &[Squares],
        largest: u32,
        map_size: UVec2,
    ) -> PreparedNearest {
        let PreparedLists { lists, fragments, lease, .. } = of_frame;
        let steps: Vec<&[Squares]> =
            all.chunks(SIZES_A_STEP as usize).take_while(|sizes| sizes[0].shift <= largest).collect();
        let mut bytes = vec![0; STEP_STRIDE as usize * steps.len()];
        let mut source_first = 0;
        for (bytes, sizes) in bytes.chunks_exact_mut(STEP_STRIDE as usize).zip(&steps) {
            let step = NearestStep {
                map_size,
                level: sizes[0].shift - 2,
                first: sizes[0].first,
                source_first,
                ..NearestStep::default()
            };
            bytes[..size_of::<NearestStep>()].copy_from_slice(bytemuck::bytes_of(&step));
            source_first = sizes[sizes.len() - 1].first;
        }
        let last = steps.last().and_then(|sizes| sizes.last()).expect("there is a step");
        let count = u64::from(last.first + last.count.element_product());
        #[cfg(test)]
        {
            self.made = count;
        }
        debug_assert!(4 * count <= room_bytes, "{count} squares in {room_bytes} bytes");
        let is_it =
            |(buffer, is_own): &(Arc<wgpu::Buffer>, bool)| buffer.size() == room_bytes && *is_own == lease.is_own();
        let depths = self.depths.take().filter(is_it);
        let (nearest, _) = self.depths.insert(depths.unwrap_or_else(|| {
            let descriptor = wgpu::BufferDescriptor {
                label: Some("antumbra multi_layer nearest"),
                size: room_bytes,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            };
            (lease.buffer(&stage.device, Scratch::NearestSquares, &descriptor), lease.is_own())
        }));
        let nearest_step = upload_growable(stage, &mut self.steps, "antumbra multi_layer nearest", &bytes);
        let group = Nearest { nearest_step, lists, fragments, nearest }.group(stage, &self.layout);
        let steps = steps.iter().map(|sizes| sizes[0].count).collect();
        PreparedNearest { depths: Arc::clone(nearest), group, steps }
    }

    pub(crate) fn record(&self, pass: &mut wgpu::ComputePass<'_>, prepared: &PreparedNearest) {
        let PreparedNearest { group, steps, .. } = prepared;
        for (squares, i) in steps.iter().zip(0..) {
            pass.set_pipeline(if i == 0 { &self.of_lists } else { &self.of_squares });
            pass.set_bind_group(0, group, &[i * STEP_STRIDE]);
            let groups = squares.map(|count| count.div_ceil(TILE));
            pass.dispatch_workgroups(groups.x, groups.y, 1);
        }
    }
}
