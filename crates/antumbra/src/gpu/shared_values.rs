//! CPU values that lights share: results derived from the frame's casters and camera, computed once.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// Least-recently-used cache of values by key.
#[derive(Debug, Default)]
pub(crate) struct SharedValues(Mutex<Vec<Arc<dyn Any + Send + Sync>>>);

/// Capacity: about the number of views and anchors of a frame.
const MAX_KEPT: usize = 16;

impl SharedValues {
    /// Returns a key and its value, computed if not cached.
    pub(crate) fn get_or_make<K, V>(&self, key: K, make: impl FnOnce(&K) -> V) -> Arc<(K, V)>
    where
        K: PartialEq + Send + Sync + 'static,
        V: Send + Sync + 'static,
    {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_of_key =
            |kept: &Arc<dyn Any + Send + Sync>| kept.downcast_ref::<(K, V)>().is_some_and(|(of, _)| *of == key);
        let mut kept = lock();
        if let Some(place) = kept.iter().rposition(is_of_key)
            && let Ok(found) = Arc::downcast::<(K, V)>(Arc::clone(&kept[place]))
        {
            // Move to the end: the list is ordered by last use.
            kept[place..].rotate_left(1);
            return found;
        }
        drop(kept);
        // Compute outside the lock, because other threads may prepare other lights.
        let value = make(&key);
        let made = Arc::new((key, value));
        let mut kept = lock();
        if kept.len() == MAX_KEPT {
            kept.remove(0);
        }
        kept.push(Arc::<(K, V)>::clone(&made));
        made
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_KEPT, SharedValues};

    #[test]
    fn a_value_is_made_once_while_it_is_used() {
        let values = SharedValues::default();
        let made = std::cell::Cell::new(0);
        let get = |key: usize| {
            let pair = values.get_or_make(key, |key| {
                made.set(made.get() + 1);
                10 * key
            });
            assert_eq!(*pair, (key, 10 * key));
        };
        for _ in 0..3 {
            (0..MAX_KEPT).for_each(get);
        }
        assert_eq!(made.get(), MAX_KEPT);
        // One more entry evicts the least recently used.
        get(0);
        get(MAX_KEPT);
        get(0);
        assert_eq!(made.get(), MAX_KEPT + 1);
        get(1);
        assert_eq!(made.get(), MAX_KEPT + 2);
        // The same key with another value type is a separate entry.
        assert_eq!(values.get_or_make(0usize, |_| "text").1, "text");
    }
}
