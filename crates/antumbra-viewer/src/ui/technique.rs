//! Controls of a side's technique and parameters, generated from their declarations.

use antumbra::contract::{ParamScale, ParamSpec, ParamValue};
use antumbra::{Quality, TechniqueKind};

use super::decimals;
use crate::renderer::SideReadings;
use crate::state::Side;

/// Shows the technique's name, quality, description and parameters on a device with these features.
pub fn show(ui: &mut egui::Ui, side: &mut Side, readings: &SideReadings<'_>, features: wgpu::Features) {
    ui.horizontal(|ui| {
        let mut kind = side.kind();
        egui::ComboBox::from_id_salt(("technique", ui.scope_id()))
            .selected_text(kind.name())
            .height(500.0)
            .show_ui(ui, |ui| {
                for &other in TechniqueKind::ALL {
                    ui.selectable_value(&mut kind, other, other.name()).on_hover_text(about(other, features));
                }
            })
            .response
            .on_hover_text("Shadow technique");
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
            .on_hover_text("Quality preset: sets all parameters");
        if quality != side.quality() {
            side.set_quality(quality);
        }
        let is_changed = !side.settings().is_empty();
        if ui
            .add_enabled(is_changed, egui::Button::new("Reset"))
            .on_hover_text("Reset all parameters to their defaults")
            .clicked()
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
        ui.colored_label(ui.visuals().warn_fg_color, format!("capacity exceeded, being increased: {overflow}"));
    }
    egui::CollapsingHeader::new("Parameters").id_salt(("parameters", side.kind())).default_open(true).show(ui, |ui| {
        let params: Vec<_> = side.params().collect();
        for (spec, value) in params {
            parameter(ui, side, spec, value, readings.auto_map_sizes.first().copied(), features);
        }
    });
}

/// Describes a technique: its use, its failures, and its limitations on a device with these features.
fn about(kind: TechniqueKind, features: wgpu::Features) -> String {
    let facts = kind.facts();
    let mut lines = vec![
        kind.title().to_owned(),
        kind.source().to_owned(),
        format!("Good for: {}", facts.good_for),
        format!("Fails: {}", facts.fails_where),
    ];
    lines.extend(lacks(kind, features).into_iter().map(|lack| format!("On this device: {lack}")));
    // The facts are Markdown.
    lines.join("\n").replace('`', "")
}

/// Returns a technique's limitations on a device with these features, compared with other devices. WebGPU's core has none of the features.
fn lacks(kind: TechniqueKind, features: wgpu::Features) -> Vec<String> {
    let mut lacks = Vec::new();
    for spec in kind.param_specs() {
        let missing: Vec<&str> =
            spec.choices.iter().copied().filter(|choice| lack(spec, choice, features).is_some()).collect();
        if let Some(why) = missing.first().and_then(|choice| lack(spec, choice, features)) {
            lacks.push(format!("{} cannot be {}: {why}", spec.key, missing.join(" or ")));
        }
        let is_early = features.contains(wgpu::Features::SHADER_EARLY_DEPTH_TEST);
        if let Some((_, what)) = LATE_TESTS.iter().find(|(key, _)| *key == spec.key).filter(|_| !is_early) {
            lacks.push(format!("{}: {what}; the image is the same", spec.key));
        }
    }
    lacks
}

/// Parameters that benefit from a depth test before the fragment stage, with the effect of its absence.
const LATE_TESTS: [(&str, &str); 2] = [
    ("stencil", "fragments over empty lists are not skipped, which takes time"),
    ("path", "fragment_two_pass also scatters hidden fragments, which takes time"),
];

/// Reason why a parameter's choice is unavailable on a device with these features.
fn lack(spec: &ParamSpec, choice: &str, features: wgpu::Features) -> Option<&'static str> {
    let has_other_counts = features.contains(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);
    let is_other_count = spec.key == "msaa" && !matches!(choice, "1" | "4");
    (is_other_count && !has_other_counts).then_some("this device supports maps with 1 and 4 samples per texel")
}

/// Shows one parameter: its control, a reset button unless it has its default, and the reason of a refusal.
fn parameter(
    ui: &mut egui::Ui,
    side: &mut Side,
    spec: &'static ParamSpec,
    value: ParamValue,
    chosen: Option<u32>,
    features: wgpu::Features,
) {
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
        text = control(ui, spec, value, features).or_else(|| name_control(ui, spec, value, chosen));
        if !is_usual && ui.small_button("↺").on_hover_text("Reset to the default").clicked() {
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

/// Width of names, points; longer names are cut and shown in full in the tooltip.
const NAME_WIDTH: f32 = 110.0;

/// Shows switches for names that replace a number. Switching a name off sets the number that was `chosen` for the last
/// frame, or the middle of the range.
fn name_control(ui: &mut egui::Ui, spec: &ParamSpec, value: ParamValue, chosen: Option<u32>) -> Option<String> {
    let (low, high) = spec.range?;
    let mut text = None;
    for name in spec.choices {
        let is_on = value == ParamValue::Choice(name);
        if ui.selectable_label(is_on, *name).clicked() {
            let number = || chosen.map_or_else(|| (low * high).sqrt().round().to_string(), |texels| texels.to_string());
            text = Some(if is_on { number() } else { (*name).to_owned() });
        }
    }
    text
}

/// Shows the control for a parameter's type. Returns the new value as text if it was changed.
fn control(ui: &mut egui::Ui, spec: &'static ParamSpec, value: ParamValue, features: wgpu::Features) -> Option<String> {
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
        ParamValue::Choice(_) if spec.range.is_some() => None,
        ParamValue::Choice(mut choice) => {
            let before = choice;
            egui::ComboBox::from_id_salt((spec.key, ui.scope_id())).selected_text(choice).show_ui(ui, |ui| {
                for name in spec.choices {
                    match lack(spec, name, features) {
                        Some(why) => {
                            let button = egui::Button::selectable(choice == *name, *name);
                            ui.add_enabled(false, button).on_disabled_hover_text(why);
                        }
                        None => {
                            ui.selectable_value(&mut choice, name, *name);
                        }
                    }
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

/// Returns a parameter's tooltip: key, meaning, valid values, default and details.
fn explanation(spec: &ParamSpec, usual: ParamValue) -> String {
    let unit = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    format!("{}: {}\n\nValue: {}{unit}. Default: {usual}.\n\n{}", spec.key, spec.meaning, spec.expected(), spec.more)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The description names limitations of WebGPU's core for techniques that they affect, and for no other.
    #[test]
    fn the_list_says_what_a_technique_lacks_here() {
        let core = wgpu::Features::empty();
        let lacking = |kind: TechniqueKind| lacks(kind, core).join("; ");
        assert_eq!(
            lacking(TechniqueKind::Vsm),
            "msaa cannot be 2 or 8: this device supports maps with 1 and 4 samples per texel"
        );
        assert!(lacking(TechniqueKind::AliasFree).contains("stencil"));
        assert!(about(TechniqueKind::Vsm, core).contains("On this device: msaa"));
        for kind in [TechniqueKind::Hard, TechniqueKind::Pcss, TechniqueKind::Essm, TechniqueKind::MultiLayer] {
            assert_eq!(lacking(kind), "", "{kind}");
        }
        for &kind in TechniqueKind::ALL {
            assert_eq!(lacks(kind, wgpu::Features::all()), Vec::<String>::new(), "{kind}");
        }
    }
}
