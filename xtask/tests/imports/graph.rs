//! Which module of a folder imports which, and the cycles of that.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Crate, ModulePath};

/// Modules beside one another, by the imports between them: the module that imports, the one that is imported, and where.
#[derive(Debug, Default)]
pub struct Graph {
    edges: BTreeMap<(ModulePath, ModulePath), Vec<String>>,
}

impl Graph {
    /// The graph of a crate.
    pub fn of(of: &Crate) -> Self {
        let mut found = Self::default();
        for import in &of.imports {
            let to = of.declaring(&import.to);
            let common = import.from.iter().zip(&to).take_while(|(from, to)| from == to).count();
            // One is in the other: a folder and what is in it.
            if common == import.from.len() || common == to.len() {
                continue;
            }
            let beside = |path: &ModulePath| path[..=common].to_vec();
            let place = format!("{}:{}", import.file, import.line);
            found.edges.entry((beside(&import.from), beside(&to))).or_default().push(place);
        }
        found
    }

    /// How many modules import one beside them.
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// The edges by name.
    pub fn pairs(&self) -> Vec<(String, String)> {
        self.edges.keys().map(|(from, to)| (from.join("::"), to.join("::"))).collect()
    }

    /// The modules that a module leads to.
    fn reached<'a>(&'a self, from: &'a ModulePath) -> BTreeSet<&'a ModulePath> {
        let mut reached = BTreeSet::new();
        let mut open = vec![from];
        while let Some(next) = open.pop() {
            let targets = self.edges.keys().filter(|(from, _)| from == next).map(|(_, to)| to);
            open.extend(targets.filter(|to| reached.insert(*to)));
        }
        reached
    }

    /// Each group of modules that lead to one another: its members, then every import within it by its number of places and the first.
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
