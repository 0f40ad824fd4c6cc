//! Light shape for the soft kernels: bounds, mean and covariance of the light's points on its plane.

use antumbra_light::{Light, LightShape};
use glam::{Vec2, Vec3};

/// Distribution of light points' offsets from the light map's origin, across the light's axis; metres, or tangents for a sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightSpread {
    /// Bounds along right and up.
    pub(crate) extent: Vec2,
    /// Bound along the axis.
    pub(crate) extent_axis: f32,
    /// Mean, weighted by emission.
    pub(crate) mean: Vec2,
    /// (xx, xy, yy) about the mean.
    pub(crate) covariance: Vec3,
    /// Whether an ellipse approximates the shape better than a parallelogram.
    pub(crate) is_round: bool,
}

impl LightSpread {
    pub(crate) fn of(light: &Light) -> Self {
        let moments = light.moments();
        let all_round = (Vec2::splat(moments.radius), moments.radius);
        let (extent, extent_axis) = match &light.shape {
            LightShape::Rectangle { size_m } => (0.5 * *size_m, 0.0),
            LightShape::Disk { .. } | LightShape::Sun { .. } => (moments.half_extent.truncate(), 0.0),
            LightShape::Sphere { .. } | LightShape::Ellipsoid { .. } | LightShape::Points { .. } => all_round,
        };
        Self {
            extent,
            extent_axis,
            // The view of a list of points is from their mean.
            mean: if matches!(light.shape, LightShape::Points { .. }) { Vec2::ZERO } else { moments.mean.truncate() },
            covariance: Vec3::new(moments.variance.x, moments.covariance.x, moments.variance.y),
            is_round: !matches!(light.shape, LightShape::Rectangle { .. }),
        }
    }
}
