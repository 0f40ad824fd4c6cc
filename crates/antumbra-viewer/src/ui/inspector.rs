//! Values of the pixel under the pointer.

use crate::renderer::Inspected;
use crate::state::State;

/// Distance from the pointer, points.
const OFFSET: egui::Vec2 = egui::vec2(18.0, 18.0);

/// Shows a pixel's values beside the pointer. `truth` is the traced visibility; it is negative if the pixel is not judged.
pub fn show(ctx: &egui::Context, state: &State, pointer: egui::Pos2, inspected: &Inspected, truth: Option<f32>) {
    let area =
        egui::Area::new(egui::Id::unique("inspector")).order(egui::Order::Tooltip).interactable(false).fade_in(false);
    area.fixed_pos(pointer + OFFSET).show(ctx, |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            egui::Grid::new("inspector").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
                for (name, value) in rows(state, inspected, truth) {
                    ui.label(egui::RichText::new(name).weak());
                    ui.monospace(value);
                    ui.end_row();
                }
            });
        });
    });
}

/// Returns names and values with units.
fn rows(state: &State, inspected: &Inspected, truth: Option<f32>) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    row("pixel", format!("{}, {}", inspected.pixel.x, inspected.pixel.y));
    let Some(surface) = &inspected.surface else {
        row("surface", "none (background)".into());
        return rows;
    };
    if let Some(position) = surface.position {
        let in_world = position + state.anchor;
        row("position", format!("{:.3}, {:.3}, {:.3} m", in_world.x, in_world.y, in_world.z));
        row("distance to camera", format!("{:.3} m", position.distance(state.setup.camera.eye)));
        if let Some(light) = state.setup.lights.get(state.light).filter(|light| !light.is_distant()) {
            row("distance to light", format!("{:.3} m", position.distance(light.center)));
        }
    }
    let normal = surface.normal;
    row("normal", format!("{:+.3}, {:+.3}, {:+.3}", normal.x, normal.y, normal.z));
    let judged = truth.filter(|truth| *truth >= 0.0);
    for (side, visibility) in state.shown_sides().iter().zip(inspected.visibilities) {
        let Some(visibility) = visibility else { continue };
        let error = judged.map_or_else(String::new, |truth| format!("   error {:+.4}", visibility - truth));
        row(&side.name(), format!("{visibility:.4} of the light visible{error}"));
    }
    match truth {
        Some(truth) if truth >= 0.0 => row("truth", format!("{truth:.4} of the light visible")),
        Some(_) => row("truth", "not measured: faces away from the light".into()),
        None => row("truth", "…".into()),
    }
    let color = surface.base_color;
    row("base colour", format!("{:.3}, {:.3}, {:.3} linear, opacity {:.2}", color.x, color.y, color.z, color.w));
    row("surface", format!("roughness {:.2}, metallic {:.2}", surface.roughness, surface.metallic));
    rows
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use glam::{UVec2, Vec3, Vec4};

    use super::*;
    use crate::renderer::InspectedSurface;

    #[test]
    fn numbers_have_names_and_units() {
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Vsm);
        (state.setup.camera.eye, state.is_split) = (Vec3::new(1.0, 0.0, 4.0), true);
        state.anchor = Vec3::new(0.0, 0.0, 160.0);
        let surface = InspectedSurface {
            position: Some(Vec3::new(1.0, 0.0, 2.5)),
            normal: Vec3::Y,
            base_color: Vec4::new(0.5, 0.25, 0.125, 1.0),
            metallic: 0.0,
            roughness: 0.7,
        };
        let inspected =
            Inspected { pixel: UVec2::new(3, 4), surface: Some(surface), visibilities: [Some(0.75), Some(0.5)] };
        let text = |truth| -> Vec<String> {
            rows(&state, &inspected, truth).into_iter().map(|(name, value)| format!("{name}: {value}")).collect()
        };
        let judged = text(Some(0.625));
        for line in [
            "pixel: 3, 4",
            "position: 1.000, 0.000, 162.500 m",
            "distance to camera: 1.500 m",
            "normal: +0.000, +1.000, +0.000",
            "pcss: 0.7500 of the light visible   error +0.1250",
            "vsm: 0.5000 of the light visible   error -0.1250",
            "truth: 0.6250 of the light visible",
        ] {
            assert!(judged.iter().any(|row| row == line), "{line} is not in {judged:?}");
        }
        assert!(text(Some(-1.0)).iter().all(|row| !row.contains("error")));
        let nothing = Inspected { surface: None, ..inspected.clone() };
        assert_eq!(rows(&state, &nothing, None).len(), 2);
    }
}
