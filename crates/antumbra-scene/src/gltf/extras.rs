//! Application data that glTF objects carry along.

use gltf::json::Extras;
use serde_json::{Map, Value};

/// Returns an object's `extras` if it is a JSON object; else an empty map.
pub(super) fn of(extras: &Extras) -> Map<String, Value> {
    extras.as_ref().and_then(|raw| serde_json::from_str(raw.get()).ok()).unwrap_or_default()
}
