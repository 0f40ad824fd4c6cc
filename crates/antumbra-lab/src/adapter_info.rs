//! Adapter of a measurement, as reports and advices name it.

use serde::{Deserialize, Serialize};

use crate::device::AdapterReport;

/// The adapter whose times these are.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct AdapterInfo {
    /// As the driver names it.
    pub name: String,
    /// Driver and version.
    pub driver: String,
    /// Vulkan, Metal, …
    pub backend: String,
    /// The adapter is a program on the CPU: its times rank techniques only roughly and say nothing about a GPU.
    pub is_software: bool,
}

impl AdapterInfo {
    /// What a report says of an adapter.
    pub fn of(adapter: &AdapterReport) -> Self {
        Self {
            name: adapter.name.clone(),
            driver: adapter.driver_and_version(),
            backend: adapter.backend.to_string(),
            is_software: adapter.is_software(),
        }
    }
}
