//! One light's shadow by one technique: its state, and the work of a frame as a value.
//!
//! A state is cheap to make and drop: programs belong to the device, and every light shares them. It keeps maps and
//! lists from frame to frame, so give each light one, and each of several views of a light one of its own.
//!
//! [`Shadow::prepare`] gives [`Prepared`] work, and [`Prepared::record`] takes it. Between the two the state is borrowed, so
//! that no other frame of it can come between; several lights are prepared and recorded in any order. Uploads travel with
//! the work, so frames may be recorded one after the other and submitted together: submit in the order of recording.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra_light::{Aabb, Light};
use glam::{Mat4, UVec2, Vec3};

use crate::casters::CastersKey;
use crate::contract::{
    Casters, DepthConvention, Error, Frame, MaskChannels, MaskPlace, MeshCaster, Overflow, ParamError, ParamSpec,
    ParamValue, Params, Quality,
};
use crate::frame::narrow_mask::NarrowMask;
use crate::gpu::{CommandsEnd, Gpu, Keep, Recorder, Stage, StagedUploads};
use crate::techniques::{Technique, TechniqueKind};

#[cfg(test)]
mod tests;
mod warm_up;

pub use warm_up::WarmUp;

/// One light's shadow by a technique that is known at compile time.
pub struct Shadow<T: Technique> {
    gpu: Gpu,
    /// What the next frame is prepared by.
    pub params: T::Params,
    technique: T,
    /// Where the host's mask has fewer bits than the technique's.
    narrow: Option<NarrowMask>,
    keep: Keep,
    /// The last frame failed or was never recorded: what it had made ready is not to be relied on.
    is_stale: bool,
    /// Commands of an earlier frame were never submitted: what they would have drawn is not there.
    are_dropped: Arc<AtomicBool>,
    /// What the mask holds, where that can be told.
    drawn: Option<FrameKey<T::Params>>,
}

/// What tells a frame from others.
#[derive(Debug, PartialEq)]
struct FrameKey<P> {
    params: P,
    light: Light,
    casters: CastersKey,
    mask: (wgpu::Texture, MaskPlace, MaskChannels),
    size_px: UVec2,
    origin_px: UVec2,
    depth: wgpu::TextureView,
    depth_convention: DepthConvention,
    camera: [Mat4; 2],
    normals: Option<wgpu::TextureView>,
    bounds: Option<Aabb>,
    points: [Vec<Vec3>; 2],
    version: u64,
}

impl<P: Params> FrameKey<P> {
    /// `None` where the host does not say when depth or casters change.
    fn of(params: &P, frame: &Frame<'_>, casters: Option<CastersKey>) -> Option<Self> {
        let receivers = &frame.receivers;
        Some(Self {
            casters: casters?,
            version: receivers.version?,
            params: params.clone(),
            light: frame.light.clone(),
            mask: (frame.mask.texture().clone(), frame.mask.place(), frame.mask.channels()),
            size_px: receivers.size_px,
            origin_px: receivers.origin_px,
            depth: receivers.depth.clone(),
            depth_convention: receivers.depth_convention,
            camera: [receivers.view_from_world, receivers.clip_from_view],
            normals: receivers.normals.cloned(),
            bounds: receivers.bounds,
            points: [receivers.hull, receivers.seen].map(<[Vec3]>::to_vec),
        })
    }
}

impl<T: Technique> fmt::Debug for Shadow<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Shadow({})", T::KIND)
    }
}

impl<T: Technique> Shadow<T> {
    /// A light's state, with default parameters.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the device lacks something.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        Self::with_params(gpu, T::Params::default())
    }

    /// A light's state.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_params(gpu: &Gpu, params: T::Params) -> Result<Self, Error> {
        Ok(Self {
            gpu: gpu.clone(),
            params,
            technique: T::new(gpu)?,
            narrow: None,
            keep: Keep::default(),
            is_stale: false,
            are_dropped: Arc::default(),
            drawn: None,
        })
    }

    /// Makes ready for `frame`: fits, allocates, puts uploads aside.
    ///
    /// # Errors
    /// Where parameters, light or frame do not fit one another or the device. Nothing is left that draws.
    pub fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error> {
        self.params.validate(T::KIND.name())?;
        let casters = match frame.casters {
            Casters::Set { set, layers } => Some(set.key(layers)),
            Casters::Meshes(_) | Casters::DepthMap(_) => None,
        };
        let are_dropped = self.are_dropped.swap(false, Ordering::AcqRel);
        let key = FrameKey::of(&self.params, frame, casters);
        if !(self.is_stale || are_dropped)
            && key.is_some()
            && key == self.drawn
            && self.technique.is_settled(&self.params)
        {
            return Ok(Prepared { meshes: None, work: self, frame: *frame, uploads: None });
        }
        self.drawn = None;
        if std::mem::replace(&mut self.is_stale, true) || are_dropped {
            self.technique = T::new(&self.gpu)?;
        }
        let stage = Stage::new(&self.gpu, std::mem::take(&mut self.keep), casters);
        let outcome = meshes_of(&frame.casters).and_then(|meshes| {
            let casters = with_meshes(&frame.casters, meshes.as_deref());
            self.narrow =
                NarrowMask::serves(frame.mask).then(|| NarrowMask::prepare(&stage, frame.mask, self.narrow.take()));
            let mask = self.narrow.as_ref().map_or(frame.mask, NarrowMask::wide);
            self.technique.prepare(&stage, &Frame { casters, mask, ..*frame }, &self.params)?;
            Ok(meshes)
        });
        let uploads;
        (self.keep, uploads) = stage.finish();
        let meshes = outcome?;
        self.drawn = key;
        Ok(Prepared { meshes, work: self, frame: *frame, uploads: Some(uploads) })
    }

    /// The technique, for what it has besides a mask.
    pub fn technique(&self) -> &T {
        &self.technique
    }

    /// Bytes of GPU memory that the state holds; the mask, programs and the host's resources apart.
    pub fn memory_bytes(&self) -> u64 {
        self.technique.memory_bytes()
    }

    /// What the newest finished frame lacked room for, as far as the last [`prepare`](Self::prepare) has learnt, which
    /// has made room.
    pub fn overflow(&self) -> Option<Overflow> {
        self.technique.overflow()
    }
}

/// A frame of one light, ready to be recorded.
#[must_use = "nothing is drawn before it is recorded"]
pub struct Prepared<'a> {
    work: &'a mut dyn Work,
    frame: Frame<'a>,
    /// Those of a set.
    meshes: Option<Vec<MeshCaster<'a>>>,
    /// None where the mask holds the frame.
    uploads: Option<StagedUploads>,
}

impl fmt::Debug for Prepared<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Prepared").field("frame", &self.frame).finish_non_exhaustive()
    }
}

impl Prepared<'_> {
    /// What the newest finished frame lacked room for, as far as is known; this one has room for as much.
    pub fn overflow(&self) -> Option<Overflow> {
        self.work.overflow()
    }

    /// Records the frame's uploads and passes: none where the mask holds just this frame.
    pub fn record(self, recorder: &mut Recorder<'_>) {
        let Some(uploads) = self.uploads else { return };
        recorder.upload(uploads, self.work.commands_end());
        let casters = with_meshes(&self.frame.casters, self.meshes.as_deref());
        self.work.record(recorder, &Frame { casters, ..self.frame });
    }
}

/// A set's casters, as techniques take them; `None` where there is no set.
fn meshes_of<'a>(casters: &Casters<'a>) -> Result<Option<Vec<MeshCaster<'a>>>, Error> {
    match casters {
        Casters::Set { set, layers } => set.meshes(*layers).map(Some),
        Casters::Meshes(_) | Casters::DepthMap(_) => Ok(None),
    }
}

/// The casters with a set's in the set's place.
fn with_meshes<'a>(casters: &Casters<'a>, meshes: Option<&'a [MeshCaster<'a>]>) -> Casters<'a> {
    meshes.map_or(*casters, Casters::Meshes)
}

/// A state of whatever technique, for [`Prepared`].
trait Work: wgpu::WasmNotSendSync {
    fn overflow(&self) -> Option<Overflow>;
    fn commands_end(&self) -> CommandsEnd;
    fn record(&mut self, recorder: &mut Recorder<'_>, frame: &Frame<'_>);
}

impl<T: Technique> Work for Shadow<T> {
    fn commands_end(&self) -> CommandsEnd {
        CommandsEnd::of(&self.are_dropped)
    }
    fn overflow(&self) -> Option<Overflow> {
        self.technique.overflow()
    }
    fn record(&mut self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let mask = self.narrow.as_ref().map_or(frame.mask, NarrowMask::wide);
        self.technique.record(recorder, &Frame { mask, ..*frame });
        if let Some(narrow) = &self.narrow {
            narrow.record(recorder, frame.mask);
        }
        self.is_stale = false;
    }
}

/// Object-safe twin of [`Shadow`].
trait ErasedShadow: wgpu::WasmNotSendSync {
    fn get(&self, key: &str) -> Option<ParamValue>;
    fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError>;
    fn set_quality(&mut self, quality: Quality);
    fn warm_up(&self, what: WarmUp) -> Result<(), Error>;
    fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error>;
    fn memory_bytes(&self) -> u64;
    fn overflow(&self) -> Option<Overflow>;
}

impl<T: Technique> ErasedShadow for Shadow<T> {
    fn get(&self, key: &str) -> Option<ParamValue> {
        self.params.get(key)
    }
    fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError> {
        self.params.set(T::KIND.name(), key, text)
    }
    fn set_quality(&mut self, quality: Quality) {
        self.params = T::Params::of_quality(quality);
    }
    fn warm_up(&self, what: WarmUp) -> Result<(), Error> {
        Shadow::warm_up(self, what)
    }
    fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error> {
        Shadow::prepare(self, frame)
    }
    fn memory_bytes(&self) -> u64 {
        Shadow::memory_bytes(self)
    }
    fn overflow(&self) -> Option<Overflow> {
        Shadow::overflow(self)
    }
}

/// One light's shadow by a technique chosen while the program runs.
pub struct AnyShadow {
    kind: TechniqueKind,
    inner: Box<dyn ErasedShadow>,
}

impl fmt::Debug for AnyShadow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyShadow({})", self.kind)
    }
}

impl<T: Technique + 'static> From<Shadow<T>> for AnyShadow {
    fn from(shadow: Shadow<T>) -> Self {
        Self { kind: T::KIND, inner: Box::new(shadow) }
    }
}

impl AnyShadow {
    /// Which technique this is by.
    pub fn kind(&self) -> TechniqueKind {
        self.kind
    }

    /// The parameters with their present values.
    pub fn params(&self) -> impl Iterator<Item = (&'static ParamSpec, ParamValue)> + '_ {
        self.kind.param_specs().iter().map(|spec| (spec, self.inner.get(spec.key).unwrap_or(spec.default)))
    }

    /// Sets a parameter from text, for the next frame.
    ///
    /// # Errors
    /// Names the keys there are, or what the key takes.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError> {
        self.inner.set(key, text)
    }

    /// Sets all parameters to what a quality has, for the next frame; set single ones after it.
    pub fn set_quality(&mut self, quality: Quality) {
        self.inner.set_quality(quality);
    }

    /// [`Shadow::warm_up`].
    ///
    /// # Errors
    /// As [`Shadow::warm_up`].
    pub fn warm_up(&self, what: WarmUp) -> Result<(), Error> {
        self.inner.warm_up(what)
    }

    /// [`Shadow::prepare`].
    ///
    /// # Errors
    /// As [`Shadow::prepare`].
    pub fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error> {
        self.inner.prepare(frame)
    }

    /// [`Shadow::memory_bytes`].
    pub fn memory_bytes(&self) -> u64 {
        self.inner.memory_bytes()
    }

    /// [`Shadow::overflow`].
    pub fn overflow(&self) -> Option<Overflow> {
        self.inner.overflow()
    }
}
