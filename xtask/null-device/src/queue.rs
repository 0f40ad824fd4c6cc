//! Queues that complete work at submission. A semaphore is a counter that submissions raise.

use ash::vk::{self, Handle};

use crate::{Function, does_nothing, erased};

/// Returns the replacement of a function of queues, semaphores and fences.
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

/// Returns a pointer to a semaphore's value.
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
    crate::commands::print_submission();
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
                // A binary semaphore has the value zero.
                for (&semaphore, &value) in semaphores.iter().zip(values).filter(|(_, value)| **value > 0) {
                    *value_of(semaphore) = value;
                }
            }
        }
    }
    vk::Result::SUCCESS
}

/// Returns a Vulkan array as a slice; its pointer may be null if it is empty.
unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    // SAFETY: by the caller.
    if count == 0 { &[] } else { unsafe { std::slice::from_raw_parts(first, count as usize) } }
}

/// Returns the structures of a `pNext` chain.
unsafe fn extensions(first: *const std::ffi::c_void) -> impl Iterator<Item = *const vk::BaseInStructure<'static>> {
    let link = |at: *const vk::BaseInStructure<'static>| (!at.is_null()).then_some(at);
    // SAFETY: by the caller, who passes a valid Vulkan chain.
    std::iter::successors(link(first.cast()), move |at| link(unsafe { (**at).p_next }))
}

#[cfg(test)]
mod tests {
    use std::ptr;

    use super::*;

    #[test]
    fn a_submission_raises_its_timeline_semaphores() {
        let mut timeline = vk::SemaphoreTypeCreateInfo::default().initial_value(3);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut timeline);
        let device = vk::Device::null();
        let mut semaphores = [vk::Semaphore::null(); 2];
        let value = |semaphore| {
            let mut value = 0;
            // SAFETY: a semaphore of `create_semaphore`.
            let result = unsafe { semaphore_value(device, semaphore, &mut value) };
            assert_eq!(result, vk::Result::SUCCESS);
            value
        };
        // SAFETY: whole structures, and semaphores that are made before they are used and destroyed last.
        unsafe {
            for semaphore in &mut semaphores {
                assert_eq!(create_semaphore(device, &info, ptr::null(), semaphore), vk::Result::SUCCESS);
            }
            let values = [9, 0];
            let mut raised = vk::TimelineSemaphoreSubmitInfo::default().signal_semaphore_values(&values);
            let submits = [
                vk::SubmitInfo::default(),
                vk::SubmitInfo::default().signal_semaphores(&semaphores).push_next(&mut raised),
            ];
            assert_eq!(submit(vk::Queue::null(), 2, submits.as_ptr(), vk::Fence::null()), vk::Result::SUCCESS);
            assert_eq!(semaphores.map(value), [9, 3]);
            for semaphore in semaphores {
                destroy_semaphore(device, semaphore, ptr::null());
            }
            destroy_semaphore(device, vk::Semaphore::null(), ptr::null());
        }
    }
}
