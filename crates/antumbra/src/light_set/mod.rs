//! Lights that one camera sees, each with a state and a mask, of which a budget's worth is redrawn in a frame.
//!
//! ```text
//!  lights ──► seen? ──► changed? ──► rank ──► first of them ──► prepare ──► record
//!            (range)     (key)    (schedule)   (budget)
//!               │           │                     └──► others keep their masks, which age
//!               └► culled   └► mask is current
//! ```
//!
//! A light has a range, beyond which the host does not shade by it. Lights of whose ranges the camera sees nothing are culled; casters
//! outside of a light's range are not drawn for it, and change nothing for it. Maps and masks of lights that wait stay as they are.
//!
//! ```no_run
//! # use antumbra::*; use antumbra::light::Light; use glam::UVec2;
//! # fn example(gpu: &Gpu, lamps: &[Light], casters: &CasterSet, receivers: Receivers<'_>, size_px: UVec2,
//! #     recorder: &mut Recorder<'_>) -> Result<(), Error> {
//! // Once: four masks in the components of each layer.
//! let mut lights = LightSet::new();
//! let masks = Mask::packed(gpu.device(), size_px, MaskChannels::One, wgpu::TextureFormat::Rgba8Unorm, lamps.len());
//! for (lamp, mask) in lamps.iter().zip(masks) {
//!     lights.add(RangedLight::new(lamp.clone(), 8.0), TechniqueKind::Smrt.create(gpu)?, mask)?;
//! }
//! // Each frame.
//! lights.prepare(&LightSetFrame { casters, receivers, budget: Budget::Lights(4) })?.record(recorder);
//! # Ok(()) }
//! ```
//!
//! # Limits
//! A mask that is kept is an image of the frame that drew it. Where the camera has moved since, its shadows lag behind the surfaces that
//! they lie on by as much as these have moved in the image; [`MaskState::Kept`] has the number of frames. Give a light whose shadows
//! must never lag a state of its own beside the set.

use antumbra_light::Light;
use slotmap::SlotMap;

use crate::casters::{Ball, CasterSet};
use crate::contract::{CastersKey, Error, Mask, Receivers};
use crate::gpu::Recorder;
use crate::shadow::{AnyShadow, Casters, Frame, Prepared};

mod schedule;
mod seen;

use schedule::{Candidate, Change};
use seen::SeenSpace;

slotmap::new_key_type! {
    /// Handle of a light in a [`LightSet`].
    pub struct LightId;
}

/// Light with a range.
#[derive(Clone, Debug, PartialEq)]
pub struct RangedLight {
    /// Light.
    pub light: Light,
    /// Distance from the light's centre beyond which the host does not shade by it, metres; infinite for a sun. Visibility is not right
    /// beyond it.
    pub range_m: f32,
    /// A bit for each layer whose casters the light sees; `u32::MAX`, the default, for all.
    pub layers: u32,
}

impl RangedLight {
    /// A light that sees casters of all layers.
    pub fn new(light: Light, range_m: f32) -> Self {
        Self { light, range_m, layers: u32::MAX }
    }

    /// Ball that holds the light and all that it shades, and so all that casts a shadow there.
    fn ball(&self) -> Ball {
        let Light { center, .. } = self.light;
        let radius_m = if self.light.is_distant() { f32::INFINITY } else { self.light.bounding_radius() };
        Ball { center, radius_m: radius_m.max(self.range_m) }
    }

    fn casters<'a>(&self, set: &'a CasterSet) -> Casters<'a> {
        let (Ball { center, radius_m }, layers) = (self.ball(), self.layers);
        if radius_m.is_infinite() {
            Casters::Set { set, layers }
        } else {
            Casters::Within { set, layers, center, radius_m }
        }
    }

    fn check(&self) -> Result<(), Error> {
        self.light.validate().map_err(|source| Error::Light { technique: WHO, source })?;
        let range_m = self.range_m;
        if range_m.is_nan() || range_m <= 0.0 {
            return bad("a light's range", format!("{range_m} m"), "above 0 m, infinite for none");
        }
        if self.light.is_distant() && range_m.is_finite() {
            return bad("a sun's range", format!("{range_m} m"), "infinite");
        }
        Ok(())
    }
}

/// Upper limit of what a frame redraws; a light at least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// So many lights; `u32::MAX` for all.
    Lights(u32),
    /// Lights whose masks' pixels and maps' texels, layers behind included, are so many together. What a light has drawn last is what it is
    /// taken to draw again, and one that was never drawn counts as the largest of the others.
    Texels(u64),
}

/// Frame of a light set.
#[derive(Clone, Copy, Debug)]
pub struct LightSetFrame<'a> {
    /// Casters, brought to the GPU by [`CasterSet::update`].
    pub casters: &'a CasterSet,
    /// Receivers, of the masks' size. With a [`version`](Receivers::version), masks of frames in which nothing changed are not redrawn.
    pub receivers: Receivers<'a>,
    /// Upper limit of what is redrawn.
    pub budget: Budget,
}

/// State of a light's mask in the frame prepared last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskState {
    /// The frame draws it.
    Drawn,
    /// Nothing that it depends on has changed since it was drawn.
    Current,
    /// It is of an earlier frame.
    Kept {
        /// Frames since it was drawn, or last was current.
        age: u32,
    },
    /// The light came into view and was not drawn yet: the mask holds nothing of use. Shade without it, or leave the light out.
    Missing,
    /// The camera sees nothing within the light's range: the mask is not read.
    Culled,
}

/// Lights that one camera sees.
#[derive(Debug, Default)]
pub struct LightSet {
    lights: SlotMap<LightId, Entry>,
}

#[derive(Debug)]
struct Entry {
    light: RangedLight,
    shadow: AnyShadow,
    mask: Mask,
    state: MaskState,
    /// What the mask was drawn with, where it is of this view.
    drawn: Option<Drawing>,
    /// Frames for which the mask was not theirs.
    waits: u32,
    /// Pixels and texels of the frame that was drawn last.
    texels: Option<u64>,
    /// What the mask is to be drawn with, where the frame redraws it.
    chosen: Option<Drawing>,
}

/// Light and casters of a mask.
type Drawing = (Light, Option<CastersKey>);

/// Prepared frame of a light set.
#[must_use = "nothing is drawn before it is recorded"]
#[derive(Debug)]
pub struct PreparedLights<'a> {
    works: Vec<(LightId, Prepared<'a>)>,
}

/// What errors name in place of a technique.
const WHO: &str = "light set";

impl LightSet {
    /// Creates an empty set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a light with its state and its mask, which is [`MaskState::Missing`] until a frame draws it.
    ///
    /// # Errors
    /// Where light or range are not usable, or another light has the mask.
    pub fn add(&mut self, light: RangedLight, shadow: AnyShadow, mask: Mask) -> Result<LightId, Error> {
        light.check()?;
        self.check_mask(None, &mask)?;
        Ok(self.lights.insert(Entry {
            light,
            shadow,
            mask,
            state: MaskState::Missing,
            drawn: None,
            waits: 0,
            texels: None,
            chosen: None,
        }))
    }

    /// Moves or changes a light.
    ///
    /// # Errors
    /// Where there is no such light, or light or range are not usable.
    pub fn set_light(&mut self, id: LightId, light: RangedLight) -> Result<(), Error> {
        light.check()?;
        self.lights.get_mut(id).ok_or_else(gone)?.light = light;
        Ok(())
    }

    /// Gives a light another mask, of a resized view: it is drawn anew.
    ///
    /// # Errors
    /// Where there is no such light, or another light has the mask.
    pub fn set_mask(&mut self, id: LightId, mask: Mask) -> Result<(), Error> {
        self.check_mask(Some(id), &mask)?;
        let entry = self.lights.get_mut(id).ok_or_else(gone)?;
        (entry.mask, entry.drawn) = (mask, None);
        Ok(())
    }

    /// Removes a light; its state and mask, where there was one.
    pub fn remove(&mut self, id: LightId) -> Option<(AnyShadow, Mask)> {
        self.lights.remove(id).map(|entry| (entry.shadow, entry.mask))
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Handles of all lights.
    pub fn ids(&self) -> impl Iterator<Item = LightId> + '_ {
        self.lights.keys()
    }

    /// A light.
    pub fn light(&self, id: LightId) -> Option<&RangedLight> {
        self.lights.get(id).map(|entry| &entry.light)
    }

    /// A light's mask.
    pub fn mask(&self, id: LightId) -> Option<&Mask> {
        self.lights.get(id).map(|entry| &entry.mask)
    }

    /// A light's state, for its reports.
    pub fn shadow(&self, id: LightId) -> Option<&AnyShadow> {
        self.lights.get(id).map(|entry| &entry.shadow)
    }

    /// A light's state, for its parameters: another value redraws the light.
    pub fn shadow_mut(&mut self, id: LightId) -> Option<&mut AnyShadow> {
        self.lights.get_mut(id).map(|entry| &mut entry.shadow)
    }

    /// State of a light's mask in the frame prepared last.
    pub fn mask_state(&self, id: LightId) -> Option<MaskState> {
        self.lights.get(id).map(|entry| entry.state)
    }

    /// GPU memory that all lights retain, bytes: the sum of [`AnyShadow::memory_bytes`].
    pub fn memory_bytes(&self) -> u64 {
        self.lights.values().map(|entry| entry.shadow.memory_bytes()).sum()
    }

    /// Prepares a frame: culls and ranks the lights, and prepares those that it redraws. Submit in the order of recording.
    ///
    /// Of lights that change in every frame, each is redrawn within five times as many frames as the budget needs for all of them; by
    /// [`Budget::Texels`], within four times as many and one for each light.
    ///
    /// # Errors
    /// Where the budget is nothing or the casters were changed since their last update, and as [`AnyShadow::prepare`].
    pub fn prepare<'a>(&'a mut self, frame: &LightSetFrame<'a>) -> Result<PreparedLights<'a>, Error> {
        check_budget(frame.budget)?;
        frame.casters.check_updated()?;
        self.choose(frame);
        let mut works = Vec::new();
        for (id, entry) in &mut self.lights {
            if let Some(drawing) = entry.chosen.take() {
                works.push((id, entry.prepare(frame, drawing)?));
            }
        }
        Ok(PreparedLights { works })
    }

    /// Sets the state of each light's mask, and which lights the frame redraws.
    fn choose(&mut self, frame: &LightSetFrame<'_>) {
        let seen = SeenSpace::of(&frame.receivers);
        let largest = self.lights.values_mut().map(Entry::known_texels).max().flatten();
        let mut drawings = Vec::new();
        let mut candidates = Vec::new();
        for (id, entry) in &mut self.lights {
            entry.chosen = None;
            if let Some((candidate, drawing)) = entry.candidate(frame, &seen, largest) {
                candidates.push(candidate);
                drawings.push((id, Some(drawing)));
            }
        }
        let budget = match frame.budget {
            Budget::Lights(lights) => lights.into(),
            Budget::Texels(texels) => texels,
        };
        for i in schedule::chosen(&candidates, budget) {
            let (id, drawing) = &mut drawings[i];
            self.lights[*id].chosen = drawing.take();
        }
    }

    fn check_mask(&self, of: Option<LightId>, mask: &Mask) -> Result<(), Error> {
        let is_taken = self.lights.iter().any(|(id, entry)| Some(id) != of && entry.mask.overlaps(mask));
        if is_taken { bad("a light's mask", "another light's, or part of it", "one of its own") } else { Ok(()) }
    }
}

impl<'a> PreparedLights<'a> {
    /// Lights that the frame redraws.
    pub fn drawn(&self) -> impl Iterator<Item = LightId> + '_ {
        self.works.iter().map(|(id, _)| *id)
    }

    /// Records the work of all lights, one after the other.
    pub fn record(self, recorder: &mut Recorder<'_>) {
        self.works.into_iter().for_each(|(_, work)| work.record(recorder));
    }
}

impl Entry {
    /// Pixels and texels of the frame drawn last; `None` where there was none.
    fn known_texels(&mut self) -> Option<u64> {
        if self.state == MaskState::Drawn {
            self.texels = Some(self.shadow.map_texels() + self.pixels());
        }
        self.texels
    }

    /// Pixels of the mask.
    fn pixels(&self) -> u64 {
        self.mask.size_px().as_u64vec2().element_product()
    }

    /// Candidate for the schedule, and what it would draw with; `None` where the light need not be redrawn.
    fn candidate(
        &mut self,
        frame: &LightSetFrame<'_>,
        seen: &SeenSpace,
        largest: Option<u64>,
    ) -> Option<(Candidate, Drawing)> {
        let Some(area) = seen.share_of(&self.light.ball()) else {
            // The mask may be of another view by the time that the light is seen again.
            (self.state, self.waits, self.drawn) = (MaskState::Culled, 0, None);
            return None;
        };
        let casters = self.light.casters(frame.casters);
        let asked = Frame { light: &self.light.light, casters, receivers: frame.receivers, mask: &self.mask };
        let drawing = (self.light.light.for_shadows(), casters.key());
        if self.shadow.holds(&asked, drawing.1) {
            (self.state, self.waits, self.drawn) = (MaskState::Current, 0, Some(drawing));
            return None;
        }
        if !self.shadow.is_intact() {
            self.drawn = None;
        }
        self.waits = self.waits.saturating_add(1);
        let change = match &self.drawn {
            None => Change::All,
            Some(drawn) if *drawn == drawing => Change::View,
            Some(_) => Change::Shadows,
        };
        self.state = if self.drawn.is_some() { MaskState::Kept { age: self.waits } } else { MaskState::Missing };
        let cost = match frame.budget {
            Budget::Lights(_) => 1,
            Budget::Texels(_) => self.texels.or(largest).unwrap_or_else(|| self.pixels()),
        };
        Some((Candidate { area, change, waits: self.waits, cost }, drawing))
    }

    fn prepare<'a>(&'a mut self, frame: &LightSetFrame<'a>, drawing: Drawing) -> Result<Prepared<'a>, Error> {
        let casters = self.light.casters(frame.casters);
        let Self { light, shadow, mask, .. } = self;
        let work = shadow.prepare(&Frame { light: &light.light, casters, receivers: frame.receivers, mask })?;
        (self.state, self.waits) = (MaskState::Drawn, 0);
        self.drawn = Some(drawing);
        Ok(work)
    }
}

fn check_budget(budget: Budget) -> Result<(), Error> {
    match budget {
        Budget::Lights(0) | Budget::Texels(0) => bad("the budget", format!("{budget:?}"), "1 or more"),
        Budget::Lights(_) | Budget::Texels(_) => Ok(()),
    }
}

fn gone() -> Error {
    let (had, needed) = ("not in this set".into(), "one that was added and not removed".into());
    Error::BadFrame { technique: WHO, what: "the light", had, needed }
}

fn bad(what: &'static str, had: impl Into<String>, needed: &str) -> Result<(), Error> {
    Err(Error::BadFrame { technique: WHO, what, had: had.into(), needed: needed.into() })
}
