//! Device errors of a piece of work: available at once natively, some frames later in a browser.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use antumbra::Gpu;

use crate::message::one_line;

/// Device errors that arrive later.
#[derive(Clone, Debug, Default)]
pub struct Refusals {
    late: Arc<Mutex<Late>>,
}

#[derive(Debug, Default)]
struct Late {
    /// Number of pieces of work whose errors are not known yet.
    pending: u32,
    /// The last error.
    why: Option<String>,
}

impl Refusals {
    /// Returns the last error that arrived after its work was recorded, since the last call.
    pub fn take(&self) -> Option<String> {
        self.late().why.take()
    }

    /// Whether errors of some work are not known yet.
    pub fn is_pending(&self) -> bool {
        let late = self.late();
        late.pending > 0 || late.why.is_some()
    }

    fn late(&self) -> MutexGuard<'_, Late> {
        self.late.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs work on the device. A device error becomes the work's error, in one line; in a browser [`take`](Self::take) returns it later.
    ///
    /// # Errors
    /// Fails if the work fails, or if the device reports an error at once.
    pub fn watch<T>(&self, gpu: &Gpu, work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
        let out_of_memory = gpu.device().push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let invalid = gpu.device().push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        let (invalid, out_of_memory) = (invalid.pop(), out_of_memory.pop());
        let refusal = async { refusal(out_of_memory.await, invalid.await) };
        #[cfg(not(target_arch = "wasm32"))]
        return pollster::block_on(refusal).map_or(result, Err);
        #[cfg(target_arch = "wasm32")]
        {
            self.late().pending += 1;
            let refusals = self.clone();
            wasm_bindgen_futures::spawn_local(async move {
                let why = refusal.await;
                let mut late = refusals.late();
                late.pending -= 1;
                late.why = why.or(late.why.take());
            });
            result
        }
    }
}

fn refusal(out_of_memory: Option<wgpu::Error>, invalid: Option<wgpu::Error>) -> Option<String> {
    match (out_of_memory, invalid) {
        (Some(_), _) => Some("the device is out of memory; reduce sizes, layers or numbers of samples".into()),
        (None, Some(error)) => Some(format!("the device reports an error: {}", one_line(&error.to_string()))),
        (None, None) => None,
    }
}
