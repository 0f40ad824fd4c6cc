//! What an independent host expects of the library.

mod bounds;
mod formats;
mod invalid;
mod light_set;
mod many;
mod memory;
mod places;
