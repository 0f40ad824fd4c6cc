//! Modules of a crate, and the paths that their files name.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::tokens::{Token, tokens};

/// Module path: names from the crate's root on.
pub type ModulePath = Vec<String>;

/// Path that a file names.
#[derive(Debug)]
pub struct Import {
    pub from: ModulePath,
    pub to: ModulePath,
    pub file: String,
    pub line: usize,
}

/// Modules and imports of a crate.
#[derive(Debug, Default)]
pub struct Crate {
    pub modules: BTreeSet<ModulePath>,
    pub imports: Vec<Import>,
    /// Names that `use` adds to a module: module and name, with the path that it refers to.
    pub named: BTreeMap<(ModulePath, String), ModulePath>,
}

/// Returns the sorted entries of a folder; none if it does not exist.
pub fn entries(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

impl Crate {
    /// Reads the crate whose sources are in `folder`.
    pub fn read(folder: &Path) -> Self {
        let mut files = Vec::new();
        let mut folders = vec![folder.to_owned()];
        while let Some(next) = folders.pop() {
            for path in entries(&next) {
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|ending| ending == "rs" || ending == "wesl") {
                    let name = path.strip_prefix(folder).expect("it is inside").display().to_string();
                    files.push((name, std::fs::read_to_string(&path).expect("a source is text")));
                }
            }
        }
        Self::of_texts(files)
    }

    /// Returns the crate of these files: path within `src`, and text.
    pub fn of_texts(files: impl IntoIterator<Item = (String, String)>) -> Self {
        let mut files: Vec<(String, String)> = files.into_iter().collect();
        files.sort();
        let mut found = Self::default();
        let read: Vec<(String, ModulePath, Vec<Token>)> = files
            .into_iter()
            .map(|(path, text)| {
                let module = module_of(&path);
                (path, module, without_tests(tokens(&text)))
            })
            .filter(|(_, module, _)| !module.iter().any(|name| is_for_tests(name)))
            .collect();
        found.modules = read.iter().map(|(_, module, _)| module.clone()).collect();
        for (file, module, tokens) in &read {
            found.read_file(file, module, tokens);
        }
        found
    }

    fn read_file(&mut self, file: &str, module: &ModulePath, tokens: &[Token]) {
        let is_wesl = file.ends_with(".wesl");
        // The open inline modules, and the depth of braces at which each ends.
        let (mut inline, mut depth) = (Vec::<(String, usize)>::new(), 0);
        let mut at = 0;
        while at < tokens.len() {
            let here: ModulePath = module.iter().chain(inline.iter().map(|(name, _)| name)).cloned().collect();
            let next = |offset: usize| tokens.get(at + offset).map_or("", |token| token.text.as_str());
            let follows_path = at > 0 && tokens[at - 1].text == "::";
            match next(0) {
                "{" => depth += 1,
                "}" => {
                    depth -= 1;
                    inline.pop_if(|(_, end)| *end == depth);
                }
                "mod" if !is_wesl && next(2) == "{" => inline.push((next(1).to_owned(), depth)),
                "use" | "import" if (next(0) == "import") == is_wesl => {
                    at += 1;
                    self.read_tree(file, module, &here, tokens, &mut at, &[]);
                    continue;
                }
                "crate" | "super" | "package" if !follows_path && next(1) == "::" => {
                    let line = tokens[at].line;
                    let path = path_at(tokens, &mut at);
                    self.push(file, line, module, &here, &path);
                    continue;
                }
                _ => {}
            }
            at += 1;
        }
    }

    /// Reads a tree of `use` or `import` at `at`, and moves `at` past it.
    fn read_tree(
        &mut self,
        file: &str,
        module: &ModulePath,
        here: &ModulePath,
        tokens: &[Token],
        at: &mut usize,
        prefix: &[String],
    ) {
        let line = tokens.get(*at).map_or(0, |token| token.line);
        let path: Vec<String> = prefix.iter().cloned().chain(path_at(tokens, at)).collect();
        let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
        match text(*at) {
            "{" => {
                *at += 1;
                while *at < tokens.len() && text(*at) != "}" {
                    self.read_tree(file, module, here, tokens, at, &path);
                    *at += usize::from(text(*at) == ",");
                }
                *at += 1;
            }
            "*" => {
                *at += 1;
                self.push(file, line, module, here, &path);
            }
            "as" => {
                self.name(here, text(*at + 1), &path);
                *at += 2;
                self.push(file, line, module, here, &path);
            }
            _ if path.is_empty() => *at += 1,
            _ => {
                let path = if path.last().is_some_and(|name| name == "self") { &path[..path.len() - 1] } else { &path };
                self.name(here, path.last().map_or("", String::as_str), path);
                self.push(file, line, module, here, path);
            }
        }
    }

    fn name(&mut self, here: &ModulePath, name: &str, path: &[String]) {
        if let Some(target) = self.absolute(here, path).filter(|target| target.last().is_some()) {
            self.named.insert((here.clone(), name.to_owned()), target);
        }
    }

    fn push(&mut self, file: &str, line: usize, module: &ModulePath, here: &ModulePath, path: &[String]) {
        if let Some(to) = self.absolute(here, path) {
            self.imports.push(Import { from: module.clone(), to, file: file.to_owned(), line });
        }
    }

    /// Returns a path from the crate's root on; `None` for other crates'.
    fn absolute(&self, here: &ModulePath, path: &[String]) -> Option<ModulePath> {
        let (first, rest) = path.split_first()?;
        let mut base = match first.as_str() {
            "crate" | "package" => ModulePath::new(),
            "self" => here.clone(),
            "super" => here[..here.len().checked_sub(1)?].to_vec(),
            name => {
                let child: ModulePath = here.iter().cloned().chain([name.to_owned()]).collect();
                let is_module = self.modules.iter().any(|module| module.starts_with(&child));
                return is_module.then(|| child.into_iter().chain(rest.iter().cloned()).collect());
            }
        };
        for name in rest {
            if name == "super" {
                base.pop();
            } else if name != "self" {
                base.push(name.clone());
            }
        }
        Some(base)
    }

    /// Returns the module that declares the item of a path.
    pub fn declaring(&self, path: &ModulePath) -> ModulePath {
        let mut path = path.clone();
        // Limit of re-exports of re-exports; a circle of names does not compile.
        for _ in 0..8 {
            let known = (0..=path.len()).rev().find(|&length| self.is_module(&path[..length])).unwrap_or(0);
            let Some(name) = path.get(known) else { return path };
            match self.named.get(&(path[..known].to_vec(), name.clone())) {
                Some(target) => path = target.iter().chain(&path[known + 1..]).cloned().collect(),
                None => return path[..known].to_vec(),
            }
        }
        path
    }

    fn is_module(&self, path: &[String]) -> bool {
        self.modules.contains(path) || self.modules.iter().any(|module| module.starts_with(path))
    }
}

/// Returns words joined by `::` at `at`, and moves `at` past them.
fn path_at(tokens: &[Token], at: &mut usize) -> Vec<String> {
    let mut path = Vec::new();
    while let Some(token) = tokens.get(*at) {
        if token.text == "::" {
            *at += 1;
        } else if token.is_word() && token.text != "as" && (path.is_empty() || tokens[*at - 1].text == "::") {
            path.push(token.text.clone());
            *at += 1;
        } else {
            break;
        }
    }
    path
}

fn is_for_tests(name: &str) -> bool {
    matches!(name, "tests" | "testing" | "test_support")
}

/// Returns the module of a file, by its path within `src`.
fn module_of(path: &str) -> ModulePath {
    let path = path.rsplit_once('.').map_or(path, |(stem, _)| stem);
    let mut module: ModulePath = path.split(['/', '\\']).map(str::to_owned).collect();
    let is_root = module.len() == 1 && matches!(module[0].as_str(), "lib" | "main");
    if is_root || module.last().is_some_and(|name| name == "mod") {
        module.pop();
    }
    module
}

/// Removes the tokens of test-only items.
fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let starts = |words: &[&str]| {
            tokens[at..].iter().map(|token| token.text.as_str()).take(words.len()).eq(words.iter().copied())
        };
        if starts(&["#", "[", "cfg", "(", "test", ")", "]"]) || starts(&["#", "[", "cfg", "(", "all", "(", "test"]) {
            at = end_of_item(&tokens, at);
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

/// Returns the end of the item whose attributes start at `start`: after its braces, or its `;` or `,` outside of brackets.
fn end_of_item(tokens: &[Token], start: usize) -> usize {
    let (mut depth, mut is_in_attribute) = (0, true);
    for (at, token) in tokens.iter().enumerate().skip(start) {
        match token.text.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => {
                depth -= 1;
                if depth < 0 {
                    return at;
                }
                let next = tokens.get(at + 1).map_or("", |token| token.text.as_str());
                if token.text == "}" && depth == 0 && !matches!(next, ";" | ",") {
                    return at + 1;
                }
                is_in_attribute &= token.text != "]" || depth > 0 || next == "#";
            }
            ";" | "," if depth == 0 && !is_in_attribute => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}
