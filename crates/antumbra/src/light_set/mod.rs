//! Set of lights seen by one camera, each with a state and a mask. A frame redraws as many as a budget allows.
//!
//! ```text
//!  lights ──► seen? ──► changed? ──► rank ──► first of them ──► prepare ──► record
//!            (range)     (key)    (schedule)   (budget)
//!               │           │                     └──► others keep their masks, which age
//!               └► culled   └► mask is current
//! ```
//!
//! A light has a range, beyond which the host does not shade by it. Lights whose ranges are out of view are culled. Casters outside
//! of a light's range are not drawn for it, and their changes do not redraw it. Lights that wait keep their maps and masks.
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
//! A kept mask is an image of the frame that drew it. If the camera has moved since, its shadows lag behind their surfaces by the
//! surfaces' motion in the image; [`MaskState::Kept`] has the number of frames. Give a light whose shadows must never lag a state
//! of its own outside the set.

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
    /// Distance from the light's centre beyond which the host does not shade by it, metres; infinite for a sun. Visibility is not
    /// correct beyond it.
    pub range_m: f32,
    /// Bit mask of the layers whose casters the light sees; `u32::MAX`, the default, for all.
    pub layers: u32,
}

impl RangedLight {
    /// Creates a light that sees casters of all layers.
    pub fn new(light: Light, range_m: f32) -> Self {
        Self { light, range_m, layers: u32::MAX }
    }

    /// Ball that contains the light and all that it shades, and therefore all casters that matter.
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
        self.light.validate().map_err(|source| Error::Light { technique: ERROR_SOURCE, source })?;
        let range_m = self.range_m;
        if range_m.is_nan() || range_m <= 0.0 {
            return bad("a light's range", format!("{range_m} m"), "above 0 m, or infinite for no limit");
        }
        if self.light.is_distant() && range_m.is_finite() {
            return bad("a sun's range", format!("{range_m} m"), "infinite");
        }
        Ok(())
    }
}

/// Upper limit of what a frame redraws. At least one light is redrawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// Number of lights; `u32::MAX` for all.
    Lights(u32),
    /// Total number of mask pixels and map texels, layers behind included. A light counts with what it drew last; one that was
    /// never drawn counts as the largest of the others.
    Texels(u64),
}

/// Frame of a light set.
#[derive(Clone, Copy, Debug)]
pub struct LightSetFrame<'a> {
    /// Casters, uploaded by [`CasterSet::update`].
    pub casters: &'a CasterSet,
    /// Receivers, of the masks' size. With a [`version`](Receivers::version), masks of frames in which nothing changed are not redrawn.
    pub receivers: Receivers<'a>,
    /// Upper limit of what is redrawn.
    pub budget: Budget,
}

/// State of a light's mask in the frame prepared last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskState {
    /// The frame draws the mask.
    Drawn,
    /// Nothing that the mask depends on has changed since it was drawn.
    Current,
    /// The mask is of an earlier frame.
    Kept {
        /// Number of frames since the mask was drawn, or last was current.
        age: u32,
    },
    /// The light came into view and was not drawn yet: the mask has no valid content. Shade without the mask, or skip the light.
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
    /// Light and casters that the mask was drawn with, if it is of this view.
    drawn: Option<Drawing>,
    /// Number of frames for which the mask was out of date.
    waits: u32,
    /// Number of mask pixels and map texels that the light drew last.
    texels: Option<u64>,
    /// Light and casters to draw the mask with, if the frame redraws it.
    chosen: Option<Drawing>,
}

/// Light and casters of a mask.
type Drawing = (Light, Option<CastersKey>);

/// Prepared frame of a light set.
#[must_use = "`prepare` draws nothing until its result is recorded"]
#[derive(Debug)]
pub struct PreparedLights<'a> {
    works: Vec<(LightId, Prepared<'a>)>,
}

/// Name in errors, in place of a technique's.
const ERROR_SOURCE: &str = "light set";

impl LightSet {
    /// Creates an empty set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a light with its state and its mask, which is [`MaskState::Missing`] until a frame draws it.
    ///
    /// # Errors
    /// If light or range are invalid, or another light has the mask.
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
    /// If there is no such light, or light or range are invalid.
    pub fn set_light(&mut self, id: LightId, light: RangedLight) -> Result<(), Error> {
        light.check()?;
        self.lights.get_mut(id).ok_or_else(gone)?.light = light;
        Ok(())
    }

    /// Replaces a light's mask, as for a resized view. The new mask is redrawn.
    ///
    /// # Errors
    /// If there is no such light, or another light has the mask.
    pub fn set_mask(&mut self, id: LightId, mask: Mask) -> Result<(), Error> {
        self.check_mask(Some(id), &mask)?;
        let entry = self.lights.get_mut(id).ok_or_else(gone)?;
        (entry.mask, entry.drawn) = (mask, None);
        Ok(())
    }

    /// Removes a light and returns its state and mask; `None` if there is no such light.
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

    /// Light of a handle.
    pub fn light(&self, id: LightId) -> Option<&RangedLight> {
        self.lights.get(id).map(|entry| &entry.light)
    }

    /// Mask of a light.
    pub fn mask(&self, id: LightId) -> Option<&Mask> {
        self.lights.get(id).map(|entry| &entry.mask)
    }

    /// State of a light, for its reports.
    pub fn shadow(&self, id: LightId) -> Option<&AnyShadow> {
        self.lights.get(id).map(|entry| &entry.shadow)
    }

    /// State of a light, for setting its parameters: a different value redraws the light.
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
    /// A light that changes in every frame is redrawn within five times the number of frames that the budget needs for all such
    /// lights; with [`Budget::Texels`], within four times that number plus one frame per light.
    ///
    /// # Errors
    /// If the budget is zero or the casters were changed since their last update, and as [`AnyShadow::prepare`].
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

    /// Sets the state of each light's mask, and chooses the lights that the frame redraws.
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
        if is_taken {
            bad("a light's mask", "in use: it overlaps the mask of another light", "used by one light only")
        } else {
            Ok(())
        }
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
    /// Number of mask pixels and map texels that the light drew last; `None` if it was never drawn.
    fn known_texels(&mut self) -> Option<u64> {
        if self.state == MaskState::Drawn {
            self.texels = Some(self.shadow.map_texels() + self.pixels());
        }
        self.texels
    }

    /// Number of pixels of the mask.
    fn pixels(&self) -> u64 {
        self.mask.size_px().as_u64vec2().element_product()
    }

    /// Candidate for the schedule, with the light and casters to draw; `None` if the light need not be redrawn.
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
        Budget::Lights(0) | Budget::Texels(0) => bad("the budget", format!("{budget:?}"), "at least 1"),
        Budget::Lights(_) | Budget::Texels(_) => Ok(()),
    }
}

fn gone() -> Error {
    let (had, needed) = ("not in this set".into(), "one that was added to this set and not removed".into());
    Error::BadFrame { technique: ERROR_SOURCE, what: "the light", had, needed }
}

fn bad(what: &'static str, had: impl Into<String>, needed: &str) -> Result<(), Error> {
    Err(Error::BadFrame { technique: ERROR_SOURCE, what, had: had.into(), needed: needed.into() })
}
