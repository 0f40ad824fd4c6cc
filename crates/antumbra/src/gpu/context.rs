//! The host's device, and what it offers.

/// A handle on the host's device and queue. Cheap to clone; the library never creates a device of its own.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
}

impl Gpu {
    /// Native features that the library uses where the device has them and does without where not: ask for their
    /// intersection with the adapter's features when making the device.
    ///
    /// `TIMESTAMP_QUERY` times each pass; `DEPTH_CLIP_CONTROL` keeps casters nearer than a light map's near plane;
    /// `TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES` brings light maps with 2 and 8 samples a texel beside WebGPU's 1 and 4;
    /// `SHADER_EARLY_DEPTH_TEST` spares `reprojection` hidden fragments where it scatters while it rasterises.
    pub const WANTED_FEATURES: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
        .union(wgpu::Features::DEPTH_CLIP_CONTROL)
        .union(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
        .union(wgpu::Features::SHADER_EARLY_DEPTH_TEST);

    /// Wraps the host's device and queue.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self { device: device.clone(), queue: queue.clone() }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Whether the device has a feature.
    pub fn has(&self, feature: wgpu::Features) -> bool {
        self.device.features().contains(feature)
    }
}
