//! One exposure for all lights of a scene.
//!
//! ```text
//! a light's shape, candela or lux ─► what it gives, physically ─► by group well exposed ─► all together well exposed
//! ```
//!
//! Lights whose candela or lux are known are one group, in which they add up as they would outside the computer: far ones are
//! dim. Of others nothing is known but that lights of a kind are alike: surfaces glow with one exitance, points with one
//! intensity, suns give one illuminance. Each of those is a group of its own, and the groups are equally strong in the picture,
//! since nothing says otherwise.
//!
//! *Well exposed* is the unshadowed irradiance that the better lit of the points in view would get, facing each light, were
//! every light's intensity 1. Intensities dim or raise lights after that, so that 1 exposes sensibly and 2 is twice as bright.

use std::f32::consts::PI;

use antumbra_light::{Light, LightShape, SampleSet};
use glam::Vec3;

use super::{ELLIPSOID, LEAST_HALF_WIDTH_M, POINTS, RECTANGLE, SPHERE, SUN, kind_and_half_size};

/// Points in view that exposure looks at, at most.
const EXPOSURE_POINTS: usize = 2048;
/// Light points for each of them.
const EXPOSURE_LIGHT_POINTS: u32 = 16;
/// Which of the points in view, sorted by irradiance, gets the full exposure: most of the picture is then no brighter,
/// and what is close to a lamp may be.
const EXPOSED_QUANTILE: f32 = 0.75;
/// Irradiance there: a white diffuse surface that faces the light has the radiance 2.5. Chosen by eye on the built-in
/// scenes, so that a lit grey floor is bright and a white wall keeps its texture.
const EXPOSED_IRRADIANCE: f32 = 2.5 * PI;

/// Lights that add up as their numbers say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    /// Candela or lux are known.
    Measured,
    /// One exitance.
    Surfaces,
    /// One intensity.
    Points,
    /// One illuminance.
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

/// The radiance of each light (of points: the radiant intensity) that exposes the points `seen` sensibly, with its intensity
/// and colour. Black where a light reaches nothing that is seen.
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

/// Scales the radiances of some lights so that they expose well together.
fn expose(radiances: &mut [f32], unit_irradiances: &[Vec<f32>], members: &[usize]) {
    let seen = unit_irradiances.first().map_or(0, Vec::len);
    let irradiance = |point: usize| members.iter().map(|i| radiances[*i] * unit_irradiances[*i][point]).sum::<f32>();
    let mut irradiances: Vec<f32> = (0..seen).map(irradiance).filter(|e| e.is_finite() && *e > 0.0).collect();
    irradiances.sort_unstable_by(f32::total_cmp);
    let exposed = irradiances.get((irradiances.len() as f32 * EXPOSED_QUANTILE) as usize);
    // Without any, the lights reach nothing that is seen.
    let scale = exposed.map_or(0.0, |irradiance| EXPOSED_IRRADIANCE / irradiance);
    // What single precision cannot hold, a small lamp of 1e35 candela say, is dark.
    let scaled = |radiance: f32| Some(radiance * scale).filter(|scaled| scaled.is_finite()).unwrap_or(0.0);
    members.iter().for_each(|i| radiances[*i] = scaled(radiances[*i]));
}

/// Radiance (of points: radiant intensity) before exposure: of candela or lux, or else what is 1 for all of a group.
fn radiance(light: &Light) -> f32 {
    let (kind, half_size) = kind_and_half_size(&light.shape);
    match (light.candela_or_lux, kind) {
        // Of a sun: over the projected solid angle of its disc.
        (lux, SUN) => lux.unwrap_or(1.0) / sun_irradiance(half_size.x),
        (None, _) => 1.0,
        // A surface of radiance L has L A along its axis.
        (Some(candela), POINTS) => candela,
        (Some(candela), _) => candela / shown_area(kind, half_size),
    }
}

/// Of what a light shows along its axis, square metres.
fn shown_area(kind: u32, half_size: Vec3) -> f32 {
    match kind {
        RECTANGLE => 4.0 * half_size.x * half_size.y,
        // As its irradiance has it: of the strength of the sphere of its volume.
        ELLIPSOID => PI * half_size.element_product().powf(2.0 / 3.0),
        _ => PI * half_size.x * half_size.x,
    }
}

/// Of a sun of unit radiance on what faces it, of the tangent of half its angle.
fn sun_irradiance(tangent: f32) -> f32 {
    PI * tangent * tangent / (1.0 + tangent * tangent)
}

/// The unshadowed irradiance, at unit radiance, of a surface at `x` that faces the light: summed over points of the
/// light, given in the unit cube.
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
            let distance = segment.length().max(LEAST_HALF_WIDTH_M);
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

    /// The irradiance of each light at the origin.
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

    /// Four times as far, a sixteenth as bright; together they expose well.
    #[test]
    fn distances_between_lights_count() {
        let disk = LightShape::Disk { radius_m: 0.1 };
        let sum = EXPOSED_IRRADIANCE / 17.0;
        for given in [None, Some(300.0)] {
            let lights = [lamp(disk.clone(), 2.0, given), lamp(disk.clone(), 8.0, given)];
            assert_near(&at_origin(&lights), &[16.0 * sum, sum]);
        }
    }

    /// Candela over the square of the distance are lux, whatever the shape.
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

    /// Of lights that say nothing of themselves, kinds are equally strong; intensities come after exposure.
    #[test]
    fn kinds_are_equally_strong_and_dimmers_come_last() {
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
