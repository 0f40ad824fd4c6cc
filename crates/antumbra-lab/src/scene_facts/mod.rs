//! Facts about a scene's shadows: measured in one view, for one light, by rays alone.
//!
//! ```text
//! truth ─► lit, penumbra, umbra ─► some pixels of the penumbra ─► rays to the light ─► every occluder on them
//! ```
//!
//! **An occluder's depth.** What sets occluders apart for a shadow technique is how wide a penumbra each casts. With D the light's
//! extent across the ray and d of the ray's length L between receiver and occluder, that is w = D d / (L − d) (the intercept
//! theorem; a sun's D is an angle, and w = D d). D is √12 times the standard deviation of the light's points along a direction: a
//! square's side. A closed mesh that a ray enters and leaves is one occluder, midway.
//!
//! **Distinct depths** of a pixel are how many widths it takes so that each occluder's is from one of them to half as wide again
//! and half a pixel; a depth that hides less than a sixteenth of the light does not count. One depth is what techniques with one mean
//! blocker assume.
//!
//! **Widths in pixels** are as seen face on; receivers that the light grazes stretch them.

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

/// What a view of a scene is like, for one light.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// What the picture shows, as shares of its pixels.
    pub picture: PictureShares,
    /// What is in the penumbra; `None` without a pixel of it.
    pub penumbra: Option<PenumbraFacts>,
    /// Share of the judged pixels whose surface the light's centre sees at less than [`GRAZING_DEG`]; `None` without one.
    pub grazing: Option<f64>,
    /// How wide the light is, as its receivers see it, degrees.
    pub light_diameter_deg: Option<Spread>,
    /// How far off the light's axis its receivers lie, degrees; `None` for a sun.
    pub off_axis_deg: Option<Spread>,
    /// Share of the scene's triangles whose material is masked.
    pub masked_triangles: f64,
    /// Share of the scene's triangles whose surface lets some light through.
    pub tinted_triangles: f64,
}

/// Shares of a picture's pixels, one in all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PictureShares {
    /// Judged, and V above 0.99.
    pub lit: f64,
    /// Judged, and V between.
    pub penumbra: f64,
    /// Judged, and V below 0.01.
    pub umbra: f64,
    /// Surfaces turned from the light or out of its reach, and pixels on edges.
    pub not_judged: f64,
    /// Nothing there.
    pub background: f64,
}

/// What is in the penumbra; shares of its pixels, or of what blocks rays there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PenumbraFacts {
    /// Pixels that were looked at.
    pub pixels: u64,
    /// Share of the pixels with one distinct depth of occluders.
    pub one_depth: f64,
    /// With two.
    pub two_depths: f64,
    /// With more.
    pub more_depths: f64,
    /// How wide the penumbrae are, pixels.
    pub width_px: Spread,
    /// Share of what blocks that is narrower than a texel of a map of [`DEFAULT_MAP_TEXELS`] a side over all that is judged.
    pub thin: f64,
    /// Share of what blocks that is alpha-masked.
    pub masked: f64,
    /// Share of what blocks that lets some light through.
    pub tinted: f64,
}

/// Middle and upper end of what varies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Half are below.
    pub median: f64,
    /// Nine of ten are below.
    pub p90: f64,
}

/// Texels along a side of most techniques' maps at their defaults.
pub const DEFAULT_MAP_TEXELS: f32 = 1024.0;

/// Light that comes in at less than this over a surface grazes it.
pub const GRAZING_DEG: f32 = 15.0;

/// Pixels of the penumbra that are looked at, at most: shares are known to 1.6 % (√(¼ / 1024)).
const MOST_PIXELS: usize = 1024;
/// Rays from each, at most.
const RAYS: u32 = 32;

impl SceneFacts {
    /// Looks at a traced view. `receivers` are what `camera` sees through `tracer`, and `truth` is `light`'s there.
    ///
    /// # Errors
    /// Where the light is invalid.
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
        let share = |count: usize| count as f64 / receivers.points.len().max(1) as f64;
        let penumbra: Vec<usize> =
            judged.iter().copied().filter(|&i| (UMBRA_BELOW..=LIT_ABOVE).contains(&value(i))).collect();
        let lit = judged.iter().filter(|&&i| value(i) > LIT_ABOVE).count();
        let hits = receivers.hits();
        let picture = PictureShares {
            lit: share(lit),
            penumbra: share(penumbra.len()),
            umbra: share(judged.len() - lit - penumbra.len()),
            not_judged: share(hits - judged.len().min(hits)),
            background: share(receivers.points.len() - hits),
        };

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
        let chosen = penumbra.len().min(MOST_PIXELS);
        (0..chosen).for_each(|k| probe.look(penumbra[k * penumbra.len() / chosen], &mut tally));

        let occluders = scene.occluders();
        let triangles_of = |wanted: fn(&Occluder) -> bool| {
            let is = |instance: &&antumbra_scene::Instance| wanted(&occluders[instance.mesh]);
            let count: usize = scene.instances.iter().filter(is).map(|i| scene.meshes[i.mesh].indices.len() / 3).sum();
            count as f64 / scene.triangle_count().max(1) as f64
        };
        Ok(Self {
            picture,
            penumbra: tally.facts(),
            grazing: (!judged.is_empty()).then(|| grazing as f64 / judged.len() as f64),
            light_diameter_deg: Spread::of(points().map(|p| diameter(p.position)).collect()),
            off_axis_deg: if light.is_distant() {
                None
            } else {
                Spread::of(points().map(|p| off_axis(p.position)).collect())
            },
            masked_triangles: triangles_of(|occluder| matches!(occluder, Occluder::Masked { .. })),
            tinted_triangles: triangles_of(|occluder| matches!(occluder, Occluder::Translucent)),
        })
    }

    /// In words, a few lines.
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
                    ", receivers {}° off its axis (median; 90th percentile {}°)",
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
    /// `None` of nothing.
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let at = |fraction: f64| values.get(((values.len() as f64 - 1.0) * fraction).round() as usize).copied();
        Some(Self { median: at(0.5)?, p90: at(0.9)? })
    }
}

/// Of a share.
pub(crate) fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 0.5 => "under 1 %".into(),
        p => format!("{p:.0} %"),
    }
}

fn short(v: f64) -> String {
    if v < 10.0 { format!("{v:.1}") } else { format!("{v:.0}") }
}
