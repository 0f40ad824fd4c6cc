//! A setup: where to look from and what the lights are, as TOML (`docs/formats.md`).

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

/// Defaults of a setup file's camera.
const FOV_Y_DEGREES: f64 = 45.0;
const NEAR_M: f32 = 0.05;
const FAR_M: f32 = 200.0;

/// Where to look from and what the lights are.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Where to look from.
    pub camera: Camera,
    /// At least one light.
    pub lights: Vec<Light>,
}

/// A setup that a scene does not bring whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumed {
    /// Itself.
    pub setup: Setup,
    /// What the scene does not say, for readers; `None` where it says all.
    pub line: Option<String>,
    /// What makes such a camera for pictures of other formats, where the camera frames the scene from outside.
    pub framing: Option<Framing>,
}

/// A scene's place in pictures that it fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing(framing::Subject);

impl Framing {
    /// A camera whose picture, of this width over its height, the scene fills.
    pub fn camera(&self, aspect: f32) -> Camera {
        framing::camera(&self.0, aspect)
    }
}

impl Setup {
    /// Reads a setup from TOML; `origin` names the text in messages and is the file beside which textures lie.
    ///
    /// # Errors
    /// One line: file, line, key, and what would be right.
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

    /// The setup as TOML from which [`Self::from_toml`] makes the same setup, textures inside it as data URIs.
    pub fn to_toml(&self) -> String {
        write::toml(self)
    }

    /// The setup that a scene implies: its first camera and its lights. Where it has no camera one frames what fills it, or,
    /// where faces enclose its middle, stands inside; where it has no lights one rectangle shines from above, or from below
    /// the ceiling.
    pub fn for_scene(scene: &Scene) -> Self {
        Self::assumed(scene).setup
    }

    /// [`Self::for_scene`], and what of it the scene does not say. A camera that frames the scene shows it in pictures of any
    /// format down to a square.
    pub fn assumed(scene: &Scene) -> Assumed {
        Self::assumed_for(scene, 1.0)
    }

    /// [`Self::assumed`], with a camera that frames the scene in pictures of this width over their height.
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
            let how = if framing.is_none() { "stands inside" } else { "frames it" };
            taken.push(format!("no camera, and one {how}"));
        }
        if !has_lights {
            let how = if framing.is_none() { "hangs below the ceiling" } else { "shines from above" };
            let side_m = 2.0 * key.bounding_radius() / std::f32::consts::SQRT_2;
            taken.push(format!("no lights, and a square one of {side_m:.2} m {how}"));
        }
        let line = format!("{} has {}; --setup says otherwise", scene.name, taken.join("; "));
        let lights = if has_lights { scene.lights.clone() } else { vec![key] };
        let framing = framing.filter(|_| camera.is_none());
        Assumed { setup: Self { camera: camera.unwrap_or(taken_camera), lights }, line: Some(line), framing }
    }
}

/// Whether a scene is seen from inside; see [`room`].
pub(crate) fn is_room(scene: &Scene) -> bool {
    room::inside(scene).is_some()
}

/// Whether a camera makes a picture; the message names the setup file's key.
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
    /// Sine of the smallest angle between view and up at which the picture's horizon is well defined in an f32.
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
