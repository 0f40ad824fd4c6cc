//! Light sets with a budget: which lights are redrawn, the age of masks, created resources, and the error against frames
//! that redraw all lights.

use std::collections::HashMap;
use std::time::Instant;

use antumbra::light::{Light, LightShape};
use antumbra::{
    AnyShadow, Budget, LightId, LightSet, LightSetFrame, Mask, MaskChannels, MaskState, RangedLight, Receivers,
    Recorder,
};
use antumbra_host_tests::device::Device;
use antumbra_host_tests::host::{HostCasters, kind_of, mask_of, shadow_with, small_shadow};
use antumbra_host_tests::raster::Picture;
use antumbra_host_tests::scene::Camera;
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::many::{crowd, place};

/// Range of the lamps, metres: each reaches a part of the crowd.
const RANGE_M: f32 = 2.5;

/// Position of lamp `i` of `count`, in rows above the crowd.
fn lamp_at(i: usize, count: usize) -> Vec3 {
    let side = (count as f32).sqrt().ceil();
    let (column, row) = ((i as f32) % side, (i as f32 / side).floor());
    Vec3::new(column / side * 9.0 - 4.0, 1.6, row / side * 9.0 - 4.0)
}

fn lamp(center: Vec3) -> RangedLight {
    RangedLight::new(Light::new(LightShape::Sphere { radius_m: 0.08 }, center, center - Vec3::Y), RANGE_M)
}

/// Lamps above a crowd of boxes.
struct Hall<'a> {
    device: &'a Device,
    casters: HostCasters,
    picture: Picture,
    lights: LightSet,
    ids: Vec<LightId>,
}

impl<'a> Hall<'a> {
    fn new(device: &'a Device, size_px: UVec2, shadows: Vec<AnyShadow>) -> Self {
        let masks = shadows.iter().map(|_| Mask::new(device.wgpu(), size_px)).collect();
        Self::with_masks(device, size_px, shadows, masks)
    }

    fn with_masks(device: &'a Device, size_px: UVec2, shadows: Vec<AnyShadow>, masks: Vec<Mask>) -> Self {
        let scene = crowd();
        let mut lights = LightSet::new();
        let count = shadows.len();
        let add = |(i, (shadow, mask))| lights.add(lamp(lamp_at(i, count)), shadow, mask).expect("a good light");
        let ids = shadows.into_iter().zip(masks).enumerate().map(add).collect();
        let picture = Picture::draw(device, &scene, &Camera { size_px, ..Camera::base() });
        Self { device, casters: HostCasters::new(device, &scene), picture, lights, ids }
    }

    fn move_boxes(&mut self, boxes: impl Iterator<Item = usize>, frame: u32) {
        boxes.for_each(|i| self.casters.set_matrix(i + 1, place(i, frame)));
        self.casters.update(self.device);
    }

    /// Draws one frame with modified receivers. Returns the redrawn lights.
    fn draw_of(
        &mut self,
        budget: Budget,
        receivers: impl for<'p> FnOnce(Receivers<'p>) -> Receivers<'p>,
    ) -> Vec<LightId> {
        let receivers = receivers(self.picture.receivers());
        let mut encoder = self.device.encoder();
        let frame = LightSetFrame { casters: &self.casters.set, receivers, budget };
        let work = self.lights.prepare(&frame).expect("a good frame");
        let drawn = work.drawn().collect();
        work.record(&mut Recorder::new(&mut encoder, None));
        self.device.queue().submit([encoder.finish()]);
        self.device.wait();
        drawn
    }

    fn draw(&mut self, budget: Budget) -> Vec<LightId> {
        self.draw_of(budget, |receivers| receivers)
    }

    /// Draws one frame with an unchanged depth buffer.
    fn draw_still(&mut self, budget: Budget) -> Vec<LightId> {
        self.draw_of(budget, |receivers| receivers.with_version(0))
    }

    fn state(&self, id: LightId) -> MaskState {
        self.lights.mask_state(id).expect("one of the set's")
    }

    fn states(&self) -> Vec<MaskState> {
        self.ids.iter().map(|id| self.state(*id)).collect()
    }
}

/// If everything changes in every frame, each frame redraws as many lights as the budget allows. No light waits longer than
/// five times the number of frames that redrawing all takes, and redrawing creates no wgpu resource.
#[test]
fn budgets_are_kept_and_no_light_waits_for_ever() {
    let device = Device::idle();
    for (count, budget) in [(16usize, 1u32), (16, 4), (16, 16), (64, 1), (64, 4), (64, 16)] {
        let shadows = (0..count).map(|_| small_shadow(&device, kind_of("hard"))).collect();
        let mut hall = Hall::new(&device, UVec2::new(16, 9), shadows);
        let max_age = 5 * count.div_ceil(budget as usize) as u32;
        let mut drawn = HashMap::<LightId, u32>::new();
        let mut made = None;
        let (warm, all) = (2 * max_age.max(10), 4 * max_age.max(10));
        for frame in 0..all {
            hall.move_boxes(0..100, frame);
            let of_frame = hall.draw(Budget::Lights(budget));
            assert_eq!(of_frame.len(), budget as usize, "{count} lights, frame {frame}");
            for id in &hall.ids {
                let is_drawn = of_frame.contains(id);
                assert_eq!(hall.state(*id) == MaskState::Drawn, is_drawn, "{count} lights, frame {frame}");
                let is_young = match hall.state(*id) {
                    MaskState::Drawn => true,
                    MaskState::Kept { age } => age <= max_age,
                    MaskState::Missing => !drawn.contains_key(id) && frame < max_age,
                    MaskState::Current | MaskState::Culled => false,
                };
                assert!(is_young, "{count} lights, budget {budget}, frame {frame}: {:?}", hall.states());
            }
            of_frame.into_iter().for_each(|id| *drawn.entry(id).or_default() += 1);
            if frame == warm {
                made = Some(device.gpu.objects_created());
            }
        }
        assert_eq!(made, Some(device.gpu.objects_created()), "{count} lights, budget {budget}");
        let least = all / (max_age + 1);
        assert!(hall.ids.iter().all(|id| drawn[id] >= least.max(1)), "{count} lights, budget {budget}: {drawn:?}");
    }
}

/// Prints CPU time per frame and memory for 64 lamps above a hundred boxes, 20 of which move, with several budgets.
#[test]
#[ignore = "prints figures"]
fn what_sixty_four_lamps_take() {
    for name in ["hard", "pcss", "smrt"] {
        for budget in [1, 4, 16, u32::MAX] {
            let device = Device::idle();
            let shadows = (0..64).map(|_| kind_of(name).create(&device.gpu).expect("any device")).collect();
            let mut hall = Hall::new(&device, UVec2::new(32, 18), shadows);
            let mut frames = Vec::new();
            for frame in 0..80 {
                hall.move_boxes(0..20, frame);
                let began = Instant::now();
                let drawn = hall.draw_still(Budget::Lights(budget)).len();
                frames.push((began.elapsed(), drawn));
            }
            let mut steady = frames.split_off(70);
            steady.sort();
            let (time, drawn) = steady[steady.len() / 2];
            let [retained, shared] = [hall.lights.memory_bytes(), device.gpu.memory_bytes().shared].map(|b| b >> 20);
            println!(
                "{name}, budget {budget}: {:.2} ms to prepare, record and submit {drawn} lamps; {retained} MiB retained, {shared} shared",
                time.as_secs_f64() * 1e3
            );
        }
    }
}

/// Casters that move outside a lamp's range do not affect its mask; a lamp that moves is redrawn alone.
#[test]
fn only_lights_that_something_changed_for_are_redrawn() {
    let device = Device::idle();
    let shadows = (0..16).map(|_| small_shadow(&device, kind_of("pcss"))).collect();
    let mut hall = Hall::new(&device, UVec2::new(16, 9), shadows);
    let all = Budget::Lights(u32::MAX);
    assert_eq!(hall.draw_still(all).len(), 16);
    assert_eq!(hall.draw_still(all).len(), 0);
    assert_eq!(hall.states(), [MaskState::Current; 16]);
    // This box at one end of the crowd moves within .3 m of its position and is .3 m wide.
    hall.move_boxes(std::iter::once(0), 40);
    let drawn = hall.draw_still(all);
    let corner = Vec3::new(-4.5, 0.5, -4.5);
    for (i, id) in hall.ids.iter().enumerate() {
        let distance = lamp_at(i, 16).distance(corner);
        if (distance - RANGE_M).abs() > 0.7 {
            assert_eq!(drawn.contains(id), distance < RANGE_M, "lamp {i} at {distance} m");
        }
    }
    assert!((1..8).contains(&drawn.len()), "{}", drawn.len());
    let moved = hall.ids[9];
    hall.lights.set_light(moved, lamp(lamp_at(9, 16) + 0.1 * Vec3::X)).expect("a good light");
    assert_eq!(hall.draw_still(all), [moved]);
    // A changed parameter causes a redraw; an unchanged frame does not.
    hall.lights.shadow_mut(hall.ids[3]).expect("one of the set's").set("samples", "8").expect("in range");
    assert_eq!(hall.draw_still(all), [hall.ids[3]]);
    assert_eq!(hall.draw_still(all).len(), 0);
}

/// Lights without visible receivers are culled. A light that becomes visible has no mask until it is drawn, and has priority.
#[test]
fn lights_out_of_view_are_culled_and_begin_anew() {
    let device = Device::idle();
    let shadows = (0..16).map(|_| small_shadow(&device, kind_of("hard"))).collect();
    let mut hall = Hall::new(&device, UVec2::new(16, 9), shadows);
    hall.draw(Budget::Lights(u32::MAX));
    // The camera looks away from the hall.
    let camera = Camera { eye: Vec3::new(40.0, 5.0, 8.0), target: Vec3::new(90.0, 0.0, 0.0), ..Camera::base() };
    let view_from_world = camera.view_from_world();
    let away = hall.draw_of(Budget::Lights(2), |mut receivers| {
        receivers.view_from_world = view_from_world;
        receivers
    });
    assert_eq!(away, []);
    assert_eq!(hall.states(), [MaskState::Culled; 16]);
    assert_eq!(hall.draw(Budget::Lights(3)).len(), 3);
    let of = |hall: &Hall<'_>, state| hall.states().into_iter().filter(|found| *found == state).count();
    assert_eq!((of(&hall, MaskState::Drawn), of(&hall, MaskState::Missing)), (3, 13));
    for missing in [10, 7, 4, 1] {
        hall.draw(Budget::Lights(3));
        assert_eq!(of(&hall, MaskState::Missing), missing);
    }
}

/// A budget in texels counts the maps that each light drew last, which differ in size.
#[test]
fn texels_are_counted_by_what_lights_draw() {
    let device = Device::idle();
    let size_px = UVec2::new(16, 9);
    let sizes = ["64", "128", "64", "256"];
    let of_size = |size| shadow_with(&device, kind_of("hard"), &[("map_size", size)]);
    let mut hall = Hall::new(&device, size_px, sizes.map(of_size).into());
    let pixels = 16 * 9;
    hall.draw(Budget::Texels(u64::MAX));
    // A lamp has a map for each cube face with receivers.
    let costs: Vec<u64> = (hall.ids.iter().zip(sizes))
        .map(|(id, size)| {
            let maps = hall.lights.shadow(*id).expect("one of the set's").drawn_maps();
            let texels: u64 = maps.iter().map(|map| u64::from(map.size_px.x) * u64::from(map.size_px.y)).sum();
            let side: u64 = size.parse().expect("a number");
            assert!(texels >= side * side && texels <= 6 * side * side, "{texels} texels of maps of {size}");
            texels + pixels
        })
        .collect();
    let budget = costs[1] + costs[0] + costs[2] + costs[0];
    let (mut drawn, mut over) = (vec![0; 4], 0);
    for frame in 0..60 {
        hall.move_boxes(0..100, frame);
        let of_frame = hall.draw(Budget::Texels(budget));
        let places: Vec<usize> =
            of_frame.iter().map(|id| hall.ids.iter().position(|of| of == id).expect("one of the set's")).collect();
        let spent: u64 = places.iter().map(|i| costs[*i]).sum();
        assert!(spent <= budget || places == [3], "frame {frame}: {places:?}, {spent} of {budget}");
        over += u32::from(spent > budget);
        places.into_iter().for_each(|i| drawn[i] += 1);
    }
    // The large map alone exceeds the budget, but has its turn.
    let is_over = over == drawn[3] && (2..=40).contains(&over);
    assert!(drawn.iter().all(|times| *times >= 2) && is_over, "{drawn:?}, {over} frames over the budget");
}

/// Dropped work leaves masks to be redrawn, and an error in one light's frame does not affect the others.
#[test]
fn dropped_and_failed_frames_are_redrawn() {
    let device = Device::idle();
    let shadows = (0..4).map(|_| small_shadow(&device, kind_of("hard"))).collect();
    let mut hall = Hall::new(&device, UVec2::new(16, 9), shadows);
    let all = Budget::Lights(u32::MAX);
    hall.draw_still(all);
    hall.move_boxes(0..100, 7);
    let receivers = hall.picture.receivers().with_version(0);
    drop(hall.lights.prepare(&LightSetFrame { casters: &hall.casters.set, receivers, budget: all }).expect("good"));
    assert_eq!(hall.draw_still(Budget::Lights(1)).len(), 1);
    let missing = |hall: &Hall<'_>| hall.states().iter().filter(|state| **state == MaskState::Missing).count();
    assert_eq!(missing(&hall), 3);
    // One mask has the wrong size.
    let small = Mask::new(device.wgpu(), UVec2::new(8, 8));
    let missing_one = *hall.ids.iter().find(|id| hall.state(**id) == MaskState::Missing).expect("three are");
    let good = hall.lights.mask(missing_one).expect("one of the set's").clone();
    hall.lights.set_mask(missing_one, small).expect("of no other light");
    let frame = LightSetFrame { casters: &hall.casters.set, receivers: hall.picture.receivers(), budget: all };
    let error = hall.lights.prepare(&frame).expect_err("of another size").to_string();
    assert!(error.contains("the mask's size") && !error.contains('\n'), "{error}");
    hall.lights.set_mask(missing_one, good).expect("of no other light");
    assert!(hall.draw_still(all).len() >= 3 && missing(&hall) == 0);
    assert_eq!(hall.draw_still(all).len(), 0);
}

/// Each invalid input is refused in one line.
#[test]
fn bad_lights_masks_and_budgets_are_refused() {
    let device = Device::idle();
    let shadow = || small_shadow(&device, kind_of("hard"));
    let size_px = UVec2::new(16, 9);
    let mask = || Mask::new(device.wgpu(), size_px);
    let mut hall = Hall::new(&device, size_px, vec![shadow()]);
    let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.01 }, Vec3::Y, Vec3::ZERO);
    let good = lamp(Vec3::Y);
    for (light, words) in [
        (RangedLight { range_m: 0.0, ..good.clone() }, "a light's range is 0 m"),
        (RangedLight { range_m: f32::NAN, ..good.clone() }, "a light's range is NaN m"),
        (RangedLight::new(sun.clone(), 5.0), "a sun's range is 5 m, and must be infinite"),
        (RangedLight::new(Light { center: Vec3::NAN, ..sun.clone() }, f32::INFINITY), "`center`"),
    ] {
        let error = hall.lights.add(light.clone(), shadow(), mask()).expect_err(words).to_string();
        assert!(error.starts_with("light set: ") && error.contains(words) && !error.contains('\n'), "{error}");
        assert_eq!(hall.lights.set_light(hall.ids[0], light).expect_err(words).to_string(), error);
    }
    let first = hall.lights.mask(hall.ids[0]).expect("one of the set's").clone();
    let error = hall.lights.add(good.clone(), shadow(), first.clone()).expect_err("taken").to_string();
    assert!(error.contains("a light's mask is in use"), "{error}");
    hall.lights.set_mask(hall.ids[0], first).expect("its own");
    hall.lights.add(RangedLight::new(sun, f32::INFINITY), shadow(), mask()).expect("a good sun");
    for budget in [Budget::Lights(0), Budget::Texels(0)] {
        let frame = LightSetFrame { casters: &hall.casters.set, receivers: hall.picture.receivers(), budget };
        let error = hall.lights.prepare(&frame).expect_err("nothing").to_string();
        assert!(error.contains("the budget") && error.contains("at least 1"), "{error}");
    }
    hall.casters.set_matrix(1, Mat4::IDENTITY);
    let budget = Budget::Lights(1);
    let frame = LightSetFrame { casters: &hall.casters.set, receivers: hall.picture.receivers(), budget };
    let error = hall.lights.prepare(&frame).expect_err("not updated").to_string();
    assert!(error.contains("CasterSet::update"), "{error}");
    let id = hall.ids[0];
    assert!(hall.lights.remove(id).is_some() && hall.lights.remove(id).is_none());
    assert!(hall.lights.set_light(id, good).expect_err("removed").to_string().contains("the light is not in this set"));
}

/// The RMS difference from frames that redraw all lights falls as the budget grows: eight lamps above a moving crowd, over
/// pixels within the lamps' range.
#[test]
fn masks_come_nearer_to_those_of_all_lights_redrawn_as_the_budget_grows() {
    let Some(device) = Device::shared() else { return };
    let size_px = UVec2::new(48, 27);
    let shadow = |_| shadow_with(device, kind_of("hard"), &[("map_size", "256")]);
    let masks = |hall: &Hall<'_>| -> Vec<Vec<f32>> {
        let layer = |id: &LightId| {
            let mask = hall.lights.mask(*id).expect("one of the set's");
            device.read_layer(mask.texture(), mask.place().layer)
        };
        hall.ids.iter().map(layer).collect()
    };
    let frames = |budget| {
        let of_lights = (0..8).map(shadow).collect();
        let packed = Mask::packed(device.wgpu(), size_px, MaskChannels::One, Mask::FORMAT, 8);
        let mut hall = Hall::with_masks(device, size_px, of_lights, packed);
        // The first frame draws all lights.
        hall.draw(Budget::Lights(u32::MAX));
        let of_frame = |frame: u32| {
            hall.move_boxes(0..100, 4 * frame);
            device.validated("a frame", || hall.draw(Budget::Lights(budget)));
            masks(&hall)
        };
        (1u32..25).map(of_frame).collect::<Vec<_>>()
    };
    let of_all = frames(u32::MAX);
    let rms_of = |budget| {
        let of_budget = frames(budget);
        let pairs = of_budget.iter().flatten().flatten().zip(of_all.iter().flatten().flatten());
        let squares: Vec<f32> = pairs.map(|(a, b)| (a - b).powi(2)).collect();
        (squares.iter().sum::<f32>() / squares.len() as f32).sqrt()
    };
    let rms = [1, 2, 4, 8].map(rms_of);
    println!("rms over 24 frames for budgets of 1, 2, 4 and 8 of 8 lamps: {rms:?}");
    assert!(rms[0] > 0.01 && rms[3] == 0.0, "{rms:?}");
    assert!(rms.windows(2).all(|pair| pair[1] < 0.95 * pair[0]), "{rms:?}");
}

/// Packed masks equal separate masks, rounded to eight bits, whichever of them a frame redraws.
#[test]
fn packed_masks_are_those_of_their_own() {
    let Some(device) = Device::shared() else { return };
    let size_px = UVec2::new(48, 27);
    let shadow = || shadow_with(device, kind_of("hard"), &[("map_size", "128")]);
    let packed = Mask::packed(device.wgpu(), size_px, MaskChannels::One, wgpu::TextureFormat::Rgba8Unorm, 6);
    let texture = packed[0].texture().clone();
    assert_eq!(texture.depth_or_array_layers(), 2);
    let mut hall = Hall::with_masks(device, size_px, (0..6).map(|_| shadow()).collect(), packed);
    for id in hall.ids.clone() {
        let of_all = hall.lights.light(id).expect("one of the set's").clone();
        hall.lights.set_light(id, RangedLight { range_m: f32::INFINITY, ..of_all }).expect("a good light");
    }
    // Each frame draws two lights and keeps the masks drawn before.
    for _ in 0..3 {
        assert_eq!(device.validated("packed", || hall.draw_still(Budget::Lights(2))).len(), 2);
    }
    for (i, id) in hall.ids.iter().enumerate() {
        let light = &hall.lights.light(*id).expect("one of the set's").light;
        let own = mask_of(device, &mut shadow(), light, hall.casters.all(), hall.picture.receivers());
        let is_mixed = own.contains(&0.0) && own.contains(&1.0);
        assert!(is_mixed, "lamp {i} shades nothing");
        let texels = device.read_layer(&texture, i as u32 / 4);
        let component = |texel: &f32| f32::from(texel.to_bits().to_le_bytes()[i % 4]) / 255.0;
        let is_same = texels.iter().map(component).zip(&own).all(|(a, b)| (a - *b).abs() <= 0.5 / 255.0);
        assert!(is_same, "lamp {i}");
    }
}

/// Within a light's range only casters that reach into it matter.
#[test]
fn casters_beyond_the_range_shade_nothing_within_it() {
    let Some(device) = Device::shared() else { return };
    let size_px = UVec2::new(96, 54);
    let mut hall = Hall::new(device, size_px, vec![shadow_with(device, kind_of("ray_traced"), &[("samples", "8")])]);
    let camera = Camera { size_px, ..Camera::base() };
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
    hall.picture = Picture::draw_as(device, &crowd(), &camera, wgpu::TextureFormat::Depth32Float, usage);
    let depth = device.read_layer(&hall.picture.depth, 0);
    let world_from_clip = (camera.clip_from_view() * camera.view_from_world()).inverse();
    let position = |i: usize| {
        let at = Vec2::new((i as u32 % size_px.x) as f32 + 0.5, (i as u32 / size_px.x) as f32 + 0.5);
        let ndc = at / size_px.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
        world_from_clip.project_point3(ndc.extend(depth[i]))
    };
    let ranged = lamp(Vec3::new(0.3, 1.2, -0.2));
    hall.lights.set_light(hall.ids[0], ranged.clone()).expect("a good light");
    hall.draw(Budget::Lights(1));
    let within = device.read_layer(hall.lights.mask(hall.ids[0]).expect("one of the set's").texture(), 0);
    let mut shadow = shadow_with(device, kind_of("ray_traced"), &[("samples", "8")]);
    let of_all = mask_of(device, &mut shadow, &ranged.light, hall.casters.all(), hall.picture.receivers());
    let in_range = |i: &usize| depth[*i] > 0.0 && position(*i).distance(ranged.light.center) < ranged.range_m;
    let places: Vec<usize> = (0..depth.len()).filter(in_range).collect();
    let dark = places.iter().filter(|i| of_all[**i] < 0.5).count();
    assert!(places.len() > 200 && dark > 50, "{dark} of {} are dark", places.len());
    let differing = places.iter().filter(|i| within[**i] != of_all[**i]).count();
    assert_eq!(differing, 0, "of {}", places.len());
    assert!(within != of_all, "there is nothing beyond the range");
}
