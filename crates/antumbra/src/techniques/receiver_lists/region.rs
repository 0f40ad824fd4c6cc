//! Regions of the light's map over which triangles are drawn.

use crate::gpu::shared_constants;

/// Region of the light's map over which a triangle is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Region {
    /// Convex hull of three boxes.
    #[default]
    Boxes,
    /// Two corners for each of the triangle's, for a light of one point.
    SixVertices,
    /// Convex hull of three hexagons.
    Hexagons,
}

shared_constants! {
    const SIX_VERTICES: u32 = 6, as in RASTER_DRAW;
    /// Largest number of corners of a hull of hexagons.
    const HULL_CORNERS: u32 = 22, as in RASTER_HULLS;
}

/// Size of a triangle's hull, bytes.
pub(super) const HULL_BYTES: u64 = 8 * HULL_CORNERS as u64;

impl Region {
    /// Returns the number of corners, `SampleSettings::region_corners`.
    pub(super) fn corners(self) -> u32 {
        match self {
            Self::Boxes => 12,
            Self::SixVertices => SIX_VERTICES,
            Self::Hexagons => HULL_CORNERS,
        }
    }
}
