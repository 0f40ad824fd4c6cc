//! Comparison of structs with the shaders that share them.

use super::GpuStruct;
use crate::shaders;

/// Asserts that at least one linked shader has this struct, and that its layout is the same in each of them. A struct of the same name
/// that shares no member is another one.
pub(crate) fn assert_same_layout<T: GpuStruct>() {
    let mut is_found = false;
    for (path, wgsl) in shaders::ALL.iter().filter(|(_, wgsl)| wgsl.lines().any(is_struct::<T>)) {
        let module = naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|error| panic!("{path}: {error}"));
        let structs = module.types.iter().filter_map(|(_, ty)| match (&ty.name, &ty.inner) {
            (Some(name), naga::TypeInner::Struct { members, span }) if is_named::<T>(name) => Some((members, *span)),
            _ => None,
        });
        let is_shared = |name: &Option<String>| T::FIELDS.iter().any(|field| name.as_deref() == Some(field.name));
        for (members, span) in structs.filter(|(members, _)| members.iter().any(|m| is_shared(&m.name))) {
            is_found = true;
            let size_of_type = |ty| module.types[ty].inner.size(module.to_ctx()) as usize;
            let in_shader: Vec<_> = members
                .iter()
                .map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize, size_of_type(m.ty)))
                .collect();
            let in_rust: Vec<_> = T::FIELDS.iter().map(|f| (f.name.to_owned(), f.offset, f.size)).collect();
            assert_eq!(in_shader, in_rust, "{path}: struct {}", T::WGSL_NAME);
            assert_eq!(span as usize, size_of::<T>(), "{path}: size of struct {}", T::WGSL_NAME);
        }
    }
    assert!(is_found, "no shader has a struct {}", T::WGSL_NAME);
}

/// Whether a line of a linked shader begins the struct.
fn is_struct<T: GpuStruct>(line: &str) -> bool {
    line.strip_prefix("struct ").and_then(|rest| rest.strip_suffix(" {")).is_some_and(is_named::<T>)
}

/// Whether a linked name is the struct's: the linker puts the file's name before it, and the structs' names have no underscore.
fn is_named<T: GpuStruct>(linked: &str) -> bool {
    linked.rsplit('_').next() == Some(T::WGSL_NAME)
}
