//! Tests of the colours of levels.

use glam::Vec3;

use super::super::nearest::all_squares;
use super::super::plan::FramePlan;
use super::super::{MultiLayerLightParts, MultiLayerParams};
use crate::TechniqueKind;
use crate::contract::{MapSize, Mask, MaskChannels};
use crate::gpu::Stage;
use crate::shadow::{Casters, Frame};
use crate::testing::{Case, Mesh, RECTANGLE, SIZE, gpu, read_layer, run, test_ground};

/// Returns a hue as in `primitives/hues.wesl`.
fn hue(number: usize) -> Vec3 {
    let hue = (number as f32 * 0.381_966).fract();
    Vec3::new(0.0, 2.0, 1.0).map(|k| 0.25 + 0.75 * (((hue + k / 3.0).fract() * 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0))
}

/// In the umbra of a half-plane the filter has one size, f = l (1/z − 1/z_r), between two levels' own. The colour is a mix of
/// theirs by the variance, as dark as an umbra.
#[test]
fn shown_levels_are_those_of_the_filter_s_size() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    for map_size in [256, 384, 512, 640] {
        let light_parts = MultiLayerLightParts::One;
        let params =
            MultiLayerParams { map_size: MapSize::Texels(map_size), light_parts, ..MultiLayerParams::default() };
        let (squared, filter) = case.with_prepared(&casters, |frame| {
            let plan = FramePlan::new(&Stage::at_once(gpu), frame, &casters, &params);
            let (lookup, ladder) = plan.lookup(&all_squares(plan.map_size));
            let squared: Vec<f32> =
                ladder.rungs[..lookup.rung_count as usize].iter().map(|rung| rung.squared).collect();
            (squared, lookup.filter_per_g * (1.0 / 2.5 - 1.0 / 4.0))
        });
        let finer = squared.iter().rposition(|own| *own <= filter * filter).expect("the base is for no filter");
        let want = squared.get(finer + 1).map_or(hue(finer), |coarser| {
            hue(finer).lerp(hue(finer + 1), (filter * filter - squared[finer]) / (coarser - squared[finer]))
        });
        let mut technique = TechniqueKind::MultiLayer.create(gpu).expect("a device with WebGPU's limits");
        let map_size = map_size.to_string();
        for (key, value) in [("map_size", map_size.as_str()), ("light_parts", "1"), ("show", "levels")] {
            technique.set(key, value).expect("a parameter");
        }
        let mask = Mask::with_channels(gpu.device(), SIZE, MaskChannels::Three);
        // The first frames may lack memory for all levels.
        for _ in 0..6 {
            case.with_frame(Casters::Meshes(&casters), |frame| {
                run(gpu, &mut technique, &Frame { mask: &mask, ..*frame }).expect("a good frame");
            });
        }
        let layers: [Vec<f32>; 3] =
            [0, 1, 2].map(|layer| bytemuck::pod_collect_to_vec(&read_layer(gpu, mask.texture(), layer)));
        let shown = |i: usize| Vec3::new(layers[0][i], layers[1][i], layers[2][i]);
        let umbra = case.ground_pixels(|p| test_ground(p) && p.x < -0.9);
        assert!(umbra.len() > 50);
        for (i, p) in umbra {
            // The bias moves the sheet by two thirds of a texel; neighbouring hues lie .1 apart.
            assert!(shown(i).abs_diff_eq(0.2 * want, 0.01), "{map_size} at {p}: {}, want {}", shown(i), 0.2 * want);
        }
        // Unshadowed receivers have no level.
        for (i, p) in case.ground_pixels(|p| test_ground(p) && p.x > 0.9) {
            assert!(shown(i).abs_diff_eq(Vec3::ONE, 0.01), "{map_size} at {p}: {}", shown(i));
        }
    }
}
