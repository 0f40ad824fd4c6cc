//! Shaft of a receiver's rays, which tells the boxes that the rays may meet.
//!
//! All rays start at `o` and their vectors `d` lie in a box of vectors, `d⁻ ≤ d ≤ d⁺`. A point `o + t·d` of a box
//! `[low, high]` exists for some such `d` and `0 ≤ t ≤ t_max` exactly where, on every axis,
//!
//! ```text
//! t·d⁻ ≤ high − o     and     t·d⁺ ≥ low − o
//! ```
//!
//! for one `t`. These are six bounds on `t`, from below or from above by the sign of `d⁻` or `d⁺`. The test therefore
//! costs no more than that of a single ray, and is exact for the box of vectors. (Interval ray packets: Boulos, Wald
//! and Shirley, "Geometric and Arithmetic Culling Methods for Entire Ray Packets", Utah UUCS-06-010, 2006; the shaft
//! of Haines and Wallace, "Shaft Culling for Efficient Ray-Cast Radiosity", 1991.)
//!
//! The test must not miss a box with a triangle that the planes of `planes.rs` report as hit. Their rounding moves
//! a silhouette by an angle of a few 2⁻²⁴; the box of vectors is widened by [`ANGLE_SLACK`], the bounds on `t` by
//! [`TIME_SLACK`].

use crate::lanes::Lanes;
use crate::planes::LANES;
use crate::tree::Node;

/// Widening of the box of vectors: eight times the 4·2⁻²⁴ by which rounding can turn a plane.
pub(crate) const ANGLE_SLACK: f32 = 1.0 / (1 << 19) as f32;
/// Widening of the bounds on `t`: more than five times the errors of 2⁻²⁴ of a subtraction, a reciprocal and a product.
const TIME_SLACK: f32 = 1.0 / (1 << 20) as f32;
/// Substitute for 1/0: finite, which avoids 0 · ∞, and larger than any relevant `t`.
const LARGEST_INVERSE: f32 = 1e30;

/// Bounds on `t` from one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Heading {
    /// All vectors point up the axis: rays enter at `low` and leave at `high`.
    Up,
    /// All vectors point down the axis.
    Down,
    /// Some vectors point up and some down: there are only entries.
    Both,
}

/// Shaft of one receiver's rays, or a single ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shaft {
    origin: [f32; 3],
    heading: [Heading; 3],
    /// 1/d⁻ and 1/d⁺ per axis, scaled by the slack of their bound.
    inverse_low: [f32; 3],
    inverse_high: [f32; 3],
    end: f32,
}

impl Shaft {
    /// Shaft of all vectors within `half` of `middle`, per axis, from `t = 0` to `t_max`.
    #[inline(always)]
    pub(crate) fn new(origin: [f32; 3], middle: [f32; 3], half: [f32; 3], t_max: f32) -> Self {
        let largest = |i: usize| middle[i].abs() + half[i];
        let longest = largest(0).max(largest(1)).max(largest(2));
        let slack = longest * ANGLE_SLACK;
        let mut shaft = Self {
            origin,
            heading: [Heading::Both; 3],
            inverse_low: [0.0; 3],
            inverse_high: [0.0; 3],
            end: t_max * (1.0 + TIME_SLACK),
        };
        let inverse = |v: f32| (1.0 / v).clamp(-LARGEST_INVERSE, LARGEST_INVERSE);
        let (entry, exit) = (1.0 - TIME_SLACK, 1.0 + TIME_SLACK);
        for i in 0..3 {
            let low = middle[i] - half[i] - slack;
            let high = middle[i] + half[i] + slack;
            let (heading, low_slack, high_slack) = match (low > 0.0, high < 0.0) {
                (true, _) => (Heading::Up, exit, entry),
                (_, true) => (Heading::Down, entry, exit),
                _ => (Heading::Both, entry, entry),
            };
            shaft.heading[i] = heading;
            // A bound of exactly zero never applies: −0 sends a box's far side to −∞, which is right for an entry.
            let low = if heading == Heading::Both { low.min(-f32::MIN_POSITIVE) } else { low };
            let high = if heading == Heading::Both { high.max(f32::MIN_POSITIVE) } else { high };
            shaft.inverse_low[i] = inverse(low) * low_slack;
            shaft.inverse_high[i] = inverse(high) * high_slack;
        }
        shaft
    }

    /// Shaft of a single vector.
    #[inline(always)]
    pub(crate) fn single(origin: [f32; 3], vector: [f32; 3], t_max: f32) -> Self {
        Self::new(origin, vector, [0.0; 3], t_max)
    }

    /// Shortens the shaft to `t_max`.
    pub(crate) fn shorten(&mut self, t_max: f32) {
        self.end = self.end.min(t_max * (1.0 + TIME_SLACK));
    }

    /// Largest `t`, with slack.
    pub(crate) fn end(&self) -> f32 {
        self.end
    }

    /// Bit mask of the children that the shaft can meet, and the smallest `t` of each.
    #[inline(always)]
    pub(crate) fn meets<L: Lanes>(&self, node: &Node) -> (u32, [f32; LANES]) {
        let mut near = L::splat(0.0);
        let mut far = L::splat(self.end);
        for axis in 0..3 {
            let origin = L::splat(self.origin[axis]);
            let by_high = L::load(&node.high[axis]).sub(origin).mul(L::splat(self.inverse_low[axis]));
            let by_low = L::load(&node.low[axis]).sub(origin).mul(L::splat(self.inverse_high[axis]));
            match self.heading[axis] {
                Heading::Up => (near, far) = (near.max(by_low), far.min(by_high)),
                Heading::Down => (near, far) = (near.max(by_high), far.min(by_low)),
                Heading::Both => near = near.max(by_low).max(by_high),
            }
        }
        // The sign bit of far − near is set if the bounds contradict each other.
        (!far.sub(near).signs() & node.present, near.to_array())
    }
}
