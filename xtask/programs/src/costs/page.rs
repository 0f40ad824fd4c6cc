//! The page `bench/gpu-cost.md`.

use super::frames::{Frame, SCENE, SIZE};
use super::limits::{Exceptions, MAX_REGISTERS};
use super::log::Log;
use super::table::{Counts, Name, Row, Table};

/// Number of registers above which a pipeline is listed.
const MANY_REGISTERS: u32 = 96;

/// Architecture and year of a family.
pub struct Title(pub &'static str);

/// Returns the page, from a log for each family and the frames of each technique.
///
/// # Errors
/// If a technique draws with a pipeline that was not counted.
pub fn page(logs: &[(Title, Log)], frames: &[Frame], exceptions: &Exceptions) -> Result<String, String> {
    let families: Vec<String> = logs.iter().map(|(title, log)| format!("{} ({})", log.table.family, title.0)).collect();
    let driver = logs.first().map_or("", |(_, log)| log.table.driver.as_str());
    let mut text = format!(
        "# Static costs\n\n\
         Registers, waves, instructions and workgroup memory of every pipeline, as the compiler of {driver} counts them for\n\
         {}. `cargo xtask gpu-cost` writes this page. It needs no GPU: nothing is run, and nothing\n\
         is timed. Compare a pipeline with its own past, by `cargo xtask gpu-cost --diff TABLE`. Other vendors' compilers count otherwise.\n\n\
         - Registers: vector registers of a thread. With more than {MAX_REGISTERS}, too few waves remain to hide loads, and \
         `cargo xtask gpu-cost --check`\n  fails, except for the pipelines at the end of this page.\n\
         - Waves: how many a SIMD unit holds at a time, in Mesa's count, which ends at 32.\n\
         - Instructions: those of the program, however often a loop runs them.\n\n",
        families.join(" and ")
    );
    text += &techniques(logs)?;
    text += &commands(frames);
    text += &wide_pipelines(logs);
    text += &exceptions_of(logs, exceptions);
    Ok(text)
}

/// Returns a line of a table.
fn line(cells: impl IntoIterator<Item = String>) -> String {
    format!("| {} |\n", cells.into_iter().collect::<Vec<_>>().join(" | "))
}

/// Returns the head of a table: common columns, columns for each family, and last columns.
fn head(logs: &[(Title, Log)], common: &[&str], of_family: &[&str], last: &[&str]) -> String {
    let of_families = logs.iter().flat_map(|(_, log)| {
        of_family.iter().enumerate().map(|(i, column)| match i {
            0 => format!("{}: {column}", log.table.family),
            _ => (*column).to_owned(),
        })
    });
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let columns: Vec<String> = words(common).into_iter().chain(of_families).chain(words(last)).collect();
    let is_number = |place: usize| place >= common.len().min(1) && place < columns.len() - last.len();
    let rule = (0..columns.len()).map(|place| if is_number(place) { "---:" } else { "---" });
    let rule = format!("|{}|\n", rule.collect::<Vec<_>>().join("|"));
    line(columns) + &rule
}

fn techniques(logs: &[(Title, Log)]) -> Result<String, String> {
    let mut text = "## Techniques\n\n\
         Of the pipelines that a technique draws with at its default settings: the most registers, the fewest waves, the instructions \
         of the longest,\nand the most workgroup memory of compute programs, in bytes.\n\n"
        .to_owned();
    text += &head(logs, &["technique", "programs"], &["registers", "waves", "instructions", "memory"], &[]);
    let names = logs.first().map(|(_, log)| log.techniques.as_slice()).unwrap_or_default();
    for (technique, stages) in names {
        let mut cells = vec![format!("`{technique}`"), stages.len().to_string()];
        for (_, log) in logs {
            let rows = rows_of(&log.table, stages)?;
            let counts = || rows.iter().map(|row| row.counts);
            // In other stages it is used by the driver to pass vertices on.
            let memory = rows.iter().filter(|row| row.name.stage == "compute").map(|row| row.counts.workgroup_bytes);
            let of_all = [
                counts().map(|counts| counts.registers).max(),
                counts().map(|counts| counts.waves).min(),
                counts().map(|counts| counts.instructions).max(),
                memory.max(),
            ];
            cells.extend(of_all.map(|count| count.unwrap_or(0).to_string()));
        }
        text += &line(cells);
    }
    text.push('\n');
    Ok(text)
}

/// Returns the section on commands of a frame of each technique.
fn commands(frames: &[Frame]) -> String {
    let mut text = format!(
        "## Commands of a frame\n\nOf `{SCENE}` at {SIZE} with default settings, after the first frames; MiB that the technique keeps. \
         wgpu adds a dispatch to each\nindirect one, to check it. Values that techniques read back are zero here, \
         and commands that depend on them are missing.\n\n"
    );
    let columns = [
        "technique",
        "dispatches",
        "indirect dispatches",
        "barriers",
        "render passes",
        "draws",
        "copies and fills",
        "MiB",
    ];
    text += &head(&[], &columns, &[], &[]);
    for frame in frames {
        let counts = [
            frame.dispatches,
            frame.indirect_dispatches,
            frame.barriers,
            frame.render_passes,
            frame.draws,
            frame.copies,
        ];
        let memory = format!("{:.1}", frame.memory_bytes as f64 / f64::from(1 << 20));
        let counts = counts.into_iter().map(|count| count.to_string());
        text += &line(std::iter::once(format!("`{}`", frame.technique)).chain(counts).chain([memory]));
    }
    text.push('\n');
    text
}

/// Returns the rows of a technique's stages.
fn rows_of<'a>(table: &'a Table, stages: &[Name]) -> Result<Vec<&'a Row>, String> {
    let mut rows = Vec::new();
    for stage in stages {
        let before = rows.len();
        rows.extend(table.rows.iter().filter(|row| row.name.is_same_program(stage)));
        if rows.len() == before {
            return Err(format!("{}: the driver was not given {}", table.family, stage.text()));
        }
    }
    Ok(rows)
}

/// Returns the section on pipelines with many registers for any family.
fn wide_pipelines(logs: &[(Title, Log)]) -> String {
    let mut wide: Vec<(u32, &Name)> = Vec::new();
    for Row { name, counts } in logs.iter().flat_map(|(_, log)| &log.table.rows) {
        if counts.registers > MANY_REGISTERS {
            match wide.iter_mut().find(|(_, known)| *known == name) {
                Some((most, _)) => *most = counts.registers.max(*most),
                None => wide.push((counts.registers, name)),
            }
        }
    }
    wide.sort_by(|a, b| (b.0, a.1).cmp(&(a.0, b.1)));
    let mut text = format!("## Pipelines with more than {MANY_REGISTERS} registers\n\n");
    text += &head(logs, &["pipeline"], &["registers", "waves", "spilled scalars", "instructions"], &[]);
    for (_, name) in wide {
        let mut cells = vec![format!("`{}`", name.text())];
        for (_, log) in logs {
            // There are several if one program is compiled for several layouts.
            let counts: Vec<Counts> =
                log.table.rows.iter().filter(|row| row.name == *name).map(|row| row.counts).collect();
            let all = |count: fn(&Counts) -> u32| {
                counts.iter().map(|counts| count(counts).to_string()).collect::<Vec<_>>().join(", ")
            };
            cells.extend([
                all(|counts| counts.registers),
                all(|counts| counts.waves),
                all(|counts| counts.scalar_spills),
                all(|counts| counts.instructions),
            ]);
        }
        text += &line(cells);
    }
    text
}

/// Returns the section on exceptions, with their counts and reasons.
fn exceptions_of(logs: &[(Title, Log)], exceptions: &Exceptions) -> String {
    let mut labels: Vec<&str> = Vec::new();
    for Row { name, .. } in logs.iter().flat_map(|(_, log)| &log.table.rows) {
        if exceptions.reason(&name.label).is_some() && !labels.contains(&name.label.as_str()) {
            labels.push(&name.label);
        }
    }
    labels.sort_unstable();
    let mut text = format!(
        "\n## Exceptions\n\nPipelines with more than {MAX_REGISTERS} registers or with scalar registers spilled, \
         from `xtask/programs/exceptions.toml`. Vector registers are never\nspilled, and no memory is used for them.\n\n"
    );
    text += &head(logs, &["label"], &["registers", "spilled scalars"], &["why"]);
    for label in labels {
        let mut cells = vec![format!("`{label}`")];
        for (_, log) in logs {
            let own = || log.table.rows.iter().filter(|row| row.name.label == label).map(|row| row.counts);
            cells.push(own().map(|counts| counts.registers).max().unwrap_or(0).to_string());
            cells.push(own().map(|counts| counts.scalar_spills).max().unwrap_or(0).to_string());
        }
        cells.push(exceptions.reason(label).unwrap_or_default().to_owned());
        text += &line(cells);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(label: &str, stage: &str, registers: u32) -> Row {
        let name = Name { label: label.into(), module: label.into(), stage: stage.into(), ..Name::default() };
        let counts = Counts {
            registers,
            waves: 1024 / registers,
            instructions: 10 * registers,
            workgroup_bytes: registers,
            ..Counts::default()
        };
        Row { name, counts }
    }

    #[test]
    fn a_technique_is_a_line_of_its_programs() {
        let rows = vec![row("essm", "compute", 64), row("map", "vertex", 128), row("other", "compute", 256)];
        let mut shared = rows[0].name.clone();
        shared.label = "savsm".into();
        let techniques = vec![("savsm".to_owned(), vec![shared, rows[1].name.clone()])];
        let table = Table { family: "NAVI21".into(), driver: "Mesa 25.0.7".into(), rows };
        let exceptions = Exceptions::read().unwrap();
        let frame = Frame { technique: "savsm".into(), barriers: 7, memory_bytes: 3 << 19, ..Frame::default() };
        let log = Log { table: table.clone(), techniques };
        let text = page(&[(Title("RDNA 2"), log)], &[frame], &exceptions).unwrap();
        assert!(text.contains("| `savsm` | 0 | 0 | 7 | 0 | 0 | 0 | 1.5 |"), "{text}");
        assert!(text.contains("| `savsm` | 2 | 128 | 8 | 1280 | 64 |"), "{text}");
        let wide: Vec<&str> =
            text.lines().filter(|line| line.starts_with("| `other") || line.starts_with("| `map")).collect();
        assert_eq!(wide, ["| `other, compute ` | 256 | 4 | 0 | 2560 |", "| `map, vertex ` | 128 | 8 | 0 | 1280 |"]);
        assert!(text.contains("| `essm` | 64 | 0 |"), "{text}");
        let unknown = vec![("savsm".to_owned(), vec![row("unknown", "compute", 8).name])];
        assert!(page(&[(Title("RDNA 2"), Log { table, techniques: unknown })], &[], &exceptions).is_err());
    }
}
