//! Bind groups and views of a frame, cached from earlier frames by their descriptors.

use std::hash::{BuildHasher, Hash, Hasher};
use std::num::NonZeroU64;

use hashbrown::DefaultHashBuilder;

use super::{RetainedState, Stage, Used};

/// Cached bind group with its layout and resources. Every frame looks it up by reference, so that a hit clones no key.
#[derive(Debug)]
pub(super) struct CachedGroup {
    hash: u64,
    layout: wgpu::BindGroupLayout,
    resources: Vec<(u32, Resource)>,
    pub(super) group: Used<wgpu::BindGroup>,
}

/// Resource of a bind group at a binding.
#[derive(Debug)]
pub(crate) enum Resource {
    Buffer(wgpu::Buffer, u64, Option<NonZeroU64>),
    View(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

/// Cached view, with its texture and the part of it.
#[derive(Debug)]
pub(super) struct CachedView {
    texture: wgpu::Texture,
    part: TexturePart,
    pub(super) view: Used<wgpu::TextureView>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct TexturePart {
    format: Option<wgpu::TextureFormat>,
    dimension: Option<wgpu::TextureViewDimension>,
    usage: Option<wgpu::TextureUsages>,
    aspect: wgpu::TextureAspect,
    mips: (u32, Option<u32>),
    layers: (u32, Option<u32>),
}

impl Stage<'_> {
    /// Returns a bind group, cached by layout and resources.
    pub(crate) fn create_bind_group(&self, descriptor: &wgpu::BindGroupDescriptor<'_>) -> wgpu::BindGroup {
        let RetainedState { frame, hashes, groups, .. } = &mut *self.keep.borrow_mut();
        let hash = hash_of_group(hashes, descriptor);
        if let Some(kept) = groups.find_mut(hash, |kept| kept.is_of(descriptor)) {
            kept.group.frame = *frame;
            return kept.group.value.clone();
        }
        let value = self.gpu.device.create_bind_group(descriptor);
        let kept = CachedGroup {
            hash,
            layout: descriptor.layout.clone(),
            resources: descriptor.entries.iter().map(|entry| (entry.binding, Resource::of(&entry.resource))).collect(),
            group: Used { value: value.clone(), frame: *frame },
        };
        groups.insert_unique(hash, kept, |kept| kept.hash);
        value
    }

    /// Returns a view of a texture, cached by texture and descriptor.
    pub(crate) fn create_view(
        &self,
        texture: &wgpu::Texture,
        descriptor: &wgpu::TextureViewDescriptor<'_>,
    ) -> wgpu::TextureView {
        let part = TexturePart {
            format: descriptor.format,
            dimension: descriptor.dimension,
            usage: descriptor.usage,
            aspect: descriptor.aspect,
            mips: (descriptor.base_mip_level, descriptor.mip_level_count),
            layers: (descriptor.base_array_layer, descriptor.array_layer_count),
        };
        let RetainedState { frame, hashes, views, .. } = &mut *self.keep.borrow_mut();
        let hash = hashes.hash_one((texture, &part));
        if let Some(kept) = views.find_mut(hash, |kept| (&kept.texture, &kept.part) == (texture, &part)) {
            kept.view.frame = *frame;
            return kept.view.value.clone();
        }
        let value = self.gpu.device.create_view(texture, descriptor);
        let kept = CachedView { texture: texture.clone(), part, view: Used { value: value.clone(), frame: *frame } };
        views.insert_unique(hash, kept, |kept| hashes.hash_one((&kept.texture, &kept.part)));
        value
    }
}

impl CachedGroup {
    fn is_of(&self, descriptor: &wgpu::BindGroupDescriptor<'_>) -> bool {
        self.layout == *descriptor.layout
            && self.resources.len() == descriptor.entries.len()
            && self
                .resources
                .iter()
                .zip(descriptor.entries)
                .all(|((binding, resource), entry)| *binding == entry.binding && resource.is(&entry.resource))
    }
}

impl Resource {
    /// Binding resource for a bind group entry.
    pub(crate) fn binding(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Buffer(buffer, offset, size) => {
                wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: *offset, size: *size })
            }
            Self::View(view) => wgpu::BindingResource::TextureView(view),
            Self::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
        }
    }

    pub(crate) fn of(bound: &wgpu::BindingResource<'_>) -> Self {
        match bound {
            wgpu::BindingResource::Buffer(part) => Self::Buffer(part.buffer.clone(), part.offset, part.size),
            wgpu::BindingResource::TextureView(view) => Self::View((*view).clone()),
            wgpu::BindingResource::Sampler(sampler) => Self::Sampler((*sampler).clone()),
            other => unreachable!("the library binds no {other:?}"),
        }
    }

    fn is(&self, bound: &wgpu::BindingResource<'_>) -> bool {
        match (self, bound) {
            (Self::Buffer(buffer, offset, size), wgpu::BindingResource::Buffer(part)) => {
                (buffer, *offset, *size) == (part.buffer, part.offset, part.size)
            }
            (Self::View(view), wgpu::BindingResource::TextureView(bound)) => view == *bound,
            (Self::Sampler(sampler), wgpu::BindingResource::Sampler(bound)) => sampler == *bound,
            _ => false,
        }
    }
}

/// Hash of the layout and the bound resources, in order.
fn hash_of_group(hashes: &DefaultHashBuilder, descriptor: &wgpu::BindGroupDescriptor<'_>) -> u64 {
    let mut hasher = hashes.build_hasher();
    descriptor.layout.hash(&mut hasher);
    for entry in descriptor.entries {
        match &entry.resource {
            wgpu::BindingResource::Buffer(part) => (part.buffer, part.offset).hash(&mut hasher),
            wgpu::BindingResource::TextureView(view) => view.hash(&mut hasher),
            wgpu::BindingResource::Sampler(sampler) => sampler.hash(&mut hasher),
            other => unreachable!("the library binds no {other:?}"),
        }
    }
    hasher.finish()
}
