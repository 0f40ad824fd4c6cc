//! Extent and covariance of a light's points, to which maps, margins and kernels are fitted.

use glam::{DVec2, DVec3, UVec2, Vec2, Vec3};

use crate::{EmissionTexture, Light, LightFrame, LightShape};

/// Moments of a light's points, weighted by emission, and bounds of the emitting part.
///
/// All are along the light's own axes: right, up, axis of [`LightFrame`]. Lengths are in metres. For a sun they are tangents of
/// angles, because its points are directions on the tangent plane at distance 1, relative to the sun's middle.
///
/// A sphere's points lie on a disc that faces the receiver. Its covariance is the same from everywhere: a disc's along every axis,
/// so that across any line of sight it is that disc's. Its bounds are the ball's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightMoments {
    /// Mean point, relative to the light's centre. Not zero if emission or a list of points leans to one side.
    pub mean: Vec3,
    /// Variances along right, up and axis, about the mean.
    pub variance: Vec3,
    /// Covariances of right and up, of up and axis, of axis and right.
    pub covariance: Vec3,
    /// Half sides of the smallest box centred on the mean that contains the emitting part. For a texture or a list of points, that
    /// part may reach less far on one of two opposite sides.
    pub half_extent: Vec3,
    /// Radius of the smallest sphere centred on the mean that contains the emitting part.
    pub radius: f32,
}

/// Rectangle across the light's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquivalentRectangle {
    /// Centre of the rectangle, along right and up from the light's centre.
    pub middle: Vec2,
    /// Full sides, the longer first.
    pub size: Vec2,
    /// Angle of the first side, from right towards up, radians, −π/2 to π/2; 0 if both sides are equal.
    pub angle_rad: f32,
}

impl Light {
    /// Mean, covariance and bounds of this light's points: closed forms for uniform shapes, sums for a texture and for a
    /// list of points.
    ///
    /// The light must be valid ([`Light::validate`]). All are zero for a texture that is dark everywhere and for an empty list.
    pub fn moments(&self) -> LightMoments {
        match (&self.shape, &self.emission) {
            (LightShape::Rectangle { size_m }, Some(texture)) => of_texture(*size_m, texture),
            // Variance of a side: its length squared over 12.
            (LightShape::Rectangle { size_m }, None) => {
                let half = 0.5 * *size_m;
                LightMoments::centered((half * half / 3.0).extend(0.0), half.extend(0.0), half.length())
            }
            (LightShape::Disk { radius_m }, _) => LightMoments::of_disc(*radius_m),
            (LightShape::Sun { angular_diameter_rad }, _) => LightMoments::of_disc((0.5 * angular_diameter_rad).tan()),
            (LightShape::Sphere { radius_m }, _) => {
                LightMoments::centered(Vec3::splat(radius_m * radius_m / 4.0), Vec3::splat(*radius_m), *radius_m)
            }
            // Variance of a ball along each axis: r²/5.
            (LightShape::Ellipsoid { radii_m }, _) => {
                LightMoments::centered(*radii_m * *radii_m / 5.0, *radii_m, radii_m.max_element())
            }
            (LightShape::Points { positions_m }, _) => of_points(&self.frame(), positions_m),
        }
    }
}

impl LightMoments {
    fn centered(variance: Vec3, half_extent: Vec3, radius: f32) -> Self {
        Self { mean: Vec3::ZERO, variance, covariance: Vec3::ZERO, half_extent, radius }
    }

    /// Moments of a disc: variance r²/4 along each axis in its plane.
    fn of_disc(radius: f32) -> Self {
        let across = |v: f32| Vec3::new(v, v, 0.0);
        Self::centered(across(radius * radius / 4.0), across(radius), radius)
    }

    /// Mean point in world space; not defined for a sun.
    pub fn mean_in_world(&self, frame: &LightFrame) -> Vec3 {
        frame.center + frame.right * self.mean.x + frame.up * self.mean.y + frame.axis * self.mean.z
    }

    /// Sides along right and up of the uniform rectangle with these variances: √12 σ. Equal to the size of a uniform rectangle
    /// light.
    pub fn equivalent_size(&self) -> Vec2 {
        side_of(self.variance.truncate())
    }

    /// Uniform rectangle across the axis with this mean and covariance, along the covariance's principal axes: points in a slanted
    /// line give a slanted line.
    pub fn equivalent_rectangle(&self) -> EquivalentRectangle {
        let Vec3 { x: xx, y: yy, .. } = self.variance;
        let xy = self.covariance.x;
        // Eigenvalues of [[xx, xy], [xy, yy]]: the mean of the variances, plus and minus `half_way`.
        let (middle, half_way) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        // Below rounding there is no direction.
        let is_even = half_way <= 1e-6 * middle;
        EquivalentRectangle {
            middle: self.mean.truncate(),
            size: side_of(Vec2::new(middle + half_way, (middle - half_way).max(0.0))),
            angle_rad: if is_even { 0.0 } else { 0.5 * (2.0 * xy).atan2(xx - yy) },
        }
    }
}

/// Lengths of uniform lines with these variances: a line of length s has variance s²/12.
fn side_of(variance: Vec2) -> Vec2 {
    Vec2::new((12.0 * variance.x).sqrt(), (12.0 * variance.y).sqrt())
}

/// Weighted sums in double precision, relative to a point near all samples.
#[derive(Default)]
struct Sums {
    weight: f64,
    first: DVec3,
    squares: DVec3,
    products: DVec3,
}

impl Sums {
    fn add(&mut self, p: DVec3, weight: f64) {
        self.weight += weight;
        self.first += weight * p;
        self.squares += weight * p * p;
        self.products += weight * DVec3::new(p.x * p.y, p.y * p.z, p.z * p.x);
    }

    /// Mean, variances, covariances.
    fn moments(&self) -> (DVec3, DVec3, DVec3) {
        if self.weight <= 0.0 {
            return Default::default();
        }
        let mean = self.first / self.weight;
        let products = DVec3::new(mean.x * mean.y, mean.y * mean.z, mean.z * mean.x);
        let variance = (self.squares / self.weight - mean * mean).max(DVec3::ZERO);
        (mean, variance, self.products / self.weight - products)
    }
}

/// Moments of a rectangle of texels, each uniform.
fn of_texture(size_m: Vec2, texture: &EmissionTexture) -> LightMoments {
    let count = UVec2::new(texture.width, texture.height);
    let texel = size_m.as_dvec2() / count.as_dvec2();
    let first_corner = -0.5 * size_m.as_dvec2();
    // Rows run from the top.
    let corner = |i: usize| {
        let (column, row) = (i as u32 % count.x, i as u32 / count.x);
        first_corner + DVec2::new(f64::from(column), f64::from(count.y - 1 - row)) * texel
    };
    let lit = || texture.luminance.iter().enumerate().filter(|(_, luminance)| **luminance > 0.0);
    let mut sums = Sums::default();
    for (i, luminance) in lit() {
        sums.add((corner(i) + 0.5 * texel).extend(0.0), f64::from(*luminance));
    }
    let (mean, variance, covariance) = sums.moments();
    let (mut half_extent, mut radius) = (DVec2::ZERO, 0.0f64);
    for (i, _) in lit() {
        let (low, high) = (corner(i) - mean.truncate(), corner(i) + texel - mean.truncate());
        let reach = low.abs().max(high.abs());
        half_extent = half_extent.max(reach);
        radius = radius.max(reach.length());
    }
    // Add the variance within a texel.
    let variance = if sums.weight > 0.0 { variance + (texel * texel / 12.0).extend(0.0) } else { variance };
    LightMoments {
        mean: mean.as_vec3(),
        variance: variance.as_vec3(),
        covariance: covariance.as_vec3(),
        half_extent: half_extent.extend(0.0).as_vec3(),
        radius: radius as f32,
    }
}

/// Moments of points of equal weight, wherever the light's centre is.
fn of_points(frame: &LightFrame, positions_m: &[Vec3]) -> LightMoments {
    let Some(first) = positions_m.first() else { return LightMoments::centered(Vec3::ZERO, Vec3::ZERO, 0.0) };
    let [right, up, axis] = [frame.right, frame.up, frame.axis].map(|v| v.as_dvec3());
    let along_axes = |offset: DVec3| DVec3::new(offset.dot(right), offset.dot(up), offset.dot(axis));
    // Relative to the first point, so that points far from the origin lose no precision.
    let offsets = || positions_m.iter().map(|p| along_axes(p.as_dvec3() - first.as_dvec3()));
    let mut sums = Sums::default();
    offsets().for_each(|p| sums.add(p, 1.0));
    let (mean, variance, covariance) = sums.moments();
    let half_extent = offsets().fold(DVec3::ZERO, |reach, p| reach.max((p - mean).abs()));
    let radius = offsets().fold(0.0, |reach: f64, p| reach.max(p.distance(mean)));
    LightMoments {
        mean: (along_axes(first.as_dvec3() - frame.center.as_dvec3()) + mean).as_vec3(),
        variance: variance.as_vec3(),
        covariance: covariance.as_vec3(),
        half_extent: half_extent.as_vec3(),
        radius: radius as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SampleSet;

    fn light(shape: LightShape) -> Light {
        // Askew, so that no axis is the world's.
        Light::new(shape, Vec3::new(1.0, 4.0, -2.0), Vec3::new(0.3, 0.1, 0.7))
    }

    fn assert_close(got: Vec3, want: Vec3, most: f32, what: &str) {
        assert!((got - want).abs().max_element() <= most, "{what}: {got}, want {want}");
    }

    fn points_in(frame: &LightFrame, offsets: &[Vec3]) -> Vec<Vec3> {
        let at = |p: &Vec3| frame.center + frame.right * p.x + frame.up * p.y + frame.axis * p.z;
        offsets.iter().map(at).collect()
    }

    #[test]
    fn uniform_shapes_have_their_closed_forms() {
        let cases = [
            (
                LightShape::Rectangle { size_m: Vec2::new(0.6, 0.8) },
                Vec3::new(0.03, 0.16 / 3.0, 0.0),
                Vec3::new(0.3, 0.4, 0.0),
                0.5,
            ),
            (LightShape::Disk { radius_m: 0.4 }, Vec3::new(0.04, 0.04, 0.0), Vec3::new(0.4, 0.4, 0.0), 0.4),
            (LightShape::Sphere { radius_m: 0.4 }, Vec3::splat(0.04), Vec3::splat(0.4), 0.4),
            (
                LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) },
                Vec3::new(0.05, 0.008, 0.018),
                Vec3::new(0.5, 0.2, 0.3),
                0.5,
            ),
            (
                LightShape::Sun { angular_diameter_rad: 2.0 * 0.1f32.atan() },
                Vec3::new(0.0025, 0.0025, 0.0),
                Vec3::new(0.1, 0.1, 0.0),
                0.1,
            ),
        ];
        for (shape, variance, half_extent, radius) in cases {
            let what = format!("{shape:?}");
            let light = light(shape);
            let moments = light.moments();
            assert_eq!((moments.mean, moments.covariance), (Vec3::ZERO, Vec3::ZERO), "{what}");
            assert_close(moments.variance, variance, 1e-7, &what);
            assert_close(moments.half_extent, half_extent, 1e-6, &what);
            assert!((moments.radius - radius).abs() < 1e-6, "{what}: {}", moments.radius);
            assert!((moments.radius - light.bounding_radius()).abs() < 1e-6, "{what}");
            if !light.is_distant() {
                assert_eq!(moments.mean_in_world(&light.frame()), light.center, "{what}");
            }
        }
    }

    #[test]
    fn sampled_points_have_these_moments_and_lie_within_these_bounds() {
        let spot = EmissionTexture::gray(3, 2, vec![0.0, 1.0, 4.0, 0.0, 0.5, 0.0]);
        let size_m = Vec2::new(0.6, 0.8);
        let textured = Light { emission: Some(spot), ..light(LightShape::Rectangle { size_m }) };
        let offsets = [Vec3::new(0.2, -0.1, 0.4), Vec3::new(-0.5, 0.3, 0.0), Vec3::new(0.9, 0.2, 0.1)];
        let points = LightShape::Points { positions_m: points_in(&textured.frame(), &offsets) };
        let lights = [
            light(LightShape::Rectangle { size_m }),
            textured,
            light(LightShape::Disk { radius_m: 0.4 }),
            light(LightShape::Sphere { radius_m: 0.4 }),
            light(LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) }),
            light(LightShape::Sun { angular_diameter_rad: 0.2 }),
            light(points),
        ];
        for light in lights {
            let what = format!("{:?}", light.shape);
            let (frame, moments) = (light.frame(), light.moments());
            // On the axis, so that a sphere's disc is perpendicular to it and has no variance along it.
            let seen_from = frame.center + 10.0 * frame.axis;
            let mut sums = Sums::default();
            for u in SampleSet::R2.points(3 * 4096, 1) {
                let point = light.point(&frame, u, seen_from);
                let offset = if light.is_distant() { point.xyz + frame.axis } else { point.xyz - frame.center };
                let along = Vec3::new(offset.dot(frame.right), offset.dot(frame.up), offset.dot(frame.axis));
                sums.add(along.as_dvec3(), f64::from(point.weight));
                if point.weight > 0.0 {
                    let from_mean = along - moments.mean;
                    assert!(from_mean.length() <= moments.radius + 1e-5, "{what}: {from_mean}");
                    assert!(from_mean.abs().cmple(moments.half_extent + 1e-5).all(), "{what}: {from_mean}");
                }
            }
            let (mean, variance, covariance) = sums.moments();
            let is_sphere = matches!(light.shape, LightShape::Sphere { .. });
            let expected = if is_sphere { moments.variance.with_z(0.0) } else { moments.variance };
            assert_close(mean.as_vec3(), moments.mean, 1e-3, &what);
            assert_close(variance.as_vec3(), expected, 3e-4, &what);
            assert_close(covariance.as_vec3(), moments.covariance, 3e-4, &what);
        }
    }

    #[test]
    fn a_texture_lit_in_part_is_the_rectangle_of_that_part() {
        let size_m = Vec2::new(0.8, 0.4);
        let with = |luminance: [f32; 8]| {
            let emission = EmissionTexture::gray(4, 2, luminance.to_vec());
            Light { emission: Some(emission), ..light(LightShape::Rectangle { size_m }) }.moments()
        };
        let whole = with([2.0; 8]);
        let plain = light(LightShape::Rectangle { size_m }).moments();
        assert_close(whole.variance, plain.variance, 1e-7, "all of it");
        assert_close(whole.half_extent, plain.half_extent, 1e-6, "all of it");
        assert!((whole.radius - plain.radius).abs() < 1e-6);
        // The upper row's two texels to the right: 0.4 by 0.2 at (0.2, 0.1).
        let part = with([0.0, 0.0, 3.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
        assert_close(part.mean, Vec3::new(0.2, 0.1, 0.0), 1e-7, "a part");
        assert_close(part.variance, Vec3::new(0.16, 0.04, 0.0) / 12.0, 1e-7, "a part");
        assert_close(part.half_extent, Vec3::new(0.2, 0.1, 0.0), 1e-6, "a part");
        assert!((part.radius - 0.05f32.sqrt()).abs() < 1e-6, "{}", part.radius);
        assert!((part.equivalent_size() - Vec2::new(0.4, 0.2)).abs().max_element() < 1e-6);
        // Three times as bright to the right as to the left.
        let leaning = with([1.0, 1.0, 3.0, 3.0, 1.0, 1.0, 3.0, 3.0]);
        assert_close(leaning.mean, Vec3::new(0.1, 0.0, 0.0), 1e-7, "leaning");
        assert_close(leaning.half_extent, Vec3::new(0.5, 0.2, 0.0), 1e-6, "leaning");
        // All dark: the light is invalid, but no number is NaN.
        let dark = with([0.0; 8]);
        assert_eq!(dark, LightMoments::centered(Vec3::ZERO, Vec3::ZERO, 0.0));
    }

    #[test]
    fn points_are_taken_about_their_own_mean_wherever_the_centre_is() {
        let base = light(LightShape::Sphere { radius_m: 1.0 });
        let frame = base.frame();
        let square = [
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(-1.0, 1.0, 0.0),
            Vec3::new(-1.0, -1.0, 0.0),
            Vec3::new(1.0, -1.0, 0.0),
        ];
        let shifted = square.map(|p| p + Vec3::new(3.0, 0.0, 0.5));
        let moments = light(LightShape::Points { positions_m: points_in(&frame, &shifted) }).moments();
        assert_close(moments.mean, Vec3::new(3.0, 0.0, 0.5), 1e-5, "mean");
        assert_close(moments.variance, Vec3::new(1.0, 1.0, 0.0), 1e-5, "variance");
        assert_close(moments.half_extent, Vec3::new(1.0, 1.0, 0.0), 1e-5, "half extent");
        // About the mean, not about the centre, which is 3 m away.
        assert!((moments.radius - 2f32.sqrt()).abs() < 1e-5, "{}", moments.radius);
        let in_world = moments.mean_in_world(&frame);
        let mean = points_in(&frame, &shifted).iter().sum::<Vec3>() / 4.0;
        assert_close(in_world, mean, 1e-5, "in world");
        // One point has no extent.
        let one = light(LightShape::Points { positions_m: vec![Vec3::new(1e4, 2.0, 3.0)] }).moments();
        assert_eq!((one.variance, one.half_extent, one.radius), (Vec3::ZERO, Vec3::ZERO, 0.0));
        assert_eq!(light(LightShape::Points { positions_m: Vec::new() }).moments().radius, 0.0);
    }

    #[test]
    fn equivalent_rectangles_are_turned_as_the_points_are() {
        let size_m = Vec2::new(0.3, 0.9);
        let upright = light(LightShape::Rectangle { size_m }).moments();
        assert!((upright.equivalent_size() - size_m).abs().max_element() < 1e-6);
        let rectangle = upright.equivalent_rectangle();
        assert!((rectangle.size - Vec2::new(0.9, 0.3)).abs().max_element() < 1e-6, "{rectangle:?}");
        assert!((rectangle.angle_rad.abs() - std::f32::consts::FRAC_PI_2).abs() < 1e-6, "{rectangle:?}");
        // A disc is equivalent to a square with sides of √3 radii, not rotated.
        let disc = light(LightShape::Disk { radius_m: 1.0 }).moments().equivalent_rectangle();
        assert!((disc.size - Vec2::splat(3f32.sqrt())).abs().max_element() < 1e-5 && disc.angle_rad == 0.0, "{disc:?}");
        // A line of points at 30 degrees.
        let frame = light(LightShape::Disk { radius_m: 1.0 }).frame();
        let (sin, cos) = 30f32.to_radians().sin_cos();
        let line: Vec<Vec3> = (0..9).map(|i| Vec3::new(cos, sin, 0.0) * (i as f32 - 4.0)).collect();
        let line = light(LightShape::Points { positions_m: points_in(&frame, &line) }).moments().equivalent_rectangle();
        assert!((line.angle_rad - 30f32.to_radians()).abs() < 1e-4, "{line:?}");
        // The variance of −4 … 4 is 60 / 9.
        assert!((line.size.x - (12.0f32 * 60.0 / 9.0).sqrt()).abs() < 1e-3 && line.size.y < 0.02, "{line:?}");
    }

    #[test]
    fn a_light_twice_as_large_has_twice_the_reach() {
        for shape in [
            LightShape::Rectangle { size_m: Vec2::new(0.6, 0.8) },
            LightShape::Sun { angular_diameter_rad: 0.1 },
            LightShape::Points { positions_m: vec![Vec3::new(1.0, 4.5, -2.0), Vec3::new(1.5, 4.0, -2.2)] },
        ] {
            let what = format!("{shape:?}");
            let light = light(shape);
            let (once, twice) = (light.moments(), light.scaled(2.0).moments());
            assert_close(twice.mean, 2.0 * once.mean, 1e-5, &what);
            assert_close(twice.variance, 4.0 * once.variance, 1e-5, &what);
            assert_close(twice.half_extent, 2.0 * once.half_extent, 1e-5, &what);
            assert!((twice.radius - 2.0 * once.radius).abs() < 1e-5, "{what}");
        }
    }
}
