//! Text of Bevy's shader with masks in it. Separate from Bevy, so that it is tested where Bevy is not built.

/// Line that adds a light's contribution, for points, spots and suns in this order.
const ADDED: &str = "direct_light += light_contrib * shadow;";
/// Line that adds a rectangle's contribution.
const ADDED_RECTANGLE: &str = "direct_light += light_contrib;";
/// Expression of each light's mask number, in the same order.
const MASKS: [&str; 3] =
    ["antumbra_mask_of_clustered(light_id)", "antumbra_mask_of_clustered(light_id)", "antumbra_mask_of_directional(i)"];
/// Names of the shader that the added functions use.
const NAMES: [&str; 3] = ["mesh_view_bindings as view_bindings", "mesh_view_types", "MESH_FLAGS_SHADOW_RECEIVER_BIT"];
const FUNCTIONS: &str = include_str!("patch.wesl");

/// Reason why the shader cannot be patched.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatchError {
    /// The number of times that a line occurs is not the expected one.
    #[error("`{line}` occurs {had} times, expected {needed}")]
    Count {
        /// The line.
        line: &'static str,
        /// Number of times that it occurs.
        had: usize,
        /// Expected number.
        needed: usize,
    },
}

/// Returns the shader with masks in it.
///
/// # Errors
/// If the lines to change are not those of Bevy 0.20.
pub fn patched(shader: &str) -> Result<String, PatchError> {
    let count = |line: &'static str, needed| {
        let had = shader.matches(line).count();
        if had == needed { Ok(()) } else { Err(PatchError::Count { line, had, needed }) }
    };
    count(ADDED, MASKS.len())?;
    count(ADDED_RECTANGLE, 1)?;
    for name in NAMES {
        if !shader.contains(name) {
            return Err(PatchError::Count { line: name, had: 0, needed: 1 });
        }
    }
    let visibility =
        |mask: &str, shadow: &str| format!("antumbra_visibility({mask}, {shadow}, in.frag_coord, in.flags)");
    let mut text = String::with_capacity(shader.len() + FUNCTIONS.len() + 512);
    let mut parts = shader.split(ADDED);
    text.extend(parts.next());
    for (part, mask) in parts.zip(MASKS) {
        text += &format!("direct_light += light_contrib * {};", visibility(mask, "shadow"));
        text += part;
    }
    let of_rectangle =
        format!("direct_light += light_contrib * {};", visibility("antumbra_mask_of_rectangle(light.range)", "1.0"));
    let mut text = text.replace(ADDED_RECTANGLE, &of_rectangle);
    text += FUNCTIONS;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIKE_BEVY: &str =
        "import mesh_view_bindings as view_bindings, mesh_view_types, MESH_FLAGS_SHADOW_RECEIVER_BIT;
        { direct_light += light_contrib * shadow; } { direct_light += light_contrib * shadow; }
        { direct_light += light_contrib * shadow; } { direct_light += light_contrib; }";

    #[test]
    fn each_light_is_multiplied_by_its_own_mask() {
        let text = patched(LIKE_BEVY).unwrap();
        let body = text.strip_suffix(FUNCTIONS).unwrap();
        let order: Vec<_> = body.match_indices("antumbra_mask_of_").map(|(at, _)| &body[at + 17..at + 22]).collect();
        assert_eq!(order, ["clust", "clust", "direc", "recta"]);
        assert_eq!(body.matches("antumbra_visibility(").count(), 4);
        assert_eq!(text.matches("fn antumbra_visibility(").count(), 3, "of one sample, of several, without");
    }

    #[test]
    fn another_shader_is_left_alone() {
        let fewer = LIKE_BEVY.replacen(ADDED, "", 1);
        assert_eq!(patched(&fewer), Err(PatchError::Count { line: ADDED, had: 2, needed: 3 }));
        assert!(patched(&LIKE_BEVY.replace("mesh_view_types", "")).is_err());
        assert!(patched("").is_err());
    }
}
