//! Bind groups, each declared once: from one list of bindings come the layout and the group, whose resources have names; and
//! where the list says which shaders it is for, a test that they have the same.

use std::num::NonZeroU64;

use super::{Gpu, Stage};

#[cfg(test)]
pub(crate) mod tests;

/// What a bind group declared by [`bindings!`] can do.
pub(crate) trait Bindings {
    /// Names layouts and groups.
    const LABEL: &'static str;

    /// The layout's entries.
    fn layout_entries() -> Vec<wgpu::BindGroupLayoutEntry>;

    /// The group's entries.
    fn entries(&self) -> Vec<wgpu::BindGroupEntry<'_>>;

    /// Each binding's number and name.
    #[cfg(test)]
    fn names() -> Vec<(u32, &'static str)>;

    /// The layout, shared by all that have the same entries.
    fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        create_layout(gpu, Self::LABEL, &Self::layout_entries())
    }

    /// The layout where depth has several samples a texel, or one.
    fn layout_of_samples(gpu: &Gpu, depth_is_multisampled: bool) -> wgpu::BindGroupLayout {
        Self::layout_with(gpu, |ty| {
            if let wgpu::BindingType::Texture { sample_type: texels::DEPTH, multisampled, .. } = ty {
                *multisampled = depth_is_multisampled;
            }
        })
    }

    /// The layout, with types other than declared where there are several variants of the shader.
    fn layout_with(gpu: &Gpu, adapt: impl Fn(&mut wgpu::BindingType)) -> wgpu::BindGroupLayout {
        let mut entries = Self::layout_entries();
        entries.iter_mut().for_each(|entry| adapt(&mut entry.ty));
        create_layout(gpu, Self::LABEL, &entries)
    }

    /// A frame's group: that of an earlier frame where it is the same.
    fn group(&self, stage: &Stage<'_>, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let entries = self.entries();
        stage.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(Self::LABEL), layout, entries: &entries })
    }

    /// A group to keep beside its resources.
    fn kept_group(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let entries = self.entries();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(Self::LABEL), layout, entries: &entries })
    }
}

fn create_layout(gpu: &Gpu, label: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
}

/// Declares bind groups: label, the stages that see them, and each binding's number, name and [kind](Kind).
///
/// - `0 view: Uniform in VERTEX`: a binding that other stages see.
/// - `, group 1 of [SHADER]` after the stages: which group of which shaders it is. A test named as the group holds the
///   declaration against them.
/// - `, with batch: BatchBindings`: another group's bindings come first.
macro_rules! bindings {
    ($(
        $(#[$outer:meta])*
        $visibility:vis struct $name:ident = $label:literal, $($stages:ident)|+
            $(, group $group:literal of [$($shader:ident),+])?
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
            #[allow(non_snake_case, reason = "named as what it tests")]
            fn $name() {
                let shaders = [$( (stringify!($shader), $crate::shaders::$shader) ),+];
                $crate::gpu::bindings::tests::assert_as_declared::<$name<'_>>($group, &shaders);
            }
        )?
    )+ };
}

/// The first of a list.
macro_rules! first_of {
    ($first:expr $(, $rest:expr)*) => {
        $first
    };
}

/// A list, after another where there are two.
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

/// A kind of binding: its type in layouts, and what is bound.
pub(crate) trait Kind {
    /// What is bound.
    type Bound<'a>: Clone;
    /// Its type in layouts.
    fn ty(&self) -> wgpu::BindingType;
    /// It in groups.
    fn resource<'a>(&self, bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a>;
}

fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// Declares kinds of buffers, bound whole.
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
    /// A uniform buffer.
    Uniform: wgpu::BufferBindingType::Uniform;
    /// A storage buffer that is read.
    Storage: wgpu::BufferBindingType::Storage { read_only: true };
    /// A storage buffer that is read and written.
    ReadWrite: wgpu::BufferBindingType::Storage { read_only: false };
}

/// Declares kinds of parts of buffers.
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
    /// Part of a storage buffer that is read.
    StoragePart: Storage;
    /// Part of a storage buffer that is read and written.
    ReadWritePart: ReadWrite;
}

/// Declares kinds of buffers that hold several items of so many bytes, of which one is chosen where the group is bound.
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
    /// One of several uniforms.
    DynamicUniform: wgpu::BufferBindingType::Uniform;
    /// One of several items that are read.
    DynamicStorage: wgpu::BufferBindingType::Storage { read_only: true };
}

/// What a texture's texels are to a shader.
pub(crate) mod texels {
    /// Floats that are loaded, not filtered.
    pub(crate) const FLOAT: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };
    /// Floats that a sampler may filter.
    pub(crate) const FILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: true };
    /// Depth.
    pub(crate) const DEPTH: wgpu::TextureSampleType = wgpu::TextureSampleType::Depth;
    /// Unsigned integers.
    pub(crate) const UINT: wgpu::TextureSampleType = wgpu::TextureSampleType::Uint;
}

/// What a sampler does.
pub(crate) mod samples {
    /// Mixes texels.
    pub(crate) const FILTERS: wgpu::SamplerBindingType = wgpu::SamplerBindingType::Filtering;
    /// Takes texels as they are.
    pub(crate) const TAKES: wgpu::SamplerBindingType = wgpu::SamplerBindingType::NonFiltering;
    /// Compares depths.
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
    /// A texture of [`texels`].
    Texture(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    /// Its layers.
    TextureArray(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    };
    /// A texture of three dimensions.
    Texture3d(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D3,
        multisampled: false,
    };
    /// A texture of several samples a texel.
    MultisampledTexture(texels: wgpu::TextureSampleType): TextureView as TextureView => wgpu::BindingType::Texture {
        sample_type: texels,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: true,
    };
    /// A texture that is written.
    WrittenTexture(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    };
    /// Layers that are written.
    WrittenArray(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    };
    /// A texture of three dimensions that is written.
    WrittenTexture3d(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D3,
    };
    /// Layers that are read and written.
    ReadWriteArray(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::ReadWrite,
        format,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    };
    /// A sampler.
    Sampler(how: wgpu::SamplerBindingType): Sampler as Sampler => wgpu::BindingType::Sampler(how);
}
