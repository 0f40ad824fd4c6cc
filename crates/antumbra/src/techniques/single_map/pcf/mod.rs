//! `pcf`: the mean of many depth comparisons over a kernel of fixed width.
//!
//! William Reeves, David Salesin, Robert Cook, "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987. Each
//! tap compares with the receiver's plane at its own texel's centre, so that wide kernels on tilted receivers do not
//! shadow themselves.
//!
//! Three kernels: the exact box of n × n texels; a Poisson disc (Mitchell 1991's best candidates); Vogel's spiral
//! (Vogel 1979). The two discs are optionally rotated by a random angle per pixel, which trades banding for noise.
//!
//! Contacts stay sharp (`attach_contacts`; false is as published): the kernel is narrowed until it contains no blocker that is
//! too near the receiver to blur so much. A blocker in front of the receiver by a gap `d` blurs by d · tan β to either side under
//! a light of half angle β. This angle is limited to that of a light 11° wide, and to the light's elevation above the receiver, so
//! that no kernel reaches past the line where blocker and receiver meet. With the light 5 to 90° above `tilted-planes`, umbrae at
//! contacts leak .043–.068 as published and .015–.027 with narrowed kernels.
//!
//! # Limits
//! The width is in texels, the same for every occluder that is not at a contact, and does not depend on the light's size. The
//! discs' taps compare bilinearly where the kernel is wider than a texel.

use std::f32::consts::PI;

use antumbra_light::SampleSet;
use glam::Vec2;

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Embeddable, Gpu, Recorder, Stage, TableKey};
use crate::light_map::light_view::FollowedLight;
use crate::light_map::map::{MapSearch, MapSettings};
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::{KernelPoints, MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;
#[cfg(test)]
mod tests;

use gpu_types::PcfUniform;
pub use params::{PcfKernel, PcfParams};

/// Percentage-closer filtering.
#[derive(Debug)]
pub struct Pcf {
    resolve: MapResolve<PcfUniform>,
}

impl Technique for Pcf {
    const NAME: &'static str = "pcf";
    type Params = PcfParams;
    type Prepared = PreparedMapResolve;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { resolve: MapResolve::new(gpu, Self::NAME, shaders::PCF_RESOLVE, &[], MapSearch::Nothing) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &PcfParams,
    ) -> Result<PreparedMapResolve, Error> {
        let PcfParams { kernel, samples, seed, .. } = *params;
        let points = || match kernel {
            PcfKernel::Box => Vec::new(),
            PcfKernel::Poisson => poisson_disk(samples, seed),
            PcfKernel::Vogel => vogel_disk(samples),
        };
        let bytes = || bytemuck::pod_collect_to_vec(&points());
        let key = TableKey { of: "antumbra taps of pcf", numbers: vec![kernel as u32, samples, seed] };
        let kernel = if kernel == PcfKernel::Box {
            KernelPoints::without_points()
        } else {
            KernelPoints { key: Some(key), bytes: &bytes }
        };
        let uniform = PcfUniform {
            kernel_size_texels: params.kernel_size,
            tap_count: if params.kernel == PcfKernel::Box { 0 } else { samples },
            rotate: params.rotate.into(),
            bias_scale: params.bias_scale,
            attach_contacts: params.attach_contacts.into(),
        };
        let map = MapSettings { followed: FollowedLight::Center, ..MapSettings::square(params.map_size) };
        let pass = ResolvePass::of(map);
        self.resolve.prepare(stage, frame, &pass, &uniform, kernel)
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMapResolve) {
        self.resolve.record(recorder, frame, prepared);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.resolve.drawn_map()
    }

    fn embeddable(&self) -> Option<Embeddable> {
        self.resolve.embeddable(shaders::PCF_SHADER_FUNCTION)
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}

/// Vogel's spiral: turn `i` by the golden angle, radius by √, so that each tap has the same area of the unit disk.
fn vogel_disk(n: u32) -> Vec<Vec2> {
    let golden_angle = PI * (3.0 - 5f32.sqrt());
    (0..n)
        .map(|i| {
            let radius = ((i as f32 + 0.5) / n as f32).sqrt();
            radius * Vec2::from_angle(i as f32 * golden_angle)
        })
        .collect()
}

/// Best-candidate points mapped to the unit disk, keeping area.
fn poisson_disk(n: u32, seed: u32) -> Vec<Vec2> {
    SampleSet::PoissonDisc.points(n, seed).into_iter().map(|u| u.x.sqrt() * Vec2::from_angle(2.0 * PI * u.y)).collect()
}
