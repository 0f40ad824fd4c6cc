//! Boxes that keep a cascade's maps in place while the camera moves.
//!
//! A map fitted to what the camera sees moves in every frame of a walk, and its texels with it: edges and filtered shadows of
//! static objects flicker, and the map must be redrawn. So a cascade's receivers are enclosed in a slightly larger box along
//! the sun's axes, which is kept while it contains them and is not far too large. Its side is quantised, so that a new box
//! mostly has texels of the old size, and the map's texels are aligned with the old ones by
//! [`in_whole_texels`](crate::light_map::stable_fit::in_whole_texels) (Valient, "Stable rendering of cascaded shadow maps",
//! ShaderX6, 2008, fits spheres instead, which never change their size and are up to twice as wide).

use antumbra_light::Light;
use glam::{DVec3, Vec3};

use super::cascades::CascadeEnds;

/// Smallest margin of a box on each side, as a fraction of the longer side of what it contains.
const SLACK: f64 = 1.0 / 128.0;

/// Number of box sides per octave.
const SIDES_IN_OCTAVE: f64 = 32.0;

/// Largest number of steps by which a box's side may exceed the smallest that suffices.
const TOO_LARGE: f64 = 5.0;

/// Stable boxes of one light, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct StableBoxes {
    /// The sun's axes, which the boxes lie along.
    axes: [Vec3; 3],
    boxes: Vec<StableBox>,
    pub(super) ends: Option<CascadeEnds>,
}

/// Box around a part's receivers, with coordinates along the axes from the world's origin, independent of the frame's
/// anchor.
#[derive(Clone, Copy, Debug)]
struct StableBox {
    part: u32,
    min: DVec3,
    max: DVec3,
    /// Longer side across the axis, metres.
    side_m: f64,
}

impl StableBoxes {
    /// Begins a frame: discards boxes along other axes.
    pub(super) fn begin(&mut self, sun: &Light) {
        let frame = sun.frame();
        let axes = [frame.right, frame.up, frame.axis];
        if self.axes != axes {
            (self.axes, self.boxes) = (axes, Vec::new());
        }
    }

    /// Ends a frame: discards boxes of parts that it did not have.
    pub(super) fn keep(&mut self, is_part: impl Fn(u32) -> bool) {
        self.boxes.retain(|held| is_part(held.part));
    }

    /// Returns the corners of a box that contains a part's points, all relative to `anchor`: the previous frame's box if it
    /// suits.
    pub(super) fn hold(&mut self, part: u32, points: &[Vec3], anchor: Vec3) -> [Vec3; 8] {
        let axes = self.axes.map(Vec3::as_dvec3);
        let along = |x: &Vec3| DVec3::from_array(axes.map(|axis| axis.dot(x.as_dvec3() + anchor.as_dvec3())));
        let (min, max) = points
            .iter()
            .map(along)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        let held = self.boxes.iter().copied().find(|held| held.part == part && held.does_for(min, max));
        let held = held.unwrap_or_else(|| {
            let new = StableBox::about(part, min, max);
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

impl StableBox {
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

/// Returns the smallest quantised side that leaves slack around `needed_m`.
fn side_for(needed_m: f64) -> f64 {
    let least = (needed_m * (1.0 + 2.0 * SLACK)).max(1e-6);
    ((least.log2() * SIDES_IN_OCTAVE).ceil() / SIDES_IN_OCTAVE).exp2()
}
