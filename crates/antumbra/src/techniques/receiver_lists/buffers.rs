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
    pub(super) fn prepare<'a>(
        &'a mut self,
        stage: &Stage<'_>,
        plan: &FramePlan,
        points: &[LocalPoint],
    ) -> BufferSet<'a> {
        use wgpu::BufferUsages as Usages;

        let sized = |slot: &'a mut Option<wgpu::Buffer>, label, bytes, more: Usages| {
            sized_buffer(stage, slot, label, bytes, Usages::STORAGE | more)
        };
        let storage = |slot: &'a mut Option<wgpu::Buffer>, label, bytes| sized(slot, label, bytes, Usages::empty());
        let pixels = plan.pixels;
        let (lists, triangles) = (u64::from(plan.list_count), u64::from(plan.max_triangles));
        let corners = triangles * u64::from(plan.max_stride);
        let positions = if plan.stores_positions { pixels } else { 1 };
        let penumbrae = if plan.draws_silhouettes() { lists } else { 1 };
        let hulls_bytes = if plan.makes_hulls { triangles * HULL_BYTES } else { 8 };
        let cluster_boxes = u64::from(plan.max_clusters() + plan.max_supers());
        let work_words = u64::from(FIRST_GROUP + 4 * plan.max_groups());
        BufferSet {
            state: storage(&mut self.state, "view-sample state", STATE_LENGTH * 4),
            counts: storage(&mut self.counts, "view-sample counts", (lists + 2) * 4),
            places: storage(&mut self.places, "view-sample places", pixels * 8),
            list: storage(&mut self.list, "view-sample lists", pixels * 4),
            positions: storage(&mut self.positions, "view-sample positions", positions * POSITIONS_BYTES),
            penumbrae: storage(&mut self.penumbrae, "view-sample penumbrae", penumbrae * 4),
            hulls: storage(&mut self.hulls, "view-sample region hulls", hulls_bytes),
            shaft: sized(&mut self.shaft, "view-sample shaft", SHAFT_LENGTH * 16, Usages::UNIFORM),
            whole_light: upload_storage(stage, &mut self.whole_light, "view-sample light", &packed_box(points)),
            cells: storage(&mut self.cells, "triangle cells", u64::from(CELL_COUNT + 1) * 4),
            triangle_places: storage(&mut self.triangle_places, "triangle places", triangles * 8),
            triangles: storage(&mut self.triangles, "triangles", corners * 16),
            edges: storage(&mut self.edges, "edge faces", u64::from(plan.edge_slots()) * 4),
            boxes: storage(&mut self.boxes, "cluster boxes", cluster_boxes * 32),
            totals: storage(&mut self.totals, "view-sample totals", 20),
            dispatches: sized(&mut self.dispatches, "view-sample dispatches", 16, Usages::INDIRECT),
            work: sized(&mut self.work, "view-sample work", work_words * 4, Usages::COPY_SRC),
            bits: sized(&mut self.bits, "view-sample bits", plan.bits_bytes(), Usages::COPY_SRC),
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
