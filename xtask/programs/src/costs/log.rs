//! Log of a run: announcements of pipelines, each followed by the statistics that Mesa's driver prints with `RADV_DEBUG=shaderstats`, a
//! block for each stage.

use std::collections::HashMap;

use serde_json::Value;

use super::announcement::{DEVICE, END, PIPELINE, TECHNIQUE};
use super::table::{Counts, Name, Row, Table};

/// Results of a run.
#[derive(Debug, Default, PartialEq)]
pub struct Log {
    pub table: Table,
    /// Stages of each technique's pipelines at its default settings, in order.
    pub techniques: Vec<(String, Vec<Name>)>,
}

impl Log {
    /// Reads the log of a run on a family of devices.
    ///
    /// # Errors
    /// If the run did not finish, or the driver printed nothing.
    pub fn read(text: &str) -> Result<Self, String> {
        let (mut log, mut reader) = (Self::default(), Reader::default());
        let mut has_ended = false;
        for line in text.lines() {
            if let Some(announced) = line.strip_prefix(DEVICE) {
                let device = json(announced)?;
                log.table.family = family_in(word(&device, "name"));
                log.table.driver = word(&device, "driver").to_owned();
            } else if let Some(announced) = line.strip_prefix(TECHNIQUE) {
                let announced = json(announced)?;
                log.add_technique(word(&announced, "technique"), names_of(&announced["pipeline"]));
            } else if let Some(announced) = line.strip_prefix(PIPELINE) {
                reader.names = names_of(&json(announced)?);
            } else if line == END {
                has_ended = true;
            } else {
                log.table.rows.extend(reader.read(line));
            }
        }
        if !has_ended {
            let last = text.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("the driver printed nothing");
            return Err(format!("the driver ended before the last pipeline: {last}"));
        }
        if log.table.rows.is_empty() {
            return Err("the driver printed no statistics".to_owned());
        }
        log.table.rows.sort();
        log.table.rows.dedup();
        Ok(log)
    }

    fn add_technique(&mut self, technique: &str, names: Vec<Name>) {
        match self.techniques.last_mut() {
            Some((last, known)) if last == technique => {
                known.extend(names.into_iter().filter(|name| !known.contains(name)).collect::<Vec<_>>());
            }
            _ => self.techniques.push((technique.to_owned(), names)),
        }
    }
}

/// Reader of a driver's statistics blocks.
#[derive(Default)]
struct Reader {
    /// Stages of the pipeline announced last; empty before the first, while the driver compiles its own programs.
    names: Vec<Name>,
    stage: String,
    block: Option<HashMap<String, u32>>,
}

impl Reader {
    /// Reads a line. Returns the row that ends with it.
    fn read(&mut self, line: &str) -> Option<Row> {
        if let Some(title) = line.strip_suffix(':').filter(|title| title.contains(" Shader")) {
            // "Compute Shader:", "Pixel Shader:", "Vertex Shader as ESGS:".
            let stage = title.split(' ').next().unwrap_or_default().to_lowercase();
            self.stage = if stage == "pixel" { "fragment".to_owned() } else { stage };
        } else if line.starts_with("*** SHADER STATS") {
            self.block = Some(HashMap::new());
        } else if line.starts_with("*****") {
            let block = self.block.take()?;
            let name = self.names.iter().find(|name| name.stage == self.stage)?.clone();
            return Some(Row { name, counts: counts_in(&block) });
        } else if let (Some(block), Some((key, value))) = (&mut self.block, line.split_once(": ")) {
            // Hashes are not counts, and exceed 32 bits.
            block.extend(value.trim().parse().ok().map(|value| (key.to_owned(), value)));
        }
        None
    }
}

fn counts_in(block: &HashMap<String, u32>) -> Counts {
    let count = |key| block.get(key).copied().unwrap_or(0);
    Counts {
        registers: count("VGPRs"),
        waves: count("Subgroups per SIMD"),
        spills: count("Spilled VGPRs"),
        scalar_spills: count("Spilled SGPRs"),
        workgroup_bytes: count("LDS size"),
        scratch_bytes: count("Scratch size"),
        instructions: count("Instructions"),
    }
}

fn json(text: &str) -> Result<Value, String> {
    serde_json::from_str(text).map_err(|error| format!("{text}: {error}"))
}

fn word<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

/// Returns the stages of an announced pipeline.
fn names_of(pipeline: &Value) -> Vec<Name> {
    let programs = pipeline["programs"].as_array().map(Vec::as_slice).unwrap_or_default();
    let own = |value, key| word(value, key).to_owned();
    let name = |program| Name {
        label: own(pipeline, "label"),
        stage: own(program, "stage"),
        module: own(program, "module"),
        entry: own(program, "entry"),
        constants: own(program, "constants"),
        state: own(pipeline, "state"),
    };
    programs.iter().map(name).collect()
}

/// Returns the family in a device's name: `NAVI21` in `Null hardware (RADV NAVI21)`.
fn family_in(device: &str) -> String {
    let inside = device.split_once("RADV ").map_or(device, |(_, after)| after);
    inside.trim_end_matches(')').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = r#"
@technique {"technique":"essm","pipeline":{"label":"essm","state":"","programs":[{"stage":"compute","module":"essm","entry":"resolve","constants":"0=1"}]}}
Compute Shader:
*** SHADER STATS ***
VGPRs: 8
********************
@device {"name":"Null hardware (RADV NAVI21)","driver":"Mesa 25.0.7"}
@pipeline {"label":"depth","state":"Depth32Float","programs":[{"stage":"vertex","module":"depth","entry":"v","constants":""},{"stage":"fragment","module":"depth","entry":"f","constants":""}]}

Vertex Shader as ESGS:
*** SHADER STATS ***
Driver pipeline hash: 981450218027735410
VGPRs: 24
Subgroups per SIMD: 32
********************

Pixel Shader:
*** SHADER STATS ***
VGPRs: 16
********************
@pipeline {"label":"essm","state":"","programs":[{"stage":"compute","module":"essm","entry":"resolve","constants":"0=1"}]}
Compute Shader:
*** SHADER STATS ***
SGPRs: 128
VGPRs: 128
Spilled SGPRs: 4
Spilled VGPRs: 2
LDS size: 512
Scratch size: 16
Subgroups per SIMD: 8
Instructions: 5094
********************
@end
"#;

    #[test]
    fn rows_are_those_of_announced_pipelines() {
        let log = Log::read(LOG).unwrap();
        let Table { family, driver, rows } = &log.table;
        assert_eq!((family.as_str(), driver.as_str()), ("NAVI21", "Mesa 25.0.7"));
        let named: Vec<_> = rows.iter().map(|row| (row.name.entry.as_str(), row.counts.registers)).collect();
        assert_eq!(named, [("f", 16), ("v", 24), ("resolve", 128)]);
        let expected = Counts {
            registers: 128,
            waves: 8,
            spills: 2,
            scalar_spills: 4,
            workgroup_bytes: 512,
            scratch_bytes: 16,
            instructions: 5094,
        };
        assert_eq!(rows[2].counts, expected);
        assert_eq!(log.techniques, [("essm".to_owned(), vec![rows[2].name.clone()])]);
    }

    #[test]
    fn a_run_that_broke_off_is_an_error() {
        let error = Log::read(&LOG.replace("@end", "radv: Unknown family: navi99")).unwrap_err();
        assert!(error.contains("Unknown family"), "{error}");
        assert!(Log::read("@end").is_err());
    }
}
