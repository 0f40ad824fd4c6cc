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

/// Values of each type that a parameter can have, for [`Params::set_value`].
macro_rules! into_values {
    ($( $ty:ty as $variant:ident, )+) => { $(
        impl From<$ty> for ParamValue {
            fn from(value: $ty) -> Self {
                Self::$variant(value)
            }
        }
    )+ };
}

into_values! {
    u32 as U32,
    f32 as F32,
    bool as Bool,
    &'static str as Choice,
    ParamList as List,
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
    /// The names a choice can take; of what has a range, too, what may be given in place of a number; empty for others.
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
        let other = if self.choices.is_empty() { String::new() } else { format!(", or {}", self.choices.join(", ")) };
        match (self.default, self.range) {
            (ParamValue::F32(_), Some((low, high))) => format!("a number from {low} to {high}"),
            (_, Some((low, high))) => format!("a whole number from {low} to {high}{other}"),
            (ParamValue::Bool(_), _) => "true or false".into(),
            (ParamValue::List(_), _) => format!("up to {} numbers with commas between them", ParamList::CAPACITY),
            _ => format!("one of {}", self.choices.join(", ")),
        }
    }

    /// Whether a mask is in colour at this value, whatever the casters: a debug view that paints layers or levels, or light that
    /// is weighted by channel.
    pub fn colors_mask(&self, value: ParamValue) -> bool {
        matches!(
            (self.key, value),
            ("show", ParamValue::Choice("layers" | "levels")) | ("weights", ParamValue::Choice("irradiance"))
        )
    }

    /// Whether it takes whole numbers, be it with names in place of some.
    pub fn is_whole(&self) -> bool {
        self.range.is_some() && !matches!(self.default, ParamValue::F32(_))
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
    /// A value of this type; `None` of a value of another, or one that is not finite.
    fn from_value(value: ParamValue) -> Option<Self>;
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
    fn from_value(value: ParamValue) -> Option<Self> {
        if let ParamValue::U32(number) = value { Some(number) } else { None }
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
    fn from_value(value: ParamValue) -> Option<Self> {
        if let ParamValue::F32(number) = value { Some(number).filter(|number| number.is_finite()) } else { None }
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
    fn from_value(value: ParamValue) -> Option<Self> {
        if let ParamValue::Bool(switch) = value { Some(switch) } else { None }
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
    fn from_value(value: ParamValue) -> Option<Self> {
        if let ParamValue::List(list) = value { Self::new(list.values()) } else { None }
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
    /// The value that a text stands for as that of a key of [`Self::specs`]; `None` where it stands for none.
    fn parse(key: &str, text: &str) -> Option<ParamValue>;
    /// Sets a key of [`Self::specs`], in range or not; `None`, and nothing is set, where the value is of another type.
    fn put(&mut self, key: &str, value: ParamValue) -> Option<()>;

    /// Sets a key from text. Keys, choices and switches are read in any case.
    ///
    /// # Errors
    /// Names the keys there are, or what the key takes.
    fn set(&mut self, technique: &'static str, key: &str, text: &str) -> Result<(), ParamError> {
        let spec = spec_of::<Self>(technique, key)?;
        put_in_range(self, technique, spec, Self::parse(spec.key, text), || text.into())
    }

    /// Sets a key to a value of its type: `set_value("pcf", "map_size", 2048)`.
    ///
    /// # Errors
    /// As [`Self::set`].
    fn set_value(
        &mut self,
        technique: &'static str,
        key: &str,
        value: impl Into<ParamValue>,
    ) -> Result<(), ParamError> {
        let (spec, value) = (spec_of::<Self>(technique, key)?, value.into());
        put_in_range(self, technique, spec, Some(value), || value.to_string())
    }

    /// Checks every number against its range; fields are public and can be set past [`Self::set`].
    ///
    /// # Errors
    /// Names the first key out of range, and its range.
    fn validate(&self, technique: &'static str) -> Result<(), ParamError> {
        let mut checked = Self::default();
        for spec in Self::specs() {
            if let Some(value) = self.get(spec.key) {
                checked.set_value(technique, spec.key, value)?;
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

/// The declaration of a key, read in any case.
fn spec_of<P: Params>(technique: &'static str, key: &str) -> Result<&'static ParamSpec, ParamError> {
    let named = P::specs().iter().find(|spec| spec.key.eq_ignore_ascii_case(key));
    named.ok_or_else(|| ParamError::UnknownKey {
        technique,
        key: key.into(),
        known: P::specs().iter().map(|spec| spec.key).collect::<Vec<_>>().join(", "),
    })
}

/// Sets a key to a value that is one of its type and in range. `written` is the value as it was given.
fn put_in_range<P: Params>(
    params: &mut P,
    technique: &'static str,
    spec: &ParamSpec,
    value: Option<ParamValue>,
    written: impl Fn() -> String,
) -> Result<(), ParamError> {
    let is_in_range = |value: &ParamValue| match (spec.range, *value) {
        (Some((low, high)), ParamValue::U32(number)) => (low..=high).contains(&f64::from(number)),
        (Some((low, high)), ParamValue::F32(number)) => (low..=high).contains(&f64::from(number)),
        _ => true,
    };
    value.filter(is_in_range).and_then(|value| params.put(spec.key, value)).ok_or_else(|| ParamError::BadValue {
        technique,
        key: spec.key,
        value: written(),
        expected: spec.expected(),
    })
}

impl ParamType for antumbra_light::SampleSet {
    const CHOICES: &'static [&'static str] = &["stratified", "r2", "sobol", "poisson", "relaxed"];
    fn parse(text: &str) -> Option<Self> {
        Self::from_name(text)
    }
    fn value(self) -> ParamValue {
        ParamValue::Choice(self.name())
    }
    fn from_value(value: ParamValue) -> Option<Self> {
        if let ParamValue::Choice(name) = value { Self::from_name(name) } else { None }
    }
}
