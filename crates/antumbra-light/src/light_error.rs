//! Validation of a light's numbers.

use std::f32::consts::FRAC_PI_2;

use glam::Vec3;

use crate::light::{Cone, Light, LightShape};

/// Fault of a light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LightError {
    /// The axis has no direction.
    #[error("light `{light}`: its axis has zero length: `center` and `target` must differ")]
    ZeroAxis {
        /// The light's name.
        light: String,
    },
    /// The up hint is parallel to the axis, or zero.
    #[error("light `{light}`: `up` is zero or parallel to the axis; choose an `up` that leans away from it")]
    ParallelUp {
        /// The light's name.
        light: String,
    },
    /// A number is out of its valid range.
    #[error("light `{light}`: `{key}` is {value}, and must be {range}")]
    OutOfRange {
        /// The light's name.
        light: String,
        /// Name of the quantity.
        key: &'static str,
        /// Value found.
        value: String,
        /// Valid range.
        range: &'static str,
    },
}

impl Light {
    /// Checks every number of the light.
    ///
    /// # Errors
    /// Names the first quantity that is not finite, out of its range, or leaves the frame undefined.
    pub fn validate(&self) -> Result<(), LightError> {
        let light = || self.name.clone();
        let out = |key, value: String, range| Err(LightError::OutOfRange { light: light(), key, value, range });
        if !self.axis.is_finite() || (self.axis.length() - 1.0).abs() > 1e-3 {
            return Err(LightError::ZeroAxis { light: light() });
        }
        if !self.up.is_finite() || self.axis.cross(self.up).length() <= 1e-6 * self.up.length() || self.up == Vec3::ZERO
        {
            return Err(LightError::ParallelUp { light: light() });
        }
        if !self.center.is_finite() {
            return out("center", format!("{}", self.center), "finite");
        }
        if !self.color.is_finite() || self.color.min_element() < 0.0 {
            return out("color", format!("{}", self.color), "finite and not negative");
        }
        if !self.intensity.is_finite() || self.intensity < 0.0 {
            return out("intensity", self.intensity.to_string(), "finite and not negative");
        }
        if let Some(given) = self.candela_or_lux
            && (!given.is_finite() || given < 0.0)
        {
            return out(self.shape.photometric_unit(), given.to_string(), "finite and not negative");
        }
        if let Some(fov) = self.fov_rad
            && !(fov > 0.0 && fov < std::f32::consts::PI)
        {
            return out("fov", format!("{} degrees", fov.to_degrees()), "above 0 and below 180 degrees");
        }
        if let Some(Cone { inner_rad, outer_rad }) = self.cone
            && !(0.0 <= inner_rad && inner_rad < outer_rad && outer_rad < FRAC_PI_2)
        {
            let had = format!("{} to {} degrees off the axis", inner_rad.to_degrees(), outer_rad.to_degrees());
            return out("cone", had, "an inner angle from 0 up, and an outer one above it and below 90 degrees");
        }
        let size_ok = |v: f32| v.is_finite() && v >= 0.0;
        match &self.shape {
            LightShape::Rectangle { size_m } if !(size_ok(size_m.x) && size_ok(size_m.y)) => {
                out("size", format!("{size_m}"), "two finite lengths in metres, not negative")
            }
            LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } if !size_ok(*radius_m) => {
                out("radius", radius_m.to_string(), "a finite length in metres, not negative")
            }
            LightShape::Ellipsoid { radii_m } if !radii_m.to_array().into_iter().all(size_ok) => {
                out("radii", format!("{radii_m}"), "three finite lengths in metres, not negative")
            }
            LightShape::Sun { angular_diameter_rad: angle } if !(*angle >= 0.0 && *angle < FRAC_PI_2) => {
                out("angular_diameter", format!("{} degrees", angle.to_degrees()), "from 0 to below 90 degrees")
            }
            LightShape::Points { positions_m } if positions_m.is_empty() => {
                out("positions", "an empty list".into(), "at least one position")
            }
            LightShape::Points { positions_m } if !positions_m.iter().all(|p| p.is_finite()) => {
                out("positions", "a list with a number that is not finite".into(), "finite positions in metres")
            }
            _ => match &self.emission {
                Some(texture) if !texture.is_usable() => {
                    out("texture", "unusable".into(), "an image with finite luminances, not all zero")
                }
                _ => Ok(()),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_key() {
        let bad = Light::new(LightShape::Disk { radius_m: -1.0 }, Vec3::Y, Vec3::ZERO);
        assert!(bad.validate().unwrap_err().to_string().contains("`radius`"));
        let bad = Light::new(LightShape::Disk { radius_m: 1.0 }, Vec3::Y, Vec3::Y);
        assert!(matches!(bad.validate(), Err(LightError::ZeroAxis { .. })));
    }
}
