//! What the values of options may be. Each parser's message says what would be right; clap puts the option in front.

use antumbra::{Quality, TechniqueKind};
use antumbra_lab::compare::Truth;
use antumbra_lab::motion::Motion;
use antumbra_lab::reproduce::{PRESETS, Preset};
use antumbra_lab::technique_run::DENOISED;
use glam::UVec2;

use crate::suggest::did_you_mean;

/// Pictures up to this wide and high fit the texture limits of every WebGPU device.
const MAX_SIDE_PX: u32 = 8192;

/// `KEY=VALUE` or `NAME.KEY=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The one technique that it is for, and the one quality; `None` is every chosen technique that has the key.
    pub technique: Option<(TechniqueKind, Option<Quality>)>,
    pub key: String,
    pub value: String,
}

/// A technique, how much it may spend, and whether its masks are made smooth: `pcss`, `pcss:fast`, `pcss:fast+denoised`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Technique {
    pub kind: TechniqueKind,
    pub quality: Quality,
    pub is_denoised: bool,
}

/// A list of techniques.
#[derive(Clone, Debug)]
pub struct Techniques(pub Vec<Technique>);

pub fn size(text: &str) -> Result<UVec2, String> {
    let right = || format!("a size is WIDTHxHEIGHT in pixels, each from 1 to {MAX_SIDE_PX}, such as 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(right)?;
    let side = |text: &str| text.parse().ok().filter(|side| (1..=MAX_SIDE_PX).contains(side)).ok_or_else(right);
    Ok(UVec2::new(side(width)?, side(height)?))
}

pub fn time(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|t: &f32| t.is_finite()).ok_or_else(|| "a time is a number of seconds, such as 1.5".into())
}

pub fn samples(text: &str) -> Result<u32, String> {
    whole_number(text, 1, 65_536)
}

pub fn frames(text: &str) -> Result<u32, String> {
    whole_number(text, 1, 10_000)
}

pub fn warm_up(text: &str) -> Result<u32, String> {
    whole_number(text, 0, 10_000)
}

pub fn minutes(text: &str) -> Result<u32, String> {
    whole_number(text, 1, 10_000)
}

fn whole_number(text: &str, low: u32, high: u32) -> Result<u32, String> {
    let number = text.parse().ok().filter(|n| (low..=high).contains(n));
    number.ok_or_else(|| format!("it takes a whole number from {low} to {high}"))
}

pub fn truth(text: &str) -> Result<Truth, String> {
    match text {
        "traced" => Ok(Truth::Traced),
        "filtered" => Ok(Truth::Filtered),
        _ => Err("it takes traced or filtered".into()),
    }
}

/// What moves.
#[derive(Clone, Debug)]
pub struct Motions(pub Vec<Motion>);

pub fn motions(text: &str) -> Result<Motions, String> {
    let mut motions = Vec::new();
    for name in text.split(',').map(str::trim) {
        let named = match name {
            "all" => Motion::ALL.to_vec(),
            _ => vec![motion(name)?],
        };
        motions.extend(named.into_iter().filter(|motion| !motions.contains(motion)).collect::<Vec<_>>());
    }
    Ok(Motions(motions))
}

fn motion(name: &str) -> Result<Motion, String> {
    let known = || Motion::ALL.into_iter().map(Motion::name);
    Motion::ALL.into_iter().find(|motion| motion.name() == name).ok_or_else(|| {
        let list = known().collect::<Vec<_>>().join(", ");
        format!("`{name}` does not move{}; {list} do, or all", did_you_mean(name, known()))
    })
}

pub fn motion_frames(text: &str) -> Result<u32, String> {
    whole_number(text, 1, 1000)
}

pub fn step(text: &str) -> Result<f32, String> {
    let metres = text.parse().ok().filter(|metres| (0.0..=1000.0).contains(metres));
    metres.ok_or_else(|| "it takes metres from 0 to 1000, such as 0.15".into())
}

pub fn technique(text: &str) -> Result<Technique, String> {
    let (text, is_denoised) = without_denoised(text);
    let (kind, quality) = kind_and_quality(text)?;
    let quality = quality.unwrap_or_default();
    if kind.has_quality(quality) {
        return Ok(Technique { kind, quality, is_denoised });
    }
    let list = all_of(quality, false).iter().map(|technique| technique.kind.name()).collect::<Vec<_>>().join(", ");
    Err(format!("`{kind}` has no setting `{quality}`; {list} have"))
}

/// A name without the end that says so, and whether it had it.
fn without_denoised(text: &str) -> (&str, bool) {
    text.strip_suffix(DENOISED).map_or((text, false), |name| (name, true))
}

pub fn preset(id: &str) -> Result<Preset, String> {
    let known = || PRESETS.iter().map(|preset| preset.paper);
    PRESETS.iter().find(|preset| preset.paper == id).copied().ok_or_else(|| {
        let list = known().collect::<Vec<_>>().join(", ");
        format!("there is no preset `{id}`{}; there are {list}", did_you_mean(id, known()))
    })
}

fn kind_and_quality(text: &str) -> Result<(TechniqueKind, Option<Quality>), String> {
    match text.split_once(':') {
        None => Ok((kind(text)?, None)),
        Some((name, step)) => Ok((kind(name)?, Some(quality(step)?))),
    }
}

pub fn quality(name: &str) -> Result<Quality, String> {
    let known = || Quality::ALL.into_iter().map(Quality::name);
    Quality::from_name(name).ok_or_else(|| {
        let list = known().collect::<Vec<_>>().join(", ");
        format!("there is no quality `{name}`{}; there are {list}", did_you_mean(name, known()))
    })
}

pub fn kind(name: &str) -> Result<TechniqueKind, String> {
    let known = || TechniqueKind::ALL.iter().map(|kind| kind.name());
    TechniqueKind::from_name(name).ok_or_else(|| {
        let list = known().collect::<Vec<_>>().join(", ");
        format!("there is no technique `{name}`{}; there are {list}", did_you_mean(name, known()))
    })
}

pub fn techniques(text: &str) -> Result<Techniques, String> {
    let mut techniques = Vec::new();
    for name in text.split(',').map(str::trim) {
        let (plain, is_denoised) = without_denoised(name);
        let named = match plain.split_once(':') {
            None if plain == "all" => all_of(Quality::default(), is_denoised),
            Some(("all", step)) => all_of(quality(step)?, is_denoised),
            _ => vec![technique(name)?],
        };
        // Twice the same row would only confuse.
        techniques.extend(named.into_iter().filter(|technique| !techniques.contains(technique)).collect::<Vec<_>>());
    }
    Ok(Techniques(techniques))
}

/// A paper's techniques, each as printed there, and then what it measures them against, as it comes or as its own paper
/// has it.
pub fn techniques_of(preset: &Preset) -> Vec<Technique> {
    let of = |kind: &TechniqueKind| Technique {
        kind: *kind,
        quality: if kind.has_quality(Quality::Paper) { Quality::Paper } else { Quality::default() },
        is_denoised: false,
    };
    preset.techniques.iter().map(of).collect()
}

fn all_of(quality: Quality, is_denoised: bool) -> Vec<Technique> {
    let all = TechniqueKind::ALL.iter().filter(|kind| kind.has_quality(quality));
    all.map(|kind| Technique { kind: *kind, quality, is_denoised }).collect()
}

pub fn setting(text: &str) -> Result<Setting, String> {
    let form = "it takes KEY=VALUE or TECHNIQUE.KEY=VALUE, such as map_size=2048 or pcss.map_size=2048";
    let (path, value) = text.split_once('=').ok_or(form)?;
    let (name, key) = match path.split_once('.') {
        Some((name, key)) => (Some(kind_and_quality(name.trim())?), key),
        None => (None, path),
    };
    let (key, value) = (key.trim(), value.trim());
    if key.is_empty() || value.is_empty() {
        return Err(form.into());
    }
    Ok(Setting { technique: name, key: key.into(), value: value.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x360"), Ok(UVec2::new(640, 360)));
        for wrong in ["0x0", "640", "640x", "x360", "640x-1", "9000x10", "640x360x2", "1e3x1", "99999999999x1", ""] {
            assert!(size(wrong).unwrap_err().contains("1280x720"), "{wrong}");
        }
    }

    #[test]
    fn settings() {
        let parsed = setting("pcss.map_size=2048").unwrap();
        assert_eq!((parsed.technique, parsed.key.as_str()), (Some((TechniqueKind::Pcss, None)), "map_size"));
        let of_one = setting("pcss:fast.samples=8").unwrap();
        assert_eq!(of_one.technique, Some((TechniqueKind::Pcss, Some(Quality::Fast))));
        assert_eq!(setting("samples=64").unwrap().technique, None);
        assert!(setting("samples").unwrap_err().contains("KEY=VALUE"));
        assert!(setting("samples=").unwrap_err().contains("KEY=VALUE"));
        assert!(setting("pcs.samples=1").unwrap_err().contains("did you mean `pcss`?"));
    }

    #[test]
    fn motion_lists() {
        assert_eq!(motions("all").unwrap().0, Motion::ALL);
        assert_eq!(motions("caster, camera,caster").unwrap().0, [Motion::Caster, Motion::Camera]);
        assert!(motions("camra").unwrap_err().contains("did you mean `camera`?"));
        assert!(step("-1").is_err() && step("NaN").is_err() && step("0") == Ok(0.0));
    }

    #[test]
    fn presets_are_of_papers_and_print_something() {
        assert!(preset("shen-2014").unwrap_err().contains("did you mean `shen-2013`?"));
        for chosen in PRESETS {
            assert!(antumbra_lab::reproduce::PAPERS.iter().any(|paper| paper.id == chosen.paper), "{}", chosen.paper);
            let techniques = techniques_of(&preset(chosen.paper).unwrap());
            assert!(techniques.iter().any(|technique| technique.quality == Quality::Paper), "{}", chosen.paper);
            assert!(techniques.iter().all(|technique| technique.kind.has_quality(technique.quality)));
        }
        assert_eq!(PRESETS.len(), antumbra_lab::reproduce::PAPERS.len());
    }

    #[test]
    fn technique_lists() {
        assert_eq!(techniques("all").unwrap().0, all_of(Quality::Balanced, false));
        let of = |kind, quality| Technique { kind, quality, is_denoised: false };
        assert_eq!(
            techniques("hard, pcss:fast,pcss, hard:balanced,pcss").unwrap().0,
            [
                of(TechniqueKind::Hard, Quality::Balanced),
                of(TechniqueKind::Pcss, Quality::Fast),
                of(TechniqueKind::Pcss, Quality::Balanced)
            ]
        );
        assert_eq!(techniques("all:high").unwrap().0, all_of(Quality::High, false));
        assert_eq!(
            techniques("pcss:fast+denoised").unwrap().0,
            [Technique { is_denoised: true, ..of(TechniqueKind::Pcss, Quality::Fast) }]
        );
        assert_eq!(techniques("all+denoised").unwrap().0, all_of(Quality::Balanced, true));
        assert!(techniques("pcss:fats").unwrap_err().contains("did you mean `fast`?"));
        assert!(techniques("pcss:paper").unwrap_err().contains("essm"));
        assert!(techniques("all:paper").unwrap().0.contains(&of(TechniqueKind::Essm, Quality::Paper)));
        assert!(techniques("hard,").is_err());
    }
}
