//! Plan of a frame, computed before allocation: batches of triangles and light points, and their sizes.

use std::fmt;

use antumbra_light::Aabb;
use glam::Vec3;

use super::batches::{BATCH_TRIANGLES, Batch, Run, Surfaces, batches_of};
use super::gpu_types::SampleSettings;
use super::light_points::{MAX_WORDS, WORD, world_box};
use super::region::Region;
use super::settings::{
    CELL_COUNT, CHOOSES, FLAG_CLOSED, PENUMBRA_ONLY, PROJECT_PARALLEL, PROJECT_SPHERE, SUBSET_ALL, SUBSET_KNOWN,
};
use super::windows::Windows;
use super::{Options, Traversal, is_weighted, stride_of};
use crate::contract::{Error, MeshCaster, PreparedFrame};
use crate::gpu::Stage;
use crate::light_map::occluding_bounds::OccludingBounds;
use crate::receivers::inputs::{clip_depth_rows, matrix_rounding_m};

/// Largest size of the bits of all pixels, bytes; more light points are taken in turn.
const BITS_BUDGET_BYTES: u64 = 120 << 20;

/// Number of words of light points that are tested together if casters have holes or tint: each bit costs a texture
/// sample, and no pass may run long.
const TEXTURED_WORDS: usize = 8;

/// Size of a receiver's positions in the lists, bytes: on its surface, and at the ray offset.
pub(super) const POSITIONS_BYTES: u64 = 32;

/// Sizes of a frame.
#[derive(Clone, Debug)]
pub(super) struct FramePlan {
    pub(super) pixels: u64,
    /// Whether only every other pixel in both directions is listed at first.
    pub(super) is_sparse: bool,
    /// Batches of triangles; the first is opaque.
    pub(super) batches: Vec<Batch>,
    /// Number of words of light points that are tested together.
    pub(super) words: usize,
    /// Number of words kept of each pixel's bits.
    pub(super) pixel_words: u32,
    /// Windows; `None` if triangles are not drawn.
    pub(super) windows: Option<Windows>,
    /// Width of a window, or of the one map of groups, texels.
    pub(super) window_side: u32,
    pub(super) list_count: u32,
    /// Largest number of triangles in a batch.
    pub(super) max_triangles: u32,
    pub(super) max_stride: u32,
    /// Options that have an effect.
    pub(super) switches: u32,
    /// Whether lists store positions; only if triangles are drawn.
    pub(super) stores_positions: bool,
    /// Whether regions of influence are computed before they are drawn.
    pub(super) makes_hulls: bool,
}

impl FramePlan {
    /// Returns the plan, or an error if a binding of `binding_limit` bytes cannot hold its data.
    pub(super) fn new(
        technique: &'static str,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'_>],
        options: &Options,
        binding_limit: u64,
    ) -> Result<Self, Error> {
        let check_fits = |bytes: u64, what: fmt::Arguments<'_>, remedy| {
            if bytes <= binding_limit {
                return Ok(());
            }
            let (needed, had) =
                (format!("{bytes} bytes for {what}"), format!("at most {binding_limit} bytes per binding"));
            Err(Error::Unsupported { technique, needed, had, remedy })
        };
        let pixels = u64::from(frame.receivers.size_px.x) * u64::from(frame.receivers.size_px.y);
        let windows = windows_of(frame, options);
        let chooses = windows.is_some() && options.traversal == Traversal::Chosen;
        let stores_positions = windows.is_some() && options.drawn.stored_positions;
        let listed_bytes = pixels * if stores_positions { POSITIONS_BYTES } else { 8 };
        check_fits(listed_bytes, format_args!("a list of {pixels} receivers"), "render the mask in several parts")?;

        // A thread holds the bits of a batch of light points, and a buffer those of all pixels if they must outlast a
        // batch of triangles.
        let makes_hulls = windows.is_some() && options.drawn.region == Region::Hexagons;
        // This makes 44 MiB of hulls.
        let most = if makes_hulls { BATCH_TRIANGLES / 4 } else { BATCH_TRIANGLES };
        let batches = batches_of(meshes, frame.sees_within(), most, options.points.len() > 1);
        let is_textured = batches.iter().any(|batch| batch.surfaces != Surfaces::Opaque);
        let stored_words = (BITS_BUDGET_BYTES / (4 * pixels)).max(1) as usize;
        let words = stored_words.min(if is_textured { TEXTURED_WORDS } else { MAX_WORDS });
        let pixel_words =
            options.points.len().div_ceil(WORD).min(if options.keep_bits { usize::MAX } else { words }) as u32;
        if options.keep_bits {
            let remedy = "use fewer light points or a smaller mask, or set `keep_bits` to false";
            check_fits(pixels * u64::from(pixel_words) * 4, format_args!("the bits of every pixel"), remedy)?;
        }

        let window_side = options.map_size.next_power_of_two();
        let mut plan = Self {
            pixels,
            // Points are in any order, so that nothing can be interpolated between them.
            is_sparse: options.is_sparse && frame.receivers.have_neighbours(),
            words,
            pixel_words,
            windows,
            window_side,
            list_count: windows.map_or(1, |windows| windows.count) << (2 * window_side.ilog2()),
            max_triangles: batches.iter().map(Batch::triangles).max().unwrap_or(0).max(1),
            max_stride: batches.iter().map(stride_of).max().unwrap_or(3),
            switches: options.switches | if chooses { CHOOSES } else { 0 },
            stores_positions,
            makes_hulls,
            batches,
        };
        // A mesh split over several batches counts as open along the cuts.
        if plan.batches.iter().filter(|batch| batch.surfaces == Surfaces::Opaque).count() > 1 {
            plan.switches &= !PENUMBRA_ONLY;
        }
        Ok(plan)
    }

    /// Whether a batch's triangles are drawn over the windows; otherwise groups of receivers walk them.
    pub(super) fn is_drawn(&self, batch: &Batch) -> bool {
        self.windows.is_some() && !matches!(batch.surfaces, Surfaces::Tinted(_))
    }

    /// Whether the device may let groups walk a drawn batch's triangles instead.
    pub(super) fn chooses(&self) -> bool {
        self.switches & CHOOSES != 0
    }

    /// Whether triangles with silhouettes are drawn to mark the texels that penumbrae can reach.
    pub(super) fn draws_silhouettes(&self) -> bool {
        self.windows.is_some() && self.switches & PENUMBRA_ONLY != 0
    }

    /// Number of leading batches that are opaque or alpha-tested; the remaining ones are tinted.
    pub(super) fn opaque_batches(&self) -> usize {
        self.batches.iter().filter(|batch| !matches!(batch.surfaces, Surfaces::Tinted(_))).count()
    }

    /// Returns the runs of closed meshes if triangles with silhouettes are needed; otherwise none.
    pub(super) fn silhouette_runs(&self) -> impl Iterator<Item = &Run> {
        let is_asked = self.switches & PENUMBRA_ONLY != 0;
        let runs = self.batches.iter().flat_map(|batch| &batch.runs);
        runs.filter(move |run| is_asked && run.flags & FLAG_CLOSED != 0)
    }

    /// Number of slots of the edge table, a power of two.
    pub(super) fn edge_slots(&self) -> u32 {
        let closed_triangles: u32 = self.silhouette_runs().map(Run::triangles).sum();
        // Two triangles have three edges; twice as many slots as edges keep most apart.
        (3 * closed_triangles.min(1 << 23)).next_power_of_two().max(64)
    }

    /// Largest number of boxes of 64 triangles each.
    pub(super) fn max_clusters(&self) -> u32 {
        self.max_triangles.div_ceil(64)
    }

    /// Largest number of boxes of 32 clusters each.
    pub(super) fn max_supers(&self) -> u32 {
        self.max_clusters().div_ceil(32)
    }

    /// Largest number of groups of receivers.
    pub(super) fn max_groups(&self) -> u32 {
        self.pixels.div_ceil(64) as u32
    }

    fn is_tinted(&self) -> bool {
        self.batches.iter().any(|batch| matches!(batch.surfaces, Surfaces::Tinted(_)))
    }

    /// Size of every pixel's bits, and of the light that tinted casters transmit, bytes.
    pub(super) fn bits_bytes(&self) -> u64 {
        self.pixels * u64::from(self.pixel_words + if self.is_tinted() { 3 } else { 0 }) * 4
    }

    /// Returns the settings that all passes of the frame share.
    pub(super) fn settings(
        &self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'_>],
        options: &Options,
    ) -> SampleSettings {
        let light = frame.light;
        let [clip_z_row, clip_w_row] = clip_depth_rows(&frame.receivers);
        let whole = world_box(light, &options.points, options.rotations > 0);
        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let between = OccludingBounds::new(light, &bounds, &frame.receivers.corners());
        let casters_box = between.all().fold(Aabb::EMPTY, Aabb::union);
        let casters_box = if casters_box.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } } else { casters_box };
        let base = SampleSettings {
            clip_z_row,
            clip_w_row,
            matrix_rounding_m: matrix_rounding_m(stage, &frame.receivers),
            subset: if self.is_sparse { SUBSET_KNOWN } else { SUBSET_ALL },
            light_min: whole.min,
            point_count: options.points.len() as u32,
            light_max: whole.max,
            word_count: 0,
            casters_min: casters_box.min,
            list_bits: 2 * self.window_side.ilog2(),
            casters_max: casters_box.max,
            projection: if light.is_distant() { PROJECT_PARALLEL } else { PROJECT_SPHERE },
            total_weight: options.points.iter().map(|point| point.weight).sum::<f32>().max(f32::MIN_POSITIVE),
            switches: self.switches,
            cell_count: CELL_COUNT,
            list_count: self.list_count,
            super_first: self.max_clusters(),
            is_weighted: is_weighted(light).into(),
            triangle_stride: 3,
            lookup_size: options.lookup_size,
            pixel_words: self.pixel_words,
            first_passed: if self.is_tinted() { self.pixels as u32 * self.pixel_words } else { 0 },
            rotations: options.rotations,
            turn: options.turn,
            ray_offset_scale: options.ray_offset_scale,
            max_groups: self.max_groups(),
            window_side: self.window_side,
            ..SampleSettings::default()
        };
        let Some(windows) = self.windows else { return base };
        let [window_right, window_up, window_axis] = windows.axes;
        SampleSettings {
            window_count: windows.count,
            window_right,
            region_corners: options.drawn.region.corners(),
            window_up,
            window_axis,
            window_light_min: windows.light.min,
            window_light_max: windows.light.max,
            ..base
        }
    }
}

/// Returns the windows over which triangles are drawn; `None` if groups of receivers walk them.
fn windows_of(frame: &PreparedFrame<'_>, options: &Options) -> Option<Windows> {
    let towards = || Windows::towards(&frame.receivers, frame.light, &options.points, options.rotations > 0);
    match options.traversal {
        Traversal::Groups => None,
        Traversal::Raster => Some(towards()),
        Traversal::Chosen => Some(towards()).filter(|windows| windows.count == 1),
    }
}
