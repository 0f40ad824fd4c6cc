//! Good files with a few bytes changed or cut off give an error or a sound scene, never a panic or a hang.
//!
//! The mutations are deterministic, so that a failure can be repeated; `fuzz/` searches further. Limits are tight, so that
//! changed counts request little.

use std::time::{Duration, Instant};

use super::{guarded, scenes_folder, unsound};
use crate::gltf::{Limits, Pose, load_bytes};
use crate::{Setup, builtin, export_glb};

/// Permuted congruential generator (O'Neill 2014, PCG-XSH-RR): a seed always names the same case.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((((self.0 >> 18) ^ self.0) >> 27) as u32).rotate_right((self.0 >> 59) as u32)
    }

    fn below(&mut self, n: usize) -> usize {
        self.next() as usize % n.max(1)
    }
}

/// One mutation of `bytes`: flips, overwritten digits and punctuation, cut ends, repeated pieces.
fn mutate(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    /// Bytes that do most harm in JSON and in binary counts.
    const SPITEFUL: &[u8] = b"0123456789-.eE\"{}[],:\x00\xff\x7f\x80";
    let mut out = bytes.to_vec();
    for _ in 0..=random.below(4) {
        if out.is_empty() {
            break;
        }
        // The document is at the beginning and matters more than the data after it.
        let reach = if random.below(3) > 0 { out.len().min(4096) } else { out.len() };
        let at = random.below(reach);
        match random.below(10) {
            0..3 => out[at] ^= 1 << random.below(8),
            3..7 => out[at] = SPITEFUL[random.below(SPITEFUL.len())],
            7 => out.truncate(at),
            8 => {
                let piece = out[at..(at + 1 + random.below(16)).min(out.len())].to_vec();
                out.splice(at..at, piece);
            }
            _ => {
                let end = (at + 1 + random.below(16)).min(out.len());
                out.drain(at..end);
            }
        }
    }
    out
}

/// Repairs the chunk lengths of a container whose document was changed, so that more than the container is tested.
fn mended(glb: &[u8]) -> Option<Vec<u8>> {
    let start = glb.windows(4).position(|w| w == b"BIN\0")?.checked_sub(4)?;
    let (json, bin) = (glb.get(20..start)?, glb.get(start + 8..)?);
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data) in [(b"JSON", json), (b"BIN\0", bin.to_vec())] {
        out.extend((data.len().next_multiple_of(4) as u32).to_le_bytes());
        out.extend(kind);
        out.extend(data);
        out.resize(out.len().next_multiple_of(4), 0);
    }
    let length = out.len() as u32;
    out[8..12].copy_from_slice(&length.to_le_bytes());
    Some(out)
}

#[test]
fn mutated_scenes_never_crash() {
    const ITERATIONS: usize = 6000;
    /// Time limit: a slow machine tests fewer mutations rather than failing.
    const TIME: Duration = Duration::from_secs(6);
    let mut seeds: Vec<(String, Vec<u8>)> = ["window", "occluders"]
        .iter()
        .filter_map(|name| Some(((*name).into(), export_glb(&builtin::build(name).ok()?).ok()?)))
        .collect();
    assert!(!seeds.is_empty());
    if let Some(folder) = scenes_folder() {
        let broken = folder.join("broken");
        for file in
            ["control-good-cube.glb", "control-good-skin.glb", "control-good-texture.glb", "mode-triangle-strip.glb"]
        {
            seeds.push((file.into(), std::fs::read(broken.join(file)).unwrap()));
        }
        seeds.push(("data-uri".into(), std::fs::read(broken.join("control-good-data-uri.gltf")).unwrap()));
        seeds.push(("alpha".into(), std::fs::read(folder.join("fence-chain-link-masked.glb")).unwrap()));
    }
    let begin = Instant::now();
    let mut random = Random(1);
    let (mut loaded, mut tried) = (0, 0);
    while tried < ITERATIONS && begin.elapsed() < TIME {
        let (name, good) = &seeds[tried % seeds.len()];
        let mut bytes = mutate(good, &mut random);
        if tried % 2 == 0 {
            bytes = mended(&bytes).unwrap_or(bytes);
        }
        let scene =
            guarded(Duration::from_secs(20), move || load_bytes(&bytes, "mutant", Pose::At(0.4), Limits::TIGHT));
        match scene {
            Err(crash) => panic!("mutation {tried} of {name}: {crash}"),
            Ok(Ok(mutant)) => {
                assert_eq!(unsound(&mutant.scene), None, "mutation {tried} of {name}");
                loaded += 1;
            }
            Ok(Err(e)) => assert!(!e.to_string().contains('\n'), "mutation {tried} of {name}: {e}"),
        }
        tried += 1;
    }
    println!("{tried} mutants, {loaded} of them still load");
    assert!(loaded > tried / 50, "{loaded} of {tried}: the mutations stop at the container");
}

#[test]
fn mutated_setups_never_crash() {
    let mut good: Vec<String> = Vec::new();
    for info in builtin::NAMES {
        if let Ok(scene) = builtin::build(info.name) {
            good.push(Setup::for_scene(&scene).to_toml());
        }
        if good.len() == 3 {
            break;
        }
    }
    let mut random = Random(2);
    for i in 0..4000 {
        let bytes = mutate(good[i % good.len()].as_bytes(), &mut random);
        let text = String::from_utf8_lossy(&bytes);
        match Setup::from_toml(&text, std::path::Path::new("mutant.toml")) {
            Ok(setup) => {
                let again = setup.to_toml();
                assert!(Setup::from_toml(&again, std::path::Path::new("again.toml")).is_ok(), "{text}\n{again}");
            }
            Err(e) => assert!(!e.to_string().contains('\n'), "{e}"),
        }
    }
}
