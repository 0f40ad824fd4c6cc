//! Micro-patches: the squares of a light map as occluders, each at the depth of what it shows. `patch.wesl` projects one from a receiver onto
//! the light's plane, `window.wesl` walks those that may hide the light, `shown_texel.wesl` chooses the texel that one of several shows,
//! `surface_step.wesl` says how far apart two of one surface may lie, and `light_place.wesl` where on the light an offset is.
//!
//! Gaël Guennebaud, Loïc Barthe, Mathias Paulin, "Real-time soft shadow mapping by backprojection", EGSR 2006, 227–234.

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;
