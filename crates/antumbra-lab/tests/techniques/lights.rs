//! Replacements of a scene's light, of every kind.

use antumbra_light::{EmissionTexture, Light, LightShape};
use glam::{Vec2, Vec3};

/// A light's name, and the function that changes a scene's light.
pub(crate) type Change = (&'static str, fn(&mut Light));

/// A disk, a sphere, an ellipsoid, a sun, points and an emission texture.
pub(crate) const LIGHTS: [Change; 6] = [
    ("disk", |light| light.shape = LightShape::Disk { radius_m: 0.4 }),
    ("sphere", |light| all_around(light, LightShape::Sphere { radius_m: 0.3 })),
    ("ellipsoid", |light| all_around(light, LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) })),
    ("sun", |light| all_around(light, LightShape::Sun { angular_diameter_rad: 0.05 })),
    ("points", |light| {
        let across = 0.2 * Vec3::Y.cross(light.axis).normalize_or(Vec3::X);
        let positions_m = [-across, across, 0.2 * Vec3::Y].map(|offset| light.center + offset).to_vec();
        all_around(light, LightShape::Points { positions_m });
    }),
    ("picture", |light| {
        light.shape = LightShape::Rectangle { size_m: Vec2::new(0.8, 0.5) };
        let luminance = (0..12).map(|i| (i % 5) as f32).collect();
        light.emission = Some(EmissionTexture::gray(4, 3, luminance));
    }),
];

fn all_around(light: &mut Light, shape: LightShape) {
    (light.shape, light.fov_rad, light.cone) = (shape, None, None);
}
