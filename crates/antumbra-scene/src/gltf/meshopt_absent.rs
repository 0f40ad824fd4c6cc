//! Compressed buffer views without a decoder: the feature `meshopt` is C++, and builds for browsers omit it.

use super::fault::{Fault, Result, quoted};
use super::meshopt_view::Compression;

/// Refuses every compressed view.
pub(super) fn decode(compression: &Compression<'_>, _encoded: &[u8], place: &str) -> Result<Vec<u8>> {
    let Compression { mode, filter, .. } = compression;
    Err(Fault::new(
        place,
        format!(
            "is compressed by meshopt ({}, filter {}), which this program cannot decode",
            quoted(mode),
            quoted(filter)
        ),
        "export the scene without EXT_meshopt_compression, or open it with the command `antumbra`",
    ))
}
