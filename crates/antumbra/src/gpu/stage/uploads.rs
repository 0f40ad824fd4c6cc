//! Uploads of a frame: bytes that its commands copy to their targets, and the staging buffers in between.

use std::sync::Arc;

use super::RetainedState;
use crate::gpu::{CommandsEnd, Gpu};

/// Uploads collected so far.
#[derive(Debug, Default)]
pub(super) struct Uploads {
    pub(super) bytes: Vec<u8>,
    pub(super) copies: Vec<Copy>,
}

#[derive(Clone, Debug)]
pub(super) struct Copy {
    pub(super) to: wgpu::Buffer,
    pub(super) to_offset: u64,
    pub(super) from: u64,
    pub(super) bytes: u64,
}

/// Staging buffer. It is free if nothing else holds its ticket: a frame holds it until it is recorded, and its commands
/// hold it until the queue has finished or they are dropped.
#[derive(Debug)]
pub(super) struct Staging {
    pub(super) buffer: wgpu::Buffer,
    ticket: Arc<()>,
}

/// Uploads of a frame, to be recorded before its passes.
#[derive(Debug, Default)]
pub(crate) struct StagedUploads {
    from: Option<(wgpu::Buffer, Arc<()>)>,
    copies: Vec<Copy>,
}

impl StagedUploads {
    /// Records the copies of all uploads; `then` is notified when the commands are done or dropped.
    pub(crate) fn record(self, encoder: &mut wgpu::CommandEncoder, then: CommandsEnd) {
        let ticket = self.from.map(|(buffer, ticket)| {
            for Copy { to, to_offset, from, bytes } in &self.copies {
                encoder.copy_buffer_to_buffer(&buffer, *from, to, *to_offset, *bytes);
            }
            ticket
        });
        encoder.on_submitted_work_done(move || {
            drop(ticket);
            then.done();
        });
    }
}

/// Minimum size of a staging buffer, bytes: enough for most frames.
const MIN_STAGING_BYTES: u64 = 16 << 10;

impl Uploads {
    /// Moves the uploads of another collection into this one.
    pub(super) fn append(&mut self, other: &mut Self) {
        let first = self.bytes.len() as u64;
        self.bytes.append(&mut other.bytes);
        self.copies.extend(other.copies.drain(..).map(|copy| Copy { from: first + copy.from, ..copy }));
    }
}

impl RetainedState {
    pub(super) fn stage_uploads(&mut self, gpu: &Gpu) -> StagedUploads {
        let bytes = self.uploads.bytes.len() as u64;
        if bytes == 0 {
            return StagedUploads::default();
        }
        let is_free = |staging: &Staging| Arc::strong_count(&staging.ticket) == 1;
        // Replaces a free buffer that is too small, rather than keeping both.
        self.staging.retain(|staging| !is_free(staging) || staging.buffer.size() >= bytes);
        let place = self.staging.iter().position(is_free).unwrap_or_else(|| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra staging"),
                size: bytes.max(MIN_STAGING_BYTES).next_power_of_two(),
                usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            self.staging.push(Staging { buffer, ticket: Arc::new(()) });
            self.staging.len() - 1
        });
        let Staging { buffer, ticket } = &self.staging[place];
        gpu.queue.write_buffer(buffer, 0, &self.uploads.bytes);
        StagedUploads {
            from: Some((buffer.clone(), Arc::clone(ticket))),
            copies: std::mem::take(&mut self.uploads.copies),
        }
    }
}
