//! Content of GPU resources, cached by the key of everything that it depends on.

/// Key of the content of resources: a map, lists, a mask, a mean of frames.
#[derive(Debug)]
pub(crate) struct Content<K> {
    /// Key from the frame that wrote the content; `None` if it cannot be reused.
    key: Option<K>,
    /// Number of consecutive repetitions of this key, not counting the first frame.
    repeats: u32,
}

impl<K> Default for Content<K> {
    fn default() -> Self {
        Self { key: None, repeats: 0 }
    }
}

impl<K: PartialEq> Content<K> {
    /// Whether an earlier frame has written the content of this key.
    pub(crate) fn is_of(&self, key: Option<&K>) -> bool {
        key.is_some() && key == self.key.as_ref()
    }

    /// Requests the content of a key; `None` means that it cannot be reused. Returns whether an earlier frame has written it;
    /// if not, this frame must.
    pub(crate) fn ask(&mut self, key: Option<K>) -> bool {
        let is_written = self.is_of(key.as_ref());
        self.repeats = if is_written { self.repeats.saturating_add(1) } else { 0 };
        self.key = key;
        is_written
    }

    /// Number of consecutive frames that requested the same key, not counting the first.
    pub(crate) fn repeats(&self) -> u32 {
        self.repeats
    }
}

#[cfg(test)]
mod tests {
    use super::Content;

    #[test]
    fn content_is_written_once_for_a_key_and_always_without_one() {
        let mut content = Content::default();
        let asked = [Some(1), Some(1), Some(1), Some(2), None, None, Some(2)];
        let written = asked.map(|key| (content.is_of(key.as_ref()), content.ask(key), content.repeats()));
        let once = [(false, 0), (true, 1), (true, 2), (false, 0), (false, 0), (false, 0), (false, 0)];
        assert_eq!(written, once.map(|(is, repeats)| (is, is, repeats)));
    }
}
