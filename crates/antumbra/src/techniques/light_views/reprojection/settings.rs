//! Settings of a frame of `reprojection` or `reprojection_layered`.

use crate::contract::param_choice;
use crate::techniques::Coverage;
use crate::techniques::light_views::PointChoice;

param_choice! {
    /// Shader stage that scatters the fragments.
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
    /// Comparison of the integer maps with receivers.
    pub enum ReprojectionFilter {
        /// Four loads from the integers.
        Manual = "manual",
        /// A copy in a float texture, read by one gather.
        Copy = "copy",
        /// A depth texture that they are drawn into, read by the hardware's comparison sampler.
        Draw = "draw",
    }
}

param_choice! {
    /// Shape of the central map.
    pub enum ReprojectionProjection {
        /// A cube if the light's plane view would be cut, otherwise a plane.
        Auto = "auto",
        /// One view along the light's axis.
        Plane = "plane",
        /// The faces of a cube.
        Cube = "cube",
    }
}

impl ReprojectionProjection {
    /// Directions that the central map covers. A cube's faces cover everything in front of the light, or all around it; six
    /// planes are less work if the light shines all around.
    pub(crate) fn coverage(self) -> Coverage {
        match self {
            Self::Auto => Coverage::HalfSpace,
            Self::Plane => Coverage::Window,
            Self::Cube => Coverage::Everything,
        }
    }
}

/// Texels in which a fragment is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Splat {
    /// The texel that it falls in.
    Point,
    /// The texel that it falls in, if it is at most this far from the texel's centre, texels.
    NearCentre(f32),
    /// Every texel whose centre lies in its footprint; its slope is limited to this, depth per width.
    Surfel(f32),
}

/// Source of the fragments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// The nearest layers, scattered from maps by compute.
    LayersByCompute(u32),
    /// The nearest layer, scattered from a map by a fragment pass.
    LayerByFragments,
    /// Fragments that pass the depth test, in the order of drawing, scattered while rasterising.
    NearestWhileRasterising,
    /// All fragments, scattered while rasterising.
    AllWhileRasterising,
}

/// Settings of one frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) view_size: u32,
    pub(crate) central_size: u32,
    pub(crate) points: PointChoice,
    pub(crate) splat: Splat,
    pub(crate) source: Source,
    pub(crate) synchronized: bool,
    /// Whether points that fall into one texel are merged before they are stored.
    pub(crate) brings_together: bool,
    pub(crate) filter: ReprojectionFilter,
    pub(crate) projection: ReprojectionProjection,
    pub(crate) bias_before: bool,
    pub(crate) bias_scale: f32,
}

impl Settings {
    /// Whether the central view may be from behind the light. Points would leave gaps in views that see them from nearer, and a
    /// scatter while rasterising does not leave out fragments behind the light.
    pub(crate) fn may_be_from_behind(&self) -> bool {
        matches!((self.splat, self.source), (Splat::Surfel(_), Source::LayersByCompute(_)))
            && self.projection == ReprojectionProjection::Auto
    }
}

impl Source {
    /// Whether the central views are drawn to maps before they are scattered.
    pub(crate) fn needs_central_map(self) -> bool {
        matches!(self, Self::LayersByCompute(_) | Self::LayerByFragments)
    }

    /// Number of layers of each central view that are kept.
    pub(crate) fn layers(self) -> u32 {
        if let Self::LayersByCompute(layers) = self { layers } else { 1 }
    }
}
