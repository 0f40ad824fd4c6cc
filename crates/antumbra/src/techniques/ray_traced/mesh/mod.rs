//! Bottom level: a tree over each mesh's triangles in object space, kept from frame to frame.
//!
//! A mesh's triangles are copied in the tree's order, so that a leaf's are adjacent and one pass reads meshes of any buffers. A triangle
//! takes 48 bytes (64 with texture coordinates) and 16 of nodes: less than twice the 36 of its corners.
//!
//! A mesh with a [`version`](MeshCaster::version) is built once, and refitted where its vertices changed. A mesh without one is refitted in
//! each frame: correct after any change, but with the hierarchy of its first frame.

use std::collections::HashSet;

use super::gpu_types::{Segment, SourceRange};
use super::tree::{Forest, Level, TreePrograms};
use crate::contract::{Error, MeshCaster};
use crate::gpu::{
    Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, dispatch_threads, shared_constants,
};
use crate::shaders;

mod kept;

pub(super) use kept::MeshPlace;
use kept::{KeptMeshes, MeshKey, Outdated, UsedMesh};

bindings! {
    struct Kept = "kept triangles", COMPUTE, group 0 of [MESH_GATHER, MESH_PLACE, MESH_RECALL] {
        0 shape: Uniform,
        1 segments: Storage,
        2 items: ReadWrite,
        3 order: ReadWrite,
        4 triangles: ReadWrite,
    }

    struct Source = "mesh source", COMPUTE, group 1 of [MESH_GATHER, MESH_PLACE] {
        0 source_range: Uniform,
        1 mesh_positions: Storage,
        2 mesh_indices: Storage,
        3 mesh_uvs: Storage,
    }
}

shared_constants! {
    /// Largest position that a leaf can encode.
    const FIRST_MASK: u32 = 0x1ff_ffff, as in RAY_TRACED_TRACE;
}

/// Pipelines of the passes over meshes.
#[derive(Debug)]
struct Programs {
    kept_layout: wgpu::BindGroupLayout,
    source_layout: wgpu::BindGroupLayout,
    gather: wgpu::ComputePipeline,
    place: wgpu::ComputePipeline,
    recall: wgpu::ComputePipeline,
}

/// Trees of meshes.
#[derive(Debug)]
pub(super) struct Meshes {
    programs: Programs,
    kept: KeptMeshes,
    made: Option<Work>,
    fitted: Option<Work>,
}

/// Trees that are built, or refitted, in a frame.
#[derive(Debug)]
struct Work {
    forest: Forest,
    kept: wgpu::BindGroup,
    sources: Vec<(wgpu::BindGroup, u32)>,
}

impl Meshes {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let (kept, source) = (Kept::layout(gpu), Source::layout(gpu));
        let program = |wgsl, layouts: &[&wgpu::BindGroupLayout]| compute_pipeline(gpu, "kept triangles", wgsl, layouts);
        Self {
            programs: Programs {
                gather: program(shaders::MESH_GATHER, &[&kept, &source]),
                place: program(shaders::MESH_PLACE, &[&kept, &source]),
                recall: program(shaders::MESH_RECALL, &[&kept]),
                kept_layout: kept,
                source_layout: source,
            },
            kept: KeptMeshes::new(),
            made: None,
            fitted: None,
        }
    }

    /// Prepares the meshes of casters with at least one triangle each. Returns the position of each caster's mesh.
    #[expect(clippy::mutable_key_type, reason = "a buffer is hashed by which one it is, and that never changes")]
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        trees: &TreePrograms,
        technique: &'static str,
        casters: &[&MeshCaster<'_>],
    ) -> Result<Vec<MeshPlace>, Error> {
        let keys: Vec<MeshKey> = casters.iter().map(|caster| MeshKey::of(caster)).collect();
        let mut used: Vec<UsedMesh<'_, '_>> = Vec::new();
        let mut is_asked = HashSet::new();
        for (key, caster) in keys.iter().zip(casters) {
            if is_asked.insert(key) {
                used.push(UsedMesh { key: key.clone(), caster });
            }
        }
        let Outdated { to_build, to_fit } = self.kept.keep(stage, technique, &used)?;
        self.made = self.work(stage, trees, true, &to_build);
        self.fitted = self.work(stage, trees, false, &to_fit);
        Ok(keys.iter().map(|key| self.kept.place(key)).collect())
    }

    fn work(
        &mut self,
        stage: &Stage<'_>,
        trees: &TreePrograms,
        makes: bool,
        meshes: &[&UsedMesh<'_, '_>],
    ) -> Option<Work> {
        let before = if makes { self.made.take() } else { self.fitted.take() };
        if meshes.is_empty() {
            return None;
        }
        let mut forest = before.map_or_else(|| Forest::new(stage), |work| work.forest);
        let segment = |mesh: &&UsedMesh<'_, '_>| {
            let place = self.kept.place(&mesh.key);
            Segment {
                item_count: mesh.triangle_count(),
                first_node: place.first_node,
                first_triangle: place.first_triangle,
                triangle_stride: place.triangle_stride,
                source_triangle: mesh.caster.first_triangle,
                ..Segment::default()
            }
        };
        let mut segments: Vec<Segment> = meshes.iter().map(segment).collect();
        forest.prepare(stage, trees, Level::Triangles, makes, &mut segments, self.nodes());
        let (shape, table) = forest.shape();
        let kept =
            Kept { shape, segments: table, items: forest.items(), order: forest.order(), triangles: self.triangles() };
        let kept = kept.group(stage, &self.programs.kept_layout);
        let mut sources = Vec::new();
        let mut first_item = 0;
        for meshes in meshes.chunk_by(|a, b| buffers_of(a.caster) == buffers_of(b.caster)) {
            let count: u32 = meshes.iter().map(|mesh| mesh.triangle_count()).sum();
            let range = SourceRange { first_item, end_item: first_item + count, ..SourceRange::default() };
            let (mesh_positions, mesh_indices, uvs) = buffers_of(meshes[0].caster);
            let source = Source {
                source_range: &stage.uniform("antumbra mesh source", &range),
                mesh_positions,
                mesh_indices,
                // A placeholder that no shader reads.
                mesh_uvs: uvs.unwrap_or(mesh_positions),
            };
            sources.push((source.group(stage, &self.programs.source_layout), count));
            first_item += count;
        }
        Some(Work { forest, kept, sources })
    }

    /// Records the builds and refits.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, trees: &TreePrograms) {
        let Programs { gather, place, recall, .. } = &self.programs;
        if let Some(work) = &self.made {
            work.forest.clear(recorder);
            recorder.compute("make mesh trees", Span::Only, |pass| {
                work.over_sources(pass, gather);
                work.forest.sort(pass, trees);
                work.over_sources(pass, place);
                work.forest.link(pass, trees);
                work.forest.fit(pass, trees);
            });
        }
        if let Some(work) = &self.fitted {
            recorder.compute("fit mesh trees", Span::Only, |pass| {
                pass.set_pipeline(recall);
                pass.set_bind_group(0, &work.kept, &[]);
                dispatch_threads(pass, work.forest.item_count());
                work.over_sources(pass, gather);
                work.over_sources(pass, place);
                work.forest.fit(pass, trees);
            });
        }
    }

    /// `array<vec4u>`: see `tree/nodes.wesl`.
    pub(super) fn nodes(&self) -> &wgpu::Buffer {
        self.kept.nodes.buffer()
    }

    /// `array<vec4u>`: see `mesh/source.wesl`.
    pub(super) fn triangles(&self) -> &wgpu::Buffer {
        self.kept.triangles.buffer()
    }

    /// Whether no tree was built or refitted in the last frame.
    #[cfg(test)]
    pub(super) fn is_idle(&self) -> bool {
        self.made.is_none() && self.fitted.is_none()
    }

    /// Size of the trees without the buffers for building them, bytes.
    pub(super) fn kept_bytes(&self) -> u64 {
        self.kept.bytes()
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        let work = [&self.made, &self.fitted].into_iter().flatten().map(|work| work.forest.memory_bytes()).sum::<u64>();
        self.kept_bytes() + work
    }
}

impl Work {
    fn over_sources(&self, pass: &mut wgpu::ComputePass<'_>, program: &wgpu::ComputePipeline) {
        pass.set_pipeline(program);
        pass.set_bind_group(0, &self.kept, &[]);
        for (group, triangles) in &self.sources {
            pass.set_bind_group(1, group, &[]);
            dispatch_threads(pass, *triangles);
        }
    }
}

/// Returns positions, indices and, for textured casters, texture coordinates.
fn buffers_of<'a>(mesh: &MeshCaster<'a>) -> (&'a wgpu::Buffer, &'a wgpu::Buffer, Option<&'a wgpu::Buffer>) {
    (mesh.positions, mesh.indices, mesh.opacity.texture().map(|texture| texture.uvs))
}
