//! What belongs to a device.

use antumbra::Gpu;
use bevy::prelude::*;
use bevy::render::renderer::{RenderDevice, RenderQueue};

use crate::casters::CasterStore;
use crate::draw::Shadows;

/// Makes all that belongs to a device: at start, and again where Bevy has lost one.
pub fn init_device(mut commands: Commands, device: Res<RenderDevice>, queue: Res<RenderQueue>) {
    let gpu = Gpu::new(device.wgpu_device(), &queue);
    commands.insert_resource(CasterStore::new(&gpu));
    commands.insert_resource(Shadows::new(&gpu));
}
