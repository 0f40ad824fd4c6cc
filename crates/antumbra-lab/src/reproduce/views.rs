//! Views of the papers: setup files for scenes without a camera, or with another one than the paper's.

/// Name and setup file of each view.
pub const VIEWS: &[(&str, &str)] = &[
    ("sponza-hall", include_str!("views/sponza-hall.toml")),
    ("sponza-atrium", include_str!("views/sponza-atrium.toml")),
    ("tree-near", include_str!("views/tree-near.toml")),
    ("fence-close", include_str!("views/fence-close.toml")),
    ("all-penumbra", include_str!("views/all-penumbra.toml")),
    ("sky", include_str!("views/sky.toml")),
    ("fence-distant", include_str!("views/fence-distant.toml")),
];

/// Returns a view's setup file.
///
/// # Panics
/// If there is no such view; a test checks that rows name existing ones.
pub(super) fn view_named(name: &str) -> &'static str {
    VIEWS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text).expect("a row names a view that there is")
}
