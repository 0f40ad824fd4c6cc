//! The null device of Mesa's RADV, as a program's only device.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{Options, write};

/// Driver that wraps RADV's, with its manifest for the Vulkan loader.
pub struct NullDevice<'a> {
    options: &'a Options,
    manifest: PathBuf,
}

impl<'a> NullDevice<'a> {
    /// Writes the driver's manifest.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn new(options: &'a Options) -> Result<Self, String> {
        let manifest = options.folder.join("null_device.json");
        let library = options.null_device.to_string_lossy();
        let icd = serde_json::json!({ "library_path": library, "api_version": "1.3.0" });
        write(&manifest, &serde_json::json!({ "file_format_version": "1.0.0", "ICD": icd }).to_string())?;
        Ok(Self { options, manifest })
    }

    /// Returns the command of a program on a family's device.
    pub fn command(&self, program: &Path, family: &str) -> Command {
        let mut command = Command::new(program);
        // The variable's name depends on the version of the Vulkan loader.
        command.env("VK_DRIVER_FILES", &self.manifest).env("VK_ICD_FILENAMES", &self.manifest);
        command.env("ANTUMBRA_NULL_DEVICE_DRIVER", &self.options.driver).env("RADV_FORCE_FAMILY", family);
        command
    }
}
