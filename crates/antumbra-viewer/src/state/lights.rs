//! Edits of lights: shape, direction, position, and adding and removing lights.

use antumbra_light::{Light, LightShape};
use glam::{Quat, Vec2, Vec3};

/// Kinds of light shapes, for a list to choose from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeKind {
    /// [`LightShape::Rectangle`].
    Rectangle,
    /// [`LightShape::Disk`].
    Disk,
    /// [`LightShape::Sphere`].
    Sphere,
    /// [`LightShape::Ellipsoid`].
    Ellipsoid,
    /// [`LightShape::Sun`].
    Sun,
    /// [`LightShape::Points`].
    Points,
}

/// Angular diameter of the sun as seen from the Earth, degrees.
const SUN_DEGREES: f32 = 0.53;

impl ShapeKind {
    /// All kinds.
    pub const ALL: [Self; 6] = [Self::Rectangle, Self::Disk, Self::Sphere, Self::Ellipsoid, Self::Sun, Self::Points];

    /// Returns the kind of a shape.
    pub fn of(shape: &LightShape) -> Self {
        match shape {
            LightShape::Rectangle { .. } => Self::Rectangle,
            LightShape::Disk { .. } => Self::Disk,
            LightShape::Sphere { .. } => Self::Sphere,
            LightShape::Ellipsoid { .. } => Self::Ellipsoid,
            LightShape::Sun { .. } => Self::Sun,
            LightShape::Points { .. } => Self::Points,
        }
    }

    /// Name in setup files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rectangle => "rectangle",
            Self::Disk => "disk",
            Self::Sphere => "sphere",
            Self::Ellipsoid => "ellipsoid",
            Self::Sun => "sun",
            Self::Points => "points",
        }
    }

    /// Gives `light` a shape of this kind and of about the same size.
    pub fn give_to(self, light: &mut Light) {
        if Self::of(&light.shape) == self {
            return;
        }
        // The size of a sun or a point list is not the radius of a lamp.
        let radius_m = match light.shape {
            LightShape::Sun { .. } | LightShape::Points { .. } => 0.25,
            _ => light.bounding_radius(),
        };
        let unit = light.shape.photometric_unit();
        light.shape = match self {
            Self::Rectangle => LightShape::Rectangle { size_m: Vec2::splat(2f32.sqrt() * radius_m) },
            Self::Disk => LightShape::Disk { radius_m },
            Self::Sphere => LightShape::Sphere { radius_m },
            Self::Ellipsoid => LightShape::Ellipsoid { radii_m: Vec3::new(radius_m, 0.5 * radius_m, 0.5 * radius_m) },
            Self::Sun => LightShape::Sun { angular_diameter_rad: SUN_DEGREES.to_radians() },
            Self::Points => {
                let right = light.frame().right;
                LightShape::Points {
                    positions_m: vec![light.center - radius_m * right, light.center + radius_m * right],
                }
            }
        };
        light.emission = None;
        // Candela cannot be converted to lux.
        if light.shape.photometric_unit() != unit {
            light.candela_or_lux = None;
        }
        if self == Self::Sun {
            // A frustum or cone at a sun's centre would cut off what it did not cut off at a lamp's.
            (light.fov_rad, light.cone) = (None, None);
        }
    }
}

/// Direction towards a light, as two angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// Angle about +Y from +Z towards +X, radians.
    pub azimuth_rad: f32,
    /// Angle above the horizon, radians.
    pub elevation_rad: f32,
}

impl Angles {
    /// Returns the direction from which the light's rays come, along its axis.
    pub fn of(light: &Light) -> Self {
        let from = -light.axis;
        Self { azimuth_rad: from.x.atan2(from.z), elevation_rad: from.y.clamp(-1.0, 1.0).asin() }
    }

    /// Turns the light's axis to these angles.
    pub fn give_to(self, light: &mut Light) {
        let flat = self.elevation_rad.cos();
        let from = Vec3::new(flat * self.azimuth_rad.sin(), self.elevation_rad.sin(), flat * self.azimuth_rad.cos());
        light.axis = -from.normalize();
        light.up = Light::default_up(light.axis);
    }
}

/// Moves a light, including the positions of a point list.
pub fn move_by(light: &mut Light, offset_m: Vec3) {
    light.center += offset_m;
    if let LightShape::Points { positions_m } = &mut light.shape {
        for position in positions_m {
            *position += offset_m;
        }
    }
}

/// Rotates a light about the vertical axis through `middle`.
pub(super) fn turn_about(light: &mut Light, middle: Vec3, angle_rad: f32) {
    let turn = Quat::from_rotation_y(angle_rad);
    let moved = |p: Vec3| middle + turn * (p - middle);
    light.center = moved(light.center);
    light.axis = (turn * light.axis).normalize();
    light.up = turn * light.up;
    if let LightShape::Points { positions_m } = &mut light.shape {
        for position in positions_m {
            *position = moved(*position);
        }
    }
}

impl super::State {
    /// Adds a copy of the selected light, beside it, and selects the copy.
    pub fn add_light(&mut self) {
        let mut light = self.setup.lights[self.light].clone();
        let beside = light.frame().right * (3.0 * light.bounding_radius()).max(0.5);
        move_by(&mut light, beside);
        let is_taken = |name: &str| self.setup.lights.iter().any(|light| light.name == name);
        light.name = (2..).map(|n| format!("light {n}")).find(|name| !is_taken(name)).unwrap_or_default();
        self.setup.lights.push(light);
        self.light = self.setup.lights.len() - 1;
    }

    /// Removes the selected light, unless it is the last.
    pub fn remove_light(&mut self) {
        if self.setup.lights.len() > 1 {
            self.setup.lights.remove(self.light);
            self.light = self.light.min(self.setup.lights.len() - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;

    use super::*;
    use crate::state::State;

    #[test]
    fn every_shape_becomes_every_other() {
        for from in ShapeKind::ALL {
            for to in ShapeKind::ALL {
                let shape = LightShape::Rectangle { size_m: Vec2::ONE };
                let mut light = Light::new(shape, Vec3::new(1.0, 4.0, 2.0), Vec3::ZERO);
                from.give_to(&mut light);
                to.give_to(&mut light);
                assert_eq!(ShapeKind::of(&light.shape), to);
                assert_eq!(light.validate(), Ok(()));
            }
        }
    }

    #[test]
    fn angles_are_where_light_comes_from() {
        let mut light =
            Light::new(LightShape::Sun { angular_diameter_rad: 0.01 }, Vec3::ZERO, Vec3::new(-1.0, -2.0, 1.0));
        let axis = light.axis;
        Angles::of(&light).give_to(&mut light);
        assert!(light.axis.abs_diff_eq(axis, 1e-5), "{} and {axis}", light.axis);
        Angles { azimuth_rad: 1.0, elevation_rad: std::f32::consts::FRAC_PI_2 }.give_to(&mut light);
        assert!(light.axis.abs_diff_eq(Vec3::NEG_Y, 1e-5));
        assert_eq!(light.validate(), Ok(()));
    }

    #[test]
    fn the_last_light_cannot_be_removed() {
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.add_light();
        state.add_light();
        let names: Vec<_> = state.setup.lights.iter().map(|light| light.name.clone()).collect();
        assert_eq!((names.len(), state.light), (3, 2));
        assert_ne!(names[1], names[2]);
        for _ in 0..4 {
            state.remove_light();
        }
        assert_eq!((state.setup.lights.len(), state.light), (1, 0));
    }
}
