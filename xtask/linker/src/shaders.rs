//! Shaders of the library, as its sources declare them. Each `.wesl` file with an entry point is one. A line `// Variants: FEATURES, …`
//! at its head adds one for each set of features, joined by `+`, which compiles what is marked `@if(feature)`.

use std::collections::BTreeMap;

/// Lines at the head of a shader that name its variants, and those that only tests use.
const VARIANTS: &str = "// Variants: ";
const TEST_VARIANTS: &str = "// Variants of tests: ";

/// Shader of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shader {
    /// Path of the `.wesl` file under `src/`, without extension.
    pub path: String,
    /// Features of its conditional parts, joined by `+`; empty without features.
    pub features: String,
    /// Whether only tests use it.
    pub is_of_tests: bool,
}

impl Shader {
    /// Path of the linked text under `linked/`, without extension. Shaders of tests have a folder that is not packaged.
    pub fn linked(&self) -> String {
        let folder = if self.is_of_tests { "test/" } else { "" };
        format!("{folder}{}", self.name())
    }

    /// Path with features.
    pub fn name(&self) -> String {
        let Self { path, features, .. } = self;
        if features.is_empty() { path.clone() } else { format!("{path}.{features}") }
    }

    /// Name of the library's constant: folder, file and features. A folder that ends like its file stands alone: `fade/fade` is `FADE`.
    pub fn constant(&self) -> String {
        let (folders, file) = self.path.rsplit_once('/').unwrap_or(("", &self.path));
        let folder = folders.rsplit('/').next().unwrap_or_default();
        let ends_alike = folder == file || folder.ends_with(&format!("_{file}"));
        let file = if ends_alike { "" } else { file };
        let words = [folder, file, &self.features].into_iter().filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join("_").replace('+', "_").to_uppercase()
    }
}

/// Returns the shaders among the texts of sources by path, in that order.
///
/// # Errors
/// A head that cannot be understood, or two shaders with the same constant.
pub fn shaders(texts: &BTreeMap<String, String>) -> Result<Vec<Shader>, String> {
    let mut shaders = Vec::new();
    for (file, text) in texts {
        if let Some(path) = file.strip_suffix(".wesl")
            && has_entry_point(text)
        {
            shaders.extend(shaders_of(path, text)?);
        }
    }
    let mut paths = BTreeMap::new();
    for shader in &shaders {
        if let Some(other) = paths.insert(shader.constant(), shader.name()) {
            let (name, constant) = (shader.name(), shader.constant());
            return Err(format!("src/{other} and src/{name} would both be `shaders::{constant}`: rename a file"));
        }
    }
    Ok(shaders)
}

fn has_entry_point(text: &str) -> bool {
    let code = text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code));
    code.into_iter().any(|line| ["@compute", "@vertex", "@fragment"].iter().any(|entry| line.contains(entry)))
}

/// Returns a file's shaders: itself and its variants.
fn shaders_of(path: &str, text: &str) -> Result<Vec<Shader>, String> {
    let is_probe = path.ends_with("probe");
    let mut shaders = vec![Shader { path: path.to_owned(), features: String::new(), is_of_tests: is_probe }];
    for line in text.lines().take_while(|line| line.starts_with("//")) {
        let of_tests = line.strip_prefix(TEST_VARIANTS).map(|list| (list, true));
        let Some((list, is_of_tests)) = of_tests.or(line.strip_prefix(VARIANTS).map(|list| (list, is_probe))) else {
            continue;
        };
        for features in list.split(", ") {
            let is_name = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
            if !features.split('+').all(is_name) {
                return Err(format!(
                    "src/{path}.wesl: `{features}` names no features, such as `float` or `encoded+float`"
                ));
            }
            shaders.push(Shader { path: path.to_owned(), features: features.to_owned(), is_of_tests });
        }
    }
    Ok(shaders)
}

/// Returns the library's list of shaders, which it includes: constants with the paths of their linked texts.
pub fn list(shaders: &[Shader]) -> String {
    let entries = shaders.iter().map(|shader| {
        let condition = if shader.is_of_tests { "    #[cfg(test)]\n" } else { "" };
        format!("{condition}    {} = \"{}\";\n", shader.constant(), shader.linked())
    });
    format!(
        "// Written by `{}` from the `.wesl` files under `src/` that have an entry point: edit those, not this.\n\nshaders! {{\n{}}}\n",
        crate::COMMAND,
        entries.collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_names_variants() {
        let text = "// Sums.\n// Variants: float, encoded+float\n// Variants of tests: count\n\n// Variants: not_of_the_head\n@compute";
        let found = shaders_of("a/sums/sum", text).expect("a good head");
        let found: Vec<_> = found.iter().map(|shader| (shader.constant(), shader.linked())).collect();
        let expected = [
            ("SUMS_SUM", "a/sums/sum"),
            ("SUMS_SUM_FLOAT", "a/sums/sum.float"),
            ("SUMS_SUM_ENCODED_FLOAT", "a/sums/sum.encoded+float"),
            ("SUMS_SUM_COUNT", "test/a/sums/sum.count"),
        ];
        assert_eq!(found, expected.map(|(constant, linked)| (constant.to_owned(), linked.to_owned())));
        for bad in ["// Variants: ", "// Variants: Float", "// Variants: float,count", "// Variants: a+"] {
            assert!(shaders_of("a/sum", bad).is_err_and(|error| error.contains("names no features")), "{bad}");
        }
    }

    #[test]
    fn constants_are_folder_and_file() {
        let constant = |path: &str| shaders_of(path, "").expect("no head")[0].constant();
        assert_eq!(constant("techniques/single_map/hard/resolve"), "HARD_RESOLVE");
        assert_eq!(constant("mask/fade/fade"), "FADE");
        assert_eq!(constant("primitives/prefix_scan/scan"), "PREFIX_SCAN");
        assert_eq!(constant("primitives/rescan/scan"), "RESCAN_SCAN");
    }

    #[test]
    fn an_entry_point_in_a_comment_is_none() {
        assert!(has_entry_point("fn f() {}\n@if(a) @compute @workgroup_size(1)\nfn main() {}"));
        assert!(!has_entry_point("// for passes with @compute\nfn f() {} // @vertex"));
    }

    /// Probes print a block's values for its tests.
    #[test]
    fn probes_are_of_tests() {
        let texts = crate::texts_in(&crate::library().join("src"));
        let shaders = texts.and_then(|texts| shaders(&texts)).unwrap_or_else(|fault| panic!("{fault}"));
        let of_tests = shaders.iter().filter(|shader| shader.is_of_tests);
        assert!(of_tests.clone().count() >= 10, "{:?}", of_tests.collect::<Vec<_>>());
        assert!(shaders.iter().filter(|shader| shader.path.ends_with("probe")).all(|shader| shader.is_of_tests));
    }
}
