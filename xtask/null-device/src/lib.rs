//! Vulkan driver that wraps Mesa's RADV on its null device, for `cargo xtask gpu-cost`.
//!
//! With `RADV_FORCE_FAMILY=navi21`, RADV creates a device of that family without hardware. Its compiler is the real one, but it has no
//! memory types, its queues never finish, and it cannot lay out images. wgpu requires all three before the first pipeline. This driver
//! implements them itself and forwards everything else, above all pipelines, to the wrapped driver. Nothing is drawn or computed.
//!
//! The Vulkan loader finds it by a manifest; [`DRIVER`] names the wrapped driver.
//! Specification: Khronos Group, Architecture of the Vulkan Loader Interfaces, "LoaderDriverInterface".

#![allow(unsafe_code)]

mod commands;
mod memory;
mod queue;

use std::ffi::{CStr, c_char};
use std::sync::OnceLock;

use ash::vk;
use libloading::Library;

/// Environment variable with the path of the wrapped driver's library.
const DRIVER: &str = "ANTUMBRA_NULL_DEVICE_DRIVER";

/// Untyped Vulkan function.
type Function = unsafe extern "system" fn();
type Lookup<Handle> = unsafe extern "system" fn(Handle, *const c_char) -> Option<Function>;
type Negotiate = unsafe extern "system" fn(*mut u32) -> vk::Result;

/// Lookup functions of the wrapped driver.
struct Wrapped {
    negotiate: Negotiate,
    of_instance: Lookup<vk::Instance>,
    of_physical_device: Lookup<vk::Instance>,
    of_device: OnceLock<Lookup<vk::Device>>,
}

impl Wrapped {
    /// # Panics
    /// If there is no such driver, because Vulkan cannot report which one is missing.
    fn load() -> Self {
        let path = std::env::var_os(DRIVER).unwrap_or_else(|| panic!("{DRIVER} does not name a driver"));
        // SAFETY: loading a driver's library has no conditions; its functions have these types by the loader's specification. It
        // stays loaded for the whole process.
        unsafe {
            let library = Library::new(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let library: &'static Library = Box::leak(Box::new(library));
            let get =
                |name: &str| library.get(name.as_bytes()).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            Self {
                negotiate: std::mem::transmute::<Function, Negotiate>(*get("vk_icdNegotiateLoaderICDInterfaceVersion")),
                of_instance: std::mem::transmute::<Function, Lookup<vk::Instance>>(*get("vk_icdGetInstanceProcAddr")),
                of_physical_device: std::mem::transmute::<Function, Lookup<vk::Instance>>(*get(
                    "vk_icdGetPhysicalDeviceProcAddr",
                )),
                of_device: OnceLock::new(),
            }
        }
    }
}

fn wrapped() -> &'static Wrapped {
    static WRAPPED: OnceLock<Wrapped> = OnceLock::new();
    WRAPPED.get_or_init(Wrapped::load)
}

/// Negotiates a version of the interface between loader and driver.
///
/// # Safety
/// Only for the loader.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vk_icdNegotiateLoaderICDInterfaceVersion(version: *mut u32) -> vk::Result {
    // SAFETY: by the caller.
    unsafe { (wrapped().negotiate)(version) }
}

/// Looks up a function of an instance.
///
/// # Safety
/// As `vkGetInstanceProcAddr`.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vk_icdGetInstanceProcAddr(
    instance: vk::Instance,
    name: *const c_char,
) -> Option<Function> {
    // SAFETY: by the caller; functions keep the types that their names have in Vulkan.
    unsafe {
        let real = (wrapped().of_instance)(instance, name)?;
        match CStr::from_ptr(name).to_bytes() {
            b"vkGetDeviceProcAddr" => {
                wrapped().of_device.get_or_init(|| std::mem::transmute::<Function, Lookup<vk::Device>>(real));
                Some(std::mem::transmute::<Lookup<vk::Device>, Function>(device_function))
            }
            name => Some(memory::of_instance(name, real).or_else(|| replaced(name, real)).unwrap_or(real)),
        }
    }
}

/// Looks up a function of a physical device that is unknown to a loader older than the wrapped driver.
///
/// # Safety
/// As [`vk_icdGetInstanceProcAddr`].
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vk_icdGetPhysicalDeviceProcAddr(
    instance: vk::Instance,
    name: *const c_char,
) -> Option<Function> {
    // SAFETY: by the caller.
    unsafe {
        let real = (wrapped().of_physical_device)(instance, name)?;
        Some(memory::of_instance(CStr::from_ptr(name).to_bytes(), real).unwrap_or(real))
    }
}

/// Looks up a function of a device.
///
/// # Safety
/// As `vkGetDeviceProcAddr`.
unsafe extern "system" fn device_function(device: vk::Device, name: *const c_char) -> Option<Function> {
    // SAFETY: by the caller; the loader looks this function up before it calls it.
    unsafe {
        let of_device = wrapped().of_device.get().expect("looked up before it is called");
        let real = of_device(device, name)?;
        Some(replaced(CStr::from_ptr(name).to_bytes(), real).unwrap_or(real))
    }
}

/// Returns the replacement of a device's function, if it has one.
fn replaced(name: &[u8], real: Function) -> Option<Function> {
    queue::replaced(name).or_else(|| memory::replaced(name, real)).or_else(|| commands::replaced(name))
}

/// Does nothing, in place of functions that return nothing or a result. The calling convention accepts any arguments.
unsafe extern "system" fn nothing() -> vk::Result {
    vk::Result::SUCCESS
}

/// Erases the type of a function.
macro_rules! erased {
    ($function:expr, $type:ty) => {{
        let function: $type = $function;
        // SAFETY: a function pointer, whose type callers restore by its name.
        Some(unsafe { std::mem::transmute::<$type, $crate::Function>(function) })
    }};
}
pub(crate) use erased;

/// Returns [`nothing`] with its type erased.
fn does_nothing() -> Option<Function> {
    erased!(nothing, unsafe extern "system" fn() -> vk::Result)
}
