//! Denoiser settings.

/// Denoiser settings: means of a mask over frames and neighbouring pixels, for any technique.
///
/// Techniques that take few samples a pixel, with random offsets, are noisy: `pcss`, `pcss_anisotropic`, `smrt`, `bitmask`, `ray_traced`, `pcf` with `rotate`,
/// `sample_based`. Denoised, each pixel's random number differs from frame to frame as well, and its visibility is the mean over
/// the frames that saw the same point: found where the camera of the frame before had it, dropped where that saw something
/// else, or where light or casters have moved so far that it is no longer among what its neighbours see. What noise is left
/// is taken out by a plane fitted to the neighbours on the same surface, no wider than the penumbra allows.
///
/// The mask of a frame that is alone is smoothed over pixels only. A mask that nothing changes is drawn anew until its means
/// are of all frames, and then stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoise {
    /// Frames that a mean is of at most: 1 to 64. More: less noise at rest and in motion; where the light or casters move
    /// slowly, shadows that lag by some of them.
    pub most_frames: u32,
    /// How far the surface at each pixel has come since the frame before, in parts of the picture, right and down: where it
    /// is now less where it was. Of any float format with `TEXTURE_BINDING`, laid out as the depth buffer. `None`: only the
    /// camera moves, and what moves of itself is known by its depth alone.
    pub motion: Option<wgpu::TextureView>,
}

impl Denoise {
    /// Upper limit of [`most_frames`](Self::most_frames).
    pub const MOST_FRAMES: u32 = 64;
}

impl Default for Denoise {
    /// Of 16 frames, by the camera's motion.
    fn default() -> Self {
        Self { most_frames: 16, motion: None }
    }
}
