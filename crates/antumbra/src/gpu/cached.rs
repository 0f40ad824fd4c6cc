//! Values cached with the key that each was created for: pipelines, maps, points.

/// Cache of one value and its key.
#[derive(Clone, Debug)]
pub(crate) struct Cached<K, V>(Option<(K, V)>);

impl<K, V> Default for Cached<K, V> {
    fn default() -> Self {
        Self(None)
    }
}

impl<K: PartialEq, V> Cached<K, V> {
    /// Returns the value of a key: the cached one, or a new one that replaces it.
    pub(crate) fn get_or_make(&mut self, key: K, make: impl FnOnce() -> V) -> &mut V {
        // Free the old value before creating the new one, as they may be large.
        let there = self.0.take().filter(|(made_for, _)| *made_for == key);
        let (_, value) = self.0.insert(there.unwrap_or_else(|| (key, make())));
        value
    }

    /// Cached value, or `None`.
    pub(crate) fn get(&self) -> Option<&V> {
        self.0.as_ref().map(|(_, value)| value)
    }

    /// Cached key and value, or `None`.
    pub(crate) fn pair(&self) -> Option<&(K, V)> {
        self.0.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::Cached;

    #[test]
    fn a_value_is_made_once_for_a_key() {
        let (mut cached, mut made) = (Cached::default(), 0);
        for (key, values) in [("a", 1), ("a", 1), ("b", 2), ("a", 3)] {
            let value = *cached.get_or_make(key, || {
                made += 1;
                made
            });
            assert_eq!((value, made, cached.pair()), (values, values, Some(&(key, values))));
        }
    }
}
