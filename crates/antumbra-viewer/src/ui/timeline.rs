//! The playback bar of an animated scene: play and pause, time, speed.

use crate::state::{SPEEDS, State};

/// Shows the bar if the scene is animated.
pub fn show(ui: &mut egui::Ui, state: &mut State) {
    let play = &mut state.play;
    let Some([first, last]) = play.ends_s else { return };
    ui.horizontal(|ui| {
        let name = if play.is_playing { "Pause" } else { "Play" };
        let size = egui::vec2(76.0, ui.spacing().interact_size.y);
        if ui.add_sized(size, egui::Button::new(name)).on_hover_text("Play or pause the animation (Space)").clicked() {
            play.is_playing = !play.is_playing;
        }
        let speed = egui::DragValue::new(&mut play.speed).range(SPEEDS).speed(0.01).max_decimals(2).prefix("× ");
        ui.add(speed).on_hover_text("Playback speed");
        // The slider fills the bar except for the number.
        ui.spacing_mut().slider_width = (ui.available_width() - 80.0).max(60.0);
        let range = first.min(0.0)..=last;
        let slider = egui::Slider::new(&mut play.time_s, range)
            .suffix(" s")
            .custom_formatter(|time_s, _| format!("{time_s:.2}"));
        if ui.add(slider).on_hover_text("Time of the animation").changed() {
            play.is_playing = false;
        }
    });
}
