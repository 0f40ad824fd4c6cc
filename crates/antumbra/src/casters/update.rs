//! Update of a caster set: uploads and packing of changes.

use std::ops::Range;

use super::CasterSet;
use super::pack::{PackDispatch, PackTargets};
use crate::contract::Error;
use crate::gpu::{Recorder, Span, Stage};

impl CasterSet {
    /// Uploads changes to the GPU: records uploads and packing. Call it before lights are prepared, in commands that are
    /// submitted before theirs.
    ///
    /// # Errors
    /// None at present; later versions may report errors of the device.
    pub fn update(&mut self, recorder: &mut Recorder<'_>) -> Result<(), Error> {
        if self.updated == Some(self.version) && !self.commands.are_dropped() {
            return Ok(());
        }
        let gpu = self.gpu.clone();
        if self.commands.take_dropped() {
            self.bring_all();
        }
        let stage = Stage::new(&gpu, std::mem::take(&mut self.keep), None);
        let encoder = recorder.encoder();
        self.vertices.iter_mut().for_each(|arena| arena.grow(&gpu, encoder));
        self.indices.grow(&gpu, encoder);
        self.instances.grow(&gpu, encoder);
        let mut dispatches = Vec::new();
        self.pack_meshes(&stage, encoder, &mut dispatches);
        self.upload_instances(&stage, encoder, &mut dispatches);
        let uploads;
        (self.keep, uploads) = stage.finish();
        recorder.upload(uploads, self.commands.end());
        if !dispatches.is_empty() {
            recorder.compute("pack casters", Span::Only, |pass| {
                dispatches.iter().for_each(|dispatch| dispatch.record(pass));
            });
        }
        if !std::mem::replace(&mut self.is_sorted, true) {
            self.sort();
        }
        self.updated = Some(self.version);
        Ok(())
    }

    /// Makes the next update upload everything, because the commands of an earlier one were dropped.
    fn bring_all(&mut self) {
        for mesh in self.meshes.values_mut() {
            mesh.is_changed = true;
            // Results derived from the buffers in the meantime used the old content.
            mesh.version.vertices += 1;
        }
        self.casters.values_mut().for_each(|caster| caster.is_moved = true);
        self.version += 1;
    }

    fn pack_meshes(
        &mut self,
        stage: &Stage<'_>,
        encoder: &mut wgpu::CommandEncoder,
        dispatches: &mut Vec<PackDispatch>,
    ) {
        let Some(indices) = self.indices.buffer() else { return };
        for mesh in self.meshes.values_mut().filter(|mesh| mesh.is_changed) {
            mesh.is_changed = false;
            let arena = &self.vertices[usize::from(mesh.source.has_uvs())];
            let Some(positions) = arena.buffer() else { continue };
            if mesh.source.vertex_count() == 0 || mesh.source.index_count() == 0 {
                continue;
            }
            let uvs = arena.column(1);
            // Placeholder if there are none: bound, but not written. It must not be a buffer that the same pass writes.
            let uvs = uvs.or(self.instances.buffer()).unwrap_or(positions);
            let (first_vertex, first_index) = (mesh.vertices.start, 3 * mesh.indices.start);
            let targets = PackTargets { positions, uvs, indices, first_vertex, first_index };
            dispatches.push(self.packer.mesh(stage, encoder, &mesh.source, &targets));
        }
    }

    /// Uploads matrices known on the CPU, merging adjacent ranges, and packs the others.
    fn upload_instances(
        &mut self,
        stage: &Stage<'_>,
        encoder: &mut wgpu::CommandEncoder,
        dispatches: &mut Vec<PackDispatch>,
    ) {
        let Some(instances) = self.instances.buffer() else { return };
        let mut known: Vec<Range<u32>> = Vec::new();
        for caster in self.casters.values_mut().filter(|caster| caster.is_moved) {
            caster.is_moved = false;
            match &caster.source {
                None => known.push(caster.places.clone()),
                Some(source) if source.count() > 0 => {
                    let first = caster.places.start;
                    dispatches.push(self.packer.instances(stage, encoder, source, instances, first));
                }
                Some(_) => {}
            }
        }
        known.sort_unstable_by_key(|places| places.start);
        for run in known.chunk_by(|a, b| a.end == b.start) {
            let (Some(first), Some(last)) = (run.first(), run.last()) else { continue };
            let matrices = &self.matrices[first.start as usize..last.end as usize];
            stage.upload(instances, u64::from(first.start) * 64, bytemuck::cast_slice(matrices));
        }
    }

    /// Sorts casters by vertex buffer, then by mesh, then by place, so that passes rarely change buffers.
    fn sort(&mut self) {
        let Self { order, casters, meshes, .. } = self;
        order.clear();
        order.extend(casters.keys());
        order.sort_unstable_by_key(|id| {
            let caster = &casters[*id];
            let mesh = &meshes[caster.mesh];
            (mesh.source.has_uvs(), mesh.vertices.start, caster.places.start)
        });
    }
}
