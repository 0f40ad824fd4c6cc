//! Links each WESL shader of `crates/antumbra/src` to plain WGSL in `crates/antumbra/linked`, and lists them there for the library:
//! `cargo xtask shaders`.
//!
//! List and linked text are committed and embedded unchanged, so that building the library needs no linker. A test here fails if they
//! differ from what the sources link to.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use wesl::syntax::GlobalDeclaration;
use wesl::{CompileResult, Mangler, ModulePath, SourceMap, Wesl};

pub use shaders::{Shader, shaders};

mod shaders;

/// Command that relinks, for headers and messages.
const COMMAND: &str = "cargo xtask shaders";

/// File of the library's list of shaders, under `linked/`.
const LIST: &str = "shaders.rs";

/// Returns the library's folder.
pub fn library() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/antumbra")
}

/// Relinks all shaders into `linked/`, and lists them there. Unchanged files are not written, because cargo would rebuild.
///
/// # Errors
/// The first shader that does not link, or file that cannot be read or written.
pub fn relink(library: &Path) -> Result<(), String> {
    let folder = library.join("linked");
    let linked = link_all(&library.join("src"))?;
    let committed = texts_in(&folder)?;
    let (mut written, mut removed) = (0, 0);
    for (file, text) in linked.iter().filter(|(file, text)| committed.get(*file) != Some(text)) {
        let target = folder.join(file);
        target
            .parent()
            .map_or(Ok(()), std::fs::create_dir_all)
            .and_then(|()| std::fs::write(&target, text))
            .map_err(|error| format!("cannot write {}: {error}", target.display()))?;
        println!("linked {file}");
        written += 1;
    }
    for file in committed.keys().filter(|file| !linked.contains_key(*file)) {
        let stale = folder.join(file);
        std::fs::remove_file(&stale).map_err(|error| format!("cannot remove {}: {error}", stale.display()))?;
        println!("removed {file}");
        removed += 1;
    }
    println!("{} shaders: {written} files written, {removed} removed", linked.len() - 1);
    Ok(())
}

/// Returns every shader's linked text and the library's list of them, by their paths under `linked/`.
fn link_all(sources: &Path) -> Result<BTreeMap<String, String>, String> {
    let shaders = shaders(&texts_in(sources)?)?;
    let mut files = BTreeMap::from([(LIST.to_owned(), shaders::list(&shaders))]);
    let mut plain = String::new();
    for shader in &shaders {
        let text = link(sources, shader)?;
        // A variant follows its file's plain shader.
        if shader.features.is_empty() {
            body(&text).clone_into(&mut plain);
        } else if body(&text) == plain {
            let Shader { path, features, .. } = shader;
            return Err(format!("src/{path}.wesl: the variant `{features}` changes nothing: is it misspelt?"));
        }
        files.insert(format!("{}.wgsl", shader.linked()), text);
    }
    Ok(files)
}

/// Returns a linked text without its first line, which names the variant.
fn body(text: &str) -> &str {
    text.split_once('\n').map_or("", |(_, body)| body)
}

/// Returns a shader's text, linked from the modules under `sources`.
///
/// # Errors
/// The reason why it does not link.
pub fn link(sources: &Path, shader: &Shader) -> Result<String, String> {
    let Shader { path, features, .. } = shader;
    let mut compiler = Wesl::new(sources);
    compiler.set_custom_mangler(ByFile);
    compiler.set_missing_feature_behavior(false);
    for feature in features.split('+').filter(|feature| !feature.is_empty()) {
        compiler.set_feature(feature, true);
    }
    let module: ModulePath = format!("package::{}", path.replace('/', "::"))
        .parse()
        .map_err(|error| format!("src/{path}.wesl: its path is not a module path: {error}"))?;
    let mut linked = compiler.compile(&module).map_err(|error| format!("src/{path}.wesl does not link:\n{error}"))?;
    order(&mut linked);
    if let Some(name) = first_twice(&linked) {
        return Err(format!(
            "src/{path}.wesl does not link: two files with the same name both declare `{name}`; rename one of the files"
        ));
    }
    let with = if features.is_empty() { String::new() } else { format!(" with {features}") };
    Ok(format!("// Linked from src/{path}.wesl{with} by `{COMMAND}`: edit that, not this.\n\n{linked}"))
}

/// Mangler that names imported items by file and item: `space_LightViewGpu`. Names with the whole path took two fifths of the
/// shader text that browsers download.
struct ByFile;

impl Mangler for ByFile {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        path.components.last().map_or_else(|| item.to_owned(), |file| format!("{file}_{item}"))
    }
}

/// Returns the first name that is declared twice.
fn first_twice(linked: &CompileResult) -> Option<String> {
    let mut names: Vec<String> =
        linked.syntax.global_declarations.iter().filter_map(|one| name_of(one.node())).collect();
    names.sort_unstable();
    names.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0].clone())
}

/// Returns the name of a declaration. Declarations without a name have no module either.
fn name_of(declaration: &GlobalDeclaration) -> Option<String> {
    match declaration {
        GlobalDeclaration::Declaration(declaration) => Some(declaration.ident.to_string()),
        GlobalDeclaration::TypeAlias(alias) => Some(alias.ident.to_string()),
        GlobalDeclaration::Struct(structure) => Some(structure.ident.to_string()),
        GlobalDeclaration::Function(function) => Some(function.ident.to_string()),
        GlobalDeclaration::ConstAssert(_) | GlobalDeclaration::Void => None,
    }
}

/// Orders the modules: the shader's own first, then by path, each in the order of its source. The linker visits entry points in a hash
/// set, so with several of them its order differs between runs.
fn order(linked: &mut CompileResult) {
    let CompileResult { syntax, sourcemap, .. } = linked;
    syntax.global_directives.sort_by_cached_key(ToString::to_string);
    syntax.global_directives.dedup();
    syntax.global_declarations.sort_by_cached_key(|declaration| {
        // Declarations without a name come last, ordered by text.
        let Some(name) = name_of(declaration.node()) else { return (true, declaration.to_string()) };
        // The shader's own names are not mangled and therefore not in the source map.
        (false, sourcemap.get_decl(&name).map_or_else(String::new, |(module, _)| module.to_string()))
    });
}

/// Returns the text of every file under a folder, by its path with `/` separators.
///
/// # Errors
/// A file or folder that cannot be read. A folder that does not exist is empty.
pub fn texts_in(folder: &Path) -> Result<BTreeMap<String, String>, String> {
    let mut texts = BTreeMap::new();
    let mut folders = vec![String::new()];
    while let Some(inner) = folders.pop() {
        let path = folder.join(&inner);
        let unreadable = |error: std::io::Error| format!("cannot read {}: {error}", path.display());
        let entries = match std::fs::read_dir(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound && inner.is_empty() => break,
            entries => entries.map_err(unreadable)?,
        };
        for entry in entries {
            let entry = entry.map_err(unreadable)?;
            let name = format!("{inner}{}", entry.file_name().to_string_lossy());
            if entry.file_type().map_err(unreadable)?.is_dir() {
                folders.push(format!("{name}/"));
            } else {
                // Lossy, so that a binary file is reported as one that does not belong here.
                let bytes = std::fs::read(entry.path()).map_err(unreadable)?;
                texts.insert(name, String::from_utf8_lossy(&bytes).into_owned());
            }
        }
    }
    Ok(texts)
}

/// Returns one line for each file of `linked/` that differs from what the sources link to.
#[cfg(test)]
fn faults(linked: &BTreeMap<String, String>, committed: &BTreeMap<String, String>) -> Vec<String> {
    let fault = |file: &String, what: &str| format!("crates/antumbra/linked/{file} {what}: run `{COMMAND}`");
    let outdated = linked.iter().filter_map(|(file, text)| match committed.get(file) {
        None => Some(fault(file, "is missing")),
        Some(other) if other != text => Some(fault(file, "is out of date")),
        Some(_) => None,
    });
    let stale = committed.keys().filter(|file| !linked.contains_key(*file));
    outdated.chain(stale.map(|file| fault(file, "belongs to no shader of src"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linked_shaders_are_what_their_sources_link_to() {
        let linked = link_all(&library().join("src")).unwrap_or_else(|fault| panic!("{fault}"));
        let committed = texts_in(&library().join("linked")).unwrap_or_else(|fault| panic!("{fault}"));
        let faults = faults(&linked, &committed);
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    }

    #[test]
    fn old_missing_and_stale_files_are_named_with_the_command() {
        let texts = |files: &[(&str, &str)]| {
            files.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())).collect::<BTreeMap<_, _>>()
        };
        let linked = texts(&[("a.wgsl", "new"), ("b.wgsl", "same"), ("c.wgsl", "new")]);
        let committed = texts(&[("a.wgsl", "old"), ("b.wgsl", "same"), ("d.wgsl", "left over")]);
        let expected = [
            "crates/antumbra/linked/a.wgsl is out of date: run `cargo xtask shaders`",
            "crates/antumbra/linked/c.wgsl is missing: run `cargo xtask shaders`",
            "crates/antumbra/linked/d.wgsl belongs to no shader of src: run `cargo xtask shaders`",
        ];
        assert_eq!(faults(&linked, &committed), expected);
    }
}
