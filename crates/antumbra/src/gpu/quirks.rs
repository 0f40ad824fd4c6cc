//! Limits of drivers that no limit of WebGPU tells.

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
