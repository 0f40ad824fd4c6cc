// List of all shaders of the library, by the path of the `.wesl` file under `src/`. Included by `lib.rs`, which embeds the linked
// text, and by `xtask/linker`, which creates it: `cargo xtask shaders`. `with "feature"` compiles the parts marked `@if(feature)`;
// several features are joined by `+`.

/// Path of a shader's linked text under `linked/`. Shaders for tests alone have a folder that is not packaged.
macro_rules! linked_file {
    ($path:literal) => { concat!($path, ".wgsl") };
    ($path:literal with $features:literal) => { concat!($path, ".", $features, ".wgsl") };
    (test $($shader:tt)+) => { concat!("test/", linked_file!($($shader)+)) };
}

shaders! {
    /// Accumulation: fingerprint of a buffer's contents.
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
    /// Half resolution: upsampling of the half-size mask.
    HALF_RESOLUTION_UPSAMPLE = "mask/half_resolution/upsample";
    /// Masks in other formats than techniques write.
    MASK_FORMAT_DRAW = "mask/format/draw";
    /// Points as receivers: from a host's buffers into textures.
    POINTS_PACK = "receivers/points/pack";
    /// Points as receivers: visibility into a host's buffer.
    POINTS_WRITE = "receivers/points/write";
    /// Points as receivers: positions, normals and widths of a frame's pixels.
    #[cfg(test)]
    POINTS_PROBE = "receivers/points/probe";
    /// `hard` as a function for hosts' shaders.
    HARD_FUNCTION = "techniques/single_map/hard/shader_function";
    /// `pcf` as a function for hosts' shaders.
    PCF_FUNCTION = "techniques/single_map/pcf/shader_function";
    /// `pcss` as a function for hosts' shaders.
    PCSS_FUNCTION = "techniques/single_map/pcss/shader_function";
    /// Receivers of a multisampled depth buffer.
    SPLIT_RECEIVERS_DRAW = "receivers/split_receivers/split";
    /// Light partition: receivers of one part.
    LIGHT_PARTITION_PICK = "light_partition/pick";
    /// Light partition: the mask of one part into the light's mask.
    LIGHT_PARTITION_JOIN = "light_partition/join";
    /// The rasteriser's grid: slanted triangles.
    RASTERISER_DRAW = "gpu/rasteriser/draw";
    /// The rasteriser's grid: errors of the triangles' depths.
    RASTERISER_MEASURE = "gpu/rasteriser/measure";
    /// Casters: a host's vertices into the set's format.
    PACK_MESH = "casters/pack";
    /// Casters: a host's matrices into the set's format.
    PACK_INSTANCES = "casters/pack_instances";
    /// Light maps of opaque casters.
    CASTER_DEPTH_OPAQUE = "light_map/caster_depth/opaque";
    /// Light maps of alpha-tested casters.
    CASTER_DEPTH_CUTOUT = "light_map/caster_depth/cutout";
    /// Casters' triangles in world space.
    CASTER_TRIANGLES_GATHER = "light_map/caster_triangles/gather";
    /// Casters' triangles: neighbours of each.
    CASTER_TRIANGLES_JOIN = "light_map/caster_triangles/join";
    /// Maps of the triangle that each texel shows.
    CASTER_TRIANGLES_MAP = "light_map/caster_triangles/map";
    /// Layers of opaque casters: depth and its gradient.
    DEPTH_LAYERS_OPAQUE = "light_map/depth_layers/layer_opaque";
    /// Layers of alpha-tested casters.
    DEPTH_LAYERS_CUTOUT = "light_map/depth_layers/layer_cutout";
    /// Four levels of a depth pyramid.
    DEPTH_PYRAMID_LEVELS = "light_map/depth_pyramid/levels";
    /// Last four levels of a depth pyramid.
    DEPTH_PYRAMID_LAST = "light_map/depth_pyramid/last";
    /// Prefix sums: one level down.
    PREFIX_SCAN = "primitives/prefix_scan/scan";
    /// Prefix sums: one level back up.
    PREFIX_SCAN_ADD = "primitives/prefix_scan/add";
    /// Every depth basis, encoded, mixed and decoded.
    #[cfg(test)]
    DEPTH_BASIS_PROBE = "primitives/depth_basis/probe";
    /// Random thresholds for surfaces of partial coverage.
    #[cfg(test)]
    STOCHASTIC_PROBE = "primitives/stochastic/probe";
    /// Summed-area tables of floats.
    SUMMED_AREA_TABLE_FLOAT = "techniques/summed/summed_area_table/table" with "float";
    /// Summed-area tables of integers.
    SUMMED_AREA_TABLE_INTEGER = "techniques/summed/summed_area_table/table";
    /// Summed-area tables of floats, by recursive doubling.
    SUMMED_AREA_DOUBLING_FLOAT = "techniques/summed/summed_area_table/doubling" with "float";
    /// Summed-area tables of integers, by recursive doubling.
    SUMMED_AREA_DOUBLING_INTEGER = "techniques/summed/summed_area_table/doubling";
    /// One direction of a packed map's blur.
    PACKED_BLUR = "primitives/packed_map/blur";
    /// One mip level of a packed map.
    PACKED_HALVE = "primitives/packed_map/halve";
    /// Several mip levels of a packed map.
    PACKED_HALVE_SEVERAL = "primitives/packed_map/halve_several";
    /// Reference of the filterable techniques: percentage-closer filtering with their kernel.
    FILTERABLE_EXACT = "techniques/filterable/exact";
    /// Reference of the filterable techniques, for a multisampled map.
    FILTERABLE_EXACT_MULTISAMPLED = "techniques/filterable/exact" with "multisampled";
    /// `hard`: one comparison.
    HARD_RESOLVE = "techniques/single_map/hard/resolve";
    /// `pcf`: a fixed kernel of comparisons.
    PCF_RESOLVE = "techniques/single_map/pcf/resolve";
    /// `pcss`: blocker search, penumbra estimate, filter.
    PCSS_RESOLVE = "techniques/single_map/pcss/resolve";
    /// `smrt`: blocker search, rays through layers.
    SMRT_RESOLVE = "techniques/single_map/smrt/resolve";
    /// `bitmask`: a bit for each light point, micro-patches.
    BITMASK_RESOLVE = "techniques/single_map/bitmask/resolve";
    /// `bitmask` with every light point tested against every patch.
    #[cfg(test)]
    BITMASK_RESOLVE_EXHAUSTIVE = "techniques/single_map/bitmask/resolve" with "exhaustive";
    /// `bitmask` with every square split that may be too wide.
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
    /// `multi_view`: accumulation with edges finer than a texel, found between the views.
    MULTI_VIEW_ACCUMULATE_SHARP = "techniques/light_views/multi_view/accumulate_sharp";
    /// `multi_view`: accumulation by the triangles that texels hold.
    MULTI_VIEW_ACCUMULATE_TRIANGLES = "techniques/light_views/multi_view/accumulate_triangles";
    /// `reprojection`: scatters the central map's texels, as points, into a group of views.
    REPROJECTION_SPLAT_POINTS = "techniques/light_views/reprojection/splat_points";
    /// `reprojection`: lists the central map's surfels.
    REPROJECTION_COLLECT_SURFELS = "techniques/light_views/reprojection/collect_surfels";
    /// `reprojection`: scatters surfels into a group of views.
    REPROJECTION_SPLAT_SURFELS = "techniques/light_views/reprojection/splat_surfels";
    /// `reprojection`: scatters points by fragments of a triangle over the map.
    REPROJECTION_SPLAT_SCREEN = "techniques/light_views/reprojection/splat_screen";
    /// `reprojection`: scatters fragments while opaque casters are rasterised.
    REPROJECTION_SPLAT_OPAQUE = "techniques/light_views/reprojection/splat_opaque";
    /// `reprojection`: scatters fragments while alpha-tested casters are rasterised.
    REPROJECTION_SPLAT_CUTOUT = "techniques/light_views/reprojection/splat_cutout";
    /// `reprojection`: converts integer maps to depth textures.
    REPROJECTION_DRAW = "techniques/light_views/reprojection/draw";
    /// `reprojection`: adds a batch of integer maps to the mask.
    REPROJECTION_ACCUMULATE_MANUAL = "techniques/light_views/reprojection/accumulate_manual";
    /// `reprojection`: adds a batch of maps copied into textures to the mask.
    REPROJECTION_ACCUMULATE_COPIED = "techniques/light_views/reprojection/accumulate_copied";
    /// `vsm`: two moments of each texel.
    VSM_ENCODE = "techniques/filterable/vsm/encode";
    /// `vsm`: two moments, from a multisampled map.
    VSM_ENCODE_MULTISAMPLED = "techniques/filterable/vsm/encode" with "multisampled";
    /// `vsm`: Chebyshev's bound.
    VSM_RESOLVE = "techniques/filterable/vsm/resolve";
    /// Lists of all fragments of casters in a light's view.
    TEXEL_LISTS_RASTER = "light_map/texel_lists/raster";
    /// Sorting of lists of fragments.
    TEXEL_LISTS_SORT = "light_map/texel_lists/sort";
    /// Interpolation of masks of which every other pixel is known.
    SPARSE_UPSAMPLE = "mask/sparse_upsample/upsample";
    /// `multi_layer`: a level of filtered lists.
    MULTI_LAYER_FILTER = "techniques/multi_layer/filter";
    /// `multi_layer`: the nearest fragment of squares of texels.
    MULTI_LAYER_NEAREST = "techniques/multi_layer/nearest";
    /// `multi_layer`: the soft lookup.
    MULTI_LAYER_RESOLVE = "techniques/multi_layer/resolve";
    /// View-samples: zeroes an array.
    VIEW_SAMPLES_CLEAR = "techniques/receiver_lists/clear";
    /// View-samples: the box of the receivers.
    VIEW_SAMPLES_BOUNDS = "techniques/receiver_lists/lists/bounds";
    /// View-samples: counts receivers per texel.
    VIEW_SAMPLES_COUNT = "techniques/receiver_lists/lists/count";
    /// View-samples: chooses between drawn and walked triangles.
    VIEW_SAMPLES_CHOOSE = "techniques/receiver_lists/lists/choose";
    /// View-samples: stores receivers in lists.
    VIEW_SAMPLES_SCATTER = "techniques/receiver_lists/lists/scatter";
    /// View-samples: marks pixels that interpolation left missing, for a second round of lists.
    VIEW_SAMPLES_MARK_MISSING = "techniques/receiver_lists/lists/mark_missing";
    /// View-samples: irradiance from the bits of light points.
    VIEW_SAMPLES_IRRADIANCE = "techniques/receiver_lists/light_bits/irradiance";
    /// View-samples: arguments of indirect dispatches.
    VIEW_SAMPLES_ARGUMENTS = "techniques/receiver_lists/lists/arguments";
    /// View-samples: initialises the first pass over the groups.
    VIEW_SAMPLES_BEGIN = "techniques/receiver_lists/evaluation/begin";
    /// View-samples: initialises a further pass over the groups.
    VIEW_SAMPLES_ADVANCE = "techniques/receiver_lists/evaluation/advance";
    /// View-samples: edges that can be silhouettes.
    VIEW_SAMPLES_EDGE_FACES = "techniques/receiver_lists/triangles/edge_faces";
    /// View-samples: counts triangles per cell.
    VIEW_SAMPLES_TRIANGLE_COUNT = "techniques/receiver_lists/triangles/count";
    /// View-samples: stores triangles by cell.
    VIEW_SAMPLES_TRIANGLE_SCATTER = "techniques/receiver_lists/triangles/scatter";
    /// View-samples: boxes of triangles.
    VIEW_SAMPLES_CLUSTER_BOXES = "techniques/receiver_lists/triangles/cluster_boxes";
    /// View-samples: boxes of boxes.
    VIEW_SAMPLES_SUPER_BOXES = "techniques/receiver_lists/triangles/super_boxes";
    /// View-samples: visibility of the listed receivers.
    VIEW_SAMPLES_EVALUATE = "techniques/receiver_lists/evaluation/evaluate";
    /// View-samples: arguments of indirect draws.
    VIEW_SAMPLES_RASTER_ARGUMENTS = "techniques/receiver_lists/raster/arguments";
    /// View-samples: initial bits of light points, before triangles are drawn.
    VIEW_SAMPLES_RASTER_BEFORE = "techniques/receiver_lists/raster/open_points";
    /// View-samples: summed weights of the bits left after triangles are drawn.
    VIEW_SAMPLES_RASTER_AFTER = "techniques/receiver_lists/raster/sum_visible";
    /// View-samples: triangles over the receivers that they may shade.
    VIEW_SAMPLES_RASTER = "techniques/receiver_lists/raster/draw";
    /// View-samples: triangles over receivers for a light of one point, by planes of each triangle.
    VIEW_SAMPLES_RASTER_LIGHT_PLANES = "techniques/receiver_lists/raster/draw_by_light_planes";
    /// View-samples: convex hulls of hexagons around the light's projections.
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
    /// View-samples: quantities behind regions of influence.
    #[cfg(test)]
    VIEW_SAMPLES_REGION_PROBE = "techniques/receiver_lists/raster/probe";
    /// `ray_traced`: triangles' boxes.
    RAY_GATHER = "techniques/ray_traced/mesh/gather";
    /// `ray_traced`: triangles stored in their tree's order.
    RAY_PLACE = "techniques/ray_traced/mesh/place";
    /// `ray_traced`: order of the stored triangles.
    RAY_RECALL = "techniques/ray_traced/mesh/recall";
    /// `ray_traced`: instances, their inverse matrices and boxes.
    RAY_INSTANCES = "techniques/ray_traced/top/instances";
    /// Trees: items in the order of their numbers.
    TREE_NUMBER = "techniques/ray_traced/tree/number";
    /// Trees: pyramid of boxes, each of eight finer boxes.
    TREE_PYRAMID = "techniques/ray_traced/tree/pyramid";
    /// Trees: box of each tree.
    TREE_FRAMES = "techniques/ray_traced/tree/frames";
    /// Trees: Morton codes.
    TREE_CODES = "techniques/ray_traced/tree/codes";
    /// Trees: counts digits of codes.
    TREE_SORT_COUNT = "techniques/ray_traced/tree/sort_count";
    /// Trees: sorts items by a digit.
    TREE_SORT_SCATTER = "techniques/ray_traced/tree/sort_scatter";
    /// Trees: items and parent of each node.
    TREE_HIERARCHY = "techniques/ray_traced/tree/hierarchy";
    /// Trees: number of leaves for each leaf size.
    TREE_TALLY = "techniques/ray_traced/tree/tally";
    /// Trees: first item of each leaf.
    TREE_MARK = "techniques/ray_traced/tree/mark";
    /// Trees: nodes in the order in which rays visit them.
    TREE_WORDS = "techniques/ray_traced/tree/words";
    /// Trees: box of each node.
    TREE_FIT = "techniques/ray_traced/tree/fit";
    /// `ray_traced`: segments to the light.
    RAY_TRACE = "techniques/ray_traced/trace";
    /// `lvsm`: two moments of each layer.
    LVSM_ENCODE = "techniques/filterable/lvsm/encode";
    /// `lvsm`: two moments per layer, from a multisampled map.
    LVSM_ENCODE_MULTISAMPLED = "techniques/filterable/lvsm/encode" with "multisampled";
    /// `lvsm`: two moments per layer, from opaque casters' fragments.
    LVSM_TARGETS_OPAQUE = "techniques/filterable/lvsm/targets_opaque";
    /// `lvsm`: two moments per layer, from alpha-tested casters' fragments.
    LVSM_TARGETS_CUTOUT = "techniques/filterable/lvsm/targets_cutout";
    /// `lvsm`: visibility from the layers' moments.
    LVSM_RESOLVE = "techniques/filterable/lvsm/resolve";
    /// `evsm`: moments of warped depths.
    EVSM_ENCODE = "techniques/filterable/evsm/encode";
    /// `evsm`: moments of warped depths, from a multisampled map.
    EVSM_ENCODE_MULTISAMPLED = "techniques/filterable/evsm/encode" with "multisampled";
    /// `evsm`: visibility from the moments.
    EVSM_RESOLVE = "techniques/filterable/evsm/resolve";
    /// `esm`: exponentials of depth.
    ESM_ENCODE = "techniques/filterable/esm/encode";
    /// `esm`: exponentials of depth, from a multisampled map.
    ESM_ENCODE_MULTISAMPLED = "techniques/filterable/esm/encode" with "multisampled";
    /// `esm`: visibility from the exponentials.
    ESM_RESOLVE = "techniques/filterable/esm/resolve";
    /// `convolution`: Fourier terms.
    CONVOLUTION_ENCODE = "techniques/filterable/convolution/encode";
    /// `convolution`: Fourier terms, from a multisampled map.
    CONVOLUTION_ENCODE_MULTISAMPLED = "techniques/filterable/convolution/encode" with "multisampled";
    /// `convolution`: visibility from the terms.
    CONVOLUTION_RESOLVE = "techniques/filterable/convolution/resolve";
    /// `moment`: four moments.
    MOMENT_ENCODE = "techniques/filterable/moment/encode";
    /// `moment`: four moments, from a multisampled map.
    MOMENT_ENCODE_MULTISAMPLED = "techniques/filterable/moment/encode" with "multisampled";
    /// `moment`: visibility from the moments.
    MOMENT_RESOLVE = "techniques/filterable/moment/resolve";
    /// `lvsm`: histogram of the depths of second occluders.
    LVSM_HISTOGRAM = "techniques/filterable/lvsm/histogram";
    /// `lvsm`: histogram of the depths of second occluders, from a multisampled map.
    LVSM_HISTOGRAM_MULTISAMPLED = "techniques/filterable/lvsm/histogram" with "multisampled";
    /// `lvsm`: histogram of the splits that receivers with light bleeding need.
    LVSM_BLEEDING = "techniques/filterable/lvsm/bleeding";
    /// `lvsm`: histogram of the splits that receivers with light bleeding need, for a multisampled map.
    LVSM_BLEEDING_MULTISAMPLED = "techniques/filterable/lvsm/bleeding" with "multisampled";
    /// Lloyd's relaxation.
    LLOYD_UPDATE = "primitives/lloyd/update";
    /// Pre-filtered soft techniques: depth in a basis of integers.
    SOFT_ENCODE = "techniques/summed/encode";
    /// Pre-filtered soft techniques: depth in a basis of floats.
    SOFT_ENCODE_FLOAT = "techniques/summed/encode" with "float";
    /// Summed-area tables of a basis of integers, encoded on reading.
    SOFT_TABLE = "techniques/summed/summed_area_table/table" with "encoded";
    /// Summed-area tables of a basis of floats, encoded on reading.
    SOFT_TABLE_FLOAT = "techniques/summed/summed_area_table/table" with "encoded+float";
    /// One mip level of the basis from the previous one.
    SOFT_HALVE = "techniques/summed/halve";
    /// Depth as exponentials on each tile's own plane.
    SOFT_ENCODE_TILES = "techniques/summed/encode_tiles";
    /// Blocker search and filter by tables of integers.
    SOFT_RESOLVE = "techniques/summed/resolve";
    /// Blocker search and filter by tables of floats.
    SOFT_RESOLVE_FLOAT = "techniques/summed/resolve" with "float";
    /// Filter by tables of integers, with the number of texels that each pixel reads in place of visibility.
    #[cfg(test)]
    SOFT_RESOLVE_COUNT = "techniques/summed/resolve" with "count";
    /// Filter by tables of integers, with the mean blocker's g in place of visibility.
    #[cfg(test)]
    SOFT_RESOLVE_BLOCKERS = "techniques/summed/resolve" with "blockers";
}
