//! Commands, which are recorded nowhere.

use crate::{Function, does_nothing};

pub fn replaced(name: &[u8]) -> Option<Function> {
    let is_of_buffers = matches!(
        name,
        b"vkBeginCommandBuffer"
            | b"vkEndCommandBuffer"
            | b"vkResetCommandBuffer"
            | b"vkResetCommandPool"
            | b"vkFreeCommandBuffers"
            | b"vkDestroyCommandPool"
    );
    if is_of_buffers || name.starts_with(b"vkCmd") { does_nothing() } else { None }
}
