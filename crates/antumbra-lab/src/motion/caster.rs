//! Choice of the moving caster.

use antumbra_reference::Receivers;
use antumbra_scene::{Aabb, Scene};
use glam::Vec3;

use crate::error::LabError;

/// Fraction of the scene's extent from which an instance counts as ground, wall or hall, not as a movable object.
const SURROUNDINGS: f32 = 0.75;

/// Instances that move together, and their name for display.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingCaster {
    /// Name of the mesh.
    pub name: String,
    /// Indices into [`Scene::instances`].
    pub instances: Vec<usize>,
}

/// Returns all instances of the mesh called `name`, or of its parts `name.0`, `name.1`, … if a glTF mesh has several primitives.
///
/// # Errors
/// If there is none: one line with the available names.
pub fn named_caster(scene: &Scene, name: &str) -> Result<MovingCaster, LabError> {
    let is_part = |mesh: &str, name: &str| {
        let number = mesh.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
        mesh == name || number.is_some_and(|number| number.parse::<u32>().is_ok())
    };
    let named = |is_named: &dyn Fn(&str) -> bool| -> Vec<usize> {
        let instances = scene.instances.iter().enumerate();
        instances.filter(|(_, one)| is_named(&scene.meshes[one.mesh].name)).map(|(index, _)| index).collect()
    };
    // A file may have names that differ only in case, so an exact match takes precedence.
    let mut instances = named(&|mesh| is_part(mesh, name));
    if instances.is_empty() {
        let name = name.to_lowercase();
        instances = named(&|mesh| is_part(&mesh.to_lowercase(), &name));
    }
    if instances.is_empty() {
        return Err(LabError::Request(format!(
            "--caster: there is no mesh `{name}` in the scene; available: {}",
            names(scene)
        )));
    }
    // The spelling of the scene.
    let own = scene.meshes[scene.instances[instances[0]].mesh].name.get(..name.len());
    Ok(MovingCaster { name: own.unwrap_or(name).to_owned(), instances })
}

/// Returns the instance with most pixels in the image that is neither ground nor wall: its box spans less than three quarters of
/// the scene's along both x and z, or, if there is none, along one of them. `receivers` are what the camera sees. `None` if
/// every visible instance spans too much.
pub fn largest_caster(scene: &Scene, receivers: &Receivers) -> Option<MovingCaster> {
    let mut pixels = vec![0_usize; scene.instances.len()];
    for point in receivers.points.iter().flatten() {
        pixels[point.instance as usize] += 1;
    }
    let whole = scene.bounds();
    let extent = |bounds: Aabb| (bounds.max - bounds.min).max(Vec3::ZERO);
    let spans_along: Vec<usize> = (scene.instances.iter())
        .map(|instance| {
            let points = scene.meshes[instance.mesh].positions.iter();
            let own = extent(Aabb::of(points.map(|p| instance.world_from_object.transform_point3(*p))));
            let spans = own.cmpge(SURROUNDINGS * extent(whole));
            usize::from(spans.x) + usize::from(spans.z)
        })
        .collect();
    // The first of equals, so that the choice is deterministic.
    let largest = |max_spans: usize| {
        let free = (0..pixels.len()).filter(|i| pixels[*i] > 0 && spans_along[*i] <= max_spans);
        free.max_by_key(|i| (pixels[*i], std::cmp::Reverse(*i)))
    };
    let index = largest(0).or_else(|| largest(1))?;
    Some(MovingCaster { name: scene.meshes[scene.instances[index].mesh].name.clone(), instances: vec![index] })
}

/// Returns the first names of meshes, each once.
pub(super) fn names(scene: &Scene) -> String {
    const SHOWN: usize = 12;
    let mut names: Vec<&str> = Vec::new();
    for instance in &scene.instances {
        let name = scene.meshes[instance.mesh].name.as_str();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let more = if names.len() > SHOWN { format!(" and {} more", names.len() - SHOWN) } else { String::new() };
    names.truncate(SHOWN);
    names.join(", ") + &more
}

#[cfg(test)]
mod tests {
    use antumbra_reference::Tracer;
    use antumbra_scene::{LoadOptions, Setup, load};
    use glam::UVec2;

    use super::*;

    fn largest_in(spec: &str) -> Option<MovingCaster> {
        let scene = load(spec, &LoadOptions::default()).unwrap();
        let camera = Setup::for_scene(&scene).camera;
        largest_caster(&scene, &Tracer::new(&scene).unwrap().primary(&camera, UVec2::new(96, 54)))
    }

    #[test]
    fn grounds_and_walls_stay() {
        assert_eq!(largest_in("builtin:overlap").unwrap().name, "table");
        assert_eq!(largest_in("builtin:lantern-wall").unwrap().name, "banner");
        assert_eq!(largest_in("builtin:leaning-plank").unwrap().name, "plank");
        assert_eq!(largest_in("builtin:hall"), None, "one mesh, which is all there is");
    }

    #[test]
    fn names_are_exact_or_those_of_parts() {
        let mut scene = load("builtin:lantern-wall", &LoadOptions::default()).unwrap();
        assert_eq!(named_caster(&scene, "banner").unwrap().instances, [4], "and not the banner pole");
        let unknown = named_caster(&scene, "flag").unwrap_err().to_string();
        assert!(unknown.contains("`flag`") && unknown.contains("banner pole") && !unknown.contains('\n'), "{unknown}");
        scene.meshes[2].name = "lamp.0".into();
        scene.meshes[3].name = "lamp.1".into();
        let lamp = named_caster(&scene, "LAMP").unwrap();
        assert_eq!((lamp.name.as_str(), lamp.instances), ("lamp", vec![2, 3]));
        scene.meshes[3].name = "LAMP".into();
        assert_eq!(named_caster(&scene, "LAMP").unwrap().instances, [3], "the case decides where both are there");
    }
}
