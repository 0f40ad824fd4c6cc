//! Outcome of a row.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::exhibit::Measure;
use super::figure::Figure;
use super::{SCENES_HINT, SCENES_VARIABLE};
use crate::stopwatch::FrameCount;

/// Outcome of a row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The row was measured.
    Measured(Measured),
    /// The row was not requested.
    NotRun,
    /// The library lacks this technique.
    NotYet(String),
    /// The scene is a file that is not available.
    NotReady(String),
    /// The row takes a software renderer too long to run by default.
    TooSlow,
    /// The device cannot run the row, for the given reason.
    Skipped(String),
    /// The row failed with the given message. Other rows continue.
    Failed(String),
}

/// Figures of a row; which ones exist depends on its measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Time of the row's passes, milliseconds; `None` for rows about errors.
    pub ms: Option<f64>,
    /// Number of timed and warm-up frames of `ms`.
    pub count: Option<FrameCount>,
    /// Time for rendering the camera's view, milliseconds.
    pub scene_ms: Option<f64>,
    /// Number of timed and warm-up frames of `scene_ms`.
    pub scene_count: Option<FrameCount>,
    /// Root mean square error.
    pub rmse: Option<f64>,
    /// Mean visibility where the reference is umbra.
    pub umbra_leak: Option<f64>,
    /// Mean missing visibility where the reference is lit.
    pub lit_loss: Option<f64>,
    /// Rms of the error's detail where the reference is smooth.
    #[serde(default)]
    pub noise: Option<f64>,
    /// Rms change of the mask between frames minus that of the truth.
    #[serde(default)]
    pub flicker: Option<f64>,
    /// Rms change of the truth itself: the flicker of a mask that never changes.
    #[serde(default)]
    pub still_flicker: Option<f64>,
    /// Light samples per pixel of the reference, if it was traced.
    #[serde(default)]
    pub truth_samples: Option<u32>,
    /// Root mean square error of a constant mask with the reference's mean, that is of an image without any
    /// shadow. An `rmse` far below it is small.
    pub flat_rmse: Option<f64>,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: Option<u64>,
    /// Width and height of the image, pixels.
    pub size_px: [u32; 2],
    /// Number of drawn triangles.
    pub triangles: u64,
}

impl Measured {
    /// Returns one of the figures.
    pub fn figure(&self, figure: Figure) -> Option<f64> {
        match figure {
            Figure::Ms => self.ms,
            Figure::Rmse => self.rmse,
            Figure::UmbraLeak => self.umbra_leak,
            Figure::LitLoss => self.lit_loss,
            Figure::Noise => self.noise,
            Figure::Flicker => self.flicker,
            Figure::MemoryMib => self.memory_bytes.map(|bytes| bytes as f64 / (1 << 20) as f64),
        }
    }

    /// Formats the row's main figures for tables, with units.
    pub fn text(&self, measure: &Measure) -> String {
        let number = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.4}"));
        let fps = |ms: f64| 1e3 / ms.max(f64::MIN_POSITIVE);
        match (measure, self.ms) {
            (Measure::Colors, _) => "an image".to_owned(),
            (Measure::Motion(_), _) => {
                let [flicker, still] = [self.flicker, self.still_flicker].map(number);
                format!("flicker {flicker}, the truth's change {still}")
            }
            (measure, _) if measure.is_error() => {
                let [rmse, leak, loss, noise] = [self.rmse, self.umbra_leak, self.lit_loss, self.noise].map(number);
                let time = self.ms.map_or_else(String::new, |ms| format!(", {ms:.3} ms{}", counted(self.count)));
                format!("rmse {rmse}, umbra leak {leak}, lit loss {loss}, noise {noise}{time}")
            }
            (_, None) => "–".to_owned(),
            (Measure::Fps { .. }, Some(ms)) => {
                let whole = self.scene_ms.map(|scene| {
                    let counted = counted(self.scene_count);
                    format!(", {:.2} including the scene{counted}", fps(ms + scene))
                });
                format!("{:.2} fps of shadows only{}{}", fps(ms), counted(self.count), whole.unwrap_or_default())
            }
            (_, Some(ms)) => format!("{ms:.3} ms{}", counted(self.count)),
        }
    }
}

/// Returns ` (median of 5 frames after 2)`.
fn counted(count: Option<FrameCount>) -> String {
    count.map_or_else(String::new, |count| format!(" ({count})"))
}

impl fmt::Display for Outcome {
    /// Writes the reason of a missing result, for a table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Measured(_) => write!(f, "measured"),
            Self::NotRun => write!(f, "not run"),
            Self::NotYet(technique) => write!(f, "not available: needs {technique}"),
            Self::NotReady(scene) => {
                write!(f, "not ready: set {SCENES_VARIABLE} to a folder that contains {scene} ({SCENES_HINT})")
            }
            Self::TooSlow => write!(f, "too slow for a software renderer; use --dear or a GPU to run it"),
            Self::Skipped(reason) => write!(f, "not possible on this device: {reason}"),
            Self::Failed(reason) => write!(f, "failed: {reason}"),
        }
    }
}

impl Outcome {
    /// Formats the outcome for a table.
    pub fn text(&self, measure: &Measure) -> String {
        match self {
            Self::Measured(measured) => measured.text(measure),
            other => other.to_string(),
        }
    }
}
