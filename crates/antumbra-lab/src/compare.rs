//! Comparison of techniques with the ground truth, for one scene, camera and light.

mod motions;
mod rows;
mod truth;

use antumbra::AnyShadow;
use antumbra_scene::{Scene, Setup, builtin};
use glam::{UVec2, Vec3};
use serde_json::{Value, json};

use crate::device::LabDevice;
use crate::error::LabError;
use crate::identity::Identity;
use crate::limits::{Pace, Planned};
use crate::motion::{Motion, MotionOptions, MovingScene};
use crate::progress::Progress;
use crate::report::{AdapterInfo, Report, Row, SceneInfo, utc_now};
use crate::technique_run::{TechniqueChoice, Timing, create};
use crate::view::View;
use rows::{measure_row, planned};
use truth::Judge;

/// Reference of a comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Truth {
    /// Traced ground truth: rays to the whole light.
    #[default]
    Traced,
    /// Exact comparisons in each technique's own map under its own kernel of fixed width: the value that a filterable basis approximates,
    /// without the error of a fixed width.
    Filtered,
}

/// Request for a comparison.
#[derive(Clone, Debug)]
pub struct CompareRequest<'a> {
    /// Scene as named on the command line: `builtin:overlap`, a path.
    pub spec: &'a str,
    /// Geometry and materials.
    pub scene: &'a Scene,
    /// Camera and lights. All lights contribute to the shaded images.
    pub setup: &'a Setup,
    /// World position of the origin of scene and setup.
    pub anchor: Vec3,
    /// Index of the light that is judged and timed.
    pub light: usize,
    /// Width and height of the image, pixels.
    pub size_px: UVec2,
    /// Techniques in the order of display.
    pub choices: &'a [TechniqueChoice],
    /// Reference of the comparison.
    pub truth: Truth,
    /// Light samples per pixel of the traced ground truth.
    pub samples: u32,
    /// Number of warm-up and timed frames.
    pub timing: Timing,
    /// Whether images are shaded coherently; see [`crate::shading::Shading::bend_normals`].
    pub coherent: bool,
    /// Motions to measure, if any.
    pub motion: Option<&'a MotionOptions>,
    /// Command line that reproduces the report.
    pub command: String,
    /// Arguments of that command line that select scene, setup and size.
    pub scene_arguments: String,
    /// Commit of the program.
    pub commit: &'a str,
}

impl CompareRequest<'_> {
    /// Returns everything that a report depends on, for resuming it.
    pub fn identity(&self, lab: &LabDevice) -> Identity {
        Identity::new(lab, self.commit, &self.settings())
    }

    /// Returns the scene's name in the report.
    pub fn scene_name(&self) -> String {
        if self.builtin_name().is_some() { builtin::declared_name(self.spec) } else { self.scene.name.clone() }
    }

    fn builtin_name(&self) -> Option<&str> {
        builtin::spec_of(self.spec).and_then(|spec| spec.split('?').next())
    }

    fn settings(&self) -> Value {
        let technique = |choice: &TechniqueChoice| format!("{}{}", choice.name(), choice.as_arguments());
        let motion = self.motion.map(|options| {
            let path: Vec<String> = options.path.iter().map(|camera| format!("{camera:?}")).collect();
            json!({
                "motions": options.motions.iter().map(|motion| motion.name()).collect::<Vec<_>>(),
                "frames": options.frames, "step_m": options.step_m.to_string(), "caster": options.caster, "path": path,
            })
        });
        json!({
            "scene": self.scene_arguments,
            "triangles": self.scene.triangle_count(),
            "setup": self.setup.relative_to(-self.anchor).to_toml(),
            "light": self.setup.lights[self.light].name,
            "truth": format!("{:?}", self.truth).to_lowercase(),
            "samples": self.samples,
            "frames": self.timing.frames,
            "coherent": self.coherent,
            "techniques": self.choices.iter().map(technique).collect::<Vec<_>>(),
            "motion": motion,
        })
    }
}

/// Callback that receives the report whenever it has grown.
pub type ReportCallback<'a> = &'a mut dyn FnMut(&Report) -> Result<(), LabError>;

/// Traces the ground truth, runs each technique, and measures its errors. `earlier` is an unfinished report of the same
/// [identity](CompareRequest::identity); its results are not measured again. Measurements that are not expected to end before the deadline
/// are named in [`Report::missing`].
///
/// # Errors
/// If the scene cannot be traced, a parameter is wrong, the device fails, the deadline passes before the truth is traced, or `each` fails.
/// A technique that the device cannot run is a row with the reason.
pub fn compare(
    lab: &LabDevice,
    request: &CompareRequest<'_>,
    earlier: Option<Report>,
    pace: &mut Pace,
    each: ReportCallback<'_>,
    progress: &dyn Progress,
) -> Result<Report, LabError> {
    let make_view = if request.coherent { View::coherent } else { View::new };
    let view = make_view(lab, request.scene, request.setup, request.size_px)?;
    // Check all parameters before the long work begins.
    let techniques: Vec<_> = request.choices.iter().map(|choice| create(&lab.gpu(), choice)).collect();
    if let Some(error) = techniques.iter().find_map(|made| made.as_ref().err().filter(|e| !is_unsupported(e))) {
        return Err(error.clone().into());
    }
    let mut moving = request.motion.map(|options| moving_scene(lab, request, options)).transpose()?;
    let judge = match &earlier {
        Some(report) => Judge::of_report(report, request.setup.lights.len()),
        None => Judge::trace(request, &view, pace.deadline(), progress)?,
    };
    let motions = moving.as_ref().map(|moving| moving.motions().0).unwrap_or_default();
    let mut report = begin(lab, request, &view, &judge, &techniques, earlier, pace);
    name_missing(&mut report, &motions);
    each(&report)?;

    progress.begin("running the techniques", techniques.len() as u64);
    for (i, (choice, made)) in request.choices.iter().zip(techniques).enumerate() {
        if report.rows[i].is_missing {
            let (name, row) = (choice.name(), report.rows[i].clone());
            let began = std::time::Instant::now();
            let measured = pace.measure(Planned::new(&name, request.size_px), |end| {
                measure_row(&view, request, &judge, (choice, made), row, end)
            })?;
            if let Some(row) = measured {
                report.rows[i] = Row { seconds: began.elapsed().as_secs_f64(), ..row };
                name_missing(&mut report, &motions);
                each(&report)?;
            }
        }
        progress.reach(i as u64 + 1);
    }
    progress.end();
    if let Some(moving) = &mut moving {
        motions::measure(lab, moving, request, &mut report, pace, each, progress)?;
    }
    Ok(report)
}

/// Returns the report before its first measurement, with the results of an earlier one.
fn begin(
    lab: &LabDevice,
    request: &CompareRequest<'_>,
    view: &View<'_>,
    judge: &Judge,
    techniques: &[Result<AnyShadow, antumbra::Error>],
    earlier: Option<Report>,
    pace: &mut Pace,
) -> Report {
    let made = request.choices.iter().zip(techniques);
    let mut rows: Vec<Row> = made.map(|(choice, made)| planned(request, choice, made.as_ref().ok())).collect();
    let (earlier_rows, motion) = earlier.map_or_else(Default::default, |earlier| (earlier.rows, earlier.motion));
    for (row, earlier) in rows.iter_mut().zip(earlier_rows) {
        if earlier.is_missing {
            continue;
        }
        pace.took(Planned::new(&earlier.technique, request.size_px), earlier.seconds);
        if !pace.is_longer_than(earlier.cut_short_s) {
            *row = earlier;
        }
    }
    Report {
        scene: scene_info(request, view),
        facts: judge.facts.clone(),
        adapter: AdapterInfo::of(&lab.adapter),
        commit: request.commit.to_owned(),
        date: utc_now(),
        command: request.command.clone(),
        reference: judge.reference(request.light),
        rows,
        motion,
        settings: request.settings(),
        missing: Vec::new(),
        baseline: None,
        warnings: judge.warnings.clone(),
    }
}

/// Names the missing measurements: rows, and motions of measured rows.
fn name_missing(report: &mut Report, motions: &[Motion]) {
    let rows = report.rows.iter().filter(|row| row.is_missing).map(|row| row.technique.clone());
    let in_motion = motions.iter().flat_map(|motion| motions::open_names(&report.rows, *motion));
    report.missing = rows.chain(in_motion).collect();
}

fn moving_scene<'a>(
    lab: &'a LabDevice,
    request: &CompareRequest<'a>,
    options: &'a MotionOptions,
) -> Result<MovingScene<'a>, LabError> {
    if request.truth == Truth::Filtered {
        let why = "--motion compares techniques with traced visibility; omit `--truth filtered`";
        return Err(LabError::Request(why.into()));
    }
    MovingScene::new(lab, request.scene, request.setup, request.light, request.size_px, options)
}

fn is_unsupported(error: &antumbra::Error) -> bool {
    matches!(error, antumbra::Error::Unsupported { .. })
}

fn scene_info(request: &CompareRequest<'_>, view: &View<'_>) -> SceneInfo {
    let summary = request.builtin_name().and_then(builtin::named).map(|info| info.summary);
    SceneInfo {
        name: request.scene_name(),
        summary: summary.unwrap_or_default().to_owned(),
        triangles: view.triangle_count() as u64,
        setup_toml: request.setup.relative_to(-request.anchor).to_toml(),
    }
}
