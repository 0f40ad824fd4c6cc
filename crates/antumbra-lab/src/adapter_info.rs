//! Adapter of a measurement, as named in reports and recommendations.

use serde::{Deserialize, Serialize};

use crate::device::AdapterReport;

/// Adapter on which times were measured.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct AdapterInfo {
    /// Name reported by the driver.
    pub name: String,
    /// Driver and version.
    pub driver: String,
    /// Graphics API: Vulkan, Metal, …
    pub backend: String,
    /// Whether the adapter is a software renderer. Its times rank techniques only roughly and do not represent a GPU.
    pub is_software: bool,
}

impl AdapterInfo {
    /// Returns the fields of a device's adapter that reports show.
    pub fn of(adapter: &AdapterReport) -> Self {
        Self {
            name: adapter.name.clone(),
            driver: adapter.driver_and_version(),
            backend: adapter.backend.to_string(),
            is_software: adapter.is_software(),
        }
    }
}
