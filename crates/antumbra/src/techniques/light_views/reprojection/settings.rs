//! Settings of a frame of `reprojection` or `reprojection_layered`.

use crate::contract::param_choice;
use crate::techniques::Coverage;
use crate::techniques::light_views::PointChoice;

param_choice! {
    /// Which shader stage scatters the fragments.
    pub enum ReprojectionPath {
        /// A compute pass over the central map.
        Compute = "compute",
        /// A fragment pass over the central map: the paper's three-pass form.
        Fragment = "fragment",
        /// The fragments of the central rasterisation themselves: the paper's two-pass form.
        FragmentTwoPass = "fragment_two_pass",
    }
}

param_choice! {
    /// How the integer maps are compared with receivers.
    pub enum ReprojectionFilter {
        /// Four loads from the integers.
        Manual = "manual",
        /// Copied into a float texture, one gather.
        Copy = "copy",
        /// Drawn into a depth texture, the hardware's comparison sampler.
        Draw = "draw",
    }
}

param_choice! {
    /// What the central map is.
    pub enum ReprojectionProjection {
        /// A cube where the light's plane view would be cut, a plane elsewhere.
        Auto = "auto",
        /// One view along the light's axis.
        Plane = "plane",
        /// The faces of a cube.
        Cube = "cube",
    }
}

impl ReprojectionProjection {
    /// A cube's faces hold all that is before the light, and all around it; six planes are less work, where the light
    /// shines all around.
    pub(crate) fn coverage(self) -> Coverage {
        match self {
            Self::Auto => Coverage::HalfSpace,
            Self::Plane => Coverage::Window,
            Self::Cube => Coverage::Everything,
        }
    }
}

/// Where a fragment is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Splat {
    /// In the texel that it falls in.
    Point,
    /// There, if it is no farther from the texel's centre than this, texels.
    NearCentre(f32),
    /// In every texel whose centre lies in its footprint, its slope held at this (depth per width).
    Surfel(f32),
}

/// Which fragments there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// The nearest layers, scattered from maps by compute.
    LayersByCompute(u32),
    /// The nearest layer, scattered from a map by a fragment pass.
    LayerByFragments,
    /// While rasterising: what passes the depth test until then.
    NearestWhileRasterising,
    /// While rasterising: everything.
    AllWhileRasterising,
}

/// One frame's settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) view_size: u32,
    pub(crate) central_size: u32,
    pub(crate) points: PointChoice,
    pub(crate) splat: Splat,
    pub(crate) source: Source,
    pub(crate) synchronized: bool,
    /// Whether points that meet in a texel are brought together before they are stored.
    pub(crate) brings_together: bool,
    pub(crate) filter: ReprojectionFilter,
    pub(crate) projection: ReprojectionProjection,
    pub(crate) bias_before: bool,
    pub(crate) bias_scale: f32,
}

impl Settings {
    /// Whether the central view may be from behind the light: points would leave gaps where views see them from nearer, and fragments
    /// that are scattered while they are rasterised are not told from those behind the light.
    pub(crate) fn may_be_from_behind(&self) -> bool {
        matches!((self.splat, self.source), (Splat::Surfel(_), Source::LayersByCompute(_)))
            && self.projection == ReprojectionProjection::Auto
    }
}

impl Source {
    /// Whether the central views are drawn first, and scattered then.
    pub(crate) fn needs_central_map(self) -> bool {
        matches!(self, Self::LayersByCompute(_) | Self::LayerByFragments)
    }

    /// Layers of each central view that are kept.
    pub(crate) fn layers(self) -> u32 {
        if let Self::LayersByCompute(layers) = self { layers } else { 1 }
    }
}
