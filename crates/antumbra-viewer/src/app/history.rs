//! Undo and redo of the user's edits: lights and techniques. Camera motion is not an edit.

use antumbra_light::Light;
use egui::util::undoer::Undoer;

use crate::state::{Side, State};

/// The part of the state that undo restores.
#[derive(Clone, Debug, PartialEq)]
struct Edited {
    lights: Vec<Light>,
    /// Index of the selected light.
    light: usize,
    sides: [Side; 2],
    is_split: bool,
}

impl Edited {
    fn of(state: &State) -> Self {
        Self {
            lights: state.setup.lights.clone(),
            light: state.light,
            sides: state.sides.clone(),
            is_split: state.is_split,
        }
    }

    fn give_to(self, state: &mut State) {
        let Self { lights, light, sides, is_split } = self;
        (state.setup.lights, state.light) = (lights, light);
        (state.sides, state.is_split) = (sides, is_split);
    }
}

/// Edits of the open scene, oldest first.
#[derive(Debug, Default)]
pub struct History {
    edits: Undoer<Edited>,
    /// Generation of the open scene to which the edits belong.
    generation: Option<u64>,
}

impl History {
    /// Records the state of a frame. All edits between two pauses of a second form one step. Animation is not an edit: its
    /// result is recorded when it stops.
    pub fn note(&mut self, state: &State, time_s: f64) {
        let generation = state.scene.as_ref().map(|open| open.generation);
        if generation != self.generation {
            *self = Self { edits: Undoer::default(), generation };
        }
        if !state.is_moving() {
            self.edits.feed_state(time_s, &Edited::of(state));
        }
    }

    /// Undoes the newest edit. Returns whether there was one.
    pub fn undo(&mut self, state: &mut State) -> bool {
        let edited = self.edits.undo(&Edited::of(state)).cloned();
        edited.map(|edited| edited.give_to(state)).is_some()
    }

    /// Redoes the edit that was undone last. Returns whether there was one.
    pub fn redo(&mut self, state: &mut State) -> bool {
        let edited = self.edits.redo(&Edited::of(state)).cloned();
        edited.map(|edited| edited.give_to(state)).is_some()
    }

    /// Whether an edit can be undone, and whether one can be redone.
    pub fn can_undo_and_redo(&self, state: &State) -> [bool; 2] {
        let edited = Edited::of(state);
        [self.edits.has_undo(&edited), self.edits.has_redo(&edited)]
    }
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use antumbra_scene::{LoadOptions, load};

    use super::*;

    fn opened() -> State {
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.open("builtin:overlap", &load("builtin:overlap", &LoadOptions::default()).unwrap(), None);
        state
    }

    /// Records an unchanged state for two seconds from a time on.
    fn rest(history: &mut History, state: &State, from_s: f64) {
        for step in 0..3 {
            history.note(state, from_s + f64::from(step));
        }
    }

    #[test]
    fn edits_go_back_and_forth_and_looking_around_stays() {
        let (mut history, mut state) = (History::default(), opened());
        rest(&mut history, &state, 0.0);
        assert_eq!(history.can_undo_and_redo(&state), [false, false]);
        let first = state.clone();
        state.setup.lights[0].intensity = 9.0;
        rest(&mut history, &state, 10.0);
        state.sides[0].set_kind(TechniqueKind::Vsm);
        state.add_light();
        rest(&mut history, &state, 20.0);
        let last = state.clone();
        state.setup.camera.eye.x += 1.0;
        let camera = state.setup.camera;
        assert!(history.undo(&mut state));
        assert_eq!((state.setup.lights.len(), state.setup.lights[0].intensity), (1, 9.0));
        assert_eq!(history.can_undo_and_redo(&state), [true, true]);
        assert!(history.undo(&mut state));
        assert_eq!((&state.setup.lights, &state.sides), (&first.setup.lights, &first.sides));
        assert!(!history.undo(&mut state));
        assert!(history.redo(&mut state) && history.redo(&mut state) && !history.redo(&mut state));
        assert_eq!((&state.setup.lights, &state.sides, state.light), (&last.setup.lights, &last.sides, last.light));
        assert_eq!(state.setup.camera, camera);
    }

    #[test]
    fn another_scene_has_a_history_of_its_own() {
        let (mut history, mut state) = (History::default(), opened());
        rest(&mut history, &state, 0.0);
        state.setup.lights[0].intensity = 9.0;
        rest(&mut history, &state, 10.0);
        state.open("builtin:overlap", &load("builtin:overlap", &LoadOptions::default()).unwrap(), None);
        rest(&mut history, &state, 20.0);
        assert!(!history.undo(&mut state));
        // A turntable is no edit while it turns; its result is one when it stops.
        state.light_turn_rad_s = 1.0;
        state.advance(0.5);
        rest(&mut history, &state, 30.0);
        state.light_turn_rad_s = 0.0;
        rest(&mut history, &state, 40.0);
        assert!(history.undo(&mut state) && !history.undo(&mut state));
    }
}
