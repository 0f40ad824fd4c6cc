//! Parameters, declared once: name, meaning, unit, range, default, scale, and the effect of larger values. Documentation, `--set`,
//! setup files, sliders and searches all read that one declaration.

use std::fmt;

use super::{ParamError, PublishedForm, Quality};

/// Scale of a parameter's slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamScale {
    /// Equal steps.
    Linear,
    /// Equal ratios.
    Log,
}

/// Value of a parameter of any type.
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

/// List of up to [`CAPACITY`](Self::CAPACITY) numbers, written with commas between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamList {
    numbers: [f32; Self::CAPACITY],
    count: usize,
}

impl ParamList {
    /// Maximum length.
    pub const CAPACITY: usize = 15;
    /// Empty list.
    pub const EMPTY: Self = Self { numbers: [0.0; Self::CAPACITY], count: 0 };

    /// Creates a list; `None` if there are too many numbers or one is not finite.
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

/// Conversions from each type that a parameter can have, for [`Params::set_value`].
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

/// Declaration of one parameter.
#[derive(Clone, Copy, Debug)]
pub struct ParamSpec {
    /// Key.
    pub key: &'static str,
    /// Description.
    pub meaning: &'static str,
    /// Unit; empty for pure numbers, switches and choices.
    pub unit: &'static str,
    /// Smallest and largest number; `None` for switches, choices and lists.
    pub range: Option<(f64, f64)>,
    /// Names of a choice; for a parameter with a range, names accepted in place of a number; empty for others.
    pub choices: &'static [&'static str],
    /// Default value.
    pub default: ParamValue,
    /// Scale of a slider.
    pub scale: ParamScale,
    /// Effect of a larger value, or how the choices differ.
    pub more: &'static str,
}

impl ParamSpec {
    /// Accepted values, for messages: `a whole number from 64 to 8192`.
    pub fn expected(&self) -> String {
        let other = if self.choices.is_empty() { String::new() } else { format!(", or {}", self.choices.join(", ")) };
        match (self.default, self.range) {
            (ParamValue::F32(_), Some((low, high))) => format!("a number from {low} to {high}"),
            (_, Some((low, high))) => format!("a whole number from {low} to {high}{other}"),
            (ParamValue::Bool(_), _) => "true or false".into(),
            (ParamValue::List(_), _) => format!("up to {} numbers separated by commas", ParamList::CAPACITY),
            _ => format!("one of {}", self.choices.join(", ")),
        }
    }

    /// Whether a mask is in colour at this value, regardless of the casters: a debug view that paints layers or levels, or light
    /// that is weighted by channel.
    pub fn colors_mask(&self, value: ParamValue) -> bool {
        matches!(
            (self.key, value),
            ("show", ParamValue::Choice("layers" | "levels")) | ("weights", ParamValue::Choice("irradiance"))
        )
    }

    /// Whether the parameter takes whole numbers, possibly with names in place of some.
    pub fn is_whole(&self) -> bool {
        self.range.is_some() && !matches!(self.default, ParamValue::F32(_))
    }
}

/// Type of a parameter. Names are case-insensitive: `TRUE`, `Ranges`.
pub trait ParamType: Copy {
    /// Names of a choice; empty for other types.
    const CHOICES: &'static [&'static str] = &[];
    /// Parses a value; `None` if the text is not one.
    fn parse(text: &str) -> Option<Self>;
    /// Converts to an untyped value.
    fn value(self) -> ParamValue;
    /// Converts from an untyped value; `None` if it has another type or is not finite.
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
    /// Parameters of a quality; the defaults for [`Quality::Balanced`].
    fn of_quality(quality: Quality) -> Self;
    /// Departures from the paper, for [`Quality::Paper`]; `None` if there is no such setting.
    fn published() -> Option<&'static PublishedForm>;
    /// Declarations, in the order of documentation.
    fn specs() -> &'static [ParamSpec];
    /// Value of a key of [`Self::specs`].
    fn get(&self, key: &str) -> Option<ParamValue>;
    /// Parses a value of a key of [`Self::specs`]; `None` if the text is not one.
    fn parse(key: &str, text: &str) -> Option<ParamValue>;
    /// Sets a key of [`Self::specs`] without checking the range. Returns `None` and sets nothing if the value has another type.
    fn put(&mut self, key: &str, value: ParamValue) -> Option<()>;

    /// Sets a key from text. Keys, choices and switches are case-insensitive.
    ///
    /// # Errors
    /// Lists the technique's keys, or the values that the key accepts.
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

    /// Checks every number against its range, because fields are public and can be set without [`Self::set`].
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

    /// Parameters whose values in a quality differ from the defaults.
    fn quality_settings(quality: Quality) -> Vec<(&'static str, ParamValue)> {
        let (set, default) = (Self::of_quality(quality), Self::default());
        let differs = |spec: &ParamSpec| {
            set.get(spec.key).filter(|value| Some(*value) != default.get(spec.key)).map(|value| (spec.key, value))
        };
        Self::specs().iter().filter_map(differs).collect()
    }
}

/// Returns the declaration of a key; case-insensitive.
fn spec_of<P: Params>(technique: &'static str, key: &str) -> Result<&'static ParamSpec, ParamError> {
    let named = P::specs().iter().find(|spec| spec.key.eq_ignore_ascii_case(key));
    named.ok_or_else(|| ParamError::UnknownKey {
        technique,
        key: key.into(),
        known: P::specs().iter().map(|spec| spec.key).collect::<Vec<_>>().join(", "),
    })
}

/// Sets a key if the value has its type and is in range. `written` is the value as given, for the error.
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
