//! The list of techniques.

use std::fmt;

use super::Technique;
#[cfg(feature = "filterable")]
use super::filterable::{convolution::Convolution, esm::Esm, evsm::Evsm, lvsm::Lvsm, moment::Moment, vsm::Vsm};
#[cfg(feature = "light_views")]
use super::light_views::{
    multi_view::MultiView, reprojection::Reprojection, reprojection_layered::ReprojectionLayered,
};
#[cfg(feature = "multi_layer")]
use super::multi_layer::MultiLayer;
#[cfg(feature = "receiver_lists")]
use super::receiver_lists::{alias_free::AliasFree, sample_based::SampleBased};
#[cfg(feature = "single_map")]
use super::single_map::{hard::Hard, pcf::Pcf, pcss::Pcss, pcss_anisotropic::PcssAnisotropic};
#[cfg(feature = "summed")]
use super::summed::{cssm::Cssm, essm::Essm, evssm::Evssm, mssm::Mssm, savsm::Savsm, vssm::Vssm};
use crate::contract::{Error, ParamError, ParamSpec, ParamValue, Params, Printed, Quality};
use crate::gpu::Gpu;
use crate::shadow::{AnyShadow, Shadow};

/// Lists the techniques once: family, which is the feature that compiles it; variant, name, type, title, source.
macro_rules! techniques {
    ($( $family:literal, $variant:ident, $name:literal, $ty:ty, $title:literal, $source:literal; )+) => {
        /// Every technique of the families that the crate is built with.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum TechniqueKind { $( #[doc = $title] #[cfg(feature = $family)] $variant, )+ }

        impl TechniqueKind {
            /// Every technique, in the order of documentation.
            pub const ALL: &'static [Self] = &[$( #[cfg(feature = $family)] Self::$variant, )+];

            /// The name that command lines and files use.
            pub fn name(self) -> &'static str {
                match self { $( #[cfg(feature = $family)] Self::$variant => $name, )+ }
            }

            /// A title for people.
            pub fn title(self) -> &'static str {
                match self { $( #[cfg(feature = $family)] Self::$variant => $title, )+ }
            }

            /// Authors, year, venue.
            pub fn source(self) -> &'static str {
                match self { $( #[cfg(feature = $family)] Self::$variant => $source, )+ }
            }

            /// The declarations of its parameters.
            pub fn param_specs(self) -> &'static [ParamSpec] {
                match self { $( #[cfg(feature = $family)] Self::$variant => <$ty as Technique>::Params::specs(), )+ }
            }

            /// Checks a parameter's value as [`AnyShadow::set`] would, before there is a device.
            ///
            /// # Errors
            /// Names the keys there are, or what the key takes.
            pub fn check(self, key: &str, text: &str) -> Result<(), ParamError> {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => <$ty as Technique>::Params::default().set($name, key, text),
                )+ }
            }

            /// What a quality sets otherwise than the defaults.
            pub fn quality_settings(self, quality: Quality) -> Vec<(&'static str, ParamValue)> {
                match self { $(
                    #[cfg(feature = $family)]
                    Self::$variant => <$ty as Technique>::Params::quality_settings(quality),
                )+ }
            }

            /// The technique as its paper prints it, which [`Quality::Paper`] sets; `None` for those of other papers.
            pub fn printed(self) -> Option<&'static Printed> {
                match self { $( #[cfg(feature = $family)] Self::$variant => <$ty as Technique>::Params::printed(), )+ }
            }

            /// A light's state with default parameters.
            ///
            /// # Errors
            /// As [`Shadow::new`].
            pub fn create(self, gpu: &Gpu) -> Result<AnyShadow, Error> {
                Ok(match self { $( #[cfg(feature = $family)] Self::$variant => Shadow::<$ty>::new(gpu)?.into(), )+ })
            }
        }
    };
}

techniques! {
    "single_map", Hard, "hard", Hard, "Hard shadow map", "Williams 1978, SIGGRAPH";
    "single_map", Pcf, "pcf", Pcf, "Percentage-closer filtering", "Reeves, Salesin, Cook 1987, SIGGRAPH";
    "single_map", Pcss, "pcss", Pcss, "Percentage-closer soft shadows", "Fernando 2005, SIGGRAPH sketches";
    "light_views", MultiView, "multi_view", MultiView, "One depth map per light sample", "Heckbert, Herf 1997, CMU-CS-97-104";
    "filterable", Vsm, "vsm", Vsm, "Variance shadow map", "Donnelly, Lauritzen 2006, I3D";
    "filterable", Lvsm, "lvsm", Lvsm, "Layered variance shadow map", "Lauritzen, McCool 2008, Graphics Interface";
    "filterable", Evsm, "evsm", Evsm, "Exponential variance shadow map", "Lauritzen, McCool 2008, Graphics Interface";
    "filterable", Esm, "esm", Esm, "Exponential shadow map", "Annen et al. 2008, Graphics Interface; Salvi 2008";
    "filterable", Convolution, "convolution", Convolution, "Convolution shadow map", "Annen et al. 2007, EGSR";
    "filterable", Moment, "moment", Moment, "Moment shadow map", "Peters, Klein 2015, I3D";
    "single_map", PcssAnisotropic, "pcss_anisotropic", PcssAnisotropic, "Percentage-closer soft shadows over the pixel's footprint",
        "Shen, Guennebaud, Yang, Feng 2011, CGF 30(2)";
    "summed", Essm, "essm", Essm, "Exponential soft shadow mapping", "Shen, Feng, Yang 2013, CGF 32(4)";
    "summed", Savsm, "savsm", Savsm, "Summed-area variance shadow maps", "Lauritzen 2007, GPU Gems 3";
    "summed", Vssm, "vssm", Vssm, "Variance soft shadow mapping", "Yang, Dong, Feng, Seidel, Kautz 2010, CGF 29(7)";
    "summed", Cssm, "cssm", Cssm, "Convolution soft shadow maps", "Annen, Dong, Mertens, Bekaert, Seidel, Kautz 2008, SIGGRAPH";
    "summed", Evssm, "evssm", Evssm, "Exponential variance soft shadow mapping",
        "Lauritzen, McCool 2008, Graphics Interface; Yang et al. 2010, CGF 29(7)";
    "summed", Mssm, "mssm", Mssm, "Moment soft shadow mapping", "Peters, Münstermann, Wetzstein, Klein 2017, JCGT 6(1)";
    "multi_layer", MultiLayer, "multi_layer", MultiLayer, "Filtered multi-layer shadow maps",
        "Selgrad, Dachsbacher, Meyer, Stamminger 2014, Computer Graphics Forum";
    "light_views", Reprojection, "reprojection", Reprojection, "Fragment reprojection", "Marrs, Watson, Healey 2014";
    "light_views", ReprojectionLayered, "reprojection_layered", ReprojectionLayered, "Fragment reprojection from layers",
        "after Marrs, Watson, Healey 2014; Everitt 2001";
    "receiver_lists", AliasFree, "alias_free", AliasFree, "Alias-free hard shadows", "Sintorn, Eisemann, Assarsson 2008, EGSR";
    "receiver_lists", SampleBased, "sample_based", SampleBased, "Sample-based visibility", "Sintorn, Eisemann, Assarsson 2008, EGSR";
}

impl TechniqueKind {
    /// The technique of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Whether there is such a quality of it: every step of the ladder, and [`Quality::Paper`] where that sets anything.
    pub fn has_quality(self, quality: Quality) -> bool {
        quality != Quality::Paper || self.printed().is_some()
    }
}

impl fmt::Display for TechniqueKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
