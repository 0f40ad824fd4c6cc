//! Lists per texel of a technique, for inspection.

use glam::UVec2;

/// Lists of a light's map, one a texel, as the frame that was prepared last makes them; the next one of the same light writes
/// over them.
///
/// Masks want none of it: it is for tools that show how long lists are and where.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnLists {
    /// 32-bit words, with usage `STORAGE`; how long a list is they say by `lengths`.
    pub words: wgpu::Buffer,
    /// Encoding of the lengths.
    pub lengths: ListLengths,
    /// Plural noun of the list's elements: `fragments`, `receivers`.
    pub listed: &'static str,
    /// Order of the texels in the lists.
    pub order: ListOrder,
    /// Levels, the finest first; at least one.
    pub levels: Vec<ListLevel>,
}

/// Encoding of the length of list *i*, counted from the buffer's first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListLengths {
    /// Word 2 i + 1; the word before says where the list begins.
    Counted,
    /// Word i + 1 less word i, which say where lists begin.
    Between,
}

/// Mapping from texels to lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListOrder {
    /// Row after row.
    Rows,
    /// Of cells of space, that halve what is seen from the light again and again, and not of directions alone. As a picture they
    /// lie along a curve whose neighbours are neighbours in space, or nearly: the list's number has the bits of the texel's
    /// column and row in turn, the row's first.
    Halvings,
    /// One or the other, as the device has chosen.
    Told {
        /// The buffer's word that tells: 0 for rows, 1 for halvings.
        word: u32,
    },
}

/// One level of lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListLevel {
    /// Index of the level's first list.
    pub first: u32,
    /// Size, texels.
    pub size_texels: UVec2,
}
