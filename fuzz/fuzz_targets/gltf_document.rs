//! Fuzz target of an arbitrary document in a valid container, with the remaining bytes as its binary chunk. The target computes
//! the container's lengths, which mutation seldom keeps valid. The first zero byte separates document and chunk.
#![no_main]

use antumbra_scene::{LoadOptions, load_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let split = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data, padding) in [(b"JSON", &bytes[..split], b' '), (b"BIN\0", &bytes[split..], 0)] {
        let length = data.len().next_multiple_of(4);
        glb.extend((length as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(data);
        glb.resize(glb.len() + length - data.len(), padding);
    }
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
    let _ = load_bytes(&glb, "fuzz", &LoadOptions::default());
});
