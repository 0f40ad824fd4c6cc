//! Whether a scene is in metres, as glTF has it.
//!
//! Many files count in centimetres or millimetres. Nothing in them says so, and nothing looks wrong until a lamp of five centimetres lights
//! a fox of 165 metres: penumbrae follow from metres. Only some sizes are evidence: a town may have any. So the warning is for sizes that
//! hardly any asset in metres has.

use crate::Scene;
use crate::setup::is_room;

/// An object that stands on nothing, across and in height: beyond both come towers and cathedrals, which are modelled with the place that
/// they stand at more often than not. (A level of a game may be as wide, and is lower.)
const LARGEST_OBJECT_M: f32 = 100.0;
const HIGHEST_OBJECT_M: f32 = 50.0;
/// No room is higher: St Peter's nave is 46 m, its dome 117 m from the floor, and has a nave about it.
const HIGHEST_ROOM_M: f32 = 100.0;
/// Across: a grain of rice.
const SMALLEST_M: f32 = 0.005;

impl Scene {
    /// Warning about a scene that is probably not in metres; `None` where it may well be.
    pub fn unit_warning(&self) -> Option<String> {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return None;
        }
        let (across_m, height_m) = (bounds.diagonal(), bounds.max.y - bounds.min.y);
        let what = if across_m < SMALLEST_M {
            format!("is {} across", length(across_m))
        } else if height_m > HIGHEST_ROOM_M && is_room(self) {
            format!("is a room of {} in height", length(height_m))
        } else if across_m > LARGEST_OBJECT_M && height_m > HIGHEST_OBJECT_M && self.stands_on_nothing() {
            format!("is an object of {} across", length(across_m))
        } else {
            return None;
        };
        let other = if across_m < SMALLEST_M { "metres over a thousand" } else { "centimetres" };
        Some(format!(
            "{} {what}; glTF counts in metres, and this looks like another unit ({other}, say): penumbrae go by metres, so scale the file, \
             or give lights' sizes in its unit by --setup",
            self.name
        ))
    }
}

/// In metres with three figures.
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

    /// Objects and rooms in centimetres, and what is smaller than a grain.
    #[test]
    fn other_units_are_told() {
        let mut knot = load("builtin:knot?triangles=1000", &LoadOptions::default()).unwrap();
        knot.instances.retain(|instance| knot.meshes[instance.mesh].name == "knot");
        let hall = builtin::build("hall").unwrap();
        for (scene, factor, said) in
            [(&knot, 100.0, "an object of"), (&knot, 1e-3, "across"), (&hall, 100.0, "a room of")]
        {
            let warning = scaled(scene, factor).unit_warning().expect("a warning");
            assert!(warning.contains(said) && warning.contains("metres") && !warning.contains('\n'), "{warning}");
        }
    }

    /// Of the scenes beside the repository one is in centimetres.
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
            told.len() <= 1 && told.iter().all(|warning| warning.starts_with("fox is an object of 165 m")),
            "{told:?}"
        );
    }
}
