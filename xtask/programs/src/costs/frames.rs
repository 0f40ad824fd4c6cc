//! Commands of one frame of each technique: `antumbra bench` runs on the null device, whose driver prints them.
//!
//! Nothing is drawn: values that techniques read back are zero, and commands that depend on them are missing.

use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;

use super::null_device::NullDevice;

/// Scene of the frames.
pub const SCENE: &str = "builtin:street";
/// Image size.
pub const SIZE: &str = "1920x1080";

/// Commands of one frame of a technique.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    pub technique: String,
    /// Number of direct dispatches, including those with which wgpu validates indirect ones.
    pub dispatches: usize,
    pub indirect_dispatches: usize,
    /// Number of barriers on memory, buffers or images.
    pub barriers: usize,
    pub render_passes: usize,
    pub draws: usize,
    pub copies: usize,
    /// Memory of the technique's textures and buffers, bytes.
    pub memory_bytes: u64,
}

/// Counts the commands of a frame of each technique on a family's null device; files go to `folder`.
///
/// # Errors
/// The first technique that fails.
pub fn count(
    device: &NullDevice<'_>,
    antumbra: &Path,
    family: &str,
    folder: &Path,
    techniques: &[&str],
) -> Result<Vec<Frame>, String> {
    let count = |technique: &&str| {
        let frame = count_one(device, antumbra, family, &folder.join(format!("{technique}.json")), technique);
        frame.map_err(|problem| format!("a frame of {technique}: {problem}"))
    };
    techniques.par_iter().map(count).collect()
}

fn count_one(
    device: &NullDevice<'_>,
    antumbra: &Path,
    family: &str,
    file: &Path,
    technique: &str,
) -> Result<Frame, String> {
    let mut bench = device.command(antumbra, family);
    bench.env("ANTUMBRA_NULL_DEVICE_COMMANDS", "1");
    bench.args(["bench", SCENE, "--techniques", technique, "--sizes", SIZE]);
    bench.args(["--frames", "1", "--warm-up", "1", "--json"]).arg(file);
    let output = bench.output().map_err(|error| error.to_string())?;
    let log = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let last = log.lines().rfind(|line| !line.starts_with('@')).unwrap_or_default();
        return Err(format!("{}: {last}", output.status));
    }
    let results = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let commands = last_timed(&log).ok_or("no frame was timed")?;
    let memory_bytes = memory_in(&results).ok_or("it was not measured")?;
    Ok(Frame { technique: technique.to_owned(), memory_bytes, ..counted(&commands) })
}

/// Returns the commands of the last frame with timestamps.
fn last_timed(log: &str) -> Option<Vec<&str>> {
    let commands = log.lines().filter_map(|line| line.strip_prefix("@command ")).collect::<Vec<_>>();
    let mut frames = commands.rsplit(|command| *command == "submit");
    frames.find(|frame| frame.contains(&"timestamp")).map(<[_]>::to_vec)
}

fn counted(commands: &[&str]) -> Frame {
    let count = |word| commands.iter().filter(|command| **command == word).count();
    Frame {
        dispatches: count("dispatch"),
        indirect_dispatches: count("dispatch_indirect"),
        barriers: count("barrier"),
        render_passes: count("render_pass"),
        draws: count("draw"),
        copies: count("copy") + count("fill"),
        ..Frame::default()
    }
}

/// Returns the memory in the JSON of a benchmark of one technique, bytes.
fn memory_in(results: &str) -> Option<u64> {
    let results: Value = serde_json::from_str(results).ok()?;
    results["rows"][0]["ran"]["memory_bytes"].as_u64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_timed_frame_is_counted() {
        let log = "@command dispatch\n@command submit\n@command timestamp\n@command copy\n@command submit\nAdapter\n\
                   @command timestamp\n@command barrier\n@command dispatch\n@command dispatch_indirect\n@command dispatch\n\
                   @command render_pass\n@command draw\n@command fill\n@command submit\n@command copy\n@command submit\n";
        let expected = Frame {
            dispatches: 2,
            indirect_dispatches: 1,
            barriers: 1,
            render_passes: 1,
            draws: 1,
            copies: 1,
            ..Frame::default()
        };
        assert_eq!(last_timed(log).map(|commands| counted(&commands)), Some(expected));
        assert_eq!(last_timed("@command dispatch\n@command submit\n"), None);
    }

    #[test]
    fn memory_is_read_off_the_results() {
        assert_eq!(memory_in("{\"rows\":[{\"ran\":{\"memory_bytes\":4194304}}]}"), Some(4_194_304));
        assert_eq!(memory_in("{\"rows\":[{\"skipped\":\"no rays\"}]}"), None);
    }
}
