//! What the device refuses of some work: known at once natively, some frames later in a browser.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use antumbra::Gpu;

use crate::message::one_line;

/// Refusals that come late.
#[derive(Clone, Debug, Default)]
pub struct Refusals {
    late: Arc<Mutex<Late>>,
}

#[derive(Debug, Default)]
struct Late {
    /// Pieces of work of which it is not known yet.
    pending: u32,
    /// The last refusal.
    why: Option<String>,
}

impl Refusals {
    /// The last refusal that came after its work was done, since the last call.
    pub fn take(&self) -> Option<String> {
        self.late().why.take()
    }

    /// Whether it is not known of some work whether the device refuses it.
    pub fn is_pending(&self) -> bool {
        let late = self.late();
        late.pending > 0 || late.why.is_some()
    }

    fn late(&self) -> MutexGuard<'_, Late> {
        self.late.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does work on the device; what the device refuses of it is the work's error, in one line, or in a browser what
    /// [`take`](Self::take) has later.
    ///
    /// # Errors
    /// The work's own, and where the device tells at once what the device refuses.
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
        (Some(_), _) => Some("the device has no memory for this; lower sizes, layers or numbers of samples".into()),
        (None, Some(error)) => Some(format!("the device refuses: {}", one_line(&error.to_string()))),
        (None, None) => None,
    }
}
