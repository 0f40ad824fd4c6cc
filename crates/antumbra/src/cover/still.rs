//! Stable placement of a sun's maps while the camera moves.
//!
//! A map that is fitted to what the camera sees lies elsewhere in every frame of a walk, and its texels with it: edges crawl
//! over what stands still, filters change their minds, and all is drawn again. So what a slice receives is held by a box
//! along the sun's axes, somewhat larger than it, and the box stays as long as it holds it and is not far too large. Its side
//! is one of few: a new box mostly has the old one's texels, and is laid in whole ones of them by
//! [`in_whole_texels`](crate::light_map::still_view::in_whole_texels) (Valient, "Stable rendering of cascaded shadow maps",
//! ShaderX6, 2008, who fits spheres instead: those never change their size, and are up to twice as wide).

use antumbra_light::Light;
use glam::{DVec3, Vec3};

use super::slices::SliceEnds;

/// A box is larger than what it holds by this part of its longer side at least, on each side.
const SLACK: f64 = 1.0 / 128.0;

/// Sides of boxes in an octave.
const SIDES_IN_OCTAVE: f64 = 32.0;

/// A box is too large where one of as many sides less would do.
const TOO_LARGE: f64 = 5.0;

/// Of one light, from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Still {
    /// The sun's axes, which the boxes lie along.
    axes: [Vec3; 3],
    boxes: Vec<StillBox>,
    pub(super) ends: Option<SliceEnds>,
}

/// A box about what a part receives, its coordinates along the axes and from the world's origin, wherever frames are counted
/// from.
#[derive(Clone, Copy, Debug)]
struct StillBox {
    part: u32,
    min: DVec3,
    max: DVec3,
    /// The longer side across the axis.
    side_m: f64,
}

impl Still {
    /// Begins a frame: boxes along other axes are forgotten.
    pub(super) fn begin(&mut self, sun: &Light) {
        let frame = sun.frame();
        let axes = [frame.right, frame.up, frame.axis];
        if self.axes != axes {
            (self.axes, self.boxes) = (axes, Vec::new());
        }
    }

    /// Ends it: boxes of parts that it had not are forgotten.
    pub(super) fn keep(&mut self, is_part: impl Fn(u32) -> bool) {
        self.boxes.retain(|held| is_part(held.part));
    }

    /// The corners of a box that holds some points of a part, all counted from an anchor: the frame's before, where that
    /// does.
    pub(super) fn hold(&mut self, part: u32, points: &[Vec3], anchor: Vec3) -> [Vec3; 8] {
        let axes = self.axes.map(Vec3::as_dvec3);
        let along = |x: &Vec3| DVec3::from_array(axes.map(|axis| axis.dot(x.as_dvec3() + anchor.as_dvec3())));
        let (min, max) = points
            .iter()
            .map(along)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        let held = self.boxes.iter().copied().find(|held| held.part == part && held.does_for(min, max));
        let held = held.unwrap_or_else(|| {
            let new = StillBox::about(part, min, max);
            self.boxes.retain(|held| held.part != part);
            self.boxes.push(new);
            new
        });
        std::array::from_fn(|i| {
            let side = |k: usize| if i >> k & 1 == 0 { held.min[k] } else { held.max[k] };
            let corner: DVec3 = (0..3).map(|k| side(k) * axes[k]).sum();
            (corner - anchor.as_dvec3()).as_vec3()
        })
    }
}

impl StillBox {
    fn about(part: u32, min: DVec3, max: DVec3) -> Self {
        let needed = longer_side(min, max);
        let side_m = side_for(needed);
        let more = 0.5 * (side_m - needed);
        Self { part, min: min - more, max: max + more, side_m }
    }

    fn does_for(&self, min: DVec3, max: DVec3) -> bool {
        let holds = self.min.cmple(min).all() && self.max.cmpge(max).all();
        holds && self.side_m <= side_for(longer_side(min, max)) * (TOO_LARGE / SIDES_IN_OCTAVE).exp2() * (1.0 + 1e-9)
    }
}

fn longer_side(min: DVec3, max: DVec3) -> f64 {
    (max - min).truncate().max_element()
}

/// The least side of those that there are that leaves slack about so much.
fn side_for(needed_m: f64) -> f64 {
    let least = (needed_m * (1.0 + 2.0 * SLACK)).max(1e-6);
    ((least.log2() * SIDES_IN_OCTAVE).ceil() / SIDES_IN_OCTAVE).exp2()
}
