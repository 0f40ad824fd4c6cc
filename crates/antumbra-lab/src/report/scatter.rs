//! Error against cost as an inline SVG: every technique a point, and the line of those that none beats in both.

use std::fmt::Write;

use super::html::{escape, three_figures};

/// A technique as a point.
pub(super) struct Point {
    pub(super) name: String,
    /// Of its section in the page, without `#`.
    pub(super) anchor: String,
    /// Above zero.
    pub(super) cost: f64,
    pub(super) error: f64,
}

/// What a drawing's axes are.
#[derive(Clone, Copy)]
pub(super) struct Axes {
    /// Of the cost, to read along the axis: `milliseconds a frame`.
    pub(super) cost: &'static str,
    /// `ms`.
    pub(super) cost_unit: &'static str,
    /// Of the error: `rmse`.
    pub(super) error: &'static str,
}

/// The drawing, in its own units; the page scales it.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 380.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 18.0;
const BOTTOM: f64 = 46.0;
/// Baselines of neighbouring labels are at least this far apart.
const LABEL_STEP: f64 = 14.0;
/// About the advance of a character of a label.
const LABEL_ADVANCE: f64 = 7.2;

/// Where costs and errors lie in the picture: cost runs to the right on a logarithmic scale, error upwards on a linear one
/// from zero.
struct Scale {
    /// The logarithms of the costs at the left edge and at the right.
    x_min: f64,
    x_max: f64,
    error_step: f64,
    error_max: f64,
}

impl Scale {
    /// That shows every point, of which there is one at least.
    fn of(points: &[&Point]) -> Self {
        let fold = |f: fn(f64, f64) -> f64, start: f64| points.iter().map(|p| p.cost).fold(start, f);
        let (cost_min, cost_max) = (fold(f64::min, f64::INFINITY), fold(f64::max, 0.0));
        let worst = points.iter().map(|p| p.error).fold(0.0, f64::max);
        let error_step = nice_step(worst / 4.0);
        let error_max = error_step * (worst / error_step * 1.02).ceil().max(1.0);
        // A margin of a factor of 1.6 either side leaves labels room and gives a lone point a scale.
        Self { x_min: (cost_min / 1.6).ln(), x_max: (cost_max * 1.6).ln(), error_step, error_max }
    }

    fn x_of(&self, cost: f64) -> f64 {
        LEFT + (cost.ln() - self.x_min) / (self.x_max - self.x_min) * (WIDTH - LEFT - RIGHT)
    }

    fn y_of(&self, error: f64) -> f64 {
        HEIGHT - BOTTOM - error / self.error_max * (HEIGHT - TOP - BOTTOM)
    }
}

/// The points over a grid, each a link to its row, with the front of the best. `None` without a point.
pub(super) fn scatter_svg(points: &[Point], axes: Axes) -> Option<String> {
    let points: Vec<&Point> =
        points.iter().filter(|p| p.cost > 0.0 && p.cost.is_finite() && p.error.is_finite()).collect();
    if points.is_empty() {
        return None;
    }
    let scale = Scale::of(&points);
    let mut svg = format!(
        "<svg class=\"scatter\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\"><title>{} against {}, one point for each \
         technique; lower left is better</title>",
        axes.error, axes.cost
    );
    draw_grid(&mut svg, &scale);
    draw_axes(&mut svg, &axes);
    let front = front_of(&points);
    if front.len() > 1 {
        let at = |p: &&Point| format!("{:.1},{:.1}", scale.x_of(p.cost), scale.y_of(p.error));
        let steps: Vec<String> = front.iter().map(at).collect();
        let _ = write!(svg, "<polyline class=\"front\" points=\"{}\"/>", steps.join(" "));
    }
    draw_points(&mut svg, &scale, &axes, &points, &front);
    Some(svg + "</svg>")
}

/// Lines at round errors and costs, with their numbers.
fn draw_grid(svg: &mut String, scale: &Scale) {
    let (floor, ceiling) = (scale.y_of(0.0), scale.y_of(scale.error_max));
    for i in 0..=(scale.error_max / scale.error_step).round() as u32 {
        let error = f64::from(i) * scale.error_step;
        let y = scale.y_of(error);
        let text = if i == 0 { "0".into() } else { short(error) };
        let _ = write!(
            svg,
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"tick\" \
             x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            WIDTH - RIGHT,
            LEFT - 8.0,
            y + 4.0
        );
    }
    for cost in log_ticks(scale.x_min.exp(), scale.x_max.exp()) {
        let x = scale.x_of(cost);
        let _ = write!(
            svg,
            "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{ceiling:.1}\" y2=\"{floor:.1}\"/><text \
             class=\"tick\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            floor + 18.0,
            short(cost)
        );
    }
}

/// What the axes mean.
fn draw_axes(svg: &mut String, axes: &Axes) {
    let _ = write!(
        svg,
        "<text class=\"axis\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{} →</text>\
         <text class=\"axis\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" transform=\"rotate(-90)\">error, {} \
          →</text>",
        WIDTH - RIGHT,
        HEIGHT - 8.0,
        axes.cost,
        -TOP,
        14.0,
        axes.error
    );
}

/// A circle and a name for each point.
fn draw_points(svg: &mut String, scale: &Scale, axes: &Axes, points: &[&Point], front: &[&Point]) {
    let places = label_positions(points, |cost| scale.x_of(cost), |error| scale.y_of(error));
    for (point, (label_x, label_y, anchor)) in points.iter().zip(places) {
        let is_front = front.iter().any(|p| std::ptr::eq(*p, *point));
        let _ = write!(
            svg,
            "<a href=\"#{}\"><title>{}: {} {}, {} {}</title><circle class=\"{}\" cx=\"{:.1}\" cy=\"{:.1}\" \
             r=\"5.5\"/>\
             <text class=\"label\" x=\"{label_x:.1}\" y=\"{label_y:.1}\" text-anchor=\"{anchor}\">{}</text></a>",
            escape(&point.anchor),
            escape(&point.name),
            axes.error,
            short(point.error),
            three_figures(point.cost),
            axes.cost_unit,
            if is_front { "point best" } else { "point" },
            scale.x_of(point.cost),
            scale.y_of(point.error),
            escape(&point.name),
        );
    }
}

/// The points that no other beats in both cost and error, cheapest first.
pub(super) fn front(points: &[Point]) -> Vec<&Point> {
    front_of(&points.iter().collect::<Vec<_>>())
}

fn front_of<'a>(points: &[&'a Point]) -> Vec<&'a Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.error.total_cmp(&b.error)));
    let mut least = f64::INFINITY;
    sorted.retain(|p| {
        let is_front = p.error < least;
        least = least.min(p.error);
        is_front
    });
    sorted
}

/// Beside each point, on the side that has room, moved up or down until it hides no other label.
fn label_positions(
    points: &[&Point],
    x_of: impl Fn(f64) -> f64,
    y_of: impl Fn(f64) -> f64,
) -> Vec<(f64, f64, &'static str)> {
    const GAP: f64 = 10.0;
    let mut taken: Vec<(f64, f64, f64)> = Vec::new();
    let mut positions = Vec::new();
    for point in points {
        let width = point.name.chars().count() as f64 * LABEL_ADVANCE;
        let (x, y) = (x_of(point.cost), y_of(point.error));
        let to_right = x + GAP + width < WIDTH;
        let (left, anchor) = if to_right { (x + GAP, "start") } else { (x - GAP - width, "end") };
        let is_free =
            |y: f64| taken.iter().all(|&(l, r, other)| r < left || left + width < l || (other - y).abs() >= LABEL_STEP);
        // 0, +1, −1, +2, … half steps away.
        let offsets = (0..40).map(|i| f64::from((i + 1) / 2) * if i % 2 == 0 { -0.5 } else { 0.5 } * LABEL_STEP);
        let in_frame = |y: &f64| (TOP..HEIGHT - BOTTOM).contains(y);
        let label_y = offsets.map(|d| y + 4.0 + d).filter(in_frame).find(|&y| is_free(y)).unwrap_or(y + 4.0);
        taken.push((left, left + width, label_y));
        positions.push((if to_right { left } else { x - GAP }, label_y, anchor));
    }
    positions
}

/// 1, 2 or 5 times a power of ten, at least `v`.
fn nice_step(v: f64) -> f64 {
    if v <= 0.0 {
        return 0.01;
    }
    let power = 10_f64.powf(v.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|&step| step >= v * 0.999_999).unwrap_or(10.0 * power)
}

/// 1, 2 and 5 times powers of ten in a range; the powers alone where that would be many.
fn log_ticks(min: f64, max: f64) -> Vec<f64> {
    let powers = (min.log10().floor() as i32)..=(max.log10().ceil() as i32);
    let factors: &[f64] = if max / min > 300.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all = powers.flat_map(|power| factors.iter().map(move |factor| factor * 10_f64.powi(power)));
    all.filter(|&tick| tick >= min && tick <= max).collect()
}

/// Three figures without trailing zeros.
fn short(v: f64) -> String {
    let text = three_figures(v);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: Axes = Axes { cost: "milliseconds a frame", cost_unit: "ms", error: "rmse" };

    fn point(name: &str, cost: f64, error: f64) -> Point {
        Point { name: name.into(), anchor: name.into(), cost, error }
    }

    #[test]
    fn the_front_is_what_nothing_beats_in_both() {
        let all = [point("a", 1.0, 0.1), point("b", 2.0, 0.2), point("c", 3.0, 0.05), point("d", 3.0, 0.06)];
        let names: Vec<_> = front(&all).iter().map(|p| p.name.clone()).collect();
        assert_eq!(names, ["a", "c"]);
    }

    #[test]
    fn labels_do_not_hide_each_other() {
        let all: Vec<Point> = (0..6).map(|i| point("technique", 1.0 + 0.01 * f64::from(i), 0.1)).collect();
        let refs: Vec<&Point> = all.iter().collect();
        let mut rows: Vec<f64> = label_positions(&refs, |_| 100.0, |_| 200.0).iter().map(|p| p.1).collect();
        rows.sort_by(f64::total_cmp);
        assert!(rows.windows(2).all(|pair| pair[1] - pair[0] >= LABEL_STEP));
    }

    #[test]
    fn odd_input_gives_a_drawing_or_nothing() {
        assert!(scatter_svg(&[], AXES).is_none());
        assert!(scatter_svg(&[point("a", 0.0, 0.1), point("b", f64::NAN, 0.1)], AXES).is_none());
        for lone in [point("a", 1.0, 0.0), point("<b>", 1e-4, 1e-9), point("c", 1e5, 0.7)] {
            let svg = scatter_svg(&[lone], AXES).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("<b>"), "{svg}");
        }
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(log_ticks(0.7, 30.0), [1.0, 2.0, 5.0, 10.0, 20.0]);
        assert_eq!(log_ticks(0.1, 1000.0), [0.1, 1.0, 10.0, 100.0, 1000.0]);
        assert_eq!([0.03, 0.011, 0.0].map(nice_step), [0.05, 0.02, 0.01]);
    }
}
