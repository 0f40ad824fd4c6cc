//! Runs of casters' triangles, one thread of a dispatch per triangle; the shader side is `runs.wesl`.

use crate::gpu::{Stage, bindings, gpu_structs};

gpu_structs! {
    /// Run of a mesh's triangles, for each of some instances; `runs.wesl` documents the fields.
    pub(crate) struct TriangleRun {
        first_thread: u32,
        thread_count: u32,
        first_triangle: u32,
        triangle_count: u32,
        first_instance: u32,
        first_place: u32,
        /// Flags of the technique.
        flags: u32,
        has_uvs: u32,
    }
}

bindings! {
    /// Bindings shared by the runs of a dispatch.
    pub(crate) struct RunBindings = "triangle runs", COMPUTE,
        group 1 of [CASTER_TRIANGLES_GATHER, CASTER_TRIANGLES_JOIN]
    {
        0 runs: Uniform,
        1 mesh_positions: Storage,
        2 mesh_indices: Storage,
        3 mesh_instances: Storage,
        4 anchor_in_world: Uniform,
    }
}

/// Uniform with the frame's anchor, for the runs.
pub(crate) fn anchor_uniform(stage: &Stage<'_>) -> wgpu::Buffer {
    stage.uniform("antumbra anchor", &stage.anchor().extend(0.0))
}

/// Largest number of runs per dispatch: `MAX_RUNS` of `runs.wesl`.
pub(crate) const MAX_RUNS: usize = 512;

/// Uploads at most [`MAX_RUNS`] runs, each with its triangle count; also returns the total count.
pub(crate) fn upload_runs(
    stage: &Stage<'_>,
    runs: impl IntoIterator<Item = (TriangleRun, u32)>,
) -> (wgpu::Buffer, u32) {
    let mut thread_count = 0;
    let mut table: Vec<TriangleRun> = (runs.into_iter())
        .map(|(run, triangles)| {
            let run = TriangleRun { first_thread: thread_count, ..run };
            thread_count += triangles;
            run
        })
        .collect();
    table.iter_mut().for_each(|run| run.thread_count = thread_count);
    table.resize(MAX_RUNS, TriangleRun { first_thread: u32::MAX, ..TriangleRun::default() });
    (stage.uniform_array("antumbra triangle runs", &table), thread_count)
}
