//! Points of a sphere light that all receivers share.
//!
//! A receiver sees a sphere as the uniform disc that faces it, so each receiver has its own disc. Points of one disc are right only along
//! its axis: 45 degrees off it the disc is narrower by a third. So points are taken within the ball, with the one density whose
//! projection on every plane is uniform. By Abel's inversion of a uniform disc it is 1 / √(R² − ρ²), of which the fraction
//! (θ − sin θ) / π lies within ρ = R sin(θ / 2).

use std::f32::consts::{PI, SQRT_2, TAU};

use glam::Vec3;

/// Points in the unit ball for points in the unit square; z of the latter is ignored.
///
/// A point's distance from the centre follows from its rank from pole to pole, in steps of √2 on the circle: the distances of
/// neighbours differ, and all together are evenly distributed.
pub(crate) fn ball_points(unit: &[Vec3]) -> Vec<Vec3> {
    let mut by_height: Vec<usize> = (0..unit.len()).collect();
    by_height.sort_by(|a, b| unit[*a].x.total_cmp(&unit[*b].x));
    let mut points = vec![Vec3::ZERO; unit.len()];
    for (rank, i) in by_height.into_iter().enumerate() {
        let share = ((rank as f32 + 0.5) * SQRT_2).fract();
        points[i] = radius_within(share) * direction(unit[i].x, unit[i].y);
    }
    points
}

/// Direction for a point (u, v) of the unit square, uniform over all directions.
fn direction(u: f32, v: f32) -> Vec3 {
    let height = 1.0 - 2.0 * u;
    let (sine, cosine) = (TAU * v).sin_cos();
    ((1.0 - height * height).max(0.0).sqrt() * Vec3::new(cosine, sine, 0.0)).with_z(height)
}

/// Distance from the centre within which the fraction `share` of all points lies; θ is found by bisection.
fn radius_within(share: f32) -> f32 {
    let (mut low, mut high) = (0.0, PI);
    for _ in 0..24 {
        let theta: f32 = 0.5 * (low + high);
        if theta - theta.sin() < share * PI {
            low = theta;
        } else {
            high = theta;
        }
    }
    (0.25 * (low + high)).sin()
}

#[cfg(test)]
mod tests {
    use antumbra_light::SampleSet;
    use glam::Vec3;

    use super::*;

    /// Fraction of a uniform disc of radius 1 that lies before a line at `s` from its centre.
    fn disc_before(s: f32) -> f32 {
        1.0 - (s.acos() - s * (1.0 - s * s).sqrt()) / PI
    }

    /// Root mean square difference between the fractions of points and of a disc before lines, over directions all around.
    fn difference(points: &[Vec3], directions: &[Vec3]) -> f32 {
        let lines: Vec<f32> = (0..20).map(|k| -0.95 + 0.1 * k as f32).collect();
        let squares = directions.iter().flat_map(|along| {
            lines.iter().map(move |s| {
                let before = points.iter().filter(|p| p.dot(*along) < *s).count();
                (before as f32 / points.len() as f32 - disc_before(*s)).powi(2)
            })
        });
        (squares.sum::<f32>() / (directions.len() * lines.len()) as f32).sqrt()
    }

    /// Points are a uniform disc from everywhere, the more exactly the more there are: independently drawn points would differ
    /// from it by at most 1 / (2 √n), and by .38 / √n in the root mean square over these lines.
    #[test]
    fn points_are_an_even_disc_from_all_sides() {
        let directions: Vec<Vec3> = SampleSet::Sobol.points(64, 7).iter().map(|u| direction(u.x, u.y)).collect();
        for (set, n) in
            [(SampleSet::R2, 64), (SampleSet::R2, 256), (SampleSet::Sobol, 256), (SampleSet::Stratified, 256)]
        {
            let found = difference(&ball_points(&set.points(n, 1)), &directions);
            let drawn = 0.38 / (n as f32).sqrt();
            assert!(found < 0.6 * drawn, "{set}, {n} points: {found} from a disc, drawn ones {drawn}");
        }
    }
}
