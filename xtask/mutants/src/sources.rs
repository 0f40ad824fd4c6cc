//! Shader sources of the library, the sources that each shader is linked from, and the shaders that result from a change.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use antumbra_linker::{Shader, library, link, shaders, texts_in};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::places::Change;

/// All `.wesl` files of the library.
pub struct Sources {
    /// Text by path under `src/`.
    pub texts: BTreeMap<String, String>,
    /// Shaders of the library.
    shaders: Vec<Shader>,
    /// Current linked text of each shader.
    linked: Vec<String>,
    /// Sources that each shader is linked from.
    parts: Vec<BTreeSet<String>>,
}

/// Effect of a change on the shaders.
pub enum MutationEffect {
    /// New texts, by the library's names of the changed shaders: see [`changed_name`].
    Shaders(BTreeMap<String, String>),
    /// Not a mutant: one of the shaders does not compile, or none changes.
    Nothing(&'static str),
}

impl Sources {
    /// # Errors
    /// A file that cannot be read, or a shader that does not link.
    pub fn read() -> Result<Self, String> {
        let root = library().join("src");
        let mut texts = texts_in(&root)?;
        let shaders = shaders(&texts)?;
        texts.retain(|file, _| file.ends_with(".wesl"));
        let linked = shaders.iter().map(|shader| link(&root, shader)).collect::<Result<_, _>>()?;
        let parts = shaders.iter().map(|shader| parts_of(&texts, &format!("{}.wesl", shader.path))).collect();
        Ok(Self { texts, shaders, linked, parts })
    }

    /// Applies a change to a source in a separate folder with all sources, and links the shaders that depend on it.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn make(&self, folder: &Folder, file: &str, change: &Change) -> Result<MutationEffect, String> {
        let mut text = self.texts[file].clone();
        text.replace_range(change.start..change.end, &change.to);
        folder.write(file, &text)?;
        let made = self.link_changed(folder, file);
        folder.write(file, &self.texts[file])?;
        Ok(made)
    }

    fn link_changed(&self, folder: &Folder, file: &str) -> MutationEffect {
        let mut shaders = BTreeMap::new();
        for (i, shader) in self.shaders.iter().enumerate().filter(|(i, _)| self.parts[*i].contains(file)) {
            let Ok(text) = link(&folder.sources, shader) else { return MutationEffect::Nothing("does not link") };
            if text == self.linked[i] {
                continue;
            }
            if !is_valid(&text) {
                return MutationEffect::Nothing("does not compile");
            }
            shaders.insert(changed_name(shader), text);
        }
        if shaders.is_empty() { MutationEffect::Nothing("changes no shader") } else { MutationEffect::Shaders(shaders) }
    }
}

/// Folder of a worker: all sources, the changed shaders, and notes of the shaders that a test used.
pub struct Folder {
    sources: PathBuf,
    pub changed: PathBuf,
    pub seen: PathBuf,
}

impl Folder {
    /// # Errors
    /// If it cannot be written.
    pub fn new(path: &Path, sources: &Sources) -> Result<Self, String> {
        let folder = Self { sources: path.join("src"), changed: path.join("changed"), seen: path.join("seen") };
        sources.texts.iter().try_for_each(|(file, text)| folder.write(file, text))?;
        Ok(folder)
    }

    fn write(&self, file: &str, text: &str) -> Result<(), String> {
        write(&self.sources.join(file), text)
    }

    /// Removes the notes of used shaders.
    ///
    /// # Errors
    /// If the notes cannot be removed.
    pub fn clear_seen(&self) -> Result<(), String> {
        empty(&self.seen)
    }

    /// Returns the shaders used since [`Self::clear_seen`]. The library's notes have `=` for `/`.
    ///
    /// # Errors
    /// If the notes cannot be read.
    pub fn shaders_seen(&self) -> Result<BTreeSet<String>, String> {
        let notes = std::fs::read_dir(&self.seen).map_err(|error| format!("{}: {error}", self.seen.display()))?;
        Ok(notes.filter_map(Result::ok).map(|note| note.file_name().to_string_lossy().replace('=', "/")).collect())
    }

    /// Writes changed shaders where the tests look for them, in place of the previous ones.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn put(&self, shaders: &BTreeMap<String, String>) -> Result<(), String> {
        empty(&self.changed)?;
        shaders.iter().try_for_each(|(name, text)| write(&self.changed.join(name), text))
    }
}

/// Creates an empty folder, or empties it.
fn empty(folder: &Path) -> Result<(), String> {
    let unable = |error| format!("{}: {error}", folder.display());
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(unable)?;
    }
    std::fs::create_dir_all(folder).map_err(unable)
}

/// Writes a file, and creates its folder if missing.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    path.parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(path, text))
        .map_err(|error| format!("cannot write {}: {error}", path.display()))
}

/// Returns the name of a shader in the library's feature `mutants` (`gpu/mutants.rs`): its path and its features.
pub fn changed_name(shader: &Shader) -> String {
    format!("{}.wgsl", shader.name())
}

/// Returns a source and everything that it imports, by the paths after `package::`.
fn parts_of(texts: &BTreeMap<String, String>, file: &str) -> BTreeSet<String> {
    let mut parts = BTreeSet::new();
    let mut open = vec![file.to_owned()];
    while let Some(file) = open.pop() {
        let Some(text) = texts.get(&file).filter(|_| parts.insert(file.clone())) else { continue };
        for path in text.split("package::").skip(1) {
            let end = path.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == ':')).unwrap_or(path.len());
            let names: Vec<&str> = path[..end].split("::").collect();
            let mut modules = (1..=names.len()).rev().map(|n| format!("{}.wesl", names[..n].join("/")));
            open.extend(modules.find(|module| texts.contains_key(module)));
        }
    }
    parts
}

/// Whether a shader compiles by WebGPU's own rules, as the library's must.
fn is_valid(wgsl: &str) -> bool {
    let core = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    naga::front::wgsl::parse_str(wgsl)
        .is_ok_and(|module| Validator::new(ValidationFlags::all(), core).validate(&module).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shader's parts are its source and all direct and indirect imports, and no others.
    #[test]
    fn parts_are_what_is_imported_and_what_that_imports() {
        let text = |text: &str| text.to_owned();
        let texts = BTreeMap::from([
            (text("a/main.wesl"), text("import package::b::far::{f, g};\nfn main() { package::c::h(); }")),
            (text("b/far.wesl"), text("import package::d::one;")),
            (text("c.wesl"), text("fn h() {}")),
            (text("d.wesl"), text("const one = 1;")),
            (text("e.wesl"), text("import package::d::one;")),
        ]);
        let parts: Vec<_> = parts_of(&texts, "a/main.wesl").into_iter().collect();
        assert_eq!(parts, ["a/main.wesl", "b/far.wesl", "c.wesl", "d.wesl"]);
    }

    #[test]
    fn what_does_not_compile_is_no_mutant() {
        assert!(is_valid("@compute @workgroup_size(1) fn main() { var a = 1 + 1; a += 1; }"));
        assert!(!is_valid("@compute @workgroup_size(1) fn main() { var a = 1u + 1i; }"));
    }
}
