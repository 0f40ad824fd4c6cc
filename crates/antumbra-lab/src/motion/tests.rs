//! Tests of motions in built-in scenes, with small images.

use antumbra::TechniqueKind;
use antumbra_scene::{LoadOptions, load};

use super::*;
use crate::progress::Silent;
use crate::technique_run::{TechniqueChoice, create};
use crate::test_support::lab_or_skip;

const SIZE_PX: UVec2 = UVec2::new(80, 64);

struct Case {
    scene: Scene,
    setup: Setup,
    options: MotionOptions,
}

impl Case {
    fn new(spec: &str, frames: u32, step_m: f32) -> Self {
        let scene = load(spec, &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        let options = MotionOptions { motions: Motion::ALL.to_vec(), frames, step_m, caster: None, path: Vec::new() };
        Self { scene, setup, options }
    }

    fn moving<'a>(&'a self, lab: &'a LabDevice) -> Result<MovingScene<'a>, LabError> {
        MovingScene::new(lab, &self.scene, &self.setup, 0, SIZE_PX, &self.options)
    }

    /// Returns the truth of a motion and the measures of each technique.
    fn run(&self, lab: &LabDevice, motion: Motion, choices: &[TechniqueChoice]) -> (MotionTruth, Vec<MotionFigures>) {
        let mut moving = self.moving(lab).unwrap();
        let truth = moving.trace(motion, 256, &Silent).unwrap();
        let run = |choice: &TechniqueChoice| {
            let mut technique = create(&lab.gpu(), choice).unwrap();
            moving.run(&truth, &mut technique).unwrap()
        };
        let figures = choices.iter().map(run).collect();
        (truth, figures)
    }
}

#[test]
fn what_does_not_move_does_not_flicker() {
    let Some(lab) = lab_or_skip() else { return };
    let case = Case::new("builtin:leaning-plank", 2, 0.0);
    for motion in Motion::ALL {
        let choices = [TechniqueKind::Pcss, TechniqueKind::MultiLayer].map(TechniqueChoice::default_of);
        let (truth, figures) = case.run(lab, motion, &choices);
        assert_eq!(truth.summary.change, Some(0.0), "{motion:?}");
        for figures in figures {
            assert_eq!((figures.flicker, figures.ratio, figures.lag_frames), (Some(0.0), None, None), "{motion:?}");
            assert!(figures.after_stop.is_empty(), "no pixel was touched");
        }
    }
}

#[test]
fn hard_edges_flicker_more_than_soft_ones() {
    let Some(lab) = lab_or_skip() else { return };
    let case = Case::new("builtin:lantern-wall", 4, 0.15);
    let hard = TechniqueChoice::default_of(TechniqueKind::Hard);
    let views = vec![("samples".into(), "64".into()), ("view_size".into(), "256".into())];
    let choices = [hard, TechniqueChoice::with_settings(TechniqueKind::MultiView, views)];
    for motion in Motion::ALL {
        let (truth, figures) = case.run(lab, motion, &choices);
        let change = truth.summary.change.unwrap();
        let noise = truth.summary.noise.unwrap();
        let [hard, multi_view] = [0, 1].map(|i| figures[i].flicker.unwrap());
        assert!(change > 0.01, "{motion:?}: the truth changes by {change}");
        assert!(hard > 2.0 * multi_view && multi_view > 0.0, "{motion:?}: hard {hard}, multi_view {multi_view}");
        assert!(noise < 0.5 * multi_view, "{motion:?}: noise {noise} beside {multi_view}");
        for figures in &figures {
            assert!((figures.ratio.unwrap() - figures.flicker.unwrap() / change).abs() < 1e-9);
            assert_eq!(figures.lag_frames, Some(0), "{motion:?}: neither keeps anything of earlier frames");
        }
    }
}

/// A motion ends at the state of the unmoved scene, as in a still comparison.
#[test]
fn a_motion_arrives_at_the_scene_as_it_stands() {
    let Some(lab) = lab_or_skip() else { return };
    let case = Case::new("builtin:lantern-wall", 3, 0.3);
    let mut moving = case.moving(lab).unwrap();
    let truths = Motion::ALL.map(|motion| moving.trace(motion, 16, &Silent).unwrap());
    for truth in &truths {
        assert_eq!(truth.frames[3].visibility, truths[0].frames[3].visibility);
        assert_ne!(
            truth.frames[0].visibility, truth.frames[3].visibility,
            "{:?} moves something",
            truth.summary.motion
        );
    }
    assert_eq!(truths[2].summary.caster.as_deref().unwrap(), "lantern");
}

#[test]
fn a_scene_without_a_caster_apart_moves_the_rest() {
    let Some(lab) = lab_or_skip() else { return };
    let mut case = Case::new("builtin:hall", 1, 0.1);
    let (motions, left_out) = case.moving(lab).unwrap().motions();
    assert_eq!(motions, [Motion::Camera, Motion::Light]);
    assert!(left_out.unwrap().contains("Choose one with `--caster`: hall"));
    case.options.caster = Some("hall".into());
    assert_eq!(case.moving(lab).unwrap().motions(), (Motion::ALL.to_vec(), None));
    case.options.caster = Some("roof".into());
    assert!(case.moving(lab).unwrap_err().to_string().contains("there is no mesh `roof`"));
}
