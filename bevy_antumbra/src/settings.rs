//! User settings: technique, quality and parameters, for the whole app, a camera or a light.

use antumbra::contract::Denoise;
use antumbra::{AnyShadow, Gpu, Quality, TechniqueKind};
use bevy::prelude::*;

/// Technique, quality and parameters of a light's shadows.
///
/// On a light they apply to that light, on a camera to all lights without their own; the plugin's
/// [`settings`](crate::AntumbraPlugin::settings) apply to the rest. The softness of a shadow is not a setting: it follows from
/// the light's size.
///
/// ```
/// # use bevy::prelude::*; use bevy_antumbra::*;
/// # fn spawn(commands: &mut Commands) {
/// commands.spawn((
///     RectLight { width: 1.2, height: 0.6, ..default() },
///     SoftShadows::by(ShadowTechnique::MultiLayer).with("map_size", 512),
/// ));
/// # }
/// ```
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct SoftShadows {
    /// Shadow technique.
    pub technique: ShadowTechnique,
    /// Quality: a preset of all parameters.
    pub quality: ShadowQuality,
    /// Parameters that override the quality's values. `antumbra techniques NAME` lists a technique's parameters with units and
    /// ranges; so does [`ShadowTechnique::parameters`].
    pub parameters: Vec<ShadowParameter>,
    /// Denoising of masks over frames and neighbouring pixels; `None` leaves them as the technique writes them.
    pub denoise: Option<ShadowDenoise>,
    /// When Bevy draws the light's own map, too. Read from lights and the plugin's settings; ignored on cameras.
    pub maps: BevyMaps,
}

/// When Bevy draws a light's own map beside the plugin's mask. A mask holds one surface per pixel, that of the depth prepass.
/// Everything else has Bevy's shadows: transparent surfaces, back sides of diffusely transmitting ones and volumetric fog.
/// Rectangles have no map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum BevyMaps {
    /// If a transparent or transmitting material in the scene receives shadows, or the light is a `VolumetricLight`.
    #[default]
    WhereNeeded,
    /// Always: for your own transparent materials, which the plugin does not know about.
    Always,
    /// Never: surfaces without a mask are unshadowed.
    Never,
}

/// Denoising of masks, for techniques with few random samples per pixel, such as `Pcss` and `SampleBased`. If objects move, give
/// the camera a `MotionVectorPrepass`, too: without it, and always at four samples per pixel, only the camera's own motion is
/// known.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct ShadowDenoise {
    /// Maximum number of frames averaged per pixel: 1 to 64, 16 by default. More frames give less noise, but shadows lag by some
    /// frames if lights or casters move slowly.
    pub max_frames: u32,
}

impl Default for ShadowDenoise {
    fn default() -> Self {
        Self { max_frames: Denoise::default().max_frames }
    }
}

impl ShadowDenoise {
    /// Returns the library's settings, with the view's motion vectors.
    pub(crate) fn of_library(self, motion: Option<wgpu::TextureView>) -> Denoise {
        Denoise { max_frames: self.max_frames, motion }
    }
}

impl SoftShadows {
    /// Returns settings for a technique at its default quality.
    pub fn by(technique: ShadowTechnique) -> Self {
        Self { technique, ..Self::default() }
    }

    /// Sets the quality.
    pub fn at(mut self, quality: ShadowQuality) -> Self {
        self.quality = quality;
        self
    }

    /// Overrides a parameter.
    pub fn with(mut self, key: impl Into<String>, value: impl Into<ShadowValue>) -> Self {
        self.parameters.push(ShadowParameter { key: key.into(), value: value.into() });
        self
    }

    /// Enables denoising.
    pub fn denoised(mut self, denoise: ShadowDenoise) -> Self {
        self.denoise = Some(denoise);
        self
    }

    /// Sets when Bevy draws its own map.
    pub fn beside(mut self, maps: BevyMaps) -> Self {
        self.maps = maps;
        self
    }

    /// Creates a light's state with these settings.
    ///
    /// # Errors
    /// If the device lacks a feature, or a parameter is unknown or out of range: one line with the fault and the valid choices.
    pub(crate) fn create(&self, gpu: &Gpu) -> Result<AnyShadow, antumbra::Error> {
        let mut shadow = self.technique.kind().create(gpu)?;
        self.apply(&mut shadow)?;
        Ok(shadow)
    }

    /// Sets all parameters of a state of the same technique.
    pub(crate) fn apply(&self, shadow: &mut AnyShadow) -> Result<(), antumbra::Error> {
        shadow.set_quality(self.quality.of_library());
        for ShadowParameter { key, value } in &self.parameters {
            shadow.set(key, &value.to_string())?;
        }
        Ok(())
    }

    /// Checks the parameters without a device.
    ///
    /// # Errors
    /// Lists the valid keys, or the values that a key takes.
    pub fn check(&self) -> Result<(), antumbra::contract::ParamError> {
        let check = |p: &ShadowParameter| self.technique.kind().check(&p.key, &p.value.to_string());
        self.parameters.iter().try_for_each(check)
    }
}

/// Marker that excludes a light from the plugin's shadows.
///
/// A [`RectLight`] casts no shadows, and other lights keep Bevy's own shadow maps if `shadow_maps_enabled` is set.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct NoSoftShadows;

/// Parameter of a technique.
#[derive(Clone, Debug, Default, PartialEq, Reflect)]
pub struct ShadowParameter {
    /// Name, such as `map_size`.
    pub key: String,
    /// Value.
    pub value: ShadowValue,
}

/// Value of a parameter.
#[derive(Clone, Debug, PartialEq, Reflect)]
pub enum ShadowValue {
    /// A count or size.
    Count(u32),
    /// A quantity, in the parameter's unit.
    Number(f32),
    /// A switch.
    Switch(bool),
    /// One of a parameter's choices, by name.
    Choice(String),
    /// Several quantities.
    List(Vec<f32>),
}

impl Default for ShadowValue {
    fn default() -> Self {
        Self::Count(0)
    }
}

impl std::fmt::Display for ShadowValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Count(v) => write!(f, "{v}"),
            Self::Number(v) => write!(f, "{v}"),
            Self::Switch(v) => write!(f, "{v}"),
            Self::Choice(v) => f.write_str(v),
            Self::List(v) => f.write_str(&v.iter().map(f32::to_string).collect::<Vec<_>>().join(",")),
        }
    }
}

impl From<u32> for ShadowValue {
    fn from(v: u32) -> Self {
        Self::Count(v)
    }
}

impl From<f32> for ShadowValue {
    fn from(v: f32) -> Self {
        Self::Number(v)
    }
}

impl From<bool> for ShadowValue {
    fn from(v: bool) -> Self {
        Self::Switch(v)
    }
}

impl From<&str> for ShadowValue {
    fn from(v: &str) -> Self {
        Self::Choice(v.into())
    }
}

/// Quality of a technique: a preset of its parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum ShadowQuality {
    /// Affordable for a game with many lights.
    Fast,
    /// Remaining errors are hard to see.
    #[default]
    Balanced,
    /// Smaller error for two to four times the time.
    High,
    /// Smallest error of the technique, regardless of time.
    Best,
    /// The algorithm as published, for comparison; not a step of this scale. Techniques that are of none of the five papers use
    /// their defaults.
    Paper,
}

impl ShadowQuality {
    /// All qualities, from the cheapest to the most expensive; `Paper` is last.
    pub const ALL: &'static [Self] = &[Self::Fast, Self::Balanced, Self::High, Self::Best, Self::Paper];

    fn of_library(self) -> Quality {
        match self {
            Self::Fast => Quality::Fast,
            Self::Balanced => Quality::Balanced,
            Self::High => Quality::High,
            Self::Best => Quality::Best,
            Self::Paper => Quality::Paper,
        }
    }
}

/// Declares the techniques once: the enum and its mapping to the library's.
macro_rules! techniques {
    ($( $(#[$outer:meta])* $variant:ident, )+) => {
        /// Technique of the library. Its own page describes method, authors and failures.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
        #[reflect(Default, Clone, PartialEq)]
        pub enum ShadowTechnique { $( $(#[$outer])* $variant, )+ }

        impl ShadowTechnique {
            /// All techniques.
            pub const ALL: &'static [Self] = &[$( Self::$variant, )+];

            /// Returns the library's technique.
            pub fn kind(self) -> TechniqueKind {
                match self { $( Self::$variant => TechniqueKind::$variant, )+ }
            }
        }
    };
}

techniques! {
    /// One map, hard edges with the map's resolution.
    Hard,
    /// One map, edges of constant width.
    Pcf,
    /// Percentage-closer soft shadows, with blockers from three layers.
    Pcss,
    /// Rays through three layers of the light map: separate penumbrae for occluders side by side and one behind another. The
    /// default, good for most scenes.
    #[default]
    Smrt,
    /// One bit per point of the light, set by the texels of three layers.
    Bitmask,
    /// Outlines of blockers in one layer of the light map, and their area on the light: penumbrae without noise.
    Backprojection,
    /// Percentage-closer soft shadows, also filtered over the pixel's footprint.
    PcssAnisotropic,
    /// One map for each of many points of the light: exact, for as many passes.
    MultiView,
    /// Variance shadow maps.
    Vsm,
    /// Layered variance shadow maps.
    Lvsm,
    /// Exponential variance shadow maps.
    Evsm,
    /// Exponential shadow maps.
    Esm,
    /// Convolution shadow maps.
    Convolution,
    /// Moment shadow maps.
    Moment,
    /// Exponential soft shadow mapping.
    Essm,
    /// Summed-area variance shadow maps.
    Savsm,
    /// Variance soft shadow mapping.
    Vssm,
    /// Convolution soft shadow maps.
    Cssm,
    /// Exponential variance soft shadow mapping.
    Evssm,
    /// Moment soft shadow mapping.
    Mssm,
    /// Filtered multi-layer shadow maps: occluders one behind another, and coloured ones.
    MultiLayer,
    /// Fragment reprojection.
    Reprojection,
    /// Fragment reprojection from several layers.
    ReprojectionLayered,
    /// Rays through bounding volume hierarchies of the casters' triangles, coloured shadows included; noisy with few rays.
    RayTraced,
    /// Exact hard shadows.
    AliasFree,
    /// Exact soft shadows for its light samples, coloured ones included; slow for casters with many triangles.
    SampleBased,
}

impl ShadowTechnique {
    /// Returns the parameters: names, meanings, units, ranges, defaults.
    pub fn parameters(self) -> &'static [antumbra::contract::ParamSpec] {
        self.kind().param_specs()
    }

    /// Whether coloured casters cast coloured shadows; otherwise they count as opaque from half coverage on.
    pub(crate) fn knows_color(self) -> bool {
        self.kind().facts().translucent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_technique_of_the_library_is_here() {
        for kind in TechniqueKind::ALL {
            assert!(ShadowTechnique::ALL.iter().any(|technique| technique.kind() == *kind), "{kind} is missing");
        }
        assert_eq!(ShadowTechnique::ALL.len(), TechniqueKind::ALL.len());
    }

    #[test]
    fn every_quality_of_the_library_is_here() {
        let ours: Vec<Quality> = ShadowQuality::ALL.iter().map(|quality| quality.of_library()).collect();
        assert_eq!(ours, Quality::ALL);
    }

    /// Edits by name through reflection alone, as an inspector does.
    #[test]
    fn reflection_edits_quality_and_denoising() {
        let mut settings = SoftShadows::default();
        let edit: &mut dyn PartialReflect = &mut settings;
        let edit = edit.reflect_mut().as_struct().expect("a struct");
        edit.field_mut("quality").expect("a quality").apply(&ShadowQuality::Paper);
        edit.field_mut("denoise").expect("an option").apply(&Some(ShadowDenoise { max_frames: 4 }));
        let denoise = ShadowDenoise { max_frames: 4 };
        assert_eq!(settings, SoftShadows::default().at(ShadowQuality::Paper).denoised(denoise));
    }

    #[test]
    fn values_read_as_the_library_reads_them() {
        let right = SoftShadows::by(ShadowTechnique::Pcss).with("map_size", 512);
        assert_eq!(right.check(), Ok(()));
        let wrong = SoftShadows::by(ShadowTechnique::Pcss).with("map_size", 0.5);
        assert!(wrong.check().is_err_and(|error| error.to_string().contains("map_size")));
        let unknown = SoftShadows::default().with("softness", 2.0);
        assert!(unknown.check().is_err_and(|error| error.to_string().contains("softness")));
    }
}
