//! Comparison of a browser's masks with the system's, as a table.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Maximum mean of |ΔV| over a mask between two devices.
const MAX_DIFFERENCE: f64 = 1e-3;

/// Result of a case.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    /// Name of the case: `overlap pcss filter=false`.
    name: String,
    /// Mean of |ΔV| over the mask.
    difference: f64,
}

impl Row {
    fn scene(&self) -> &str {
        self.name.split(' ').next().unwrap_or_default()
    }

    fn technique(&self) -> &str {
        self.name.split(' ').nth(1).unwrap_or_default()
    }

    /// Returns the parameters that are not at their defaults.
    fn settings(&self) -> String {
        self.name.split(' ').skip(2).collect::<Vec<_>>().join(" ")
    }
}

/// Compares every mask of each folder's `cases.txt` with the browser's, and writes a table per folder. Only the first folder decides:
/// other adapters may rasterise triangle corners differently.
///
/// # Errors
/// Masks that are missing, contain no shadow, or differ from the first folder's.
pub fn compare(natives: &[PathBuf], web: &Path, adapter: &str, table: &Path) -> Result<(), String> {
    let mut written = String::new();
    let mut measures = Vec::new();
    for native in natives {
        let (text, count, faults) = compare_with(native, web, adapter)?;
        let _ = writeln!(written, "{text}");
        measures.push((count, faults));
    }
    std::fs::write(table, &written).map_err(|error| format!("{}: {error}", table.display()))?;
    eprintln!("{written}");
    match measures.first() {
        Some((count, faults)) if *count > 0 && faults.is_empty() => {
            eprintln!("xtask: {count} masks agree; the table is {}", table.display());
            Ok(())
        }
        Some((count, faults)) if !faults.is_empty() => {
            Err(format!("{} masks of {count} differ or are missing: {}", faults.len(), faults.join("; ")))
        }
        _ => Err("no masks were compared".into()),
    }
}

/// Returns the table of one folder, its number of masks, and faults: masks that differ or are missing.
fn compare_with(native: &Path, web: &Path, adapter: &str) -> Result<(String, usize, Vec<String>), String> {
    let cases = native.join("cases.txt");
    let text = std::fs::read_to_string(&cases).map_err(|error| format!("{}: {error}", cases.display()))?;
    let (native_adapter, names) = text.split_once('\n').unwrap_or((&text, ""));
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for (index, name) in names.lines().enumerate() {
        let file = format!("{index}.f32");
        match read(&native.join(&file)).and_then(|ours| difference(&ours, &read(&web.join(&file))?)) {
            Ok(difference) => {
                if difference > MAX_DIFFERENCE {
                    faults.push(format!("{name}: mean |ΔV| {difference:.2e}"));
                }
                rows.push(Row { name: name.to_owned(), difference });
            }
            Err(why) => faults.push(format!("{name}: {why}")),
        }
    }
    Ok((markdown(&rows, native_adapter, adapter), rows.len(), faults))
}

fn read(file: &Path) -> Result<Vec<f32>, String> {
    let bytes = std::fs::read(file).map_err(|_| "it is missing".to_owned())?;
    Ok(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
}

/// Returns the mean of |ΔV|; an error if the masks cannot be compared or contain no shadow.
fn difference(ours: &[f32], theirs: &[f32]) -> Result<f64, String> {
    if ours.len() != theirs.len() || ours.is_empty() {
        return Err(format!("{} and {} pixels", ours.len(), theirs.len()));
    }
    let low = ours.iter().copied().fold(f32::INFINITY, f32::min);
    let high = ours.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if high - low < 0.5 {
        return Err(format!("it has no shadow: visibility is {low} to {high}"));
    }
    let sum: f64 = ours.iter().zip(theirs).map(|(a, b)| f64::from((a - b).abs())).sum();
    let mean = sum / ours.len() as f64;
    if mean.is_finite() { Ok(mean) } else { Err("visibility is not a number".into()) }
}

/// Returns a line per technique: its defaults on each scene, and its worst choice.
fn markdown(rows: &[Row], native: &str, web: &str) -> String {
    let mut scenes: Vec<&str> = Vec::new();
    let mut techniques: Vec<&str> = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene()) {
            scenes.push(row.scene());
        }
        if !techniques.contains(&row.technique()) {
            techniques.push(row.technique());
        }
    }
    let mut text = format!("System: {native}. Browser: {}.\n\n", web.replace('\n', ", "));
    let _ = writeln!(text, "| technique | {} | worst choice | |", scenes.join(" | "));
    let _ = writeln!(text, "|---|{}---:|---|", "---:|".repeat(scenes.len()));
    for technique in techniques {
        let own = || rows.iter().filter(|row| row.technique() == technique);
        let plain = |scene: &&str| {
            let row = own().find(|row| row.scene() == *scene && row.settings().is_empty());
            row.map_or("–".to_owned(), |row| scientific(row.difference))
        };
        let cells: Vec<String> = scenes.iter().map(plain).collect();
        let worst = own().filter(|row| !row.settings().is_empty()).max_by(|a, b| a.difference.total_cmp(&b.difference));
        let worst =
            worst.map_or("– | ".to_owned(), |row| format!("{} | `{}`", scientific(row.difference), row.settings()));
        let _ = writeln!(text, "| `{technique}` | {} | {worst} |", cells.join(" | "));
    }
    text
}

fn scientific(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_without_shadow_are_not_compared() {
        assert_eq!(difference(&[0.0, 1.0], &[0.5, 1.0]), Ok(0.25));
        assert!(difference(&[1.0, 1.0], &[1.0, 1.0]).is_err());
        assert!(difference(&[0.0, 1.0], &[0.0]).is_err());
        assert!(difference(&[0.0, 1.0], &[f32::NAN, 1.0]).is_err());
        assert!(difference(&[], &[]).is_err());
    }

    #[test]
    fn a_technique_is_a_line() {
        let row = |name: &str, difference| Row { name: name.to_owned(), difference };
        let rows = [row("a pcss", 0.0), row("b pcss", 1e-4), row("a pcss x=1", 2e-5), row("a pcss y=2 z=3", 3e-5)];
        let text = markdown(&rows, "ours", "theirs");
        assert!(text.contains("| `pcss` | 0 | 1.0e-4 | 3.0e-5 | `y=2 z=3` |"), "{text}");
    }
}
