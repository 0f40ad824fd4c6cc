//! Vulkan driver that wraps Mesa's RADV on its null device, for `cargo xtask gpu-cost`.
//!
//! With `RADV_FORCE_FAMILY=navi21`, RADV makes a device of that family without hardware: its compiler is the real one, but it has no
//! memory types, no queue that ever finishes, and images that it cannot lay out. wgpu asks for all three before the first pipeline.
//! This driver answers those questions itself and leaves everything else, pipelines above all, to the wrapped one. Nothing is drawn
//! or computed.
//!
//! The Vulkan loader loads it by a manifest that names it; [`DRIVER`] names the wrapped one.
//! Specification: Khronos Group, Architecture of the Vulkan Loader Interfaces, "LoaderDriverInterface".

#![allow(unsafe_code)]

mod commands;
mod memory;
mod queue;

use std::ffi::{CStr, c_char};
use std::sync::OnceLock;

use ash::vk;
use libloading::Library;

/// The variable with the path of the wrapped driver's library.
const DRIVER: &str = "ANTUMBRA_NULL_DEVICE_DRIVER";

/// Any function of Vulkan, as it is looked up.
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
    /// Where there is no such driver: Vulkan has no other way to say which.
    fn load() -> Self {
        let path = std::env::var_os(DRIVER).unwrap_or_else(|| panic!("{DRIVER} names no driver"));
        // SAFETY: a driver's library may be loaded by anyone; its functions have these types by the loader's specification. It
        // stays loaded as long as the process.
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

/// Agrees on a version of the interface between loader and driver.
///
/// # Safety
/// By the loader alone.
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

/// Looks up a function of a physical device, which a loader may not know that is older than the wrapped driver.
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

/// Replacement of a device's function, if it has one.
fn replaced(name: &[u8], real: Function) -> Option<Function> {
    queue::replaced(name).or_else(|| memory::replaced(name, real)).or_else(|| commands::replaced(name))
}

/// A function that does nothing, in place of those that return nothing or a result. The calling convention lets any arguments pass.
unsafe extern "system" fn nothing() -> vk::Result {
    vk::Result::SUCCESS
}

/// A function without its type.
macro_rules! erased {
    ($function:expr, $type:ty) => {{
        let function: $type = $function;
        // SAFETY: a pointer to a function, which callers give its type again by its name.
        Some(unsafe { std::mem::transmute::<$type, $crate::Function>(function) })
    }};
}
pub(crate) use erased;

/// [`nothing`] without its type.
fn does_nothing() -> Option<Function> {
    erased!(nothing, unsafe extern "system" fn() -> vk::Result)
}
