//! Values cached with the key that each was made for: pipelines, maps, points.

/// A value, and its key.
#[derive(Clone, Debug)]
pub(crate) struct Cached<K, V>(Option<(K, V)>);

impl<K, V> Default for Cached<K, V> {
    fn default() -> Self {
        Self(None)
    }
}

impl<K: PartialEq, V> Cached<K, V> {
    /// The value of a key: the one that is there, or a new one in its place.
    pub(crate) fn get_or_make(&mut self, key: K, make: impl FnOnce() -> V) -> &mut V {
        // What is there goes before another is made: they may be large.
        let there = self.0.take().filter(|(made_for, _)| *made_for == key);
        let (_, value) = self.0.insert(there.unwrap_or_else(|| (key, make())));
        value
    }

    /// The value that is there.
    pub(crate) fn get(&self) -> Option<&V> {
        self.0.as_ref().map(|(_, value)| value)
    }

    /// The key and the value that are there.
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
