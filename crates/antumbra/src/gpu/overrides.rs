//! Overridable constants of shaders, by name.
//!
//! A source declares `override NAME: type = default;`, and Rust sets the value by that name, without a number. The linker may
//! prefix a name with its module path, so the name in the linked shader is looked up here.

/// Returns overridable constants with their names in a linked shader.
///
/// # Panics
/// If the shader has no constant of a name, or several.
pub(crate) fn linked(wgsl: &str, constants: &[(&str, f64)]) -> Vec<(String, f64)> {
    if constants.is_empty() {
        return Vec::new();
    }
    // A shader is long and has tens of constants, so it is read once for all of them.
    let names: Vec<&str> = names(wgsl).collect();
    let linked_name = |name: &str| {
        linked_name(&names, name)
            .unwrap_or_else(|| panic!("no `override {name}` in a shader that begins with {:?}", wgsl.lines().next()))
    };
    constants.iter().map(|(name, value)| (linked_name(name).to_owned(), *value)).collect()
}

/// Returns the name that the linker generated from `name`, or `None`.
fn linked_name<'s>(names: &[&'s str], name: &str) -> Option<&'s str> {
    if let Some(exact) = names.iter().find(|linked| **linked == name) {
        return Some(exact);
    }
    let found: Vec<&str> = names.iter().copied().filter(|linked| is_linked_name(linked, name)).collect();
    match found[..] {
        [] => None,
        [only] => Some(only),
        [one, other, ..] => panic!("`override {name}` is {one} or {other}"),
    }
}

/// Names of all overrides of a shader.
fn names(wgsl: &str) -> impl Iterator<Item = &str> {
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    wgsl.split("override ").skip(1).filter_map(move |rest| rest.split(|c| !is_of_name(c)).next())
}

/// Whether a name in a linked shader is that of a module: the linker prefixes the module path and, for names with
/// underscores, their number.
pub(crate) fn is_linked_name(linked: &str, name: &str) -> bool {
    let underscores = name.matches('_').count();
    linked == name || linked.ends_with(&format!("_{name}")) || linked.ends_with(&format!("_{underscores}{name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHADER: &str = "override PART: u32 = 0u;\noverride uniform_BASIS: u32 = 0u;\noverride a_1OF_ALL = 1;\n\
                          override ACCUMULATION: u32;override LIST_ACCUMULATION: u32;override b_PART: u32;";

    #[test]
    fn names_are_found_with_and_without_a_path() {
        let linked = linked(SHADER, &[("PART", 1.0), ("BASIS", 2.0), ("OF_ALL", 3.0), ("ACCUMULATION", 4.0)]);
        let names: Vec<&str> = linked.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["PART", "uniform_BASIS", "a_1OF_ALL", "ACCUMULATION"]);
    }

    #[test]
    #[should_panic(expected = "no `override PARTS`")]
    fn a_name_that_no_override_has_is_a_fault() {
        linked(SHADER, &[("PARTS", 1.0)]);
    }

    /// Rust would have to repeat the numbers.
    #[test]
    fn no_shader_numbers_its_overrides() {
        for (path, wgsl) in crate::shaders::ALL {
            assert!(!wgsl.contains("@id("), "{path}");
        }
    }
}
