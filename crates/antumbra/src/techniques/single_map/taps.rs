//! Taps over a light's shape, the input of `light_taps.wesl`: positions in the light's own coordinates, whatever its pose.

use antumbra_light::{Light, LightShape, SampleSet, ball_from_cube, disk_from_square};
use glam::{Vec2, Vec3, Vec4};

use super::KernelPoints;
use crate::gpu::TableKey;
use crate::receivers::inputs::kind_of;

/// 2 / (1 + √5).
const INVERSE_GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;

/// Taps of a light, from a sample set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taps<'a> {
    pub(crate) light: &'a Light,
    pub(crate) set: SampleSet,
    pub(crate) seed: u32,
    /// Index of the run of consecutive points within the set: 0 unless frames use different random numbers.
    pub(crate) run: u32,
}

/// Use of a list of taps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TapUse {
    /// Positions in the light's shape, with scales.
    Search,
    /// Positions in the light's shape.
    Filter,
    /// Positions in the unit square.
    Square,
}

/// Consecutive lists of taps, each with its use and its number of taps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TapLists<'a, const COUNT: usize>(pub(crate) [(Taps<'a>, TapUse, u32); COUNT]);

impl<const COUNT: usize> TapLists<'_, COUNT> {
    /// Calls `prepare` with the kernel of these taps.
    pub(crate) fn with_kernel<R>(&self, prepare: impl FnOnce(KernelPoints<'_>) -> R) -> R {
        prepare(KernelPoints { key: self.key(), bytes: &|| bytemuck::pod_collect_to_vec(&self.taps()) })
    }

    fn taps(&self) -> Vec<Vec4> {
        let list = |(taps, used_as, count): &(Taps<'_>, TapUse, u32)| match used_as {
            TapUse::Search => taps.of_search(*count),
            TapUse::Filter => taps.of_filter(*count),
            TapUse::Square => taps.of_square(*count),
        };
        self.0.iter().flat_map(list).collect()
    }

    /// Key of the shared table of these taps; `None` if they depend on the light's own points, or change from frame to frame.
    fn key(&self) -> Option<TableKey> {
        let mut numbers = Vec::with_capacity(10);
        for (Taps { light, set, seed, run }, used_as, count) in &self.0 {
            if *run != 0 || matches!(light.shape, LightShape::Points { .. }) {
                return None;
            }
            numbers.extend([kind_of(&light.shape), *set as u32, *seed, *used_as as u32, *count]);
        }
        Some(TableKey { of: "antumbra taps", numbers })
    }
}

impl Taps<'_> {
    /// Search taps: positions, and in w each tap's share of the range of scales, in [0, 1). Multiples of the golden ratio spread
    /// the scales evenly over any run of taps.
    pub(crate) fn of_search(&self, count: u32) -> Vec<Vec4> {
        let scale = |i: u64| (i as f64 * INVERSE_GOLDEN_RATIO).fract() as f32;
        let first = u64::from(self.run) * u64::from(count);
        self.places(count).into_iter().zip(first..).map(|(place, i)| place.extend(scale(i))).collect()
    }

    /// Filter taps: positions; w is 0.
    pub(crate) fn of_filter(&self, count: u32) -> Vec<Vec4> {
        self.places(count).into_iter().map(|place| place.extend(0.0)).collect()
    }

    /// Points of the unit square, for filters that do not have the light's shape.
    pub(crate) fn of_square(&self, count: u32) -> Vec<Vec4> {
        self.set.run(self.run, count, self.seed).into_iter().map(|u| (u.truncate(), Vec2::ZERO).into()).collect()
    }

    /// Whether every prefix of the taps covers the light: true for sets that grow point by point, false for a list of points,
    /// which is used in its own order.
    pub(crate) fn are_progressive(&self) -> bool {
        matches!(self.set, SampleSet::R2 | SampleSet::Sobol | SampleSet::PoissonDisc)
            && !matches!(self.light.shape, LightShape::Points { .. })
    }

    /// Positions of the taps. For a rectangle: in the unit square, to be shifted on the torus. For a list of points: one of them
    /// along right, up and axis, relative to the light's centre. Otherwise: in the unit disc or ball, to be rotated about its axis.
    fn places(&self, count: u32) -> Vec<Vec3> {
        let points = self.set.run(self.run, count, self.seed).into_iter().map(|u| u.truncate()).zip(0..);
        // Each tap takes one stratum, or one point of a list, in order, so that all of them get the same number of taps.
        let stratum = |i: u32| (i as f32 + 0.5) / count as f32;
        match &self.light.shape {
            LightShape::Rectangle { .. } => points.map(|(u, _)| u.extend(0.0)).collect(),
            LightShape::Disk { .. } | LightShape::Sphere { .. } | LightShape::Sun { .. } => {
                points.map(|(u, _)| disk_from_square(u).extend(0.0)).collect()
            }
            LightShape::Ellipsoid { .. } => points.map(|(u, i)| ball_from_cube(u.extend(stratum(i)))).collect(),
            LightShape::Points { positions_m } => {
                let frame = self.light.frame();
                let last = positions_m.len().saturating_sub(1);
                let of_list = |i| positions_m[((stratum(i) * positions_m.len() as f32) as usize).min(last)];
                let in_frame = |p: Vec3| Vec3::new(p.dot(frame.right), p.dot(frame.up), p.dot(frame.axis));
                (0..count).map(|i| in_frame(of_list(i) - frame.center)).collect()
            }
        }
    }
}

/// Override constants of passes over taps: those of `light_taps.wesl`, and `LAYER_COUNT` of
/// `light_map/depth_layers/behind.wesl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TapsProgram {
    /// Kind of the light, as in `receivers/light.wesl`.
    light_kind: u32,
    /// Number of layers of casters, including the light map's own.
    layers: u32,
    /// Whether the light is a rectangle with an emission texture.
    has_emission: bool,
    /// Whether every prefix of the taps covers the light.
    is_progressive: bool,
}

impl TapsProgram {
    /// Constants of the usual light, a rectangle without emission texture.
    pub(crate) fn usual(layers: u32) -> Self {
        Self { light_kind: 0, layers, has_emission: false, is_progressive: true }
    }

    pub(crate) fn of(taps: &Taps<'_>, layers: u32) -> Self {
        let Light { shape, emission, .. } = taps.light;
        Self {
            light_kind: kind_of(shape),
            layers,
            has_emission: matches!(shape, LightShape::Rectangle { .. }) && emission.is_some(),
            is_progressive: taps.are_progressive(),
        }
    }

    /// Values of the constants, by name.
    pub(crate) fn constants(self) -> [(&'static str, f64); 4] {
        [
            ("LIGHT_KIND", f64::from(self.light_kind)),
            ("LAYER_COUNT", f64::from(self.layers)),
            ("HAS_EMISSION", f64::from(u8::from(self.has_emission))),
            ("IS_PROGRESSIVE", f64::from(u8::from(self.is_progressive))),
        ]
    }
}
