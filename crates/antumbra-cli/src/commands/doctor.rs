//! `antumbra doctor`.

use antumbra::TechniqueKind;
use antumbra_lab::device::{AdapterReport, DeviceError, LabDevice, list_adapters};

use crate::args::DoctorArgs;
use crate::commands::device_options;
use crate::failure::Failure;
use crate::stdout::say;
use crate::table;

/// Lists adapters, features and limits, and what each technique lacks here.
pub fn doctor(args: &DoctorArgs) -> Result<(), Failure> {
    let adapters = list_adapters();
    if adapters.is_empty() {
        return Err(DeviceError::NoAdapter.into());
    }
    let mut rows = vec![["ADAPTER", "KIND", "BACKEND", "DRIVER"].map(str::to_owned).to_vec()];
    rows.extend(adapters.iter().map(|adapter| {
        vec![adapter.name.clone(), kind(adapter).to_owned(), adapter.backend.to_string(), adapter.driver_and_version()]
    }));
    table::print(&rows);

    let lab = LabDevice::new(&device_options(&args.adapter))?;
    let adapter = &lab.adapter;
    say!("\nIn use: {} ({})", adapter.name, adapter.backend);
    say!("\nFeatures beyond WebGPU's core that the library or the laboratory uses:");
    let has = |feature| if adapter.features.contains(feature) { "yes" } else { "no" };
    let features = [
        (wgpu::Features::TIMESTAMP_QUERY, "timestamps", "times of single passes; without it, of whole frames"),
        (wgpu::Features::DEPTH_CLIP_CONTROL, "depth clip control", "casters nearer than a light map's near plane"),
        (
            wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES,
            "adapter's own formats",
            "light maps of 2 and 8 samples a texel",
        ),
        (
            wgpu::Features::SHADER_EARLY_DEPTH_TEST,
            "early depth test",
            "reprojection's path=fragment_two_pass leaves out hidden fragments, alias_free's stencil empty lists",
        ),
    ];
    let mut rows: Vec<Vec<String>> = vec![["FEATURE", "AVAILABLE", "USED FOR"].map(str::to_owned).to_vec()];
    rows.extend(features.map(|(feature, name, use_)| vec![name.into(), has(feature).into(), use_.into()]));
    table::print(&rows);

    let needed = wgpu::Limits::default();
    let had = &adapter.limits;
    say!("\nLimits (every technique stays within WebGPU's guaranteed minimum):");
    let limit = |name: &str, had: u64, least: u64| vec![name.to_owned(), had.to_string(), least.to_string()];
    table::print(&[
        ["LIMIT", "THIS ADAPTER", "WEBGPU MINIMUM"].map(str::to_owned).to_vec(),
        limit("side of a texture, texels", had.max_texture_dimension_2d.into(), needed.max_texture_dimension_2d.into()),
        limit("layers of a texture", had.max_texture_array_layers.into(), needed.max_texture_array_layers.into()),
        limit("size of a buffer, bytes", had.max_buffer_size, needed.max_buffer_size),
        limit(
            "size of a storage binding, bytes",
            had.max_storage_buffer_binding_size,
            needed.max_storage_buffer_binding_size,
        ),
        limit(
            "storage buffers a stage",
            had.max_storage_buffers_per_shader_stage.into(),
            needed.max_storage_buffers_per_shader_stage.into(),
        ),
        limit(
            "invocations a workgroup",
            had.max_compute_invocations_per_workgroup.into(),
            needed.max_compute_invocations_per_workgroup.into(),
        ),
        limit(
            "shared memory a workgroup, bytes",
            had.max_compute_workgroup_storage_size.into(),
            needed.max_compute_workgroup_storage_size.into(),
        ),
    ]);

    say!("\nTechniques:");
    let gpu = lab.gpu();
    let rows: Vec<Vec<String>> = TechniqueKind::ALL
        .iter()
        .map(|kind| {
            let state = kind.create(&gpu).map_or_else(|error| error.to_string(), |_| "ready".to_owned());
            vec![format!("  {kind}"), state]
        })
        .collect();
    table::print(&rows);
    Ok(lab.check()?)
}

fn kind(adapter: &AdapterReport) -> &'static str {
    match adapter.device_type {
        wgpu::DeviceType::DiscreteGpu => "graphics card",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "other",
    }
}
