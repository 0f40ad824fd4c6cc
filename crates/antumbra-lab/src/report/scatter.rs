//! Scatter plot of error against cost as inline SVG: a point per technique, and the Pareto front as a line.

use std::fmt::Write;

use super::html::{escape, three_figures};

/// A technique as a point.
pub(super) struct Point {
    pub(super) name: String,
    /// Anchor of its section in the page, without `#`.
    pub(super) anchor: String,
    /// Cost, above zero.
    pub(super) cost: f64,
    pub(super) error: f64,
}

/// Labels of a plot's axes.
#[derive(Clone, Copy)]
pub(super) struct Axes {
    /// Cost, with its unit: `milliseconds a frame`.
    pub(super) cost: &'static str,
    /// Unit of the cost: `ms`.
    pub(super) cost_unit: &'static str,
    /// Error: `rmse`.
    pub(super) error: &'static str,
}

/// Size and margins of the drawing in its own units; the page scales it.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 380.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 18.0;
const BOTTOM: f64 = 46.0;
/// Radius of a point.
const RADIUS: f64 = 5.5;
/// Minimum distance between the baselines of labels.
const LABEL_STEP: f64 = 14.0;
/// Height of a label above and below its baseline.
const LABEL_RISE: f64 = 10.5;
const LABEL_DROP: f64 = 3.5;
/// Approximate advance width of a label's character.
const LABEL_ADVANCE: f64 = 7.2;
/// Margin on either side of the points, as a factor. It leaves space for labels, and always contains a tick.
const MARGIN: f64 = 1.6;

/// Logarithmic scales: cost to the right, error upwards. An error of zero is at the lower edge.
pub(super) struct Scale {
    costs: (f64, f64),
    errors: (f64, f64),
}

impl Scale {
    /// View box of the drawing.
    pub(super) const VIEW_BOX: &'static str = "0 0 640 380";

    /// Returns the scale that shows every point.
    pub(super) fn of(points: &[&Point]) -> Self {
        let range = |values: &dyn Fn(&Point) -> f64| {
            let positive = points.iter().map(|point| values(point)).filter(|value| *value > 0.0);
            let (least, most) = positive.fold((f64::INFINITY, 0.0_f64), |(a, b), value| (a.min(value), b.max(value)));
            if most > 0.0 { (least / MARGIN, most * MARGIN) } else { (1.0 / MARGIN, MARGIN) }
        };
        Self { costs: range(&|point| point.cost), errors: range(&|point| point.error) }
    }

    pub(super) fn x_of(&self, cost: f64) -> f64 {
        LEFT + share(self.costs, cost) * (WIDTH - LEFT - RIGHT)
    }

    pub(super) fn y_of(&self, error: f64) -> f64 {
        HEIGHT - BOTTOM - share(self.errors, error) * (HEIGHT - TOP - BOTTOM)
    }
}

/// Returns the position of a value in a range on a logarithmic scale, 0 to 1.
fn share((min, max): (f64, f64), value: f64) -> f64 {
    ((value.max(min) / min).ln() / (max / min).ln()).min(1.0)
}

/// Plots the points over a grid, each a link to its row, with the Pareto front. `None` without a point.
pub(super) fn scatter_svg(points: &[Point], axes: Axes) -> Option<String> {
    let points: Vec<&Point> =
        points.iter().filter(|p| p.cost > 0.0 && p.cost.is_finite() && p.error.is_finite()).collect();
    if points.is_empty() {
        return None;
    }
    let scale = Scale::of(&points);
    let mut svg = format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0} against {1}\"><svg class=\"scatter\" viewBox=\"{2}\" role=\"img\"><title>{0} against {1}, both \
         logarithmic, one point for each technique; lower left is better</title>",
        axes.error,
        axes.cost,
        Scale::VIEW_BOX
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
    Some(svg + "</svg></div>")
}

/// Draws grid lines at round errors and costs, with their numbers.
pub(super) fn draw_grid(svg: &mut String, scale: &Scale) {
    let (floor, ceiling) = (HEIGHT - BOTTOM, TOP);
    for error in log_ticks(scale.errors) {
        let y = scale.y_of(error);
        let _ = write!(
            svg,
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"tick\" \
             x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 8.0,
            y + 4.0,
            short(error)
        );
    }
    for cost in log_ticks(scale.costs) {
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

/// Draws the labels of the axes.
pub(super) fn draw_axes(svg: &mut String, axes: &Axes) {
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

/// Draws the name of each point beside it.
pub(super) fn name_points(svg: &mut String, scale: &Scale, points: &[&Point]) {
    for (point, named) in points.iter().zip(named_points(scale, points)) {
        svg.push_str(&named.text(&point.name));
    }
}

/// Position of a point and of its name.
struct NamedPoint {
    x: f64,
    y: f64,
    label_x: f64,
    label_y: f64,
    anchor: &'static str,
}

impl NamedPoint {
    fn text(&self, name: &str) -> String {
        let Self { label_x, label_y, anchor, .. } = self;
        format!(
            "<text class=\"label\" x=\"{label_x:.1}\" y=\"{label_y:.1}\" text-anchor=\"{anchor}\">{}</text>",
            escape(name)
        )
    }
}

/// Returns the positions of points and names. Names cover neither names nor points if there is space.
fn named_points(scale: &Scale, points: &[&Point]) -> Vec<NamedPoint> {
    let centers: Vec<(f64, f64)> =
        points.iter().map(|point| (scale.x_of(point.cost), scale.y_of(point.error))).collect();
    let widths: Vec<f64> = points.iter().map(|point| point.name.chars().count() as f64 * LABEL_ADVANCE).collect();
    let labels = place_labels(&centers, &widths);
    let named = |((x, y), label): ((f64, f64), Label)| {
        let (label_x, anchor) = if label.left > x { (label.left, "start") } else { (label.right, "end") };
        NamedPoint { x, y, label_x, label_y: label.baseline, anchor }
    };
    centers.into_iter().zip(labels).map(named).collect()
}

/// Draws a circle and a name for each point.
fn draw_points(svg: &mut String, scale: &Scale, axes: &Axes, points: &[&Point], front: &[&Point]) {
    for (point, named) in points.iter().zip(named_points(scale, points)) {
        let NamedPoint { x, y, label_x, label_y, .. } = named;
        let leader = if (label_y - LABEL_DROP - y).abs() > LABEL_STEP / 2.0 {
            format!(
                "<line class=\"leader\" x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{label_x:.1}\" y2=\"{:.1}\"/>",
                label_y - 4.0
            )
        } else {
            String::new()
        };
        let is_front = front.iter().any(|p| std::ptr::eq(*p, *point));
        let _ = write!(
            svg,
            "<a href=\"#{}\"><title>{}: {} {}, {} {}</title>{leader}<circle class=\"{}\" cx=\"{x:.1}\" cy=\"{y:.1}\" \
             r=\"{RADIUS}\"/>{}</a>",
            escape(&point.anchor),
            escape(&point.name),
            axes.error,
            short(point.error),
            three_figures(point.cost),
            axes.cost_unit,
            if is_front { "point best" } else { "point" },
            named.text(&point.name),
        );
    }
}

/// Returns the Pareto front of cost and error, cheapest first.
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

/// Box of a label.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Label {
    left: f64,
    right: f64,
    baseline: f64,
}

impl Label {
    fn meets(&self, other: &Self) -> bool {
        let is_apart = self.right < other.left || other.right < self.left;
        !is_apart && (self.baseline - other.baseline).abs() < LABEL_STEP
    }

    fn covers(&self, (x, y): (f64, f64)) -> bool {
        let is_beside = x + RADIUS < self.left || self.right < x - RADIUS;
        let is_above_or_below = y + RADIUS < self.baseline - LABEL_RISE || self.baseline + LABEL_DROP < y - RADIUS;
        !is_beside && !is_above_or_below
    }
}

/// Places labels beside their points, moved up or down until they cover no other label and no point. Without a free place,
/// a label is to the right of its point.
fn place_labels(centers: &[(f64, f64)], widths: &[f64]) -> Vec<Label> {
    const GAP: f64 = 10.0;
    let mut placed: Vec<Label> = Vec::new();
    for (&(x, y), &width) in centers.iter().zip(widths) {
        let at = |step: i32, is_right: bool| {
            let left = if is_right { x + GAP } else { x - GAP - width };
            Label { left, right: left + width, baseline: y + 4.0 + f64::from(step) * 0.5 * LABEL_STEP }
        };
        let is_free = |label: &Label| {
            let is_inside = label.left >= LEFT && label.right <= WIDTH;
            is_inside
                && (TOP..HEIGHT - BOTTOM).contains(&label.baseline)
                && placed.iter().all(|other| !label.meets(other))
                && centers.iter().all(|center| !label.covers(*center))
        };
        // Offsets of 0, −1, 1, −2, … half steps, on the right side first.
        let steps = (0..40).map(|i| if i % 2 == 0 { i / 2 } else { -(i + 1) / 2 });
        let label = steps.flat_map(|step| [at(step, true), at(step, false)]).find(is_free);
        placed.push(label.unwrap_or(at(0, true)));
    }
    placed
}

/// Returns 1, 2 and 5 times the powers of ten in a range; only the powers if there would be too many.
fn log_ticks((min, max): (f64, f64)) -> Vec<f64> {
    let powers = (min.log10().floor() as i32)..=(max.log10().ceil() as i32);
    let factors: &[f64] = if max / min > 300.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all = powers.flat_map(|power| factors.iter().map(move |factor| factor * 10_f64.powi(power)));
    all.filter(|&tick| tick >= min && tick <= max).collect()
}

/// Formats three figures without trailing zeros.
fn short(v: f64) -> String {
    let text = three_figures(v);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: Axes = Axes { cost: "milliseconds per frame", cost_unit: "ms", error: "rmse" };

    fn point(name: &str, cost: f64, error: f64) -> Point {
        Point { name: name.into(), anchor: name.into(), cost, error }
    }

    #[test]
    fn the_front_has_the_points_that_no_other_dominates() {
        let all = [point("a", 1.0, 0.1), point("b", 2.0, 0.2), point("c", 3.0, 0.05), point("d", 3.0, 0.06)];
        let names: Vec<_> = front(&all).iter().map(|p| p.name.clone()).collect();
        assert_eq!(names, ["a", "c"]);
    }

    #[test]
    fn labels_cover_no_label_and_no_point() {
        let crowd = [(100.0, 200.0), (103.0, 201.0), (104.0, 196.0), (140.0, 200.0), (630.0, 30.0), (620.0, 25.0)];
        let labels = place_labels(&crowd, &[70.0; 6]);
        for (i, label) in labels.iter().enumerate() {
            assert!(labels[..i].iter().all(|other| !label.meets(other)), "{i}: {labels:?}");
            assert!(crowd.iter().all(|center| !label.covers(*center)), "{i}: {labels:?}");
            assert!(label.left >= LEFT && label.right <= WIDTH, "{i}: {labels:?}");
        }
        assert!(labels[0].meets(&labels[0]) && labels[0].covers((labels[0].left, labels[0].baseline)));
    }

    #[test]
    fn errors_are_on_a_logarithmic_scale() {
        let all = [point("a", 1.0, 0.1), point("b", 2.0, 0.01), point("c", 3.0, 0.001), point("d", 4.0, 0.0)];
        let scale = Scale::of(&all.iter().collect::<Vec<_>>());
        let [a, b, c, d] = all.each_ref().map(|point| scale.y_of(point.error));
        assert!(((b - a) - (c - b)).abs() < 1e-9 && c > b && b > a, "{a} {b} {c}");
        assert!(d > c && d == HEIGHT - BOTTOM, "{d}");
    }

    #[test]
    fn plots_of_degenerate_input_are_valid_or_absent() {
        assert!(scatter_svg(&[], AXES).is_none());
        assert!(scatter_svg(&[point("a", 0.0, 0.1), point("b", f64::NAN, 0.1)], AXES).is_none());
        for lone in [point("a", 1.0, 0.0), point("<b>", 1e-4, 1e-9), point("c", 1e5, 0.7)] {
            let svg = scatter_svg(&[lone], AXES).unwrap();
            assert!(svg.contains("class=\"tick\""), "{svg}");
            assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("<b>"), "{svg}");
        }
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(log_ticks((0.7, 30.0)), [1.0, 2.0, 5.0, 10.0, 20.0]);
        assert_eq!(log_ticks((0.1, 1000.0)), [0.1, 1.0, 10.0, 100.0, 1000.0]);
        // A single point has a tick.
        for value in [1.0, 2.1, 3.2, 4.9, 7.9] {
            assert!(!log_ticks((value / MARGIN, value * MARGIN)).is_empty(), "{value}");
        }
    }
}
