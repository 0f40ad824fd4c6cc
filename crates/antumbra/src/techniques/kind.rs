//! The list of techniques.

use std::fmt;

use super::{
    Technique, alias_free::AliasFree, convolution::Convolution, cssm::Cssm, esm::Esm, essm::Essm, evsm::Evsm,
    evssm::Evssm, hard::Hard, lvsm::Lvsm, moment::Moment, mssm::Mssm, multi_layer::MultiLayer, multi_view::MultiView,
    pcf::Pcf, pcss::Pcss, pcss_anisotropic::PcssAnisotropic, reprojection::Reprojection,
    reprojection_layered::ReprojectionLayered, sample_based::SampleBased, savsm::Savsm, vsm::Vsm, vssm::Vssm,
};
use crate::contract::{Error, ParamError, ParamSpec, Params};
use crate::gpu::Gpu;
use crate::shadow::{AnyShadow, Shadow};

/// Lists the techniques once: variant, name, type, title, source.
macro_rules! techniques {
    ($( $variant:ident, $name:literal, $ty:ty, $title:literal, $source:literal; )+) => {
        /// Every technique of the library.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum TechniqueKind { $( #[doc = $title] $variant, )+ }

        impl TechniqueKind {
            /// Every technique, in the order of documentation.
            pub const ALL: &'static [Self] = &[$( Self::$variant, )+];

            /// The name that command lines and files use.
            pub fn name(self) -> &'static str {
                match self { $( Self::$variant => $name, )+ }
            }

            /// A title for people.
            pub fn title(self) -> &'static str {
                match self { $( Self::$variant => $title, )+ }
            }

            /// Authors, year, venue.
            pub fn source(self) -> &'static str {
                match self { $( Self::$variant => $source, )+ }
            }

            /// The declarations of its parameters.
            pub fn param_specs(self) -> &'static [ParamSpec] {
                match self { $( Self::$variant => <$ty as Technique>::Params::specs(), )+ }
            }

            /// Checks a parameter's value as [`AnyShadow::set`] would, before there is a device.
            ///
            /// # Errors
            /// Names the keys there are, or what the key takes.
            pub fn check(self, key: &str, text: &str) -> Result<(), ParamError> {
                match self { $(
                    Self::$variant => <$ty as Technique>::Params::default().set($name, key, text),
                )+ }
            }

            /// A light's state with default parameters.
            ///
            /// # Errors
            /// As [`Shadow::new`].
            pub fn create(self, gpu: &Gpu) -> Result<AnyShadow, Error> {
                Ok(match self { $( Self::$variant => Shadow::<$ty>::new(gpu)?.into(), )+ })
            }
        }
    };
}

techniques! {
    Hard, "hard", Hard, "Hard shadow map", "Williams 1978, SIGGRAPH";
    Pcf, "pcf", Pcf, "Percentage-closer filtering", "Reeves, Salesin, Cook 1987, SIGGRAPH";
    Pcss, "pcss", Pcss, "Percentage-closer soft shadows", "Fernando 2005, SIGGRAPH sketches";
    MultiView, "multi_view", MultiView, "One depth map per light sample", "Heckbert, Herf 1997, CMU-CS-97-104";
    Vsm, "vsm", Vsm, "Variance shadow map", "Donnelly, Lauritzen 2006, I3D";
    Lvsm, "lvsm", Lvsm, "Layered variance shadow map", "Lauritzen, McCool 2008, Graphics Interface";
    Evsm, "evsm", Evsm, "Exponential variance shadow map", "Lauritzen, McCool 2008, Graphics Interface";
    Esm, "esm", Esm, "Exponential shadow map", "Annen et al. 2008, Graphics Interface; Salvi 2008";
    Convolution, "convolution", Convolution, "Convolution shadow map", "Annen et al. 2007, EGSR";
    Moment, "moment", Moment, "Moment shadow map", "Peters, Klein 2015, I3D";
    PcssAnisotropic, "pcss_anisotropic", PcssAnisotropic, "Percentage-closer soft shadows over the pixel's footprint",
        "Shen, Guennebaud, Yang, Feng 2011, CGF 30(2)";
    Essm, "essm", Essm, "Exponential soft shadow mapping", "Shen, Feng, Yang 2013, CGF 32(4)";
    Savsm, "savsm", Savsm, "Summed-area variance shadow maps", "Lauritzen 2007, GPU Gems 3";
    Vssm, "vssm", Vssm, "Variance soft shadow mapping", "Yang, Dong, Feng, Seidel, Kautz 2010, CGF 29(7)";
    Cssm, "cssm", Cssm, "Convolution soft shadow maps", "Annen, Dong, Mertens, Bekaert, Seidel, Kautz 2008, SIGGRAPH";
    Evssm, "evssm", Evssm, "Exponential variance soft shadow mapping",
        "Lauritzen, McCool 2008, Graphics Interface; Yang et al. 2010, CGF 29(7)";
    Mssm, "mssm", Mssm, "Moment soft shadow mapping", "Peters, Münstermann, Wetzstein, Klein 2017, JCGT 6(1)";
    MultiLayer, "multi_layer", MultiLayer, "Filtered multi-layer shadow maps",
        "Selgrad, Dachsbacher, Meyer, Stamminger 2014, Computer Graphics Forum";
    Reprojection, "reprojection", Reprojection, "Fragment reprojection", "Marrs, Watson, Healey 2014";
    ReprojectionLayered, "reprojection_layered", ReprojectionLayered, "Fragment reprojection from layers",
        "after Marrs, Watson, Healey 2014; Everitt 2001";
    AliasFree, "alias_free", AliasFree, "Alias-free hard shadows", "Sintorn, Eisemann, Assarsson 2008, EGSR";
    SampleBased, "sample_based", SampleBased, "Sample-based visibility", "Sintorn, Eisemann, Assarsson 2008, EGSR";
}

impl TechniqueKind {
    /// The technique of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }
}

impl fmt::Display for TechniqueKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
