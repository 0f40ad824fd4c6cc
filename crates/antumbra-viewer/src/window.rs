//! The desktop window: opens it on the requested adapter with the features and limits that the library wants.

use std::path::Path;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use antumbra_scene::{LoadOptions, builtin, load};
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};

use crate::app::{App, Ended, Outcome, PersistentState};
use crate::device::device_descriptor;
use crate::loader::read_setup;
use crate::message::one_line;
use crate::options::{ViewerError, ViewerOptions};

/// Environment variable that names the adapter when the options do not.
pub const ADAPTER_VARIABLE: &str = "ANTUMBRA_ADAPTER";

/// Minimum lifetime of a device; one that is lost sooner is not replaced.
const MIN_LIFE: Duration = Duration::from_secs(10);

/// Opens the window and returns once it is closed. If the graphics device is lost, a new window continues with a new device.
///
/// # Errors
/// Fails if there is no desktop, no adapter for it, or a requested screenshot cannot be taken.
pub fn run(options: ViewerOptions) -> Result<(), ViewerError> {
    check_input(&options)?;
    let (size, adapter) = (options.size, options.adapter.clone());
    let mut start = Start::Options(Box::new(options));
    loop {
        let made = Instant::now();
        match run_window(size, adapter.clone(), start)? {
            Some(Ended::Lost(why, kept)) if made.elapsed() >= MIN_LIFE => {
                eprintln!("antumbra: the graphics device was lost ({why}); reopening the window");
                start = Start::Restored(kept);
            }
            Some(Ended::Lost(why, _)) => return Err(ViewerError::Lost(why)),
            Some(Ended::Done(outcome)) => return outcome.map_err(ViewerError::Input),
            None => return Ok(()),
        }
    }
}

/// Initial state of a window.
enum Start {
    Options(Box<ViewerOptions>),
    Restored(Box<PersistentState>),
}

/// Opens a window and returns once it is closed, by itself or by the user.
fn run_window(size: glam::UVec2, adapter: Option<String>, start: Start) -> Result<Option<Ended>, ViewerError> {
    let size = [size.x as f32, size.y as f32];
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_app_id("antumbra")
            .with_inner_size(size)
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: WgpuConfiguration {
            wgpu_setup: WgpuSetup::CreateNew(setup(adapter)),
            ..WgpuConfiguration::default()
        },
        persist_window: false,
        ..eframe::NativeOptions::default()
    };
    let outcome = Outcome::default();
    let for_app = outcome.clone();
    let create = Box::new(move |creation: &eframe::CreationContext<'_>| {
        let render_state = creation.wgpu_render_state.clone().ok_or("the window is not drawn by wgpu")?;
        let app = match start {
            Start::Options(options) => App::new(&creation.egui_ctx, render_state, *options, for_app),
            Start::Restored(kept) => App::kept(&creation.egui_ctx, render_state, *kept, for_app),
        };
        Ok(Box::new(app) as Box<dyn eframe::App>)
    });
    eframe::run_native("antumbra", native, create)
        .map_err(|error| ViewerError::Window(without_source(&error.to_string()).to_owned()))?;
    let ended = outcome.lock().unwrap_or_else(PoisonError::into_inner).take();
    Ok(ended)
}

/// Strips the source location from a message, and its full stop.
fn without_source(message: &str) -> &str {
    let behind = message.split_once(".rs:").and_then(|(_, place)| place.split_once(": "));
    behind.map_or(message, |(_, what)| what).trim_end_matches('.')
}

/// Checks the arguments before a window opens. Errors within a scene file appear when it loads.
fn check_input(options: &ViewerOptions) -> Result<(), ViewerError> {
    if let Some(path) = &options.setup {
        read_setup(path).map_err(ViewerError::Input)?;
    }
    let Some(spec) = &options.scene else { return Ok(()) };
    let is_there = match builtin::spec_of(spec) {
        Some(name) => builtin::named(name.split('?').next().unwrap_or(name)).is_some(),
        None => Path::new(spec).exists(),
    };
    if is_there {
        return Ok(());
    }
    let why = load(spec, &LoadOptions::default()).err().map(|error| one_line(&error.to_string()));
    why.map_or(Ok(()), |why| Err(ViewerError::Input(why)))
}

/// Device setup as in the laboratory: WebGPU's limits, with larger textures and buffers if the adapter supports them.
fn setup(adapter: Option<String>) -> WgpuSetupCreateNew {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
    // As in the laboratory's device: validation layers before 2023 reject every shader with debug information.
    setup.instance_descriptor.flags = (setup.instance_descriptor.flags - wgpu::InstanceFlags::DEBUG).with_env();
    setup.native_adapter_selector =
        Some(Arc::new(move |adapters, surface| select(adapters, surface, adapter.as_deref()).cloned()));
    setup.device_descriptor = Arc::new(device_descriptor);
    setup
}

/// Selects the best adapter that can draw to the window and matches the name.
fn select<'a>(
    adapters: &'a [wgpu::Adapter],
    surface: Option<&wgpu::Surface<'_>>,
    name: Option<&str>,
) -> Result<&'a wgpu::Adapter, String> {
    let from_environment = std::env::var(ADAPTER_VARIABLE).ok().filter(|part| !part.is_empty());
    let wanted = name.map(str::to_owned).or(from_environment).map(|name| name.to_lowercase());
    let is_wanted = |adapter: &&wgpu::Adapter| {
        let info = adapter.get_info();
        let names = [info.name, info.driver, info.backend.to_string()];
        wanted.as_ref().is_none_or(|wanted| names.iter().any(|name| name.to_lowercase().contains(wanted)))
    };
    let fits = |adapter: &&wgpu::Adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface));
    let rank = |adapter: &&wgpu::Adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    adapters.iter().filter(is_wanted).filter(fits).min_by_key(rank).ok_or_else(|| {
        let names: Vec<_> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
        match &wanted {
            Some(wanted) => {
                format!("no adapter named `{wanted}` can draw to the window; available: {}", names.join(", "))
            }
            None => format!("no adapter can draw to the window; available: {}", names.join(", ")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_no_source_file() {
        let message = "os error at /x/winit/mod.rs:765: neither DISPLAY nor that is set.";
        assert_eq!(without_source(message), "neither DISPLAY nor that is set");
        assert_eq!(without_source("no adapter: none"), "no adapter: none");
    }
}
