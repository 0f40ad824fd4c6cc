//! Incremental tracing of one job by rows: receivers first, then rounds of shadow rays.

use std::sync::atomic::AtomicBool;

use antumbra_reference::{Receivers, SampledLight, Tracer, VisibilityOptions};

use super::{Estimate, Job, NOT_JUDGED, ROUND_POINTS, ROUNDS};

/// Progress of a job.
#[derive(Debug)]
pub struct Tracing {
    id: u64,
    job: Job,
    receivers: Receivers,
    /// Samples of the light in the current round; set once the receivers are traced.
    light: Option<SampledLight>,
    /// Number of completed rounds.
    rounds: u32,
    /// Number of completed rows of the receivers or of the current round.
    rows: u32,
    /// Visibility by pixel, summed over rounds, and whether the pixel is judged.
    sums: Vec<f64>,
    is_judged: Vec<bool>,
}

impl Tracing {
    /// Creates a job without progress.
    pub fn new(id: u64, job: Job) -> Self {
        let pixels = (job.size_px.x * job.size_px.y) as usize;
        let receivers = Receivers { size_px: job.size_px, points: Vec::with_capacity(pixels) };
        Self {
            id,
            job,
            receivers,
            light: None,
            rounds: 0,
            rows: 0,
            sums: vec![0.0; pixels],
            is_judged: vec![false; pixels],
        }
    }

    /// The job.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// Whether all rounds are done.
    pub fn is_done(&self) -> bool {
        self.rounds == ROUNDS
    }

    /// Traces `rows` more rows, up to the end of the round. The end of a round returns an estimate.
    ///
    /// # Errors
    /// Fails with one line if the light cannot be traced, or if `cancel` was set.
    pub fn advance(&mut self, tracer: &Tracer, rows: u32, cancel: &AtomicBool) -> Result<Option<Estimate>, String> {
        let Job { camera, size_px, light, .. } = &self.job;
        let part = self.rows..self.rows.saturating_add(rows).min(size_px.y);
        self.rows = part.end;
        let is_last = part.end == size_px.y;
        if self.receivers.points.len() < self.sums.len() {
            self.receivers.points.extend(tracer.primary_in_rows(camera, *size_px, part));
            if is_last {
                self.rows = 0;
            }
            return Ok(None);
        }
        let sampled = match self.light.take() {
            Some(sampled) => sampled,
            None => {
                let options =
                    VisibilityOptions { samples: ROUND_POINTS, seed: self.rounds, ..VisibilityOptions::default() };
                SampledLight::new(light, &options).map_err(|error| error.to_string())?
            }
        };
        let first = (part.start * size_px.x) as usize;
        let traced =
            tracer.visibility_in_rows(&self.receivers, part, &sampled, cancel).map_err(|error| error.to_string())?;
        for (sum, value) in self.sums[first..].iter_mut().zip(traced.mean_channel()) {
            *sum += f64::from(value);
        }
        for (is_judged, faces) in self.is_judged[first..].iter_mut().zip(traced.faces_light_center) {
            *is_judged = faces;
        }
        if !is_last {
            self.light = Some(sampled);
            return Ok(None);
        }
        self.rows = 0;
        self.rounds += 1;
        Ok(Some(self.estimate()))
    }

    fn estimate(&self) -> Estimate {
        let mean = |(sum, is_judged): (&f64, &bool)| {
            if *is_judged { (sum / f64::from(self.rounds)) as f32 } else { NOT_JUDGED }
        };
        Estimate {
            job: self.id,
            size_px: self.job.size_px,
            points: self.rounds * ROUND_POINTS,
            values: self.sums.iter().zip(&self.is_judged).map(mean).collect(),
        }
    }
}
