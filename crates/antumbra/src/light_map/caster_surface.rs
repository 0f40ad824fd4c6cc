//! Caster surfaces in the shaders' form; `caster_surface.wesl` defines how much light they stop.

use glam::{Vec3, Vec4};

use crate::contract::{Opacity, SurfaceCoverage};
use crate::gpu::shared_constants;

shared_constants! {
    pub(crate) const COVERAGE_WHOLE: u32 = 0, as in CASTER_DEPTH_CUTOUT;
    pub(crate) const COVERAGE_ALPHA: u32 = 1, as in CASTER_DEPTH_CUTOUT;
    pub(crate) const COVERAGE_CUTOFF: u32 = 2, as in EVALUATION_EVALUATE;
}

/// Values of a surface that is not opaque, without its texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceValues {
    /// Transmitted colour and alpha; multiplies the texture.
    pub(crate) factor: Vec4,
    /// Smallest alpha that blocks light, for [`COVERAGE_CUTOFF`].
    pub(crate) cutoff: f32,
    pub(crate) coverage: u32,
}

impl SurfaceValues {
    /// Returns the values of a surface, or `None` if it is opaque.
    pub(crate) fn of(opacity: &Opacity<'_>) -> Option<Self> {
        match opacity {
            Opacity::Opaque => None,
            Opacity::Masked { alpha_factor, cutoff, .. } => {
                Some(Self { factor: Vec3::ZERO.extend(*alpha_factor), cutoff: *cutoff, coverage: COVERAGE_CUTOFF })
            }
            Opacity::Translucent { coverage, transmitted, .. } => {
                let (coverage, alpha, cutoff) = match coverage {
                    SurfaceCoverage::Whole => (COVERAGE_WHOLE, 1.0, 0.0),
                    SurfaceCoverage::Alpha(alpha) => (COVERAGE_ALPHA, *alpha, 0.0),
                    SurfaceCoverage::Cutoff { alpha_factor, cutoff } => (COVERAGE_CUTOFF, *alpha_factor, *cutoff),
                };
                Some(Self { factor: transmitted.extend(alpha), cutoff, coverage })
            }
        }
    }
}
