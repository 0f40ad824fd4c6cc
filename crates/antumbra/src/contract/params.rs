//! Parameters, declared once: name, meaning, unit, range, default, scale, and what more of it does. Documentation,
//! `--set`, setup files, sliders and searches all read that one declaration.

use std::fmt;

use super::{ParamError, Printed, Quality};

/// How a slider over a parameter should run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamScale {
    /// Equal steps.
    Linear,
    /// Equal ratios.
    Log,
}

/// A parameter's value, whatever its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParamValue {
    /// A count or size.
    U32(u32),
    /// A quantity.
    F32(f32),
    /// A switch.
    Bool(bool),
    /// One of the spec's choices.
    Choice(&'static str),
    /// Several quantities.
    List(ParamList),
}

/// Up to [`CAPACITY`](Self::CAPACITY) numbers, written with commas between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamList {
    numbers: [f32; Self::CAPACITY],
    count: usize,
}

impl ParamList {
    /// The most numbers of a list.
    pub const CAPACITY: usize = 15;
    /// No numbers.
    pub const EMPTY: Self = Self { numbers: [0.0; Self::CAPACITY], count: 0 };

    /// A list; `None` where there are too many numbers or one is not finite.
    pub fn new(values: &[f32]) -> Option<Self> {
        let mut list = Self { count: values.len(), ..Self::EMPTY };
        list.numbers.get_mut(..values.len())?.copy_from_slice(values);
        values.iter().all(|v| v.is_finite()).then_some(list)
    }

    /// The numbers.
    pub fn values(&self) -> &[f32] {
        &self.numbers[..self.count]
    }
}

impl fmt::Display for ParamList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, value) in self.values().iter().enumerate() {
            write!(f, "{}{value}", if i > 0 { "," } else { "" })?;
        }
        Ok(())
    }
}

impl fmt::Display for ParamValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::U32(v) => write!(f, "{v}"),
            Self::F32(v) => write!(f, "{v}"),
            Self::Bool(v) => write!(f, "{v}"),
            Self::Choice(v) => f.write_str(v),
            Self::List(v) => write!(f, "{v}"),
        }
    }
}

/// The declaration of one parameter.
#[derive(Clone, Copy, Debug)]
pub struct ParamSpec {
    /// The key.
    pub key: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its unit; empty for pure numbers, switches and choices.
    pub unit: &'static str,
    /// Smallest and largest number; `None` for switches and choices.
    pub range: Option<(f64, f64)>,
    /// The names a choice can take; empty for others.
    pub choices: &'static [&'static str],
    /// The value it has unless set.
    pub default: ParamValue,
    /// How a slider should run.
    pub scale: ParamScale,
    /// What more of it does, or what the choices differ in.
    pub more: &'static str,
}

impl ParamSpec {
    /// What the parameter takes, for messages: `a whole number from 64 to 8192`.
    pub fn expected(&self) -> String {
        match (self.default, self.range) {
            (ParamValue::U32(_), Some((low, high))) => format!("a whole number from {low} to {high}"),
            (ParamValue::F32(_), Some((low, high))) => format!("a number from {low} to {high}"),
            (ParamValue::Bool(_), _) => "true or false".into(),
            (ParamValue::List(_), _) => format!("up to {} numbers with commas between them", ParamList::CAPACITY),
            _ => format!("one of {}", self.choices.join(", ")),
        }
    }
}

/// A type that a parameter can have. Names are read in any case: `TRUE`, `Ranges`.
pub trait ParamType: Copy {
    /// The names of a choice; empty for other types.
    const CHOICES: &'static [&'static str] = &[];
    /// Reads a value; `None` where the text is not one.
    fn parse(text: &str) -> Option<Self>;
    /// The value, untyped.
    fn value(self) -> ParamValue;
    /// The value as a number, for range checks; `None` for switches and choices.
    fn number(self) -> Option<f64> {
        None
    }
}

impl ParamType for u32 {
    fn parse(text: &str) -> Option<Self> {
        text.parse().ok()
    }
    fn value(self) -> ParamValue {
        ParamValue::U32(self)
    }
    fn number(self) -> Option<f64> {
        Some(f64::from(self))
    }
}

impl ParamType for f32 {
    fn parse(text: &str) -> Option<Self> {
        text.parse().ok().filter(|v: &f32| v.is_finite())
    }
    fn value(self) -> ParamValue {
        ParamValue::F32(self)
    }
    fn number(self) -> Option<f64> {
        Some(f64::from(self))
    }
}

impl ParamType for bool {
    fn parse(text: &str) -> Option<Self> {
        text.to_ascii_lowercase().parse().ok()
    }
    fn value(self) -> ParamValue {
        ParamValue::Bool(self)
    }
}

impl ParamType for ParamList {
    fn parse(text: &str) -> Option<Self> {
        if text.trim().is_empty() {
            return Some(Self::EMPTY);
        }
        let values: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        Self::new(&values?)
    }
    fn value(self) -> ParamValue {
        ParamValue::List(self)
    }
}

/// A technique's parameters.
pub trait Params: Default + Clone + PartialEq + wgpu::WasmNotSendSync {
    /// What a quality sets; the defaults for [`Quality::Balanced`].
    fn of_quality(quality: Quality) -> Self;
    /// What [`Quality::Paper`] turns off; `None` where there is no such setting.
    fn printed() -> Option<&'static Printed>;
    /// The declarations, in the order of documentation.
    fn specs() -> &'static [ParamSpec];
    /// The value of a key of [`Self::specs`].
    fn get(&self, key: &str) -> Option<ParamValue>;
    /// Sets a key from text. Keys, choices and switches are read in any case.
    ///
    /// # Errors
    /// Names the keys there are, or what the key takes.
    fn set(&mut self, technique: &'static str, key: &str, text: &str) -> Result<(), ParamError>;
    /// Checks every number against its range; fields are public and can be set past [`Self::set`].
    ///
    /// # Errors
    /// Names the first key out of range, and its range.
    fn validate(&self, technique: &'static str) -> Result<(), ParamError> {
        let mut checked = Self::default();
        for spec in Self::specs() {
            if let Some(value) = self.get(spec.key) {
                checked.set(technique, spec.key, &value.to_string())?;
            }
        }
        Ok(())
    }

    /// What a quality sets otherwise than the defaults.
    fn quality_settings(quality: Quality) -> Vec<(&'static str, ParamValue)> {
        let (set, default) = (Self::of_quality(quality), Self::default());
        let differs = |spec: &ParamSpec| {
            set.get(spec.key).filter(|value| Some(*value) != default.get(spec.key)).map(|value| (spec.key, value))
        };
        Self::specs().iter().filter_map(differs).collect()
    }
}

/// Declares a technique's parameters; see [`ParamSpec`] for the facts each states. Behind the struct may stand what the steps of
/// [`Quality`] set otherwise than the defaults: `Fast { samples: 16, }`; and behind those what the technique's paper prints
/// otherwise, with what ours does in its place, and the departures that no parameter turns off:
/// `=> Paper { samples: 1, ours "64 of them."; } kept { "A warped window.", }`.
macro_rules! params {
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
            fn printed() -> Option<&'static $crate::contract::Printed> {
                $( return Some(&$crate::contract::Printed {
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

            fn set(
                &mut self,
                technique: &'static str,
                key: &str,
                text: &str,
            ) -> Result<(), $crate::contract::ParamError> {
                use $crate::contract::{ParamError, ParamType};
                let named = Self::specs().iter().find(|spec| spec.key.eq_ignore_ascii_case(key));
                let spec = named.ok_or_else(|| ParamError::UnknownKey {
                    technique,
                    key: key.into(),
                    known: Self::specs().iter().map(|spec| spec.key).collect::<Vec<_>>().join(", "),
                })?;
                let bad_value = || ParamError::BadValue {
                    technique,
                    key: spec.key,
                    value: text.into(),
                    expected: spec.expected(),
                };
                match spec.key {
                    $( stringify!($key) => {
                        let value = <$ty as ParamType>::parse(text).ok_or_else(bad_value)?;
                        if let (Some((low, high)), Some(number)) = (spec.range, value.number()) {
                            if !(low..=high).contains(&number) {
                                return Err(bad_value());
                            }
                        }
                        self.$key = value;
                    } )+
                    _ => {}
                }
                Ok(())
            }
        }
    };
}

/// Declares an enum as a parameter's choice; each variant's name is what users write.
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
        }
    };
}

pub(crate) use {param_choice, params};

impl ParamType for antumbra_light::SampleSet {
    const CHOICES: &'static [&'static str] = &["stratified", "r2", "sobol", "poisson", "relaxed"];
    fn parse(text: &str) -> Option<Self> {
        Self::from_name(text)
    }
    fn value(self) -> ParamValue {
        ParamValue::Choice(self.name())
    }
}
