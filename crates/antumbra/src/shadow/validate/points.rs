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
            return self.bad("the number of points", "0", "at least 1");
        }
        if receivers.row_length == Some(0) {
            return self.bad("the points' `row_length`", "0", "at least 1, or `None`");
        }
        let size = size_of_points(receivers.count, receivers.row_length);
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        if size.max_element() > most {
            return self.bad(
                "the number of points",
                format!("{} in {} rows of {}", receivers.count, size.y, size.x),
                format!("at most {most} rows of {most} points on this device"),
            );
        }
        Ok(())
    }

    pub(super) fn buffers(&self, validator: &mut Validator) -> Result<(), Error> {
        let PointFrame { receivers, visibilities, channels, .. } = self.frame;
        let read = [
            ("the buffer of the points' positions", 3),
            ("the buffer of the points' normals", 3),
            ("the buffer of the points' widths", 1),
        ];
        for ((what, floats), buffer) in read.into_iter().zip(receivers.buffers()) {
            if let Some(buffer) = buffer {
                self.point_buffer(validator, what, &buffer, floats)?;
                if buffer.buffer == *visibilities {
                    return self.bad(what, "also the buffer of the visibilities", "another buffer");
                }
            }
        }
        let written = PointBuffer { buffer: visibilities, offset: 0, stride: 4 * channels.count() };
        self.point_buffer(validator, "the buffer of the points' visibilities", &written, u64::from(channels.count()))
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
            return self.bad(what, "created without the usage STORAGE", "created with it");
        }
        if !offset.is_multiple_of(4) || !stride.is_multiple_of(4) || u64::from(stride) < 4 * floats {
            return self.bad(
                what,
                format!("laid out with an offset of {offset} and a stride of {stride} bytes"),
                format!("laid out in multiples of 4 bytes, with a stride of at least {}", 4 * floats),
            );
        }
        let end = offset + u64::from(self.frame.receivers.count - 1) * u64::from(stride) + 4 * floats;
        if end > buffer.size() {
            return self.bad(what, format!("{} bytes long", buffer.size()), format!("at least {end} bytes long"));
        }
        let most = self.gpu.device.limits().max_storage_buffer_binding_size;
        if buffer.size() > most {
            return self.bad(
                what,
                format!("{} bytes long", buffer.size()),
                format!("at most {most} bytes long, the limit of a binding on this device"),
            );
        }
        let validation_error =
            validator.buffers.validation_error(buffer.clone(), |buffer| storage_validation_error(self.gpu, buffer));
        let refuse = |validation_error| {
            self.bad(what, format!("one that cannot be bound ({validation_error})"), "a buffer of the light's device")
        };
        validation_error.map_or(Ok(()), refuse)
    }

    pub(super) fn widths(&self) -> Result<(), Error> {
        match self.frame.receivers.widths {
            PointWidths::Same(width_m) if !(width_m >= 0.0 && width_m.is_finite()) => {
                self.bad("the points' width", format!("{width_m} m"), "finite and at least 0 m")
            }
            _ => Ok(()),
        }
    }

    /// Refuses invalid bounds, hull and seen points.
    pub(super) fn point_places(&self) -> Result<(), Error> {
        let receivers = &self.frame.receivers;
        if let Some(problem) = receivers.bounds.problem() {
            return self.bad(
                "the points' bounding box",
                problem,
                "a box of all points whose first corner is the minimum",
            );
        }
        self.finite("the points' `hull`", receivers.hull)?;
        self.finite("the points' `seen`", receivers.seen)
    }
}
