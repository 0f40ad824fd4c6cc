//! Light points as the shaders test them: in the light's frame, in groups of 32 that are near each other.

use antumbra_light::{Aabb, Light, LightFrame, LightShape};
use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::gpu::shared_constants;

/// Number of light points per word of bits.
pub(crate) const WORD: usize = 32;
/// Largest number of words that a pass holds for each receiver.
pub(crate) const MAX_WORDS: usize = 32;

/// Largest number of light points that are tested one by one for a triangle.
pub(crate) const MAX_SINGLED_OUT: u32 = 20;

shared_constants! {
    /// Number of vectors before the points in [`packed_words`].
    const FIRST_POINT: u32 = 2 + 2 * MAX_WORDS as u32, as in EVALUATION_EVALUATE;
    /// Number of vectors of [`packed_words`], independent of the number of points.
    const LIGHT_WORDS_LENGTH: u32 = FIRST_POINT + (MAX_WORDS * WORD) as u32, as in EVALUATION_EVALUATE;
}

/// Point in the light's frame about its centre: right, up, axis, metres (tangents for a sun), and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LocalPoint {
    pub(crate) at: Vec3,
    pub(crate) weight: f32,
    /// Linear RGB emission, of which `weight` is the luminance.
    pub(crate) emission: Vec3,
    /// Index in the sample set, or in the light's own list.
    pub(crate) index: u32,
}

impl LocalPoint {
    /// Returns a point of a light of uniform emission, with index 0.
    pub(crate) fn white(at: Vec3) -> Self {
        Self { at, weight: 1.0, emission: Vec3::ONE, index: 0 }
    }
}

/// Returns the light's points for points of the unit cube, sorted so that each 32 of them are close together. A light
/// that is a list of points has its own.
pub(crate) fn local_points(light: &Light, unit_points: &[Vec3]) -> Vec<LocalPoint> {
    let mut points: Vec<LocalPoint> = if let LightShape::Points { positions_m } = &light.shape {
        let frame = light.frame();
        let axes = [frame.right, frame.up, frame.axis].map(Vec3::as_dvec3);
        let local = |p: &Vec3| {
            let offset = p.as_dvec3() - frame.center.as_dvec3();
            DVec3::from_array(axes.map(|axis| offset.dot(axis))).as_vec3()
        };
        (0..).zip(positions_m).map(|(index, p)| LocalPoint { index, ..LocalPoint::white(local(p)) }).collect()
    } else {
        // With the identity as frame, a light point is its own coordinates. A sphere's disc faces the receiver: seen
        // from +z its right is −x.
        let identity = LightFrame { center: Vec3::ZERO, right: Vec3::X, up: Vec3::Y, axis: Vec3::Z };
        let flip = if matches!(light.shape, LightShape::Sphere { .. }) { -1.0 } else { 1.0 };
        let has_volume = matches!(light.shape, LightShape::Ellipsoid { .. });
        let picture = light.emission.as_ref().filter(|_| matches!(light.shape, LightShape::Rectangle { .. }));
        (0..)
            .zip(unit_points)
            .map(|(index, u)| {
                let point = light.point(&identity, *u, Vec3::Z);
                let z = if has_volume { point.xyz.z } else { 0.0 };
                let at = Vec3::new(flip * point.xyz.x, point.xyz.y, z);
                let emission = picture.map_or(Vec3::ONE, |picture| picture.color_at(u.truncate()));
                LocalPoint { at, weight: point.weight, emission, index }
            })
            .collect()
    };
    sort_into_words(&mut points);
    points
}

/// Halves the set recursively across its longer side, at multiples of 32.
fn sort_into_words(points: &mut [LocalPoint]) {
    if points.len() <= WORD {
        return;
    }
    let extent = box_of(points).1;
    let axis = if extent.x >= extent.y && extent.x >= extent.z { 0 } else { 1 + usize::from(extent.z > extent.y) };
    let first = points.len().div_ceil(WORD).div_ceil(2) * WORD;
    points.select_nth_unstable_by(first.min(points.len() - 1), |a, b| a.at[axis].total_cmp(&b.at[axis]));
    let (left, right) = points.split_at_mut(first);
    sort_into_words(left);
    sort_into_words(right);
}

/// Returns the centre and half size of the box of some points.
pub(crate) fn box_of(points: &[LocalPoint]) -> (Vec3, Vec3) {
    let b = Aabb::of(points.iter().map(|p| p.at));
    (0.5 * (b.min + b.max), 0.5 * (b.max - b.min))
}

/// Returns the number of cells along a side of a grid over the points: about one cell per point.
pub(crate) fn cells_across(points: &[LocalPoint]) -> u32 {
    (points.len() as f32).sqrt().ceil().clamp(1.0, 32.0) as u32
}

/// Returns the largest number of cells that cannot contain more than [`MAX_SINGLED_OUT`] points in total; 0 if one word
/// holds all points, which takes one iteration.
pub(crate) fn max_cells(points: &[LocalPoint]) -> u32 {
    if points.len() <= WORD {
        return 0;
    }
    let (starts, _) = by_cells(points);
    let fullest = starts.windows(2).map(|cell| cell[1] - cell[0]).max().unwrap_or(0).max(1);
    MAX_SINGLED_OUT / fullest
}

/// Returns the number of cells per metre along each side, as in `evaluation/`.
fn cells_per_m(points: &[LocalPoint]) -> Vec2 {
    let half = box_of(points).1.truncate();
    cells_across(points) as f32 / (2.0 * half).max(Vec2::splat(1e-20))
}

/// Returns the index in the order of each cell's first point, row after row, followed by the number of points; and the
/// points' indices in that order.
fn by_cells(points: &[LocalPoint]) -> (Vec<u32>, Vec<usize>) {
    let across = cells_across(points);
    let (middle, half) = box_of(points);
    let (low, scale) = (middle.truncate() - half.truncate(), cells_per_m(points));
    let cell = |p: &LocalPoint| {
        let at = ((p.at.truncate() - low) * scale).clamp(Vec2::ZERO, Vec2::splat(across as f32 - 1.0)).as_uvec2();
        (at.y * across + at.x) as usize
    };
    let cells: Vec<usize> = points.iter().map(cell).collect();
    let mut starts = vec![0; (across * across) as usize + 1];
    cells.iter().for_each(|cell| starts[cell + 1] += 1);
    for cell in 1..starts.len() {
        starts[cell] += starts[cell - 1];
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|i| cells[*i]);
    (starts, order)
}

/// Returns the first two vectors of [`packed_words`]: centre and half size of the box of all, with the cells per metre.
pub(crate) fn packed_box(points: &[LocalPoint]) -> [Vec4; 2] {
    let (middle, half) = box_of(points);
    let scale = cells_per_m(points);
    [middle.extend(scale.x), half.extend(scale.y)]
}

/// Returns the layout that `evaluation/` reads: centre and half size of the box of all, with the cells per metre, then
/// those of each word, then the points, four at a time: x, y, z, weights.
pub(crate) fn packed_words(points: &[LocalPoint]) -> Vec<Vec4> {
    let entry = |(middle, half): (Vec3, Vec3)| [middle.extend(0.0), half.extend(0.0)];
    let mut packed = packed_box(points).to_vec();
    packed.extend(points.chunks(WORD).flat_map(|word| entry(box_of(word))));
    packed.resize(FIRST_POINT as usize, Vec4::ZERO);
    let none = LocalPoint { weight: 0.0, ..LocalPoint::white(Vec3::ZERO) };
    for word in points.chunks(WORD) {
        for four in 0..WORD / 4 {
            let value = |of: fn(&LocalPoint) -> f32| {
                Vec4::from_array(std::array::from_fn(|k| of(word.get(4 * four + k).unwrap_or(&none))))
            };
            packed.extend([value(|p| p.at.x), value(|p| p.at.y), value(|p| p.at.z), value(|p| p.weight)]);
        }
    }
    packed.resize(LIGHT_WORDS_LENGTH as usize, Vec4::ZERO);
    packed
}

/// Returns the layout that `evaluation/` reads: the points in the order of cells, each with its bit's index, then the
/// first of each cell, four at a time.
pub(crate) fn packed_cells(points: &[LocalPoint]) -> Vec<Vec4> {
    let (starts, order) = by_cells(points);
    let mut packed: Vec<Vec4> = order.iter().map(|i| points[*i].at.extend(*i as f32)).collect();
    let start = |i: usize| starts.get(i).map_or(0.0, |start| *start as f32);
    packed.extend((0..starts.len()).step_by(4).map(|i| Vec4::from_array(std::array::from_fn(|k| start(i + k)))));
    packed
}

/// Returns the box of all points in the world; for a sun, of the directions towards it.
pub(crate) fn world_box(light: &Light, points: &[LocalPoint], is_turned: bool) -> Aabb {
    box_along(light, points, is_turned, [Vec3::X, Vec3::Y, Vec3::Z], Vec3::ZERO)
}

/// Returns the box along other axes, about an origin in the world.
pub(crate) fn box_along(
    light: &Light,
    points: &[LocalPoint],
    is_turned: bool,
    axes: [Vec3; 3],
    origin_in_world: Vec3,
) -> Aabb {
    let frame = light.frame();
    let along = |v: Vec3| Vec3::from(axes.map(|axis| axis.dot(v)));
    let (middle, mut half) = box_of(points);
    let center = if light.is_distant() { -frame.axis } else { frame.center } - origin_in_world;
    if matches!(light.shape, LightShape::Sphere { .. }) {
        // The disc may face any direction.
        let radius = points.iter().map(|p| p.at.length()).fold(0.0, f32::max);
        let center = along(center);
        return Aabb { min: center - radius, max: center + radius };
    }
    if is_turned {
        let radius = points.iter().map(|p| p.at.truncate().length()).fold(0.0, f32::max);
        half = Vec3::new(radius, radius, half.z);
    }
    let middle = along(center + frame.right * middle.x + frame.up * middle.y + frame.axis * middle.z);
    let reach = along(frame.right).abs() * half.x + along(frame.up).abs() * half.y + along(frame.axis).abs() * half.z;
    // Margin for the points' single-precision rounding.
    let reach = reach + 1e-6 * (middle.abs() + reach);
    Aabb { min: middle - reach, max: middle + reach }
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra_light::SampleSet;

    #[test]
    fn words_are_compact_and_hold_every_point_once() {
        let light = Light::new(LightShape::Rectangle { size_m: Vec2::ONE }, Vec3::Y, Vec3::ZERO);
        for samples in [1, 31, 32, 33, 100, 256, 1000, 1024] {
            let points = local_points(&light, &SampleSet::R2.points(samples, 1));
            let mut indices: Vec<u32> = points.iter().map(|p| p.index).collect();
            indices.sort_unstable();
            assert_eq!(indices, (0..samples).collect::<Vec<_>>());
            if samples == 1024 {
                for word in points.chunks(WORD) {
                    let half = box_of(word).1;
                    assert!(4.0 * half.x * half.y < 0.06, "{half}");
                }
            }
        }
    }
}
