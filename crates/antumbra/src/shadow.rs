//! Shadow of one light by one technique: its state, and a frame's work as a value.
//!
//! A state is cheap to create and drop: pipelines belong to the device and are shared by all lights. A state keeps maps and lists
//! from frame to frame, so use one per light, and one per view of a light that has several views.
//!
//! [`Shadow::prepare`] returns [`Prepared`] work, which [`Prepared::record`] records. In between the state is borrowed, so that it
//! can prepare no other frame. Several lights are prepared and recorded in any order. Uploads are recorded with the work, so frames
//! may be recorded one after the other and submitted together: submit in the order of recording.

use std::fmt;

use crate::contract::{CastersKey, Denoise, DrawnLists, DrawnMap, Error, Overflow, Params, PreparedFrame};
use crate::gpu::{Commands, Content, Gpu, Recorder, RetainedState, Stage, StagedUploads};
use crate::mask::denoise::{Denoiser, PreparedDenoise};
use crate::mask::fade::{Fade, PreparedFade};
use crate::mask::half_resolution::{HalfResolution, PreparedHalf};
use crate::mask::smoothing::{PreparedSmoothing, Smoothing};
use crate::techniques::Technique;

mod anchored;
mod any;
mod conversions;
mod frame;
mod frame_key;
mod partitioned;
mod shader_function;
#[cfg(test)]
mod tests;
mod validate;
mod warm_up;

use anchored::{Anchored, anchor_of};
use conversions::{Conversions, RetainedConversions};
use frame::{FrameCasters, FrameRequest, prepared};
use frame_key::FrameKey;
use partitioned::{PartitionedPasses, PartitionedState};
use shader_function::ShaderFunctions;
use validate::Validator;

pub use any::AnyShadow;
pub use frame::{Casters, Frame, PointFrame};
pub use warm_up::{WarmUp, WarmUpSteps};

/// State of one light's shadow, by a technique known at compile time.
pub struct Shadow<T: Technique> {
    gpu: Gpu,
    validator: Validator,
    /// Parameters of the next frame.
    pub params: T::Params,
    /// Denoiser settings of the next frame; `None`, the default, leaves the mask as the technique writes it, and discards the means
    /// of earlier frames.
    pub denoise: Option<Denoise>,
    /// Whether the next frame's technique writes a mask of half the width and height, which is then interpolated within surfaces;
    /// for any technique. Work per pixel takes a quarter of the time; contact shadows a pixel or two wide are lost in part. Mask,
    /// denoising and receivers keep their full size. Ignored for points, which have no neighbours.
    pub half_resolution: bool,
    /// State if one view covers what the light reaches.
    technique: T,
    /// State if several views are needed; created on demand and retained.
    parted: Option<PartitionedState<T>>,
    conversions: RetainedConversions,
    denoiser: Option<Denoiser>,
    half: Option<HalfResolution>,
    smoothing: Option<Smoothing>,
    fade: Option<Fade>,
    keep: RetainedState,
    functions: ShaderFunctions,
    /// Key of the mask's content, valid if the last frame was recorded and no commands were dropped.
    mask: Content<FrameKey<T::Params>>,
    /// Whether the last frame was recorded; otherwise it failed or was dropped, and its state is discarded.
    is_recorded: bool,
    commands: Commands,
}

impl<T: Technique> fmt::Debug for Shadow<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Shadow({})", T::NAME)
    }
}

impl<T: Technique> Shadow<T> {
    /// Creates a light's state with default parameters.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if the device lacks a feature or a limit is too low.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        Self::with_params(gpu, T::Params::default())
    }

    /// Creates a light's state.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_params(gpu: &Gpu, params: T::Params) -> Result<Self, Error> {
        Ok(Self {
            gpu: gpu.clone(),
            validator: Validator::default(),
            params,
            denoise: None,
            half_resolution: false,
            technique: T::new(gpu)?,
            parted: None,
            conversions: RetainedConversions::default(),
            denoiser: None,
            half: None,
            smoothing: None,
            fade: None,
            keep: RetainedState::default(),
            functions: ShaderFunctions::default(),
            mask: Content::default(),
            is_recorded: true,
            commands: Commands::default(),
        })
    }

    /// Prepares a frame: fits maps, allocates, collects uploads.
    ///
    /// # Errors
    /// If parameters, light or frame do not fit one another or the device. Then there is nothing to record.
    pub fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error> {
        self.prepare_request(FrameRequest::Mask(*frame))
    }

    /// Prepares a frame of points in place of a depth buffer. Use one state for points and another for a light's mask, because each
    /// caches what its last frame drew.
    ///
    /// Points have no neighbours, so `sub` and the smoothing of `smrt` are skipped, and `denoise` is an error.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    pub fn prepare_points<'a>(&'a mut self, frame: &PointFrame<'a>) -> Result<Prepared<'a>, Error> {
        self.prepare_request(FrameRequest::Points(*frame))
    }

    fn prepare_request<'a>(&'a mut self, request: FrameRequest<'a>) -> Result<Prepared<'a>, Error> {
        self.params.validate(T::NAME)?;
        self.validator.check(T::NAME, &self.gpu, &request, self.denoise.as_ref())?;
        let casters = request.casters().key();
        let is_lost = self.commands.take_dropped() || !self.is_recorded;
        if is_lost {
            self.mask = Content::default();
        }
        let key = self.key_of(&request, casters);
        let is_same = self.mask.is_of(key.as_ref());
        if is_same && self.is_settled() {
            return Ok(Prepared { work: Box::new(FrameWork { shadow: self, request, passes: None }) });
        }
        self.is_recorded = false;
        if is_lost {
            self.technique = T::new(&self.gpu)?;
            self.parted = None;
            self.denoiser = None;
        }
        if self.denoise.is_none() {
            self.denoiser = None;
        }
        if !self.half_resolution {
            self.half = None;
        }
        let gpu = self.gpu.clone();
        let stage = Stage::new(&gpu, std::mem::take(&mut self.keep), casters)
            .anchored(anchor_of(&request))
            .of_noise_frame(self.denoiser.as_ref().map_or(0, Denoiser::noise_frame));
        let outcome = self.prepare_passes(&stage, &request, is_same);
        let uploads;
        (self.keep, uploads) = stage.finish();
        let passes = Some((uploads, outcome?));
        self.mask.ask(key);
        Ok(Prepared { work: Box::new(FrameWork { shadow: self, request, passes }) })
    }

    /// Whether the mask already holds this frame, whose casters have the key `casters`, so that the frame would record nothing.
    pub(crate) fn holds(&self, frame: &Frame<'_>, casters: Option<CastersKey>) -> bool {
        let key = self.key_of(&FrameRequest::Mask(*frame), casters);
        self.is_intact() && self.mask.is_of(key.as_ref()) && self.is_settled()
    }

    fn key_of(&self, request: &FrameRequest<'_>, casters: Option<CastersKey>) -> Option<FrameKey<T::Params>> {
        FrameKey::of(&self.params, (self.denoise.as_ref(), self.half_resolution), request, casters)
    }

    /// Whether the frame prepared last was recorded and its commands were not dropped.
    pub(crate) fn is_intact(&self) -> bool {
        self.is_recorded && !self.commands.are_dropped()
    }

    /// Number of texels in the depth maps of the frame prepared last, layers behind included.
    pub(crate) fn map_texels(&self) -> u64 {
        let texels = |map: &DrawnMap| map.size_px.as_u64vec2().element_product() * (1 + map.layers_behind.len() as u64);
        self.drawn_maps().iter().map(texels).sum()
    }

    /// Prepares a frame's stages, from the host's mask back to the light: each writes the mask that the stage prepared before it
    /// reads.
    fn prepare_passes<'a>(
        &mut self,
        stage: &Stage<'_>,
        request: &FrameRequest<'a>,
        is_same: bool,
    ) -> Result<Passes<'a, T::Prepared>, Error> {
        let casters = FrameCasters::of(request.casters())?;
        let conversions = Conversions::prepare(stage, request, std::mem::take(&mut self.conversions));
        self.conversions = conversions.kept();
        let (receivers, mask) = conversions.inner();
        let wide = prepared(request.light(), &casters, receivers, mask);

        let in_world = casters.meshes();
        let host = wide;
        let anchored = Anchored::is_needed(stage.anchor(), &wide, in_world)
            .then(|| Anchored::new(stage.anchor(), &wide, in_world));
        let wide = anchored.as_ref().map_or(wide, |anchored| anchored.frame(&wide));
        let meshes = anchored.as_ref().map_or(in_world, Anchored::meshes).unwrap_or_default();

        let denoise = self.denoise.as_ref().map(|settings| {
            let denoiser = self.denoiser.get_or_insert_with(|| Denoiser::new(stage));
            denoiser.prepare(stage, [&host, &wide], settings, is_same)
        });
        let full = PreparedFrame { mask: denoise.as_ref().map_or(wide.mask, |denoise| &denoise.noisy), ..wide };

        // Points have no neighbours to interpolate or average.
        let are_neighbours = full.receivers.have_neighbours();
        let is_half = self.half_resolution && are_neighbours;
        let half = is_half.then(|| self.half.get_or_insert_with(|| HalfResolution::new(stage)).prepare(stage, &full));
        let of_mask = half.as_ref().map_or(full, |half| half.frame_of(&full));

        let fade = of_mask
            .receivers
            .shadow_distance
            .map(|distance| self.fade.get_or_insert_with(|| Fade::new(stage)).prepare(stage, &of_mask, &distance));
        let is_noisy = are_neighbours && T::is_noisy(&self.params, of_mask.light);
        if !is_noisy {
            // Frees a texture of the receivers' size.
            self.smoothing = None;
        }
        let smoothing =
            is_noisy.then(|| self.smoothing.get_or_insert_with(|| Smoothing::new(stage)).prepare(stage, &of_mask));
        let of_technique = PreparedFrame { noisy: smoothing.as_ref().map(PreparedSmoothing::noisy), ..of_mask };

        let light = match PartitionedState::prepare(&mut self.parted, stage, &of_technique, meshes, &self.params)? {
            Some(parts) => LightPasses::Parts(Box::new(parts)),
            None => LightPasses::Whole(self.technique.prepare(stage, &of_technique, &self.params)?),
        };
        Ok(Passes { casters, conversions, light, smoothing, fade, half, denoise })
    }

    /// Records a frame's stages, in the order of the data: reading of points, halving of the receivers, the technique, smoothing of
    /// noisy visibility, the fade, upsampling of the mask, denoising, conversion of the mask.
    fn record_passes(&self, recorder: &mut Recorder<'_>, request: &FrameRequest<'_>, passes: Passes<'_, T::Prepared>) {
        let Passes { casters, conversions, light, smoothing, fade, half, denoise } = passes;
        let (receivers, wide) = conversions.inner();
        let mask = denoise.as_ref().map_or(wide, |denoise| &denoise.noisy);
        let full = prepared(request.light(), &casters, receivers, mask);
        let of_mask = half.as_ref().map_or(full, |half| half.frame_of(&full));
        let of_technique = PreparedFrame { noisy: smoothing.as_ref().map(PreparedSmoothing::noisy), ..of_mask };
        conversions.record_read(recorder);
        if let Some(half) = &half {
            half.record_pick(recorder);
        }
        match (light, &self.parted) {
            (LightPasses::Whole(technique), _) => self.technique.record(recorder, &of_technique, &technique),
            (LightPasses::Parts(parts), Some(parted)) => {
                if let Some(smoothing) = &smoothing {
                    smoothing.record_dark(recorder);
                }
                parted.record(recorder, &of_technique, *parts);
            }
            (LightPasses::Parts(_), None) => {}
        }
        if let Some(smoothing) = &smoothing {
            smoothing.record(recorder);
        }
        if let Some(fade) = &fade {
            fade.record(recorder);
        }
        if let Some(half) = &half {
            half.record_upsample(recorder);
        }
        if let Some(denoise) = &denoise {
            denoise.record(recorder);
        }
        conversions.record_write(recorder);
    }

    fn is_settled(&self) -> bool {
        if let (Some(denoise), Some(denoiser)) = (&self.denoise, &self.denoiser)
            && !denoiser.is_settled(denoise)
        {
            return false;
        }
        match self.parts_in_use() {
            Some(parted) => parted.is_settled(&self.params, self.mask.repeats()),
            None => self.technique.is_settled(&self.params, self.mask.repeats()),
        }
    }

    /// State of the light's parts; `None` if the frame prepared last has one view.
    fn parts_in_use(&self) -> Option<&PartitionedState<T>> {
        self.parted.as_ref().filter(|parted| parted.is_in_use())
    }

    /// Technique, for outputs other than the mask; unused if the light is covered in parts, which have states of their own.
    pub fn technique(&self) -> &T {
        &self.technique
    }

    /// GPU memory that the light retains, bytes: maps, lists, trees, buffers of its frames. [`Gpu::memory_bytes`] counts what all
    /// lights share. Neither counts masks, pipelines, the host's resources and uniforms of a few bytes. A
    /// [`MemoryPlan`](crate::MemoryPlan) returns the number before anything is allocated.
    pub fn memory_bytes(&self) -> u64 {
        self.keep.memory_bytes()
            + self.technique.memory_bytes()
            + self.parted.as_ref().map_or(0, PartitionedState::memory_bytes)
            + self.denoiser.as_ref().map_or(0, Denoiser::memory_bytes)
    }

    /// Texels along a side of each map of the frame prepared last whose size is [`MapSize::Auto`](crate::contract::MapSize::Auto):
    /// one per part of the light. Empty if sizes are fixed, or the technique has no such map.
    pub fn auto_map_sizes(&self) -> Vec<u32> {
        match self.parts_in_use() {
            Some(parted) => parted.auto_map_sizes().collect(),
            None => self.keep.auto_texels().into_iter().collect(),
        }
    }

    /// Depth maps of the frame prepared last, for inspection once its commands have run: those of each part of the light, with
    /// layers behind and levels. Empty for techniques that store no depths.
    pub fn drawn_maps(&self) -> Vec<DrawnMap> {
        match self.parts_in_use() {
            Some(parted) => parted.drawn_maps().collect(),
            None => self.technique.drawn_maps(),
        }
    }

    /// Lists per texel of the frame prepared last, for inspection once its commands have run: those of each part of the light.
    /// Empty for techniques without lists.
    pub fn drawn_lists(&self) -> Vec<DrawnLists> {
        match self.parts_in_use() {
            Some(parted) => parted.drawn_lists().collect(),
            None => self.technique.drawn_lists(),
        }
    }

    /// Overflow of the newest finished frame that the last [`prepare`](Self::prepare) knew of. That call has made room for it.
    pub fn overflow(&self) -> Option<Overflow> {
        match self.parts_in_use() {
            Some(parted) => parted.overflow(),
            None => self.technique.overflow(),
        }
    }
}

/// Passes of one frame; `P` is the technique's prepared work.
struct Passes<'a, P> {
    casters: FrameCasters<'a>,
    conversions: Conversions<'a>,
    light: LightPasses<'a, P>,
    /// `Some` if the technique's visibility is noisy.
    smoothing: Option<PreparedSmoothing>,
    /// `Some` if there is a shadow distance.
    fade: Option<PreparedFade>,
    /// `Some` if the technique writes a mask of half the size.
    half: Option<PreparedHalf>,
    /// `Some` if the mask is denoised.
    denoise: Option<PreparedDenoise>,
}

/// Passes from the light to its mask.
enum LightPasses<'a, P> {
    /// One view covers what the light reaches.
    Whole(P),
    /// Several views cover it, each with a mask that is joined to the light's.
    Parts(Box<PartitionedPasses<'a, P>>),
}

/// Prepared frame of one light. It must be dropped before what it borrows: declare a list of them after their casters.
#[must_use = "`prepare` draws nothing until its result is recorded"]
pub struct Prepared<'a> {
    work: Box<dyn Work + 'a>,
}

impl fmt::Debug for Prepared<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Prepared").field(self.work.request()).finish()
    }
}

impl Prepared<'_> {
    /// Overflow of the newest finished frame, as far as known; this frame has room for as much.
    pub fn overflow(&self) -> Option<Overflow> {
        self.work.overflow()
    }

    /// Records the frame's uploads and passes; none if the mask already holds this frame.
    pub fn record(self, recorder: &mut Recorder<'_>) {
        self.work.record(recorder);
    }
}

/// Object-safe form of a frame's work.
trait Work: wgpu::WasmNotSendSync {
    fn request(&self) -> &dyn fmt::Debug;
    fn overflow(&self) -> Option<Overflow>;
    fn record(self: Box<Self>, recorder: &mut Recorder<'_>);
}

/// A light's state while a frame of it waits to be recorded.
struct FrameWork<'a, T: Technique> {
    shadow: &'a mut Shadow<T>,
    request: FrameRequest<'a>,
    /// `None` if the mask already holds the frame.
    passes: Option<(StagedUploads, Passes<'a, T::Prepared>)>,
}

impl<T: Technique> Work for FrameWork<'_, T> {
    fn request(&self) -> &dyn fmt::Debug {
        &self.request
    }
    fn overflow(&self) -> Option<Overflow> {
        self.shadow.overflow()
    }
    fn record(self: Box<Self>, recorder: &mut Recorder<'_>) {
        let Some((uploads, passes)) = self.passes else { return };
        self.shadow.is_recorded = true;
        if self.shadow.gpu.device.is_planned() {
            return;
        }
        recorder.upload(uploads, self.shadow.commands.end());
        recorder.joining_compute_passes(|recorder| self.shadow.record_passes(recorder, &self.request, passes));
    }
}
