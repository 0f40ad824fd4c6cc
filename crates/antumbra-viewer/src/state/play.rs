//! Playback of an animated scene.

/// Range of playback speeds; 1 is real time.
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.05..=4.0;

/// Playback state of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    /// First and last time of the scene's animations, seconds; `None` if nothing is animated.
    pub ends_s: Option<[f32; 2]>,
    /// Current time, seconds.
    pub time_s: f32,
    /// Whether playback runs.
    pub is_playing: bool,
    /// Speed, scene seconds per second, within [`SPEEDS`].
    pub speed: f32,
}

impl Default for Play {
    fn default() -> Self {
        Self { ends_s: None, time_s: 0.0, is_playing: false, speed: 1.0 }
    }
}

impl Play {
    /// Creates a paused state at `time_s`. A time other than 0 is clamped to the animations' range.
    pub fn at(ends_s: Option<[f32; 2]>, time_s: f32) -> Self {
        // Without animations the time is 0.
        let time_s = ends_s.map_or(0.0, |[first, last]| if time_s == 0.0 { 0.0 } else { time_s.clamp(first, last) });
        Self { ends_s, time_s, ..Self::default() }
    }

    /// Advances by `seconds` of real time. Playback loops.
    pub fn advance(&mut self, seconds: f32) {
        let Some([first, last]) = self.ends_s.filter(|_| self.is_playing) else { return };
        let time_s = self.time_s.max(first) + self.speed * seconds;
        // The range is empty if all keys have the same time.
        self.time_s =
            if time_s <= last { time_s } else { first + (time_s - first) % (last - first).max(f32::MIN_POSITIVE) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_goes_by_while_it_plays_and_begins_again() {
        let mut play = Play::at(Some([1.0, 3.0]), 0.0);
        play.advance(1.0);
        assert_eq!(play.time_s, 0.0);
        play.is_playing = true;
        play.advance(0.5);
        assert_eq!(play.time_s, 1.5);
        play.speed = 2.0;
        play.advance(1.0);
        assert_eq!(play.time_s, 1.5, "two seconds on, in a clip of two");
        let mut moment = Play { is_playing: true, ..Play::at(Some([1.0, 1.0]), 5.0) };
        moment.advance(0.1);
        assert_eq!(moment.time_s, 1.0);
        let mut still = Play { is_playing: true, ..Play::at(None, 2.0) };
        still.advance(1.0);
        assert_eq!(still.time_s, 0.0);
    }
}
