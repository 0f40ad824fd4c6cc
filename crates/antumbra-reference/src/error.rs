//! Errors of the ray tracer.

use antumbra_light::LightError;

/// Error of the ray tracer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// The light is invalid.
    #[error(transparent)]
    Light(#[from] LightError),
    /// A scene has an index that is out of range.
    #[error(
        "reference: scene `{scene}`: {what} {index} is out of range: there are {count}; this is a fault of the scene's loader"
    )]
    OutOfRange {
        /// The scene's name.
        scene: String,
        /// Kind of the indexed object.
        what: &'static str,
        /// Index out of range.
        index: usize,
        /// Number of objects.
        count: usize,
    },
    /// A world position is not a finite number.
    #[error(
        "reference: scene `{scene}`: instance {instance} has a position that is not finite; check its transform and vertices"
    )]
    NotFinite {
        /// The scene's name.
        scene: String,
        /// Index into the scene's instances.
        instance: usize,
    },
    /// The scene has more triangles than the tracer's indices can address.
    #[error("reference: scene `{scene}` has {count} triangles, counting instances; the tracer supports at most {most}")]
    TooManyTriangles {
        /// The scene's name.
        scene: String,
        /// Number of triangles.
        count: usize,
        /// Largest number allowed.
        most: usize,
    },
    /// The number of light samples is zero or too large.
    #[error("reference: `samples` is {samples}, and must be from 1 to {most}")]
    Samples {
        /// Number requested.
        samples: u32,
        /// Largest number allowed.
        most: u32,
    },
    /// The caller cancelled.
    #[error("reference: cancelled")]
    Cancelled,
}
