//! Radiance by the plain product and by the ratio estimator, against ray-traced radiance.
//!
//! A renderer shows the analytic irradiance of an area light times a mask on a white diffuse surface. With `weights=irradiance` masks
//! hold the arriving fraction of the light's irradiance, and otherwise the visible fraction of the light (Heitz, Hill, McGuire,
//! "Combining Analytic Direct Illumination and Stochastic Shadows", I3D 2018). For each scene and technique this prints the root mean
//! square error of both products over all pixels that show a surface, relative to the mean unshadowed irradiance. *Exact* is the product
//! with perfect masks.
//!
//! ```text
//! cargo run --example ratio
//! cargo run --example ratio -- builtin:hall builtin:overlap
//! ```

use antumbra::TechniqueKind;
use antumbra_lab::device::{DeviceOptions, LabDevice};
use antumbra_lab::irradiance::IrradianceTruth;
use antumbra_lab::technique_run::TechniqueChoice;
use antumbra_lab::view::View;
use antumbra_scene::{LoadOptions, Setup, load};
use glam::UVec2;

const SCENES: [&str; 15] = [
    "builtin:overlap",
    "builtin:window",
    "builtin:columns",
    "builtin:hall",
    "builtin:staircase",
    "builtin:leaning-plank",
    "builtin:fence-geometry",
    "builtin:lantern-wall",
    "builtin:stacked-panels",
    "builtin:tilted-planes",
    "builtin:spheres",
    "builtin:lamp-room",
    "builtin:shanty",
    "builtin:street",
    "builtin:town",
];
const SIZE: UVec2 = UVec2::new(240, 135);
/// Number of rays from each pixel to the light, for the ground truth.
const RAYS: u32 = 4096;
const TECHNIQUES: [TechniqueKind; 3] = [TechniqueKind::RayTraced, TechniqueKind::SampleBased, TechniqueKind::Smrt];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let scenes = if given.is_empty() { SCENES.map(str::to_owned).into() } else { given };
    let lab = LabDevice::new(&DeviceOptions { adapter: None, wanted_features: antumbra::Gpu::WANTED_FEATURES })?;
    let columns = TECHNIQUES.map(|kind| format!("`{kind}` V × E | R × E")).join(" | ");
    println!("| scene | pixels | exact V × E | exact R × E | {columns} |");
    println!("|---|{}", "---|".repeat(3 + 2 * TECHNIQUES.len()));
    for spec in scenes {
        let scene = load(&spec, &LoadOptions::default())?;
        let setup = Setup::for_scene(&scene);
        let truth = IrradianceTruth::new(&lab, &scene, &setup, SIZE, 0, RAYS)?;
        let view = View::new(&lab, &scene, &setup, SIZE)?;
        let exact = [truth.rmse_of_visibility(), truth.rmse_of_ratio()];
        let mut line = format!("| `{spec}` | {} | {:.4} | {:.4} ", truth.count(), exact[0], exact[1]);
        for kind in TECHNIQUES {
            let product = TechniqueChoice::default_of(kind);
            for choice in [&product, &product.for_shading()] {
                let mask = view.draw(&mut view.create(choice)?, 0, 1)?.visibility;
                line += &format!("| {:.4} ", truth.rmse(&mask));
            }
        }
        println!("{line}|");
    }
    Ok(())
}
