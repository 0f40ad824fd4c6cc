//! Warning about scenes that are probably not in metres, the unit of glTF.
//!
//! Many files use centimetres or millimetres, and nothing in them says so. Penumbrae depend on metres: a lamp of five centimetres may
//! light a fox of 165 metres. Only some sizes are evidence, because a town may have any size. The warning is therefore limited to sizes
//! that hardly any asset in metres has.

use crate::Scene;
use crate::setup::is_room;

/// Largest diagonal and height of an object that stands on nothing, metres. Towers and cathedrals exceed both, but usually come with
/// their surroundings. (A level of a game may be as wide, but is lower.)
const LARGEST_OBJECT_M: f32 = 100.0;
const HIGHEST_OBJECT_M: f32 = 50.0;
/// Largest height of a room, metres: St Peter's nave is 46 m high; its dome reaches 117 m, but has a nave around it.
const HIGHEST_ROOM_M: f32 = 100.0;
/// Smallest diagonal of a scene, metres: a grain of rice.
const SMALLEST_M: f32 = 0.005;

impl Scene {
    /// Warning about a scene that is probably not in metres; `None` if its size is plausible.
    pub fn unit_warning(&self) -> Option<String> {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return None;
        }
        let (across_m, height_m) = (bounds.diagonal(), bounds.max.y - bounds.min.y);
        let what = if across_m < SMALLEST_M {
            format!("is {} across", length(across_m))
        } else if height_m > HIGHEST_ROOM_M && is_room(self) {
            format!("is a room {} high", length(height_m))
        } else if across_m > LARGEST_OBJECT_M && height_m > HIGHEST_OBJECT_M && self.lacks_ground() {
            format!("is an object {} across", length(across_m))
        } else {
            return None;
        };
        let other = if across_m < SMALLEST_M { "millimetres" } else { "centimetres" };
        Some(format!(
            "{} {what}; glTF files are in metres, but this one seems to be in another unit ({other}?). Penumbrae depend on \
             sizes in metres: scale the file, or give the lights' sizes in its unit with --setup",
            self.name
        ))
    }
}

/// Formats metres with at least three significant digits.
fn length(metres: f32) -> String {
    if metres >= 100.0 { format!("{metres:.0} m") } else { format!("{metres:.2e} m") }
}

#[cfg(test)]
mod tests {
    use antumbra_testing::scenes_folder;
    use glam::{Mat4, Vec3};

    use crate::{LoadOptions, Scene, builtin, load};

    fn scaled(scene: &Scene, factor: f32) -> Scene {
        let mut scene = scene.clone();
        for instance in &mut scene.instances {
            instance.world_from_object = Mat4::from_scale(Vec3::splat(factor)) * instance.world_from_object;
        }
        scene
    }

    #[test]
    fn scenes_in_metres_are_silent() {
        for info in builtin::NAMES {
            let scene = builtin::build(info.name).unwrap();
            assert_eq!(scene.unit_warning(), None, "{}", info.name);
        }
        assert_eq!(Scene::default().unit_warning(), None);
    }

    /// Objects and rooms in centimetres are reported, and objects smaller than a grain of rice.
    #[test]
    fn other_units_are_told() {
        let mut knot = load("builtin:knot?triangles=1000", &LoadOptions::default()).unwrap();
        knot.instances.retain(|instance| knot.meshes[instance.mesh].name == "knot");
        let hall = builtin::build("hall").unwrap();
        for (scene, factor, said) in
            [(&knot, 100.0, "is an object"), (&knot, 1e-3, "across"), (&hall, 100.0, "is a room")]
        {
            let warning = scaled(scene, factor).unit_warning().expect("a warning");
            assert!(warning.contains(said) && warning.contains("metres") && !warning.contains('\n'), "{warning}");
        }
    }

    /// The fox, in centimetres, is the only scene beside the repository that may be reported.
    #[test]
    fn of_real_scenes_the_fox_is_told_alone() {
        let Some(folder) = scenes_folder() else { return };
        let mut told = Vec::new();
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "glb") {
                let scene = load(path.to_str().unwrap(), &LoadOptions::default()).unwrap();
                told.extend(scene.unit_warning());
            }
        }
        assert!(
            told.len() <= 1 && told.iter().all(|warning| warning.starts_with("fox is an object 165 m")),
            "{told:?}"
        );
    }
}
