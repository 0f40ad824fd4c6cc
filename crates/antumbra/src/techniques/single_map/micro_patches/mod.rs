//! Micro-patches: squares of a light map as occluders, each at the depth that it shows. `patch.wesl` projects a square from a receiver onto
//! the light's plane, `window.wesl` visits those that may hide the light, `shown_texel.wesl` chooses the texel that a square shows,
//! `surface_step.wesl` bounds the step in depth within a surface, and `light_place.wesl` maps offsets to positions in the light's shape.
//!
//! Gaël Guennebaud, Loïc Barthe, Mathias Paulin, "Real-time soft shadow mapping by backprojection", EGSR 2006, 227–234.

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;
