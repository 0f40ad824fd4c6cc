//! What an independent host expects of the library.

mod formats;
mod invalid;
