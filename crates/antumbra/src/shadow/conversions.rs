//! Conversions at both ends of a frame's data: textures that techniques read and write in place of the host's receivers and mask,
//! if they need other formats.

use super::frame::{Frame, FrameRequest, PointFrame};
use crate::contract::{Mask, PreparedReceivers};
use crate::gpu::{Recorder, Stage};
use crate::mask::format::NarrowMask;
use crate::receivers::points::PointTextures;

/// Inputs and output of one frame, with their conversions.
pub(super) enum Conversions<'a> {
    /// A mask of a depth buffer.
    Mask {
        frame: Frame<'a>,
        /// Conversion to the host's format; `None` if techniques write the host's mask directly.
        narrow: Option<NarrowMask>,
    },
    /// Visibilities of points.
    Points { frame: PointFrame<'a>, textures: PointTextures },
}

/// Resources of the last frame's conversions.
#[derive(Clone, Debug, Default)]
pub(super) enum RetainedConversions {
    /// No conversion.
    #[default]
    Nothing,
    Narrow(Box<NarrowMask>),
    Points(Box<PointTextures>),
}

impl<'a> Conversions<'a> {
    /// Prepares the conversions of a host's request. `earlier` has the resources of the previous frame.
    pub(super) fn prepare(stage: &Stage<'_>, request: &FrameRequest<'a>, earlier: RetainedConversions) -> Self {
        match request {
            FrameRequest::Mask(frame) => {
                let earlier = if let RetainedConversions::Narrow(earlier) = earlier { Some(*earlier) } else { None };
                let narrow = NarrowMask::serves(frame.mask).then(|| NarrowMask::prepare(stage, frame.mask, earlier));
                Self::Mask { frame: *frame, narrow }
            }
            FrameRequest::Points(frame) => {
                let earlier = if let RetainedConversions::Points(earlier) = earlier { Some(*earlier) } else { None };
                let PointFrame { receivers, visibilities, channels, .. } = frame;
                let textures = PointTextures::prepare(stage, receivers, visibilities, *channels, earlier);
                Self::Points { frame: *frame, textures }
            }
        }
    }

    /// Receivers and mask as techniques receive them.
    pub(super) fn inner(&self) -> (PreparedReceivers<'_>, &Mask) {
        match self {
            Self::Mask { frame, narrow } => {
                (frame.receivers.into(), narrow.as_ref().map_or(frame.mask, NarrowMask::wide))
            }
            Self::Points { frame, textures } => (textures.receivers(&frame.receivers), textures.mask()),
        }
    }

    /// Records the conversion of the host's receivers to the technique's.
    pub(super) fn record_read(&self, recorder: &mut Recorder<'_>) {
        if let Self::Points { textures, .. } = self {
            textures.record_read(recorder);
        }
    }

    /// Records the conversion of the technique's mask to the host's output.
    pub(super) fn record_write(&self, recorder: &mut Recorder<'_>) {
        match self {
            Self::Mask { frame, narrow: Some(narrow) } => narrow.record(recorder, frame.mask),
            Self::Mask { narrow: None, .. } => {}
            Self::Points { textures, .. } => textures.record_write(recorder),
        }
    }

    /// Handles of the resources, for the next frame.
    pub(super) fn kept(&self) -> RetainedConversions {
        match self {
            Self::Mask { narrow: Some(narrow), .. } => RetainedConversions::Narrow(Box::new(narrow.clone())),
            Self::Mask { narrow: None, .. } => RetainedConversions::Nothing,
            Self::Points { textures, .. } => RetainedConversions::Points(Box::new(textures.clone())),
        }
    }
}
