//! Changes that are made every time, whatever the seed: `named.toml`.

use std::path::Path;

use serde::Deserialize;

use crate::places::Change;
use crate::sources::Sources;

/// Change identified by its text, which must occur once in its source.
#[derive(Debug, Deserialize)]
pub struct Named {
    pub what: String,
    pub file: String,
    pub from: String,
    pub to: String,
}

#[derive(Debug, Deserialize)]
struct List {
    change: Vec<Named>,
}

/// Reads the list.
///
/// # Errors
/// If it cannot be read.
pub fn read(root: &Path) -> Result<Vec<Named>, String> {
    let path = root.join("xtask/mutants/named.toml");
    std::fs::read_to_string(&path)
        .map_err(|error| error.to_string())
        .and_then(|text| toml::from_str::<List>(&text).map_err(|error| error.to_string()))
        .map(|list| list.change)
        .map_err(|error| format!("{}: {error}", path.display()))
}

impl Named {
    /// Returns the change, with its place in the source.
    ///
    /// # Errors
    /// If its text does not occur, or more than once.
    pub fn change(&self, sources: &Sources) -> Result<Change, String> {
        let text = sources.texts.get(&self.file).map_or("", String::as_str);
        let found: Vec<usize> = text.match_indices(&self.from).map(|(at, _)| at).collect();
        match found[..] {
            [start] => Ok(Change { start, end: start + self.from.len(), to: self.to.clone() }),
            _ => Err(format!(
                "named.toml: `{}` occurs {} times in {}, but must occur once",
                self.from,
                found.len(),
                self.file
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_in_its_source() {
        let sources = Sources::read().expect("the library's");
        let list = read(&crate::run::root()).expect("the list");
        assert!(list.len() >= 4);
        for named in list {
            named.change(&sources).unwrap_or_else(|fault| panic!("{fault}"));
        }
    }
}
