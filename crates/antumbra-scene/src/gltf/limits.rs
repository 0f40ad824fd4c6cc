//! Limits of what the loader allocates for one file.
//!
//! A glTF file of a kilobyte can request terabytes: accessors without data, instances of instances, compressed views and
//! images. Each such amplifier draws on a budget; exceeding it is an error, without an allocation.

use std::cell::Cell;

use super::fault::{Fault, Result};

/// Upper bounds for one file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Bytes of the scene file and of each file beside it. The GLB container's own limit.
    pub file_bytes: u64,
    /// Total bytes fetched from other files.
    pub fetched_bytes: u64,
    /// Accessor elements that are read, counted at each read: bounds the time.
    pub elements: usize,
    /// Total elements of accessors without data, which read as zeros.
    pub zero_elements: usize,
    /// Total decoded bytes of compressed buffer views.
    pub decoded_bytes: usize,
    /// Vertices of all meshes, deformed and mirrored copies included.
    pub vertices: usize,
    /// Indices of all meshes.
    pub indices: usize,
    /// Placed meshes.
    pub instances: usize,
    /// Cameras, and lights: a scene with more of either is a mistake, and each one carries application data.
    pub cameras_and_lights: usize,
    /// Texels along a side of an image: the largest size that common GPUs support.
    pub image_side: u32,
    /// Texels of all images.
    pub texels: usize,
}

impl Limits {
    /// For files that a user chooses: a scene at one of these limits takes some 10 GB of memory.
    pub const GENEROUS: Self = Self {
        file_bytes: u32::MAX as u64,
        fetched_bytes: 2 * u32::MAX as u64,
        elements: 1 << 30,
        zero_elements: 1 << 24,
        decoded_bytes: 1 << 31,
        vertices: 1 << 26,
        indices: 3 << 26,
        instances: 1 << 22,
        cameras_and_lights: 1024,
        image_side: 16384,
        texels: 1 << 28,
    };

    /// For files that a user opens where addresses have 32 bits, as in a browser's tab: a scene at one of these limits takes
    /// about 1 GB of memory.
    pub const SMALL: Self = Self {
        file_bytes: 1 << 29,
        fetched_bytes: 1 << 29,
        elements: 1 << 26,
        zero_elements: 1 << 22,
        decoded_bytes: 1 << 28,
        vertices: 1 << 23,
        indices: 3 << 23,
        instances: 1 << 19,
        cameras_and_lights: 1024,
        image_side: 8192,
        texels: 1 << 26,
    };

    /// For bytes of unknown origin and for fuzzing: some 100 MB of memory.
    pub const TIGHT: Self = Self {
        file_bytes: 1 << 26,
        fetched_bytes: 1 << 26,
        elements: 1 << 22,
        zero_elements: 1 << 16,
        decoded_bytes: 1 << 24,
        vertices: 1 << 20,
        indices: 3 << 20,
        instances: 1 << 16,
        cameras_and_lights: 64,
        image_side: 4096,
        texels: 1 << 22,
    };
}

/// Remaining part of [`Limits`].
#[derive(Debug)]
pub(super) struct Budget {
    pub limits: Limits,
    fetched_bytes: Cell<usize>,
    elements: Cell<usize>,
    zero_elements: Cell<usize>,
    decoded_bytes: Cell<usize>,
    vertices: Cell<usize>,
    indices: Cell<usize>,
    instances: Cell<usize>,
    texels: Cell<usize>,
}

impl Budget {
    pub(super) fn new(limits: Limits) -> Self {
        Self {
            limits,
            fetched_bytes: Cell::new(limits.fetched_bytes as usize),
            elements: Cell::new(limits.elements),
            zero_elements: Cell::new(limits.zero_elements),
            decoded_bytes: Cell::new(limits.decoded_bytes),
            vertices: Cell::new(limits.vertices),
            indices: Cell::new(limits.indices),
            instances: Cell::new(limits.instances),
            texels: Cell::new(limits.texels),
        }
    }

    /// Bytes that may still be fetched from one other file.
    pub(super) fn fetchable_bytes(&self) -> u64 {
        self.limits.file_bytes.min(self.fetched_bytes.get() as u64)
    }

    pub(super) fn take_fetched_bytes(&self, n: usize, place: &str) -> Result<()> {
        take(&self.fetched_bytes, n, self.limits.fetched_bytes as usize, place, "bytes of other files")
    }

    pub(super) fn take_elements(&self, n: usize, place: &str) -> Result<()> {
        take(&self.elements, n, self.limits.elements, place, "accessor elements")
    }

    pub(super) fn take_zero_elements(&self, n: usize, place: &str) -> Result<()> {
        take(&self.zero_elements, n, self.limits.zero_elements, place, "elements of accessors without data")
    }

    pub(super) fn take_decoded_bytes(&self, n: usize, place: &str) -> Result<()> {
        take(&self.decoded_bytes, n, self.limits.decoded_bytes, place, "bytes of decoded buffer views")
    }

    pub(super) fn take_vertices(&self, n: usize, place: &str) -> Result<()> {
        take(&self.vertices, n, self.limits.vertices, place, "vertices")
    }

    pub(super) fn take_indices(&self, n: usize, place: &str) -> Result<()> {
        take(&self.indices, n, self.limits.indices, place, "indices")
    }

    pub(super) fn take_instances(&self, n: usize, place: &str) -> Result<()> {
        take(&self.instances, n, self.limits.instances, place, "instances")
    }

    pub(super) fn take_texels(&self, n: usize, place: &str) -> Result<()> {
        take(&self.texels, n, self.limits.texels, place, "texels")
    }
}

fn take(left: &Cell<usize>, n: usize, all: usize, place: &str, what: &str) -> Result<()> {
    match left.get().checked_sub(n) {
        Some(rest) => {
            left.set(rest);
            Ok(())
        }
        None => Err(Fault::new(
            place,
            format!("needs {n} {what}, which exceeds the limit"),
            format!("at most {all} {what} per file are supported"),
        )),
    }
}
