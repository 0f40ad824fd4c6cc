//! Decoding of compressed buffer views by the `meshopt` crate, which wraps the C++ of meshoptimizer.
//!
//! Its decoders promise to be safe for any bytes. Their preconditions on sizes are mere assertions and are checked here.
//! Without the feature `meshopt`, `meshopt_absent.rs` replaces this file.

use super::fault::{Fault, Result, quoted};
use super::meshopt_view::Compression;

/// Decodes compressed bytes to `stride · count` bytes.
pub(super) fn decode(compression: &Compression<'_>, encoded: &[u8], place: &str) -> Result<Vec<u8>> {
    let bad = |problem: String, remedy: &str| Fault::new(place, problem, remedy);
    let undecodable = || bad("the compressed data is corrupt".into(), "export or download the file again");
    let (stride, count) = (compression.stride, compression.count);
    match compression.mode {
        "ATTRIBUTES" if (4..=256).contains(&stride) && stride.is_multiple_of(4) => {
            let bytes = decode_vertices(encoded, stride, count).ok_or_else(undecodable)?;
            filtered(bytes, compression, place)
        }
        "TRIANGLES" if matches!(stride, 2 | 4) && count.is_multiple_of(3) => match stride {
            2 => meshopt::decode_index_buffer::<u16>(encoded, count).map(little_endian_u16),
            _ => meshopt::decode_index_buffer::<u32>(encoded, count).map(little_endian_u32),
        }
        .map_err(|_| undecodable()),
        "INDICES" if matches!(stride, 2 | 4) => match stride {
            2 => meshopt::decode_index_sequence::<u16>(encoded, count).map(little_endian_u16),
            _ => meshopt::decode_index_sequence::<u32>(encoded, count).map(little_endian_u32),
        }
        .map_err(|_| undecodable()),
        mode => Err(bad(
            format!("compression mode {} with {count} elements of {stride} bytes", quoted(mode)),
            "expected a multiple of 4 bytes from 4 to 256 for ATTRIBUTES, 2 or 4 bytes for TRIANGLES (in threes) and INDICES",
        )),
    }
}

/// Applies the view's filter (section "Filters") in place, after the mode ATTRIBUTES.
fn filtered(bytes: Vec<u8>, compression: &Compression<'_>, place: &str) -> Result<Vec<u8>> {
    let i16s = |b: &[u8]| [0, 2, 4, 6].map(|k| i16::from_le_bytes([b[k], b[k + 1]]));
    let from_i16s = |v: Vec<[i16; 4]>| v.into_iter().flatten().flat_map(i16::to_le_bytes).collect();
    let from_i8s = |v: Vec<[i8; 4]>| v.into_iter().flatten().map(|x| x as u8).collect();
    Ok(match (compression.filter, compression.stride) {
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
                "expected NONE, OCTAHEDRAL (4 or 8 bytes), QUATERNION (8), EXPONENTIAL (a multiple of 4) or COLOR (4 or 8)",
            ));
        }
    })
}

fn little_endian_u16(values: Vec<u16>) -> Vec<u8> {
    values.into_iter().flat_map(u16::to_le_bytes).collect()
}

fn little_endian_u32(values: Vec<u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// Element of `WORDS · 4` bytes, because the decoder takes its stride from a type.
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

/// Decodes vertices; `stride` is a multiple of 4 from 4 to 256.
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
