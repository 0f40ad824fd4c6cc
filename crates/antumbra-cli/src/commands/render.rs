//! `antumbra render`.

use std::time::Duration;

use antumbra::{AnyShadow, Error};
use antumbra_lab::device::LabDevice;
use antumbra_lab::error::LabError;
use antumbra_lab::image_io::{check_picture_path, check_visibility_path, write_picture};
use antumbra_lab::output_files::check_json_path;
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Progress;
use antumbra_lab::technique_run::{Drawn, TechniqueChoice, TechniqueRun, Timing, create, parameters_of};
use antumbra_lab::view::View;
use antumbra_light::Light;
use serde_json::{Value, json};

use crate::args::{RenderArgs, ShadingFactor};
use crate::commands::{
    COMMIT, LoadedScene, choices, end_shadows, light_index, load_scene, narrowest, open_device, write_json,
    write_visibilities,
};
use crate::failure::Failure;
use crate::progress::Bars;

/// Timing parameters: number of frames of the medians, and time limit.
const TIMED: Timing =
    Timing { warm_up: 2, frames: 11, at_least: Duration::ZERO, at_most: Duration::from_secs(30), end: None };

/// Renders and writes the image and the other requested files.
pub fn render(args: &RenderArgs, bars: &Bars) -> Result<(), Failure> {
    let choice = choices(std::slice::from_ref(&args.technique), &args.settings)?.remove(0);
    // Checks come before the long work.
    check_picture_path(&args.output)?;
    args.visibility.as_deref().map_or(Ok(()), check_visibility_path)?;
    args.timings.as_deref().map_or(Ok(()), check_json_path)?;
    let LoadedScene { scene, mut setup, .. } =
        load_scene(&args.scene, &args.view.scene, narrowest(&[args.view.size]), bars)?;
    end_shadows(&mut setup.camera, args.shadow_distance);
    let chosen = args.light.as_deref().map(|name| light_index(&setup.lights, Some(name))).transpose()?;
    let lab = open_device(&args.adapter)?;
    let mut shading = match args.shading {
        ShadingFactor::Ratio => choice.for_shading(),
        ShadingFactor::Product => choice.clone(),
    };
    let mut technique = create(&lab.gpu(), &shading)?;
    bars.begin("drawing", 0);
    let make_view = if args.coherent { View::coherent } else { View::new };
    let view = make_view(&lab, &scene, &setup, args.view.size)?;
    let lights = 0..setup.lights.len();
    let draw = |technique: &mut AnyShadow| {
        lights.clone().map(|light| view.draw(technique, light, args.frames)).collect::<Result<Vec<_>, _>>()
    };
    let drawn = match draw(&mut technique) {
        // Irradiance weights take memory. They are a default, so fall back to visibility without them.
        Err(LabError::Technique(Error::Unsupported { .. })) if shading != choice => {
            shading = choice.clone();
            technique = view.create(&shading)?;
            draw(&mut technique)?
        }
        drawn => drawn?,
    };
    let picture = view.shade(&visibilities_of(&drawn))?;
    // A mask weighted by irradiance is not visibility, so the visibility needs another draw.
    let apart =
        if args.visibility.is_some() && shading != choice { Some(draw(&mut view.create(&choice)?)?) } else { None };
    bars.end();
    note_map_sizes(&setup.lights, &drawn, bars);

    write_picture(&args.output, &picture.to_srgb8())?;
    if let Some(path) = &args.visibility {
        let drawn = apart.as_deref().unwrap_or(&drawn);
        write_visibilities(path, &setup.lights, &visibilities_of(drawn), chosen, bars)?;
    }
    if let Some(path) = &args.timings {
        let mut timings = device_facts(&lab);
        timings["scene"] = json!(args.scene);
        timings["size"] = json!(args.view.size.to_array());
        timings["technique"] = json!(choice.name());
        timings["parameters"] = json!(parameters_of(&technique));
        timings["lights"] = json!(timed_lights(&view, &setup.lights, &shading)?);
        write_json(path, &timings)?;
    }
    Ok(())
}

/// Returns the program's version, and the device with its driver.
fn device_facts(lab: &LabDevice) -> Value {
    json!({
        "antumbra": env!("CARGO_PKG_VERSION"),
        "commit": COMMIT,
        "adapter": lab.adapter.name,
        "driver": lab.adapter.driver_and_version(),
        "backend": lab.adapter.backend.to_string(),
        "software": lab.adapter.is_software(),
    })
}

/// Notes the sizes of maps that are chosen for each light.
fn note_map_sizes(lights: &[Light], drawn: &[Drawn], bars: &Bars) {
    for (light, Drawn { auto_map_sizes, .. }) in lights.iter().zip(drawn) {
        if !auto_map_sizes.is_empty() {
            let sizes = auto_map_sizes.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
            bars.note(&format!("light `{}`: map_size = auto is {sizes}", light.name));
        }
    }
}

/// Times the technique for each light. Timing uses a state of its own, so that it does not change the written image.
fn timed_lights(view: &View<'_>, lights: &[Light], choice: &TechniqueChoice) -> Result<Vec<Value>, LabError> {
    let timed = |(index, light): (usize, &Light)| {
        let TechniqueRun { timings, memory_bytes, auto_map_sizes, .. } =
            view.run(&mut view.create(choice)?, index, &TIMED)?;
        Ok(json!({
            "light": light.name,
            "timings": timings,
            "memory_bytes": memory_bytes,
            "auto_map_sizes": auto_map_sizes,
        }))
    };
    lights.iter().enumerate().map(timed).collect()
}

fn visibilities_of(drawn: &[Drawn]) -> Vec<&Visibility> {
    drawn.iter().map(|drawn| &drawn.visibility).collect()
}
