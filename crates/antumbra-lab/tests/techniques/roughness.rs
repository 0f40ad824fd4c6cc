//! Visible artefacts at default parameters: high-frequency error where the ground truth is smooth, weighted as the eye sees it.

use antumbra::TechniqueKind;
use antumbra_lab::device::LabDevice;
use glam::UVec2;

use crate::common::{Judged, lab, scene_file};

/// Image size, larger than in other tests: in small images penumbrae are so narrow that the ground truth is hardly smooth inside them.
const SIZE: UVec2 = UVec2::new(640, 360);

#[test]
fn defaults_keep_their_roughness() {
    let Some(lab) = lab() else { return };
    let kinds = [TechniqueKind::Pcss, TechniqueKind::Smrt, TechniqueKind::MultiLayer, TechniqueKind::SampleBased];
    // Bounds by technique: roughness, and roughness of the worst tile.
    for (spec, bounds) in [
        ("builtin:overlap", [[0.018, 0.0479], [0.0105, 0.0194], [0.0023, 0.0084], [0.0023, 0.0042]]),
        ("builtin:window", [[0.0114, 0.0506], [0.0102, 0.0255], [0.0084, 0.0287], [0.0037, 0.0246]]),
        ("builtin:lantern-wall", [[0.0124, 0.0625], [0.0059, 0.0192], [0.0052, 0.0244], [0.0017, 0.0057]]),
        ("builtin:lamp-room", [[0.0064, 0.0386], [0.0061, 0.0337], [0.0125, 0.0771], [0.0024, 0.0314]]),
        ("builtin:hall", [[0.0054, 0.0309], [0.0053, 0.0298], [0.0216, 0.0832], [0.0043, 0.0316]]),
    ] {
        hold(lab, &Judged::of_size(SIZE, spec, |_| {}), &kinds.into_iter().zip(bounds).collect::<Vec<_>>());
    }
}

/// Spheres on both sides of the edge between a light's central part and the ring around it. A map that ends at the edge
/// would leak along a bright wedge (worst tiles .049, .050, .032).
#[test]
fn no_light_leaks_where_parts_meet() {
    let Some(lab) = lab() else { return };
    let Some(spec) = scene_file("interior-rooms.glb") else { return };
    let bounds = [
        (TechniqueKind::Pcss, [0.0037, 0.0285]),
        (TechniqueKind::Smrt, [0.0016, 0.0079]),
        (TechniqueKind::MultiLayer, [0.0022, 0.0137]),
    ];
    hold(lab, &Judged::of_size(SIZE, &spec, |_| {}), &bounds);
}

/// Stairs with a lamp in the wall beside them: risers are edge-on in its map, and rays below the stairs cross them between
/// two map reads. (A thickness test at each read alone would light .043 of the umbra.)
#[test]
fn no_light_comes_through_stairs() {
    let Some(lab) = lab() else { return };
    let judged = Judged::of_size(UVec2::new(320, 180), "builtin:staircase", |_| {});
    let metrics = judged.metrics(&judged.run(lab, TechniqueKind::Smrt, &[]));
    let leak = metrics.umbra_leak.expect("dark pixels");
    println!("stairs: {leak:.4} of what is dark is lit");
    assert!(leak <= 0.012, "stairs: {leak} of what is dark is lit");
}

/// Checks bounds on roughness and on the worst tile's.
fn hold(lab: &LabDevice, judged: &Judged, bounds: &[(TechniqueKind, [f64; 2])]) {
    let spec = &judged.spec;
    for (kind, [bound, tile_bound]) in bounds {
        let metrics = judged.metrics(&judged.run(lab, *kind, &[]));
        let roughness = metrics.roughness.expect("smooth pixels");
        let worst_tile = metrics.worst_tile.expect("smooth pixels");
        println!("{spec}: {kind}: roughness {roughness:.4}, worst tile {worst_tile:.4} at {:?}", metrics.worst_tile_at);
        assert!(roughness <= *bound, "{spec}: {kind}: roughness {roughness} against {bound}");
        assert!(worst_tile <= *tile_bound, "{spec}: {kind}: worst tile {worst_tile} against {tile_bound}");
    }
}
