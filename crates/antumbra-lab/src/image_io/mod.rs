//! Images as PNG or JPEG, visibility as OpenEXR. Files are written completely or not at all.

mod exr_file;
mod picture_file;
mod png_file;

pub use exr_file::{read_visibility_exr, write_visibility_exr};
pub use picture_file::{check_picture_path, check_visibility_path, write_picture};
pub use png_file::{encode_png, read_png, write_png};
