//! Host's device as the library uses it: objects that lights can share are created once, and all created objects are counted.
//!
//! Layouts, shader modules, pipelines and samplers are cached by their descriptors, so that a second light, or a second
//! technique with the same pass, reuses them. Buffers, textures, views and bind groups are created on each request.

mod caches;
mod keys;

use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock, PoisonError};

use super::budget::Budget;
use super::scratch::{Scratch, ScratchTextureKey};
use super::shared_values::SharedValues;
use super::uniforms::{self, UniformAccess};
use super::{constant_branches, programs, quirks};
use caches::{DescriptorCache, SharedPool};
use keys::{ComputeKey, Constants, EntryKey, LayoutKey, LinkedText, RenderKey, constants_of};

/// Host's device, with the objects on it that all lights share.
#[derive(Clone, Debug)]
pub(crate) struct Device {
    device: wgpu::Device,
    programs: Arc<Programs>,
}

/// Numbers of objects that the library has created on a device. A number that grows while the scene only moves indicates waste.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ObjectCounts {
    /// Shader modules, layouts, pipelines and samplers, which all lights share.
    pub programs: u64,
    /// Buffers.
    pub buffers: u64,
    /// Textures.
    pub textures: u64,
    /// Views of textures.
    pub views: u64,
    /// Bind groups.
    pub bind_groups: u64,
}

impl ObjectCounts {
    /// Sum of all numbers.
    pub fn total(&self) -> u64 {
        self.programs + self.buffers + self.textures + self.views + self.bind_groups
    }
}

/// Key of a table that lights share; it determines the content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TableKey {
    /// Kind of table.
    pub(crate) of: &'static str,
    pub(crate) numbers: Vec<u32>,
}

#[derive(Debug, Default)]
struct Programs {
    /// Real device, if this is the device of a memory plan.
    plan_of: Option<Device>,
    pipeline_cache: Option<wgpu::PipelineCache>,
    uniforms: UniformAccess,
    /// Result of [`quirks::max_iterations`].
    max_iterations: u32,
    bind_group_layouts: DescriptorCache<LayoutKey, wgpu::BindGroupLayout>,
    pipeline_layouts: DescriptorCache<Vec<Option<wgpu::BindGroupLayout>>, wgpu::PipelineLayout>,
    modules: DescriptorCache<LinkedText, wgpu::ShaderModule>,
    /// Modules without the branches that a pipeline's constants exclude, by whole module and constants.
    specialized_modules: DescriptorCache<(wgpu::ShaderModule, Constants), wgpu::ShaderModule>,
    compute_pipelines: DescriptorCache<ComputeKey, wgpu::ComputePipeline>,
    render_pipelines: DescriptorCache<RenderKey, wgpu::RenderPipeline>,
    /// By descriptor, as text, because it contains floats.
    samplers: DescriptorCache<String, wgpu::Sampler>,
    scratch_textures: SharedPool<ScratchTextureKey, wgpu::Texture>,
    /// Textures with the view that passes draw to.
    scratch_attachments: SharedPool<ScratchTextureKey, (wgpu::Texture, wgpu::TextureView)>,
    scratch_buffers: SharedPool<(Scratch, u64, wgpu::BufferUsages), wgpu::Buffer>,
    tables: SharedPool<TableKey, wgpu::Buffer>,
    /// Memory budget of maps that one light owns.
    budget: Arc<Budget>,
    shared_values: SharedValues,
    /// Result of `rasteriser`.
    snapped_texels: OnceLock<wgpu::Buffer>,
    /// Texture from `receivers/blue_noise`.
    noise_tile: OnceLock<wgpu::TextureView>,
    counts: Counts,
}

#[derive(Debug, Default)]
struct Counts {
    programs: AtomicU64,
    buffers: AtomicU64,
    textures: AtomicU64,
    views: AtomicU64,
    bind_groups: AtomicU64,
}

impl Device {
    pub(crate) fn new(device: &wgpu::Device, pipeline_cache: Option<&wgpu::PipelineCache>) -> Self {
        let programs = Programs {
            pipeline_cache: pipeline_cache.cloned(),
            uniforms: UniformAccess::of(device),
            max_iterations: quirks::max_iterations(&device.adapter_info()),
            ..Programs::default()
        };
        Self { device: device.clone(), programs: Arc::new(programs) }
    }

    /// Creates the device of a memory plan for `of`. Planned lights get the part of its map budget that is left.
    pub(super) fn planned(of: &Self, device: &wgpu::Device) -> Self {
        let programs = Programs {
            plan_of: Some(of.clone()),
            uniforms: of.programs.uniforms,
            max_iterations: of.programs.max_iterations,
            budget: Arc::new(of.budget().left()),
            ..Programs::default()
        };
        Self { device: device.clone(), programs: Arc::new(programs) }
    }

    /// Whether this is the device of a memory plan, which creates nothing and runs no commands.
    pub(crate) fn is_planned(&self) -> bool {
        self.programs.plan_of.is_some()
    }

    /// Loop iterations of an invocation after which a pass of unbounded work leaves the rest to the next pass.
    pub(crate) fn max_iterations(&self) -> u32 {
        self.programs.max_iterations
    }

    /// Whether lights of this device may read resources of `other`: a clone, or the device that this one plans for.
    pub(super) fn reads_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.programs, &other.programs)
            || self.programs.plan_of.as_ref().is_some_and(|of| of.reads_of(other))
    }

    /// Underlying wgpu device.
    pub(crate) fn raw(&self) -> &wgpu::Device {
        &self.device
    }

    pub(crate) fn limits(&self) -> wgpu::Limits {
        self.device.limits()
    }

    pub(crate) fn features(&self) -> wgpu::Features {
        self.device.features()
    }

    /// Memory budget of maps that one light owns.
    pub(super) fn budget(&self) -> &Arc<Budget> {
        &self.programs.budget
    }

    /// Memory of all resources that lights share, bytes.
    pub(super) fn scratch_bytes(&self) -> u64 {
        let Programs { scratch_textures, scratch_attachments, scratch_buffers, tables, .. } = &*self.programs;
        let textures = scratch_textures.bytes(texture_bytes) + scratch_attachments.bytes(|(it, _)| texture_bytes(it));
        textures + scratch_buffers.bytes(wgpu::Buffer::size) + tables.bytes(wgpu::Buffer::size)
    }

    /// Numbers of objects created so far.
    pub(crate) fn counts(&self) -> ObjectCounts {
        let Counts { programs, buffers, textures, views, bind_groups } = &self.programs.counts;
        let [programs, buffers, textures, views, bind_groups] =
            [programs, buffers, textures, views, bind_groups].map(|count| count.load(Ordering::Relaxed));
        ObjectCounts { programs, buffers, textures, views, bind_groups }
    }

    /// Returns a shader text as the device receives it, for a module of the host.
    pub(crate) fn host_shader_text(&self, wgsl: String) -> String {
        self.programs.uniforms.shader_text(wgsl.into()).into_owned()
    }

    /// Returns a bind group layout, shared by all with equal entries.
    pub(crate) fn create_bind_group_layout(
        &self,
        descriptor: &wgpu::BindGroupLayoutDescriptor<'_>,
    ) -> wgpu::BindGroupLayout {
        let Programs { bind_group_layouts, counts, .. } = &*self.programs;
        let entries = self.programs.uniforms.layout_entries(descriptor.label.unwrap_or_default(), descriptor.entries);
        let key = [descriptor.entries.to_vec(), entries.clone()];
        bind_group_layouts.get_or_make(key, &counts.programs, || {
            let descriptor = wgpu::BindGroupLayoutDescriptor { entries: &entries, ..*descriptor };
            programs::create_bind_group_layout(&self.device, &descriptor)
        })
    }

    /// Returns a pipeline layout, shared. The library uses no immediates.
    pub(crate) fn create_pipeline_layout(
        &self,
        descriptor: &wgpu::PipelineLayoutDescriptor<'_>,
    ) -> wgpu::PipelineLayout {
        debug_assert_eq!(descriptor.immediate_size, 0, "the cache key of a layout has only its bind groups");
        let key: Vec<_> = descriptor.bind_group_layouts.iter().map(|layout| layout.cloned()).collect();
        debug_assert!(
            self.is_within_defaults(&key),
            "{:?} has more storage buffers than WebGPU's default",
            descriptor.label
        );
        let Programs { pipeline_layouts, counts, .. } = &*self.programs;
        pipeline_layouts
            .get_or_make(key, &counts.programs, || programs::create_pipeline_layout(&self.device, descriptor))
    }

    /// Whether a pipeline, as declared, stays within WebGPU's default limits for storage buffers. A device that reads uniforms
    /// from storage has raised limits and would not report it.
    fn is_within_defaults(&self, layouts: &[Option<wgpu::BindGroupLayout>]) -> bool {
        let known = self.programs.bind_group_layouts.0.lock().unwrap_or_else(PoisonError::into_inner);
        let declared = |layout| known.iter().find(|(_, made)| *made == layout).map(|([entries, _], _)| entries);
        let entries: Vec<_> = layouts.iter().flatten().filter_map(declared).flatten().copied().collect();
        uniforms::are_within_defaults(&entries)
    }

    /// Returns the module of a linked shader, shared.
    pub(crate) fn create_shader_module(&self, label: &str, wgsl: &'static str) -> wgpu::ShaderModule {
        let Programs { modules, counts, .. } = &*self.programs;
        modules.get_or_make(LinkedText(wgsl), &counts.programs, || {
            let text = self.programs.uniforms.shader_text(crate::shaders::text_of(wgsl));
            programs::create_shader_module(&self.device, label, text)
        })
    }

    /// Returns the module of a linked shader without the branches that a pipeline's constants exclude. Listeners of `programs` receive
    /// the whole module only.
    fn specialize(
        &self,
        label: Option<&str>,
        module: &wgpu::ShaderModule,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> wgpu::ShaderModule {
        let Programs { modules, specialized_modules, counts, uniforms, .. } = &*self.programs;
        let linked = {
            let known = modules.0.lock().unwrap_or_else(PoisonError::into_inner);
            known.iter().find(|(_, made)| *made == module).map(|(linked, _)| linked.0)
        };
        // A plan compiles nothing.
        let Some(linked) = linked.filter(|_| !self.is_planned()) else { return module.clone() };
        specialized_modules.get_or_make((module.clone(), constants_of(options)), &counts.programs, || {
            let whole = uniforms.shader_text(crate::shaders::text_of(linked));
            match constant_branches::without_excluded(&whole, options.constants) {
                Cow::Borrowed(_) => module.clone(),
                Cow::Owned(text) => {
                    let source = wgpu::ShaderSource::Wgsl(text.into());
                    self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source })
                }
            }
        })
    }

    /// Returns a compute pipeline, shared by all callers with an equal descriptor.
    pub(crate) fn create_compute_pipeline(
        &self,
        descriptor: &wgpu::ComputePipelineDescriptor<'_>,
    ) -> wgpu::ComputePipeline {
        let entry = EntryKey::new(descriptor.module, descriptor.entry_point, &descriptor.compilation_options);
        let Programs { compute_pipelines, counts, pipeline_cache, .. } = &*self.programs;
        compute_pipelines.get_or_make(
            ComputeKey { layout: descriptor.layout.cloned(), entry },
            &counts.programs,
            || {
                programs::tell(programs::CreatedObject::Compute(descriptor));
                let cache = pipeline_cache.as_ref();
                let module = &self.specialize(descriptor.label, descriptor.module, &descriptor.compilation_options);
                let descriptor = wgpu::ComputePipelineDescriptor { cache, module, ..descriptor.clone() };
                self.device.create_compute_pipeline(&descriptor)
            },
        )
    }

    /// Returns a render pipeline, shared by all callers with an equal descriptor.
    pub(crate) fn create_render_pipeline(
        &self,
        descriptor: &wgpu::RenderPipelineDescriptor<'_>,
    ) -> wgpu::RenderPipeline {
        let Programs { render_pipelines, counts, pipeline_cache, .. } = &*self.programs;
        render_pipelines.get_or_make(RenderKey::new(descriptor), &counts.programs, || {
            programs::tell(programs::CreatedObject::Render(descriptor));
            let (cache, label) = (pipeline_cache.as_ref(), descriptor.label);
            let wgpu::RenderPipelineDescriptor { vertex, fragment, .. } = descriptor.clone();
            let vertex_module = self.specialize(label, vertex.module, &vertex.compilation_options);
            let fragment_module = fragment
                .as_ref()
                .map(|fragment| self.specialize(label, fragment.module, &fragment.compilation_options));
            let vertex = wgpu::VertexState { module: &vertex_module, ..vertex };
            let fragment = fragment
                .zip(fragment_module.as_ref())
                .map(|(fragment, module)| wgpu::FragmentState { module, ..fragment });
            let descriptor = wgpu::RenderPipelineDescriptor { cache, vertex, fragment, ..descriptor.clone() };
            self.device.create_render_pipeline(&descriptor)
        })
    }

    /// Returns a sampler, shared by all callers with an equal descriptor.
    pub(crate) fn create_sampler(&self, descriptor: &wgpu::SamplerDescriptor<'_>) -> wgpu::Sampler {
        let key = format!("{:?}", wgpu::SamplerDescriptor { label: None, ..descriptor.clone() });
        let Programs { samplers, counts, .. } = &*self.programs;
        samplers.get_or_make(key, &counts.programs, || self.device.create_sampler(descriptor))
    }

    /// CPU values that lights share.
    pub(crate) fn shared_values(&self) -> &SharedValues {
        &self.programs.shared_values
    }

    /// Returns the result of `rasteriser` for the adapter, measured by the first call.
    pub(super) fn snapped_texels(&self, measure: impl FnOnce() -> wgpu::Buffer) -> &wgpu::Buffer {
        self.programs.snapped_texels.get_or_init(measure)
    }

    /// Returns the texture from `receivers/blue_noise`, created by the first call.
    pub(crate) fn noise_tile(&self, make: impl FnOnce() -> wgpu::TextureView) -> &wgpu::TextureView {
        self.programs.noise_tile.get_or_init(make)
    }

    pub(crate) fn create_buffer(&self, descriptor: &wgpu::BufferDescriptor<'_>) -> wgpu::Buffer {
        self.programs.counts.buffers.fetch_add(1, Ordering::Relaxed);
        let usage = self.programs.uniforms.buffer_usage(descriptor.usage);
        self.device.create_buffer(&wgpu::BufferDescriptor { usage, ..descriptor.clone() })
    }

    pub(crate) fn create_texture(&self, descriptor: &wgpu::TextureDescriptor<'_>) -> wgpu::Texture {
        self.programs.counts.textures.fetch_add(1, Ordering::Relaxed);
        self.device.create_texture(descriptor)
    }

    /// Returns a texture that one light's commands fill and read before another light's do. Equal requests share it, and it is
    /// freed with its last holder. Different uses never share one, so that a pass may bind all of them.
    pub(crate) fn scratch_texture(
        &self,
        scratch: Scratch,
        descriptor: &wgpu::TextureDescriptor<'_>,
    ) -> Arc<wgpu::Texture> {
        let key = ScratchTextureKey::new(scratch, descriptor);
        self.programs.scratch_textures.get_or_make(key, || self.create_texture(descriptor))
    }

    /// Returns a scratch attachment with its view; a light that reuses an existing one creates nothing.
    pub(super) fn scratch_attachment(
        &self,
        scratch: Scratch,
        descriptor: &wgpu::TextureDescriptor<'_>,
    ) -> Arc<(wgpu::Texture, wgpu::TextureView)> {
        let key = ScratchTextureKey::new(scratch, descriptor);
        self.programs.scratch_attachments.get_or_make(key, || {
            let texture = self.create_texture(descriptor);
            let view = self.create_view(&texture, &wgpu::TextureViewDescriptor::default());
            (texture, view)
        })
    }

    /// Returns a scratch buffer, shared in the same way.
    pub(crate) fn scratch_buffer(
        &self,
        scratch: Scratch,
        descriptor: &wgpu::BufferDescriptor<'_>,
    ) -> Arc<wgpu::Buffer> {
        let key = (scratch, descriptor.size, descriptor.usage);
        self.programs.scratch_buffers.get_or_make(key, || self.create_buffer(descriptor))
    }

    /// Returns a buffer whose content depends only on its key and never changes. It is shared by all lights, and freed with its
    /// last holder.
    pub(super) fn table(&self, key: TableKey, make: impl FnOnce() -> wgpu::Buffer) -> Arc<wgpu::Buffer> {
        self.programs.tables.get_or_make(key, make)
    }

    pub(crate) fn create_view(
        &self,
        texture: &wgpu::Texture,
        descriptor: &wgpu::TextureViewDescriptor<'_>,
    ) -> wgpu::TextureView {
        self.programs.counts.views.fetch_add(1, Ordering::Relaxed);
        texture.create_view(descriptor)
    }

    pub(crate) fn create_bind_group(&self, descriptor: &wgpu::BindGroupDescriptor<'_>) -> wgpu::BindGroup {
        self.programs.counts.bind_groups.fetch_add(1, Ordering::Relaxed);
        self.device.create_bind_group(descriptor)
    }
}

/// Memory of a texture, all samples, levels and layers, bytes.
pub(crate) fn texture_bytes(texture: &wgpu::Texture) -> u64 {
    descriptor_bytes(&wgpu::TextureDescriptor {
        label: None,
        size: texture.size(),
        mip_level_count: texture.mip_level_count(),
        sample_count: texture.sample_count(),
        dimension: texture.dimension(),
        format: texture.format(),
        usage: texture.usage(),
        view_formats: &[],
    })
}

/// Memory of a texture with this descriptor, bytes.
pub(super) fn descriptor_bytes(texture: &wgpu::TextureDescriptor<'_>) -> u64 {
    let texel = texture.format.block_copy_size(None).unwrap_or(4);
    let level = |level: u32| {
        let size = texture.size.mip_level_size(level, texture.dimension);
        u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers)
    };
    let sample = u64::from(texel) * u64::from(texture.sample_count);
    sample * (0..texture.mip_level_count).map(level).sum::<u64>()
}
