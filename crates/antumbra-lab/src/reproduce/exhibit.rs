//! A paper's tables and figures as data: what is in them, what of ours to hold beside it, and what the
//! paper claims by it.

use super::claim::Claim;
use crate::motion::Motion;

/// A paper that this project implements.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// First author and year: the first half of an exhibit's name.
    pub id: &'static str,
    /// Authors, title, venue, year.
    pub citation: &'static str,
    /// What its times were measured on.
    pub hardware: &'static str,
    /// That hardware's memory bandwidth, GB/s: what shadow maps mostly wait for, so that times compare by it.
    pub bandwidth_gb_s: f64,
    /// Its own techniques: rows of them are run as published and as ours.
    pub own: &'static [&'static str],
    /// Its tables and figures, in the paper's order.
    pub exhibits: &'static [Exhibit],
}

/// A table or a figure.
#[derive(Clone, Copy, Debug)]
pub struct Exhibit {
    /// `table1`, `figure3`, or `text` for numbers in the running text.
    pub id: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// What to run for it; empty for a drawing.
    pub rows: &'static [Row],
    /// What the paper says of it, and how that is decided.
    pub claims: &'static [Claim],
    /// What of it is not shown here, and why; empty where all is.
    pub note: &'static str,
}

/// One thing to run, and what the paper has for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What it is, in the paper's terms. No two rows of an exhibit have one name: claims speak of rows by it.
    pub what: &'static str,
    /// `builtin:NAME`, or the name of a file in the folder that [`SCENES_VARIABLE`](super::SCENES_VARIABLE) names. Where the
    /// paper's own scene is not to be had this is one of its kind.
    pub scene: &'static str,
    /// Where from it is seen and what lights it, by name among [`VIEWS`](super::VIEWS); `None` as the scene itself says.
    pub view: Option<&'static str>,
    /// The technique, by the name that it has or will have; empty where none is measured.
    pub technique: &'static str,
    /// Its parameters in both forms, as the paper set them for this row.
    pub settings: Settings,
    /// Parameters of our form alone.
    pub ours: Settings,
    /// Whether there is no form of ours: what the row measures is of the published algorithm alone.
    pub is_published_alone: bool,
    /// Width and height of the picture, pixels.
    pub size_px: (u32, u32),
    /// The light's size over its own.
    pub light_scale: f32,
    /// Frames that add up to the picture, for techniques that accumulate.
    pub frames: u32,
    /// What is measured, with the paper's own figure.
    pub measure: Measure,
    /// Whether a software renderer takes too long over it to be asked for it in passing.
    pub is_dear: bool,
    /// Whether a row about errors is timed too, so that the page draws its error over its time.
    pub is_timed_too: bool,
    /// Where it stands in a plot of its exhibit's errors over a number.
    pub plotted: Option<Plotted>,
}

/// A point of a plot of errors over a number that rows differ in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plotted {
    /// What the number is, for the axis; one for all of an exhibit.
    pub axis: &'static str,
    /// The line that the point is on.
    pub line: &'static str,
    /// The number, above zero.
    pub at: f64,
}

/// A technique's parameters.
pub type Settings = &'static [(&'static str, &'static str)];

/// What a row measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Milliseconds for the passes whose label contains the text (all where it is empty).
    Ms {
        /// Part of the label; several parts with `|` between them add up.
        passes: &'static str,
        /// As printed.
        paper: Reported,
    },
    /// Frames a second, of the shadows alone where we measure.
    Fps {
        /// As printed, for the whole frame.
        paper: Reported,
    },
    /// Milliseconds for drawing what the camera sees, by the processor's clock: what hosts do before they ask for shadows.
    SceneMs {
        /// As printed.
        paper: Reported,
    },
    /// Errors against the truth: `rmse`, `umbra_leak` and `lit_loss`. The papers show pictures for these.
    Error,
    /// The same against exact filtering by the technique's own kernel of fixed width.
    FilteredError,
    /// The same against another technique.
    Difference {
        /// Its name.
        from: &'static str,
        /// Its parameters.
        settings: Settings,
    },
    /// Flicker against the truth's own change, frame by frame, while something moves; a strip of frames is its picture.
    Motion(Motion),
    /// No number: a debug view in colours, as the technique paints it.
    Colors,
}

/// A paper's own figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reported {
    /// Printed as a number.
    Number(f64),
    /// Only drawn, as a curve or a bar.
    Drawn,
}

impl Measure {
    /// The paper's own figure for a table, with its unit.
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

    /// The paper's own figure as milliseconds a frame.
    pub fn paper_ms(&self) -> Option<f64> {
        match self {
            Self::Ms { paper: Reported::Number(ms), .. } | Self::SceneMs { paper: Reported::Number(ms) } => Some(*ms),
            Self::Fps { paper: Reported::Number(fps) } => Some(1e3 / fps),
            _ => None,
        }
    }

    /// Whether a technique's frames are timed.
    pub fn is_timed(&self) -> bool {
        matches!(self, Self::Ms { .. } | Self::Fps { .. })
    }

    /// Whether pictures are compared, so that errors come out.
    pub fn is_error(&self) -> bool {
        matches!(self, Self::Error | Self::FilteredError | Self::Difference { .. })
    }
}

impl Row {
    /// Another size of picture.
    pub(super) const fn at(self, width: u32, height: u32) -> Self {
        Self { size_px: (width, height), ..self }
    }

    /// Seen from one of [`VIEWS`](super::VIEWS).
    pub(super) const fn seen(self, view: &'static str) -> Self {
        Self { view: Some(view), ..self }
    }

    /// With a light of another size.
    pub(super) const fn light_scaled(self, light_scale: f32) -> Self {
        Self { light_scale, ..self }
    }

    /// The picture after so many frames.
    pub(super) const fn after_frames(self, frames: u32) -> Self {
        Self { frames, ..self }
    }

    /// With parameters.
    pub(super) const fn with(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// With parameters of our form alone.
    pub(super) const fn ours(self, ours: Settings) -> Self {
        Self { ours, ..self }
    }

    /// Run as published alone.
    pub(super) const fn alone(self) -> Self {
        Self { is_published_alone: true, ..self }
    }

    /// Timed too.
    pub(super) const fn timed(self) -> Self {
        Self { is_timed_too: true, ..self }
    }

    /// A point of the exhibit's plot.
    pub(super) const fn plotted(self, axis: &'static str, line: &'static str, at: f64) -> Self {
        Self { plotted: Some(Plotted { axis, line, at }), ..self }
    }

    /// Too dear for a software renderer, unless it is asked for.
    pub(super) const fn dear(self) -> Self {
        self.dear_where(true)
    }

    /// The same, where it is so.
    pub(super) const fn dear_where(self, is_dear: bool) -> Self {
        Self { is_dear, ..self }
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
        is_dear: false,
        is_timed_too: false,
        plotted: None,
    }
}

/// A row that compares pictures.
pub(super) const fn error(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::Error)
}

/// A row that compares pictures of one kernel of fixed width.
pub(super) const fn filtered_error(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::FilteredError)
}

/// A row that compares a technique's picture with another technique's.
pub(super) const fn difference(
    what: &'static str,
    scene: &'static str,
    technique: &'static str,
    (from, settings): (&'static str, Settings),
) -> Row {
    row(what, scene, technique, Measure::Difference { from, settings })
}

/// A row that looks at frames while something moves.
pub(super) const fn in_motion(what: &'static str, scene: &'static str, technique: &'static str, motion: Motion) -> Row {
    row(what, scene, technique, Measure::Motion(motion))
}

/// A row that shows a debug view.
pub(super) const fn colors(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::Colors)
}

/// A row that compares milliseconds of all passes, or of those whose label contains `passes`.
pub(super) const fn ms(
    what: &'static str,
    scene: &'static str,
    technique: &'static str,
    passes: &'static str,
    paper: Reported,
) -> Row {
    row(what, scene, technique, Measure::Ms { passes, paper })
}

/// A row that compares frames a second.
pub(super) const fn fps(what: &'static str, scene: &'static str, technique: &'static str, paper: f64) -> Row {
    row(what, scene, technique, Measure::Fps { paper: Reported::Number(paper) })
}

/// A row that compares milliseconds for drawing what the camera sees.
pub(super) const fn scene_ms(what: &'static str, scene: &'static str, paper: f64) -> Row {
    row(what, scene, "", Measure::SceneMs { paper: Reported::Number(paper) })
}

impl Exhibit {
    /// How many runs its rows are: one for each form of each.
    pub fn run_count(&self, paper: &Paper) -> usize {
        self.rows.iter().map(|row| row.forms(paper).len()).sum()
    }
}

/// An exhibit without anything to run.
pub(super) const fn drawing(id: &'static str, shows: &'static str) -> Exhibit {
    Exhibit { id, shows, rows: &[], claims: &[], note: "" }
}
