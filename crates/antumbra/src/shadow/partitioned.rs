//! State of a light that is covered in parts: a technique for each part, and what the parts share.

use glam::Vec3;

use crate::contract::{DrawnLists, DrawnMap, Error, MeshCaster, Overflow, Params, PreparedCasters, PreparedFrame};
use crate::gpu::{Gpu, Recorder, RetainedState, Stage};
use crate::light_partition::part_images::{PartImages, PreparedPartImages};
use crate::light_partition::stable_boxes::StableBoxes;
use crate::light_partition::{Part, parts_of};
use crate::techniques::Technique;

/// State of a light's parts.
pub(super) struct PartitionedState<T> {
    images: PartImages,
    /// Parts of the frame prepared last; empty if the technique covers all that the light reaches.
    parts: Vec<Part>,
    /// State of every part that any frame had, so that parts that come and go create nothing.
    states: Vec<PartState<T>>,
    /// Boxes that keep a sun's cascades in place.
    stable_boxes: StableBoxes,
}

struct PartState<T> {
    id: u32,
    /// Whether the part ever had casters, so that its maps keep their size while casters come and go.
    has_cast: bool,
    technique: T,
    keep: RetainedState,
}

/// Inputs for preparing a part.
struct PartStage<'a> {
    of_light: &'a Stage<'a>,
    stable_box: Option<[Vec3; 8]>,
    /// Number of parts of the light.
    part_count: usize,
}

/// Passes of all parts in one frame; `P` is the technique's prepared work.
pub(super) struct PartitionedPasses<'a, P> {
    images: PreparedPartImages,
    parts: Vec<PartPasses<'a, P>>,
}

struct PartPasses<'a, P> {
    casters: Vec<MeshCaster<'a>>,
    technique: P,
}

impl<T: Technique> PartitionedState<T> {
    /// Prepares a frame in parts. Does nothing and returns `None` if the technique covers all that the light reaches.
    pub(super) fn prepare<'a>(
        earlier: &mut Option<Self>,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'a>],
        params: &T::Params,
    ) -> Result<Option<PartitionedPasses<'a, T::Prepared>>, Error> {
        let mut stable_boxes =
            earlier.as_mut().map(|earlier| std::mem::take(&mut earlier.stable_boxes)).unwrap_or_default();
        let parts =
            parts_of(frame, T::coverage(params), stage.anchor(), &mut stable_boxes, stage.device.shared_values());
        if parts.is_empty() {
            if let Some(earlier) = earlier {
                earlier.parts = parts;
            }
            return Ok(None);
        }
        let parted = earlier.get_or_insert_with(|| Self {
            images: PartImages::new(stage),
            parts: Vec::new(),
            states: Vec::new(),
            stable_boxes: StableBoxes::default(),
        });
        parted.stable_boxes = stable_boxes;
        let images = parted.images.prepare(stage, frame, &parts);
        parted.parts = parts;
        let Self { parts, states, .. } = parted;
        let mut passes = Vec::with_capacity(parts.len());
        let part_count = parts.len();
        for part in &*parts {
            let casters = part.casters_of(meshes);
            let state = PartState::of(states, stage, part.id)?;
            let of_part = images.frame_of(frame, part);
            let frame = PreparedFrame { casters: of_meshes(&frame.casters, &casters), ..of_part };
            state.has_cast |= !casters.is_empty() || !matches!(frame.casters, PreparedCasters::Draws(_));
            let stage = &PartStage { of_light: stage, stable_box: part.stable_box, part_count };
            let technique = if state.has_cast {
                state.prepare(stage, &frame, params)?
            } else {
                state.prepare(stage, &frame, &with_least_maps(params))?
            };
            passes.push(PartPasses { casters, technique });
        }
        Ok(Some(PartitionedPasses { images, parts: passes }))
    }

    /// Records a frame, part by part.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        frame: &PreparedFrame<'_>,
        passes: PartitionedPasses<'_, T::Prepared>,
    ) {
        let PartitionedPasses { images, parts } = passes;
        for (i, (part, passes)) in self.parts.iter().zip(parts).enumerate() {
            let Some(state) = self.states.iter().find(|state| state.id == part.id) else { continue };
            images.pick(recorder, i);
            let frame = images.frame_of(frame, part);
            let casters = of_meshes(&frame.casters, &passes.casters);
            state.technique.record(recorder, &PreparedFrame { casters, ..frame }, &passes.technique);
            images.join(recorder, i);
        }
    }

    /// Whether the frame prepared last is in parts.
    pub(super) fn is_in_use(&self) -> bool {
        !self.parts.is_empty()
    }

    fn states_in_use(&self) -> impl Iterator<Item = &PartState<T>> {
        self.states.iter().filter(|state| self.parts.iter().any(|part| part.id == state.id))
    }

    pub(super) fn is_settled(&self, params: &T::Params, still_frames: u32) -> bool {
        self.states_in_use().all(|state| state.technique.is_settled(params, still_frames))
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.states.iter().map(|state| state.technique.memory_bytes() + state.keep.memory_bytes()).sum()
    }

    /// Texels along a side of each part's map, if chosen per frame; omits parts without casters.
    pub(super) fn auto_map_sizes(&self) -> impl Iterator<Item = u32> {
        self.states_in_use().filter_map(|state| state.keep.auto_texels())
    }

    /// Depth maps of all parts.
    pub(super) fn drawn_maps(&self) -> impl Iterator<Item = DrawnMap> {
        self.states_in_use().flat_map(|state| state.technique.drawn_maps())
    }

    /// Lists of all parts.
    pub(super) fn drawn_lists(&self) -> impl Iterator<Item = DrawnLists> {
        self.states_in_use().flat_map(|state| state.technique.drawn_lists())
    }

    /// Largest overflow of any part.
    pub(super) fn overflow(&self) -> Option<Overflow> {
        let overflows = self.states_in_use().filter_map(|state| state.technique.overflow());
        overflows.max_by_key(|overflow| overflow.needed - overflow.had)
    }
}

/// Returns parameters with the smallest maps, for a part without casters.
fn with_least_maps<P: Params>(params: &P) -> P {
    const SIZES: [&str; 2] = ["map_size", "view_size"];
    let mut least = params.clone();
    for spec in P::specs().iter().filter(|spec| SIZES.contains(&spec.key)) {
        if let Some((low, _)) = spec.range {
            least.set("", spec.key, &low.to_string()).expect("the least of its range");
        }
    }
    least
}

/// Returns a part's casters; a host's depth map serves every part.
fn of_meshes<'a>(of_frame: &PreparedCasters<'a>, of_part: &'a [MeshCaster<'a>]) -> PreparedCasters<'a> {
    match of_frame {
        PreparedCasters::HostDepthMap(map) => PreparedCasters::HostDepthMap(*map),
        PreparedCasters::Draws(_) => PreparedCasters::Draws(of_part),
    }
}

impl<T: Technique> PartState<T> {
    fn of<'a>(states: &'a mut Vec<Self>, gpu: &Gpu, id: u32) -> Result<&'a mut Self, Error> {
        let place = match states.iter().position(|state| state.id == id) {
            Some(place) => place,
            None => {
                states.push(Self { id, has_cast: false, technique: T::new(gpu)?, keep: RetainedState::default() });
                states.len() - 1
            }
        };
        Ok(&mut states[place])
    }

    fn prepare(
        &mut self,
        part: &PartStage<'_>,
        frame: &PreparedFrame<'_>,
        params: &T::Params,
    ) -> Result<T::Prepared, Error> {
        let of_light = part.of_light;
        let stage = of_light.of_part(std::mem::take(&mut self.keep), part.stable_box).sharing(part.part_count);
        let outcome = self.technique.prepare(&stage, frame, params);
        self.keep = stage.finish_part(of_light);
        outcome
    }
}
