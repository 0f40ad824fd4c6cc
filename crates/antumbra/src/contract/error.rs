//! Errors. Each message names the technique, what it needed, what it got, and what to do.

use antumbra_light::LightError;

/// Reason why a technique cannot be created or a frame cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The device lacks a feature or a limit is too low.
    #[error("{technique}: needs {needed}, but this device has {had}; {remedy}")]
    Unsupported {
        /// Name of the technique.
        technique: &'static str,
        /// The feature or limit.
        needed: String,
        /// What the device has.
        had: String,
        /// Suggested remedy.
        remedy: &'static str,
    },
    /// An input of the frame is unusable or does not fit the others.
    #[error("{technique}: {what} is {had}, and must be {needed}")]
    BadFrame {
        /// Name of the technique.
        technique: &'static str,
        /// Name of the input.
        what: &'static str,
        /// Value found.
        had: String,
        /// Value required.
        needed: String,
    },
    /// The light is unusable.
    #[error("{technique}: {source}")]
    Light {
        /// Name of the technique.
        technique: &'static str,
        /// Faulty quantity, with its range.
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
    #[error("{technique} has no parameter `{key}`; available: {known}")]
    UnknownKey {
        /// Name of the technique.
        technique: &'static str,
        /// The key given.
        key: String,
        /// Keys of the technique.
        known: String,
    },
    /// The value does not parse or lies outside the range.
    #[error("{technique}: `{key}` cannot be `{value}`; expected {expected}")]
    BadValue {
        /// Name of the technique.
        technique: &'static str,
        /// The key.
        key: &'static str,
        /// The value given.
        value: String,
        /// Accepted values.
        expected: String,
    },
}
