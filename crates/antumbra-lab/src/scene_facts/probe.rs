//! Rays from a penumbra pixel to the light, and all occluders on them.

use antumbra_light::{Light, LightFrame, LightPoint};
use antumbra_reference::{ReceiverPoint, Receivers, SampledLight, Tracer};
use antumbra_scene::{Camera, Occluder, Scene};
use glam::Vec3;

use super::{DEFAULT_MAP_TEXELS, PenumbraFacts, RAYS, Spread};

/// Minimum fraction of the light that a depth hides.
const MIN_PART: f32 = 1.0 / 16.0;
/// Ratio of the largest to the smallest width that count as one depth.
const DISTINCT: f64 = 1.5;
/// Maximum number of surfaces examined per ray, because foliage has very many.
const MAX_CROSSINGS: usize = 24;
/// Maximum number of occluders per ray whose width is examined.
const MAX_WIDTHS: usize = 8;
/// Half length, in texels, of the ray segment that looks for an occluder's neighbourhood: a surface
/// tilted by 76° is still hit one texel away.
const REACH_TEXELS: f32 = 4.0;

/// Scene, receivers and light of the rays.
pub(super) struct Probe<'a> {
    tracer: &'a Tracer,
    receivers: &'a Receivers,
    camera: &'a Camera,
    sampled: &'a SampledLight,
    /// Whether each instance's mesh is closed.
    is_closed: Vec<bool>,
    /// Occluder kind of each instance.
    occluders: Vec<Occluder>,
    /// Texel of the default map: metres for a sun, metres per metre of distance for other lights.
    texel: f32,
}

/// Sums over pixels.
#[derive(Debug, Default)]
pub(super) struct Tally {
    /// Number of pixels with one, two and more distinct depths.
    depths: [u64; 3],
    widths_px: Vec<f64>,
    /// Number of occluders whose width was examined, and of thin ones among them.
    looked_at: u64,
    thin: u64,
    crossings: u64,
    masked: u64,
    tinted: u64,
}

/// Surface or solid on a ray.
struct Crossing {
    /// Distance along the ray, metres.
    distance_m: f32,
    first_hit: ReceiverPoint,
}

impl<'a> Probe<'a> {
    pub(super) fn new(
        scene: &Scene,
        tracer: &'a Tracer,
        receivers: &'a Receivers,
        camera: &'a Camera,
        light: &'a Light,
        sampled: &'a SampledLight,
        judged: &[usize],
    ) -> Self {
        let meshes = || scene.instances.iter().map(|instance| &scene.meshes[instance.mesh]);
        let occluders = scene.occluders();
        let frame = light.frame();
        let seen = judged.iter().filter_map(|&i| receivers.points[i]).map(|point| point.position);
        Self {
            tracer,
            receivers,
            camera,
            sampled,
            is_closed: meshes().map(|mesh| mesh.closed).collect(),
            occluders: scene.instances.iter().map(|instance| occluders[instance.mesh]).collect(),
            texel: extent_of(light, &frame, seen) / DEFAULT_MAP_TEXELS,
        }
    }

    /// Traces a pixel's rays.
    pub(super) fn look(&self, pixel: usize, tally: &mut Tally) {
        let Some(receiver) = self.receivers.points[pixel] else { return };
        let points = self.sampled.points_for(pixel, receiver.position);
        // A list of points has its own number of samples.
        let step = points.len().div_ceil(RAYS as usize).max(1);
        let points: Vec<LightPoint> = points.into_iter().step_by(step).filter(|point| point.weight > 0.0).collect();
        let extent = extent_across(&points, receiver.position);
        let footprint_m = self.pixel_m(receiver.position);
        let mut widths_m = Vec::new();
        for point in &points {
            let vector = point.vector_from(receiver.origin());
            let length_m = if point.w == 0.0 { f32::INFINITY } else { vector.length() };
            let mut looks = 0;
            for crossing in self.crossings(receiver.origin(), vector.normalize(), length_m) {
                let d = crossing.distance_m;
                let width_m =
                    if length_m.is_finite() { extent * d / (length_m - d).max(1e-3 * length_m) } else { extent * d };
                widths_m.push(f64::from(width_m));
                let occluder = self.occluders[crossing.first_hit.instance as usize];
                tally.crossings += 1;
                tally.masked += u64::from(matches!(occluder, Occluder::Masked { .. }));
                tally.tinted += u64::from(occluder == Occluder::Translucent);
                if occluder != Occluder::Translucent && looks < MAX_WIDTHS {
                    looks += 1;
                    tally.looked_at += 1;
                    tally.thin += u64::from(self.is_thin(crossing.first_hit.position, vector.normalize(), point));
                }
            }
        }
        if widths_m.is_empty() {
            return;
        }
        tally.widths_px.push(widths_m.iter().sum::<f64>() / widths_m.len() as f64 / f64::from(footprint_m));
        let least = (points.len() as f32 * MIN_PART).ceil() as usize;
        let depths = distinct_depths(&mut widths_m, f64::from(footprint_m), least);
        tally.depths[depths.clamp(1, 3) - 1] += 1;
    }

    /// Returns all surfaces and solids on a ray up to the light, nearest first. A closed mesh that is
    /// entered and left counts once, midway.
    fn crossings(&self, origin: Vec3, direction: Vec3, length_m: f32) -> Vec<Crossing> {
        let mut crossings: Vec<Crossing> = Vec::new();
        // Whether the last crossing is a surface of a closed mesh that the ray has not left yet.
        let mut is_inside = false;
        let mut from_m = 0.0;
        for _ in 0..MAX_CROSSINGS {
            let Some(hit) = self.tracer.first_hit(origin, direction, from_m) else { break };
            let distance_m = (hit.position - origin).dot(direction);
            if distance_m >= length_m {
                break;
            }
            from_m = f64::from(distance_m) * (1.0 + 1e-5) + 1e-6;
            match crossings.last_mut().filter(|last| is_inside && last.first_hit.instance == hit.instance) {
                Some(entered) => {
                    entered.distance_m = 0.5 * (entered.distance_m + distance_m);
                    is_inside = false;
                }
                None => {
                    is_inside = self.is_closed[hit.instance as usize];
                    crossings.push(Crossing { distance_m, first_hit: hit });
                }
            }
        }
        crossings
    }

    /// Returns whether both sides at a distance of one texel are empty, in one of four directions across the ray. This is true of
    /// everything narrower than a texel, and of nothing wider than two.
    fn is_thin(&self, at: Vec3, direction: Vec3, point: &LightPoint) -> bool {
        let texel_m = if point.w == 0.0 { self.texel } else { self.texel * at.distance(point.xyz) };
        let right = direction.any_orthonormal_vector();
        let up = direction.cross(right);
        let is_hit = |offset: Vec3| {
            let reach = direction * (REACH_TEXELS * texel_m);
            self.tracer.occluded(at + offset - reach, at + offset + reach)
        };
        (0..4).any(|k| {
            let (sin, cos) = (k as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
            let offset = (right * cos + up * sin) * texel_m;
            !is_hit(offset) && !is_hit(-offset)
        })
    }

    /// Returns the width of a pixel at a visible position, metres.
    fn pixel_m(&self, at: Vec3) -> f32 {
        let forward = (self.camera.target - self.camera.eye).normalize();
        let depth_m = (at - self.camera.eye).dot(forward);
        2.0 * (0.5 * self.camera.fov_y_rad).tan() * depth_m / self.receivers.size_px.y as f32
    }
}

impl Tally {
    pub(super) fn facts(self) -> Option<PenumbraFacts> {
        let pixels: u64 = self.depths.iter().sum();
        let share = |count: u64, of: u64| if of == 0 { 0.0 } else { count as f64 / of as f64 };
        let [one, two, more] = self.depths;
        Some(PenumbraFacts {
            pixels,
            one_depth: share(one, pixels),
            two_depths: share(two, pixels),
            more_depths: share(more, pixels),
            width_px: Spread::of(self.widths_px)?,
            thin: share(self.thin, self.looked_at),
            masked: share(self.masked, self.crossings),
            tinted: share(self.tinted, self.crossings),
        })
    }
}

/// Returns the number of widths that represent all: from the smallest on, each represents those up to [`DISTINCT`] times itself plus half
/// a pixel. Groups hit by fewer than `least` rays do not count.
fn distinct_depths(widths: &mut [f64], pixel: f64, least: usize) -> usize {
    widths.sort_by(f64::total_cmp);
    let mut depths = 0;
    let mut rest = &widths[..];
    while let Some(first) = rest.first() {
        let (same, others) = rest.split_at(rest.partition_point(|width| *width <= DISTINCT * first + 0.5 * pixel));
        depths += usize::from(same.len() >= least);
        rest = others;
    }
    depths
}

/// Returns the light's extent across the direction to it, metres, or tangents for a sun: √12 standard deviations along a direction.
fn extent_across(points: &[LightPoint], from: Vec3) -> f32 {
    let vectors = || points.iter().map(|point| point.vector_from(from));
    let mean = vectors().sum::<Vec3>() / points.len().max(1) as f32;
    let along = mean.normalize_or_zero();
    let variance: f32 =
        vectors().map(|v| (v - mean).reject_from(along).length_squared()).sum::<f32>() / points.len().max(1) as f32;
    // Half of the variance is along each of two directions.
    (6.0 * variance).sqrt()
}

/// Returns the extent of visible points in a map from the light: metres for a sun, tangents for others, at most that of a cube face.
fn extent_of(light: &Light, frame: &LightFrame, seen: impl Iterator<Item = Vec3>) -> f32 {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for at in seen {
        let from_center = at - frame.center;
        let across = Vec3::new(from_center.dot(frame.right), from_center.dot(frame.up), 0.0);
        let depth = if light.is_distant() { 1.0 } else { from_center.dot(frame.axis) };
        let at = if depth > 0.0 { across / depth } else { across.signum() };
        let at = if light.is_distant() { at } else { at.clamp(Vec3::NEG_ONE, Vec3::ONE) };
        (low, high) = (low.min(at), high.max(at));
    }
    (high - low).max_element().max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_as_many_as_widths_it_takes() {
        let of = |widths: &[f64], least| distinct_depths(&mut widths.to_vec(), 0.1, least);
        assert_eq!(of(&[1.0, 1.4, 1.54], 1), 1, "half as wide again, and half a pixel");
        assert_eq!(of(&[1.0, 1.6], 1), 2);
        assert_eq!(of(&[8.0, 1.0, 3.0], 1), 3);
        assert_eq!(of(&[1.0, 1.0, 8.0], 2), 1, "one ray of three is too little");
        assert_eq!(of(&[], 1), 0);
    }
}
