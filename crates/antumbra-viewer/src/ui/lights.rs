//! The list of lights, and the selected one's shape, size and position.

use antumbra_light::{Cone, Light, LightShape};
use glam::Vec3;

use super::decimals;
use crate::state::{Angles, ShapeKind, State, move_by};

/// Scene diagonals that a light moves per point of a drag.
const DRAG_DIAGONALS: f32 = 1.0 / 1000.0;

/// Shows the list and the selected light.
pub fn show(ui: &mut egui::Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| {
        for (index, light) in state.setup.lights.iter().enumerate() {
            ui.selectable_value(&mut state.light, index, &light.name);
        }
        if ui.button("+").on_hover_text("Add a light beside the selected one").clicked() {
            state.add_light();
        }
        let may_remove = state.setup.lights.len() > 1;
        if ui.add_enabled(may_remove, egui::Button::new("−")).on_hover_text("Remove the selected light").clicked() {
            state.remove_light();
        }
    });
    let speed_m = state.scene.as_ref().map_or(0.01, |open| open.bounds.diagonal() * DRAG_DIAGONALS).max(1e-4);
    let anchor = state.anchor;
    let index = state.light.min(state.setup.lights.len() - 1);
    let before = &state.setup.lights[index];
    let mut light = before.clone();
    egui::Grid::new("light").num_columns(2).show(ui, |ui| {
        shape(ui, &mut light, speed_m);
        pose(ui, &mut light, anchor, speed_m);
        limits(ui, &mut light);
        emission(ui, &mut light);
    });
    // An invalid light is rejected, and the controls return to the previous values.
    if light != *before {
        match light.validate() {
            Ok(()) => state.setup.lights[index] = light,
            Err(error) => {
                ui.colored_label(ui.visuals().error_fg_color, error.to_string());
            }
        }
    }
    let mut turns = state.light_turn_rad_s != 0.0;
    if ui.checkbox(&mut turns, "Rotate around the scene").changed() {
        state.light_turn_rad_s = if turns { TURN_RAD_S } else { 0.0 };
    }
}

/// Turntable speed: a turn in twenty seconds.
pub(super) const TURN_RAD_S: f32 = std::f32::consts::TAU / 20.0;

fn length(ui: &mut egui::Ui, value_m: &mut f32, speed_m: f32) {
    ui.add(egui::DragValue::new(value_m).speed(speed_m).range(0.0..=f32::MAX).suffix(" m").max_decimals(3));
}

fn shape(ui: &mut egui::Ui, light: &mut Light, speed_m: f32) {
    ui.label("Shape");
    let mut kind = ShapeKind::of(&light.shape);
    egui::ComboBox::from_id_salt("shape").selected_text(kind.name()).show_ui(ui, |ui| {
        for other in ShapeKind::ALL {
            ui.selectable_value(&mut kind, other, other.name());
        }
    });
    kind.give_to(light);
    ui.end_row();
    ui.label("Size").on_hover_text("Physical size of the light, the only control of softness");
    ui.horizontal(|ui| match &mut light.shape {
        LightShape::Rectangle { size_m } => {
            length(ui, &mut size_m.x, speed_m);
            length(ui, &mut size_m.y, speed_m);
        }
        LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => length(ui, radius_m, speed_m),
        LightShape::Ellipsoid { radii_m } => {
            length(ui, &mut radii_m.x, speed_m);
            length(ui, &mut radii_m.y, speed_m);
            length(ui, &mut radii_m.z, speed_m);
        }
        LightShape::Sun { angular_diameter_rad } => {
            let mut degrees = angular_diameter_rad.to_degrees();
            let slider = egui::Slider::new(&mut degrees, 0.0..=45.0)
                .clamping(egui::SliderClamping::Edits)
                .suffix("°")
                .custom_formatter(decimals(2));
            if ui.add(slider).on_hover_text("Angular diameter; that of the sun seen from Earth is 0.53°").changed() {
                *angular_diameter_rad = degrees.to_radians();
            }
        }
        LightShape::Points { positions_m } => {
            ui.label(format!("{} points", positions_m.len()));
        }
    });
    ui.end_row();
}

fn pose(ui: &mut egui::Ui, light: &mut Light, anchor: Vec3, speed_m: f32) {
    if !light.is_distant() {
        ui.label("Position").on_hover_text("Centre of the light in world space. You can also drag it in the image");
        ui.horizontal(|ui| {
            let mut in_world = light.center.as_dvec3() + anchor.as_dvec3();
            let before = in_world;
            for value in [&mut in_world.x, &mut in_world.y, &mut in_world.z] {
                ui.add(egui::DragValue::new(value).speed(speed_m).max_decimals(3));
            }
            if in_world != before {
                move_by(light, (in_world - before).as_vec3());
            }
        });
        ui.end_row();
    }
    let mut angles = Angles::of(light);
    let before = angles;
    let angle = |ui: &mut egui::Ui, name, tip, value_rad: &mut f32, limit: f32| {
        ui.label(name).on_hover_text(tip);
        let mut degrees = value_rad.to_degrees();
        let slider = egui::Slider::new(&mut degrees, -limit..=limit).suffix("°").custom_formatter(decimals(1));
        if ui.add(slider).changed() {
            *value_rad = degrees.to_radians();
        }
        ui.end_row();
    };
    angle(ui, "Azimuth", "Horizontal direction towards the light, from +z to +x", &mut angles.azimuth_rad, 180.0);
    angle(
        ui,
        "Elevation",
        "Angle of the direction towards the light above the horizon",
        &mut angles.elevation_rad,
        90.0,
    );
    if angles != before {
        angles.give_to(light);
    }
}

/// Initial half angles of a cone: a desk lamp's. The frustum is as wide.
const FIRST_CONE_RAD: [f32; 2] = [25.0 * DEGREE_RAD, 35.0 * DEGREE_RAD];
const DEGREE_RAD: f32 = std::f32::consts::PI / 180.0;

/// Shows the light's limits: a cone, a square frustum.
fn limits(ui: &mut egui::Ui, light: &mut Light) {
    if light.is_distant() {
        return;
    }
    let angle = |ui: &mut egui::Ui, value_rad: &mut f32, range: std::ops::RangeInclusive<f32>, tip: &str| {
        let mut degrees = value_rad.to_degrees();
        let value = egui::DragValue::new(&mut degrees).range(range).speed(0.2).suffix("°").max_decimals(1);
        if ui.add(value).on_hover_text(tip).changed() {
            *value_rad = degrees.to_radians();
        }
    };
    ui.label("Cone").on_hover_text("Cone of a spot light. Its angles have handles in the image");
    ui.horizontal(|ui| {
        let mut is_held = light.cone.is_some();
        if ui.checkbox(&mut is_held, "").changed() {
            let [inner_rad, outer_rad] = FIRST_CONE_RAD;
            light.cone = is_held.then_some(Cone { inner_rad, outer_rad });
        }
        if let Some(Cone { inner_rad, outer_rad }) = &mut light.cone {
            angle(ui, inner_rad, 0.0..=outer_rad.to_degrees() - 0.1, "Inner angle from the axis: fully lit up to it");
            angle(ui, outer_rad, inner_rad.to_degrees() + 0.1..=89.5, "Outer angle from the axis: not lit beyond it");
        }
    });
    ui.end_row();
    ui.label("Frustum").on_hover_text("Square frustum around the axis. Its angle has a handle in the image");
    ui.horizontal(|ui| {
        let mut is_held = light.fov_rad.is_some();
        if ui.checkbox(&mut is_held, "").changed() {
            light.fov_rad = is_held.then_some(2.0 * FIRST_CONE_RAD[1]);
        }
        if let Some(fov_rad) = &mut light.fov_rad {
            angle(ui, fov_rad, 1.0..=179.0, "Full angle from side to side");
        }
    });
    ui.end_row();
}

/// Initial intensity: the candela of a bright bulb, 1 250 lumens in all directions, or the lux of a hazy sun.
const DEFAULT_GIVEN: f32 = 100.0;

fn emission(ui: &mut egui::Ui, light: &mut Light) {
    let (unit, tip) = match light.shape {
        LightShape::Sun { .. } => {
            (" lx", "Illuminance on a surface that faces the sun; if off, the same as other suns")
        }
        _ => (" cd", "Luminous intensity along the axis; if off, the same as other lights of this kind"),
    };
    ui.label("Emits")
        .on_hover_text(format!("{tip}. It determines the ratios between lights; the exposure adapts to all of them"));
    ui.horizontal(|ui| {
        let mut is_given = light.candela_or_lux.is_some();
        ui.checkbox(&mut is_given, "");
        let mut given = light.candela_or_lux.unwrap_or(DEFAULT_GIVEN);
        let speed = 0.01 * given.max(1.0);
        let value = egui::DragValue::new(&mut given).speed(speed).range(0.0..=f32::MAX).suffix(unit);
        ui.add_enabled(is_given, value);
        light.candela_or_lux = is_given.then_some(given);
    });
    ui.end_row();
    ui.label("Intensity").on_hover_text("Dimmer; at 1 for all lights, the exposure is right");
    ui.horizontal(|ui| {
        let slider = egui::Slider::new(&mut light.intensity, 0.0..=8.0);
        ui.add(slider.clamping(egui::SliderClamping::Edits).custom_formatter(decimals(2)));
        let mut rgb = light.color.to_array();
        if ui.color_edit_button_rgb(&mut rgb).changed() {
            light.color = Vec3::from(rgb);
        }
    });
    ui.end_row();
}
