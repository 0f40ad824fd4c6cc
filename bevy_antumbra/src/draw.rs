//! A view's masks: after its depth is there, and before it is shaded.

use std::collections::HashMap;

use antumbra::light::Aabb;
use antumbra::{AnyShadow, Casters, DepthConvention, Frame, Gpu, MaskChannels, Receivers, Recorder};
use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::ExtractedView;

use crate::casters::CasterStore;
use crate::convert::mat4;
use crate::lights::{LightLayers, MaskLayers, ShadowLight, ShadowLights};
use crate::masks::{MaskWriter, ScratchMask, ViewMasks};
use crate::normals::{NormalDeriver, NormalSources, Normals};
use crate::seen::{Seen, SeenGatherer};
use crate::settings::SoftShadows;
use crate::warnings::Warnings;

/// Frames after which what was not used is dropped.
const KEPT_FRAMES: u64 = 8;

/// States of all lights in all views, and what their masks are written to.
#[derive(Resource)]
pub struct Shadows {
    pub gpu: Gpu,
    pub views: EntityHashMap<ViewMasks>,
    pub frame: u64,
    writer: MaskWriter,
    /// By light and view.
    states: HashMap<(Entity, Entity), State>,
    scratch: Vec<(ScratchMask, u64)>,
    /// Views of depth textures, since Bevy's are not always the same ones from frame to frame.
    depths: EntityHashMap<(wgpu::Texture, wgpu::TextureView)>,
    deriver: NormalDeriver,
    normals: EntityHashMap<Normals>,
    gatherer: SeenGatherer,
    seen: EntityHashMap<Seen>,
}

/// A light's state in a view.
struct State {
    shadow: AnyShadow,
    settings: SoftShadows,
    seen: u64,
}

/// What holds where lights have no settings of their own.
#[derive(Resource, Clone, Default)]
pub struct DefaultSettings {
    /// For all views.
    pub everywhere: SoftShadows,
    /// For single views.
    pub of_views: EntityHashMap<SoftShadows>,
}

impl DefaultSettings {
    /// What a light's shadows are made by in a view.
    pub fn of<'a>(&'a self, light: &'a ShadowLight, view: Entity) -> &'a SoftShadows {
        light.settings.as_ref().or_else(|| self.of_views.get(&view)).unwrap_or(&self.everywhere)
    }
}

/// What a view's lights are drawn with.
struct ViewFrame<'a> {
    entity: Entity,
    depth: wgpu::TextureView,
    origin_px: glam::UVec2,
    view_from_world: glam::Mat4,
    clip_from_view: glam::Mat4,
    casters: &'a CasterStore,
    seen: &'a [glam::Vec3],
    normals: Option<wgpu::TextureView>,
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
            deriver: NormalDeriver::new(gpu.device()),
            normals: EntityHashMap::default(),
            gatherer: SeenGatherer::new(gpu.device()),
            seen: EntityHashMap::default(),
        }
    }

    /// The same view of a depth texture as long as it is the same texture.
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

    /// The place of a scratch mask of a size.
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

    /// A light's state, made where there is none or its technique is another one now.
    fn state(&mut self, key: (Entity, Entity), settings: &SoftShadows) -> Result<&mut State, antumbra::Error> {
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

    /// Records one light's mask into its layers.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        light: &ShadowLight,
        layers: LightLayers,
        settings: &SoftShadows,
        view: &ViewFrame<'_>,
    ) -> Result<(), antumbra::Error> {
        let Some(size_px) = self.views.get(&view.entity).map(|masks| masks.size_px) else { return Ok(()) };
        let channels = if layers.count == 3 { MaskChannels::Three } else { MaskChannels::One };
        let range = layers.first..layers.first + layers.count;
        let bounds = within_range(view.casters.receivers, light);
        let scratch = self.scratch(size_px, channels);
        let outcome = if bounds.is_empty() || view.casters.set.is_empty() {
            Ok(false)
        } else {
            let mask = self.scratch[scratch].0.mask.clone();
            let frame = Frame {
                light: &light.light,
                casters: Casters::Set { set: &view.casters.set, layers: light.caster_layers },
                receivers: Receivers {
                    size_px,
                    origin_px: view.origin_px,
                    depth: &view.depth,
                    depth_convention: DepthConvention::Reversed,
                    view_from_world: view.view_from_world,
                    clip_from_view: view.clip_from_view,
                    normals: view.normals.as_ref(),
                    bounds: Some(bounds),
                    hull: &[],
                    seen: view.seen,
                    version: None,
                },
                mask: &mask,
            };
            let state = self.state((light.entity, view.entity), settings)?;
            state.shadow.prepare(&frame).map(|prepared| {
                prepared.record(&mut Recorder::new(encoder, None));
                true
            })
        };
        let is_drawn = *outcome.as_ref().unwrap_or(&false);
        let Some(masks) = self.views.get(&view.entity) else { return Ok(()) };
        self.writer.record(encoder, masks, range, is_drawn.then(|| &self.scratch[scratch].0));
        outcome.map(|_| ())
    }
}

/// What of a box a light reaches.
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
    mut warnings: ResMut<Warnings>,
    mut context: RenderContext,
) {
    let (Some(mut shadows), Some(casters)) = (shadows, casters) else { return };
    let (entity, extracted, textures, jitter, view_layers) = view.into_inner();
    let Some(depth) = &textures.depth else { return };
    if layers.count == 0 || shadows.views.get(&entity).is_none_or(|masks| masks.seen != shadows.frame) {
        return;
    }
    let shadows = &mut *shadows;
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
    let normals = textures.normal.as_ref().map(|shading| {
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
    let frame = ViewFrame {
        entity,
        depth,
        origin_px,
        view_from_world,
        clip_from_view,
        casters: &casters,
        seen: &seen.points,
        normals,
    };
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
    let (depth, part) = (frame.depth, (origin_px, size_px));
    shadows.gatherer.record(encoder, shadows.gpu.queue(), &mut seen, &depth, part, world_from_clip);
    shadows.seen.insert(entity, seen);
    let oldest = shadows.frame.saturating_sub(KEPT_FRAMES);
    shadows.states.retain(|_, state| state.seen >= oldest);
    shadows.scratch.retain(|(_, seen)| *seen >= oldest);
    let views = &shadows.views;
    shadows.depths.retain(|view, _| views.contains_key(view));
    shadows.seen.retain(|view, _| views.contains_key(view));
    shadows.normals.retain(|view, _| views.contains_key(view));
}

/// Fetches what views see, as far as it has come. After a frame is submitted.
pub fn fetch_seen(shadows: Option<ResMut<Shadows>>) {
    if let Some(mut shadows) = shadows {
        shadows.seen.values_mut().for_each(Seen::advance);
    }
}
