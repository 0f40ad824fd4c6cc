//! Content of GPU resources, cached by the key of all that it depends on.

/// Content of resources: a map, lists, a mask, a mean of frames.
#[derive(Debug)]
pub(crate) struct Content<K> {
    /// Of the frame that wrote it; `None` where no key tells what it is of.
    key: Option<K>,
    /// Frames in a row that asked for this key, the first of them not counted.
    repeats: u32,
}

impl<K> Default for Content<K> {
    fn default() -> Self {
        Self { key: None, repeats: 0 }
    }
}

impl<K: PartialEq> Content<K> {
    /// Whether an earlier frame has written what a key asks for.
    pub(crate) fn is_of(&self, key: Option<&K>) -> bool {
        key.is_some() && key == self.key.as_ref()
    }

    /// Asks for the content of a key, `None` where no key tells what a frame writes. Whether an earlier frame has written it;
    /// otherwise this frame has to.
    pub(crate) fn ask(&mut self, key: Option<K>) -> bool {
        let is_written = self.is_of(key.as_ref());
        self.repeats = if is_written { self.repeats.saturating_add(1) } else { 0 };
        self.key = key;
        is_written
    }

    /// Frames in a row that asked for the same, the first of them not counted.
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
