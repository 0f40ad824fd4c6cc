//! Top level: a tree over the instances of a frame, rebuilt in each frame in which casters may have moved.

use super::gpu_types::{INSTANCE_VECTORS, InstanceRange, InstanceRun, Segment};
use super::mesh::MeshPlace;
use super::tree::{FRAME_VECTORS, Forest, Level, TreePrograms};
use crate::contract::{Error, MeshCaster};
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, dispatch_threads, sized_buffer};
use crate::shaders;

bindings! {
    struct Listed = "instances", COMPUTE, group 0 of [TOP_INSTANCES] {
        0 instance_runs: Storage,
        1 nodes: Storage,
        2 items: ReadWrite,
        3 instances: ReadWrite,
    }

    struct Source = "instance source", COMPUTE, group 1 of [TOP_INSTANCES] {
        0 instance_range: Uniform,
        1 mesh_instances: Storage,
    }
}

/// Instances, and the tree over them.
#[derive(Debug)]
pub(super) struct Top {
    listed_layout: wgpu::BindGroupLayout,
    source_layout: wgpu::BindGroupLayout,
    program: wgpu::ComputePipeline,
    forest: Forest,
    instances: Option<wgpu::Buffer>,
    nodes: Option<wgpu::Buffer>,
    prepared: Option<Prepared>,
}

#[derive(Debug)]
struct Prepared {
    count: u32,
    /// Bind group of the list; `None` if there are no instances.
    listed: Option<wgpu::BindGroup>,
    sources: Vec<(wgpu::BindGroup, u32)>,
}

impl Top {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let (listed, source) = (Listed::layout(gpu), Source::layout(gpu));
        Self {
            program: compute_pipeline(gpu, "instances", shaders::TOP_INSTANCES, &[&listed, &source]),
            listed_layout: listed,
            source_layout: source,
            forest: Forest::new(gpu),
            instances: None,
            nodes: None,
            prepared: None,
        }
    }

    /// Prepares the instances of casters, whose meshes are at `places` in `mesh_nodes`.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        trees: &TreePrograms,
        technique: &'static str,
        casters: &[&MeshCaster<'_>],
        places: &[MeshPlace],
        mesh_nodes: &wgpu::Buffer,
    ) -> Result<(), Error> {
        let count: u64 = casters.iter().map(|caster| u64::from(caster.instance_count)).sum();
        let max_bytes = stage.device.limits().max_storage_buffer_binding_size;
        let needed = 16 * u64::from(INSTANCE_VECTORS) * count;
        if needed > max_bytes {
            return Err(Error::Unsupported {
                technique,
                needed: format!("{needed} bytes for {count} instances"),
                had: format!("at most {max_bytes} bytes per binding"),
                remedy: "use fewer instances, or request a larger max_storage_buffer_binding_size",
            });
        }
        let count = count as u32;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let vectors = |slot, label, count: u32| {
            sized_buffer(stage, slot, label, 16 * u64::from(count.max(1)), usage);
        };
        vectors(&mut self.instances, "antumbra instances", INSTANCE_VECTORS * count);
        vectors(&mut self.nodes, "antumbra instance nodes", FRAME_VECTORS + 4 * count);
        if count == 0 {
            self.prepared = Some(Prepared { count, listed: None, sources: Vec::new() });
            return Ok(());
        }
        let (instances, nodes) = (here(&self.instances), here(&self.nodes));
        let mut segments = [Segment { item_count: count, ..Segment::default() }];
        self.forest.prepare(stage, trees, Level::Instances, true, &mut segments, nodes);
        let runs = stage.storage("antumbra instance runs", &runs_of(casters, places));
        let listed = Listed { instance_runs: &runs, nodes: mesh_nodes, items: self.forest.items(), instances };
        let sources = self.sources(stage, casters);
        self.prepared = Some(Prepared { count, listed: Some(listed.group(stage, &self.listed_layout)), sources });
        Ok(())
    }

    /// Returns a dispatch for each run of casters whose instances are in the same buffer.
    fn sources(&self, stage: &Stage<'_>, casters: &[&MeshCaster<'_>]) -> Vec<(wgpu::BindGroup, u32)> {
        let mut first_item = 0;
        let of_buffer = casters.chunk_by(|a, b| a.instances == b.instances);
        of_buffer
            .map(|of_buffer| {
                let count: u32 = of_buffer.iter().map(|caster| caster.instance_count).sum();
                let range = InstanceRange {
                    anchor_in_world: stage.anchor(),
                    first_item,
                    end_item: first_item + count,
                    run_count: casters.len() as u32,
                    ..InstanceRange::default()
                };
                first_item += count;
                let instance_range = &stage.uniform("antumbra instance source", &range);
                let source = Source { instance_range, mesh_instances: of_buffer[0].instances };
                (source.group(stage, &self.source_layout), count)
            })
            .collect()
    }

    /// Lists the instances and builds the tree.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, trees: &TreePrograms) {
        let Some(Prepared { listed: Some(listed), sources, .. }) = &self.prepared else { return };
        self.forest.clear(recorder);
        recorder.compute("make instance tree", Span::Only, |pass| {
            pass.set_pipeline(&self.program);
            pass.set_bind_group(0, listed, &[]);
            for (group, count) in sources {
                pass.set_bind_group(1, group, &[]);
                dispatch_threads(pass, *count);
            }
            self.forest.sort(pass, trees);
            self.forest.link(pass, trees);
            self.forest.fit(pass, trees);
        });
    }

    pub(super) fn count(&self) -> u32 {
        self.prepared.as_ref().map_or(0, |prepared| prepared.count)
    }

    /// `array<vec4u>`: see `top/instance.wesl`.
    pub(super) fn instances(&self) -> &wgpu::Buffer {
        here(&self.instances)
    }

    /// `array<vec4u>`: the box of all, then nodes of two vectors each.
    pub(super) fn nodes(&self) -> &wgpu::Buffer {
        here(&self.nodes)
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        let own: u64 = [&self.instances, &self.nodes].into_iter().flatten().map(wgpu::Buffer::size).sum();
        own + self.forest.memory_bytes()
    }
}

fn runs_of(casters: &[&MeshCaster<'_>], places: &[MeshPlace]) -> Vec<InstanceRun> {
    let mut first_item = 0;
    let run = |(caster, (mesh, place)): (u32, (&&MeshCaster<'_>, &MeshPlace))| {
        let run = InstanceRun { first_item, first_instance: mesh.first_instance, caster, first_node: place.first_node };
        first_item += mesh.instance_count;
        run
    };
    (0..).zip(casters.iter().zip(places)).map(run).collect()
}

fn here(buffer: &Option<wgpu::Buffer>) -> &wgpu::Buffer {
    buffer.as_ref().expect("prepare allocates it")
}
