//! Every fragment of casters from a light's view, in lists: one a texel, sorted by depth, tightly packed.
//!
//! Two ways to gather, as Selgrad, Dachsbacher, Meyer and Stamminger 2014 (section 7) measure them: *arrays* count each
//! texel's fragments in one pass over the geometry, turn counts into places by a prefix sum, and collect in a second
//! pass; *linked* lists (Yang et al. 2010) take one pass over the geometry and are packed after. Both end in the same
//! arrays, which can be searched by halving.
//!
//! A fragment is 8 bytes (`fragments.wesl`): depth along the axis in metres, and opacity, of one channel or of three.
//! A list's entry is 8 bytes: first fragment, count. Closed opaque meshes leave their back faces alone, which for what
//! lies outside of them stop the same light; other surfaces leave every face.
//!
//! With four samples a texel, a fragment's opacity counts the share of the texel that its surface covers. The parts of a
//! surface that meet in a texel become one fragment again, and so do the two sides of a thin thing: of what lies near
//! in depth, each sample stops what its nearest stops.
//!
//! Where `capacity` is too small, the fragments that come last are left out, and [`TexelLists::counters`] say how many
//! there were.

use std::sync::Arc;

use self::options::{Gather, ListOptions};
use self::raster::{ListRaster, Pass};
use self::sort::{ListSorter, PreparedSort};
use self::storage::Storage;
use crate::contract::MeshCaster;
use crate::gpu::{Gpu, Lease, Recorder, Stage};
use crate::light_map::light_view::LightView;
use crate::primitives::prefix_scan::PrefixScan;

#[cfg(test)]
pub(crate) mod cpu;
pub(crate) mod gpu_types;
pub(crate) mod options;
mod raster;
mod sort;
mod storage;
#[cfg(test)]
pub(crate) mod tests;

/// Bytes of a fragment, and of a list's entry.
pub(crate) const FRAGMENT_BYTES: u64 = 8;

/// Makes lists.
#[derive(Debug)]
pub(crate) struct TexelLists {
    raster: ListRaster,
    scan: PrefixScan,
    sorter: ListSorter,
    storage: Option<Storage>,
}

/// The lists of one frame, and the passes that fill them.
#[derive(Debug)]
pub(crate) struct PreparedLists {
    /// (first, count) of each texel's list, row by row, then the owner's.
    pub(crate) lists: Arc<wgpu::Buffer>,
    /// The fragments: `array<vec2u>`.
    pub(crate) fragments: Arc<wgpu::Buffer>,
    /// `ListCounters`: how many fragments the casters have, and where the room behind the stored ones begins.
    pub(crate) counters: Arc<wgpu::Buffer>,
    /// The right to the buffers, which those that the owner makes of them share.
    pub(crate) lease: Arc<Lease>,
    raster_group: wgpu::BindGroup,
    sort: PreparedSort,
}

impl TexelLists {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self { raster: ListRaster::new(gpu), scan: PrefixScan::new(gpu), sorter: ListSorter::new(gpu), storage: None }
    }

    /// Allocates and uploads. The buffers stay where neither the map's size nor the room needed grows.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        view: &LightView,
        casters: &[MeshCaster<'_>],
        options: &ListOptions,
    ) -> PreparedLists {
        if self.storage.as_ref().is_none_or(|storage| !storage.fits(options)) {
            // What it has goes back before more is taken.
            self.storage = None;
            self.storage = Some(Storage::new(stage, options));
        }
        let storage = self.storage.as_mut().expect("made above where it was missing");
        storage.options = *options;
        storage.widen(stage);
        self.scan.prepare(stage, &storage.cursors, options.most_texels);
        PreparedLists {
            lists: Arc::clone(&storage.lists),
            fragments: Arc::clone(&storage.fragments),
            counters: Arc::clone(&storage.counters),
            lease: Arc::clone(&storage.lease),
            raster_group: self.raster.prepare(stage, view, casters, storage),
            sort: self.sorter.prepare(stage, storage),
        }
    }

    /// Records the passes that fill the lists: `count`, `scan`, `collect`, `sort`, or `link`, `sort`.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, casters: &[MeshCaster<'_>], prepared: &PreparedLists) {
        self.record_passes(recorder, [casters, casters], prepared);
    }

    /// The same, by the casters that are counted and those that are collected or linked.
    fn record_passes(
        &self,
        recorder: &mut Recorder<'_>,
        [counted, gathered]: [&[MeshCaster<'_>]; 2],
        prepared: &PreparedLists,
    ) {
        let Some(storage) = &self.storage else { return };
        recorder.clear_buffer(&storage.cursors);
        recorder.clear_buffer(&storage.counters);
        let raster = |recorder: &mut Recorder<'_>, pass, casters: &[MeshCaster<'_>]| {
            self.raster.record(recorder, pass, storage, &prepared.raster_group, casters);
        };
        match storage.options.gather {
            Gather::Linked => raster(recorder, ("link", Pass::Link), gathered),
            Gather::Arrays => {
                raster(recorder, ("count", Pass::Count), counted);
                self.scan.record(recorder, "scan");
                storage.record_begins(recorder);
                raster(recorder, ("collect", Pass::Collect), gathered);
            }
        }
        prepared.sort.record(recorder);
    }

    /// Bytes of all buffers that are the light's own.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.storage.as_ref().map_or(0, |storage| storage.lease.own_bytes() + self.scan.memory_bytes())
    }
}
