//! Plain tables on stdout.

use crate::stdout;

/// Prints rows of cells; the first row is the heading. Columns fit their widest cell, and numeric columns are
/// right-aligned. The last cell of a row that is shorter than others is a note, which extends over the remaining columns.
pub fn print(rows: &[Vec<String>]) {
    stdout::write(format_args!("{}", layout(rows)));
}

fn layout(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| cell(row, column, columns)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    // Right-aligned numbers are easy to compare.
    let is_number = |cell: &String| cell.is_empty() || cell == "–" || cell.parse::<f64>().is_ok();
    let numeric: Vec<bool> = (0..columns)
        .map(|column| rows.len() > 1 && rows[1..].iter().filter_map(|row| cell(row, column, columns)).all(is_number))
        .collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).zip(&numeric).map(|((cell, &width), &numeric)| {
            if numeric { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}

/// Returns a row's cell in one of `columns` columns; `None` for a note.
fn cell(row: &[String], column: usize, columns: usize) -> Option<&String> {
    let is_note = row.len() < columns && column + 1 == row.len();
    row.get(column).filter(|_| !is_note)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_to_the_right() {
        let rows = [["name", "ms"], ["hard", "1.25"], ["multi_view", "120.5"]];
        let rows: Vec<Vec<String>> = rows.iter().map(|row| row.map(str::to_owned).to_vec()).collect();
        assert_eq!(layout(&rows), "name           ms\nhard         1.25\nmulti_view  120.5\n");
    }

    #[test]
    fn notes_widen_no_column() {
        let rows =
            [&["name", "rmse", "ms"][..], &["hard", "0.2", "1.25"], &["vsm", "skipped: it needs more than there is"]];
        let rows: Vec<Vec<String>> =
            rows.iter().map(|row| row.iter().map(|cell| (*cell).to_owned()).collect()).collect();
        let expected = "name  rmse    ms\nhard   0.2  1.25\nvsm   skipped: it needs more than there is\n";
        assert_eq!(layout(&rows), expected);
    }
}
