//! Lists per texel of a technique, for inspection.

use glam::UVec2;

/// Lists of a light's map, one per texel, of the frame prepared last. The light's next frame overwrites them.
///
/// They are for tools that show the lengths of lists; rendering does not need them.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnLists {
    /// Buffer of 32-bit words, with usage `STORAGE`; `lengths` is the encoding of the lists' lengths.
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

/// Encoding of the length of list *i*, counted from the buffer's first list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListLengths {
    /// Word 2 i + 1 is the length; the word before it is the list's offset.
    Counted,
    /// Word i + 1 minus word i: the words are the lists' offsets.
    Between,
}

/// Mapping from texels to lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListOrder {
    /// Row-major order.
    Rows,
    /// Cells of space, by repeated halving of what the light sees, instead of directions alone. As an image they follow a Morton
    /// curve, whose neighbours are mostly neighbours in space: the list's index interleaves the bits of the texel's column and row,
    /// the row's first.
    Halvings,
    /// Rows or halvings, as chosen on the GPU.
    Chosen {
        /// Index of the word in the buffer that has the choice: 0 for rows, 1 for halvings.
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
