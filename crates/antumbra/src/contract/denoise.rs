//! Denoiser settings.

/// Denoiser settings: means of a mask over frames and neighbouring pixels, for any technique.
///
/// Techniques that take few samples per pixel, with random offsets, are noisy: `pcss`, `pcss_anisotropic`, `smrt`, `bitmask`,
/// `ray_traced`, `pcf` with `rotate`, `sample_based`. With a denoiser, each pixel's random number also changes from frame to frame,
/// and its visibility is the mean over the frames that saw the same point. The mean is reprojected from the previous frame. It is
/// dropped where that frame saw another surface, or where light or casters have moved so far that it lies outside the range of the
/// neighbouring pixels. Remaining noise is removed by a plane fitted to the neighbours on the same surface, no wider than the
/// penumbra allows.
///
/// The mask of a single frame is smoothed over pixels only. While nothing changes, the mask is redrawn until its means cover
/// `max_frames` frames; then it is cached.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoise {
    /// Maximum number of frames in a mean, 1 to 64. More frames reduce noise at rest and in motion, but shadows of slowly moving
    /// lights or casters lag by some of them.
    pub max_frames: u32,
    /// Motion vectors: image position of each pixel's surface in this frame minus that in the previous frame, as fractions of the
    /// image, right and down. Any float format with `TEXTURE_BINDING`, laid out as the depth buffer. `None`: only camera motion is
    /// reprojected, and moving objects are detected by depth alone.
    pub motion: Option<wgpu::TextureView>,
}

impl Denoise {
    /// Upper limit of [`max_frames`](Self::max_frames).
    pub const MAX_FRAMES: u32 = 64;
}

impl Default for Denoise {
    /// Means over 16 frames, reprojected by the camera's motion.
    fn default() -> Self {
        Self { max_frames: 16, motion: None }
    }
}
