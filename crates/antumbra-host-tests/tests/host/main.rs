//! What an independent host expects of the library.

mod bounds;
mod formats;
mod invalid;
mod many;
mod memory;
mod places;
