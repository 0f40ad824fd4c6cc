//! Cameras of the papers: setup files for scenes whose file has no camera, or whose own is not the paper's view.

/// Each view's name, and its setup file.
pub const VIEWS: &[(&str, &str)] = &[
    ("sponza-hall", include_str!("views/sponza-hall.toml")),
    ("sponza-atrium", include_str!("views/sponza-atrium.toml")),
    ("tree-near", include_str!("views/tree-near.toml")),
    ("fence-close", include_str!("views/fence-close.toml")),
    ("all-penumbra", include_str!("views/all-penumbra.toml")),
    ("sky", include_str!("views/sky.toml")),
    ("fence-distant", include_str!("views/fence-distant.toml")),
];

/// A view's setup file.
///
/// # Panics
/// Where there is none: rows and views are both ours, and a test looks.
pub(super) fn view_named(name: &str) -> &'static str {
    VIEWS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text).expect("a row names a view that there is")
}
