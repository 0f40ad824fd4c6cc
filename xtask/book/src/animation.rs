//! Animations of the gallery: a scene's lights swing around the vertical axis through the camera's target.

use std::path::Path;

use antumbra_scene::{LoadOptions, Setup, load};
use glam::Quat;

/// Scenes with an animation: a contact that softens with distance, foliage, coloured glass, a sun.
pub const SCENES: [&str; 4] = ["leaning-plank", "bench-under-tree", "stained-glass", "town"];

const FRAMES: u32 = 12;
const FRAME_MS: u32 = 150;
const SWING_DEGREES: f32 = 35.0;

/// Returns the file name of a scene's animation.
pub fn image(scene: &str) -> String {
    format!("{scene}-moving.png")
}

/// Writes the setup file of each frame.
///
/// # Errors
/// If a file cannot be written.
pub fn write_setups(scene: &str, folder: &Path) -> Result<(), String> {
    let loaded = load(&format!("builtin:{scene}"), &LoadOptions::default()).map_err(|error| error.to_string())?;
    let setup = Setup::for_scene(&loaded);
    for frame in 0..FRAMES {
        let file = folder.join(setup_file(scene, frame));
        let text = at_frame(&setup, frame).to_toml();
        // An unchanged file must not cause a new image.
        if std::fs::read_to_string(&file).is_ok_and(|old| old == text) {
            continue;
        }
        std::fs::write(&file, text).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    Ok(())
}

/// Returns the commands that render the frames and join them, as lines `OUTPUT: COMMAND`.
pub fn commands(scene: &str, technique: &str) -> Vec<String> {
    let image = image(scene);
    let frames: Vec<String> = (0..FRAMES).map(|frame| format!("{scene}-{frame}.frame.png")).collect();
    let renders = (0..FRAMES).zip(&frames).map(|(frame, output)| {
        let setup = setup_file(scene, frame);
        format!("{output}: antumbra render builtin:{scene} --technique {technique} --size 320x180 --setup {setup} -o {output}")
    });
    renders.chain([format!("{image}: antumbra-animate {image} {FRAME_MS} {}", frames.join(" "))]).collect()
}

fn setup_file(scene: &str, frame: u32) -> String {
    format!("{scene}-{frame}.toml")
}

/// Returns the setup of a frame. The path is closed, so that the animation repeats without a jump.
fn at_frame(setup: &Setup, frame: u32) -> Setup {
    let angle = SWING_DEGREES.to_radians() * (std::f32::consts::TAU * frame as f32 / FRAMES as f32).sin();
    let turn = Quat::from_rotation_y(angle);
    let mut turned = setup.clone();
    for light in &mut turned.lights {
        light.center = setup.camera.target + turn * (light.center - setup.camera.target);
        light.axis = turn * light.axis;
        light.up = turn * light.up;
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_swing_and_come_back() {
        for scene in SCENES {
            let loaded = load(&format!("builtin:{scene}"), &LoadOptions::default()).unwrap();
            let setup = Setup::for_scene(&loaded);
            let axis = |frame| at_frame(&setup, frame).lights[0].axis;
            assert!(axis(0).dot(axis(FRAMES / 4)) < 0.999, "{scene}");
            assert!((axis(0) - axis(FRAMES)).length() < 1e-5, "{scene}");
        }
    }
}
