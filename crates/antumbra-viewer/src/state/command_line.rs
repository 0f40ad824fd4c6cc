//! The command line that reproduces the image on screen.

use glam::UVec2;

use super::State;

/// Returns `antumbra render …` for one technique, `antumbra compare …` for two. `None` before a scene is open.
///
/// A setup that no file holds yet is named `setup.toml`: the user must save it first.
pub fn command_line(state: &State, size_px: UVec2) -> Option<String> {
    let scene = state.scene.as_ref()?;
    let mut words = vec!["antumbra".to_owned()];
    words.push(if state.is_split { "compare" } else { "render" }.to_owned());
    words.push(scene.spec.clone());
    let setup = match &state.setup_file {
        Some((path, setup)) if *setup == state.setup => path.display().to_string(),
        _ => "setup.toml".to_owned(),
    };
    words.extend(["--setup".to_owned(), setup]);
    if state.play.time_s != 0.0 {
        words.extend(["--time".to_owned(), state.play.time_s.to_string()]);
    }
    // With a setup file the commands add no ground unless asked.
    if scene.has_ground {
        words.push("--ground".to_owned());
    }
    if state.is_split {
        // `compare` prints one row for a technique that is listed twice, with the left side's settings.
        let mut names: Vec<String> = state.sides.iter().map(|side| side.name()).collect();
        names.dedup();
        words.extend(["--techniques".to_owned(), names.join(",")]);
        for side in &state.sides[..names.len()] {
            let settings = side.settings();
            words.extend(
                settings
                    .into_iter()
                    .flat_map(|(key, value)| ["--set".to_owned(), format!("{}.{key}={value}", side.name())]),
            );
        }
    } else {
        let side = &state.sides[0];
        words.extend(["--technique".to_owned(), side.name()]);
        let settings = side.settings();
        words.extend(settings.into_iter().flat_map(|(key, value)| ["--set".to_owned(), format!("{key}={value}")]));
    }
    words.extend(["--size".to_owned(), format!("{}x{}", size_px.x, size_px.y)]);
    words.extend(["-o".to_owned(), if state.is_split { "out" } else { "picture.png" }.to_owned()]);
    Some(words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
}

/// Quotes a word for a POSIX shell.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use antumbra::{Quality, TechniqueKind};
    use antumbra_scene::{LoadOptions, load};

    use super::*;
    use crate::state::Play;

    #[test]
    fn what_is_on_screen_is_on_the_command_line() {
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Vsm);
        assert_eq!(command_line(&state, UVec2::ONE), None);
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        state.open("a scene.glb", &scene, None);
        state.setup_file = Some(("evening.toml".into(), state.setup.clone()));
        state.sides[0].set_quality(Quality::Fast);
        state.sides[0].set("map_size", "256");
        let size_px = UVec2::new(640, 360);
        assert_eq!(
            command_line(&state, size_px).unwrap(),
            "antumbra render 'a scene.glb' --setup evening.toml --technique pcss:fast --set map_size=256 --size 640x360 \
             -o picture.png"
        );
        state.play = Play::at(Some([0.0, 2.0]), 1.25);
        state.scene.as_mut().unwrap().has_ground = true;
        assert_eq!(
            command_line(&state, size_px).unwrap(),
            "antumbra render 'a scene.glb' --setup evening.toml --time 1.25 --ground --technique pcss:fast \
             --set map_size=256 --size 640x360 -o picture.png"
        );
        state.open("a scene.glb", &scene, Some(state.setup.clone()));
        state.is_split = true;
        state.setup.camera.eye.x += 1.0;
        assert_eq!(
            command_line(&state, size_px).unwrap(),
            "antumbra compare 'a scene.glb' --setup setup.toml --techniques pcss:fast,vsm \
             --set pcss:fast.map_size=256 --size 640x360 -o out"
        );
    }
}
