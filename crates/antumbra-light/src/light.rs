//! Shapes and poses of a light.

use glam::{Vec2, Vec3};

use crate::emission::EmissionTexture;

/// Shape of an emitter, and weighting of its area.
///
/// The size is physical and the only setting of softness: the penumbra's width follows from geometry.
#[derive(Clone, Debug, PartialEq)]
pub enum LightShape {
    /// A flat rectangle, uniform over its area.
    Rectangle {
        /// Full width along [`LightFrame::right`] and full height along [`LightFrame::up`], metres.
        size_m: Vec2,
    },
    /// A flat disk, uniform over its area.
    Disk {
        /// Radius, metres.
        radius_m: f32,
    },
    /// A uniformly bright sphere: as seen from `x`, uniform over the disc of the same centre and radius facing `x`.
    Sphere {
        /// Radius, metres.
        radius_m: f32,
    },
    /// An ellipsoid, uniform over its volume.
    Ellipsoid {
        /// Half-axes along right, up and the light's axis, metres.
        radii_m: Vec3,
    },
    /// A distant disc: uniform over the directions of a cone, by area on the tangent disc.
    Sun {
        /// Full angle of the cone, radians.
        angular_diameter_rad: f32,
    },
    /// A list of point emitters of equal weight.
    Points {
        /// World positions, metres.
        positions_m: Vec<Vec3>,
    },
}

impl LightShape {
    /// Photometric unit of a light of this shape: `candela`, or `lux` for a sun.
    pub fn photometric_unit(&self) -> &'static str {
        if matches!(self, Self::Sun { .. }) { "lux" } else { "candela" }
    }
}

/// A spot's cone about its axis: full strength within the inner angle, none beyond the outer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Inner angle from the axis, radians.
    pub inner_rad: f32,
    /// Outer angle from the axis, radians; larger than the inner, and below a right angle.
    pub outer_rad: f32,
}

impl Cone {
    /// Strength in a direction with this cosine to the axis, as in KHR_lights_punctual: the square of a linear falloff, in the
    /// cosine, from inner to outer angle.
    pub fn strength(&self, cosine: f32) -> f32 {
        let (inner, outer) = (self.inner_rad.cos(), self.outer_rad.cos());
        let falloff = ((cosine - outer) / (inner - outer).max(1e-3)).clamp(0.0, 1.0);
        falloff * falloff
    }
}

/// A light: shape, pose and emission.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name in reports.
    pub name: String,
    /// Shape and size of the emitter.
    pub shape: LightShape,
    /// Centre in world space, metres. A sun's centre anchors its frustum and has no effect on visibility.
    pub center: Vec3,
    /// Unit vector along which the light looks, from its centre towards its target.
    pub axis: Vec3,
    /// Up hint of the [`LightFrame`]; need be neither unit nor orthogonal to the axis.
    pub up: Vec3,
    /// Full angle of the square frustum about the axis that limits the light, radians. `None`: a sphere, an ellipsoid and points
    /// shine in all directions, a rectangle and a disk into the half-space in front of them.
    pub fov_rad: Option<f32>,
    /// Cone of a spot, from the light's centre: visibility is 0 outside. Inside, the host's shading applies the falloff.
    pub cone: Option<Cone>,
    /// Linear RGB.
    pub color: Vec3,
    /// Photometric strength: luminous intensity along the axis, candela; for a sun the illuminance of a surface that faces it, lux.
    /// `None` if unknown: as much as others of its kind. It sets the ratios between lights; an image's exposure depends on all of
    /// them.
    pub candela_or_lux: Option<f32>,
    /// Dimmer; at 1 all lights together expose sensibly.
    pub intensity: f32,
    /// Emission over a [`LightShape::Rectangle`]; `None` is uniform.
    pub emission: Option<EmissionTexture>,
}

/// Axes of a light. `(right, up, −axis)` is right-handed, as for a camera that looks down −z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFrame {
    /// World position of the light's centre.
    pub center: Vec3,
    /// Right, unit: `axis × up hint`.
    pub right: Vec3,
    /// Up, unit: `right × axis`.
    pub up: Vec3,
    /// Axis, unit: the direction in which the light looks.
    pub axis: Vec3,
}

impl Light {
    /// Creates a light of `shape` at `center` looking at `target`, white, with the default up hint.
    pub fn new(shape: LightShape, center: Vec3, target: Vec3) -> Self {
        let axis = (target - center).normalize_or_zero();
        Self {
            name: "key".into(),
            shape,
            center,
            axis,
            up: Self::default_up(axis),
            fov_rad: None,
            cone: None,
            color: Vec3::ONE,
            candela_or_lux: None,
            intensity: 1.0,
            emission: None,
        }
    }

    /// Copy of the light with default name, colour and brightness, on which its shadows do not depend.
    #[must_use]
    pub fn for_shadows(&self) -> Self {
        Self { name: String::new(), color: Vec3::ONE, candela_or_lux: None, intensity: 1.0, ..self.clone() }
    }

    /// Default up hint: +Y, or +Z if the axis is within 8 degrees of vertical.
    pub fn default_up(axis: Vec3) -> Vec3 {
        Self::valid_up(axis, Vec3::Y)
    }

    /// Up hint that is valid for this axis: `up`, or +Z if the axis is within 8 degrees of `up`, or +Y if it is within 8 degrees of
    /// +Z, too.
    pub fn valid_up(axis: Vec3, up: Vec3) -> Vec3 {
        let is_beside = |hint: &Vec3| axis.cross(*hint).length() > 8f32.to_radians().sin() * hint.length();
        if up == Vec3::ZERO { up } else { [up, Vec3::Z].into_iter().find(is_beside).unwrap_or(Vec3::Y) }
    }

    /// Axes of the light in world space.
    pub fn frame(&self) -> LightFrame {
        let right = self.axis.cross(self.up).normalize();
        LightFrame { center: self.center, right, up: right.cross(self.axis), axis: self.axis }
    }

    /// Whether the light is infinitely far away.
    pub fn is_distant(&self) -> bool {
        matches!(self.shape, LightShape::Sun { .. })
    }

    /// Radius of the smallest sphere about the centre that contains the light, metres; for a sun the tangent of its half-angle.
    pub fn bounding_radius(&self) -> f32 {
        match &self.shape {
            LightShape::Rectangle { size_m } => 0.5 * size_m.length(),
            LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => *radius_m,
            LightShape::Ellipsoid { radii_m } => radii_m.max_element(),
            LightShape::Sun { angular_diameter_rad } => (0.5 * angular_diameter_rad).tan(),
            LightShape::Points { positions_m } => {
                positions_m.iter().map(|p| p.distance(self.center)).fold(0.0, f32::max)
            }
        }
    }

    /// Returns the light with positions relative to `anchor`.
    pub fn relative_to(&self, anchor: Vec3) -> Self {
        let mut light = Self { center: self.center - anchor, ..self.clone() };
        if let LightShape::Points { positions_m } = &mut light.shape {
            positions_m.iter_mut().for_each(|position| *position -= anchor);
        }
        light
    }

    /// Returns the light with its size multiplied by `factor`; points move away from the centre.
    pub fn scaled(&self, factor: f32) -> Self {
        let shape = match &self.shape {
            LightShape::Rectangle { size_m } => LightShape::Rectangle { size_m: *size_m * factor },
            LightShape::Disk { radius_m } => LightShape::Disk { radius_m: radius_m * factor },
            LightShape::Sphere { radius_m } => LightShape::Sphere { radius_m: radius_m * factor },
            LightShape::Ellipsoid { radii_m } => LightShape::Ellipsoid { radii_m: *radii_m * factor },
            LightShape::Sun { angular_diameter_rad } => {
                LightShape::Sun { angular_diameter_rad: 2.0 * ((0.5 * angular_diameter_rad).tan() * factor).atan() }
            }
            LightShape::Points { positions_m } => LightShape::Points {
                positions_m: positions_m.iter().map(|p| self.center + (*p - self.center) * factor).collect(),
            },
        };
        Self { shape, ..self.clone() }
    }

    /// Whether the light shines in all directions: a shape with no front, without frustum or cone.
    pub fn is_omnidirectional(&self) -> bool {
        self.fov_rad.is_none()
            && self.cone.is_none()
            && match self.shape {
                LightShape::Sphere { .. } | LightShape::Ellipsoid { .. } | LightShape::Points { .. } => true,
                LightShape::Rectangle { .. } | LightShape::Disk { .. } | LightShape::Sun { .. } => false,
            }
    }

    /// Tangent of the angle from the axis, along right and up, beyond which the light does not reach; `None` if unlimited.
    pub fn max_angle_tangent(&self) -> Option<f32> {
        let frustum = self.fov_rad.map(|fov| (0.5 * fov).tan());
        let cone = self.cone.map(|cone| cone.outer_rad.tan());
        frustum.into_iter().chain(cone).reduce(f32::min)
    }

    /// Whether the light can reach the world position `x`: inside its frustum and cone; without a frustum, a rectangle and a disk
    /// reach only what is in front of their plane. Elsewhere visibility is 0 (docs/formats.md).
    pub fn reaches(&self, frame: &LightFrame, x: Vec3) -> bool {
        if self.is_distant() {
            return true;
        }
        let from_center = x - frame.center;
        let depth = from_center.dot(frame.axis);
        if self.cone.is_some_and(|cone| depth < cone.outer_rad.cos() * from_center.length()) {
            return false;
        }
        match self.fov_rad {
            Some(fov) => {
                let half_width = depth * (0.5 * fov).tan();
                depth > 0.0
                    && from_center.dot(frame.right).abs() <= half_width
                    && from_center.dot(frame.up).abs() <= half_width
            }
            None => depth > 0.0 || self.is_omnidirectional(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;

    #[test]
    fn frame_is_right_handed_like_a_camera() {
        let light = Light::new(LightShape::Disk { radius_m: 1.0 }, Vec3::new(3.0, 4.0, 5.0), Vec3::ZERO);
        let f = light.frame();
        assert!(f.right.cross(f.up).abs_diff_eq(-f.axis, 1e-6));
        assert!(f.right.abs_diff_eq(f.axis.cross(light.up).normalize(), 1e-6));
    }

    #[test]
    fn reach_is_the_frustum_given_or_all_in_front() {
        let mut light = Light::new(LightShape::Disk { radius_m: 0.1 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
        let frame = light.frame();
        assert!(light.reaches(&frame, Vec3::new(100.0, 0.0, 0.0)));
        assert!(!light.reaches(&frame, Vec3::new(0.0, 6.0, 0.0)));
        light.fov_rad = Some(FRAC_PI_2);
        assert!(light.reaches(&frame, Vec3::new(4.9, 0.0, 0.0)));
        assert!(!light.reaches(&frame, Vec3::new(5.1, 0.0, 0.0)));
        light.shape = LightShape::Sphere { radius_m: 0.1 };
        assert!(!light.reaches(&frame, Vec3::new(0.0, 6.0, 0.0)));
        light.fov_rad = None;
        assert!(light.reaches(&frame, Vec3::new(0.0, 6.0, 0.0)));
    }

    #[test]
    fn a_cone_ends_the_light_and_softens_towards_its_end() {
        let mut light = Light::new(LightShape::Sphere { radius_m: 0.1 }, Vec3::new(0.0, 1.0, 0.0), Vec3::ZERO);
        light.cone = Some(Cone { inner_rad: 20f32.to_radians(), outer_rad: FRAC_PI_4 });
        let frame = light.frame();
        assert!(!light.is_omnidirectional());
        assert!((light.max_angle_tangent().unwrap() - 1.0).abs() < 1e-6);
        assert!(light.reaches(&frame, Vec3::new(0.99, 0.0, 0.0)) && !light.reaches(&frame, Vec3::new(1.01, 0.0, 0.0)));
        assert!(!light.reaches(&frame, Vec3::new(0.8, 0.0, 0.8)), "round, not square");
        assert!(!light.reaches(&frame, Vec3::new(0.0, 2.0, 0.0)));
        let cone = light.cone.unwrap();
        assert_eq!((cone.strength(1.0), cone.strength(0.0)), (1.0, 0.0));
        let halfway = 0.5 * (cone.inner_rad.cos() + cone.outer_rad.cos());
        assert!((cone.strength(halfway) - 0.25).abs() < 1e-6);
        light.cone = Some(Cone { inner_rad: 0.5, outer_rad: 0.4 });
        assert!(light.validate().unwrap_err().to_string().contains("`cone`"));
    }

    #[test]
    fn an_up_along_the_axis_is_replaced() {
        assert_eq!(Light::valid_up(Vec3::NEG_Y, Vec3::Y), Vec3::Z);
        assert_eq!(Light::valid_up(Vec3::Z, Vec3::NEG_Z), Vec3::Y);
        assert_eq!(Light::valid_up(Vec3::NEG_Y, Vec3::X), Vec3::X);
        let nine_degrees_off = Vec3::new(9f32.to_radians().sin(), -9f32.to_radians().cos(), 0.0);
        assert_eq!(Light::valid_up(nine_degrees_off, Vec3::Y), Vec3::Y);
    }
}
