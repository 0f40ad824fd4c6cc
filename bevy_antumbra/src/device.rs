//! Initialisation of per-device resources.

use antumbra::Gpu;
use bevy::prelude::*;
use bevy::render::renderer::{RenderDevice, RenderQueue};

use crate::casters::CasterStore;
use crate::draw::Shadows;

/// Creates all per-device resources: at start, and again after Bevy has lost a device.
pub fn init_device(mut commands: Commands, device: Res<RenderDevice>, queue: Res<RenderQueue>) {
    let gpu = Gpu::new(device.wgpu_device(), &queue);
    commands.insert_resource(CasterStore::new(&gpu));
    commands.insert_resource(Shadows::new(&gpu));
}
