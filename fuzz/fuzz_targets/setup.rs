//! Fuzz target of arbitrary text as a setup file: an error of one line, or a setup that survives writing and reading.
#![no_main]

use antumbra_scene::Setup;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Setup::from_toml(text, "fuzz.toml".as_ref()) {
        Ok(setup) => {
            Setup::from_toml(&setup.to_toml(), "fuzz.toml".as_ref()).expect("a setup reads what it wrote");
        }
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
    }
});
