//! Batches of triangles: as many as memory is set aside for, opaque ones first, then each surface that is
//! there for some light points and not for others, whatever casters have it, then each caster of which a share passes.
//!
//! Masked surfaces are there or not at a place. Translucent ones that do not tint are there for as many of many light
//! points as they stop light: what several of them let through then multiplies, as it does along each segment. Of tinted
//! ones, and of one light point, a share passes.

use antumbra_light::Aabb;

use crate::contract::{MeshCaster, Opacity};
use crate::light_map::caster_surface::SurfaceValues;

use super::settings::{FLAG_CLOSED, FLAG_MASKED, FLAG_TINTED};

/// Triangles of a batch: 48 MiB of corners and 8 of places.
pub(crate) const BATCH_TRIANGLES: u32 = 1 << 20;

/// What the triangles of a batch do to light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surfaces {
    Opaque,
    /// Those of the caster of this index and of all with its surface, which hide light points or not.
    Masked(usize),
    /// Those of the caster of this index, which let a share of each colour pass.
    Tinted(usize),
}

/// A run of triangles and instances of one caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) caster: usize,
    pub(crate) first_triangle: u32,
    pub(crate) triangle_count: u32,
    pub(crate) first_instance: u32,
    pub(crate) instance_count: u32,
    /// Of the batch's triangles, the run's first.
    pub(crate) first_place: u32,
    pub(crate) flags: u32,
}

impl Run {
    pub(crate) fn triangles(&self) -> u32 {
        self.triangle_count * self.instance_count
    }
}

/// Triangles that are sorted and tested together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Batch {
    pub(crate) surfaces: Surfaces,
    pub(crate) runs: Vec<Run>,
    /// Of all runs.
    triangles: u32,
}

impl Batch {
    fn new(surfaces: Surfaces) -> Self {
        Self { surfaces, runs: Vec::new(), triangles: 0 }
    }

    pub(crate) fn triangles(&self) -> u32 {
        self.triangles
    }

    fn add(&mut self, run: Run) {
        self.triangles += run.triangles();
        self.runs.push(run);
    }
}

/// Every triangle of the casters once, in batches of at most `most` triangles; one empty batch where there is none, so
/// that there is always an opaque one. `by_bits`: there are light points enough for translucent surfaces to hide some.
///
/// `sees_within` tells of a caster's box whether the camera may see the caster from within while the light is outside. Closed
/// casters then count as open: light reaches what is seen there through faces that segments leave.
pub(crate) fn batches_of(
    casters: &[MeshCaster<'_>],
    sees_within: impl Fn(&Aabb) -> bool,
    most: u32,
    by_bits: bool,
) -> Vec<Batch> {
    let mut batches = vec![Batch::new(Surfaces::Opaque)];
    let mut add = |index: usize, surfaces: Surfaces, flags: u32| {
        let caster = &casters[index];
        let per_instance = caster.index_count / 3;
        let (mut instance, mut triangle) = (0, 0);
        if per_instance == 0 {
            return;
        }
        while instance < caster.instance_count {
            let batch = match batches.last_mut() {
                Some(batch) if batch.surfaces == surfaces && batch.triangles() < most => batch,
                _ => {
                    batches.push(Batch::new(surfaces));
                    batches.last_mut().expect("just pushed")
                }
            };
            let first_place = batch.triangles();
            let room = most - first_place;
            // Whole instances where any fits, else a part of one.
            let (triangle_count, instance_count) = if triangle == 0 && room >= per_instance {
                (per_instance, (room / per_instance).min(caster.instance_count - instance))
            } else {
                ((per_instance - triangle).min(room), 1)
            };
            batch.add(Run {
                caster: index,
                first_triangle: triangle,
                triangle_count,
                first_instance: caster.first_instance + instance,
                instance_count,
                first_place,
                flags,
            });
            if triangle + triangle_count == per_instance {
                (instance, triangle) = (instance + instance_count, 0);
            } else {
                triangle += triangle_count;
            }
        }
    };
    for (i, caster) in casters.iter().enumerate() {
        if matches!(caster.opacity, Opacity::Opaque) {
            let is_closed = caster.closed && !sees_within(&caster.bounds);
            add(i, Surfaces::Opaque, if is_closed { FLAG_CLOSED } else { 0 });
        }
    }
    let hides_points = |opacity: &Opacity<'_>| match opacity {
        Opacity::Opaque => false,
        Opacity::Masked { .. } => true,
        Opacity::Translucent { .. } => by_bits && !opacity.tints(),
    };
    let mut by_surface: Vec<Vec<usize>> = Vec::new();
    for (i, caster) in casters.iter().enumerate().filter(|(_, caster)| hides_points(&caster.opacity)) {
        let same = by_surface.iter_mut().find(|same| has_surface_of(&caster.opacity, &casters[same[0]].opacity));
        match same {
            Some(same) => same.push(i),
            None => by_surface.push(vec![i]),
        }
    }
    for same in &by_surface {
        for i in same {
            add(*i, Surfaces::Masked(same[0]), FLAG_MASKED);
        }
    }
    for (i, caster) in casters.iter().enumerate() {
        if !hides_points(&caster.opacity) && !matches!(caster.opacity, Opacity::Opaque) {
            add(i, Surfaces::Tinted(i), FLAG_TINTED);
        }
    }
    batches
}

/// Whether two surfaces do the same to light, where their texture coordinates are the same.
fn has_surface_of(a: &Opacity<'_>, b: &Opacity<'_>) -> bool {
    let is_same_texture = match (a.texture(), b.texture()) {
        (Some(a), Some(b)) => a.view == b.view && a.sampler == b.sampler,
        (a, b) => a.is_none() && b.is_none(),
    };
    is_same_texture && SurfaceValues::of(a) == SurfaceValues::of(b)
}
