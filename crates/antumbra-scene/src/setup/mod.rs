//! Setup: camera and lights, as TOML (`docs/formats.md`).

mod emission;
mod framing;
mod read;
mod room;
mod write;

#[cfg(test)]
mod tests;

use std::path::Path;

use antumbra_light::Light;

use crate::{Camera, Scene, SceneError};

/// Defaults of a setup file's camera: vertical field of view, degrees; near and far planes, metres.
const FOV_Y_DEGREES: f64 = 45.0;
const NEAR_M: f32 = 0.05;
const FAR_M: f32 = 200.0;

/// Camera and lights.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Camera.
    pub camera: Camera,
    /// Lights; at least one.
    pub lights: Vec<Light>,
}

/// Setup of a scene, with defaults for the camera or lights that the scene lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumed {
    /// The setup.
    pub setup: Setup,
    /// Message about the defaults that were assumed; `None` if there are none.
    pub line: Option<String>,
    /// Cameras for other aspect ratios; `None` unless the camera is a default one that frames the scene from outside.
    pub framing: Option<Framing>,
}

/// Framing of a scene: gives cameras whose images the scene fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing(framing::Subject);

impl Framing {
    /// Returns a camera whose image the scene fills; `aspect` is width over height.
    pub fn camera(&self, aspect: f32) -> Camera {
        framing::camera(&self.0, aspect)
    }
}

impl Setup {
    /// Reads a setup from TOML. `origin` is the text's file: messages name it, and textures lie beside it.
    ///
    /// # Errors
    /// One line: file, line, key, and remedy.
    pub fn from_toml(text: &str, origin: &Path) -> Result<Self, SceneError> {
        read::setup(text, origin)
    }

    /// Reads a setup file.
    ///
    /// # Errors
    /// As [`Self::from_toml`], or the file cannot be read.
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| SceneError::ReadSetup { path: path.to_owned(), source })?;
        Self::from_toml(&text, path)
    }

    /// Writes the setup as TOML that [`Self::from_toml`] reads back as the same setup, with textures as data URIs.
    pub fn to_toml(&self) -> String {
        write::toml(self)
    }

    /// Setup that a scene implies: its first camera and its lights. By default, the camera frames the scene's subject, or stands
    /// inside if faces enclose the scene's centre; the light is a rectangle above, or below the ceiling if the camera stands
    /// inside.
    pub fn for_scene(scene: &Scene) -> Self {
        Self::assumed(scene).setup
    }

    /// [`Self::for_scene`], with a message about assumed defaults. A default camera that frames the scene does so in images of any
    /// aspect ratio of at least 1.
    pub fn assumed(scene: &Scene) -> Assumed {
        Self::assumed_for(scene, 1.0)
    }

    /// [`Self::assumed`], with a default camera that frames the scene in images of this aspect ratio (width over height).
    pub fn assumed_for(scene: &Scene, aspect: f32) -> Assumed {
        let camera = scene.cameras.first().copied();
        let has_lights = !scene.lights.is_empty();
        if let (Some(camera), true) = (camera, has_lights) {
            let setup = Self { camera, lights: scene.lights.clone() };
            return Assumed { setup, line: None, framing: None };
        }
        let (taken_camera, key, framing) = match room::inside(scene) {
            Some((inside, key)) => (inside, key, None),
            None => {
                let framing = Framing(framing::Subject::of(scene));
                (framing.camera(aspect), framing::key_light(framing.0.bounds), Some(framing))
            }
        };
        let mut taken = Vec::new();
        if camera.is_none() {
            let how = if framing.is_none() { "inside the room" } else { "that frames it" };
            taken.push(format!("no camera, so one {how} was added"));
        }
        if !has_lights {
            let how = if framing.is_none() { "below the ceiling" } else { "above the scene" };
            let side_m = 2.0 * key.bounding_radius() / std::f32::consts::SQRT_2;
            taken.push(format!("no lights, so a square one of {side_m:.2} m {how} was added"));
        }
        let line = format!("{} has {}; choose others with --setup", scene.name, taken.join("; "));
        let lights = if has_lights { scene.lights.clone() } else { vec![key] };
        let framing = framing.filter(|_| camera.is_none());
        Assumed { setup: Self { camera: camera.unwrap_or(taken_camera), lights }, line: Some(line), framing }
    }
}

/// Whether a scene is a room, which is viewed from inside; see [`room`].
pub(crate) fn is_room(scene: &Scene) -> bool {
    room::inside(scene).is_some()
}

/// Checks that a camera can make an image; the error names the setup file's key.
pub(crate) fn check_camera(camera: &Camera) -> Result<(), String> {
    let Camera { eye, target, up, fov_y_rad, near_m, far_m, shadow_distance } = *camera;
    for (key, value) in [("eye", eye), ("target", target), ("up", up)] {
        if !value.is_finite() {
            return Err(format!("`{key}` is {value}, and must be finite"));
        }
    }
    let forward = (target - eye).normalize_or_zero();
    if forward == glam::Vec3::ZERO {
        return Err(format!("`eye` and `target` are both {eye}, and must differ"));
    }
    /// Sine of the smallest angle between view and up at which the image's horizon is well defined in an f32.
    const PARALLEL: f32 = 1e-5;
    if forward.cross(up.normalize_or_zero()).length() < PARALLEL {
        return Err(format!("`up` is {up}, and must be neither zero nor parallel to the view"));
    }
    if !(fov_y_rad > 0.0 && fov_y_rad < std::f32::consts::PI) {
        return Err(format!("`fov_y` is {} degrees, and must be above 0 and below 180", fov_y_rad.to_degrees()));
    }
    if !(near_m > 0.0 && near_m.is_finite()) {
        return Err(format!("`near` is {near_m}, and must be a finite length in metres above 0"));
    }
    if !(far_m > near_m && far_m.is_finite()) {
        return Err(format!("`far` is {far_m}, and must be a finite length in metres above `near` ({near_m})"));
    }
    if let Some((distance, (what, range))) = shadow_distance.and_then(|distance| Some((distance, distance.problem()?)))
    {
        let is_end = what == "end_m";
        let (key, value) = if is_end { ("shadow_distance", distance.end_m) } else { ("shadow_fade", distance.fade_m) };
        return Err(format!("`{key}` is {value}, and must be a length in metres, {range}"));
    }
    Ok(())
}
