//! Real-time soft shadows for wgpu: a light, casters and a depth buffer in, a visibility mask out.
//!
//! ```text
//!  light (shape, size in metres) ──┐
//!  casters (meshes or a depth map) ┼──► light map ──► filter ──► resolve ──► mask: 1 lit … 0 umbra
//!  receivers (your depth buffer) ──┘
//! ```
//!
//! The library uses the device that you have, records into your encoder, submits nothing and blocks on nothing. The
//! penumbra follows from the light's physical size, and the bias from each receiver's plane: there is no softness and
//! no bias to tune.
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
//! let mut shadow = TechniqueKind::Pcss.create(&gpu)?;
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
//! `examples/minimal.rs` is a whole small renderer around these lines. A host with many lights, moving casters or vertices of its
//! own formats keeps a [`CasterSet`], which all its lights share: `docs/integrating.md` goes on from there, and
//! `examples/many_lights` is such a host.
//!
//! | technique | source | penumbra | light maps | what it misses |
//! |---|---|---|---|---|
//! | [`hard`](techniques::single_map::hard) | Williams 1978 | none | 1 | every penumbra |
//! | [`pcf`](techniques::single_map::pcf) | Reeves et al. 1987 | of one width | 1 | contact hardening |
//! | [`pcss`](techniques::single_map::pcss) | Fernando 2005 | from an averaged blocker a layer | 3 | near and far occluders side by side |
//! | [`multi_view`](techniques::light_views::multi_view) | Heckbert, Herf 1997 | as true as its samples | one a sample | your frame budget |
//! | [`vsm`](techniques::filterable::vsm) | Donnelly, Lauritzen 2006 | of one width | 1, filtered | overlapping occluders |
//! | [`lvsm`](techniques::filterable::lvsm) | Lauritzen, McCool 2008 | of one width | 1, filtered, in layers | foliage |
//! | [`evsm`](techniques::filterable::evsm) | Lauritzen, McCool 2008 | of one width | 1, filtered | foliage, deep ranges |
//! | [`esm`](techniques::filterable::esm) | Annen et al. 2008 | of one width | 1, filtered | contacts |
//! | [`convolution`](techniques::filterable::convolution) | Annen et al. 2007 | of one width | 1, filtered | contacts |
//! | [`moment`](techniques::filterable::moment) | Peters, Klein 2015 | of one width | 1, filtered | three occluders and more |
//! | [`pcss_anisotropic`](techniques::single_map::pcss_anisotropic) | Shen et al. 2011 | the same, over the pixel too | 1 | layered occluders |
//! | [`essm`](techniques::summed::essm) | Shen et al. 2013 | the same, in constant time | 1 | layered occluders |
//! | [`savsm`](techniques::summed::savsm) | Lauritzen 2007 | from two moments | 1 | overlapping occluders |
//! | [`vssm`](techniques::summed::vssm) | Yang et al. 2010 | the same, in constant time | 1 | overlapping occluders |
//! | [`cssm`](techniques::summed::cssm) | Annen et al. 2008 | from a Fourier series | 1 | contacts |
//! | [`evssm`](techniques::summed::evssm) | Lauritzen, McCool 2008 | from warped moments | 1 | layered occluders |
//! | [`mssm`](techniques::summed::mssm) | Peters et al. 2017 | from four moments | 1 | layered occluders |
//! | [`multi_layer`](techniques::multi_layer) | Selgrad et al. 2014 | of each occluder, opaque or tinted | 1, of lists | occluders finer than a texel |
//! | [`reprojection`](techniques::light_views::reprojection) | Marrs et al. 2014 | as true as its samples | one central map | what the light's middle does not see |
//! | [`reprojection_layered`](techniques::light_views::reprojection_layered) | after Marrs et al. 2014 | as true as its samples | a few layers of one | silhouettes within a texel |
//! | [`alias_free`](techniques::receiver_lists::alias_free) | Sintorn et al. 2008 | none | none | every penumbra |
//! | [`sample_based`](techniques::receiver_lists::sample_based) | Sintorn et al. 2008 | exact for its samples | none | your frame budget, in foliage |
//!
//! Each of their pages says where it fails. Conventions (spaces, units, depth) are stated once, in [`contract`].
//!
//! Families of techniques are features of the crate, all on by default: `single_map`, `filterable`, `summed`, `multi_layer`,
//! `light_views`, `receiver_lists`. A host that wants one compiles one.
//!
//! A technique chosen while the program runs makes an [`AnyShadow`]; one known at compile time a [`Shadow`] with its own
//! parameter struct.
#![forbid(unsafe_code)]
// Rooms that families share hold what one family alone uses, and its shaders.
#![cfg_attr(
    not(all(
        feature = "filterable",
        feature = "light_views",
        feature = "multi_layer",
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
    feature = "receiver_lists",
    feature = "single_map",
    feature = "summed",
)))]
compile_error!(
    "antumbra has no technique: choose at least one of its features `filterable`, `light_views`, `multi_layer`, \
    `receiver_lists`, `single_map`, `summed`"
);

pub mod casters;
pub mod contract;
mod cover;
mod frame;
pub mod gpu;
mod light_map;
mod primitives;
mod shadow;
pub mod techniques;
#[cfg(test)]
mod testing;

pub use antumbra_light as light;
pub use casters::CasterSet;
pub use contract::{
    Casters, Denoise, DepthConvention, DepthMapCaster, Error, Frame, Mask, MaskChannels, MaskPlace, MeshCaster,
    Opacity, Overflow, Quality, Receivers, SurfaceTexture,
};
pub use frame::split_receivers::SplitReceivers;
pub use gpu::{Gpu, PassTime, PassTimer, Recorder};
pub use shadow::{AnyShadow, Prepared, Shadow, WarmUp};
pub use techniques::{Technique, TechniqueKind};

/// The linked shaders, embedded.
pub(crate) mod shaders {
    macro_rules! shaders {
        ($(
            $(#[doc = $doc:literal])* $(#[cfg($only:ident)])?
            $name:ident = $path:literal $(with $features:literal)?;
        )+) => {
            $( $(#[doc = $doc])* $(#[cfg($only)])? pub(crate) const $name: &str =
                include_str!(concat!("../linked/", linked_file!($($only)? $path $(with $features)?))); )+

            /// Every shader with its path.
            #[cfg(test)]
            pub(crate) const ALL: &[(&str, &str)] = &[$( (concat!($path, $(" with ", $features)?), $name), )+];
        };
    }

    include!("shaders.rs");

    #[cfg(feature = "mutants")]
    pub(crate) use crate::gpu::mutants::text_of;

    /// What is compiled for a linked shader: itself.
    #[cfg(not(feature = "mutants"))]
    pub(crate) fn text_of(linked: &'static str) -> std::borrow::Cow<'static, str> {
        linked.into()
    }
}

#[cfg(test)]
mod tests;
