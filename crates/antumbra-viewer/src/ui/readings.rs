//! Measurements of the shown techniques: times, memory, errors.

use crate::renderer::{ERROR_RAMP, ERROR_RANGE, FrameTimes, SideReadings, Times};
use crate::state::State;

/// Measurements of a frame.
#[derive(Clone, Debug)]
pub struct Readings<'a> {
    /// The left or only side, and the right side.
    pub sides: [SideReadings<'a>; 2],
    /// Light samples per pixel that the ground truth has so far.
    pub truth_points: Option<u32>,
    /// GPU memory of the scene, bytes.
    pub scene_memory_bytes: u64,
    /// Image size, pixels.
    pub size_px: glam::UVec2,
    /// The adapter's name.
    pub adapter: &'a str,
    /// Features of the device beyond WebGPU's core.
    pub features: wgpu::Features,
}

/// Shows medians of every pass's time over the last frames, and a graph.
pub fn show(ui: &mut egui::Ui, state: &State, readings: &Readings<'_>) {
    ui.label(egui::RichText::new(readings.adapter).weak());
    for (side, readings) in state.shown_sides().iter().zip(&readings.sides) {
        ui.strong(side.kind().name());
        let times = readings.times;
        graph(ui, times);
        egui::Grid::new(("times", side.kind(), ui.next_auto_id())).num_columns(2).striped(true).show(ui, |ui| {
            let mut row = |name: &str, value: String| {
                ui.label(name);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.monospace(value));
                ui.end_row();
            };
            for (label, ms) in times.pass_medians() {
                row(label, format!("{ms:.3} ms"));
            }
            if let Some(ms) = times.median(FrameTimes::gpu_ms) {
                row("all passes", format!("{ms:.3} ms"));
            }
            if let Some(ms) = times.median(|frame| frame.processor_ms) {
                row("CPU", format!("{ms:.3} ms"));
                let (frames, warm_up) = times.counts();
                row("median of", format!("{frames} frames after {warm_up} warm-up frames"));
            }
            row("memory", mebibytes(readings.memory_bytes));
            if !readings.auto_map_sizes.is_empty() {
                let sizes: Vec<_> = readings.auto_map_sizes.iter().map(u32::to_string).collect();
                row("map_size, auto", sizes.join(", "));
            }
        });
    }
    ui.label(format!("scene {}", mebibytes(readings.scene_memory_bytes)));
}

fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}

/// Draws a bar for each of the last frames, and a line at the median.
fn graph(ui: &mut egui::Ui, times: &Times) {
    let height = 36.0;
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), height), egui::Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let highest_ms = times.frames().map(FrameTimes::gpu_ms).fold(0.0, f64::max);
    let Some(median_ms) = times.median(FrameTimes::gpu_ms).filter(|_| highest_ms > 0.0) else { return };
    let y = |ms: f64| rect.bottom() - (ms / highest_ms) as f32 * rect.height();
    let bar = rect.width() / crate::renderer::FRAMES as f32;
    for (i, frame) in times.frames().enumerate() {
        let left = rect.left() + i as f32 * bar;
        let right_bottom = egui::pos2(left + (0.8 * bar).max(1.0), rect.bottom());
        let bar = egui::Rect::from_two_pos(egui::pos2(left, y(frame.gpu_ms())), right_bottom);
        painter.rect_filled(bar, 0.0, ui.visuals().selection.bg_fill);
    }
    painter.hline(rect.x_range(), y(median_ms), ui.visuals().widgets.active.fg_stroke);
}

/// Shows the status bar: the newest message, errors, sizes.
pub fn status_bar(ui: &mut egui::Ui, state: &State, readings: &Readings<'_>, message: &str, is_bad: bool) {
    ui.horizontal(|ui| {
        if let Some(open) = &state.scene {
            ui.label(format!("{} triangles", open.triangle_count));
            ui.separator();
            ui.label(format!("{} × {}", readings.size_px.x, readings.size_px.y));
        }
        if state.show.needs_truth() {
            ui.separator();
            match readings.truth_points {
                Some(points) => ui.label(format!("truth: {points} light samples per pixel")),
                None => ui.label("tracing…"),
            };
            for (side, readings) in state.shown_sides().iter().zip(&readings.sides) {
                if let Some(rmse) = readings.rmse {
                    ui.strong(format!("{} rmse {rmse:.4}", side.kind().name()));
                }
            }
            if state.show == crate::state::Show::Error {
                error_scale(ui);
            }
        }
        if !message.is_empty() {
            ui.separator();
            let color = if is_bad { ui.visuals().error_fg_color } else { ui.visuals().text_color() };
            ui.add(egui::Label::new(egui::RichText::new(message).color(color)).truncate()).on_hover_text(message);
        }
    });
}

/// Shows the colour map of the error view.
fn error_scale(ui: &mut egui::Ui) {
    ui.separator();
    ui.label(format!("{:+}", -ERROR_RANGE));
    let (rect, _) = ui.allocate_exact_size(egui::vec2(110.0, 12.0), egui::Sense::hover());
    let width = rect.width() / ERROR_RAMP.len() as f32;
    for (i, [r, g, b]) in ERROR_RAMP.into_iter().enumerate() {
        let min = egui::pos2(rect.left() + i as f32 * width, rect.top());
        let cell = egui::Rect::from_min_size(min, egui::vec2(width, rect.height()));
        ui.painter().rect_filled(cell, 0.0, egui::Color32::from_rgb(r, g, b));
    }
    ui.label(format!("{ERROR_RANGE:+}"));
}
