//! Light map that the library draws, with one or several samples per texel.

use antumbra_light::Aabb;
use glam::UVec2;

use super::depth_axis::{DepthAxis, DepthRange};
use super::{FilterSettings, Filterable, FrameMap};
use crate::contract::{Error, MeshCaster, PreparedFrame};
use crate::gpu::{Gpu, GpuStruct, Stage};
use crate::light_map::caster_depth::{CasterDepth, check_map_size};
use crate::light_map::central_view::fit_light_view;
use crate::light_map::map_texels::map_texels;
use crate::light_map::occluding_bounds::OccludingBounds;
use crate::light_map::stable_fit::{corners_to_hold, in_whole_texels};
use crate::receivers::inputs::PreparedInputs;

/// Light map that the library draws.
#[derive(Debug)]
pub(super) struct OwnMap {
    pub(super) view: wgpu::TextureView,
    pub(super) size: u32,
    pub(super) sample_count: u32,
}

impl<P: GpuStruct> Filterable<P> {
    /// Fits, allocates and prepares the light map.
    pub(super) fn prepare_own_map(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'_>],
        settings: &FilterSettings,
        inputs: PreparedInputs,
    ) -> Result<FrameMap, Error> {
        let technique = self.technique;
        let sample_count = settings.msaa.count();
        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let receivers = corners_to_hold(stage, &frame.receivers);
        let between = OccludingBounds::new(frame.light, &bounds, &receivers);
        let mut view = fit_light_view(frame.light, &bounds, &receivers);
        let bytes_of = |size: u32| bytes_of(size, sample_count);
        let size = map_texels(stage, frame, settings.map_size, bytes_of, &view, &bounds);
        check_map_size(stage, technique, size, "set a smaller `map_size`")?;
        if self.own_map.as_ref().is_none_or(|map| (map.size, map.sample_count) != (size, sample_count)) {
            self.own_map =
                Some(OwnMap { view: depth_texture(stage, technique, size, sample_count)?, size, sample_count });
        }
        let depth = self.own_map.as_ref().map(|map| map.view.clone()).expect("created above if missing");
        // Kernels of receivers at the window's edge reach beyond it.
        let reach = (settings.kernel().radius() + 1).min(size / 4);
        view.window.half_size *= size as f32 / (size - 2 * reach) as f32;
        let view = in_whole_texels(stage, view, UVec2::splat(size));
        let casters = self.casters.get_or_make(sample_count, || CasterDepth::multisampled(stage, sample_count));
        casters.prepare(stage, &[view.clip_from_world()], meshes);
        let range = match settings.depth_axis {
            DepthAxis::Light => None,
            DepthAxis::World => DepthRange::along_world(&view, &between, &receivers),
            DepthAxis::Distance => DepthRange::by_distance(&view, &between, &receivers),
        };
        let view = view.to_gpu(size);
        let range = range.unwrap_or_else(|| DepthRange::of_view(&view));
        let size = UVec2::splat(size);
        Ok(FrameMap { depth, size, sample_count, view, range, settings: *settings, inputs, is_drawn: false })
    }
}

/// Returns the memory of a map with the basis of most techniques, bytes: depth, and four channels in two words. Mip levels add
/// three eighths.
fn bytes_of(size: u32, sample_count: u32) -> u64 {
    const OF_BASIS: u32 = 8 * 11 / 8;
    u64::from(4 * sample_count + OF_BASIS) * u64::from(size).pow(2)
}

/// Creates a square depth map.
fn depth_texture(gpu: &Gpu, technique: &'static str, size: u32, sample_count: u32) -> Result<wgpu::TextureView, Error> {
    // Every adapter supports 1 and 4 samples; others are only known by trying.
    let is_core = matches!(sample_count, 1 | 4);
    let unsupported = || Error::Unsupported {
        technique,
        needed: format!("a shadow map with {sample_count} samples per texel"),
        had: "1 and 4".into(),
        remedy: "set `msaa` to 1 or 4",
    };
    if !is_core && !gpu.has(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES) {
        return Err(unsupported());
    }
    let descriptor = wgpu::TextureDescriptor {
        label: Some("antumbra light map"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format: CasterDepth::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    // Browsers cannot answer synchronously, but they never have the feature.
    let mut made = None;
    if gpu.validation_error(|| made = Some(gpu.device.create_texture(&descriptor))).is_some() {
        return Err(unsupported());
    }
    let texture = made.expect("the trial texture was created");
    Ok(gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default()))
}
