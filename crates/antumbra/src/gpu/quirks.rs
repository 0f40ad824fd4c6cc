//! What a few drivers cannot do that others can, by their names.

/// Turns of loops in an invocation after which a pass of unbounded work ends and leaves the rest to the next.
///
/// llvmpipe ends every loop of an invocation after 65 535 turns of all of them, and a processor takes seconds for so many more. On a
/// graphics card passes cost more than turns: an NVIDIA H200 took .65 to .75 of the time for `sample_based` with so many that hardly
/// any group of receivers needs a second pass. A million turns are a tenth of a second there at the very most, and far less than the
/// seconds after which a system takes a card for hung on one twenty times slower.
pub(super) fn most_turns(adapter: &wgpu::AdapterInfo) -> u32 {
    let is_processor = adapter.driver == "llvmpipe" || adapter.device_type == wgpu::DeviceType::Cpu;
    if is_processor { 60_000 } else { 1_000_000 }
}
