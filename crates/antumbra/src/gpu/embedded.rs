//! Techniques as functions for hosts' shaders: WGSL to prepend to the host's shader, and one bind group.
//!
//! The text is a linked shader, adapted for inclusion in another: its bindings are in one group of the host's choice, its
//! constants have their values, its entry point is removed, and all names that it declares have a prefix of the host's choice,
//! so that a shader can include several lights.

use std::collections::HashSet;
use std::sync::Arc;

use super::{Bindings, Resource, overrides};

/// Offset, in the host's group, between the bindings of consecutive groups of a linked shader.
const BINDINGS_PER_GROUP: u32 = 16;

/// Shader and resources of a technique for a host's shader, from the last prepared frame.
#[derive(Debug)]
pub struct Embeddable {
    /// Linked text with a function `visibility_at`.
    pub(crate) wgsl: &'static str,
    /// Values of overridable constants, by name.
    pub(crate) constants: Vec<(&'static str, f64)>,
    /// Layout and resources of each group of the linked text.
    pub(crate) groups: Vec<EmbeddedGroup>,
    /// Whether the bound resources retain the frame's content until the light's next frame.
    pub(crate) is_own: bool,
}

/// Bind group of a linked shader.
#[derive(Debug)]
pub(crate) struct EmbeddedGroup {
    layout: Vec<wgpu::BindGroupLayoutEntry>,
    bound: Vec<(u32, Resource)>,
}

impl EmbeddedGroup {
    pub(crate) fn of<B: Bindings>(group: &B) -> Self {
        let bound = group.entries().iter().map(|entry| (entry.binding, Resource::of(&entry.resource))).collect();
        Self { layout: B::layout_entries(), bound }
    }
}

/// Visibility of a light as a function for a host's shaders, from [`Shadow::shader_function`](crate::Shadow::shader_function).
#[derive(Clone, Debug)]
pub struct ShaderFunction {
    /// WGSL to prepend to the host's shader: `fn visibility_at(position: vec3f, normal: vec3f, pixel: vec2u) -> f32`. All
    /// names, including this one, start with the requested prefix. The position is in world space; the normal is a unit vector,
    /// or zero for points that face the light, such as particles; the pixel selects random numbers. The text is the same, by
    /// [`Arc::ptr_eq`], until parameters, kind of light or casters require another program.
    pub wgsl: Arc<str>,
    /// Layout of the bind group, for fragment and compute shaders.
    pub layout: wgpu::BindGroupLayout,
    /// Resources that the function reads; valid after the frame's commands have run.
    pub bind_group: wgpu::BindGroup,
}

/// Returns the binding number in the host's group.
fn embedded_binding(group: u32, binding: u32) -> u32 {
    BINDINGS_PER_GROUP * group + binding
}

impl Embeddable {
    /// Entries of the host's bind group layout.
    pub(crate) fn layout_entries(&self) -> Vec<wgpu::BindGroupLayoutEntry> {
        let visibility = wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let entries = (0..).zip(&self.groups).flat_map(|(group, of)| {
            of.layout.iter().map(move |entry| wgpu::BindGroupLayoutEntry {
                binding: embedded_binding(group, entry.binding),
                visibility,
                ..*entry
            })
        });
        entries.collect()
    }

    /// Entries of the host's bind group.
    pub(crate) fn bound(&self) -> Vec<wgpu::BindGroupEntry<'_>> {
        let entries = (0..).zip(&self.groups).flat_map(|(group, of)| {
            of.bound.iter().map(move |(binding, resource)| wgpu::BindGroupEntry {
                binding: embedded_binding(group, *binding),
                resource: resource.binding(),
            })
        });
        entries.collect()
    }

    /// Returns the text for a group index and a prefix of the host's choice.
    pub(crate) fn text(&self, group: u32, prefix: &str) -> String {
        let wgsl = crate::shaders::text_of(self.wgsl);
        embedded_text(&wgsl, &overrides::linked(&wgsl, &self.constants), group, prefix)
    }
}

/// Adapts a linked text for inclusion in another.
fn embedded_text(wgsl: &str, constants: &[(String, f64)], group: u32, prefix: &str) -> String {
    let text = without_entry_point(wgsl);
    let lines = text.lines().filter(|line| !line.starts_with("//"));
    let lines = lines.map(|line| with_constant(&with_binding(line, group), constants) + "\n");
    with_prefix(&lines.collect::<String>(), prefix)
}

/// Removes the only entry point of a linked text; functions end with a brace on a line of its own.
fn without_entry_point(wgsl: &str) -> String {
    let Some((before, from)) = wgsl.split_once("@compute") else { return wgsl.to_owned() };
    let after = from.split_once("\n}\n").map_or("", |(_, after)| after);
    before.to_owned() + after
}

/// Replaces the group and binding of a line, if it has them.
fn with_binding(line: &str, host_group: u32) -> String {
    let number = |name: &str| line.split_once(name)?.1.split_once(')')?.0.parse::<u32>().ok();
    match (number("@group("), number("@binding(")) {
        (Some(group), Some(binding)) => {
            format!("@group({host_group}) @binding({})", embedded_binding(group, binding))
        }
        _ => line.to_owned(),
    }
}

/// Replaces an overridable constant that the line declares by a constant with its value.
fn with_constant(line: &str, constants: &[(String, f64)]) -> String {
    let parts = line.strip_prefix("override ").and_then(|rest| rest.split_once(": "));
    let Some((name, rest)) = parts else { return line.to_owned() };
    let (ty, default) = rest.trim_end_matches(';').split_once(" = ").unwrap_or((rest, ""));
    let given = constants.iter().find(|(constant, _)| constant == name).map(|(_, value)| match ty {
        "bool" => (*value != 0.0).to_string(),
        "u32" => format!("{}u", *value as u32),
        "i32" => format!("{}i", *value as i32),
        _ => format!("{value:?}"),
    });
    format!("const {name}: {ty} = {};", given.as_deref().unwrap_or(default))
}

/// Returns the words of a text and the separators between them.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_of_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut rest = text;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let end = rest.find(|c: char| is_of_word(c) != is_of_word(first)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        rest = after;
        Some(word)
    })
}

/// Adds a prefix to every name that the text declares, and to all members and locals with the same names.
fn with_prefix(text: &str, prefix: &str) -> String {
    const DECLARE: [&str; 5] = ["fn", "struct", "const", "var", "alias"];
    let mut names = HashSet::new();
    for line in text.lines() {
        // Of functions, only unindented lines count: `var<uniform> name`, `var<storage, read> name`, `fn name`.
        if words(line).next().is_some_and(|word| DECLARE.contains(&word)) {
            let declared = line.split([':', '(', '{', '=']).next().unwrap_or_default();
            names.extend(words(declared.trim()).last());
        }
    }
    words(text).flat_map(|word| if names.contains(word) { [prefix, word] } else { ["", word] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linked_text_becomes_part_of_another() {
        let text = "// Linked from there.\n\nfn visibility_at(x: f32) -> f32 {\n    return space_scale(x) * one.x;\n}\n\n\
                    @compute @workgroup_size(1)\nfn keep() {\n    _ = visibility_at(1.0);\n}\n\n\
                    @group(2) @binding(1)\nvar<storage, read> one: array<vec2f>;\n\n\
                    override space_COUNT: u32 = 1u;\noverride space_IS: bool = false;\n\n\
                    fn space_scale(x: f32) -> f32 {\n    var x = x;\n    return x * f32(space_COUNT);\n}\n";
        let got = embedded_text(text, &[("space_COUNT".to_owned(), 3.0)], 5, "sun_");
        for part in [
            "fn sun_visibility_at(x: f32)",
            "return sun_space_scale(x) * sun_one.x;",
            "@group(5) @binding(33)\nvar<storage, read> sun_one: array<vec2f>;",
            "const sun_space_COUNT: u32 = 3u;",
            "const sun_space_IS: bool = false;",
            "var x = x;",
        ] {
            assert!(got.contains(part), "no {part:?} in\n{got}");
        }
        assert!(!got.contains("keep") && !got.contains("override") && !got.contains("Linked"), "{got}");
    }
}
