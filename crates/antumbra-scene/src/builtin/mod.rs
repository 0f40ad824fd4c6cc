//! Built-in scenes: small procedural scenes modelled on figures of the papers, each with its camera and its light.
//!
//! [`NAMES`] lists them; [`build`] makes one from `NAME` or `NAME?key=value&key=value`. The same specification gives
//! the same scene every time. Solid objects are closed meshes (`Mesh::closed`); leaves, blades of grass, alpha-masked
//! cards and panes of glass are open sheets.

use std::fmt;

use crate::Scene;

mod bias;
mod checker_far;
mod colonnade;
mod fence;
mod hairball;
mod knots;
mod noise;
mod occluders;
mod ring_in_grass;
mod rooms;
mod shanty;
mod shapes;
mod stage;
mod stained_glass;
mod staircase;
mod street;
mod town;
mod trees;
mod window;

/// Description of a built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinInfo {
    /// The name in `builtin:NAME`.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Figure of the paper that the scene is modelled on, or its purpose.
    pub source: &'static str,
    /// Number of triangles drawn, with default parameters.
    pub triangles: usize,
    /// Whether all surfaces are opaque: none is masked, blended or transmitting.
    pub opaque: bool,
    /// Whether something thinner than 2 cm casts a shadow of its own: wires, hairs, blades.
    pub thin_bars: bool,
    /// Parameters that may follow the question mark.
    pub parameters: &'static [BuiltinParameter],
    make: fn(&Arguments) -> Scene,
}

/// Numeric parameter of a built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinParameter {
    /// The key.
    pub name: &'static str,
    /// Description, and the effect of larger values.
    pub meaning: &'static str,
    /// The unit, or empty for a count.
    pub unit: &'static str,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Default value.
    pub default: f64,
    /// Whether it must be a whole number.
    pub whole: bool,
}

/// Error in the specification of a built-in scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuiltinError {
    /// No scene has this name.
    #[error("there is no built-in scene `{name}`; nearest: {nearest}")]
    UnknownName {
        /// Name as given.
        name: String,
        /// Similar names.
        nearest: String,
    },
    /// The scene has no such parameter.
    #[error("built-in scene `{scene}` has no parameter `{key}`; available: {known}")]
    UnknownKey {
        /// The scene.
        scene: &'static str,
        /// Key as given.
        key: String,
        /// Parameters that the scene takes.
        known: String,
    },
    /// Not `key=value`, or a repeated key.
    #[error("built-in scene `{scene}`: `{part}` is not of the form `key=value`, each parameter once, joined by `&`")]
    Malformed {
        /// The scene.
        scene: &'static str,
        /// The part that could not be read.
        part: String,
    },
    /// Not a number, or one outside the parameter's range.
    #[error("built-in scene `{scene}`: `{key}` is `{value}`, and must be {range}")]
    OutOfRange {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        key: &'static str,
        /// Value as given.
        value: String,
        /// Valid values.
        range: String,
    },
}

/// Prefix of the names of built-in scenes.
const PREFIX: &str = "builtin:";

/// Part of a scene's name after `builtin:`, in any case; `None` for a file.
pub fn spec_of(name: &str) -> Option<&str> {
    let (head, spec) = name.split_at_checked(PREFIX.len())?;
    head.eq_ignore_ascii_case(PREFIX).then_some(spec)
}

/// Name of a scene in its declared case: `builtin:overlap` for `Builtin:OVERLAP`. Names of files are returned unchanged, and so is
/// the part after `builtin:` if no scene has that name.
pub fn declared_name(name: &str) -> String {
    let Some(spec) = spec_of(name) else { return name.to_owned() };
    let (scene, query) = spec.split_once('?').map_or((spec, None), |(scene, query)| (scene, Some(query)));
    let scene = named(scene).map_or(scene, |info| info.name);
    query.map_or_else(|| format!("{PREFIX}{scene}"), |query| format!("{PREFIX}{scene}?{query}"))
}

/// Finds a scene by its name, in any case.
pub fn named(name: &str) -> Option<&'static BuiltinInfo> {
    NAMES.iter().find(|info| info.name.eq_ignore_ascii_case(name))
}

/// The parameters of a scene with their values, defaults filled in.
struct Arguments {
    scene: &'static str,
    values: Vec<(&'static str, f64)>,
}

impl Arguments {
    /// The value of a parameter that the scene declares.
    fn get(&self, name: &str) -> f64 {
        self.values.iter().find(|(key, _)| *key == name).expect("the scene declares each parameter that it reads").1
    }
}

impl BuiltinParameter {
    fn range(&self) -> String {
        let kind = if self.whole { "a whole number" } else { "a number" };
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        format!("{kind} from {} to {}{unit}", self.min, self.max)
    }
}

impl fmt::Display for BuiltinParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` ({}, default {})", self.name, self.range(), self.default)
    }
}

/// Elevation of the light in the scenes that test bias.
const LIGHT_ELEVATION: BuiltinParameter = BuiltinParameter {
    name: "light_elevation_deg",
    meaning: "elevation of the light above the ground, seen from the scene's centre; smaller is more grazing",
    unit: "degrees",
    min: 5.0,
    max: 90.0,
    default: 40.0,
    whole: false,
};

/// Number of triangles of `knot`.
const KNOT_TRIANGLES: BuiltinParameter = BuiltinParameter {
    name: "triangles",
    meaning: "number of triangles of the scene, within 1 %; more triangles make the same surface finer",
    unit: "",
    min: 1e3,
    max: 4e6,
    default: 1e5,
    whole: true,
};

/// Defaults of the entries in [`NAMES`].
const SOLID: BuiltinInfo = BuiltinInfo {
    name: "",
    summary: "",
    source: "",
    triangles: 0,
    opaque: true,
    thin_bars: false,
    parameters: &[],
    make: |_| Scene::default(),
};

/// Every built-in scene, in the order of the documentation.
pub const NAMES: &[BuiltinInfo] = &[
    BuiltinInfo {
        name: "overlap",
        summary: "boards high above a low table above the ground: shadows overlap where variance shadow maps leak",
        source: "Lauritzen 2008, figs. 1, 2 and 6",
        triangles: 192,
        make: occluders::overlap,
        ..SOLID
    },
    BuiltinInfo {
        name: "lantern-wall",
        summary: "a lantern close to a wall and a banner far from it cast one sharp and one soft shadow that overlap",
        source: "Selgrad 2014, fig. 1",
        triangles: 1580,
        make: occluders::lantern_wall,
        ..SOLID
    },
    BuiltinInfo {
        name: "leaning-plank",
        summary: "one plank from contact with the ground to two metres above it: a penumbra of every width",
        source: "Selgrad 2014, fig. 14",
        triangles: 36,
        make: occluders::leaning_plank,
        ..SOLID
    },
    BuiltinInfo {
        name: "stacked-panels",
        summary: "aligned parallel panels: adding their opacities darkens the penumbra too much",
        source: "Selgrad 2014, fig. 15",
        triangles: 252,
        make: occluders::stacked_panels,
        ..SOLID
    },
    BuiltinInfo {
        name: "window",
        summary: "light through a latticed window onto a floor and furniture",
        source: "Marrs 2014, fig. 6 top (780 triangles)",
        triangles: 780,
        make: window::window,
        ..SOLID
    },
    BuiltinInfo {
        name: "columns",
        summary: "a ring of columns with the light inside: long shadows fan out",
        source: "Sintorn 2008, figs. 7 and 10",
        triangles: 840,
        make: colonnade::columns,
        ..SOLID
    },
    BuiltinInfo {
        name: "tilted-planes",
        summary: "slabs at many angles to the light with small things standing on them: acne and lost contact",
        source: "a test case for bias",
        triangles: 14_484,
        parameters: &[LIGHT_ELEVATION],
        make: bias::tilted_planes,
        ..SOLID
    },
    BuiltinInfo {
        name: "spheres",
        summary: "spheres of ten tessellations that touch the ground: acne at the terminator, lost contact",
        source: "a test case for bias",
        triangles: 33_444,
        parameters: &[LIGHT_ELEVATION],
        make: bias::spheres,
        ..SOLID
    },
    BuiltinInfo {
        name: "knot",
        summary: "a rippled torus knot with the requested number of triangles",
        source: "Marrs 2014, fig. 1 (dragon, 100 000 triangles); Sintorn 2008, fig. 11 (torus knot)",
        triangles: 99_994,
        parameters: &[KNOT_TRIANGLES],
        make: knots::knot,
        ..SOLID
    },
    BuiltinInfo {
        name: "ten-knots",
        summary: "ten instances of the knot, a million triangles",
        source: "Marrs 2014, fig. 3 (ten dragons)",
        triangles: 999_712,
        make: knots::ten_knots,
        ..SOLID
    },
    BuiltinInfo {
        name: "hairball",
        summary: "a ball of hairs thinner than any texel",
        source: "Sintorn 2008, fig. 14 (44 000 triangles)",
        triangles: 43_984,
        thin_bars: true,
        make: hairball::hairball,
        ..SOLID
    },
    BuiltinInfo {
        name: "fence-alpha",
        summary: "a wire fence of alpha-masked cards",
        source: "Selgrad 2014, fig. 11",
        triangles: 4486,
        opaque: false,
        thin_bars: true,
        make: fence::fence_alpha,
        ..SOLID
    },
    BuiltinInfo {
        name: "fence-geometry",
        summary: "the same fence as solid wires",
        source: "Selgrad 2014, fig. 11, without its alpha map",
        triangles: 7600,
        thin_bars: true,
        make: fence::fence_geometry,
        ..SOLID
    },
    BuiltinInfo {
        name: "stained-glass",
        summary: "panes of five colours in a lead frame: coloured soft shadows",
        source: "Selgrad 2014, fig. 1 left",
        triangles: 1044,
        opaque: false,
        make: stained_glass::stained_glass,
        ..SOLID
    },
    BuiltinInfo {
        name: "checker-far",
        summary: "a chequered canopy to the horizon under the sun: moiré",
        source: "a test case for filtering",
        triangles: 38_220,
        make: checker_far::checker_far,
        ..SOLID
    },
    BuiltinInfo {
        name: "bench-under-tree",
        summary: "a slatted bench in the shade of a high crown: the crown's penumbra bleeds through the bench",
        source: "Lauritzen 2008, fig. 3",
        triangles: 33_440,
        thin_bars: true,
        make: trees::bench_under_tree,
        ..SOLID
    },
    BuiltinInfo {
        name: "tree",
        summary: "a broad tree with leaves of four triangles",
        source: "Selgrad 2014, fig. 12; Shen 2013, fig. 1 (plants)",
        triangles: 85_324,
        thin_bars: true,
        make: trees::tree,
        ..SOLID
    },
    BuiltinInfo {
        name: "tree-alpha",
        summary: "the same tree with leaves on alpha-masked cards",
        source: "Selgrad 2014, section 5.3",
        triangles: 29_644,
        opaque: false,
        thin_bars: true,
        make: trees::tree_alpha,
        ..SOLID
    },
    BuiltinInfo {
        name: "ring-in-grass",
        summary: "a golden ring in a lawn of separate blades",
        source: "Sintorn 2008, fig. 15 (379 000 triangles)",
        triangles: 378_999,
        thin_bars: true,
        make: ring_in_grass::ring_in_grass,
        ..SOLID
    },
    BuiltinInfo {
        name: "lamp-room",
        summary: "a lamp in the middle of a furnished room: receivers in all directions around the light",
        source: "a test case for lights that shine in all directions",
        triangles: 5388,
        make: rooms::lamp_room,
        ..SOLID
    },
    BuiltinInfo {
        name: "hall",
        summary: "a hall of one mesh that encloses its light: shadows up to the light's horizon",
        source: "a test case for wide lights",
        triangles: 2268,
        make: rooms::hall,
        ..SOLID
    },
    BuiltinInfo {
        name: "staircase",
        summary: "stairs beside the wall into which their light is recessed: receivers along the light's horizon",
        source: "a test case for lights seen edge-on",
        triangles: 1552,
        thin_bars: true,
        make: staircase::staircase,
        ..SOLID
    },
    BuiltinInfo {
        name: "grove",
        summary: "sixty instances of a tree of masked cards under a sun",
        source: "a test case for many layers of masked occluders",
        triangles: 223_272,
        opaque: false,
        thin_bars: true,
        make: trees::grove,
        ..SOLID
    },
    BuiltinInfo {
        name: "town",
        summary: "more than a kilometre of houses, trees and poles under a low sun, seen from a street",
        source: "a test case for suns over large scenes",
        triangles: 208_640,
        thin_bars: true,
        make: town::town,
        ..SOLID
    },
    BuiltinInfo {
        name: "shanty",
        summary: "sheds of planks and corrugated iron, pipes, barrels: thin occluders at many heights",
        source: "Marrs 2014, fig. 6 middle (23 500 triangles)",
        triangles: 23_490,
        thin_bars: true,
        make: shanty::shanty,
        ..SOLID
    },
    BuiltinInfo {
        name: "street",
        summary: "a market street: tiled roofs, awnings, wires, lanterns, stalls in many layers",
        source: "Selgrad 2014, fig. 16 (Streets of Asia, 400 000 triangles)",
        triangles: 399_924,
        thin_bars: true,
        make: street::street,
        ..SOLID
    },
];

/// Builds a scene from `NAME` or `NAME?key=value&key=value`.
///
/// # Errors
/// An unknown name, an unknown or repeated key, or a value outside its range; the message is one line with a remedy.
pub fn build(spec: &str) -> Result<Scene, BuiltinError> {
    let (name, query) = spec.split_once('?').unwrap_or((spec, ""));
    let info =
        named(name).ok_or_else(|| BuiltinError::UnknownName { name: name.into(), nearest: nearest_names(name) })?;
    Ok((info.make)(&parse_arguments(info, query)?))
}

fn parse_arguments(info: &BuiltinInfo, query: &str) -> Result<Arguments, BuiltinError> {
    let mut given: Vec<(&'static str, f64)> = Vec::new();
    for part in query.split('&').filter(|part| !part.is_empty()) {
        let malformed = || BuiltinError::Malformed { scene: info.name, part: part.into() };
        let (key, value) = part.split_once('=').ok_or_else(malformed)?;
        let parameter = info.parameters.iter().find(|p| p.name.eq_ignore_ascii_case(key));
        let parameter = parameter.ok_or_else(|| BuiltinError::UnknownKey {
            scene: info.name,
            key: key.into(),
            known: match info.parameters {
                [] => "none".into(),
                known => known.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
            },
        })?;
        if given.iter().any(|(name, _)| *name == parameter.name) {
            return Err(malformed());
        }
        let number = value
            .parse::<f64>()
            .ok()
            .filter(|v| (parameter.min..=parameter.max).contains(v) && (!parameter.whole || v.fract() == 0.0));
        let number = number.ok_or_else(|| BuiltinError::OutOfRange {
            scene: info.name,
            key: parameter.name,
            value: value.into(),
            range: parameter.range(),
        })?;
        given.push((parameter.name, number));
    }
    let value_of = |p: &BuiltinParameter| {
        let value = given.iter().find(|(name, _)| *name == p.name).map_or(p.default, |(_, value)| *value);
        (p.name, value)
    };
    Ok(Arguments { scene: info.name, values: info.parameters.iter().map(value_of).collect() })
}

/// The three names with the smallest Levenshtein distance, those that contain `name` first.
fn nearest_names(name: &str) -> String {
    const SUGGESTIONS: usize = 3;
    let name = &name.to_lowercase();
    let mut names: Vec<&str> = NAMES.iter().map(|info| info.name).collect();
    names.sort_by_key(|candidate| {
        let contains = !name.is_empty() && (candidate.contains(name.as_str()) || name.contains(candidate));
        (!contains, strsim::levenshtein(name, candidate))
    });
    names.truncate(SUGGESTIONS);
    names.join(", ")
}

#[cfg(test)]
mod tests;
