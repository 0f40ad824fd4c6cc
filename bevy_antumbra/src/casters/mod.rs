//! What casts: Bevy's meshes, kept in the library's set of casters.
//!
//! `extract` says in every frame what there is; `store` compares that with what the set holds and tells it what has come,
//! moved, changed and gone; `mesh` describes a mesh as it lies in Bevy's slabs, from which the set packs it once; `bend` bends
//! meshes with a skeleton or morph targets into buffers of the plugin's own, from which the set packs them whenever they stand
//! otherwise than before. `surface` says what a material does to light, and `materials` asks users' own materials.

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
