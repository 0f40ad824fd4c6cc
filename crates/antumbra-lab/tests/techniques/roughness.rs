//! Visible artefacts of techniques as they come: high-frequency error where the truth is smooth, as an eye sees it.

use antumbra::TechniqueKind;
use glam::UVec2;

use crate::common::{Judged, lab};

/// Larger than elsewhere: in smaller pictures penumbrae are so narrow that the truth is hardly smooth anywhere but outside them.
const SIZE: UVec2 = UVec2::new(640, 360);

#[test]
fn defaults_keep_their_roughness() {
    let Some(lab) = lab() else { return };
    let kinds = [TechniqueKind::Pcss, TechniqueKind::Smrt, TechniqueKind::MultiLayer, TechniqueKind::SampleBased];
    // Bounds on roughness and on that of the worst tile for each kind.
    for (spec, bounds) in [
        ("builtin:overlap", [[0.018, 0.0479], [0.0108, 0.0199], [0.0023, 0.0084], [0.0023, 0.0042]]),
        ("builtin:window", [[0.0114, 0.0506], [0.0112, 0.0294], [0.0084, 0.0256], [0.0037, 0.0246]]),
        ("builtin:lantern-wall", [[0.0124, 0.0625], [0.0061, 0.0199], [0.0052, 0.0244], [0.0017, 0.0057]]),
        ("builtin:lamp-room", [[0.0064, 0.0386], [0.0065, 0.0367], [0.0125, 0.0771], [0.0024, 0.0314]]),
        ("builtin:hall", [[0.0088, 0.0494], [0.0085, 0.0464], [0.0293, 0.1232], [0.0043, 0.0316]]),
    ] {
        let judged = Judged::of_size(SIZE, spec, |_| {});
        for (kind, [bound, tile_bound]) in kinds.into_iter().zip(bounds) {
            let metrics = judged.metrics(&judged.run(lab, kind, &[]));
            let roughness = metrics.roughness.expect("smooth pixels");
            let worst_tile = metrics.worst_tile.expect("smooth pixels");
            println!(
                "{spec}: {kind}: roughness {roughness:.4}, worst tile {worst_tile:.4} at {:?}",
                metrics.worst_tile_at
            );
            assert!(roughness <= bound, "{spec}: {kind}: roughness {roughness} against {bound}");
            assert!(worst_tile <= tile_bound, "{spec}: {kind}: worst tile {worst_tile} against {tile_bound}");
        }
    }
}
