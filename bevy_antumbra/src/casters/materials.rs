//! Caster surfaces of materials other than the standard one.

use std::marker::PhantomData;

use bevy::pbr::{ExtendedMaterial, MaterialExtension};
use bevy::prelude::*;
use bevy::render::{Extract, ExtractSchedule, RenderApp};

use super::extract::extract_casters;
use super::surface::{CasterSurface, OwnSurface, OwnSurfaces, is_transparent};

/// Material that describes how it blocks light. Other materials cast as opaque, whatever they discard.
///
/// Receiving is independent of this trait: every material whose shader calls Bevy's `apply_pbr_lighting` receives shadows.
///
/// ```
/// # use bevy::prelude::*; use bevy::render::render_resource::AsBindGroup; use bevy_antumbra::*;
/// #[derive(Asset, AsBindGroup, Clone, TypePath)]
/// struct Leaves {
///     #[texture(0)]
///     #[sampler(1)]
///     texture: Handle<Image>,
/// }
///
/// impl Material for Leaves {}
///
/// impl CasterMaterial for Leaves {
///     fn caster_surface(&self) -> Option<CasterSurface> {
///         let texture = SurfaceTexture::of(&self.texture);
///         Some(CasterSurface::Masked { texture, alpha_factor: 1.0, cutoff: 0.5 })
///     }
/// }
///
/// # fn add(app: &mut App) {
/// app.add_plugins((MaterialPlugin::<Leaves>::default(), CasterMaterialPlugin::<Leaves>::default()));
/// # }
/// ```
pub trait CasterMaterial: Material {
    /// Returns the surface as a caster; `None` if it casts nothing. Called for each entity in every frame.
    fn caster_surface(&self) -> Option<CasterSurface>;
}

/// Uses the base material. What an extension discards or moves in its shader is unknown here.
impl<E: MaterialExtension> CasterMaterial for ExtendedMaterial<StandardMaterial, E> {
    fn caster_surface(&self) -> Option<CasterSurface> {
        CasterSurface::of_standard(&self.base)
    }
}

/// Plugin that makes entities with the material `M` cast as its [`CasterMaterial`] describes. Add it after
/// [`AntumbraPlugin`](crate::AntumbraPlugin), once per material.
pub struct CasterMaterialPlugin<M>(PhantomData<fn() -> M>);

impl<M> Default for CasterMaterialPlugin<M> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<M: CasterMaterial> Plugin for CasterMaterialPlugin<M> {
    fn build(&self, app: &mut App) {
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        render_app
            .init_resource::<OwnSurfaces>()
            .add_systems(ExtractSchedule, extract_surfaces::<M>.before(extract_casters));
    }
}

fn extract_surfaces<M: CasterMaterial>(
    mut surfaces: ResMut<OwnSurfaces>,
    entities: Extract<Query<(Entity, &MeshMaterial3d<M>)>>,
    materials: Extract<Res<Assets<M>>>,
) {
    let told = |material: &M| OwnSurface {
        casts: material.caster_surface(),
        is_transparent: is_transparent(material.alpha_mode()),
    };
    let surface = |material: &MeshMaterial3d<M>| materials.get(&material.0).map_or_else(OwnSurface::default, told);
    surfaces.0.extend(entities.iter().map(|(entity, material)| (entity, surface(material))));
}
