//! Binding type of uniforms: uniform buffers, or storage buffers if the driver compiles uniform values into shaders.
//!
//! Mesa's software Vulkan before version 23 treats uniform values that control branches and loops as constants: at every
//! dispatch and draw it copies the shader, inserts the values and compiles the copy, which it keeps until the pipeline is
//! destroyed. Every dispatch then costs some ten milliseconds, and the process grows with each frame: by 0.8 to 9 MB in most
//! techniques, and by 340 MB in `sample_based` on a street. Values from storage buffers are not compiled in.
//!
//! A storage value is loaded by each lane of a vector, a uniform only once. Uniforms that no branch depends on alone therefore
//! remain uniform buffers: `reprojection_layered` scatters in .7 of the time that it takes with its views' matrices in storage.
//!
//! Only this module knows of the replacement and its exceptions. Declarations of bind groups, shaders and buffers are the same
//! on every device, and `device` passes them through here.

use std::borrow::Cow;

use super::quirks;

/// Storage buffers per stage if uniforms are storage buffers, too: the sum of WebGPU's default limits for both.
const STORAGE_BUFFERS: u32 = 8 + 12;
/// Dynamic storage buffers per pipeline layout, the same sum.
const DYNAMIC_STORAGE_BUFFERS: u32 = 4 + 8;

/// Returns WebGPU's default limits, raised if [`UniformAccess`] needs it on this adapter.
pub(super) fn wanted_limits(adapter: &wgpu::AdapterInfo, allowed: &wgpu::Limits) -> wgpu::Limits {
    let defaults = wgpu::Limits::default();
    let raised = wgpu::Limits {
        max_storage_buffers_per_shader_stage: STORAGE_BUFFERS,
        max_dynamic_storage_buffers_per_pipeline_layout: DYNAMIC_STORAGE_BUFFERS,
        ..defaults.clone()
    };
    if quirks::compiles_uniform_values_in(adapter) && has_room(allowed) { raised } else { defaults }
}

/// Kind of a device's uniforms: uniform or storage buffers. No other module depends on the kind.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct UniformAccess {
    is_storage: bool,
}

fn has_room(limits: &wgpu::Limits) -> bool {
    limits.max_storage_buffers_per_shader_stage >= STORAGE_BUFFERS
        && limits.max_dynamic_storage_buffers_per_pipeline_layout >= DYNAMIC_STORAGE_BUFFERS
}

/// Whether a pipeline's entries, as declared, stay within WebGPU's default limits for storage buffers.
pub(super) fn are_within_defaults(entries: &[wgpu::BindGroupLayoutEntry]) -> bool {
    let defaults = wgpu::Limits::default();
    let count = |is_counted: &dyn Fn(wgpu::ShaderStages, bool) -> bool| {
        let is_one = |entry: &&wgpu::BindGroupLayoutEntry| match entry.ty {
            wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { .. }, has_dynamic_offset, .. } => {
                is_counted(entry.visibility, has_dynamic_offset)
            }
            _ => false,
        };
        entries.iter().filter(is_one).count() as u32
    };
    let stages = [wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::FRAGMENT, wgpu::ShaderStages::COMPUTE];
    let fits = |stage| count(&|visible, _| visible.contains(stage)) <= defaults.max_storage_buffers_per_shader_stage;
    stages.into_iter().all(fits)
        && count(&|_, is_dynamic| is_dynamic) <= defaults.max_dynamic_storage_buffers_per_pipeline_layout
}

/// Uniform whose values control no branch or loop by themselves: it is a uniform buffer on every device.
struct Numbers {
    /// Label of the bind group layout, and binding number.
    layout: &'static str,
    binding: u32,
    /// Name in linked shaders.
    name: &'static str,
}

const NUMBERS: [Numbers; 5] = [
    Numbers { layout: "antumbra splat", binding: 1, name: "group_views" },
    Numbers { layout: "antumbra multi_layer lookup", binding: 5, name: "settings_ladder" },
    Numbers { layout: "antumbra view-sample table", binding: 1, name: "light_words" },
    Numbers { layout: "antumbra view-sample evaluate", binding: 4, name: "bits_light_words" },
    Numbers { layout: "antumbra view-sample raster", binding: 4, name: "bits_light_words" },
];

/// Whether a shader's uniform is listed in [`NUMBERS`].
fn is_of_numbers(name: &str) -> bool {
    NUMBERS.iter().any(|numbers| numbers.name == name)
}

/// Whether a layout's binding is listed in [`NUMBERS`].
fn is_bound_to_numbers(layout: &str, binding: u32) -> bool {
    NUMBERS.iter().any(|numbers| (numbers.layout, numbers.binding) == (layout, binding))
}

/// Asserts that [`NUMBERS`] lists a uniform by both its name in the shader and its binding in the layout, or by neither.
#[cfg(test)]
pub(super) fn assert_alike(layout: &str, binding: u32, name: &str) {
    assert_eq!(is_of_numbers(name), is_bound_to_numbers(layout, binding), "{layout}: {name} is numbers here or there");
}

impl UniformAccess {
    /// Returns the kind of uniforms for a device.
    pub(super) fn of(device: &wgpu::Device) -> Self {
        Self { is_storage: quirks::compiles_uniform_values_in(&device.adapter_info()) && has_room(&device.limits()) }
    }

    /// Returns the entries of a bind group layout as the device receives them.
    pub(super) fn layout_entries(
        self,
        label: &str,
        declared: &[wgpu::BindGroupLayoutEntry],
    ) -> Vec<wgpu::BindGroupLayoutEntry> {
        let as_made = |mut entry: wgpu::BindGroupLayoutEntry| {
            if self.is_storage
                && !is_bound_to_numbers(label, entry.binding)
                && let wgpu::BindingType::Buffer { ty: ty @ wgpu::BufferBindingType::Uniform, .. } = &mut entry.ty
            {
                *ty = wgpu::BufferBindingType::Storage { read_only: true };
            }
            entry
        };
        declared.iter().copied().map(as_made).collect()
    }

    /// Returns a shader text as the device receives it. Structs have the same layout in both kinds of buffers.
    pub(super) fn shader_text(self, wgsl: Cow<'static, str>) -> Cow<'static, str> {
        const UNIFORM: &str = "var<uniform>";
        if !self.is_storage {
            return wgsl;
        }
        let mut parts = wgsl.split(UNIFORM);
        let mut text = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let name = part.split(':').next().unwrap_or_default().trim();
            text += if is_of_numbers(name) { UNIFORM } else { "var<storage, read>" };
            text += part;
        }
        text.into()
    }

    /// Returns a buffer's usage as the device receives it.
    pub(super) fn buffer_usage(self, usage: wgpu::BufferUsages) -> wgpu::BufferUsages {
        let is_read_as_storage = self.is_storage && usage.contains(wgpu::BufferUsages::UNIFORM);
        if is_read_as_storage { usage | wgpu::BufferUsages::STORAGE } else { usage }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::quirks::tests::adapter;
    use crate::testing::{Case, RECTANGLE, gpu, gpu_with};
    use crate::{Gpu, TechniqueKind};

    #[test]
    fn more_buffers_are_asked_for_where_there_are_some() {
        let old = adapter("llvmpipe", "Mesa 22.3.6 (LLVM 15.0.6)");
        let many = wgpu::Limits {
            max_storage_buffers_per_shader_stage: 1 << 20,
            max_dynamic_storage_buffers_per_pipeline_layout: 1 << 20,
            ..wgpu::Limits::default()
        };
        assert!(has_room(&wanted_limits(&old, &many)));
        assert_eq!(wanted_limits(&old, &wgpu::Limits::default()), wgpu::Limits::default());
        assert_eq!(wanted_limits(&adapter("NVIDIA", "570"), &many), wgpu::Limits::default());
    }

    #[test]
    fn a_ninth_storage_buffer_of_a_stage_is_noticed() {
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let (vertex, fragment) = (wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::FRAGMENT);
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let mut entries: Vec<_> = (0..8).map(|i| entry(i, fragment, storage)).collect();
        entries.extend((8..12).map(|i| entry(i, fragment, wgpu::BufferBindingType::Uniform)));
        entries.push(entry(12, vertex, storage));
        assert!(are_within_defaults(&entries));
        entries.push(entry(13, fragment | vertex, storage));
        assert!(!are_within_defaults(&entries));

        let mut entries: Vec<_> = (0..5).map(|i| entry(i, fragment, storage)).collect();
        for entry in &mut entries {
            assert!(are_within_defaults(&[*entry]));
            entry.ty = wgpu::BindingType::Buffer { ty: storage, has_dynamic_offset: true, min_binding_size: None };
        }
        assert!(are_within_defaults(&entries[..4]) && !are_within_defaults(&entries));
    }

    #[test]
    fn no_shader_keeps_a_uniform_but_of_numbers() {
        for (path, wgsl) in crate::shaders::ALL {
            let text = UniformAccess { is_storage: true }.shader_text(crate::shaders::text_of(wgsl));
            let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"));
            let mut uniforms = module.global_variables.iter().filter(|(_, it)| it.space == naga::AddressSpace::Uniform);
            assert!(uniforms.all(|(_, it)| it.name.as_deref().is_some_and(is_of_numbers)), "{path}");
        }
    }

    #[test]
    fn masks_are_the_same_bits_from_storage() {
        let Some(gpu) = gpu() else { return };
        let Some(with_room) = gpu_with(Gpu::wanted_limits) else { return };
        let settings: [(TechniqueKind, &[(&str, &str)]); 4] = [
            (TechniqueKind::Pcss, &[("map_size", "64")]),
            (TechniqueKind::MultiLayer, &[("map_size", "64")]),
            (TechniqueKind::MultiView, &[("view_size", "64"), ("samples", "8")]),
            (TechniqueKind::AliasFree, &[]),
        ];
        for (kind, settings) in settings {
            let mask = |gpu: &Gpu| Case::half_plane(gpu, RECTANGLE).run(gpu, kind, settings);
            let from_uniforms = mask(gpu);
            assert!(from_uniforms == mask(&with_room), "{kind:?}");
            let has = |is: fn(f32) -> bool| from_uniforms.iter().any(|visibility| is(*visibility));
            assert!(has(|v| v < 0.1) && has(|v| v > 0.9), "{kind:?} has no shadow to compare");
        }
    }
}
