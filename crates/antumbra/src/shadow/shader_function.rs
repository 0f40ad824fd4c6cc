//! Visibility of a light as a function in a host's own shaders, for surfaces that no depth buffer holds: glass, particles, fog.

use std::sync::Arc;

use super::Shadow;
use crate::contract::Error;
use crate::gpu::{Embeddable, RetainedState, ShaderFunction, Stage};
use crate::techniques::Technique;

#[cfg(test)]
mod tests;

/// State of a light's shader functions.
#[derive(Debug, Default)]
pub(super) struct ShaderFunctions {
    keep: RetainedState,
    /// Text of the last function, with its key.
    text: Option<(TextKey, Arc<str>)>,
}

/// Cache key of a function's text.
#[derive(Debug, PartialEq)]
struct TextKey {
    wgsl: &'static str,
    constants: Vec<(&'static str, f64)>,
    group: u32,
    prefix: String,
}

impl<T: Technique> Shadow<T> {
    /// Returns a function for the host's own shaders, `visibility_at(position, normal, pixel)`: visibility at any position, linked
    /// from the same source as the mask's pass, for transparent surfaces, particles and fog. `hard`, `pcf` and `pcss` have it. It
    /// is valid for the frame prepared last once its commands have run, at positions within that frame's `bounds`; it leaves out
    /// tints. All names start with `prefix`, which starts with a letter or is empty; `group` is the index of its bind group.
    ///
    /// Call it after each [`prepare`](Self::prepare) that was recorded: if nothing changed, text, layout and bind group are the
    /// same as before.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for other techniques, before the first frame, if the light is covered in parts, and if its map is
    /// shared with other lights; [`Error::BadFrame`] if the prefix cannot begin a name.
    pub fn shader_function(&mut self, group: u32, prefix: &str) -> Result<ShaderFunction, Error> {
        check_prefix(T::NAME, prefix)?;
        let of = self.embeddable()?;
        let layout_entries = of.layout_entries();
        let layout = self.gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra shader function"),
            entries: &layout_entries,
        });
        let stage = Stage::new(&self.gpu, std::mem::take(&mut self.functions.keep), None);
        let bind_group = stage.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra shader function"),
            layout: &layout,
            entries: &of.bound(),
        });
        (self.functions.keep, _) = stage.finish();
        let key = TextKey { wgsl: of.wgsl, constants: of.constants.clone(), group, prefix: prefix.to_owned() };
        let wgsl = match &self.functions.text {
            Some((made_of, text)) if *made_of == key => text.clone(),
            _ => self.gpu.device.host_shader_text(of.text(group, prefix)).into(),
        };
        self.functions.text = Some((key, Arc::clone(&wgsl)));
        Ok(ShaderFunction { wgsl, layout, bind_group })
    }

    fn embeddable(&self) -> Result<Embeddable, Error> {
        let refuse = |needed: &str, had: &str, remedy| {
            Err(Error::Unsupported { technique: T::NAME, needed: needed.into(), had: had.into(), remedy })
        };
        if self.parts_in_use().is_some() {
            return refuse(
                "a single shadow map for the shader function",
                "a shadow map for each part of this light",
                "limit the light to a frustum (`fov_rad`), or use `prepare_points`",
            );
        }
        match self.technique.embeddable() {
            Some(of) if of.is_own => Ok(of),
            Some(_) => refuse(
                "a shadow map that belongs to this light",
                "only one that lights share",
                "increase the budget with `Gpu::set_map_budget`",
            ),
            None => refuse(
                "a technique with a shader function and a prepared frame",
                "none",
                "use `hard`, `pcf` or `pcss` after `prepare`, or `prepare_points`",
            ),
        }
    }
}

fn check_prefix(technique: &'static str, prefix: &str) -> Result<(), Error> {
    let begins = prefix.is_empty() || prefix.starts_with(|c: char| c.is_ascii_alphabetic());
    if begins && prefix.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && !prefix.contains("__") {
        return Ok(());
    }
    Err(Error::BadFrame {
        technique,
        what: "the prefix of a shader function",
        had: format!("`{prefix}`"),
        needed: "letters, digits and single underscores, beginning with a letter".into(),
    })
}
