//! Depth bases: encodings of a light map's depth that can be filtered before they are compared, and their decoding from
//! a filtered texel to visibility and mean blocker depth.
//!
//! The functions are in the shaders of this folder; the modules contain their CPU references and tests. Depths are `t`:
//! 0 at the map's near plane, 1 at its far plane, linear along the axis. Each basis has
//! - `encode_…`: encodes one depth as a texel. Storage loses precision; filtering is linear.
//! - `…_visibility`: lit fraction, 0 to 1, from a filtered texel and a receiver's `t`. Most are upper bounds.
//! - `…_blocker_depth`: mean blocker depth as `t`; the receiver's `t` if nothing blocks.
//!
//! | module | texel | channels |
//! |---|---|---|
//! | `variance` | t, (2t − 1)² | 2 |
//! | `layered` | t, (2t − 1)² of t clamped to a layer | 2 per layer, one layer read |
//! | `exponential_variance` | e^{cu}, its square; −e^{−cu}, its square; u = 2t − 1 | 2 or 4 |
//! | `exponential` | e^{c(t − 1)}; for blocker depths also its product with t, and t | 1 or 3 |
//! | `convolution` | sin c_k t, cos c_k t; for blocker depths also their products with t, and t | 2 M, or 4 M + 1 |
//! | `moment` | u, u², u³, u⁴, or their affine map to [0, 1]⁴ | 4 |

#[cfg(test)]
pub(crate) mod cpu;
#[cfg(test)]
pub(crate) mod tests;
