//! The casters' buffers and surfaces as the passes take them.

use glam::Vec4;

use crate::contract::{MeshCaster, Opacity, SurfaceTexture};
use crate::gpu::Stage;

use super::batches::{Run, Surfaces};
use super::gpu_types::{SampleMesh, SampleSurface};
use super::group;
use super::pipelines::Layouts;

/// Group 1 of a run of triangles, and the workgroups that take a thread for each.
#[derive(Debug)]
pub(super) struct RunGroup {
    pub(super) group: wgpu::BindGroup,
    pub(super) workgroups: [u32; 2],
}

/// WebGPU's most workgroups a dimension.
const MAX_GROUPS: u32 = 65_535;

/// What a run's passes read.
pub(super) fn run_group(stage: &Stage<'_>, layouts: &Layouts, mesh: &MeshCaster<'_>, run: &Run) -> RunGroup {
    let uvs = match &mesh.opacity {
        Opacity::Masked { texture, .. } | Opacity::Tinted { texture: Some(texture), .. } => Some(texture.uvs),
        _ => None,
    };
    let mesh_of_run = SampleMesh {
        first_triangle: run.first_triangle,
        triangle_count: run.triangle_count,
        first_instance: run.first_instance,
        instance_count: run.instance_count,
        first_place: run.first_place,
        flags: run.flags,
        has_uvs: uvs.is_some().into(),
        padding: 0,
    };
    let uniform = stage.uniform("view-sample mesh", &mesh_of_run);
    // Where there are no coordinates nothing reads them.
    let uvs = uvs.unwrap_or(mesh.positions);
    let buffers = [&uniform, mesh.positions, mesh.indices, mesh.instances, uvs];
    let group = group(stage, "view-sample mesh", &layouts.mesh, &buffers.map(wgpu::Buffer::as_entire_binding));
    let groups = run.triangles().div_ceil(64);
    RunGroup { group, workgroups: [groups.min(MAX_GROUPS), groups.div_ceil(MAX_GROUPS)] }
}

/// What a batch's triangles do to light.
pub(super) fn surface_group(
    stage: &Stage<'_>,
    layouts: &Layouts,
    no_texture: &(wgpu::TextureView, wgpu::Sampler),
    meshes: &[MeshCaster<'_>],
    surfaces: Surfaces,
) -> wgpu::BindGroup {
    let (texture, surface): (Option<&SurfaceTexture<'_>>, _) = match surfaces {
        Surfaces::Opaque => (None, SampleSurface::default()),
        Surfaces::Masked(i) | Surfaces::Tinted(i) => match &meshes[i].opacity {
            Opacity::Opaque => (None, SampleSurface::default()),
            Opacity::Masked { texture, alpha_factor, cutoff } => (
                Some(texture),
                SampleSurface { factor: Vec4::splat(*alpha_factor), cutoff: *cutoff, ..SampleSurface::default() },
            ),
            Opacity::Tinted { tint, texture, texture_tints_only } => (
                texture.as_ref(),
                SampleSurface {
                    factor: *tint,
                    texture_tints_only: (*texture_tints_only).into(),
                    ..SampleSurface::default()
                },
            ),
        },
    };
    let uniform = stage.uniform("view-sample surface", &surface);
    let (view, sampler) = texture.map_or((&no_texture.0, &no_texture.1), |t| (t.view, t.sampler));
    let entries = [
        uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(view),
        wgpu::BindingResource::Sampler(sampler),
    ];
    group(stage, "view-sample surface", &layouts.surface, &entries)
}

/// A thread for each triangle of some runs.
pub(super) fn over_runs(pass: &mut wgpu::ComputePass<'_>, pipeline: &wgpu::ComputePipeline, runs: &[RunGroup]) {
    pass.set_pipeline(pipeline);
    for run in runs {
        pass.set_bind_group(1, &run.group, &[]);
        pass.dispatch_workgroups(run.workgroups[0], run.workgroups[1], 1);
    }
}
