//! Bind groups, each declared once: one list of bindings gives the layout and the group, whose resources have names. If the
//! list names its shaders, a test compares their bindings with it.

use std::num::NonZeroU64;

use super::{Gpu, Stage};

#[cfg(test)]
pub(crate) mod tests;

/// Bind group declared by [`bindings!`].
pub(crate) trait Bindings {
    /// Label of layouts and groups.
    const LABEL: &'static str;

    /// Entries of the layout.
    fn layout_entries() -> Vec<wgpu::BindGroupLayoutEntry>;

    /// Entries of the group.
    fn entries(&self) -> Vec<wgpu::BindGroupEntry<'_>>;

    /// Number and name of each binding.
    #[cfg(test)]
    fn names() -> Vec<(u32, &'static str)>;

    /// Returns the layout, shared by all with the same entries.
    fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        create_layout(gpu, Self::LABEL, &Self::layout_entries())
    }

    /// Returns the layout with depth textures multisampled or not.
    fn layout_of_samples(gpu: &Gpu, depth_is_multisampled: bool) -> wgpu::BindGroupLayout {
        Self::layout_with(gpu, |ty| {
            if let wgpu::BindingType::Texture { sample_type: texels::DEPTH, multisampled, .. } = ty {
                *multisampled = depth_is_multisampled;
            }
        })
    }

    /// Returns the layout with adapted binding types, for variants of the shader.
    fn layout_with(gpu: &Gpu, adapt: impl Fn(&mut wgpu::BindingType)) -> wgpu::BindGroupLayout {
        let mut entries = Self::layout_entries();
        entries.iter_mut().for_each(|entry| adapt(&mut entry.ty));
        create_layout(gpu, Self::LABEL, &entries)
    }

    /// Returns the frame's group, reused from an earlier frame if the layout and resources are the same.
    fn group(&self, stage: &Stage<'_>, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let entries = self.entries();
        stage.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(Self::LABEL), layout, entries: &entries })
    }

    /// Creates a group that the caller keeps together with its resources.
    fn cached_group(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let entries = self.entries();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(Self::LABEL), layout, entries: &entries })
    }
}

fn create_layout(gpu: &Gpu, label: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
}

/// Declares bind groups: label, the stages that see them, and each binding's number, name and [kind](Kind).
///
/// - `0 view: Uniform in VERTEX`: a binding with its own stages.
/// - `, group 1 of [SHADER]` after the stages: group index and shaders. A test named after the struct compares the
///   declaration with them.
/// - `, group 1 of all with maps`: the same for all shaders in whose group 1 a binding is named `maps`.
/// - `, with batch: BatchBindings`: includes the bindings of another group first.
macro_rules! bindings {
    ($(
        $(#[$outer:meta])*
        $visibility:vis struct $name:ident = $label:literal, $($stages:ident)|+
            $(, group $group:literal of $([$($shader:ident),+])? $(all with $member:ident)?)?
            $(, with $base:ident: $base_ty:ident)?
        {
            $( $(#[$inner:meta])* $binding:literal $field:ident: $kind:ident $(($($argument:expr),+))? $(in $($own:ident)|+)?, )+
        }
    )+) => { $(
        $(#[$outer])*
        #[derive(Clone)]
        $visibility struct $name<'a> {
            $( pub(crate) $base: $base_ty<'a>, )?
            $( $(#[$inner])* pub(crate) $field: <$crate::gpu::bindings::$kind as $crate::gpu::bindings::Kind>::Bound<'a>, )+
        }

        impl $crate::gpu::bindings::Bindings for $name<'_> {
            const LABEL: &'static str = concat!("antumbra ", $label);

            fn layout_entries() -> Vec<wgpu::BindGroupLayoutEntry> {
                use $crate::gpu::bindings::Kind as _;
                let stages = wgpu::ShaderStages::empty() $( .union(wgpu::ShaderStages::$stages) )+;
                let own = [$( wgpu::BindGroupLayoutEntry {
                    binding: $binding,
                    visibility: $crate::gpu::bindings::first_of!(
                        $( wgpu::ShaderStages::empty() $( .union(wgpu::ShaderStages::$own) )+, )? stages
                    ),
                    ty: $crate::gpu::bindings::$kind $(($($argument),+))?.ty(),
                    count: None,
                }, )+];
                $crate::gpu::bindings::joined!($($base_ty::layout_entries(),)? own)
            }

            fn entries(&self) -> Vec<wgpu::BindGroupEntry<'_>> {
                use $crate::gpu::bindings::Kind as _;
                let own = [$( wgpu::BindGroupEntry {
                    binding: $binding,
                    resource: $crate::gpu::bindings::$kind $(($($argument),+))?.resource(&self.$field),
                }, )+];
                $crate::gpu::bindings::joined!($(self.$base.entries(),)? own)
            }

            #[cfg(test)]
            fn names() -> Vec<(u32, &'static str)> {
                let own = [$( ($binding, stringify!($field)), )+];
                $crate::gpu::bindings::joined!($($base_ty::names(),)? own)
            }
        }

        $(
            #[cfg(test)]
            #[test]
            #[allow(non_snake_case, reason = "the test is named after the function it tests")]
            fn $name() {
                $( let shaders = [$( (stringify!($shader), $crate::shaders::$shader) ),+]; )?
                $( let shaders = $crate::gpu::bindings::tests::shaders_with($group, stringify!($member)); )?
                $crate::gpu::bindings::tests::assert_as_declared::<$name<'_>>($group, &shaders);
            }
        )?
    )+ };
}

/// Expands to the first item of a list.
macro_rules! first_of {
    ($first:expr $(, $rest:expr)*) => {
        $first
    };
}

/// Expands to a vector of a list, appended to another vector if two arguments are given.
macro_rules! joined {
    ($own:expr) => {
        Vec::from($own)
    };
    ($base:expr, $own:expr) => {{
        let mut all = $base;
        all.extend($own);
        all
    }};
}

pub(crate) use {bindings, first_of, joined};

/// Kind of binding: its type in layouts, and the resource that is bound.
pub(crate) trait Kind {
    /// Bound resource.
    type Bound<'a>: Clone;
    /// Binding type in layouts.
    fn ty(&self) -> wgpu::BindingType;
    /// Binding resource in groups.
    fn resource<'a>(&self, bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a>;
}

fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// Declares kinds of buffers that are bound whole.
macro_rules! buffer_kinds {
    ($( $(#[$outer:meta])* $name:ident: $ty:expr; )+) => { $(
        $(#[$outer])*
        pub(crate) struct $name;

        impl Kind for $name {
            type Bound<'a> = &'a wgpu::Buffer;
            fn ty(&self) -> wgpu::BindingType {
                buffer($ty)
            }
            fn resource<'a>(&self, bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
                bound.as_entire_binding()
            }
        }
    )+ };
}

buffer_kinds! {
    /// Uniform buffer.
    Uniform: wgpu::BufferBindingType::Uniform;
    /// Read-only storage buffer.
    Storage: wgpu::BufferBindingType::Storage { read_only: true };
    /// Read-write storage buffer.
    ReadWrite: wgpu::BufferBindingType::Storage { read_only: false };
}

/// Declares kinds of bindings of a part of a buffer.
macro_rules! part_kinds {
    ($( $(#[$outer:meta])* $name:ident: $whole:ident; )+) => { $(
        $(#[$outer])*
        pub(crate) struct $name;

        impl Kind for $name {
            type Bound<'a> = wgpu::BufferBinding<'a>;
            fn ty(&self) -> wgpu::BindingType {
                $whole.ty()
            }
            fn resource<'a>(&self, bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
                wgpu::BindingResource::Buffer(bound.clone())
            }
        }
    )+ };
}

part_kinds! {
    /// Part of a read-only storage buffer.
    StoragePart: Storage;
    /// Part of a read-write storage buffer.
    ReadWritePart: ReadWrite;
}

/// Declares kinds of buffers with dynamic offset. The argument is the size of one item, bytes.
macro_rules! dynamic_kinds {
    ($( $(#[$outer:meta])* $name:ident: $ty:expr; )+) => { $(
        $(#[$outer])*
        pub(crate) struct $name(pub(crate) usize);

        impl Kind for $name {
            type Bound<'a> = &'a wgpu::Buffer;
            fn ty(&self) -> wgpu::BindingType {
                let min_binding_size = NonZeroU64::new(self.0 as u64);
                wgpu::BindingType::Buffer { ty: $ty, has_dynamic_offset: true, min_binding_size }
            }
            fn resource<'a>(&self, bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
                let size = NonZeroU64::new(self.0 as u64);
                wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: bound, offset: 0, size })
            }
        }
    )+ };
}

dynamic_kinds! {
    /// Uniform buffer with dynamic offset.
    DynamicUniform: wgpu::BufferBindingType::Uniform;
    /// Read-only storage buffer with dynamic offset.
    DynamicStorage: wgpu::BufferBindingType::Storage { read_only: true };
}

/// Sample types of textures.
pub(crate) mod texels {
    /// Unfilterable float.
    pub(crate) const FLOAT: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };
    /// Filterable float.
    pub(crate) const FILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: true };
    /// Depth.
    pub(crate) const DEPTH: wgpu::TextureSampleType = wgpu::TextureSampleType::Depth;
    /// Unsigned integer.
    pub(crate) const UINT: wgpu::TextureSampleType = wgpu::TextureSampleType::Uint;
}

/// Sampler binding types.
pub(crate) mod samples {
    /// Filtering sampler.
    pub(crate) const FILTERS: wgpu::SamplerBindingType = wgpu::SamplerBindingType::Filtering;
    /// Non-filtering sampler.
    pub(crate) const TAKES: wgpu::SamplerBindingType = wgpu::SamplerBindingType::NonFiltering;
    /// Comparison sampler.
    pub(crate) const COMPARES: wgpu::SamplerBindingType = wgpu::SamplerBindingType::Comparison;
}

/// Declares kinds of textures and of samplers.
macro_rules! other_kinds {
    ($( $(#[$outer:meta])* $name:ident($($argument:ident: $argument_ty:ty),+): $bound:ident as $resource:ident => $ty:expr; )+) => { $(
        $(#[$outer])*
        pub(crate) struct $name($( pub(crate) $argument_ty, )+);

        impl Kind for $name {
            type Bound<'a> = &'a wgpu::$bound;
            fn ty(&self) -> wgpu::BindingType {
                let Self($($argument),+) = *self;
                $ty
            }
            fn resource<'a>(&self, bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
                wgpu::BindingResource::$resource(bound)
            }
        }
    )+ };
}

other_kinds! {
    /// 2D texture with a sample type of [`texels`].
    Texture(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    /// 2D texture array.
    TextureArray(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    };
    /// 3D texture.
    Texture3d(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D3,
        multisampled: false,
    };
    /// Multisampled 2D texture.
    MultisampledTexture(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: true,
    };
    /// Write-only 2D storage texture.
    WrittenTexture(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    };
    /// Write-only 2D storage texture array.
    WrittenArray(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    };
    /// Write-only 3D storage texture.
    WrittenTexture3d(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D3,
    };
    /// Read-write 2D storage texture array.
    ReadWriteArray(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::ReadWrite,
        format,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    };
    /// Sampler.
    Sampler(how: wgpu::SamplerBindingType): Sampler as Sampler => wgpu::BindingType::Sampler(how);
}
