//! Validation of receivers that are points: their buffers, widths and bounds.

use super::{Check, Validator};
use crate::contract::{Error, PointBuffer, PointWidths};
use crate::gpu::storage_validation_error;
use crate::receivers::points::size_of_points;
use crate::shadow::PointFrame;

impl Check<'_, PointFrame<'_>> {
    pub(super) fn count(&self) -> Result<(), Error> {
        let receivers = &self.frame.receivers;
        if receivers.count == 0 {
            return self.bad("the points' count", "0", "1 at least");
        }
        if receivers.row_length == Some(0) {
            return self.bad("the points' `row_length`", "0", "1 at least, or `None`");
        }
        let size = size_of_points(receivers.count, receivers.row_length);
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        if size.max_element() > most {
            return self.bad(
                "the points' count",
                format!("{} in {} rows of {}", receivers.count, size.y, size.x),
                format!("at most {most} rows of {most} on this device"),
            );
        }
        Ok(())
    }

    pub(super) fn buffers(&self, validator: &mut Validator) -> Result<(), Error> {
        let PointFrame { receivers, visibilities, channels, .. } = self.frame;
        let read = [("the points' positions", 3), ("the points' normals", 3), ("the points' widths", 1)];
        for ((what, floats), buffer) in read.into_iter().zip(receivers.buffers()) {
            if let Some(buffer) = buffer {
                self.point_buffer(validator, what, &buffer, floats)?;
                if buffer.buffer == *visibilities {
                    return self.bad(what, "in the buffer of the visibilities", "in another one");
                }
            }
        }
        let written = PointBuffer { buffer: visibilities, offset: 0, stride: 4 * channels.count() };
        self.point_buffer(validator, "the points' visibilities", &written, u64::from(channels.count()))
    }

    /// Refuses a buffer that has fewer than `floats` floats per point, or cannot be bound.
    pub(super) fn point_buffer(
        &self,
        validator: &mut Validator,
        what: &'static str,
        of: &PointBuffer<'_>,
        floats: u64,
    ) -> Result<(), Error> {
        let PointBuffer { buffer, offset, stride } = *of;
        if !buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return self.bad(what, "in a buffer without the usage STORAGE", "in one with it");
        }
        if !offset.is_multiple_of(4) || !stride.is_multiple_of(4) || u64::from(stride) < 4 * floats {
            return self.bad(
                what,
                format!("from byte {offset} on, {stride} bytes apart"),
                format!("at multiples of 4 bytes, {} apart at least", 4 * floats),
            );
        }
        let end = offset + u64::from(self.frame.receivers.count - 1) * u64::from(stride) + 4 * floats;
        if end > buffer.size() {
            return self.bad(what, format!("up to byte {end} of a buffer of {}", buffer.size()), "within the buffer");
        }
        let most = self.gpu.device.limits().max_storage_buffer_binding_size;
        if buffer.size() > most {
            return self.bad(
                what,
                format!("in a buffer of {} bytes", buffer.size()),
                format!("in one of {most} at most, which this device binds"),
            );
        }
        let validation_error =
            validator.buffers.validation_error(buffer.clone(), |buffer| storage_validation_error(self.gpu, buffer));
        let refuse = |validation_error| {
            self.bad(
                what,
                format!("in a buffer that cannot be bound ({validation_error})"),
                "in one of the light's device",
            )
        };
        validation_error.map_or(Ok(()), refuse)
    }

    pub(super) fn widths(&self) -> Result<(), Error> {
        match self.frame.receivers.widths {
            PointWidths::Same(width_m) if !(width_m >= 0.0 && width_m.is_finite()) => {
                self.bad("the points' width", format!("{width_m} m"), "0 or more, and finite")
            }
            _ => Ok(()),
        }
    }

    /// Refuses invalid bounds, hull and seen points.
    pub(super) fn point_places(&self) -> Result<(), Error> {
        let receivers = &self.frame.receivers;
        if let Some(problem) = receivers.bounds.problem() {
            return self.bad("the points' box", problem, "a box of all points with its least corner first");
        }
        self.finite("the points' `hull`", receivers.hull)?;
        self.finite("the points' `seen`", receivers.seen)
    }
}
