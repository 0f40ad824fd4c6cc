//! Automatic number of texels of a map, chosen for each frame.
//!
//! No shadow edge is sharper than a texel, and none need be sharper than a pixel. So texels are half as wide as a pixel where
//! receivers are seen: a map has many texels for a large image, a near camera, or a distant light. Wide penumbrae would allow
//! fewer texels, but do not count, since under any light the penumbra is narrow at contacts.
//!
//! The receivers are [`PreparedReceivers::seen_points`](crate::contract::PreparedReceivers::seen_points). The ratio of texel to pixel
//! width is their unweighted geometric mean, so that a few receivers near the camera, for which hardly any map would suffice, do not
//! dominate. Points of the receivers' hull, used if the host passes no seen points, are unweighted too: most surfaces are at its far side.
//! Sizes are steps of √2 with hysteresis: a size is kept until the wanted one is a quarter of a step past the midpoint to the next, or a
//! whole step if the host passes no seen points. So a camera that moves to and fro allocates no textures. The largest size is what the
//! light's budget allows ([`Stage::auto_map_bytes`]), the smallest is [`USUAL_TEXELS`].

use antumbra_light::Aabb;
use glam::{Vec2, Vec3};

use super::light_view::{LightView, Window};
use crate::contract::{Camera, MapSize, PreparedFrame, PreparedReceivers, SeenPoint};
use crate::gpu::Stage;

/// Number of sizes per octave.
const STEPS_IN_OCTAVE: f32 = 2.0;

/// Hysteresis, in steps: the size changes once the wanted one is farther away than half a step plus this.
const STAYS_FOR: f32 = 0.25;

/// [`STAYS_FOR`] if points of the receivers' hull represent what is seen.
const STAYS_UNSEEN_FOR: f32 = 1.0;

/// Largest size, whatever the budget: drawing a larger map would take longer than everything else.
const MAX_TEXELS: u32 = 4096;

/// Size if no camera sees the receivers, and the smallest size, whatever the budget: fewer texels are worse ([`PIXELS`]).
const USUAL_TEXELS: u32 = 1024;

/// Divisor of all sizes, texels: the side of a workgroup.
const MULTIPLE: u32 = 8;

/// Target width of a texel, in pixels. At 1280 × 720, a width of 1 gives `flight-helmet.glb` and `lantern.glb` 728 texels, ½ gives 1448.
/// There `smrt` has rmse .0241, .0175, .0150, .0133 and .0145, .0095, .0081, .0069 with 512, 1024, 1448 and 2048 texels.
const PIXELS: f32 = 0.5;

/// Returns the texels along a side of a map of `casters`. `bytes_of` gives the bytes of a size, with all that belongs to the map.
pub(crate) fn map_texels(
    stage: &Stage<'_>,
    frame: &PreparedFrame<'_>,
    size: MapSize,
    bytes_of: impl Fn(u32) -> u64,
    view: &LightView,
    casters: &[Aabb],
) -> u32 {
    if let MapSize::Texels(texels) = size {
        return texels;
    }
    let most = max_texels(stage.auto_map_bytes(), bytes_of, stage.device.limits().max_texture_dimension_2d);
    // A budget shared by many lights or parts leaves no choice.
    if most <= USUAL_TEXELS {
        stage.note_auto_texels(most);
        return most;
    }
    let of_casters = casters.iter().copied().fold(Aabb::EMPTY, Aabb::union);
    let receivers = PreparedReceivers { bounds: frame.receivers.bounds.or(Some(of_casters)), ..frame.receivers };
    let wanted = receivers.camera().and_then(|camera| {
        let seen = receivers.seen_points(&without_repeats(receivers.corners()));
        wanted_texels(camera, receivers.size_px.y, &seen, view)
    });
    let stays_for = if receivers.seen.is_empty() { STAYS_UNSEEN_FOR } else { STAYS_FOR };
    let texels = step_of(wanted.unwrap_or(USUAL_TEXELS as f32), stage.auto_texels(), stays_for);
    let texels = texels.clamp(USUAL_TEXELS, most);
    stage.note_auto_texels(texels);
    texels
}

/// Removes repeated corners. In a camera's frustum the eye is a corner of every pair of planes, and points taken between corners would
/// crowd near it.
fn without_repeats(mut corners: Vec<Vec3>) -> Vec<Vec3> {
    /// Distance of equal corners, as a fraction of the bounding box's diagonal.
    const NEAR: f32 = 1e-4;
    corners.retain(|corner| corner.is_finite());
    let near_m = NEAR * Aabb::of(corners.iter().copied()).diagonal();
    corners.into_iter().fold(Vec::new(), |mut once, corner| {
        if once.iter().all(|other: &Vec3| other.distance(corner) > near_m) {
            once.push(corner);
        }
        once
    })
}

/// Returns the largest size that fits `bytes`, at least [`USUAL_TEXELS`], and at most the device's `limit`.
fn max_texels(bytes: u64, bytes_of: impl Fn(u32) -> u64, limit: u32) -> u32 {
    let steps = (0..=(MAX_TEXELS as f32).log2() as u32 * STEPS_IN_OCTAVE as u32).rev();
    let affordable = steps.map(|step| texels_of(step as f32)).find(|texels| bytes_of(*texels) <= bytes);
    affordable.unwrap_or(0).max(USUAL_TEXELS).min(limit)
}

/// Returns the size nearest to `wanted`, or the previous one if that is nearly as near.
fn step_of(wanted: f32, before: Option<u32>, stays_for: f32) -> u32 {
    let step = wanted.max(1.0).log2() * STEPS_IN_OCTAVE;
    let nearest = texels_of(step.round());
    let is_near = |texels: &u32| ((*texels as f32).log2() * STEPS_IN_OCTAVE - step).abs() <= 0.5 + stays_for;
    before.filter(is_near).unwrap_or(nearest)
}

fn texels_of(step: f32) -> u32 {
    let texels = (step.clamp(0.0, 31.0) / STEPS_IN_OCTAVE).exp2();
    ((texels / MULTIPLE as f32).round() as u32).max(1) * MULTIPLE
}

/// Returns the texels along a side for which texels on the receivers are [`PIXELS`] wide, in an image of `height_px` rows; `None` if
/// nothing is seen.
fn wanted_texels(camera: &Camera, height_px: u32, seen: &[SeenPoint], view: &LightView) -> Option<f32> {
    let ratios = seen
        .iter()
        .map(|point| map_m(view, point.pos_in_world) / (PIXELS * pixel_m(camera, height_px, point.pos_in_world)));
    let logs: Vec<f32> = ratios.filter(|ratio| *ratio > 0.0 && ratio.is_finite()).map(f32::ln).collect();
    (!logs.is_empty()).then(|| (logs.iter().sum::<f32>() / logs.len() as f32).exp())
}

/// Width of a pixel at `x`, metres across the view.
fn pixel_m(camera: &Camera, height_px: u32, x: Vec3) -> f32 {
    let w = (camera.clip_from_view * camera.view_from_world).row(3).dot(x.extend(1.0));
    2.0 * w / (camera.clip_from_view.y_axis.y.abs() * height_px as f32)
}

/// Width of a map of one texel at `x`, metres across the light: its wider side, which blurs more.
fn map_m(view: &LightView, x: Vec3) -> f32 {
    let p = x - view.frame.center;
    let z = if view.perspective { p.dot(view.frame.axis).max(view.near_m) } else { 1.0 };
    let in_plane = Vec2::new(p.dot(view.frame.right), p.dot(view.frame.up)) / z;
    let Window { center, half_size, warp, .. } = view.window;
    // A step along the warp is longer by w² in the plane, one across it by w.
    let w = (1.0 + warp.dot(in_plane - center)).max(1e-3);
    2.0 * z * w * (half_size.x * w).max(half_size.y)
}

#[cfg(test)]
mod tests {
    use antumbra_light::{Light, LightShape};
    use glam::camera::rh::{proj, view};

    use super::*;
    use crate::contract::DepthConvention;
    use crate::light_map::central_view::fit_light_view;

    const GROUND: Aabb = Aabb { min: Vec3::new(-4.0, 0.0, -4.0), max: Vec3::new(4.0, 0.01, 4.0) };

    fn lamp_above() -> LightView {
        let light = Light::new(LightShape::Sphere { radius_m: 0.1 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
        fit_light_view(&light, &[GROUND], &GROUND.corners())
    }

    /// Camera that looks straight down from `height_m`.
    fn camera(height_m: f32) -> Camera {
        Camera {
            view_from_world: view::look_at_mat4(Vec3::new(0.0, height_m, 0.0), Vec3::ZERO, Vec3::Z),
            clip_from_view: proj::directx::perspective_infinite_reverse(0.9, 1.0, 0.1),
            depth_convention: DepthConvention::Reversed,
        }
    }

    fn ground() -> Vec<SeenPoint> {
        let at =
            |i: i32| SeenPoint { pos_in_world: Vec3::new((i % 9 - 4) as f32, 0.0, (i / 9 - 4) as f32), weight: 1.0 };
        (0..81).map(at).collect()
    }

    /// The chosen size gives 1 / [`PIXELS`] texels per pixel, by the projections of map and camera.
    #[test]
    fn texels_are_as_wide_as_parts_of_pixels() {
        let map = lamp_above();
        for (height_m, rows) in [(6.0, 360), (6.0, 720), (12.0, 720), (3.0, 1080)] {
            let camera = camera(height_m);
            let texels = wanted_texels(&camera, rows, &ground(), &map).expect("the ground is seen");
            let (here, beside) = (Vec3::ZERO, Vec3::new(0.01, 0.0, 0.0));
            let moved = |clip_from_world: glam::Mat4, across: f32| {
                let [a, b] = [here, beside].map(|x| clip_from_world.project_point3(x).truncate());
                0.5 * across * (a - b).length()
            };
            let in_pixels = moved(camera.clip_from_view * camera.view_from_world, rows as f32);
            let in_texels = moved(map.clip_from_world(), texels);
            let texels_a_pixel = in_texels / in_pixels;
            assert!((texels_a_pixel * PIXELS - 1.0).abs() < 0.02, "{height_m} m, {rows} rows: {texels_a_pixel}");
        }
    }

    /// A single receiver close to the camera must not enlarge the map, since that would improve nothing else.
    #[test]
    fn what_is_near_the_camera_weighs_no_more() {
        let mut seen = ground();
        let usual = wanted_texels(&camera(6.0), 720, &seen, &lamp_above()).expect("seen");
        seen.push(SeenPoint { pos_in_world: Vec3::new(0.0, 4.9, 0.0), weight: 1.0 });
        let with_one = wanted_texels(&camera(5.0), 720, &seen, &lamp_above()).expect("seen");
        assert!(with_one < 1.4 * usual, "{usual} and {with_one}");
        assert_eq!(wanted_texels(&camera(6.0), 720, &[], &lamp_above()), None);
    }

    /// A camera that moves to and fro over the border between two sizes keeps one of them.
    #[test]
    fn sizes_are_kept_over_their_borders() {
        let border = 1024.0 * 2f32.powf(0.25);
        let mut held = Some(1024);
        for i in 0..100 {
            held = Some(step_of(border * (1.0 + 0.05 * (i as f32).sin()), held, STAYS_FOR));
            assert_eq!(held, Some(1024));
        }
        assert_eq!(step_of(border * 1.15, held, STAYS_FOR), 1448);
        assert_eq!(step_of(border * 1.15, held, STAYS_UNSEEN_FOR), 1024);
        assert_eq!(step_of(border * 0.98, Some(1448), STAYS_FOR), 1448);
        assert_eq!(step_of(0.0, None, STAYS_FOR), MULTIPLE);
    }

    /// Maps stay within the light's budget, but [`USUAL_TEXELS`] are always allowed.
    #[test]
    fn sizes_keep_within_what_may_be_spent() {
        let of = |per_texel: u64| move |texels: u32| per_texel * u64::from(texels).pow(2);
        for (bytes, per_texel, texels) in
            [(64 << 20, 15, 2048), (63 << 20, 16, 1448), (64 << 20, 50, 1024), (0, 50, 1024)]
        {
            assert_eq!(max_texels(bytes, of(per_texel), 8192), texels);
        }
        assert_eq!(max_texels(u64::MAX, of(1), 8192), MAX_TEXELS);
        assert_eq!(max_texels(u64::MAX, of(1), 2048), 2048);
        assert_eq!(texels_of(22.0), 2048);
    }
}
