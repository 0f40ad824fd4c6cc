//! Compression of buffer views, as a view describes it.
//!
//! Source: EXT_meshopt_compression (Kapoulkine 2021) and its successor KHR_meshopt_compression.

use gltf::json::buffer::View;
use serde_json::Value;

use super::fault::{Fault, Result};

/// Compression of a buffer view, as the view describes it.
pub(super) struct Compression<'v> {
    /// Buffer of the compressed bytes, and their range in it.
    pub buffer: usize,
    pub offset: u64,
    pub length: u64,
    /// Bytes per element, and number of elements.
    pub stride: usize,
    pub count: usize,
    pub mode: &'v str,
    pub filter: &'v str,
}

impl<'v> Compression<'v> {
    /// Returns the compression of a view; `None` if it is not compressed.
    pub(super) fn of(view: &'v View, place: &str) -> Result<Option<Self>> {
        let extensions = view.extensions.as_ref().map(|e| &e.others);
        let Some((name, value)) = extensions.and_then(|others| {
            ["EXT_meshopt_compression", "KHR_meshopt_compression"]
                .into_iter()
                .find_map(|name| others.get(name).map(|value| (name, value)))
        }) else {
            return Ok(None);
        };
        let whole = |key: &str| {
            value
                .get(key)
                .and_then(|v| v.as_u64().or_else(|| v.as_f64().filter(|f| f.fract() == 0.0).map(|f| f as u64)))
        };
        let text = |key: &str| value.get(key).and_then(Value::as_str);
        let missing = |key: &str| {
            Fault::new(format!("{place}.extensions.{name}"), format!("`{key}` is missing"), "the extension requires it")
        };
        Ok(Some(Self {
            buffer: whole("buffer").ok_or_else(|| missing("buffer"))? as usize,
            offset: whole("byteOffset").unwrap_or(0),
            length: whole("byteLength").ok_or_else(|| missing("byteLength"))?,
            stride: whole("byteStride").ok_or_else(|| missing("byteStride"))? as usize,
            count: whole("count").ok_or_else(|| missing("count"))? as usize,
            mode: text("mode").ok_or_else(|| missing("mode"))?,
            filter: text("filter").unwrap_or("NONE"),
        }))
    }
}
