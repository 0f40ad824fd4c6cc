//! Errors. Each message names the technique, what it needed, what it got, and what to do.

use antumbra_light::LightError;

/// Reason why a technique cannot be created or a frame cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The device lacks something.
    #[error("{technique}: needs {needed}, and this device has {had}; {remedy}")]
    Unsupported {
        /// Which technique.
        technique: &'static str,
        /// The feature or limit.
        needed: String,
        /// What there is.
        had: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The frame's parts do not fit one another.
    #[error("{technique}: {what} is {had}, and must be {needed}")]
    BadFrame {
        /// Which technique.
        technique: &'static str,
        /// Which part.
        what: &'static str,
        /// What it is.
        had: String,
        /// What would be right.
        needed: String,
    },
    /// The light is unusable.
    #[error("{technique}: {source}")]
    Light {
        /// Which technique.
        technique: &'static str,
        /// Which number, and its range.
        source: LightError,
    },
    /// A parameter is unknown or out of range.
    #[error(transparent)]
    Param(#[from] ParamError),
}

/// Reason why a parameter cannot be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParamError {
    /// No such key.
    #[error("{technique} has no parameter `{key}`; it has: {known}")]
    UnknownKey {
        /// Which technique.
        technique: &'static str,
        /// The key given.
        key: String,
        /// The keys there are.
        known: String,
    },
    /// The value does not parse or lies outside the range.
    #[error("{technique}: `{key}` cannot be `{value}`; it takes {expected}")]
    BadValue {
        /// Which technique.
        technique: &'static str,
        /// The key.
        key: &'static str,
        /// The value given.
        value: String,
        /// What would be right.
        expected: String,
    },
}
