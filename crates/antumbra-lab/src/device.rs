//! The laboratory's adapter and headless device, which records every error.
//!
//! A real GPU is preferred to software Vulkan. Errors that wgpu reports asynchronously are recorded, not thrown on a driver's thread.
//! [`LabDevice::check`] returns the first of them to the caller.

use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

/// Environment variable with a part of the adapter's name, in any case. The command line takes precedence.
pub const ADAPTER_VARIABLE: &str = "ANTUMBRA_ADAPTER";

/// Options of the device.
#[derive(Clone, Debug, Default)]
pub struct DeviceOptions {
    /// Part of the adapter's name, driver or backend, in any case. `None` reads [`ADAPTER_VARIABLE`]; if
    /// that is unset, the best adapter is used.
    pub adapter: Option<String>,
    /// Features to enable if the adapter has them; `TIMESTAMP_QUERY` is always among them.
    pub wanted_features: wgpu::Features,
}

/// Reason why there is no device, or why its results cannot be trusted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeviceError {
    /// The machine has no adapter.
    #[error(
        "no usable adapter; install a graphics driver, or software Vulkan: on Debian and Ubuntu \
         `apt-get install mesa-vulkan-drivers libvulkan1`"
    )]
    NoAdapter,
    /// The requested adapter does not exist.
    #[error("no adapter has a name, driver or backend that contains `{wanted}`; available: {available}")]
    NoSuchAdapter {
        /// Requested name.
        wanted: String,
        /// Names of the available adapters.
        available: String,
    },
    /// The adapter exists but cannot be used.
    #[error("adapter `{adapter}` is not usable: {reason}")]
    Unusable {
        /// Name of the adapter.
        adapter: String,
        /// Message of the driver, or the limit that is too low.
        reason: String,
    },
    /// The device reported errors.
    #[error("the graphics device reported {count} error(s); the first: {first}")]
    Failed {
        /// Number of errors.
        count: usize,
        /// First error in full.
        first: String,
    },
    /// The device was lost.
    #[error("the graphics device was lost: {reason}; if the image is large, try a smaller one")]
    Lost {
        /// Message of the driver.
        reason: String,
    },
}

/// Description of an adapter for people and reports.
#[derive(Clone, Debug, PartialEq)]
pub struct AdapterReport {
    /// Name of the adapter, e.g. `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub name: String,
    /// Name of the driver; empty if the backend does not report it.
    pub driver: String,
    /// Version of the driver.
    pub driver_info: String,
    /// Graphics API: Vulkan, Metal or DirectX 12.
    pub backend: wgpu::Backend,
    /// Kind of device: discrete, integrated, virtual, CPU.
    pub device_type: wgpu::DeviceType,
    /// All features of the adapter.
    pub features: wgpu::Features,
    /// All limits of the adapter.
    pub limits: wgpu::Limits,
}

impl AdapterReport {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            name: info.name,
            driver: info.driver,
            driver_info: info.driver_info,
            backend: info.backend,
            device_type: info.device_type,
            features: adapter.features(),
            limits: adapter.limits(),
        }
    }

    /// Returns the driver's name and version.
    pub fn driver_and_version(&self) -> String {
        format!("{} {}", self.driver, self.driver_info).trim().to_owned()
    }

    /// Returns whether the adapter is a software renderer.
    pub fn is_software(&self) -> bool {
        self.device_type == wgpu::DeviceType::Cpu
    }

    /// Returns whether `part` occurs in the name, the driver or the backend, in any case.
    pub fn matches(&self, part: &str) -> bool {
        let part = part.to_lowercase();
        [&self.name, &self.driver, &self.backend.to_string()].into_iter().any(|s| s.to_lowercase().contains(&part))
    }

    /// Returns the rank, best first: real hardware, then the backend that vendors maintain best.
    fn rank(&self) -> (u8, u8) {
        let device_type = match self.device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        };
        let backend = match self.backend {
            wgpu::Backend::Vulkan | wgpu::Backend::Metal => 0,
            wgpu::Backend::Dx12 => 1,
            _ => 2,
        };
        (device_type, backend)
    }
}

/// Returns every adapter of this machine, in order of preference.
pub fn list_adapters() -> Vec<AdapterReport> {
    adapters().into_iter().map(|(_, report)| report).collect()
}

/// Device with its queue and recorded errors.
#[derive(Debug)]
pub struct LabDevice {
    /// Device.
    pub device: wgpu::Device,
    /// Queue of the device.
    pub queue: wgpu::Queue,
    /// Adapter of the device.
    pub adapter: AdapterReport,
    gpu: antumbra::gpu::Gpu,
    faults: Arc<Mutex<Faults>>,
}

#[derive(Debug, Default)]
struct Faults {
    errors: Vec<String>,
    lost: Option<String>,
}

/// Dereferences to the library's handle on the device, as renderer and library expect it.
impl Deref for LabDevice {
    type Target = antumbra::gpu::Gpu;

    fn deref(&self) -> &Self::Target {
        &self.gpu
    }
}

impl LabDevice {
    /// Creates a device on the adapter that `options` name, or on the best.
    ///
    /// # Errors
    /// If there is no adapter, the requested one does not exist, or none provides a device.
    pub fn new(options: &DeviceOptions) -> Result<Self, DeviceError> {
        let from_environment = || std::env::var(ADAPTER_VARIABLE).ok().filter(|part| !part.is_empty());
        let wanted = options.adapter.clone().or_else(from_environment);
        let mut candidates = adapters();
        if candidates.is_empty() {
            return Err(DeviceError::NoAdapter);
        }
        if let Some(wanted) = wanted {
            let available: Vec<_> = candidates.iter().map(|(_, report)| report.name.clone()).collect();
            candidates.retain(|(_, report)| report.matches(&wanted));
            if candidates.is_empty() {
                return Err(DeviceError::NoSuchAdapter { wanted, available: available.join(", ") });
            }
        }
        // A driver installed without its hardware still lists an adapter; the next one may work.
        let mut first_refusal = None;
        for (adapter, report) in candidates {
            match open(&adapter, report, options.wanted_features) {
                Ok(device) => return Ok(device),
                Err(refusal) => first_refusal = first_refusal.or(Some(refusal)),
            }
        }
        Err(first_refusal.unwrap_or(DeviceError::NoAdapter))
    }

    /// Returns the library's handle on this device. All clones share pipelines.
    pub fn gpu(&self) -> antumbra::gpu::Gpu {
        self.gpu.clone()
    }

    /// Waits until all submitted work is done, then reports errors since the last call.
    ///
    /// # Errors
    /// The first error that the device recorded, or its loss.
    pub fn check(&self) -> Result<(), DeviceError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        let mut faults = self.faults.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(reason) = faults.lost.clone() {
            return Err(DeviceError::Lost { reason });
        }
        if let Err(error) = waited {
            return Err(DeviceError::Lost { reason: error.to_string() });
        }
        let errors = std::mem::take(&mut faults.errors);
        match errors.first() {
            Some(first) => Err(DeviceError::Failed { count: errors.len(), first: first.clone() }),
            None => Ok(()),
        }
    }
}

fn adapters() -> Vec<(wgpu::Adapter, AdapterReport)> {
    // Debug information in SPIR-V names WGSL as its source language, which validation layers older than 2023 report as an error for every
    // shader. `WGPU_DEBUG=1` restores it for captures.
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.flags.remove(wgpu::InstanceFlags::DEBUG);
    let instance = wgpu::Instance::new(descriptor.with_env());
    let mut adapters: Vec<_> = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
        .into_iter()
        .map(|adapter| {
            let report = AdapterReport::of(&adapter);
            (adapter, report)
        })
        .collect();
    adapters.sort_by_key(|(_, report)| report.rank());
    adapters
}

fn open(
    adapter: &wgpu::Adapter,
    report: AdapterReport,
    wanted_features: wgpu::Features,
) -> Result<LabDevice, DeviceError> {
    let unusable = |reason: String| DeviceError::Unusable { adapter: report.name.clone(), reason };
    // WebGPU's default limits, so that everything runs anywhere; only images and scenes may be larger. If the library asks for more
    // storage buffers, for its uniforms, it keeps its own use within the defaults.
    let required_limits = wgpu::Limits {
        max_texture_dimension_2d: report.limits.max_texture_dimension_2d,
        max_buffer_size: report.limits.max_buffer_size,
        ..antumbra::Gpu::wanted_limits(adapter)
    };
    let mut short = Vec::new();
    required_limits.check_limits_with_fail_fn(&report.limits, false, |name, needed, had| {
        short.push(format!("its {name} is {had}, below WebGPU's minimum of {needed}"));
    });
    if !short.is_empty() {
        return Err(unusable(short.join("; ")));
    }
    let wanted_features = wanted_features | wgpu::Features::TIMESTAMP_QUERY;
    let required_features = wanted_features & (report.features - wgpu::Features::all_experimental_mask());
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("antumbra lab"),
        required_features,
        required_limits,
        experimental_features: wgpu::ExperimentalFeatures::disabled(),
        memory_hints: wgpu::MemoryHints::Performance,
        trace: wgpu::Trace::Off,
    }))
    .map_err(|error| unusable(error.to_string()))?;

    let faults = Arc::new(Mutex::new(Faults::default()));
    let for_errors = faults.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        for_errors.lock().unwrap_or_else(PoisonError::into_inner).errors.push(error.to_string());
    }));
    let for_loss = faults.clone();
    device.set_device_lost_callback(move |reason, message| {
        // Dropping the device also ends here, and is no error.
        if reason != wgpu::DeviceLostReason::Destroyed {
            for_loss.lock().unwrap_or_else(PoisonError::into_inner).lost = Some(message);
        }
    });
    let gpu = antumbra::gpu::Gpu::new(&device, &queue);
    Ok(LabDevice { device, queue, adapter: report, gpu, faults })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_adapter_is_named() {
        if list_adapters().is_empty() {
            return antumbra_testing::skip_without_adapter();
        }
        let options = DeviceOptions { adapter: Some("no such adapter".into()), ..DeviceOptions::default() };
        let error = LabDevice::new(&options).unwrap_err();
        assert!(matches!(&error, DeviceError::NoSuchAdapter { .. }), "{error}");
    }

    #[test]
    fn errors_are_kept_until_asked_for() {
        if list_adapters().is_empty() {
            return antumbra_testing::skip_without_adapter();
        }
        let lab = LabDevice::new(&DeviceOptions::default()).unwrap();
        lab.check().unwrap();
        let no_usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE;
        let _ = lab.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("wrong"),
            size: 3,
            usage: no_usage,
            mapped_at_creation: true,
        });
        assert!(matches!(lab.check(), Err(DeviceError::Failed { count: 1.., .. })));
        lab.check().unwrap();
    }
}
