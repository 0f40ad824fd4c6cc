//! Reference of a comparison: traced, or filtered exactly.

use std::time::Instant;

use antumbra_reference::{Tracer, VisibilityOptions};
use image::RgbImage;

use super::{CompareRequest, Truth};
use crate::error::LabError;
use crate::picture::Visibility;
use crate::progress::Progress;
use crate::report::{Reference, ReferenceInfo, Report};
use crate::scene_facts::SceneFacts;
use crate::technique_run::TechniqueChoice;
use crate::truth::{LightTruth, trace_lights_until};
use crate::view::View;

/// Reference of every light, with scene facts and warnings.
pub(super) struct Judge {
    /// References in the setup's order. A resumed report has the judged light's in every place, because others only shade its image.
    pub(super) truths: Vec<LightTruth>,
    /// Image shaded with all of them.
    pub(super) picture: RgbImage,
    pub(super) facts: Option<SceneFacts>,
    pub(super) warnings: Vec<String>,
    info: ReferenceInfo,
}

impl Judge {
    /// Traces every light.
    pub(super) fn trace(
        request: &CompareRequest<'_>,
        view: &View<'_>,
        deadline: Option<Instant>,
        progress: &dyn Progress,
    ) -> Result<Self, LabError> {
        // For a filtered reference, the tracer only determines which pixels are judged.
        let samples = if request.truth == Truth::Traced { request.samples } else { 1 };
        let options = VisibilityOptions { samples, ..VisibilityOptions::default() };
        progress.begin("building the acceleration structure", 0);
        let tracer = Tracer::new(request.scene)?;
        let (camera, lights) = (&request.setup.camera, &request.setup.lights);
        let receivers = tracer.primary(camera, request.size_px);
        let mut truths = trace_lights_until(&tracer, &receivers, lights, &options, deadline, progress)?;
        let mut warnings = request.scene.warnings.clone();
        let seen = view.surface_points()?;
        let others: Vec<usize> =
            truths.iter_mut().map(|truth| truth.unjudge_mismatched_surfaces(&seen, camera.eye)).collect();
        if others[request.light] > 0 {
            warnings.push(format!(
                "{} pixels are not measured: an edge passes through their centres, where the depth buffer shows another \
                 surface than the ray hits.",
                others[request.light]
            ));
        }
        // Scene facts need more than the single ray of a filtered reference.
        let facts = (request.truth == Truth::Traced).then(|| {
            let truth = &truths[request.light];
            SceneFacts::measure(request.scene, &tracer, &receivers, camera, &lights[request.light], truth)
        });
        let facts = facts.transpose()?;
        if request.truth == Truth::Filtered {
            let (own, warning) = filtered(request, view, &truths)?;
            truths = own;
            warnings.push(warning);
        }
        let visibilities: Vec<&Visibility> = truths.iter().map(|truth| &truth.visibility).collect();
        let picture = view.shade(&visibilities)?.to_srgb8();
        let LightTruth { rays, seconds, .. } = truths[request.light];
        Ok(Self { info: ReferenceInfo { samples, rays, seconds }, truths, picture, facts, warnings })
    }

    /// Returns the reference of an earlier report.
    pub(super) fn of_report(report: &Report, lights: usize) -> Self {
        let Reference { visibility, shaded, judged, info } = &report.reference;
        let truth = LightTruth {
            visibility: visibility.clone(),
            judged: judged.clone(),
            first_hits: [].into(),
            seconds: info.seconds,
            rays: info.rays,
        };
        Self {
            truths: vec![truth; lights],
            picture: shaded.clone(),
            facts: report.facts.clone(),
            warnings: report.warnings.clone(),
            info: *info,
        }
    }

    /// Returns the report's part of the reference.
    pub(super) fn reference(&self, light: usize) -> Reference {
        let truth = &self.truths[light];
        Reference {
            visibility: truth.visibility.clone(),
            shaded: self.picture.clone(),
            judged: truth.judged.clone(),
            info: self.info,
        }
    }
}

/// Returns the filtered references of the first technique with a kernel of fixed width, and a warning for the reader.
fn filtered(
    request: &CompareRequest<'_>,
    view: &View<'_>,
    judged: &[LightTruth],
) -> Result<(Vec<LightTruth>, String), LabError> {
    let Some(exact) = request.choices.iter().find_map(TechniqueChoice::filtered_truth) else {
        return Err(LabError::Request(
            "none of these techniques has a kernel of constant width to compare with; `--truth filtered` works for vsm, lvsm, \
             evsm, esm, convolution and moment"
                .into(),
        ));
    };
    let warning = format!(
        "Each technique is compared with exact percentage-closer filtering of its own shadow map by its own kernel, not with \
         traced visibility. The reference shown is that of {}.",
        exact.kind
    );
    Ok((filtered_truths(view, &exact, judged)?, warning))
}

/// Returns the references of a technique's own kernel, for the same judged pixels.
pub(super) fn filtered_truths(
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
