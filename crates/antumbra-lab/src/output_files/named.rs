//! Validation of output paths: a file name with a known extension.

use std::path::Path;

use super::{FileError, check_writable};

/// Rejects `-`, which other programs use for standard output and which would become a file of that name. `./-` is accepted.
///
/// # Errors
/// If the path is `-`.
pub fn check_named(path: &Path) -> Result<(), FileError> {
    if path.as_os_str() == "-" {
        let why = "results are files and folders, which cannot be written to standard output";
        return Err(FileError::bad_path("write", path, why, "give a name"));
    }
    Ok(())
}

/// Returns which of `endings` (lower case, without dot) a file name has, in any case. `what` describes the content in messages.
///
/// # Errors
/// If the extension is missing or unknown, or the path is `-`.
pub fn check_ending(path: &Path, what: &str, endings: &[&'static str]) -> Result<&'static str, FileError> {
    check_named(path)?;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if let Some(known) = endings.iter().find(|known| ending.as_deref() == Some(**known)) {
        return Ok(known);
    }
    let why = match ending {
        Some(other) => format!("{what} cannot be written as .{other}"),
        None => format!("its name has no extension that determines the format of {what}"),
    };
    let remedy = format!("name it .{}", endings.join(" or ."));
    Err(FileError::bad_path("write", path, why, &remedy))
}

/// Checks that JSON can be written to a path, before long work. Leaves no file.
///
/// # Errors
/// If the name does not end in `.json`, or the path is not writable.
pub fn check_json_path(path: &Path) -> Result<(), FileError> {
    check_ending(path, "JSON", &["json"])?;
    check_writable(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_is_written() {
        let of = |name: &str| check_ending(Path::new(name), "a picture", &["png", "jpg"]);
        assert_eq!((of("a.png").unwrap(), of("dir.x/A.JPG").unwrap()), ("png", "jpg"));
        for name in ["a", "-", "a.", ".png", "a.bmp", "dir.png/a", "", "a.png.tmp"] {
            let error = of(name).unwrap_err();
            assert!(error.is_bad_input && !error.to_string().contains('\n'), "{name}: {error}");
        }
        assert!(of("a").unwrap_err().to_string().ends_with("name it .png or .jpg"));
        assert!(of("-").unwrap_err().to_string().contains("standard output"));
        assert!(check_named(Path::new("./-")).is_ok());
        assert!(check_json_path(Path::new("t.txt")).unwrap_err().to_string().ends_with("name it .json"));
    }
}
