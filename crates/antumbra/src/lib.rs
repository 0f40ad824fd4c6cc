//! Real-time soft shadows for wgpu: a light, casters and a depth buffer in, a visibility mask out.
#![forbid(unsafe_code)]

mod blocks;
pub mod contract;
pub mod gpu;
pub mod techniques;

pub use antumbra_light as light;
pub use contract::{
    AnyTechnique, Casters, DepthConvention, DepthMapCaster, Error, Frame, Mask, MeshCaster, Opacity, Receivers,
    SurfaceTexture, Technique, TechniqueKind,
};
pub use gpu::{Gpu, PassTime, PassTimer, Recorder};

/// The linked shaders, embedded.
pub(crate) mod shaders {
    macro_rules! shaders {
        ($( $(#[$doc:meta])* $name:ident = $path:literal; )+) => {
            $( $(#[$doc])* pub(crate) const $name: &str =
                include_str!(concat!(env!("OUT_DIR"), "/", $path, ".wgsl")); )+

            /// Every shader with its path.
            #[cfg(test)]
            pub(crate) const ALL: &[(&str, &str)] = &[$( ($path, $name), )+];
        };
    }

    include!("shaders.rs");
}

#[cfg(test)]
mod tests;
