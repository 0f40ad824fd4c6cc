//! Creates every program on a device, as hosts, renderer and viewer do; draws nothing.

use antumbra::contract::{ParamSpec, ParamValue};
use antumbra::light::{Light, LightShape};
use antumbra::{
    Camera, Casters, Denoise, DepthConvention, DepthMapCaster, Error, Frame, Gpu, Mask, MaskChannels, Quality,
    Receivers, Recorder, SplitReceivers, TechniqueKind, WarmUp,
};
use antumbra_render::gpu_scene::GpuScene;
use antumbra_render::receivers::{ReceiverImages, ReceiverPass};
use antumbra_render::shading::{Shading, ShadingPrograms};
use antumbra_scene::{LoadOptions, Setup, load};
use antumbra_viewer::renderer::{Compile, Renderer};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// Scenes with opaque, alpha-tested and tinted casters.
const SCENES: [&str; 3] = ["builtin:overlap", "builtin:fence-alpha", "builtin:stained-glass"];

/// Extent of the parameter variants to create.
#[derive(Clone, Copy, PartialEq)]
pub enum Extent {
    /// Default quality only.
    Default,
    /// Every quality.
    Qualities,
    /// Every quality, and every choice, switch and number.
    Parameters,
}

/// Creates all programs.
///
/// # Errors
/// The first unexpected rejection.
pub fn make_all(gpu: &Gpu, extent: Extent) -> Result<(), String> {
    for &kind in TechniqueKind::ALL {
        make_technique(gpu, kind, extent)?;
    }
    let hosts = Hosts::new(gpu);
    hosts.make_maps_of_hosts().map_err(|error| error.to_string())?;
    hosts.make_masks().map_err(|error| error.to_string())?;
    hosts.make_split_receivers().map_err(|error| error.to_string())?;
    make_renderer(gpu)
}

/// Creates the programs of a technique.
///
/// # Errors
/// The first unexpected rejection.
pub fn make_technique(gpu: &Gpu, kind: TechniqueKind, extent: Extent) -> Result<(), String> {
    for settings in settings_of(kind, extent) {
        let words = || settings.iter().map(|(key, value)| format!(" {key}={value}")).collect::<String>();
        make(gpu, kind, &settings).map_err(|error| format!("{kind}{}: {error}", words()))?;
    }
    Ok(())
}

type Settings = Vec<(&'static str, String)>;

/// Returns each quality; and for the lowest, each choice and switch changed and each number at both ends of its range.
fn settings_of(kind: TechniqueKind, extent: Extent) -> Vec<Settings> {
    let of_quality =
        |quality| kind.quality_settings(quality).into_iter().map(|(key, value)| (key, value.to_string())).collect();
    if extent == Extent::Default {
        return vec![of_quality(Quality::default())];
    }
    let mut all: Vec<Settings> = Vec::new();
    for quality in Quality::ALL.into_iter().filter(|quality| kind.has_quality(*quality)) {
        let base: Settings = of_quality(quality);
        if quality == Quality::Fast && extent == Extent::Parameters {
            for spec in kind.param_specs() {
                all.extend(others(spec).into_iter().map(|value| with(&base, spec.key, value)));
            }
            let of_kind = TOGETHER.iter().filter(|(of, _)| *of == kind.name());
            all.extend(of_kind.map(|(_, pair)| {
                pair.iter().fold(base.clone(), |settings, (key, value)| with(&settings, key, (*value).to_owned()))
            }));
        }
        all.push(base);
    }
    all
}

/// Parameters that have their own programs if changed together.
const TOGETHER: [(&str, [(&str, &str); 2]); 3] = [
    ("essm", [("table", "float"), ("scan", "doubling")]),
    ("essm", [("table", "float"), ("sub", "true")]),
    ("vsm", [("resolve", "exact"), ("msaa", "4")]),
];

/// Returns settings with one value added or replaced.
fn with(base: &Settings, key: &'static str, value: String) -> Settings {
    let mut settings: Settings = base.iter().filter(|(known, _)| *known != key).cloned().collect();
    if (key, value.as_str()) == ("placement", "manual") {
        // Manual placement needs the depths of the splits, metres from the light.
        settings.push(("split_depths", "2, 3, 4".into()));
    }
    settings.push((key, value));
    settings
}

/// Counts that affect no program; large ones would take long.
const COUNTS: [&str; 3] = ["samples", "search_samples", "seed"];

/// Map sizes, which affect no program, and their value here: no adapter supports the largest.
const SIZES: [&str; 2] = ["map_size", "view_size"];
const SMALL_TEXELS: &str = "64";

/// Returns every choice, and both ends of a range, because some numbers affect programs.
fn others(spec: &ParamSpec) -> Vec<String> {
    match spec.default {
        _ if SIZES.contains(&spec.key) || COUNTS.contains(&spec.key) => Vec::new(),
        ParamValue::Bool(_) => vec!["true".into(), "false".into()],
        ParamValue::Choice(_) => {
            // Browsers support maps with one sample and with four.
            let is_everywhere = |choice: &&&str| spec.key != "msaa" || matches!(**choice, "1" | "4");
            spec.choices.iter().filter(is_everywhere).map(|choice| (*choice).to_owned()).collect()
        }
        ParamValue::U32(_) | ParamValue::F32(_) => {
            spec.range.map_or_else(Vec::new, |(low, high)| vec![low.to_string(), high.to_string()])
        }
        ParamValue::List(_) => Vec::new(),
    }
}

/// Compiles a technique's programs before its first frame, with and without denoising.
fn make(gpu: &Gpu, kind: TechniqueKind, settings: &Settings) -> Result<(), String> {
    let mut shadow = kind.create(gpu).map_err(|error| error.to_string())?;
    let sizes = kind.param_specs().iter().map(|spec| spec.key).filter(|key| SIZES.contains(key));
    let small: Settings = sizes.map(|key| (key, SMALL_TEXELS.to_owned())).collect();
    for (key, value) in settings.iter().chain(&small) {
        // The ends of a number's range are invalid together with some other values; such settings cannot draw.
        if shadow.set(key, value).is_err() {
            return Ok(());
        }
    }
    shadow.set_denoise(Some(Denoise::default()));
    shadow.set_half_resolution(true);
    match shadow.warm_up(WarmUp::default()) {
        // Maps that exceed every browser's limits.
        Err(Error::Unsupported { .. }) | Ok(()) => Ok(()),
        Err(error) => Err(error.to_string()),
    }
}

/// Host inputs in forms that the renderer here does not use.
struct Hosts<'a> {
    gpu: &'a Gpu,
    light: Light,
    depth: wgpu::TextureView,
}

impl<'a> Hosts<'a> {
    const SIZE_PX: UVec2 = UVec2::splat(4);

    fn new(gpu: &'a Gpu) -> Self {
        let shape = LightShape::Rectangle { size_m: Vec2::splat(0.5) };
        let light = Light::new(shape, Vec3::new(0.3, 4.0, 0.2), Vec3::ZERO);
        Self { depth: texture(gpu, wgpu::TextureFormat::Depth32Float, 1), gpu, light }
    }

    fn receivers(&self) -> Receivers<'_> {
        let camera = Camera {
            view_from_world: Mat4::from_translation(Vec3::new(0.0, 0.0, -4.0)),
            clip_from_view: glam::camera::rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1),
            depth_convention: DepthConvention::Reversed,
        };
        let bounds = antumbra::light::Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        Receivers::new(&self.depth, Self::SIZE_PX, camera).with_bounds(bounds)
    }

    /// Creates the programs of techniques that accept a depth map drawn by the host.
    fn make_maps_of_hosts(&self) -> Result<(), Error> {
        let back = -self.light.frame().axis;
        let view_from_world =
            glam::camera::rh::view::look_at_mat4(self.light.center, self.light.center - back, Vec3::X);
        let map = DepthMapCaster {
            view: &self.depth,
            size_px: Self::SIZE_PX,
            clip_from_world: glam::camera::rh::proj::directx::perspective_infinite_reverse(1.5, 1.0, 0.1)
                * view_from_world,
            depth_convention: DepthConvention::Reversed,
        };
        let mask = Mask::new(self.gpu.device(), Self::SIZE_PX);
        let frame =
            Frame { light: &self.light, casters: Casters::DepthMap(map), receivers: self.receivers(), mask: &mask };
        let mut taken = 0;
        for &kind in TechniqueKind::ALL {
            taken += usize::from(kind.create(self.gpu)?.prepare(&frame).is_ok());
        }
        assert!(taken >= 9, "{taken} techniques take a host's map");
        Ok(())
    }

    /// Creates the programs of masks of every format.
    fn make_masks(&self) -> Result<(), Error> {
        for format in Mask::FORMATS {
            for channels in [MaskChannels::One, MaskChannels::Three] {
                let mask = Mask::with_format(self.gpu.device(), Self::SIZE_PX, channels, format);
                let frame = Frame {
                    light: &self.light,
                    casters: Casters::Meshes(&[]),
                    receivers: self.receivers(),
                    mask: &mask,
                };
                drop(TechniqueKind::Hard.create(self.gpu)?.prepare(&frame)?);
            }
        }
        Ok(())
    }

    /// Creates the programs of receivers with four samples per pixel.
    fn make_split_receivers(&self) -> Result<(), Error> {
        let depth = texture(self.gpu, wgpu::TextureFormat::Depth32Float, 4);
        let normals = [None, Some(wgpu::TextureFormat::Rgba8Unorm), Some(wgpu::TextureFormat::Rgba16Float)]
            .map(|format| format.map(|format| texture(self.gpu, format, 4)));
        for normals in &normals {
            let mut receivers = self.receivers().with_normals(normals.as_ref());
            receivers.depth = &depth;
            // The commands are never submitted.
            let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            SplitReceivers::new(self.gpu).record(&mut Recorder::new(&mut encoder, None), &receivers)?;
        }
        Ok(())
    }
}

fn texture(gpu: &Gpu, format: wgpu::TextureFormat, sample_count: u32) -> wgpu::TextureView {
    let UVec2 { x: width, y: height } = Hosts::SIZE_PX;
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("programs"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Creates the programs of receivers, shading, and the viewer's displays of masks, maps and lists.
fn make_renderer(gpu: &Gpu) -> Result<(), String> {
    drop(Renderer::new(gpu, Compile::AtOnce));
    let (receivers, programs) = (ReceiverPass::new(gpu), ShadingPrograms::new(gpu.device()));
    for name in SCENES {
        let scene = load(name, &LoadOptions::default()).map_err(|error| error.to_string())?;
        let uploaded = GpuScene::upload_with_faces(gpu, &scene);
        drop(receivers.draw_groups(gpu, &uploaded));
        let Setup { camera, lights } = Setup::for_scene(&scene);
        let images = ReceiverImages::new(gpu.device(), &camera, Hosts::SIZE_PX);
        let mut shading = Shading::new(gpu, &programs, &images, None, &lights, &[]);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        shading.bend_normals(gpu, &mut encoder, &uploaded, &images);
    }
    Ok(())
}
