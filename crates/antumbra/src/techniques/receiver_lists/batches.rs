//! Batches of triangles, limited by the memory for them: opaque ones first, then a batch for each surface that blocks
//! some light points and not others, shared by all casters with it, then one for each caster that transmits a fraction
//! of the light.
//!
//! Masked surfaces are present or absent at a position. Translucent ones without tint block as many of many light points
//! as they stop light: the transmittances of several then multiply, as they do along each segment. Tinted ones, and all
//! with a single light point, transmit a fraction.

use antumbra_light::Aabb;

use crate::contract::{MeshCaster, Opacity};
use crate::light_map::caster_surface::SurfaceValues;

use super::settings::{FLAG_CLOSED, FLAG_MASKED, FLAG_TINTED};

/// Largest number of triangles of a batch: 48 MiB of corners and 8 of positions in the order.
pub(crate) const BATCH_TRIANGLES: u32 = 1 << 20;

/// Effect of a batch's triangles on light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surfaces {
    Opaque,
    /// Triangles of the caster of this index, and of all with its surface, which hide a light point or not.
    Masked(usize),
    /// Triangles of the caster of this index, which transmit a fraction of each colour.
    Tinted(usize),
}

/// Range of triangles and instances of one caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) caster: usize,
    pub(crate) first_triangle: u32,
    pub(crate) triangle_count: u32,
    pub(crate) first_instance: u32,
    pub(crate) instance_count: u32,
    /// Index of the run's first triangle in the batch.
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
    /// Number of triangles in all runs.
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

/// Returns every triangle of the casters once, in batches of at most `most` triangles. The first batch is opaque, and
/// empty if no caster is. `by_bits`: there are enough light points for translucent surfaces to hide some of them.
///
/// `sees_within` returns for a caster's box whether the camera may see the caster from within while the light is outside.
/// Closed casters then count as open, because light reaches the visible surfaces through faces that segments leave.
pub(crate) fn batches_of(
    casters: &[MeshCaster<'_>],
    sees_within: impl Fn(&Aabb) -> bool,
    most: u32,
    by_bits: bool,
) -> Vec<Batch> {
    let mut batches = Batches { casters, most, batches: vec![Batch::new(Surfaces::Opaque)] };
    for (i, caster) in casters.iter().enumerate() {
        if matches!(caster.opacity, Opacity::Opaque) {
            let is_closed = caster.closed && !sees_within(&caster.bounds);
            batches.add(i, Surfaces::Opaque, if is_closed { FLAG_CLOSED } else { 0 });
        }
    }
    let hides_points = |opacity: &Opacity<'_>| match opacity {
        Opacity::Opaque => false,
        Opacity::Masked { .. } => true,
        Opacity::Translucent { .. } => by_bits && !opacity.tints(),
    };
    let hiding = (0..casters.len()).filter(|i| hides_points(&casters[*i].opacity));
    for same in by_surface(casters, hiding) {
        for i in &same {
            batches.add(*i, Surfaces::Masked(same[0]), FLAG_MASKED);
        }
    }
    for (i, caster) in casters.iter().enumerate() {
        if !hides_points(&caster.opacity) && !matches!(caster.opacity, Opacity::Opaque) {
            batches.add(i, Surfaces::Tinted(i), FLAG_TINTED);
        }
    }
    batches.batches
}

/// Batches to which casters are added one after the other.
struct Batches<'a> {
    casters: &'a [MeshCaster<'a>],
    /// Largest number of triangles of a batch.
    most: u32,
    batches: Vec<Batch>,
}

impl Batches<'_> {
    /// Adds every triangle of the caster of this index: whole instances if one fits into a batch, otherwise parts of them.
    fn add(&mut self, index: usize, surfaces: Surfaces, flags: u32) {
        let caster = &self.casters[index];
        let per_instance = caster.index_count / 3;
        let (mut instance, mut triangle) = (0, 0);
        if per_instance == 0 {
            return;
        }
        while instance < caster.instance_count {
            let most = self.most;
            let batch = self.with_room(surfaces);
            let first_place = batch.triangles();
            let room = most - first_place;
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
    }

    /// Returns the last batch if it has these surfaces and is not full, otherwise a new one.
    fn with_room(&mut self, surfaces: Surfaces) -> &mut Batch {
        let has_room = |batch: &Batch| batch.surfaces == surfaces && batch.triangles() < self.most;
        if !self.batches.last().is_some_and(has_room) {
            self.batches.push(Batch::new(surfaces));
        }
        self.batches.last_mut().expect("just pushed if there was none")
    }
}

/// Returns the casters of these indices in groups with the same surface, in the order of their first casters.
fn by_surface(casters: &[MeshCaster<'_>], indices: impl Iterator<Item = usize>) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in indices {
        let same = groups.iter_mut().find(|same| has_surface_of(&casters[i].opacity, &casters[same[0]].opacity));
        match same {
            Some(same) => same.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}

/// Whether two surfaces have the same effect on light at the same texture coordinates.
fn has_surface_of(a: &Opacity<'_>, b: &Opacity<'_>) -> bool {
    let is_same_texture = match (a.texture(), b.texture()) {
        (Some(a), Some(b)) => a.view == b.view && a.sampler == b.sampler,
        (a, b) => a.is_none() && b.is_none(),
    };
    is_same_texture && SurfaceValues::of(a) == SurfaceValues::of(b)
}
