//! Driver quirks: behaviour that no feature or limit of WebGPU reveals.

/// Loop iterations of an invocation after which a pass of unbounded work ends and leaves the rest to the next pass.
///
/// llvmpipe terminates all loops of an invocation after 65 535 iterations in total, and a CPU needs seconds for that many. On a
/// graphics card a pass costs more than its iterations: with fifty times as many, an NVIDIA H200 took .63 and .75 of the time
/// for `sample_based` (`knot`, `street`, 1920 × 1080), some 3 ms per million iterations. With a million, even a card a hundred
/// times slower stays below the seconds after which a system considers it hung.
pub(super) fn max_iterations(adapter: &wgpu::AdapterInfo) -> u32 {
    // A browser reveals neither driver nor type, and may render in software.
    let is_card = matches!(adapter.device_type, wgpu::DeviceType::DiscreteGpu | wgpu::DeviceType::IntegratedGpu);
    if is_card { 1_000_000 } else { 60_000 }
}

/// Whether a driver compiles uniform values into shaders, so that storage buffers are better ([`super::uniforms`]).
pub(super) fn compiles_uniform_values_in(adapter: &wgpu::AdapterInfo) -> bool {
    let mesa = adapter.driver_info.strip_prefix("Mesa ").and_then(|rest| rest.split('.').next()?.parse::<u32>().ok());
    adapter.driver == "llvmpipe" && mesa.is_some_and(|version| version < 23)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Returns a software adapter with this driver.
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
