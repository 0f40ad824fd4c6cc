//! A side's technique and its parameters, straight from their declarations.

use antumbra::contract::{ParamScale, ParamSpec, ParamValue};
use antumbra::{Quality, TechniqueKind};

use super::decimals;
use super::readings::SideReadings;
use crate::state::Side;

/// The technique's name and quality, what it is, and its parameters.
pub fn show(ui: &mut egui::Ui, side: &mut Side, readings: &SideReadings<'_>) {
    ui.horizontal(|ui| {
        let mut kind = side.kind();
        egui::ComboBox::from_id_salt(("technique", ui.scope_id()))
            .selected_text(kind.name())
            .height(500.0)
            .show_ui(ui, |ui| {
                for &other in TechniqueKind::ALL {
                    ui.selectable_value(&mut kind, other, other.name()).on_hover_text(format!(
                        "{}\n{}",
                        other.title(),
                        other.source()
                    ));
                }
            })
            .response
            .on_hover_text("How shadows are drawn");
        side.set_kind(kind);
        let mut quality = side.quality();
        egui::ComboBox::from_id_salt(("quality", ui.scope_id()))
            .selected_text(quality.name())
            .show_ui(ui, |ui| {
                for step in Quality::ALL.into_iter().filter(|step| kind.has_quality(*step)) {
                    ui.selectable_value(&mut quality, step, step.name());
                }
            })
            .response
            .on_hover_text("How much it may spend: sets every parameter");
        if quality != side.quality() {
            side.set_quality(quality);
        }
        let is_changed = !side.settings().is_empty();
        if ui.add_enabled(is_changed, egui::Button::new("Reset")).on_hover_text("All parameters as they come").clicked()
        {
            side.reset();
        }
    });
    ui.label(egui::RichText::new(format!("{} — {}", side.kind().title(), side.kind().source())).weak());
    if let Some(kind) = readings.compiling {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("compiling {}", kind.name()));
        });
    }
    if let Some(problem) = readings.problem {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
    if let Some(overflow) = readings.overflow {
        ui.colored_label(ui.visuals().warn_fg_color, format!("no room yet: {overflow}"));
    }
    egui::CollapsingHeader::new("Parameters").id_salt(("parameters", side.kind())).default_open(true).show(ui, |ui| {
        let params: Vec<_> = side.params().collect();
        for (spec, value) in params {
            parameter(ui, side, spec, value);
        }
    });
}

/// One parameter: its control, a way back where it is not as it comes, and why it was refused.
fn parameter(ui: &mut egui::Ui, side: &mut Side, spec: &'static ParamSpec, value: ParamValue) {
    let mut text = None;
    ui.horizontal(|ui| {
        let is_usual = value == side.usual(spec);
        let name = if is_usual { egui::RichText::new(spec.key) } else { egui::RichText::new(spec.key).strong() };
        let size = egui::vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_size(size);
            ui.add(egui::Label::new(name).truncate()).on_hover_text(explanation(spec, side.usual(spec)));
        });
        text = control(ui, spec, value);
        if !is_usual && ui.small_button("↺").on_hover_text("As it comes").clicked() {
            text = Some(side.usual(spec).to_string());
        }
    });
    if let Some(text) = text {
        side.set(spec.key, &text);
    }
    if let Some(why) = side.refusal(spec.key) {
        ui.colored_label(ui.visuals().error_fg_color, why);
    }
}

/// Room for most names; the rest is cut, and whole in the tooltip.
const NAME_WIDTH: f32 = 110.0;

/// The control for a parameter's type; the new value as text where it was changed.
fn control(ui: &mut egui::Ui, spec: &'static ParamSpec, value: ParamValue) -> Option<String> {
    let slider = |ui: &mut egui::Ui, mut number: f64, is_whole: bool| {
        let (low, high) = spec.range?;
        let mut slider = egui::Slider::new(&mut number, low..=high).logarithmic(spec.scale == ParamScale::Log);
        slider = if is_whole { slider.integer() } else { slider.custom_formatter(decimals(4)) };
        let suffix = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
        ui.add(slider.suffix(suffix)).changed().then_some(number)
    };
    match value {
        ParamValue::U32(v) => slider(ui, f64::from(v), true).map(|v| (v as u32).to_string()),
        ParamValue::F32(v) => slider(ui, f64::from(v), false).map(|v| (v as f32).to_string()),
        ParamValue::Bool(v) => {
            let mut is_on = v;
            ui.checkbox(&mut is_on, "").changed().then(|| is_on.to_string())
        }
        ParamValue::Choice(mut choice) => {
            let before = choice;
            egui::ComboBox::from_id_salt((spec.key, ui.scope_id())).selected_text(choice).show_ui(ui, |ui| {
                for name in spec.choices {
                    ui.selectable_value(&mut choice, name, *name);
                }
            });
            (choice != before).then(|| choice.to_owned())
        }
        ParamValue::List(list) => {
            let id = ui.scope_id().with(spec.key);
            let mut text = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| list.to_string());
            let response = ui.add(egui::TextEdit::singleline(&mut text).desired_width(140.0));
            if response.has_focus() {
                ui.data_mut(|data| data.insert_temp(id, text.clone()));
            } else {
                ui.data_mut(|data| data.remove::<String>(id));
            }
            (response.lost_focus() && text != list.to_string()).then_some(text)
        }
    }
}

/// The five facts of a parameter.
fn explanation(spec: &ParamSpec, usual: ParamValue) -> String {
    let unit = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    format!("{}: {}\n\nTakes {}{unit}; {usual} as it comes.\n\n{}", spec.key, spec.meaning, spec.expected(), spec.more)
}
