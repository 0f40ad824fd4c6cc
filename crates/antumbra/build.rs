//! Links each WESL shader listed in `src/shaders.rs` to plain WGSL under `OUT_DIR`, at the same path.

use std::path::Path;

use wesl::{ModulePath, Wesl};

macro_rules! shaders {
    ($( $(#[$doc:meta])* $name:ident = $path:literal; )+) => {
        const SHADERS: &[&str] = &[$( $path, )+];
    };
}

include!("src/shaders.rs");

fn main() {
    println!("cargo::rerun-if-changed=src");
    let out_dir = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR for build scripts");
    let compiler = Wesl::new("src");
    for path in SHADERS {
        let module: ModulePath =
            format!("package::{}", path.replace('/', "::")).parse().expect("a path of src/shaders.rs");
        let linked = match compiler.compile(&module) {
            Ok(linked) => linked.to_string(),
            Err(error) => panic!("src/{path}.wesl does not link:\n{error}"),
        };
        let target = Path::new(&out_dir).join(format!("{path}.wgsl"));
        std::fs::create_dir_all(target.parent().expect("shader paths have a folder")).expect("OUT_DIR is writable");
        std::fs::write(&target, linked).expect("OUT_DIR is writable");
    }
}
