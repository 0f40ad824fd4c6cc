//! How masks come into Bevy's picture: four lines of its lighting are multiplied by them.
//!
//! Bevy has no place where visibility could be handed in, so its shader `pbr_functions.wesl` is changed as it is loaded:
//! where a light's share is added up, it is multiplied by what `patch.wesl` reads from the
//! masks. Materials, bindings and pipelines stay as they are, forward and deferred shading both come by, and so does each
//! material that calls Bevy's lighting. The lines that are changed are counted, and where there are others than expected
//! nothing is changed: the plugin says so in one line, and Bevy's own shadows stay on.

use std::borrow::Cow;

use bevy::prelude::*;
use bevy::shader::{Shader, Source};

use crate::patched::patched;

/// The shader, as Bevy's asset server knows it.
const PATH: &str = "embedded://bevy_pbr/render/pbr_functions.wesl";

/// Whether masks reach Bevy's picture.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Patch {
    /// The shader is not loaded yet.
    #[default]
    Waiting,
    /// They do.
    Applied,
    /// They do not: Bevy's shader is another one. Bevy's own shadows stay on.
    Refused,
}

/// Changes the shader once it is loaded.
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
                "bevy_antumbra: {PATH} is not that of Bevy 0.20, so that soft shadows stay off and Bevy's own on: {error}"
            );
            Patch::Refused
        }
    };
}
