//! List of techniques, with the facts needed to choose one.

use std::fmt;

use crate::contract::{Error, ParamError, ParamSpec, ParamValue, Params, PublishedForm, Quality};
use crate::gpu::Gpu;
use crate::shadow::{AnyShadow, Shadow};
use crate::techniques::Technique;
use crate::techniques::technique::Listed;

/// Facts for choosing a technique. Tables of the documentation, the command line's help and this page are generated from them.
/// Texts are Markdown without a full stop, for table cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct TechniqueFacts {
    /// Name in command lines and files.
    pub name: &'static str,
    /// Display name.
    pub title: &'static str,
    /// Authors, year, venue.
    pub source: &'static str,
    /// The feature of this crate that compiles it.
    pub family: &'static str,
    /// Source of the penumbra's width.
    pub penumbra: &'static str,
    /// Assumption about the occluders of a receiver.
    pub occluders: OccluderModel,
    /// Whether translucent casters dim and tint the light. Otherwise they count as opaque from half coverage on.
    pub translucent: bool,
    /// Number and kind of its shadow maps.
    pub light_maps: &'static str,
    /// Use case.
    pub good_for: &'static str,
    /// Failure case.
    pub fails_where: &'static str,
    /// Name of the laboratory's built-in scene that shows its worst failure.
    pub worst_scene: &'static str,
    /// Caption of that failure.
    pub worst_case: &'static str,
}

/// Assumption of a technique about the occluders between a receiver and the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OccluderModel {
    /// Occluders cast no penumbra.
    NoPenumbra,
    /// All penumbrae are as wide as the kernel.
    OneWidth,
    /// Occluders have one mean depth.
    OneDepth,
    /// Occluders have a few depths.
    SeveralDepths,
    /// No assumption: parts of the light, or occluders, are tested one by one.
    Any,
}

impl OccluderModel {
    /// Whether penumbrae are as wide wherever their occluder is.
    pub fn has_fixed_width(self) -> bool {
        matches!(self, Self::NoPenumbra | Self::OneWidth)
    }
}

/// Whether two texts are equal, evaluated at compile time.
const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Lists the techniques once: name; variant and type, in a module; family, which is the feature that compiles it; facts. The first `$`
/// is for the macro that this one declares.
macro_rules! techniques {
    (($dollar:tt) $( $name:ident: $variant:ident in $($module:ident)::+, feature $family:literal, {
        title: $title:literal,
        source: $source:literal,
        penumbra: $penumbra:literal,
        occluders: $occluders:ident,
        translucent: $translucent:literal,
        light_maps: $light_maps:literal,
        good_for: $good_for:literal,
        fails_where: $fails_where:literal,
        worst_case: $worst_scene:literal, $worst_case:literal,
    } )+) => {
        /// Every technique of the families that the crate is built with.
        ///
        /// | technique | | penumbra | shadow maps | good for | fails where |
        /// |---|---|---|---|---|---|
        $( #[doc = concat!(
            "| [`", stringify!($name), "`](crate::techniques", $( "::", stringify!($module), )+ ") | ", $title, " | ", $penumbra, " | ",
            $light_maps, " | ", $good_for, " | ", $fails_where, " |"
        )] )+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum TechniqueKind {
            $(
                #[doc = concat!($title, ": ", $source, ".\n\nGood for: ", $good_for, ". Fails where: ", $fails_where, ".")]
                #[cfg(feature = $family)]
                $variant,
            )+
        }

        $( #[cfg(feature = $family)] use crate::techniques::$($module)::+::$variant; )+

        $( #[cfg(feature = $family)] const _: () = assert!(
            is_same(<$variant as Technique>::NAME, stringify!($name)),
            concat!("`", stringify!($name), "` is listed by another name than its own, `Technique::NAME`")
        ); )+

        $( #[cfg(feature = $family)] impl Listed for $variant {} )+

        impl TechniqueKind {
            /// All techniques, in the order of the documentation.
            pub const ALL: &'static [Self] = &[$( #[cfg(feature = $family)] Self::$variant, )+];

            /// Facts for choosing the technique.
            pub fn facts(self) -> &'static TechniqueFacts {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => &TechniqueFacts {
                        name: stringify!($name),
                        title: $title,
                        source: $source,
                        family: $family,
                        penumbra: $penumbra,
                        occluders: OccluderModel::$occluders,
                        translucent: $translucent,
                        light_maps: $light_maps,
                        good_for: $good_for,
                        fails_where: $fails_where,
                        worst_scene: $worst_scene,
                        worst_case: $worst_case,
                    },
                )+ }
            }

            /// Declarations of the parameters.
            pub fn param_specs(self) -> &'static [ParamSpec] {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => <$variant as Technique>::Params::specs(),
                )+ }
            }

            /// Checks a parameter's value as [`AnyShadow::set`] would, without a device.
            ///
            /// # Errors
            /// Lists the technique's keys, or the values that the key accepts.
            pub fn check(self, key: &str, text: &str) -> Result<(), ParamError> {
                self.read(key, text).map(drop)
            }

            /// Parses a parameter and its value as [`AnyShadow::set`] would. Returns keys and choices as declared, regardless of
            /// the text's case.
            ///
            /// # Errors
            /// Lists the technique's keys, or the values that the key accepts.
            pub fn read(self, key: &str, text: &str) -> Result<(&'static ParamSpec, ParamValue), ParamError> {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => read::<<$variant as Technique>::Params>(stringify!($name), key, text),
                )+ }
            }

            /// Parameters whose values in a quality differ from the defaults.
            pub fn quality_settings(self, quality: Quality) -> Vec<(&'static str, ParamValue)> {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => <$variant as Technique>::Params::quality_settings(quality),
                )+ }
            }

            /// Departures from the paper, for [`Quality::Paper`]; `None` if the technique has no such quality.
            pub fn published(self) -> Option<&'static PublishedForm> {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => <$variant as Technique>::Params::published(),
                )+ }
            }

            /// Creates a light's state with default parameters.
            ///
            /// # Errors
            /// As [`Shadow::new`].
            pub fn create(self, gpu: &Gpu) -> Result<AnyShadow, Error> {
                Ok(match self { $( #[cfg(feature = $family)] Self::$variant => Shadow::<$variant>::new(gpu)?.into(), )+ })
            }
        }

        /// Passes every technique to a macro, as `name: Variant,`: for tests, which have a function for each.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! each_technique {
            ($dollar callback:ident) => { $dollar callback! { $( $name: $variant, )+ } };
        }
    };
}

techniques! {
    ($)
    hard: Hard in single_map::hard, feature "single_map", {
        title: "Hard shadow map",
        source: "Williams 1978, SIGGRAPH",
        penumbra: "none",
        occluders: NoPenumbra,
        translucent: false,
        light_maps: "1",
        good_for: "a baseline; lights of no size",
        fails_where: "every penumbra",
        worst_case: "overlap", "no penumbra at all",
    }
    pcf: Pcf in single_map::pcf, feature "single_map", {
        title: "Percentage-closer filtering",
        source: "Reeves, Salesin, Cook 1987, SIGGRAPH",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1",
        good_for: "antialiased edges of one width",
        fails_where: "penumbrae of varying width",
        worst_case: "lantern-wall", "the same width for a near and a far occluder",
    }
    pcss: Pcss in single_map::pcss, feature "single_map", {
        title: "Percentage-closer soft shadows",
        source: "Fernando 2005, SIGGRAPH sketches",
        penumbra: "from the mean blocker of each of three layers",
        occluders: SeveralDepths,
        translucent: false,
        light_maps: "3",
        good_for: "occluders behind one another; sharp contacts",
        fails_where: "near and far bars side by side: one mean depth per layer",
        worst_case: "window", "one mean depth for near and far bars; `means=ranges` reduces the error from .043 to .026",
    }
    smrt: Smrt in single_map::smrt, feature "single_map", {
        title: "Shadow map ray tracing",
        source: "Agrawala et al. 2000, SIGGRAPH; Xie, Tabellion, Pearce 2007, EGSR",
        penumbra: "from rays through three layers",
        occluders: Any,
        translucent: false,
        light_maps: "3",
        good_for: "near and far occluders, side by side or behind one another",
        fails_where: "rays that pass behind the last layer; penumbrae narrower than a texel, which get a texel's width",
        worst_case: "tree", "many small surfaces behind one another, more than three layers contain",
    }
    bitmask: Bitmask in single_map::bitmask, feature "single_map", {
        title: "Bitmask soft shadows",
        source: "Schwarz, Stamminger 2007, CGF 26(3)",
        penumbra: "from the texels of three layers, projected onto the light",
        occluders: Any,
        translucent: false,
        light_maps: "3",
        good_for: "occluders at any depths, combined without double counting",
        fails_where: "cost; stair-stepping by texels in narrow penumbrae; casters behind the last layer",
        worst_case: "tree", "leaves behind the third layer are missing, which leaves speckles of light",
    }
    backprojection: Backprojection in single_map::backprojection, feature "single_map", {
        title: "Backprojection",
        source: "Guennebaud, Barthe, Paulin 2006, EGSR; 2007, CGF 26(3)",
        penumbra: "from the area of the light inside projected outlines of texels",
        occluders: Any,
        translucent: false,
        light_maps: "1",
        good_for: "a single layer of occluders, without noise where it covers few texels",
        fails_where: "occluders behind one another: light leaks, or areas are counted twice",
        worst_case: "tree", "leaves behind the first layer are missing, and areas that several visible leaves hide are counted twice",
    }
    multi_view: MultiView in light_views::multi_view, feature "light_views", {
        title: "One depth map per light sample",
        source: "Heckbert, Herf 1997, CMU-CS-97-104",
        penumbra: "as exact as its samples",
        occluders: Any,
        translucent: true,
        light_maps: "1 per sample",
        good_for: "ground truth on the GPU; still images",
        fails_where: "cost: one pass per sample; thin casters that hide one another in every view",
        worst_case: "ring-in-grass", "surfaces behind several blades, within a few texels of the 1024² views, are estimated",
    }
    vsm: Vsm in filterable::vsm, feature "filterable", {
        title: "Variance shadow map",
        source: "Donnelly, Lauritzen 2006, I3D",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1, filtered",
        good_for: "wide, smooth, cheap edges",
        fails_where: "light bleeding where occluders overlap",
        worst_case: "overlap", "the boards' shadow bleeds light onto the ground below the table",
    }
    lvsm: Lvsm in filterable::lvsm, feature "filterable", {
        title: "Layered variance shadow map",
        source: "Lauritzen, McCool 2008, Graphics Interface",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1, filtered, in layers",
        good_for: "wide, smooth edges without light bleeding: umbra leak .0007 on `overlap`, `vsm` .052",
        fails_where: "foliage without gaps in depth",
        worst_case: "bench-under-tree", "one width of blur for leaves far above, whose depths have no gaps for splits between layers",
    }
    evsm: Evsm in filterable::evsm, feature "filterable", {
        title: "Exponential variance shadow map",
        source: "Lauritzen, McCool 2008, Graphics Interface",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1, filtered",
        good_for: "little light bleeding from one map",
        fails_where: "foliage; large depth ranges",
        worst_case: "tree", "leaves at many depths in one kernel, of which the warps represent only the nearest and farthest",
    }
    esm: Esm in filterable::esm, feature "filterable", {
        title: "Exponential shadow map",
        source: "Annen et al. 2008, Graphics Interface; Salvi 2008",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1, filtered",
        good_for: "memory: one channel per texel",
        fails_where: "contacts; silhouettes",
        worst_case: "stacked-panels", "light leaks at every contact and on receivers that are tilted away from the light",
    }
    convolution: Convolution in filterable::convolution, feature "filterable", {
        title: "Convolution shadow map",
        source: "Annen et al. 2007, EGSR",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1, filtered",
        good_for: "8-bit storage",
        fails_where: "contacts; ringing; cost, since a lookup reads every term of the series",
        worst_case: "leaning-plank", "light leaks within 1/(2M) of the depth range from every contact",
    }
    moment: Moment in filterable::moment, feature "filterable", {
        title: "Moment shadow map",
        source: "Peters, Klein 2015, I3D",
        penumbra: "constant width",
        occluders: OneWidth,
        translucent: false,
        light_maps: "1, filtered",
        good_for: "least light bleeding for 64 bits per texel",
        fails_where: "three or more occluders in one kernel",
        worst_case: "lantern-wall", "hardly any light bleeding, but one width for a near and a far occluder",
    }
    pcss_anisotropic: PcssAnisotropic in single_map::pcss_anisotropic, feature "single_map", {
        title: "Percentage-closer soft shadows over the pixel's footprint",
        source: "Shen, Guennebaud, Yang, Feng 2011, CGF 30(2)",
        penumbra: "from one mean blocker depth, also filtered over the pixel's footprint",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "distant receivers without moiré, with as many samples as `pcss`",
        fails_where: "occluders behind one another",
        worst_case: "tree", "64 samples, and one mean depth, for leaves at all depths",
    }
    essm: Essm in summed::essm, feature "summed", {
        title: "Exponential soft shadow mapping",
        source: "Shen, Feng, Yang 2013, CGF 32(4)",
        penumbra: "from one mean blocker depth, in constant time",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "large kernels without noise",
        fails_where: "occluders behind one another",
        worst_case: "tree", "one mean depth for near and far leaves; details finer than half a part of the kernel are missed",
    }
    savsm: Savsm in summed::savsm, feature "summed", {
        title: "Summed-area variance shadow maps",
        source: "Lauritzen 2007, GPU Gems 3",
        penumbra: "from two moments",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "one lookup per kernel",
        fails_where: "light bleeding where occluders overlap",
        worst_case: "overlap", "light bleeds through the table where the boards above overlap it",
    }
    vssm: Vssm in summed::vssm, feature "summed", {
        title: "Variance soft shadow mapping",
        source: "Yang, Dong, Feng, Seidel, Kautz 2010, CGF 29(7)",
        penumbra: "from two moments, in constant time",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "as `savsm`; subdivides its kernel to reduce light bleeding",
        fails_where: "light bleeding where occluders overlap",
        worst_case: "overlap", "light bleeds through the table, though less where a part of the kernel contains a single depth",
    }
    cssm: Cssm in summed::cssm, feature "summed", {
        title: "Convolution soft shadow maps",
        source: "Annen, Dong, Mertens, Bekaert, Seidel, Kautz 2008, SIGGRAPH",
        penumbra: "from a Fourier series",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "comparison with its paper",
        fails_where: "contacts; memory",
        worst_case: "leaning-plank", "the step of a series of four terms takes an eighth of the depth range, so contact shadows are lost",
    }
    evssm: Evssm in summed::evssm, feature "summed", {
        title: "Exponential variance soft shadow mapping",
        source: "Lauritzen, McCool 2008, Graphics Interface; Yang et al. 2010, CGF 29(7)",
        penumbra: "from warped moments",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "less light bleeding than `vssm`",
        fails_where: "occluders behind one another",
        worst_case: "tree", "its integer tables limit the exponent to 5, too small for leaves at all depths",
    }
    mssm: Mssm in summed::mssm, feature "summed", {
        title: "Moment soft shadow mapping",
        source: "Peters, Münstermann, Wetzstein, Klein 2017, JCGT 6(1)",
        penumbra: "from four moments",
        occluders: OneDepth,
        translucent: false,
        light_maps: "1",
        good_for: "least light bleeding where two occluders overlap",
        fails_where: "lattices and foliage: three or more occluders",
        worst_case: "tree", "four moments represent three depths, too few for a kernel of leaves",
    }
    multi_layer: MultiLayer in multi_layer, feature "multi_layer", {
        title: "Filtered multi-layer shadow maps",
        source: "Selgrad, Dachsbacher, Meyer, Stamminger 2014, Computer Graphics Forum",
        penumbra: "of each occluder, opaque or translucent",
        occluders: SeveralDepths,
        translucent: true,
        light_maps: "1, of lists",
        good_for: "layered, translucent and masked occluders from one view",
        fails_where: "receivers at grazing angles; wires",
        worst_case: "fence-geometry", "wires as thin as a texel of the 1024² map appear and disappear in bands",
    }
    reprojection: Reprojection in light_views::reprojection, feature "light_views", {
        title: "Fragment reprojection",
        source: "Marrs, Watson, Healey 2014",
        penumbra: "as exact as its samples",
        occluders: Any,
        translucent: false,
        light_maps: "1 central map",
        good_for: "many light samples from one rasterisation",
        fails_where: "casters that are not visible from the light's centre",
        worst_case: "tree", "leaves hidden from the light's centre are missing, so light leaks through the crown",
    }
    reprojection_layered: ReprojectionLayered in light_views::reprojection_layered, feature "light_views", {
        title: "Fragment reprojection from layers",
        source: "after Marrs, Watson, Healey 2014; Everitt 2001",
        penumbra: "as exact as its samples",
        occluders: Any,
        translucent: false,
        light_maps: "several layers of one view",
        good_for: "layered occluders; large lights",
        fails_where: "cost, about three times the arithmetic of `reprojection`; silhouettes, within a texel",
        worst_case: "tree", "leaves behind the fourth layer are missing",
    }
    ray_traced: RayTraced in ray_traced, feature "ray_traced", {
        title: "Rays through bounding volume hierarchies",
        source: "Cook, Porter, Carpenter 1984, SIGGRAPH; Karras 2012, HPG",
        penumbra: "as exact as its rays",
        occluders: Any,
        translucent: true,
        light_maps: "none",
        good_for: "ground truth on the GPU; tinted casters along each ray; few rays with a denoiser",
        fails_where: "noise with few rays; cost of foliage near the light",
        worst_case: "tree", "64 rays per pixel are noisy among leaves",
    }
    alias_free: AliasFree in receiver_lists::alias_free, feature "receiver_lists", {
        title: "Alias-free hard shadows",
        source: "Sintorn, Eisemann, Assarsson 2008, EGSR",
        penumbra: "none",
        occluders: NoPenumbra,
        translucent: true,
        light_maps: "none",
        good_for: "exact hard shadows without a bias",
        fails_where: "every penumbra",
        worst_case: "columns", "exact hard edges, but no penumbra",
    }
    sample_based: SampleBased in receiver_lists::sample_based, feature "receiver_lists", {
        title: "Sample-based visibility",
        source: "Sintorn, Eisemann, Assarsson 2008, EGSR",
        penumbra: "exact at its samples",
        occluders: Any,
        translucent: true,
        light_maps: "none",
        good_for: "the ray tracer's result for the same light samples, except for 1 sample in 10 000 on solids",
        fails_where: "many triangles between receivers and a large light",
        worst_case: "stained-glass", "tint is computed from the fraction of the light that each pane covers, not per light sample",
    }
}

#[cfg(test)]
#[allow(clippy::single_component_path_imports, reason = "it gives the macro a path in this crate")]
pub(crate) use each_technique;

impl TechniqueKind {
    /// Name in command lines and files.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Display name.
    pub fn title(self) -> &'static str {
        self.facts().title
    }

    /// Authors, year, venue.
    pub fn source(self) -> &'static str {
        self.facts().source
    }

    /// Technique of this name; case-insensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name().eq_ignore_ascii_case(name))
    }

    /// Whether the technique has this quality: every one of the ladder, and [`Quality::Paper`] if it sets anything.
    pub fn has_quality(self, quality: Quality) -> bool {
        quality != Quality::Paper || self.published().is_some()
    }
}

impl AnyShadow {
    /// Technique.
    ///
    /// # Panics
    /// If the technique is the caller's own, which is not listed.
    pub fn kind(&self) -> TechniqueKind {
        TechniqueKind::from_name(self.name()).expect("a technique of the library is listed")
    }
}

fn read<P: Params>(
    technique: &'static str,
    key: &str,
    text: &str,
) -> Result<(&'static ParamSpec, ParamValue), ParamError> {
    let mut params = P::default();
    params.set(technique, key, text)?;
    let spec = P::specs().iter().find(|spec| spec.key.eq_ignore_ascii_case(key));
    let spec = spec.expect("what was set is declared");
    Ok((spec, params.get(spec.key).unwrap_or(spec.default)))
}

impl fmt::Display for TechniqueKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
