//! Imports run one way: the modules of each crate, by the imports of their Rust and WESL files, form no cycle.
//!
//! Two levels are checked: the top-level modules of a crate, and the modules of each folder. A file belongs to the module of its path, so
//! `map.rs` and `map.wesl` are one. A path through a re-export counts for the module that declares the item. A folder's own `mod.rs`
//! lists its modules and may import them, and they may import its items: that is no edge.
//!
//! Test-only code (`#[cfg(test)]`, `tests.rs`, `testing.rs`) is left out: a test of a low-level module may use a high-level one to create
//! its input, and users of the library never build it.
//!
//! `ANTUMBRA_TREE=path cargo test -p xtask --test imports -- --nocapture` reads another checkout.

mod graph;
mod source;
mod tokens;

use std::path::{Path, PathBuf};

use graph::Graph;
use source::Crate;

/// Returns the checkout to read.
fn tree() -> PathBuf {
    std::env::var_os("ANTUMBRA_TREE").map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), PathBuf::from)
}

/// Returns the source folders of crates: the workspace's, the plugin's and the example's.
fn crates_of(tree: &Path) -> Vec<PathBuf> {
    let mut folders = vec![tree.join("xtask"), tree.join("bevy_antumbra"), tree.join("fuzz")];
    for group in ["crates", "xtask"] {
        folders.extend(source::entries(&tree.join(group)));
    }
    folders.retain(|folder| folder.join("Cargo.toml").is_file() && folder.join("src").is_dir());
    let mut sources: Vec<PathBuf> = folders.iter().map(|folder| folder.join("src")).collect();
    sources.extend(Some(tree.join("examples/many_lights")).filter(|folder| folder.is_dir()));
    sources.sort();
    sources
}

#[test]
fn modules_make_no_cycle() {
    let tree = tree();
    let sources = crates_of(&tree);
    assert!(sources.len() > 5, "{}: no checkout of the repository", tree.display());
    let mut report = String::new();
    for folder in &sources {
        let name = folder.strip_prefix(&tree).unwrap_or(folder).display().to_string();
        let graph = Graph::of(&Crate::read(folder));
        let cycles = graph.cycles();
        println!("{name}: {} imports between modules, {} cycles", graph.len(), cycles.len());
        for cycle in cycles {
            report += &format!("\n{name}: {cycle}");
        }
    }
    assert!(report.is_empty(), "modules import one another in a circle:{report}");
}

/// Returns the edges of a crate that is given as text, as pairs of modules.
fn edges(files: &[(&str, &str)]) -> Vec<(String, String)> {
    Graph::of(&Crate::of_texts(files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())))).pairs()
}

fn pair(from: &str, to: &str) -> (String, String) {
    (from.to_owned(), to.to_owned())
}

#[test]
fn imports_of_every_form_are_read() {
    let found = edges(&[
        ("lib.rs", "mod a; mod b; mod c; mod d; mod e; pub use b::Thing;"),
        ("a.rs", "use crate::{Thing, c::{self, X as Y}};\nfn f() { crate::d::g(); }"),
        ("b/mod.rs", "mod x; mod y; pub use x::Inner;\nstruct Thing;"),
        ("b/x.rs", "use super::y;\nstruct Inner;"),
        ("b/y.rs", "mod inline { use super::super::x::Z; }"),
        (
            "c.rs",
            "// use crate::a;\nconst S: &str = \"crate::a\";\n#[cfg(test)]\nmod tests { use crate::a; }\nfn f<'a>(c: char) { c == '\"' }",
        ),
        ("d.wesl", "/* import package::a; */\n@if(x) import package::e::{f, g as h};"),
        ("e.wesl", "fn f() { package::b::x::w(); }"),
        ("b/tests.rs", "use crate::a;"),
    ]);
    let expected = [
        pair("a", "b"),
        pair("a", "c"),
        pair("a", "d"),
        pair("b::x", "b::y"),
        pair("b::y", "b::x"),
        pair("d", "e"),
        pair("e", "b"),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_cycle_is_told_with_a_line_for_each_import() {
    let files = [
        ("lib.rs", ""),
        ("a.rs", "\nuse crate::b::X;"),
        ("b.wesl", "import package::c::y;"),
        ("c.rs", "use super::a::Z;"),
    ];
    let files = files.map(|(path, text)| (path.to_owned(), text.to_owned()));
    let cycles = Graph::of(&Crate::of_texts(files)).cycles();
    assert_eq!(cycles.len(), 1);
    for part in ["a b c", "a → b", "a.rs:2", "b → c", "b.wesl:1", "c → a", "c.rs:1"] {
        assert!(cycles[0].contains(part), "no `{part}` in {}", cycles[0]);
    }
}
