//! Pipelines of the passes, and the buffers and bind groups of the trees that they build.

use super::super::gpu_types::TreeShape;
use super::{DIGITS, LEAF_SIZES};
use crate::gpu::{Bindings, Gpu, Stage, bindings, compute_pipeline, sized_buffer};
use crate::shaders;

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

/// Pipelines of the passes.
#[derive(Debug)]
pub(crate) struct TreePrograms {
    boxes_layout: wgpu::BindGroupLayout,
    sort_layout: wgpu::BindGroupLayout,
    links_layout: wgpu::BindGroupLayout,
    pub(super) number: wgpu::ComputePipeline,
    pub(super) pyramid: wgpu::ComputePipeline,
    pub(super) frames: wgpu::ComputePipeline,
    pub(super) codes: wgpu::ComputePipeline,
    pub(super) count: wgpu::ComputePipeline,
    pub(super) scatter: wgpu::ComputePipeline,
    pub(super) links: [wgpu::ComputePipeline; 3],
    pub(super) words: wgpu::ComputePipeline,
    pub(super) fit: wgpu::ComputePipeline,
}

impl TreePrograms {
    pub(crate) fn new(gpu: &Gpu) -> Self {
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

/// Buffers of a forest.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub(super) items: Option<wgpu::Buffer>,
    pub(super) orders: [Option<wgpu::Buffer>; 2],
    pub(super) keys: [Option<wgpu::Buffer>; 2],
    pub(super) pyramid: Option<wgpu::Buffer>,
    pub(super) counts: Option<wgpu::Buffer>,
    pub(super) ends: Option<wgpu::Buffer>,
    pub(super) parents: Option<wgpu::Buffer>,
    pub(super) tallies: Option<wgpu::Buffer>,
    pub(super) starts: Option<wgpu::Buffer>,
}

impl Scratch {
    pub(super) fn allocate(&mut self, stage: &Stage<'_>, shape: &TreeShape, makes: bool, pyramid_boxes: u32) {
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

    pub(super) fn memory_bytes(&self) -> u64 {
        let Self { items, orders, keys, pyramid, counts, ends, parents, tallies, starts } = self;
        let all = [items, &orders[0], &orders[1], &keys[0], &keys[1], pyramid, counts, ends, parents, tallies, starts];
        all.into_iter().flatten().map(wgpu::Buffer::size).sum()
    }
}

/// Creates the bind groups of trees.
pub(super) struct ForestGroups<'a> {
    pub(super) stage: &'a Stage<'a>,
    pub(super) programs: &'a TreePrograms,
    pub(super) scratch: &'a Scratch,
    pub(super) shape: TreeShape,
    pub(super) segments: &'a wgpu::Buffer,
    pub(super) nodes: &'a wgpu::Buffer,
}

impl ForestGroups<'_> {
    /// Returns a uniform of the trees' shape for a step of a pass.
    pub(super) fn step_shape(&self, step: u32) -> wgpu::Buffer {
        self.stage.uniform("antumbra tree shape", &TreeShape { step, ..self.shape })
    }

    pub(super) fn boxes(&self, shape: &wgpu::Buffer) -> wgpu::BindGroup {
        let boxes = Boxes {
            shape,
            segments: self.segments,
            items: here(&self.scratch.items),
            order: here(&self.scratch.orders[0]),
            pyramid: here(&self.scratch.pyramid),
            keys: here(&self.scratch.keys[0]),
            nodes: self.nodes,
        };
        boxes.group(self.stage, &self.programs.boxes_layout)
    }

    /// Returns the group that sorts by a digit of the codes.
    pub(super) fn digit(&self, step: u32) -> wgpu::BindGroup {
        let (from, to) = ((step % 2) as usize, 1 - (step % 2) as usize);
        let sorted = Sorted {
            shape: &self.step_shape(step),
            segments: self.segments,
            keys_in: here(&self.scratch.keys[from]),
            order_in: here(&self.scratch.orders[from]),
            keys_out: here(&self.scratch.keys[to]),
            order_out: here(&self.scratch.orders[to]),
            counts: here(&self.scratch.counts),
        };
        sorted.group(self.stage, &self.programs.sort_layout)
    }

    pub(super) fn links(&self, shape: &wgpu::Buffer) -> wgpu::BindGroup {
        let links = Links {
            shape,
            segments: self.segments,
            keys: here(&self.scratch.keys[0]),
            ends: here(&self.scratch.ends),
            parents: here(&self.scratch.parents),
            tallies: here(&self.scratch.tallies),
            starts: here(&self.scratch.starts),
            nodes: self.nodes,
        };
        links.group(self.stage, &self.programs.links_layout)
    }
}

/// Returns a buffer that exists.
pub(super) fn here(buffer: &Option<wgpu::Buffer>) -> &wgpu::Buffer {
    buffer.as_ref().expect("prepare allocates it")
}
