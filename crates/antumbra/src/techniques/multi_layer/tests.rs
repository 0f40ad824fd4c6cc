//! Tests of the filter against its CPU reference, and of the technique's properties.

use antumbra_light::{Light, LightShape};
use glam::{UVec2, Vec2, Vec3};

use super::levels::{DepthReach, LevelOptions, levels, prune_levels};
use super::nearest::{all_squares, squares_for};
use super::plan::light_extent;
use super::{MultiLayer, MultiLayerDepthAverage, MultiLayerHierarchy, MultiLayerParams, PreparedMultiLayer, cpu};
use crate::TechniqueKind;
use crate::contract::{MapSize, Mask, MeshCaster, Opacity, PreparedCasters, PreparedFrame, SurfaceCoverage};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::texel_lists::cpu::ReferenceFragment;
use crate::light_map::texel_lists::options::DepthTolerance;
use crate::light_map::texel_lists::tests::{TestMesh, agree, scenes, unpack};
use crate::shadow::Casters;
use crate::techniques::Technique;
use crate::testing::{
    Case, Mesh, RECTANGLE, View, empty_depth, gpu, half_plane_visibility, read_storage, test_ground, test_receivers,
};

mod levels_shown;
mod seen_from_the_side;

#[test]
fn levels_cover_the_map() {
    let maps = [
        ((1024, 1024), 128),
        ((1024, 1024), 1),
        ((1000, 1000), 128),
        ((1408, 736), 128),
        ((32, 128), 1),
        ((96, 96), 24),
        ((64, 64), 128),
        ((16, 16), 8),
    ];
    for (((width, height), stack_size), fine) in maps.into_iter().flat_map(|map| [(map, false), (map, true)]) {
        let map_size = UVec2::new(width, height);
        let options = LevelOptions { map_size, octaves: 14, stack_size, fine, subsampled_steps: 0, samples: 1 };
        let levels = levels(&options);
        let what = |i: usize| format!("level {i} of {map_size}, {stack_size}, {fine}");
        for (i, level) in levels.iter().enumerate() {
            let kernel = level.kernel();
            // Consecutive kernels leave no gap, and cover the map.
            assert!(level.spacing <= kernel, "{}", what(i));
            let last = (level.size - 1).as_vec2() + level.offset;
            let end = last * level.spacing + 0.5 * kernel;
            assert!(end.cmpge(map_size.as_vec2()).all(), "{}", what(i));
            assert!(level.offset * level.spacing <= 0.5 * kernel, "{}", what(i));
            if i > 0 {
                assert!(level.width > 1.8 * levels[i - 1].width || level.offset != 0.5, "{}", what(i));
                assert!(level.width > levels[i - 1].width, "{}", what(i));
                assert_eq!(level.first, levels[i - 1].first + levels[i - 1].size.element_product());
                assert!(level.source < i);
            }
        }
        let kernel = levels.last().expect("the base").octave.exp2() as u32;
        assert!(kernel >= width.max(height) && kernel / 2 < width.max(height), "{map_size} ends with {kernel}");
    }
    // Figure 7: the stack's first level is a texel wider, the others keep its size.
    let sizes = |fine| -> Vec<u32> {
        let map_size = UVec2::splat(16);
        let options = LevelOptions { map_size, octaves: 14, stack_size: 4, fine, subsampled_steps: 0, samples: 1 };
        levels(&options).iter().map(|level| level.size.x).collect()
    };
    assert_eq!(sizes(false), [16, 8, 4, 5, 5]);
    assert_eq!(sizes(true), [16, 8, 4, 5, 6, 5]);
}

#[test]
fn levels_end_with_what_receivers_look_up() {
    let whole = levels(&LevelOptions {
        map_size: UVec2::splat(256),
        octaves: 14,
        stack_size: 32,
        fine: true,
        subsampled_steps: 0,
        samples: 1,
    });
    for perspective in [true, false] {
        let reach = DepthReach { perspective, near_m: 2.0, far_m: 10.0, filter_per_g: 60.0 };
        let epsilon = DepthTolerance { slope: 0.05, m: 0.1 };
        let mut kept = whole.clone();
        prune_levels(&mut kept, &reach, |_| epsilon);
        let filter = |z_m: f32, z_receiver_m: f32| {
            reach.filter_per_g * if perspective { 1.0 / z_m - 1.0 / z_receiver_m } else { z_receiver_m - z_m }
        };
        // The filter width of any occluder and receiver lies between two levels, and both contain the occluder.
        let widest = filter(reach.near_m, reach.far_m);
        assert!(kept.len() == whole.len() || kept[kept.len() - 1].width >= widest, "{perspective}");
        for i in 0..=100 {
            let z_m = reach.near_m + 0.01 * i as f32 * (reach.far_m - reach.near_m);
            for (level, finer) in kept[1..].iter().zip(&kept) {
                let is_looked_up = filter(z_m, reach.far_m) > finer.width;
                assert!(!is_looked_up || z_m < level.z_limit_m, "{perspective}, {z_m} in {level:?}");
            }
        }
        for level in &kept[1..] {
            // A surface that the source cuts off would become a different one.
            let source = &kept[level.source];
            let end = level.z_limit_m + epsilon.slope * level.z_limit_m + epsilon.m;
            assert!(level.source == 0 || source.z_limit_m >= end, "{level:?} of {source:?}");
        }
    }
}

#[test]
fn pruning_levels_changes_no_mask() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    for parts in ["1", "4"] {
        let mask =
            |footprint| case.run(gpu, TechniqueKind::MultiLayer, &[("light_parts", parts), ("footprint", footprint)]);
        // A footprint, here a negligible one, disables pruning, so every level is complete.
        let kept = mask("0");
        let unpruned = case.run(gpu, TechniqueKind::MultiLayer, &[("light_parts", parts), ("prune", "false")]);
        assert!(kept.iter().any(|v| *v > 0.1 && *v < 0.9), "there is a penumbra");
        for whole in [mask("1e-6"), unpruned] {
            let differing = kept.iter().zip(&whole).filter(|(a, b)| (*a - *b).abs() > 1e-4).count();
            assert_eq!(differing, 0, "of {} pixels, {parts} parts", kept.len());
        }
    }
}

/// Without pruning the requested number of levels is made, and their lists hold fragments behind all receivers.
#[test]
fn unpruned_levels_are_those_that_are_asked_for() {
    let Some(gpu) = gpu() else { return };
    let (_, light, meshes) = &scenes()[0];
    let found = |prune, levels| {
        let mut technique = MultiLayer::new(gpu).expect("default limits");
        (technique.room.capacity, technique.room.map_size) = (1 << 20, 128);
        let params = MultiLayerParams {
            map_size: MapSize::Texels(128),
            hierarchy: MultiLayerHierarchy::MipMap,
            prune,
            levels,
            ..MultiLayerParams::default()
        };
        let prepared = record(gpu, &mut technique, light, meshes, &params);
        let counters: Vec<u32> = read_storage(gpu, &prepared.lists.counters);
        (prepared.levels.len(), counters[1])
    };
    let (pruned, whole, five) = (found(true, 8), found(false, 8), found(false, 5));
    println!("levels, fragments of all: pruned {pruned:?}, whole {whole:?}, five levels {five:?}");
    assert_eq!((whole.0, five.0), (8, 5));
    assert!(pruned.1 < whole.1 && five.1 < whole.1, "{pruned:?}, {whole:?}, {five:?}");
}

/// Section 5.2. Two opaque sheets, one just above the other, cover all of the light between two levels: each level holds two
/// fragments of opacity 1, with weights w and 1 − w. By multiplication the remaining light is
///
/// - as published (1 − w)² w²: each of the four fragments is weighted, then accumulated. At most 1/16, at w = ½, where
///   1 − (½)⁴ = .94 is hidden;
/// - with levels weighted (1 − w) w: at most ¼, where .75 is hidden.
///
/// Addition leaves nothing of it either way.
#[test]
fn hats_weight_fragments_before_they_accumulate() {
    let Some(gpu) = gpu() else { return };
    let light = Light::new(RECTANGLE, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let largest = |hat: &str, accumulation: &str| {
        let settings = [
            ("map_size", "128"),
            ("epsilon", "0"),
            ("hierarchy", "mip_map"),
            ("list_accumulation", accumulation),
            ("level_accumulation", accumulation),
            ("level_weights", "depth"),
            ("filter_widths", "merged"),
            ("hat", hat),
            ("lists", "apart"),
            ("planes", "false"),
            ("light_parts", "1"),
            ("msaa", "1"),
        ];
        // As the sheets rise, w passes ½ between each two levels, where the remaining light has its maximum.
        let left = (0..24).map(|i| {
            let height = 0.8 + 0.05 * i as f32;
            let sheet = |height| Mesh::horizontal(gpu, Vec2::splat(-2.5), Vec2::splat(2.5), height);
            let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
            let view = View::new(Vec3::new(1.0, 0.5, 1.0), Vec3::ZERO);
            let case = Case::new(gpu, light.clone(), view, vec![ground, sheet(height), sheet(height + 0.002)]);
            let mask = case.run(gpu, TechniqueKind::MultiLayer, &settings);
            let seen = case.ground_pixels(|p| p.x.abs() < 0.2 && p.z.abs() < 0.2);
            assert!(!seen.is_empty());
            seen.iter().map(|(i, _)| mask[*i]).fold(0.0, f32::max)
        });
        left.fold(0.0, f32::max)
    };
    let (fragments, levels) = (largest("fragments", "multiply"), largest("levels", "multiply"));
    println!("light left: fragments weighted {fragments}, levels weighted {levels}");
    assert!((0.058..=0.0635).contains(&fragments), "1 − .94 = .0625, not {fragments}");
    assert!((0.235..=0.2515).contains(&levels), "1 − .75 = .25, not {levels}");
    assert!(largest("fragments", "add") < 0.01 && largest("levels", "add") < 0.01);
    // The largest of four weighted fragments is ½ where w is.
    assert!((0.48..=0.51).contains(&largest("fragments", "max")));
}

/// Records a frame with a technique whose parameters are accessible.
fn record(
    gpu: &Gpu,
    technique: &mut MultiLayer,
    light: &Light,
    meshes: &[TestMesh],
    params: &MultiLayerParams,
) -> PreparedMultiLayer {
    let on_gpu: Vec<Mesh> = meshes.iter().map(|mesh| Mesh::new(gpu, &mesh.positions, &mesh.indices)).collect();
    let casters: Vec<_> = meshes.iter().zip(&on_gpu).map(|(mesh, on_gpu)| mesh.caster(on_gpu)).collect();
    let size = UVec2::splat(16);
    let depth = empty_depth(gpu, size);
    let mask = Mask::new(gpu.device(), size);
    let frame = PreparedFrame {
        light,
        casters: PreparedCasters::Draws(&casters),
        receivers: test_receivers(size, &depth).into(),
        mask: &mask,
        noisy: None,
    };
    let prepared = technique.prepare(&Stage::at_once(gpu), &frame, params).expect("a good frame");
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    technique.record(&mut Recorder::new(&mut encoder, None), &frame, &prepared);
    gpu.queue().submit([encoder.finish()]);
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
    prepared
}

#[test]
fn every_level_equals_its_cpu_reference() {
    let Some(gpu) = gpu() else { return };
    for (name, light, meshes) in scenes() {
        for (stack_size, subsampled_steps, depth_average) in
            [(24, 0, MultiLayerDepthAverage::Opacity), (8, 1, MultiLayerDepthAverage::Count)]
        {
            let by_count = depth_average == MultiLayerDepthAverage::Count;
            let params = MultiLayerParams {
                map_size: MapSize::Texels(96),
                stack_size,
                subsampled_steps,
                depth_average,
                ..MultiLayerParams::default()
            };
            let mut technique = MultiLayer::new(gpu).expect("default limits");
            technique.room.capacity = 1 << 20;
            technique.room.map_size = 96;
            let prepared = record(gpu, &mut technique, &light, &meshes, &params);
            let fragments: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists.fragments);
            let entries: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists.lists);
            let colored = meshes.iter().any(|mesh| mesh.opacity < 1.0);
            let levels = &prepared.levels;
            let lists_of = |i: usize| -> Vec<_> {
                let level = &levels[i];
                let entries = &entries[level.first as usize..][..level.size.element_product() as usize];
                entries.iter().map(|entry| unpack(&fragments, *entry, colored)).collect()
            };
            let texel = prepared.texel_in_plane;
            for i in 1..levels.len() {
                let widths = params.epsilon * texel * std::f32::consts::SQRT_2.powf(levels[i].octave);
                let epsilon = if light.is_distant() {
                    DepthTolerance { slope: 0.0, m: widths }
                } else {
                    DepthTolerance { slope: widths, m: 0.0 }
                };
                // Starts from the GPU's source, so that differences do not accumulate.
                let source = levels[i].source;
                let want = cpu::filter(&levels[source], &lists_of(source), &levels[i], epsilon, by_count);
                let got = lists_of(i);
                let differing = want.iter().zip(&got).filter(|(want, got)| !agree(want, got, 1e-3)).count();
                // A fragment exactly at distance ε may fall on either side.
                assert!(differing * 200 <= want.len(), "{name}, level {i}: {differing} of {} lists differ", want.len());
            }
        }
    }
}

/// Opacities in adjoining texels add up, and opacities behind one another count once, at any depth of the hierarchy.
#[test]
fn merged_lists_know_what_their_fragments_have_in_common() {
    let opaque = |z_m: f32| ReferenceFragment { z_m, opacity: 1.0, overlap: 1.0 };
    let [none, near, far] = [&[][..], &[opaque(1.0)], &[opaque(3.0)]];
    let both = &[opaque(1.0), opaque(3.0)][..];
    for (what, lists, overlaps, total) in [
        ("a slanted wall", [near, &[opaque(2.0)], far, &[opaque(4.0)]], &[1.0, 0.0, 0.0, 0.0][..], 1.0),
        ("one behind another", [both, both, none, none], &[1.0, 2.0], 0.5),
        ("beside one another", [near, near, far, far], &[1.0, 0.0], 1.0),
        ("half behind", [both, near, far, none], &[1.0, 1.0], 0.75),
    ] {
        let epsilon = DepthTolerance { slope: 0.0, m: 0.1 };
        let merged = cpu::merge(lists, epsilon, f32::MAX, false);
        let found: Vec<f32> = merged.iter().map(|fragment| fragment.overlap).collect();
        assert_eq!(found, overlaps, "{what}");
        let hidden = merged.iter().fold(0.0, |sum, one| cpu::accumulated(sum, one.opacity, one.overlap));
        assert!((hidden - total).abs() < 1e-6, "{what}: {hidden} of the light is hidden, and {total} is");
    }
}

#[test]
fn squares_know_their_nearest_fragment() {
    let Some(gpu) = gpu() else { return };
    for (name, light, meshes) in scenes() {
        // Not a multiple of any square's side.
        let params = MultiLayerParams { map_size: MapSize::Texels(84), ..MultiLayerParams::default() };
        let mut technique = MultiLayer::new(gpu).expect("default limits");
        (technique.room.capacity, technique.room.map_size) = (1 << 20, 84);
        let prepared = record(gpu, &mut technique, &light, &meshes, &params);
        let fragments: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists.fragments);
        let entries: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists.lists);
        let mut depths: Vec<f32> = read_storage(gpu, &prepared.nearest.depths);
        depths.truncate(technique.nearest.made as usize);
        let map_size = prepared.levels[0].size;
        let nearest_in = |texel: UVec2| {
            let [first, count] = entries[(texel.y * map_size.x + texel.x) as usize];
            let depths = fragments[first as usize..][..count as usize].iter().map(|[z, _]| f32::from_bits(*z));
            depths.fold(3e38, f32::min)
        };
        let mut empty = 0;
        let made = all_squares(map_size).into_iter().take_while(|squares| (squares.first as usize) < depths.len());
        for squares in made {
            let mut want = vec![3e38f32; squares.count.element_product() as usize];
            for (x, y) in (0..map_size.y).flat_map(|y| (0..map_size.x).map(move |x| (x, y))) {
                let square = (y >> squares.shift) * squares.count.x + (x >> squares.shift);
                want[square as usize] = want[square as usize].min(nearest_in(UVec2::new(x, y)));
            }
            let got = &depths[squares.first as usize..][..want.len()];
            assert_eq!(got, want, "{name}, squares of {} texels", 1 << squares.shift);
            empty += want.iter().filter(|z_m| **z_m == 3e38).count();
        }
        assert!(depths.len() > 500 && empty < depths.len(), "{name}: {empty} of {}", depths.len());
    }
}

#[test]
fn two_squares_a_side_hold_what_is_within_reach() {
    for map_size in [UVec2::new(1408, 736), UVec2::new(84, 84), UVec2::new(16, 64), UVec2::splat(4096)] {
        let all = all_squares(map_size);
        for reach in [0.5, 1.5, 2.0, 26.0, 300.0, 1e4] {
            let squares = squares_for(&all, reach);
            let side = (1u32 << squares.shift) as f32;
            assert!(squares.count == UVec2::ONE || (side >= 2.0 * reach && side < 4.0 * reach.max(2.0)), "{reach}");
        }
        for (squares, next) in all.iter().zip(&all[1..]) {
            assert_eq!(next.first, squares.first + squares.count.element_product());
        }
    }
}

#[test]
fn a_frame_without_room_says_so_and_the_next_has_it() {
    let Some(gpu) = gpu() else { return };
    let (_, light, meshes) = scenes().swap_remove(2);
    let params = MultiLayerParams { map_size: MapSize::Texels(96), ..MultiLayerParams::default() };
    let mut technique = MultiLayer::new(gpu).expect("default limits");
    (technique.room.capacity, technique.room.map_size) = (10_000, 96);
    let mut overflows = Vec::new();
    let mut counters = Vec::new();
    for _ in 0..6 {
        let prepared = record(gpu, &mut technique, &light, &meshes, &params);
        overflows.extend(technique.overflow());
        counters = read_storage::<u32>(gpu, &prepared.lists.counters);
    }
    assert!(!overflows.is_empty() && overflows.len() < 5, "{overflows:?}");
    assert!(overflows.iter().all(|overflow| overflow.needed > overflow.had));
    assert_eq!(technique.overflow(), None, "there is room at last");
    assert!(counters[1] <= technique.room.capacity);
}

#[test]
fn lights_act_as_squares_of_the_same_variance() {
    let extent = |shape| light_extent(&Light::new(shape, Vec3::Y, Vec3::ZERO));
    assert_eq!(extent(LightShape::Rectangle { size_m: Vec2::new(1.0, 2.0) }), Vec2::new(1.0, 2.0));
    assert!((extent(LightShape::Disk { radius_m: 1.0 }).x - 3f32.sqrt()).abs() < 1e-6);
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| Vec3::new(x, 1.0, z));
    assert!((extent(LightShape::Points { positions_m: corners.to_vec() }).x - 12f32.sqrt()).abs() < 1e-6);
}

#[test]
fn umbrae_of_half_transparent_occluders_have_their_transmittance() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let half = Opacity::Translucent { coverage: SurfaceCoverage::Alpha(0.5), transmitted: Vec3::ZERO, texture: None };
    // A sheet transmits half of the light; each face of a solid stops half.
    let solid = TestMesh::boxed(Vec3::new(-4.0, 1.5, -4.0), Vec3::new(0.0, 1.6, 4.0), 0.5);
    let on_gpu = Mesh::new(gpu, &solid.positions, &solid.indices);
    let ground = case.meshes[0].caster();
    let sheet = MeshCaster { opacity: half, ..case.meshes[1].caster() };
    let solid = MeshCaster { opacity: half, ..solid.caster(&on_gpu) };
    for (occluder, transmittance) in [(sheet, 0.5), (solid, 0.25)] {
        let casters = [ground, occluder];
        let mask = case.run_with(gpu, TechniqueKind::MultiLayer, &[], Casters::Meshes(&casters)).expect("a good frame");
        // Away from the edge, where the solid's side, unseen from the light's centre, would matter.
        let umbra = case.ground_pixels(|p| test_ground(p) && half_plane_visibility(p.x, 1.6) == 0.0);
        assert!(umbra.len() > 50);
        for (i, p) in umbra {
            assert!((mask[i] - transmittance).abs() < 0.01, "{transmittance} at {p}: {}", mask[i]);
        }
    }
}

/// A light with one dark half casts like its other half.
#[test]
fn emission_counts_by_its_mean_and_variance() {
    let Some(gpu) = gpu() else { return };
    let size_m = Vec2::new(1.2, 0.6);
    let whole = Case::half_plane(gpu, LightShape::Rectangle { size_m });
    let frame = whole.light.frame();
    let half_dark = antumbra_light::EmissionTexture::gray(2, 1, vec![1.0, 0.0]);
    let mut half_lit = Case::half_plane(gpu, LightShape::Rectangle { size_m });
    half_lit.light.emission = Some(half_dark);
    let mut half = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::new(0.5 * size_m.x, size_m.y) });
    half.light.center -= 0.25 * size_m.x * frame.right;
    let [whole, half_lit, half] =
        [&whole, &half_lit, &half].map(|case| case.run(gpu, TechniqueKind::MultiLayer, &[("map_size", "256")]));
    let off = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>() / a.len() as f32;
    assert!(off(&whole, &half) > 0.01, "nothing to tell: {}", off(&whole, &half));
    assert!(off(&half_lit, &half) < 0.001, "{}", off(&half_lit, &half));
}
