//! Antialiased pictures of masks that have one sample a pixel.
//!
//! A picture is the mean of several that are shifted by fractions of a pixel. Where a shifted pixel shows the surface that is seen at its
//! centre, it has the centre's colour, so that a mask's noise and steps stay as they are, neither blurred nor hidden. Where it shows another
//! one, past an edge, it is shaded anew, and takes its visibility from that of the mask's samples about it whose surface is its own. Truth
//! and techniques are treated alike.

use antumbra_render::antialiasing::{ALIKE, NORMALS_COUNT};
use glam::{IVec2, UVec2, Vec2, Vec3};

use crate::picture::{Visibility, VisibilityValues};
use crate::truth::SurfacePoint;

/// What a mask's samples are of.
#[derive(Debug)]
pub(crate) struct Samples {
    pub(crate) size_px: UVec2,
    /// Surface at each pixel's centre.
    pub(crate) points: Vec<Option<SurfacePoint>>,
    pub(crate) eye: Vec3,
    /// Size of a pixel, metres, at a metre from the eye.
    pub(crate) pixel_at_1_m: f32,
}

impl Samples {
    /// For each pixel of a picture that is shifted by `offset_px`, of which `shifted` are the surfaces: which sample shows its surface,
    /// or `None` where that is the one at the pixel's centre.
    pub(crate) fn sources(&self, shifted: &[Option<SurfacePoint>], offset_px: Vec2) -> Vec<Option<u32>> {
        let source = |(i, point): (usize, &Option<SurfacePoint>)| match point {
            Some(point) => self.source(i, point, offset_px),
            // Background has no visibility, and any sample does.
            None => self.points[i].is_some().then_some(i as u32),
        };
        shifted.iter().enumerate().map(source).collect()
    }

    fn source(&self, pixel: usize, shown: &SurfacePoint, offset_px: Vec2) -> Option<u32> {
        let width = self.size_px.x as i32;
        let at = IVec2::new(pixel as i32 % width, pixel as i32 / width);
        let pixel_m = self.pixel_at_1_m * shown.position.distance(self.eye);
        // Pixels between a sample and the plane of what is shown, and what their normals count.
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

/// A mask's values at such sources, and none where there is none: what is dark costs no shading.
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

    /// On one surface each place takes its own pixel's sample, however that looks on it.
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

    /// Beyond a silhouette, and round a corner, the neighbour's is taken that shows the same surface.
    #[test]
    fn across_an_edge_the_sample_of_the_same_surface_is_taken() {
        let silhouette = samples(|x| if x < 2 { 0.0 } else { -0.5 }, |_| Vec3::Z);
        let corner = samples(|_| 0.0, |x| if x < 2 { Vec3::Z } else { Vec3::X });
        // Pixel 6 shows the left surface at its centre, and the right one at the right of it; pixel 7 the other way round.
        let right = Vec2::new(7.0 / 16.0, 0.0);
        for (all, z) in [(&silhouette, -0.5), (&corner, 0.0)] {
            let mut shifted = all.points.clone();
            let other = all.points[7].unwrap();
            shifted[6] = Some(SurfacePoint { position: Vec3::new(0.0145, -0.01, z), ..other });
            assert_eq!(all.sources(&shifted, right)[6], Some(7));
            shifted[7] = Some(SurfacePoint { position: Vec3::new(0.0155, -0.01, 0.0), ..all.points[6].unwrap() });
            assert_eq!(all.sources(&shifted, -right)[7], Some(6));
        }
        // Where no sample shows it, or background is shown, the pixel's own does.
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
