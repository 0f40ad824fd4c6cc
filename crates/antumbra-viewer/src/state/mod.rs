//! State of the viewer: everything that a command line or a setup file can express, independent of windows and GPUs.

mod command_line;
mod lights;
mod play;
mod side;

use std::path::PathBuf;

use antumbra::TechniqueKind;
use antumbra_scene::{Aabb, Camera, Scene, Setup};
use glam::Vec3;

pub use command_line::{command_line, quoted};
pub use lights::{Angles, ShapeKind, move_by};
pub use play::{Play, SPEEDS};
pub use side::Side;

/// View of a side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Show {
    /// The shaded image.
    #[default]
    Shaded,
    /// Visibility of the selected light: white is lit, black is umbra.
    Visibility,
    /// Visibility minus the ground truth, as a colour.
    Error,
    /// The ground truth.
    Truth,
    /// The depth maps that the techniques draw for the selected light.
    LightMap,
    /// Lengths of the lists that techniques keep per texel of the selected light's map.
    Lists,
}

impl Show {
    /// All views.
    pub const ALL: [Self; 6] = [Self::Shaded, Self::Visibility, Self::Error, Self::Truth, Self::LightMap, Self::Lists];

    /// Name in command lines and on buttons.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaded => "shaded",
            Self::Visibility => "visibility",
            Self::Error => "error",
            Self::Truth => "truth",
            Self::LightMap => "map",
            Self::Lists => "lists",
        }
    }

    /// Returns the view with this name, ignoring case.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|show| show.name().eq_ignore_ascii_case(name))
    }

    /// Whether the view needs traced rays.
    pub fn needs_truth(self) -> bool {
        matches!(self, Self::Error | Self::Truth)
    }
}

/// Maximum number of bookmarks: the digits without zero.
const MAX_BOOKMARKS: usize = 9;

/// The open scene.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenScene {
    /// Name of the scene: `builtin:street`, or a path.
    pub spec: String,
    /// Number of the opening, different for each.
    pub generation: u64,
    /// Bounding box of all triangles but an added ground's, relative to the anchor.
    pub bounds: Aabb,
    /// Number of drawn triangles.
    pub triangle_count: usize,
    /// Whether a ground was added below the scene.
    pub has_ground: bool,
}

/// State of the viewer.
#[derive(Clone, Debug)]
pub struct State {
    /// The open scene; `None` before the first.
    pub scene: Option<OpenScene>,
    /// World position that serves as origin of the scene, its bounds, camera and lights.
    pub anchor: Vec3,
    /// Camera and lights, relative to the anchor.
    pub setup: Setup,
    /// The setup file that was opened or saved last, with its content relative to the anchor.
    pub setup_file: Option<(PathBuf, Setup)>,
    /// The left or only side, and the right side.
    pub sides: [Side; 2],
    /// Whether both sides are shown.
    pub is_split: bool,
    /// Position of the divider, in image widths from the left.
    pub divider: f32,
    /// The view.
    pub show: Show,
    /// Level of the shown lists or map, from the finest; the coarsest level if there are fewer.
    pub level: usize,
    /// Peeled layer of the shown map, from the nearest, or index of the light sample with its own map; the last one if there are fewer.
    pub layer: usize,
    /// Index of the selected light, which is edited and compared with the ground truth.
    pub light: usize,
    /// Bookmarked cameras, at most nine.
    pub bookmarks: Vec<Camera>,
    /// Time of an animated scene.
    pub play: Play,
    /// Angular speed of the camera around its target, radians per second.
    pub camera_turn_rad_s: f32,
    /// Angular speed of the selected light around the scene's centre, radians per second.
    pub light_turn_rad_s: f32,
}

impl State {
    /// Creates a state without a scene; `left` and `right` are the techniques of the sides.
    pub fn new(left: TechniqueKind, right: TechniqueKind) -> Self {
        Self {
            scene: None,
            anchor: Vec3::ZERO,
            setup: Setup::for_scene(&Scene::default()),
            setup_file: None,
            sides: [Side::new(left), Side::new(right)],
            is_split: false,
            divider: 0.5,
            show: Show::default(),
            level: 0,
            layer: 0,
            light: 0,
            bookmarks: Vec::new(),
            play: Play::default(),
            camera_turn_rad_s: 0.0,
            light_turn_rad_s: 0.0,
        }
    }

    /// Shows a loaded scene with `setup`, or with its own camera and lights.
    pub fn open(&mut self, spec: &str, scene: &Scene, setup: Option<Setup>) {
        let generation = self.scene.as_ref().map_or(0, |open| open.generation) + 1;
        self.scene = Some(OpenScene {
            spec: spec.to_owned(),
            generation,
            bounds: scene.bounds(),
            triangle_count: scene.triangle_count(),
            has_ground: false,
        });
        self.anchor = Vec3::ZERO;
        self.play = Play::default();
        if setup.is_none() {
            self.setup_file = None;
        }
        self.bookmarks.clear();
        self.take_setup(setup.unwrap_or_else(|| Setup::for_scene(scene)));
    }

    /// Records that the scene's last instance is an added ground, which the bounds exclude.
    pub fn note_ground(&mut self, scene: &Scene) {
        if let Some(open) = &mut self.scene {
            open.has_ground = true;
            open.bounds = bounds_of(scene, true);
        }
    }

    /// Returns camera and lights in world space, as files store them.
    pub fn setup_in_world(&self) -> Setup {
        self.setup.relative_to(-self.anchor)
    }

    /// Sets camera and lights to `setup`, which is relative to the anchor.
    pub fn take_setup(&mut self, setup: Setup) {
        self.setup = setup;
        self.light = 0;
    }

    /// Adds a bookmark of the camera. A tenth one replaces the ninth.
    pub fn add_bookmark(&mut self) {
        self.bookmarks.truncate(MAX_BOOKMARKS - 1);
        self.bookmarks.push(self.setup.camera);
    }

    /// Returns to a bookmark by its index from 0.
    pub fn go_to_bookmark(&mut self, index: usize) {
        if let Some(camera) = self.bookmarks.get(index) {
            self.setup.camera = *camera;
        }
    }

    /// Returns the visible sides.
    pub fn shown_sides(&self) -> &[Side] {
        if self.is_split { &self.sides } else { &self.sides[..1] }
    }

    /// Whether anything is animated.
    pub fn is_moving(&self) -> bool {
        self.camera_turn_rad_s != 0.0 || self.light_turn_rad_s != 0.0 || self.play.is_playing
    }

    /// Updates the state for another pose of the scene. Camera and lights follow the scene's own if they are unchanged,
    /// unless a setup file defines them.
    pub fn follow(&mut self, before: &Scene, after: &Scene) {
        if let Some(open) = &mut self.scene {
            open.bounds = bounds_of(after, open.has_ground);
        }
        if self.setup_file.is_some() {
            return;
        }
        if before.cameras.first() == Some(&self.setup.camera) {
            self.setup.camera = after.cameras.first().copied().unwrap_or(self.setup.camera);
        }
        for light in &mut self.setup.lights {
            let place = before.lights.iter().position(|other| other == light);
            if let Some(moved) = place.and_then(|place| after.lights.get(place)) {
                *light = moved.clone();
            }
        }
    }

    /// Advances playback and turntables by `seconds`.
    pub fn advance(&mut self, seconds: f32) {
        self.play.advance(seconds);
        if self.camera_turn_rad_s != 0.0 {
            crate::camera::orbit(&mut self.setup.camera, self.camera_turn_rad_s * seconds, 0.0);
        }
        if self.light_turn_rad_s != 0.0 {
            let middle = self.scene.as_ref().map_or(Vec3::ZERO, |open| open.bounds.center());
            let angle_rad = self.light_turn_rad_s * seconds;
            lights::turn_about(&mut self.setup.lights[self.light], middle, angle_rad);
        }
    }
}

/// Bounding box of the scene without an added ground.
fn bounds_of(scene: &Scene, has_ground: bool) -> Aabb {
    scene.bounds_of(&scene.instances[..scene.instances.len() - usize::from(has_ground)])
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{LoadOptions, load};

    use super::*;

    #[test]
    fn opening_another_scene_starts_anew() {
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        state.open("builtin:overlap", &scene, None);
        let first = state.scene.clone().unwrap();
        assert!(first.triangle_count > 0 && !first.bounds.is_empty());
        state.light = 7;
        state.open("builtin:overlap", &scene, None);
        assert_ne!(state.scene.as_ref().unwrap().generation, first.generation);
        assert_eq!((state.light, &state.setup), (0, &Setup::for_scene(&scene)));
    }

    #[test]
    fn a_turntable_comes_back() {
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.open("builtin:overlap", &scene, None);
        let before = state.setup.clone();
        (state.camera_turn_rad_s, state.light_turn_rad_s) = (std::f32::consts::TAU / 8.0, std::f32::consts::TAU / 8.0);
        for step in 0..8 {
            state.advance(1.0);
            assert!(state.setup.lights[0].validate().is_ok());
            assert_eq!(state.setup.camera.eye.distance(before.camera.eye) < 1e-2, step == 7);
        }
        assert!(state.setup.lights[0].center.abs_diff_eq(before.lights[0].center, 1e-2));
    }

    #[test]
    fn unedited_cameras_and_lights_follow_the_animation() {
        let mut before = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&before);
        let mut other = setup.lights[0].clone();
        other.center.x += 2.0;
        (before.cameras, before.lights) = (vec![setup.camera], vec![setup.lights[0].clone(), other]);
        let mut after = before.clone();
        after.cameras[0].eye.y += 1.0;
        after.lights.iter_mut().for_each(|light| light.center.y += 1.0);
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.open("moving.glb", &before, None);
        state.setup.lights[1].intensity = 0.5;
        let touched = state.setup.lights[1].clone();
        state.follow(&before, &after);
        assert_eq!(state.setup, Setup { camera: after.cameras[0], lights: vec![after.lights[0].clone(), touched] });
        let held = state.setup.clone();
        state.setup_file = Some(("held.toml".into(), held.clone()));
        state.follow(&after, &before);
        assert_eq!(state.setup, held);
    }

    #[test]
    fn views_are_kept_and_come_back() {
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        let before = state.setup.camera;
        state.go_to_bookmark(0);
        assert_eq!(state.setup.camera, before);
        for _ in 0..12 {
            state.add_bookmark();
            state.setup.camera.eye.x += 1.0;
        }
        assert_eq!(state.bookmarks.len(), MAX_BOOKMARKS);
        state.go_to_bookmark(0);
        assert_eq!(state.setup.camera, before);
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        state.open("builtin:overlap", &scene, None);
        assert!(state.bookmarks.is_empty());
    }

    #[test]
    fn views_have_names() {
        for show in Show::ALL {
            assert_eq!(Show::from_name(show.name()), Some(show));
        }
        assert_eq!(Show::from_name("nothing"), None);
    }
}
