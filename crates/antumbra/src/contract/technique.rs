//! The technique: typed inside, closed at the edge.

use std::fmt;

use antumbra_light::Light;

use super::{Casters, Error, Mask, ParamError, ParamSpec, ParamValue, Params, Receivers};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::{
    alias_free::AliasFree, convolution::Convolution, cssm::Cssm, esm::Esm, essm::Essm, evsm::Evsm, evssm::Evssm,
    hard::Hard, lvsm::Lvsm, moment::Moment, mssm::Mssm, multi_layer::MultiLayer, multi_view::MultiView, pcf::Pcf,
    pcss::Pcss, pcss_anisotropic::PcssAnisotropic, reprojection::Reprojection,
    reprojection_layered::ReprojectionLayered, sample_based::SampleBased, savsm::Savsm, vsm::Vsm, vssm::Vssm,
};

/// One light's work for one frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The light.
    pub light: &'a Light,
    /// What casts.
    pub casters: Casters<'a>,
    /// What receives.
    pub receivers: Receivers<'a>,
    /// Where visibility goes; the receivers' size.
    pub mask: &'a Mask,
}

/// A shadow technique.
///
/// Three phases: [`new`](Self::new) makes pipelines and checks features and limits; [`prepare`](Self::prepare)
/// allocates and uploads, and may fail; [`record`](Self::record) only records. None of them submits or blocks.
pub trait Technique: Sized {
    /// Which technique this is.
    const KIND: TechniqueKind;
    /// Its parameters.
    type Params: Params;

    /// Makes what outlives a frame.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the device lacks something.
    fn new(gpu: &Gpu) -> Result<Self, Error>;

    /// Makes ready for `frame`: fits, allocates, uploads.
    ///
    /// # Errors
    /// Where parameters, light or frame do not fit one another or the device.
    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &Self::Params) -> Result<(), Error>;

    /// Records the passes of the frame that [`prepare`](Self::prepare) saw last.
    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>);

    /// Bytes of GPU memory that the technique holds, the mask and the host's resources apart.
    fn memory_bytes(&self) -> u64;

    /// What the newest finished frame lacked room for, as far as the last [`prepare`](Self::prepare) has learnt. That
    /// `prepare` has made room: the frame it was for lacks it no more.
    fn overflow(&self) -> Option<Overflow> {
        None
    }
}

/// A structure of variable length that was too short for a frame. The frame used what fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow {
    /// What there was too much of, in the plural: `fragments`.
    pub what: &'static str,
    /// How many the frame had.
    pub needed: u64,
    /// How many there was room for.
    pub had: u64,
}

impl fmt::Display for Overflow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} and room for {}", self.needed, self.what, self.had)
    }
}

/// Object-safe twin of [`Technique`], with the parameters inside.
trait ErasedTechnique: Send {
    fn specs(&self) -> &'static [ParamSpec];
    fn get(&self, key: &str) -> Option<ParamValue>;
    fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError>;
    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>) -> Result<(), Error>;
    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>);
    fn memory_bytes(&self) -> u64;
    fn overflow(&self) -> Option<Overflow>;
}

struct WithParams<T: Technique> {
    technique: T,
    params: T::Params,
}

impl<T: Technique + Send> ErasedTechnique for WithParams<T>
where
    T::Params: Send,
{
    fn specs(&self) -> &'static [ParamSpec] {
        T::Params::specs()
    }
    fn get(&self, key: &str) -> Option<ParamValue> {
        self.params.get(key)
    }
    fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError> {
        self.params.set(T::KIND.name(), key, text)
    }
    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>) -> Result<(), Error> {
        self.params.validate(T::KIND.name())?;
        self.technique.prepare(gpu, frame, &self.params)
    }
    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.technique.record(recorder, frame);
    }
    fn memory_bytes(&self) -> u64 {
        self.technique.memory_bytes()
    }
    fn overflow(&self) -> Option<Overflow> {
        self.technique.overflow()
    }
}

/// Any technique, chosen while the program runs, with its parameters inside.
pub struct AnyTechnique {
    kind: TechniqueKind,
    inner: Box<dyn ErasedTechnique>,
}

impl fmt::Debug for AnyTechnique {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyTechnique({})", self.kind)
    }
}

impl AnyTechnique {
    /// Which technique this is.
    pub fn kind(&self) -> TechniqueKind {
        self.kind
    }

    /// The parameters with their present values.
    pub fn params(&self) -> impl Iterator<Item = (&'static ParamSpec, ParamValue)> + '_ {
        self.inner.specs().iter().map(|spec| (spec, self.inner.get(spec.key).unwrap_or(spec.default)))
    }

    /// Sets a parameter from text.
    ///
    /// # Errors
    /// Names the keys there are, or what the key takes.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError> {
        self.inner.set(key, text)
    }

    /// [`Technique::prepare`].
    ///
    /// # Errors
    /// As [`Technique::prepare`].
    pub fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>) -> Result<(), Error> {
        self.inner.prepare(gpu, frame)
    }

    /// [`Technique::record`].
    pub fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.inner.record(recorder, frame);
    }

    /// [`Technique::memory_bytes`].
    pub fn memory_bytes(&self) -> u64 {
        self.inner.memory_bytes()
    }

    /// [`Technique::overflow`].
    pub fn overflow(&self) -> Option<Overflow> {
        self.inner.overflow()
    }
}

/// Lists the techniques once: variant, name, type, title, source.
macro_rules! techniques {
    ($( $variant:ident, $name:literal, $ty:ty, $title:literal, $source:literal; )+) => {
        /// Every technique of the library.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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

            /// Checks a parameter's value as [`AnyTechnique::set`] would, before there is a device.
            ///
            /// # Errors
            /// Names the keys there are, or what the key takes.
            pub fn check(self, key: &str, text: &str) -> Result<(), ParamError> {
                match self { $(
                    Self::$variant => <$ty as Technique>::Params::default().set($name, key, text),
                )+ }
            }

            /// Makes the technique with default parameters.
            ///
            /// # Errors
            /// As [`Technique::new`].
            pub fn create(self, gpu: &Gpu) -> Result<AnyTechnique, Error> {
                let inner: Box<dyn ErasedTechnique> = match self { $(
                    Self::$variant => Box::new(WithParams::<$ty> {
                        technique: <$ty as Technique>::new(gpu)?,
                        params: Default::default(),
                    }),
                )+ };
                Ok(AnyTechnique { kind: self, inner })
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
