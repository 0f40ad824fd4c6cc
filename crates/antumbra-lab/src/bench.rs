//! The time of every pass of every technique: scenes × sizes × techniques.

use std::rc::Rc;
use std::time::{Duration, Instant};

use antumbra_scene::{Scene, Setup};
use glam::UVec2;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::progress::Progress;
use crate::technique_run::{TechniqueChoice, TechniqueRun, Timing, Timings, create, parameters_of};
use crate::view::View;

/// A scene to measure.
#[derive(Clone, Debug)]
pub struct BenchScene {
    /// How it was named: `builtin:street`, a path.
    pub spec: String,
    /// The scene.
    pub scene: Scene,
    /// Its camera and lights.
    pub setup: Setup,
    /// Which of the lights is measured.
    pub light: usize,
}

/// How many frames a measurement has, where there is time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// Before the timed ones.
    pub warm_up: u32,
    /// Timed.
    pub timed: u32,
}

/// One measurement.
#[derive(Clone, Debug, Serialize)]
pub struct BenchRow {
    /// How the scene was named.
    pub scene: String,
    /// Its triangles as drawn.
    pub triangles: usize,
    /// The name of the light.
    pub light: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The technique's name.
    pub technique: String,
    /// Every parameter with its value.
    pub parameters: Map<String, Value>,
    /// What came of it.
    #[serde(flatten)]
    pub outcome: BenchOutcome,
}

/// What came of a measurement.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BenchOutcome {
    /// It ran.
    Ran {
        /// Times.
        timings: Timings,
        /// GPU memory that the technique holds, bytes.
        memory_bytes: u64,
        /// Texels along a side of each map whose size is `auto`.
        auto_map_sizes: Vec<u32>,
    },
    /// The device lacks something, or the scene does not suit.
    Skipped(String),
}

/// Measures every scene at every size with every technique, and ends within `at_most` but for the measurement that
/// runs then: each has an equal share of the time that is left, so that what fast ones leave falls to slow ones, and those
/// for which none is left are skipped.
///
/// # Errors
/// Where a parameter is wrong or the device fails; a technique that the device cannot run is a skipped row.
pub fn bench(
    lab: &LabDevice,
    scenes: &[BenchScene],
    choices: &[TechniqueChoice],
    sizes_px: &[UVec2],
    frames: Frames,
    at_most: Duration,
    progress: &dyn Progress,
) -> Result<Vec<BenchRow>, LabError> {
    let deadline = Instant::now() + at_most;
    let mut rows = Vec::new();
    let steps = (scenes.len() * sizes_px.len() * choices.len()) as u64;
    progress.begin("measuring", steps);
    for BenchScene { spec, scene, setup, light } in scenes {
        let gpu_scene = Rc::new(GpuScene::upload(lab, scene));
        for &size_px in sizes_px {
            let view = View::of_uploaded(lab, &gpu_scene, setup, size_px)?;
            for choice in choices {
                let left = deadline.saturating_duration_since(Instant::now());
                let share = left / (steps as usize - rows.len()) as u32;
                let Frames { warm_up, timed } = frames;
                let timing = Timing { warm_up, frames: timed, at_least: Duration::ZERO, at_most: share };
                let measured = if left.is_zero() {
                    Ok(None)
                } else {
                    create(&lab.gpu(), choice).map_err(LabError::from).and_then(|mut technique| {
                        let parameters = parameters_of(&technique);
                        Ok(Some((parameters, view.run(&mut technique, *light, &timing)?)))
                    })
                };
                let (parameters, outcome) = match measured {
                    Ok(None) => (Map::new(), BenchOutcome::Skipped("no time was left for it".into())),
                    Ok(Some((parameters, TechniqueRun { timings, memory_bytes, auto_map_sizes, .. }))) => {
                        (parameters, BenchOutcome::Ran { timings, memory_bytes, auto_map_sizes })
                    }
                    Err(LabError::Technique(error @ antumbra::Error::Unsupported { .. })) => {
                        (Map::new(), BenchOutcome::Skipped(error.to_string()))
                    }
                    Err(error) => return Err(error),
                };
                rows.push(BenchRow {
                    scene: spec.clone(),
                    triangles: gpu_scene.triangle_count,
                    light: setup.lights[*light].name.clone(),
                    size: size_px.to_array(),
                    technique: choice.name(),
                    parameters,
                    outcome,
                });
                progress.reach(rows.len() as u64);
            }
        }
    }
    progress.end();
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use antumbra_scene::{LoadOptions, load};

    use super::*;
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;

    #[test]
    fn what_there_is_no_time_for_is_said() {
        let Some(lab) = lab_or_skip() else { return };
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        let scenes = [BenchScene { spec: "builtin:overlap".into(), scene, setup, light: 0 }];
        let choices = [TechniqueKind::Hard, TechniqueKind::Pcf].map(TechniqueChoice::default_of);
        let frames = Frames { warm_up: 1, timed: 3 };
        let measure = |at_most| {
            let rows = bench(lab, &scenes, &choices, &[UVec2::new(32, 18)], frames, at_most, &Silent).unwrap();
            let outcomes = rows.into_iter().map(|row| match row.outcome {
                BenchOutcome::Ran { timings, .. } => timings.frames.to_string(),
                BenchOutcome::Skipped(why) => why,
            });
            outcomes.collect::<Vec<_>>()
        };
        assert_eq!(measure(Duration::ZERO), ["no time was left for it"; 2]);
        assert_eq!(measure(Duration::from_secs(60)), ["3"; 2]);
    }
}
