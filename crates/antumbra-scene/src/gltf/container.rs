//! The outermost layer of a glTF file: the binary container, or plain JSON.
//!
//! Source: glTF 2.0, section 4, "GLB File Format Specification".

use super::fault::{Fault, Result};

/// Parts of a glTF file.
#[derive(Debug)]
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    /// Binary chunk; `None` if the file is plain JSON or has none.
    pub bin: Option<&'a [u8]>,
}

const MAGIC: &[u8] = b"glTF";
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;
const CHUNK_JSON: u32 = u32::from_le_bytes(*b"JSON");
const CHUNK_BIN: u32 = u32::from_le_bytes(*b"BIN\0");
/// Remedy for files of other formats.
const CONVERT: &str = "give a .glb or .gltf file of version 2.0; convert .obj, .fbx, .usd or .blend with Blender: File > Import, then \
    File > Export > glTF 2.0";
/// Remedy for files that end early.
const TRUNCATED: &str = "the file seems to be truncated: download or export it again";
const UTF8_BYTE_ORDER_MARK: &[u8] = &[0xEF, 0xBB, 0xBF];

/// Splits a file. Its first bytes determine the format, not its name.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>> {
    if bytes.starts_with(MAGIC) {
        return split_binary(bytes);
    }
    let json = bytes.strip_prefix(UTF8_BYTE_ORDER_MARK).unwrap_or(bytes);
    match json.iter().find(|b| !b.is_ascii_whitespace()) {
        Some(b'{' | b'[') => Ok(Container { json, bin: None }),
        Some(_) => Err(Fault::new("byte 0", "is not a glTF file: it starts with neither `glTF` nor `{`", CONVERT)),
        None => Err(Fault::new("byte 0", "the file is empty", "give a .glb or .gltf file of version 2.0")),
    }
}

fn split_binary(bytes: &[u8]) -> Result<Container<'_>> {
    let version = u32_at(bytes, 4, "the header")?;
    if version != 2 {
        return Err(Fault::new("byte 4", format!("container version {version}"), "only version 2 is supported"));
    }
    let length = u32_at(bytes, 8, "the header")? as usize;
    let Some(bytes) = bytes.get(..length) else {
        return Err(Fault::new(
            "byte 8",
            format!("the header states {length} bytes, but the file has {}", bytes.len()),
            TRUNCATED,
        ));
    };
    let (kind, json) = chunk_at(bytes, HEADER_BYTES, "the header of the JSON chunk")?;
    if kind != CHUNK_JSON {
        return Err(Fault::new("byte 16", "the first chunk is not JSON", "the first chunk must have type `JSON`"));
    }
    // Chunks after the second, and unknown ones, are ignored (section 4.4.1); known ones must be in place.
    let mut bin = None;
    let mut at = HEADER_BYTES + CHUNK_HEADER_BYTES + json.len();
    let mut second = true;
    while at < bytes.len() {
        let (kind, data) = chunk_at(bytes, at, "a chunk header")?;
        match kind {
            CHUNK_BIN if second => bin = Some(data),
            CHUNK_BIN | CHUNK_JSON => {
                return Err(Fault::new(
                    format!("byte {at}"),
                    "a second JSON or a misplaced BIN chunk",
                    "a container must have one JSON chunk, followed by at most one BIN chunk",
                ));
            }
            _ => {}
        }
        second = false;
        at += CHUNK_HEADER_BYTES + data.len();
    }
    Ok(Container { json, bin })
}

/// Returns kind and data of the chunk that begins at a byte; `what` is its header.
fn chunk_at<'b>(bytes: &'b [u8], at: usize, what: &str) -> Result<(u32, &'b [u8])> {
    let (chunk_bytes, kind) = (u32_at(bytes, at, what)? as usize, u32_at(bytes, at + 4, what)?);
    let start = at + CHUNK_HEADER_BYTES;
    if !chunk_bytes.is_multiple_of(4) {
        return Err(Fault::new(
            format!("byte {at}"),
            format!("a chunk of {chunk_bytes} bytes"),
            "chunk lengths must be multiples of 4",
        ));
    }
    match bytes[start..].get(..chunk_bytes) {
        Some(data) => Ok((kind, data)),
        None => Err(Fault::new(
            format!("byte {at}"),
            format!("a chunk states {chunk_bytes} bytes, but only {} remain", bytes.len() - start),
            TRUNCATED,
        )),
    }
}

fn u32_at(bytes: &[u8], at: usize, what: &str) -> Result<u32> {
    match bytes.get(at..at + 4) {
        Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d])),
        _ => Err(truncated(bytes.len(), what)),
    }
}

fn truncated(at: usize, what: &str) -> Fault {
    Fault::new(format!("byte {at}"), format!("the file ends inside {what}"), TRUNCATED)
}
