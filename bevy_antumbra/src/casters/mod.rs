//! Casters: Bevy's meshes, synchronised with the library's caster set.
//!
//! `extract` collects the casters of every frame. `store` compares them with the set's contents and applies the differences.
//! `mesh` describes a mesh in Bevy's slabs, from which the set packs it once. `bend` deforms meshes with a skeleton or morph
//! targets into the plugin's own buffers, from which the set packs them whenever their pose changes. `surface` describes how a
//! material blocks light, and `materials` queries users' own materials.

pub mod bend;
pub mod extract;
pub mod materials;
pub mod mesh;
pub mod morph;
pub mod store;
pub mod surface;

pub use extract::{ExtractedCasters, extract_casters};
pub use materials::{CasterMaterial, CasterMaterialPlugin};
pub use morph::{MorphBoxes, measure_morphs};
pub use store::{CasterStore, sync_casters, update_casters};
pub use surface::{CasterSurface, SurfaceTexture};
