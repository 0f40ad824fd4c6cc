//! URIs in a glTF file: data inside it, or a file in the scene's own folder.
//!
//! Source: glTF 2.0, sections 2.8 (URIs) and 3.6.1.1; RFC 2397 (data URIs), RFC 4648 (base64), RFC 3986 (percent
//! encoding). Scenes are untrusted and must not reach files elsewhere, devices, or the network.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::fault::{Fault, Result, quoted};
use crate::base64;

/// Reads the bytes that `uri` refers to.
///
/// `folder` is the scene's folder; files are refused if it is `None`, because the scene was loaded from memory. Reads at
/// most `at_most` bytes.
pub(super) fn resolve(uri: &str, folder: Option<&Path>, at_most: u64, place: &str) -> Result<Vec<u8>> {
    if let Some(rest) = strip_scheme(uri, "data:") {
        return decode_data(rest, place);
    }
    let path = inside(uri, folder, place)?;
    let unreadable = |why: String| {
        Fault::new(place, format!("{} cannot be read: {why}", quoted(uri)), "put the file next to the scene")
    };
    let metadata = std::fs::metadata(&path).map_err(|e| unreadable(e.to_string()))?;
    // A named pipe or a device would block for ever.
    if !metadata.is_file() {
        return Err(unreadable("it is not a file".into()));
    }
    let mut bytes = Vec::new();
    let file = File::open(&path).map_err(|e| unreadable(e.to_string()))?;
    file.take(at_most.min(metadata.len())).read_to_end(&mut bytes).map_err(|e| unreadable(e.to_string()))?;
    Ok(bytes)
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let head = uri.get(..scheme.len())?;
    head.eq_ignore_ascii_case(scheme).then(|| &uri[scheme.len()..])
}

/// Path of a relative URI, after checking that it lies in `folder` or below with symbolic links followed.
fn inside(uri: &str, folder: Option<&Path>, place: &str) -> Result<PathBuf> {
    let refused = |why: &str| {
        Fault::new(
            place,
            format!("{} {why}", quoted(uri)),
            "expected a relative path to a file in the scene's folder, or a data URI",
        )
    };
    let Some(folder) = folder else {
        return Err(refused("names a file, but this scene was not loaded from a folder"));
    };
    let decoded = percent_decoded(uri.as_bytes());
    let decoded = String::from_utf8(decoded).map_err(|_| refused("is not UTF-8 once percent-decoded"))?;
    if decoded.is_empty() || decoded.contains('\0') {
        return Err(refused("is not a path"));
    }
    let parts: Vec<&str> = decoded.split(['/', '\\']).collect();
    // A scheme or a drive letter; a colon later in a path is an ordinary character.
    if parts[0].contains(':') {
        return Err(refused("is not a relative path"));
    }
    if parts[0].is_empty() {
        return Err(refused("is an absolute path"));
    }
    let mut depth = 0i64;
    for part in &parts {
        depth += match *part {
            "" | "." => 0,
            ".." => -1,
            _ => 1,
        };
        if depth < 0 {
            return Err(refused("leads out of the scene's folder"));
        }
    }
    let missing = |e: std::io::Error| refused(&format!("cannot be found: {e}"));
    let folder = folder.canonicalize().map_err(missing)?;
    let path = folder.join(parts.iter().collect::<PathBuf>()).canonicalize().map_err(missing)?;
    if !path.starts_with(&folder) {
        return Err(refused("leads out of the scene's folder through a link"));
    }
    Ok(path)
}

fn percent_decoded(text: &[u8]) -> Vec<u8> {
    percent_encoding::percent_decode(text).collect()
}

/// Decodes a data URI after `data:` (RFC 2397). The media type is ignored: images are recognised by their bytes.
fn decode_data(rest: &str, place: &str) -> Result<Vec<u8>> {
    let bad = |problem: &str| Fault::new(place, problem, "expected `data:[type];base64,DATA` with DATA in base64");
    let Some((head, body)) = rest.split_once(',') else {
        return Err(bad("a data URI without a comma"));
    };
    let is_base64 = head.rsplit(';').next().is_some_and(|last| last.eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Ok(percent_decoded(body.as_bytes()));
    }
    let body = if body.contains('%') { percent_decoded(body.as_bytes()) } else { body.as_bytes().to_vec() };
    base64::decode(&body).ok_or_else(|| bad("a data URI that is not base64"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_carry_text_and_base64() {
        assert_eq!(decode_data("text/plain,a%20b", "").unwrap(), b"a b");
        // A percent sign without two hexadecimal digits stands for itself.
        assert_eq!(decode_data("text/plain,5%,%4g%41%", "").unwrap(), b"5%,%4gA%");
        assert_eq!(decode_data("application/octet-stream;base64,Zm9v", "").unwrap(), b"foo");
        assert!(decode_data("application/octet-stream;base64", "").is_err());
        assert!(decode_data(";base64,Zm9v!", "").is_err());
    }

    #[test]
    fn only_the_scenes_folder_is_read() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("scene");
        std::fs::create_dir_all(folder.join("sub")).unwrap();
        std::fs::write(root.path().join("secret"), "no").unwrap();
        std::fs::write(folder.join("a b.bin"), "yes").unwrap();
        let read = |uri: &str| resolve(uri, Some(&folder), 100, "test");
        assert_eq!(read("a%20b.bin").unwrap(), b"yes");
        assert_eq!(read("sub/../a b.bin").unwrap(), b"yes");
        for uri in [
            "../secret",
            "sub/../../secret",
            "..\\secret",
            "%2e%2e/secret",
            "sub/%2E%2E%2f..%2Fsecret",
            "/etc/hostname",
            "file:///etc/hostname",
            "C:\\x",
            "http://localhost/x",
            "sub",
            "missing.bin",
            "",
        ] {
            assert!(read(uri).is_err(), "{uri}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.path().join("secret"), folder.join("link")).unwrap();
            assert!(read("link").is_err());
        }
        assert!(resolve("a%20b.bin", None, 100, "test").is_err());
    }
}
