//! Queues whose work is done as soon as it is submitted. A semaphore is the number that submissions raised it to.

use ash::vk::{self, Handle};

use crate::{Function, does_nothing, erased};

pub fn replaced(name: &[u8]) -> Option<Function> {
    match name {
        b"vkCreateSemaphore" => erased!(create_semaphore, vk::PFN_vkCreateSemaphore),
        b"vkDestroySemaphore" => erased!(destroy_semaphore, vk::PFN_vkDestroySemaphore),
        b"vkGetSemaphoreCounterValue" | b"vkGetSemaphoreCounterValueKHR" => {
            erased!(semaphore_value, vk::PFN_vkGetSemaphoreCounterValue)
        }
        b"vkQueueSubmit" => erased!(submit, vk::PFN_vkQueueSubmit),
        b"vkWaitSemaphores"
        | b"vkWaitSemaphoresKHR"
        | b"vkGetFenceStatus"
        | b"vkWaitForFences"
        | b"vkQueueWaitIdle"
        | b"vkDeviceWaitIdle" => does_nothing(),
        _ => None,
    }
}

unsafe extern "system" fn create_semaphore(
    _: vk::Device,
    info: *const vk::SemaphoreCreateInfo<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Semaphore,
) -> vk::Result {
    // SAFETY: by the caller; the handle is this box until it is destroyed.
    unsafe {
        let mut value = 0;
        for extension in extensions((*info).p_next) {
            if (*extension).s_type == vk::StructureType::SEMAPHORE_TYPE_CREATE_INFO {
                value = (*extension.cast::<vk::SemaphoreTypeCreateInfo<'_>>()).initial_value;
            }
        }
        *made = vk::Semaphore::from_raw(Box::into_raw(Box::new(value)) as u64);
    }
    vk::Result::SUCCESS
}

/// A semaphore's value.
fn value_of(semaphore: vk::Semaphore) -> *mut u64 {
    semaphore.as_raw() as *mut u64
}

unsafe extern "system" fn destroy_semaphore(
    _: vk::Device,
    semaphore: vk::Semaphore,
    _: *const vk::AllocationCallbacks<'_>,
) {
    if semaphore != vk::Semaphore::null() {
        // SAFETY: `create_semaphore` made it, and nobody uses it afterwards.
        drop(unsafe { Box::from_raw(value_of(semaphore)) });
    }
}

unsafe extern "system" fn semaphore_value(_: vk::Device, semaphore: vk::Semaphore, value: *mut u64) -> vk::Result {
    // SAFETY: by the caller, and as above.
    unsafe { *value = *value_of(semaphore) };
    vk::Result::SUCCESS
}

unsafe extern "system" fn submit(
    _: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    _: vk::Fence,
) -> vk::Result {
    // SAFETY: by the caller; wgpu submits from one thread at a time.
    unsafe {
        for submit in slice(submits, count) {
            for extension in extensions(submit.p_next) {
                if (*extension).s_type != vk::StructureType::TIMELINE_SEMAPHORE_SUBMIT_INFO {
                    continue;
                }
                let values = &*extension.cast::<vk::TimelineSemaphoreSubmitInfo<'_>>();
                let semaphores = slice(submit.p_signal_semaphores, submit.signal_semaphore_count);
                let values = slice(values.p_signal_semaphore_values, values.signal_semaphore_value_count);
                // A binary semaphore has zero in its place.
                for (&semaphore, &value) in semaphores.iter().zip(values).filter(|(_, value)| **value > 0) {
                    *value_of(semaphore) = value;
                }
            }
        }
    }
    vk::Result::SUCCESS
}

/// An array of Vulkan's, which may be empty and nowhere.
unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    // SAFETY: by the caller.
    if count == 0 { &[] } else { unsafe { std::slice::from_raw_parts(first, count as usize) } }
}

/// The structures of a chain.
unsafe fn extensions(first: *const std::ffi::c_void) -> impl Iterator<Item = *const vk::BaseInStructure<'static>> {
    let link = |at: *const vk::BaseInStructure<'static>| (!at.is_null()).then_some(at);
    // SAFETY: by the caller, who passes a chain as Vulkan has them.
    std::iter::successors(link(first.cast()), move |at| link(unsafe { (**at).p_next }))
}
