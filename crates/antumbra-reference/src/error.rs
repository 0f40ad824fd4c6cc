//! What can go wrong.

use antumbra_light::LightError;

/// Why there is no reference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// The light's numbers make no sense.
    #[error(transparent)]
    Light(#[from] LightError),
    /// A scene refers to something that it does not hold.
    #[error(
        "reference: scene `{scene}`: {what} {index} is out of range: there are {count}; the scene's loader is at fault"
    )]
    OutOfRange {
        /// The scene's name.
        scene: String,
        /// What kind of thing.
        what: &'static str,
        /// Which was asked for.
        index: usize,
        /// How many there are.
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
    /// More triangles than the tracer's indices can count.
    #[error("reference: scene `{scene}` has {count} triangles as drawn; the tracer takes at most {most}")]
    TooManyTriangles {
        /// The scene's name.
        scene: String,
        /// How many.
        count: usize,
        /// How many would do.
        most: usize,
    },
    /// No light points were asked for.
    #[error("reference: `samples` is {samples}, and must be from 1 to {most}")]
    Samples {
        /// What was asked for.
        samples: u32,
        /// The largest number allowed.
        most: u32,
    },
    /// The caller asked to stop.
    #[error("reference: cancelled")]
    Cancelled,
}
