//! What a paper shows, as data: its tables and figures, what stands in them, and what of ours to hold beside it.

/// A paper that this project implements.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// First author and year: the first half of an exhibit's name.
    pub id: &'static str,
    /// Authors, title, venue, year.
    pub citation: &'static str,
    /// What its times were measured on.
    pub hardware: &'static str,
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
}

/// One thing to run, and what the paper has for it.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What it is, in the paper's terms.
    pub what: &'static str,
    /// `builtin:NAME`, or the name of a file in the folder that `ANTUMBRA_SCENES` names. Where the paper's own scene
    /// is not to be had this is one of its kind.
    pub scene: &'static str,
    /// The technique, by the name that it has or will have.
    pub technique: &'static str,
    /// Its parameters, as the paper set them.
    pub settings: &'static [(&'static str, &'static str)],
    /// Width and height of the picture, pixels.
    pub size_px: (u32, u32),
    /// The light's size over its own.
    pub light_scale: f32,
    /// Frames that add up to the picture, for techniques that accumulate.
    pub frames: u32,
    /// What is measured, with the paper's own figure.
    pub measure: Measure,
}

/// What a row measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Milliseconds for the passes whose label contains the text (all where it is empty).
    Ms {
        /// Part of the label.
        passes: &'static str,
        /// As printed.
        paper: Reported,
    },
    /// Frames a second, of the shadows alone where we measure.
    Fps {
        /// As printed, for the whole frame.
        paper: Reported,
    },
    /// Errors against the truth: `rmse` and `umbra_leak`. The papers show pictures for these.
    Error,
    /// The same against exact filtering by the technique's own kernel of fixed width.
    FilteredError,
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
            Self::Ms { paper, .. } => text(paper, "ms"),
            Self::Fps { paper } => text(paper, "fps"),
            Self::Error | Self::FilteredError => "a picture".to_owned(),
        }
    }
}

impl Row {
    /// Another size of picture.
    pub(super) const fn at(self, width: u32, height: u32) -> Self {
        Self { size_px: (width, height), ..self }
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
    pub(super) const fn with(self, settings: &'static [(&'static str, &'static str)]) -> Self {
        Self { settings, ..self }
    }
}

const fn row(what: &'static str, scene: &'static str, technique: &'static str, measure: Measure) -> Row {
    Row { what, scene, technique, settings: &[], size_px: (1280, 720), light_scale: 1.0, frames: 1, measure }
}

/// A row that compares pictures.
pub(super) const fn error(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::Error)
}

/// A row that compares pictures of one kernel of fixed width.
pub(super) const fn filtered_error(what: &'static str, scene: &'static str, technique: &'static str) -> Row {
    row(what, scene, technique, Measure::FilteredError)
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

/// An exhibit without anything to run.
pub(super) const fn drawing(id: &'static str, shows: &'static str) -> Exhibit {
    Exhibit { id, shows, rows: &[] }
}
