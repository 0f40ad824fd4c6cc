//! The pass that sorts lists, or packs linked ones.

use glam::UVec2;

use super::gpu_types::{ListSort, Sorted};
use super::options::{Accumulation, Gather, ListOptions};
use super::storage::Storage;
use crate::gpu::{Bindings, Cached, Gpu, Recorder, Span, Stage, compute_entry, create_uniform, write_uniform};
use crate::shaders;

/// Threads along each side of a workgroup.
const TILE: u32 = 8;

/// Pipeline key of the sort pass: unused features are compiled out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SortDesign {
    gather: Gather,
    colored: bool,
    accumulation: Accumulation,
    joins: bool,
}

impl SortDesign {
    fn of(options: &ListOptions) -> Self {
        let ListOptions { gather, colored, accumulation, .. } = *options;
        Self { gather, colored, accumulation, joins: options.join.is_some() }
    }

    fn compiled(self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
        let entry = match self.gather {
            Gather::Arrays => "sort_lists",
            Gather::Linked => "pack_lists",
        };
        let constants = [
            ("COLORED", f64::from(u8::from(self.colored))),
            ("ACCUMULATION", f64::from(self.accumulation as u32)),
            ("JOINS", f64::from(u8::from(self.joins))),
        ];
        compute_entry(gpu, entry, shaders::TEXEL_LISTS_SORT, Some(entry), &constants, &[layout])
    }
}

/// Pipelines that sort lists.
#[derive(Debug)]
pub(super) struct ListSorter {
    layout: wgpu::BindGroupLayout,
    pipelines: Cached<SortDesign, wgpu::ComputePipeline>,
    uniform: wgpu::Buffer,
}

/// Sort pass of one frame.
#[derive(Debug)]
pub(super) struct PreparedSort {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: UVec2,
}

impl ListSorter {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            layout: Sorted::layout(gpu),
            pipelines: Cached::default(),
            uniform: create_uniform::<ListSort>(gpu, "antumbra list sort"),
        }
    }

    pub(super) fn prepare(&mut self, stage: &Stage<'_>, storage: &Storage) -> PreparedSort {
        let Storage { options, cursors, fragments, lists, counters, nodes, links, .. } = storage;
        write_uniform(stage, &self.uniform, &list_sort(options));
        let design = SortDesign::of(options);
        let pipeline = self.pipelines.get_or_make(design, || design.compiled(stage, &self.layout)).clone();
        let sorted = Sorted { list_sort: &self.uniform, cursors, fragments, lists, counters, nodes, links };
        let workgroups = options.map_size.map(|texels| texels.div_ceil(TILE));
        PreparedSort { pipeline, group: sorted.group(stage, &self.layout), workgroups }
    }
}

impl PreparedSort {
    pub(super) fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("sort", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups(self.workgroups.x, self.workgroups.y, 1);
        });
    }
}

fn list_sort(options: &ListOptions) -> ListSort {
    let join = options.join.unwrap_or_default();
    ListSort {
        map_size: options.map_size,
        capacity: options.capacity,
        layers: options.layers,
        join_slope: join.slope,
        join_m: join.m,
        adjoin_slope: options.adjoin.slope,
        adjoin_m: options.adjoin.m,
    }
}
