//! Tests of the kernels' points against closed forms.

use glam::Vec2;

use super::{poisson_disk, vogel_disk};

#[test]
fn discs_are_centred_and_uniform() {
    for points in [vogel_disk(256), poisson_disk(256, 1)] {
        assert!(points.iter().all(|p| p.length() <= 1.0));
        let mean = points.iter().sum::<Vec2>() / 256.0;
        assert!(mean.length() < 0.03, "{mean}");
        // A uniform disc has a mean squared radius of ½.
        let second = points.iter().map(|p| p.length_squared()).sum::<f32>() / 256.0;
        assert!((second - 0.5).abs() < 0.02, "{second}");
    }
}
