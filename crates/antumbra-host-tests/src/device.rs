//! The host's device with its validation messages.

use std::sync::OnceLock;

use antumbra::Gpu;

/// A device with the library's handle on it.
#[derive(Debug)]
pub struct Device {
    /// The library's handle.
    pub gpu: Gpu,
    adapter: wgpu::Adapter,
}

impl Device {
    /// Creates a device; `None` if there is no adapter and none is required.
    ///
    /// # Panics
    /// Panics if the adapter gives no device.
    pub fn new() -> Option<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = match pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) {
            Ok(adapter) => adapter,
            Err(wgpu::RequestAdapterError::NotFound { .. }) => {
                antumbra_testing::skip_without_adapter();
                return None;
            }
            Err(error) => panic!("the graphics driver fails: {error}"),
        };
        let (features, limits) = (adapter.features() & Gpu::WANTED_FEATURES, Gpu::wanted_limits(&adapter));
        Some(Self::of(adapter, features, limits))
    }

    /// Creates wgpu's no-op device, within WebGPU's default limits: for tests of CPU work, on any machine.
    ///
    /// # Panics
    /// Panics if wgpu has no such device.
    pub fn idle() -> Self {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::NOOP;
        descriptor.backend_options.noop.enable = true;
        // wgpu's validation of indirect draws uses shaders with alignments that this driver lacks.
        descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        Self::of(adapter.expect("wgpu's own"), wgpu::Features::empty(), wgpu::Limits::default())
    }

    /// Creates another device on the same adapter.
    ///
    /// # Panics
    /// Panics like [`new`](Self::new).
    pub fn another(&self) -> Self {
        Self::of(self.adapter.clone(), self.wgpu().features(), self.wgpu().limits())
    }

    fn of(adapter: wgpu::Adapter, required_features: wgpu::Features, required_limits: wgpu::Limits) -> Self {
        let descriptor =
            wgpu::DeviceDescriptor { required_features, required_limits, ..wgpu::DeviceDescriptor::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .unwrap_or_else(|error| panic!("{} cannot create a device: {error}", adapter.get_info().name));
        Self { gpu: Gpu::new(&device, &queue), adapter }
    }

    /// The device shared by the process; `None` as for [`new`](Self::new).
    pub fn shared() -> Option<&'static Self> {
        static DEVICE: OnceLock<Option<Device>> = OnceLock::new();
        DEVICE.get_or_init(Self::new).as_ref()
    }

    /// wgpu's device.
    pub fn wgpu(&self) -> &wgpu::Device {
        self.gpu.device()
    }

    /// wgpu's queue.
    pub fn queue(&self) -> &wgpu::Queue {
        self.gpu.queue()
    }

    /// Calls `run`. Returns its result and the first validation message of this thread during the call.
    pub fn with_messages<T>(&self, run: impl FnOnce() -> T) -> (T, Option<String>) {
        let scope = self.wgpu().push_error_scope(wgpu::ErrorFilter::Validation);
        let value = run();
        let message = pollster::block_on(scope.pop()).map(|error| error.to_string());
        (value, message)
    }

    /// Calls `run` and returns its result.
    ///
    /// # Panics
    /// Panics on a validation message during the call.
    pub fn validated<T>(&self, what: &str, run: impl FnOnce() -> T) -> T {
        let (value, message) = self.with_messages(run);
        assert!(message.is_none(), "{what}: {}", message.unwrap_or_default());
        value
    }

    /// Creates a command encoder.
    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Creates a buffer with these bytes, padded to a multiple of four.
    pub fn buffer(&self, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().max(4).next_multiple_of(4), 0);
        let buffer = self.wgpu().create_buffer(&wgpu::BufferDescriptor {
            label: Some("host buffer"),
            size: padded.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue().write_buffer(&buffer, 0, &padded);
        buffer
    }

    /// Waits for all submitted work.
    ///
    /// # Panics
    /// Panics if the device is lost.
    pub fn wait(&self) {
        self.wgpu().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
    }

    /// Reads a layer of a texture with one 32-bit float per texel, row by row.
    ///
    /// # Panics
    /// Panics if the texture lacks usage `COPY_SRC`.
    pub fn read_layer(&self, texture: &wgpu::Texture, layer: u32) -> Vec<f32> {
        let (width, height) = (texture.width(), texture.height());
        let row_bytes = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let readback = self.wgpu().create_buffer(&wgpu::BufferDescriptor {
            label: Some("host readback"),
            size: u64::from(row_bytes * height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.encoder();
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { z: layer, ..wgpu::Origin3d::ZERO },
                ..texture.as_image_copy()
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &readback,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        self.queue().submit([encoder.finish()]);
        readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapping for reading"));
        self.wait();
        let mapped = readback.get_mapped_range(..).expect("mapped above");
        let rows = mapped.chunks_exact(row_bytes as usize).flat_map(|row| &row[..(width * 4) as usize]);
        bytemuck::pod_collect_to_vec(&rows.copied().collect::<Vec<u8>>())
    }
}
