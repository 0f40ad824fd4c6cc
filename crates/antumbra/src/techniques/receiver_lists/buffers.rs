//! Buffers that outlive a frame.

use super::light_points::{LocalPoint, packed_box};
use super::plan::{FramePlan, POSITIONS_BYTES};
use super::region::HULL_BYTES;
use super::settings::{CELL_COUNT, FIRST_GROUP, SHAFT_LENGTH, STATE_LENGTH};
use crate::gpu::{Stage, sized_buffer, upload_storage};

/// Buffers of a light, reallocated when a frame needs another size.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    state: Option<wgpu::Buffer>,
    pub(super) counts: Option<wgpu::Buffer>,
    places: Option<wgpu::Buffer>,
    list: Option<wgpu::Buffer>,
    positions: Option<wgpu::Buffer>,
    penumbrae: Option<wgpu::Buffer>,
    hulls: Option<wgpu::Buffer>,
    shaft: Option<wgpu::Buffer>,
    whole_light: Option<wgpu::Buffer>,
    cells: Option<wgpu::Buffer>,
    triangle_places: Option<wgpu::Buffer>,
    triangles: Option<wgpu::Buffer>,
    edges: Option<wgpu::Buffer>,
    boxes: Option<wgpu::Buffer>,
    totals: Option<wgpu::Buffer>,
    pub(super) dispatches: Option<wgpu::Buffer>,
    pub(super) work: Option<wgpu::Buffer>,
    pub(super) bits: Option<wgpu::Buffer>,
}

/// Buffers of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct BufferSet<'a> {
    pub(super) state: &'a wgpu::Buffer,
    pub(super) counts: &'a wgpu::Buffer,
    pub(super) places: &'a wgpu::Buffer,
    pub(super) list: &'a wgpu::Buffer,
    /// Two positions per listed receiver, if lists store positions.
    pub(super) positions: &'a wgpu::Buffer,
    /// A word per list, if silhouettes are drawn.
    pub(super) penumbrae: &'a wgpu::Buffer,
    /// Corners of each triangle's region, if regions are computed before drawing.
    pub(super) hulls: &'a wgpu::Buffer,
    pub(super) shaft: &'a wgpu::Buffer,
    pub(super) whole_light: &'a wgpu::Buffer,
    pub(super) cells: &'a wgpu::Buffer,
    pub(super) triangle_places: &'a wgpu::Buffer,
    pub(super) triangles: &'a wgpu::Buffer,
    pub(super) edges: &'a wgpu::Buffer,
    pub(super) boxes: &'a wgpu::Buffer,
    pub(super) totals: &'a wgpu::Buffer,
    pub(super) dispatches: &'a wgpu::Buffer,
    pub(super) work: &'a wgpu::Buffer,
    pub(super) bits: &'a wgpu::Buffer,
}

impl Buffers {
    /// Allocates the buffers of the frame, and uploads the light's points that every pass reads.
    pub(super) fn prepare(&mut self, stage: &Stage<'_>, plan: &FramePlan, points: &[LocalPoint]) -> BufferSet<'_> {
        let storage = wgpu::BufferUsages::STORAGE;
        let FramePlan { pixels, max_triangles, .. } = *plan;
        BufferSet {
            state: sized_buffer(stage, &mut self.state, "view-sample state", STATE_LENGTH * 4, storage),
            counts: sized_buffer(
                stage,
                &mut self.counts,
                "view-sample counts",
                u64::from(plan.list_count + 2) * 4,
                storage,
            ),
            places: sized_buffer(stage, &mut self.places, "view-sample places", pixels * 8, storage),
            list: sized_buffer(stage, &mut self.list, "view-sample lists", pixels * 4, storage),
            positions: sized_buffer(
                stage,
                &mut self.positions,
                "view-sample positions",
                if plan.stores_positions { pixels * POSITIONS_BYTES } else { POSITIONS_BYTES },
                storage,
            ),
            penumbrae: sized_buffer(
                stage,
                &mut self.penumbrae,
                "view-sample penumbrae",
                if plan.draws_silhouettes() { u64::from(plan.list_count) * 4 } else { 4 },
                storage,
            ),
            hulls: sized_buffer(
                stage,
                &mut self.hulls,
                "view-sample region hulls",
                if plan.makes_hulls { u64::from(max_triangles) * HULL_BYTES } else { 8 },
                storage,
            ),
            shaft: sized_buffer(
                stage,
                &mut self.shaft,
                "view-sample shaft",
                SHAFT_LENGTH * 16,
                storage | wgpu::BufferUsages::UNIFORM,
            ),
            whole_light: upload_storage(stage, &mut self.whole_light, "view-sample light", &packed_box(points)),
            cells: sized_buffer(stage, &mut self.cells, "triangle cells", u64::from(CELL_COUNT + 1) * 4, storage),
            triangle_places: sized_buffer(
                stage,
                &mut self.triangle_places,
                "triangle places",
                u64::from(max_triangles) * 8,
                storage,
            ),
            triangles: sized_buffer(
                stage,
                &mut self.triangles,
                "triangles",
                u64::from(max_triangles) * u64::from(plan.max_stride) * 16,
                storage,
            ),
            edges: sized_buffer(stage, &mut self.edges, "edge faces", u64::from(plan.edge_slots()) * 4, storage),
            boxes: sized_buffer(
                stage,
                &mut self.boxes,
                "cluster boxes",
                u64::from(plan.max_clusters() + plan.max_supers()) * 32,
                storage,
            ),
            totals: sized_buffer(stage, &mut self.totals, "view-sample totals", 20, storage),
            dispatches: sized_buffer(
                stage,
                &mut self.dispatches,
                "view-sample dispatches",
                16,
                storage | wgpu::BufferUsages::INDIRECT,
            ),
            work: sized_buffer(
                stage,
                &mut self.work,
                "view-sample work",
                u64::from(FIRST_GROUP + 4 * plan.max_groups()) * 4,
                storage | wgpu::BufferUsages::COPY_SRC,
            ),
            bits: sized_buffer(
                stage,
                &mut self.bits,
                "view-sample bits",
                plan.bits_bytes(),
                storage | wgpu::BufferUsages::COPY_SRC,
            ),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let all = [
            &self.state,
            &self.counts,
            &self.places,
            &self.list,
            &self.positions,
            &self.penumbrae,
            &self.hulls,
            &self.shaft,
            &self.whole_light,
            &self.cells,
            &self.triangle_places,
            &self.triangles,
            &self.edges,
            &self.boxes,
            &self.totals,
            &self.dispatches,
            &self.work,
            &self.bits,
        ];
        all.into_iter().flatten().map(wgpu::Buffer::size).sum()
    }
}
