//! Tests through a noisy technique, against closed forms.

use antumbra_light::{Light, LightShape};
use glam::{Vec2, Vec3};

use crate::TechniqueKind;
use crate::casters::tests::{set_of, update};
use crate::contract::{Denoise, Error, Mask, MaskChannels, Receivers};
use crate::gpu::{Gpu, Recorder};
use crate::shadow::AnyShadow;
use crate::shadow::{Casters, Frame};
use crate::testing::{
    Case, Mesh, RECTANGLE, SIZE, View, gpu, half_plane_visibility, read_layer, rmse, run, test_ground, texture_of,
    view_of,
};

/// Returns a noisy technique: 8 taps in the blocker search, 8 in the filter.
fn noisy(gpu: &Gpu, denoise: Option<Denoise>) -> AnyShadow {
    with_taps(gpu, "8", denoise)
}

fn with_taps(gpu: &Gpu, taps: &str, denoise: Option<Denoise>) -> AnyShadow {
    let mut shadow = TechniqueKind::Pcss.create(gpu).expect("any device");
    for key in ["search_samples", "samples"] {
        shadow.set(key, taps).expect("in range");
    }
    shadow.set_denoise(denoise);
    shadow
}

/// Returns the mask after a number of frames of a case.
fn after(gpu: &Gpu, shadow: &mut AnyShadow, case: &Case, frames: u32) -> Vec<f32> {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let draw = |shadow: &mut AnyShadow| {
        case.with_frame(Casters::Meshes(&casters), |frame| run(gpu, shadow, frame).expect("a good frame"))
    };
    (0..frames).map(|_| draw(shadow)).last().expect("a frame at least")
}

fn error_of(case: &Case, mask: &[f32]) -> f32 {
    rmse(&case.ground_pixels(test_ground), mask, |p| half_plane_visibility(p.x, 1.0))
}

/// Returns the half-plane case with the camera moved to the right by `away_m`, metres.
fn seen_from(gpu: &Gpu, away_m: f32) -> Case {
    let case = Case::half_plane(gpu, RECTANGLE);
    let view = View::new(Vec3::new(2.0 + away_m, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    Case::new(gpu, case.light, view, case.meshes)
}

/// In still frames, 8 filter taps over 16 frames are as good as 64 taps; a single frame improves, too.
#[test]
fn means_of_still_frames_are_as_good_as_many_taps() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    // A search of few taps has a bias that frames do not average out.
    let well_searched = |denoise| {
        let mut shadow = noisy(gpu, denoise);
        shadow.set("search_samples", "64").expect("in range");
        shadow
    };
    let alone = error_of(&case, &after(gpu, &mut well_searched(None), &case, 1));
    let many = error_of(&case, &after(gpu, &mut with_taps(gpu, "64", None), &case, 1));
    let mut shadow = well_searched(Some(Denoise::default()));
    let first = error_of(&case, &after(gpu, &mut shadow, &case, 1));
    let still = error_of(&case, &after(gpu, &mut shadow, &case, 15));
    println!("8 taps {alone:.4}, denoised {first:.4}, after 16 frames {still:.4}; 64 taps {many:.4}");
    assert!(first < 0.7 * alone && still < many, "{first} {still}");
}

/// A mask without noise is unchanged, including edges one pixel wide.
#[test]
fn a_mask_without_noise_is_left_alone() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let plain = case.run(gpu, TechniqueKind::Hard, &[]);
    assert!(plain.contains(&0.0) && plain.contains(&1.0));
    let mut shadow = TechniqueKind::Hard.create(gpu).expect("any device");
    shadow.set_denoise(Some(Denoise::default()));
    assert!(after(gpu, &mut shadow, &case, 8) == plain);
}

/// Means follow the surface while the camera moves by about a pixel per frame.
#[test]
fn means_follow_a_moving_camera() {
    let Some(gpu) = gpu() else { return };
    let mut shadow = noisy(gpu, Some(Denoise::default()));
    let mut frozen = noisy(gpu, Some(Denoise { max_frames: 1, motion: None }));
    let mut errors = [0.0; 2];
    for i in 0..=12 {
        let case = seen_from(gpu, 0.07 * i as f32);
        errors = [&mut shadow, &mut frozen].map(|shadow| error_of(&case, &after(gpu, shadow, &case, 1)));
    }
    println!("over time and pixels {:.4}, over pixels alone {:.4}", errors[0], errors[1]);
    assert!(errors[0] < 0.62 * errors[1], "{errors:?}");
}

/// A light that jumps takes its shadow along: after eight frames almost no ghost remains.
#[test]
fn a_jump_leaves_no_ghost() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let there = Light { center: case.light.center - 0.8 * Vec3::X, ..case.light.clone() };
    let mut shadow = noisy(gpu, Some(Denoise::default()));
    let before = after(gpu, &mut shadow, &case, 16);
    let case = Case { light: there, ..case };
    let settled = after(gpu, &mut noisy(gpu, Some(Denoise::default())), &case, 16);
    let pixels = case.ground_pixels(test_ground);
    let distance = |mask: &[f32]| {
        let squared: f32 = pixels.iter().map(|(i, _)| (mask[*i] - settled[*i]).powi(2)).sum();
        (squared / pixels.len() as f32).sqrt()
    };
    let [first, eighth] = [1, 7].map(|frames| distance(&after(gpu, &mut shadow, &case, frames)));
    println!("before {:.4}, the first frame {first:.4}, the eighth {eighth:.4}", distance(&before));
    assert!(distance(&before) > 0.2 && first < 0.1 && eighth < 0.02);
}

/// Motion vectors of a camera's motion match reprojection; those of another motion fetch the mean from elsewhere.
#[test]
fn motion_vectors_say_where_a_surface_was() {
    let Some(gpu) = gpu() else { return };
    let [here, there] = [0.0, 0.25].map(|away| seen_from(gpu, away));
    let of_camera = |view: &View, p: Vec3| {
        let clip = view.clip_from_view * view.view_from_world * p.extend(1.0);
        Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5
    };
    let pixels = there.ground_pixels(|_| true);
    let mut motion = vec![[0.0_f32; 4]; SIZE.element_product() as usize];
    for (i, p) in pixels {
        let came = of_camera(&there.view, p) - of_camera(&here.view, p);
        motion[i][..2].copy_from_slice(&came.to_array());
    }
    let texture = |texels: &[[f32; 4]]| view_of(&texture_of(gpu, SIZE, wgpu::TextureFormat::Rgba32Float, texels));
    let still = texture(&vec![[0.0; 4]; motion.len()]);
    let motion = texture(&motion);
    let with = |motion: Option<wgpu::TextureView>| {
        let mut shadow = noisy(gpu, Some(Denoise::default()));
        after(gpu, &mut shadow, &here, 16);
        shadow.set_denoise(Some(Denoise { motion, ..Denoise::default() }));
        error_of(&there, &after(gpu, &mut shadow, &there, 1))
    };
    let [by_camera, by_vectors, by_none] = [None, Some(motion), Some(still)].map(with);
    println!(
        "by camera {by_camera:.4}, by vectors {by_vectors:.4}, by vectors that say that nothing moved {by_none:.4}"
    );
    assert!((by_camera - by_vectors).abs() < 0.002 && by_none > 1.2 * by_camera);
}

/// Channels are independent: with casters that tint nothing, all equal the mask of one channel. Narrow masks equal wide ones.
#[test]
fn masks_of_any_kind_are_smoothed() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let one = after(gpu, &mut noisy(gpu, Some(Denoise::default())), &case, 4);
    assert!(one.iter().any(|v| *v < 0.1) && one.iter().any(|v| *v > 0.9), "neither black nor white");
    let formats = [(MaskChannels::Three, Mask::FORMAT), (MaskChannels::One, wgpu::TextureFormat::R8Unorm)];
    for (channels, format) in formats {
        let mask = Mask::with_format(gpu.device(), SIZE, channels, format);
        let mut shadow = noisy(gpu, Some(Denoise::default()));
        let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
        for _ in 0..4 {
            case.with_frame(Casters::Meshes(&casters), |frame| {
                let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                let frame = Frame { mask: &mask, ..*frame };
                shadow.prepare(&frame).expect("a good frame").record(&mut Recorder::new(&mut encoder, None));
                gpu.queue.submit([encoder.finish()]);
            });
        }
        for layer in 0..mask.texture().depth_or_array_layers() {
            let bytes = read_layer(gpu, mask.texture(), layer);
            let got: Vec<f32> = if format == Mask::FORMAT {
                bytemuck::pod_collect_to_vec(&bytes)
            } else {
                bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect()
            };
            let most = got.iter().zip(&one).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            // Vulkan and Direct3D allow stored values an error of .6 of a step.
            let room = if format == Mask::FORMAT { 0.0 } else { 0.6 / 255.0 + 1e-6 };
            assert!(most <= room, "{format:?}, layer {layer}: {most}");
        }
    }
}

/// A still mask is redrawn until its means cover all frames, and is cached from then on.
#[test]
fn a_still_mask_settles() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Disk { radius_m: 0.5 });
    let (mut set, _) = set_of(gpu, &case);
    update(gpu, &mut set);
    let mut shadow = noisy(gpu, Some(Denoise { max_frames: 5, motion: None }));
    let mut passes = || {
        case.with_frame(Casters::Set { set: &set, layers: u32::MAX }, |frame| {
            let receivers = Receivers { version: Some(1), ..frame.receivers };
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut recorder = Recorder::new(&mut encoder, None);
            shadow.prepare(&Frame { receivers, ..*frame }).expect("a good frame").record(&mut recorder);
            let count = recorder.passes().len();
            gpu.queue.submit([encoder.finish()]);
            count
        })
    };
    let counts: Vec<_> = (0..8).map(|_| passes()).collect();
    assert!(counts[..5].iter().all(|count| *count > 2) && counts[5..].iter().all(|count| *count == 0), "{counts:?}");
}

/// Numbers of frames out of range are rejected.
#[test]
fn frames_are_from_1_to_64() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    for max_frames in [0, 65] {
        let mut shadow = noisy(gpu, Some(Denoise { max_frames, motion: None }));
        let refused = case.with_frame(Casters::Meshes(&casters), |frame| shadow.prepare(frame).map(drop));
        assert!(matches!(refused, Err(Error::BadFrame { .. })), "{max_frames}: {refused:?}");
    }
}

/// Frames that only move create no wgpu resource once both halves of the history have their bind groups.
#[test]
fn frames_that_only_move_make_no_objects() {
    let Some(shared) = gpu() else { return };
    // A device of its own, because its counters are compared.
    let gpu = &Gpu::new(shared.device(), shared.queue());
    let case = Case::half_plane(gpu, RECTANGLE);
    let mut shadow = noisy(gpu, Some(Denoise::default()));
    let mut move_on = |i: u32| {
        let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
        let light = Light { center: case.light.center + 0.05 * i as f32 * Vec3::X, ..case.light.clone() };
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let work = shadow.prepare(&Frame { light: &light, ..*frame }).expect("a good frame");
            work.record(&mut Recorder::new(&mut encoder, None));
            gpu.queue.submit([encoder.finish()]);
        });
        // Polling returns the staging buffers for reuse.
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
    };
    (0..4).for_each(&mut move_on);
    let counts = gpu.objects_created();
    (4..8).for_each(&mut move_on);
    assert!(counts.total() > 0, "nothing is counted");
    assert_eq!(gpu.objects_created(), counts);
}
