//! Parsers of option values. A parser's message describes valid values; clap prefixes the option.

use std::path::Path;
use std::time::Duration;

use antumbra::{Quality, TechniqueKind};
use antumbra_lab::advise::{Budget, Prefer};
use antumbra_lab::compare::Truth;
use antumbra_lab::motion::Motion;
use antumbra_lab::preset::read_preset;
use antumbra_lab::reproduce::{PRESETS, Preset};
use antumbra_lab::suite::Part;
use antumbra_lab::sweep::Shard;
use antumbra_lab::technique_run::{Extras, TechniqueChoice};
use antumbra_scene::builtin;
use glam::UVec2;

use crate::suggest::did_you_mean;

/// Maximum width and height of images: the texture limit of every WebGPU device.
const MAX_SIDE_PX: u32 = 8192;

/// Parameter setting: `KEY=VALUE` or `NAME.KEY=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Technique and optional quality that the setting applies to; `None` for every chosen technique with the key.
    pub technique: Option<(TechniqueKind, Option<Quality>)>,
    pub key: String,
    pub value: String,
}

/// A technique with quality and additional passes: `pcss`, `pcss:fast`, `pcss:fast+half+denoised`; or a preset file: `advice.toml`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Technique {
    pub kind: TechniqueKind,
    pub quality: Quality,
    pub extras: Extras,
    /// Settings of a preset; `--set` overrides them.
    pub settings: Vec<(String, String)>,
}

/// A list of techniques.
#[derive(Clone, Debug)]
pub struct Techniques(pub Vec<Technique>);

pub fn size(text: &str) -> Result<UVec2, String> {
    let right = || format!("expected WIDTHxHEIGHT in pixels, each from 1 to {MAX_SIDE_PX}, such as 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(right)?;
    let side = |text: &str| text.parse().ok().filter(|side| (1..=MAX_SIDE_PX).contains(side)).ok_or_else(right);
    Ok(UVec2::new(side(width)?, side(height)?))
}

/// Parses a scene's name; a built-in's name is returned as declared, whatever its case.
pub fn scene(text: &str) -> Result<String, String> {
    Ok(builtin::declared_name(text))
}

pub fn time(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|t: &f32| t.is_finite()).ok_or_else(|| "expected a number of seconds, such as 1.5".into())
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

/// Parses a time limit in seconds, up to about eleven days.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| *seconds > 0.0 && *seconds <= 1e6);
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "expected a number of seconds above 0, such as 60 or 0.5".into())
}

pub fn minutes(text: &str) -> Result<u32, String> {
    whole_number(text, 1, 10_000)
}

fn whole_number(text: &str, low: u32, high: u32) -> Result<u32, String> {
    let number = text.parse().ok().filter(|n| (low..=high).contains(n));
    number.ok_or_else(|| format!("expected a whole number from {low} to {high}"))
}

pub fn truth(text: &str) -> Result<Truth, String> {
    match text.to_lowercase().as_str() {
        "traced" => Ok(Truth::Traced),
        "filtered" => Ok(Truth::Filtered),
        _ => Err("expected traced or filtered".into()),
    }
}

/// Motions to measure.
#[derive(Clone, Debug)]
pub struct Motions(pub Vec<Motion>);

pub fn motions(text: &str) -> Result<Motions, String> {
    let mut motions = Vec::new();
    for name in text.split(',').map(str::trim) {
        let named = if is_all(name) { Motion::ALL.to_vec() } else { vec![motion(name)?] };
        motions.extend(named.into_iter().filter(|motion| !motions.contains(motion)).collect::<Vec<_>>());
    }
    Ok(Motions(motions))
}

/// Whether a name is `all`.
pub fn is_all(name: &str) -> bool {
    name.eq_ignore_ascii_case("all")
}

fn motion(name: &str) -> Result<Motion, String> {
    named(name, &Motion::ALL, Motion::name)
        .map_err(|(near, list)| format!("there is no motion `{name}`{near}; expected {list} or all"))
}

pub fn suite_part(text: &str) -> Result<Part, String> {
    named(text.trim(), &Part::ALL, Part::name)
        .map_err(|(near, list)| format!("the suite has no table `{text}`{near}; it has {list}"))
}

/// Finds a value by its name. The error has a suggestion and the list of names.
fn named<T: Copy>(name: &str, all: &[T], name_of: impl Fn(T) -> &'static str) -> Result<T, (String, String)> {
    let names = || all.iter().copied().map(&name_of);
    let found = all.iter().copied().find(|one| name_of(*one).eq_ignore_ascii_case(name));
    found.ok_or_else(|| (did_you_mean(name, names()), names().collect::<Vec<_>>().join(", ")))
}

pub fn motion_frames(text: &str) -> Result<u32, String> {
    whole_number(text, 1, 1000)
}

pub fn step(text: &str) -> Result<f32, String> {
    let metres = text.parse().ok().filter(|metres| (0.0..=1000.0).contains(metres));
    metres.ok_or_else(|| "expected a distance in metres from 0 to 1000, such as 0.15".into())
}

pub fn distance(text: &str) -> Result<f32, String> {
    let metres = text.parse().ok().filter(|metres: &f32| *metres > 0.0 && metres.is_finite());
    metres.ok_or_else(|| "expected a distance in metres above 0, such as 150".into())
}

pub fn technique(text: &str) -> Result<Technique, String> {
    let (text, extras) = Extras::split(text);
    if Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        let TechniqueChoice { kind, quality, settings, .. } =
            read_preset(Path::new(text)).map_err(|error| error.to_string())?;
        return Ok(Technique { kind, quality, extras, settings });
    }
    let (kind, quality) = kind_and_quality(text)?;
    let quality = quality.unwrap_or_default();
    if kind.has_quality(quality) {
        return Ok(Technique { kind, quality, extras, settings: Vec::new() });
    }
    let list =
        all_of(quality, Extras::default()).iter().map(|technique| technique.kind.name()).collect::<Vec<_>>().join(", ");
    Err(format!("`{kind}` has no preset `{quality}`; techniques that have it: {list}"))
}

pub fn preset(id: &str) -> Result<Preset, String> {
    let known = || PRESETS.iter().map(|preset| preset.paper);
    PRESETS.iter().find(|preset| preset.paper.eq_ignore_ascii_case(id)).copied().ok_or_else(|| {
        let list = known().collect::<Vec<_>>().join(", ");
        format!("there is no preset `{id}`{}; available: {list}", did_you_mean(id, known()))
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
        format!("there is no quality `{name}`{}; available: {list}", did_you_mean(name, known()))
    })
}

pub fn kind(name: &str) -> Result<TechniqueKind, String> {
    let known = || TechniqueKind::ALL.iter().map(|kind| kind.name());
    TechniqueKind::from_name(name).ok_or_else(|| {
        let list = known().collect::<Vec<_>>().join(", ");
        format!("there is no technique `{name}`{}; available: {list}", did_you_mean(name, known()))
    })
}

pub fn techniques(text: &str) -> Result<Techniques, String> {
    let mut techniques = Vec::new();
    for name in text.split(',').map(str::trim) {
        let (plain, extras) = Extras::split(name);
        let named = match plain.split_once(':') {
            None if is_all(plain) => all_of(Quality::default(), extras),
            Some((all, step)) if is_all(all) => all_of(quality(step)?, extras),
            _ => vec![technique(name)?],
        };
        // A duplicate row would be useless.
        techniques.extend(named.into_iter().filter(|technique| !techniques.contains(technique)).collect::<Vec<_>>());
    }
    Ok(Techniques(techniques))
}

/// Returns a paper's techniques as published there, followed by the techniques that it compares with, at their paper
/// quality or else at their defaults.
pub fn techniques_of(preset: &Preset) -> Vec<Technique> {
    let of = |kind: &TechniqueKind| Technique {
        kind: *kind,
        quality: if kind.has_quality(Quality::Paper) { Quality::Paper } else { Quality::default() },
        extras: Extras::default(),
        settings: Vec::new(),
    };
    preset.techniques.iter().map(of).collect()
}

fn all_of(quality: Quality, extras: Extras) -> Vec<Technique> {
    let all = TechniqueKind::ALL.iter().filter(|kind| kind.has_quality(quality));
    all.map(|kind| Technique { kind: *kind, quality, extras, settings: Vec::new() }).collect()
}

/// Techniques to choose from, without qualities.
#[derive(Clone, Debug)]
pub struct Kinds(pub Vec<TechniqueKind>);

pub fn kinds(text: &str) -> Result<Kinds, String> {
    let mut kinds = Vec::new();
    for name in text.split(',').map(str::trim) {
        let named = if is_all(name) { TechniqueKind::ALL.to_vec() } else { vec![kind(name)?] };
        kinds.extend(named.into_iter().filter(|kind| !kinds.contains(kind)).collect::<Vec<_>>());
    }
    Ok(Kinds(kinds))
}

pub fn budget(text: &str) -> Result<Budget, String> {
    let right = || "expected milliseconds, such as 4ms, or a multiple of the time of pcf, such as 4x".to_owned();
    let text = text.to_lowercase();
    let (number, unit): (&str, fn(f64) -> Budget) = match (text.strip_suffix("ms"), text.strip_suffix('x')) {
        (Some(number), _) => (number, Budget::Ms),
        (_, Some(number)) => (number, Budget::TimesPcf),
        _ => return Err(right()),
    };
    let number = number.trim().parse().ok().filter(|v: &f64| (1e-3..=1e6).contains(v));
    number.map(unit).ok_or_else(right)
}

pub fn memory(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 3] = [("kib", 1024.0), ("mib", 1_048_576.0), ("gib", 1_073_741_824.0)];
    let text = text.to_lowercase();
    let of = |(unit, bytes): &(&str, f64)| {
        let number: f64 = text.strip_suffix(unit)?.trim().parse().ok()?;
        (number > 0.0 && number <= 1e6).then(|| (number * bytes) as u64)
    };
    UNITS.iter().find_map(of).ok_or_else(|| "expected a memory size, such as 512KiB, 64MiB or 1GiB".into())
}

/// Parses a root-mean-square error of visibility, above 0 and at most 1.
pub fn roughness(text: &str) -> Result<f64, String> {
    let right = || "expected a fraction above 0 and at most 1, such as 0.01".to_owned();
    text.parse().ok().filter(|v| *v > 0.0 && *v <= 1.0).ok_or_else(right)
}

/// Parses a memory bandwidth, gigabytes per second.
pub fn bandwidth(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("expected a positive number of gigabytes per second, such as 288".into()),
    }
}

pub fn shard(text: &str) -> Result<Shard, String> {
    let right = || "expected INDEX/COUNT with an index from 1 to the count, such as 1/4".to_owned();
    let (index, of) = text.split_once('/').ok_or_else(right)?;
    let number = |text: &str| text.parse::<usize>().map_err(|_| right());
    let shard = Shard { index: number(index)?, of: number(of)? };
    if (1..=shard.of).contains(&shard.index) && shard.of <= 100_000 { Ok(shard) } else { Err(right()) }
}

pub fn prefer(text: &str) -> Result<Prefer, String> {
    match text.to_lowercase().as_str() {
        "still" => Ok(Prefer::Still),
        "motion" => Ok(Prefer::Motion),
        _ => Err("expected still or motion".into()),
    }
}

pub fn setting(text: &str) -> Result<Setting, String> {
    let form = "expected KEY=VALUE or TECHNIQUE.KEY=VALUE, such as map_size=2048 or pcss.map_size=2048";
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

    /// Names match in any case.
    #[test]
    fn names_in_any_case() {
        assert_eq!(scene("BUILTIN:Overlap"), Ok("builtin:overlap".into()));
        assert_eq!(scene("Hall.GLB"), Ok("Hall.GLB".into()));
        assert_eq!(kind("PCSS"), Ok(TechniqueKind::Pcss));
        assert_eq!(quality("FAST"), Ok(Quality::Fast));
        let same = |a: &str, b: &str| assert_eq!(techniques(a).unwrap().0, techniques(b).unwrap().0, "{a}");
        same("Hard,PCSS:Fast+Denoised", "hard,pcss:fast+denoised");
        same("ALL:High", "all:high");
        same("All", "all");
        assert_eq!(kinds("All").unwrap().0, TechniqueKind::ALL);
        assert_eq!(preset("Shen-2013").unwrap().paper, "shen-2013");
        assert_eq!(motions("Camera,LIGHT").unwrap().0, [Motion::Camera, Motion::Light]);
        assert_eq!(motions("ALL").unwrap().0, Motion::ALL);
        assert_eq!(suite_part("Times"), Ok(Part::Times));
        assert_eq!((truth("Filtered"), prefer("MOTION")), (Ok(Truth::Filtered), Ok(Prefer::Motion)));
        assert_eq!(
            (budget("4MS"), budget("4X"), memory("64mib")),
            (Ok(Budget::Ms(4.0)), Ok(Budget::TimesPcf(4.0)), Ok(64 << 20))
        );
        let setting = setting("PCSS:Fast.Map_Size=512").unwrap();
        assert_eq!(setting.technique, Some((TechniqueKind::Pcss, Some(Quality::Fast))));
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
    fn budgets_and_sizes_of_memory() {
        assert_eq!((budget("4ms"), budget("0.5x")), (Ok(Budget::Ms(4.0)), Ok(Budget::TimesPcf(0.5))));
        for wrong in ["4", "ms", "-1ms", "0x", "NaNms", "4s", ""] {
            assert!(budget(wrong).unwrap_err().contains("4ms"), "{wrong}");
        }
        assert_eq!((memory("64MiB"), memory("1.5 KiB")), (Ok(64 << 20), Ok(1536)));
        for wrong in ["64", "64MB", "-1MiB", "0KiB", "MiB"] {
            assert!(memory(wrong).unwrap_err().contains("64MiB"), "{wrong}");
        }
        assert_eq!(shard("2/4"), Ok(Shard { index: 2, of: 4 }));
        for wrong in ["0/4", "5/4", "1", "/", "a/b", "-1/2", "1/1000000"] {
            assert!(shard(wrong).unwrap_err().contains("1/4"), "{wrong}");
        }
        assert_eq!(kinds("pcf, pcss,pcf").unwrap().0, [TechniqueKind::Pcf, TechniqueKind::Pcss]);
        assert!(kinds("pcss:fast").is_err() && prefer("moving").is_err());
    }

    #[test]
    fn time_limits() {
        assert_eq!((seconds("60"), seconds("0.5")), (Ok(Duration::from_secs(60)), Ok(Duration::from_millis(500))));
        for wrong in ["0", "-1", "NaN", "inf", "1e9", "60s", ""] {
            assert!(seconds(wrong).unwrap_err().contains("such as 60"), "{wrong}");
        }
    }

    #[test]
    fn motion_lists() {
        assert_eq!(motions("all").unwrap().0, Motion::ALL);
        assert_eq!(motions("caster, camera,caster").unwrap().0, [Motion::Caster, Motion::Camera]);
        assert!(motions("camra").unwrap_err().contains("did you mean `camera`?"));
        assert!(step("-1").is_err() && step("NaN").is_err() && step("0") == Ok(0.0));
    }

    #[test]
    fn every_preset_has_techniques_as_published() {
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
        assert_eq!(techniques("all").unwrap().0, all_of(Quality::Balanced, Extras::default()));
        let of = |kind, quality| Technique { kind, quality, extras: Extras::default(), settings: Vec::new() };
        assert_eq!(
            techniques("hard, pcss:fast,pcss, hard:balanced,pcss").unwrap().0,
            [
                of(TechniqueKind::Hard, Quality::Balanced),
                of(TechniqueKind::Pcss, Quality::Fast),
                of(TechniqueKind::Pcss, Quality::Balanced)
            ]
        );
        assert_eq!(techniques("all:high").unwrap().0, all_of(Quality::High, Extras::default()));
        assert_eq!(
            techniques("pcss:fast+denoised").unwrap().0,
            [Technique { extras: Extras::denoised(), ..of(TechniqueKind::Pcss, Quality::Fast) }]
        );
        assert_eq!(techniques("all+denoised").unwrap().0, all_of(Quality::Balanced, Extras::denoised()));
        assert!(techniques("pcss:fats").unwrap_err().contains("did you mean `fast`?"));
        assert!(techniques("pcss:paper").unwrap_err().contains("essm"));
        assert!(techniques("all:paper").unwrap().0.contains(&of(TechniqueKind::Essm, Quality::Paper)));
        assert!(techniques("hard,").is_err());
    }
}
