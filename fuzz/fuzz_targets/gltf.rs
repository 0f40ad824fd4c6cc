//! Fuzz target of arbitrary bytes as a glTF file: an error or a scene, never a panic, a hang or a huge allocation.
//!
//! Seeds: small `.glb` and `.gltf` files in `fuzz/corpus/gltf/`.
#![no_main]

use antumbra_scene::{LoadOptions, Setup, load_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = load_bytes(bytes, "fuzz", &LoadOptions { time_s: 0.4 }) {
        assert!(scene.world_triangles().all(|t| t.positions.iter().all(|p| p.is_finite())));
        // A loaded scene must be valid for framing and for writing.
        let setup = Setup::for_scene(&scene);
        Setup::from_toml(&setup.to_toml(), "fuzz.toml".as_ref()).expect("a setup reads what it wrote");
    }
});
