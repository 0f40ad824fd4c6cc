//! Decoding of compressed buffer views, within the file's budget.

use gltf::json::buffer::View;

use super::fault::{Fault, Result};
use super::limits::Budget;
use super::meshopt_codec as codec;
use super::meshopt_view::Compression;

/// Decodes compressed bytes to `byteStride · count` bytes, which are drawn from the budget before they are allocated.
pub(super) fn decode(
    compression: &Compression<'_>,
    encoded: &[u8],
    budget: &Budget,
    view: &View,
    place: &str,
) -> Result<Vec<u8>> {
    let Compression { stride, count, .. } = *compression;
    let bad = |problem: String, remedy: &str| Fault::new(place, problem, remedy);
    let size = stride.checked_mul(count).filter(|size| *size as u64 == view.byte_length.0);
    let Some(size) = size else {
        return Err(bad(
            format!("{count} elements of {stride} bytes are not {} bytes", view.byte_length.0),
            "`count` times `byteStride` must be the view's `byteLength`",
        ));
    };
    budget.take_decoded_bytes(size, place)?;
    codec::decode(compression, encoded, place)
}
