//! Interface of every technique: pipelines, a prepared frame, a recorded frame.

use antumbra_light::Light;

use crate::contract::{DrawnLists, DrawnMap, Error, Overflow, Params, PreparedFrame};
use crate::gpu::{Embeddable, Gpu, Recorder, Stage};
use crate::light_partition::Coverage;

/// Seal of [`Technique`]: the list of techniques implements it for each entry.
pub trait Listed {}

/// A shadow technique, as the library runs it: hosts use it through [`Shadow`](crate::Shadow).
///
/// Three phases: [`new`](Self::new) asks for programs and checks features and limits; [`prepare`](Self::prepare)
/// allocates and uploads, and may fail; [`record`](Self::record) only records. None of them submits or blocks.
///
/// Sealed: techniques are those of [`TechniqueKind`](crate::TechniqueKind).
pub trait Technique: Sized + Listed + wgpu::WasmNotSendSync {
    /// The name that command lines, files and errors use.
    const NAME: &'static str;
    /// Its parameters.
    type Params: Params;
    /// Bind groups and pipelines of one frame: [`prepare`](Self::prepare) returns them, [`record`](Self::record) requires them.
    type Prepared: wgpu::WasmNotSendSync + 'static;

    /// How much of what a light reaches a state covers; what is more is cut into parts, with a state each.
    fn coverage(_params: &Self::Params) -> Coverage {
        Coverage::Window
    }

    /// Whether visibility is noisy and written with how far it may be smoothed, as `mask/smoothing/noisy.wesl` says, where a frame has
    /// [such a target](PreparedFrame::noisy).
    fn is_noisy(_params: &Self::Params, _light: &Light) -> bool {
        false
    }

    /// Makes what one light needs beside the programs that all lights share.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the device lacks something.
    fn new(gpu: &Gpu) -> Result<Self, Error>;

    /// Makes ready for `frame`: fits, allocates, uploads.
    ///
    /// # Errors
    /// Where parameters, light or frame do not fit one another or the device.
    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &Self::Params,
    ) -> Result<Self::Prepared, Error>;

    /// Records the passes of a frame, as [`prepare`](Self::prepare) made them ready.
    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &Self::Prepared);

    /// Whether the mask of a frame that is as the one before would be the same: nothing goes on from frame to frame, and
    /// nothing is yet to be learnt of the last. So many frames as it were prepared after the first of them.
    fn is_settled(&self, _params: &Self::Params, _still_frames: u32) -> bool {
        true
    }

    /// The one depth map that the frame prepared last draws and reads, with what is made of it; `None` of techniques that have
    /// none, or many.
    fn drawn_map(&self) -> Option<DrawnMap> {
        None
    }

    /// All of them: of a light that is seen from many points, or to all sides, more than one.
    fn drawn_maps(&self) -> Vec<DrawnMap> {
        self.drawn_map().into_iter().collect()
    }

    /// The lists per texel that the frame prepared last makes and reads, a set for each window that the light looks through;
    /// none of techniques that keep no lists.
    fn drawn_lists(&self) -> Vec<DrawnLists> {
        Vec::new()
    }

    /// What a host's shader needs to ask for visibility itself, as the frame prepared last gives it; `None` of techniques that have no
    /// such function, or before a frame.
    #[doc(hidden)]
    fn embeddable(&self) -> Option<Embeddable> {
        None
    }

    /// Bytes of GPU memory that the technique holds, the mask and the host's resources apart.
    fn memory_bytes(&self) -> u64;

    /// What the newest finished frame lacked room for, as far as the last [`prepare`](Self::prepare) has learnt. That
    /// `prepare` has made room: the frame it was for lacks it no more.
    fn overflow(&self) -> Option<Overflow> {
        None
    }
}
