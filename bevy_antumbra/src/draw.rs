//! Drawing of a view's masks, after its depth prepass and before its main pass.

use std::collections::HashMap;
use std::time::Instant;

use antumbra::light::Aabb;
use antumbra::{
    AnyShadow, Casters, DepthConvention, Error, Frame, Gpu, MaskChannels, Receivers, Recorder, SplitReceivers,
};
use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::ExtractedView;

use crate::casters::CasterStore;
use crate::convert::mat4;
use crate::counts::ShadowCounts;
use crate::lights::{DefaultSettings, LightLayers, MaskLayers, ShadowLight, ShadowLights};
use crate::masks::{CachedGroup, MaskWriter, ScratchMask, ViewMasks};
use crate::normals::{NormalDeriver, NormalSources, Normals};
use crate::seen::{Seen, SeenGatherer};
use crate::settings::SoftShadows;
use crate::warnings::Warnings;

/// Number of frames after which unused resources are dropped.
const RETAINED_FRAMES: u64 = 8;

/// States of all lights in all views, and the resources that write their masks.
#[derive(Resource)]
pub struct Shadows {
    pub gpu: Gpu,
    pub views: EntityHashMap<ViewMasks>,
    pub frame: u64,
    pub writer: MaskWriter,
    states: HashMap<StateKey, State>,
    scratch: Vec<(ScratchMask, u64)>,
    /// Cached views of depth textures; Bevy's own can differ from frame to frame.
    depths: EntityHashMap<(wgpu::Texture, wgpu::TextureView)>,
    splits: EntityHashMap<Split>,
    deriver: NormalDeriver,
    normals: EntityHashMap<Normals>,
    gatherer: SeenGatherer,
    seen: EntityHashMap<Seen>,
}

/// Key of a light's state in a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct StateKey {
    light: Entity,
    view: Entity,
    /// Whether this is the state of a view's second image. Both images share one state unless it depends on the last frame.
    is_second: bool,
}

/// A light's state in a view.
struct State {
    shadow: AnyShadow,
    settings: SoftShadows,
    seen: u64,
}

/// Inputs for all lights of a view.
struct ViewFrame<'a> {
    entity: Entity,
    /// Images of the view: one, or two if pixels have several samples: the nearest and the farthest surface of each pixel.
    pictures: Vec<Picture>,
    /// Motion vectors of each pixel, if Bevy draws them.
    motion: Option<wgpu::TextureView>,
    size_px: glam::UVec2,
    view_from_world: glam::Mat4,
    clip_from_view: glam::Mat4,
    casters: &'a CasterStore,
    seen: &'a [glam::Vec3],
}

/// Receivers with one sample per pixel.
#[derive(Clone)]
struct Picture {
    depth: wgpu::TextureView,
    normals: Option<wgpu::TextureView>,
    origin_px: glam::UVec2,
}

impl ViewFrame<'_> {
    fn receivers<'a>(&'a self, picture: &'a Picture, bounds: Option<Aabb>) -> Receivers<'a> {
        let camera = antumbra::Camera {
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            depth_convention: DepthConvention::Reversed,
        };
        Receivers::new(&picture.depth, self.size_px, camera)
            .with_origin_px(picture.origin_px)
            .with_normals(picture.normals.as_ref())
            .with_bounds(bounds)
            .with_seen(self.seen)
    }
}

impl Shadows {
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            gpu: gpu.clone(),
            views: EntityHashMap::default(),
            frame: 0,
            writer: MaskWriter::new(gpu.device()),
            states: HashMap::new(),
            scratch: Vec::new(),
            depths: EntityHashMap::default(),
            splits: EntityHashMap::default(),
            deriver: NormalDeriver::new(gpu.device()),
            normals: EntityHashMap::default(),
            gatherer: SeenGatherer::new(gpu.device()),
            seen: EntityHashMap::default(),
        }
    }

    /// Returns the GPU memory of all states, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.states.values().map(|state| state.shadow.memory_bytes()).sum()
    }

    /// Returns the cached view of a depth texture, or creates it.
    fn depth_view(&mut self, view: Entity, texture: &wgpu::Texture) -> wgpu::TextureView {
        if let Some((kept, depth)) = self.depths.get(&view)
            && kept == texture
        {
            return depth.clone();
        }
        let depth = texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("bevy_antumbra depth"),
            aspect: wgpu::TextureAspect::DepthOnly,
            ..wgpu::TextureViewDescriptor::default()
        });
        self.depths.insert(view, (texture.clone(), depth.clone()));
        depth
    }

    /// Returns the index of a scratch mask of the given size and channels.
    fn scratch(&mut self, size_px: glam::UVec2, channels: MaskChannels) -> usize {
        let fits = |(scratch, _): &(ScratchMask, u64)| {
            scratch.mask.size_px() == size_px && scratch.mask.channels() == channels
        };
        let i = self.scratch.iter().position(fits).unwrap_or_else(|| {
            self.scratch.push((self.writer.scratch(size_px, channels), 0));
            self.scratch.len() - 1
        });
        self.scratch[i].1 = self.frame;
        i
    }

    /// Returns a light's state. Creates it if there is none or its technique has changed.
    fn state(&mut self, key: StateKey, settings: &SoftShadows) -> Result<&mut State, Error> {
        let kept = self.states.remove(&key);
        let state = match kept {
            Some(state) if state.settings == *settings => state,
            Some(mut state) if state.settings.technique == settings.technique => {
                settings.apply(&mut state.shadow)?;
                State { settings: settings.clone(), ..state }
            }
            _ => State { shadow: settings.create(&self.gpu)?, settings: settings.clone(), seen: 0 },
        };
        Ok(self.states.entry(key).insert_entry(State { seen: self.frame, ..state }).into_mut())
    }

    /// Records one light's masks into their layers; fully lit if nothing can be in shadow.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        light: &ShadowLight,
        layers: LightLayers,
        settings: &SoftShadows,
        view: &ViewFrame<'_>,
    ) -> Result<(), Error> {
        let channels = if layers.count == 3 { MaskChannels::Three } else { MaskChannels::One };
        let scratch = self.scratch(view.size_px, channels);
        let mut outcome = Ok(false);
        for (i, picture) in view.pictures.iter().enumerate() {
            if outcome.is_ok() {
                outcome = self.record_picture(encoder, light, settings, view, (picture, i > 0), scratch);
            }
            let Some(masks) = self.views.get(&view.entity) else { return Ok(()) };
            let slots = (layers.first..layers.first + layers.count).map(|mask| masks.slot_of(i as u32, mask));
            let mask = outcome.as_ref().is_ok_and(|is_drawn| *is_drawn).then(|| &self.scratch[scratch].0);
            self.writer.record(encoder, masks, slots, mask);
        }
        outcome.map(|_| ())
    }

    /// Records one light's mask of an image into a scratch mask. Returns false if nothing can be in shadow.
    fn record_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        light: &ShadowLight,
        settings: &SoftShadows,
        view: &ViewFrame<'_>,
        (picture, is_second): (&Picture, bool),
        scratch: usize,
    ) -> Result<bool, Error> {
        let bounds = within_range(view.casters.receivers, light);
        if bounds.is_empty() || view.casters.set.is_empty() {
            return Ok(false);
        }
        let mask = self.scratch[scratch].0.mask.clone();
        let is_second = is_second && settings.denoise.is_some();
        let state = self.state(StateKey { light: light.entity, view: view.entity, is_second }, settings)?;
        state.shadow.set_denoise(settings.denoise.map(|denoise| denoise.of_library(view.motion.clone())));
        let frame = Frame {
            light: &light.light,
            casters: Casters::Set { set: &view.casters.set, layers: light.caster_layers },
            receivers: view.receivers(picture, Some(bounds)),
            mask: &mask,
        };
        state.shadow.prepare(&frame)?.record(&mut Recorder::new(encoder, None));
        Ok(true)
    }

    /// Splits a view of four samples per pixel. Writes both depths to the array, where the shader matches fragments to images.
    fn split(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        entity: Entity,
        view: &ViewFrame<'_>,
        picture: &Picture,
    ) -> Result<Vec<Picture>, Error> {
        let mut split = self.splits.remove(&entity).unwrap_or_else(|| Split::new(&self.gpu));
        let receivers = view.receivers(picture, None);
        let outcome = split.receivers.record(&mut Recorder::new(encoder, None), &receivers);
        let pictures = outcome.map(|()| {
            let of_split = split.receivers.images(&receivers);
            let normals = |i: usize| of_split[i].normals.cloned();
            [0, 1].map(|i| Picture {
                depth: of_split[i].depth.clone(),
                normals: normals(i),
                origin_px: glam::UVec2::ZERO,
            })
        });
        if let (Ok(pictures), Some(masks)) = (&pictures, self.views.get(&entity)) {
            for ((picture, kept), i) in pictures.iter().zip(&mut split.depths).zip(0..) {
                self.writer.record_view(encoder, masks, i, &picture.depth, kept);
            }
        }
        self.splits.insert(entity, split);
        pictures.map(Vec::from)
    }
}

/// Resources that split a view of several samples per pixel.
struct Split {
    receivers: SplitReceivers,
    depths: [CachedGroup; 2],
}

impl Split {
    fn new(gpu: &Gpu) -> Self {
        Self { receivers: SplitReceivers::new(gpu), depths: [None, None] }
    }
}

/// Returns the part of a box within the light's range.
fn within_range(bounds: Aabb, light: &ShadowLight) -> Aabb {
    let Some(range) = light.range.filter(|range| range.is_finite()) else { return bounds };
    let (min, max) = (bounds.min.max(light.light.center - range), bounds.max.min(light.light.center + range));
    if min.cmple(max).all() { Aabb { min, max } } else { Aabb::EMPTY }
}

/// Records the masks of the view that is being rendered.
pub fn draw_masks(
    view: ViewQuery<(Entity, &ExtractedView, &ViewPrepassTextures, Option<&TemporalJitter>, Option<&RenderLayers>)>,
    shadows: Option<ResMut<Shadows>>,
    casters: Option<Res<CasterStore>>,
    lights: Res<ShadowLights>,
    layers: Res<MaskLayers>,
    defaults: Res<DefaultSettings>,
    counts: Res<ShadowCounts>,
    mut warnings: ResMut<Warnings>,
    mut context: RenderContext,
) {
    let began = Instant::now();
    let (Some(mut shadows), Some(casters)) = (shadows, casters) else { return };
    let (entity, extracted, textures, jitter, view_layers) = view.into_inner();
    let Some(depth) = &textures.depth else { return };
    if layers.count == 0 || shadows.views.get(&entity).is_none_or(|masks| masks.seen != shadows.frame) {
        return;
    }
    let shadows = &mut *shadows;
    if let Some(masks) = shadows.views.get(&entity) {
        shadows.writer.record_others(context.command_encoder(), masks);
        if !masks.has_masks() {
            return;
        }
    }
    let viewport = extracted.viewport;
    let mut clip_from_view = extracted.clip_from_view;
    if let Some(jitter) = jitter {
        jitter.jitter_projection(&mut clip_from_view, Vec2::new(viewport.z as f32, viewport.w as f32));
    }
    let depth = shadows.depth_view(entity, &depth.texture.texture);
    let (view_from_world, clip_from_view) =
        (mat4(&extracted.world_from_view.to_matrix().inverse()), mat4(&clip_from_view));
    let (origin_px, size_px) = (glam::UVec2::new(viewport.x, viewport.y), glam::UVec2::new(viewport.z, viewport.w));
    let encoder = context.command_encoder();
    let is_split = depth.texture().sample_count() > 1;
    let normals = textures.normal.as_ref().filter(|_| !is_split).map(|shading| {
        let shading_normals: &wgpu::Texture = &shading.texture.texture;
        let depth = &depth;
        let sources = NormalSources { depth, shading_normals, view_from_world, clip_from_view, origin_px, size_px };
        let kept = shadows.normals.remove(&entity);
        let normals = shadows.deriver.record(encoder, shadows.gpu.queue(), kept, &sources);
        let view = normals.view.clone();
        shadows.normals.insert(entity, normals);
        view
    });
    let kept = shadows.seen.remove(&entity);
    let mut seen = kept.unwrap_or_else(|| shadows.gatherer.start());
    let picture = Picture { depth, normals, origin_px };
    let mut frame = ViewFrame {
        entity,
        pictures: vec![picture.clone()],
        motion: textures
            .motion_vectors
            .as_ref()
            .filter(|_| !is_split)
            .map(|motion| (*motion.texture.default_view).clone()),
        size_px,
        view_from_world,
        clip_from_view,
        casters: &casters,
        seen: &seen.points,
    };
    if is_split {
        match shadows.split(encoder, entity, &frame, &picture) {
            Ok(pictures) => frame.pictures = pictures,
            // The points are read back next frame.
            Err(error) => {
                shadows.seen.insert(entity, seen);
                return warnings.say(error);
            }
        }
    }
    for light in &lights.lights {
        let Some(of_light) = layers.of_lights.get(&light.entity) else { continue };
        let is_seen = light.range.is_some() || view_layers.unwrap_or_default().intersects(&light.render_layers);
        if !is_seen {
            continue;
        }
        let outcome = shadows.record(encoder, light, *of_light, defaults.of(light, entity), &frame);
        warnings.of(outcome);
    }
    let world_from_clip = (clip_from_view * view_from_world).inverse();
    // The split image's depth is in the view's own array.
    let gathered = match shadows.views.get(&entity) {
        Some(masks) if is_split => masks.depth_layer().map(|depth| (depth.clone(), glam::UVec2::ZERO)),
        _ => Some((picture.depth, origin_px)),
    };
    if let Some((depth, origin_px)) = gathered {
        let part = (origin_px, size_px);
        shadows.gatherer.record(encoder, shadows.gpu.queue(), &mut seen, &depth, part, world_from_clip);
    }
    shadows.seen.insert(entity, seen);
    let oldest = shadows.frame.saturating_sub(RETAINED_FRAMES);
    shadows.states.retain(|_, state| state.seen >= oldest);
    shadows.scratch.retain(|(_, seen)| *seen >= oldest);
    let views = &shadows.views;
    shadows.depths.retain(|view, _| views.contains_key(view));
    shadows.seen.retain(|view, _| views.contains_key(view));
    shadows.normals.retain(|view, _| views.contains_key(view));
    shadows.splits.retain(|view, _| views.contains_key(view));
    counts.spend(began);
}

/// Advances the readback of visible points without waiting. Runs after a frame is submitted.
pub fn fetch_seen(shadows: Option<ResMut<Shadows>>) {
    if let Some(mut shadows) = shadows {
        shadows.seen.values_mut().for_each(Seen::advance);
    }
}
