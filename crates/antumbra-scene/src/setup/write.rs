//! Writing of setups as TOML, such that reading gives the same numbers.

use std::fmt::Write;

use antumbra_light::{Light, LightShape};
use glam::{DVec3, Vec3};

use super::{Setup, emission};

/// Largest distance of a centre, metres, at which a target one metre from it gives the axis to all digits of an f32.
const DISTANT_M: f64 = 1e6;

pub(super) fn toml(setup: &Setup) -> String {
    let camera = &setup.camera;
    let mut out = String::new();
    let mut line = |key: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{key} = {value}");
    };
    line("eye", vector(camera.eye));
    line("target", vector(camera.target));
    line("up", vector(camera.up));
    line("fov_y", degrees(camera.fov_y_rad));
    line("near", number(camera.near_m));
    line("far", number(camera.far_m));
    if let Some(distance) = camera.shadow_distance {
        line("shadow_distance", number(distance.end_m));
        line("shadow_fade", number(distance.fade_m));
    }
    let lights: String = setup.lights.iter().map(light).collect();
    format!("[camera]\n{out}{lights}")
}

fn light(light: &Light) -> String {
    let mut out = String::from("\n[[light]]\n");
    let mut line = |key: &str, value: String| {
        let _ = writeln!(out, "{key} = {value}");
    };
    line("name", string(&light.name));
    line("shape", string(super::read::shape_name(&light.shape)));
    line("center", vector(light.center));
    match &light.shape {
        LightShape::Sun { .. } => line("direction", vector(light.axis)),
        // In double precision, and with a farther target if the centre is distant, so that the direction keeps its digits.
        _ => {
            let center = light.center.as_dvec3();
            let distance = if center.length() < DISTANT_M { 1.0 } else { center.length() };
            line("target", exact_vector(center + distance * light.axis.as_dvec3()));
        }
    }
    line("up", vector(light.up));
    match &light.shape {
        LightShape::Rectangle { size_m } => line("size", format!("[{}, {}]", number(size_m.x), number(size_m.y))),
        LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => line("radius", number(*radius_m)),
        LightShape::Ellipsoid { radii_m } => line("radii", vector(*radii_m)),
        LightShape::Sun { angular_diameter_rad } => line("angular_diameter", degrees(*angular_diameter_rad)),
        LightShape::Points { positions_m } => {
            let list: Vec<String> = positions_m.iter().map(|p| vector(*p)).collect();
            line("positions", format!("[{}]", list.join(", ")));
        }
    }
    if let Some(fov_rad) = light.fov_rad {
        line("fov", degrees(fov_rad));
    }
    if let Some(cone) = light.cone {
        line("cone", format!("[{}, {}]", degrees(cone.inner_rad), degrees(cone.outer_rad)));
    }
    line("color", vector(light.color));
    if let Some(given) = light.candela_or_lux {
        line(light.shape.photometric_unit(), number(given));
    }
    line("intensity", number(light.intensity));
    if let Some(uri) = light.emission.as_ref().and_then(emission::data_uri) {
        line("texture", string(&uri));
    }
    out
}

/// Formats the shortest decimal that reads back as the same f32; a float in TOML needs a point or an exponent.
fn number(v: f32) -> String {
    format!("{v:?}")
}

fn vector(v: Vec3) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

fn exact_vector(v: DVec3) -> String {
    // An f32 has seven digits; a difference of two needs as many again.
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// Formats degrees that read back as the same radians, with few digits if they suffice.
fn degrees(rad: f32) -> String {
    let exact = f64::from(rad).to_degrees();
    let short = exact as f32;
    let shown: f64 = number(short).parse().unwrap_or(exact);
    if shown.to_radians() as f32 == rad { number(short) } else { format!("{exact:?}") }
}

fn string(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
