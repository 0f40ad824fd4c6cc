//! Exposure: one for all lights of a scene.
//!
//! ```text
//! a light's shape, candela or lux ─► its physical strength ─► each group well exposed ─► all together well exposed
//! ```
//!
//! Lights whose candela or lux are known are one group, in which they add up as in reality: far ones are dim. Other lights are only
//! known to be alike by kind: surfaces have one exitance, points one intensity, suns one illuminance. Each of these kinds is a
//! group of its own. The groups are equally strong in the image, because nothing says otherwise.
//!
//! *Well exposed* refers to the unshadowed irradiance that the better lit of the visible points would get, facing each light, if
//! every light's intensity were 1. Intensities are applied afterwards: 1 exposes sensibly, and 2 is twice as bright.

use std::f32::consts::PI;

use antumbra_light::{Light, LightShape, SampleSet};
use glam::Vec3;

use super::light_buffers::{ELLIPSOID, MIN_HALF_WIDTH_M, POINTS, RECTANGLE, SPHERE, SUN, kind_and_half_size};

/// Largest number of visible points that determine the exposure.
const EXPOSURE_POINTS: usize = 2048;
/// Number of light points per visible point.
const EXPOSURE_LIGHT_POINTS: u32 = 16;
/// Quantile of the visible points, sorted by irradiance, that gets the full exposure: most of the image is then no
/// brighter, but surfaces close to a lamp may be.
const EXPOSED_QUANTILE: f32 = 0.75;
/// Irradiance at that quantile: a white diffuse surface that faces the light has the radiance 2.5. Chosen by eye on the
/// built-in scenes, so that a lit grey floor is bright and a white wall keeps its texture.
const EXPOSED_IRRADIANCE: f32 = 2.5 * PI;

/// Group of lights whose quantities are comparable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    /// Lights with known candela or lux.
    Measured,
    /// Surfaces of one exitance.
    Surfaces,
    /// Points of one intensity.
    Points,
    /// Suns of one illuminance.
    Suns,
}

impl Group {
    const ALL: [Self; 4] = [Self::Measured, Self::Surfaces, Self::Points, Self::Suns];

    fn of(light: &Light) -> Self {
        match light.shape {
            _ if light.candela_or_lux.is_some() => Self::Measured,
            LightShape::Points { .. } => Self::Points,
            LightShape::Sun { .. } => Self::Suns,
            _ => Self::Surfaces,
        }
    }
}

/// Radiance of each light (radiant intensity for points) that exposes the points `seen` sensibly, including its intensity
/// and colour. Black if a light reaches none of the points.
pub fn exposed_radiances(lights: &[Light], seen: &[Vec3]) -> Vec<Vec3> {
    let seen: Vec<Vec3> = seen.iter().copied().step_by(seen.len().div_ceil(EXPOSURE_POINTS).max(1)).collect();
    let points = SampleSet::Stratified.points(EXPOSURE_LIGHT_POINTS, 0);
    let mut radiances: Vec<f32> = lights.iter().map(radiance).collect();
    let unit_irradiances: Vec<Vec<f32>> =
        lights.iter().map(|light| seen.iter().map(|x| facing_irradiance(light, &points, *x)).collect()).collect();
    let mut groups = 0;
    for group in Group::ALL {
        let members: Vec<usize> = (0..lights.len()).filter(|i| Group::of(&lights[*i]) == group).collect();
        groups += usize::from(!members.is_empty());
        expose(&mut radiances, &unit_irradiances, &members);
    }
    if groups > 1 {
        let all: Vec<usize> = (0..lights.len()).collect();
        expose(&mut radiances, &unit_irradiances, &all);
    }
    lights.iter().zip(radiances).map(|(light, radiance)| light.color * (light.intensity * radiance)).collect()
}

/// Scales the radiances of some lights so that together they expose well.
fn expose(radiances: &mut [f32], unit_irradiances: &[Vec<f32>], members: &[usize]) {
    let seen = unit_irradiances.first().map_or(0, Vec::len);
    let irradiance = |point: usize| members.iter().map(|i| radiances[*i] * unit_irradiances[*i][point]).sum::<f32>();
    let mut irradiances: Vec<f32> = (0..seen).map(irradiance).filter(|e| e.is_finite() && *e > 0.0).collect();
    irradiances.sort_unstable_by(f32::total_cmp);
    let exposed = irradiances.get((irradiances.len() as f32 * EXPOSED_QUANTILE) as usize);
    // Without any irradiance, the lights reach no visible point.
    let scale = exposed.map_or(0.0, |irradiance| EXPOSED_IRRADIANCE / irradiance);
    // A radiance beyond single precision, of a small lamp of 1e35 candela for example, becomes 0.
    let scaled = |radiance: f32| Some(radiance * scale).filter(|scaled| scaled.is_finite()).unwrap_or(0.0);
    members.iter().for_each(|i| radiances[*i] = scaled(radiances[*i]));
}

/// Radiance (radiant intensity for points) before exposure: from candela or lux, or else a value that is 1 for the group.
fn radiance(light: &Light) -> f32 {
    let (kind, half_size) = kind_and_half_size(&light.shape);
    match (light.candela_or_lux, kind) {
        // A sun's illuminance over the projected solid angle of its disc.
        (lux, SUN) => lux.unwrap_or(1.0) / sun_irradiance(half_size.x),
        (None, _) => 1.0,
        // A surface of radiance L and area A has the intensity L A along its axis.
        (Some(candela), POINTS) => candela,
        (Some(candela), _) => candela / shown_area(kind, half_size),
    }
}

/// Area of a light projected along its axis, square metres.
fn shown_area(kind: u32, half_size: Vec3) -> f32 {
    match kind {
        RECTANGLE => 4.0 * half_size.x * half_size.y,
        // Consistent with its irradiance: an ellipsoid is as strong as the sphere of the same volume.
        ELLIPSOID => PI * half_size.element_product().powf(2.0 / 3.0),
        _ => PI * half_size.x * half_size.x,
    }
}

/// Irradiance from a sun of unit radiance on a surface that faces it; `tangent` is that of half its angle.
fn sun_irradiance(tangent: f32) -> f32 {
    PI * tangent * tangent / (1.0 + tangent * tangent)
}

/// Unshadowed irradiance, at unit radiance, of a surface at `x` that faces the light, summed over light points, which are
/// given in the unit cube.
fn facing_irradiance(light: &Light, points: &[Vec3], x: Vec3) -> f32 {
    let frame = light.frame();
    if !light.reaches(&frame, x) {
        return 0.0;
    }
    let cosine = (x - light.center).normalize_or_zero().dot(light.axis);
    let strength = light.cone.map_or(1.0, |cone| cone.strength(cosine));
    let (kind, half_size) = kind_and_half_size(&light.shape);
    if let LightShape::Points { positions_m } = &light.shape {
        let sum: f32 = positions_m.iter().map(|p| 1.0 / p.distance_squared(x)).sum();
        return strength * sum / positions_m.len() as f32;
    }
    if kind == SUN {
        return sun_irradiance(half_size.x);
    }
    let emits_to_all_sides = matches!(kind, SPHERE | ELLIPSOID);
    let towards = (light.center - x).normalize_or_zero();
    let sum: f32 = points
        .iter()
        .map(|u| {
            let segment = light.point(&frame, *u, x).vector_from(x);
            let distance = segment.length().max(MIN_HALF_WIDTH_M);
            let direction = segment / distance;
            let emitted = if emits_to_all_sides { 1.0 } else { (-direction.dot(light.axis)).max(0.0) };
            emitted * direction.dot(towards).max(0.0) / (distance * distance)
        })
        .sum();
    strength * shown_area(kind, half_size) * sum / points.len() as f32
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    fn lamp(shape: LightShape, height_m: f32, candela_or_lux: Option<f32>) -> Light {
        Light { candela_or_lux, ..Light::new(shape, height_m * Vec3::Y, Vec3::ZERO) }
    }

    /// Irradiance of each light at the origin.
    fn at_origin(lights: &[Light]) -> Vec<f32> {
        let points = SampleSet::Stratified.points(EXPOSURE_LIGHT_POINTS, 0);
        let radiances = exposed_radiances(lights, &[Vec3::ZERO]);
        let of = |(light, radiance): (&Light, Vec3)| radiance.x * facing_irradiance(light, &points, Vec3::ZERO);
        lights.iter().zip(radiances).map(of).collect()
    }

    fn assert_near(values: &[f32], expected: &[f32]) {
        let is_near = values.iter().zip(expected).all(|(v, e)| (v - e).abs() < 0.02 * e.abs());
        assert!(is_near && values.len() == expected.len(), "{values:?}, and {expected:?} was expected");
    }

    /// A light four times as far is a sixteenth as bright; together the lights expose well.
    #[test]
    fn distances_between_lights_count() {
        let disk = LightShape::Disk { radius_m: 0.1 };
        let sum = EXPOSED_IRRADIANCE / 17.0;
        for given in [None, Some(300.0)] {
            let lights = [lamp(disk.clone(), 2.0, given), lamp(disk.clone(), 8.0, given)];
            assert_near(&at_origin(&lights), &[16.0 * sum, sum]);
        }
    }

    /// Candela over the square of the distance are lux, for all shapes.
    #[test]
    fn candela_and_lux_are_of_one_scale() {
        let shapes = [
            LightShape::Rectangle { size_m: Vec2::new(0.4, 0.1) },
            LightShape::Disk { radius_m: 0.2 },
            LightShape::Sphere { radius_m: 0.1 },
            LightShape::Ellipsoid { radii_m: Vec3::splat(0.2) },
            LightShape::Points { positions_m: vec![3.0 * Vec3::Y; 2] },
        ];
        let mut lights: Vec<Light> = shapes.into_iter().map(|shape| lamp(shape, 3.0, Some(900.0))).collect();
        lights.push(lamp(LightShape::Sun { angular_diameter_rad: 0.01 }, 3.0, Some(100.0)));
        assert_near(&at_origin(&lights), &[EXPOSED_IRRADIANCE / 6.0; 6]);
    }

    /// Without candela or lux, kinds of light are equally strong; intensities are applied after exposure.
    #[test]
    fn light_kinds_are_equally_strong_before_intensity() {
        let sun = LightShape::Sun { angular_diameter_rad: 0.2 };
        let mut lights = vec![lamp(sun, 3.0, None), lamp(LightShape::Sphere { radius_m: 0.05 }, 2.0, None)];
        assert_near(&at_origin(&lights), &[0.5 * EXPOSED_IRRADIANCE; 2]);
        lights[0].intensity = 3.0;
        assert_near(&at_origin(&lights), &[1.5 * EXPOSED_IRRADIANCE, 0.5 * EXPOSED_IRRADIANCE]);
    }

    #[test]
    fn what_is_not_seen_or_gives_nothing_is_dark() {
        let disk = LightShape::Disk { radius_m: 0.1 };
        let away = Light::new(disk.clone(), Vec3::Y, 2.0 * Vec3::Y);
        assert_eq!(exposed_radiances(&[away], &[Vec3::ZERO]), [Vec3::ZERO]);
        assert_eq!(exposed_radiances(&[lamp(disk.clone(), 1.0, Some(0.0))], &[Vec3::ZERO]), [Vec3::ZERO]);
        assert_eq!(exposed_radiances(&[lamp(disk, 1.0, None)], &[]), [Vec3::ZERO]);
        assert_eq!(exposed_radiances(&[], &[Vec3::ZERO]), []);
        let tiny = LightShape::Disk { radius_m: 1e-3 };
        for given in [1e35, 1e-40, f32::MAX] {
            let lights = [lamp(tiny.clone(), 1.0, Some(given)), lamp(tiny.clone(), 2.0, Some(300.0))];
            assert!(exposed_radiances(&lights, &[Vec3::ZERO]).iter().all(|l| l.is_finite()), "{given}");
        }
    }
}
