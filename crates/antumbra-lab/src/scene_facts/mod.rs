//! Facts about a scene's shadows: measured in one view, for one light, by rays only.
//!
//! ```text
//! truth ─► lit, penumbra, umbra ─► some pixels of the penumbra ─► rays to the light ─► every occluder on them
//! ```
//!
//! **Depth of an occluder.** For shadow techniques, occluders differ by the width of the penumbra that each casts. With D the light's
//! extent across the ray and d of the ray's length L between receiver and occluder, the width is w = D d / (L − d) (the intercept theorem;
//! a sun's D is an angle, and w = D d). D is √12 times the standard deviation of the light's points along a direction: the side of a
//! square light. A closed mesh that a ray enters and leaves is one occluder, at the midpoint.
//!
//! **Distinct depths** of a pixel are the number of widths needed so that each occluder's width is between one of them and
//! 1.5 times it plus half a pixel. A depth that hides less than a sixteenth of the light does not count. Techniques with one
//! mean blocker depth assume one depth.
//!
//! **Widths in pixels** are for surfaces seen face on; receivers at grazing light have wider ones.

mod probe;
#[cfg(test)]
mod tests;

use antumbra_light::Light;
use antumbra_reference::{Receivers, ReferenceError, SampledLight, Tracer, VisibilityOptions};
use antumbra_scene::{Camera, Occluder, Scene};
use serde::{Deserialize, Serialize};

use crate::metrics::{LIT_ABOVE, UMBRA_BELOW};
use crate::truth::LightTruth;
use probe::{Probe, Tally};

/// Properties of a view of a scene, for one light.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// Shares of the image's pixels.
    pub picture: PictureShares,
    /// Properties of the penumbra; `None` without penumbra pixels.
    pub penumbra: Option<PenumbraFacts>,
    /// Share of the judged pixels that the light's centre sees at less than [`GRAZING_DEG`]; `None` without judged pixels.
    pub grazing: Option<f64>,
    /// Angular diameter of the light seen from its receivers, degrees.
    pub light_diameter_deg: Option<Spread>,
    /// Angle between the light's axis and its receivers, degrees; `None` for a sun.
    pub off_axis_deg: Option<Spread>,
    /// Share of the scene's triangles that are alpha-tested.
    pub masked_triangles: f64,
    /// Share of the scene's triangles that transmit light.
    pub tinted_triangles: f64,
}

/// Shares of an image's pixels; their sum is 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PictureShares {
    /// Judged pixels with V above 0.99.
    pub lit: f64,
    /// Judged pixels with V between.
    pub penumbra: f64,
    /// Judged pixels with V below 0.01.
    pub umbra: f64,
    /// Surfaces that face away from the light or are out of its reach, and pixels on edges.
    pub not_judged: f64,
    /// Pixels without a surface.
    pub background: f64,
}

/// Properties of the penumbra, as shares of its pixels or of the blockers on its rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PenumbraFacts {
    /// Number of examined pixels.
    pub pixels: u64,
    /// Share of the pixels with one distinct depth of blockers.
    pub one_depth: f64,
    /// Share of the pixels with two distinct depths.
    pub two_depths: f64,
    /// Share of the pixels with more distinct depths.
    pub more_depths: f64,
    /// Widths of the penumbrae, pixels.
    pub width_px: Spread,
    /// Share of blockers narrower than a texel of a map with [`DEFAULT_MAP_TEXELS`] per side that covers all judged pixels.
    pub thin: f64,
    /// Share of blockers that are alpha-tested.
    pub masked: f64,
    /// Share of blockers that transmit light.
    pub tinted: f64,
}

/// Median and 90th percentile of a distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
}

/// Texels per side of most techniques' maps by default.
pub const DEFAULT_MAP_TEXELS: f32 = 1024.0;

/// Angle between light and surface below which light is grazing, degrees.
pub const GRAZING_DEG: f32 = 15.0;

/// Maximum number of examined penumbra pixels: shares are accurate to 1.6 % (√(¼ / 1024)).
const MAX_PIXELS: usize = 1024;
/// Maximum number of rays per pixel.
const RAYS: u32 = 32;

impl PictureShares {
    /// Shares from numbers of pixels, of which `lit` and `penumbra` are among the judged ones.
    fn of(receivers: &Receivers, judged: usize, lit: usize, penumbra: usize) -> Self {
        let share = |count: usize| count as f64 / receivers.points.len().max(1) as f64;
        let hits = receivers.hits();
        Self {
            lit: share(lit),
            penumbra: share(penumbra),
            umbra: share(judged - lit - penumbra),
            not_judged: share(hits - judged.min(hits)),
            background: share(receivers.points.len() - hits),
        }
    }
}

/// Returns the share of a scene's triangles whose mesh is a wanted occluder.
fn share_of_triangles(scene: &Scene, occluders: &[Occluder], wanted: fn(&Occluder) -> bool) -> f64 {
    let is = |instance: &&antumbra_scene::Instance| wanted(&occluders[instance.mesh]);
    let count: usize = scene.instances.iter().filter(is).map(|i| scene.meshes[i.mesh].indices.len() / 3).sum();
    count as f64 / scene.triangle_count().max(1) as f64
}

impl SceneFacts {
    /// Measures a traced view. `receivers` are what `camera` sees through `tracer`, and `truth` is `light`'s there.
    ///
    /// # Errors
    /// If the light is invalid.
    pub fn measure(
        scene: &Scene,
        tracer: &Tracer,
        receivers: &Receivers,
        camera: &Camera,
        light: &Light,
        truth: &LightTruth,
    ) -> Result<Self, ReferenceError> {
        let options = VisibilityOptions { samples: RAYS, ..VisibilityOptions::default() };
        let sampled = SampledLight::new(light, &options)?;
        let judged: Vec<usize> = (0..receivers.points.len()).filter(|&i| truth.judged[i]).collect();
        let points = || judged.iter().filter_map(|&i| receivers.points[i]);

        let value = |pixel: usize| {
            let channels = truth.visibility.channel_count();
            (0..channels).map(|channel| truth.visibility.at(pixel, channel)).sum::<f32>() / channels as f32
        };
        let penumbra: Vec<usize> =
            judged.iter().copied().filter(|&i| (UMBRA_BELOW..=LIT_ABOVE).contains(&value(i))).collect();
        let lit = judged.iter().filter(|&&i| value(i) > LIT_ABOVE).count();

        let frame = light.frame();
        let towards = |at: glam::Vec3| if light.is_distant() { -light.axis } else { (light.center - at).normalize() };
        let grazing = points().filter(|p| p.normal.dot(towards(p.position)) < GRAZING_DEG.to_radians().sin()).count();
        let off_axis = |at: glam::Vec3| f64::from((-towards(at)).dot(frame.axis).clamp(-1.0, 1.0).acos().to_degrees());
        let diameter = |at: glam::Vec3| {
            let distance = if light.is_distant() { 1.0 } else { light.center.distance(at) };
            f64::from(2.0 * (light.bounding_radius() / distance.max(f32::MIN_POSITIVE)).atan().to_degrees())
        };

        let probe = Probe::new(scene, tracer, receivers, camera, light, &sampled, &judged);
        let mut tally = Tally::default();
        let chosen = penumbra.len().min(MAX_PIXELS);
        (0..chosen).for_each(|k| probe.look(penumbra[k * penumbra.len() / chosen], &mut tally));

        let occluders = scene.occluders();
        Ok(Self {
            picture: PictureShares::of(receivers, judged.len(), lit, penumbra.len()),
            penumbra: tally.facts(),
            grazing: (!judged.is_empty()).then(|| grazing as f64 / judged.len() as f64),
            light_diameter_deg: Spread::of(points().map(|p| diameter(p.position)).collect()),
            off_axis_deg: if light.is_distant() {
                None
            } else {
                Spread::of(points().map(|p| off_axis(p.position)).collect())
            },
            masked_triangles: share_of_triangles(scene, &occluders, |one| matches!(one, Occluder::Masked { .. })),
            tinted_triangles: share_of_triangles(scene, &occluders, |one| matches!(one, Occluder::Translucent)),
        })
    }

    /// Describes the facts in a few lines.
    pub fn lines(&self) -> Vec<String> {
        let p = &self.picture;
        let mut lines = vec![format!(
            "image: {} lit, {} penumbra, {} umbra, {} facing away from the light, {} background",
            percent(p.lit),
            percent(p.penumbra),
            percent(p.umbra),
            percent(p.not_judged),
            percent(p.background)
        )];
        match &self.penumbra {
            None => lines.push("penumbra: none".into()),
            Some(penumbra) => {
                lines.push(format!(
                    "penumbra: median width {} px, 90th percentile {} px; one depth of occluders in {} of it, two in {}, more in {}",
                    short(penumbra.width_px.median),
                    short(penumbra.width_px.p90),
                    percent(penumbra.one_depth),
                    percent(penumbra.two_depths),
                    percent(penumbra.more_depths)
                ));
                lines.push(format!(
                    "its occluders: {} narrower than a texel of a {DEFAULT_MAP_TEXELS}² map, {} alpha-tested, {} translucent",
                    percent(penumbra.thin),
                    percent(penumbra.masked),
                    percent(penumbra.tinted)
                ));
            }
        }
        if let (Some(diameter), Some(grazing)) = (self.light_diameter_deg, self.grazing) {
            let off_axis = self.off_axis_deg.map_or_else(String::new, |angle| {
                format!(
                    ", receivers at {}° from its axis (median; 90th percentile {}°)",
                    short(angle.median),
                    short(angle.p90)
                )
            });
            lines.push(format!(
                "light: {}° wide{off_axis}; {} of the receivers at grazing angles below {GRAZING_DEG}°",
                short(diameter.median),
                percent(grazing)
            ));
        }
        lines
    }
}

impl Spread {
    /// Returns the spread of some values; `None` if empty.
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let at = |fraction: f64| values.get(((values.len() as f64 - 1.0) * fraction).round() as usize).copied();
        Some(Self { median: at(0.5)?, p90: at(0.9)? })
    }
}

/// Formats a share as a percentage.
pub(crate) fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 0.5 => "under 1 %".into(),
        p => format!("{p:.0} %"),
    }
}

fn short(v: f64) -> String {
    if v < 10.0 { format!("{v:.1}") } else { format!("{v:.0}") }
}
