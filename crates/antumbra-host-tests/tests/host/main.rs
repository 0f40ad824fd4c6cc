//! Tests of the library by an independent host.

mod bounds;
mod formats;
mod invalid;
mod light_set;
mod many;
mod memory;
mod places;
