//! Outcome of a row.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::exhibit::Measure;
use super::figure::Figure;
use super::{SCENES_HINT, SCENES_VARIABLE};
use crate::stopwatch::FrameCount;

/// What came of a row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It was measured.
    Measured(Measured),
    /// Nobody has asked for it.
    NotRun,
    /// The library does not have this technique yet.
    NotYet(String),
    /// The scene is a file, which is not here.
    NotReady(String),
    /// It takes a software renderer too long to be run unasked.
    TooDear,
    /// This device cannot: why.
    Skipped(String),
    /// It went wrong: how. Other rows go on.
    Failed(String),
}

/// The figures of a row; which there are depends on what it measures.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Milliseconds, of the passes that the row names. None where it is about errors.
    pub ms: Option<f64>,
    /// Of how many frames that is the median, and after how many.
    pub count: Option<FrameCount>,
    /// Milliseconds for drawing what the camera sees, beside it.
    pub scene_ms: Option<f64>,
    /// Of how many frames that is the median, and after how many.
    pub scene_count: Option<FrameCount>,
    /// Root of the mean squared error.
    pub rmse: Option<f64>,
    /// Mean visibility where the reference is umbra.
    pub umbra_leak: Option<f64>,
    /// Mean of what is missing where the reference is lit.
    pub lit_loss: Option<f64>,
    /// Rms of the error's detail where the reference is smooth.
    #[serde(default)]
    pub noise: Option<f64>,
    /// Rms of the mask's change from frame to frame less the truth's.
    #[serde(default)]
    pub flicker: Option<f64>,
    /// The truth's own change: what a mask that never changes would flicker.
    #[serde(default)]
    pub still_flicker: Option<f64>,
    /// Light points a pixel of the reference, where it was traced.
    #[serde(default)]
    pub truth_samples: Option<u32>,
    /// Root of the mean squared error of a mask that has the reference's mean everywhere: what a picture without any shadow in
    /// it would err. Large beside it, errors are small.
    pub flat_rmse: Option<f64>,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: Option<u64>,
    /// Width and height of the picture, pixels.
    pub size_px: [u32; 2],
    /// Triangles as drawn.
    pub triangles: u64,
}

impl Measured {
    /// One of its figures.
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

    /// What the row is about, for tables, with units.
    pub fn text(&self, measure: &Measure) -> String {
        let number = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.4}"));
        let fps = |ms: f64| 1e3 / ms.max(f64::MIN_POSITIVE);
        match (measure, self.ms) {
            (Measure::Colors, _) => "a picture".to_owned(),
            (Measure::Motion(_), _) => {
                let [flicker, still] = [self.flicker, self.still_flicker].map(number);
                format!("flicker {flicker} where the truth changes by {still}")
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
                    format!(", {:.2} with the scene drawn{counted}", fps(ms + scene))
                });
                format!("{:.2} fps of shadows alone{}{}", fps(ms), counted(self.count), whole.unwrap_or_default())
            }
            (_, Some(ms)) => format!("{ms:.3} ms{}", counted(self.count)),
        }
    }
}

/// ` (median of 5 frames after 2)`.
fn counted(count: Option<FrameCount>) -> String {
    count.map_or_else(String::new, |count| format!(" ({count})"))
}

impl fmt::Display for Outcome {
    /// Why there is nothing, for a table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Measured(_) => write!(f, "measured"),
            Self::NotRun => write!(f, "not run"),
            Self::NotYet(technique) => write!(f, "not there yet: it needs {technique}"),
            Self::NotReady(scene) => {
                write!(f, "not ready: set {SCENES_VARIABLE} to a folder that holds {scene} ({SCENES_HINT})")
            }
            Self::TooDear => write!(f, "too dear for a software renderer unless asked for by --dear"),
            Self::Skipped(reason) => write!(f, "not possible on this device: {reason}"),
            Self::Failed(reason) => write!(f, "failed: {reason}"),
        }
    }
}

impl Outcome {
    /// For a table.
    pub fn text(&self, measure: &Measure) -> String {
        match self {
            Self::Measured(measured) => measured.text(measure),
            other => other.to_string(),
        }
    }
}
