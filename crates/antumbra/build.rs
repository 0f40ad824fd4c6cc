//! Links each WESL shader listed in `src/shaders.rs` to plain WGSL under `OUT_DIR`, at the same path.

use std::path::Path;

use wesl::{ModulePath, Wesl};

macro_rules! shaders {
    ($( $(#[$doc:meta])* $name:ident = $path:literal $(with $feature:literal)?; )+) => {
        /// Paths, each with the features that its conditional parts are compiled for, joined by `+`.
        const SHADERS: &[(&str, &str)] = &[$( ($path, concat!($($feature)?)), )+];
    };
}

include!("src/shaders.rs");

fn main() {
    println!("cargo::rerun-if-changed=src");
    let out_dir = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR for build scripts");
    for (path, feature) in SHADERS {
        let mut compiler = Wesl::new("src");
        compiler.set_missing_feature_behavior(false);
        for feature in feature.split('+').filter(|feature| !feature.is_empty()) {
            compiler.set_feature(feature, true);
        }
        let module: ModulePath =
            format!("package::{}", path.replace('/', "::")).parse().expect("a path of src/shaders.rs");
        let linked = match compiler.compile(&module) {
            Ok(linked) => linked.to_string(),
            Err(error) => panic!("src/{path}.wesl does not link:\n{error}"),
        };
        let target = Path::new(&out_dir).join(format!("{path}{feature}.wgsl"));
        std::fs::create_dir_all(target.parent().expect("shader paths have a folder")).expect("OUT_DIR is writable");
        std::fs::write(&target, linked).expect("OUT_DIR is writable");
    }
}
