//! One glTF file being read: its document, bytes, remaining budget and warnings.
//!
//! Buffers are fetched on first use, so that unused ones cannot cause a failure.

use std::borrow::Cow;
use std::cell::{OnceCell, RefCell};
use std::path::Path;

use gltf::json::{Root, buffer::View};

use super::container::Container;
use super::document;
use super::fault::{Fault, Result, quoted};
use super::limits::{Budget, Limits};
use super::meshopt_decode;
use super::meshopt_view::Compression;
use super::uri;

/// A glTF file being read.
pub(super) struct Source<'a> {
    pub root: Root,
    pub budget: Budget,
    /// Whether integer positions, normals and texture coordinates are allowed (KHR_mesh_quantization).
    pub quantized: bool,
    bin: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    buffers: Vec<OnceCell<Cow<'a, [u8]>>>,
    decoded_views: Vec<OnceCell<Vec<u8>>>,
    warnings: RefCell<Vec<String>>,
}

/// Bytes of a buffer view.
#[derive(Clone, Copy)]
pub(super) struct ViewBytes<'s> {
    pub bytes: &'s [u8],
    /// Bytes from one element to the next; `None` if the view does not say.
    pub stride: Option<usize>,
}

impl<'a> Source<'a> {
    /// Parses the document. `folder` is where the files beside the scene lie; `None` for a scene in memory.
    pub(super) fn new(container: Container<'a>, folder: Option<&'a Path>, limits: Limits) -> Result<Self> {
        let root = document::parse(container.json)?;
        let warnings = RefCell::new(Vec::from_iter(document::unread_animations(&root)));
        let quantized =
            root.extensions_used.iter().chain(&root.extensions_required).any(|e| e == "KHR_mesh_quantization");
        Ok(Self {
            buffers: root.buffers.iter().map(|_| OnceCell::new()).collect(),
            decoded_views: root.buffer_views.iter().map(|_| OnceCell::new()).collect(),
            root,
            budget: Budget::new(limits),
            quantized,
            bin: container.bin,
            folder,
            warnings,
        })
    }

    /// Whether `have` cameras or lights are as many as the limit allows; warns that further ones are left out.
    pub(super) fn is_full(&self, have: usize, what: &str) -> bool {
        let most = self.budget.limits.cameras_and_lights;
        if have >= most {
            self.warn(format!("{what}: only the first {most} are used"));
        }
        have >= most
    }

    /// Adds a warning about something left out or repaired; each line once.
    pub(super) fn warn(&self, line: String) {
        /// Largest number of warnings, so that the list stays readable even for a file in which everything is wrong.
        const MOST: usize = 50;
        let mut warnings = self.warnings.borrow_mut();
        if warnings.len() < MOST && !warnings.contains(&line) {
            warnings.push(line);
        }
        if warnings.len() == MOST {
            warnings.push("further warnings are omitted".into());
        }
    }

    pub(super) fn into_warnings(self) -> Vec<String> {
        self.warnings.into_inner()
    }

    /// Reads the bytes that an image's URI refers to.
    pub(super) fn read_uri(&self, uri: &str, place: &str) -> Result<Vec<u8>> {
        let bytes = uri::resolve(uri, self.folder, self.budget.fetchable_bytes(), place)?;
        self.budget.take_fetched_bytes(bytes.len(), place)?;
        Ok(bytes)
    }

    fn buffer(&self, index: usize) -> Result<&[u8]> {
        let Some(cell) = self.buffers.get(index) else {
            return Err(Fault::unresolved(format!("buffers[{index}]"), "buffers", index, self.buffers.len()));
        };
        if cell.get().is_none() {
            let _ = cell.set(self.load_buffer(index)?);
        }
        Ok(cell.get().map_or(&[], |bytes| bytes))
    }

    fn load_buffer(&self, index: usize) -> Result<Cow<'a, [u8]>> {
        let place = format!("buffers[{index}]");
        let buffer = &self.root.buffers[index];
        let wanted = buffer.byte_length.0;
        let limit = self.budget.limits.file_bytes;
        if wanted > limit {
            return Err(Fault::new(
                place,
                format!("states {wanted} bytes"),
                format!("at most {limit} bytes are supported"),
            ));
        }
        let mut bytes = match (&buffer.uri, self.bin) {
            (Some(uri), _) => {
                let place = format!("{place}.uri");
                let bytes = uri::resolve(uri, self.folder, wanted.min(self.budget.fetchable_bytes()), &place)?;
                self.budget.take_fetched_bytes(bytes.len(), &place)?;
                Cow::Owned(bytes)
            }
            (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
            (None, _) => {
                return Err(Fault::absent(
                    place,
                    "has no `uri`, and there is no binary chunk for it",
                    "only the first buffer of a .glb may lack a `uri`",
                ));
            }
        };
        let wanted = wanted as usize;
        if bytes.len() < wanted {
            return Err(Fault::new(
                place,
                format!("states {wanted} bytes, but its source has {}", bytes.len()),
                "`byteLength` must not exceed the data: the file seems to be truncated",
            ));
        }
        match &mut bytes {
            Cow::Borrowed(slice) => *slice = &slice[..wanted],
            Cow::Owned(vec) => vec.truncate(wanted),
        }
        Ok(bytes)
    }

    /// Returns a range of a buffer after checking it.
    pub(super) fn buffer_range(&self, buffer: usize, offset: u64, length: u64, place: &str) -> Result<&[u8]> {
        if buffer >= self.root.buffers.len() {
            return Err(Fault::unresolved(place, "buffers", buffer, self.root.buffers.len()));
        }
        let bytes = self.buffer(buffer)?;
        let range = offset.checked_add(length).filter(|end| *end <= bytes.len() as u64);
        match range {
            Some(end) => Ok(&bytes[offset as usize..end as usize]),
            None => Err(Fault::new(
                place,
                format!("bytes {offset} + {length} are beyond the end of buffers[{buffer}] ({} bytes)", bytes.len()),
                "the range must be inside the buffer",
            )),
        }
    }

    /// Returns the bytes of a buffer view, decompressed if necessary.
    pub(super) fn view(&self, index: usize) -> Result<ViewBytes<'_>> {
        let Some(view) = self.root.buffer_views.get(index) else {
            return Err(Fault::unresolved("bufferView", "bufferViews", index, self.root.buffer_views.len()));
        };
        let place = format!("bufferViews[{index}]");
        let stride = checked_stride(view, &place)?;
        if let Some(compression) = Compression::of(view, &place)? {
            let cell = &self.decoded_views[index];
            if cell.get().is_none() {
                let encoded = self.buffer_range(compression.buffer, compression.offset, compression.length, &place)?;
                let _ = cell.set(meshopt_decode::decode(&compression, encoded, &self.budget, view, &place)?);
            }
            return Ok(ViewBytes { bytes: cell.get().map_or(&[], Vec::as_slice), stride });
        }
        let offset = view.byte_offset.map_or(0, |o| o.0);
        let bytes = self.buffer_range(view.buffer.value(), offset, view.byte_length.0, &place)?;
        Ok(ViewBytes { bytes, stride })
    }

    /// Name for messages: the object's own, or its kind and number.
    pub(super) fn label(name: Option<&String>, kind: &str, index: usize) -> String {
        match name {
            Some(name) if !name.is_empty() => format!("{kind}[{index}] {}", quoted(name)),
            _ => format!("{kind}[{index}]"),
        }
    }
}

fn checked_stride(view: &View, place: &str) -> Result<Option<usize>> {
    /// Valid strides, which are also multiples of 4 (section 3.6.2.1).
    const STRIDES: std::ops::RangeInclusive<usize> = 4..=252;
    match view.byte_stride.map(|s| s.0) {
        Some(stride) if !STRIDES.contains(&stride) || !stride.is_multiple_of(4) => Err(Fault::new(
            format!("{place}.byteStride"),
            format!("is {stride}"),
            "expected a multiple of 4 from 4 to 252",
        )),
        stride => Ok(stride),
    }
}
