//! The command `antumbra`.
fn main() {}
