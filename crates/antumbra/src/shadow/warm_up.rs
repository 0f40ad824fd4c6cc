//! Compilation before the first frame: a frame of a dummy scene is prepared on a state that is dropped, and its pipelines stay with
//! the device.

use std::collections::VecDeque;
use std::fmt;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Affine2, Mat4, UVec2, Vec2, Vec3};

use super::Shadow;
use super::{Casters, Frame};
use crate::casters::{
    Caster, CasterSet, Instances, Mesh, PositionFormat, Positions, Surface, Texture, TextureCoordinateFormat,
    TextureCoordinates,
};
use crate::contract::{DepthConvention, Error, Mask, MaskChannels, Receivers, SurfaceCoverage};
use crate::gpu::{Gpu, Recorder};
use crate::light_partition::part_images::PartImages;
use crate::mask::denoise::Denoiser;
use crate::mask::half_resolution::HalfResolution;
use crate::mask::smoothing::Smoothing;
use crate::receivers::points::PointTextures;
use crate::techniques::{Coverage, Technique};

/// Features of a scene that decide which pipelines its frames need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WarmUp {
    /// Whether casters may be alpha-tested, or translucent without a tint.
    pub masked: bool,
    /// Whether casters may tint, with masks of three channels.
    pub tinted: bool,
}

impl Default for WarmUp {
    /// All features.
    fn default() -> Self {
        Self { masked: true, tinted: true }
    }
}

/// Steps of compilation before the first frame, for hosts that show progress: each item compiles at most what one frame of a light
/// needs. The length is the number of steps left. In a browser, which has no threads to spare, take one per frame.
#[must_use = "nothing is compiled until `step` is called"]
pub struct WarmUpSteps {
    steps: VecDeque<Box<dyn Step>>,
}

impl fmt::Debug for WarmUpSteps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "WarmUpSteps({} left)", self.steps.len())
    }
}

impl Iterator for WarmUpSteps {
    /// Result of a step, as of [`Shadow::warm_up`].
    type Item = Result<(), Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.steps.pop_front().map(|step| step.run())
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.steps.len(), Some(self.steps.len()))
    }
}

impl ExactSizeIterator for WarmUpSteps {}

/// Step of compilation.
trait Step: wgpu::WasmNotSendSync {
    fn run(self: Box<Self>) -> Result<(), Error>;
}

/// Step that compiles passes before or after a technique.
struct PassesStep {
    gpu: Gpu,
    compile: fn(&Gpu),
}

impl Step for PassesStep {
    fn run(self: Box<Self>) -> Result<(), Error> {
        (self.compile)(&self.gpu);
        Ok(())
    }
}

/// Step that prepares a technique's frame of a dummy scene, under a light of one shape.
struct FrameStep<T: Technique> {
    gpu: Gpu,
    params: T::Params,
    scene: WarmUp,
    shape: LightShape,
    /// Whether the step returns the frame's error: for the first light shape of a scene. Errors of other shapes appear when a frame
    /// uses them.
    is_asked: bool,
}

impl<T: Technique> Step for FrameStep<T> {
    fn run(self: Box<Self>) -> Result<(), Error> {
        let dummy = DummyScene::new(&self.gpu, self.scene)?;
        let mut shadow = Shadow::<T>::with_params(&self.gpu, self.params)?;
        let outcome = shadow.prepare(&dummy.frame(&light_of(self.shape))).map(drop);
        if self.is_asked { outcome } else { Ok(()) }
    }
}

impl<T: Technique + 'static> Shadow<T> {
    /// Compiles what frames with the current parameters need, so that no frame compiles anything. Call it while the host loads, if
    /// you like on another thread with a separate state. Pipelines stay with the device and serve every light.
    ///
    /// # Errors
    /// As [`new`](Shadow::new) and [`prepare`](Shadow::prepare).
    pub fn warm_up(&self, what: WarmUp) -> Result<(), Error> {
        self.warm_up_steps(what).collect()
    }

    /// Returns the steps of [`warm_up`](Self::warm_up), to be taken a few per frame by hosts that must not wait: a loading screen
    /// with progress, a browser.
    pub fn warm_up_steps(&self, what: WarmUp) -> WarmUpSteps {
        let mut compile: Vec<fn(&Gpu)> = vec![PointTextures::compile_ahead];
        if T::coverage(&self.params) != Coverage::Everything {
            compile.push(|gpu| drop(PartImages::new(gpu)));
        }
        if self.denoise.is_some() {
            compile.push(|gpu| drop(Denoiser::new(gpu)));
        }
        if shapes().iter().any(|shape| T::is_noisy(&self.params, &light_of(shape.clone()))) {
            compile.push(|gpu| drop(Smoothing::new(gpu)));
        }
        if self.half_resolution {
            compile.push(|gpu| drop(HalfResolution::new(gpu)));
        }
        let passes = compile.into_iter().map(|compile| {
            let step: Box<dyn Step> = Box::new(PassesStep { gpu: self.gpu.clone(), compile });
            step
        });
        let frames = scenes_of(what).into_iter().flat_map(|scene| {
            // Some techniques compile for each light shape, and again for each kind of caster.
            shapes().into_iter().enumerate().map(move |(i, shape)| {
                let (gpu, params) = (self.gpu.clone(), self.params.clone());
                let step: Box<dyn Step> = Box::new(FrameStep::<T> { gpu, params, scene, shape, is_asked: i == 0 });
                step
            })
        });
        WarmUpSteps { steps: passes.chain(frames).collect() }
    }
}

/// Scenes that need pipelines of their own, because some techniques compile variants for casters that are not opaque.
fn scenes_of(what: WarmUp) -> Vec<WarmUp> {
    let mut scenes = vec![WarmUp { masked: false, tinted: false }];
    scenes.extend(
        [(what.masked, false), (false, what.tinted), (what.masked, what.tinted)]
            .map(|(masked, tinted)| WarmUp { masked, tinted }),
    );
    scenes.dedup();
    scenes
}

/// Creates a light of a shape, above the scene.
fn light_of(shape: LightShape) -> Light {
    Light::new(shape, Vec3::new(0.3, 4.0, 0.2), Vec3::ZERO)
}

/// One light shape of every kind.
fn shapes() -> [LightShape; 6] {
    [
        LightShape::Disk { radius_m: 0.1 },
        LightShape::Rectangle { size_m: Vec2::splat(0.1) },
        LightShape::Sphere { radius_m: 0.1 },
        LightShape::Ellipsoid { radii_m: Vec3::splat(0.1) },
        LightShape::Sun { angular_diameter_rad: 0.01 },
        LightShape::Points { positions_m: vec![Vec3::new(0.3, 4.0, 0.2), Vec3::new(0.4, 4.0, 0.2)] },
    ]
}

/// Dummy scene: one triangle for each kind of caster.
struct DummyScene {
    set: CasterSet,
    depth: wgpu::TextureView,
    mask: Mask,
}

impl DummyScene {
    fn new(gpu: &Gpu, what: WarmUp) -> Result<Self, Error> {
        let surface_texture = Texture {
            view: texture(gpu, wgpu::TextureFormat::Rgba8Unorm),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
        };
        // Zero-initialised positions and texture coordinates of one triangle, with room for twice as many.
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("antumbra warm-up"),
            size: 72,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let mut set = CasterSet::new(gpu);
        let (open, closed) = (set.add_mesh(&triangle(&buffer, false))?, set.add_mesh(&triangle(&buffer, true))?);
        let here = [Mat4::IDENTITY];
        let mut add =
            |mesh, surface| set.add(&Caster { surface, ..Caster::new(mesh, Instances::Matrices(&here)) }).map(drop);
        add(open, Surface::Opaque)?;
        add(closed, Surface::Opaque)?;
        if what.masked {
            add(open, Surface::Masked { texture: surface_texture.clone(), alpha_factor: 1.0, cutoff: 0.5 })?;
        }
        let translucent = |transmitted, texture| {
            let coverage = SurfaceCoverage::Alpha(0.5);
            Surface::Translucent { coverage, transmitted, texture }
        };
        if what.masked {
            add(open, translucent(Vec3::ZERO, None))?;
        }
        if what.tinted {
            add(open, translucent(Vec3::X, None))?;
            add(open, translucent(Vec3::X, Some(surface_texture)))?;
        }
        // Never submitted: nothing of it is drawn.
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        set.update(&mut Recorder::new(&mut encoder, None))?;
        let channels = if what.tinted { MaskChannels::Three } else { MaskChannels::One };
        Ok(Self {
            set,
            depth: texture(gpu, wgpu::TextureFormat::R32Float),
            mask: Mask::with_channels(gpu.device(), UVec2::ONE, channels),
        })
    }

    fn frame<'a>(&'a self, light: &'a Light) -> Frame<'a> {
        Frame {
            light,
            casters: Casters::Set { set: &self.set, layers: u32::MAX },
            receivers: Receivers {
                size_px: UVec2::ONE,
                origin_px: UVec2::ZERO,
                depth: &self.depth,
                depth_convention: DepthConvention::Reversed,
                view_from_world: Mat4::from_translation(Vec3::new(0.0, 0.0, -4.0)),
                clip_from_view: glam::camera::rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1),
                normals: None,
                bounds: None,
                hull: &[],
                seen: &[],
                shadow_distance: None,
                version: None,
            },
            mask: &self.mask,
        }
    }
}

/// Creates a texture of one texel.
fn texture(gpu: &Gpu, format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("antumbra warm-up"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default())
}

/// Mesh of one triangle, from a buffer of positions that are read as texture coordinates, too.
fn triangle(buffer: &wgpu::Buffer, closed: bool) -> Mesh<'_> {
    Mesh {
        vertex_count: 3,
        positions: Positions { buffer, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
        texture_coordinates: Some(TextureCoordinates {
            buffer,
            offset: 0,
            stride: 8,
            format: TextureCoordinateFormat::Float32x2,
            transform: Affine2::IDENTITY,
        }),
        indices: None,
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed,
        bounds: Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE },
    }
}
