//! Materials other than the standard one: what they say of themselves.

use std::marker::PhantomData;

use bevy::pbr::{ExtendedMaterial, MaterialExtension};
use bevy::prelude::*;
use bevy::render::{Extract, ExtractSchedule, RenderApp};

use super::extract::extract_casters;
use super::surface::{CasterSurface, OwnSurface, OwnSurfaces, is_transparent};

/// A material that says what it does to light that meets it. Those that do not, cast as opaque, whatever they discard.
///
/// Which lights reach a fragment is another matter: every material has shadows on it whose shader calls Bevy's
/// `apply_pbr_lighting`.
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
    /// What it does to light; `None` where it casts nothing at all. Called for each entity in every frame.
    fn caster_surface(&self) -> Option<CasterSurface>;
}

/// As its standard material: an extension may discard fragments or move vertices, which is not known here.
impl<E: MaterialExtension> CasterMaterial for ExtendedMaterial<StandardMaterial, E> {
    fn caster_surface(&self) -> Option<CasterSurface> {
        CasterSurface::of_standard(&self.base)
    }
}

/// Lets entities with a material of the user's cast as the material says. Add it after
/// [`AntumbraPlugin`](crate::AntumbraPlugin), once for each material.
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
