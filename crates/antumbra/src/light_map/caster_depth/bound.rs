//! Buffers and pipeline that a pass has bound for its draws.

/// State bound in a render pass; binds of unchanged state are skipped.
#[derive(Default)]
pub(crate) struct Bound<'a> {
    pipeline: Option<&'a wgpu::RenderPipeline>,
    vertices: [Option<&'a wgpu::Buffer>; 3],
    indices: Option<&'a wgpu::Buffer>,
}

impl<'a> Bound<'a> {
    pub(crate) fn pipeline(&mut self, pass: &mut wgpu::RenderPass<'_>, pipeline: &'a wgpu::RenderPipeline) {
        if self.pipeline.replace(pipeline) != Some(pipeline) {
            pass.set_pipeline(pipeline);
        }
    }

    pub(crate) fn vertices(&mut self, pass: &mut wgpu::RenderPass<'_>, slot: usize, buffer: &'a wgpu::Buffer) {
        if self.vertices[slot].replace(buffer) != Some(buffer) {
            pass.set_vertex_buffer(slot as u32, buffer.slice(..));
        }
    }

    /// Binds an index buffer of 32-bit indices.
    pub(crate) fn indices(&mut self, pass: &mut wgpu::RenderPass<'_>, buffer: &'a wgpu::Buffer) {
        if self.indices.replace(buffer) != Some(buffer) {
            pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
        }
    }
}
