//! Pipelines of the scatter, by the stage that scatters.

use std::sync::LazyLock;

use super::central::Views;
use super::program::compute_program;
use super::settings::{Settings, Source, Splat};
use super::surfel_list::SurfelList;
use crate::gpu::{DrawPipeline, Gpu, NoDepth, with_early_depth_test};
use crate::light_map::caster_depth::{CasterProgram, CasterProgramDescriptor};
use crate::light_map::depth_layers::DepthLayers;
use crate::shaders;

/// Layouts of the scatter's bind groups.
#[derive(Debug)]
pub(super) struct ScatterLayouts {
    /// Group 1: the central map.
    pub(super) central: wgpu::BindGroupLayout,
    /// Group 2 of passes over a central map.
    pub(super) group: wgpu::BindGroupLayout,
    /// Group 2 of the central rasterisation.
    pub(super) rasterised: wgpu::BindGroupLayout,
}

/// Key of the pipelines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PipelineKey {
    pub(super) scattering: Scattering,
    pub(super) is_surfel: bool,
    pub(super) synchronized: bool,
    pub(super) is_affine: bool,
    pub(super) tries_faces: bool,
    pub(super) has_reach: bool,
    pub(super) brings_together: bool,
}

/// Stage in which fragments are scattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scattering {
    Compute,
    Screen,
    /// Rasterisation of the central view, of only the nearest fragments or all.
    Raster {
        nearest: bool,
    },
}

/// Pipelines of one key; created on first use, since a host uses one.
#[derive(Debug)]
pub(super) enum Program {
    /// Compute pass with one thread per 2 × 2 texels.
    Points(wgpu::ComputePipeline),
    /// Compute pass with one thread per surfel of the list.
    Surfels(wgpu::ComputePipeline),
    Screen(wgpu::RenderPipeline),
    Raster(CasterProgram),
}

impl PipelineKey {
    pub(super) fn of(settings: &Settings, views: &Views, is_affine: bool) -> Self {
        let scattering = match settings.source {
            Source::LayersByCompute(_) => Scattering::Compute,
            Source::LayerByFragments => Scattering::Screen,
            Source::NearestWhileRasterising => Scattering::Raster { nearest: true },
            Source::AllWhileRasterising => Scattering::Raster { nearest: false },
        };
        let is_surfel = matches!(settings.splat, Splat::Surfel(_));
        Self {
            scattering,
            is_surfel,
            synchronized: settings.synchronized,
            is_affine,
            tries_faces: views.central.len() > 1,
            has_reach: matches!(settings.splat, Splat::NearCentre(_)),
            brings_together: settings.brings_together,
        }
    }
}

impl Program {
    /// Creates the pipelines of a key. `list` exists if compute scatters surfels.
    pub(super) fn new(
        gpu: &Gpu,
        layouts: &ScatterLayouts,
        layers: &DepthLayers,
        list: Option<&SurfelList>,
        key: PipelineKey,
    ) -> Self {
        let constant = |name: &'static str, value: bool| (name, f64::from(u8::from(value)));
        let of_all = [
            constant("SYNCHRONIZED", key.synchronized),
            constant("IS_AFFINE", key.is_affine),
            constant("TRIES_FACES", key.tries_faces),
        ];
        let of_points = [of_all.as_slice(), &[constant("HAS_REACH", key.has_reach)]].concat();
        let of_quads = [of_points.as_slice(), &[constant("BRINGS_TOGETHER", key.brings_together)]].concat();
        let of_rasterised = [of_points.as_slice(), &[constant("IS_SURFEL", key.is_surfel)]].concat();
        // Group 0 is the casters', if there are any.
        let of_map = [None, Some(&layouts.central), Some(&layouts.group)];
        match key.scattering {
            Scattering::Compute if key.is_surfel => {
                let list = list.expect("created before its program");
                let of_list = [None, Some(list.listed_layout()), Some(&layouts.group)];
                Self::Surfels(compute_program(gpu, shaders::REPROJECTION_SPLAT_SURFELS, &of_list, &of_all))
            }
            Scattering::Compute => {
                Self::Points(compute_program(gpu, shaders::REPROJECTION_SPLAT_POINTS, &of_map, &of_quads))
            }
            Scattering::Screen => {
                let screen = DrawPipeline {
                    label: "reprojection by fragments",
                    wgsl: shaders::REPROJECTION_SPLAT_SCREEN,
                    layouts: &of_map,
                    fragment: Some("splat"),
                    constants: &of_quads,
                    depth: Some(NoDepth::state()),
                    ..DrawPipeline::default()
                };
                Self::Screen(screen.create(gpu))
            }
            Scattering::Raster { nearest } => {
                Self::Raster(raster_program(gpu, &layouts.rasterised, layers, nearest, &of_rasterised))
            }
        }
    }
}

/// Creates the pipelines that scatter while rasterising. `nearest`: with the depth test, before the fragment stage if the device
/// supports that; otherwise hidden fragments are reprojected, too.
fn raster_program(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    layers: &DepthLayers,
    nearest: bool,
    constants: &[(&str, f64)],
) -> CasterProgram {
    let early = nearest && gpu.has(wgpu::Features::SHADER_EARLY_DEPTH_TEST);
    let [opaque_wgsl, cutout_wgsl] = if early {
        [&EARLY_OPAQUE, &EARLY_CUTOUT].map(|text| text.as_str())
    } else {
        [shaders::REPROJECTION_SPLAT_OPAQUE, shaders::REPROJECTION_SPLAT_CUTOUT]
    };
    layers.casters().program(
        gpu,
        &CasterProgramDescriptor {
            label: "reprojection while rasterising",
            opaque_wgsl,
            cutout_wgsl,
            opaque_fragment: Some("splat"),
            cutout_fragment: "splat",
            constants,
            layout: Some(layout),
            targets: &[],
            depth_compare: if nearest { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Always },
            depth_write: nearest,
            front_faces_of_solids: !nearest,
            sample_count: 1,
        },
    )
}

/// Shaders with the depth test before the fragment stage.
static EARLY_OPAQUE: LazyLock<String> = LazyLock::new(|| with_early_depth_test(shaders::REPROJECTION_SPLAT_OPAQUE));
static EARLY_CUTOUT: LazyLock<String> = LazyLock::new(|| with_early_depth_test(shaders::REPROJECTION_SPLAT_CUTOUT));
