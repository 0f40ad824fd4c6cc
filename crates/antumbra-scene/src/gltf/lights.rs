//! Lights of the asset.
//!
//! Source: KHR_lights_punctual. Its lights have no size, but soft shadows need one: spot and point lights get a radius of
//! 5 cm, directional lights the sun's 0.53° (`docs/formats.md`). `extras` of the light, or of its node, overrides:
//!
//! | key | meaning |
//! |---|---|
//! | `radius` | disk or sphere, metres |
//! | `size` | `[width, height]` of a rectangle, metres |
//! | `angular_diameter` | sun, degrees |
//! | `radii` | half-axes of an ellipsoid, metres |
//! | `positions` | points in the node's space, metres |
//! | `shape` | `rectangle`, `disk`, `sphere`, `ellipsoid`, `sun` or `points`, if the other keys leave it open |
//! | `fov` | of a square frustum that restricts the light, degrees |
//! | `intensity`, `candela`, `lux` | as in a setup file; each, or a `shape` of the other unit, disables the extension's number |
//! | `emission` | `{width, height, luminance, tint}`: a rectangle's texture; `tint`, RGB of each texel, if it is coloured |
//!
//! A spot light keeps its cone; a point light shines in all directions.
//!
//! The exporter writes these keys, so that a round trip keeps shape and size.

use antumbra_light::{Cone, EmissionTexture, Light, LightShape};
use glam::{Mat4, Vec2, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type};
use gltf::json::validation::Checked;
use serde_json::{Map, Value};

use super::extras;
use super::fault::{Fault, Result};
use super::materials::floats;
use super::source::Source;

/// Default radius of a spot or point light, metres (`docs/formats.md`).
const RADIUS_M: f32 = 0.05;
/// Angular diameter of the sun seen from the earth, degrees (`docs/formats.md`).
const SUN_DEGREES: f32 = 0.53;
/// Smallest angle off the axis, radians, of a cone that does not restrict the light: it reaches everything in front.
const UNRESTRICTED_RAD: f32 = std::f32::consts::FRAC_PI_2 * 0.999;

/// Light, to be finished once all lights and the scene's bounds are known.
pub(super) struct Found {
    light: Light,
    /// Whether it is a point light without a direction of its own.
    all_round: bool,
}

/// Reads the light of a node; `None`, with a warning, if it cannot be used.
pub(super) fn read(
    source: &Source,
    index: usize,
    world_from_node: Mat4,
    node_extras: Map<String, Value>,
) -> Result<Option<Found>> {
    let lights = source.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let lights = lights.map_or(&[][..], |e| &e.lights);
    let Some(json) = lights.get(index) else {
        return Err(Fault::unresolved("KHR_lights_punctual.light", "lights", index, lights.len()));
    };
    let label = Source::label(json.name.as_ref(), "lights", index);
    let Checked::Valid(kind) = json.type_ else {
        return Err(Fault::new(label, "its type is unknown", "expected directional, point or spot"));
    };
    let mut keys = node_extras;
    keys.extend(extras::of(&json.extras));

    let axis = -world_from_node.z_axis.truncate().normalize_or(Vec3::Z);
    let up = world_from_node.y_axis.truncate().normalize_or_zero();
    let number = |key: &str| floats(keys.get(key)).map(|[v]: [f32; 1]| v);
    let intensity = number("intensity");
    let shape = shape(&keys, kind, world_from_node);
    let unit = shape.photometric_unit();
    // The extension's number is candela, or lux for a sun: it has no meaning if `extras` changes a sun to another shape or back.
    let is_of_unit = (unit == "lux") == (kind == Type::Directional);
    let extension = (intensity.is_none() && is_of_unit).then_some(json.intensity);
    let light = Light {
        name: json.name.clone().unwrap_or_else(|| format!("light {index}")),
        shape,
        center: world_from_node.w_axis.truncate(),
        axis,
        up: if axis.cross(up).length() > 1e-3 { up } else { Light::default_up(axis) },
        fov_rad: floats(keys.get("fov")).map(|[degrees]| degrees.to_radians()),
        cone: cone(json, kind),
        color: Vec3::from_array(json.color),
        candela_or_lux: number(unit).or(extension),
        intensity: intensity.unwrap_or(1.0),
        emission: keys.get("emission").and_then(emission),
    };
    if let Err(error) = light.validate() {
        source.warn(format!("{label}: {error}; it is ignored"));
        return Ok(None);
    }
    let all_round = kind == Type::Point && !keys.contains_key("shape");
    Ok(Some(Found { light, all_round }))
}

fn shape(keys: &Map<String, Value>, kind: Type, world_from_node: Mat4) -> LightShape {
    let named = keys.get("shape").and_then(Value::as_str);
    let size = floats::<2>(keys.get("size"));
    let radius = floats::<1>(keys.get("radius")).map_or(RADIUS_M, |[r]| r);
    let radii = floats::<3>(keys.get("radii"));
    let positions = keys.get("positions").and_then(Value::as_array).and_then(|list| {
        // The node's rotation and translation, but not its scale, because sizes are in metres.
        let (_, rotation, translation) = world_from_node.to_scale_rotation_translation();
        list.iter().map(|p| floats(Some(p)).map(|p| translation + rotation * Vec3::from_array(p))).collect()
    });
    match (named, size, radii, positions) {
        (Some("rectangle") | None, Some(size), _, _) => LightShape::Rectangle { size_m: Vec2::from_array(size) },
        (Some("ellipsoid") | None, _, Some(radii), _) => LightShape::Ellipsoid { radii_m: Vec3::from_array(radii) },
        (Some("points") | None, _, _, Some(positions_m)) => LightShape::Points { positions_m },
        (Some("disk"), ..) => LightShape::Disk { radius_m: radius },
        (Some("sphere"), ..) => LightShape::Sphere { radius_m: radius },
        _ => match kind {
            Type::Spot => LightShape::Disk { radius_m: radius },
            Type::Point => LightShape::Sphere { radius_m: radius },
            Type::Directional => {
                let degrees = floats(keys.get("angular_diameter")).map_or(SUN_DEGREES, |[d]| d);
                LightShape::Sun { angular_diameter_rad: degrees.to_radians() }
            }
        },
    }
}

/// Cone of a spot light; `None` if it is no narrower than the half-space in front of the light.
fn cone(json: &JsonLight, kind: Type) -> Option<Cone> {
    let spot = json.spot.as_ref().filter(|spot| kind == Type::Spot && spot.outer_cone_angle < UNRESTRICTED_RAD)?;
    Some(Cone { inner_rad: spot.inner_cone_angle, outer_rad: spot.outer_cone_angle })
}

fn emission(value: &Value) -> Option<EmissionTexture> {
    let side = |key: &str| value.get(key)?.as_u64().and_then(|v| u32::try_from(v).ok());
    let luminance: Option<Vec<f32>> =
        value.get("luminance")?.as_array()?.iter().map(|v| v.as_f64().map(|v| v as f32)).collect();
    let tint: Option<Vec<Vec3>> = value
        .get("tint")
        .and_then(Value::as_array)
        .and_then(|list| list.iter().map(|color| floats(Some(color)).map(Vec3::from_array)).collect());
    let (width, height, luminance) = (side("width")?, side("height")?, luminance?);
    // Checked here because the product may exceed what a u32 holds.
    (u64::from(width) * u64::from(height) == luminance.len() as u64).then_some(EmissionTexture {
        width,
        height,
        luminance,
        tint,
    })
}

/// Finishes the lights: those without a direction point at the centre of the scene.
pub(super) fn finish(mut found: Vec<Found>, scene_center: Option<Vec3>) -> Vec<Light> {
    for f in found.iter_mut().filter(|f| f.all_round) {
        let towards = scene_center.map_or(Vec3::ZERO, |c| c - f.light.center);
        f.light.axis = towards.normalize_or(Vec3::NEG_Y);
        f.light.up = Light::default_up(f.light.axis);
    }
    found.into_iter().map(|f| f.light).collect()
}
