//! What was drawn of casters, and still stands.

use crate::contract::CastersKey;

/// Tells whether what was drawn last was drawn of what is asked for now.
#[derive(Debug, Default)]
pub(crate) struct Standing {
    of: Option<(CastersKey, Vec<u8>)>,
    stands: bool,
}

impl Standing {
    /// What is drawn next: of these casters, which are `None` where nothing tells them from others, and of all else that
    /// it hangs on.
    pub(crate) fn draw_next(&mut self, casters: Option<CastersKey>, of: &[&[u8]]) {
        let stands = |(drawn_casters, drawn): &(CastersKey, Vec<u8>)| {
            Some(*drawn_casters) == casters && drawn.iter().eq(of.iter().copied().flatten())
        };
        self.stands = self.of.as_ref().is_some_and(stands);
        if !self.stands {
            self.of = casters.map(|casters| (casters, of.concat()));
        }
    }

    /// Whether it is there already.
    pub(crate) fn stands(&self) -> bool {
        self.stands
    }
}
