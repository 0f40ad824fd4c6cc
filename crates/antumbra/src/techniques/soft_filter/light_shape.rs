//! A light as the soft kernels see it: bounds, mean and covariance of its points on its plane.

use antumbra_light::{Light, LightShape};
use glam::{Vec2, Vec3};

/// Points' offsets from the light map's origin, across the light's axis; metres, or tangents for a sun.
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
    /// Whether an ellipse is nearer to its shape than a parallelogram.
    pub(crate) is_round: bool,
}

impl LightSpread {
    /// Closed forms for uniform shapes, sums for textures and lists of points.
    pub(crate) fn of(light: &Light) -> Self {
        let radius = light.bounding_radius();
        // Second moments of a uniform disc, r²/4, and ball, r²/5, along an axis.
        let (extent, extent_axis, variance) = match &light.shape {
            LightShape::Rectangle { size_m } => (0.5 * *size_m, 0.0, *size_m * *size_m / 12.0),
            LightShape::Disk { radius_m } => (Vec2::splat(*radius_m), 0.0, Vec2::splat(radius_m * radius_m / 4.0)),
            LightShape::Sun { .. } => (Vec2::splat(radius), 0.0, Vec2::splat(radius * radius / 4.0)),
            LightShape::Sphere { radius_m } => (Vec2::splat(radius), radius, Vec2::splat(radius_m * radius_m / 4.0)),
            LightShape::Ellipsoid { radii_m } => {
                let across = radii_m.truncate();
                (Vec2::splat(radius), radius, across * across / 5.0)
            }
            LightShape::Points { positions_m } => {
                return Self::of_points(light, positions_m, radius);
            }
        };
        let mut spread = Self {
            extent,
            extent_axis,
            mean: Vec2::ZERO,
            covariance: Vec3::new(variance.x, 0.0, variance.y),
            is_round: !matches!(light.shape, LightShape::Rectangle { .. }),
        };
        if let (LightShape::Rectangle { size_m }, Some(texture)) = (&light.shape, &light.emission) {
            let texel = *size_m / Vec2::new(texture.width as f32, texture.height as f32);
            let points = (0..texture.height).flat_map(|row| (0..texture.width).map(move |column| (column, row)));
            // Rows run from the top.
            let points = points.zip(&texture.luminance).map(|((column, row), weight)| {
                let place = Vec2::new(column as f32 + 0.5, (texture.height - row) as f32 - 0.5);
                (place * texel - 0.5 * *size_m, *weight)
            });
            (spread.mean, spread.covariance) = moments(points);
            spread.covariance += Vec3::new(texel.x * texel.x, 0.0, texel.y * texel.y) / 12.0;
        }
        spread
    }

    fn of_points(light: &Light, positions_m: &[Vec3], radius: f32) -> Self {
        let frame = light.frame();
        let center = positions_m.iter().sum::<Vec3>() / positions_m.len() as f32;
        let offsets = positions_m.iter().map(|p| *p - center);
        let (mean, covariance) = moments(offsets.map(|p| (Vec2::new(p.dot(frame.right), p.dot(frame.up)), 1.0)));
        Self { extent: Vec2::splat(radius), extent_axis: radius, mean, covariance, is_round: true }
    }
}

/// Weighted mean and covariance; zero without weight.
fn moments(points: impl Iterator<Item = (Vec2, f32)>) -> (Vec2, Vec3) {
    let (mut weight, mut sum, mut squares) = (0.0, Vec2::ZERO, Vec3::ZERO);
    for (p, w) in points {
        weight += w;
        sum += w * p;
        squares += w * Vec3::new(p.x * p.x, p.x * p.y, p.y * p.y);
    }
    if weight <= 0.0 {
        return (Vec2::ZERO, Vec3::ZERO);
    }
    let mean = sum / weight;
    (mean, squares / weight - Vec3::new(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y))
}
