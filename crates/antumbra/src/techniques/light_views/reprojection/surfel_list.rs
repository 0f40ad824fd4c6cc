//! List of a central map's surfels, from which every group of views is scattered.
//!
//! Layers behind the first are mostly empty, and a batch of views has several groups: surfels are found once, and the cost of a
//! group depends on their number. The list is made by [pieces](SurfelPiece), bands of rows of a slice, each with space for
//! one surfel per texel, so that none is lost. If all pieces fit a budget, each has a place of its own and they are listed once
//! per frame; otherwise they are listed one after the other for each batch, in one place.
//!
//! - `collected surfels` reads a central map's texels once, 8 bytes each, and writes 4 bytes per surfel.
//! - `reprojected depth maps` reads, for each surfel and group, 4 bytes of name and 20 bytes of the map.

use super::gpu_types::SurfelPiece;
use super::program::compute_program;
use crate::gpu::{Bindings, Gpu, LeasedBuffer, Recorder, Scratch, Span, Stage, bindings, sized_buffer, texels};
use crate::light_map::depth_layers::{DepthLayers, LayersSize};
use crate::shaders;

bindings! {
    /// Bindings of the pass that lists the surfels of a piece.
    struct CollectSurfels = "collect surfels", COMPUTE, group 1 of [REPROJECTION_COLLECT_SURFELS] {
        0 central_depth: TextureArray(texels::DEPTH),
        1 central_gradient: TextureArray(texels::FLOAT),
        2 piece: DynamicUniform(size_of::<SurfelPiece>()),
        3 names: ReadWrite,
        4 counts: ReadWrite,
    }

    /// Bindings of the pass that scatters listed surfels.
    struct ListedSurfels = "listed surfels", COMPUTE, group 1 of [REPROJECTION_SPLAT_SURFELS] {
        0 central_depth: TextureArray(texels::DEPTH),
        1 central_gradient: TextureArray(texels::FLOAT),
        2 piece: DynamicUniform(size_of::<SurfelPiece>()),
        3 names: Storage,
        4 counts: Storage,
    }
}

/// Label of the pass that lists surfels.
const COLLECT: &str = "collected surfels";

/// Texels along each side of a workgroup's share: 8 × 8 threads, 2 × 2 texels each.
const TILE_TEXELS: u32 = 8 * 2;

/// Maximum numbers of names.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Names of one piece.
    pub(super) piece: u32,
    /// Names of all pieces together, if each has its own place.
    pub(super) kept: u64,
}

impl Limits {
    /// Default limits. A piece of 16 MiB is half of what one dimension of workgroups can scatter; 64 MiB in all are half of
    /// WebGPU's smallest limit for a binding.
    pub(super) const DEFAULT: Self = Self { piece: 1 << 22, kept: 1 << 24 };
}

/// Bytes of a piece's count: three words of a dispatch, and the number of names.
const COUNT_BYTES: u32 = 16;

/// Lists of surfels.
#[derive(Debug)]
pub(super) struct SurfelList {
    collect_layout: wgpu::BindGroupLayout,
    listed_layout: wgpu::BindGroupLayout,
    collect: wgpu::ComputePipeline,
    names: LeasedBuffer,
    counts: Option<wgpu::Buffer>,
}

/// Lists of one frame.
#[derive(Debug)]
pub(super) struct PreparedList {
    pieces: Pieces,
    /// Counts of each piece, as arguments of an indirect dispatch.
    counts: wgpu::Buffer,
    collect: wgpu::BindGroup,
    /// Bind group 1 of the scatter.
    pub(super) listed: wgpu::BindGroup,
}

/// Division of central maps into pieces.
#[derive(Clone, Debug, PartialEq)]
struct Pieces {
    /// Pieces by view, slice and band.
    all: Vec<Piece>,
    /// Whether each piece has its own place in the list.
    are_kept: bool,
    /// Number of names that the list has space for.
    names: u64,
    size: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    view: u32,
    rows: u32,
    gpu: SurfelPiece,
}

impl Pieces {
    fn of(size: LayersSize, limits: Limits) -> Self {
        let band = (limits.piece / size.size / TILE_TEXELS * TILE_TEXELS).max(TILE_TEXELS).min(size.size);
        let slices = size.views * size.layers;
        let names_of_all = u64::from(size.size).pow(2) * u64::from(slices);
        let are_kept = names_of_all <= limits.kept;
        let mut all = Vec::new();
        let mut first_name = 0;
        for slice in 0..slices {
            for first_row in (0..size.size).step_by(band as usize) {
                let rows = band.min(size.size - first_row);
                let first_count = all.len() as u32 * COUNT_BYTES / 4;
                let gpu = SurfelPiece { slice, first_row, first_name, first_count, ..SurfelPiece::default() };
                all.push(Piece { view: slice / size.layers, rows, gpu });
                if are_kept {
                    first_name += rows * size.size;
                }
            }
        }
        let names = if are_kept { names_of_all } else { u64::from(band) * u64::from(size.size) };
        Self { all, are_kept, names, size: size.size }
    }
}

impl Piece {
    /// Offset of the piece's uniform, bytes.
    fn offset(&self) -> u32 {
        self.gpu.first_count * 4 / COUNT_BYTES * size_of::<SurfelPiece>() as u32
    }
}

impl SurfelList {
    /// Creates the pipeline; `splat_layout` is that of group 2, the batch.
    pub(super) fn new(gpu: &Gpu, splat_layout: &wgpu::BindGroupLayout) -> Self {
        let collect_layout = CollectSurfels::layout(gpu);
        let layouts = [None, Some(&collect_layout), Some(splat_layout)];
        Self {
            collect: compute_program(gpu, shaders::REPROJECTION_COLLECT_SURFELS, &layouts, &[]),
            listed_layout: ListedSurfels::layout(gpu),
            collect_layout,
            names: LeasedBuffer::default(),
            counts: None,
        }
    }

    pub(super) fn listed_layout(&self) -> &wgpu::BindGroupLayout {
        &self.listed_layout
    }

    pub(super) fn prepare(&mut self, stage: &Stage<'_>, layers: &DepthLayers, limits: Limits) -> PreparedList {
        let pieces = Pieces::of(layers.size(), limits);
        let gpu_pieces: Vec<SurfelPiece> = pieces.all.iter().map(|piece| piece.gpu).collect();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let descriptor = wgpu::BufferDescriptor {
            label: Some("antumbra names of surfels"),
            size: pieces.names * 4,
            usage,
            mapped_at_creation: false,
        };
        let names = self.names.sized(&stage.device, Scratch::SurfelNames, &descriptor);
        let usage = usage | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
        let count_bytes = gpu_pieces.len() as u64 * u64::from(COUNT_BYTES);
        let counts = sized_buffer(stage, &mut self.counts, "antumbra counts of surfels", count_bytes, usage);
        let piece = &stage.uniform_array("antumbra surfel pieces", &gpu_pieces);
        let (central_depth, central_gradient) = (layers.depth_array(), layers.gradient_array());
        let collect =
            CollectSurfels { central_depth, central_gradient, piece, names, counts }.group(stage, &self.collect_layout);
        let listed =
            ListedSurfels { central_depth, central_gradient, piece, names, counts }.group(stage, &self.listed_layout);
        PreparedList { pieces, counts: counts.clone(), collect, listed }
    }

    /// Records the work before a batch: clears counts of the frame or the batch before, and lists the surfels if that is
    /// done once per frame.
    pub(super) fn record_collect(
        &self,
        recorder: &mut Recorder<'_>,
        prepared: &PreparedList,
        is_first_batch: bool,
        splats: &[(&wgpu::BindGroup, Vec<u32>)],
    ) {
        let pieces = &prepared.pieces;
        if !is_first_batch && pieces.are_kept {
            return;
        }
        recorder.clear_buffer(&prepared.counts);
        if pieces.are_kept {
            recorder.compute(COLLECT, Span::Only, |pass| {
                for piece in &pieces.all {
                    self.collect_piece(pass, prepared, piece, &splats[piece.view as usize]);
                }
            });
        }
    }

    /// Scatters the surfels of all central views, as the last part of step `label`.
    ///
    /// - `splats`: for each central view, group 2 and the offsets of its groups of views.
    pub(super) fn record_scatter(
        &self,
        recorder: &mut Recorder<'_>,
        label: &'static str,
        prepared: &PreparedList,
        scatter: &wgpu::ComputePipeline,
        splats: &[(&wgpu::BindGroup, Vec<u32>)],
    ) {
        recorder.compute(label, Span::Last, |pass| {
            for piece in &prepared.pieces.all {
                let (splat, offsets) = &splats[piece.view as usize];
                if !prepared.pieces.are_kept {
                    self.collect_piece(pass, prepared, piece, &splats[piece.view as usize]);
                }
                pass.set_pipeline(scatter);
                pass.set_bind_group(1, &prepared.listed, &[piece.offset()]);
                for group in offsets {
                    pass.set_bind_group(2, *splat, &[*group]);
                    pass.dispatch_workgroups_indirect(&prepared.counts, u64::from(piece.gpu.first_count) * 4);
                }
            }
        });
    }

    fn collect_piece(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        prepared: &PreparedList,
        piece: &Piece,
        (splat, offsets): &(&wgpu::BindGroup, Vec<u32>),
    ) {
        pass.set_pipeline(&self.collect);
        pass.set_bind_group(1, &prepared.collect, &[piece.offset()]);
        pass.set_bind_group(2, *splat, &offsets[..1]);
        pass.dispatch_workgroups(prepared.pieces.size.div_ceil(TILE_TEXELS), piece.rows.div_ceil(TILE_TEXELS), 1);
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.names.own_bytes() + self.counts.as_ref().map_or(0, wgpu::Buffer::size)
    }

    /// List, and counts of the pieces.
    #[cfg(test)]
    pub(super) fn buffers(&self) -> Option<[&wgpu::Buffer; 2]> {
        Some([self.names.buffer()?, self.counts.as_ref()?])
    }
}

#[cfg(test)]
mod tests {
    use super::{Limits, Pieces};
    use crate::light_map::depth_layers::LayersSize;

    #[test]
    fn pieces_hold_every_texel_once_within_their_room() {
        for (size, views, layers) in
            [(1, 1, 1), (15, 1, 3), (16, 1, 1), (142, 2, 4), (2048, 1, 4), (1024, 6, 4), (16384, 1, 2)]
        {
            let pieces = Pieces::of(LayersSize { size, views, layers, with_gradients: true }, Limits::DEFAULT);
            let mut rows = vec![0; (size * views * layers) as usize];
            let mut next_name = 0;
            for (i, piece) in pieces.all.iter().enumerate() {
                assert_eq!(piece.gpu.first_count, 4 * i as u32);
                assert_eq!(piece.view, piece.gpu.slice / layers);
                assert!(piece.gpu.first_row % 16 == 0 && piece.rows > 0, "{piece:?}");
                assert_eq!(piece.gpu.first_name, if pieces.are_kept { next_name } else { 0 });
                let end = u64::from(piece.gpu.first_name) + u64::from(piece.rows * size);
                assert!(end <= pieces.names && piece.rows * size <= Limits::DEFAULT.piece, "{piece:?}");
                next_name += piece.rows * size;
                let first = piece.gpu.slice * size + piece.gpu.first_row;
                rows[first as usize..(first + piece.rows) as usize].iter_mut().for_each(|row| *row += 1);
            }
            assert!(rows.iter().all(|row| *row == 1), "{size} {views} {layers}");
            assert!(pieces.names <= Limits::DEFAULT.kept);
            assert_eq!(pieces.are_kept, u64::from(size).pow(2) * u64::from(views * layers) <= Limits::DEFAULT.kept);
        }
    }
}
