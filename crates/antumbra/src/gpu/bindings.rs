//! Bind groups, each declared once: from one list of bindings come the layout and the group, whose resources have names.

use std::num::NonZeroU64;

use super::{Gpu, Stage};

/// What a bind group declared by [`bindings!`] can do.
pub(crate) trait Bindings {
    /// Names layouts and groups.
    const LABEL: &'static str;

    /// The layout's entries.
    fn layout_entries() -> Vec<wgpu::BindGroupLayoutEntry>;

    /// The group's entries.
    fn entries(&self) -> Vec<wgpu::BindGroupEntry<'_>>;

    /// The layout, shared by all that have the same entries.
    fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        Self::layout_with(gpu, &[])
    }

    /// The layout with further entries.
    fn layout_with(gpu: &Gpu, further: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
        gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(Self::LABEL),
            entries: &[&Self::layout_entries(), further].concat(),
        })
    }

    /// A frame's group: that of an earlier frame where it is the same.
    fn group(&self, stage: &Stage<'_>, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        self.group_with(stage, layout, Vec::new())
    }

    /// A frame's group with further entries.
    fn group_with(
        &self,
        stage: &Stage<'_>,
        layout: &wgpu::BindGroupLayout,
        further: Vec<wgpu::BindGroupEntry<'_>>,
    ) -> wgpu::BindGroup {
        let entries = [self.entries(), further].concat();
        stage.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(Self::LABEL), layout, entries: &entries })
    }

    /// A group to keep beside its resources.
    fn kept_group(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let entries = self.entries();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(Self::LABEL), layout, entries: &entries })
    }
}

/// Declares bind groups: label, the stages that see them, and each binding's number, name and [kind](Kind). A binding that other
/// stages see says so: `0 view: Uniform in VERTEX`.
macro_rules! bindings {
    ($(
        $(#[$outer:meta])*
        $visibility:vis struct $name:ident = $label:literal, $stages:ident {
            $( $(#[$inner:meta])* $binding:literal $field:ident: $kind:ident $(($($argument:expr),+))? $(in $own:ident)?, )+
        }
    )+) => { $(
        $(#[$outer])*
        #[derive(Clone)]
        $visibility struct $name<'a> {
            $( $(#[$inner])* pub(crate) $field: <$crate::gpu::bindings::$kind as $crate::gpu::bindings::Kind>::Bound<'a>, )+
        }

        impl $crate::gpu::bindings::Bindings for $name<'_> {
            const LABEL: &'static str = concat!("antumbra ", $label);

            fn layout_entries() -> Vec<wgpu::BindGroupLayoutEntry> {
                #[allow(unused_imports, reason = "where every binding says what it is seen by")]
                use $crate::gpu::bindings::Kind as _;
                vec![$( wgpu::BindGroupLayoutEntry {
                    binding: $binding,
                    visibility: $crate::gpu::bindings::first_of!($( wgpu::ShaderStages::$own, )? wgpu::ShaderStages::$stages),
                    ty: $crate::gpu::bindings::$kind $(($($argument),+))?.ty(),
                    count: None,
                }, )+]
            }

            fn entries(&self) -> Vec<wgpu::BindGroupEntry<'_>> {
                vec![$( wgpu::BindGroupEntry {
                    binding: $binding,
                    resource: <$crate::gpu::bindings::$kind as $crate::gpu::bindings::Kind>::resource(&self.$field),
                }, )+]
            }
        }
    )+ };
}

/// The first of a list.
macro_rules! first_of {
    ($first:expr $(, $rest:expr)*) => {
        $first
    };
}

pub(crate) use {bindings, first_of};

/// A kind of binding: its type in layouts, and what is bound.
pub(crate) trait Kind {
    /// What is bound.
    type Bound<'a>: Clone;
    /// Its type in layouts.
    fn ty(&self) -> wgpu::BindingType;
    /// It in groups.
    fn resource<'a>(bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a>;
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
            fn resource<'a>(bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
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

/// A storage buffer that is read, or part of one.
pub(crate) struct StoragePart;

impl Kind for StoragePart {
    type Bound<'a> = wgpu::BufferBinding<'a>;
    fn ty(&self) -> wgpu::BindingType {
        Storage.ty()
    }
    fn resource<'a>(bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
        wgpu::BindingResource::Buffer(bound.clone())
    }
}

/// One of several uniforms of so many bytes in a buffer, chosen where it is bound.
pub(crate) struct DynamicUniform(pub(crate) usize);

impl Kind for DynamicUniform {
    type Bound<'a> = wgpu::BufferBinding<'a>;
    fn ty(&self) -> wgpu::BindingType {
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: true,
            min_binding_size: NonZeroU64::new(self.0 as u64),
        }
    }
    fn resource<'a>(bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
        wgpu::BindingResource::Buffer(bound.clone())
    }
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
            fn resource<'a>(bound: &Self::Bound<'a>) -> wgpu::BindingResource<'a> {
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
    /// Layers that are read and written.
    ReadWriteArray(format: wgpu::TextureFormat): TextureView as TextureView => wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::ReadWrite,
        format,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    };
    /// A sampler.
    Sampler(ty: wgpu::SamplerBindingType): Sampler as Sampler => wgpu::BindingType::Sampler(ty);
}
