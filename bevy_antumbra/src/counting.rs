//! Counting of each frame's lights, casters and memory.

use bevy::prelude::*;

use crate::casters::CasterStore;
use crate::counts::ShadowCounts;
use crate::draw::Shadows;
use crate::lights::ShadowLights;

/// Updates the frame's counts.
pub fn count(
    counts: Res<ShadowCounts>,
    lights: Res<ShadowLights>,
    casters: Option<Res<CasterStore>>,
    shadows: Option<Res<Shadows>>,
) {
    let mut counts = counts.lock();
    counts.lights = lights.lights.len();
    counts.casters = casters.as_ref().map_or(0, |casters| casters.set.len());
    if let (Some(casters), Some(shadows)) = (casters, shadows) {
        counts.objects_created = shadows.gpu.objects_created().total();
        counts.memory_bytes = casters.set.memory_bytes() + shadows.memory_bytes();
    }
}
