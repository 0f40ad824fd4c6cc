// Every shader of the library, by the path of its `.wesl` file under `src/`: the one list. Included by `lib.rs`, which
// embeds the linked text, and by `xtask/linker`, which makes it: `cargo xtask shaders`. `with "feature"` compiles the
// parts marked `@if(feature)`; several features stand with `+` between them.

/// Where a shader's linked text lies under `linked/`. Those for tests alone have a folder that is not packaged.
macro_rules! linked_file {
    ($path:literal) => { concat!($path, ".wgsl") };
    ($path:literal with $features:literal) => { concat!($path, ".", $features, ".wgsl") };
    (test $($shader:tt)+) => { concat!("test/", linked_file!($($shader)+)) };
}

shaders! {
    /// Accumulation: what is in a buffer, as a number.
    ACCUMULATION_FINGERPRINT = "mask/accumulation/fingerprint";
    /// Accumulation: means over frames.
    ACCUMULATION_ACCUMULATE = "mask/accumulation/accumulate";
    /// Denoising: means over the frames that saw the same point.
    DENOISE_OVER_TIME = "mask/denoise/over_time";
    /// Denoising: planes fitted to the neighbours.
    DENOISE_OVER_PIXELS = "mask/denoise/over_pixels";
    /// Smoothing of noisy visibility over pixels.
    SMOOTHING_SMOOTH = "mask/smoothing/smooth";
    /// Fade of shadows that end at a distance.
    FADE = "mask/fade/fade";
    /// Half resolution: receivers of half the size.
    HALF_RESOLUTION_PICK = "mask/half_resolution/pick";
    /// Half resolution: a mask of half the size at full size.
    HALF_RESOLUTION_UPSAMPLE = "mask/half_resolution/upsample";
    /// Masks of fewer bits than techniques write.
    MASK_FORMAT_DRAW = "mask/format/draw";
    /// Points as receivers: from a host's buffers to textures.
    POINTS_PACK = "receivers/points/pack";
    /// What a technique gave for points, into a host's buffer.
    POINTS_WRITE = "receivers/points/write";
    /// What a frame's receivers are, for tests.
    #[cfg(test)]
    POINTS_PROBE = "receivers/points/probe";
    /// hard for hosts' shaders.
    HARD_FUNCTION = "techniques/single_map/hard/shader_function";
    /// pcf for hosts' shaders.
    PCF_FUNCTION = "techniques/single_map/pcf/shader_function";
    /// pcss for hosts' shaders.
    PCSS_FUNCTION = "techniques/single_map/pcss/shader_function";
    /// Receivers of a multisampled depth buffer.
    SPLIT_RECEIVERS_DRAW = "receivers/split_receivers/split";
    /// Parts of what a light reaches: the receivers of one.
    LIGHT_PARTITION_PICK = "light_partition/pick";
    /// What a technique gave for one, into the light's mask.
    LIGHT_PARTITION_JOIN = "light_partition/join";
    /// The rasteriser's grid: slanted triangles.
    RASTERISER_DRAW = "gpu/rasteriser/draw";
    /// The rasteriser's grid: how far their depths are off.
    RASTERISER_MEASURE = "gpu/rasteriser/measure";
    /// Casters: a host's vertices into the set's own.
    PACK_MESH = "casters/pack";
    /// Casters: a host's matrices.
    PACK_INSTANCES = "casters/pack_instances";
    /// Light maps of opaque casters.
    CASTER_DEPTH_OPAQUE = "light_map/caster_depth/opaque";
    /// Light maps of casters with holes.
    CASTER_DEPTH_CUTOUT = "light_map/caster_depth/cutout";
    /// Casters' triangles in the world.
    CASTER_TRIANGLES_GATHER = "light_map/caster_triangles/gather";
    /// Their neighbours.
    CASTER_TRIANGLES_JOIN = "light_map/caster_triangles/join";
    /// Maps of which triangle each texel shows.
    CASTER_TRIANGLES_MAP = "light_map/caster_triangles/map";
    /// Layers of opaque casters: depth and its gradient.
    DEPTH_LAYERS_OPAQUE = "light_map/depth_layers/layer_opaque";
    /// Layers of casters with holes.
    DEPTH_LAYERS_CUTOUT = "light_map/depth_layers/layer_cutout";
    /// Four levels of a depth pyramid.
    DEPTH_PYRAMID_LEVELS = "light_map/depth_pyramid/levels";
    /// Its last four.
    DEPTH_PYRAMID_LAST = "light_map/depth_pyramid/last";
    /// Prefix sums: one level down.
    PREFIX_SCAN = "primitives/prefix_scan/scan";
    /// Prefix sums: one level back up.
    PREFIX_SCAN_ADD = "primitives/prefix_scan/add";
    /// Every depth basis, encoded, mixed and decoded.
    #[cfg(test)]
    DEPTH_BASIS_PROBE = "primitives/depth_basis/probe";
    /// Numbers for surfaces of partial coverage.
    #[cfg(test)]
    STOCHASTIC_PROBE = "primitives/stochastic/probe";
    /// Summed-area tables of floats.
    SUMMED_AREA_TABLE_FLOAT = "techniques/summed/summed_area_table/table" with "float";
    /// Summed-area tables of integers.
    SUMMED_AREA_TABLE_INTEGER = "techniques/summed/summed_area_table/table";
    /// The same by recursive doubling.
    SUMMED_AREA_DOUBLING_FLOAT = "techniques/summed/summed_area_table/doubling" with "float";
    /// The same by recursive doubling.
    SUMMED_AREA_DOUBLING_INTEGER = "techniques/summed/summed_area_table/doubling";
    /// One direction of a packed map's blur.
    PACKED_BLUR = "primitives/packed_map/blur";
    /// One of a packed map's mips.
    PACKED_HALVE = "primitives/packed_map/halve";
    /// Several of them.
    PACKED_HALVE_SEVERAL = "primitives/packed_map/halve_several";
    /// The truth of the filterable techniques.
    FILTERABLE_EXACT = "techniques/filterable/exact";
    /// The same of a multisampled map.
    FILTERABLE_EXACT_MULTISAMPLED = "techniques/filterable/exact" with "multisampled";
    /// `hard`: one comparison.
    HARD_RESOLVE = "techniques/single_map/hard/resolve";
    /// `pcf`: a fixed kernel of comparisons.
    PCF_RESOLVE = "techniques/single_map/pcf/resolve";
    /// `pcss`: blocker search, penumbra estimate, filter.
    PCSS_RESOLVE = "techniques/single_map/pcss/resolve";
    /// `smrt`: search, rays through layers.
    SMRT_RESOLVE = "techniques/single_map/smrt/resolve";
    /// `bitmask`: a bit for each light point, micro-patches.
    BITMASK_RESOLVE = "techniques/single_map/bitmask/resolve";
    /// The same with every point tested against every patch.
    #[cfg(test)]
    BITMASK_RESOLVE_EXHAUSTIVE = "techniques/single_map/bitmask/resolve" with "exhaustive";
    /// The same with every square split that may be too wide.
    #[cfg(test)]
    BITMASK_RESOLVE_ONE_BY_ONE = "techniques/single_map/bitmask/resolve" with "one_by_one";
    /// `backprojection`: the area that texels hide.
    BACKPROJECTION_RESOLVE = "techniques/single_map/backprojection/resolve";
    /// Micro-patches of given squares.
    #[cfg(test)]
    PATCH_PROBE = "techniques/single_map/micro_patches/probe";
    /// `pcss_anisotropic`: `pcss` over the pixel's footprint.
    PCSS_ANISOTROPIC_RESOLVE = "techniques/single_map/pcss_anisotropic/resolve";
    /// `multi_view`: adds a batch of views to the mask.
    MULTI_VIEW_ACCUMULATE = "techniques/light_views/multi_view/accumulate";
    /// The same, with edges finer than a texel found between the views.
    MULTI_VIEW_ACCUMULATE_SHARP = "techniques/light_views/multi_view/accumulate_sharp";
    /// The same by the triangles that texels hold.
    MULTI_VIEW_ACCUMULATE_TRIANGLES = "techniques/light_views/multi_view/accumulate_triangles";
    /// `reprojection`: scatters the central map's texels, as points, into a group of views.
    REPROJECTION_SPLAT_POINTS = "techniques/light_views/reprojection/splat_points";
    /// Lists the central map's surfels.
    REPROJECTION_COLLECT_SURFELS = "techniques/light_views/reprojection/collect_surfels";
    /// Scatters them into a group of views.
    REPROJECTION_SPLAT_SURFELS = "techniques/light_views/reprojection/splat_surfels";
    /// Points by fragments of a triangle over the map.
    REPROJECTION_SPLAT_SCREEN = "techniques/light_views/reprojection/splat_screen";
    /// Either while opaque casters are rasterised.
    REPROJECTION_SPLAT_OPAQUE = "techniques/light_views/reprojection/splat_opaque";
    /// The same while casters with holes are rasterised.
    REPROJECTION_SPLAT_CUTOUT = "techniques/light_views/reprojection/splat_cutout";
    /// Integer maps into depth textures.
    REPROJECTION_DRAW = "techniques/light_views/reprojection/draw";
    /// Adds a batch of integer maps to the mask.
    REPROJECTION_ACCUMULATE_MANUAL = "techniques/light_views/reprojection/accumulate_manual";
    /// Adds a batch of maps copied into textures to the mask.
    REPROJECTION_ACCUMULATE_COPIED = "techniques/light_views/reprojection/accumulate_copied";
    /// `vsm`: two moments of each texel.
    VSM_ENCODE = "techniques/filterable/vsm/encode";
    /// The same of a multisampled map.
    VSM_ENCODE_MULTISAMPLED = "techniques/filterable/vsm/encode" with "multisampled";
    /// `vsm`: Chebyshev's bound.
    VSM_RESOLVE = "techniques/filterable/vsm/resolve";
    /// Casters from a light's view, every fragment of them.
    TEXEL_LISTS_RASTER = "light_map/texel_lists/raster";
    /// Lists of fragments, sorted.
    TEXEL_LISTS_SORT = "light_map/texel_lists/sort";
    /// Masks of which every other pixel is known.
    SPARSE_UPSAMPLE = "mask/sparse_upsample/upsample";
    /// `multi_layer`: a level of filtered lists.
    MULTI_LAYER_FILTER = "techniques/multi_layer/filter";
    /// `multi_layer`: the nearest fragment of squares of texels.
    MULTI_LAYER_NEAREST = "techniques/multi_layer/nearest";
    /// `multi_layer`: the soft lookup.
    MULTI_LAYER_RESOLVE = "techniques/multi_layer/resolve";
    /// View-samples: zeroes an array.
    VIEW_SAMPLES_CLEAR = "techniques/receiver_lists/clear";
    /// View-samples: the box of the receivers asked for.
    VIEW_SAMPLES_BOUNDS = "techniques/receiver_lists/lists/bounds";
    /// View-samples: counts receivers a texel.
    VIEW_SAMPLES_COUNT = "techniques/receiver_lists/lists/count";
    /// View-samples: drawn or walked triangles.
    VIEW_SAMPLES_CHOOSE = "techniques/receiver_lists/lists/choose";
    /// View-samples: stores receivers in lists.
    VIEW_SAMPLES_SCATTER = "techniques/receiver_lists/lists/scatter";
    /// Pixels between every other one that interpolation left missing, for a second round of lists.
    VIEW_SAMPLES_MARK_MISSING = "techniques/receiver_lists/lists/mark_missing";
    /// Irradiance from the bits of light points.
    VIEW_SAMPLES_IRRADIANCE = "techniques/receiver_lists/light_bits/irradiance";
    /// View-samples: sizes of dispatches.
    VIEW_SAMPLES_ARGUMENTS = "techniques/receiver_lists/lists/arguments";
    /// View-samples: before the first pass over the groups.
    VIEW_SAMPLES_BEGIN = "techniques/receiver_lists/evaluation/begin";
    /// View-samples: before a further one.
    VIEW_SAMPLES_ADVANCE = "techniques/receiver_lists/evaluation/advance";
    /// View-samples: edges that can be silhouettes.
    VIEW_SAMPLES_EDGE_FACES = "techniques/receiver_lists/triangles/edge_faces";
    /// View-samples: counts triangles a cell.
    VIEW_SAMPLES_TRIANGLE_COUNT = "techniques/receiver_lists/triangles/count";
    /// View-samples: stores triangles by cell.
    VIEW_SAMPLES_TRIANGLE_SCATTER = "techniques/receiver_lists/triangles/scatter";
    /// View-samples: boxes of triangles.
    VIEW_SAMPLES_CLUSTER_BOXES = "techniques/receiver_lists/triangles/cluster_boxes";
    /// View-samples: boxes of boxes.
    VIEW_SAMPLES_SUPER_BOXES = "techniques/receiver_lists/triangles/super_boxes";
    /// View-samples: visibility of the listed receivers.
    VIEW_SAMPLES_EVALUATE = "techniques/receiver_lists/evaluation/evaluate";
    /// View-samples: how much is drawn.
    VIEW_SAMPLES_RASTER_ARGUMENTS = "techniques/receiver_lists/raster/arguments";
    /// View-samples: bits before triangles are drawn.
    VIEW_SAMPLES_RASTER_BEFORE = "techniques/receiver_lists/raster/open_points";
    /// View-samples: what bits weigh after that.
    VIEW_SAMPLES_RASTER_AFTER = "techniques/receiver_lists/raster/sum_visible";
    /// View-samples: triangles over the receivers that they may shade.
    VIEW_SAMPLES_RASTER = "techniques/receiver_lists/raster/draw";
    /// View-samples: the same for a light of one point, by planes of each triangle.
    VIEW_SAMPLES_RASTER_LIGHT_PLANES = "techniques/receiver_lists/raster/draw_by_light_planes";
    /// View-samples: hulls of hexagons about the light's shadows.
    VIEW_SAMPLES_REGION_HULLS = "techniques/receiver_lists/raster/hulls";
    /// View-samples: texels that penumbrae can fall in.
    VIEW_SAMPLES_RASTER_SILHOUETTES = "techniques/receiver_lists/raster/silhouettes";
    /// View-samples: texels that hold receivers.
    VIEW_SAMPLES_RASTER_STENCIL = "techniques/receiver_lists/raster/stencil";
    /// View-samples: table of planes.
    VIEW_SAMPLES_MAKE_LOOKUP = "techniques/receiver_lists/light_bits/make_lookup";
    /// View-samples: triangles against boxes of light points.
    #[cfg(test)]
    VIEW_SAMPLES_TRIANGLE_PROBE = "techniques/receiver_lists/light_bits/triangle_probe";
    /// What regions of influence are made of.
    #[cfg(test)]
    VIEW_SAMPLES_REGION_PROBE = "techniques/receiver_lists/raster/probe";
    /// `ray_traced`: triangles' boxes.
    RAY_GATHER = "techniques/ray_traced/mesh/gather";
    /// Triangles kept in their tree's order.
    RAY_PLACE = "techniques/ray_traced/mesh/place";
    /// That order.
    RAY_RECALL = "techniques/ray_traced/mesh/recall";
    /// Instances, their inverses and boxes.
    RAY_INSTANCES = "techniques/ray_traced/top/instances";
    /// Trees: items in the order of their numbers.
    TREE_NUMBER = "techniques/ray_traced/tree/number";
    /// Trees: boxes of eight boxes.
    TREE_PYRAMID = "techniques/ray_traced/tree/pyramid";
    /// Trees: their own boxes.
    TREE_FRAMES = "techniques/ray_traced/tree/frames";
    /// Trees: Morton codes.
    TREE_CODES = "techniques/ray_traced/tree/codes";
    /// Trees: digits of codes, counted.
    TREE_SORT_COUNT = "techniques/ray_traced/tree/sort_count";
    /// Trees: items sorted by a digit.
    TREE_SORT_SCATTER = "techniques/ray_traced/tree/sort_scatter";
    /// Trees: nodes' items and parents.
    TREE_HIERARCHY = "techniques/ray_traced/tree/hierarchy";
    /// Trees: how many leaves there would be.
    TREE_TALLY = "techniques/ray_traced/tree/tally";
    /// Trees: where leaves begin.
    TREE_MARK = "techniques/ray_traced/tree/mark";
    /// Trees: nodes in their order.
    TREE_WORDS = "techniques/ray_traced/tree/words";
    /// Trees: nodes' boxes.
    TREE_FIT = "techniques/ray_traced/tree/fit";
    /// `ray_traced`: segments to the light.
    RAY_TRACE = "techniques/ray_traced/trace";
    /// `lvsm`: two moments of each layer.
    LVSM_ENCODE = "techniques/filterable/lvsm/encode";
    /// The same of a multisampled map.
    LVSM_ENCODE_MULTISAMPLED = "techniques/filterable/lvsm/encode" with "multisampled";
    /// The same of opaque casters' fragments.
    LVSM_TARGETS_OPAQUE = "techniques/filterable/lvsm/targets_opaque";
    /// The same of fragments of casters with holes.
    LVSM_TARGETS_CUTOUT = "techniques/filterable/lvsm/targets_cutout";
    /// `lvsm`: visibility from them.
    LVSM_RESOLVE = "techniques/filterable/lvsm/resolve";
    /// `evsm`: moments of warped depths.
    EVSM_ENCODE = "techniques/filterable/evsm/encode";
    /// The same of a multisampled map.
    EVSM_ENCODE_MULTISAMPLED = "techniques/filterable/evsm/encode" with "multisampled";
    /// `evsm`: visibility from them.
    EVSM_RESOLVE = "techniques/filterable/evsm/resolve";
    /// `esm`: exponentials.
    ESM_ENCODE = "techniques/filterable/esm/encode";
    /// The same of a multisampled map.
    ESM_ENCODE_MULTISAMPLED = "techniques/filterable/esm/encode" with "multisampled";
    /// `esm`: visibility from them.
    ESM_RESOLVE = "techniques/filterable/esm/resolve";
    /// `convolution`: Fourier terms.
    CONVOLUTION_ENCODE = "techniques/filterable/convolution/encode";
    /// The same of a multisampled map.
    CONVOLUTION_ENCODE_MULTISAMPLED = "techniques/filterable/convolution/encode" with "multisampled";
    /// `convolution`: visibility from them.
    CONVOLUTION_RESOLVE = "techniques/filterable/convolution/resolve";
    /// `moment`: four moments.
    MOMENT_ENCODE = "techniques/filterable/moment/encode";
    /// The same of a multisampled map.
    MOMENT_ENCODE_MULTISAMPLED = "techniques/filterable/moment/encode" with "multisampled";
    /// `moment`: visibility from them.
    MOMENT_RESOLVE = "techniques/filterable/moment/resolve";
    /// `lvsm`: second occluders.
    LVSM_HISTOGRAM = "techniques/filterable/lvsm/histogram";
    /// The same of a multisampled map.
    LVSM_HISTOGRAM_MULTISAMPLED = "techniques/filterable/lvsm/histogram" with "multisampled";
    /// `lvsm`: where receivers see light bleed.
    LVSM_BLEEDING = "techniques/filterable/lvsm/bleeding";
    /// The same of a multisampled map.
    LVSM_BLEEDING_MULTISAMPLED = "techniques/filterable/lvsm/bleeding" with "multisampled";
    /// Lloyd's relaxation.
    LLOYD_UPDATE = "primitives/lloyd/update";
    /// Pre-filtered soft techniques: depth to a basis of integers.
    SOFT_ENCODE = "techniques/summed/encode";
    /// The same of floats.
    SOFT_ENCODE_FLOAT = "techniques/summed/encode" with "float";
    /// Summed-area tables of the basis, encoded as it is read: integers.
    SOFT_TABLE = "techniques/summed/summed_area_table/table" with "encoded";
    /// The same of floats.
    SOFT_TABLE_FLOAT = "techniques/summed/summed_area_table/table" with "encoded+float";
    /// One mip level of the basis from the one before.
    SOFT_HALVE = "techniques/summed/halve";
    /// Depth to exponentials before each tile's own plane.
    SOFT_ENCODE_TILES = "techniques/summed/encode_tiles";
    /// Blocker search and filter by tables of integers.
    SOFT_RESOLVE = "techniques/summed/resolve";
    /// The same of floats.
    SOFT_RESOLVE_FLOAT = "techniques/summed/resolve" with "float";
    /// The same as by integers, but the mask gets the number of texels that each pixel reads.
    #[cfg(test)]
    SOFT_RESOLVE_COUNT = "techniques/summed/resolve" with "count";
    /// The same, but the mask gets the mean blocker's g.
    #[cfg(test)]
    SOFT_RESOLVE_BLOCKERS = "techniques/summed/resolve" with "blockers";
}
