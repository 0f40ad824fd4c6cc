//! World-space array of all casters' triangles, each with its neighbours across its edges; and maps whose texels store the
//! id of the triangle that they show ([`maps`]). Segments can then be tested exactly against that triangle and its
//! neighbours (`walk.wesl`), whereas depth alone allows only a guess about what lies between texels.
//!
//! Triangles are neighbours if an edge's ends agree to the bit, even across meshes: edges are stored in a hash table by
//! their ends, and the entries of a slot are compared. A triangle takes 48 bytes, and its edges 24 to 36. Casters count as
//! opaque, since triangles do not describe a surface's holes.

use crate::contract::{Error, MeshCaster};
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, dispatch_threads, sized_buffer};
use crate::shaders;

pub(crate) mod maps;
pub(crate) mod runs;
#[cfg(test)]
mod tests;

bindings! {
    struct Gathered = "caster triangles", COMPUTE, group 0 of [CASTER_TRIANGLES_GATHER, CASTER_TRIANGLES_JOIN] {
        0 triangle_words: ReadWrite,
        1 slots: ReadWrite,
        2 links: ReadWrite,
    }
}

use runs::{MAX_RUNS, RunBindings, TriangleRun, anchor_uniform, upload_runs};

/// Bytes of a triangle: corners and neighbours.
const TRIANGLE_BYTES: u64 = 48;

/// World-space triangles of the casters.
#[derive(Debug)]
pub(crate) struct CasterTriangles {
    layout: wgpu::BindGroupLayout,
    run_layout: wgpu::BindGroupLayout,
    gather: wgpu::ComputePipeline,
    join: wgpu::ComputePipeline,
    buffers: Buffers,
    group: Option<wgpu::BindGroup>,
    runs: Vec<Run>,
    /// Capacity of the buffers, triangles.
    room: u64,
}

#[derive(Debug, Default)]
struct Buffers {
    triangles: Option<wgpu::Buffer>,
    slots: Option<wgpu::Buffer>,
    links: Option<wgpu::Buffer>,
}

/// Triangles of casters that share their buffers.
#[derive(Debug)]
struct Run {
    count: u32,
    group: wgpu::BindGroup,
}

/// Smallest capacity, triangles.
const MIN_ROOM: u64 = 2048;

impl CasterTriangles {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let (all, run) = (Gathered::layout(gpu), RunBindings::layout(gpu));
        let pipeline = |label, wgsl| compute_pipeline(gpu, label, wgsl, &[&all, &run]);
        Self {
            gather: pipeline("caster triangles", shaders::CASTER_TRIANGLES_GATHER),
            join: pipeline("caster triangles' neighbours", shaders::CASTER_TRIANGLES_JOIN),
            layout: all,
            run_layout: run,
            buffers: Buffers::default(),
            group: None,
            runs: Vec::new(),
            room: 0,
        }
    }

    /// Allocates buffers for the casters' triangles. The casters' own must be [readable](crate::light_map::readable_meshes).
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        technique: &'static str,
        casters: &[MeshCaster<'_>],
        remedy: &'static str,
    ) -> Result<(), Error> {
        let count_of = |caster: &MeshCaster<'_>| u64::from(caster.index_count / 3) * u64::from(caster.instance_count);
        let count: u64 = casters.iter().map(count_of).sum();
        let max_bytes = stage.device.limits().max_storage_buffer_binding_size;
        if count * TRIANGLE_BYTES > max_bytes {
            return Err(Error::Unsupported {
                technique,
                needed: format!("a buffer with {TRIANGLE_BYTES} bytes for each of {count} triangles"),
                had: format!("at most {max_bytes} bytes per binding"),
                remedy,
            });
        }
        let meshes: Vec<&MeshCaster<'_>> = casters.iter().filter(|mesh| count_of(mesh) > 0).collect();
        let mut first = 0;
        self.runs.clear();
        let of_buffers = meshes.chunk_by(|a, b| buffers_of(a) == buffers_of(b));
        for meshes in of_buffers.flat_map(|meshes| meshes.chunks(MAX_RUNS)) {
            let run = self.run(stage, meshes, first);
            first += run.count;
            self.runs.push(run);
        }
        // Spare room, so that casters that enter and leave the light's reach allocate nothing; and no binding may be empty.
        if count > self.room || 4 * count.max(MIN_ROOM) < self.room {
            self.room = (count + count / 2).next_power_of_two().max(MIN_ROOM);
        }
        let room = self.room.min(max_bytes / TRIANGLE_BYTES).max(1);
        let buffer = |slot: &mut Option<wgpu::Buffer>, label, bytes| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            sized_buffer(stage, slot, label, bytes, usage).clone()
        };
        let gathered = Gathered {
            triangle_words: &buffer(&mut self.buffers.triangles, "antumbra caster triangles", TRIANGLE_BYTES * room),
            slots: &buffer(&mut self.buffers.slots, "antumbra edge slots", 4 * (3 * room).next_power_of_two()),
            links: &buffer(&mut self.buffers.links, "antumbra edge links", 12 * room),
        };
        self.group = Some(gathered.group(stage, &self.layout));
        Ok(())
    }

    fn run(&self, stage: &Stage<'_>, meshes: &[&MeshCaster<'_>], mut first_place: u32) -> Run {
        let run = |mesh: &&MeshCaster<'_>| {
            let triangles = mesh.index_count / 3 * mesh.instance_count;
            let run = TriangleRun {
                first_triangle: mesh.first_triangle,
                triangle_count: mesh.index_count / 3,
                first_instance: mesh.first_instance,
                first_place,
                ..TriangleRun::default()
            };
            first_place += triangles;
            (run, triangles)
        };
        let (runs, count) = upload_runs(stage, meshes.iter().map(run));
        let [mesh_positions, mesh_indices, mesh_instances] = buffers_of(meshes[0]);
        let anchor_in_world = &anchor_uniform(stage);
        let bindings = RunBindings { runs: &runs, mesh_positions, mesh_indices, mesh_instances, anchor_in_world };
        Run { count, group: bindings.group(stage, &self.run_layout) }
    }

    /// Number of triangles.
    pub(crate) fn count(&self) -> u32 {
        self.runs.iter().map(|run| run.count).sum()
    }

    /// `array<vec4u>`, three for each triangle; see `triangles.wesl`.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        self.buffers.triangles.as_ref().expect("prepare comes before use")
    }

    /// Gathers the triangles and finds their neighbours.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, label: &'static str) {
        let (Some(group), Some(slots)) = (&self.group, &self.buffers.slots) else { return };
        recorder.clear_buffer(slots);
        recorder.compute(label, Span::Only, |pass| {
            pass.set_bind_group(0, group, &[]);
            for pipeline in [&self.gather, &self.join] {
                pass.set_pipeline(pipeline);
                for run in &self.runs {
                    pass.set_bind_group(1, &run.group, &[]);
                    dispatch_threads(pass, run.count);
                }
            }
        });
    }

    pub(crate) fn memory_bytes(&self) -> u64 {
        let Buffers { triangles, slots, links } = &self.buffers;
        [triangles, slots, links].into_iter().flatten().map(wgpu::Buffer::size).sum()
    }
}

/// Buffers of positions, indices and instances.
fn buffers_of<'a>(mesh: &MeshCaster<'a>) -> [&'a wgpu::Buffer; 3] {
    [mesh.positions, mesh.indices, mesh.instances]
}
