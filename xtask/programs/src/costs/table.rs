//! Tables of a compiler's counts: one row for each stage of a pipeline, as tab-separated text.

use std::collections::HashMap;

use std::fmt::Write;

/// Name of a row.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name {
    pub label: String,
    pub stage: String,
    pub module: String,
    pub entry: String,
    pub constants: String,
    pub state: String,
}

impl Name {
    /// Whether another name is of the same program. Techniques that share a program label its pipeline differently.
    pub fn is_same_program(&self, other: &Self) -> bool {
        Self { label: other.label.clone(), ..self.clone() } == *other
    }

    /// Returns the name in readable form.
    pub fn text(&self) -> String {
        let mut text = self.label.clone();
        if self.module != self.label {
            let _ = write!(text, ", {}", self.module);
        }
        let _ = write!(text, ", {} {}", self.stage, self.entry);
        for (begin, part, end) in [(" [", &self.constants, "]"), (" (", &self.state, ")")] {
            if !part.is_empty() {
                let _ = write!(text, "{begin}{part}{end}");
            }
        }
        text
    }
}

/// Counts of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Counts {
    /// Number of vector registers per thread.
    pub registers: u32,
    /// Number of waves that a SIMD unit holds at a time.
    pub waves: u32,
    /// Number of vector registers spilled to memory.
    pub spills: u32,
    /// Number of scalar registers spilled to lanes of vector registers.
    pub scalar_spills: u32,
    /// Workgroup memory, bytes.
    pub workgroup_bytes: u32,
    /// Memory per thread for spills and dynamically indexed arrays, bytes.
    pub scratch_bytes: u32,
    pub instructions: u32,
}

impl Counts {
    /// Returns each count with its name.
    fn named(&self) -> [(&'static str, u32); 7] {
        [
            ("registers", self.registers),
            ("waves", self.waves),
            ("spills", self.spills),
            ("scalar_spills", self.scalar_spills),
            ("workgroup_bytes", self.workgroup_bytes),
            ("scratch_bytes", self.scratch_bytes),
            ("instructions", self.instructions),
        ]
    }
}

/// Row of a table: a stage of a pipeline.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Row {
    pub name: Name,
    pub counts: Counts,
}

/// Table of counts for a family of devices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Mesa's name of the family.
    pub family: String,
    /// Version of Mesa.
    pub driver: String,
    /// Distinct rows, sorted.
    pub rows: Vec<Row>,
}

const NAMES: [&str; 6] = ["label", "stage", "module", "entry", "constants", "state"];

impl Table {
    /// Returns the table as text.
    pub fn to_text(&self) -> String {
        let columns: Vec<&str> = NAMES.into_iter().chain(Counts::default().named().map(|(name, _)| name)).collect();
        let mut text = format!("# {}\n# {}\n{}\n", self.family, self.driver, columns.join("\t"));
        for Row { name: Name { label, stage, module, entry, constants, state }, counts } in &self.rows {
            let _ = write!(text, "{label}\t{stage}\t{module}\t{entry}\t{constants}\t{state}");
            for (_, count) in counts.named() {
                let _ = write!(text, "\t{count}");
            }
            text.push('\n');
        }
        text
    }

    /// Reads a table from text.
    ///
    /// # Errors
    /// If it is not such a table.
    pub fn of_text(text: &str) -> Result<Self, String> {
        let mut lines = text.lines();
        let mut heading = || lines.next()?.strip_prefix("# ").map(str::to_owned);
        let (Some(family), Some(driver)) = (heading(), heading()) else { return Err("not a table of gpu-cost".into()) };
        let empty = Self { family, driver, rows: Vec::new() };
        if lines.next() != empty.to_text().lines().nth(2) {
            return Err("a table of gpu-cost with other columns".into());
        }
        let rows = lines.map(|line| row_of(line).ok_or_else(|| format!("not a row of a table of gpu-cost: {line}")));
        Ok(Self { rows: rows.collect::<Result<_, _>>()?, ..empty })
    }

    /// Returns the changes since an earlier table, one line per count.
    pub fn difference(&self, earlier: &Self) -> String {
        let mut text = format!("{}: {} → {}\n", self.family, earlier.driver, self.driver);
        let (before, after) = (earlier.by_place(), self.by_place());
        let (mut changed, mut gone, mut new) = (0, 0, 0);
        let mut places: Vec<_> =
            before.keys().chain(after.keys().filter(|place| !before.contains_key(*place))).collect();
        places.sort();
        for place in places {
            match (before.get(place), after.get(place)) {
                (Some(before), Some(after)) if before == after => {}
                (Some(before), Some(after)) => {
                    changed += 1;
                    let _ = writeln!(text, "{}", place.0.text());
                    for ((name, before), (_, after)) in before.named().into_iter().zip(after.named()) {
                        if before != after {
                            let _ = writeln!(text, "    {name:16} {before:7} → {after:7}");
                        }
                    }
                }
                (Some(_), None) => {
                    gone += 1;
                    let _ = writeln!(text, "gone: {}", place.0.text());
                }
                (None, Some(counts)) => {
                    new += 1;
                    let Counts { registers, instructions, .. } = counts;
                    let _ =
                        writeln!(text, "new: {}: {registers} registers, {instructions} instructions", place.0.text());
                }
                (None, None) => unreachable!("a place of one of them"),
            }
        }
        let _ = writeln!(text, "{changed} rows changed, {new} are new, {gone} are gone, of {}", self.rows.len());
        text
    }

    /// Returns the counts by name, and by order among rows with the same name.
    fn by_place(&self) -> HashMap<(&Name, usize), Counts> {
        let mut places = HashMap::new();
        for row in &self.rows {
            let order = (0..).find(|order| !places.contains_key(&(&row.name, *order))).expect("a free number");
            places.insert((&row.name, order), row.counts);
        }
        places
    }
}

fn row_of(line: &str) -> Option<Row> {
    let words: Vec<&str> = line.split('\t').collect();
    let (&[label, stage, module, entry, constants, state], counts) = words.split_first_chunk()?;
    let [label, stage, module, entry, constants, state] =
        [label, stage, module, entry, constants, state].map(str::to_owned);
    let counts: Vec<u32> = counts.iter().map(|count| count.parse().ok()).collect::<Option<_>>()?;
    let &[registers, waves, spills, scalar_spills, workgroup_bytes, scratch_bytes, instructions] = &counts[..] else {
        return None;
    };
    Some(Row {
        name: Name { label, stage, module, entry, constants, state },
        counts: Counts { registers, waves, spills, scalar_spills, workgroup_bytes, scratch_bytes, instructions },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(label: &str, registers: u32, instructions: u32) -> Row {
        let name = Name {
            label: label.into(),
            stage: "compute".into(),
            module: label.into(),
            entry: "resolve".into(),
            constants: "0=1".into(),
            state: String::new(),
        };
        Row { name, counts: Counts { registers, waves: 8, instructions, ..Counts::default() } }
    }

    fn table(rows: &[Row]) -> Table {
        Table { family: "NAVI21".into(), driver: "Mesa 25.0.7".into(), rows: rows.to_vec() }
    }

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let table = table(&[row("essm", 96, 4000), row("vssm", 80, 3000)]);
        assert_eq!(Table::of_text(&table.to_text()), Ok(table));
        assert!(Table::of_text("").is_err());
        assert!(Table::of_text("# a\n# b\nlabel\n").is_err());
        let torn = format!("{}a\tb\n", super::Table::default().to_text());
        assert!(Table::of_text(&torn).is_err());
    }

    #[test]
    fn differences_are_those_of_rows_with_one_name() {
        let earlier = table(&[row("essm", 96, 4000), row("gone", 8, 10), row("twice", 8, 10), row("twice", 16, 20)]);
        let later = table(&[row("essm", 96, 3900), row("new", 24, 50), row("twice", 8, 10), row("twice", 24, 20)]);
        let text = later.difference(&earlier);
        let expected = "NAVI21: Mesa 25.0.7 → Mesa 25.0.7\n\
                        essm, compute resolve [0=1]\n    instructions        4000 →    3900\n\
                        gone: gone, compute resolve [0=1]\n\
                        new: new, compute resolve [0=1]: 24 registers, 50 instructions\n\
                        twice, compute resolve [0=1]\n    registers             16 →      24\n\
                        2 rows changed, 1 are new, 1 are gone, of 4\n";
        assert_eq!(text, expected);
        assert!(later.difference(&later).contains("0 rows changed, 0 are new, 0 are gone"));
    }
}
