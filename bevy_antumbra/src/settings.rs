//! What users choose: technique, quality and parameters, for the whole app, a camera or a light.

use antumbra::contract::Denoise;
use antumbra::{AnyShadow, Gpu, Quality, TechniqueKind};
use bevy::prelude::*;

/// By which technique a light's shadows are made, and how much it may spend.
///
/// On a light it holds for that light, on a camera for all lights that have none of their own; the plugin's
/// [`settings`](crate::AntumbraPlugin::settings) hold for the rest. How soft a shadow is, is not here: that follows from the
/// light's size.
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
    /// The technique.
    pub technique: ShadowTechnique,
    /// How much it may spend: a set of all its parameters.
    pub quality: ShadowQuality,
    /// Single parameters that are otherwise than the quality has them. `antumbra techniques NAME` lists a technique's, with
    /// units and ranges; so does [`ShadowTechnique::parameters`].
    pub parameters: Vec<ShadowParameter>,
    /// Whether masks are made smooth over frames and neighbouring pixels, and how; `None` leaves them as the technique writes
    /// them.
    pub denoise: Option<ShadowDenoise>,
    /// Whether Bevy draws the light's own map too. Read of lights and of the plugin's settings; a map is of no camera.
    pub maps: BevyMaps,
}

/// Whether Bevy draws a light's own map beside the plugin's mask. A mask is of the one surface that a pixel's depth is of. What is
/// shaded besides it has Bevy's shadows: transparent surfaces, the far side of what transmits light diffusely, and volumetric fog.
/// Rectangles have no map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum BevyMaps {
    /// Where the scene has a transparent or transmitting material that receives shadows, or the light is a `VolumetricLight`.
    #[default]
    WhereNeeded,
    /// Always: for materials of your own that are transparent, of which the plugin is not told.
    Always,
    /// Never: what has no mask is as bright as without shadows.
    Never,
}

/// How masks are made smooth: for techniques that take few samples a pixel, with random offsets, `Pcss` and `SampleBased` among
/// them. Where things move by themselves, give the camera a `MotionVectorPrepass` too: without it only the camera's own motion
/// is known. At four samples a pixel it always is so.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct ShadowDenoise {
    /// Frames that a pixel is the mean of at most: 1 to 64, 16 by default. More: less noise, and shadows that lag by some
    /// frames where lights or casters move slowly.
    pub max_frames: u32,
}

impl Default for ShadowDenoise {
    fn default() -> Self {
        Self { max_frames: Denoise::default().max_frames }
    }
}

impl ShadowDenoise {
    /// For the library, with what a view knows of motion.
    pub(crate) fn of_library(self, motion: Option<wgpu::TextureView>) -> Denoise {
        Denoise { max_frames: self.max_frames, motion }
    }
}

impl SoftShadows {
    /// By a technique at its default quality.
    pub fn by(technique: ShadowTechnique) -> Self {
        Self { technique, ..Self::default() }
    }

    /// The same at another quality.
    pub fn at(mut self, quality: ShadowQuality) -> Self {
        self.quality = quality;
        self
    }

    /// The same with a parameter set.
    pub fn with(mut self, key: impl Into<String>, value: impl Into<ShadowValue>) -> Self {
        self.parameters.push(ShadowParameter { key: key.into(), value: value.into() });
        self
    }

    /// The same made smooth over frames and pixels.
    pub fn denoised(mut self, denoise: ShadowDenoise) -> Self {
        self.denoise = Some(denoise);
        self
    }

    /// The same with Bevy's own map or without it.
    pub fn beside(mut self, maps: BevyMaps) -> Self {
        self.maps = maps;
        self
    }

    /// A light's state with these settings.
    ///
    /// # Errors
    /// Where the device lacks something, or a parameter is unknown or out of range: one line that says which, and what there is.
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

    /// Checks the parameters before there is a device.
    ///
    /// # Errors
    /// Names the keys there are, or what a key takes.
    pub fn check(&self) -> Result<(), antumbra::contract::ParamError> {
        let check = |p: &ShadowParameter| self.technique.kind().check(&p.key, &p.value.to_string());
        self.parameters.iter().try_for_each(check)
    }
}

/// A light with it is left alone: no shadows of the plugin's.
///
/// A [`RectLight`] then casts none, and the others keep Bevy's own, by maps, where `shadow_maps_enabled` is set.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct NoSoftShadows;

/// A technique's parameter.
#[derive(Clone, Debug, Default, PartialEq, Reflect)]
pub struct ShadowParameter {
    /// Its name: `map_size`.
    pub key: String,
    /// Its value.
    pub value: ShadowValue,
}

/// A parameter's value.
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

/// How much a technique may spend; each step is a set of its parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum ShadowQuality {
    /// What a game with many lights can spend.
    Fast,
    /// What is left of the error is hard to see.
    #[default]
    Balanced,
    /// Twice to four times the time, for what error that takes away.
    High,
    /// The least error that the technique reaches, whatever the time.
    Best,
    /// No step of these: the algorithm as its paper prints it, to compare with. Techniques that are of none of the five papers
    /// are at their defaults.
    Paper,
}

impl ShadowQuality {
    /// Every quality, from the cheapest to the dearest, and the paper's last.
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

/// Declares the techniques once: the enum, and which of the library's each is.
macro_rules! techniques {
    ($( $(#[$outer:meta])* $variant:ident, )+) => {
        /// A technique of the library's; its own page says how it works, whose it is and where it fails.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
        #[reflect(Default, Clone, PartialEq)]
        pub enum ShadowTechnique { $( $(#[$outer])* $variant, )+ }

        impl ShadowTechnique {
            /// Every technique.
            pub const ALL: &'static [Self] = &[$( Self::$variant, )+];

            /// The same in the library.
            pub fn kind(self) -> TechniqueKind {
                match self { $( Self::$variant => TechniqueKind::$variant, )+ }
            }
        }
    };
}

techniques! {
    /// One map, edges as sharp as its texels.
    Hard,
    /// One map, edges of one width.
    Pcf,
    /// Percentage-closer soft shadows, with blockers of three layers.
    Pcss,
    /// Rays through three layers of the light map: occluders side by side and one behind another, each with its own penumbra. The
    /// default, good for most scenes.
    #[default]
    Smrt,
    /// A bit for each point of the light, set by the texels of three layers.
    Bitmask,
    /// Outlines of what blocks in one layer of the light map, and their area on the light: penumbrae without noise.
    Backprojection,
    /// Percentage-closer soft shadows over the pixel's footprint too.
    PcssAnisotropic,
    /// A map for each of many points of the light: truth, at the price of as many passes.
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
    /// Rays through trees over the casters' triangles: as true as it has rays, coloured shadows too; noise where these are few.
    RayTraced,
    /// Exact hard shadows.
    AliasFree,
    /// Exact soft shadows for the samples it has, coloured ones too; slow where casters have many triangles.
    SampleBased,
}

impl ShadowTechnique {
    /// Its parameters: names, meanings, units, ranges, defaults.
    pub fn parameters(self) -> &'static [antumbra::contract::ParamSpec] {
        self.kind().param_specs()
    }

    /// Whether it makes coloured shadows of coloured casters; the others count such as opaque from half on.
    pub(crate) fn knows_color(self) -> bool {
        matches!(self, Self::AliasFree | Self::MultiLayer | Self::MultiView | Self::RayTraced | Self::SampleBased)
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

    /// What an inspector does: by names, through reflection alone.
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
