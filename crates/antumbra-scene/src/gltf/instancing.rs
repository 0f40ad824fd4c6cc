//! Instances of a node's mesh.
//!
//! Source: EXT_mesh_gpu_instancing (Khronos 2021).

use glam::{Mat4, Quat, Vec3};
use gltf::json::scene::Node;
use serde_json::Value;

use super::accessors::Allowed;
use super::fault::{Fault, Result};
use super::numbers::unit_quaternion;
use super::source::Source;

/// `node_from_instance` of each instance; only the identity for a node without the extension.
pub(super) fn transforms(source: &Source, node: &Node, index: usize) -> Result<Vec<Mat4>> {
    let extension = node.extensions.as_ref().and_then(|e| e.others.get("EXT_mesh_gpu_instancing"));
    let Some(extension) = extension else { return Ok(vec![Mat4::IDENTITY]) };
    let place = format!("nodes[{index}].extensions.EXT_mesh_gpu_instancing");
    let attribute = |name: &str| -> Result<Option<usize>> {
        match extension.get("attributes").and_then(|a| a.get(name)) {
            None => Ok(None),
            Some(value) => value.as_u64().map(|i| Some(i as usize)).ok_or_else(|| {
                Fault::new(&*place, format!("attribute {name} is not an accessor's index"), "expected a whole number")
            }),
        }
    };
    let [translation, rotation, scale] = [attribute("TRANSLATION")?, attribute("ROTATION")?, attribute("SCALE")?];
    // Attributes without a meaning here still give the number of instances.
    let any = extension
        .get("attributes")
        .and_then(Value::as_object)
        .and_then(|a| a.values().find_map(Value::as_u64))
        .map(|i| i as usize);
    let Some(first) = translation.or(rotation).or(scale).or(any) else { return Ok(vec![Mat4::IDENTITY]) };
    let count = source.accessor_count(first, &place)?;
    for accessor in [translation, rotation, scale].into_iter().flatten() {
        let have = source.accessor_count(accessor, &place)?;
        if have != count {
            return Err(Fault::new(
                place,
                format!("attributes of {count} and {have} elements"),
                "all attributes must have as many elements as there are copies",
            ));
        }
    }
    if count > source.budget.limits.instances {
        source.budget.take_instances(count, &place)?;
    }
    let vec3s = |accessor: Option<usize>, otherwise: Vec3| match accessor {
        Some(a) => {
            let values = source.read_floats::<3>(a, Allowed::SignedFractions, &place)?;
            Ok(values.into_iter().map(Vec3::from_array).collect())
        }
        None => Ok(vec![otherwise; count]),
    };
    let translations: Vec<Vec3> = vec3s(translation, Vec3::ZERO)?;
    let scales: Vec<Vec3> = vec3s(scale, Vec3::ONE)?;
    let rotations = match rotation {
        Some(a) => source.read_floats::<4>(a, Allowed::SignedFractions, &place)?,
        None => vec![Quat::IDENTITY.to_array(); count],
    };
    Ok((0..count)
        .map(|k| {
            let rotation = unit_quaternion(Quat::from_array(rotations[k])).unwrap_or(Quat::IDENTITY);
            Mat4::from_scale_rotation_translation(scales[k], rotation, translations[k])
        })
        .collect())
}
