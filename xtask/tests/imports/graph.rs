//! Graph of imports between the modules of a folder, and its cycles.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Crate, ModulePath};

/// Imports between sibling modules: importing module, imported module, and places.
#[derive(Debug, Default)]
pub struct Graph {
    edges: BTreeMap<(ModulePath, ModulePath), Vec<String>>,
}

impl Graph {
    /// Returns the graph of a crate.
    pub fn of(of: &Crate) -> Self {
        let mut found = Self::default();
        for import in &of.imports {
            let to = of.declaring(&import.to);
            let common = import.from.iter().zip(&to).take_while(|(from, to)| from == to).count();
            // One contains the other: a folder and a module in it.
            if common == import.from.len() || common == to.len() {
                continue;
            }
            let beside = |path: &ModulePath| path[..=common].to_vec();
            let place = format!("{}:{}", import.file, import.line);
            found.edges.entry((beside(&import.from), beside(&to))).or_default().push(place);
        }
        found
    }

    /// Returns the number of edges.
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Returns the edges by name.
    pub fn pairs(&self) -> Vec<(String, String)> {
        self.edges.keys().map(|(from, to)| (from.join("::"), to.join("::"))).collect()
    }

    /// Returns the modules that are reachable from a module.
    fn reached<'a>(&'a self, from: &'a ModulePath) -> BTreeSet<&'a ModulePath> {
        let mut reached = BTreeSet::new();
        let mut open = vec![from];
        while let Some(next) = open.pop() {
            let targets = self.edges.keys().filter(|(from, _)| from == next).map(|(_, to)| to);
            open.extend(targets.filter(|to| reached.insert(*to)));
        }
        reached
    }

    /// Describes each cyclic group of modules: its members, then every import within it with its number of places and the first one.
    pub fn cycles(&self) -> Vec<String> {
        let modules: BTreeSet<&ModulePath> = self.edges.keys().flat_map(|(from, to)| [from, to]).collect();
        let reached: BTreeMap<_, _> = modules.iter().map(|module| (*module, self.reached(module))).collect();
        let mut told = BTreeSet::new();
        let mut cycles = Vec::new();
        for module in modules.iter().filter(|module| reached[**module].contains(**module)) {
            let group: BTreeSet<&ModulePath> =
                reached[*module].iter().copied().filter(|other| reached[*other].contains(*module)).collect();
            if told.insert(group.clone()) {
                cycles.push(self.description(&group));
            }
        }
        cycles
    }

    fn description(&self, group: &BTreeSet<&ModulePath>) -> String {
        let names: Vec<String> = group.iter().map(|module| module.join("::")).collect();
        let mut text = format!("a cycle of {} modules: {}", names.len(), names.join(" "));
        for ((from, to), places) in &self.edges {
            if group.contains(from) && group.contains(to) {
                let [from, to] = [from.join("::"), to.join("::")];
                text += &format!("\n    {from} → {to}: {} imports, first {}", places.len(), places[0]);
            }
        }
        text
    }
}
