//! `antumbra scenes`.

use std::path::Path;

use antumbra_lab::output_files::{check_ending, check_writable, write_atomically};
use antumbra_scene::{Scene, SceneError, builtin, export_glb, export_gltf};
use serde_json::{Value, json};

use crate::args::ScenesArgs;
use crate::failure::Failure;
use crate::stdout::say;
use crate::table;

/// Lists the built-in scenes, or writes one as glTF.
pub fn scenes(args: &ScenesArgs) -> Result<(), Failure> {
    if let (Some(name), Some(output)) = (&args.export, &args.output) {
        let export = exporter_for(output)?;
        check_writable(output)?;
        let spec = builtin::spec_of(name).unwrap_or(name);
        let scene = builtin::build(spec).map_err(|error| Failure::Input(error.to_string()))?;
        return Ok(write_atomically(output, &export(&scene)?)?);
    }
    if args.json {
        say!("{:#}", list_as_json());
        return Ok(());
    }
    let mut rows = vec![["NAME", "TRIANGLES", "WHAT IT SHOWS"].map(str::to_owned).to_vec()];
    rows.extend(
        builtin::NAMES.iter().map(|info| vec![info.name.into(), info.triangles.to_string(), info.summary.into()]),
    );
    table::print(&rows);
    let with_parameters = builtin::NAMES.iter().filter(|info| !info.parameters.is_empty());
    say!("\nParameters, as in builtin:NAME?key=value&key=value:");
    for info in with_parameters {
        for parameter in info.parameters {
            say!(
                "  {}?{}  {} ({} to {}{}{}; default {})",
                info.name,
                parameter.name,
                parameter.meaning.trim_end_matches('.'),
                parameter.min,
                parameter.max,
                if parameter.unit.is_empty() { "" } else { " " },
                parameter.unit,
                parameter.default
            );
        }
    }
    Ok(())
}

fn list_as_json() -> Value {
    let scenes = builtin::NAMES.iter().map(|info| {
        let parameters = info.parameters.iter().map(|parameter| {
            json!({
                "name": parameter.name,
                "meaning": parameter.meaning,
                "unit": parameter.unit,
                "range": [parameter.min, parameter.max],
                "default": parameter.default,
            })
        });
        json!({
            "name": format!("builtin:{}", info.name),
            "triangles": info.triangles,
            "shows": info.summary,
            "parameters": parameters.collect::<Vec<_>>(),
        })
    });
    scenes.collect()
}

type Exporter = fn(&Scene) -> Result<Vec<u8>, SceneError>;

/// Returns the exporter for a path's extension: text or binary container.
fn exporter_for(output: &Path) -> Result<Exporter, Failure> {
    Ok(match check_ending(output, "a scene", &["glb", "gltf"])? {
        "glb" => export_glb,
        _ => export_gltf,
    })
}
