//! Techniques against the truth, on one scene, seen by one camera, for one light.

use antumbra::AnyShadow;
use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::{Scene, Setup, builtin};
use glam::{UVec2, Vec3};
use image::RgbImage;
use serde_json::Map;

use crate::device::LabDevice;
use crate::error::LabError;
use crate::metrics::{FlipMap, compare_visibility};
use crate::motion::{MotionOptions, MovingScene};
use crate::picture::Visibility;
use crate::progress::Progress;
use crate::report::{
    AdapterInfo, Measurement, MotionInfo, Outcome, PassTime, Reference, ReferenceInfo, Report, Row, SceneInfo, utc_now,
};
use crate::scene_facts::SceneFacts;
use crate::technique_run::{Clock, TechniqueChoice, TechniqueRun, Timing, create, parameters_of};
use crate::truth::{LightTruth, trace_lights};
use crate::view::View;

/// What techniques are held against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Truth {
    /// Light as it is: rays to the whole light.
    #[default]
    Traced,
    /// Exact comparisons of each technique's own map under its own kernel of fixed width: what a filterable basis
    /// approximates, apart from what a fixed width cannot be.
    Filtered,
}

/// What to compare.
#[derive(Clone, Debug)]
pub struct CompareRequest<'a> {
    /// How the scene was named: `builtin:overlap`, a path.
    pub spec: &'a str,
    /// The scene.
    pub scene: &'a Scene,
    /// Camera and lights. Every light shines in the pictures.
    pub setup: &'a Setup,
    /// The world position that scene and setup are counted from.
    pub anchor: Vec3,
    /// Which light is judged and timed.
    pub light: usize,
    /// Width and height, pixels.
    pub size_px: UVec2,
    /// The techniques, in the order to show them.
    pub choices: &'a [TechniqueChoice],
    /// What they are held against.
    pub truth: Truth,
    /// Light points for each pixel of the traced truth.
    pub samples: u32,
    /// Frames to warm up, and to time.
    pub timing: Timing,
    /// Pictures are shaded coherently; see [`crate::shading::Shading::bend_normals`].
    pub coherent: bool,
    /// What moves, where something is to.
    pub motion: Option<&'a MotionOptions>,
    /// The command line that makes the report again.
    pub command: String,
    /// The arguments of that command line which say what is seen: scene, setup, size.
    pub scene_arguments: String,
    /// The commit of the program.
    pub commit: &'a str,
}

/// Traces the truth, runs each technique, and says how far it is from the truth.
///
/// # Errors
/// Where the scene cannot be traced, a parameter is wrong, or the device fails. A technique that the device cannot run
/// is a row that says so.
pub fn compare(lab: &LabDevice, request: &CompareRequest<'_>, progress: &dyn Progress) -> Result<Report, LabError> {
    let make_view = if request.coherent { View::coherent } else { View::new };
    let view = make_view(lab, request.scene, request.setup, request.size_px)?;
    // All parameters are looked at before the long work begins.
    let techniques: Vec<_> = request.choices.iter().map(|choice| create(&lab.gpu(), choice)).collect();
    if let Some(error) = techniques.iter().find_map(|made| made.as_ref().err().filter(|e| !is_unsupported(e))) {
        return Err(error.clone().into());
    }

    let mut moving = request.motion.map(|options| moving_scene(lab, request, options)).transpose()?;

    // Of a filtered truth the tracer tells no more than which pixels are judged.
    let samples = if request.truth == Truth::Traced { request.samples } else { 1 };
    let options = VisibilityOptions { samples, ..VisibilityOptions::default() };
    progress.begin("building the ray tracer's tree", 0);
    let tracer = Tracer::new(request.scene)?;
    let receivers = tracer.primary(&request.setup.camera, request.size_px);
    let mut truths = trace_lights(&tracer, &receivers, &request.setup.lights, &options, progress)?;
    let mut warnings = request.scene.warnings.clone();
    let seen = view.surface_points()?;
    let others: Vec<usize> =
        truths.iter_mut().map(|truth| truth.judge_what_is_seen(&seen, request.setup.camera.eye)).collect();
    if others[request.light] > 0 {
        warnings.push(format!(
            "{} pixels are not judged: an edge passes through their centres, and the depth buffer shows another face \
             there than the ray meets.",
            others[request.light]
        ));
    }
    // A truth of one ray knows no penumbra.
    let facts = (request.truth == Truth::Traced).then(|| {
        let (camera, light) = (&request.setup.camera, &request.setup.lights[request.light]);
        SceneFacts::measure(request.scene, &tracer, &receivers, camera, light, &truths[request.light])
    });
    let facts = facts.transpose()?;
    if request.truth == Truth::Filtered {
        let Some(exact) = request.choices.iter().find_map(TechniqueChoice::filtered_truth) else {
            return Err(LabError::Request(
                "none of these techniques has a kernel of fixed width to be held against; a filtered truth is for vsm, \
                 lvsm, evsm, esm, convolution and moment"
                    .into(),
            ));
        };
        truths = filtered_truths(&view, &exact, &truths)?;
        warnings.push(format!(
            "Each technique is held against exact percentage-closer filtering of its own light map by its own kernel, \
             not against traced light. The truth shown is {}'s.",
            exact.kind
        ));
    }
    let true_visibilities: Vec<&Visibility> = truths.iter().map(|truth| &truth.visibility).collect();
    let true_picture = view.shade(&true_visibilities)?.to_srgb8();

    let mut rows = Vec::new();
    progress.begin("running the techniques", techniques.len() as u64);
    for (choice, made) in request.choices.iter().zip(techniques) {
        rows.push(row(&view, request, choice, made, &truths, &true_picture)?);
        progress.reach(rows.len() as u64);
    }
    progress.end();
    let motion = moving.as_mut().map(|moving| motions(lab, moving, request, &mut rows, progress)).transpose()?;
    warnings.extend(moving.and_then(|moving| moving.motions().1));

    let truth = &truths[request.light];
    Ok(Report {
        scene: scene_info(request, &view),
        facts,
        adapter: AdapterInfo::of(&lab.adapter),
        commit: request.commit.to_owned(),
        date: utc_now(),
        command: request.command.clone(),
        reference: Reference {
            visibility: truth.visibility.clone(),
            shaded: true_picture,
            judged: truth.judged.clone(),
            info: ReferenceInfo { samples, rays: truth.rays, seconds: truth.seconds },
        },
        rows,
        motion,
        warnings,
    })
}

fn moving_scene<'a>(
    lab: &'a LabDevice,
    request: &CompareRequest<'a>,
    options: &'a MotionOptions,
) -> Result<MovingScene<'a>, LabError> {
    if request.truth == Truth::Filtered {
        let why = "--motion holds techniques against traced light; leave out `--truth filtered`";
        return Err(LabError::Request(why.into()));
    }
    MovingScene::new(lab, request.scene, request.setup, request.light, request.size_px, options)
}

/// Runs the techniques that were measured through every motion, each with a new state, and adds the figures to their rows.
fn motions(
    lab: &LabDevice,
    moving: &mut MovingScene<'_>,
    request: &CompareRequest<'_>,
    rows: &mut [Row],
    progress: &dyn Progress,
) -> Result<MotionInfo, LabError> {
    let (frames, step_m) = moving.frames_and_step_m();
    let mut truths = Vec::new();
    for motion in moving.motions().0 {
        let truth = moving.trace(motion, request.samples, progress)?;
        progress.begin(&format!("techniques, {} in motion", motion.name()), rows.len() as u64);
        for (done, (row, choice)) in (1..).zip(rows.iter_mut().zip(request.choices)) {
            if let Outcome::Measured(measured) = &mut row.outcome {
                match moving.run(&truth, &mut create(&lab.gpu(), choice)?) {
                    Ok(figures) => {
                        if figures.lacking_room > 0 {
                            row.warnings.push(format!(
                                "While the {} moved, {} of {frames} frames lacked room for their lists, which counts as \
                                 flicker.",
                                motion.name(),
                                figures.lacking_room
                            ));
                        }
                        measured.motions.push(figures);
                    }
                    Err(LabError::Technique(error)) if is_unsupported(&error) => {
                        row.notes.push(format!("Not measured while the {} moves: {error}", motion.name()));
                    }
                    Err(error) => return Err(error),
                }
            }
            progress.reach(done);
        }
        progress.end();
        truths.push(truth.summary);
    }
    Ok(MotionInfo { frames, step_m, samples: request.samples, truths })
}

/// The truths of a technique's own kernel, over the pixels that are judged anyway.
fn filtered_truths(
    view: &View<'_>,
    exact: &TechniqueChoice,
    judged: &[LightTruth],
) -> Result<Vec<LightTruth>, LabError> {
    let mut technique = view.create(exact)?;
    let lights = judged.iter().enumerate();
    lights
        .map(|(light, truth)| {
            let visibility = view.draw(&mut technique, light, 1)?.visibility;
            Ok(LightTruth { visibility, seconds: 0.0, rays: 0, ..truth.clone() })
        })
        .collect()
}

fn is_unsupported(error: &antumbra::Error) -> bool {
    matches!(error, antumbra::Error::Unsupported { .. })
}

fn row(
    view: &View<'_>,
    request: &CompareRequest<'_>,
    choice: &TechniqueChoice,
    made: Result<AnyShadow, antumbra::Error>,
    truths: &[LightTruth],
    true_picture: &RgbImage,
) -> Result<Row, LabError> {
    let mut row = Row {
        technique: choice.name(),
        title: choice.kind.title().to_owned(),
        parameters: Map::new(),
        command: format!(
            "antumbra render {} --technique {}{} -o {}.png",
            request.scene_arguments,
            choice.name(),
            choice.settings.iter().map(|(key, value)| format!(" --set {key}={value}")).collect::<String>(),
            choice.name().replace(':', "-"),
        ),
        outcome: Outcome::Skipped(String::new()),
        warnings: Vec::new(),
        notes: Vec::new(),
    };
    let mut own_truths = None;
    if request.truth == Truth::Filtered {
        let Some(exact) = choice.filtered_truth() else {
            row.outcome = Outcome::Skipped(format!("{} has no kernel of fixed width to be held against", choice.kind));
            return Ok(row);
        };
        own_truths = Some(filtered_truths(view, &exact, truths)?);
    }
    let outcome = made.map_err(LabError::from).and_then(|mut technique| {
        row.parameters = parameters_of(&technique);
        run_all_lights(view, request, &mut technique)
    });
    row.outcome = match outcome {
        Ok(runs) => {
            let timings = &runs.judged.timings;
            if timings.clock == Clock::SubmitToDone {
                row.notes.push(format!(
                    "The adapter has no timestamps; from submission to completion it took {:.2} ms ({}).",
                    timings.total_ms,
                    timings.count()
                ));
            }
            let mut measured = match &own_truths {
                None => measure(view, request.light, runs, truths, true_picture)?,
                Some(own) => {
                    let visibilities: Vec<&Visibility> = own.iter().map(|truth| &truth.visibility).collect();
                    measure(view, request.light, runs, own, &view.shade(&visibilities)?.to_srgb8())?
                }
            };
            measured.own_truth = own_truths.map(|mut own| own.swap_remove(request.light).visibility);
            Outcome::Measured(Box::new(measured))
        }
        Err(LabError::Technique(error)) if is_unsupported(&error) => Outcome::Skipped(error.to_string()),
        Err(error) => return Err(error),
    };
    Ok(row)
}

/// The light that is judged, timed; of the others the masks, which are drawn once.
fn run_all_lights(view: &View<'_>, request: &CompareRequest<'_>, technique: &mut AnyShadow) -> Result<Runs, LabError> {
    let mut others = Vec::new();
    let mut judged = None;
    for light in 0..request.setup.lights.len() {
        if light == request.light {
            judged = Some(view.run(technique, light, &request.timing)?);
        } else {
            others.push(view.draw(technique, light, 1)?.visibility);
        }
    }
    let judged = judged.expect("the light that is judged is the setup's");
    Ok(Runs { judged, others })
}

/// What came of a technique's lights.
struct Runs {
    judged: TechniqueRun,
    /// Masks of the lights before and after it.
    others: Vec<Visibility>,
}

impl Runs {
    /// Every light's mask, in the setup's order, of which the judged one is `light`.
    fn visibilities(&self, light: usize) -> Vec<&Visibility> {
        let (before, after) = self.others.split_at(light);
        before.iter().chain([&self.judged.visibility]).chain(after).collect()
    }
}

fn measure(
    view: &View<'_>,
    light: usize,
    runs: Runs,
    truths: &[LightTruth],
    true_picture: &RgbImage,
) -> Result<Measurement, LabError> {
    let shaded = view.shade(&runs.visibilities(light))?.to_srgb8();
    let run = runs.judged;
    let truth = &truths[light];
    let mut metrics = compare_visibility(&truth.visibility, &run.visibility, &truth.judged)?;
    metrics.add_flip(&FlipMap::new(true_picture, &shaded)?);
    let count = run.timings.count();
    let passes = run.timings.passes.into_iter().map(|pass| PassTime {
        name: pass.label,
        median_ms: pass.ms,
        p10_ms: Some(pass.p10_ms),
        p90_ms: Some(pass.p90_ms),
        bytes: None,
    });
    Ok(Measurement {
        visibility: run.visibility,
        shaded,
        metrics,
        own_truth: None,
        passes: passes.collect(),
        total_ms: (run.timings.clock != Clock::SubmitToDone).then_some(run.timings.total_ms),
        count,
        memory_bytes: Some(run.memory_bytes),
        auto_map_sizes: run.auto_map_sizes,
        motions: Vec::new(),
    })
}

fn scene_info(request: &CompareRequest<'_>, view: &View<'_>) -> SceneInfo {
    let name = builtin::spec_of(request.spec).and_then(|spec| spec.split('?').next());
    let summary = name.and_then(builtin::named).map(|info| info.summary);
    SceneInfo {
        name: if name.is_some() { builtin::declared_name(request.spec) } else { request.scene.name.clone() },
        summary: summary.unwrap_or_default().to_owned(),
        triangles: view.triangle_count() as u64,
        setup_toml: request.setup.counted_from(-request.anchor).to_toml(),
    }
}
