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

use crate::gpu::{
    Bindings, Gpu, Recorder, Stage, bindings, compute_pipeline, dispatch_threads, shared_constants, sized_buffer,
};
use crate::primitives::prefix_scan::PrefixScan;
use crate::shaders;

use super::gpu_types::{Segment, TreeShape};

bindings! {
    struct Boxes = "tree boxes", COMPUTE,
        group 0 of [TREE_NUMBER, TREE_PYRAMID, TREE_FRAMES, TREE_CODES, TREE_FIT]
    {
        0 shape: Uniform,
        1 segments: Storage,
        2 items: ReadWrite,
        3 order: ReadWrite,
        4 pyramid: ReadWrite,
        5 keys: ReadWrite,
        6 nodes: ReadWrite,
    }

    struct Sorted = "tree sort", COMPUTE, group 0 of [TREE_SORT_COUNT, TREE_SORT_SCATTER] {
        0 shape: Uniform,
        1 segments: Storage,
        2 keys_in: Storage,
        3 order_in: Storage,
        4 keys_out: ReadWrite,
        5 order_out: ReadWrite,
        6 counts: ReadWrite,
    }

    struct Links = "tree links", COMPUTE, group 0 of [TREE_HIERARCHY, TREE_TALLY, TREE_MARK, TREE_WORDS] {
        0 shape: Uniform,
        1 segments: Storage,
        2 keys: Storage,
        3 ends: ReadWrite,
        4 parents: ReadWrite,
        5 tallies: ReadWrite,
        6 starts: ReadWrite,
        7 nodes: ReadWrite,
    }
}

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

/// Pipelines of the passes.
#[derive(Debug)]
pub(super) struct TreePrograms {
    boxes_layout: wgpu::BindGroupLayout,
    sort_layout: wgpu::BindGroupLayout,
    links_layout: wgpu::BindGroupLayout,
    number: wgpu::ComputePipeline,
    pyramid: wgpu::ComputePipeline,
    frames: wgpu::ComputePipeline,
    codes: wgpu::ComputePipeline,
    count: wgpu::ComputePipeline,
    scatter: wgpu::ComputePipeline,
    links: [wgpu::ComputePipeline; 3],
    words: wgpu::ComputePipeline,
    fit: wgpu::ComputePipeline,
}

impl TreePrograms {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let (boxes, sort, links) = (Boxes::layout(gpu), Sorted::layout(gpu), Links::layout(gpu));
        let program = |wgsl, layout| compute_pipeline(gpu, "tree", wgsl, &[layout]);
        Self {
            number: program(shaders::TREE_NUMBER, &boxes),
            pyramid: program(shaders::TREE_PYRAMID, &boxes),
            frames: program(shaders::TREE_FRAMES, &boxes),
            codes: program(shaders::TREE_CODES, &boxes),
            count: program(shaders::TREE_SORT_COUNT, &sort),
            scatter: program(shaders::TREE_SORT_SCATTER, &sort),
            links: [shaders::TREE_HIERARCHY, shaders::TREE_TALLY, shaders::TREE_MARK].map(|wgsl| program(wgsl, &links)),
            words: program(shaders::TREE_WORDS, &links),
            fit: program(shaders::TREE_FIT, &boxes),
            boxes_layout: boxes,
            sort_layout: sort,
            links_layout: links,
        }
    }
}

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

#[derive(Debug, Default)]
struct Scratch {
    items: Option<wgpu::Buffer>,
    orders: [Option<wgpu::Buffer>; 2],
    keys: [Option<wgpu::Buffer>; 2],
    pyramid: Option<wgpu::Buffer>,
    counts: Option<wgpu::Buffer>,
    ends: Option<wgpu::Buffer>,
    parents: Option<wgpu::Buffer>,
    tallies: Option<wgpu::Buffer>,
    starts: Option<wgpu::Buffer>,
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
        let (mut item_count, mut block_count) = (0, 0);
        for segment in &mut *segments {
            (segment.first_item, segment.first_block) = (item_count, block_count);
            item_count += segment.item_count;
            block_count += segment.item_count.div_ceil(BLOCK_ITEMS);
        }
        let shape = TreeShape {
            item_count,
            segment_count: segments.len() as u32,
            block_count,
            is_top: (level == Level::Instances).into(),
            ..TreeShape::default()
        };
        let shape_of = |step| stage.uniform("antumbra tree shape", &TreeShape { step, ..shape });
        let shape_buffer = shape_of(0);
        let segment_buffer = stage.storage("antumbra tree segments", segments);
        let level_counts = level_counts(item_count);
        self.scratch.allocate(stage, &shape, makes, level_counts.iter().sum());
        let scratch = &self.scratch;
        let boxes_of = |shape: &wgpu::Buffer| {
            let boxes = Boxes {
                shape,
                segments: &segment_buffer,
                items: here(&scratch.items),
                order: here(&scratch.orders[0]),
                pyramid: here(&scratch.pyramid),
                keys: here(&scratch.keys[0]),
                nodes,
            };
            boxes.group(stage, &programs.boxes_layout)
        };
        let levels = (1..).zip(&level_counts).map(|(level, count)| (boxes_of(&shape_of(level)), *count)).collect();
        let made = makes.then(|| {
            let digit = |step: u32| {
                let (from, to) = ((step % 2) as usize, 1 - (step % 2) as usize);
                let sorted = Sorted {
                    shape: &shape_of(step),
                    segments: &segment_buffer,
                    keys_in: here(&scratch.keys[from]),
                    order_in: here(&scratch.orders[from]),
                    keys_out: here(&scratch.keys[to]),
                    order_out: here(&scratch.orders[to]),
                    counts: here(&scratch.counts),
                };
                sorted.group(stage, &programs.sort_layout)
            };
            let links = Links {
                shape: &shape_buffer,
                segments: &segment_buffer,
                keys: here(&scratch.keys[0]),
                ends: here(&scratch.ends),
                parents: here(&scratch.parents),
                tallies: here(&scratch.tallies),
                starts: here(&scratch.starts),
                nodes,
            };
            BuildGroups {
                digits: (0..CODE_DIGITS).map(digit).collect(),
                links: links.group(stage, &programs.links_layout),
            }
        });
        if makes {
            self.count_scan.prepare(stage, here(&scratch.counts), DIGITS * block_count);
            self.start_scan.prepare(stage, here(&scratch.starts), item_count + 1);
        }
        self.prepared = Some(Prepared {
            item_count,
            segment_count: shape.segment_count,
            block_count,
            node_room: item_count * if level == Level::Instances { 2 } else { 1 },
            boxes: boxes_of(&shape_buffer),
            levels,
            made,
            shape: shape_buffer,
            segments: segment_buffer,
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

impl Scratch {
    fn allocate(&mut self, stage: &Stage<'_>, shape: &TreeShape, makes: bool, pyramid_boxes: u32) {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let words = |slot: &mut Option<wgpu::Buffer>, label, count: u32| {
            sized_buffer(stage, slot, label, 4 * u64::from(count), usage);
        };
        let items = shape.item_count;
        // Two vectors per box.
        words(&mut self.items, "antumbra tree items", 8 * items);
        words(&mut self.pyramid, "antumbra tree pyramid", 8 * pyramid_boxes);
        words(&mut self.orders[0], "antumbra tree order", items);
        words(&mut self.keys[0], "antumbra tree keys", items);
        if makes {
            words(&mut self.orders[1], "antumbra tree order", items);
            words(&mut self.keys[1], "antumbra tree keys", items);
            words(&mut self.counts, "antumbra tree counts", DIGITS * shape.block_count);
            words(&mut self.ends, "antumbra tree ends", items);
            words(&mut self.parents, "antumbra tree parents", 2 * items);
            words(&mut self.tallies, "antumbra tree tallies", LEAF_SIZES * shape.segment_count);
            words(&mut self.starts, "antumbra tree starts", items + 1);
        }
    }

    fn memory_bytes(&self) -> u64 {
        let Self { items, orders, keys, pyramid, counts, ends, parents, tallies, starts } = self;
        let all = [items, &orders[0], &orders[1], &keys[0], &keys[1], pyramid, counts, ends, parents, tallies, starts];
        all.into_iter().flatten().map(wgpu::Buffer::size).sum()
    }
}

/// Returns the number of boxes of each level of the pyramid, up to the single one.
fn level_counts(item_count: u32) -> Vec<u32> {
    let mut counts = vec![item_count.div_ceil(GROUP)];
    while let Some(count) = counts.last().copied().filter(|count| *count > 1) {
        counts.push(count.div_ceil(GROUP));
    }
    counts
}

fn here(buffer: &Option<wgpu::Buffer>) -> &wgpu::Buffer {
    buffer.as_ref().expect("prepare allocates it")
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
