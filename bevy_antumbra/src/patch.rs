//! Patch of Bevy's lighting shader: four of its lines are multiplied by the masks.
//!
//! Bevy has no hook for visibility, so its shader `pbr_functions.wesl` is changed after loading: each light's contribution is
//! multiplied by the visibility that `patch.wesl` reads from the masks. Materials, bindings and pipelines stay unchanged. The
//! patch covers forward and deferred shading and each material that calls Bevy's lighting. The lines to change are counted. If
//! the counts differ from those expected, nothing is changed: the plugin logs one line, and Bevy's own shadows stay on.

use std::borrow::Cow;

use bevy::prelude::*;
use bevy::shader::{Shader, Source};

use crate::patched::patched;

/// Path of the shader in Bevy's asset server.
const PATH: &str = "embedded://bevy_pbr/render/pbr_functions.wesl";

/// State of the patch: whether masks reach Bevy's image.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Patch {
    /// The shader is not loaded yet.
    #[default]
    Waiting,
    /// Masks reach the image.
    Applied,
    /// Bevy's shader is not the expected one. Bevy's own shadows stay on.
    Refused,
}

/// Patches the shader once it is loaded.
pub fn apply(mut patch: ResMut<Patch>, mut shaders: ResMut<Assets<Shader>>) {
    if *patch != Patch::Waiting {
        return;
    }
    let Some(id) = shaders.iter().find(|(_, shader)| shader.path == PATH).map(|(id, _)| id) else { return };
    let Some(mut shader) = shaders.get_mut(id) else { return };
    let outcome = match &shader.source {
        Source::Wesl(text) => patched(text).map_err(|error| error.to_string()),
        _ => Err("it is not in WESL".to_owned()),
    };
    *patch = match outcome {
        Ok(text) => {
            shader.source = Source::Wesl(Cow::Owned(text));
            Patch::Applied
        }
        Err(error) => {
            warn!(
                "bevy_antumbra: {PATH} differs from that of Bevy 0.20, so soft shadows are off and Bevy's own shadows on: {error}"
            );
            Patch::Refused
        }
    };
}
