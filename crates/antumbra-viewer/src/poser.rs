//! Background posing of the open scene, one time at a time. The window stays responsive while a large scene moves.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use antumbra_scene::{Animations, Scene};
use glam::Vec3;

use crate::background::{Wake, run_in_background};
use crate::message::one_line;

/// Poses one animated scene.
#[derive(Debug)]
pub struct Poser {
    animations: Arc<Animations>,
    has_ground: bool,
    /// World position that serves as the scene's origin.
    anchor: Vec3,
    /// Time of the last result, even if it failed, seconds.
    shown_s: f32,
    pending: Option<(f32, Receiver<Result<Scene, String>>)>,
}

impl Poser {
    /// Creates a poser for `animations`, whose scene is shown at `shown_s`. `has_ground` tells whether the viewer added a
    /// ground; `anchor` is the scene's origin.
    pub fn new(animations: Arc<Animations>, has_ground: bool, anchor: Vec3, shown_s: f32) -> Self {
        Self { animations, has_ground, anchor, shown_s, pending: None }
    }

    /// Requests the scene at `time_s`. Calls `wake` once [`take`](Self::take) has a result.
    pub fn want(&mut self, time_s: f32, wake: &Wake) {
        if self.pending.is_some() || time_s == self.shown_s {
            return;
        }
        let (sender, result) = channel();
        let (animations, has_ground, anchor) = (self.animations.clone(), self.has_ground, self.anchor);
        let wake = wake.clone();
        run_in_background(move || {
            let mut posed = animations.scene_at(time_s).map_err(|error| one_line(&error.to_string()));
            if let Ok(scene) = &mut posed {
                if has_ground {
                    scene.add_ground();
                }
                scene.count_from(anchor);
            }
            // The receiver is gone if another scene was opened meanwhile.
            let _ = sender.send(posed);
            wake();
        });
        self.pending = Some((time_s, result));
    }

    /// Returns the scene at a requested time, without its images, or an error in one line.
    pub fn take(&mut self) -> Option<Result<Scene, String>> {
        let (time_s, result) = self.pending.as_ref()?;
        let posed = result.try_recv().ok()?;
        self.shown_s = *time_s;
        self.pending = None;
        Some(posed)
    }

    /// Whether the shown time differs from `time_s`.
    pub fn is_behind(&self, time_s: f32) -> bool {
        self.pending.is_some() || time_s != self.shown_s
    }
}
