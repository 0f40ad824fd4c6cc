//! Conversion of Bevy's lights to the library's, and assignment of mask layers to lights.

use antumbra::light::{Cone, Light, LightShape};
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::entity::EntityHashMap;
use bevy::light::{SunDisk, VolumetricLight};
use bevy::pbr::{ExtractedDirectionalLight, ExtractedPointLight, ExtractedRectLight};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;

use crate::casters::ExtractedCasters;
use crate::convert::vec3;
use crate::layers::layer_bits;
use crate::patch::Patch;
use crate::settings::{BevyMaps, NoSoftShadows, SoftShadows};

/// Light with soft shadows in this frame.
#[derive(Clone, Debug)]
pub struct ShadowLight {
    /// Entity in the render world.
    pub entity: Entity,
    pub light: Light,
    /// Distance beyond which the light does not shine, metres.
    pub range: Option<f32>,
    /// Render layers of the light.
    pub render_layers: RenderLayers,
    /// Render layers as bits of the caster set.
    pub caster_layers: u32,
    /// Settings of the light itself, if it has any.
    pub settings: Option<SoftShadows>,
    /// Depth bias of its own map in Bevy; `None` for kinds of light that Bevy draws no maps for.
    own_bias: Option<f32>,
    /// Whether the light is volumetric: fog needs its map.
    is_volumetric: bool,
}

impl ShadowLight {
    /// Returns the depth bias of Bevy's own map if Bevy has to draw one beside the mask.
    fn map_beside(&self, defaults: &SoftShadows, some_have_no_mask: bool) -> Option<f32> {
        let is_drawn = match self.settings.as_ref().unwrap_or(defaults).maps {
            BevyMaps::WhereNeeded => some_have_no_mask || self.is_volumetric,
            BevyMaps::Always => true,
            BevyMaps::Never => false,
        };
        self.own_bias.filter(|_| is_drawn)
    }
}

/// Settings for lights without settings of their own.
#[derive(Resource, Clone, Default)]
pub struct DefaultSettings {
    /// Settings of all other views.
    pub everywhere: SoftShadows,
    /// Settings of single views.
    pub of_views: EntityHashMap<SoftShadows>,
}

impl DefaultSettings {
    /// Returns the settings of a light in a view.
    pub fn of<'a>(&'a self, light: &'a ShadowLight, view: Entity) -> &'a SoftShadows {
        light.settings.as_ref().or_else(|| self.of_views.get(&view)).unwrap_or(&self.everywhere)
    }
}

/// Lights of this frame, in a stable order.
#[derive(Resource, Default)]
pub struct ShadowLights {
    pub lights: Vec<ShadowLight>,
    /// Depth bias of each light that keeps Bevy's own map.
    left_alone: EntityHashMap<f32>,
    /// Whether masks reach Bevy's image; if not, Bevy draws all shadows.
    are_on: bool,
}

/// Maximum number of mask layers: 7 bits number them, and 0 means none.
pub const MAX_LAYERS: u32 = 127;

/// Mask layers of each light.
#[derive(Resource, Default)]
pub struct MaskLayers {
    pub of_lights: EntityHashMap<LightLayers>,
    /// Number of layers in use.
    pub count: u32,
    /// Whether Bevy draws maps of its own for spots or suns, which share the masks' binding.
    pub are_beside_maps: bool,
    /// Lights with Bevy's own maps in the last frame, with their depth biases.
    with_maps: EntityHashMap<f32>,
}

/// Layers of a light's mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightLayers {
    pub first: u32,
    /// Number of layers: 1, or 3 for red, green and blue.
    pub count: u32,
}

impl LightLayers {
    /// Returns the number that the shader reads; see `patch.wesl`.
    fn number(self) -> u32 {
        (self.first + 1) | if self.count == 3 { 128 } else { 0 }
    }
}

/// Components of every light besides its own.
type Common = (RenderEntity, &'static GlobalTransform, &'static ViewVisibility, Option<&'static RenderLayers>);
/// Components that choose a light's shadows.
type Chosen = (Option<&'static SoftShadows>, Has<NoSoftShadows>, Has<VolumetricLight>);

/// Extracts the lights to the render world. All of them in every frame, because they are few.
pub fn extract_lights(
    patch: Extract<Res<Patch>>,
    mut lights: ResMut<ShadowLights>,
    points: Extract<Query<(Common, Chosen, &PointLight)>>,
    spots: Extract<Query<(Common, Chosen, &SpotLight)>>,
    suns: Extract<Query<(Common, Chosen, &DirectionalLight, Option<&SunDisk>)>>,
    rectangles: Extract<Query<(Common, Chosen, &RectLight)>>,
) {
    lights.lights.clear();
    lights.left_alone.clear();
    lights.are_on = **patch == Patch::Applied;
    if !lights.are_on {
        return;
    }
    let lights = &mut *lights;
    let mut add = |(entity, transform, visibility, layers): (
        Entity,
        &GlobalTransform,
        &ViewVisibility,
        Option<&RenderLayers>,
    ),
                   (settings, is_left_alone, is_volumetric): (Option<&SoftShadows>, bool, bool),
                   (shape, cone, range): (LightShape, Option<Cone>, Option<f32>),
                   own_bias: Option<f32>| {
        if !visibility.get() {
            return;
        }
        if is_left_alone {
            lights.left_alone.extend(own_bias.map(|bias| (entity, bias)));
            return;
        }
        let render_layers = layers.cloned().unwrap_or_default();
        let caster_layers = layer_bits(&render_layers);
        let light = placed(shape, transform, cone, format!("{entity}"));
        let settings = settings.cloned();
        lights.lights.push(ShadowLight {
            entity,
            light,
            range,
            render_layers,
            caster_layers,
            settings,
            own_bias,
            is_volumetric,
        });
    };
    for (common, chosen, light) in points.iter().filter(|(.., light)| light.shadow_maps_enabled) {
        let shape = LightShape::Sphere { radius_m: light.radius.max(0.0) };
        add(common, chosen, (shape, None, Some(light.range)), Some(light.shadow_depth_bias));
    }
    for (common, chosen, light) in spots.iter().filter(|(.., light)| light.shadow_maps_enabled) {
        let shape = LightShape::Disk { radius_m: light.radius.max(0.0) };
        add(common, chosen, (shape, Some(cone_of(light)), Some(light.range)), Some(light.shadow_depth_bias));
    }
    for (common, chosen, light, disk) in suns.iter().filter(|(.., light, _)| light.shadow_maps_enabled) {
        let angular_diameter_rad = disk.cloned().unwrap_or_default().angular_size.max(0.0);
        let shape = LightShape::Sun { angular_diameter_rad };
        add(common, chosen, (shape, None, None), Some(light.shadow_depth_bias));
    }
    for (common, chosen, light) in &rectangles {
        let scale = common.1.scale();
        let size_m = glam::Vec2::new(light.width * scale.x.abs(), light.height * scale.y.abs());
        add(common, chosen, (LightShape::Rectangle { size_m }, None, Some(light.range)), None);
    }
    lights.lights.sort_unstable_by_key(|light| light.entity);
}

/// Returns a spot's cone with Bevy's angles: the outer limited to less than 90°, the inner to less than the outer.
fn cone_of(light: &SpotLight) -> Cone {
    let outer_rad = light.outer_angle.clamp(1e-3, std::f32::consts::FRAC_PI_2 - 1e-4);
    Cone { inner_rad: light.inner_angle.clamp(0.0, 0.999 * outer_rad), outer_rad }
}

/// Returns the light at its entity's transform. Bevy's lights face −z, and its rectangles lie along x and y.
fn placed(shape: LightShape, transform: &GlobalTransform, cone: Option<Cone>, name: String) -> Light {
    let (center, axis) = (vec3(transform.translation()), vec3(transform.forward().as_vec3()));
    let up = vec3(transform.up().as_vec3());
    Light { name, up, cone, axis, ..Light::new(shape, center, center + axis) }
}

/// Assigns mask layers to lights, turns off Bevy's own maps of these lights and stores the layer number where the shader reads
/// it. Turns on the maps of excluded lights, and of lights that need a map for surfaces without a mask.
///
/// Runs in every frame, because Bevy extracts lights only when they change.
pub fn claim_lights(
    lights: Res<ShadowLights>,
    colored: Res<ColoredLights>,
    defaults: Res<DefaultSettings>,
    casters: Res<ExtractedCasters>,
    mut layers: ResMut<MaskLayers>,
    mut points: Query<(Entity, &mut ExtractedPointLight)>,
    mut suns: Query<(Entity, &mut ExtractedDirectionalLight)>,
    mut rectangles: Query<(Entity, &mut ExtractedRectLight)>,
    mut has_warned: Local<bool>,
) {
    if !lights.are_on {
        return;
    }
    let layers = &mut *layers;
    let maps_before = std::mem::replace(&mut layers.with_maps, lights.left_alone.clone());
    layers.with_maps.extend(
        lights.lights.iter().filter_map(|light| {
            Some((light.entity, light.map_beside(&defaults.everywhere, casters.some_have_no_mask)?))
        }),
    );
    give_layers(&lights, &colored, layers, &mut has_warned);
    layers.are_beside_maps = false;
    let number = |entity| layers.of_lights.get(&entity).map_or(0, |layers| layers.number());
    // Returns whether Bevy draws the map, and the bias with the number in it.
    let claim = |entity| {
        let own_bias = layers.with_maps.get(&entity).copied();
        (own_bias.is_some(), numbered(own_bias.unwrap_or(1.0), number(entity)))
    };
    // The layer of a spot's map in Bevy's array depends on the other maps, and Bevy updates it only for changed lights.
    let have_maps_changed = layers.with_maps != maps_before;
    for (entity, mut light) in &mut points {
        if have_maps_changed {
            light.set_changed();
        }
        // Change detection is bypassed, because Bevy would derive its data again for every changed light.
        let light = light.bypass_change_detection();
        (light.shadow_maps_enabled, light.shadow_depth_bias) = claim(entity);
        layers.are_beside_maps |= light.shadow_maps_enabled && light.spot_light_angles.is_some();
    }
    for (entity, mut light) in &mut suns {
        let light = light.bypass_change_detection();
        (light.shadow_maps_enabled, light.shadow_depth_bias) = claim(entity);
        layers.are_beside_maps |= light.shadow_maps_enabled;
    }
    for (entity, mut light) in &mut rectangles {
        light.bypass_change_detection().range = numbered(light.range, number(entity));
    }
}

/// Stores a number in the lowest eight bits of a quantity, which changes it by less than one part in 32 768. Keeps the result
/// away from 0, which a GPU might flush, and from infinity, which with a number would be NaN.
fn numbered(quantity: f32, number: u32) -> f32 {
    let quantity = if quantity.abs() < 1e-6 { 1e-6 } else { quantity.clamp(f32::MIN, f32::MAX) };
    f32::from_bits((quantity.to_bits() & !0xff) | number)
}

/// Assigns layers to each light. Lights beyond the maximum keep Bevy's own maps.
fn give_layers(lights: &ShadowLights, colored: &ColoredLights, layers: &mut MaskLayers, has_warned: &mut bool) {
    layers.of_lights.clear();
    layers.count = 0;
    for light in &lights.lights {
        let count = if colored.0.contains(&light.entity) { 3 } else { 1 };
        if layers.count + count > MAX_LAYERS {
            layers.with_maps.extend(light.own_bias.map(|bias| (light.entity, bias)));
            if !std::mem::replace(has_warned, true) {
                warn!("bevy_antumbra: masks have {MAX_LAYERS} layers; further lights have no soft shadows");
            }
            continue;
        }
        let first = layers.count;
        layers.of_lights.insert(light.entity, LightLayers { first, count });
        layers.count += count;
    }
}

/// Lights whose masks have three channels.
#[derive(Resource, Default)]
pub struct ColoredLights(pub bevy::ecs::entity::EntityHashSet);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_carry_numbers_and_hardly_move() {
        for quantity in [0.02f32, -0.6, 20.0, 0.0, 1e-30] {
            for number in [0, 1, 127, 128 | 125] {
                let with = numbered(quantity, number);
                assert_eq!(with.to_bits() & 0xff, number);
                assert!(with.is_normal() && (with - quantity).abs() <= (quantity.abs() / 32768.0).max(2e-6));
            }
        }
        let endless = numbered(f32::INFINITY, 5);
        assert!(
            endless.is_normal() && endless > 1e38 && endless.to_bits() & 0xff == 5,
            "a rectangle may have an infinite range"
        );
    }

    #[test]
    fn maps_are_drawn_beside_masks_where_something_has_none() {
        let shape = LightShape::Sphere { radius_m: 0.1 };
        let light = |settings: Option<SoftShadows>, own_bias, is_volumetric| ShadowLight {
            entity: Entity::PLACEHOLDER,
            light: Light::new(shape.clone(), glam::Vec3::ZERO, glam::Vec3::X),
            range: None,
            render_layers: RenderLayers::default(),
            caster_layers: 1,
            settings,
            own_bias,
            is_volumetric,
        };
        let defaults = SoftShadows::default();
        let beside = |light: &ShadowLight, some| light.map_beside(&defaults, some);
        let plain = light(None, Some(0.5), false);
        assert_eq!((beside(&plain, false), beside(&plain, true)), (None, Some(0.5)));
        assert_eq!(beside(&light(None, Some(0.5), true), false), Some(0.5), "fog needs it");
        assert_eq!(beside(&light(None, None, true), true), None, "rectangles have no map");
        let never = light(Some(SoftShadows::default().beside(BevyMaps::Never)), Some(0.5), true);
        assert_eq!(beside(&never, true), None);
        let always = light(Some(SoftShadows::default().beside(BevyMaps::Always)), Some(0.5), false);
        assert_eq!(beside(&always, false), Some(0.5));
    }
}
