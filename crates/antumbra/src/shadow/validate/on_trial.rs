//! Cache of resources that were bound on trial, because wgpu does not expose their properties.

/// Resources that could be bound on trial, with the last frame that used each.
#[derive(Debug)]
pub(super) struct BindableCache<R> {
    found: Vec<(R, u64)>,
    frame: u64,
}

impl<R> Default for BindableCache<R> {
    fn default() -> Self {
        Self { found: Vec::new(), frame: 0 }
    }
}

impl<R: PartialEq> BindableCache<R> {
    /// Number of frames after which an unused resource is dropped, so that it can be freed.
    const RETAINED_FRAMES: u64 = 8;

    /// Begins a frame.
    pub(super) fn begin_frame(&mut self) {
        self.frame += 1;
        self.found.retain(|(_, frame)| frame + Self::RETAINED_FRAMES >= self.frame);
    }

    /// Validation error that wgpu reports for a resource, or `None`. Only new resources are tried.
    pub(super) fn validation_error(&mut self, resource: R, trial: impl FnOnce(&R) -> Option<String>) -> Option<String> {
        if let Some((_, frame)) = self.found.iter_mut().find(|(good, _)| *good == resource) {
            *frame = self.frame;
            return None;
        }
        let validation_error = trial(&resource);
        if validation_error.is_none() {
            self.found.push((resource, self.frame));
        }
        validation_error
    }
}
