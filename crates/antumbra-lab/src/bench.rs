//! The time of every pass of every technique: scenes × sizes × techniques.

use std::rc::Rc;

use antumbra_scene::{Scene, Setup};
use glam::UVec2;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::progress::Progress;
use crate::technique_run::{TechniqueChoice, Timing, Timings, create, parameters_of};
use crate::view::View;

/// A scene to measure.
#[derive(Clone, Debug)]
pub struct BenchScene {
    /// How it was named: `builtin:street`, a path.
    pub spec: String,
    /// The scene.
    pub scene: Scene,
    /// Its camera and lights; the first light is measured.
    pub setup: Setup,
}

/// One measurement.
#[derive(Clone, Debug, Serialize)]
pub struct BenchRow {
    /// How the scene was named.
    pub scene: String,
    /// Its triangles as drawn.
    pub triangles: usize,
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
    },
    /// The device lacks something, or the scene does not suit.
    Skipped(String),
}

/// Measures every scene at every size with every technique.
///
/// # Errors
/// Where a parameter is wrong or the device fails; a technique that the device cannot run is a skipped row.
pub fn bench(
    lab: &LabDevice,
    scenes: &[BenchScene],
    choices: &[TechniqueChoice],
    sizes_px: &[UVec2],
    timing: &Timing,
    progress: &dyn Progress,
) -> Result<Vec<BenchRow>, LabError> {
    let mut rows = Vec::new();
    let steps = (scenes.len() * sizes_px.len() * choices.len()) as u64;
    progress.begin("measuring", steps);
    for BenchScene { spec, scene, setup } in scenes {
        let gpu_scene = Rc::new(GpuScene::upload(lab, scene));
        for &size_px in sizes_px {
            let view = View::of_uploaded(lab, &gpu_scene, setup, size_px)?;
            for choice in choices {
                let measured = create(&lab.gpu(), choice).map_err(LabError::from).and_then(|mut technique| {
                    let parameters = parameters_of(&technique);
                    Ok((parameters, view.run(&mut technique, 0, timing)?))
                });
                let (parameters, outcome) = match measured {
                    Ok((parameters, run)) => {
                        (parameters, BenchOutcome::Ran { timings: run.timings, memory_bytes: run.memory_bytes })
                    }
                    Err(LabError::Technique(error @ antumbra::Error::Unsupported { .. })) => {
                        (Map::new(), BenchOutcome::Skipped(error.to_string()))
                    }
                    Err(error) => return Err(error),
                };
                rows.push(BenchRow {
                    scene: spec.clone(),
                    triangles: gpu_scene.triangle_count,
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
