//! Translation of programs to the languages of other systems, by naga with the options that wgpu uses.

use naga::back::{hlsl, msl, pipeline_constants, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

use crate::recorder::Program;

/// Module with the information of naga's validator.
pub type Validated = (naga::Module, ModuleInfo);

/// Program in a language, and the name of its entry point there.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    pub bytes: Vec<u8>,
    pub entry: String,
}

/// Program in every language, or the reason why naga cannot write it.
#[derive(Clone, Debug, PartialEq)]
pub struct Translation {
    /// HLSL for shader model 6.0.
    pub hlsl: Result<Text, String>,
    /// MSL 2.4.
    pub msl: Result<Text, String>,
    /// SPIR-V 1.3, that of Vulkan 1.1.
    pub spirv: Result<Text, String>,
}

/// Parses and validates a module.
///
/// # Errors
/// The error of naga.
pub fn validated(wgsl: &str) -> Result<Validated, String> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|error| error.to_string())?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
    let info = info.map_err(|error| with_causes(&error))?;
    Ok((module, info))
}

/// Translates a program of a module.
///
/// # Errors
/// If its constants do not fit the module.
pub fn translate((module, info): &Validated, program: &Program) -> Result<Translation, String> {
    let constants = program.constants.iter().cloned().collect();
    let entry = (program.stage, program.entry.as_str());
    // As in wgpu, constants are applied first: code that they disable is not translated.
    let (module, info) = pipeline_constants::process_overrides(module, info, Some(entry), &constants)
        .map_err(|error| with_causes(&error))?;
    let place = module.entry_points.iter().position(|known| known.stage == entry.0 && known.name == entry.1);
    let place = place.ok_or_else(|| format!("there is no entry point `{}`", entry.1))?;
    Ok(Translation {
        hlsl: in_hlsl(&module, &info, program, place),
        msl: in_msl(&module, &info, program, place),
        spirv: in_spirv(&module, &info, program),
    })
}

/// Bounds checks that wgpu uses if a driver has none.
const BOUNDS: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Restrict,
    image_load: BoundsCheckPolicy::Restrict,
    binding_array: BoundsCheckPolicy::Unchecked,
};

fn in_hlsl(module: &naga::Module, info: &ModuleInfo, program: &Program, place: usize) -> Result<Text, String> {
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V6_0,
        // Binding of the number of workgroups and the first vertex, in a space without bind groups.
        special_constants_binding: Some(hlsl::BindTarget { space: 100, ..hlsl::BindTarget::default() }),
        ..hlsl::Options::default()
    };
    let of_pipeline = hlsl::PipelineOptions { entry_point: Some((program.stage, program.entry.clone())) };
    let mut text = String::new();
    let mut writer = hlsl::Writer::new(&mut text, &options, &of_pipeline);
    let names = writer.write(module, info, None).map_err(|error| with_causes(&error))?.entry_point_names;
    Ok(Text { entry: name_in(names, place)?, bytes: text.into_bytes() })
}

fn in_msl(module: &naga::Module, info: &ModuleInfo, program: &Program, place: usize) -> Result<Text, String> {
    let options = msl::Options { lang_version: (2, 4), bounds_check_policies: BOUNDS, ..msl::Options::default() };
    let entry_point = Some((program.stage, program.entry.clone()));
    let of_pipeline = msl::PipelineOptions { entry_point, ..msl::PipelineOptions::default() };
    let written = msl::write_string(module, info, &options, &of_pipeline).map_err(|error| with_causes(&error))?;
    Ok(Text { entry: name_in(written.1.entry_point_names, place)?, bytes: written.0.into_bytes() })
}

fn in_spirv(module: &naga::Module, info: &ModuleInfo, program: &Program) -> Result<Text, String> {
    let options = spv::Options { lang_version: (1, 3), bounds_check_policies: BOUNDS, ..spv::Options::default() };
    let of_pipeline = spv::PipelineOptions { shader_stage: program.stage, entry_point: program.entry.clone() };
    let words = spv::write_vec(module, info, &options, Some(&of_pipeline)).map_err(|error| with_causes(&error))?;
    Ok(Text { entry: program.entry.clone(), bytes: words.iter().flat_map(|word| word.to_le_bytes()).collect() })
}

/// Returns an entry point's name, from the names of all or of the only one written.
fn name_in<E: std::error::Error>(names: Vec<Result<String, E>>, place: usize) -> Result<String, String> {
    let place = if names.len() == 1 { 0 } else { place };
    let name = names.into_iter().nth(place).ok_or("no entry point was written")?;
    name.map_err(|error| with_causes(&error))
}

/// Returns an error with its causes. naga's messages omit all but the first.
fn with_causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text += &format!(": {error}");
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const WGSL: &str = "override count: u32;\n@group(0) @binding(0) var<storage, read_write> sums: array<u32, 8>;\n\
                        @compute @workgroup_size(1) fn upper() { sums[0] = count; }\n\
                        @compute @workgroup_size(1) fn lower() { sums[1] = count; }";

    fn program(entry: &str, constants: &[(&str, f64)]) -> Program {
        Program {
            stage: naga::ShaderStage::Compute,
            module: "sums".into(),
            wgsl: WGSL.into(),
            entry: entry.into(),
            constants: constants.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        }
    }

    #[test]
    fn a_program_is_translated_with_its_constants() {
        let module = validated(WGSL).unwrap();
        let translation = translate(&module, &program("lower", &[("count", 1234.0)])).unwrap();
        for (text, entry) in [(&translation.hlsl, "lower"), (&translation.msl, "lower")] {
            let text = text.as_ref().unwrap();
            let words = String::from_utf8_lossy(&text.bytes);
            assert!(words.contains("1234") && words.contains(entry) && text.entry == entry, "{words}");
            assert!(!words.contains("upper"), "{words}");
        }
        let words = translation.spirv.unwrap().bytes;
        // SPIR-V's magic number and version 1.3.
        assert_eq!(words[..8], [0x03, 0x02, 0x23, 0x07, 0, 3, 1, 0]);
    }

    #[test]
    fn a_constant_without_a_value_is_an_error() {
        let module = validated(WGSL).unwrap();
        assert!(translate(&module, &program("upper", &[])).is_err());
        assert!(translate(&module, &program("third", &[("count", 1.0)])).is_err());
        assert!(validated("fn f() { return 1; }").is_err());
    }
}
