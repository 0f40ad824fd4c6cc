//! One side of the image on the GPU: a technique's state for every light, masks, shaded image, times.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use antumbra::{
    AnyShadow, Casters, DrawnLists, DrawnMap, Frame, Gpu, Mask, MaskChannels, Recorder, TechniqueKind, WarmUp,
};
use antumbra_light::Light;
use antumbra_render::gpu_scene::GpuScene;
use antumbra_render::receivers::ReceiverImages;
use antumbra_render::shading::{PictureTargets, Shading, VisibilitySource};
use glam::UVec2;
use web_time::Instant;

use super::antialiasing::{StillSide, mask_format};
use super::light_map::{MapChoices, ShownMap, of_point};
use super::lists::level_of;
use super::refusals::Refusals;
use super::side_readings::SideReadings;
use super::texture_reader::TextureReader;
use super::times::{FrameClock, FrameTimes, Times};
use super::{Compile, Wake};
use crate::background::run_in_background;
use crate::state::{Show, Side};

/// Maximum number of techniques that a side compiles at a time: the chosen one and a former choice. On software devices
/// each takes hundreds of megabytes, and a slow one takes a minute.
const MAX_COMPILERS: usize = 2;

/// A side's state on the GPU.
#[derive(Debug)]
pub struct SideWork {
    /// State of the technique, one per light; empty until the first technique is ready.
    shadows: Vec<AnyShadow>,
    /// The technique that is being compiled.
    compiling: Option<Compiling>,
    /// Reference held by every compilation, including abandoned ones.
    compilers: Arc<()>,
    masks: Vec<Mask>,
    targets: PictureTargets,
    clock: FrameClock,
    /// Times of the last frames.
    pub times: Times,
    /// Technique that could not be created, and the reason.
    refused: Option<(TechniqueKind, String)>,
    /// Reason why the technique could not draw the last frame.
    failed: Option<String>,
    /// Device errors of the side's work.
    refusals: Refusals,
    /// Overflow of the last frame, as text.
    pub overflow: Option<String>,
    /// Texels along a side of each map whose size was chosen for the last frame.
    auto_map_sizes: Vec<u32>,
    /// Reader of the selected light's mask.
    pub mask_reader: TextureReader,
    list_reader: TextureReader,
    /// Of the shown lists: length of the longest list, and sum of all lengths.
    list_totals: Option<[u32; 2]>,
}

#[derive(Debug)]
struct Compiling {
    kind: TechniqueKind,
    result: Receiver<Result<AnyShadow, String>>,
}

/// Inputs of a side.
#[derive(Clone, Copy, Debug)]
pub struct SideFrame<'a> {
    /// Casters.
    pub scene: &'a GpuScene,
    /// Receivers.
    pub images: &'a ReceiverImages,
    /// Shading of the receivers by the lights.
    pub shading: &'a Shading,
    /// The lights.
    pub lights: &'a [Light],
}

impl SideWork {
    /// Creates a side without a technique, for images of `size_px`.
    pub fn new(gpu: &Gpu, size_px: UVec2) -> Self {
        Self {
            shadows: Vec::new(),
            compiling: None,
            compilers: Arc::new(()),
            masks: Vec::new(),
            targets: PictureTargets::new(gpu.device(), size_px),
            clock: FrameClock::new(gpu),
            times: Times::default(),
            refused: None,
            failed: None,
            refusals: Refusals::default(),
            overflow: None,
            auto_map_sizes: Vec::new(),
            mask_reader: TextureReader::default(),
            list_reader: TextureReader::default(),
            list_totals: None,
        }
    }

    /// Resizes the images; images and masks must be drawn again.
    pub fn resize(&mut self, gpu: &Gpu, size_px: UVec2) {
        self.targets = PictureTargets::new(gpu.device(), size_px);
        self.masks.clear();
        self.mask_reader = TextureReader::default();
    }

    /// The technique that draws; `None` before one is ready.
    pub fn kind(&self) -> Option<TechniqueKind> {
        self.shadows.first().map(AnyShadow::kind)
    }

    /// The technique that is being compiled.
    pub fn compiling(&self) -> Option<TechniqueKind> {
        self.compiling.as_ref().map(|compiling| compiling.kind)
    }

    /// Number of techniques that are being compiled, including abandoned ones.
    #[cfg(test)]
    pub(super) fn compilers(&self) -> usize {
        Arc::strong_count(&self.compilers) - 1
    }

    /// Reason why the side's technique does not draw. The image then shows the last success.
    pub fn problem(&self) -> Option<&str> {
        self.refused.as_ref().map(|(_, why)| why.as_str()).or(self.failed.as_deref())
    }

    /// Measurements of the side, with its error against the ground truth.
    pub(crate) fn readings(&self, rmse: Option<f64>) -> SideReadings<'_> {
        SideReadings {
            compiling: self.compiling(),
            problem: self.problem(),
            overflow: self.overflow.as_deref(),
            times: &self.times,
            memory_bytes: self.memory_bytes(),
            auto_map_sizes: &self.auto_map_sizes,
            rmse,
        }
    }

    /// GPU memory that the technique holds for all lights, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.shadows.iter().map(AnyShadow::memory_bytes).sum()
    }

    /// Shaded image, linear display values.
    pub fn picture(&self) -> &wgpu::Texture {
        &self.targets.picture
    }

    /// Every light's mask and the shaded image; `None` before a technique has drawn them.
    pub(super) fn still(&self) -> Option<StillSide<'_>> {
        let are_drawn = !self.shadows.is_empty() && !self.masks.is_empty();
        are_drawn.then_some(StillSide { masks: &self.masks, picture: &self.targets.picture })
    }

    /// A light's mask; `None` before it is drawn.
    pub fn mask(&self, light: usize) -> Option<&Mask> {
        self.masks.get(light)
    }

    /// Depth maps drawn for a light; empty if the technique has none.
    pub fn drawn_maps(&self, light: usize) -> Vec<DrawnMap> {
        self.shadows.get(light).map(AnyShadow::drawn_maps).unwrap_or_default()
    }

    /// Numbers of choices in a view of a light's maps or lists.
    pub fn map_choices(&self, show: Show, light: usize) -> MapChoices {
        match show {
            Show::LightMap => MapChoices::of(&self.drawn_maps(light)),
            Show::Lists => MapChoices { levels: self.list_levels(light), ..MapChoices::default() },
            _ => MapChoices::default(),
        }
    }

    /// Returns a level and a layer of a light's maps. If light samples have maps, `layer` selects the sample.
    pub fn shown_maps(&self, light: usize, level: usize, layer: usize) -> Vec<ShownMap> {
        of_point(self.drawn_maps(light), layer).into_iter().map(|map| ShownMap::of(map, level, layer)).collect()
    }

    /// Describes a light's depth maps in one line.
    pub fn map_line(&self, light: usize, level: usize, layer: usize) -> Option<String> {
        let kind = self.kind()?;
        let choices = MapChoices::of(&self.drawn_maps(light));
        let shown = self.shown_maps(light, level, layer);
        let maps: Vec<&DrawnMap> = shown.iter().map(|shown| &shown.map).collect();
        let Some(first) = shown.first() else {
            return Some(format!("{kind} uses no shadow map"));
        };
        let count = if maps.len() > 1 { format!("{} maps of ", maps.len()) } else { String::new() };
        let which = first.which(choices);
        if first.is_filtered() {
            let UVec2 { x, y } = first.size_px;
            return Some(format!(
                "{kind}: {count}{x} × {y} texels{which}; bright where the first channel is smallest, dark where it is largest"
            ));
        }
        let samples = match first.map.sample_count {
            count if count > 1 && !first.is_level() => format!(" with {count} samples each"),
            _ => String::new(),
        };
        // These techniques keep the light samples' maps in a buffer.
        let made = if matches!(kind, TechniqueKind::Reprojection | TechniqueKind::ReprojectionLayered) {
            " from the light's centre; the maps of the light samples are not shown"
        } else {
            ""
        };
        let nearest_m = maps.iter().map(|map| map.range_m[0]).fold(f32::INFINITY, f32::min);
        let farthest_m = maps.iter().map(|map| map.range_m[1]).fold(f32::NEG_INFINITY, f32::max);
        let UVec2 { x, y } = first.size_px;
        Some(format!(
            "{kind}: {count}{x} × {y} texels{samples}{which}{made}; bright at {nearest_m:.2} m, dark at {farthest_m:.2} m along the light's axis"
        ))
    }

    /// Lists per texel of a light; empty if the technique has none.
    pub fn drawn_lists(&self, light: usize) -> Vec<DrawnLists> {
        self.shadows.get(light).map(AnyShadow::drawn_lists).unwrap_or_default()
    }

    /// Number of levels of a light's lists.
    pub fn list_levels(&self, light: usize) -> usize {
        self.drawn_lists(light).iter().map(|lists| lists.levels.len()).max().unwrap_or(0)
    }

    /// Starts the readback of the lists' totals that the encoder's commands compute; `None` without lists.
    pub(super) fn read_list_totals(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        totals: Option<&wgpu::Buffer>,
    ) {
        self.list_totals = None;
        self.list_reader = TextureReader::default();
        if let Some(totals) = totals {
            self.list_reader.record_words(gpu, encoder, totals, 2, 0);
        }
    }

    /// Whether totals of lists are in flight or not yet taken.
    pub(super) fn are_list_totals_awaited(&self) -> bool {
        self.list_reader.is_pending()
    }

    /// Of the lists shown last: length of the longest list and sum of all lengths; `None` until they are read back.
    pub fn list_totals(&self) -> Option<[u32; 2]> {
        self.list_totals
    }

    /// Describes a level of a light's lists in one line.
    pub fn lists_line(&self, light: usize, level: usize) -> Option<String> {
        let kind = self.kind()?;
        let lists = self.drawn_lists(light);
        let Some((first, (index, shown))) = lists.first().and_then(|first| Some((first, level_of(first, level)?)))
        else {
            return Some(format!("{kind} has no lists"));
        };
        let count = if lists.len() > 1 { format!("{} maps of ", lists.len()) } else { String::new() };
        let levels = first.levels.len();
        let level = if levels > 1 { format!(", level {} of {levels}", index + 1) } else { String::new() };
        let totals = self.list_totals.map_or_else(String::new, |[longest, sum]| {
            format!("; {sum} {} in total; the longest list, in yellow, has {longest}", first.listed)
        });
        let UVec2 { x, y } = shown.size_texels;
        Some(format!("{kind}: {count}{x} × {y} lists of {}{level}{totals}", first.listed))
    }

    /// Whether a readback, a compilation or a device error is pending.
    pub fn is_busy(&self) -> bool {
        let is_reading = self.clock.is_busy() || self.mask_reader.is_waiting();
        is_reading || self.compiling.is_some() || self.refusals.is_pending()
    }

    /// Collects completed readbacks and compilations. Returns whether the side must be drawn again.
    pub fn collect(&mut self, gpu: &Gpu) -> bool {
        if let Some(late) = self.refusals.take() {
            self.begin_anew(gpu);
            self.failed = Some(late);
        }
        if let Some(read) = self.list_reader.take() {
            self.list_totals = read.u32s().try_into().ok();
        }
        if let Some(times) = self.clock.take() {
            self.times.push(times);
        }
        let Some(compiling) = &self.compiling else { return false };
        let outcome = match compiling.result.try_recv() {
            Err(TryRecvError::Empty) => return false,
            Err(TryRecvError::Disconnected) => {
                Err(format!("{}: the compilation ended without a result", compiling.kind))
            }
            Ok(outcome) => outcome,
        };
        let kind = compiling.kind;
        self.compiling = None;
        match outcome {
            Ok(shadow) => {
                self.shadows = vec![shadow];
                self.times.clear();
                self.failed = None;
            }
            Err(why) => self.refused = Some((kind, why)),
        }
        true
    }

    /// Starts compiling the side's technique unless it is ready or being compiled.
    pub fn request(&mut self, gpu: &Gpu, side: &Side, what: WarmUp, compile: &Compile) {
        let wanted = side.kind();
        if self.refused.as_ref().is_some_and(|(kind, _)| *kind == wanted) {
            return;
        }
        self.refused = None;
        let coming = self.compiling().or(self.kind());
        if coming == Some(wanted) {
            return;
        }
        // Drivers cannot cancel a compilation. A user who scrolls through the techniques leaves some behind; the next one
        // waits until one is done.
        if Arc::strong_count(&self.compilers) > MAX_COMPILERS {
            return;
        }
        let compiler = self.compilers.clone();
        let for_collect = gpu.clone();
        let (gpu, side) = (gpu.clone(), side.clone());
        let refusals = self.refusals.clone();
        let make = move || {
            refusals.watch(&gpu, || {
                let mut shadow = side.kind().create(&gpu).map_err(|error| error.to_string())?;
                set_params(&mut shadow, &side);
                shadow.warm_up(what).map_err(|error| error.to_string())?;
                Ok(shadow)
            })
        };
        let (sender, result) = channel();
        self.compiling = Some(Compiling { kind: wanted, result });
        match compile {
            Compile::AtOnce => {
                // Sending succeeds, because `self` holds the receiver.
                let _ = sender.send(make());
                self.collect(&for_collect);
            }
            Compile::Background(wake) => {
                let wake: Wake = wake.clone();
                run_in_background(move || {
                    let made = make();
                    // This drop precedes the send, because the recipient may start another compilation.
                    drop(compiler);
                    // The receiver is gone if another technique was chosen meanwhile.
                    let _ = sender.send(made);
                    wake();
                });
            }
        }
    }

    /// Draws and submits masks, and records the shaded image. On failure both stay unchanged and [`problem`](Self::problem)
    /// returns the reason.
    pub fn draw(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, side: &Side, frame: &SideFrame<'_>) {
        match self.masks_commands(gpu, side, frame) {
            Ok(commands) => gpu.queue().submit([commands]),
            Err(_) => return,
        };
        let is_ready = !self.shadows.is_empty();
        let source = |mask| if is_ready { VisibilitySource::Mask(mask) } else { VisibilitySource::Lit };
        let sources: Vec<_> = self.masks.iter().map(source).collect();
        frame.shading.record(gpu, encoder, frame.images, &sources, &self.targets);
    }

    /// Returns the commands that draw every light's mask, in an encoder of their own, so that a device error affects nothing else.
    pub(super) fn masks_commands(
        &mut self,
        gpu: &Gpu,
        side: &Side,
        frame: &SideFrame<'_>,
    ) -> Result<wgpu::CommandBuffer, String> {
        let result = self.refusals.clone().watch(gpu, || {
            self.fit_shadows(gpu, side, frame)?;
            self.fit_masks(gpu, side, frame);
            let descriptor = wgpu::CommandEncoderDescriptor { label: Some("viewer: masks") };
            let mut encoder = gpu.device().create_command_encoder(&descriptor);
            self.record_masks(gpu, &mut encoder, frame)?;
            Ok(encoder.finish())
        });
        self.failed = result.as_ref().err().cloned();
        if result.is_err() {
            self.begin_anew(gpu);
        }
        result
    }

    /// Recreates the technique's state after a device error, which may have left it incomplete. Pipelines stay cached, so this is cheap.
    fn begin_anew(&mut self, gpu: &Gpu) {
        if let Some(kind) = self.kind() {
            self.shadows = self.shadows.iter().filter_map(|_| kind.create(gpu).ok()).collect();
            self.clock = FrameClock::new(gpu);
        }
    }

    /// Creates the state for each light and sets the side's parameters.
    fn fit_shadows(&mut self, gpu: &Gpu, side: &Side, frame: &SideFrame<'_>) -> Result<(), String> {
        let Some(kind) = self.kind() else { return Ok(()) };
        while self.shadows.len() < frame.lights.len() {
            self.shadows.push(kind.create(gpu).map_err(|error| error.to_string())?);
        }
        self.shadows.truncate(frame.lights.len());
        // While the chosen technique compiles, the former one keeps its parameters.
        if kind == side.kind() {
            for shadow in &mut self.shadows {
                set_params(shadow, side);
            }
        }
        Ok(())
    }

    /// Creates masks of the right size and number of channels, one per light.
    fn fit_masks(&mut self, gpu: &Gpu, side: &Side, frame: &SideFrame<'_>) {
        let is_colored = side.params().any(|(spec, value)| spec.colors_mask(value));
        let casters = frame.scene.casters();
        let casters = Casters::Meshes(&casters);
        let channels = if is_colored { MaskChannels::Three } else { casters.mask_channels() };
        let format = mask_format(channels);
        self.masks.retain(|mask| mask.channels() == channels && mask.size_px() == frame.images.size_px);
        self.masks.truncate(frame.lights.len());
        while self.masks.len() < frame.lights.len() {
            self.masks.push(Mask::with_format(gpu.device(), frame.images.size_px, channels, format));
        }
    }

    fn record_masks(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &SideFrame<'_>,
    ) -> Result<(), String> {
        let began = Instant::now();
        let made_before = gpu.objects_created();
        let casters = frame.scene.casters_of_lights();
        let mut works = Vec::new();
        for ((shadow, light), mask) in self.shadows.iter_mut().zip(frame.lights).zip(&self.masks) {
            let casters = Casters::Meshes(casters.of(light));
            let work = shadow.prepare(&Frame { light, casters, receivers: frame.images.receivers(), mask });
            works.push(work.map_err(|error| error.to_string())?);
        }
        if works.is_empty() {
            return Ok(());
        }
        self.overflow = works.iter().find_map(|work| work.overflow()).map(|overflow| overflow.to_string());
        let is_timed = !self.clock.is_busy();
        let mut recorder = Recorder::new(encoder, self.clock.timer());
        for work in works {
            work.record(&mut recorder);
        }
        self.auto_map_sizes = self.shadows.iter().flat_map(AnyShadow::auto_map_sizes).collect();
        let processor_ms = began.elapsed().as_secs_f64() * 1e3;
        let has_made = gpu.objects_created() != made_before;
        let frame = FrameTimes { passes: Vec::new(), processor_ms, has_made };
        if is_timed {
            self.clock.record(encoder, frame.clone());
        }
        if !self.clock.is_busy() {
            // Without timestamps only the CPU's time is known.
            self.times.push(frame);
        } else if !is_timed && has_made {
            // This frame is not timed on the GPU, but earlier times are obsolete.
            self.times.push(frame);
        }
        Ok(())
    }
}

/// Sets the side's parameters, which the side has validated.
fn set_params(shadow: &mut AnyShadow, side: &Side) {
    for (spec, value) in side.params() {
        // A side accepts valid values only.
        let set = shadow.set(spec.key, &value.to_string());
        debug_assert!(set.is_ok(), "{set:?}");
    }
}
