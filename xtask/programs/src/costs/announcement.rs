//! Announcement of pipelines on standard error, each before a driver compiles it and prints its statistics there.

use std::sync::{Arc, Mutex, PoisonError};

use antumbra::TechniqueKind;
use serde_json::{Value, json};

use crate::device;
use crate::makings::{self, Extent};
use crate::recorder::{Pipeline, Program, Recorder, stage_name};

/// Prefixes of announcement lines.
pub const DEVICE: &str = "@device ";
pub const TECHNIQUE: &str = "@technique ";
pub const PIPELINE: &str = "@pipeline ";
pub const END: &str = "@end";

/// Device that pipelines are created on.
#[derive(Clone)]
enum Place {
    /// wgpu's no-op device, which compiles nothing. Used for a technique's pipelines at its default settings.
    NoOp(&'static str),
    /// Vulkan device.
    Driver,
}

/// Announces the pipelines of each technique at its default settings, then creates all pipelines on the first Vulkan driver.
///
/// # Errors
/// If there is no driver, or a pipeline is rejected.
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
        // Each technique needs its own device, because shared pipelines are created only once per device.
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
