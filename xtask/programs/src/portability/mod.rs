//! Pipeline part of `cargo xtask portability`: translates each program as wgpu does on other systems, and validates it with their
//! compilers. DXC compiles HLSL, spirv-val validates SPIR-V; MSL is only translated, because Apple's compiler runs nowhere else.
//! Linked shaders without a pipeline are included.

mod compilers;
mod dxc;
mod translation;

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use crate::recorder::{self, Pipeline, Program};
use crate::{describe, device};
use compilers::Compilers;
use translation::{Translation, Validated};

pub use compilers::DXIL;
pub use dxc::compile as compile_hlsl;

/// Programs and compilers of a check.
pub struct Options {
    /// Output folder of translations, emptied first.
    pub folder: PathBuf,
    /// Library of DXC; `None` skips compiling HLSL.
    pub dxc: Option<OsString>,
    /// Command spirv-val; `None` skips validating SPIR-V.
    pub spirv_val: Option<OsString>,
    /// Substring of the label, module or entry point of the programs to check.
    pub only: Option<String>,
}

/// Step that a program can fail at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Constants,
    Hlsl,
    Msl,
    Spirv,
    Dxc,
    SpirvVal,
}

impl Step {
    const ALL: [Self; 6] = [Self::Constants, Self::Hlsl, Self::Msl, Self::Spirv, Self::Dxc, Self::SpirvVal];

    fn name(self) -> &'static str {
        match self {
            Self::Constants => "naga, override constants",
            Self::Hlsl => "naga, HLSL for shader model 6.0",
            Self::Msl => "naga, MSL 2.4",
            Self::Spirv => "naga, SPIR-V 1.3",
            Self::Dxc => "DXC, DXIL",
            Self::SpirvVal => "spirv-val, Vulkan 1.1",
        }
    }

    /// Whether the step runs with these options.
    fn is_taken(self, options: &Options) -> bool {
        match self {
            Self::Dxc => options.dxc.is_some(),
            Self::SpirvVal => options.spirv_val.is_some(),
            Self::Constants | Self::Hlsl | Self::Msl | Self::Spirv => true,
        }
    }
}

/// Step that a program failed at, and its first error.
type Failure = (Step, String);

/// Translates and validates every program. Prints each failure and the count of each step.
///
/// # Errors
/// If a program fails, or nothing could be checked.
pub fn check(options: &Options) -> Result<(), String> {
    let programs = programs(options.only.as_deref())?;
    if programs.is_empty() {
        return Err("there is no such program".to_owned());
    }
    empty(&options.folder)?;
    // Each text is parsed once, by the first job that needs it.
    let modules: HashMap<Arc<str>, OnceLock<Result<Validated, String>>> =
        programs.iter().map(|(_, program)| (program.wgsl.clone(), OnceLock::new())).collect();
    let compilers = Compilers::new(options)?;
    let failures_of = |(place, (_, program)): (usize, &(String, Program))| {
        let module = modules[&program.wgsl].get_or_init(|| translation::validated(&program.wgsl));
        let module = module.as_ref().map_err(Clone::clone);
        let translation = module.and_then(|module| translation::translate(module, program));
        judge(&compilers, &options.folder.join(format!("{place:04}")), program, translation)
    };
    let failures: Vec<Vec<Failure>> = programs.par_iter().enumerate().map(failures_of).collect();
    for (place, ((label, program), failures)) in programs.iter().zip(&failures).enumerate() {
        for (step, error) in failures {
            println!("{label} | {program:?}: {}: {error} ({place:04})", step.name());
        }
    }
    let mut count = 0;
    for step in Step::ALL {
        let failed = failures.iter().flatten().filter(|(of, _)| *of == step).count();
        if step.is_taken(options) {
            println!("{:32} {} programs, {failed} failures", step.name(), programs.len());
        } else {
            println!("{:32} SKIPPED", step.name());
        }
        count += failed;
    }
    match count {
        0 => Ok(()),
        _ => Err(format!("{count} failures; translations are in {}, numbered as above", options.folder.display())),
    }
}

/// Returns the distinct programs of all pipelines, with the label of one of their pipelines.
fn programs(only: Option<&str>) -> Result<Vec<(String, Program)>, String> {
    let pipelines = recorder::pipelines_made(device::make_all_variants)?;
    let mut programs = distinct(pipelines);
    let linked = describe::linked_folder();
    for file in describe::linked_files(&linked)? {
        let wgsl = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let name = file.strip_prefix(&linked).unwrap_or(&file).display().to_string();
        programs.extend(without_pipeline(&programs, &name, &wgsl).into_iter().map(|program| (name.clone(), program)));
    }
    if let Some(only) = only {
        programs
            .retain(|(label, program)| [label, &program.module, &program.entry].iter().any(|text| text.contains(only)));
    }
    Ok(programs)
}

/// Returns programs of a linked shader without pipeline and required constants. Hosts include functions of some in their own shaders.
fn without_pipeline(programs: &[(String, Program)], name: &str, wgsl: &str) -> Vec<Program> {
    let module = naga::front::wgsl::parse_str(wgsl).unwrap_or_default();
    if module.overrides.iter().any(|(_, constant)| constant.init.is_none()) {
        return Vec::new();
    }
    let has_pipeline = |entry: &naga::EntryPoint| {
        programs
            .iter()
            .any(|(_, program)| program.stage == entry.stage && program.entry == entry.name && *program.wgsl == *wgsl)
    };
    let program = |entry: naga::EntryPoint| Program {
        stage: entry.stage,
        module: name.to_owned(),
        wgsl: wgsl.into(),
        entry: entry.name,
        constants: Vec::new(),
    };
    module.entry_points.into_iter().filter(|entry| !has_pipeline(entry)).map(program).collect()
}

/// Returns the distinct programs in order of their first pipelines.
fn distinct(pipelines: Vec<Pipeline>) -> Vec<(String, Program)> {
    let mut known = std::collections::HashSet::new();
    let all = pipelines
        .into_iter()
        .flat_map(|Pipeline { label, programs, .. }| programs.into_iter().map(move |program| (label.clone(), program)));
    all.filter(|(_, program)| known.insert((program.wgsl.clone(), format!("{program:?}")))).collect()
}

/// Returns a program's failures. Its translations are written next to `stem`.
fn judge(
    compilers: &Compilers,
    stem: &Path,
    program: &Program,
    translation: Result<Translation, String>,
) -> Vec<Failure> {
    let Translation { hlsl, msl, spirv } = match translation {
        Ok(translation) => translation,
        Err(error) => return vec![(Step::Constants, one_line(&error))],
    };
    let mut failures = Vec::new();
    let mut written = |step, text: Result<translation::Text, String>, extension: &str| {
        let file = stem.with_extension(extension);
        let outcome = text.and_then(|text| {
            fs::write(&file, &text.bytes).map_err(|error| format!("{}: {error}", file.display()))?;
            Ok((file, text.entry))
        });
        outcome.map_err(|error| failures.push((step, one_line(&error)))).ok()
    };
    let hlsl = written(Step::Hlsl, hlsl, "hlsl");
    written(Step::Msl, msl, "metal");
    let spirv = written(Step::Spirv, spirv, "spv");
    let judged = [
        hlsl.and_then(|(file, entry)| Some((Step::Dxc, compilers.dxc(&file, &entry, program.stage)?))),
        spirv.and_then(|(file, _)| Some((Step::SpirvVal, compilers.spirv_val(&file)?))),
    ];
    failures.extend(judged.into_iter().flatten());
    failures
}

/// Returns the first line of an error, shortened for output.
fn one_line(error: &str) -> String {
    error.lines().next().unwrap_or_default().chars().take(300).collect()
}

fn empty(folder: &Path) -> Result<(), String> {
    let outcome = if folder.exists() { fs::remove_dir_all(folder) } else { Ok(()) };
    outcome.and_then(|()| fs::create_dir_all(folder)).map_err(|error| format!("{}: {error}", folder.display()))
}

#[cfg(test)]
mod tests {
    use naga::ShaderStage;

    use super::*;

    fn pipeline(label: &str, wgsl: &str, constant: f64) -> Pipeline {
        let program = Program {
            stage: ShaderStage::Compute,
            module: "module".into(),
            wgsl: wgsl.into(),
            entry: "run".into(),
            constants: vec![("0".into(), constant)],
        };
        Pipeline { label: label.into(), programs: vec![program], state: String::new() }
    }

    #[test]
    fn linked_programs_without_pipeline_are_judged_too() {
        let wgsl = "@compute @workgroup_size(1) fn run() {}\n@compute @workgroup_size(1) fn keep() {}";
        let known = distinct(vec![pipeline("a", wgsl, 1.0)]);
        let found = without_pipeline(&known, "folder/file.wgsl", wgsl);
        assert_eq!(found.iter().map(|program| program.entry.as_str()).collect::<Vec<_>>(), ["keep"]);
        let with_constant = "override count: u32;\n@compute @workgroup_size(1) fn run() { let all = count; }";
        assert!(without_pipeline(&known, "folder/file.wgsl", with_constant).is_empty());
    }

    #[test]
    fn identical_programs_are_judged_once() {
        let pipelines = vec![
            pipeline("a", "text", 1.0),
            pipeline("b", "text", 1.0),
            pipeline("c", "text", 2.0),
            pipeline("d", "other", 1.0),
        ];
        let labels: Vec<String> = distinct(pipelines).into_iter().map(|(label, _)| label).collect();
        assert_eq!(labels, ["a", "c", "d"]);
    }

    #[test]
    fn a_program_that_naga_refuses_fails_at_its_constants() {
        let options = Options { folder: PathBuf::new(), dxc: None, spirv_val: None, only: None };
        let program = pipeline("a", "text", 1.0).programs.remove(0);
        let failures =
            judge(&Compilers::new(&options).unwrap(), Path::new("none"), &program, Err("no such id\nhere".into()));
        assert_eq!(failures, [(Step::Constants, "no such id".to_owned())]);
    }
}
