//! Shadows that algebra knows.
