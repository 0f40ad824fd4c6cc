//! Compilers of other systems in separate processes, so that an abort or a hang is an error like any other.

use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::time::{Duration, Instant};

use naga::ShaderStage;

use super::Options;

/// First argument with which this program compiles one file with DXC.
pub const DXIL: &str = "dxil";

/// Time limit, far above the slowest program's time.
const PATIENCE: Duration = Duration::from_secs(120);

/// Available compilers.
pub struct Compilers {
    /// Path of this program, which calls DXC's library.
    own: PathBuf,
    dxc: Option<OsString>,
    spirv_val: Option<OsString>,
}

impl Compilers {
    /// # Errors
    /// If the path of this program is unknown.
    pub fn new(options: &Options) -> Result<Self, String> {
        let own = std::env::current_exe().map_err(|error| format!("cannot find the path of this program: {error}"))?;
        Ok(Self { own, dxc: options.dxc.clone(), spirv_val: options.spirv_val.clone() })
    }

    /// Returns DXC's first error for an HLSL file.
    pub fn dxc(&self, file: &Path, entry: &str, stage: ShaderStage) -> Option<String> {
        let profile = match stage {
            ShaderStage::Vertex => "vs_6_0",
            ShaderStage::Fragment => "ps_6_0",
            _ => "cs_6_0",
        };
        let mut command = Command::new(&self.own);
        command.arg(DXIL).arg(self.dxc.as_ref()?).arg(file).args([entry, profile]);
        run(&mut command, &file.with_extension("dxc.txt"))
    }

    /// Returns spirv-val's first error for a SPIR-V file.
    pub fn spirv_val(&self, file: &Path) -> Option<String> {
        let mut command = Command::new(self.spirv_val.as_ref()?);
        command.args(["--target-env", "vulkan1.1"]).arg(file);
        run(&mut command, &file.with_extension("val.txt"))
    }
}

/// Runs a compiler, whose messages go to `log`. Returns its first error if it fails, dies or hangs.
fn run(command: &mut Command, log: &Path) -> Option<String> {
    let status = match limited(command, log) {
        Ok(Some(status)) => status,
        Ok(None) => return Some(format!("not finished after {} s", PATIENCE.as_secs())),
        Err(error) => return Some(format!("cannot run: {error}")),
    };
    if status.success() {
        return None;
    }
    let messages = fs::read(log).unwrap_or_default();
    Some(if status.code().is_some() {
        first_error(&String::from_utf8_lossy(&messages)).unwrap_or_else(|| status.to_string())
    } else {
        format!("the compiler crashed: {status}")
    })
}

/// Returns the exit status of a command; `None` if it takes longer than [`PATIENCE`].
fn limited(command: &mut Command, log: &Path) -> std::io::Result<Option<ExitStatus>> {
    let messages = File::create(log)?;
    let mut running = command.stdout(messages.try_clone()?).stderr(messages).spawn()?;
    let began = Instant::now();
    while began.elapsed() < PATIENCE {
        if let Some(status) = running.try_wait()? {
            return Ok(Some(status));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    running.kill()?;
    running.wait().map(|_| None)
}

/// Returns the first line that names an error, else the first line, without the file name.
fn first_error(messages: &str) -> Option<String> {
    let line = messages.lines().find(|line| line.contains("error")).or_else(|| messages.lines().next())?;
    // The file name is always the same.
    let line = line.strip_prefix("hlsl.hlsl:").unwrap_or(line);
    Some(super::one_line(line))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_is_reported_with_its_line() {
        let messages =
            "hlsl.hlsl:7:1: warning: unused\nhlsl.hlsl:293:8: error: redefinition of 'ZeroValue'\nfloat4 a;\n";
        assert_eq!(first_error(messages).as_deref(), Some("293:8: error: redefinition of 'ZeroValue'"));
        assert_eq!(first_error("Block 12 is not structured\n").as_deref(), Some("Block 12 is not structured"));
        assert_eq!(first_error(""), None);
    }

    #[cfg(unix)]
    #[test]
    fn a_compiler_that_refuses_or_dies_is_a_failure() {
        let log = std::env::temp_dir().join(format!("antumbra-compilers-{}.txt", std::process::id()));
        let shell = |script: &str| run(Command::new("sh").args(["-c", script]), &log);
        let outcomes = ["true", "echo 1:2: error: no >&2; exit 1", "exit 3", "kill -ABRT $$"].map(shell);
        let _ = fs::remove_file(&log);
        assert_eq!(outcomes[0], None);
        assert_eq!(outcomes[1].as_deref(), Some("1:2: error: no"));
        assert!(outcomes[2].as_ref().is_some_and(|error| error.contains('3')), "{outcomes:?}");
        assert!(outcomes[3].as_ref().is_some_and(|error| error.contains("crashed")), "{outcomes:?}");
        assert!(run(&mut Command::new("no-such-compiler"), &log).is_some_and(|error| error.contains("cannot run")));
        let _ = fs::remove_file(&log);
    }
}
