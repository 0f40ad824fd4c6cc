//! Macros that declare parameters, and the parameters that several techniques share.

/// Declares a technique's parameters; [`ParamSpec`] lists the facts of each. Two optional parts follow the struct. First, the
/// values of each [`Quality`] that differ from the defaults: `Fast { samples: 16, }`. Second, the published values that differ,
/// each with what our default does instead, and the departures that no parameter turns off:
/// `=> Paper { samples: 1, ours "64 of them."; } kept { "A warped window.", }`.
///
/// A parameter of several techniques is declared once, in [`params_in_full`], and named: `shared bias_scale;`.
macro_rules! params {
    ($(#[$outer:meta])* pub struct $name:ident { $($body:tt)+ } $($rest:tt)*) => {
        $crate::contract::params_in_full! { [$(#[$outer])* pub struct $name] [] [$($rest)*] $($body)+ }
    };
}

/// Expands `shared` parameters, each of which is declared here once.
macro_rules! params_in_full {
    ([$($head:tt)*] [$($done:tt)*] [$($rest:tt)*]) => {
        $crate::contract::declare_params! { $($head)* { $($done)* } $($rest)* }
    };
    ($head:tt $done:tt $rest:tt shared map_size, more $more:literal; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head $done $rest
            shared map_size = $crate::contract::MapSize::Texels(1024), more $more; $($body)*
        }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared map_size = $size:expr, more $more:literal; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Texels along a side of the shadow map; `auto` makes a texel about half as wide as a pixel at the visible receivers,
            /// with at least 1024 texels.
            map_size: $crate::contract::MapSize = $size, in 16..=8192, unit "texels", scale Log, more $more;
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared map_size of lists; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Texels along a side of a map with one texel per list of receivers; rounded up to a power of two. The lists divide
            /// space by distance from the light too.
            map_size: u32 = 512, in 16..=2048, unit "texels", scale Log,
                more "Shorter lists: changes the time, but not the shadow.";
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared sub; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Evaluation of every other pixel in both directions, with interpolation.
            sub: bool = false,
                more "true evaluates as few as a quarter of the pixels, but blurs shadows as narrow as a pixel.";
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared edge_goes_on; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Whether casters at the map's edge are extended beyond it, for blockers nearer to the light than the map holds.
            edge_goes_on: bool = true,
                more "false, as published, leaks light past the map's edge where an occluder is closer to the light than the \
                     light is wide.";
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared seed; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Seed of the sample points.
            seed: u32 = 1, in 0..=65535,
                more "Selects another sample set of the same quality.";
        ] $rest $($body)* }
    };
    // The type is named as the caller imports it, because one of these macros declares it.
    ($head:tt [$($done:tt)*] $rest:tt shared weights, more $more:literal; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Weight of each light sample in a receiver's visibility.
            weights: SampleWeights = SampleWeights::Emission, more $more;
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared bias_scale; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Scale of the automatic bias.
            bias_scale: f32 = 1.0, in 0.0..=8.0,
                more "Values above 1 detach contact shadows; values below 1 risk acne in concave corners.";
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt shared bias_scale of rays; $($body:tt)*) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            /// Scale of the ray offset on casters that are not closed.
            bias_scale: f32 = 1.0, in 0.0..=8.0,
                more "Values above 1 detach contact shadows by thousandths of a pixel; values below 1 risk acne on open meshes.";
        ] $rest $($body)* }
    };
    ($head:tt [$($done:tt)*] $rest:tt
        $(#[doc = $doc:literal])+
        $key:ident: $ty:ty = $default:expr $(, in $low:literal..=$high:literal)? $(, unit $unit:literal)?
        $(, scale $scale:ident)? , more $more:literal;
        $($body:tt)*
    ) => {
        $crate::contract::params_in_full! { $head [ $($done)*
            $(#[doc = $doc])+
            $key: $ty = $default $(, in $low..=$high)? $(, unit $unit)? $(, scale $scale)? , more $more;
        ] $rest $($body)* }
    };
}

/// Declares parameters after `shared` ones are expanded.
macro_rules! declare_params {
    ($(#[$outer:meta])* pub struct $name:ident { $(
        $(#[doc = $doc:literal])+
        $key:ident: $ty:ty = $default:expr $(, in $low:literal..=$high:literal)? $(, unit $unit:literal)?
        $(, scale $scale:ident)? , more $more:literal;
    )+ }
    $( $quality:ident { $( $quality_key:ident: $quality_value:expr, )+ } )*
    $( => Paper { $( $paper_key:ident: $paper_value:expr, ours $ours:literal; )* } kept { $( $kept:literal, )* } )?
    ) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name { $( $(#[doc = $doc])+ pub $key: $ty, )+ }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $key: $default, )+ }
            }
        }

        impl $crate::contract::Params for $name {
            fn of_quality(quality: $crate::contract::Quality) -> Self {
                match quality {
                    $( $crate::contract::Quality::$quality => Self { $( $quality_key: $quality_value, )+ ..Self::default() }, )*
                    $( $crate::contract::Quality::Paper => Self { $( $paper_key: $paper_value, )* ..Self::default() }, )?
                    _ => Self::default(),
                }
            }

            #[allow(unreachable_code)]
            fn published() -> Option<&'static $crate::contract::PublishedForm> {
                $( return Some(&$crate::contract::PublishedForm {
                    departures: &[$( $crate::contract::Departure { key: stringify!($paper_key), ours: $ours }, )*],
                    kept: &[$( $kept, )*],
                }); )?
                None
            }

            fn specs() -> &'static [$crate::contract::ParamSpec] {
                static SPECS: std::sync::LazyLock<Vec<$crate::contract::ParamSpec>> = std::sync::LazyLock::new(|| {
                    use $crate::contract::{ParamScale, ParamSpec, ParamType};
                    let defaults = $name::default();
                    vec![$( {
                        #[allow(unused_mut, unused_assignments)]
                        let (mut range, mut unit, mut scale) = (None, "", ParamScale::Linear);
                        $( range = Some(($low as f64, $high as f64)); )?
                        $( unit = $unit; )?
                        $( scale = ParamScale::$scale; )?
                        ParamSpec {
                            key: stringify!($key),
                            meaning: concat!($($doc,)+).trim_ascii(),
                            unit,
                            range,
                            choices: <$ty as ParamType>::CHOICES,
                            default: defaults.$key.value(),
                            scale,
                            more: $more,
                        }
                    }, )+]
                });
                &SPECS
            }

            fn get(&self, key: &str) -> Option<$crate::contract::ParamValue> {
                use $crate::contract::ParamType;
                match key {
                    $( stringify!($key) => Some(self.$key.value()), )+
                    _ => None,
                }
            }

            fn parse(key: &str, text: &str) -> Option<$crate::contract::ParamValue> {
                use $crate::contract::ParamType;
                match key {
                    $( stringify!($key) => <$ty as ParamType>::parse(text).map(ParamType::value), )+
                    _ => None,
                }
            }

            fn put(&mut self, key: &str, value: $crate::contract::ParamValue) -> Option<()> {
                use $crate::contract::ParamType;
                match key {
                    $( stringify!($key) => self.$key = <$ty as ParamType>::from_value(value)?, )+
                    _ => return None,
                }
                Some(())
            }
        }
    };
}

/// Declares an enum as a parameter's choice; each variant's text is its name in commands and files.
macro_rules! param_choice {
    ($(#[$outer:meta])* pub enum $name:ident { $( $(#[$inner:meta])* $variant:ident = $text:literal, )+ }) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $( $(#[$inner])* $variant, )+ }

        impl $crate::contract::ParamType for $name {
            const CHOICES: &'static [&'static str] = &[$( $text, )+];
            fn parse(text: &str) -> Option<Self> {
                match text {
                    $( _ if text.eq_ignore_ascii_case($text) => Some(Self::$variant), )+
                    _ => None,
                }
            }
            fn value(self) -> $crate::contract::ParamValue {
                $crate::contract::ParamValue::Choice(match self { $( Self::$variant => $text, )+ })
            }
            fn from_value(value: $crate::contract::ParamValue) -> Option<Self> {
                if let $crate::contract::ParamValue::Choice(name) = value { Self::parse(name) } else { None }
            }
        }
    };
}

pub(crate) use {declare_params, param_choice, params, params_in_full};
