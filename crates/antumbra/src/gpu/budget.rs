//! Memory budget of maps and lists that belong to one light each.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Default budget of all lights together, bytes.
const DEFAULT_BUDGET_BYTES: u64 = 256 << 20;

/// Memory budget of maps and lists that lights own.
#[derive(Debug)]
pub(super) struct Budget {
    bytes: AtomicU64,
    owned_bytes: AtomicU64,
    /// Bytes within this budget that lights own on the device that this one plans for.
    owned_elsewhere: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { bytes: DEFAULT_BUDGET_BYTES.into(), owned_bytes: 0.into(), owned_elsewhere: 0 }
    }
}

impl Budget {
    pub(super) fn set(&self, bytes: u64) {
        self.bytes.store(bytes, Ordering::Relaxed);
    }

    pub(super) fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    pub(super) fn owned_bytes(&self) -> u64 {
        self.owned_bytes.load(Ordering::Relaxed)
    }

    /// Returns a budget of the same size in which the bytes now owned count as taken.
    pub(super) fn left(&self) -> Self {
        let owned_elsewhere = self.owned_elsewhere + self.owned_bytes();
        Self { bytes: self.bytes().into(), owned_bytes: 0.into(), owned_elsewhere }
    }

    /// Reserves bytes; `None` if fewer are left.
    pub(super) fn take(self: &Arc<Self>, bytes: u64) -> Option<OwnedBytes> {
        let most = self.bytes().saturating_sub(self.owned_elsewhere);
        let add = |owned: u64| owned.checked_add(bytes).filter(|all| *all <= most);
        self.owned_bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add).ok()?;
        Some(OwnedBytes { budget: Arc::clone(self), bytes })
    }
}

/// Reserved bytes, returned to the budget when dropped.
#[derive(Debug)]
pub(super) struct OwnedBytes {
    budget: Arc<Budget>,
    bytes: u64,
}

impl OwnedBytes {
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for OwnedBytes {
    fn drop(&mut self) {
        self.budget.owned_bytes.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_taken_and_given_back() {
        let budget = Arc::new(Budget::default());
        budget.set(100);
        let first = budget.take(60).expect("there is room");
        assert!(budget.take(41).is_none());
        let second = budget.take(40).expect("there is just room");
        assert_eq!(budget.owned_bytes(), 100);
        drop(first);
        assert_eq!(budget.owned_bytes(), 40);
        assert!(budget.take(u64::MAX).is_none());
        let left = Arc::new(budget.left());
        assert!(left.take(61).is_none(), "40 are taken");
        let planned = left.take(60).expect("there is just room");
        assert_eq!((left.owned_bytes(), budget.owned_bytes()), (60, 40));
        drop((second, planned));
        assert_eq!((left.owned_bytes(), budget.owned_bytes()), (0, 0));
    }
}
