//! Commands, which are not recorded. To count a frame's commands, each prints a line to standard error.

use std::sync::OnceLock;

use ash::vk;

use crate::{Function, does_nothing, erased};

/// Environment variable that enables printing.
const VARIABLE: &str = "ANTUMBRA_NULL_DEVICE_COMMANDS";

fn print(command: &str) {
    static IS_PRINTED: OnceLock<bool> = OnceLock::new();
    if *IS_PRINTED.get_or_init(|| std::env::var_os(VARIABLE).is_some()) {
        eprintln!("@command {command}");
    }
}

/// Prints a submission, which ends a frame's commands.
pub fn print_submission() {
    print("submit");
}

/// Defines functions that print a word and do nothing else.
macro_rules! printed {
    ($($word:ident: $($name:literal)|+,)*) => {
        /// Returns the replacement of a counted command.
        fn counted(name: &[u8]) -> Option<Function> {
            match name {
                $($($name)|+ => {
                    unsafe extern "system" fn $word() -> vk::Result {
                        print(stringify!($word));
                        vk::Result::SUCCESS
                    }
                    erased!($word, unsafe extern "system" fn() -> vk::Result)
                })*
                _ => None,
            }
        }
    };
}

printed! {
    dispatch: b"vkCmdDispatch",
    dispatch_indirect: b"vkCmdDispatchIndirect",
    render_pass: b"vkCmdBeginRenderPass" | b"vkCmdBeginRenderPass2" | b"vkCmdBeginRendering",
    draw: b"vkCmdDraw" | b"vkCmdDrawIndexed" | b"vkCmdDrawIndirect" | b"vkCmdDrawIndexedIndirect",
    copy: b"vkCmdCopyBuffer" | b"vkCmdCopyBufferToImage" | b"vkCmdCopyImage" | b"vkCmdCopyImageToBuffer",
    fill: b"vkCmdFillBuffer" | b"vkCmdClearColorImage" | b"vkCmdClearDepthStencilImage",
    timestamp: b"vkCmdWriteTimestamp" | b"vkCmdWriteTimestamp2",
}

/// Returns the replacement of a function of command buffers.
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
    if name == b"vkCmdPipelineBarrier" {
        return erased!(pipeline_barrier, vk::PFN_vkCmdPipelineBarrier);
    }
    let is_command = is_of_buffers || name.starts_with(b"vkCmd");
    counted(name).or_else(|| if is_command { does_nothing() } else { None })
}

unsafe extern "system" fn pipeline_barrier(
    _: vk::CommandBuffer,
    _: vk::PipelineStageFlags,
    _: vk::PipelineStageFlags,
    _: vk::DependencyFlags,
    memory: u32,
    _: *const vk::MemoryBarrier<'_>,
    buffers: u32,
    _: *const vk::BufferMemoryBarrier<'_>,
    images: u32,
    _: *const vk::ImageMemoryBarrier<'_>,
) {
    // A barrier without memory, buffers and images orders only stages.
    if memory + buffers + images > 0 {
        print("barrier");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_replaced_and_nothing_else() {
        for name in ["vkCmdDispatch", "vkCmdPipelineBarrier", "vkCmdBindPipeline", "vkEndCommandBuffer"] {
            assert!(replaced(name.as_bytes()).is_some(), "{name}");
        }
        for name in ["vkCreateComputePipelines", "vkAllocateCommandBuffers"] {
            assert!(replaced(name.as_bytes()).is_none(), "{name}");
        }
    }
}
