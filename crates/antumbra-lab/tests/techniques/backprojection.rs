//! `backprojection` against the ray tracer: test scenes, every kind of light, and the claims of its two papers.

use antumbra::TechniqueKind;

use crate::common::{Judged, lab};
use crate::texels::{keeps_its_figures, knows_every_light, rmse_of};

const KIND: TechniqueKind = TechniqueKind::Backprojection;

#[test]
fn backprojection_keeps_its_figures() {
    let bounds = [
        ("builtin:overlap", 0.0168, 0.0088),
        ("builtin:leaning-plank", 0.0062, 0.0004),
        ("builtin:lantern-wall", 0.025, 0.0057),
        ("builtin:columns", 0.0105, 0.0013),
        ("builtin:window", 0.0358, 0.0045),
        ("builtin:tree", 0.064, 0.039),
    ];
    keeps_its_figures(KIND, &bounds);
}

#[test]
fn every_kind_of_light_is_known() {
    knows_every_light(KIND, [0.013, 0.012, 0.0216, 0.0115, 0.053, 0.0273, 0.039]);
}

/// Leaves at many depths: the sum of what each texel hides exceeds what they hide together.
#[test]
fn outlines_do_not_add_up_what_is_hidden_twice() {
    if lab().is_none() {
        return;
    }
    let judged = Judged::new("builtin:tree", |_| {});
    let [outlines, patches] =
        ["outlines", "patches"].map(|occluders| rmse_of(&judged, KIND, &[("occluders", occluders)]));
    println!("rmse {outlines:.4} by outlines, {patches:.4} by patches");
    assert!(outlines < 0.75 * patches, "{outlines} by outlines, {patches} by patches");
}
