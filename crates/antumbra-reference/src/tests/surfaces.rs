//! Masks and tints.
