//! One primitive of the document as triangles.
//!
//! Source: glTF 2.0, section 3.7.2. Strips and fans become lists. Points and lines have no area that could cast a shadow
//! and are left out with a warning.

use glam::{Vec2, Vec3, Vec4};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessors::Allowed;
use super::fault::{Fault, Result};
use super::geometry::{Geometry, Influences, MorphTarget};
use super::materials::UvSource;
use super::source::Source;

/// Attributes to read from primitives.
#[derive(Clone, Copy, Default)]
pub(super) struct Wanted {
    /// Texture coordinates of the material's images.
    pub uv: Option<UvSource>,
    /// Joints and weights.
    pub influences: bool,
    /// Morph targets.
    pub targets: bool,
}

/// Accessor of the attribute with a semantic.
pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value())
}

/// Reads a primitive; `None`, with a warning, if it has no triangles to draw.
///
/// The geometry's normals are those of the file, or empty. All indices are in range.
pub(super) fn read(source: &Source, primitive: &Primitive, wanted: Wanted, place: &str) -> Result<Option<Geometry>> {
    let Checked::Valid(mode) = primitive.mode else {
        return Err(Fault::new(format!("{place}.mode"), "is unknown", "expected a mode from 0 to 6"));
    };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        source.warn(format!("{place}: points and lines have no area; they are ignored"));
        return Ok(None);
    }
    let Some(positions) = attribute(primitive, Semantic::Positions) else {
        source.warn(format!("{place}: has no POSITION; it is ignored"));
        return Ok(None);
    };

    let count = source.accessor_count(positions, place)?;
    source.budget.take_vertices(count, place)?;
    let mut geometry = Geometry {
        positions: vec3s(source, positions, count, &format!("{place}.attributes.POSITION"))?,
        ..Geometry::default()
    };
    geometry.indices = triangles(source, primitive, mode, count, place)?;
    if let Some(normals) = attribute(primitive, Semantic::Normals) {
        geometry.normals = vec3s(source, normals, count, &format!("{place}.attributes.NORMAL"))?;
    }
    geometry.colors = colors(source, primitive, count, place)?;
    if let Some(uv) = wanted.uv {
        geometry.uvs = uvs(source, primitive, uv, count, place)?;
    }
    if wanted.influences {
        geometry.influences = influences(source, primitive, count, place)?;
    }
    if wanted.targets {
        geometry.targets = targets(source, primitive, count, place)?;
    }

    geometry.compact();
    if geometry.normals.is_empty() {
        // Section 3.7.2.1: a primitive without normals gets flat ones, for which each vertex must belong to one triangle.
        source.budget.take_vertices(geometry.indices.len(), place)?;
        geometry.unshare();
    }
    let dropped = geometry.drop_unbounded();
    if dropped > 0 {
        source.warn(format!("{place}: {dropped} triangles with positions that are not finite are ignored"));
    }
    if geometry.indices.is_empty() {
        source.warn(format!("{place}: it has no remaining triangle"));
        return Ok(None);
    }
    Ok(Some(geometry))
}

fn targets(source: &Source, primitive: &Primitive, count: usize, place: &str) -> Result<Vec<MorphTarget>> {
    let mut targets = Vec::new();
    for (k, target) in primitive.targets.iter().flatten().enumerate() {
        let place = format!("{place}.targets[{k}]");
        source.budget.take_vertices(count, &place)?;
        let displacements = |accessor: Option<gltf::json::Index<gltf::json::Accessor>>| match accessor {
            Some(index) => vec3s(source, index.value(), count, &place),
            None => Ok(Vec::new()),
        };
        targets
            .push(MorphTarget { positions: displacements(target.positions)?, normals: displacements(target.normals)? });
    }
    Ok(targets)
}

/// Refuses attribute lists of different lengths, which are invalid.
fn same_count(have: usize, want: usize, place: &str) -> Result<()> {
    if have == want {
        return Ok(());
    }
    Err(Fault::new(place, format!("has {have} elements"), format!("expected as many as POSITION has, {want}")))
}

fn vec3s(source: &Source, accessor: usize, count: usize, place: &str) -> Result<Vec<Vec3>> {
    same_count(source.accessor_count(accessor, place)?, count, place)?;
    Ok(source.read_floats::<3>(accessor, Allowed::Geometry, place)?.into_iter().map(Vec3::from_array).collect())
}

/// Vertex indices of the triangles, in range and without the degenerate triangles that join strips.
fn triangles(source: &Source, primitive: &Primitive, mode: Mode, vertices: usize, place: &str) -> Result<Vec<u32>> {
    let corners = match primitive.indices {
        Some(accessor) => {
            let place = format!("{place}.indices");
            source.budget.take_indices(source.accessor_count(accessor.value(), &place)?, &place)?;
            source.read_indices(accessor.value(), &place)?
        }
        None => {
            source.budget.take_indices(vertices, place)?;
            (0..vertices as u32).collect()
        }
    };
    let listed: Vec<[u32; 3]> = match mode {
        Mode::TriangleStrip => {
            source.budget.take_indices(2 * corners.len(), place)?;
            let turned = |(k, t): (usize, &[u32])| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] };
            let triangles = corners.windows(3).enumerate().map(turned);
            // Triangles that use a vertex twice join strips; they draw nothing.
            triangles.filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).collect()
        }
        Mode::TriangleFan => {
            source.budget.take_indices(2 * corners.len(), place)?;
            corners.get(1..).unwrap_or_default().windows(2).map(|t| [t[0], t[1], corners[0]]).collect()
        }
        _ => {
            if !corners.len().is_multiple_of(3) {
                source.warn(format!(
                    "{place}: the number of corners, {}, is not a multiple of 3; the rest is ignored",
                    corners.len()
                ));
            }
            corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect()
        }
    };
    let all = listed.len();
    let kept: Vec<u32> = listed.into_iter().filter(|t| t.iter().all(|&i| (i as usize) < vertices)).flatten().collect();
    let dropped = all - kept.len() / 3;
    if dropped > 0 {
        source.warn(format!("{place}: {dropped} triangles with indices past the last vertex are ignored"));
    }
    Ok(kept)
}

fn colors(source: &Source, primitive: &Primitive, count: usize, place: &str) -> Result<Vec<Vec4>> {
    let Some(accessor) = attribute(primitive, Semantic::Colors(0)) else { return Ok(Vec::new()) };
    let place = format!("{place}.attributes.COLOR_0");
    same_count(source.accessor_count(accessor, &place)?, count, &place)?;
    let mut colors: Vec<Vec4> = if source.accessor_components(accessor, &place)? == 3 {
        let rgb = source.read_floats::<3>(accessor, Allowed::Fractions, &place)?;
        rgb.into_iter().map(|c| Vec3::from_array(c).extend(1.0)).collect()
    } else {
        let rgba = source.read_floats::<4>(accessor, Allowed::Fractions, &place)?;
        rgba.into_iter().map(Vec4::from_array).collect()
    };
    for color in &mut colors {
        *color = Vec4::from_array(color.to_array().map(|v| if v.is_nan() { 1.0 } else { v.clamp(0.0, 1.0) }));
    }
    Ok(colors)
}

fn uvs(source: &Source, primitive: &Primitive, uv: UvSource, count: usize, place: &str) -> Result<Vec<Vec2>> {
    let Some(accessor) = attribute(primitive, Semantic::TexCoords(uv.set)) else {
        source.warn(format!("{place}: lacks TEXCOORD_{}, which its material needs; the texture is ignored", uv.set));
        return Ok(Vec::new());
    };
    let place = format!("{place}.attributes.TEXCOORD_{}", uv.set);
    same_count(source.accessor_count(accessor, &place)?, count, &place)?;
    let uvs = source.read_floats::<2>(accessor, Allowed::Fractions, &place)?;
    let mut uvs: Vec<Vec2> = uvs.into_iter().map(Vec2::from_array).collect();
    /// Largest texture coordinate: beyond it an f32 has no digits left for the position within a texel.
    const LARGEST: f32 = 1e6;
    let mut repaired = 0;
    for v in &mut uvs {
        *v = uv.image_from_mesh.transform_point2(*v);
        if !v.to_array().iter().all(|c| c.abs() <= LARGEST) {
            *v = Vec2::ZERO;
            repaired += 1;
        }
    }
    if repaired > 0 {
        source.warn(format!("{place}: {repaired} texture coordinates are not finite; 0 is used"));
    }
    Ok(uvs)
}

fn influences(source: &Source, primitive: &Primitive, count: usize, place: &str) -> Result<Vec<Influences>> {
    let mut sets = Vec::new();
    for set in 0.. {
        let (joints, weights) =
            (attribute(primitive, Semantic::Joints(set)), attribute(primitive, Semantic::Weights(set)));
        let (Some(joints), Some(weights)) = (joints, weights) else { break };
        for (accessor, name) in [(joints, "JOINTS"), (weights, "WEIGHTS")] {
            let place = format!("{place}.attributes.{name}_{set}");
            same_count(source.accessor_count(accessor, &place)?, count, &place)?;
        }
        source.budget.take_vertices(count, place)?;
        sets.push(Influences {
            joints: source.read_floats::<4>(joints, Allowed::Joints, place)?,
            weights: source.read_floats::<4>(weights, Allowed::Fractions, place)?,
        });
    }
    Ok(sets)
}
