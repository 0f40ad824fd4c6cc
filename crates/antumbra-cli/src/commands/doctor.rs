//! `antumbra doctor`.

use antumbra::TechniqueKind;
use antumbra_lab::device::{AdapterReport, DeviceError, LabDevice, list_adapters};

use serde_json::{Map, Value, json};

use crate::args::DoctorArgs;
use crate::commands::device_options;
use crate::failure::Failure;
use crate::stdout::say;
use crate::table;

/// Features beyond WebGPU's core, with names and uses.
const FEATURES: [(wgpu::Features, &str, &str); 4] = [
    (wgpu::Features::TIMESTAMP_QUERY, "timestamps", "times of single passes; without it, only of whole frames"),
    (wgpu::Features::DEPTH_CLIP_CONTROL, "depth clip control", "casters in front of a shadow map's near plane"),
    (
        wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES,
        "adapter-specific formats",
        "shadow maps with 2 and 8 samples per texel",
    ),
    (
        wgpu::Features::SHADER_EARLY_DEPTH_TEST,
        "early depth test",
        "reprojection's path=fragment_two_pass skips hidden fragments, alias_free's stencil skips empty lists",
    ),
];

/// A limit's name, and its accessor.
type NamedLimit = (&'static str, fn(&wgpu::Limits) -> u64);

const LIMITS: [NamedLimit; 7] = [
    ("texture side, texels", |limits| limits.max_texture_dimension_2d.into()),
    ("texture layers", |limits| limits.max_texture_array_layers.into()),
    ("buffer size, bytes", |limits| limits.max_buffer_size),
    ("storage binding size, bytes", |limits| limits.max_storage_buffer_binding_size),
    ("storage buffers per stage", |limits| limits.max_storage_buffers_per_shader_stage.into()),
    ("invocations per workgroup", |limits| limits.max_compute_invocations_per_workgroup.into()),
    ("shared memory per workgroup, bytes", |limits| limits.max_compute_workgroup_storage_size.into()),
];

/// Lists adapters, features and limits, and reasons why techniques are unavailable here.
pub fn doctor(args: &DoctorArgs) -> Result<(), Failure> {
    let adapters = list_adapters();
    if adapters.is_empty() {
        return Err(DeviceError::NoAdapter.into());
    }
    if !args.json {
        let mut rows = vec![["ADAPTER", "KIND", "BACKEND", "DRIVER"].map(str::to_owned).to_vec()];
        rows.extend(adapters.iter().map(|adapter| {
            let texts = [adapter.name.as_str(), kind(adapter), adapter.backend.to_str(), &adapter.driver_and_version()];
            texts.map(str::to_owned).to_vec()
        }));
        table::print(&rows);
    }
    let lab = LabDevice::new(&device_options(&args.adapter))?;
    let gpu = lab.gpu();
    let problems: Vec<(TechniqueKind, Option<String>)> =
        TechniqueKind::ALL.iter().map(|kind| (*kind, kind.create(&gpu).err().map(|error| error.to_string()))).collect();
    if args.json {
        say!("{:#}", as_json(&adapters, &lab.adapter, &problems));
    } else {
        print_device(&lab.adapter, &problems);
    }
    Ok(lab.check()?)
}

fn print_device(adapter: &AdapterReport, problems: &[(TechniqueKind, Option<String>)]) {
    say!("\nIn use: {} ({})", adapter.name, adapter.backend);
    say!("\nOptional WebGPU and native features that the library or the laboratory uses:");
    let has = |feature| if adapter.features.contains(feature) { "yes" } else { "no" };
    let mut rows: Vec<Vec<String>> = vec![["FEATURE", "AVAILABLE", "USED FOR"].map(str::to_owned).to_vec()];
    rows.extend(FEATURES.map(|(feature, name, used_for)| [name, has(feature), used_for].map(str::to_owned).to_vec()));
    table::print(&rows);

    let least = wgpu::Limits::default();
    say!("\nLimits (every technique works within WebGPU's guaranteed minimum):");
    let mut rows = vec![["LIMIT", "THIS ADAPTER", "WEBGPU MINIMUM"].map(str::to_owned).to_vec()];
    rows.extend(
        LIMITS.map(|(name, of)| vec![name.to_owned(), of(&adapter.limits).to_string(), of(&least).to_string()]),
    );
    table::print(&rows);

    say!("\nTechniques:");
    let rows: Vec<Vec<String>> = problems
        .iter()
        .map(|(kind, problem)| vec![format!("  {kind}"), problem.clone().unwrap_or_else(|| "ready".to_owned())])
        .collect();
    table::print(&rows);
}

/// Returns the same information as JSON. The value of an available technique is null.
fn as_json(adapters: &[AdapterReport], in_use: &AdapterReport, problems: &[(TechniqueKind, Option<String>)]) -> Value {
    let of_adapter = |adapter: &AdapterReport| {
        json!({
            "name": adapter.name,
            "kind": kind(adapter),
            "backend": adapter.backend.to_str(),
            "driver": adapter.driver_and_version(),
        })
    };
    let least = wgpu::Limits::default();
    let limits = LIMITS
        .map(|(name, of)| (name.to_owned(), json!({ "adapter": of(&in_use.limits), "webgpu_minimum": of(&least) })));
    let features = FEATURES.map(|(feature, name, _)| (name.to_owned(), in_use.features.contains(feature).into()));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": env!("ANTUMBRA_COMMIT"),
        "adapters": adapters.iter().map(of_adapter).collect::<Vec<_>>(),
        "in_use": of_adapter(in_use),
        "features": features.into_iter().collect::<Map<_, _>>(),
        "limits": limits.into_iter().collect::<Map<_, _>>(),
        "techniques": problems.iter().map(|(kind, problem)| (kind.name().to_owned(), json!(problem))).collect::<Map<_, _>>(),
    })
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
