//! Measured subpixel precision of the adapter's rasteriser.
//!
//! A rasteriser snaps corners to a subpixel grid and interpolates depth over the moved triangle. On a slanted surface, depth is
//! off by the surface's slope times that shift. WebGPU does not reveal how fine the grid is. Graphics chips have 256 steps per
//! texel. Some, and the software that browsers fall back to, have 16, which makes a tolerance of a hundredth of a texel wrong.
//! Some software interpolates over the unmoved triangle and needs no tolerance. So the library measures once per device: it
//! draws a few slanted triangles and stores the largest distance of a depth from its plane in a buffer for the shaders. Nothing
//! waits for it.

use super::{Bindings, DrawPipeline, Gpu, bindings, compute_pipeline, depth_state, texels};
use crate::shaders;

bindings! {
    struct Measured = "rasteriser", COMPUTE, group 0 of [RASTERISER_MEASURE] {
        0 drawn: Texture(texels::DEPTH),
        1 snapped_texels: ReadWrite,
    }
}

crate::gpu::shared_constants! {
    /// Cells along a side of the target.
    const CELLS: u32 = 16, as in RASTERISER_MEASURE;
    /// Texels along a side of a cell.
    const CELL_TEXELS: u32 = 16, as in RASTERISER_MEASURE;
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

impl Gpu {
    /// Uniform buffer, `f32`, with usage `COPY_SRC`: distance by which the adapter's rasteriser displaces planes, texels. The
    /// first call for this device measures it. About .003 on graphics cards, 0 on software renderers.
    pub fn snapped_texels(&self) -> &wgpu::Buffer {
        self.device.snapped_texels(|| measure(self))
    }

    /// Adds a displacement, texels, to that of the rasteriser; takes effect only before the first measurement.
    #[cfg(test)]
    pub(crate) fn pretend_snapped(&self, by_texels: f32) {
        self.device.snapped_texels(|| measure_moved(self, by_texels));
    }
}

/// Draws and measures. Returns a uniform buffer, `f32`: distance by which planes are displaced, texels; 0 if they are exact.
fn measure(gpu: &Gpu) -> wgpu::Buffer {
    measure_moved(gpu, 0.0)
}

/// Measures with everything drawn `by_texels` texels to the right.
fn measure_moved(gpu: &Gpu, by_texels: f32) -> wgpu::Buffer {
    let label = Some("antumbra rasteriser");
    let size = CELLS * CELL_TEXELS;
    let drawn = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label,
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let drawn = gpu.device.create_view(&drawn, &wgpu::TextureViewDescriptor::default());
    let snapped_texels = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label,
        size: size_of::<f32>() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let draw = DrawPipeline {
        label: "rasteriser draw",
        wgsl: shaders::RASTERISER_DRAW,
        fragment: None,
        depth: Some(depth_state(FORMAT, wgpu::CompareFunction::Always, true)),
        ..DrawPipeline::default()
    };
    let draw = draw.create(gpu);
    let layout = Measured::layout(gpu);
    let compare = compute_pipeline(gpu, "rasteriser measure", shaders::RASTERISER_MEASURE, &[&layout]);
    let group = Measured { drawn: &drawn, snapped_texels: &snapped_texels }.cached_group(gpu, &layout);

    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &drawn,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&draw);
        pass.set_viewport(by_texels, 0.0, size as f32, size as f32, 0.0, 1.0);
        pass.draw(0..3 * CELLS * CELLS, 0..1);
    }
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes: None });
        pass.set_pipeline(&compare);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    snapped_texels
}

#[cfg(test)]
mod tests {
    use super::measure_moved;
    use crate::testing::{gpu, read_storage};

    /// The coarsest grid has 16 steps per texel, so corners move by at most half a step in each direction.
    #[test]
    fn rasterisers_keep_planes_to_a_part_of_a_texel() {
        let Some(gpu) = gpu() else { return };
        let snapped: Vec<f32> = read_storage(gpu, gpu.snapped_texels());
        println!("{} texels", snapped[0]);
        assert!((0.0..0.08).contains(&snapped[0]), "{snapped:?}");
        assert_eq!(gpu.snapped_texels(), gpu.clone().snapped_texels(), "measured once");
    }

    /// A displacement of a sixteenth of a texel is measured, times the safety factor.
    #[test]
    fn rasterisation_offsets_are_measured() {
        let Some(gpu) = gpu() else { return };
        let own = read_storage::<f32>(gpu, gpu.snapped_texels())[0];
        let moved = read_storage::<f32>(gpu, &measure_moved(gpu, 0.0625))[0];
        let expected = 1.25 * 0.0625;
        assert!((moved - expected).abs() < own + 0.1 * expected, "{moved} texels, and {own} of its own");
    }
}
