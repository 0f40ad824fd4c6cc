//! Pipelines announced on standard error, each before a driver compiles it and prints its statistics there.

use std::sync::{Arc, Mutex, PoisonError};

use antumbra::TechniqueKind;
use serde_json::{Value, json};

use crate::device;
use crate::makings::{self, Extent};
use crate::recorder::{Pipeline, Program, Recorder, stage_name};

/// Beginnings of lines that are ours.
pub const DEVICE: &str = "@device ";
pub const TECHNIQUE: &str = "@technique ";
pub const PIPELINE: &str = "@pipeline ";
pub const END: &str = "@end";

/// Device that pipelines are made on.
#[derive(Clone)]
enum Place {
    /// wgpu's own, for which nothing is compiled: these are a technique's pipelines at its default settings.
    NoOp(&'static str),
    /// Vulkan's.
    Driver,
}

/// Announces the pipelines of each technique at its default settings, then makes all pipelines by the first Vulkan driver.
///
/// # Errors
/// Where there is no driver, or a pipeline is refused.
pub fn announce_all() -> Result<(), String> {
    let place = Arc::new(Mutex::new(Place::Driver));
    let recorder = Mutex::new(Recorder::default());
    let listened = place.clone();
    antumbra::programs::listen(move |made| {
        let pipeline = recorder.lock().unwrap_or_else(PoisonError::into_inner).record(&made);
        if let Some(pipeline) = pipeline {
            match *listened.lock().unwrap_or_else(PoisonError::into_inner) {
                Place::NoOp(technique) => {
                    eprintln!("{TECHNIQUE}{}", json!({ "technique": technique, "pipeline": described(&pipeline) }));
                }
                Place::Driver => eprintln!("{PIPELINE}{}", described(&pipeline)),
            }
        }
    });
    let set_place = |to| *place.lock().unwrap_or_else(PoisonError::into_inner) = to;
    for &kind in TechniqueKind::ALL {
        set_place(Place::NoOp(kind.name()));
        // On a device of its own, for pipelines that techniques share are made once on each.
        makings::make_technique(&device::no_op(device::FEATURES)?, kind, Extent::Default)?;
    }
    set_place(Place::Driver);
    let (gpu, adapter) = device::vulkan(device::FEATURES)?;
    eprintln!("{DEVICE}{}", json!({ "name": adapter.name, "driver": adapter.driver_info }));
    makings::make_all(&gpu, Extent::Parameters)?;
    eprintln!("{END}");
    Ok(())
}

fn described(pipeline: &Pipeline) -> Value {
    let program = |program: &Program| {
        json!({
            "stage": stage_name(program.stage),
            "module": program.module,
            "entry": program.entry,
            "constants": program.constants_text(),
        })
    };
    let programs: Vec<Value> = pipeline.programs.iter().map(program).collect();
    json!({ "label": pipeline.label, "state": pipeline.state, "programs": programs })
}
