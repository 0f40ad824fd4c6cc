//! Rows about motion: flicker relative to the truth's own change, and a strip of frames.

use std::rc::Rc;

use super::exhibit::Row;
use super::outcome::{Measured, Outcome};
use super::run::{Pictures, RunResult, Site};
use crate::error::LabError;
use crate::motion::{Motion, MotionOptions, MotionTruth, MovingScene};
use crate::progress::Silent;
use crate::technique_run::TechniqueChoice;

/// Number of moving frames.
const FRAMES: u32 = 12;
/// Metres per frame.
const STEP_M: f32 = 0.1;

impl Site<'_, '_> {
    /// Runs the technique through a motion.
    pub(super) fn look_at_motion(
        &mut self,
        motion: Motion,
        choice: &TechniqueChoice,
        about: Measured,
        with_pictures: bool,
    ) -> Result<RunResult, LabError> {
        let motions = vec![motion];
        let options = MotionOptions { motions, frames: FRAMES, step_m: STEP_M, caster: None, path: Vec::new() };
        let size_px = self.bench.options.size_of(self.row);
        let mut moving = MovingScene::new(self.bench.lab, &self.loaded.scene, self.setup, 0, size_px, &options)?;
        let truth = self.motion_truth(motion, &mut moving)?;
        let mut technique = self.view.create(choice)?;
        let figures = moving.run_until(&truth, &mut technique, self.bench.end)?;
        let measured = Measured {
            flicker: figures.flicker,
            still_flicker: truth.summary.change,
            truth_samples: Some(self.bench.options.samples),
            ..about
        };
        let pictures = with_pictures.then(|| Pictures {
            picture: figures.strip,
            reference: Some(truth.summary.strip.clone()),
            error: None,
        });
        Ok(RunResult { outcome: Outcome::Measured(measured), pictures, cut_short_s: None })
    }

    /// Returns the truth of a motion, traced once for all rows that use it.
    fn motion_truth(&mut self, motion: Motion, moving: &mut MovingScene<'_>) -> Result<Rc<MotionTruth>, LabError> {
        let samples = self.bench.options.samples;
        let size_px = self.bench.options.size_of(self.row);
        let Row { scene, view, light_scale, .. } = self.row;
        let key = format!("{scene} {view:?} {light_scale} {size_px} {samples} {}", motion.name());
        if let Some(truth) = self.bench.motion_truths.get(&key) {
            return Ok(Rc::clone(truth));
        }
        let truth = Rc::new(moving.trace_until(motion, samples, self.bench.deadline, &Silent)?);
        self.bench.motion_truths.insert(key, Rc::clone(&truth));
        Ok(truth)
    }
}
