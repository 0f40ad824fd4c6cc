//! Objects of a planned device: buffers and textures with their ledger entries, and one type for all objects without memory.

use std::future::ready;
use std::ops::Range;
use std::pin::Pin;

use wgpu::custom::{
    BindGroupInterface, BindGroupLayoutInterface, BlasCompactCallback, BlasInterface, BufferInterface,
    BufferMapCallback, CommandBufferInterface, ComputePipelineInterface, DispatchBindGroupLayout,
    DispatchBufferMappedRange, DispatchTextureView, ExternalTextureInterface, PipelineCacheInterface,
    PipelineLayoutInterface, QuerySetInterface, RenderBundleInterface, RenderPipelineInterface, SamplerInterface,
    ShaderCompilationInfoFuture, ShaderModuleInterface, TextureInterface, TextureViewInterface, TlasInterface,
};

use super::Entry;

/// Planned buffer or texture.
#[derive(Debug)]
pub(super) struct PlannedMemory {
    _entry: Entry,
}

impl PlannedMemory {
    pub(super) fn new(entry: Entry) -> Self {
        Self { _entry: entry }
    }
}

impl BufferInterface for PlannedMemory {
    fn map_async(&self, _: wgpu::MapMode, _: Range<wgpu::BufferAddress>, callback: BufferMapCallback) {
        callback(Err(wgpu::BufferAsyncError));
    }
    fn get_mapped_range(
        &self,
        _: Range<wgpu::BufferAddress>,
    ) -> Result<DispatchBufferMappedRange, wgpu::MapRangeError> {
        panic!("a planned buffer has no memory that could be mapped");
    }
    fn unmap(&self) {}
    fn destroy(&self) {}
}

impl TextureInterface for PlannedMemory {
    fn create_view(&self, _: &wgpu::TextureViewDescriptor<'_>) -> DispatchTextureView {
        DispatchTextureView::custom(Planned)
    }
    fn destroy(&self) {}
}

/// Planned object without memory.
#[derive(Debug)]
pub(super) struct Planned;

impl BindGroupInterface for Planned {}
impl BindGroupLayoutInterface for Planned {}
impl CommandBufferInterface for Planned {}
impl PipelineLayoutInterface for Planned {}
impl RenderBundleInterface for Planned {}
impl SamplerInterface for Planned {}
impl TextureViewInterface for Planned {}
impl TlasInterface for Planned {}

impl ShaderModuleInterface for Planned {
    fn get_compilation_info(&self) -> Pin<Box<dyn ShaderCompilationInfoFuture>> {
        Box::pin(ready(wgpu::CompilationInfo { messages: Vec::new() }))
    }
}

impl ComputePipelineInterface for Planned {
    fn get_bind_group_layout(&self, _: u32) -> DispatchBindGroupLayout {
        DispatchBindGroupLayout::custom(Self)
    }
}

impl RenderPipelineInterface for Planned {
    fn get_bind_group_layout(&self, _: u32) -> DispatchBindGroupLayout {
        DispatchBindGroupLayout::custom(Self)
    }
}

impl PipelineCacheInterface for Planned {
    fn get_data(&self) -> Option<Vec<u8>> {
        None
    }
}

impl QuerySetInterface for Planned {
    fn destroy(&self) {}
}

impl ExternalTextureInterface for Planned {
    fn destroy(&self) {}
}

impl BlasInterface for Planned {
    fn prepare_compact_async(&self, callback: BlasCompactCallback) {
        callback(Err(wgpu::BlasAsyncError));
    }
    fn ready_for_compaction(&self) -> bool {
        false
    }
}
