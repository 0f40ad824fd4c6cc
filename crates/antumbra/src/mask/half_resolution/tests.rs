//! Tests of the passes alone, and through techniques.

use antumbra_light::{Light, LightShape};
use glam::camera::rh::proj::directx::perspective_infinite_reverse;
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::{half_clip, half_of};
use crate::TechniqueKind;
use crate::casters::tests::{set_of, update};
use crate::contract::{Mask, MaskChannels, Receivers};
use crate::gpu::{Gpu, Recorder};
use crate::shadow::{AnyShadow, Casters, Frame};
use crate::testing::{
    Case, Mesh, RECTANGLE, SIZE, View, gpu, half_plane_visibility, read_layer, rmse, run, test_ground, texture_of,
    view_of,
};

/// Error of linear interpolation between pixels two apart at a penumbra's ends, against the closed form; the penumbra is about
/// twelve pixels wide.
const MAX_OF_ENDS: f32 = 0.007;

/// Techniques that filter over a pixel's footprint, here twice as wide, which doubles the error.
const BY_FOOTPRINT: [TechniqueKind; 1] = [TechniqueKind::Essm];

fn at_half(gpu: &Gpu, kind: TechniqueKind, is_half: bool) -> AnyShadow {
    let mut shadow = kind.create(gpu).expect("any device");
    shadow.set_half_resolution(is_half);
    shadow
}

/// Pixel (i, j) of the half image and pixel (2i, 2j) of the image have the same point at their centre.
#[test]
fn half_size_pixels_lie_where_pixels_do() {
    for size_px in [UVec2::new(96, 54), UVec2::new(97, 55), UVec2::new(1, 2), UVec2::new(7, 1)] {
        let clip_from_view = perspective_infinite_reverse(0.8, 1.7, 0.1);
        let half_from_view = half_clip(size_px) * clip_from_view;
        let half_px = half_of(size_px);
        assert_eq!(half_px, (size_px + 1) / 2);
        let at = |clip: Mat4, size: UVec2, x: Vec3| {
            let ndc = clip.project_point3(x).truncate();
            (ndc * Vec2::new(0.5, -0.5) + 0.5) * size.as_vec2() - 0.5
        };
        for x in [Vec3::new(0.3, -0.2, -2.0), Vec3::new(-1.3, 0.4, -7.0), Vec3::new(0.0, 0.0, -1.0)] {
            let (full, half) = (at(clip_from_view, size_px, x), at(half_from_view, half_px, x));
            assert!(full.abs_diff_eq(2.0 * half, 1e-3), "{size_px}: {full} and {half}");
            let [z, z_of_half] = [clip_from_view, half_from_view].map(|clip| clip.project_point3(x).z);
            assert_eq!(z, z_of_half);
        }
    }
}

/// On a ground with one penumbra, the error is nearly that of full resolution, and the masks differ.
#[test]
fn penumbrae_are_those_of_full_resolution() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let pixels = case.ground_pixels(test_ground);
    // One of each family, and the two that use neighbours themselves.
    for kind in [
        TechniqueKind::Pcss,
        TechniqueKind::Smrt,
        TechniqueKind::MultiView,
        TechniqueKind::Vsm,
        TechniqueKind::Essm,
        TechniqueKind::MultiLayer,
        TechniqueKind::RayTraced,
        TechniqueKind::SampleBased,
    ] {
        let masks = [false, true].map(|is_half| {
            case.with_frame(Casters::Meshes(&casters), |frame| {
                run(gpu, &mut at_half(gpu, kind, is_half), frame).expect("a good frame")
            })
        });
        assert!(masks[0] != masks[1], "{kind}: half the resolution changes nothing");
        let [full, half] = masks.each_ref().map(|mask| rmse(&pixels, mask, |p| half_plane_visibility(p.x, 1.0)));
        println!("{kind}: {full:.4} from the closed form, {half:.4} at half the resolution");
        let most = if BY_FOOTPRINT.contains(&kind) { 2.0 * MAX_OF_ENDS } else { MAX_OF_ENDS };
        assert!(half < full + most, "{kind}: {half} for {full}");
    }
}

/// Left sides and widths of the posts, which lean to the right by a tenth of their height and lie in the plane z = ½.
const POSTS: [(f32, f32); 5] = [(-0.9, 0.05), (-0.53, 0.06), (-0.16, 0.08), (0.21, 0.11), (0.58, 0.2)];

/// Returns the normal of the post or ground at a pixel's centre: one derived from depth would be arbitrary on a thin post.
fn normal_at(view: &View, pixel: UVec2) -> [f32; 4] {
    let ndc = (pixel.as_vec2() + 0.5) / SIZE.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
    let world_from_clip = (view.clip_from_view * view.view_from_world).inverse();
    let [near, far] = [1.0, 0.01].map(|depth| world_from_clip.project_point3(ndc.extend(depth)));
    let at = near + (far - near) * ((near.z - 0.5) / (near.z - far.z));
    let is_on = |(x, width): &(f32, f32)| (*x..x + width).contains(&(at.x - 0.1 * at.y)) && (-0.5..0.9).contains(&at.y);
    if POSTS.iter().any(is_on) { [0.0, 0.0, 1.0, 0.0] } else { [0.0, 1.0, 0.0, 0.0] }
}

/// Lit posts, one to a few pixels wide, before a ground that faces away from the light: neither surface takes visibility from the
/// other.
#[test]
fn edges_are_those_of_full_resolution() {
    let Some(gpu) = gpu() else { return };
    let ground = Mesh::horizontal(gpu, Vec2::new(-6.0, -9.0), Vec2::new(6.0, 0.0), 0.0);
    let mut meshes = vec![ground];
    for (x, width) in POSTS {
        let corners = [(x, -0.5), (x + width, -0.5), (x + width, 0.9), (x, 0.9)];
        meshes.push(Mesh::new(gpu, &corners.map(|(x, y)| Vec3::new(x + 0.1 * y, y, 0.5)), &[0, 1, 2, 0, 2, 3]));
    }
    let light = Light::new(LightShape::Rectangle { size_m: Vec2::splat(0.1) }, Vec3::new(0.0, -1.0, 9.0), Vec3::ZERO);
    let view = View::new(Vec3::new(0.0, 1.2, 5.0), Vec3::new(0.0, 0.2, 0.0));
    let case = Case::new(gpu, light, view, meshes);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let normals: Vec<[f32; 4]> =
        (0..SIZE.element_product()).map(|i| normal_at(&case.view, UVec2::new(i % SIZE.x, i / SIZE.x))).collect();
    let normals = view_of(&texture_of(gpu, SIZE, wgpu::TextureFormat::Rgba32Float, &normals));
    let [full, half] = [false, true].map(|is_half| {
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let receivers = Receivers { normals: Some(&normals), ..frame.receivers };
            let frame = Frame { receivers, ..*frame };
            run(gpu, &mut at_half(gpu, TechniqueKind::AliasFree, is_half), &frame).expect("a good frame")
        })
    });
    let of = |value: f32| full.iter().filter(|v| **v == value).count();
    assert!(of(1.0) > 300 && of(0.0) > 1000, "{} lit, {} dark", of(1.0), of(0.0));
    let differing: Vec<usize> = (0..full.len()).filter(|i| (full[*i] - half[*i]).abs() > 0.05).collect();
    let places: Vec<_> = differing.iter().map(|i| (i % SIZE.x as usize, i / SIZE.x as usize)).collect();
    assert_eq!(places, [], "{} of {}", differing.len(), full.len());
}

/// Returns a mask filled with −1.
fn unwritten_mask(gpu: &Gpu, size_px: UVec2, channels: MaskChannels) -> Mask {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("test mask"),
        size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: channels.count() },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: Mask::FORMAT,
        usage: Mask::usages(Mask::FORMAT) | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels = vec![-1f32; (size_px.element_product() * channels.count()) as usize];
    let (bytes_per_row, rows_per_image) = (Some(4 * size_px.x), Some(size_px.y));
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image };
    gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, texture.size());
    Mask::of_own_layers(&texture, 0, channels)
}

/// Every pixel is written: in one channel and three, under a lamp with cube faces, with a depth buffer of odd size,
/// denoised or not.
#[test]
fn every_pixel_of_every_mask_is_written() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Sphere { radius_m: 0.1 });
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let lamp = Light { center: Vec3::new(-0.6, 1.9, 0.0), ..case.light.clone() };
    for (size_px, light, channels) in [
        (UVec2::new(95, 93), &lamp, MaskChannels::One),
        (UVec2::new(95, 96), &case.light, MaskChannels::Three),
        (UVec2::new(1, 1), &case.light, MaskChannels::One),
    ] {
        let part = SIZE.as_vec2() / size_px.as_vec2();
        let offset = (part - 1.0) * Vec2::new(1.0, -1.0);
        let crop = Mat4::from_translation(offset.extend(0.0)) * Mat4::from_scale(part.extend(1.0));
        for denoise in [None, Some(crate::Denoise::default())] {
            let mask = unwritten_mask(gpu, size_px, channels);
            let mut shadow = at_half(gpu, TechniqueKind::Hard, true);
            shadow.set_denoise(denoise);
            case.with_frame(Casters::Meshes(&casters), |frame| {
                let clip_from_view = crop * frame.receivers.clip_from_view;
                let receivers = Receivers { size_px, clip_from_view, ..frame.receivers };
                let frame = Frame { light, receivers, mask: &mask, ..*frame };
                run(gpu, &mut shadow, &frame).expect("a good frame");
            });
            for layer in 0..channels.count() {
                let got: Vec<f32> = bytemuck::pod_collect_to_vec(&read_layer(gpu, mask.texture(), layer));
                assert!(got.iter().all(|v| (0.0..=1.0).contains(v)), "{size_px}, layer {layer}");
                assert!(size_px.x == 1 || (got.contains(&0.0) && got.contains(&1.0)), "{size_px}, layer {layer}");
            }
        }
    }
}

/// Frames that move create no wgpu resource, a still frame records nothing, and a change of resolution is a new frame.
#[test]
fn frames_at_half_the_resolution_make_no_objects() {
    let Some(shared) = gpu() else { return };
    let gpu = &Gpu::new(shared.device(), shared.queue());
    let case = Case::half_plane(gpu, RECTANGLE);
    let (mut set, _) = set_of(gpu, &case);
    update(gpu, &mut set);
    let mut shadow = at_half(gpu, TechniqueKind::Hard, true);
    let mut draw = |shift: f32, is_half: bool| {
        shadow.set_half_resolution(is_half);
        let light = Light { center: case.light.center + shift * Vec3::X, ..case.light.clone() };
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::new(&mut encoder, None);
        case.with_frame(Casters::Set { set: &set, layers: u32::MAX }, |frame| {
            let receivers = Receivers { version: Some(0), ..frame.receivers };
            shadow.prepare(&Frame { light: &light, receivers, ..*frame }).expect("a good frame").record(&mut recorder);
        });
        let passes = recorder.passes().len();
        gpu.queue.submit([encoder.finish()]);
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
        passes
    };
    (0..6).for_each(|i| assert!(draw(0.1 * i as f32, true) > 2));
    // Tests share the device: another's poll may delay a staging buffer, so only one round of several must create none.
    let made = (6..12).map(|i| {
        let before = gpu.objects_created();
        draw(0.1 * i as f32, true);
        gpu.objects_created() == before
    });
    assert!(made.filter(|is_same| *is_same).count() > 0);
    assert_eq!(draw(1.1, true), 0);
    assert!(draw(1.1, false) > 0 && draw(1.1, true) > 0);
}
