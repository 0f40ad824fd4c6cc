//! A paper's tables and figures as data: content, our rows to compare, and the paper's claims.

use super::claim::Claim;
use crate::motion::Motion;

/// A paper whose techniques this project implements.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// First author and year: the first half of an exhibit's name.
    pub id: &'static str,
    /// Authors, title, venue, year.
    pub citation: &'static str,
    /// Hardware on which the paper measured times.
    pub hardware: &'static str,
    /// Memory bandwidth of that hardware, GB/s. Shadow maps are mostly limited by it, so times are compared relative to it.
    pub bandwidth_gb_s: f64,
    /// Techniques of the paper; their rows run as published and as ours.
    pub own: &'static [&'static str],
    /// Tables and figures, in the paper's order.
    pub exhibits: &'static [Exhibit],
}

/// A table or a figure.
#[derive(Clone, Copy, Debug)]
pub struct Exhibit {
    /// Name: `table1`, `figure3`, or `text` for numbers in the running text.
    pub id: &'static str,
    /// Description of the content.
    pub shows: &'static str,
    /// Rows to run; empty for a drawing.
    pub rows: &'static [Row],
    /// Claims of the paper about it, with their rules.
    pub claims: &'static [Claim],
    /// Omitted content with the reason; empty if complete.
    pub note: &'static str,
}

/// A measurement to run, with the paper's result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Name in the paper's terms, unique within the exhibit, because claims refer to rows by name.
    pub what: &'static str,
    /// Scene: `builtin:NAME`, or the name of a file in the folder given by [`SCENES_VARIABLE`](super::SCENES_VARIABLE). If the paper's own
    /// scene is not available, this is a similar one.
    pub scene: &'static str,
    /// Camera and lights by their name in [`VIEWS`](super::VIEWS); `None` uses the scene's own.
    pub view: Option<&'static str>,
    /// Name of the technique, possibly one still to be implemented; empty if none is measured.
    pub technique: &'static str,
    /// Parameters of both forms, as the paper set them for this row.
    pub settings: Settings,
    /// Additional parameters of our form.
    pub ours: Settings,
    /// Whether only the published form is run, because the row measures the published algorithm.
    pub is_published_alone: bool,
    /// Width and height of the image, pixels.
    pub size_px: (u32, u32),
    /// Factor of the light's size.
    pub light_scale: f32,
    /// Number of accumulated frames, for techniques that accumulate.
    pub frames: u32,
    /// Measurement, with the paper's own figure.
    pub measure: Measure,
    /// Whether the row takes a software renderer too long to run by default.
    pub is_slow: bool,
    /// Whether a row about errors is timed too, so that the page plots its error over its time.
    pub is_timed_too: bool,
    /// Position in the exhibit's plot of errors over a parameter.
    pub plotted: Option<Plotted>,
}

/// Point in a plot of errors over a parameter in which rows differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plotted {
    /// Axis label of the parameter, the same for all rows of an exhibit.
    pub axis: &'static str,
    /// Name of the point's line.
    pub line: &'static str,
    /// Value of the parameter, above zero.
    pub at: f64,
}

/// Parameters of a technique.
pub type Settings = &'static [(&'static str, &'static str)];

/// Measurement of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Milliseconds of the passes whose label contains the text (all passes if it is empty).
    Ms {
        /// Part of the label; several parts separated by `|` are summed.
        passes: &'static str,
        /// Figure as printed.
        paper: Reported,
    },
    /// Frames per second; ours are of the shadows alone.
    Fps {
        /// Figure as printed, for the whole frame.
        paper: Reported,
    },
    /// Milliseconds for rendering the camera's view, on the CPU's clock: a host's work before shadows.
    SceneMs {
        /// Figure as printed.
        paper: Reported,
    },
    /// Errors against the ground truth: `rmse`, `umbra_leak` and `lit_loss`. The papers show images of these.
    Error,
    /// Errors against exact filtering with the technique's own kernel of fixed width.
    FilteredError,
    /// Errors against another technique.
    Difference {
        /// Name of the other technique.
        from: &'static str,
        /// Parameters of the other technique.
        settings: Settings,
    },
    /// Flicker relative to the truth's own change during a motion, with a strip of frames as the image.
    Motion(Motion),
    /// Image of a debug view in colours, without a figure.
    Colors,
}

/// A paper's own figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reported {
    /// Printed number.
    Number(f64),
    /// Curve or bar without a number.
    Drawn,
}

impl Measure {
    /// Formats the paper's own figure for a table, with its unit.
    pub fn paper_text(&self) -> String {
        let text = |reported: &Reported, unit: &str| match reported {
            Reported::Number(value) => format!("{value} {unit}"),
            Reported::Drawn => "drawn".to_owned(),
        };
        match self {
            Self::Ms { paper, .. } | Self::SceneMs { paper } => text(paper, "ms"),
            Self::Fps { paper } => text(paper, "fps"),
            Self::Error | Self::FilteredError | Self::Difference { .. } | Self::Colors => "a picture".to_owned(),
            Self::Motion(_) => "words".to_owned(),
        }
    }

    /// Returns the paper's own figure in milliseconds per frame.
    pub fn paper_ms(&self) -> Option<f64> {
        match self {
            Self::Ms { paper: Reported::Number(ms), .. } | Self::SceneMs { paper: Reported::Number(ms) } => Some(*ms),
            Self::Fps { paper: Reported::Number(fps) } => Some(1e3 / fps),
            _ => None,
        }
    }

    /// Returns whether a technique's frames are timed.
    pub fn is_timed(&self) -> bool {
        matches!(self, Self::Ms { .. } | Self::Fps { .. })
    }

    /// Returns whether images are compared, which gives errors.
    pub fn is_error(&self) -> bool {
        matches!(self, Self::Error | Self::FilteredError | Self::Difference { .. })
    }
}

impl Row {
    /// Sets the image size.
    pub(super) const fn at(self, width: u32, height: u32) -> Self {
        Self { size_px: (width, height), ..self }
    }

    /// Sets the view, one of [`VIEWS`](super::VIEWS).
    pub(super) const fn seen(self, view: &'static str) -> Self {
        Self { view: Some(view), ..self }
    }

    /// Sets the factor of the light's size.
    pub(super) const fn light_scaled(self, light_scale: f32) -> Self {
        Self { light_scale, ..self }
    }

    /// Sets the number of accumulated frames.
    pub(super) const fn after_frames(self, frames: u32) -> Self {
        Self { frames, ..self }
    }

    /// Sets the parameters of both forms.
    pub(super) const fn with(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// Sets the additional parameters of our form.
    pub(super) const fn ours(self, ours: Settings) -> Self {
        Self { ours, ..self }
    }

    /// Runs the published form only.
    pub(super) const fn alone(self) -> Self {
        Self { is_published_alone: true, ..self }
    }

    /// Times the row, too.
    pub(super) const fn timed(self) -> Self {
        Self { is_timed_too: true, ..self }
    }

    /// Adds the row to the exhibit's plot.
    pub(super) const fn plotted(self, axis: &'static str, line: &'static str, at: f64) -> Self {
        Self { plotted: Some(Plotted { axis, line, at }), ..self }
    }

    /// Marks the row as too slow for a software renderer unless requested.
    pub(super) const fn slow(self) -> Self {
        self.slow_if(true)
    }

    /// Marks the row as too slow under a condition.
    pub(super) const fn slow_if(self, is_slow: bool) -> Self {
        Self { is_slow, ..self }
    }
}

const fn row(what: &'static str, scene: &'static str, technique: &'static str, measure: Measure) -> Row {
    Row {
        what,
        scene,
        view: None,
        technique,
        settings: &[],
        ours: &[],
        is_published_alone: false,
        size_px: (1280, 720),
        light_scale: 1.0,
        frames: 1,
        measure,
        is_slow: false,
        is_timed_too: false,
        plotted: None,
    }
}

/// Creates a row that compares images with the ground truth.
pub(super) const fn error(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::Error)
}

/// Creates a row that compares images with exact filtering by the same kernel.
pub(super) const fn filtered_error(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::FilteredError)
}

/// Creates a row that compares a technique's image with another technique's.
pub(super) const fn difference(
    what: &'static str,
    scene: &'static str,
    technique: &'static str,
    (from, settings): (&'static str, Settings),
) -> Row {
    row(what, scene, technique, Measure::Difference { from, settings })
}

/// Creates a row that measures flicker during a motion.
pub(super) const fn in_motion(what: &'static str, scene: &'static str, technique: &'static str, motion: Motion) -> Row {
    row(what, scene, technique, Measure::Motion(motion))
}

/// Creates a row that shows a debug view.
pub(super) const fn colors(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::Colors)
}

/// Creates a row that compares the milliseconds of all passes, or of those whose label contains `passes`.
pub(super) const fn ms(
    what: &'static str,
    scene: &'static str,
    technique: &'static str,
    passes: &'static str,
    paper: Reported,
) -> Row {
    row(what, scene, technique, Measure::Ms { passes, paper })
}

/// Creates a row that compares frames per second.
pub(super) const fn fps(what: &'static str, scene: &'static str, technique: &'static str, paper: f64) -> Row {
    row(what, scene, technique, Measure::Fps { paper: Reported::Number(paper) })
}

/// Creates a row that compares the milliseconds for rendering the camera's view.
pub(super) const fn scene_ms(what: &'static str, scene: &'static str, paper: f64) -> Row {
    row(what, scene, "", Measure::SceneMs { paper: Reported::Number(paper) })
}

impl Exhibit {
    /// Returns the number of runs: one per form of each row.
    pub fn run_count(&self, paper: &Paper) -> usize {
        self.rows.iter().map(|row| row.forms(paper).len()).sum()
    }
}

/// Creates an exhibit without anything to run.
pub(super) const fn drawing(id: &'static str, shows: &'static str) -> Exhibit {
    Exhibit { id, shows, rows: &[], claims: &[], note: "" }
}
