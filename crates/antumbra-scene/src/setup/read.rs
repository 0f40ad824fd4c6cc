//! Reading of setup files key by key, so that every message can name the line, the key and the nearest valid one.

use std::cmp::Reverse;
use std::path::Path;

use antumbra_light::{Cone, EmissionTexture, Light, LightShape, ShadowDistance};
use glam::{DVec3, Vec2, Vec3};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{FAR_M, FOV_Y_DEGREES, NEAR_M, Setup, check_camera, emission};
use crate::{Camera, SceneError};

const SHAPES: &[&str] = &["rectangle", "disk", "sphere", "ellipsoid", "sun", "points"];
const CAMERA_KEYS: &[&str] = &["eye", "target", "up", "fov_y", "near", "far", "shadow_distance", "shadow_fade"];
/// Keys of every light; each shape adds its own.
const LIGHT_KEYS: &[&str] = &["name", "shape", "center", "target", "up", "fov", "cone", "color", "intensity"];
/// Angular diameter of the sun seen from the earth, degrees.
const SUN_DEGREES: f64 = 0.53;
/// Default position of a light: above the origin, metres.
const CENTER_M: Vec3 = Vec3::new(0.0, 5.0, 0.0);

/// Name of a shape in files.
pub(super) fn shape_name(shape: &LightShape) -> &'static str {
    match shape {
        LightShape::Rectangle { .. } => "rectangle",
        LightShape::Disk { .. } => "disk",
        LightShape::Sphere { .. } => "sphere",
        LightShape::Ellipsoid { .. } => "ellipsoid",
        LightShape::Sun { .. } => "sun",
        LightShape::Points { .. } => "points",
    }
}

/// Keys that a shape adds to those of every light.
fn own_keys(shape: &str) -> &'static [&'static str] {
    match shape {
        "rectangle" => &["size", "texture", "candela"],
        "disk" | "sphere" => &["radius", "candela"],
        "ellipsoid" => &["radii", "candela"],
        "sun" => &["direction", "angular_diameter", "lux"],
        _ => &["positions", "candela"],
    }
}

type Result<T> = std::result::Result<T, SceneError>;

pub(super) fn setup(text: &str, origin: &Path) -> Result<Setup> {
    let file = File { text, origin: origin.display().to_string() };
    let root = DeTable::parse(text).map_err(|e| {
        let at = e.span().map_or(0, |s| s.start);
        file.error(at, e.message().replace('\n', " "), "the file must be TOML")
    })?;
    let root = Section { file: &file, name: "the file", start: 0, table: root.get_ref() };
    root.only(&[&["camera", "light"]], "a setup has one [camera] and one or more [[light]]")?;

    let camera = match root.get("camera") {
        Some(value) => camera(&file, value)?,
        None => return Err(file.error(0, "there is no [camera]", "add [camera] with `eye` and `target`")),
    };
    let lights = match root.get("light") {
        Some(value) => match value.get_ref() {
            DeValue::Array(items) => {
                let folder = origin.parent().unwrap_or(Path::new(""));
                items.iter().enumerate().map(|(i, item)| light(&file, item, i, folder)).collect::<Result<Vec<_>>>()?
            }
            _ => {
                let start = value.span().start;
                return Err(file.error(start, "`light` is not a list", "write [[light]] with two brackets"));
            }
        },
        None => Vec::new(),
    };
    if lights.is_empty() {
        return Err(file.error(text.len(), "there is no [[light]]", "add at least one [[light]] with its `shape`"));
    }
    Ok(Setup { camera, lights })
}

fn camera(file: &File, value: &Spanned<DeValue>) -> Result<Camera> {
    let section = Section::of(file, "[camera]", value)?;
    section.only(&[CAMERA_KEYS], "")?;
    let camera = Camera {
        eye: section.vec3("eye")?.ok_or_else(|| section.missing("eye", "[x, y, z] in metres"))?.as_vec3(),
        target: section.vec3("target")?.ok_or_else(|| section.missing("target", "[x, y, z] in metres"))?.as_vec3(),
        up: section.vec3("up")?.map_or(Vec3::Y, |v| v.as_vec3()),
        fov_y_rad: section.number("fov_y")?.unwrap_or(FOV_Y_DEGREES).to_radians() as f32,
        near_m: section.number("near")?.map_or(NEAR_M, |v| v as f32),
        far_m: section.number("far")?.map_or(FAR_M, |v| v as f32),
        shadow_distance: shadow_distance(file, &section)?,
    };
    check_camera(&camera).map_err(|problem| {
        // The message begins with the key.
        let key = problem.split('`').nth(1).unwrap_or_default();
        file.error(section.start_of(key), format!("[camera]: {problem}"), "correct the key")
    })?;
    Ok(camera)
}

fn shadow_distance(file: &File, section: &Section<'_>) -> Result<Option<ShadowDistance>> {
    let fade_m = section.number("shadow_fade")?.map(|v| v as f32);
    let Some(end_m) = section.number("shadow_distance")? else {
        let Some(_) = fade_m else { return Ok(None) };
        let problem = "[camera]: `shadow_fade` is given without `shadow_distance`";
        return Err(file.error(section.start_of("shadow_fade"), problem, "add `shadow_distance`, in metres"));
    };
    let usual = ShadowDistance::new(end_m as f32);
    Ok(Some(ShadowDistance { fade_m: fade_m.unwrap_or(usual.fade_m), ..usual }))
}

fn light(file: &File, value: &Spanned<DeValue>, index: usize, folder: &Path) -> Result<Light> {
    let title = format!("[[light]] number {}", index + 1);
    let section = Section::of(file, &title, value)?;
    let shape = section.string("shape")?.ok_or_else(|| section.missing("shape", &one_of(SHAPES)))?;
    if !SHAPES.contains(&shape) {
        let problem = format!("{title}: `shape` is {shape:?}");
        return Err(file.error(section.start_of("shape"), problem, &suggestion(shape, SHAPES)));
    }
    section.only(&[LIGHT_KEYS, own_keys(shape)], &format!("a {shape}"))?;

    let emission = emission_of(file, &section, &title, folder)?;
    let shape = light_shape(&section, shape)?;
    let target = section.vec3("target")?;
    let direction = section.vec3("direction")?;
    if matches!(shape, LightShape::Sun { .. }) && direction.is_none() && target.is_none() {
        return Err(section.missing("direction", "[x, y, z], the way the light travels"));
    }
    let default_center = match &shape {
        LightShape::Points { positions_m } if !positions_m.is_empty() => {
            positions_m.iter().sum::<Vec3>() / positions_m.len() as f32
        }
        _ => CENTER_M,
    };
    let center = section.vec3("center")?.unwrap_or(default_center.as_dvec3());
    let target = target.unwrap_or(DVec3::ZERO);
    // Computed from the centre rounded to f32, so that a light that was written reads back unchanged. Points that are equal
    // in the file define no direction.
    let towards_target = if target == center { DVec3::ZERO } else { target - center.as_vec3().as_dvec3() };
    let axis = unit(direction.unwrap_or(towards_target));
    // Each of the two is a key only of the shapes for which it is defined.
    let given = section.number("candela")?.or(section.number("lux")?);
    let light = Light {
        name: section.string("name")?.map_or_else(|| default_name(index), str::to_owned),
        shape,
        center: center.as_vec3(),
        axis,
        up: Light::valid_up(axis, section.vec3("up")?.map_or(Vec3::Y, |v| v.as_vec3())),
        fov_rad: section.number("fov")?.map(|degrees| degrees.to_radians() as f32),
        cone: section.numbers("cone")?.map(|[inner, outer]: [f64; 2]| Cone {
            inner_rad: inner.to_radians() as f32,
            outer_rad: outer.to_radians() as f32,
        }),
        color: section.vec3("color")?.map_or(Vec3::ONE, |v| v.as_vec3()),
        candela_or_lux: given.map(|v| v as f32),
        intensity: section.number("intensity")?.map_or(1.0, |v| v as f32),
        emission,
    };
    light.validate().map_err(|source| SceneError::Light {
        origin: file.origin.clone(),
        line: file.line(section.start),
        source,
    })?;
    Ok(light)
}

/// Emission texture of a light; `None` if it has none.
fn emission_of(file: &File, section: &Section<'_>, title: &str, folder: &Path) -> Result<Option<EmissionTexture>> {
    let Some(texture) = section.string("texture")? else { return Ok(None) };
    let read = emission::read(texture, folder).map_err(|why| {
        let shown: String = texture.chars().take(80).collect();
        file.error(
            section.start_of("texture"),
            format!("{title}: `texture` {shown:?} cannot be used: {why}"),
            "expected a PNG or JPEG file beside the setup file",
        )
    });
    read.map(Some)
}

/// Reads a light's shape from the keys of its kind, which is one of [`SHAPES`].
fn light_shape(section: &Section<'_>, shape: &str) -> Result<LightShape> {
    let need = |key: &'static str, what: &str| section.missing(key, what);
    Ok(match shape {
        "rectangle" => {
            let [w, h] = section.numbers("size")?.ok_or_else(|| need("size", "[width, height] in metres"))?;
            LightShape::Rectangle { size_m: Vec2::new(w as f32, h as f32) }
        }
        "disk" | "sphere" => {
            let radius_m = section.number("radius")?.ok_or_else(|| need("radius", "a length in metres"))? as f32;
            if shape == "disk" { LightShape::Disk { radius_m } } else { LightShape::Sphere { radius_m } }
        }
        "ellipsoid" => {
            let radii = section.vec3("radii")?.ok_or_else(|| need("radii", "three half-axes in metres"))?;
            LightShape::Ellipsoid { radii_m: radii.as_vec3() }
        }
        "sun" => {
            let degrees = section.number("angular_diameter")?.unwrap_or(SUN_DEGREES);
            LightShape::Sun { angular_diameter_rad: degrees.to_radians() as f32 }
        }
        _ => LightShape::Points {
            positions_m: section.positions()?.ok_or_else(|| need("positions", "[[x, y, z], ...] in metres"))?,
        },
    })
}

/// Default name of a light; the first light is the key light.
fn default_name(index: usize) -> String {
    if index == 0 { "key".into() } else { format!("light {}", index + 1) }
}

/// Normalizes in double precision; zero if there is no direction.
fn unit(v: DVec3) -> Vec3 {
    v.try_normalize().unwrap_or(DVec3::ZERO).as_vec3()
}

/// Text being read and its origin for messages.
struct File<'t> {
    text: &'t str,
    origin: String,
}

impl File<'_> {
    /// Line of a byte, from 1.
    fn line(&self, at: usize) -> usize {
        let before = &self.text.as_bytes()[..at.min(self.text.len())];
        1 + before.iter().filter(|b| **b == b'\n').count()
    }

    fn error(&self, at: usize, problem: impl Into<String>, remedy: &str) -> SceneError {
        SceneError::Setup {
            origin: self.origin.clone(),
            line: self.line(at),
            problem: problem.into(),
            remedy: remedy.to_owned(),
        }
    }
}

/// One table of the file.
struct Section<'t> {
    file: &'t File<'t>,
    name: &'t str,
    start: usize,
    table: &'t DeTable<'t>,
}

impl<'t> Section<'t> {
    fn of(file: &'t File<'t>, name: &'t str, value: &'t Spanned<DeValue<'t>>) -> Result<Self> {
        let start = value.span().start;
        match value.get_ref() {
            DeValue::Table(table) => Ok(Self { file, name, start, table }),
            other => Err(file.error(
                start,
                format!("{name} is {}", article(other.type_str())),
                "it must be a table of keys and values",
            )),
        }
    }

    fn get(&self, key: &str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.table.iter().find(|(k, _)| k.get_ref() == key).map(|(_, v)| v)
    }

    /// Start of a key's value, a byte; start of the section if it has no such key.
    fn start_of(&self, key: &str) -> usize {
        self.get(key).map_or(self.start, |v| v.span().start)
    }

    /// Refuses keys outside `allowed`; `whose` names the owner of the keys in messages.
    fn only(&self, allowed: &[&[&str]], whose: &str) -> Result<()> {
        let allowed: Vec<&str> = allowed.iter().copied().flatten().copied().collect();
        // In the order of the file, so that the first mistake is the one reported.
        let mut keys: Vec<_> = self.table.keys().collect();
        keys.sort_by_key(|key| key.span().start);
        match keys.into_iter().find(|key| !allowed.contains(&key.get_ref().as_ref())) {
            None => Ok(()),
            Some(key) => {
                let name: &str = key.get_ref();
                let owners: Vec<&str> = SHAPES.iter().copied().filter(|s| own_keys(s).contains(&name)).collect();
                let remedy = if !whose.is_empty() && !owners.is_empty() {
                    format!("this key belongs to {}; {whose} has {}", owners.join(" and "), one_of(&allowed))
                } else {
                    suggestion(name, &allowed)
                };
                let shown: String = name.chars().take(40).collect();
                Err(self.file.error(key.span().start, format!("{}: unknown key {shown:?}", self.name), &remedy))
            }
        }
    }

    fn missing(&self, key: &str, what: &str) -> SceneError {
        self.file.error(self.start, format!("{}: `{key}` is missing", self.name), &format!("add `{key}`: {what}"))
    }

    fn wrong(&self, key: &str, value: &Spanned<DeValue>, what: &str) -> SceneError {
        let problem = format!("{}: `{key}` is {}", self.name, article(value.get_ref().type_str()));
        self.file.error(value.span().start, problem, &format!("expected {what}"))
    }

    fn string(&self, key: &str) -> Result<Option<&'t str>> {
        self.get(key).map(|v| v.get_ref().as_str().ok_or_else(|| self.wrong(key, v, "a string in quotes"))).transpose()
    }

    fn number(&self, key: &str) -> Result<Option<f64>> {
        self.get(key).map(|v| number(v).ok_or_else(|| self.wrong(key, v, "a number"))).transpose()
    }

    fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>> {
        self.get(key)
            .map(|v| numbers(v).ok_or_else(|| self.wrong(key, v, &format!("a list of {N} numbers"))))
            .transpose()
    }

    fn vec3(&self, key: &str) -> Result<Option<DVec3>> {
        Ok(self.numbers(key)?.map(DVec3::from_array))
    }

    fn positions(&self) -> Result<Option<Vec<Vec3>>> {
        let Some(value) = self.get("positions") else { return Ok(None) };
        let wrong = |v| self.wrong("positions", v, "a list of [x, y, z]");
        let items = value.get_ref().as_array().ok_or_else(|| wrong(value))?;
        let position = |v| numbers(v).map(|p| DVec3::from_array(p).as_vec3()).ok_or_else(|| wrong(v));
        items.iter().map(position).collect::<Result<Vec<_>>>().map(Some)
    }
}

fn number(value: &Spanned<DeValue>) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(v) => v.as_str().parse().ok(),
        DeValue::Integer(v) => i64::from_str_radix(v.as_str(), v.radix()).ok().map(|v| v as f64),
        _ => None,
    }
}

fn numbers<const N: usize>(value: &Spanned<DeValue>) -> Option<[f64; N]> {
    let items = value.get_ref().as_array()?;
    let list: Option<Vec<f64>> = items.iter().map(number).collect();
    list?.try_into().ok()
}

fn article(kind: &str) -> String {
    let vowel = kind.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {kind}", if vowel { "an" } else { "a" })
}

fn one_of(names: &[&str]) -> String {
    names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
}

/// Valid name that is most similar to a wrong one, or all of them if none is similar.
fn suggestion(wrong: &str, right: &[&str]) -> String {
    // Number of wrong letters up to which a name counts as mistyped; longer names are allowed more.
    let slips = |name: &str| 1 + name.len() / 3;
    // A much longer name is not mistyped, and comparing it would take long.
    let candidates = right.iter().filter(|name| wrong.len() <= 2 * name.len());
    let shared_start = |name: &str| name.bytes().zip(wrong.bytes()).take_while(|(a, b)| a == b).count();
    let nearest = candidates.map(|name| (strsim::levenshtein(wrong, name), Reverse(shared_start(name)), *name)).min();
    match nearest {
        Some((d, _, name)) if d <= slips(name) => format!("did you mean `{name}`?"),
        _ => format!("valid keys are {}", one_of(right)),
    }
}
