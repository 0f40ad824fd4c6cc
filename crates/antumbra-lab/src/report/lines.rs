//! Line plot of errors over a number, as inline SVG.

use std::fmt::Write;

use super::html::{escape, three_figures};
use super::scatter::{Axes, Point, Scale, draw_axes, draw_grid, name_points};

/// A series of the plot.
pub(super) struct Line {
    pub(super) name: String,
    /// Number (above zero) and error of each point.
    pub(super) points: Vec<(f64, f64)>,
}

/// Stroke styles, used in turn.
const STROKES: [&str; 4] = ["solid", "dashed", "dotted", "mixed"];

/// Plots lines on logarithmic scales, each named at its last point. `None` unless a line has two points.
pub(super) fn lines_svg(lines: &[Line], axes: Axes) -> Option<String> {
    let drawable = |(at, error): &(f64, f64)| *at > 0.0 && at.is_finite() && error.is_finite();
    let points_of = |line: &Line| -> Vec<Point> {
        let mut points: Vec<(f64, f64)> = line.points.iter().copied().filter(drawable).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let point = |(cost, error)| Point { name: line.name.clone(), anchor: String::new(), cost, error };
        points.into_iter().map(point).collect()
    };
    let lines: Vec<Vec<Point>> = lines.iter().map(points_of).filter(|points| points.len() > 1).collect();
    if lines.is_empty() {
        return None;
    }
    let scale = Scale::of(&lines.iter().flatten().collect::<Vec<_>>());
    let mut svg = format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0} over {1}\"><svg class=\"scatter\" viewBox=\"{2}\" \
         role=\"img\"><title>{0} over {1}, both logarithmic; lower is better</title>",
        axes.error,
        escape(axes.cost),
        Scale::VIEW_BOX
    );
    draw_grid(&mut svg, &scale);
    draw_axes(&mut svg, &axes);
    for (points, stroke) in lines.iter().zip(STROKES.iter().cycle()) {
        let at = |p: &Point| format!("{:.1},{:.1}", scale.x_of(p.cost), scale.y_of(p.error));
        let places: Vec<String> = points.iter().map(at).collect();
        let _ = write!(svg, "<polyline class=\"series {stroke}\" points=\"{}\"/>", places.join(" "));
        for point in points {
            let _ = write!(
                svg,
                "<circle class=\"point\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\"><title>{}: {} at {}</title></circle>",
                scale.x_of(point.cost),
                scale.y_of(point.error),
                escape(&point.name),
                three_figures(point.error),
                three_figures(point.cost)
            );
        }
    }
    name_points(&mut svg, &scale, &lines.iter().filter_map(|points| points.last()).collect::<Vec<_>>());
    Some(svg + "</svg></div>")
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: Axes = Axes { cost: "c", cost_unit: "", error: "rmse" };

    fn line(name: &str, points: &[(f64, f64)]) -> Line {
        Line { name: name.into(), points: points.to_vec() }
    }

    #[test]
    fn lines_go_from_the_least_number_to_the_largest_and_are_named() {
        let lines =
            [line("μ < 20", &[(20.0, 0.01), (5.0, 0.1), (10.0, 0.03)]), line("other", &[(5.0, 0.2), (20.0, 0.2)])];
        let svg = lines_svg(&lines, AXES).unwrap();
        let drawn = svg.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        let x: Vec<f64> = drawn.split(' ').map(|at| at.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(x.len() == 3 && x[0] < x[1] && x[1] < x[2], "{drawn}");
        assert!(svg.contains("μ &lt; 20") && svg.contains("dashed") && svg.contains(">c →"), "{svg}");
    }

    #[test]
    fn lines_with_fewer_than_two_points_are_not_drawn() {
        assert!(lines_svg(&[], AXES).is_none());
        assert!(lines_svg(&[line("a", &[(1.0, 0.1)]), line("b", &[(0.0, 0.1), (f64::NAN, 0.1)])], AXES).is_none());
    }
}
