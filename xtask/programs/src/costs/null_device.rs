//! The null device of Mesa's RADV, as a program's only device.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{Options, write};

/// The driver that wraps RADV's, as Vulkan's loader finds it.
pub struct NullDevice<'a> {
    options: &'a Options,
    manifest: PathBuf,
}

impl<'a> NullDevice<'a> {
    /// Writes the driver's manifest.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn new(options: &'a Options) -> Result<Self, String> {
        let manifest = options.folder.join("null_device.json");
        let library = options.null_device.to_string_lossy();
        let icd = serde_json::json!({ "library_path": library, "api_version": "1.3.0" });
        write(&manifest, &serde_json::json!({ "file_format_version": "1.0.0", "ICD": icd }).to_string())?;
        Ok(Self { options, manifest })
    }

    /// A program on the device of a family.
    pub fn command(&self, program: &Path, family: &str) -> Command {
        let mut command = Command::new(program);
        // Vulkan's loader has gone by both names.
        command.env("VK_DRIVER_FILES", &self.manifest).env("VK_ICD_FILENAMES", &self.manifest);
        command.env("ANTUMBRA_NULL_DEVICE_DRIVER", &self.options.driver).env("RADV_FORCE_FAMILY", family);
        command
    }
}
