//! Limits of registers and spills, and exceptions from `exceptions.toml`.

use serde::Deserialize;

use super::table::{Counts, Table};

/// Maximum vector registers per thread. With more, an RDNA 2 SIMD unit holds fewer than eight waves (Mesa's count): too few to hide loads.
pub const MAX_REGISTERS: u32 = 128;

/// Exceptions of the repository.
const EXCEPTIONS: &str = include_str!("../../exceptions.toml");

/// Exceptions, and the compiler that they apply to.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exceptions {
    /// Prefix of Mesa's version.
    mesa: String,
    #[serde(default, rename = "exception")]
    all: Vec<Exception>,
}

/// Higher limits for pipelines with a label.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Exception {
    label: String,
    registers: Option<u32>,
    scalar_spills: Option<u32>,
    why: String,
}

impl Exceptions {
    /// Reads the exceptions of the repository.
    ///
    /// # Errors
    /// If the file has another form.
    pub fn read() -> Result<Self, String> {
        Self::of_text(EXCEPTIONS)
    }

    fn of_text(text: &str) -> Result<Self, String> {
        let exceptions: Self = toml::from_str(text).map_err(|error| format!("exceptions.toml: {error}"))?;
        match exceptions.all.iter().find(|exception| exception.why.trim().is_empty()) {
            Some(Exception { label, .. }) => Err(format!("exceptions.toml: {label} has no reason")),
            None => Ok(exceptions),
        }
    }

    /// Checks that a table comes from the compiler that the exceptions apply to.
    ///
    /// # Errors
    /// The expected and the actual compiler.
    pub fn are_for(&self, table: &Table) -> Result<(), String> {
        let version = table.driver.strip_prefix("Mesa ").unwrap_or(&table.driver);
        let is_it =
            version.strip_prefix(&self.mesa).is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()));
        if is_it { Ok(()) } else { Err(format!("limits are for Mesa {}, but this is {}", self.mesa, table.driver)) }
    }

    /// Returns the reason of a label's exception.
    pub fn reason(&self, label: &str) -> Option<&str> {
        self.of(label).map(|exception| exception.why.as_str())
    }

    fn of(&self, label: &str) -> Option<&Exception> {
        self.all.iter().find(|exception| exception.label == label)
    }

    /// Returns faults: programs beyond the limits and their exceptions, and exceptions that no program needs.
    pub fn judge(&self, tables: &[Table]) -> Vec<String> {
        let mut faults = Vec::new();
        for table in tables {
            for row in &table.rows {
                let exception = self.of(&row.name.label);
                let Counts { registers, spills, scalar_spills, scratch_bytes, .. } = row.counts;
                let max_registers = exception.and_then(|exception| exception.registers).unwrap_or(MAX_REGISTERS);
                let max_spills = exception.and_then(|exception| exception.scalar_spills).unwrap_or(0);
                let counted = [
                    ("vector registers", registers, max_registers),
                    ("spilled scalar registers", scalar_spills, max_spills),
                    ("spilled vector registers", spills, 0),
                    ("bytes of scratch memory", scratch_bytes, 0),
                ];
                faults.extend(counted.into_iter().filter(|(_, count, most)| count > most).map(
                    |(what, count, most)| {
                        format!("{}: {}: {count} {what}; at most {most} are allowed", table.family, row.name.text())
                    },
                ));
            }
        }
        faults.extend(self.all.iter().flat_map(|exception| exception.in_vain(tables)));
        faults
    }
}

impl Exception {
    /// Returns the faults of an exception that no program needs.
    fn in_vain(&self, tables: &[Table]) -> Vec<String> {
        let most = |count: fn(&Counts) -> u32| {
            let rows = tables.iter().flat_map(|table| &table.rows).filter(|row| row.name.label == self.label);
            rows.map(|row| count(&row.counts)).max().unwrap_or(0)
        };
        let limits = [
            ("registers", self.registers, most(|counts| counts.registers), MAX_REGISTERS),
            ("scalar_spills", self.scalar_spills, most(|counts| counts.scalar_spills), 0),
        ];
        let is_empty = self.registers.is_none() && self.scalar_spills.is_none();
        let in_vain = limits.into_iter().filter(|(_, exception, most, limit)| exception.is_some() && most <= limit);
        let mut faults: Vec<String> = in_vain
            .map(|(what, _, most, _)| {
                format!("exceptions.toml: {} needs no exception for {what}, because its maximum is {most}", self.label)
            })
            .collect();
        faults.extend(is_empty.then(|| format!("exceptions.toml: the exception of {} has no limit", self.label)));
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::{Name, Row};
    use super::*;

    fn table(rows: &[(&str, Counts)]) -> Table {
        let row = |&(label, counts): &(&str, Counts)| {
            let name = Name { label: label.into(), module: label.into(), ..Name::default() };
            Row { name, counts }
        };
        Table { family: "NAVI21".into(), driver: "Mesa 25.0.7".into(), rows: rows.iter().map(row).collect() }
    }

    fn registers(registers: u32) -> Counts {
        Counts { registers, ..Counts::default() }
    }

    fn exceptions(text: &str) -> Exceptions {
        Exceptions::of_text(&format!("mesa = \"25.0\"\n{text}")).unwrap()
    }

    const ESSM: &str = "[[exception]]\nlabel = \"essm\"\nregisters = 200\nscalar_spills = 3\nwhy = \"sums\"";

    #[test]
    fn what_is_beyond_a_limit_is_a_fault() {
        let none = exceptions("");
        let beyond = [
            registers(129),
            Counts { spills: 1, ..registers(8) },
            Counts { scalar_spills: 1, ..registers(8) },
            Counts { scratch_bytes: 4, ..registers(8) },
        ];
        for counts in beyond {
            assert_eq!(none.judge(&[table(&[("essm", counts), ("hard", registers(128))])]).len(), 1, "{counts:?}");
        }
    }

    #[test]
    fn an_exception_allows_so_much_and_has_to_be_needed() {
        let one = exceptions(ESSM);
        let needed = Counts { scalar_spills: 3, ..registers(200) };
        assert!(one.judge(&[table(&[("essm", registers(64))]), table(&[("essm", needed)])]).is_empty());
        assert_eq!(one.judge(&[table(&[("essm", Counts { spills: 1, ..needed })])]).len(), 1);
        assert_eq!(one.judge(&[table(&[("essm", Counts { registers: 201, ..needed })])]).len(), 1);
        assert_eq!(one.judge(&[table(&[("essm", Counts { registers: 128, ..needed })])]).len(), 1);
        assert_eq!(one.judge(&[table(&[("hard", registers(8))])]).len(), 2);
        assert_eq!(exceptions("[[exception]]\nlabel = \"essm\"\nwhy = \"sums\"").judge(&[table(&[])]).len(), 1);
        assert_eq!(one.reason("essm"), Some("sums"));
    }

    #[test]
    fn another_compiler_is_not_judged() {
        let one = exceptions(ESSM);
        assert!(one.are_for(&table(&[])).is_ok());
        for driver in ["Mesa 22.3.6", "Mesa 25.01", "Mesa 2"] {
            assert!(one.are_for(&Table { driver: driver.into(), ..table(&[]) }).is_err(), "{driver}");
        }
    }

    #[test]
    fn every_exception_of_the_repository_has_a_reason() {
        Exceptions::read().unwrap();
        assert!(Exceptions::of_text("mesa = \"25\"\n[[exception]]\nlabel = \"essm\"\nwhy = \"\"").is_err());
    }
}
