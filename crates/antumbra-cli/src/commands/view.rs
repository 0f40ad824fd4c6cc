//! `antumbra view`.

use crate::args::WindowArgs;
use crate::failure::Failure;

/// Opens the window and returns once it is closed.
#[cfg(feature = "viewer")]
pub fn view(args: WindowArgs) -> Result<(), Failure> {
    use antumbra_lab::output_files::{check_ending, check_writable};
    use antumbra_lab::technique_run::TechniqueChoice;
    use antumbra_viewer::state::{Show, Side};
    use antumbra_viewer::{ViewerError, ViewerOptions, run};

    use crate::commands::choices;

    if let Some(path) = &args.screenshot {
        check_ending(path, "an image of the window", &["png"])?;
        check_writable(path)?;
    }
    let techniques: Vec<_> = [Some(args.technique), args.against].into_iter().flatten().collect();
    let side = |choice: &TechniqueChoice| {
        let mut side = Side::new(choice.kind);
        side.set_quality(choice.quality);
        for (key, value) in &choice.settings {
            side.set(key, value);
        }
        side
    };
    let sides: Vec<Side> = choices(&techniques, &args.settings)?.iter().map(side).collect();
    let options = ViewerOptions {
        scene: args.scene,
        setup: args.setup,
        time_s: args.time,
        ground: args.ground.when(),
        side: sides[0].clone(),
        against: sides.get(1).cloned(),
        show: Show::from_name(&args.show).unwrap_or_default(),
        size: args.size,
        adapter: args.adapter.adapter,
        screenshot: args.screenshot,
    };
    run(options).map_err(|error| match error {
        ViewerError::Window(_) | ViewerError::Lost(_) => Failure::Device(error.to_string()),
        ViewerError::Input(_) => Failure::Input(error.to_string()),
    })
}

/// Reports that this build has no window, and how to get it.
#[cfg(not(feature = "viewer"))]
pub fn view(_args: WindowArgs) -> Result<(), Failure> {
    let what = "this program was built without the viewer; build it with `cargo build --bin antumbra`";
    Err(Failure::Other(what.into()))
}
