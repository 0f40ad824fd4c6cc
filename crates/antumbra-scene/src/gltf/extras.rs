//! Application data that glTF objects carry along.

use gltf::json::Extras;
use serde_json::{Map, Value};

/// An object's `extras` where it is a JSON object; else nothing.
pub(super) fn of(extras: &Extras) -> Map<String, Value> {
    extras.as_ref().and_then(|raw| serde_json::from_str(raw.get()).ok()).unwrap_or_default()
}
