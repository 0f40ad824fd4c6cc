//! Values of the processor that lights share: what one has worked out of the frame's casters and camera, others take.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// Values by the keys that they were made for. The few used last are kept.
#[derive(Debug, Default)]
pub(crate) struct SharedValues(Mutex<Vec<Arc<dyn Any + Send + Sync>>>);

/// As many as a frame's views and anchors together mostly are.
const MOST_KEPT: usize = 16;

impl SharedValues {
    /// The key and value of a key: those that are there, or new ones.
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
            // The last used comes last.
            kept[place..].rotate_left(1);
            return found;
        }
        drop(kept);
        // Not under the lock: other lights may be prepared on other threads.
        let value = make(&key);
        let made = Arc::new((key, value));
        let mut kept = lock();
        if kept.len() == MOST_KEPT {
            kept.remove(0);
        }
        kept.push(Arc::<(K, V)>::clone(&made));
        made
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST_KEPT, SharedValues};

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
            (0..MOST_KEPT).for_each(get);
        }
        assert_eq!(made.get(), MOST_KEPT);
        // One more takes the place of that which was not used for longest.
        get(0);
        get(MOST_KEPT);
        get(0);
        assert_eq!(made.get(), MOST_KEPT + 1);
        get(1);
        assert_eq!(made.get(), MOST_KEPT + 2);
        // Another type of the same key is another value.
        assert_eq!(values.get_or_make(0usize, |_| "text").1, "text");
    }
}
