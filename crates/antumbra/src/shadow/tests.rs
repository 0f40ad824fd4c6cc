//! Tests of every technique over sequences of frames: resources are reused, and frames come in any order.

use antumbra_light::{Aabb, Light, LightShape, ShadowDistance};
use glam::{DMat4, Mat4, Vec2, Vec3};

use super::{AnyShadow, WarmUp};
use super::{Casters, Frame};
use crate::TechniqueKind;
use crate::casters::tests::{set_of, update};
use crate::casters::{CasterSet, Surface};
use crate::contract::{Mask, MaskChannels, MeshCaster, Receivers, SurfaceCoverage};
use crate::gpu::{Gpu, Recorder};
use crate::technique_kind::each_technique;
use crate::testing::{Case, Mesh, SIZE, View, gpu, instances_at, read_texture, run};

const RECTANGLE: LightShape = LightShape::Rectangle { size_m: Vec2::new(1.0, 0.6) };

/// A technique with small maps and few samples.
fn small(gpu: &Gpu, kind: TechniqueKind) -> AnyShadow {
    let mut shadow = kind.create(gpu).expect("any device");
    for (key, value) in [("map_size", "128"), ("view_size", "64"), ("samples", "8"), ("search_samples", "8")] {
        if kind.param_specs().iter().any(|spec| spec.key == key) {
            shadow.set(key, value).expect("in range");
        }
    }
    shadow
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

fn visibility(gpu: &Gpu, mask: &Mask) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(&read_texture(gpu, mask.texture(), 0, SIZE))
}

/// Returns the light moved by 5 cm per frame.
fn moved(light: &Light, frame: u32) -> Light {
    Light { center: light.center + 0.05 * frame as f32 * Vec3::X, ..light.clone() }
}

/// Property of a technique's frames of a test scene, with its name.
type Property = (&'static str, fn(&Gpu, &Case, TechniqueKind));

/// Lists properties with the names of their functions, for failure messages.
macro_rules! properties {
    ($($property:ident),* $(,)?) => { [$((stringify!($property), $property as fn(&Gpu, &Case, TechniqueKind))),*] };
}

/// Declares one test per technique. Each checks all properties, because most of its time is spent compiling the technique's
/// shaders, which every process repeats: a test per technique and property takes more than twice as long.
macro_rules! techniques {
    ($($technique:ident: $kind:ident,)*) => {
        mod frames_under_a_rectangle {
            $(#[test]
            fn $technique() {
                super::under_a_rectangle(super::TechniqueKind::$kind);
            })*
        }
    };
}

each_technique!(techniques);

fn holds(gpu: &Gpu, case: &Case, kind: TechniqueKind, properties: &[Property]) {
    for (name, property) in properties {
        println!("{kind}: {name}");
        property(gpu, case, kind);
    }
}

/// Checks the properties under a light that one map covers.
fn under_a_rectangle(kind: TechniqueKind) {
    let Some(shared) = gpu() else { return };
    // A separate `Gpu` has separate counters.
    let gpu = &Gpu::new(shared.device(), shared.queue());
    let properties = properties![
        warm_frames_compile_nothing,
        frames_that_only_move_make_no_objects,
        frames_before_one_submission_are_those_of_two,
        frames_that_come_to_nothing_leave_nothing,
        what_stands_still_is_not_drawn_again,
        frames_far_from_the_origin_are_as_at_it,
    ];
    holds(gpu, &Case::half_plane(gpu, RECTANGLE), kind, &properties);
}

/// Properties under a light that needs several maps: for one technique per family, because techniques do not know of parts.
mod frames_all_around_a_sphere {
    use super::TechniqueKind;

    #[test]
    fn hard() {
        super::all_around_a_sphere(TechniqueKind::Hard);
    }

    #[test]
    fn multi_view() {
        super::all_around_a_sphere(TechniqueKind::MultiView);
    }

    #[test]
    fn vsm() {
        super::all_around_a_sphere(TechniqueKind::Vsm);
    }

    #[test]
    fn essm() {
        super::all_around_a_sphere(TechniqueKind::Essm);
    }

    #[test]
    fn reprojection() {
        super::all_around_a_sphere(TechniqueKind::Reprojection);
    }

    #[test]
    fn multi_layer() {
        super::all_around_a_sphere(TechniqueKind::MultiLayer);
    }
}

fn all_around_a_sphere(kind: TechniqueKind) {
    let Some(shared) = gpu() else { return };
    let gpu = &Gpu::new(shared.device(), shared.queue());
    let ground_below = Case::half_plane(gpu, LightShape::Sphere { radius_m: 0.2 });
    // Close above the half-plane, so that receivers may lie on all sides, up to the lamp's height.
    let lamp = Light { center: Vec3::new(-0.6, 1.9, 0.0), ..ground_below.light.clone() };
    let case = Case { light: lamp, ..ground_below };
    let of_all = properties![
        warm_frames_compile_nothing,
        frames_that_only_move_make_no_objects,
        what_stands_still_is_not_drawn_again,
    ];
    holds(gpu, &case, kind, &of_all);
    // Its first frames overflow here, and which fragments fit depends on their order.
    if kind != TechniqueKind::MultiLayer {
        let of_those_with_room =
            properties![frames_before_one_submission_are_those_of_two, frames_that_come_to_nothing_leave_nothing];
        holds(gpu, &case, kind, &of_those_with_room);
    }
}

/// Ten kilometres from the world's origin, where 32-bit floats are a millimetre apart, masks are those at the origin, except for
/// the rounding of the camera's matrix by the host.
fn frames_far_from_the_origin_are_as_at_it(gpu: &Gpu, case: &Case, kind: TechniqueKind) {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let near = case
        .with_frame(Casters::Meshes(&casters), |frame| run(gpu, &mut small(gpu, kind), frame).expect("a good frame"));
    for away in [Vec3::new(1024.0, 0.0, -512.0), Vec3::new(10_000.3, 0.0, 4_321.7), Vec3::new(9_003.3, 0.0, -6_324.7)] {
        let moved = instances_at(gpu, away);
        let bounds = |mesh: &Mesh| Aabb { min: mesh.bounds.min + away, max: mesh.bounds.max + away };
        let casters: Vec<_> = (case.meshes.iter())
            .map(|mesh| MeshCaster { instances: &moved, bounds: bounds(mesh), ..mesh.caster() })
            .collect();
        let light = Light { center: case.light.center + away, ..case.light.clone() };
        let far = case.with_frame(Casters::Meshes(&casters), |frame| {
            let view_from_world =
                (frame.receivers.view_from_world.as_dmat4() * DMat4::from_translation(-away.as_dvec3())).as_mat4();
            let receivers = Receivers { view_from_world, ..frame.receivers };
            let frame = Frame { light: &light, receivers, ..*frame };
            run(gpu, &mut small(gpu, kind), &frame).expect("a good frame")
        });
        let squares: f32 = far.iter().zip(&near).map(|(a, b)| (a - b).powi(2)).sum();
        let rms = (squares / far.len() as f32).sqrt();
        println!("{kind}, {away}: {rms:.5} from the same at the origin");
        // Whether a variance near zero counts as zero depends on its last bits.
        let is_of_variances = matches!(kind, TechniqueKind::Vssm | TechniqueKind::Evssm);
        let bound = if is_of_variances { 0.05 } else { 0.003 };
        assert!(rms <= bound, "{kind}, {away}: {rms}");
    }
}

fn frames_that_only_move_make_no_objects(gpu: &Gpu, case: &Case, kind: TechniqueKind) {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let mut shadow = small(gpu, kind);
    let mut draw = |frames: std::ops::Range<u32>| {
        for i in frames {
            let light = moved(&case.light, i);
            case.with_frame(Casters::Meshes(&casters), |frame| {
                let work = shadow.prepare(&Frame { light: &light, ..*frame }).expect("a good frame");
                let mut encoder = encoder(gpu);
                work.record(&mut Recorder::new(&mut encoder, None));
                gpu.queue.submit([encoder.finish()]);
            });
            gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
        }
        gpu.objects_created()
    };
    assert!(draw(0..6).total() > 0, "{kind}: nothing is counted");
    // Tests share the device: if another test's poll has taken the callback that frees a staging buffer but not yet called it, the
    // next frame creates a second one. Resources that frames always create would appear in every round.
    let mut rounds = [6..10, 6..10, 6..10].into_iter().map(|frames| {
        let before = gpu.objects_created();
        (before, draw(frames))
    });
    assert!(rounds.any(|(before, after)| before == after), "{kind}: {:?}", gpu.objects_created());
}

/// Automatic map sizes are those that are drawn, at least 1024 texels for any image. They stay while the light moves a little. None
/// are reported if sizes are fixed.
#[test]
fn chosen_map_sizes_are_those_drawn() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    for kind in [TechniqueKind::Hard, TechniqueKind::Smrt, TechniqueKind::Vsm, TechniqueKind::Savsm] {
        let mut shadow = small(gpu, kind);
        let mut draw = |size: &str, frame: u32| {
            shadow.set("map_size", size).expect("a number or auto");
            let light = moved(&case.light, frame);
            case.with_frame(Casters::Meshes(&casters), |frame| {
                run(gpu, &mut shadow, &Frame { light: &light, ..*frame }).expect("a good frame");
            });
            let drawn: Vec<u32> = shadow.drawn_maps().iter().map(|map| map.size_px.x).collect();
            (shadow.auto_map_sizes(), drawn)
        };
        let (chosen, drawn) = draw("auto", 0);
        assert_eq!(chosen.len(), 1, "{kind}: {chosen:?}");
        assert!(chosen.iter().all(|size| (1024..=4096).contains(size) && drawn.contains(size)), "{kind}: {chosen:?}");
        assert_eq!(draw("auto", 1).0, chosen, "{kind}");
        assert_eq!(draw("128", 1).0, [0; 0], "{kind}");
    }
}

/// Two lights, first with a state each, then with one for both: frames in one submission have the bits of frames in two
/// submissions.
fn frames_before_one_submission_are_those_of_two(gpu: &Gpu, case: &Case, kind: TechniqueKind) {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let lights = [moved(&case.light, 0), moved(&case.light, 12)];
    let submit = |encoder: wgpu::CommandEncoder| gpu.queue.submit([encoder.finish()]);
    let masks = || [(); 2].map(|()| Mask::new(gpu.device(), SIZE));
    case.with_frame(Casters::Meshes(&casters), |frame| {
        let alone = masks();
        for (light, mask) in lights.iter().zip(&alone) {
            let mut encoder = encoder(gpu);
            let mut shadow = small(gpu, kind);
            let work = shadow.prepare(&Frame { light, mask, ..*frame }).expect("a good frame");
            work.record(&mut Recorder::new(&mut encoder, None));
            submit(encoder);
        }
        let alone = alone.each_ref().map(|mask| visibility(gpu, mask));
        assert!(alone[0] != alone[1], "{kind}: the light's place tells nothing");

        let together = masks();
        let mut shadows = [(); 2].map(|()| small(gpu, kind));
        let mut commands = encoder(gpu);
        let works: Vec<_> = (shadows.iter_mut().zip(&lights).zip(&together))
            .map(|((shadow, light), mask)| shadow.prepare(&Frame { light, mask, ..*frame }).expect("a good frame"))
            .collect();
        // Last prepared, first recorded.
        works.into_iter().rev().for_each(|work| work.record(&mut Recorder::new(&mut commands, None)));
        submit(commands);
        assert!(together.each_ref().map(|mask| visibility(gpu, mask)) == alone, "{kind}: two lights");

        let in_turn = masks();
        let mut shadow = small(gpu, kind);
        let mut commands = encoder(gpu);
        for (light, mask) in lights.iter().zip(&in_turn) {
            let work = shadow.prepare(&Frame { light, mask, ..*frame }).expect("a good frame");
            work.record(&mut Recorder::new(&mut commands, None));
        }
        submit(commands);
        assert!(in_turn.each_ref().map(|mask| visibility(gpu, mask)) == alone, "{kind}: one state, two frames");
    });
}

/// After a frame that was prepared and dropped, or one that failed, the state draws the next frame correctly.
fn frames_that_come_to_nothing_leave_nothing(gpu: &Gpu, case: &Case, kind: TechniqueKind) {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let elsewhere = moved(&case.light, 12);
    let wrong = Mask::new(gpu.device(), SIZE + 1);
    let draw = |shadow: &mut AnyShadow| {
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let mask = Mask::new(gpu.device(), SIZE);
            let mut encoder = encoder(gpu);
            let work = shadow.prepare(&Frame { mask: &mask, ..*frame }).expect("a good frame");
            work.record(&mut Recorder::new(&mut encoder, None));
            gpu.queue.submit([encoder.finish()]);
            visibility(gpu, &mask)
        })
    };
    let expected = draw(&mut small(gpu, kind));
    let mut shadow = small(gpu, kind);
    case.with_frame(Casters::Meshes(&casters), |frame| {
        drop(shadow.prepare(&Frame { light: &elsewhere, ..*frame }).expect("a good frame"));
    });
    assert!(draw(&mut shadow) == expected, "{kind}: after a frame that was dropped");
    case.with_frame(Casters::Meshes(&casters), |frame| {
        let error = shadow.prepare(&Frame { mask: &wrong, light: &elsewhere, ..*frame }).unwrap_err();
        assert!(error.to_string().contains("the mask's size"), "{kind}: {error}");
    });
    assert!(draw(&mut shadow) == expected, "{kind}: after a frame that failed");
}

/// Outcome of a frame with a set's casters.
struct Outcome {
    /// Whether casters were drawn or read.
    draws: bool,
    /// Number of passes.
    passes: usize,
    /// Mask, which the frame has changed if it was submitted.
    mask: Vec<f32>,
    /// Whether the frame before overflowed.
    has_lacked: bool,
}

/// The second frame of a static scene draws no caster, and has the first one's bits; later ones record nothing at all, even if the
/// light's brightness changes. If the light or a caster moves, or commands were never submitted, the frame is drawn again.
fn what_stands_still_is_not_drawn_again(gpu: &Gpu, case: &Case, kind: TechniqueKind) {
    let (mut set, ids) = set_of(gpu, case);
    update(gpu, &mut set);
    let mask = Mask::new(gpu.device(), SIZE);
    let mut shadow = small(gpu, kind);
    let mut draw = |set: &CasterSet, light: &Light, is_submitted: bool| {
        case.with_frame(Casters::Set { set, layers: u32::MAX }, |frame| {
            let receivers = Receivers { version: Some(1), ..frame.receivers };
            let work = shadow.prepare(&Frame { light, receivers, mask: &mask, ..*frame }).expect("a good frame");
            let has_lacked = work.overflow().is_some();
            let mut encoder = encoder(gpu);
            let mut recorder = Recorder::new(&mut encoder, None);
            work.record(&mut recorder);
            let reads_casters = ["triangles", "view-sample lists", "trace"];
            let draws = recorder.passes().iter().any(|pass| pass.draws_casters || reads_casters.contains(&pass.label));
            let passes = recorder.passes().len();
            if is_submitted {
                gpu.queue.submit([encoder.finish()]);
            }
            gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
            Outcome { draws, passes, mask: visibility(gpu, &mask), has_lacked }
        })
    };
    let mut first = draw(&set, &case.light, true);
    assert!(first.draws, "{kind}: the first frame draws casters");
    let mut second = draw(&set, &case.light, true);
    if second.has_lacked {
        first = second;
        second = draw(&set, &case.light, true);
    }
    assert!(!second.draws, "{kind}: the second frame draws none");
    assert!(second.mask == first.mask, "{kind}: and shows the same");
    // The second frame may still read back what the first one needed.
    let bright = Light { name: "bright".into(), color: Vec3::X, intensity: 7.0, ..case.light.clone() };
    let third = draw(&set, &bright, true);
    assert_eq!(third.passes, 0, "{kind}: the third frame records nothing");
    assert!(third.mask == first.mask, "{kind}: and shows the same");
    let elsewhere = draw(&set, &moved(&case.light, 12), true);
    assert!(elsewhere.draws && elsewhere.mask != first.mask, "{kind}: the light has moved");
    let away = [Mat4::from_translation(Vec3::new(0.4, 0.0, 0.0))];
    set.set_instances(ids[1], crate::casters::Instances::Matrices(&away)).expect("there");
    update(gpu, &mut set);
    assert!(draw(&set, &case.light, false).draws, "{kind}: a caster has moved");
    let after = draw(&set, &case.light, true);
    assert!(after.draws && after.mask != first.mask, "{kind}: the frame before was never submitted");
}

/// Warm-up steps together compile what a warm-up compiles at once, and report the number of steps left.
#[test]
fn warm_up_steps_compile_a_part_each() {
    let Some(shared) = gpu() else { return };
    let gpu = || Gpu::new(shared.device(), shared.queue());
    let (at_once, in_steps) = (gpu(), gpu());
    for (kind, what) in [
        (TechniqueKind::Pcss, WarmUp::default()),
        (TechniqueKind::MultiLayer, WarmUp { masked: true, tinted: false }),
        (TechniqueKind::RayTraced, WarmUp { masked: false, tinted: false }),
    ] {
        let of = |gpu: &Gpu| {
            let mut shadow = small(gpu, kind);
            shadow.set_half_resolution(true);
            shadow
        };
        of(&at_once).warm_up(what).expect("any device");
        let mut steps = of(&in_steps).warm_up_steps(what);
        let all = steps.len();
        let made = || in_steps.objects_created().programs;
        let (first, mut parts) = (made(), 0);
        for left in (0..all).rev() {
            let before = made();
            steps.next().expect("some are left").expect("any device");
            assert_eq!(steps.len(), left, "{kind}");
            parts += u32::from(made() > before);
        }
        assert!(steps.next().is_none() && made() > first, "{kind}");
        // Pipelines that techniques share exist after the first technique.
        let least = if kind == TechniqueKind::Pcss { 3 } else { 1 };
        assert!(parts >= least, "{kind}: {parts} of {all} steps compile anything");
        assert_eq!(made(), at_once.objects_created().programs, "{kind}");
    }
}

/// After a warm-up the first frame compiles nothing, for any kind of caster.
fn warm_frames_compile_nothing(gpu: &Gpu, case: &Case, kind: TechniqueKind) {
    // A separate `Gpu` has separate pipelines.
    let gpu = &Gpu::new(gpu.device(), gpu.queue());
    let (mut set, ids) = set_of(gpu, case);
    small(gpu, kind).warm_up(WarmUp::default()).expect("any device");
    let programs = gpu.objects_created().programs;
    assert!(programs > 0, "{kind}: nothing is counted");
    let of = |transmitted| Surface::Translucent { coverage: SurfaceCoverage::Alpha(0.5), transmitted, texture: None };
    for (surface, channels) in [
        (Surface::Opaque, MaskChannels::One),
        (of(Vec3::ZERO), MaskChannels::One),
        (of(Vec3::splat(0.5)), MaskChannels::One),
        (of(Vec3::new(1.0, 0.5, 0.5)), MaskChannels::Three),
    ] {
        set.set_surface(ids[1], surface).expect("there");
        update(gpu, &mut set);
        let mask = Mask::with_channels(gpu.device(), SIZE, channels);
        case.with_frame(Casters::Set { set: &set, layers: u32::MAX }, |frame| {
            drop(small(gpu, kind).prepare(&Frame { mask: &mask, ..*frame }).expect("a good frame"));
            // This light is not flat, and some techniques compile for that.
            let ball = Light { shape: LightShape::Sphere { radius_m: 0.2 }, ..frame.light.clone() };
            drop(small(gpu, kind).prepare(&Frame { light: &ball, mask: &mask, ..*frame }));
        });
    }
    assert_eq!(gpu.objects_created().programs, programs, "{kind}: a frame compiled something");
}

/// Shadows are unchanged up to where the fade begins, fade as [`ShadowDistance`] defines, and are gone beyond its end: for
/// techniques that cover everything by themselves, and for those that do not.
#[test]
fn shadows_fade_and_end_at_a_distance() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let distance = ShadowDistance { end_m: 6.0, fade_m: 1.5 };
    let eye = case.view.view_from_world.inverse().w_axis.truncate();
    let ground = case.ground_pixels(|p| p.abs().max_element() < 5.9);
    for name in ["hard", "essm", "moment", "multi_layer", "sample_based"] {
        let kind = TechniqueKind::from_name(name).expect("a technique");
        let draw = |shadow_distance| {
            case.with_frame(Casters::Meshes(&casters), |frame| {
                let frame = Frame { receivers: Receivers { shadow_distance, ..frame.receivers }, ..*frame };
                run(gpu, &mut small(gpu, kind), &frame).expect("a good frame")
            })
        };
        let (whole, faded) = (draw(None), draw(Some(distance)));
        // Dark pixels before the fade, within it, and beyond.
        let mut dark = [0; 3];
        let mut off = 0.0;
        for (i, p) in &ground {
            let share = distance.lit_share(p.distance(eye));
            let expected = whole[*i] + (1.0 - whole[*i]) * share;
            off += (faded[*i] - expected).abs();
            if whole[*i] < 0.1 {
                dark[usize::from(share > 0.0) + usize::from(share == 1.0)] += 1;
            }
            if share == 1.0 {
                assert_eq!(faded[*i], 1.0, "{name}: {p} is {} m away", p.distance(eye));
            }
        }
        let off = off / ground.len() as f32;
        println!("{name}: {off:.4} from what is expected; {dark:?} dark pixels");
        assert!(dark.iter().all(|count| *count > 20), "{name}: {dark:?} dark pixels");
        // Maps of the near part alone have other texels.
        assert!(off < 0.01, "{name}: {off}");
        let bad = ShadowDistance { fade_m: 7.0, ..distance };
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let frame = Frame { receivers: Receivers { shadow_distance: Some(bad), ..frame.receivers }, ..*frame };
            let error = small(gpu, kind).prepare(&frame).expect_err("a fade longer than the distance").to_string();
            assert!(error.contains("fade_m") && error.contains(name), "{error}");
        });
    }
}

/// While a camera walks under a sun, maps of cascades that still cover the view are not redrawn, and masks match those of a new
/// state.
#[test]
fn cascades_that_hold_are_not_drawn_again() {
    let Some(gpu) = gpu() else { return };
    let shape = LightShape::Sun { angular_diameter_rad: 0.0093 };
    let sun = Light::new(shape, Vec3::ZERO, Vec3::new(0.4, -0.6, -0.3));
    let walking = |frame: u32| {
        let eye = Vec3::new(0.05 * frame as f32, 1.7, 5.0 + 0.02 * frame as f32);
        let meshes = vec![
            Mesh::horizontal(gpu, Vec2::splat(-900.0), Vec2::splat(900.0), 0.0),
            Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 1.5),
            Mesh::horizontal(gpu, Vec2::new(-40.0, -190.0), Vec2::new(40.0, -150.0), 20.0),
        ];
        Case::new(gpu, sun.clone(), View::new(eye, eye + Vec3::new(-0.2, -0.2, -1.0)), meshes)
    };
    let first = walking(0);
    let (mut set, _) = set_of(gpu, &first);
    update(gpu, &mut set);
    for name in ["hard", "moment", "multi_layer"] {
        let kind = TechniqueKind::from_name(name).expect("a technique");
        let mut shadow = small(gpu, kind);
        let draw = |shadow: &mut AnyShadow, case: &Case| {
            case.with_frame(Casters::Set { set: &set, layers: u32::MAX }, |frame| {
                let work = shadow.prepare(frame).expect("a good frame");
                let mut encoder = encoder(gpu);
                let mut recorder = Recorder::new(&mut encoder, None);
                work.record(&mut recorder);
                let draws = recorder.passes().iter().filter(|pass| pass.draws_casters).count();
                gpu.queue.submit([encoder.finish()]);
                gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
                (draws, visibility(gpu, &case.mask))
            })
        };
        // Lists grow to the size they need.
        for _ in 0..3 {
            draw(&mut shadow, &first);
        }
        let (all, _) = draw(&mut small(gpu, kind), &first);
        const FRAMES: u32 = 12;
        let mut again = 0;
        for i in 1..=FRAMES {
            let case = walking(i);
            let (draws, mask) = draw(&mut shadow, &case);
            again += draws;
            let mut own = small(gpu, kind);
            for _ in 0..3 {
                draw(&mut own, &case);
            }
            let (_, fresh) = draw(&mut own, &case);
            assert!(mask.iter().any(|v| *v < 0.1) && mask.iter().any(|v| *v > 0.9), "{name}: nothing is seen");
            let squares: f32 = mask.iter().zip(&fresh).map(|(a, b)| (a - b).powi(2)).sum();
            let rms = (squares / mask.len() as f32).sqrt();
            assert!(rms < 0.1, "{name}, frame {i}: {rms} from a state of its own");
        }
        println!("{name}: {all} passes draw casters at first, {again} in {FRAMES} frames after");
        assert!(all >= 3, "{name}: {all} passes");
        assert!(again < all * FRAMES as usize / 4, "{name}: {again} passes");
    }
}
