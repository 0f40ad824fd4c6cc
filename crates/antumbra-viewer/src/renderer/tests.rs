//! Tests of the renderer on the default adapter, without a window.

use antumbra::contract::{MaskChannels, ParamSpec, ParamValue};
use antumbra::{Quality, TechniqueKind};
use antumbra_host_tests::device::Device;
use antumbra_light::LightShape;
use antumbra_scene::{Instance, LoadOptions, Material, Mesh, Scene, Setup, load};
use glam::Vec3;

use super::drawing::SETTLING_FRAMES;
use super::*;
use crate::device::device_descriptor;
use crate::state::{ShapeKind, Show};

const SIZE: UVec2 = UVec2::new(64, 64);

/// Creates a device; `None` and a message if this machine has no adapter and none is required.
fn gpu_or_skip() -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) else {
        antumbra_testing::skip_without_adapter();
        return None;
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&device_descriptor(&adapter))).unwrap();
    Some(Gpu::new(&device, &queue))
}

/// Creates a renderer with an open scene; it compiles before `draw` returns.
fn fixture(spec: &str) -> Option<(Renderer, State)> {
    let gpu = gpu_or_skip()?;
    let scene = load(spec, &LoadOptions::default()).unwrap();
    let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
    state.open(spec, &scene, None);
    let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
    renderer.open(&scene, state.scene.as_ref().unwrap().generation);
    Some((renderer, state))
}

/// Draws until no work is left. Returns the number of frames.
fn settle(renderer: &mut Renderer, state: &State) -> u32 {
    for frame in 1..200 {
        let drawn = renderer.draw(state, SIZE, None);
        assert_eq!(renderer.take_error(), None);
        if !drawn.is_unfinished {
            return frame;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    panic!("the image does not become still");
}

fn picture(renderer: &mut Renderer) -> Vec<u8> {
    read(renderer).bytes
}

/// Reads the output image and waits for it.
fn read(renderer: &mut Renderer) -> Texels {
    renderer.read_output().unwrap();
    renderer.gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
    renderer.take_output().unwrap()
}

/// Mean of the image's red, green and blue, 0 to 255.
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
    // Moving the divider draws no shadow; moving the light does.
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

/// A static image is antialiased: closer to the downsampled larger image than samples at pixel centres are, and unchanged within surfaces.
#[test]
fn what_stands_still_is_smooth() {
    const LARGER: u32 = 8;
    let Some((mut renderer, state)) = fixture("builtin:overlap") else { return };
    settle(&mut renderer, &state);
    let smooth = picture(&mut renderer);
    renderer.view.as_mut().unwrap().smoothed = None;
    renderer.draw(&state, SIZE, None);
    let sharp = picture(&mut renderer);
    let Some((mut larger, state)) = fixture("builtin:overlap") else { return };
    for _ in 0..=SETTLING_FRAMES {
        larger.draw(&state, LARGER * SIZE, None);
    }
    let larger = picture(&mut larger);
    let linear = antumbra_scene::linear_from_srgb;
    let mean_at = |pixel: UVec2, channel: usize| {
        let within = (0..LARGER * LARGER).map(|i| LARGER * pixel + UVec2::new(i % LARGER, i / LARGER));
        let at = |p: UVec2| linear(larger[4 * (p.y * LARGER * SIZE.x + p.x) as usize + channel]);
        within.map(at).sum::<f32>() / (LARGER * LARGER) as f32
    };
    let (mut squares, mut unchanged) = ([0.0; 2], 0);
    for i in 0..SIZE.element_product() {
        let pixel = UVec2::new(i % SIZE.x, i / SIZE.x);
        let differs = |channel: usize| smooth[4 * i as usize + channel].abs_diff(sharp[4 * i as usize + channel]) > 1;
        unchanged += u32::from(!(0..3).any(differs));
        for channel in 0..3 {
            let mean = mean_at(pixel, channel);
            for (sum, bytes) in squares.iter_mut().zip([&smooth, &sharp]) {
                *sum += (linear(bytes[4 * i as usize + channel]) - mean).powi(2);
            }
        }
    }
    let [smooth, sharp] = squares.map(|sum: f32| (sum / (3 * SIZE.element_product()) as f32).sqrt());
    println!("rmse {smooth:.4} antialiased, {sharp:.4} not; {unchanged} pixels unchanged");
    assert!(smooth < 0.6 * sharp, "{smooth} and {sharp}");
    assert!(unchanged > SIZE.element_product() / 2 && unchanged < SIZE.element_product(), "{unchanged} pixels");
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
    // The left half shows one technique, the right half the other.
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

/// *Shaded* uses ratio masks; other views and the inspector use visibility.
#[test]
fn pictures_have_ratios_and_other_views_have_visibility() {
    let Some((mut renderer, mut state)) = fixture("builtin:hall") else { return };
    state.sides[0].set_kind(TechniqueKind::RayTraced);
    state.sides[0].set("samples", "16");
    let mut mask_of = |show, pointer_px| {
        state.show = show;
        renderer.inspect(pointer_px);
        settle(&mut renderer, &state);
        renderer.read_masks(&state);
        settle(&mut renderer, &state);
        renderer.take_mask(0, 0).unwrap().1
    };
    let shaded = mask_of(Show::Shaded, None);
    let visibility = mask_of(Show::Visibility, None);
    let apart = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart(&shaded, &visibility) > 0.02, "{}", apart(&shaded, &visibility));
    // Masks of three channels are half floats.
    assert!(apart(&mask_of(Show::Shaded, Some(UVec2::new(20, 30))), &visibility) < 1e-3);
    assert!(apart(&mask_of(Show::Shaded, None), &shaded) < 1e-6);
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

/// Values at both ends of a parameter's range, and all choices; only the default of a list.
fn ends(spec: &ParamSpec) -> Vec<String> {
    let numbers = spec.range.map(|(low, high)| [(low as f32).to_string(), (high as f32).to_string()]);
    let names = spec.choices.iter().map(|choice| (*choice).to_owned());
    match spec.default {
        ParamValue::Bool(_) => vec!["true".into(), "false".into()],
        ParamValue::List(_) => vec![spec.default.to_string()],
        _ => numbers.into_iter().flatten().chain(names).collect(),
    }
}

/// Runs on a device that validates but does not draw.
#[test]
fn every_parameter_goes_to_both_ends() {
    set_parameters_to_both_ends(&Device::idle().gpu);
}

/// Runs on an adapter, so the driver compiles each variant, too.
#[test]
#[ignore = "long"]
fn every_parameter_goes_to_both_ends_on_an_adapter() {
    let Some(gpu) = gpu_or_skip() else { return };
    set_parameters_to_both_ends(&gpu);
}

/// Both ends of every parameter of every technique are accepted, or refused with a message if memory is short: no panic, no
/// device error. Frames are prepared and recorded but not drawn, which would take a software device hours.
fn set_parameters_to_both_ends(gpu: &Gpu) {
    let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
    let (mut count, mut refused) = (0, 0);
    for &kind in TechniqueKind::ALL {
        let mut state = State::new(kind, TechniqueKind::Hard);
        state.open("builtin:overlap", &scene, None);
        state.sides[0].set_quality(Quality::Fast);
        let mut renderer = Renderer::new(gpu, Compile::AtOnce);
        renderer.open(&scene, 1);
        renderer.draw(&state, SIZE, None);
        for spec in kind.param_specs() {
            for text in ends(spec) {
                state.sides[0].set(spec.key, &text);
                assert_eq!(state.sides[0].refusal(spec.key), None, "{kind}: {} = {text}", spec.key);
                if let Err(why) = renderer.record_only(&state) {
                    assert!(
                        why.contains("out of memory") || why.contains(kind.name()),
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
        // Resetting the parameters clears the error.
        renderer.draw(&state, SIZE, None);
        assert_eq!((renderer.sides[0].problem(), renderer.take_error()), (None, None), "{kind}");
    }
    assert!(count > 200 && refused < count / 10, "{refused} of {count} refused");
}

/// A built-in scene in which a vertex rises and an instance moves sideways over time.
fn flapping(time_s: f32) -> Scene {
    let mut scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
    scene.meshes[1].positions[0].y += 0.4 * time_s;
    scene.instances[1].world_from_object.w_axis.x += 0.3 * time_s;
    scene
}

#[test]
fn a_scene_at_another_time_is_what_it_is_when_opened_then() {
    let Some(gpu) = gpu_or_skip() else { return };
    // Techniques with data from earlier frames: maps, lists per texel and of receivers, triangles.
    for kind in [
        TechniqueKind::Pcss,
        TechniqueKind::MultiView,
        TechniqueKind::AliasFree,
        TechniqueKind::MultiLayer,
        TechniqueKind::RayTraced,
    ] {
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
        // The posed scene is static, so it is not drawn again.
        let version = renderer.version();
        assert_eq!(renderer.draw(&state, SIZE, None), Drawn::default(), "{kind}");
        assert_eq!(renderer.version(), version, "{kind}");
    }
}

#[test]
fn an_instance_that_disappears_and_returns_restores_the_image() {
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

/// A board 1 m below a square light, and a floor 3 m below it.
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
    // One technique with many maps, lists or layers represents the others, which are slow on software devices.
    let others = ["multi_view", "reprojection", "reprojection_layered", "ray_traced", "alias_free", "sample_based"];
    for &kind in TechniqueKind::ALL.iter().filter(|kind| !others.contains(&kind.name())) {
        let mut state = State::new(kind, TechniqueKind::Hard);
        state.sides[0].set_quality(Quality::Fast);
        state.sides[0].set("map_size", "256");
        state.open("board", &scene, Some(setup.clone()));
        state.show = Show::LightMap;
        let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
        renderer.open(&scene, 1);
        // One frame suffices: later ones use the same light.
        renderer.draw(&state, SIZE, None);
        assert_eq!((renderer.take_error(), renderer.sides[0].problem()), (None, None), "{kind}");
        let maps = renderer.sides[0].drawn_maps(0);
        let line = renderer.sides[0].map_line(0, 0, 0).unwrap();
        assert_eq!(line.contains("no shadow map"), maps.is_empty(), "{line}");
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
    // A light among the casters is split into parts, each with a map.
    let mut state = State::new(TechniqueKind::Hard, TechniqueKind::Hard);
    state.open("board", &scene, Some(setup.clone()));
    state.setup.lights[0].shape = LightShape::Sphere { radius_m: 0.1 };
    state.setup.lights[0].center = Vec3::new(0.0, 1.0, 0.0);
    state.show = Show::LightMap;
    let mut renderer = Renderer::new(&gpu, Compile::AtOnce);
    renderer.open(&scene, 1);
    renderer.draw(&state, SIZE, None);
    let (maps, line) = (renderer.sides[0].drawn_maps(0), renderer.sides[0].map_line(0, 0, 0).unwrap());
    assert!(maps.len() > 1 && line.contains(&format!("{} maps", maps.len())), "{line}");
    assert!(maps.iter().enumerate().all(|(i, map)| maps[..i].iter().all(|other| other.depth != map.depth)));
    assert_eq!(renderer.take_error(), None);
    assert_eq!(with_map, 19, "seven of one map, six that are filtered, six that are summed");
}

/// Scrolling through the techniques ends with the last one drawn, and few abandoned compilations.
#[test]
fn techniques_that_are_passed_by_do_not_pile_up() {
    let Some((renderer, mut state)) = fixture("builtin:overlap") else { return };
    let mut renderer = Renderer { compile: Compile::Background(Arc::new(|| ())), ..renderer };
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

/// Shows the lists of a technique on the board and the floor.
fn lists_of(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)], level: usize) -> (Renderer, State) {
    let (scene, setup) = board_over_floor();
    let mut state = State::new(kind, TechniqueKind::Hard);
    state.sides[0].set_quality(Quality::Fast);
    for (key, value) in settings {
        state.sides[0].set(key, value);
        assert_eq!(state.sides[0].refusal(key), None);
    }
    state.open("board", &scene, Some(setup));
    (state.show, state.level) = (Show::Lists, level);
    let mut renderer = Renderer::new(gpu, Compile::AtOnce);
    renderer.open(&scene, 1);
    settle(&mut renderer, &state);
    assert_eq!(renderer.sides[0].problem(), None, "{kind}");
    (renderer, state)
}

/// Fraction of the image's pixels that have this colour.
fn share_of(bytes: &[u8], color: [u8; 3]) -> f64 {
    let is_near = |texel: &&[u8]| texel.iter().zip(color).all(|(a, b)| a.abs_diff(b) <= 2);
    bytes.chunks_exact(4).map(|texel| &texel[..3]).filter(is_near).count() as f64 / (bytes.len() / 4) as f64
}

/// Colours of a list of length 1 and of the longest: both ends of the shader's ramp.
const LEAST: [u8; 3] = [51, 18, 107];
const MOST: [u8; 3] = [255, 245, 158];

#[test]
fn every_receiver_is_in_a_list() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (scene, setup) = board_over_floor();
    let receivers = antumbra_reference::Tracer::new(&scene).unwrap().primary(&setup.camera, SIZE);
    let pixels = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y)));
    // All visible surfaces face the light.
    let seen = pixels.filter(|(x, y)| receivers.at(*x, *y).is_some()).count() as u32;
    for (kind, traversal) in [
        (TechniqueKind::AliasFree, "groups"),
        (TechniqueKind::AliasFree, "raster"),
        (TechniqueKind::SampleBased, "groups"),
    ] {
        let (mut renderer, _) = lists_of(&gpu, kind, &[("map_size", "32"), ("traversal", traversal)], 0);
        let [longest, sum] = renderer.sides[0].list_totals().expect("they were counted");
        let line = renderer.sides[0].lists_line(0, 0).unwrap();
        // The tolerance is for pixels where a ray hits an edge and the rasteriser does not.
        assert!(seen > 1000 && sum.abs_diff(seen) <= 8, "{seen} receivers are seen; {line}");
        assert!(longest > 1 && line.contains("32 × 32 lists of receivers"), "{line}");
        assert!(
            !line.contains("level") && line.contains(&format!("the longest list, in yellow, has {longest}")),
            "{line}"
        );
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
    // The board hides (0.2 / 1)² / (1 / 3)² of the floor from the light: the fraction of lists with two entries.
    let bytes = picture(&mut renderer);
    let (once, twice) = (share_of(&bytes, LEAST), share_of(&bytes, MOST));
    let expected = 0.2f64.powi(2) * 9.0;
    assert!((twice / (once + twice) - expected).abs() < 0.03, "{once} once, {twice} twice; {line}");
    // Texels along the edges hold fragments of both surfaces.
    let lists = f64::from(sum) / (1.0 + expected);
    let texels = renderer.sides[0].drawn_lists(0)[0].levels[0].size_texels.as_dvec2();
    assert!(lists > 0.5 * texels.element_product() && lists < 1.02 * texels.element_product(), "{line}");
    // Each list of the next level merges four lists; an index past the coarsest level selects that one.
    state.level = 1;
    settle(&mut renderer, &state);
    let [_, merged] = renderer.sides[0].list_totals().expect("they were counted");
    let line = renderer.sides[0].lists_line(0, 1).unwrap();
    assert!(merged > 0 && merged < sum && line.contains(&format!("level 2 of {levels}")), "{line}");
    assert_ne!(picture(&mut renderer), bytes);
    state.level = 99;
    settle(&mut renderer, &state);
    let line = renderer.sides[0].lists_line(0, 99).unwrap();
    assert!(line.contains(&format!("level {levels} of {levels}")), "{line}");
    // Other techniques keep no lists.
    let (renderer, _) = lists_of(&gpu, TechniqueKind::Hard, &[], 0);
    assert_eq!((renderer.sides[0].list_totals(), renderer.sides[0].list_levels(0)), (None, 0));
    assert!(renderer.sides[0].lists_line(0, 0).unwrap().contains("has no lists"));
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
        // The next frame takes the reading.
        renderer.draw(&state, SIZE, None);
        let inspected = renderer.inspected().unwrap();
        let traced = receivers.at(pixel.x, pixel.y);
        assert_eq!(inspected.surface.is_some(), traced.is_some(), "{pixel}");
        let (Some(surface), Some(traced)) = (inspected.surface, traced) else { continue };
        surfaces += 1;
        assert!(surface.position.unwrap().distance(traced.position) < 1e-3, "{pixel}");
        assert!(surface.normal.distance(Vec3::Y) < 1e-5, "{pixel}");
        assert!(surface.base_color.truncate().distance(Vec3::new(0.25, 0.5, 0.75)) < 0.01, "{pixel}: {surface:?}");
        let place = (pixel.y * SIZE.x + pixel.x) as usize;
        assert_eq!(inspected.visibilities, [Some(masks[0][place]), Some(masks[1][place])], "{pixel}");
        shades.insert((100.0 * masks[0][place]) as u32);
    }
    assert!(surfaces > 20 && shades.len() > 1, "{surfaces} surfaces, {shades:?}");
    // Without an inspected pixel nothing is read.
    renderer.inspect(None);
    assert_eq!(renderer.inspected(), None);
}

/// Reads a mip level of a texture's layer as 32-bit words, row by row, with its size.
fn words_of(gpu: &Gpu, texture: &wgpu::Texture, mip_level: u32, slice: u32) -> (Vec<u32>, UVec2) {
    let size = UVec2::new(texture.width() >> mip_level, texture.height() >> mip_level).max(UVec2::ONE);
    let texel_bytes = if texture.format() == wgpu::TextureFormat::Rg32Float { 8 } else { 4 };
    let row_bytes = (size.x * texel_bytes).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let copy = |encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer| {
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                mip_level,
                origin: wgpu::Origin3d { x: 0, y: 0, z: slice },
                ..texture.as_image_copy()
            },
            wgpu::TexelCopyBufferInfo {
                buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None },
            },
            wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        );
    };
    let rows = read_words(gpu, u64::from(row_bytes * size.y), copy);
    let row_words = (size.x * texel_bytes / 4) as usize;
    (rows.chunks_exact(row_bytes as usize / 4).flat_map(|row| row[..row_words].to_vec()).collect(), size)
}

/// Returns the words that commands copy into a buffer of `size` bytes.
fn read_words(gpu: &Gpu, size: u64, copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer)) -> Vec<u32> {
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    copy(&mut encoder, &buffer);
    gpu.queue().submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let mapped = buffer.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&mapped)
}

/// Compares the map in the image with the expected colours of its texels. Either texel is right for a pixel on their border.
fn assert_shown(bytes: &[u8], size: UVec2, what: &str, color: impl Fn(UVec2) -> [u8; 3]) {
    let (corners, side) = light_map::places(1, SIZE.as_vec2());
    let (corner, side) = (corners[0].as_uvec2(), side as u32);
    assert!(side > 32, "{what}: hardly anything is shown");
    for at in (0..side * side).map(|i| UVec2::new(i % side, i / side)) {
        let place = (at.as_dvec2() + 0.5) / f64::from(side) * size.as_dvec2();
        let texels = [-1e-3, 1e-3].map(|off| (place + off).max(glam::DVec2::ZERO).as_uvec2().min(size - 1));
        let pixel = corner + at;
        let first = 4 * (pixel.y * SIZE.x + pixel.x) as usize;
        let had = &bytes[first..first + 3];
        let corners = [0, 1, 2, 3].map(|i: usize| UVec2::new(texels[i % 2].x, texels[i / 2].y));
        let is_near = |texel: UVec2| had.iter().zip(color(texel)).all(|(a, b)| a.abs_diff(b) <= 1);
        assert!(corners.into_iter().any(is_near), "{what}: {had:?} at {at}, {:?} expected", color(texels[0]));
    }
}

/// Converts a finite IEEE 754 binary16 number.
fn float_from_half(bits: u32) -> f32 {
    let (exponent, fraction) = (bits >> 10 & 31, (bits & 1023) as f32);
    let size = if exponent == 0 {
        fraction / 16_777_216.0
    } else {
        (1.0 + fraction / 1024.0) * (exponent as f32 - 15.0).exp2()
    };
    if bits & 0x8000 == 0 { size } else { -size }
}

fn shown_map_of(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)]) -> (Renderer, State) {
    let (renderer, mut state) = lists_of(gpu, kind, settings, 0);
    state.show = Show::LightMap;
    (renderer, state)
}

/// Grey value of a distance in a map.
fn grey_of(map: &antumbra::DrawnMap, distance_m: f32) -> u8 {
    let [nearest_m, farthest_m] = map.range_m;
    let far = ((distance_m - nearest_m) / (farthest_m - nearest_m)).clamp(0.0, 1.0);
    (255.0 * (1.0 + (light_map::DARKEST - 1.0) * far)).round() as u8
}

/// Colour of a depth in a map without a warp.
fn color_of(map: &antumbra::DrawnMap, depth: f32) -> [u8; 3] {
    if depth == map.empty_depth {
        return NOT_JUDGED_COLOR;
    }
    let along = (depth - map.depth_offset) / map.depth_scale;
    [grey_of(map, if map.is_perspective { along.recip() } else { along }); 3]
}

#[test]
fn a_level_of_a_map_that_is_shown_is_what_that_level_holds() {
    use antumbra::contract::LevelTexels;
    let Some(gpu) = gpu_or_skip() else { return };
    let mut held = Vec::new();
    // A pyramid, and filtered maps of floats and of normalised integers.
    for (name, count) in [("pcss", 9), ("vsm", 10), ("esm", 10), ("convolution", 10)] {
        let kind = TechniqueKind::from_name(name).unwrap();
        let (mut renderer, mut state) = shown_map_of(&gpu, kind, &[("map_size", "256")]);
        // The offset keeps the board's edges off the texels' edges.
        state.setup.lights[0].center += Vec3::new(0.17, 0.0, 0.07);
        settle(&mut renderer, &state);
        let maps = renderer.sides[0].drawn_maps(0);
        assert_eq!(renderer.sides[0].map_choices(Show::LightMap, 0).levels, count, "{name}");
        let map = &maps[0];
        let (mut pictures, mut last) = (std::collections::BTreeSet::new(), Vec::new());
        for level in 1..count {
            state.level = level;
            settle(&mut renderer, &state);
            let line = renderer.sides[0].map_line(0, level, 0).unwrap();
            assert!(line.contains(&format!("level {} of {count}", level + 1)), "{line}");
            let shown = &map.levels[level - 1];
            // A pyramid's levels are mip levels; a filtered map's levels share one level of the texture.
            let texture = shown.view.texture();
            let (words, row) = words_of(&gpu, texture, (level as u32 - 1).min(texture.mip_level_count() - 1), 0);
            let size = shown.size_px;
            let at = |texel: UVec2| ((shown.origin_px.y + texel.y) * row.x + shown.origin_px.x + texel.x) as usize;
            let channel = |word: u32| match shown.texels {
                LevelTexels::Extremes | LevelTexels::Float32 => f32::from_bits(word),
                LevelTexels::Float16 => float_from_half(word & 0xffff),
                LevelTexels::Unorm16 => (word & 0xffff) as f32 / 65535.0,
                LevelTexels::Unorm8 => (word & 0xff) as f32 / 255.0,
            };
            let texels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
            let values =
                texels.filter(|_| shown.texels != LevelTexels::Extremes).map(|texel| channel(words[at(texel)]));
            let (least, greatest) = (values.clone().fold(f32::MAX, f32::min), values.fold(f32::MIN, f32::max));
            let bytes = picture(&mut renderer);
            assert_shown(&bytes, size, &line, |texel| match shown.texels {
                LevelTexels::Extremes => color_of(map, f32::from_bits(words[2 * at(texel) + 1])),
                _ => {
                    let part = (channel(words[at(texel)]) - least) / (greatest - least).max(1e-30);
                    [(255.0 * (1.0 + (light_map::DARKEST - 1.0) * part)).round() as u8; 3]
                }
            });
            pictures.insert(bytes.clone());
            last = bytes;
            held.push(shown.texels);
        }
        // Two levels that differ by less than a pixel may give equal images.
        assert!(pictures.len() > 4, "{name}: {} pictures of {count} levels", pictures.len());
        state.level = 99;
        settle(&mut renderer, &state);
        assert_eq!(picture(&mut renderer), last, "{name}: beyond the last it is the last");
    }
    assert!(held.contains(&LevelTexels::Extremes) && held.contains(&LevelTexels::Unorm8), "{held:?}");
}

#[test]
fn a_layer_behind_a_map_is_what_that_layer_holds() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (mut renderer, mut state) = shown_map_of(&gpu, TechniqueKind::Pcss, &[("map_size", "256"), ("layers", "3")]);
    assert_eq!(renderer.sides[0].map_choices(Show::LightMap, 0).layers, 3);
    let maps = renderer.sides[0].drawn_maps(0);
    let map = &maps[0];
    let middle = |bytes: &[u8]| bytes[4 * (32 * SIZE.x + 32) as usize];
    settle(&mut renderer, &state);
    assert!(middle(&picture(&mut renderer)).abs_diff(grey_of(map, 1.0)) <= 1, "the board hides the floor");
    for layer in 1..3 {
        state.layer = layer;
        settle(&mut renderer, &state);
        let line = renderer.sides[0].map_line(0, 0, layer).unwrap();
        assert!(line.contains(&format!("layer {} of 3", layer + 1)), "{line}");
        let (words, size) = words_of(&gpu, map.layers_behind[layer - 1].texture(), 0, layer as u32 - 1);
        let bytes = picture(&mut renderer);
        let depth = |texel: UVec2| f32::from_bits(words[(texel.y * size.x + texel.x) as usize]);
        assert_shown(&bytes, size, &line, |texel| color_of(map, depth(texel)));
        let expected = if layer == 1 { grey_of(map, 3.0) } else { NOT_JUDGED_COLOR[0] };
        assert!(middle(&bytes).abs_diff(expected) <= 1, "{line}: {} for {expected}", middle(&bytes));
    }
}

#[test]
fn maps_of_the_lights_points_are_chosen_from() {
    let Some(gpu) = gpu_or_skip() else { return };
    let settings = [("samples", "4"), ("view_size", "256")];
    let (mut renderer, mut state) = shown_map_of(&gpu, TechniqueKind::MultiView, &settings);
    assert_eq!(renderer.sides[0].map_choices(Show::LightMap, 0).points, 4);
    let mut pictures: Vec<Vec<u8>> = Vec::new();
    for point in 0..4 {
        state.layer = point;
        settle(&mut renderer, &state);
        let line = renderer.sides[0].map_line(0, 0, point).unwrap();
        assert!(line.contains(&format!("of light sample {}", point + 1)), "{line}");
        let maps = renderer.sides[0].shown_maps(0, 0, point);
        let [shown] = maps.as_slice() else { panic!("{} maps of one point", maps.len()) };
        let bytes = picture(&mut renderer);
        // The distances are right in a warped map, too.
        for (distance_m, least) in [(1.0, 20), (3.0, 200)] {
            let expected = grey_of(&shown.map, distance_m);
            let count = bytes.chunks_exact(4).filter(|texel| texel[0].abs_diff(expected) <= 1).count();
            assert!(count >= least, "{line}: {count} pixels at {distance_m} m, {:?}", shown.map);
        }
        assert!(pictures.iter().all(|other| *other != bytes), "{line}: as from another point");
        pictures.push(bytes);
    }
    // Maps of the reprojection techniques are buffers, as the line says; their central map has the layers to scatter.
    for (name, layers) in [("reprojection", 1), ("reprojection_layered", 2)] {
        let kind = TechniqueKind::from_name(name).unwrap();
        let (renderer, _) = shown_map_of(&gpu, kind, &[("samples", "4"), ("view_size", "64")]);
        let choices = renderer.sides[0].map_choices(Show::LightMap, 0);
        assert!(choices.layers >= layers && choices.points == 0, "{name}: {choices:?}");
        let line = renderer.sides[0].map_line(0, 0, 0).unwrap();
        assert!(line.contains("the maps of the light samples are not shown"), "{line}");
    }
}

#[test]
fn a_level_of_lists_that_is_shown_is_what_that_level_holds() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (mut renderer, mut state) = lists_of(&gpu, TechniqueKind::MultiLayer, &[("map_size", "128")], 0);
    let lists = renderer.sides[0].drawn_lists(0).remove(0);
    let words = read_words(&gpu, lists.words.size(), |encoder, buffer| {
        encoder.copy_buffer_to_buffer(&lists.words, 0, buffer, 0, lists.words.size());
    });
    let (mut sums, mut pictures) = (Vec::new(), std::collections::BTreeSet::new());
    for (level, of) in lists.levels.iter().enumerate() {
        state.level = level;
        settle(&mut renderer, &state);
        let size = of.size_texels;
        let length = |texel: UVec2| words[2 * (of.first + texel.y * size.x + texel.x) as usize + 1];
        let all = (0..size.element_product()).map(|i| length(UVec2::new(i % size.x, i / size.x)));
        let (longest, sum) = (all.clone().max().unwrap(), all.sum::<u32>());
        assert_eq!(renderer.sides[0].list_totals(), Some([longest, sum]), "level {level}");
        // The shader's ramp over the logarithm of the length.
        let ramp = |part: f32| {
            let ends = if part < 0.5 {
                [[0.20, 0.07, 0.42], [0.86, 0.30, 0.26]]
            } else {
                [[0.86, 0.30, 0.26], [1.0, 0.96, 0.62]]
            };
            let within = if part < 0.5 { 2.0 * part } else { 2.0 * part - 1.0 };
            [0, 1, 2].map(|i| (255.0 * (ends[0][i] + within * (ends[1][i] - ends[0][i]))).round() as u8)
        };
        let bytes = picture(&mut renderer);
        assert_shown(&bytes, size, &format!("level {level}"), |texel| match length(texel) {
            0 => NOT_JUDGED_COLOR,
            length if length == longest => ramp(1.0),
            length => ramp((length as f32).log2() / (longest.max(2) as f32).log2()),
        });
        pictures.insert(bytes);
        sums.push(sum);
    }
    assert!(pictures.len() > 4 && sums[0] > 2 * sums[1], "{} pictures, {sums:?}", pictures.len());
    assert!(sums.windows(2).all(|pair| pair[0] != pair[1]), "{sums:?}: two levels alike");
}
