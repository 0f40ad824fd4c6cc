//! Bounding volume hierarchies over an array of items, built on the GPU: over triangles of meshes, over instances of a frame.
//!
//! Items are sorted by the Morton codes of their centres, four bits at a time (`sort.wesl`), and the tree is derived from the codes, each
//! node independently (`links.wesl`: Karras, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", HPG 2012).
//!
//! Why not parallel locally-ordered clustering (Meister, Bittner 2018, TVCG; in one kernel: Benthin et al. 2024, HPG)? Its trees are
//! better. But its number of rounds depends on the data, so the CPU would have to read it back or guess; and in the single kernel
//! workgroups wait for others' writes, for which WebGPU guarantees neither progress nor visibility. Here every pass is one dispatch, their
//! number is known in advance, and the same items yield the same tree to the bit.
//!
//! Runs of a few items form a leaf, as large as is needed to keep a tree's nodes at most its items. Nodes are put in depth-first order by
//! counting (`words.wesl`), so that neither building nor traversal needs a stack (`nodes.wesl`).
//!
//! Boxes come from a pyramid over the items' order (`boxes.wesl`). A pass from the leaves upwards, continued by the second of two siblings,
//! would need one workgroup to see another's writes of the same dispatch. If items move and keep their order, only the pyramid and the
//! boxes are recomputed: this is how deformed meshes are refitted.

use super::gpu_types::{Segment, TreeShape};
use crate::gpu::{Gpu, Recorder, Stage, dispatch_threads, shared_constants};
use crate::primitives::prefix_scan::PrefixScan;

mod programs;

pub(super) use programs::TreePrograms;
use programs::{ForestGroups, Scratch, here};

shared_constants! {
    /// Number of items that a workgroup sorts.
    const BLOCK_ITEMS: u32 = 2048, as in TREE_SORT_COUNT;
    /// Number of boxes per box of the next level of the pyramid.
    const GROUP: u32 = 8, as in TREE_PYRAMID;
    /// Number of values of a digit.
    const DIGITS: u32 = 16, as in TREE_SORT_COUNT;
    /// Number of leaf sizes.
    const LEAF_SIZES: u32 = 3, as in TREE_TALLY;
}

/// Number of digits of a code: even, so that the sort ends in the buffer that it began in.
const CODE_DIGITS: u32 = 8;

/// Number of vectors of a tree before its nodes: its own box.
pub(super) const FRAME_VECTORS: u32 = 2;

/// Kind of the trees' items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    /// Triangles: leaves of several items, nodes of one vector.
    Triangles,
    /// Instances: leaves of one item, nodes of two vectors.
    Instances,
}

/// Trees that are built, or refitted, together.
#[derive(Debug)]
pub(super) struct Forest {
    scratch: Scratch,
    count_scan: PrefixScan,
    start_scan: PrefixScan,
    prepared: Option<Prepared>,
}

#[derive(Debug)]
struct Prepared {
    item_count: u32,
    segment_count: u32,
    block_count: u32,
    /// Largest number of nodes.
    node_room: u32,
    boxes: wgpu::BindGroup,
    /// Bind group and number of boxes of each level of the pyramid.
    levels: Vec<(wgpu::BindGroup, u32)>,
    made: Option<BuildGroups>,
    shape: wgpu::Buffer,
    segments: wgpu::Buffer,
}

/// Bind groups for building trees.
#[derive(Debug)]
struct BuildGroups {
    digits: Vec<wgpu::BindGroup>,
    links: wgpu::BindGroup,
}

impl Forest {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            scratch: Scratch::default(),
            count_scan: PrefixScan::new(gpu),
            start_scan: PrefixScan::new(gpu),
            prepared: None,
        }
    }

    /// Allocates for some segments, whose trees are stored in `nodes`. `makes`: build the trees instead of refitting them.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        programs: &TreePrograms,
        level: Level,
        makes: bool,
        segments: &mut [Segment],
        nodes: &wgpu::Buffer,
    ) {
        let (item_count, block_count) = number_items(segments);
        let shape = TreeShape {
            item_count,
            segment_count: segments.len() as u32,
            block_count,
            is_top: (level == Level::Instances).into(),
            ..TreeShape::default()
        };
        let level_counts = level_counts(item_count);
        self.scratch.allocate(stage, &shape, makes, level_counts.iter().sum());
        let segments = stage.storage("antumbra tree segments", segments);
        let groups = ForestGroups { stage, programs, scratch: &self.scratch, shape, segments: &segments, nodes };
        let shape = groups.step_shape(0);
        let levels =
            (1..).zip(&level_counts).map(|(level, count)| (groups.boxes(&groups.step_shape(level)), *count)).collect();
        let made = makes.then(|| BuildGroups {
            digits: (0..CODE_DIGITS).map(|step| groups.digit(step)).collect(),
            links: groups.links(&shape),
        });
        if makes {
            self.count_scan.prepare(stage, here(&self.scratch.counts), DIGITS * block_count);
            self.start_scan.prepare(stage, here(&self.scratch.starts), item_count + 1);
        }
        self.prepared = Some(Prepared {
            item_count,
            segment_count: groups.shape.segment_count,
            block_count,
            node_room: item_count * if level == Level::Instances { 2 } else { 1 },
            boxes: groups.boxes(&shape),
            levels,
            made,
            shape,
            segments,
        });
    }

    fn prepared(&self) -> &Prepared {
        self.prepared.as_ref().expect("prepare comes before use")
    }

    pub(super) fn item_count(&self) -> u32 {
        self.prepared().item_count
    }

    /// Buffers of [`TreeShape`] and [`Segment`]s.
    pub(super) fn shape(&self) -> (&wgpu::Buffer, &wgpu::Buffer) {
        (&self.prepared().shape, &self.prepared().segments)
    }

    /// Boxes of the items, two vectors each, by item number.
    pub(super) fn items(&self) -> &wgpu::Buffer {
        here(&self.scratch.items)
    }

    /// Item numbers, by position in the trees.
    pub(super) fn order(&self) -> &wgpu::Buffer {
        here(&self.scratch.orders[0])
    }

    /// Clears the counters before trees are built.
    pub(super) fn clear(&self, recorder: &mut Recorder<'_>) {
        recorder.clear_buffer(here(&self.scratch.tallies));
        recorder.clear_buffer(here(&self.scratch.starts));
    }

    fn made(&self) -> &BuildGroups {
        self.prepared().made.as_ref().expect("`prepare` scheduled the build")
    }

    /// Sorts items by their boxes within each segment; the result is the order.
    pub(super) fn sort(&self, pass: &mut wgpu::ComputePass<'_>, programs: &TreePrograms) {
        let prepared = self.prepared();
        pass.set_bind_group(0, &prepared.boxes, &[]);
        over(pass, &programs.number, prepared.item_count);
        prepared.make_frames(pass, programs);
        over(pass, &programs.codes, prepared.item_count);
        for digit in &self.made().digits {
            pass.set_bind_group(0, digit, &[]);
            over_blocks(pass, &programs.count, prepared.block_count);
            self.count_scan.dispatch(pass);
            pass.set_bind_group(0, digit, &[]);
            over_blocks(pass, &programs.scatter, prepared.block_count);
        }
    }

    /// Builds trees over sorted items, without boxes.
    pub(super) fn link(&self, pass: &mut wgpu::ComputePass<'_>, programs: &TreePrograms) {
        let items = self.item_count();
        pass.set_bind_group(0, &self.made().links, &[]);
        programs.links.iter().for_each(|program| over(pass, program, items));
        self.start_scan.dispatch(pass);
        pass.set_bind_group(0, &self.made().links, &[]);
        over(pass, &programs.words, items);
    }

    /// Fits nodes to items in their order.
    pub(super) fn fit(&self, pass: &mut wgpu::ComputePass<'_>, programs: &TreePrograms) {
        let prepared = self.prepared();
        prepared.make_frames(pass, programs);
        over(pass, &programs.fit, prepared.node_room);
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.scratch.memory_bytes() + self.count_scan.memory_bytes() + self.start_scan.memory_bytes()
    }
}

impl Prepared {
    /// Records the pyramid and each tree's own box.
    fn make_frames(&self, pass: &mut wgpu::ComputePass<'_>, programs: &TreePrograms) {
        for (group, count) in &self.levels {
            pass.set_bind_group(0, group, &[]);
            over(pass, &programs.pyramid, *count);
        }
        pass.set_bind_group(0, &self.boxes, &[]);
        over(pass, &programs.frames, self.segment_count);
    }
}

/// Numbers items and blocks of the segments. Returns how many of each there are.
fn number_items(segments: &mut [Segment]) -> (u32, u32) {
    let (mut item_count, mut block_count) = (0, 0);
    for segment in segments {
        (segment.first_item, segment.first_block) = (item_count, block_count);
        item_count += segment.item_count;
        block_count += segment.item_count.div_ceil(BLOCK_ITEMS);
    }
    (item_count, block_count)
}

/// Returns the number of boxes of each level of the pyramid, up to the single one.
fn level_counts(item_count: u32) -> Vec<u32> {
    let mut counts = vec![item_count.div_ceil(GROUP)];
    while let Some(count) = counts.last().copied().filter(|count| *count > 1) {
        counts.push(count.div_ceil(GROUP));
    }
    counts
}

fn over(pass: &mut wgpu::ComputePass<'_>, program: &wgpu::ComputePipeline, threads: u32) {
    pass.set_pipeline(program);
    dispatch_threads(pass, threads);
}

/// Dispatches a workgroup per block, in two dimensions if WebGPU's limit requires it.
fn over_blocks(pass: &mut wgpu::ComputePass<'_>, program: &wgpu::ComputePipeline, blocks: u32) {
    pass.set_pipeline(program);
    let across = blocks.min(65_535);
    pass.dispatch_workgroups(across, blocks.div_ceil(across.max(1)), 1);
}
