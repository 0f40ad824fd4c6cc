//! Bind groups of the casters' buffers and surfaces.

use crate::contract::{MeshCaster, SurfaceTexture};
use crate::gpu::{Bindings, Stage, dispatch_threads};
use crate::light_map::caster_surface::SurfaceValues;
use crate::light_map::caster_triangles::runs::{MAX_RUNS, RunBindings, TriangleRun, anchor_uniform, upload_runs};

use super::batches::{Run, Surfaces};
use super::gpu_types::SampleSurface;
use super::groups::{Layouts, Meshes, Surface};

/// Group 1 of some runs of triangles, and their number of triangles.
#[derive(Debug)]
pub(super) struct RunGroup {
    pub(super) group: wgpu::BindGroup,
    pub(super) triangles: u32,
}

/// Creates the bind groups of a frame's casters.
#[derive(Clone, Copy, Debug)]
pub(super) struct CasterGroups<'a> {
    pub(super) stage: &'a Stage<'a>,
    pub(super) layouts: &'a Layouts,
    pub(super) meshes: &'a [MeshCaster<'a>],
    /// Placeholder for the texture of untextured surfaces.
    pub(super) no_texture: &'a (wgpu::TextureView, wgpu::Sampler),
}

impl CasterGroups<'_> {
    /// Returns the groups of the passes over some runs: one for all runs in the same buffers.
    pub(super) fn runs<'r>(&self, runs: impl IntoIterator<Item = &'r Run>) -> Vec<RunGroup> {
        let runs: Vec<&Run> = runs.into_iter().collect();
        runs.chunk_by(|a, b| buffers_of(&self.meshes[a.caster]) == buffers_of(&self.meshes[b.caster]))
            .flat_map(|of_buffers| of_buffers.chunks(MAX_RUNS))
            .map(|runs| self.of_same_buffers(runs))
            .collect()
    }

    fn of_same_buffers(&self, runs: &[&Run]) -> RunGroup {
        let Self { stage, layouts, meshes, .. } = *self;
        let (mesh_positions, mesh_indices, mesh_instances, uvs) = buffers_of(&meshes[runs[0].caster]);
        let of_table = |run: &&Run| {
            let of_table = TriangleRun {
                first_triangle: meshes[run.caster].first_triangle + run.first_triangle,
                triangle_count: run.triangle_count,
                first_instance: run.first_instance,
                first_place: run.first_place,
                flags: run.flags,
                has_uvs: uvs.is_some().into(),
                ..TriangleRun::default()
            };
            (of_table, run.triangles())
        };
        let (table, triangles) = upload_runs(stage, runs.iter().map(of_table));
        // A placeholder that no shader reads.
        let mesh_uvs = uvs.unwrap_or(mesh_positions);
        let anchor_in_world = &anchor_uniform(stage);
        let runs = RunBindings { runs: &table, mesh_positions, mesh_indices, mesh_instances, anchor_in_world };
        RunGroup { group: Meshes { runs, mesh_uvs }.group(stage, &layouts.mesh), triangles }
    }

    /// Returns the group of a batch's surface.
    pub(super) fn surface(&self, surfaces: Surfaces) -> wgpu::BindGroup {
        let Self { stage, layouts, meshes, no_texture } = *self;
        let opacity = match surfaces {
            Surfaces::Opaque => None,
            Surfaces::Masked(i) | Surfaces::Tinted(i) => Some(&meshes[i].opacity),
        };
        let values = opacity.and_then(SurfaceValues::of);
        let surface = values.map_or_else(SampleSurface::default, |SurfaceValues { factor, cutoff, coverage }| {
            SampleSurface { factor, cutoff, coverage, ..SampleSurface::default() }
        });
        let texture: Option<&SurfaceTexture<'_>> = opacity.and_then(|opacity| opacity.texture());
        let uniform = stage.uniform("view-sample surface", &surface);
        let (surface_texture, surface_sampler) =
            texture.map_or((&no_texture.0, &no_texture.1), |texture| (texture.view, texture.sampler));
        Surface { surface: &uniform, surface_texture, surface_sampler }.group(stage, &layouts.surface)
    }
}

/// Returns positions, indices, instances and, if there are any, texture coordinates.
fn buffers_of<'a>(
    mesh: &MeshCaster<'a>,
) -> (&'a wgpu::Buffer, &'a wgpu::Buffer, &'a wgpu::Buffer, Option<&'a wgpu::Buffer>) {
    (mesh.positions, mesh.indices, mesh.instances, mesh.opacity.texture().map(|texture| texture.uvs))
}

/// Dispatches a thread per triangle of some runs.
pub(super) fn over_runs(pass: &mut wgpu::ComputePass<'_>, pipeline: &wgpu::ComputePipeline, runs: &[RunGroup]) {
    pass.set_pipeline(pipeline);
    for run in runs {
        pass.set_bind_group(1, &run.group, &[]);
        dispatch_threads(pass, run.triangles);
    }
}
