//! Comparison of bind group declarations with their shaders.

use naga::{AddressSpace, ImageClass, ImageDimension, ScalarKind, StorageAccess, TypeInner};

use super::Bindings;
use crate::gpu::overrides::is_linked_name;
use crate::gpu::uniforms;

/// Every linked shader with a binding of this name in a group.
pub(crate) fn shaders_with(group: u32, name: &str) -> Vec<(&'static str, &'static str)> {
    let has_it = |(_, wgsl): &(&str, &str)| {
        let module = naga::front::wgsl::parse_str(wgsl).expect("valid");
        let is_it = |linked: &Option<String>| linked.as_deref().is_some_and(|linked| is_linked_name(linked, name));
        let mut variables = module.global_variables.iter();
        variables.any(|(_, it)| it.binding.is_some_and(|place| place.group == group) && is_it(&it.name))
    };
    // Few shaders have to be parsed.
    crate::shaders::ALL.iter().copied().filter(|(_, wgsl)| wgsl.contains(name)).filter(has_it).collect()
}

/// Asserts that group `group` of named shaders is as declared: each shader binding is declared with the same name and
/// kind, and each declared binding occurs in a shader.
pub(crate) fn assert_as_declared<G: Bindings>(group: u32, shaders: &[(&str, &str)]) {
    let entries = G::layout_entries();
    let mut missing: Vec<_> = G::names();
    for (shader, wgsl) in shaders {
        let module = naga::front::wgsl::parse_str(wgsl).expect("valid");
        for (_, variable) in module.global_variables.iter() {
            let Some(place) = variable.binding.filter(|place| place.group == group) else { continue };
            let name = variable.name.as_deref().unwrap_or_default();
            let binding = place.binding;
            let entry = entries.iter().find(|entry| entry.binding == binding);
            let entry = entry.unwrap_or_else(|| panic!("{shader}: {name} at {binding} is not declared"));
            let (_, declared) = G::names().into_iter().find(|(of, _)| *of == binding).expect("of every entry");
            assert!(is_linked_name(name, declared), "{shader}: at {binding} is {name}, declared {declared}");
            let inner = &module.types[variable.ty].inner;
            assert!(fits(&entry.ty, variable.space, inner), "{shader}: {name} is declared as {:?}", entry.ty);
            uniforms::assert_alike(G::LABEL, binding, name);
            missing.retain(|(of, _)| *of != binding);
        }
    }
    assert!(missing.is_empty(), "no shader has {missing:?}");
}

fn fits(ty: &wgpu::BindingType, space: AddressSpace, inner: &TypeInner) -> bool {
    match (ty, space, inner) {
        (wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, .. }, AddressSpace::Uniform, _) => true,
        (
            wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { read_only }, .. },
            AddressSpace::Storage { access },
            _,
        ) => *read_only != access.contains(StorageAccess::STORE),
        (wgpu::BindingType::Sampler(how), _, TypeInner::Sampler { comparison }) => {
            *comparison == (*how == wgpu::SamplerBindingType::Comparison)
        }
        (
            wgpu::BindingType::Texture { sample_type, view_dimension, multisampled },
            _,
            TypeInner::Image { dim, arrayed, class },
        ) => is_dimension(*view_dimension, *dim, *arrayed) && is_sampled(*sample_type, *multisampled, *class),
        (
            wgpu::BindingType::StorageTexture { access, format, view_dimension },
            _,
            TypeInner::Image { dim, arrayed, class: ImageClass::Storage { format: in_shader, access: needed } },
        ) => {
            let given = match access {
                wgpu::StorageTextureAccess::WriteOnly => StorageAccess::STORE,
                _ => StorageAccess::LOAD | StorageAccess::STORE,
            };
            is_dimension(*view_dimension, *dim, *arrayed)
                && given.contains(*needed)
                && format!("{format:?}") == format!("{in_shader:?}")
        }
        _ => false,
    }
}

fn is_dimension(declared: wgpu::TextureViewDimension, dim: ImageDimension, arrayed: bool) -> bool {
    let in_shader = match (dim, arrayed) {
        (ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
        (ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
        (ImageDimension::D3, _) => wgpu::TextureViewDimension::D3,
        _ => return false,
    };
    declared == in_shader
}

fn is_sampled(declared: wgpu::TextureSampleType, multisampled: bool, class: ImageClass) -> bool {
    match class {
        ImageClass::Sampled { kind, multi } => {
            let is_kind = match declared {
                wgpu::TextureSampleType::Float { .. } => kind == ScalarKind::Float,
                wgpu::TextureSampleType::Uint => kind == ScalarKind::Uint,
                _ => false,
            };
            is_kind && multi == multisampled
        }
        // Multisampling of a depth texture is chosen when the layout is created.
        ImageClass::Depth { .. } => declared == wgpu::TextureSampleType::Depth,
        _ => false,
    }
}
