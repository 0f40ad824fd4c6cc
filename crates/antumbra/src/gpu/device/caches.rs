//! Caches of a device: objects by their descriptors, and resources that are freed with their last holder.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Cache of objects by their descriptors.
#[derive(Debug)]
pub(super) struct DescriptorCache<K, V>(pub(super) Mutex<HashMap<K, V>>);

impl<K, V> Default for DescriptorCache<K, V> {
    fn default() -> Self {
        Self(Mutex::new(HashMap::new()))
    }
}

impl<K: Eq + Hash, V: Clone> DescriptorCache<K, V> {
    /// Returns the cached object, or a new one. If two threads miss at once, both create one, and the first is cached.
    pub(super) fn get_or_make(&self, key: K, made: &AtomicU64, make: impl FnOnce() -> V) -> V {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = lock().get(&key) {
            return found.clone();
        }
        // Create outside the lock, because compiling a pipeline takes long.
        made.fetch_add(1, Ordering::Relaxed);
        let value = make();
        lock().entry(key).or_insert(value).clone()
    }
}

/// Resources that all holders of a key share, each freed with its last holder.
#[derive(Debug)]
pub(super) struct SharedPool<K, V>(Mutex<Vec<(K, Weak<V>)>>);

impl<K, V> Default for SharedPool<K, V> {
    fn default() -> Self {
        Self(Mutex::new(Vec::new()))
    }
}

impl<K: PartialEq, V> SharedPool<K, V> {
    /// Returns the resource that somebody holds, or a new one.
    pub(super) fn get_or_make(&self, key: K, make: impl FnOnce() -> V) -> Arc<V> {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.retain(|(_, value)| value.strong_count() > 0);
        if let Some(found) = held.iter().find(|(of, _)| *of == key).and_then(|(_, value)| value.upgrade()) {
            return found;
        }
        let made = Arc::new(make());
        held.push((key, Arc::downgrade(&made)));
        made
    }

    /// Memory of all held resources, bytes.
    pub(super) fn bytes(&self, of: impl Fn(&V) -> u64) -> u64 {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.iter().filter_map(|(_, value)| value.upgrade()).map(|value| of(&value)).sum()
    }
}
