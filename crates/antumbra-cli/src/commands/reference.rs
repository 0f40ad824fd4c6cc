//! `antumbra reference`.

use antumbra_lab::device::{DeviceError, LabDevice};
use antumbra_lab::image_io::{check_picture_path, check_visibility_path, write_picture};
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Progress;
use antumbra_lab::truth::trace;
use antumbra_lab::view::View;
use antumbra_reference::VisibilityOptions;

use crate::args::ReferenceArgs;
use crate::commands::{LoadedScene, device_options, light_index, load_scene, narrowest, write_visibilities};
use crate::failure::Failure;
use crate::progress::Bars;
use crate::stdout::say;

/// Traces the ground truth, and writes the image and, if requested, the visibility.
pub fn reference(args: &ReferenceArgs, bars: &Bars) -> Result<(), Failure> {
    check_picture_path(&args.output)?;
    args.visibility.as_deref().map_or(Ok(()), check_visibility_path)?;
    let LoadedScene { scene, setup, .. } =
        load_scene(&args.scene, &args.view.scene, narrowest(&[args.view.size]), bars)?;
    let chosen = args.light.as_deref().map(|name| light_index(&setup.lights, Some(name))).transpose()?;
    let options = VisibilityOptions { samples: args.samples, seed: args.seed, ..VisibilityOptions::default() };
    // The device is opened before the long work, so that a wrong adapter name fails early. Tracing itself needs no adapter.
    let lab = match LabDevice::new(&device_options(&args.adapter)) {
        Ok(lab) => Some(lab),
        Err(DeviceError::NoAdapter) if args.adapter.adapter.is_none() => None,
        Err(error) => return Err(error.into()),
    };
    let truths = trace(&scene, &setup, args.view.size, &options, bars)?;
    for (light, truth) in setup.lights.iter().zip(&truths) {
        let (rate, rays) = (truth.rays_per_second() * 1e-6, truth.rays as f64 * 1e-6);
        say!("light {}: {rays:.1} M rays in {:.2} s, {rate:.2} M rays/s", light.name, truth.seconds);
    }
    let visibilities: Vec<&Visibility> = truths.iter().map(|truth| &truth.visibility).collect();
    bars.begin("shading", 0);
    let picture = match lab {
        Some(lab) => View::new(&lab, &scene, &setup, args.view.size)?.shade(&visibilities)?.to_srgb8(),
        None => {
            bars.note(&format!("the image shows visibility, not shading: {}", DeviceError::NoAdapter));
            visibilities[chosen.unwrap_or(0)].to_gray_levels()
        }
    };
    bars.end();
    write_picture(&args.output, &picture)?;
    if let Some(path) = &args.visibility {
        write_visibilities(path, &setup.lights, &visibilities, chosen, bars)?;
    }
    Ok(())
}
