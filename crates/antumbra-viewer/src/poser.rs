//! The open scene at the time that is wanted: posed aside, one time after the other, so that the window goes on while a large
//! scene moves.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use antumbra_scene::{Animations, Scene};
use glam::Vec3;

use crate::aside::{Wake, aside};
use crate::message::one_line;

/// Poses one scene.
#[derive(Debug)]
pub struct Poser {
    animations: Arc<Animations>,
    has_ground: bool,
    /// The world position that the scene is counted from.
    anchor: Vec3,
    /// The time of the scene that was taken last, or could not be had.
    shown_s: f32,
    pending: Option<(f32, Receiver<Result<Scene, String>>)>,
}

impl Poser {
    /// Poses by `animations`, whose scene is shown at `shown_s`, stands on a ground of ours or not, and is counted from
    /// `anchor`.
    pub fn new(animations: Arc<Animations>, has_ground: bool, anchor: Vec3, shown_s: f32) -> Self {
        Self { animations, has_ground, anchor, shown_s, pending: None }
    }

    /// Wants the scene at `time_s`. `wake` is called once [`take`](Self::take) has one.
    pub fn want(&mut self, time_s: f32, wake: &Wake) {
        if self.pending.is_some() || time_s == self.shown_s {
            return;
        }
        let (sender, result) = channel();
        let (animations, has_ground, anchor) = (self.animations.clone(), self.has_ground, self.anchor);
        let wake = wake.clone();
        aside(move || {
            let mut posed = animations.scene_at(time_s).map_err(|error| one_line(&error.to_string()));
            if let Ok(scene) = &mut posed {
                if has_ground {
                    scene.stand_on_ground();
                }
                scene.count_from(anchor);
            }
            // Nobody waits any longer where another scene was opened meanwhile.
            let _ = sender.send(posed);
            wake();
        });
        self.pending = Some((time_s, result));
    }

    /// The scene at a time that was wanted, without its pictures, or one line.
    pub fn take(&mut self) -> Option<Result<Scene, String>> {
        let (time_s, result) = self.pending.as_ref()?;
        let posed = result.try_recv().ok()?;
        self.shown_s = *time_s;
        self.pending = None;
        Some(posed)
    }

    /// Whether another time is shown than `time_s`.
    pub fn is_behind(&self, time_s: f32) -> bool {
        self.pending.is_some() || time_s != self.shown_s
    }
}
