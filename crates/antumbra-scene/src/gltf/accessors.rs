//! Typed arrays read from buffer views, all checked: strides, normalized integers, sparse replacements.
//!
//! Source: glTF 2.0, section 3.6.2, and KHR_mesh_quantization.

use std::ops::Range;

use gltf::json::Accessor;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;

use super::fault::{Fault, Result};
use super::source::Source;

/// Component types that an attribute may have.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Allowed {
    /// 32-bit floats; with KHR_mesh_quantization any 8- or 16-bit integer too.
    Geometry,
    /// Floats or unsigned integers as fractions: texture coordinates, colours, weights. With KHR_mesh_quantization any
    /// 8- or 16-bit integer too.
    Fractions,
    /// Floats or any integers as fractions: rotations and weights of animations, instance attributes.
    SignedFractions,
    /// 8- or 16-bit unsigned whole numbers: joints.
    Joints,
    /// Only 32-bit floats: times, matrices.
    Floats,
}

impl Allowed {
    fn admits(self, component: ComponentType, normalized: bool, quantized: bool) -> bool {
        use ComponentType::{F32, I8, I16, U8, U16};
        let small_integer = matches!(component, I8 | I16 | U8 | U16);
        match self {
            Self::Geometry => component == F32 || quantized && small_integer,
            Self::Fractions => {
                component == F32 || matches!(component, U8 | U16) && normalized || quantized && small_integer
            }
            Self::SignedFractions => component == F32 || small_integer && normalized,
            Self::Joints => matches!(component, U8 | U16) && !normalized,
            Self::Floats => component == F32,
        }
    }

    fn wanted(self) -> &'static str {
        match self {
            Self::Geometry => "expected 32-bit floats (or 8- and 16-bit integers with KHR_mesh_quantization)",
            Self::Fractions => "expected 32-bit floats or normalized unsigned integers",
            Self::SignedFractions => "expected 32-bit floats or normalized integers",
            Self::Joints => "expected 8- or 16-bit unsigned integers",
            Self::Floats => "expected 32-bit floats",
        }
    }
}

/// Elements of an accessor as raw bytes, before sparse replacements.
struct Layout<'s> {
    /// `None` if all elements are zero.
    bytes: Option<&'s [u8]>,
    stride: usize,
    count: usize,
    component: ComponentType,
    normalized: bool,
    place: String,
}

/// Returns the range of an accessor's elements in its view, bytes; `None` if its end is no number. The last element needs only its own
/// bytes, not a whole stride (section 3.6.2.4).
fn range_of(accessor: &Accessor, size: usize, stride: usize) -> Option<Range<u64>> {
    let begin = accessor.byte_offset.map_or(0, |offset| offset.0);
    let length = match accessor.count.0.checked_sub(1) {
        Some(last) => last.checked_mul(stride as u64)?.checked_add(size as u64)?,
        None => 0,
    };
    Some(begin..length.checked_add(begin)?)
}

impl Source<'_> {
    /// Number of elements of an accessor.
    pub(super) fn accessor_count(&self, index: usize, place: &str) -> Result<usize> {
        self.accessor(index, place).map(|a| a.count.0 as usize)
    }

    /// Number of components of an element.
    pub(super) fn accessor_components(&self, index: usize, place: &str) -> Result<usize> {
        match self.accessor(index, place)?.type_ {
            Checked::Valid(kind) => Ok(kind.multiplicity()),
            Checked::Invalid => Err(Fault::new(
                format!("accessors[{index}].type"),
                "is unknown",
                "expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4",
            )),
        }
    }

    fn accessor(&self, index: usize, place: &str) -> Result<&gltf::json::Accessor> {
        self.root
            .accessors
            .get(index)
            .ok_or_else(|| Fault::unresolved(place, "accessors", index, self.root.accessors.len()))
    }

    /// Reads elements of `N` components as floats; normalized integers become fractions (section 3.6.2.2).
    ///
    /// `place` names the reader in messages. Values may be NaN or infinite.
    pub(super) fn read_floats<const N: usize>(
        &self,
        index: usize,
        allowed: Allowed,
        place: &str,
    ) -> Result<Vec<[f32; N]>> {
        let kind = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        let layout = self.layout(index, kind, place)?;
        if !allowed.admits(layout.component, layout.normalized, self.quantized) {
            return Err(Fault::new(
                place,
                format!("{} has component type {}{}", layout.place, layout.component.as_gl_enum(), {
                    if layout.normalized { ", normalized" } else { "" }
                }),
                allowed.wanted(),
            ));
        }
        let (component, normalized) = (layout.component, layout.normalized);
        let size = component.size();
        let element = |bytes: &[u8]| -> [f32; N] {
            std::array::from_fn(|k| float_from(&bytes[k * size..(k + 1) * size], component, normalized))
        };
        let mut out: Vec<[f32; N]> = match layout.bytes {
            Some(bytes) => (0..layout.count).map(|i| element(&bytes[i * layout.stride..])).collect(),
            None => vec![[0.0; N]; layout.count],
        };
        self.apply_sparse(index, &layout, N * size, |i, bytes| out[i] = element(bytes))?;
        Ok(out)
    }

    /// Reads unsigned whole numbers: vertex indices.
    pub(super) fn read_indices(&self, index: usize, place: &str) -> Result<Vec<u32>> {
        let layout = self.layout(index, Type::Scalar, place)?;
        let component = layout.component;
        if !matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) || layout.normalized {
            return Err(Fault::new(
                place,
                format!("{} has component type {}", layout.place, component.as_gl_enum()),
                "expected unsigned 8-, 16- or 32-bit integers",
            ));
        }
        let element = |bytes: &[u8]| unsigned_from(bytes, component);
        let mut out: Vec<u32> = match layout.bytes {
            Some(bytes) => (0..layout.count).map(|i| element(&bytes[i * layout.stride..])).collect(),
            None => vec![0; layout.count],
        };
        self.apply_sparse(index, &layout, component.size(), |i, bytes| out[i] = element(bytes))?;
        Ok(out)
    }

    /// Checks type and extent, so that every element of the result can be read without further checks.
    fn layout(&self, index: usize, kind: Type, place: &str) -> Result<Layout<'_>> {
        let accessor = self.accessor(index, place)?;
        let own = format!("accessors[{index}]");
        let Checked::Valid(component) = accessor.component_type else {
            return Err(Fault::new(
                format!("{own}.componentType"),
                "is unknown",
                "expected 5120, 5121, 5122, 5123, 5125 or 5126",
            ));
        };
        if self.accessor_components(index, place)? != kind.multiplicity() || accessor.type_ != Checked::Valid(kind) {
            return Err(Fault::new(
                place,
                format!("{own} has the wrong type"),
                format!("expected elements of {} components ({kind:?})", kind.multiplicity()),
            ));
        }
        let component = component.0;
        let size = component.size() * kind.multiplicity();
        let too_many = |have: usize| {
            Fault::new(
                own.clone(),
                format!("states {} elements, more than fit into its {have} bytes of data", accessor.count.0),
                "`count`, `byteOffset` and the stride must not exceed the buffer view",
            )
        };
        let (bytes, stride) = match accessor.buffer_view {
            Some(view) => {
                let view = self.view(view.value())?;
                let stride = view.stride.unwrap_or(size);
                if stride < size {
                    return Err(Fault::new(
                        own,
                        format!("elements of {size} bytes in a view of stride {stride}"),
                        "the stride must be at least the size of an element",
                    ));
                }
                let range = range_of(accessor, size, stride).filter(|range| range.end <= view.bytes.len() as u64);
                let range = range.ok_or_else(|| too_many(view.bytes.len()))?;
                (Some(view.bytes.get(range.start as usize..range.end as usize).unwrap_or_default()), stride)
            }
            None => {
                let count = usize::try_from(accessor.count.0).map_err(|_| too_many(0))?;
                self.budget.take_zero_elements(count, &own)?;
                (None, size)
            }
        };
        let count = accessor.count.0 as usize;
        self.budget.take_elements(count, place)?;
        Ok(Layout { bytes, stride, count, component, normalized: accessor.normalized, place: own })
    }

    fn apply_sparse(
        &self,
        index: usize,
        layout: &Layout,
        element_bytes: usize,
        mut replace: impl FnMut(usize, &[u8]),
    ) -> Result<()> {
        let Some(sparse) = self.root.accessors.get(index).and_then(|a| a.sparse.as_ref()) else {
            return Ok(());
        };
        let place = format!("{}.sparse", layout.place);
        let outside = |what: &str| {
            Fault::new(
                place.clone(),
                format!("{} {what} are beyond the end of their buffer view", sparse.count.0),
                "`count` and `byteOffset` must not exceed the buffer view",
            )
        };
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            return Err(Fault::new(
                format!("{place}.indices.componentType"),
                "is not an unsigned integer",
                "expected 5121, 5123 or 5125",
            ));
        };
        let range = |view: usize, offset: u64, size: usize, what: &str| -> Result<&[u8]> {
            let bytes = self.view(view)?.bytes;
            sparse
                .count
                .0
                .checked_mul(size as u64)
                .and_then(|length| offset.checked_add(length))
                .and_then(|end| bytes.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?))
                .ok_or_else(|| outside(what))
        };
        let index_bytes = index_type.0.size();
        let indices = range(sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0, index_bytes, "indices")?;
        let values = range(sparse.values.buffer_view.value(), sparse.values.byte_offset.0, element_bytes, "values")?;
        for (i, value) in indices.chunks_exact(index_bytes).zip(values.chunks_exact(element_bytes)) {
            let i = unsigned_from(i, index_type.0) as usize;
            if i >= layout.count {
                return Err(Fault::new(
                    place,
                    format!("replaces element {i} of {}", layout.count),
                    "sparse indices must be less than the accessor's `count`",
                ));
            }
            replace(i, value);
        }
        Ok(())
    }
}

/// Decodes one component; `bytes` has its size.
fn float_from(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    /// Divides by `max` if `normalized`, clamped because the two most negative integers both mean −1.
    fn signed(v: f32, max: f32, normalized: bool) -> f32 {
        if normalized { (v / max).max(-1.0) } else { v }
    }
    match component {
        ComponentType::F32 => f32::from_bits(unsigned_from(bytes, component)),
        ComponentType::I8 => signed(f32::from(bytes[0] as i8), 127.0, normalized),
        ComponentType::I16 => signed(f32::from(unsigned_from(bytes, component) as u16 as i16), 32767.0, normalized),
        ComponentType::U8 if normalized => f32::from(bytes[0]) / 255.0,
        ComponentType::U16 if normalized => unsigned_from(bytes, component) as f32 / 65535.0,
        ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => unsigned_from(bytes, component) as f32,
    }
}

/// Decodes one unsigned component; `bytes` has at least its size.
fn unsigned_from(bytes: &[u8], component: ComponentType) -> u32 {
    match component.size() {
        1 => u32::from(bytes[0]),
        2 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}
