//! Host's device and its capabilities.

use super::device::{Device, ObjectCounts};
use super::uniforms;

/// Handle on the host's device and queue, with the GPU programs that all lights share. Create one per device and clone it.
///
/// Shader modules, layouts, pipelines and samplers are created on first use and live as long as a clone of the handle. The
/// library never creates a device.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: wgpu::Queue,
}

/// Bytes of GPU memory on a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryBytes {
    /// Textures and buffers that several lights use in turn.
    pub shared: u64,
    /// Maps and lists that belong to one light each, within [`Gpu::set_map_budget`].
    pub own_maps: u64,
}

impl Gpu {
    /// Native features that the library uses if the device has them. Request their intersection with the adapter's features
    /// when creating the device.
    ///
    /// `TIMESTAMP_QUERY` times each pass. `DEPTH_CLIP_CONTROL` keeps casters nearer than a light map's near plane.
    /// `TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES` adds light maps with 2 and 8 samples per texel to WebGPU's 1 and 4.
    /// `SHADER_EARLY_DEPTH_TEST` saves hidden fragments in `reprojection` where it scatters while rasterising, and fragments
    /// over empty lists in `alias_free` and `sample_based` with `stencil`.
    pub const WANTED_FEATURES: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
        .union(wgpu::Features::DEPTH_CLIP_CONTROL)
        .union(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
        .union(wgpu::Features::SHADER_EARLY_DEPTH_TEST);

    /// Limits to request when creating the device: WebGPU's defaults, which suffice everywhere.
    ///
    /// Software drivers that recompile shaders for the values of their uniforms are an exception: the limits include more
    /// storage buffers, so that uniforms can be read from storage, which avoids delays and growing memory.
    pub fn wanted_limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
        uniforms::wanted_limits(&adapter.get_info(), &adapter.limits())
    }

    /// Wraps the host's device and queue.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self { device: Device::new(device, None), queue: queue.clone() }
    }

    /// Wraps the host's device and queue, with a cache for compiled pipelines. The device needs the feature
    /// [`PIPELINE_CACHE`](wgpu::Features::PIPELINE_CACHE). The host loads and stores the cache.
    pub fn with_pipeline_cache(device: &wgpu::Device, queue: &wgpu::Queue, cache: &wgpu::PipelineCache) -> Self {
        Self { device: Device::new(device, Some(cache)), queue: queue.clone() }
    }

    /// Host's device.
    pub fn device(&self) -> &wgpu::Device {
        self.device.raw()
    }

    /// Number of objects that the library has created on the device, through this handle and its clones. Frames with only
    /// motion create none.
    pub fn objects_created(&self) -> ObjectCounts {
        self.device.counts()
    }

    /// Sets the memory budget, bytes, of maps and lists that belong to one light each and are cached from frame to frame; 256 MiB by
    /// default. Lights beyond the budget share the memory of one light, and redraw their maps in every frame.
    ///
    /// Applies to maps that are allocated later.
    pub fn set_map_budget(&self, bytes: u64) {
        self.device.budget().set(bytes);
    }

    /// GPU memory in use: resources that lights share, and maps that belong to one light each.
    /// [`Shadow::memory_bytes`](crate::Shadow::memory_bytes) includes the latter, too.
    pub fn memory_bytes(&self) -> MemoryBytes {
        MemoryBytes { shared: self.device.scratch_bytes(), own_maps: self.device.budget().owned_bytes() }
    }

    /// Host's queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Last line of wgpu's validation error about what `run` does, or `None`; `None` also if the device, in a browser, does not
    /// answer at once.
    pub(crate) fn validation_error(&self, run: impl FnOnce()) -> Option<String> {
        let scope = self.device().push_error_scope(wgpu::ErrorFilter::Validation);
        run();
        let mut answer = Box::pin(scope.pop());
        let mut context = std::task::Context::from_waker(std::task::Waker::noop());
        let std::task::Poll::Ready(Some(error)) = std::future::Future::poll(answer.as_mut(), &mut context) else {
            return None;
        };
        let text = error.to_string();
        let last_line = text.lines().rev().map(str::trim).find(|line| !line.is_empty());
        Some(last_line.unwrap_or("invalid").to_owned())
    }

    /// Whether lights of this handle may read resources of `other`: a clone, or the handle that this one plans for. Devices of
    /// two instances cannot be distinguished, because wgpu numbers the objects of each from one.
    pub(crate) fn reads_of(&self, other: &Self) -> bool {
        self.device.reads_of(&other.device)
    }

    /// Whether the device has a feature.
    pub fn has(&self, feature: wgpu::Features) -> bool {
        self.device.features().contains(feature)
    }
}
