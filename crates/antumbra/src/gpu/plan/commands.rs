//! Commands of a planned device, which do nothing: encoders, passes and bundles.

use std::ops::Range;

use wgpu::custom::{
    CommandEncoderInterface, ComputePassInterface, DispatchBindGroup, DispatchBuffer, DispatchCommandBuffer,
    DispatchComputePass, DispatchComputePipeline, DispatchQuerySet, DispatchRenderBundle, DispatchRenderPass,
    DispatchRenderPipeline, DispatchTexture, DispatchTextureView, RenderBundleEncoderInterface, RenderPassInterface,
};
use wgpu::wgt::{BufferTransition, TextureTransition};
use wgpu::{BufferAddress, DynamicOffset};

use super::objects::Planned;

/// Command encoder or render bundle encoder.
#[derive(Debug)]
pub(super) struct PlannedCommands;

/// Compute or render pass.
#[derive(Debug)]
struct PlannedPass;

/// Required by the interfaces of passes.
impl Drop for PlannedPass {
    fn drop(&mut self) {}
}

impl CommandEncoderInterface for PlannedCommands {
    fn copy_buffer_to_buffer(
        &self,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: Option<BufferAddress>,
    ) {
    }
    fn copy_buffer_to_texture(
        &self,
        _: wgpu::TexelCopyBufferInfo<'_>,
        _: wgpu::TexelCopyTextureInfo<'_>,
        _: wgpu::Extent3d,
    ) {
    }
    fn copy_texture_to_buffer(
        &self,
        _: wgpu::TexelCopyTextureInfo<'_>,
        _: wgpu::TexelCopyBufferInfo<'_>,
        _: wgpu::Extent3d,
    ) {
    }
    fn copy_texture_to_texture(
        &self,
        _: wgpu::TexelCopyTextureInfo<'_>,
        _: wgpu::TexelCopyTextureInfo<'_>,
        _: wgpu::Extent3d,
    ) {
    }
    fn begin_compute_pass(&self, _: &wgpu::ComputePassDescriptor<'_>) -> DispatchComputePass {
        DispatchComputePass::custom(PlannedPass)
    }
    fn begin_render_pass(&self, _: &wgpu::RenderPassDescriptor<'_>) -> DispatchRenderPass {
        DispatchRenderPass::custom(PlannedPass)
    }
    fn finish(&mut self) -> DispatchCommandBuffer {
        DispatchCommandBuffer::custom(Planned)
    }
    fn clear_texture(&self, _: &DispatchTexture, _: &wgpu::ImageSubresourceRange) {}
    fn clear_buffer(&self, _: &DispatchBuffer, _: BufferAddress, _: Option<BufferAddress>) {}
    fn insert_debug_marker(&self, _: &str) {}
    fn push_debug_group(&self, _: &str) {}
    fn pop_debug_group(&self) {}
    fn write_timestamp(&self, _: &DispatchQuerySet, _: u32) {}
    fn resolve_query_set(&self, _: &DispatchQuerySet, _: u32, _: u32, _: &DispatchBuffer, _: BufferAddress) {}
    fn mark_acceleration_structures_built<'a>(
        &self,
        _: &mut dyn Iterator<Item = &'a wgpu::Blas>,
        _: &mut dyn Iterator<Item = &'a wgpu::Tlas>,
    ) {
    }
    fn build_acceleration_structures<'a>(
        &self,
        _: &mut dyn Iterator<Item = &'a wgpu::BlasBuildEntry<'a>>,
        _: &mut dyn Iterator<Item = &'a wgpu::Tlas>,
    ) {
    }
    fn transition_resources<'a>(
        &mut self,
        _: &mut dyn Iterator<Item = BufferTransition<&'a DispatchBuffer>>,
        _: &mut dyn Iterator<Item = TextureTransition<&'a DispatchTexture>>,
    ) {
    }
}

impl ComputePassInterface for PlannedPass {
    fn set_pipeline(&mut self, _: &DispatchComputePipeline) {}
    fn set_bind_group(&mut self, _: u32, _: Option<&DispatchBindGroup>, _: &[DynamicOffset]) {}
    fn set_immediates(&mut self, _: u32, _: &[u8]) {}
    fn insert_debug_marker(&mut self, _: &str) {}
    fn push_debug_group(&mut self, _: &str) {}
    fn pop_debug_group(&mut self) {}
    fn write_timestamp(&mut self, _: &DispatchQuerySet, _: u32) {}
    fn begin_pipeline_statistics_query(&mut self, _: &DispatchQuerySet, _: u32) {}
    fn end_pipeline_statistics_query(&mut self) {}
    fn dispatch_workgroups(&mut self, _: u32, _: u32, _: u32) {}
    fn dispatch_workgroups_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress) {}
    fn transition_resources<'a>(
        &mut self,
        _: &mut dyn Iterator<Item = BufferTransition<&'a DispatchBuffer>>,
        _: &mut dyn Iterator<Item = TextureTransition<&'a DispatchTextureView>>,
    ) {
    }
}

impl RenderPassInterface for PlannedPass {
    fn set_pipeline(&mut self, _: &DispatchRenderPipeline) {}
    fn set_bind_group(&mut self, _: u32, _: Option<&DispatchBindGroup>, _: &[DynamicOffset]) {}
    fn set_index_buffer(
        &mut self,
        _: &DispatchBuffer,
        _: wgpu::IndexFormat,
        _: BufferAddress,
        _: Option<wgpu::BufferSize>,
    ) {
    }
    fn set_vertex_buffer(&mut self, _: u32, _: Option<&DispatchBuffer>, _: BufferAddress, _: Option<wgpu::BufferSize>) {
    }
    fn set_immediates(&mut self, _: u32, _: &[u8]) {}
    fn set_blend_constant(&mut self, _: wgpu::Color) {}
    fn set_scissor_rect(&mut self, _: u32, _: u32, _: u32, _: u32) {}
    fn set_viewport(&mut self, _: f32, _: f32, _: f32, _: f32, _: f32, _: f32) {}
    fn set_stencil_reference(&mut self, _: u32) {}
    fn draw(&mut self, _: Range<u32>, _: Range<u32>) {}
    fn draw_indexed(&mut self, _: Range<u32>, _: i32, _: Range<u32>) {}
    fn draw_mesh_tasks(&mut self, _: u32, _: u32, _: u32) {}
    fn draw_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress) {}
    fn draw_indexed_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress) {}
    fn draw_mesh_tasks_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress) {}
    fn multi_draw_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress, _: u32) {}
    fn multi_draw_indexed_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress, _: u32) {}
    fn multi_draw_indirect_count(
        &mut self,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: u32,
    ) {
    }
    fn multi_draw_mesh_tasks_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress, _: u32) {}
    fn multi_draw_indexed_indirect_count(
        &mut self,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: u32,
    ) {
    }
    fn multi_draw_mesh_tasks_indirect_count(
        &mut self,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: &DispatchBuffer,
        _: BufferAddress,
        _: u32,
    ) {
    }
    fn insert_debug_marker(&mut self, _: &str) {}
    fn push_debug_group(&mut self, _: &str) {}
    fn pop_debug_group(&mut self) {}
    fn write_timestamp(&mut self, _: &DispatchQuerySet, _: u32) {}
    fn begin_occlusion_query(&mut self, _: u32) {}
    fn end_occlusion_query(&mut self) {}
    fn begin_pipeline_statistics_query(&mut self, _: &DispatchQuerySet, _: u32) {}
    fn end_pipeline_statistics_query(&mut self) {}
    fn execute_bundles(&mut self, _: &mut dyn Iterator<Item = &DispatchRenderBundle>) {}
}

impl RenderBundleEncoderInterface for PlannedCommands {
    fn set_pipeline(&mut self, _: &DispatchRenderPipeline) {}
    fn set_bind_group(&mut self, _: u32, _: Option<&DispatchBindGroup>, _: &[DynamicOffset]) {}
    fn set_index_buffer(
        &mut self,
        _: &DispatchBuffer,
        _: wgpu::IndexFormat,
        _: BufferAddress,
        _: Option<wgpu::BufferSize>,
    ) {
    }
    fn set_vertex_buffer(&mut self, _: u32, _: Option<&DispatchBuffer>, _: BufferAddress, _: Option<wgpu::BufferSize>) {
    }
    fn set_immediates(&mut self, _: u32, _: &[u8]) {}
    fn draw(&mut self, _: Range<u32>, _: Range<u32>) {}
    fn draw_indexed(&mut self, _: Range<u32>, _: i32, _: Range<u32>) {}
    fn draw_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress) {}
    fn draw_indexed_indirect(&mut self, _: &DispatchBuffer, _: BufferAddress) {}
    fn finish(self, _: &wgpu::RenderBundleDescriptor<'_>) -> DispatchRenderBundle {
        DispatchRenderBundle::custom(Planned)
    }
    fn finish_boxed(self: Box<Self>, _: &wgpu::RenderBundleDescriptor<'_>) -> DispatchRenderBundle {
        DispatchRenderBundle::custom(Planned)
    }
}
