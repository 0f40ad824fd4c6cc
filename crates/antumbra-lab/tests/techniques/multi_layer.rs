//! `multi_layer` against the ray tracer.

use antumbra::TechniqueKind;
use antumbra_lab::device::LabDevice;
use glam::UVec2;

use crate::common::{Judged, lab};

fn rmse(lab: &LabDevice, judged: &Judged, settings: &[(&str, &str)]) -> f64 {
    let run = judged.run(lab, TechniqueKind::MultiLayer, settings);
    let rmse = judged.metrics(&run).rmse.expect("judged pixels");
    println!("{}: multi_layer {settings:?}: rmse {rmse:.4}", judged.spec);
    rmse
}

#[test]
fn multi_layer_keeps_its_figures() {
    let Some(lab) = lab() else { return };
    for (spec, bound) in [
        ("builtin:lantern-wall", 0.0115),
        ("builtin:stacked-panels", 0.015),
        ("builtin:leaning-plank", 0.0073),
        ("builtin:overlap", 0.0098),
        ("builtin:tree", 0.046),
        ("builtin:window", 0.0265),
        ("builtin:fence-geometry", 0.0575),
        ("builtin:fence-alpha", 0.046),
        ("builtin:stained-glass", 0.0195),
        ("builtin:street", 0.06),
    ] {
        let error = rmse(lab, &Judged::new(spec, |_| {}), &[]);
        assert!(error < bound, "{spec}: rmse {error} against {bound}");
    }
}

#[test]
fn a_near_and_a_far_occluder_each_get_their_own_penumbra() {
    let Some(lab) = lab() else { return };
    let judged = Judged::new("builtin:lantern-wall", |_| {});
    let error = rmse(lab, &judged, &[]);
    // One mean depth for both would have an error of .03.
    assert!(error <= 0.011, "{error}");
}

#[test]
fn more_layers_miss_less() {
    let Some(lab) = lab() else { return };
    for spec in ["builtin:lantern-wall", "builtin:tree"] {
        let judged = Judged::new(spec, |_| {});
        // Only back faces count, so a solid is one layer.
        let errors = ["1", "2", "16", "0"].map(|layers| rmse(lab, &judged, &[("layers", layers), ("faces", "back")]));
        // The scene of the lantern has only two complete layers of back faces.
        assert!(errors[0] > errors[1] && errors[1] > errors[2] - 0.0002, "{spec}: {errors:?}");
        assert!((errors[2] - errors[3]).abs() < 0.002, "{spec}: 16 layers are nearly all: {errors:?}");
    }
}

#[test]
fn a_y_map_errs_less_than_a_mip_map() {
    let Some(lab) = lab() else { return };
    // Quarters of the light halve a MIP map's texels, too.
    for (spec, light_parts, bound) in [
        ("builtin:overlap", "1", 0.0163),
        ("builtin:overlap", "4", 0.0093),
        ("builtin:lantern-wall", "1", 0.019),
        ("builtin:lantern-wall", "4", 0.011),
    ] {
        let judged = Judged::new(spec, |_| {});
        let parts = ("light_parts", light_parts);
        let mip = rmse(lab, &judged, &[parts, ("hierarchy", "mip_map")]);
        let y = rmse(lab, &judged, &[parts]);
        assert!(y < bound && y < mip, "{spec}, {parts:?}: {y} against {bound}, and a MIP-map's {mip}");
    }
}

#[test]
fn what_saves_time_costs_little() {
    let Some(lab) = lab() else { return };
    for spec in ["builtin:overlap", "builtin:leaning-plank"] {
        let judged = Judged::new(spec, |_| {});
        let all = rmse(lab, &judged, &[]);
        for setting in [("epsilon", "30"), ("sub", "true"), ("subsampled_steps", "1"), ("light_parts", "1")] {
            let saving = rmse(lab, &judged, &[setting]);
            assert!(saving < all + 0.01, "{spec}, {setting:?}: {saving} against {all}");
        }
    }
}

#[test]
fn a_zero_size_light_gives_the_traced_hard_shadow() {
    let Some(lab) = lab() else { return };
    let judged = Judged::new("builtin:columns", |light| *light = light.scaled(0.0));
    let error = rmse(lab, &judged, &[]);
    assert!(error < 0.0465, "{error}");
}

/// At this size, slivers of `overlap` seen edge-on from the light cover texel centres. Depths behind the light must not
/// make ε negative, because a lookup that takes nothing never ends.
#[test]
fn edge_on_slivers_do_not_stop_the_lookup() {
    let Some(lab) = lab() else { return };
    // The technique is compared with itself, with additive opacities: a tiny ε must equal none.
    let size = UVec2::new(320, 180);
    let judged = Judged::of_size(size, "builtin:overlap", |_| {});
    for hierarchy in ["mip_map", "y_map"] {
        let [tiny, none] = ["0.001", "0"].map(|epsilon| {
            let own = [("epsilon", epsilon), ("epsilon_growth", "double"), ("faces", "back"), ("msaa", "1")];
            let shared = [("light_parts", "1"), ("list_accumulation", "add"), ("level_accumulation", "add")];
            judged.run(lab, TechniqueKind::MultiLayer, &[&own[..], &shared, &[("hierarchy", hierarchy)]].concat())
        });
        let pixels = size.element_product() as usize;
        let differences = (0..pixels).map(|i| f64::from((tiny.at(i, 0) - none.at(i, 0)).abs()));
        let mean = differences.sum::<f64>() / pixels as f64;
        assert!((0..pixels).any(|i| tiny.at(i, 0) > 0.1 && tiny.at(i, 0) < 0.9), "there are penumbrae");
        assert!(mean <= 1e-5, "{hierarchy}: {mean}");
    }
}
