//! Size of a light's map: fixed, or chosen from the image.

use std::fmt;

use super::{ParamType, ParamValue};

/// Texels along a side of a light's map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MapSize {
    /// A texel is about half as wide as a pixel at the visible receivers, within a share of the memory budget
    /// ([`Gpu::set_map_budget`](crate::Gpu::set_map_budget)). [`Shadow::auto_map_sizes`](crate::Shadow::auto_map_sizes) returns the
    /// size of the last frame.
    Auto,
    /// Fixed number of texels.
    Texels(u32),
}

impl MapSize {
    /// Name of [`MapSize::Auto`] in command lines and files.
    pub const AUTO: &'static str = "auto";
}

impl From<u32> for MapSize {
    fn from(texels: u32) -> Self {
        Self::Texels(texels)
    }
}

impl fmt::Display for MapSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value().fmt(f)
    }
}

impl ParamType for MapSize {
    const CHOICES: &'static [&'static str] = &[Self::AUTO];
    fn parse(text: &str) -> Option<Self> {
        if text.eq_ignore_ascii_case(Self::AUTO) { Some(Self::Auto) } else { u32::parse(text).map(Self::Texels) }
    }
    fn value(self) -> ParamValue {
        match self {
            Self::Auto => ParamValue::Choice(Self::AUTO),
            Self::Texels(texels) => ParamValue::U32(texels),
        }
    }
    fn from_value(value: ParamValue) -> Option<Self> {
        match value {
            ParamValue::U32(texels) => Some(Self::Texels(texels)),
            ParamValue::Choice(name) => Self::parse(name).filter(|size| *size == Self::Auto),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_a_number_or_auto() {
        for (text, size) in [("auto", MapSize::Auto), ("AUTO", MapSize::Auto), ("2048", MapSize::Texels(2048))] {
            assert_eq!(MapSize::parse(text), Some(size));
            assert_eq!(MapSize::from_value(size.value()), Some(size));
            assert_eq!(MapSize::parse(&size.to_string()), Some(size));
        }
        for wrong in ["", "automatic", "-1", "1.5"] {
            assert_eq!(MapSize::parse(wrong), None, "{wrong}");
        }
        for wrong in [ParamValue::Choice("2048"), ParamValue::F32(1.0), ParamValue::Bool(true)] {
            assert_eq!(MapSize::from_value(wrong), None, "{wrong}");
        }
    }
}
