//! Tests through the techniques that use it.

use antumbra_light::LightShape;
use glam::{Mat4, UVec2, Vec2, Vec3};

use crate::TechniqueKind;
use crate::contract::{Mask, Receivers};
use crate::shadow::{Casters, Frame};
use crate::testing::{Case, Mesh, SIZE, gpu, half_plane_visibility, rmse as rmse_of, run, test_ground};

/// Returns the largest allowed difference from the mask of every pixel. Noise is interpolated, too, and neighbours' noise differs as
/// much as possible. The footprint of `essm` ends at adjacent pixels, which sparse neighbours do not know: .0077, where both masks are
/// as far from the closed form as with footprints that continue beyond (.0070 apart).
fn most_of_difference(kind: TechniqueKind) -> f32 {
    match kind {
        TechniqueKind::MultiLayer => 0.0046,
        TechniqueKind::Pcss | TechniqueKind::PcssAnisotropic => 0.009,
        _ => 0.008,
    }
}

/// Returns the largest allowed error against the closed form, because two constant masks would agree, too.
fn most_from_truth(kind: TechniqueKind) -> f32 {
    match kind {
        TechniqueKind::MultiLayer => 0.011,
        _ => 0.015,
    }
}

/// Error of linear interpolation between pixels two apart at a penumbra's ends, against the closed form; the penumbra is about
/// twelve pixels wide.
const MAX_OF_ENDS: f32 = 0.007;

#[test]
fn upsampling_keeps_known_pixels_and_interpolates_others() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ONE });
    let pixels = case.ground_pixels(test_ground);
    let from_truth = |mask: &[f32]| rmse_of(&pixels, mask, |p| half_plane_visibility(p.x, 1.0));
    let has_sub = |kind: &TechniqueKind| kind.param_specs().iter().any(|spec| spec.key == "sub");
    let of_a_new_shader =
        "a technique has a parameter `sub`, or has lost it: add it to `kinds`, if its shader is none of theirs";
    assert_eq!(TechniqueKind::ALL.iter().filter(|kind| has_sub(kind)).count(), 10, "{of_a_new_shader}");
    // One of each shader; `sample_based` has a test of its own.
    let kinds = [TechniqueKind::Pcss, TechniqueKind::PcssAnisotropic, TechniqueKind::Essm, TechniqueKind::MultiLayer];
    for kind in kinds {
        let all = case.run(gpu, kind, &[]);
        let sub = case.run(gpu, kind, &[("sub", "true")]);
        let is_known = |i: usize| (i as u32 % SIZE.x).is_multiple_of(2) && (i as u32 / SIZE.x).is_multiple_of(2);
        for i in (0..all.len()).filter(|i| is_known(*i)) {
            assert_eq!(all[i], sub[i], "{}: pixel {i}", kind.name());
        }
        let squared: f32 = all.iter().zip(&sub).map(|(a, b)| (a - b).powi(2)).sum();
        let rmse = (squared / all.len() as f32).sqrt();
        let (all, sub) = (from_truth(&all), from_truth(&sub));
        println!("{}: {rmse:.4} apart; from the closed form {all:.4}, interpolated {sub:.4}", kind.name());
        assert!(rmse > 0.0, "{}: nothing was interpolated", kind.name());
        assert!(rmse < most_of_difference(kind), "{}: {rmse}", kind.name());
        assert!(sub < most_from_truth(kind), "{}: {sub}", kind.name());
        assert!(sub < all + MAX_OF_ENDS, "{}: {sub} for {all}", kind.name());
    }
}

/// An image may be part of a larger texture with unrelated pixels beyond it: a pixel beyond the last known column takes the known
/// pixel's value or is looked up.
#[test]
fn upsampling_reads_no_pixel_outside_the_image() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ONE });
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let mut dim = 0;
    // Widths at which penumbrae cross the last columns.
    for width in [8, 14, 20, 26] {
        let size_px = UVec2::new(width, SIZE.y);
        // Projection to the left part of the camera's image.
        let part = SIZE.x as f32 / width as f32;
        let crop = Mat4::from_translation((part - 1.0) * Vec3::X) * Mat4::from_scale(Vec3::new(part, 1.0, 1.0));
        let of = |sub: &str| {
            let mut shadow = TechniqueKind::Pcss.create(gpu).expect("any device");
            for (key, value) in [("sub", sub), ("rotate", "false")] {
                shadow.set(key, value).expect("in range");
            }
            let mask = Mask::new(gpu.device(), size_px);
            case.with_frame(Casters::Meshes(&casters), |frame| {
                let clip_from_view = crop * frame.receivers.clip_from_view;
                let receivers = Receivers { size_px, clip_from_view, ..frame.receivers };
                run(gpu, &mut shadow, &Frame { receivers, mask: &mask, ..*frame }).expect("a good frame")
            })
        };
        let (all, sub) = (of("false"), of("true"));
        for y in (0..SIZE.y).step_by(2) {
            let last = (y * width + width - 1) as usize;
            let [known, got] = [sub[last - 1], sub[last]];
            assert!(
                (got - known).abs() < 1e-5 || (got - all[last]).abs() < 1e-5,
                "{width} wide, row {y}: {got} beside {known}, looked up {}",
                all[last]
            );
            dim += u32::from(known > 0.01 && known < 0.25);
        }
    }
    assert!(dim > 2, "{dim} pixels that a dark one beyond them would darken");
}
