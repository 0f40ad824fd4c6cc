//! What is summed over batches.

use glam::UVec2;

use crate::contract::{Casters, Frame, Technique, TechniqueKind};
use crate::techniques::multi_view::{MultiView, MultiViewParams};
use crate::techniques::tests::{Case, Mesh, RECTANGLE, gpu, half_plane_visibility, rmse, run, test_ground};

#[test]
fn sums_add_up_over_batches_and_start_over_with_each_frame() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let pixels = case.ground_pixels(test_ground);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let mut technique = TechniqueKind::MultiView.create(gpu).expect("any device");
    technique.set("view_size", "512").expect("in range");
    // One batch, one and a bit, three and a bit, and the first again.
    let masks: Vec<Vec<f32>> = ["32", "33", "100", "32"]
        .iter()
        .map(|samples| {
            technique.set("samples", samples).expect("in range");
            let frame = |frame: &Frame<'_>| run(gpu, &mut technique, frame).expect("a good frame");
            let mask = case.with_frame(Casters::Meshes(&casters), frame);
            let error = rmse(&pixels, &mask, |p| half_plane_visibility(p.x, 1.0));
            println!("{samples} light points: rmse {error:.4}");
            // 32 points make steps of a 32nd: .0131.
            assert!(error < 0.015, "{samples} light points: {error}");
            mask
        })
        .collect();
    assert!(masks[0] == masks[3], "something is left from other frames");
}

#[test]
fn more_pixels_than_sums_have_room_for_are_told() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let mut technique = MultiView::new(gpu).expect("any device");
    let error = case.with_frame(Casters::Meshes(&casters), |frame| {
        let mut frame = *frame;
        frame.receivers.size_px = UVec2::splat(1 << 14);
        technique.prepare(gpu, &frame, &MultiViewParams::default()).unwrap_err().to_string()
    });
    assert!(error.contains("32 for each pixel") && error.contains("set `compare` to gather"), "{error}");
    assert!(!error.contains('\n'), "{error}");
}
