//! `multi_layer`: filtered multi-layer shadow maps.
//!
//! Kai Selgrad, Carsten Dachsbacher, Quirin Meyer, Marc Stamminger, "Filtering Multi-Layer Shadow Maps for Accurate Soft
//! Shadows", Computer Graphics Forum 34(1), 2014. Each texel of the base holds the list of *all* its fragments, with depth and
//! opacity. Merging the lists of 2 × 2 texels blurs the occluders themselves: partial coverage becomes lower opacity. A
//! receiver looks each depth up in the level whose blur matches the light's.
//!
//! # Level for a depth
//! A segment from a receiver at depth `z_r` to a point of the light at offset `o` from its centre crosses depth `z` at distance
//! `o · g` from the segment to the centre, measured on the light's plane, where
//!
//! ```text
//! g = 1/z − 1/z_r   (perspective)        g = z_r − z   (sun, o a tangent)
//! ```
//!
//! so the receiver sees an occluder there through a filter of width `f_s = l · g`, for a square light of side `l` (section 5.1,
//! where `z_near` cancels against the texel's width). The inverse, `g = f / l`, gives the depth for a filter size, the paper's
//! `z(f_s)`. Level `i` serves the depths between its neighbours' filter widths, with a weight that falls from 1 at its own to 0
//! at theirs (section 5.2). The weight is linear in `f²`: variances of blurs add, so the mixture of two levels has the required
//! variance.
//!
//! A level's width includes its bilinear lookup: a box of width `W` interpolated between texels `s` apart blurs like a box of
//! width `√(W² + 2 s²)`. Lights that are not squares act as the square of the same variance.
//!
//! # Differences from the paper
//! Errors are rmse against the ray tracer, 320 × 180. Of two values, the first is without the difference and the second with
//! it.
//! - **Accumulation of surfaces at different depths.** The paper adds opacities, which darkens stacked occluders too much
//!   (figure 15), or multiplies transmittances, which splits one occluder that lies in two levels, (1 − ½)(1 − ½) = ¼
//!   (figure 14). Two neighbouring levels see the *same* surface, one too sharp and one too soft, so they are mixed here.
//!   Different surfaces are accumulated by the directions of their edges; the four lists of a lookup also give the change of
//!   opacity across the map, an edge. If the edges of two surfaces point the same way, one hides behind the other and the
//!   larger opacity counts; if they point opposite ways, the surfaces adjoin and opacities add; if they are unrelated,
//!   transmittances multiply. With `level_accumulation=pairs`, which mixes and multiplies, and with `correlated`:
//!   `stacked-panels` .049 and .015, `leaning-plank` .025 and .013, `stained-glass` .057 and .037.
//! - **Overlap of fragments in one list** is computed when lists are merged (`list_accumulation=overlap`). Fragments of
//!   different lists adjoin. Once merged, they share a list, where multiplying them, or adding them although they lie behind
//!   one another, hides too little or too much. Each fragment therefore stores how much of it lies behind nearer ones, from the
//!   mean of the lists' transmittances (as in deep shadow maps: Lokovic, Veach, SIGGRAPH 2000). A wall at a grazing angle stays
//!   one wall for any kernel size: in a closed room under a lamp (`inside_out`) 1 % of the light leaked with `multiply` and
//!   0.3 % with `overlap`; the scene `overlap` has .0147 and .0140, `fence-geometry` .0575 and .0532.
//! - **Weights of the hat function** (section 5.2: fragments are "weighted depending on their z-value by a hat-function" and
//!   gathered). With `hat=fragments`, as published, each fragment of opacity α counts w α in a level and (1 − w) α in the next,
//!   and all of these are accumulated. Two opaque surfaces at w = ½ are four fragments of ½: multiplied they hide 1 − (1 − ½)⁴
//!   = .94, added min(4 · ½, 1) = 1. Here a level is accumulated first, in the example to 1 in both levels, and its occlusion
//!   is weighted: multiplied that is 1 − (1 − ½)² = .75, mixed it is ½ · 1 + ½ · 1 = 1, which is correct.
//! - **All faces** of closed meshes cast, whereas the paper keeps the back faces. A solid's two faces have the same edges, so
//!   they do not darken twice, and grooves and contacts finer than a texel no longer leak. `street` .094 and .079,
//!   `stained-glass` .037 and .020. `faces=back` has half the fragments.
//! - **Coverage.** With four samples per texel (`msaa`), the opacity of the base's fragments is the covered fraction of the
//!   texel instead of 0 or 1 (for opaque casters whose positions and indices have the usage `STORAGE`). The paper leaves this
//!   to future work ("semi-transparent fragments at silhouette edges"). Casters thinner than a texel keep their area. Without
//!   quarters of the light: `fence-geometry` .069 with one sample and .067 with four, `tree` .059 and .056.
//! - **Quarters of the light** (`light_parts`) are looked up one by one, each in kernels half as wide and at its own side of
//!   the receiver. Occluders of different quarters then add, and occluders of the same quarter come from lists that were merged
//!   once less. Merging loses the arrangement of leaves within a kernel. `tree` .056 and .050, `overlap` .019 and .011,
//!   `lantern-wall` .018 and .016, `street` .078 and .074, for four times the lookups. Next to the receiver, where the
//!   quarters' kernels are finer than texels, the base is looked up without the shift.
//! - **ε** grows by √2 per level from 10 w, not by 2 from 2 w: coarse levels keep distant surfaces apart, and fine levels stay
//!   short.
//! - **A finer Y-map.** A mixture of two levels is a blur of the right variance and the wrong shape, more so the farther their
//!   widths are apart. `fine_y_map` has a level between each two of the stack, and in exchange halves again once kernels are
//!   four texels wide. Compared with the paper's: `overlap` .0124 and .0100, `lantern-wall` .0163 and .0120, from 1.21 times
//!   the lists of a MIP-map where the paper's has 1.32 times. With a MIP-map the two scenes have .0216 and .0267.
//! - **Depths are averaged by opacity,** not by count, so that a sliver does not pull a surface from its place.
//! - **The receiver's plane.** A fragment must be in front of the receiver's plane at the list's texel, so that tilted
//!   receivers do not shade themselves. Lists behind that plane at an occluder's depth are ignored; the lists in front of it
//!   give the opacity (`street` .067 and .063, `tree` .049 and .044: receivers at grazing angles no longer miss half of the
//!   occluders above them). The light's part below the plane counts as occluded. Where the light comes near the plane, the
//!   opacity of the receiver's own surface in merged lists is removed, because half of that surface is nearer to the light than
//!   the lists' positions (a sphere of .2 m with its centre .1 m above the ground of `leaning-plank`: .374 and .071;
//!   `sconce_touch` .106 and .015).
//! - **Rectangular maps.** The map has the window's aspect ratio, and `map_size`² texels in total (`street` .073 and .067).
//!   Texels have the light's aspect ratio, up to 4 : 1, so that square kernels of them are rectangles of the light's shape.
//!
//! `multi_layer:paper` (`Quality::Paper`) turns each of these off; the parameters' declarations and
//! `antumbra techniques multi_layer` say which parameter does what. `level_weights=none`, `fixed_level` and `hierarchy=mip_map`
//! reproduce the comparisons of figures 5, 6 and 10.
//!
//! # Passes
//! `count` and `collect` draw the casters, `scan` turns counts into offsets, `sort` orders each list (or `link`, `sort`).
//! `filter` computes each level from a finer one. `nearest` finds the nearest fragment of every square of 4, 8, 16, … texels of
//! the base. `resolve` looks up. With `sub`, `upsample` interpolates between every other pixel and lists the pixels that this
//! would get wrong, and `resolve missing` looks those up, packed side by side.
//!
//! A level stores only what receivers look up in it. Filters as wide as its own apply only to occluders far enough in front of
//! the farthest receiver, so its lists end there. Levels without occluders at such distances are not made: nine of
//! seventeen on `overlap`. `prune=false` makes all levels in full, as the paper does.
//!
//! A lookup first finds the levels that contain anything for it: by four reads of `nearest` per level, those with a fragment
//! near enough to the light around the receiver, and of these the ones whose lists have fragments at the level's depths. It
//! then walks only their lists. Threads of a group need different levels, and in one loop over all levels they would wait for
//! one another at each. In groups of eight threads, walks per pixel for all parts of the light together are 4.6 on `overlap`
//! and 3.7 on `lantern-wall`, where up to forty levels exist to walk; those of a MIP-map are 4.4 and 3.6. The accumulation of
//! opacities is a pipeline constant; the pipeline is recompiled when it changes.
//!
//! A level's lookup ends with the surface that begins before the next finer level's depth; surfaces that begin beyond it belong
//! to that level.
//!
//! Time depends on the length of the lists: a larger ε shortens them where many surfaces lie behind one another (`tree`), and
//! has nothing left to merge where a list has one or two (`lantern-wall`: 1.4 per list from the third level on).
//!
//! Memory: 8 bytes per fragment and 8 per list. Counts are read back a frame later. A frame without memory for all fragments
//! keeps unmerged lists in coarse levels or drops fragments, and reports [`Technique::overflow`]; the next has enough.
//!
//! # Limits
//! Occluders finer than a fourth of a texel of the base are seen only where a sample meets them, and so in bands
//! (`fence-geometry`). Surfaces within ε in a list are one: the umbra of foliage with many layers is a little too light
//! (`tree`). Receivers at grazing angles look up objects in contact with them in texels wider than the objects, and are a
//! little too dark beside them or miss them (`street`'s signs, washing and ribbed lanterns). Fragments are seen from the
//! light's centre alone: sides of thick occluders that face the light's rim are missed. Penumbrae wider than the last level are
//! cut off. Lights act as rectangles: round ones, and ones of varying emission, by mean and variance. Alpha masks are filtered
//! by mean alpha, which covers too much or too little for cutoffs far from ½.

use crate::contract::{
    CastersKey, DrawnLists, Error, ListLengths, ListLevel, ListOrder, MeshCaster, Overflow, PreparedCasters,
    PreparedFrame,
};
use crate::gpu::{
    Bindings, Cached, Content, Gpu, Recorder, Span, Stage, bindings, compute_pipeline_without_zeroing, create_uniform,
    upload_growable, write_uniform,
};
use crate::light_map::light_view::LightViewGpu;
use crate::light_map::texel_lists::{PreparedLists, TexelLists};
use crate::mask::resolve::{PreparedResolve, Resolve, ResolveShader};
use crate::receivers::inputs::FrameInputs;
use crate::shaders;
use crate::techniques::Technique;

#[cfg(test)]
mod cpu;
mod designs;
mod fragment_room;
pub(crate) mod gpu_types;
mod levels;
mod nearest;
mod params;
mod plan;
#[cfg(test)]
mod tests;

use designs::FilterDesign;
use fragment_room::FragmentRoom;
use gpu_types::{FilterStep, MultiLayerLadder, MultiLayerUniform};
use levels::Level;
use nearest::{NearestSquares, PreparedNearest, all_squares};
pub use params::{
    MultiLayerDepthAverage, MultiLayerEpsilonGrowth, MultiLayerFaces, MultiLayerFilterWidths, MultiLayerGather,
    MultiLayerHat, MultiLayerHierarchy, MultiLayerLevelAccumulation, MultiLayerLevelWeights, MultiLayerLightParts,
    MultiLayerListAccumulation, MultiLayerLists, MultiLayerMapShape, MultiLayerParams, MultiLayerSamples,
    MultiLayerShow,
};
use plan::FramePlan;

bindings! {
    struct FilteredLists = "multi_layer filter", COMPUTE, group 0 of [MULTI_LAYER_FILTER] {
        /// [`FilterStep`]s, [`STEP_STRIDE`] bytes apart.
        0 filter_step: DynamicStorage(size_of::<FilterStep>()),
        1 lists: ReadWrite,
        2 fragments: ReadWrite,
        3 counters: ReadWrite,
    }

    struct LookedUp = "multi_layer lookup", COMPUTE, group 1 of [MULTI_LAYER_RESOLVE] {
        0 light_view: Uniform,
        1 multi_layer: Uniform,
        2 lists: Storage,
        3 fragments: Storage,
        4 nearest_in: Storage,
        5 ladder: Uniform,
    }
}

/// Threads along each side of a workgroup.
const TILE: u32 = 8;

/// Distance of [`FilterStep`]s, bytes: dynamic offsets are multiples of WebGPU's default alignment.
const STEP_STRIDE: u32 = 256;

/// Filtered multi-layer shadow maps.
#[derive(Debug)]
pub struct MultiLayer {
    lists: TexelLists,
    inputs: FrameInputs,
    filter_layout: wgpu::BindGroupLayout,
    /// Pipeline that filters a level, keyed by its constants.
    filter: Cached<FilterDesign, wgpu::ComputePipeline>,
    nearest: NearestSquares,
    lookup_layout: wgpu::BindGroupLayout,
    resolve: Resolve,
    view_uniform: wgpu::Buffer,
    lookup_uniform: wgpu::Buffer,
    ladder_uniform: wgpu::Buffer,
    /// [`FilterStep`]s, [`STEP_STRIDE`] bytes apart.
    filter_steps: Option<wgpu::Buffer>,
    room: FragmentRoom,
    /// Cache key of lists, levels and squares.
    content: Content<(CastersKey, Vec<u8>)>,
    /// Lists of the frame prepared last, if they are the light's own.
    drawn_lists: Option<DrawnLists>,
}

/// Passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedMultiLayer {
    lists: PreparedLists,
    /// Whether an earlier frame has already made the lists, their levels and squares.
    are_made: bool,
    levels: Vec<Level>,
    filter: wgpu::ComputePipeline,
    filter_group: wgpu::BindGroup,
    nearest: PreparedNearest,
    lookup_group: wgpu::BindGroup,
    resolve: PreparedResolve,
    #[cfg(test)]
    texel_in_plane: f32,
}

impl Technique for MultiLayer {
    const NAME: &'static str = "multi_layer";
    type Params = MultiLayerParams;
    type Prepared = PreparedMultiLayer;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let inputs = FrameInputs::new(gpu);
        let filter_layout = FilteredLists::layout(gpu);
        let lookup_layout = LookedUp::layout(gpu);
        Ok(Self {
            lists: TexelLists::new(gpu),
            filter: Cached::default(),
            filter_layout,
            nearest: NearestSquares::new(gpu),
            lookup_layout,
            resolve: Resolve::default(),
            view_uniform: create_uniform::<LightViewGpu>(gpu, "antumbra light view"),
            lookup_uniform: create_uniform::<MultiLayerUniform>(gpu, "antumbra multi_layer lookup"),
            ladder_uniform: create_uniform::<MultiLayerLadder>(gpu, "antumbra multi_layer ladder"),
            filter_steps: None,
            room: FragmentRoom::new(gpu),
            content: Content::default(),
            drawn_lists: None,
            inputs,
        })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &MultiLayerParams,
    ) -> Result<PreparedMultiLayer, Error> {
        let meshes = frame.casters.meshes(Self::NAME, "lists contain every fragment, a depth map only the first")?;
        let plan = FramePlan::new(stage, frame, meshes, params);
        self.room.update(stage, plan.square_size, &plan.levels)?;
        let capacity = self.room.capacity;
        let list_options = plan.list_options(capacity);
        let lists = self.lists.prepare(stage, &plan.view, meshes, &list_options);
        write_uniform(stage, &self.view_uniform, &plan.gpu_view);
        let squares = all_squares(plan.map_size);
        let (lookup, ladder) = plan.lookup(&squares);
        write_uniform(stage, &self.lookup_uniform, &lookup);
        write_uniform(stage, &self.ladder_uniform, &ladder);
        let filter = self.filter(stage, plan.filter_design());
        let shader = ResolveShader {
            label: "multi_layer resolve",
            wgsl: shaders::MULTI_LAYER_RESOLVE,
            constants: &plan.design().constants(),
            layouts: &[&self.lookup_layout],
        };
        let resolve = self.resolve.prepare(stage, &mut self.inputs, frame, params.sub, &shader);
        let steps = plan.filter_steps(capacity);
        // `Debug` prints the fields in order, and floats that print alike are equal.
        let options = format!("{list_options:?} {squares:?} {:?}", plan.filter_design());
        let casters = stage.casters().filter(|_| lists.lease.is_own());
        let of = [bytemuck::bytes_of(&plan.gpu_view), options.as_bytes(), &steps];
        let are_made = self.content.ask(casters.map(|casters| (casters, of.concat())));
        let largest = ladder.rungs.iter().map(|rung| rung.square_shift).max().unwrap_or(0);
        let filter_group = self.bind_filter(stage, &lists, &steps);
        let room_bytes = NearestSquares::bytes_of(plan.square_size);
        let nearest = self.nearest.prepare(stage, &lists, room_bytes, &squares, largest, plan.map_size);
        let lookup_group = self.bind_lookup(stage, &lists, &nearest);
        self.drawn_lists = lists.lease.is_own().then(|| drawn_lists(&lists, &plan.levels));
        Ok(PreparedMultiLayer {
            lists,
            are_made,
            #[cfg(test)]
            texel_in_plane: plan.gpu_view.texel_in_plane,
            levels: plan.levels,
            filter,
            filter_group,
            nearest,
            lookup_group,
            resolve,
        })
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMultiLayer) {
        let PreparedCasters::Draws(meshes) = &frame.casters else { return };
        if !prepared.are_made {
            self.record_lists(recorder, prepared, meshes);
        }
        if !prepared.are_made || self.room.feedback.is_missing() {
            self.room.feedback.record(recorder, &prepared.lists.counters);
        }
        prepared.resolve.record(recorder, |pass| pass.set_bind_group(1, &prepared.lookup_group, &[]));
    }

    /// Whether counts have arrived, some frames later, and all fragments fitted.
    fn is_settled(&self, _params: &MultiLayerParams, _still_frames: u32) -> bool {
        !self.room.feedback.is_awaited() && self.room.overflow.is_none()
    }

    fn drawn_lists(&self) -> Vec<DrawnLists> {
        self.drawn_lists.iter().cloned().collect()
    }

    fn memory_bytes(&self) -> u64 {
        self.lists.memory_bytes() + self.room.feedback.memory_bytes()
    }

    fn overflow(&self) -> Option<Overflow> {
        self.room.overflow
    }
}

impl MultiLayer {
    /// Records the passes that gather the lists and make their levels and squares.
    fn record_lists(&self, recorder: &mut Recorder<'_>, prepared: &PreparedMultiLayer, meshes: &[MeshCaster<'_>]) {
        self.lists.record(recorder, meshes, &prepared.lists);
        recorder.compute("filter", Span::Only, |pass| {
            pass.set_pipeline(&prepared.filter);
            for (level, i) in prepared.levels[1..].iter().zip(0..) {
                pass.set_bind_group(0, &prepared.filter_group, &[i * STEP_STRIDE]);
                let groups = level.size.map(|texels| texels.div_ceil(TILE));
                pass.dispatch_workgroups(groups.x, groups.y, 1);
            }
        });
        recorder.compute("nearest", Span::Only, |pass| self.nearest.record(pass, &prepared.nearest));
    }

    fn bind_filter(&mut self, stage: &Stage<'_>, of_frame: &PreparedLists, steps: &[u8]) -> wgpu::BindGroup {
        let filter_step = upload_growable(stage, &mut self.filter_steps, "antumbra multi_layer filter", steps);
        let PreparedLists { lists, fragments, counters, .. } = of_frame;
        FilteredLists { filter_step, lists, fragments, counters }.group(stage, &self.filter_layout)
    }

    fn bind_lookup(&self, stage: &Stage<'_>, lists: &PreparedLists, nearest: &PreparedNearest) -> wgpu::BindGroup {
        let lookup = LookedUp {
            light_view: &self.view_uniform,
            multi_layer: &self.lookup_uniform,
            lists: &lists.lists,
            fragments: &lists.fragments,
            nearest_in: &nearest.depths,
            ladder: &self.ladder_uniform,
        };
        lookup.group(stage, &self.lookup_layout)
    }

    /// Returns the filter's pipeline, and compiles it if it is missing.
    fn filter(&mut self, gpu: &Gpu, design: FilterDesign) -> wgpu::ComputePipeline {
        let make = || {
            let (wgsl, layouts) = (shaders::MULTI_LAYER_FILTER, [&self.filter_layout]);
            compute_pipeline_without_zeroing(gpu, "multi_layer filter", wgsl, &design.constants(), &layouts)
        };
        self.filter.get_or_make(design, make).clone()
    }
}

/// Returns the lists of a map and of its levels, for hosts to inspect.
fn drawn_lists(lists: &PreparedLists, levels: &[Level]) -> DrawnLists {
    let level = |level: &Level| ListLevel { first: level.first, size_texels: level.size };
    DrawnLists {
        words: (*lists.lists).clone(),
        lengths: ListLengths::Counted,
        listed: "fragments",
        order: ListOrder::Rows,
        levels: levels.iter().map(level).collect(),
    }
}
