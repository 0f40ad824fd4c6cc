//! Memory types that a device without hardware lacks, and images that are mere handles.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use ash::vk;

use crate::{Function, does_nothing, erased};

/// Memory types; the wrapped driver allocates all of them from the processor's memory.
const TYPES: [vk::MemoryPropertyFlags; 3] = [
    vk::MemoryPropertyFlags::DEVICE_LOCAL,
    vk::MemoryPropertyFlags::from_raw(
        vk::MemoryPropertyFlags::HOST_VISIBLE.as_raw() | vk::MemoryPropertyFlags::HOST_COHERENT.as_raw(),
    ),
    vk::MemoryPropertyFlags::from_raw(
        vk::MemoryPropertyFlags::HOST_VISIBLE.as_raw()
            | vk::MemoryPropertyFlags::HOST_COHERENT.as_raw()
            | vk::MemoryPropertyFlags::HOST_CACHED.as_raw(),
    ),
];
const ALL_TYPES: u32 = (1 << TYPES.len()) - 1;
const HEAP_BYTES: u64 = 8 << 30;

static PROPERTIES: OnceLock<vk::PFN_vkGetPhysicalDeviceMemoryProperties> = OnceLock::new();
static PROPERTIES_2: OnceLock<vk::PFN_vkGetPhysicalDeviceMemoryProperties2> = OnceLock::new();
static BUFFER_NEEDS: OnceLock<vk::PFN_vkGetBufferMemoryRequirements> = OnceLock::new();
static BUFFER_NEEDS_2: OnceLock<vk::PFN_vkGetBufferMemoryRequirements2> = OnceLock::new();

/// Returns the replacement of an instance's function.
pub fn of_instance(name: &[u8], real: Function) -> Option<Function> {
    match name {
        b"vkGetPhysicalDeviceMemoryProperties" => {
            // SAFETY: the function of that name has that type.
            PROPERTIES.get_or_init(|| unsafe { std::mem::transmute(real) });
            erased!(properties, vk::PFN_vkGetPhysicalDeviceMemoryProperties)
        }
        b"vkGetPhysicalDeviceMemoryProperties2" | b"vkGetPhysicalDeviceMemoryProperties2KHR" => {
            // SAFETY: as above.
            PROPERTIES_2.get_or_init(|| unsafe { std::mem::transmute(real) });
            erased!(properties_2, vk::PFN_vkGetPhysicalDeviceMemoryProperties2)
        }
        _ => None,
    }
}

/// Returns the replacement of a device's function.
pub fn replaced(name: &[u8], real: Function) -> Option<Function> {
    match name {
        b"vkGetBufferMemoryRequirements" => {
            // SAFETY: the function of that name has that type.
            BUFFER_NEEDS.get_or_init(|| unsafe { std::mem::transmute(real) });
            erased!(buffer_needs, vk::PFN_vkGetBufferMemoryRequirements)
        }
        b"vkGetBufferMemoryRequirements2" | b"vkGetBufferMemoryRequirements2KHR" => {
            // SAFETY: as above.
            BUFFER_NEEDS_2.get_or_init(|| unsafe { std::mem::transmute(real) });
            erased!(buffer_needs_2, vk::PFN_vkGetBufferMemoryRequirements2)
        }
        b"vkCreateImage" => erased!(create_image, vk::PFN_vkCreateImage),
        b"vkCreateImageView" => erased!(create_image_view, vk::PFN_vkCreateImageView),
        b"vkCreateFramebuffer" => erased!(create_framebuffer, vk::PFN_vkCreateFramebuffer),
        b"vkGetImageMemoryRequirements" => erased!(image_needs, vk::PFN_vkGetImageMemoryRequirements),
        b"vkGetImageMemoryRequirements2" | b"vkGetImageMemoryRequirements2KHR" => {
            erased!(image_needs_2, vk::PFN_vkGetImageMemoryRequirements2)
        }
        b"vkBindImageMemory"
        | b"vkDestroyImage"
        | b"vkDestroyImageView"
        | b"vkDestroyFramebuffer"
        | b"vkUpdateDescriptorSets" => does_nothing(),
        _ => None,
    }
}

/// Adds memory types to a device without any.
fn complete(properties: &mut vk::PhysicalDeviceMemoryProperties) {
    if properties.memory_type_count > 0 {
        return;
    }
    properties.memory_heap_count = 1;
    properties.memory_heaps[0] = vk::MemoryHeap { size: HEAP_BYTES, flags: vk::MemoryHeapFlags::DEVICE_LOCAL };
    properties.memory_type_count = TYPES.len() as u32;
    for (ty, flags) in properties.memory_types.iter_mut().zip(TYPES) {
        *ty = vk::MemoryType { property_flags: flags, heap_index: 0 };
    }
}

unsafe extern "system" fn properties(device: vk::PhysicalDevice, properties: *mut vk::PhysicalDeviceMemoryProperties) {
    // SAFETY: by the caller; the function was looked up before this one was.
    unsafe {
        (PROPERTIES.get().expect("looked up"))(device, properties);
        complete(&mut *properties);
    }
}

unsafe extern "system" fn properties_2(
    device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceMemoryProperties2<'_>,
) {
    // SAFETY: as above.
    unsafe {
        (PROPERTIES_2.get().expect("looked up"))(device, properties);
        complete(&mut (*properties).memory_properties);
    }
}

unsafe extern "system" fn buffer_needs(device: vk::Device, buffer: vk::Buffer, needs: *mut vk::MemoryRequirements) {
    // SAFETY: as above.
    unsafe {
        (BUFFER_NEEDS.get().expect("looked up"))(device, buffer, needs);
        allow_all_types(&mut *needs);
    }
}

unsafe extern "system" fn buffer_needs_2(
    device: vk::Device,
    info: *const vk::BufferMemoryRequirementsInfo2<'_>,
    needs: *mut vk::MemoryRequirements2<'_>,
) {
    // SAFETY: as above.
    unsafe {
        (BUFFER_NEEDS_2.get().expect("looked up"))(device, info, needs);
        allow_all_types(&mut (*needs).memory_requirements);
    }
}

fn allow_all_types(needs: &mut vk::MemoryRequirements) {
    if needs.memory_type_bits == 0 {
        needs.memory_type_bits = ALL_TYPES;
    }
}

/// Requirements of an image that is never laid out: arbitrary, but satisfiable.
const IMAGE_NEEDS: vk::MemoryRequirements =
    vk::MemoryRequirements { size: 1 << 16, alignment: 1 << 12, memory_type_bits: ALL_TYPES };

unsafe extern "system" fn image_needs(_: vk::Device, _: vk::Image, needs: *mut vk::MemoryRequirements) {
    // SAFETY: by the caller.
    unsafe { *needs = IMAGE_NEEDS };
}

unsafe extern "system" fn image_needs_2(
    _: vk::Device,
    _: *const vk::ImageMemoryRequirementsInfo2<'_>,
    needs: *mut vk::MemoryRequirements2<'_>,
) {
    // SAFETY: by the caller.
    unsafe { (*needs).memory_requirements = IMAGE_NEEDS };
}

/// Defines a function that creates an object consisting of a handle only.
macro_rules! creates_handle {
    ($name:ident, $info:ty, $handle:ty) => {
        unsafe extern "system" fn $name(
            _: vk::Device,
            _: *const $info,
            _: *const vk::AllocationCallbacks<'_>,
            made: *mut $handle,
        ) -> vk::Result {
            // SAFETY: by the caller.
            unsafe { *made = vk::Handle::from_raw(next_handle()) };
            vk::Result::SUCCESS
        }
    };
}

creates_handle!(create_image, vk::ImageCreateInfo<'_>, vk::Image);
creates_handle!(create_image_view, vk::ImageViewCreateInfo<'_>, vk::ImageView);
creates_handle!(create_framebuffer, vk::FramebufferCreateInfo<'_>, vk::Framebuffer);

fn next_handle() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(1);
    LAST.fetch_add(1, Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_device_without_memory_is_given_some() {
        let mut none = vk::PhysicalDeviceMemoryProperties::default();
        complete(&mut none);
        assert_eq!((none.memory_heap_count, none.memory_type_count), (1, 3));
        assert!(none.memory_types[1].property_flags.contains(vk::MemoryPropertyFlags::HOST_VISIBLE));
        let mut own = vk::PhysicalDeviceMemoryProperties { memory_type_count: 1, ..Default::default() };
        complete(&mut own);
        assert_eq!((own.memory_heap_count, own.memory_type_count), (0, 1));
    }

    #[test]
    fn handles_are_never_null_nor_the_same() {
        let (first, second) = (next_handle(), next_handle());
        assert!(first != 0 && second != 0 && first != second);
    }
}
