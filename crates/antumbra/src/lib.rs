//! Soft shadows of area lights in real time, for wgpu: a light, casters and a depth buffer in, a visibility mask out.
//!
//! ```text
//!  light (shape, size in metres) ──┐
//!  casters (meshes or a depth map) ┼──► light map ──► filter ──► resolve ──► mask: 1 lit … 0 umbra
//!  receivers (your depth buffer) ──┘
//! ```
//!
//! The library uses your device and encoder, submits nothing and never blocks. Lights have a size in metres, from which most
//! techniques derive the width of each penumbra. Depth bias is derived for each receiver.
//!
//! ```no_run
//! use antumbra::light::{Light, LightShape};
//! use antumbra::{Casters, Error, Frame, Gpu, Mask, MeshCaster, Receivers, Recorder, TechniqueKind};
//! use glam::{Vec2, Vec3};
//!
//! # fn example(
//! #     device: &wgpu::Device, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder,
//! #     casters: &[MeshCaster<'_>], receivers: Receivers<'_>,
//! # ) -> Result<(), Error> {
//! // Once.
//! let gpu = Gpu::new(device, queue);
//! let mut shadow = TechniqueKind::Smrt.create(&gpu)?;
//! shadow.set("map_size", "2048")?;
//! let mask = Mask::new(device, receivers.size_px);
//! let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) };
//! let light = Light::new(shape, Vec3::new(1.5, 4.5, 2.5), Vec3::ZERO);
//!
//! // Each frame, after your depth pass and before your shading.
//! let frame = Frame { light: &light, casters: Casters::Meshes(casters), receivers, mask: &mask };
//! shadow.prepare(&frame)?.record(&mut Recorder::new(encoder, None));
//! // In your shader: radiance · textureLoad(visibility, pixel, 0).x, with mask.view() bound as visibility.
//! # Ok(())
//! # }
//! ```
//!
//! - [`TechniqueKind`] compares the techniques: penumbra, use and failure of each. The pages in [`techniques`] have the details.
//! - [`contract`] states the conventions: spaces, units, depth.
//! - [`CasterSet`] holds the meshes that many lights share. `docs/integrating.md` continues from there.
//! - [`AnyShadow`] is a light's state with a technique chosen at run time, [`Shadow`] with one known at compile time.
//! - [`Shadow::prepare_points`] takes a buffer of points in place of a depth buffer (`examples/anywhere.rs`);
//!   [`Shadow::shader_function`] returns a function for your own shaders.
//! - [`LightSet`] holds many lights of one view; each frame redraws as many as a budget allows.
//! - `examples/minimal.rs` is a complete small renderer around the lines above, `examples/many_lights` one with eight lights.
//!
//! Families of techniques are features of the crate, all on by default: `single_map`, `filterable`, `summed`, `multi_layer`,
//! `light_views`, `ray_traced`, `receiver_lists`.
// Not `forbid`: wgpu's device interface declares some functions unsafe, which `gpu/plan` implements without effect.
#![deny(unsafe_code)]
// Modules that families share contain code and shaders that only one family uses.
#![cfg_attr(
    not(all(
        feature = "filterable",
        feature = "light_views",
        feature = "multi_layer",
        feature = "ray_traced",
        feature = "receiver_lists",
        feature = "single_map",
        feature = "summed",
    )),
    allow(dead_code, unused_imports, unused_macros)
)]

#[cfg(not(any(
    feature = "filterable",
    feature = "light_views",
    feature = "multi_layer",
    feature = "ray_traced",
    feature = "receiver_lists",
    feature = "single_map",
    feature = "summed",
)))]
compile_error!(
    "antumbra has no technique: choose at least one of its features `filterable`, `light_views`, `multi_layer`, \
    `ray_traced`, `receiver_lists`, `single_map`, `summed`"
);

pub mod casters;
pub mod contract;
pub mod gpu;
mod light_map;
mod light_partition;
pub mod light_set;
mod mask;
mod primitives;
mod receivers;
mod shadow;
mod technique_kind;
pub mod techniques;
#[cfg(test)]
mod testing;

pub use antumbra_light as light;
pub use antumbra_light::ShadowDistance;
pub use casters::CasterSet;
pub use contract::{
    Camera, Denoise, DepthConvention, DepthMapCaster, DrawnLists, DrawnMap, Error, Mask, MaskChannels, MaskPlace,
    MeshCaster, MeshVersion, Opacity, Overflow, PointBuffer, PointReceivers, PointWidths, Quality, Receivers,
    SurfaceCoverage, SurfaceTexture,
};
#[doc(hidden)]
pub use gpu::programs;
pub use gpu::{
    Gpu, MemoryBytes, MemoryPlan, ObjectCounts, PassTime, PassTimer, PlannedResource, Recorder, ShaderFunction,
};
pub use light_set::{Budget, LightId, LightSet, LightSetFrame, MaskState, PreparedLights, RangedLight};
pub use receivers::split_receivers::SplitReceivers;
pub use shadow::{AnyShadow, Casters, Frame, PointFrame, Prepared, Shadow, WarmUp, WarmUpSteps};
pub use technique_kind::{OccluderModel, TechniqueFacts, TechniqueKind};
pub use techniques::Technique;
/// Crates whose types appear in this one's interface.
pub use {glam, wgpu};

/// Linked shaders, embedded as text. Each `.wesl` file with an entry point is one, named by its folder and its file.
pub(crate) mod shaders {
    macro_rules! shaders {
        ($( $(#[$only:meta])? $name:ident = $linked:literal; )+) => {
            $( $(#[$only])? pub(crate) const $name: &str = include_str!(concat!("../linked/", $linked, ".wgsl")); )+

            /// Every shader with its path under `linked/`.
            #[cfg(test)]
            pub(crate) const ALL: &[(&str, &str)] = &[$( ($linked, $name), )+];
        };
    }

    include!("../linked/shaders.rs");

    #[cfg(feature = "mutants")]
    pub(crate) use crate::gpu::mutants::text_of;

    /// Returns the text to compile for a linked shader: the text itself.
    #[cfg(not(feature = "mutants"))]
    pub(crate) fn text_of(linked: &'static str) -> std::borrow::Cow<'static, str> {
        linked.into()
    }
}

#[cfg(test)]
mod tests;
