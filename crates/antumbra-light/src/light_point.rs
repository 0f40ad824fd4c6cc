//! Points of a light: the map from the unit cube to its area or volume.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use glam::{Vec2, Vec3};

use crate::light::{Light, LightFrame, LightShape};

/// Sample point of a light in homogeneous form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// World position (`w = 1`), or direction towards the light, not normalised (`w = 0`).
    pub xyz: Vec3,
    /// 1 for a position, 0 for a direction.
    pub w: f32,
    /// Relative emission ≥ 0 of this point; 1 where the light is uniform.
    pub weight: f32,
}

impl LightPoint {
    /// The vector from `x` to this point: the whole segment for a position, a direction for a distant light.
    pub fn vector_from(&self, x: Vec3) -> Vec3 {
        self.xyz - self.w * x
    }
}

impl Light {
    /// Maps a point `u` of the unit cube to a point of the light, as seen from the world position `seen_from`.
    ///
    /// The map preserves area (volume for an ellipsoid), so uniform `u` give uniform light points. Only an ellipsoid
    /// uses `u.z`; only a sphere uses `seen_from`. [`LightShape::Points`] picks by `u.x`.
    pub fn point(&self, frame: &LightFrame, u: Vec3, seen_from: Vec3) -> LightPoint {
        let at =
            |right: f32, up: f32, axis: f32| frame.center + frame.right * right + frame.up * up + frame.axis * axis;
        let position = |xyz| LightPoint { xyz, w: 1.0, weight: 1.0 };
        match &self.shape {
            LightShape::Rectangle { size_m } => {
                let offset = (u.truncate() - 0.5) * *size_m;
                let weight = self.emission.as_ref().map_or(1.0, |texture| texture.luminance_at(u.truncate()));
                LightPoint { xyz: at(offset.x, offset.y, 0.0), w: 1.0, weight }
            }
            LightShape::Disk { radius_m } => {
                let offset = disk_from_square(u.truncate()) * *radius_m;
                position(at(offset.x, offset.y, 0.0))
            }
            LightShape::Sphere { radius_m } => {
                let offset = disk_from_square(u.truncate()) * *radius_m;
                let (right, up) = facing_axes(frame, seen_from);
                position(frame.center + right * offset.x + up * offset.y)
            }
            LightShape::Ellipsoid { radii_m } => {
                let p = ball_from_cube(u) * *radii_m;
                position(at(p.x, p.y, p.z))
            }
            LightShape::Sun { angular_diameter_rad } => {
                let offset = disk_from_square(u.truncate()) * (0.5 * angular_diameter_rad).tan();
                let xyz = frame.right * offset.x + frame.up * offset.y - frame.axis;
                LightPoint { xyz, w: 0.0, weight: 1.0 }
            }
            LightShape::Points { positions_m } => {
                let index = ((u.x * positions_m.len() as f32) as usize).min(positions_m.len() - 1);
                position(positions_m[index])
            }
        }
    }
}

/// Two unit vectors across the line from `seen_from` to the light's centre, continuous in the receiver's position
/// wherever it is in front of the light.
fn facing_axes(frame: &LightFrame, seen_from: Vec3) -> (Vec3, Vec3) {
    let towards = (frame.center - seen_from).try_normalize().unwrap_or(-frame.axis);
    let right = frame.up.cross(towards).try_normalize().unwrap_or(frame.right);
    (right, towards.cross(right))
}

/// Concentric map from the unit square to the unit disk (Shirley and Chiu 1997). It preserves area and adjacency, so that strata
/// stay compact.
pub fn disk_from_square(u: Vec2) -> Vec2 {
    let p = 2.0 * u - 1.0;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (radius, angle) =
        if p.x.abs() > p.y.abs() { (p.x, FRAC_PI_4 * (p.y / p.x)) } else { (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y)) };
    radius * Vec2::new(angle.cos(), angle.sin())
}

/// Volume-preserving map from the unit cube to the unit ball: cos θ and φ uniform, radius by the cube root.
pub fn ball_from_cube(u: Vec3) -> Vec3 {
    let cos_theta = 1.0 - 2.0 * u.x;
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    let phi = TAU * u.y;
    u.z.cbrt() * Vec3::new(sin_theta * phi.cos(), sin_theta * phi.sin(), cos_theta)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SampleSet;

    fn points(light: &Light, n: u32) -> Vec<Vec3> {
        let frame = light.frame();
        SampleSet::Stratified.points(n, 1).into_iter().map(|u| light.point(&frame, u, Vec3::ZERO).xyz).collect()
    }

    /// Second moment along a direction through the centre, for which each shape has a closed form.
    fn second_moment(points: &[Vec3], center: Vec3, direction: Vec3) -> f32 {
        points.iter().map(|p| (*p - center).dot(direction).powi(2)).sum::<f32>() / points.len() as f32
    }

    #[test]
    fn shapes_have_the_second_moments_of_their_closed_forms() {
        let center = Vec3::new(0.0, 5.0, 0.0);
        let near = |got: f32, want: f32| assert!((got - want).abs() < 0.01 * want, "{got} against {want}");

        let rectangle = Light::new(LightShape::Rectangle { size_m: Vec2::new(2.0, 0.5) }, center, Vec3::ZERO);
        let (p, f) = (points(&rectangle, 4096), rectangle.frame());
        near(second_moment(&p, center, f.right), 2.0 * 2.0 / 12.0);
        near(second_moment(&p, center, f.up), 0.5 * 0.5 / 12.0);

        let disk = Light::new(LightShape::Disk { radius_m: 0.7 }, center, Vec3::ZERO);
        near(second_moment(&points(&disk, 4096), center, disk.frame().right), 0.7 * 0.7 / 4.0);

        let ellipsoid = Light::new(LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.2, 0.1) }, center, Vec3::ZERO);
        let (p, f) = (points(&ellipsoid, 16384), ellipsoid.frame());
        near(second_moment(&p, center, f.right), 0.4 * 0.4 / 5.0);
        near(second_moment(&p, center, f.up), 0.2 * 0.2 / 5.0);
        near(second_moment(&p, center, f.axis), 0.1 * 0.1 / 5.0);
    }

    #[test]
    fn sphere_faces_the_receiver() {
        let light = Light::new(LightShape::Sphere { radius_m: 0.5 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
        let frame = light.frame();
        let x = Vec3::new(4.0, 0.0, 1.0);
        let towards = (light.center - x).normalize();
        for u in SampleSet::R2.points(64, 0) {
            assert!((light.point(&frame, u, x).xyz - light.center).dot(towards).abs() < 1e-5);
        }
    }
}
