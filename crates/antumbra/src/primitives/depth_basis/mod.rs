//! Depth bases: what a light map's depth is encoded to, so that it can be filtered before it is compared; and how a
//! filtered texel is turned back into visibility, and into the mean depth of what blocks.
//!
//! The functions are shaders' own, beside this; here are their CPU references and their tests. Depths are `t`: 0 at the
//! map's near plane, 1 at its far plane, linear along the axis. Each basis is
//! - `encode_…`: one depth to what a texel stores. Storing is where precision is lost; filtering is linear.
//! - `…_visibility`: a filtered texel and a receiver's `t` to the lit fraction, 0 to 1. Bounds from above, most of them.
//! - `…_blocker_depth`: to the mean `t` of what blocks, `t` of the receiver where nothing does.
//!
//! | module | texel | channels |
//! |---|---|---|
//! | `variance` | t, (2t − 1)² | 2 |
//! | `layered` | the same of t clamped to a layer | 2 a layer, one layer read |
//! | `exponential_variance` | e^{cu}, its square; −e^{−cu}, its square; u = 2t − 1 | 2 or 4 |
//! | `exponential` | e^{c(t − 1)}; for blocker depths also its product with t, and t | 1 or 3 |
//! | `convolution` | sin c_k t, cos c_k t; for blocker depths also their products with t, and t | 2 M, or 4 M + 1 |
//! | `moment` | u, u², u³, u⁴, or their affine map to [0, 1]⁴ | 4 |

#[cfg(test)]
pub(crate) mod cpu;
#[cfg(test)]
pub(crate) mod tests;
