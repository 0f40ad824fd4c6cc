//! What casts: Bevy's meshes, kept in the library's set of casters.
//!
//! `extract` says in every frame what there is; `store` compares that with what the set holds and tells it what has come,
//! moved, changed and gone; `mesh` describes a mesh as it lies in Bevy's slabs, from which the set packs it once; `skin` bends
//! meshes with a skeleton into buffers of the plugin's own, from which the set packs them in every frame.

pub mod extract;
pub mod mesh;
pub mod skin;
pub mod store;
pub mod surface;

pub use extract::{ExtractedCasters, extract_casters};
pub use store::{CasterStore, sync_casters, update_casters};
