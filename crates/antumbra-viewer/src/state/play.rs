//! The time of an animated scene, and how it goes by.

/// How fast a scene may be played, times as fast as it is.
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.05..=4.0;

/// The time at which a scene is shown, and how it goes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    /// First and last time of the scene's animations, seconds; `None` where nothing of it is animated.
    pub ends_s: Option<[f32; 2]>,
    /// The time that is shown, seconds.
    pub time_s: f32,
    /// Whether time goes by.
    pub is_playing: bool,
    /// Seconds of the scene in a second, within [`SPEEDS`].
    pub speed: f32,
}

impl Default for Play {
    fn default() -> Self {
        Self { ends_s: None, time_s: 0.0, is_playing: false, speed: 1.0 }
    }
}

impl Play {
    /// A scene that stands at `time_s`; times outside its animations are their ends.
    pub fn at(ends_s: Option<[f32; 2]>, time_s: f32) -> Self {
        // What is not animated has no time.
        let time_s = ends_s.map_or(0.0, |[first, last]| if time_s == 0.0 { 0.0 } else { time_s.clamp(first, last) });
        Self { ends_s, time_s, ..Self::default() }
    }

    /// Lets `seconds` go by; behind the last time comes the first.
    pub fn advance(&mut self, seconds: f32) {
        let Some([first, last]) = self.ends_s.filter(|_| self.is_playing) else { return };
        let time_s = self.time_s.max(first) + self.speed * seconds;
        // Of no length where all keys are of one time.
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
