//! Texel lists: all fragments of casters from a light's view, one list per texel, sorted by depth and tightly packed.
//!
//! There are two ways to gather, as Selgrad, Dachsbacher, Meyer and Stamminger 2014 (section 7) measure them. *Arrays* count
//! each texel's fragments in one pass over the geometry, turn counts into positions by a prefix sum, and collect in a
//! second pass. *Linked* lists (Yang et al. 2010) take one pass over the geometry and are packed afterwards. Both give the
//! same arrays, which allow binary search.
//!
//! A fragment is 8 bytes (`fragments.wesl`): depth along the axis in metres, and opacity, of one channel or of three.
//! A list's entry is 8 bytes: first fragment, count. Closed opaque meshes contribute only their back faces, which stop the
//! same light for receivers outside of them; other surfaces contribute all faces.
//!
//! With four samples per texel, a fragment's opacity includes the share of the texel that its surface covers. Parts of a
//! surface that meet in a texel are merged into one fragment, and so are the two sides of a thin object: among fragments
//! near in depth, each sample takes the opacity of its nearest.
//!
//! If `capacity` is too small, the last fragments are dropped; [`PreparedLists::counters`] has the total number.

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

/// Builder of texel lists.
#[derive(Debug)]
pub(crate) struct TexelLists {
    raster: ListRaster,
    scan: PrefixScan,
    sorter: ListSorter,
    storage: Option<Storage>,
}

/// Lists of one frame, and the passes that fill them.
#[derive(Debug)]
pub(crate) struct PreparedLists {
    /// (first, count) of each texel's list, row by row, then entries of the owner.
    pub(crate) lists: Arc<wgpu::Buffer>,
    /// Fragments: `array<vec2u>`.
    pub(crate) fragments: Arc<wgpu::Buffer>,
    /// `ListCounters`: the number of the casters' fragments, and the end of the stored ones.
    pub(crate) counters: Arc<wgpu::Buffer>,
    /// Lease of the buffers, shared by those that the owner derives from them.
    pub(crate) lease: Arc<Lease>,
    raster_group: wgpu::BindGroup,
    sort: PreparedSort,
}

impl TexelLists {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self { raster: ListRaster::new(gpu), scan: PrefixScan::new(gpu), sorter: ListSorter::new(gpu), storage: None }
    }

    /// Allocates buffers and uploads parameters. Buffers are reused while they fit the options.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        view: &LightView,
        casters: &[MeshCaster<'_>],
        options: &ListOptions,
    ) -> PreparedLists {
        if self.storage.as_ref().is_none_or(|storage| !storage.fits(options)) {
            // The old buffers return their bytes to the budget before the new ones take theirs.
            self.storage = None;
            self.storage = Some(Storage::new(stage, options));
        }
        let storage = self.storage.as_mut().expect("created above if missing");
        storage.options = *options;
        storage.widen(stage);
        self.scan.prepare(stage, &storage.cursors, options.max_texels);
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

    /// [`record`](Self::record), given the casters that are counted and those that are collected or linked.
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

    /// Bytes of all buffers that belong to the light alone.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.storage.as_ref().map_or(0, |storage| storage.lease.own_bytes() + self.scan.memory_bytes())
    }
}
