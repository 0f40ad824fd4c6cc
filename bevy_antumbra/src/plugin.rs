//! The plugin: schedules of its systems.

use bevy::asset::AssetEventSystems;
use bevy::core_pipeline::prepass::{DepthPrepass, NormalPrepass};
use bevy::core_pipeline::schedule::camera_driver;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::ecs::entity::EntityHashSet;
use bevy::pbr::{LATE_SHADOW_PASS, extract_lights as extract_lights_of_bevy, per_view_shadow_pass, prepare_lights};
use bevy::prelude::*;
use bevy::render::mesh::allocator::MeshAllocatorSettings;
use bevy::render::render_resource::BufferUsages;
use bevy::render::renderer::RenderGraph;
use bevy::render::sync_world::RenderEntity;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems};

use crate::bind_masks::bind_masks;
use crate::casters::surface::OwnSurfaces;
use crate::casters::{
    CasterStore, ExtractedCasters, MorphBoxes, extract_casters, measure_morphs, sync_casters, update_casters,
};
use crate::counting::count;
use crate::counts::ShadowCounts;
use crate::device::init_device;
use crate::draw::{draw_masks, fetch_seen};
use crate::lights::{ColoredLights, DefaultSettings, MaskLayers, ShadowLights, claim_lights, extract_lights};
use crate::patch::{self, Patch};
use crate::settings::{
    BevyMaps, NoSoftShadows, ShadowDenoise, ShadowParameter, ShadowQuality, ShadowTechnique, ShadowValue, SoftShadows,
};
use crate::warnings::Warnings;

/// Plugin of soft shadows for all of Bevy's lights that cast shadows, and for rectangles.
///
/// Add it after `DefaultPlugins`. It requires a [`DepthPrepass`] and a [`NormalPrepass`] on every [`Camera3d`].
#[derive(Clone, Debug, Default)]
pub struct AntumbraPlugin {
    /// Settings of lights and cameras without settings of their own.
    pub settings: SoftShadows,
}

impl Plugin for AntumbraPlugin {
    fn build(&self, app: &mut App) {
        if let Err(error) = self.settings.check() {
            warn!("bevy_antumbra: {error}");
        }
        let counts = ShadowCounts::default();
        app.init_resource::<Patch>()
            .init_resource::<MorphBoxes>()
            .insert_resource(counts.clone())
            .register_type::<SoftShadows>()
            .register_type::<NoSoftShadows>()
            .register_type::<ShadowTechnique>()
            .register_type::<ShadowQuality>()
            .register_type::<ShadowParameter>()
            .register_type::<ShadowValue>()
            .register_type::<ShadowDenoise>()
            .register_type::<BevyMaps>()
            .add_systems(First, patch::apply)
            .add_systems(PostUpdate, measure_morphs.after(AssetEventSystems));
        // An error means that cameras already require the component.
        let _ = app.try_register_required_components::<Camera3d, DepthPrepass>();
        let _ = app.try_register_required_components::<Camera3d, NormalPrepass>();
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        // The library packs meshes from Bevy's slabs, and the deformation pass reads them.
        let mut slabs = render_app.world_mut().get_resource_or_init::<MeshAllocatorSettings>();
        slabs.extra_buffer_usages |= BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        render_app
            .insert_resource(counts)
            .insert_resource(DefaultSettings { everywhere: self.settings.clone(), ..DefaultSettings::default() })
            .init_resource::<ShadowLights>()
            .init_resource::<ColoredLights>()
            .init_resource::<MaskLayers>()
            .init_resource::<ExtractedCasters>()
            .init_resource::<OwnSurfaces>()
            .init_resource::<Warnings>()
            .add_systems(RenderStartup, init_device)
            .add_systems(
                ExtractSchedule,
                (extract_lights.after(extract_lights_of_bevy), extract_casters, extract_camera_settings),
            )
            .add_systems(
                Render,
                (
                    (choose_channels, claim_lights).chain().in_set(RenderSystems::CreateViews).before(prepare_lights),
                    sync_casters.in_set(RenderSystems::PrepareResources),
                    bind_masks.in_set(RenderSystems::PrepareResources),
                    (fetch_seen, count).in_set(RenderSystems::Cleanup),
                ),
            )
            .add_systems(RenderGraph, update_casters.before(camera_driver))
            .add_systems(
                Core3d,
                draw_masks
                    .after(Core3dSystems::Prepass)
                    .after(per_view_shadow_pass::<LATE_SHADOW_PASS>)
                    .before(Core3dSystems::MainPass),
            );
    }
}

/// Extracts the settings of cameras.
fn extract_camera_settings(
    mut defaults: ResMut<DefaultSettings>,
    cameras: Extract<Query<(RenderEntity, &SoftShadows), With<Camera3d>>>,
) {
    defaults.of_views.clear();
    defaults.of_views.extend(cameras.iter().map(|(entity, settings)| (entity, settings.clone())));
}

/// Collects the lights whose masks have three channels: some caster tints, and the technique supports colour.
fn choose_channels(
    lights: Res<ShadowLights>,
    defaults: Res<DefaultSettings>,
    casters: Option<Res<CasterStore>>,
    mut colored: ResMut<ColoredLights>,
) {
    colored.0 = EntityHashSet::default();
    let Some(casters) = casters else { return };
    for light in &lights.lights {
        let knows_color = match &light.settings {
            Some(settings) => settings.technique.knows_color(),
            None => {
                let mut all = defaults.of_views.values().chain([&defaults.everywhere]);
                all.any(|settings| settings.technique.knows_color())
            }
        };
        if knows_color && casters.set.mask_channels(light.caster_layers) == antumbra::MaskChannels::Three {
            colored.0.insert(light.entity);
        }
    }
}
