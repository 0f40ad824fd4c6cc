//! `multi_layer`: filtered multi-layer shadow maps.
//!
//! Kai Selgrad, Carsten Dachsbacher, Quirin Meyer, Marc Stamminger, "Filtering Multi-Layer Shadow Maps for Accurate Soft
//! Shadows", Computer Graphics Forum 34(1), 2014. Each texel of the base holds the list of *all* its fragments, with
//! depth and opacity. Merging the lists of 2 × 2 texels blurs the occluders themselves: what a fragment covers in part
//! becomes a fragment of less opacity. A receiver then looks each depth up in the level whose blur is the light's.
//!
//! # Which level for which depth
//! A segment from a receiver at depth `z_r` to a point of the light that is `o` from its centre crosses depth `z` at
//! `o · g` from the segment to the centre, on the light's plane, where
//!
//! ```text
//! g = 1/z − 1/z_r   (perspective)        g = z_r − z   (sun, o a tangent)
//! ```
//!
//! so an occluder there is seen through a filter of width `f_s = l · g`, for a square light of side `l` (section 5.1,
//! where `z_near` cancels against the texel's width). Inverted, `g = f / l` gives the depth for a filter size, the
//! paper's `z(f_s)`. Level `i` serves the depths between those of its neighbours' widths, with a weight that falls from
//! 1 at its own to 0 at theirs (section 5.2). The weight is linear in `f²`: variances of blurs add, so the mixture of
//! two levels then has the variance asked for.
//!
//! A level's own width counts its bilinear lookup: a box of width `W` looked up between texels `s` apart blurs as a box
//! of width `√(W² + 2 s²)`. Lights that are not squares act as the square of the same variance.
//!
//! # Where we depart from the paper
//! Errors are rmse against the ray tracer, 320 × 180.
//! - **How surfaces at different depths come together.** The paper adds opacities, which darkens what stands one behind
//!   the other (figure 15), or multiplies transmittances, which breaks one occluder apart where it lies in two levels,
//!   (1 − ½)(1 − ½) = ¼ (figure 14). Two neighbouring levels see the *same* surface, one too sharp and one too soft, so
//!   we mix them. Different surfaces come together by how their edges lie: the four lists of a lookup also give the
//!   change of opacity across the map, an edge. Where the edges of two surfaces point the same way one hides behind the
//!   other and the larger opacity counts; where they point opposite ways the surfaces adjoin and opacities add; where
//!   they are unrelated transmittances multiply. With `level_accumulation=pairs`, which mixes and multiplies, and with
//!   `correlated`: `stacked-panels` .049 and .015, `leaning-plank` .025 and .013, `stained-glass` .057 and .037.
//! - **What fragments of one list have in common** is found when lists are merged (`list_accumulation=overlap`). What fragments of
//!   different lists hide adjoins; merged, they stand in one list, and multiplied there, or added where they do lie behind one
//!   another, they hide too little or too much. So each fragment keeps how much of it lies behind the nearer ones, from the mean
//!   of the lists' transmittances (as in deep shadow maps: Lokovic, Veach, SIGGRAPH 2000). A wall that the light grazes is one wall
//!   at any kernel's size: in a closed room under a lamp (`inside_out`) 1 % of the light leaked with `multiply` and 0.3 %
//!   with `overlap`; root mean square error on the scenes `overlap` and `fence-geometry` (320 × 180) .0147 and .0140, .0575 and .0532.
//! - **What the hat weights** (section 5.2: fragments are "weighted depending on their z-value by a hat-function" and
//!   gathered). With `hat=fragments`, as published, each fragment of opacity α counts w α in a level and (1 − w) α in the
//!   next, and all of these are accumulated. Two opaque surfaces at w = ½ are four fragments of ½: multiplied they hide
//!   1 − (1 − ½)⁴ = .94, added min(4 · ½, 1) = 1. We accumulate a level first, here 1 in both, and weight what it hides:
//!   multiplied that is 1 − (1 − ½)² = .75, mixed it is ½ · 1 + ½ · 1 = 1, which is the truth.
//! - **All faces** of closed meshes cast, where the paper keeps the back ones: a solid's two faces have the same edges,
//!   so they do not darken twice, and grooves and contacts finer than a texel no longer leak. `street` .094 and .079,
//!   `stained-glass` .037 and .020. `faces=back` has half the fragments.
//! - **Coverage.** Four samples a texel (`msaa`): the opacity of the base's fragments is the share of the texel that they
//!   cover (opaque casters whose positions and indices have the usage `STORAGE`), not 0 or 1, which the paper leaves to
//!   future work ("semi-transparent fragments at silhouette edges"). What is thinner than a texel keeps its area, before
//!   the light's parts: `fence-geometry` .069 with one sample and .067 with four, `tree` .059 and .056.
//! - **Quarters of the light** (`light_parts`) are looked up one by one, each in kernels half as wide and at its own side of
//!   the receiver. What hides one quarter and what hides another then add, and what hides the same one is found in lists
//!   that were merged once less: where a kernel holds many leaves, how they lie to one another is what is lost by
//!   merging. `tree` .056 and .050, `overlap` .019 and .011, `lantern-wall` .018 and .016, `street` .078 and .074, in four
//!   times the lookups. Next to the receiver, where the parts' kernels are finer than texels, the base is looked up
//!   unshifted.
//! - **ε** grows by √2 a level from 10 w, not by 2 from 2 w: coarse levels keep surfaces apart that lie far apart, fine
//!   levels stay short.
//! - **A finer Y-map.** What two levels mix is a blur of the right variance and the wrong shape, the more so the farther
//!   their widths lie apart. `fine_y_map` has a level between each two of the stack, and in exchange halves again once
//!   kernels are four texels wide. Against the paper's:
//!   `overlap` .0124 and .0100, `lantern-wall` .0163 and .0120, from 1.21 times the lists of a MIP-map where the paper's
//!   has 1.32 times; a MIP-map has .0216 and .0267.
//! - **Depths are averaged by opacity,** not by count, so that a sliver does not pull a surface from its place.
//! - **The receiver's plane.** A fragment must be in front of the receiver's plane at the list's texel, which keeps
//!   tilted receivers from shading themselves; lists behind that plane at an occluder's depth have no say in its opacity,
//!   which those before it give (`street` .067 and .063, `tree` .049 and .044: receivers that the light grazes no longer
//!   miss half of what is above them); and the light's part below the plane counts as occluded. Where the light comes near the
//!   plane, what merged lists hold of the receiver's own surface is taken away: half of it is nearer to the light than where the
//!   lists lie (a sphere of .2 m whose middle is .1 m above the ground of `leaning-plank`: .374 and .071; `sconce_touch` .106 and .015).
//! - **Rectangular maps.** The map has the sides of the window, and `map_size`² texels in all (`street` .073 and .067).
//!   Texels have the light's own proportions, up to 4 : 1, so that square kernels of them are rectangles of the light's
//!   shape.
//!
//! `multi_layer:paper` (`Quality::Paper`) turns each of these off; the parameters' declarations
//! say which does what, and so does `antumbra techniques multi_layer`. `level_weights=none`, `fixed_level` and
//! `hierarchy=mip_map` are what figures 5, 6 and 10 compare with.
//!
//! # Passes
//! `count` and `collect` draw the casters, `scan` turns counts into places, `sort` orders each list (or `link`, `sort`);
//! `filter` makes each level from a finer one; `nearest` takes the nearest fragment of every square of 4, 8, 16, … texels
//! of the base; `resolve` looks up; with `sub`, `upsample` interpolates between every other pixel and lists what it would
//! get wrong, and `resolve missing` looks those up, packed side by side.
//!
//! A level keeps what receivers look up in it, and no more: filters as wide as its own are asked for by what lies far
//! enough before the farthest receiver, so its lists end there, and levels that nothing lies far enough before are not
//! made: nine of seventeen on `overlap`. `prune=false` makes all of them in full, as the paper does.
//!
//! A lookup first tells which levels have anything for it: by four reads of `nearest` for each, those about which anything
//! lies near enough to the light, and of these the ones whose lists have it at the level's depths. Then it walks the lists
//! of those alone. Threads of one group differ in which levels these are, and in one loop over all of them would wait for
//! one another at each: eight at a time, walks a pixel, all parts of the light together, are 4.6 on `overlap` and 3.7 on
//! `lantern-wall` where there are up to forty levels to walk, and a MIP-map's are 4.4 and 3.6. How opacities come together
//! is a constant of the pipeline, made anew when it changes.
//!
//! A level's lookup ends with the surface that begins before the next finer level's depth: what begins beyond is that
//! level's own.
//!
//! Time follows what the lists hold: a larger ε shortens them where many surfaces lie behind one another (`tree`), and has
//! nothing left to merge where a list has one or two (`lantern-wall`: 1.4 a list from the third level on).
//!
//! Memory: 8 bytes a fragment and 8 bytes a list. Counts come back a frame later; a frame without room for all keeps
//! unmerged lists in coarse levels or leaves fragments out, says so by [`Technique::overflow`], and the next has room.
//!
//! # Limits
//! Occluders finer than a fourth of a texel of the base are seen where a sample meets them, and so in bands
//! (`fence-geometry`). Surfaces that a list holds within ε are one: foliage of many layers is a little too light in its
//! umbra (`tree`). Receivers that the light grazes look what touches them up in texels that are wider than it, and are a
//! little too dark beside it, or miss it (`street`'s signs, washing and ribbed lanterns). Fragments are seen from the
//! light's centre alone: sides of thick occluders that face the light's rim are missed. Penumbrae wider than the last
//! level are cut. Lights act as rectangles: of their variance where they are round or their emission varies, about its mean. A mask is filtered by its mean alpha, which for cutoffs far from ½ covers too much or too little.

use crate::contract::{
    CastersKey, DrawnLists, Error, ListLengths, ListLevel, ListOrder, MeshCaster, Overflow, PreparedCasters,
    PreparedFrame,
};
use crate::gpu::{
    Bindings, Cached, Content, Feedback, Gpu, Recorder, Span, Stage, bindings, compute_pipeline_without_zeroing,
    create_uniform, upload_with_room, write_uniform,
};
use crate::light_map::light_view::LightViewGpu;
use crate::light_map::texel_lists::options::Accumulation;
use crate::light_map::texel_lists::{FRAGMENT_BYTES, PreparedLists, TexelLists};
use crate::mask::resolve::{PreparedResolve, Resolve, ResolveShader};
use crate::receivers::inputs::FrameInputs;
use crate::shaders;
use crate::techniques::Technique;

#[cfg(test)]
mod cpu;
pub(crate) mod gpu_types;
mod levels;
mod nearest;
mod params;
mod plan;
#[cfg(test)]
mod tests;

use gpu_types::{FilterStep, MultiLayerLadder, MultiLayerUniform};
use levels::{Level, list_count};
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
        /// [`FilterStep`]s, [`STEP_STRIDE`] apart.
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

/// Bytes from one [`FilterStep`] to the next: dynamic offsets are multiples of WebGPU's default alignment.
const STEP_STRIDE: u32 = 256;

/// Fragments for each texel of the base that the first frame has room for, before any count has come back.
const FIRST_FRAGMENTS_PER_TEXEL: u32 = 4;

/// Room beyond what the last frame needed, so that a moving scene seldom overflows.
const HEADROOM: f64 = 1.25;

/// Filtered multi-layer shadow maps.
#[derive(Debug)]
pub struct MultiLayer {
    lists: TexelLists,
    inputs: FrameInputs,
    filter_layout: wgpu::BindGroupLayout,
    /// With whether it averages depths by count.
    filter: Cached<FilterDesign, wgpu::ComputePipeline>,
    nearest: NearestSquares,
    lookup_layout: wgpu::BindGroupLayout,
    resolve: Resolve,
    view_uniform: wgpu::Buffer,
    lookup_uniform: wgpu::Buffer,
    ladder_uniform: wgpu::Buffer,
    /// [`FilterStep`]s, [`STEP_STRIDE`] apart.
    filter_steps: Option<wgpu::Buffer>,
    feedback: Feedback,
    capacity: u32,
    /// Of lists, levels and squares.
    content: Content<(CastersKey, Vec<u8>)>,
    /// What the frames that the feedback is of had.
    map_size: u32,
    overflow: Option<Overflow>,
    /// Of the frame prepared last, where they are the light's own.
    drawn_lists: Option<DrawnLists>,
}

/// What the lookup is compiled for: the constants of `resolve.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct LookupDesign {
    colored: bool,
    list_accumulation: Accumulation,
    level_accumulation: MultiLayerLevelAccumulation,
    light_parts: MultiLayerLightParts,
    level_weights: MultiLayerLevelWeights,
    hat: MultiLayerHat,
    lists: MultiLayerLists,
    planes: bool,
    shows_levels: bool,
}

impl LookupDesign {
    /// By their names.
    fn constants(self) -> [(&'static str, f64); 9] {
        [
            ("COLORED", f64::from(u8::from(self.colored))),
            ("LIST_ACCUMULATION", f64::from(self.list_accumulation as u32)),
            ("LEVEL_ACCUMULATION", f64::from(self.level_accumulation as u32)),
            ("LIGHT_PARTS", f64::from(self.light_parts.count())),
            ("LEVEL_WEIGHTS", f64::from(self.level_weights as u32)),
            ("WEIGHTS_FRAGMENTS", f64::from(u8::from(self.hat == MultiLayerHat::Fragments))),
            ("LISTS_APART", f64::from(self.lists as u32)),
            ("HAS_PLANES", f64::from(u8::from(self.planes))),
            ("SHOWS_LEVELS", f64::from(u8::from(self.shows_levels))),
        ]
    }
}

/// What the filter is compiled for: what is not asked for is no code at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FilterDesign {
    averages_by_count: bool,
    colored: bool,
    list_accumulation: Accumulation,
}

impl FilterDesign {
    /// By their names.
    fn constants(self) -> [(&'static str, f64); 3] {
        [
            ("AVERAGES_BY_COUNT", f64::from(u8::from(self.averages_by_count))),
            ("COLORED", f64::from(u8::from(self.colored))),
            ("LIST_ACCUMULATION", f64::from(self.list_accumulation as u32)),
        ]
    }
}

/// The passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedMultiLayer {
    lists: PreparedLists,
    /// An earlier frame has made the lists, their levels and squares.
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
            feedback: Feedback::new(gpu, 2),
            capacity: 0,
            content: Content::default(),
            map_size: 0,
            overflow: None,
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
        let technique = Self::NAME;
        let PreparedCasters::Draws(meshes) = &frame.casters else {
            return Err(Error::BadFrame {
                technique,
                what: "the casters",
                had: "a depth map".into(),
                needed: "meshes: lists hold every fragment, a depth map the first".into(),
            });
        };
        let plan = FramePlan::new(stage, frame, meshes, params);
        self.make_room(stage, plan.square_size, &plan.levels)?;
        let list_options = plan.list_options(self.capacity);
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
        let steps = plan.filter_steps(self.capacity);
        // Their order is that of the fields; floats that print alike are alike.
        let options = format!("{list_options:?} {squares:?} {:?}", plan.filter_design());
        let casters = stage.casters().filter(|_| lists.lease.is_own());
        let of = [bytemuck::bytes_of(&plan.gpu_view), options.as_bytes(), &steps];
        let are_made = self.content.ask(casters.map(|casters| (casters, of.concat())));
        let largest = ladder.rungs.iter().map(|rung| rung.square_shift).max().unwrap_or(0);
        let filter_group = self.bind_filter(stage, &lists, &steps);
        let room_bytes = NearestSquares::bytes_of(self.map_size);
        let nearest = self.nearest.prepare(stage, &lists, room_bytes, &squares, largest, plan.map_size);
        let lookup = LookedUp {
            light_view: &self.view_uniform,
            multi_layer: &self.lookup_uniform,
            lists: &lists.lists,
            fragments: &lists.fragments,
            nearest_in: &nearest.depths,
            ladder: &self.ladder_uniform,
        };
        let lookup_group = lookup.group(stage, &self.lookup_layout);
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
        if !prepared.are_made || self.feedback.is_missing() {
            self.feedback.record(recorder, &prepared.lists.counters);
        }
        prepared.resolve.record(recorder, |pass| pass.set_bind_group(1, &prepared.lookup_group, &[]));
    }

    /// Whether there was room for all is learnt some frames later.
    fn is_settled(&self, _params: &MultiLayerParams, _still_frames: u32) -> bool {
        !self.feedback.is_awaited() && self.overflow.is_none()
    }

    fn drawn_lists(&self) -> Vec<DrawnLists> {
        self.drawn_lists.iter().cloned().collect()
    }

    fn memory_bytes(&self) -> u64 {
        self.lists.memory_bytes() + self.feedback.memory_bytes()
    }

    fn overflow(&self) -> Option<Overflow> {
        self.overflow
    }
}

impl MultiLayer {
    /// Gathers the lists, and makes their levels.
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
        let filter_step = upload_with_room(stage, &mut self.filter_steps, "antumbra multi_layer filter", steps);
        let PreparedLists { lists, fragments, counters, .. } = of_frame;
        FilteredLists { filter_step, lists, fragments, counters }.group(stage, &self.filter_layout)
    }

    /// The filter, compiled where it is not compiled for this.
    fn filter(&mut self, gpu: &Gpu, design: FilterDesign) -> wgpu::ComputePipeline {
        let make = || {
            let (wgsl, layouts) = (shaders::MULTI_LAYER_FILTER, [&self.filter_layout]);
            compute_pipeline_without_zeroing(gpu, "multi_layer filter", wgsl, &design.constants(), &layouts)
        };
        self.filter.get_or_make(design, make).clone()
    }

    /// Sets the capacity by what the last frames needed, and says whether they had it.
    fn make_room(&mut self, stage: &Stage<'_>, map_size: u32, levels: &[Level]) -> Result<(), Error> {
        let limits = stage.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let largest = (binding / FRAGMENT_BYTES) as u32;
        let lists = list_count(levels);
        if lists > largest {
            return Err(Error::Unsupported {
                technique: Self::NAME,
                needed: format!("{lists} lists for a base of {map_size}² texels"),
                had: format!("room for {largest} in a binding of {binding} bytes"),
                remedy: "set a smaller `map_size`",
            });
        }
        let needed = self.feedback.collect(stage).map(|counters| counters[0].max(counters[1]));
        self.overflow = needed.filter(|needed| *needed > self.capacity).map(|needed| Overflow {
            what: "fragments",
            needed: needed.into(),
            had: self.capacity.into(),
        });
        let first = (map_size * map_size).saturating_mul(FIRST_FRAGMENTS_PER_TEXEL);
        let wanted = needed.map_or(0, |needed| (f64::from(needed) * HEADROOM) as u32);
        if self.map_size != map_size {
            self.capacity = 0;
            self.map_size = map_size;
        }
        if self.overflow.is_some() || self.capacity == 0 {
            self.capacity = wanted.max(first).clamp(1024, largest);
        }
        Ok(())
    }
}

/// The lists of a map and of its levels, as hosts may look at them.
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
