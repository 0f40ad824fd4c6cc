//! Tests of masks of every format, in parts of larger textures, against the 32-bit mask.

use glam::{UVec2, Vec3};

use crate::TechniqueKind;
use crate::contract::{Mask, MaskChannels, MaskPlace, MeshCaster, Opacity, SurfaceCoverage};
use crate::gpu::{Gpu, Recorder};
use crate::shadow::{Casters, Frame};
use crate::testing::{Case, Mesh, RECTANGLE, f32_of_half, gpu, read_layer, run};

/// Value of each component of a mask's texture before drawing.
const BEFORE: f32 = 0.25;

/// Returns a texture of a format, larger than the masks in it, filled with [`BEFORE`].
fn filled(gpu: &Gpu, format: wgpu::TextureFormat) -> wgpu::Texture {
    let size = wgpu::Extent3d { width: 160, height: 150, depth_or_array_layers: 4 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test atlas"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: Mask::usages(format) | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let component: &[u8] = match format.target_component_alignment() {
        Some(4) => &BEFORE.to_le_bytes(),
        Some(2) => &[0x00, 0x34],
        _ => &[64],
    };
    let texel_bytes = format.block_copy_size(None).expect("a colour format");
    let texels = component.repeat((texel_bytes * size.width * size.height * 4) as usize / component.len());
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texel_bytes * size.width),
        rows_per_image: Some(size.height),
    };
    gpu.queue.write_texture(texture.as_image_copy(), &texels, layout, size);
    texture
}

/// Returns a layer's components, pixel by pixel.
fn components(gpu: &Gpu, texture: &wgpu::Texture, layer: u32) -> Vec<f32> {
    let bytes = read_layer(gpu, texture, layer);
    match texture.format().target_component_alignment() {
        Some(4) => bytemuck::pod_collect_to_vec(&bytes),
        Some(2) => bytemuck::pod_collect_to_vec::<u8, u16>(&bytes).into_iter().map(f32_of_half).collect(),
        _ => bytes.into_iter().map(|byte| f32::from(byte) / 255.0).collect(),
    }
}

/// Returns the rounding error of stored values below 1: half a step, or a whole one for floats because they may be truncated.
fn rounding(format: wgpu::TextureFormat) -> f32 {
    match format.target_component_alignment() {
        Some(4) => 0.0,
        Some(2) => 1.0 / 2048.0,
        _ => 0.6 / 255.0,
    }
}

#[test]
fn masks_of_every_format_and_place_hold_the_same() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    // Transmitted light, and hence visibility, differs between channels.
    let tinted = Opacity::Translucent {
        coverage: SurfaceCoverage::Alpha(0.8),
        transmitted: Vec3::new(0.9, 0.5, 0.1),
        texture: None,
    };
    let casters: Vec<_> = case.meshes.iter().map(|mesh| MeshCaster { opacity: tinted, ..mesh.caster() }).collect();
    for channels in [MaskChannels::One, MaskChannels::Three] {
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let size_px = frame.receivers.size_px;
            let whole = Mask::with_channels(gpu.device(), size_px, channels);
            // Technique that supports tinted casters and compiles fast; the masks do not depend on it.
            let mut shadow = TechniqueKind::MultiView.create(gpu).expect("any device");
            for (key, value) in [("samples", "8"), ("view_size", "64")] {
                shadow.set(key, value).expect("in range");
            }
            run(gpu, &mut shadow, &Frame { mask: &whole, ..*frame }).expect("a good frame");
            let truth: Vec<_> = (0..channels.count()).map(|layer| components(gpu, whole.texture(), layer)).collect();
            if channels == MaskChannels::Three {
                assert!(truth[0] != truth[1] && truth[1] != truth[2], "the channels differ");
            }
            for format in Mask::FORMATS {
                let texture = filled(gpu, format);
                let of_four = format.components() == 4;
                let component = if of_four && channels == MaskChannels::One { 2 } else { 0 };
                let place = MaskPlace { layer: 1, origin_px: UVec2::new(33, 17), size_px, component };
                let mask = Mask::within(&texture, place, channels).expect("within a good texture");
                let mut encoder =
                    gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                let work = shadow.prepare(&Frame { mask: &mask, ..*frame }).expect("a good frame");
                work.record(&mut Recorder::new(&mut encoder, None));
                gpu.queue.submit([encoder.finish()]);
                for layer in 0..4 {
                    let held = components(gpu, &texture, layer);
                    let count = usize::from(format.components());
                    for (i, value) in held.into_iter().enumerate() {
                        let (pixel, at) = (i / count, i % count);
                        let (x, y) = (pixel as u32 % texture.width(), pixel as u32 / texture.width());
                        let expected = expected(&truth, place, of_four, layer, at, UVec2::new(x, y));
                        assert!(
                            (value - expected.unwrap_or(BEFORE)).abs()
                                <= if expected.is_some() { rounding(format) } else { 0.002 },
                            "{format:?} {channels:?} layer {layer} component {at} at ({x}, {y}): {value}, not {expected:?}"
                        );
                    }
                }
            }
        });
    }
}

/// Returns the expected value of a component; `None` if it is not the mask's.
fn expected(
    truth: &[Vec<f32>],
    place: MaskPlace,
    of_four: bool,
    layer: u32,
    component: usize,
    pixel: UVec2,
) -> Option<f32> {
    let in_mask = pixel.checked_sub(place.origin_px).filter(|pixel| pixel.cmplt(place.size_px).all())?;
    let channel = match (of_four, truth.len()) {
        (true, 1) => (layer == place.layer && component == place.component as usize).then_some(0),
        (true, _) => (layer == place.layer && component < 3).then_some(component),
        (false, _) => layer.checked_sub(place.layer).map(|channel| channel as usize),
    };
    let channel = truth.get(channel?)?;
    Some(channel[(in_mask.y * place.size_px.x + in_mask.x) as usize])
}

/// Lights of equal size share the wide mask, and each mask is its own light's.
#[test]
fn lights_share_the_wide_mask() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let format = wgpu::TextureFormat::R8Unorm;
    case.with_frame(Casters::Meshes(&casters), |frame| {
        let mask = || Mask::with_format(gpu.device(), frame.receivers.size_px, MaskChannels::One, format);
        let masks = [mask(), mask()];
        let mut shadows = [TechniqueKind::Hard, TechniqueKind::Pcss].map(|kind| kind.create(gpu).expect("any device"));
        let alone: Vec<_> = masks
            .iter()
            .zip(&mut shadows)
            .map(|(mask, shadow)| {
                let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                let work = shadow.prepare(&Frame { mask, ..*frame }).expect("a good frame");
                work.record(&mut Recorder::new(&mut encoder, None));
                gpu.queue.submit([encoder.finish()]);
                read_layer(gpu, mask.texture(), 0)
            })
            .collect();
        assert!(alone[0] != alone[1], "hard and soft shadows differ");
        let before = gpu.objects_created().textures;
        let again = [mask(), mask()];
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (mask, shadow) in again.iter().zip(&mut shadows) {
            let work = shadow.prepare(&Frame { mask, ..*frame }).expect("a good frame");
            work.record(&mut Recorder::new(&mut encoder, None));
        }
        gpu.queue.submit([encoder.finish()]);
        assert_eq!(gpu.objects_created().textures, before, "no texture is made for another mask of like size");
        for (mask, alone) in again.iter().zip(&alone) {
            assert!(read_layer(gpu, mask.texture(), 0) == *alone, "both in one submission");
        }
    });
}
