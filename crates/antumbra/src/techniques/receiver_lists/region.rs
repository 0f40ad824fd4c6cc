//! Regions of the light's map that triangles are drawn over.

use crate::gpu::shared_constants;

/// What of the light's map a triangle is drawn over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Region {
    /// The hull of three boxes.
    #[default]
    Boxes,
    /// Two corners for each of the triangle's, for a light of one point.
    SixVertices,
    /// The hull of three hexagons.
    Hexagons,
}

shared_constants! {
    const SIX_VERTICES: u32 = 6, as in VIEW_SAMPLES_RASTER;
    /// Corners of a hull of hexagons, at most.
    const HULL_CORNERS: u32 = 22, as in VIEW_SAMPLES_REGION_HULLS;
}

/// Of a triangle's hull.
pub(super) const HULL_BYTES: u64 = 8 * HULL_CORNERS as u64;

impl Region {
    /// As `SampleSettings::region_corners`.
    pub(super) fn corners(self) -> u32 {
        match self {
            Self::Boxes => 12,
            Self::SixVertices => SIX_VERTICES,
            Self::Hexagons => HULL_CORNERS,
        }
    }
}
