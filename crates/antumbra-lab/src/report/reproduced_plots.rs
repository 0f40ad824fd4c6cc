//! Plots of an exhibit's rows: error over time, and error over a parameter in which rows differ.

use super::lines::{Line, lines_svg};
use super::scatter::{Axes, Point, scatter_svg};
use crate::reproduce::{ExhibitResult, Form, Measured, Outcome, RowResult};

/// Returns the possible plots as HTML.
pub(super) fn plots(result: &ExhibitResult) -> String {
    let caption = |text: &str, svg: String| format!("<p class=\"note\">{text}</p>{svg}");
    let over_time =
        scatter_svg(&over_time(result), TIME).filter(|_| result.rows.iter().any(|one| one.row.is_timed_too));
    let over_time = over_time.map(|svg| caption("Error against time, one point for each row that has both.", svg));
    let over_number = over_number(result)
        .map(|svg| caption("Error against the varied quantity, one line for each series and form.", svg));
    [over_time, over_number].into_iter().flatten().collect()
}

const TIME: Axes = Axes { cost: "milliseconds per frame", cost_unit: "ms", error: "rmse" };

fn measured(one: &RowResult) -> Option<&Measured> {
    match &one.outcome {
        Outcome::Measured(measured) => Some(measured),
        _ => None,
    }
}

/// Returns `name`, with `, ours` or `, as published` appended if there are two forms.
fn named(result: &ExhibitResult, one: &RowResult, name: &str) -> String {
    let has_forms = one.row.forms(result.paper).len() > 1;
    match one.form {
        Form::Ours => format!("{name}, ours"),
        Form::Published if has_forms => format!("{name}, as published"),
        Form::Published => name.to_owned(),
    }
}

fn over_time(result: &ExhibitResult) -> Vec<Point> {
    let point = |one: &RowResult| {
        let Measured { rmse: Some(error), ms: Some(cost), .. } = *measured(one)? else { return None };
        let anchor = result.exhibit.id.to_owned();
        Some(Point { name: named(result, one, one.row.what), anchor, cost, error })
    };
    result.rows.iter().filter_map(point).collect()
}

fn over_number(result: &ExhibitResult) -> Option<String> {
    let mut lines: Vec<Line> = Vec::new();
    let mut axis = None;
    for one in &result.rows {
        let (Some(place), Some(Measured { rmse: Some(rmse), .. })) = (one.row.plotted, measured(one)) else { continue };
        axis = Some(place.axis);
        let name = named(result, one, place.line);
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push((place.at, *rmse)),
            None => lines.push(Line { name, points: vec![(place.at, *rmse)] }),
        }
    }
    lines_svg(&lines, Axes { cost: axis?, cost_unit: "", error: "rmse" })
}
