//! Compressed buffer views.
//!
//! Source: EXT_meshopt_compression (Kapoulkine 2021) and its successor KHR_meshopt_compression, whose bit streams the
//! `meshopt` crate decodes. Its decoders promise to be safe on any bytes; their preconditions on sizes are checked
//! here, because they are mere assertions there.

use gltf::json::buffer::View;
use serde_json::Value;

use super::fault::{Fault, Result, quoted};
use super::limits::Budget;

/// What a compressed view says about itself.
pub(super) struct Compression<'v> {
    /// The buffer that holds the compressed bytes, and where in it they lie.
    pub buffer: usize,
    pub offset: u64,
    pub length: u64,
    stride: usize,
    count: usize,
    mode: &'v str,
    filter: &'v str,
}

impl<'v> Compression<'v> {
    /// The compression of a view, where it has one.
    pub(super) fn of(view: &'v View, place: &str) -> Result<Option<Self>> {
        let extensions = view.extensions.as_ref().map(|e| &e.others);
        let Some((name, value)) = extensions.and_then(|others| {
            ["EXT_meshopt_compression", "KHR_meshopt_compression"]
                .into_iter()
                .find_map(|name| others.get(name).map(|value| (name, value)))
        }) else {
            return Ok(None);
        };
        let whole = |key: &str| {
            value
                .get(key)
                .and_then(|v| v.as_u64().or_else(|| v.as_f64().filter(|f| f.fract() == 0.0).map(|f| f as u64)))
        };
        let text = |key: &str| value.get(key).and_then(Value::as_str);
        let missing = |key: &str| {
            Fault::new(format!("{place}.extensions.{name}"), format!("`{key}` is missing"), "the extension requires it")
        };
        Ok(Some(Self {
            buffer: whole("buffer").ok_or_else(|| missing("buffer"))? as usize,
            offset: whole("byteOffset").unwrap_or(0),
            length: whole("byteLength").ok_or_else(|| missing("byteLength"))?,
            stride: whole("byteStride").ok_or_else(|| missing("byteStride"))? as usize,
            count: whole("count").ok_or_else(|| missing("count"))? as usize,
            mode: text("mode").ok_or_else(|| missing("mode"))?,
            filter: text("filter").unwrap_or("NONE"),
        }))
    }

    /// `byteStride · count` bytes from the compressed ones, taken from the budget before they are made.
    pub(super) fn decode(&self, encoded: &[u8], budget: &Budget, view: &View, place: &str) -> Result<Vec<u8>> {
        let bad = |problem: String, remedy: &str| Fault::new(place, problem, remedy);
        let size = self.stride.checked_mul(self.count).filter(|size| *size as u64 == view.byte_length.0);
        let Some(size) = size else {
            return Err(bad(
                format!("{} elements of {} bytes are not {} bytes", self.count, self.stride, view.byte_length.0),
                "`count` times `byteStride` must be the view's `byteLength`",
            ));
        };
        budget.take_decoded_bytes(size, place)?;
        let undecodable = || bad("the compressed data is corrupt".into(), "export or fetch the file again");
        match self.mode {
            "ATTRIBUTES" if (4..=256).contains(&self.stride) && self.stride.is_multiple_of(4) => {
                let bytes = decode_vertices(encoded, self.stride, self.count).ok_or_else(undecodable)?;
                self.filtered(bytes, place)
            }
            "TRIANGLES" if matches!(self.stride, 2 | 4) && self.count.is_multiple_of(3) => match self.stride {
                2 => meshopt::decode_index_buffer::<u16>(encoded, self.count).map(little_endian_u16),
                _ => meshopt::decode_index_buffer::<u32>(encoded, self.count).map(little_endian_u32),
            }
            .map_err(|_| undecodable()),
            "INDICES" if matches!(self.stride, 2 | 4) => match self.stride {
                2 => meshopt::decode_index_sequence::<u16>(encoded, self.count).map(little_endian_u16),
                _ => meshopt::decode_index_sequence::<u32>(encoded, self.count).map(little_endian_u32),
            }
            .map_err(|_| undecodable()),
            mode => Err(bad(
                format!("compression mode {} with {} elements of {} bytes", quoted(mode), self.count, self.stride),
                "ATTRIBUTES takes 4 to 256 bytes in fours, TRIANGLES whole triangles of 2 or 4, INDICES 2 or 4",
            )),
        }
    }

    /// Section "Filters": in place, after ATTRIBUTES.
    fn filtered(&self, bytes: Vec<u8>, place: &str) -> Result<Vec<u8>> {
        let i16s = |b: &[u8]| [0, 2, 4, 6].map(|k| i16::from_le_bytes([b[k], b[k + 1]]));
        let from_i16s = |v: Vec<[i16; 4]>| v.into_iter().flatten().flat_map(i16::to_le_bytes).collect();
        let from_i8s = |v: Vec<[i8; 4]>| v.into_iter().flatten().map(|x| x as u8).collect();
        Ok(match (self.filter, self.stride) {
            ("NONE", _) => bytes,
            ("OCTAHEDRAL", 4) => {
                let mut v: Vec<[i8; 4]> = bytes.chunks_exact(4).map(|b| [0, 1, 2, 3].map(|k| b[k] as i8)).collect();
                meshopt::decode_filter_oct(&mut v);
                from_i8s(v)
            }
            ("OCTAHEDRAL", 8) => {
                let mut v: Vec<[i16; 4]> = bytes.chunks_exact(8).map(i16s).collect();
                meshopt::decode_filter_oct(&mut v);
                from_i16s(v)
            }
            ("QUATERNION", 8) => {
                let mut v: Vec<[i16; 4]> = bytes.chunks_exact(8).map(i16s).collect();
                meshopt::decode_filter_quat(&mut v);
                from_i16s(v)
            }
            ("COLOR", 4) => {
                let mut v: Vec<[u8; 4]> = bytes.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]).collect();
                meshopt::decode_filter_color(&mut v);
                v.into_iter().flatten().collect()
            }
            ("COLOR", 8) => {
                let mut v: Vec<[u16; 4]> = bytes.chunks_exact(8).map(|b| i16s(b).map(|x| x as u16)).collect();
                meshopt::decode_filter_color(&mut v);
                v.into_iter().flatten().flat_map(u16::to_le_bytes).collect()
            }
            ("EXPONENTIAL", _) => {
                let mut v: Vec<[u32; 1]> =
                    bytes.chunks_exact(4).map(|b| [u32::from_le_bytes([b[0], b[1], b[2], b[3]])]).collect();
                meshopt::decode_filter_exp(&mut v);
                v.into_iter().flat_map(|[x]| x.to_le_bytes()).collect()
            }
            (filter, stride) => {
                return Err(Fault::new(
                    place,
                    format!("compression filter {} on elements of {stride} bytes", quoted(filter)),
                    "NONE, OCTAHEDRAL (4 or 8), QUATERNION (8), EXPONENTIAL (fours) or COLOR (4 or 8) is right",
                ));
            }
        })
    }
}

fn little_endian_u16(values: Vec<u16>) -> Vec<u8> {
    values.into_iter().flat_map(u16::to_le_bytes).collect()
}

fn little_endian_u32(values: Vec<u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// An element of `WORDS · 4` bytes: the decoder takes its stride from a type.
#[derive(Clone)]
struct Words<const WORDS: usize>([[u8; 4]; WORDS]);

impl<const WORDS: usize> Default for Words<WORDS> {
    fn default() -> Self {
        Self([[0; 4]; WORDS])
    }
}

fn decode_words<const WORDS: usize>(encoded: &[u8], count: usize) -> Option<Vec<u8>> {
    let elements: Vec<Words<WORDS>> = meshopt::decode_vertex_buffer(encoded, count).ok()?;
    Some(elements.into_iter().flat_map(|e| e.0).flatten().collect())
}

/// `stride` is 4 to 256 in fours.
fn decode_vertices(encoded: &[u8], stride: usize, count: usize) -> Option<Vec<u8>> {
    macro_rules! by_words {
        ($($words:literal)*) => {
            match stride / 4 {
                $($words => decode_words::<$words>(encoded, count),)*
                _ => None,
            }
        };
    }
    by_words!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64)
}
