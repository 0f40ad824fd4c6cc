//! The renderer on whatever adapter there is, without a window.

use antumbra::contract::{ParamSpec, ParamValue};
use antumbra::{Quality, TechniqueKind};
use antumbra_light::LightShape;
use antumbra_scene::{Instance, LoadOptions, Material, Mesh, Setup, load};

use super::*;
use crate::device::device_descriptor;
use crate::state::{ShapeKind, Show};

const SIZE: UVec2 = UVec2::new(64, 64);

/// A device of its own, or `None` and a word where this machine has none and none is required.
fn gpu_or_skip() -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) else {
        antumbra_testing::skip_without_adapter();
        return None;
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&device_descriptor(&adapter))).unwrap();
    Some(Gpu::new(&device, &queue))
}

/// A scene that is open, and a renderer that compiles at once.
fn fixture(spec: &str) -> Option<(Renderer, State)> {
    let gpu = gpu_or_skip()?;
    let scene = load(spec, &LoadOptions::default()).unwrap();
    let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
    state.open(spec, &scene, None);
    let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
    renderer.open(&scene, state.scene.as_ref().unwrap().generation);
    Some((renderer, state))
}

/// Draws until nothing is left to do; how often that took.
fn settle(renderer: &mut Renderer, state: &State) -> u32 {
    for frame in 1..200 {
        let drawn = renderer.draw(state, SIZE, None);
        assert_eq!(renderer.take_error(), None);
        if !drawn.is_unfinished {
            return frame;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    panic!("the picture never stands still");
}

fn picture(renderer: &mut Renderer) -> Vec<u8> {
    read(renderer).bytes
}

/// The picture, waited for.
fn read(renderer: &mut Renderer) -> Texels {
    renderer.read_output().unwrap();
    renderer.gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
    renderer.take_output().unwrap()
}

/// The mean of the picture's red, green and blue, 0 to 255.
fn mean(bytes: &[u8]) -> f64 {
    let colors = bytes.chunks_exact(4).flat_map(|texel| &texel[..3]);
    colors.map(|v| f64::from(*v)).sum::<f64>() / (bytes.len() / 4 * 3) as f64
}

#[test]
fn what_stands_still_is_not_drawn_again() {
    let Some((mut renderer, mut state)) = fixture("builtin:overlap") else { return };
    settle(&mut renderer, &state);
    let version = renderer.version();
    for _ in 0..5 {
        assert_eq!(renderer.draw(&state, SIZE, None), Drawn::default());
    }
    assert_eq!(renderer.version(), version);
    // The divider moves without a shadow drawn, the light with it.
    state.is_split = true;
    settle(&mut renderer, &state);
    let split = renderer.version();
    state.divider = 0.25;
    assert!(renderer.draw(&state, SIZE, None).is_new);
    assert_eq!(renderer.version(), split);
    state.setup.lights[0].center.x += 0.3;
    assert!(renderer.draw(&state, SIZE, None).is_new);
    assert!(renderer.version() > split);
}

#[test]
fn views_and_sides_show_what_they_say() {
    let Some((mut renderer, mut state)) = fixture("builtin:overlap") else { return };
    settle(&mut renderer, &state);
    let shaded = picture(&mut renderer);
    assert!(mean(&shaded) > 20.0 && mean(&shaded) < 235.0, "{}", mean(&shaded));
    state.show = Show::Visibility;
    settle(&mut renderer, &state);
    let soft = picture(&mut renderer);
    assert!(soft.chunks_exact(4).all(|texel| texel[0] == texel[1] && texel[1] == texel[2]), "no greys");
    assert!(soft.chunks_exact(4).any(|texel| texel[0] == 0) && soft.chunks_exact(4).any(|texel| texel[0] == 255));
    // Left of the divider is the one technique, right of it the other.
    state.is_split = true;
    settle(&mut renderer, &state);
    let split = picture(&mut renderer);
    let half = |bytes: &[u8], right: bool| -> Vec<u8> {
        let rows = bytes.chunks_exact(4 * SIZE.x as usize);
        rows.flat_map(|row| if right { &row[row.len() / 2..] } else { &row[..row.len() / 2] }).copied().collect()
    };
    assert_eq!(half(&split, false), half(&soft, false));
    assert_ne!(half(&split, true), half(&soft, true));
    assert!(half(&split, true).chunks_exact(4).all(|texel| texel[0] == 0 || texel[0] == 255), "not a hard shadow");
}

#[test]
fn the_error_view_is_of_the_truth() {
    let Some((mut renderer, mut state)) = fixture("builtin:overlap") else { return };
    state.show = Show::Error;
    settle(&mut renderer, &state);
    renderer.read_masks(&state);
    settle(&mut renderer, &state);
    let (version, mask) = renderer.take_mask(0, 0).unwrap();
    assert_eq!((version, mask.len()), (renderer.version(), 64 * 64));
    let estimate = Estimate { job: 1, size_px: SIZE, points: 16, values: mask.clone() };
    assert_eq!(estimate.rmse(&mask), Some(0.0));
    assert!(renderer.draw(&state, SIZE, Some(&estimate)).is_new);
    let white = ERROR_RAMP[5];
    assert!(picture(&mut renderer).chunks_exact(4).all(|texel| texel[..3] == white), "an error where there is none");
    let unjudged = Estimate { points: 32, values: vec![-1.0; mask.len()], ..estimate };
    assert_eq!(unjudged.rmse(&mask), None);
    assert!(renderer.draw(&state, SIZE, Some(&unjudged)).is_new);
    assert!(picture(&mut renderer).chunks_exact(4).all(|texel| texel[..3] == NOT_JUDGED_COLOR));
}

#[test]
fn lights_of_every_shape_and_another_size_are_drawn() {
    let Some((mut renderer, mut state)) = fixture("builtin:stained-glass") else { return };
    for shape in ShapeKind::ALL {
        shape.give_to(&mut state.setup.lights[0]);
        settle(&mut renderer, &state);
        assert_eq!(renderer.sides[0].problem(), None, "{}", shape.name());
    }
    state.add_light();
    settle(&mut renderer, &state);
    assert!(renderer.sides[0].mask(1).is_some_and(|mask| mask.channels() == MaskChannels::Three));
    state.remove_light();
    renderer.draw(&state, UVec2::new(33, 17), None);
    assert_eq!(read(&mut renderer).size_px, UVec2::new(33, 17));
    assert_eq!(renderer.take_error(), None);
}

/// What lies at either end of a parameter; a list is long, and then empty.
fn ends(spec: &ParamSpec) -> Vec<String> {
    match (spec.default, spec.range) {
        (ParamValue::U32(_), Some((low, high))) => vec![(low as u32).to_string(), (high as u32).to_string()],
        (ParamValue::F32(_), Some((low, high))) => vec![(low as f32).to_string(), (high as f32).to_string()],
        (ParamValue::Bool(_), _) => vec!["true".into(), "false".into()],
        (ParamValue::Choice(_), _) => spec.choices.iter().map(|choice| (*choice).to_owned()).collect(),
        _ => vec![spec.default.to_string()],
    }
}

/// Either end of every parameter of every technique is taken, or refused in words where this machine has no memory for
/// it: nothing panics, and the device has no complaint. Frames are prepared and recorded; drawing them would take a
/// software device hours.
#[test]
fn every_parameter_goes_to_both_ends() {
    let Some(gpu) = gpu_or_skip() else { return };
    let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
    let (mut count, mut refused) = (0, 0);
    for &kind in TechniqueKind::ALL {
        let mut state = State::new(kind, TechniqueKind::Hard);
        state.open("builtin:overlap", &scene, None);
        state.sides[0].set_quality(Quality::Fast);
        let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
        renderer.open(&scene, 1);
        renderer.draw(&state, SIZE, None);
        for spec in kind.param_specs() {
            for text in ends(spec) {
                state.sides[0].set(spec.key, &text);
                assert_eq!(state.sides[0].refusal(spec.key), None, "{kind}: {} = {text}", spec.key);
                if let Err(why) = renderer.record_only(&state) {
                    assert!(
                        why.contains("no memory") || why.contains(kind.name()),
                        "{kind}: {} = {text}: {why}",
                        spec.key
                    );
                    refused += 1;
                }
                assert_eq!(renderer.take_error(), None, "{kind}: {} = {text}", spec.key);
                count += 1;
            }
            state.sides[0].reset();
        }
        // What was refused is mended by going back.
        renderer.draw(&state, SIZE, None);
        assert_eq!((renderer.sides[0].problem(), renderer.take_error()), (None, None), "{kind}");
    }
    assert!(count > 200 && refused < count / 10, "{refused} of {count} refused");
}

/// A built-in scene of which a corner rises and one thing goes aside.
fn flapping(time_s: f32) -> Scene {
    let mut scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
    scene.meshes[1].positions[0].y += 0.4 * time_s;
    scene.instances[1].world_from_object.w_axis.x += 0.3 * time_s;
    scene
}

#[test]
fn a_scene_at_another_time_is_what_it_is_when_opened_then() {
    let Some(gpu) = gpu_or_skip() else { return };
    // What keeps anything of the frames before: maps, lists of texels and of receivers, triangles.
    for kind in [TechniqueKind::Pcss, TechniqueKind::MultiView, TechniqueKind::AliasFree, TechniqueKind::MultiLayer] {
        let mut state = State::new(kind, TechniqueKind::Hard);
        state.sides[0].set_quality(Quality::Fast);
        state.open("flapping", &flapping(0.0), None);
        let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
        renderer.open(&flapping(0.0), 1);
        settle(&mut renderer, &state);
        let first = picture(&mut renderer);
        renderer.pose(&flapping(0.0), &flapping(1.0));
        settle(&mut renderer, &state);
        renderer.expose();
        settle(&mut renderer, &state);
        let posed = picture(&mut renderer);
        assert_ne!(posed, first, "{kind}: nothing moves");
        let mut anew = Renderer::new(&gpu, Compile::AtOnce);
        anew.open(&flapping(1.0), 1);
        settle(&mut anew, &state);
        assert_eq!(posed, picture(&mut anew), "{kind}");
        // What stands still then is not drawn again.
        let version = renderer.version();
        assert_eq!(renderer.draw(&state, SIZE, None), Drawn::default(), "{kind}");
        assert_eq!(renderer.version(), version, "{kind}");
    }
}

#[test]
fn what_comes_and_goes_is_made_anew() {
    let Some((mut renderer, state)) = fixture("builtin:overlap") else { return };
    settle(&mut renderer, &state);
    let (all, mut fewer) = (flapping(0.0), flapping(0.0));
    fewer.instances.pop();
    let whole = picture(&mut renderer);
    renderer.pose(&all, &fewer);
    settle(&mut renderer, &state);
    assert_ne!(picture(&mut renderer), whole);
    renderer.pose(&fewer, &all);
    settle(&mut renderer, &state);
    assert_eq!(picture(&mut renderer), whole);
}

/// A board 1 m under a square light and a floor 3 m under it.
fn board_over_floor() -> (Scene, Setup) {
    let square = |half_side: f32, y: f32| {
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
        Mesh {
            positions: corners.map(|(x, z)| Vec3::new(half_side * x, y, half_side * z)).to_vec(),
            normals: vec![Vec3::Y; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Mesh::default()
        }
    };
    let placed = |mesh| Instance { mesh, world_from_object: glam::Mat4::IDENTITY };
    let material = Material { base_color: glam::Vec4::new(0.25, 0.5, 0.75, 1.0), ..Material::default() };
    let scene = Scene {
        meshes: vec![square(0.2, 2.0), square(1.0, 0.0)],
        materials: vec![material],
        instances: vec![placed(0), placed(1)],
        ..Scene::default()
    };
    let shape = LightShape::Rectangle { size_m: glam::Vec2::splat(0.1) };
    let light = Light::new(shape, Vec3::new(0.0, 3.0, 0.0), Vec3::ZERO);
    let mut setup = Setup::for_scene(&scene);
    setup.lights = vec![light];
    (setup.camera.eye, setup.camera.target) = (Vec3::new(0.0, 2.6, 1.9), Vec3::new(0.0, 0.0, 0.1));
    (scene, setup)
}

#[test]
fn light_maps_are_seen_as_the_light_sees() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (scene, setup) = board_over_floor();
    let mut with_map = 0;
    // Of those with many maps, lists or layers one stands for all: they take long on software devices.
    let others = ["multi_view", "reprojection", "reprojection_layered", "alias_free", "sample_based"];
    for &kind in TechniqueKind::ALL.iter().filter(|kind| !others.contains(&kind.name())) {
        let mut state = State::new(kind, TechniqueKind::Hard);
        state.sides[0].set_quality(Quality::Fast);
        state.sides[0].set("map_size", "256");
        state.open("board", &scene, Some(setup.clone()));
        state.show = Show::LightMap;
        let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
        renderer.open(&scene, 1);
        // Once is enough: what is drawn later is drawn from the same light.
        renderer.draw(&state, SIZE, None);
        assert_eq!((renderer.take_error(), renderer.sides[0].problem()), (None, None), "{kind}");
        let maps = renderer.sides[0].drawn_maps(0);
        let line = renderer.sides[0].map_line(0).unwrap();
        assert_eq!(line.contains("no single depth map"), maps.is_empty(), "{line}");
        let [map] = maps.as_slice() else {
            assert!(maps.is_empty());
            continue;
        };
        with_map += 1;
        let bytes = picture(&mut renderer);
        let grey = |x: u32, y: u32| bytes[4 * (y * SIZE.x + x) as usize];
        let [nearest_m, farthest_m] = map.range_m;
        let expected = |distance_m: f32| {
            let far = (distance_m - nearest_m) / (farthest_m - nearest_m);
            (255.0 * (1.0 + (light_map::DARKEST - 1.0) * far)).round() as u8
        };
        assert!(grey(32, 32).abs_diff(expected(1.0)) <= 1, "{kind}: {} for the board, {line}", grey(32, 32));
        let floors = bytes.chunks_exact(4).filter(|texel| texel[0].abs_diff(expected(3.0)) <= 1).count();
        assert!(floors > 200, "{kind}: {floors} texels of floor, {line}");
    }
    // A lamp in the middle of things is cut into parts, with a map each.
    let mut state = State::new(TechniqueKind::Hard, TechniqueKind::Hard);
    state.open("board", &scene, Some(setup.clone()));
    state.setup.lights[0].shape = LightShape::Sphere { radius_m: 0.1 };
    state.setup.lights[0].center = Vec3::new(0.0, 1.0, 0.0);
    state.show = Show::LightMap;
    let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
    renderer.open(&scene, 1);
    renderer.draw(&state, SIZE, None);
    let (maps, line) = (renderer.sides[0].drawn_maps(0), renderer.sides[0].map_line(0).unwrap());
    assert!(maps.len() > 1 && line.contains(&format!("{} maps", maps.len())), "{line}");
    assert!(maps.iter().enumerate().all(|(i, map)| maps[..i].iter().all(|other| other.depth != map.depth)));
    assert_eq!(renderer.take_error(), None);
    assert_eq!(with_map, 16, "four of one map, six that are filtered, six that are summed");
}

/// Whoever goes through the list of techniques gets the last one, and leaves few behind that compile.
#[test]
fn techniques_that_are_passed_by_do_not_pile_up() {
    let Some((renderer, mut state)) = fixture("builtin:overlap") else { return };
    let mut renderer = Renderer { compile: Compile::Aside(Arc::new(|| ())), ..renderer };
    let passed_by = ["hard", "pcf", "vsm", "esm", "evsm", "pcss"].map(|name| TechniqueKind::from_name(name).unwrap());
    let mut most = 0;
    for kind in passed_by {
        state.sides[0].set_kind(kind);
        assert!(renderer.draw(&state, SIZE, None).is_unfinished, "{kind}");
        most = most.max(renderer.sides[0].compilers());
    }
    assert!((1..=2).contains(&most), "{most} at a time");
    let began = web_time::Instant::now();
    while renderer.sides[0].kind() != Some(passed_by[5]) || renderer.draw(&state, SIZE, None).is_unfinished {
        renderer.draw(&state, SIZE, None);
        assert!(renderer.sides[0].compilers() <= 2);
        assert!(began.elapsed().as_secs() < 300, "the last one never comes");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    assert_eq!((renderer.take_error(), renderer.sides[0].problem()), (None, None));
}

/// Shows the lists of a technique over the board and the floor.
fn lists_of(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)], level: usize) -> (Renderer, State) {
    let (scene, setup) = board_over_floor();
    let mut state = State::new(kind, TechniqueKind::Hard);
    state.sides[0].set_quality(Quality::Fast);
    for (key, value) in settings {
        state.sides[0].set(key, value);
        assert_eq!(state.sides[0].refusal(key), None);
    }
    state.open("board", &scene, Some(setup));
    (state.show, state.list_level) = (Show::Lists, level);
    let mut renderer = Renderer::new(gpu, Compile::AtOnce);
    renderer.open(&scene, 1);
    settle(&mut renderer, &state);
    assert_eq!(renderer.sides[0].problem(), None, "{kind}");
    (renderer, state)
}

/// How much of the picture has this colour.
fn share_of(bytes: &[u8], color: [u8; 3]) -> f64 {
    let is_near = |texel: &&[u8]| texel.iter().zip(color).all(|(a, b)| a.abs_diff(b) <= 2);
    bytes.chunks_exact(4).map(|texel| &texel[..3]).filter(is_near).count() as f64 / (bytes.len() / 4) as f64
}

/// The colours of a list of one, and of the longest: both ends of the shader's ramp.
const LEAST: [u8; 3] = [51, 18, 107];
const MOST: [u8; 3] = [255, 245, 158];

#[test]
fn every_receiver_is_in_a_list() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (scene, setup) = board_over_floor();
    let receivers = antumbra_reference::Tracer::new(&scene).unwrap().primary(&setup.camera, SIZE);
    let pixels = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y)));
    // All that is seen faces the light.
    let seen = pixels.filter(|(x, y)| receivers.at(*x, *y).is_some()).count() as u32;
    for (kind, traversal) in [
        (TechniqueKind::AliasFree, "groups"),
        (TechniqueKind::AliasFree, "raster"),
        (TechniqueKind::SampleBased, "groups"),
    ] {
        let (mut renderer, _) = lists_of(&gpu, kind, &[("map_size", "32"), ("traversal", traversal)], 0);
        let [longest, sum] = renderer.sides[0].list_totals().expect("they were counted");
        let line = renderer.sides[0].lists_line(0, 0).unwrap();
        // Where a ray meets an edge, and a pixel's centre does not.
        assert!(seen > 1000 && sum.abs_diff(seen) <= 8, "{seen} receivers are seen; {line}");
        assert!(longest > 1 && line.contains("32 × 32 lists of receivers"), "{line}");
        assert!(!line.contains("level") && line.contains(&format!("at most {longest} in a list")), "{line}");
        let bytes = picture(&mut renderer);
        assert!(share_of(&bytes, MOST) > 0.0 && share_of(&bytes, LEAST) > 0.0, "{line}");
    }
}

#[test]
fn lists_are_as_long_as_the_light_sees_surfaces() {
    let Some(gpu) = gpu_or_skip() else { return };
    let settings = [("map_size", "256")];
    let (mut renderer, mut state) = lists_of(&gpu, TechniqueKind::MultiLayer, &settings, 0);
    let levels = renderer.sides[0].list_levels(0);
    let [longest, sum] = renderer.sides[0].list_totals().expect("they were counted");
    let line = renderer.sides[0].lists_line(0, 0).unwrap();
    assert!(levels > 1 && line.contains(&format!("lists of fragments, level 1 of {levels}")), "{line}");
    assert_eq!(longest, 2, "{line}");
    // The board hides (0.2 / 1)² / (1 / 3)² of the floor: so much of what is seen at all is seen twice.
    let bytes = picture(&mut renderer);
    let (once, twice) = (share_of(&bytes, LEAST), share_of(&bytes, MOST));
    let expected = 0.2f64.powi(2) * 9.0;
    assert!((twice / (once + twice) - expected).abs() < 0.03, "{once} once, {twice} twice; {line}");
    // Lists along the edges hold slivers of both.
    let lists = f64::from(sum) / (1.0 + expected);
    let texels = renderer.sides[0].drawn_lists(0)[0].levels[0].size_texels.as_dvec2();
    assert!(lists > 0.5 * texels.element_product() && lists < 1.02 * texels.element_product(), "{line}");
    // The next level is merged of four lists each; one that is not there is the coarsest that is.
    state.list_level = 1;
    settle(&mut renderer, &state);
    let [_, merged] = renderer.sides[0].list_totals().expect("they were counted");
    let line = renderer.sides[0].lists_line(0, 1).unwrap();
    assert!(merged > 0 && merged < sum && line.contains(&format!("level 2 of {levels}")), "{line}");
    assert_ne!(picture(&mut renderer), bytes);
    state.list_level = 99;
    settle(&mut renderer, &state);
    let line = renderer.sides[0].lists_line(0, 99).unwrap();
    assert!(line.contains(&format!("level {levels} of {levels}")), "{line}");
    // Others keep none.
    let (renderer, _) = lists_of(&gpu, TechniqueKind::Hard, &[], 0);
    assert_eq!((renderer.sides[0].list_totals(), renderer.sides[0].list_levels(0)), (None, 0));
    assert!(renderer.sides[0].lists_line(0, 0).unwrap().contains("keeps no lists"));
}

#[test]
fn a_pixel_is_what_rays_find_there() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (scene, setup) = board_over_floor();
    let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
    state.open("board", &scene, Some(setup.clone()));
    state.is_split = true;
    let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
    renderer.open(&scene, 1);
    settle(&mut renderer, &state);
    renderer.read_masks(&state);
    settle(&mut renderer, &state);
    let masks = [0, 1].map(|side| renderer.take_mask(side, 0).unwrap().1);
    let receivers = antumbra_reference::Tracer::new(&scene).unwrap().primary(&setup.camera, SIZE);
    let (mut surfaces, mut shades) = (0, std::collections::BTreeSet::new());
    for pixel in (0..8).flat_map(|x| (0..8).map(move |y| UVec2::new(8 * x + 3, 8 * y + 5))) {
        renderer.inspect(Some(pixel));
        assert_eq!(renderer.inspected(), None, "of another pixel");
        settle(&mut renderer, &state);
        // Taken with the next frame.
        renderer.draw(&state, SIZE, None);
        let inspected = renderer.inspected().unwrap();
        let traced = receivers.at(pixel.x, pixel.y);
        assert_eq!(inspected.surface.is_some(), traced.is_some(), "{pixel}");
        let (Some(surface), Some(traced)) = (inspected.surface, traced) else { continue };
        surfaces += 1;
        assert!(surface.position.unwrap().distance(traced.position) < 1e-3, "{pixel}");
        assert!(surface.normal.distance(Vec3::Y) < 1e-5, "{pixel}");
        assert!(surface.base_color.truncate().distance(Vec3::new(0.25, 0.5, 0.75)) < 0.01, "{pixel}");
        let place = (pixel.y * SIZE.x + pixel.x) as usize;
        assert_eq!(inspected.visibilities, [Some(masks[0][place]), Some(masks[1][place])], "{pixel}");
        shades.insert((100.0 * masks[0][place]) as u32);
    }
    assert!(surfaces > 20 && shades.len() > 1, "{surfaces} surfaces, {shades:?}");
    // Nothing is read where nothing is asked.
    renderer.inspect(None);
    assert_eq!(renderer.inspected(), None);
}
