//! Section of a page that compares its rows with those of another run.

use std::fmt::Write;

use super::html::{escape, three_figures};
use crate::baseline::{BaselineComparison, DIFFERENCES, PairedRow};

/// Returns a section with ratios of time and differences of error.
pub(super) fn baseline_section(against: &BaselineComparison) -> String {
    let mut html = format!(
        "<section id=\"baseline\" aria-labelledby=\"baseline-title\"><h2 id=\"baseline-title\">Comparison with another \
         run</h2><p class=\"note\">{}.</p><div class=\"scroll\" tabindex=\"0\" role=\"region\" \
         aria-labelledby=\"baseline-title\"><table class=\"numbers\"><thead><tr>",
        escape(&against.summary())
    );
    let heads = ["technique", "ms", "baseline ms", "ratio"].map(str::to_owned).into_iter();
    for head in heads.chain(DIFFERENCES.map(|key| format!("{key}, difference"))) {
        let _ = write!(html, "<th scope=\"col\">{head}</th>");
    }
    html += "</tr></thead><tbody>";
    against.rows.iter().for_each(|row| html += &line(row));
    html + "</tbody></table></div></section>"
}

fn line(row: &PairedRow) -> String {
    let ms = |value: Option<f64>| value.map_or_else(|| "–".into(), three_figures);
    let mut cells = vec![ms(row.ms), ms(row.baseline_ms), ms(row.ratio)];
    cells.extend(DIFFERENCES.map(|key| row.difference(key).map_or_else(|| "–".into(), |v| format!("{v:+.4}"))));
    let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
    format!("<tr><th scope=\"row\">{}</th>{cells}</tr>", escape(&row.name))
}
