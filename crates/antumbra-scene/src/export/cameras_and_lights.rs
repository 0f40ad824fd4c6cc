//! Cameras and lights, and the nodes that place them.

use std::f32::consts::FRAC_PI_2;

use antumbra_light::{EmissionTexture, Light, LightShape};
use glam::{Mat3, Quat, Vec3};
use serde_json::{Map, Value, json};

use super::object;
use crate::Camera;

/// Rotation of a node whose −z points along `forward`.
fn looking(forward: Vec3, up: Vec3) -> [f32; 4] {
    let right = forward.cross(up).normalize();
    Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward)).normalize().to_array()
}

pub(super) fn camera(camera: &Camera) -> Value {
    json!({
        "type": "perspective",
        "perspective": { "yfov": camera.fov_y_rad, "znear": camera.near_m, "zfar": camera.far_m },
        "extras": { "target_distance": camera.eye.distance(camera.target) },
    })
}

pub(super) fn camera_node(camera: &Camera, index: usize) -> Value {
    let forward = (camera.target - camera.eye).normalize();
    json!({
        "camera": index,
        "translation": camera.eye.to_array(),
        "rotation": looking(forward, camera.up),
    })
}

pub(super) fn light(light: &Light) -> Value {
    let mut extras = Map::new();
    let mut extra = |key: &str, value: Value| extras.insert(key.into(), value);
    extra("intensity", light.intensity.into());
    if let Some(given) = light.candela_or_lux {
        extra(light.shape.photometric_unit(), given.into());
    }
    let node_from_world = Quat::from_array(looking(light.axis, light.up)).inverse();
    let (kind, shape) = match &light.shape {
        LightShape::Rectangle { size_m } => {
            extra("size", json!(size_m.to_array()));
            ("spot", "rectangle")
        }
        LightShape::Disk { radius_m } => {
            extra("radius", json!(radius_m));
            ("spot", "disk")
        }
        LightShape::Sphere { radius_m } => {
            extra("radius", json!(radius_m));
            ("point", "sphere")
        }
        LightShape::Ellipsoid { radii_m } => {
            extra("radii", json!(radii_m.to_array()));
            ("point", "ellipsoid")
        }
        LightShape::Sun { angular_diameter_rad } => {
            extra("angular_diameter", json!(angular_diameter_rad.to_degrees()));
            ("directional", "sun")
        }
        LightShape::Points { positions_m } => {
            let local = |p: &Vec3| (node_from_world * (*p - light.center)).to_array();
            extra("positions", positions_m.iter().map(|p| json!(local(p))).collect());
            ("point", "points")
        }
    };
    // glTF allows a cone for spots only, so the type is spot whatever the shape.
    let kind = if light.cone.is_some() { "spot" } else { kind };
    extra("shape", shape.into());
    if let Some(fov_rad) = light.fov_rad {
        extra("fov", fov_rad.to_degrees().into());
    }
    if let Some(emission) = &light.emission {
        let tint = emission.tint.as_ref().map(|tint| tint.iter().map(|c| c.to_array()).collect::<Vec<_>>());
        let EmissionTexture { width, height, luminance, .. } = emission;
        extra("emission", object(json!({ "width": width, "height": height, "luminance": luminance, "tint": tint })));
    }
    let spot = if kind == "spot" {
        let (inner, outer) = light.cone.map_or((0.0, FRAC_PI_2), |cone| (cone.inner_rad, cone.outer_rad));
        json!({ "innerConeAngle": inner, "outerConeAngle": outer })
    } else {
        Value::Null
    };
    object(json!({
        "name": light.name,
        "type": kind,
        "color": light.color.to_array(),
        // For other programs: this crate's loader reads `extras`.
        "intensity": light.candela_or_lux.unwrap_or(1.0) * light.intensity,
        "spot": spot,
        "extras": extras,
    }))
}

pub(super) fn light_node(light: &Light, index: usize) -> Value {
    json!({
        "name": light.name,
        "translation": light.center.to_array(),
        "rotation": looking(light.axis, light.up),
        "extensions": { "KHR_lights_punctual": { "light": index } },
    })
}
