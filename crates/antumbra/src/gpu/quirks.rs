//! Driver quirks: what drivers do that no feature and no limit of WebGPU tells.

/// Turns of loops in an invocation after which a pass of unbounded work ends and leaves the rest to the next.
///
/// llvmpipe ends every loop of an invocation after 65 535 turns of all of them, and a processor takes seconds for so many more. On a
/// graphics card a pass costs more than its turns: with fifty times as many an NVIDIA H200 took .63 and .75 of the time for
/// `sample_based` (`knot`, `street`, 1920 × 1080), some 3 ms for every million turns. A million leave even a card that is a hundred times
/// slower below the seconds after which a system takes it for hung.
pub(super) fn most_turns(adapter: &wgpu::AdapterInfo) -> u32 {
    // A browser tells neither, and may draw by software.
    let is_card = matches!(adapter.device_type, wgpu::DeviceType::DiscreteGpu | wgpu::DeviceType::IntegratedGpu);
    if is_card { 1_000_000 } else { 60_000 }
}

/// Whether a driver compiles the values of uniforms into shaders, so that they are better read as storage buffers ([`super::uniforms`]).
pub(super) fn compiles_uniform_values_in(adapter: &wgpu::AdapterInfo) -> bool {
    let mesa = adapter.driver_info.strip_prefix("Mesa ").and_then(|rest| rest.split('.').next()?.parse::<u32>().ok());
    adapter.driver == "llvmpipe" && mesa.is_some_and(|version| version < 23)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A software adapter of a driver.
    pub(in crate::gpu) fn adapter(driver: &str, driver_info: &str) -> wgpu::AdapterInfo {
        let mut info = wgpu::AdapterInfo::new(wgpu::DeviceType::Cpu, wgpu::Backend::Vulkan);
        (info.driver, info.driver_info) = (driver.into(), driver_info.into());
        info
    }

    #[test]
    fn old_drivers_that_compile_values_in_are_known_by_name() {
        assert!(compiles_uniform_values_in(&adapter("llvmpipe", "Mesa 22.3.6 (LLVM 15.0.6)")));
        for (driver, info) in [
            ("llvmpipe", "Mesa 24.2.8 (LLVM 19.1.1)"),
            ("llvmpipe", ""),
            ("radv", "Mesa 22.3.6"),
            ("NVIDIA", "570.86.15"),
        ] {
            assert!(!compiles_uniform_values_in(&adapter(driver, info)), "{driver} {info}");
        }
    }
}
