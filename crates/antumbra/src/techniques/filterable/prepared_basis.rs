//! Passes of one frame that follow its light map.

use super::pipelines::BindGroups;
use super::{FrameMap, ResolveBy};
use crate::gpu::{Recorder, Span};
use crate::primitives::packed_map::PreparedPackedMap;
use crate::receivers::inputs::PreparedInputs;

/// Threads along each side of a workgroup over the map.
const TILE: u32 = 8;

/// Passes of one frame that follow its light map.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedBasis {
    pub(super) map: FrameMap,
    pub(super) groups: BindGroups,
    /// Layouts of the groups that passes between light map and basis bind.
    pub(super) encode_layout: wgpu::BindGroupLayout,
    pub(super) depth_layout: wgpu::BindGroupLayout,
    /// Pipeline of the encode pass; `None` if the caster pass writes the packed map, or nothing is filtered.
    pub(super) encode: Option<wgpu::ComputePipeline>,
    pub(super) packed: PreparedPackedMap,
    pub(super) resolve: wgpu::ComputePipeline,
}

impl PreparedBasis {
    /// Returns group 0 of passes over the light map.
    pub(crate) fn encode_group(&self) -> &wgpu::BindGroup {
        &self.groups.encode
    }

    /// Returns the layout of [`Self::encode_group`].
    pub(crate) fn encode_layout(&self) -> &wgpu::BindGroupLayout {
        &self.encode_layout
    }

    /// Returns group 1 of passes over the receivers that read the light map's depth: view, filter and depth.
    pub(crate) fn depth_group(&self) -> &wgpu::BindGroup {
        &self.groups.depth
    }

    /// Returns the layout of [`Self::depth_group`].
    pub(crate) fn depth_layout(&self) -> &wgpu::BindGroupLayout {
        &self.depth_layout
    }

    /// Returns the receivers: group 0 of passes over them.
    pub(crate) fn inputs(&self) -> &PreparedInputs {
        &self.map.inputs
    }

    /// Returns a view of each word of the packed map, for a caster pass that writes them.
    pub(crate) fn layer_views(&self) -> &[wgpu::TextureView] {
        self.packed.layer_views()
    }

    /// Records every pass after the light map.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let Self { map, groups, .. } = self;
        if let Some(encode) = &self.encode {
            recorder.compute("encode", Span::Only, |pass| {
                pass.set_pipeline(encode);
                pass.set_bind_group(0, &groups.encode, &[]);
                pass.set_bind_group(1, &groups.params, &[]);
                pass.dispatch_workgroups(map.size.x.div_ceil(TILE), map.size.y.div_ceil(TILE), 1);
            });
        }
        if map.settings.resolve != ResolveBy::Exact {
            self.packed.record(recorder);
        }
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&self.resolve);
            map.inputs.bind(pass);
            pass.set_bind_group(1, &groups.resolve, &[]);
            pass.set_bind_group(2, &groups.params, &[]);
            map.inputs.dispatch(pass);
        });
    }
}
