//! Binds each view's masks in place of Bevy's shadow maps.

use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::pbr::ViewShadowBindings;
use bevy::prelude::*;
use bevy::render::view::{ExtractedView, Msaa};

use crate::draw::Shadows;
use crate::lights::{MAX_LAYERS, MaskLayers};
use crate::masks::{Shape, ViewMasks};
use crate::warnings::Warnings;

/// Replaces Bevy's shadow map binding of each view by its masks. Runs after Bevy creates the maps and before its bind groups.
pub fn bind_masks(
    shadows: Option<ResMut<Shadows>>,
    layers: Res<MaskLayers>,
    mut warnings: ResMut<Warnings>,
    mut views: Query<(Entity, &ExtractedView, &mut ViewShadowBindings, Has<DepthPrepass>, &Msaa)>,
) {
    let Some(mut shadows) = shadows else { return };
    let shadows = &mut *shadows;
    shadows.frame += 1;
    if layers.count == 0 {
        return;
    }
    for (entity, view, mut bindings, has_depth, msaa) in &mut views {
        let samples = msaa.samples();
        let has_masks = has_depth && matches!(samples, 1 | 4);
        if !has_masks {
            let what = if has_depth { "2 or 8 samples per pixel" } else { "no DepthPrepass" };
            let remedy = if has_depth { "Msaa::Sample4 or Msaa::Off" } else { "one" };
            warnings.say(format!("a camera has {what} and therefore no soft shadows: give it {remedy}"));
        }
        let size_px = glam::UVec2::new(view.viewport.z, view.viewport.w);
        // Without a prepass the shader reads no masks. With an unsupported sample count it must find the marker for none.
        if !has_depth || (!has_masks && !layers.are_beside_maps) || size_px.min_element() == 0 {
            continue;
        }
        let device = shadows.gpu.device();
        let maps: Option<&wgpu::Texture> = layers.are_beside_maps.then_some(&*bindings.directional_light_depth_texture);
        let shape = Shape {
            size_px,
            samples,
            tile_px: maps.map_or(size_px, |maps| glam::UVec2::new(maps.width(), maps.height())),
            map_count: maps.map_or(0, wgpu::Texture::depth_or_array_layers),
            mask_count: if has_masks { layers.count } else { 0 },
            max_layers: device.limits().max_texture_array_layers,
        };
        let mut masks = match shadows.views.remove(&entity).filter(|masks| masks.shape.serves(&shape)) {
            Some(masks) => masks,
            // Spare layers avoid a new texture whenever a light is added.
            None => {
                let mask_count = shape.mask_count.next_multiple_of(4).min(MAX_LAYERS);
                ViewMasks::new(device, Shape { mask_count, ..shape })
            }
        };
        let shape = masks.shape;
        if shape.map_count + shape.slot_count() * shape.tiles().element_product() > shape.max_layers {
            warnings.say(format!(
                "the device has {} texture array layers, too few for the masks of all lights besides Bevy's own maps; larger \
                 maps (DirectionalLightShadowMap) take fewer layers",
                shape.max_layers
            ));
        }
        masks.maps = match (maps, masks.maps.take()) {
            (Some(texture), Some(kept)) if kept.texture == *texture => Some(kept),
            (Some(texture), _) => Some(shadows.writer.maps(texture)),
            (None, _) => None,
        };
        bindings.directional_light_depth_texture_view = masks.array.clone();
        masks.seen = shadows.frame;
        shadows.views.insert(entity, masks);
    }
    let frame = shadows.frame;
    shadows.views.retain(|_, masks| masks.seen + 8 > frame);
}
