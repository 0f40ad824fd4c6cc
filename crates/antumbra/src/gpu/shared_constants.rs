//! Constants that Rust and shaders share, each compared with the linked shaders by a test.

/// Declares constants that have the same name and value in a linked shader, `as in SHADER`, a constant of `shaders`. Use
/// it at most once per module; its test is `in_shaders::constants_are_the_same`.
macro_rules! shared_constants {
    ($( $(#[$outer:meta])* $visibility:vis const $name:ident: $ty:ty = $value:expr, as in $shader:ident; )+) => {
        $( $(#[$outer])* $visibility const $name: $ty = $value; )+

        #[cfg(test)]
        mod in_shaders {
            #[test]
            fn constants_are_the_same() {
                $( $crate::gpu::shared_constants::assert_in_shader(
                    (stringify!($shader), $crate::shaders::$shader),
                    stringify!($name),
                    super::$name as f64,
                ); )+
            }
        }
    };
}

pub(crate) use shared_constants;

/// Asserts that a linked shader, given with its name, has a constant of this name and value.
#[cfg(test)]
pub(crate) fn assert_in_shader((shader, wgsl): (&str, &'static str), name: &str, value: f64) {
    let in_shader =
        constant_of(wgsl, name).unwrap_or_else(|| panic!("{shader} has no constant {name} with its type written"));
    assert_eq!(in_shader, value, "{shader}: {name}");
}

/// Value of a constant of a linked shader, or `None`.
#[cfg(test)]
pub(crate) fn constant_of(wgsl: &'static str, name: &str) -> Option<f64> {
    let module = naga::front::wgsl::parse_str(&crate::shaders::text_of(wgsl)).expect("valid");
    let is_named = |linked: &str| super::overrides::is_linked_name(linked, name);
    let (_, constant) = module.constants.iter().find(|(_, constant)| constant.name.as_deref().is_some_and(is_named))?;
    match module.global_expressions[constant.init] {
        naga::Expression::Literal(naga::Literal::F32(value)) => Some(f64::from(value)),
        naga::Expression::Literal(naga::Literal::U32(value)) => Some(f64::from(value)),
        naga::Expression::Literal(naga::Literal::I32(value)) => Some(f64::from(value)),
        naga::Expression::Literal(naga::Literal::AbstractInt(value)) => Some(value as f64),
        naga::Expression::Literal(naga::Literal::AbstractFloat(value)) => Some(value),
        ref other => panic!("{name} is {other:?}"),
    }
}
