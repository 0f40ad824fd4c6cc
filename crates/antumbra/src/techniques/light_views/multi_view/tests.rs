//! Tests of the sums over batches, and of the comparisons with maps.

use antumbra_light::{Light, LightShape};
use glam::{UVec2, Vec2, Vec3};

use crate::TechniqueKind;
use crate::contract::{Mask, MeshCaster, Receivers};
use crate::gpu::{Gpu, Stage};
use crate::shadow::{Casters, Frame};
use crate::techniques::Technique;
use crate::techniques::light_views::multi_view::{MultiView, MultiViewParams};
use crate::testing::{
    Case, Mesh, RECTANGLE, View, draw_depth, gpu, gpu_with_bindings_of, half_plane_visibility, rmse, run, test_ground,
    view_of,
};

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

/// Maps so large that each is a batch by itself give the same sum as one batch of all.
#[test]
fn batches_of_one_view_are_those_of_all() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let of = |view_size: &str| {
        let mask = case.run(gpu, TechniqueKind::MultiView, &[("samples", "3"), ("view_size", view_size)]);
        case.ground_pixels(test_ground).into_iter().map(|(i, _)| mask[i]).collect::<Vec<_>>()
    };
    let (each, all) = (of("4096"), of("512"));
    let apart = each.iter().zip(&all).map(|(each, all)| (each - all).abs()).sum::<f32>() / all.len() as f32;
    println!("{apart} apart");
    assert!(apart < 0.005, "{apart} apart");
}

/// A device whose bindings hold a third of an image's sums uses bands, and gives the same bits.
#[test]
fn bands_give_the_bits_of_one() {
    let Some(gpu) = gpu() else { return };
    // 96 × 96 pixels of 24 and of 32 bytes are 216 and 288 KiB.
    let Some(small) = gpu_with_bindings_of(96 << 10) else { return };
    for settings in [[("compare", "triangles")], [("compare", "sharp")]] {
        let mask = |gpu: &Gpu| {
            let case = Case::half_plane(gpu, RECTANGLE);
            let settings = [&[("view_size", "128"), ("samples", "40")][..], &settings].concat();
            case.run(gpu, TechniqueKind::MultiView, &settings)
        };
        assert!(mask(gpu) == mask(&small), "{settings:?}");
    }
}

/// At 3840 × 2160 the sums of all pixels exceed WebGPU's default binding limit, or that of this adapter: as few bands as hold them give
/// the bits of many.
#[test]
#[ignore = "takes minutes on a software renderer"]
fn bands_of_a_large_picture_give_the_bits_of_narrow_ones() {
    let Some(gpu) = gpu() else { return };
    let Some(small) = gpu_with_bindings_of(16 << 20) else { return };
    let size = UVec2::new(3840, 2160);
    let mask = |gpu: &Gpu| {
        let case = Case::half_plane(gpu, RECTANGLE);
        let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
        let clip_from_world = case.view.clip_from_view * case.view.view_from_world;
        let depth = view_of(&draw_depth(gpu, size, clip_from_world, &casters));
        let mask = Mask::new(gpu.device(), size);
        let mut technique = TechniqueKind::MultiView.create(gpu).expect("any device");
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let receivers = Receivers { size_px: size, depth: &depth, ..frame.receivers };
            run(gpu, &mut technique, &Frame { receivers, mask: &mask, ..*frame }).expect("a good frame")
        })
    };
    let in_bands = mask(gpu);
    assert!(in_bands.iter().any(|v| *v < 0.1) && in_bands.iter().any(|v| *v > 0.9), "no shadow to compare");
    assert!(in_bands == mask(&small));
}

#[test]
fn rows_that_do_not_fit_a_binding_are_told() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let mut technique = MultiView::new(gpu).expect("any device");
    let error = case.with_prepared(&casters, |frame| {
        let mut frame = *frame;
        frame.receivers.size_px = UVec2::new(1 << 24, 1 << 4);
        technique.prepare(&Stage::at_once(gpu), &frame, &MultiViewParams::default()).unwrap_err().to_string()
    });
    assert!(error.contains("32 for each pixel") && error.contains("set `compare` to gather"), "{error}");
    assert!(!error.contains('\n'), "{error}");
}

#[test]
fn a_crossing_sheet_casts_its_shadow_from_where_it_crosses() {
    let Some(gpu) = gpu() else { return };
    // A ground of 6 m and a sheet of slope ½ through it along x = 0, under a small light: what is below the sheet is
    // hidden. In maps of 48² a texel is 12.5 cm.
    let light = LightShape::Rectangle { size_m: Vec2::splat(0.1) };
    let light = Light::new(light, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let corners = [(-1.0, -2.0), (-1.0, 2.0), (1.2, 2.0), (1.2, -2.0)];
    let sheet = Mesh::new(gpu, &corners.map(|(x, z)| Vec3::new(x, 0.5 * x, z)), &[0, 1, 2, 0, 2, 3]);
    let ground = Mesh::horizontal(gpu, Vec2::splat(-3.0), Vec2::splat(3.0), 0.0);
    // From below the sheet.
    let view = View::new(Vec3::new(0.5, 0.15, 0.0), Vec3::new(0.08, 0.0, 0.0));
    let case = Case::new(gpu, light, view, vec![ground, sheet]);
    let below = case.ground_pixels(|p| (0.03..0.12).contains(&p.x) && p.z.abs() < 1.0);
    let hidden = |compare: &str| {
        let settings = [("view_size", "48"), ("samples", "64"), ("window", "plain"), ("compare", compare)];
        let mask = case.run(gpu, TechniqueKind::MultiView, &settings);
        rmse(&below, &mask, |_| 0.0)
    };
    let (triangles, sharp, gather) = (hidden("triangles"), hidden("sharp"), hidden("gather"));
    println!(
        "{} pixels up to a texel behind the crossing: triangles {triangles:.3}, sharp {sharp:.3}, gather {gather:.3}",
        below.len()
    );
    assert!(triangles < 1e-3, "{triangles}");
    assert!(sharp < 0.02, "{sharp}");
    // The sheet is within the bias of half a texel there: the result of the test without the sheet's slope.
    assert!(gather > 0.5, "{gather}");
}

#[test]
fn a_light_inside_a_solid_lights_nothing_outside() {
    let Some(gpu) = gpu() else { return };
    let light = Light::new(LightShape::Rectangle { size_m: Vec2::splat(0.1) }, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    // A box of half a metre about the light, its faces turned outward.
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5;
    let corners: Vec<Vec3> = (0..8).map(|i| Vec3::new(0.0, 4.0, 0.0) + 0.5 * corner(i)).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices: Vec<u32> = quads.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
    let solid = Mesh::new(gpu, &corners, &indices);
    let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    let case = Case::new(gpu, light, view, vec![ground, solid]);
    let pixels = case.ground_pixels(test_ground);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).zip([false, true]).collect();
    let casters: Vec<_> = casters.into_iter().map(|(caster, closed)| MeshCaster { closed, ..caster }).collect();
    for compare in ["triangles", "sharp", "gather"] {
        let settings = [("view_size", "64"), ("samples", "8"), ("compare", compare)];
        let mask =
            case.run_with(gpu, TechniqueKind::MultiView, &settings, Casters::Meshes(&casters)).expect("a good frame");
        let error = rmse(&pixels, &mask, |_| 0.0);
        assert!(error < 1e-6, "{compare}: {error}");
    }
}

/// A strip along z at height ½ m, from `low` to `high` along x.
fn strip(gpu: &Gpu, low: f32, high: f32, cells: u32) -> Mesh {
    let corner = |i: u32, j: u32| {
        let (u, v) = (i as f32 / cells as f32, j as f32 / cells as f32);
        Vec3::new(low + u * (high - low), 0.5, 4.0 * v - 2.0)
    };
    let positions: Vec<Vec3> = (0..=cells).flat_map(|i| (0..=cells).map(move |j| corner(i, j))).collect();
    let at = |i: u32, j: u32| i * (cells + 1) + j;
    let cell = |i: u32, j: u32| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)];
    let indices: Vec<u32> = (0..cells).flat_map(|i| (0..cells).flat_map(move |j| cell(i, j))).collect();
    Mesh::new(gpu, &positions, &indices)
}

/// Fraction of a light of 20 cm at height 4 m that a strip at height ½ m leaves on the ground at x.
fn strip_visibility(x: f32, low: f32, high: f32) -> f32 {
    // The segment to light place l passes x + (l − x) / 8.
    let covered = |edge: f32| (8.0 * (edge - x) + x).clamp(-0.1, 0.1);
    1.0 - (covered(high) - covered(low)) / 0.2
}

fn error_under_strip(gpu: &Gpu, low: f32, high: f32, cells: u32, settings: &[(&str, &str)]) -> f32 {
    let light = LightShape::Rectangle { size_m: Vec2::splat(0.2) };
    let light = Light::new(light, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let ground = Mesh::horizontal(gpu, Vec2::splat(-3.0), Vec2::splat(3.0), 0.0);
    // From below the strip.
    let view = View::new(Vec3::new(0.9, 0.4, 0.3), Vec3::new(0.3, 0.0, 0.0));
    let case = Case::new(gpu, light, view, vec![ground, strip(gpu, low, high, cells)]);
    let pixels = case.ground_pixels(|p| p.x.abs() < 0.6 && p.z.abs() < 0.6);
    let mask = case.run(gpu, TechniqueKind::MultiView, settings);
    rmse(&pixels, &mask, |p| strip_visibility(p.x, low, high))
}

#[test]
fn edges_are_where_they_are_however_wide_texels_are() {
    let Some(gpu) = gpu() else { return };
    // Texels of 12.5 cm on the ground; the last strip is narrower.
    for high in [0.5, 0.3, 0.2] {
        let error = |compare| {
            let settings = [("view_size", "48"), ("samples", "64"), ("window", "plain"), ("compare", compare)];
            error_under_strip(gpu, 0.1, high, 1, &settings)
        };
        let (triangles, sharp) = (error("triangles"), error("sharp"));
        println!("{:.1} m wide: triangles {triangles:.4}, sharp {sharp:.4}", high - 0.1);
        assert!(triangles < 0.006, "{triangles}");
        // The error of answers at texel centres alone.
        assert!(sharp > 0.1, "{sharp}");
    }
}

#[test]
fn triangles_much_smaller_than_a_texel_hide_what_they_cover() {
    let Some(gpu) = gpu() else { return };
    // Cells of 4 to 1.3 mm, where a texel is 2.3 cm: few are walked over from one texel to the next.
    for cells in [100, 300] {
        let error = |compare| error_under_strip(gpu, 0.1, 0.5, cells, &[("view_size", "256"), ("compare", compare)]);
        let (triangles, sharp) = (error("triangles"), error("sharp"));
        println!("{cells} cells across: triangles {triangles:.4}, sharp {sharp:.4}");
        assert!(triangles < 0.03, "{cells} cells across: {triangles}");
    }
}
