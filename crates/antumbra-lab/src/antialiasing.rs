//! Antialiased images from masks with one sample per pixel.
//!
//! The image is the mean of several that are shifted by fractions of a pixel. If a shifted pixel shows the same surface as its centre, it
//! keeps the centre's colour, so noise and steps of a mask are neither blurred nor hidden. If it shows another surface, past an edge, it
//! is shaded anew with the visibility of a neighbouring mask sample on that surface. Ground truth and techniques are treated alike.

use antumbra_render::antialiasing::{ALIKE, NORMALS_COUNT};
use glam::{IVec2, UVec2, Vec2, Vec3};

use crate::picture::{Visibility, VisibilityValues};
use crate::truth::SurfacePoint;

/// Surfaces on which a mask's samples lie.
#[derive(Debug)]
pub(crate) struct Samples {
    pub(crate) size_px: UVec2,
    /// Surface at each pixel's centre; `None` for background.
    pub(crate) points: Vec<Option<SurfacePoint>>,
    pub(crate) eye: Vec3,
    /// Size of a pixel at 1 m from the eye, metres.
    pub(crate) pixel_at_1_m: f32,
}

impl Samples {
    /// Returns, for each pixel of an image shifted by `offset_px` with the surfaces `shifted`, the index of the sample on its surface, or
    /// `None` if that is the sample at the pixel's centre.
    pub(crate) fn sources(&self, shifted: &[Option<SurfacePoint>], offset_px: Vec2) -> Vec<Option<u32>> {
        let source = |(i, point): (usize, &Option<SurfacePoint>)| match point {
            Some(point) => self.source(i, point, offset_px),
            // Background has no visibility, so any sample will do.
            None => self.points[i].is_some().then_some(i as u32),
        };
        shifted.iter().enumerate().map(source).collect()
    }

    fn source(&self, pixel: usize, shown: &SurfacePoint, offset_px: Vec2) -> Option<u32> {
        let width = self.size_px.x as i32;
        let at = IVec2::new(pixel as i32 % width, pixel as i32 / width);
        let pixel_m = self.pixel_at_1_m * shown.position.distance(self.eye);
        // Distance of a sample from the plane of the shown surface in pixels, plus a weight for different normals.
        let unlike = |sample: &SurfacePoint| {
            let off_plane = (sample.position - shown.position).dot(shown.normal).abs() / pixel_m;
            off_plane + NORMALS_COUNT * (1.0 - sample.normal.dot(shown.normal))
        };
        if self.points[pixel].as_ref().is_some_and(|own| unlike(own) < ALIKE) {
            return None;
        }
        let mut best = (f32::INFINITY, pixel as u32);
        for (dy, dx) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))) {
            let beside = at + IVec2::new(dx, dy);
            if beside.cmplt(IVec2::ZERO).any() || beside.cmpge(self.size_px.as_ivec2()).any() {
                continue;
            }
            let candidate = (beside.y * width + beside.x) as usize;
            let Some(sample) = &self.points[candidate] else { continue };
            let cost = (Vec2::new(dx as f32, dy as f32) - offset_px).length_squared() + unlike(sample);
            if cost < best.0 {
                best = (cost, candidate as u32);
            }
        }
        Some(best.1)
    }
}

/// Gathers a mask's values at the given sources. Pixels without a source are dark, so they cost no shading.
pub(crate) fn gathered(visibility: &Visibility, sources: &[Option<u32>]) -> Visibility {
    let values = match &visibility.values {
        VisibilityValues::One(values) => {
            VisibilityValues::One(sources.iter().map(|i| i.map_or(0.0, |i| values[i as usize])).collect())
        }
        VisibilityValues::Three(values) => {
            VisibilityValues::Three(sources.iter().map(|i| i.map_or(Vec3::ZERO, |i| values[i as usize])).collect())
        }
    };
    Visibility { size_px: visibility.size_px, values }
}

#[cfg(test)]
mod tests {
    use antumbra_render::antialiasing::OFFSETS_PX;

    use super::*;

    fn samples(z: impl Fn(u32) -> f32, normal: impl Fn(u32) -> Vec3) -> Samples {
        let size_px = UVec2::new(5, 3);
        let points = (0..15).map(|i| {
            let position = Vec3::new((i % 5) as f32 * 0.01, (i / 5) as f32 * -0.01, z(i % 5));
            Some(SurfacePoint { position, normal: normal(i % 5) })
        });
        Samples { size_px, points: points.collect(), eye: Vec3::Z, pixel_at_1_m: 0.01 }
    }

    /// Within one surface, each pixel uses its own sample, whatever its value.
    #[test]
    fn within_a_surface_samples_stay_where_they_are() {
        let flat = samples(|_| 0.0, |_| Vec3::Z);
        for offset_px in OFFSETS_PX {
            let shifted: Vec<_> = (flat.points.iter().flatten())
                .map(|p| {
                    Some(SurfacePoint { position: p.position + 0.01 * Vec3::new(offset_px.x, -offset_px.y, 0.0), ..*p })
                })
                .collect();
            assert_eq!(flat.sources(&shifted, offset_px), [None; 15]);
        }
    }

    /// Beyond a silhouette or a corner, the neighbour on the shown surface is used.
    #[test]
    fn across_an_edge_the_sample_of_the_same_surface_is_taken() {
        let silhouette = samples(|x| if x < 2 { 0.0 } else { -0.5 }, |_| Vec3::Z);
        let corner = samples(|_| 0.0, |x| if x < 2 { Vec3::Z } else { Vec3::X });
        // At its centre, pixel 6 shows the left surface, and at its right the right one; pixel 7 vice versa.
        let right = Vec2::new(7.0 / 16.0, 0.0);
        for (all, z) in [(&silhouette, -0.5), (&corner, 0.0)] {
            let mut shifted = all.points.clone();
            let other = all.points[7].unwrap();
            shifted[6] = Some(SurfacePoint { position: Vec3::new(0.0145, -0.01, z), ..other });
            assert_eq!(all.sources(&shifted, right)[6], Some(7));
            shifted[7] = Some(SurfacePoint { position: Vec3::new(0.0155, -0.01, 0.0), ..all.points[6].unwrap() });
            assert_eq!(all.sources(&shifted, -right)[7], Some(6));
        }
        // If no sample shows the surface, or the pixel shows background, its own sample is used.
        let alone = Samples { points: vec![None; 15], ..samples(|_| 0.0, |_| Vec3::Z) };
        let own: Vec<_> = (0..15).map(Some).collect();
        assert_eq!(alone.sources(&silhouette.points, right), own);
        assert_eq!(silhouette.sources(&alone.points, right), own);
        assert_eq!(alone.sources(&alone.points, right), [None; 15]);
    }

    #[test]
    fn values_are_gathered_channel_by_channel() {
        let size_px = UVec2::new(2, 1);
        let one = Visibility::one(size_px, vec![0.25, 0.5]);
        assert_eq!(gathered(&one, &[Some(1), None]), Visibility::one(size_px, vec![0.5, 0.0]));
        let three = Visibility::three(size_px, vec![Vec3::X, Vec3::Y]);
        assert_eq!(gathered(&three, &[Some(1), Some(0)]), Visibility::three(size_px, vec![Vec3::Y, Vec3::X]));
    }
}
