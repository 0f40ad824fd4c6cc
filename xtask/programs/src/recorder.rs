//! Recorder of pipelines: their programs, and the state that a driver's code for them depends on.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use antumbra::programs::CreatedObject;
use naga::ShaderStage;

/// Pipeline with its programs and state.
#[derive(Clone, Debug, PartialEq)]
pub struct Pipeline {
    pub label: String,
    pub programs: Vec<Program>,
    /// Formats, samples and blending of a render pipeline; empty for compute.
    pub state: String,
}

/// Stage of a pipeline.
#[derive(Clone, PartialEq)]
pub struct Program {
    pub stage: ShaderStage,
    /// Name of its module's text: the first label, with a number if earlier texts had the same label.
    pub module: String,
    pub wgsl: Arc<str>,
    pub entry: String,
    /// Override constants, as passed to wgpu.
    pub constants: Vec<(String, f64)>,
}

impl fmt::Debug for Program {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} {} {} [{}]", self.module, stage_name(self.stage), self.entry, self.constants_text())
    }
}

impl Program {
    /// Returns the override constants as text: `0=1 USES_TABLE=0`.
    pub fn constants_text(&self) -> String {
        let constants = self.constants.iter().map(|(name, value)| format!("{name}={value}"));
        constants.collect::<Vec<_>>().join(" ")
    }
}

/// Returns the name of a stage: `compute`, `vertex` or `fragment`.
pub fn stage_name(stage: ShaderStage) -> String {
    format!("{stage:?}").to_lowercase()
}

/// Modules created so far.
#[derive(Debug, Default)]
pub struct Recorder {
    /// Name and text of each module.
    modules: HashMap<wgpu::ShaderModule, (String, Arc<str>)>,
    /// Name of each text. Techniques that share a text label it differently.
    names: HashMap<Arc<str>, String>,
    /// Number of texts per label.
    counts: HashMap<String, usize>,
}

impl Recorder {
    /// Records a module, or returns a pipeline.
    ///
    /// # Panics
    /// For a pipeline whose module was not recorded: `antumbra::programs` creates all of them.
    pub fn record(&mut self, made: &CreatedObject<'_>) -> Option<Pipeline> {
        match made {
            CreatedObject::Module(module, label, wgsl) => {
                self.add(module, label, wgsl);
                None
            }
            CreatedObject::Compute(descriptor) => {
                let wgpu::ComputePipelineDescriptor { module, entry_point, compilation_options, .. } = descriptor;
                let program = self.program(ShaderStage::Compute, module, *entry_point, compilation_options);
                Some(Pipeline { label: label_of(descriptor.label), programs: vec![program], state: String::new() })
            }
            CreatedObject::Render(descriptor) => Some(self.render_pipeline(descriptor)),
            CreatedObject::BindGroupLayout(..) | CreatedObject::PipelineLayout(..) => None,
        }
    }

    fn add(&mut self, module: &wgpu::ShaderModule, label: &str, wgsl: &str) {
        let (text, name) = match self.names.get_key_value(wgsl) {
            Some((text, name)) => (text.clone(), name.clone()),
            None => {
                let count = self.counts.entry(label.to_owned()).or_default();
                *count += 1;
                let name = if *count == 1 { label.to_owned() } else { format!("{label}#{count}") };
                let text: Arc<str> = wgsl.into();
                self.names.insert(text.clone(), name.clone());
                (text, name)
            }
        };
        self.modules.insert(module.clone(), (name, text));
    }

    fn program(
        &self,
        stage: ShaderStage,
        module: &wgpu::ShaderModule,
        entry: Option<&str>,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> Program {
        let (module, wgsl) = self.modules.get(module).cloned().expect("created by `antumbra::programs`");
        let entry = entry.map_or_else(|| only_entry(&wgsl, stage), str::to_owned);
        let constants = options.constants.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        Program { stage, module, wgsl, entry, constants }
    }

    fn render_pipeline(&self, descriptor: &wgpu::RenderPipelineDescriptor<'_>) -> Pipeline {
        let vertex = &descriptor.vertex;
        let options = &vertex.compilation_options;
        let mut programs = vec![self.program(ShaderStage::Vertex, vertex.module, vertex.entry_point, options)];
        let mut state = Vec::new();
        if let Some(fragment) = &descriptor.fragment {
            let options = &fragment.compilation_options;
            programs.push(self.program(ShaderStage::Fragment, fragment.module, fragment.entry_point, options));
            state.extend(
                fragment.targets.iter().flatten().map(|target| {
                    format!("{:?}{}", target.format, if target.blend.is_some() { " blended" } else { "" })
                }),
            );
        }
        state.extend(descriptor.depth_stencil.iter().map(|depth| format!("{:?}", depth.format)));
        if descriptor.multisample.count > 1 {
            state.push(format!("{} samples", descriptor.multisample.count));
        }
        if descriptor.primitive.unclipped_depth {
            state.push("unclipped".to_owned());
        }
        Pipeline { label: label_of(descriptor.label), programs, state: state.join(", ") }
    }
}

/// Returns the pipelines that `make` creates. May be called once per process.
///
/// # Errors
/// The errors of `make`.
///
/// # Panics
/// If there is already a listener, because a process can have only one.
pub fn pipelines_made(make: impl FnOnce() -> Result<(), String>) -> Result<Vec<Pipeline>, String> {
    let made: Arc<Mutex<(Recorder, Vec<Pipeline>)>> = Arc::default();
    let kept = made.clone();
    antumbra::programs::listen(move |made| {
        let (recorder, pipelines) = &mut *kept.lock().unwrap_or_else(PoisonError::into_inner);
        pipelines.extend(recorder.record(&made));
    });
    make()?;
    Ok(std::mem::take(&mut made.lock().unwrap_or_else(PoisonError::into_inner).1))
}

fn label_of(label: Option<&str>) -> String {
    label.unwrap_or_default().to_owned()
}

/// Returns the name of a text's only entry point of a stage, which a pipeline may omit.
fn only_entry(wgsl: &str, stage: ShaderStage) -> String {
    let module = naga::front::wgsl::parse_str(wgsl).expect("wgpu has parsed it");
    let entry = module.entry_points.into_iter().find(|entry| entry.stage == stage);
    entry.expect("wgpu has found one").name
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device;

    /// Creates a module and a pipeline of each text and returns the recorded pipelines.
    fn recorded(texts: &[(&str, &str)]) -> Vec<Pipeline> {
        let make = || {
            make_pipelines(&device::no_op(wgpu::Features::empty())?, texts);
            Ok(())
        };
        pipelines_made(make).unwrap()
    }

    fn make_pipelines(gpu: &antumbra::Gpu, texts: &[(&str, &str)]) {
        for &(label, text) in texts {
            let module = antumbra::programs::create_shader_module(gpu.device(), label, text.into());
            let constants = [("1", 2.0), ("2", 0.5)];
            let compilation_options = wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..wgpu::PipelineCompilationOptions::default()
            };
            antumbra::programs::create_compute_pipeline(
                gpu.device(),
                &wgpu::ComputePipelineDescriptor {
                    label: Some("halve"),
                    layout: None,
                    module: &module,
                    entry_point: None,
                    compilation_options,
                    cache: None,
                },
            );
        }
    }

    #[test]
    fn modules_are_told_apart_by_their_texts() {
        let text = "@id(1) override count: u32; @id(2) override scale: f32;\n\
                    @compute @workgroup_size(1) fn run() { let all = f32(count) * scale; }";
        let other = format!("{text}\nfn other() {{}}");
        let pipelines = recorded(&[("half", text), ("half", &other), ("another", text)]);
        let modules: Vec<&str> = pipelines.iter().map(|pipeline| pipeline.programs[0].module.as_str()).collect();
        assert_eq!(modules, ["half", "half#2", "half"]);
        assert_eq!(pipelines[0], pipelines[2]);
        assert_eq!(format!("{:?}", pipelines[1].programs[0]), "half#2 compute run [1=2 2=0.5]");
        assert_eq!((pipelines[0].label.as_str(), pipelines[0].state.as_str()), ("halve", ""));
    }
}
