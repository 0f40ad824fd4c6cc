//! Check that each family of techniques compiles without the others, and that scenes load without C++.

use std::time::Instant;

use crate::shell::{self, cargo};

/// Checks the library with one feature at a time, for all features in its `default`; then tests the loader without its C++ decoder, as in
/// browsers.
///
/// # Errors
/// A family that does not compile alone, or a manifest in which no families are found.
pub fn check() -> Result<(), String> {
    let began = Instant::now();
    let manifest = crate::root().join("crates/antumbra/Cargo.toml");
    let text = std::fs::read_to_string(&manifest).map_err(|error| format!("{}: {error}", manifest.display()))?;
    let families = default_features(&text);
    if families.is_empty() {
        return Err(format!("{}: no features in `default`", manifest.display()));
    }
    for family in &families {
        let alone =
            ["check", "--quiet", "--locked", "--package", "antumbra", "--no-default-features", "--features", family];
        shell::run(cargo().args(alone)).map_err(|problem| format!("antumbra with only `{family}`: {problem}"))?;
    }
    // Its dependencies are rebuilt for a short run, so nothing is optimised.
    let without_decoder =
        ["test", "--quiet", "--locked", "--package", "antumbra-scene", "--no-default-features", "--lib", "decoder"];
    shell::run(cargo().args(without_decoder).env("CARGO_PROFILE_DEV_OPT_LEVEL", "0"))?;
    eprintln!("xtask: checked {} families separately in {} s", families.len(), began.elapsed().as_secs());
    Ok(())
}

/// Returns the quoted words in the line of `default`.
fn default_features(manifest: &str) -> Vec<&str> {
    let default = manifest.lines().find_map(|line| line.strip_prefix("default = "));
    default.unwrap_or_default().split('"').skip(1).step_by(2).collect()
}

#[cfg(test)]
mod tests {
    use super::default_features;

    #[test]
    fn features_are_read_off_the_manifest() {
        assert_eq!(default_features("[features]\ndefault = [\"a\", \"b_c\"]\na = []\n"), ["a", "b_c"]);
        assert!(default_features("[features]\na = []\n").is_empty());
    }
}
