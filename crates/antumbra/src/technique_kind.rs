//! List of techniques, with the facts needed to choose one.

use std::fmt;

use crate::contract::{Error, ParamError, ParamSpec, ParamValue, Params, PublishedForm, Quality};
use crate::gpu::Gpu;
use crate::shadow::{AnyShadow, Shadow};
use crate::techniques::Technique;
#[cfg(feature = "filterable")]
use crate::techniques::filterable::{
    convolution::Convolution, esm::Esm, evsm::Evsm, lvsm::Lvsm, moment::Moment, vsm::Vsm,
};
#[cfg(feature = "light_views")]
use crate::techniques::light_views::{
    multi_view::MultiView, reprojection::Reprojection, reprojection_layered::ReprojectionLayered,
};
#[cfg(feature = "multi_layer")]
use crate::techniques::multi_layer::MultiLayer;
#[cfg(feature = "ray_traced")]
use crate::techniques::ray_traced::RayTraced;
#[cfg(feature = "receiver_lists")]
use crate::techniques::receiver_lists::{alias_free::AliasFree, sample_based::SampleBased};
#[cfg(feature = "single_map")]
use crate::techniques::single_map::{
    backprojection::Backprojection, bitmask::Bitmask, hard::Hard, pcf::Pcf, pcss::Pcss,
    pcss_anisotropic::PcssAnisotropic, smrt::Smrt,
};
#[cfg(feature = "summed")]
use crate::techniques::summed::{cssm::Cssm, essm::Essm, evssm::Evssm, mssm::Mssm, savsm::Savsm, vssm::Vssm};
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

/// Whether two texts are equal, evaluated at compile time.
const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Lists the techniques once: family, which is the feature that compiles it; variant and type; name; page; facts.
macro_rules! techniques {
    ($( $family:literal, $variant:ident, $name:literal, $page:literal, {
        title: $title:literal,
        source: $source:literal,
        penumbra: $penumbra:literal,
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
            "| [`", $name, "`](crate::techniques::", $page, ") | ", $title, " | ", $penumbra, " | ", $light_maps, " | ", $good_for,
            " | ", $fails_where, " |"
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

        $( #[cfg(feature = $family)] const _: () = assert!(
            is_same(<$variant as Technique>::NAME, $name),
            concat!("`", $name, "` is listed by another name than its own, `Technique::NAME`")
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
                        name: $name,
                        title: $title,
                        source: $source,
                        family: $family,
                        penumbra: $penumbra,
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
                    Self::$variant => read::<<$variant as Technique>::Params>($name, key, text),
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
    };
}

techniques! {
    "single_map", Hard, "hard", "single_map::hard", {
        title: "Hard shadow map",
        source: "Williams 1978, SIGGRAPH",
        penumbra: "none",
        light_maps: "1",
        good_for: "a baseline; lights of no size",
        fails_where: "every penumbra",
        worst_case: "overlap", "no penumbra at all",
    }
    "single_map", Pcf, "pcf", "single_map::pcf", {
        title: "Percentage-closer filtering",
        source: "Reeves, Salesin, Cook 1987, SIGGRAPH",
        penumbra: "constant width",
        light_maps: "1",
        good_for: "antialiased edges of one width",
        fails_where: "penumbrae of varying width",
        worst_case: "lantern-wall", "the same width for a near and a far occluder",
    }
    "single_map", Pcss, "pcss", "single_map::pcss", {
        title: "Percentage-closer soft shadows",
        source: "Fernando 2005, SIGGRAPH sketches",
        penumbra: "from the mean blocker of each of three layers",
        light_maps: "3",
        good_for: "occluders behind one another; sharp contacts",
        fails_where: "near and far bars side by side: one mean depth per layer",
        worst_case: "window", "one mean depth for near and far bars; `means=ranges` reduces the error from .043 to .026",
    }
    "single_map", Smrt, "smrt", "single_map::smrt", {
        title: "Shadow map ray tracing",
        source: "Agrawala et al. 2000, SIGGRAPH; Xie, Tabellion, Pearce 2007, EGSR",
        penumbra: "from rays through three layers",
        light_maps: "3",
        good_for: "near and far occluders, side by side or behind one another",
        fails_where: "rays that pass behind the last layer; penumbrae narrower than a texel, which get a texel's width",
        worst_case: "tree", "many small surfaces behind one another, more than three layers contain",
    }
    "single_map", Bitmask, "bitmask", "single_map::bitmask", {
        title: "Bitmask soft shadows",
        source: "Schwarz, Stamminger 2007, CGF 26(3)",
        penumbra: "from the texels of three layers, projected onto the light",
        light_maps: "3",
        good_for: "occluders at any depths, combined without double counting",
        fails_where: "cost; stair-stepping by texels in narrow penumbrae; casters behind the last layer",
        worst_case: "tree", "leaves behind the third layer are missing, which leaves speckles of light",
    }
    "single_map", Backprojection, "backprojection", "single_map::backprojection", {
        title: "Backprojection",
        source: "Guennebaud, Barthe, Paulin 2006, EGSR; 2007, CGF 26(3)",
        penumbra: "from the area of the light inside projected outlines of texels",
        light_maps: "1",
        good_for: "a single layer of occluders, without noise where it covers few texels",
        fails_where: "occluders behind one another: light leaks, or areas are counted twice",
        worst_case: "tree", "leaves behind the first layer are missing, and areas that several visible leaves hide are counted twice",
    }
    "light_views", MultiView, "multi_view", "light_views::multi_view", {
        title: "One depth map per light sample",
        source: "Heckbert, Herf 1997, CMU-CS-97-104",
        penumbra: "as exact as its samples",
        light_maps: "1 per sample",
        good_for: "ground truth on the GPU; still images",
        fails_where: "cost: one pass per sample; thin casters that hide one another in every view",
        worst_case: "ring-in-grass", "surfaces behind several blades, within a few texels of the 1024² views, are estimated",
    }
    "filterable", Vsm, "vsm", "filterable::vsm", {
        title: "Variance shadow map",
        source: "Donnelly, Lauritzen 2006, I3D",
        penumbra: "constant width",
        light_maps: "1, filtered",
        good_for: "wide, smooth, cheap edges",
        fails_where: "light bleeding where occluders overlap",
        worst_case: "overlap", "the boards' shadow bleeds light onto the ground below the table",
    }
    "filterable", Lvsm, "lvsm", "filterable::lvsm", {
        title: "Layered variance shadow map",
        source: "Lauritzen, McCool 2008, Graphics Interface",
        penumbra: "constant width",
        light_maps: "1, filtered, in layers",
        good_for: "wide, smooth edges without light bleeding: umbra leak .0007 on `overlap`, `vsm` .052",
        fails_where: "foliage without gaps in depth",
        worst_case: "bench-under-tree", "one width of blur for leaves far above, whose depths have no gaps for splits between layers",
    }
    "filterable", Evsm, "evsm", "filterable::evsm", {
        title: "Exponential variance shadow map",
        source: "Lauritzen, McCool 2008, Graphics Interface",
        penumbra: "constant width",
        light_maps: "1, filtered",
        good_for: "little light bleeding from one map",
        fails_where: "foliage; large depth ranges",
        worst_case: "tree", "leaves at many depths in one kernel, of which the warps represent only the nearest and farthest",
    }
    "filterable", Esm, "esm", "filterable::esm", {
        title: "Exponential shadow map",
        source: "Annen et al. 2008, Graphics Interface; Salvi 2008",
        penumbra: "constant width",
        light_maps: "1, filtered",
        good_for: "memory: one channel per texel",
        fails_where: "contacts; silhouettes",
        worst_case: "stacked-panels", "light leaks at every contact and on receivers that are tilted away from the light",
    }
    "filterable", Convolution, "convolution", "filterable::convolution", {
        title: "Convolution shadow map",
        source: "Annen et al. 2007, EGSR",
        penumbra: "constant width",
        light_maps: "1, filtered",
        good_for: "8-bit storage",
        fails_where: "contacts; ringing; cost, since a lookup reads every term of the series",
        worst_case: "leaning-plank", "light leaks within 1/(2M) of the depth range from every contact",
    }
    "filterable", Moment, "moment", "filterable::moment", {
        title: "Moment shadow map",
        source: "Peters, Klein 2015, I3D",
        penumbra: "constant width",
        light_maps: "1, filtered",
        good_for: "least light bleeding for 64 bits per texel",
        fails_where: "three or more occluders in one kernel",
        worst_case: "lantern-wall", "hardly any light bleeding, but one width for a near and a far occluder",
    }
    "single_map", PcssAnisotropic, "pcss_anisotropic", "single_map::pcss_anisotropic", {
        title: "Percentage-closer soft shadows over the pixel's footprint",
        source: "Shen, Guennebaud, Yang, Feng 2011, CGF 30(2)",
        penumbra: "from one mean blocker depth, also filtered over the pixel's footprint",
        light_maps: "1",
        good_for: "distant receivers without moiré, with as many samples as `pcss`",
        fails_where: "occluders behind one another",
        worst_case: "tree", "64 samples, and one mean depth, for leaves at all depths",
    }
    "summed", Essm, "essm", "summed::essm", {
        title: "Exponential soft shadow mapping",
        source: "Shen, Feng, Yang 2013, CGF 32(4)",
        penumbra: "from one mean blocker depth, in constant time",
        light_maps: "1",
        good_for: "large kernels without noise",
        fails_where: "occluders behind one another",
        worst_case: "tree", "one mean depth for near and far leaves; details finer than half a part of the kernel are missed",
    }
    "summed", Savsm, "savsm", "summed::savsm", {
        title: "Summed-area variance shadow maps",
        source: "Lauritzen 2007, GPU Gems 3",
        penumbra: "from two moments",
        light_maps: "1",
        good_for: "one lookup per kernel",
        fails_where: "light bleeding where occluders overlap",
        worst_case: "overlap", "light bleeds through the table where the boards above overlap it",
    }
    "summed", Vssm, "vssm", "summed::vssm", {
        title: "Variance soft shadow mapping",
        source: "Yang, Dong, Feng, Seidel, Kautz 2010, CGF 29(7)",
        penumbra: "from two moments, in constant time",
        light_maps: "1",
        good_for: "as `savsm`; subdivides its kernel to reduce light bleeding",
        fails_where: "light bleeding where occluders overlap",
        worst_case: "overlap", "light bleeds through the table, though less where a part of the kernel contains a single depth",
    }
    "summed", Cssm, "cssm", "summed::cssm", {
        title: "Convolution soft shadow maps",
        source: "Annen, Dong, Mertens, Bekaert, Seidel, Kautz 2008, SIGGRAPH",
        penumbra: "from a Fourier series",
        light_maps: "1",
        good_for: "comparison with its paper",
        fails_where: "contacts; memory",
        worst_case: "leaning-plank", "the step of a series of four terms takes an eighth of the depth range, so contact shadows are lost",
    }
    "summed", Evssm, "evssm", "summed::evssm", {
        title: "Exponential variance soft shadow mapping",
        source: "Lauritzen, McCool 2008, Graphics Interface; Yang et al. 2010, CGF 29(7)",
        penumbra: "from warped moments",
        light_maps: "1",
        good_for: "less light bleeding than `vssm`",
        fails_where: "occluders behind one another",
        worst_case: "tree", "its integer tables limit the exponent to 5, too small for leaves at all depths",
    }
    "summed", Mssm, "mssm", "summed::mssm", {
        title: "Moment soft shadow mapping",
        source: "Peters, Münstermann, Wetzstein, Klein 2017, JCGT 6(1)",
        penumbra: "from four moments",
        light_maps: "1",
        good_for: "least light bleeding where two occluders overlap",
        fails_where: "lattices and foliage: three or more occluders",
        worst_case: "tree", "four moments represent three depths, too few for a kernel of leaves",
    }
    "multi_layer", MultiLayer, "multi_layer", "multi_layer", {
        title: "Filtered multi-layer shadow maps",
        source: "Selgrad, Dachsbacher, Meyer, Stamminger 2014, Computer Graphics Forum",
        penumbra: "of each occluder, opaque or translucent",
        light_maps: "1, of lists",
        good_for: "layered, translucent and masked occluders from one view",
        fails_where: "receivers at grazing angles; wires",
        worst_case: "fence-geometry", "wires as thin as a texel of the 1024² map appear and disappear in bands",
    }
    "light_views", Reprojection, "reprojection", "light_views::reprojection", {
        title: "Fragment reprojection",
        source: "Marrs, Watson, Healey 2014",
        penumbra: "as exact as its samples",
        light_maps: "1 central map",
        good_for: "many light samples from one rasterisation",
        fails_where: "casters that are not visible from the light's centre",
        worst_case: "tree", "leaves hidden from the light's centre are missing, so light leaks through the crown",
    }
    "light_views", ReprojectionLayered, "reprojection_layered", "light_views::reprojection_layered", {
        title: "Fragment reprojection from layers",
        source: "after Marrs, Watson, Healey 2014; Everitt 2001",
        penumbra: "as exact as its samples",
        light_maps: "several layers of one view",
        good_for: "layered occluders; large lights",
        fails_where: "cost, about three times the arithmetic of `reprojection`; silhouettes, within a texel",
        worst_case: "tree", "leaves behind the fourth layer are missing",
    }
    "ray_traced", RayTraced, "ray_traced", "ray_traced", {
        title: "Rays through bounding volume hierarchies",
        source: "Cook, Porter, Carpenter 1984, SIGGRAPH; Karras 2012, HPG",
        penumbra: "as exact as its rays",
        light_maps: "none",
        good_for: "ground truth on the GPU; tinted casters along each ray; few rays with a denoiser",
        fails_where: "noise with few rays; cost of foliage near the light",
        worst_case: "tree", "64 rays per pixel are noisy among leaves",
    }
    "receiver_lists", AliasFree, "alias_free", "receiver_lists::alias_free", {
        title: "Alias-free hard shadows",
        source: "Sintorn, Eisemann, Assarsson 2008, EGSR",
        penumbra: "none",
        light_maps: "none",
        good_for: "exact hard shadows without a bias",
        fails_where: "every penumbra",
        worst_case: "columns", "exact hard edges, but no penumbra",
    }
    "receiver_lists", SampleBased, "sample_based", "receiver_lists::sample_based", {
        title: "Sample-based visibility",
        source: "Sintorn, Eisemann, Assarsson 2008, EGSR",
        penumbra: "exact at its samples",
        light_maps: "none",
        good_for: "the ray tracer's result for the same light samples, except for 1 sample in 10 000 on solids",
        fails_where: "many triangles between receivers and a large light",
        worst_case: "stained-glass", "tint is computed from the fraction of the light that each pane covers, not per light sample",
    }
}

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
