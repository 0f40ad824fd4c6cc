//! Tests of the whole application without a window, fed with input events.

use antumbra::TechniqueKind;

use super::headless::{HeadlessError, Window, options};
use super::random_input::{RandomInput, things_to_open};
use super::*;
use crate::file_dialog::Purpose;
use crate::ui::Action;

/// Unwraps a result; `None` and a message if this machine has no adapter and none is required.
fn or_skip<T>(made: Result<T, HeadlessError>) -> Option<T> {
    match made {
        Ok(made) => Some(made),
        Err(HeadlessError::NoAdapter) => {
            antumbra_testing::skip_without_adapter();
            None
        }
        Err(error) => panic!("{error}"),
    }
}

impl Window {
    fn pictured(&mut self) -> Vec<u8> {
        self.settle();
        self.app.renderer.read_output().unwrap();
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        self.app.renderer.take_output().unwrap().bytes
    }
}

/// Animated scene of a walking figure; `None` without the folder of test scenes.
fn walker() -> Option<String> {
    let path = antumbra_testing::scenes_folder()?.join("cesium-man.glb");
    path.exists().then(|| path.display().to_string())
}

#[test]
fn a_scene_plays_stands_still_and_is_what_it_is_when_opened_then() {
    let Some(walker) = walker() else { return };
    let Some(mut window) = or_skip(Window::open(options(&walker))) else { return };
    let first = window.pictured();
    let open = window.app.state.scene.clone().unwrap();
    assert!(open.has_ground && window.app.message.0.contains("a ground plane was added"), "{:?}", window.app.message);
    window.key(egui::Key::Space);
    assert!(window.app.state.play.is_playing);
    let mut times = Vec::new();
    while window.app.state.play.time_s < 0.5 {
        window.frame(Vec::new());
        times.push(window.app.state.play.time_s);
        assert!(times.len() < 20_000, "time does not go by: {:?}", window.app.state.play);
    }
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]));
    window.key(egui::Key::Space);
    assert!(!window.app.state.play.is_playing && window.app.state.play.time_s > 0.3);
    // While paused, nothing is drawn.
    window.settle();
    let version = window.app.renderer.version();
    for _ in 0..5 {
        window.frame(Vec::new());
    }
    assert_eq!(window.app.renderer.version(), version);
    // A scene opened at that time looks the same.
    window.app.act(&window.ctx.clone(), Action::Expose);
    let (posed, time_s) = (window.pictured(), window.app.state.play.time_s);
    assert_ne!(posed, first, "nothing moves");
    let setup = window.app.state.setup.clone();
    let Some(mut other) = or_skip(Window::open(ViewerOptions { time_s, ..options(&walker) })) else { return };
    other.settle();
    other.app.state.setup = setup;
    other.settle();
    other.app.act(&other.ctx.clone(), Action::Expose);
    assert!(other.pictured() == posed, "at {time_s} s");
}

/// Panels round numbers for display only; showing them does not change the state.
#[test]
fn looking_changes_nothing() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    window.settle();
    let light = &mut window.app.state.setup.lights[0];
    (light.intensity, light.cone) =
        (9.123_456, Some(antumbra_light::Cone { inner_rad: 0.123_456, outer_rad: 0.654_321 }));
    crate::state::Angles { azimuth_rad: 0.123_456, elevation_rad: 1.234_567 }.give_to(light);
    window.app.state.setup.camera.fov_y_rad = 0.765_432;
    window.app.state.sides[0].set_kind(TechniqueKind::Pcss);
    window.app.state.sides[0].set("bias_scale", "1.2345678");
    window.size = egui::vec2(900.0, 1600.0);
    window.pixels_per_point = 0.5;
    let (setup, side) = (window.app.state.setup.clone(), window.app.state.sides[0].clone());
    assert!(side.settings().contains(&("bias_scale", "1.2345678".to_owned())));
    window.settle();
    assert_eq!((&window.app.state.setup, &window.app.state.sides[0]), (&setup, &side));
}

#[test]
fn a_dense_display_gets_all_its_pixels() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    window.settle();
    let plain = window.app.size_px;
    window.pixels_per_point = 2.0;
    window.settle();
    let dense = window.app.size_px;
    // Panels are laid out in whole pixels.
    assert!((dense.as_ivec2() - 2 * plain.as_ivec2()).abs().max_element() <= 2, "{dense} after {plain}");
    assert_eq!(window.pictured().len(), 4 * dense.element_product() as usize);
    // The inspected pixel is counted in pixels of the display.
    window.key(egui::Key::I);
    window.frame(vec![egui::Event::PointerMoved(egui::pos2(100.0, 250.0))]);
    window.settle();
    assert!(window.app.renderer.inspected().is_some_and(|inspected| inspected.pixel.x == 200));
}

/// Keyboard access without a pointer: Tab reaches every control in turn, Enter presses it, arrow keys move sliders.
#[test]
fn the_keyboard_reaches_every_control() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    // The window is tall enough for the whole panel, with few pixels of the image.
    window.size = egui::vec2(900.0, 1600.0);
    window.pixels_per_point = 0.5;
    window.settle();
    let mut reached = Vec::new();
    let mut moved = Vec::new();
    for _ in 0..200 {
        window.key(egui::Key::Tab);
        let Some(focused) = window.ctx.memory(|memory| memory.focused()) else { continue };
        if reached.contains(&focused) {
            break;
        }
        reached.push(focused);
        let before = (window.app.state.setup.lights.clone(), window.app.state.sides[0].clone());
        window.key(egui::Key::ArrowRight);
        let after = (window.app.state.setup.lights.clone(), window.app.state.sides[0].clone());
        if before != after {
            moved.push(focused);
        }
        // The arrow key may have moved the focus to a neighbour.
        window.ctx.memory_mut(|memory| memory.request_focus(focused));
    }
    println!("{} controls, of which arrows move {}", reached.len(), moved.len());
    assert!(reached.len() > 30, "{} controls", reached.len());
    assert!(moved.len() >= 4, "arrows move {} of them", moved.len());
    // The first control opens scenes.
    window.ctx.memory_mut(|memory| memory.request_focus(reached[0]));
    window.frame(Vec::new());
    window.key(egui::Key::Enter);
    window.frame(Vec::new());
    assert!(window.app.panels.open.is_open);
}

#[test]
fn keys_undo_and_redo() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    window.settle();
    let press = |window: &mut Window, key, modifiers| {
        let event = |pressed| egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        window.frame(vec![event(true), event(false)]);
    };
    // An edit becomes a step after a second without another; a frame counts as 1/60 s.
    let rest = |window: &mut Window| (0..90).for_each(|_| window.frame(Vec::new()));
    rest(&mut window);
    let first = window.app.state.sides[0].kind();
    window.app.state.sides[0].set_kind(TechniqueKind::Hard);
    rest(&mut window);
    let (command, both) = (egui::Modifiers::COMMAND, egui::Modifiers::COMMAND | egui::Modifiers::SHIFT);
    press(&mut window, egui::Key::Z, command);
    assert_eq!(window.app.state.sides[0].kind(), first);
    press(&mut window, egui::Key::Z, both);
    assert_eq!(window.app.state.sides[0].kind(), TechniqueKind::Hard);
    press(&mut window, egui::Key::Z, command);
    press(&mut window, egui::Key::Y, command);
    assert_eq!(window.app.state.sides[0].kind(), TechniqueKind::Hard);
    press(&mut window, egui::Key::Z, command);
    press(&mut window, egui::Key::Z, command);
    assert_eq!(window.app.state.sides[0].kind(), first, "there is nothing before the first");
}

#[test]
fn numbers_follow_the_pointer() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    window.settle();
    window.key(egui::Key::I);
    assert!(window.app.panels.is_inspecting);
    window.frame(vec![egui::Event::PointerMoved(egui::pos2(100.0, 250.0))]);
    window.settle();
    let inspected = window.app.renderer.inspected().expect("there is a number");
    assert!(inspected.surface.is_some_and(|surface| surface.position.is_some()));
    assert!(inspected.visibilities[0].is_some() && inspected.visibilities[1].is_none());
    window.frame(vec![egui::Event::PointerGone]);
    window.frame(Vec::new());
    assert_eq!(window.app.renderer.inspected(), None);
}

#[test]
fn another_window_goes_on_where_a_device_was_lost() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    window.settle();
    window.app.state.setup.camera.eye.x += 0.5;
    window.app.panels.is_side_shown = false;
    let before = window.pictured();
    window.device.destroy();
    for _ in 0..3 {
        window.frame(Vec::new());
    }
    let ended = window.outcome.lock().unwrap().take();
    let Some(Ended::Lost(why, kept)) = ended else { panic!("nobody noticed") };
    assert!(!why.is_empty() && !why.contains('\n'), "{why}");
    let of_kept = |ctx: &egui::Context, render_state, outcome| App::kept(ctx, render_state, *kept, outcome);
    let Some(mut other) = or_skip(Window::of(of_kept)) else { return };
    assert!(!other.app.panels.is_side_shown);
    // The new window is exposed for the moved camera, so the images differ slightly.
    other.settle();
    let after = other.pictured();
    assert_eq!(after.len(), before.len());
    let off = before.iter().zip(&after).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / before.len() as f64;
    assert!(off < 4.0, "{off} levels");
    assert!(other.app.message.0.contains("recreated"));
}

#[test]
fn a_system_without_a_dialog_is_told_of() {
    let Some(mut window) = or_skip(Window::open(options("builtin:overlap"))) else { return };
    window.settle();
    let before = window.app.state.scene.clone();
    window.app.act(&window.ctx.clone(), Action::Choose(Purpose::Open, String::new()));
    window.settle();
    assert!(window.app.message.0.contains("enter the path"), "{:?}", window.app.message);
    assert_eq!(window.app.state.scene, before);
}

/// Repeated random input causes no panic, no device error and, after the first round, no growth of the device's objects.
#[test]
fn random_input_leaves_it_whole() {
    random_input(20);
}

#[test]
#[ignore = "long"]
fn more_random_input_leaves_it_whole() {
    random_input(60);
}

fn random_input(steps: usize) {
    const ROUNDS: usize = 3;
    const SEED: u64 = 17;
    let broken = antumbra_testing::scenes_folder().map(|folder| folder.join("broken"));
    let mut things = things_to_open(broken.as_deref()).unwrap();
    things.extend(walker());
    // A selection of different families; another test takes all techniques to both ends of their parameters.
    let kinds =
        [TechniqueKind::Hard, TechniqueKind::Pcf, TechniqueKind::Vsm, TechniqueKind::Vssm, TechniqueKind::AliasFree];
    let Some(mut input) = or_skip(RandomInput::new(SEED, things, kinds.to_vec())) else { return };
    let mut after = Vec::new();
    for round in 1..=ROUNDS {
        input.begin_anew(SEED);
        for _ in 0..steps {
            input.step();
        }
        assert!(input.opened() >= round as u64, "nothing was opened");
        // Each round begins in the same state.
        after.push(input.come_home());
    }
    let picture = input.window().pictured();
    assert!(picture.chunks_exact(4).any(|texel| texel[..3] != picture[..3]), "nothing is shown any more");
    // Readbacks in flight differ between rounds, so the counts may differ slightly.
    let is_no_more = |last: usize, second: usize| last <= second + second / 8;
    let (second, last) = (after[ROUNDS - 2], after[ROUNDS - 1]);
    let is_flat = is_no_more(last.buffers, second.buffers)
        && is_no_more(last.textures, second.textures)
        && is_no_more(last.bind_groups, second.bind_groups)
        && is_no_more(last.pipelines, second.pipelines);
    assert!(is_flat, "{after:?} after each round");
}
