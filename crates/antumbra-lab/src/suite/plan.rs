//! Plan of the suite: the rows of BENCHMARKS' tables, grouped by scene.

use antumbra::TechniqueKind;
use glam::UVec2;
use serde_json::{Value, json};

use crate::motion::Motion;
use crate::reproduce::{Row, exhibits};
use crate::technique_run::TechniqueChoice;

/// Part of the suite: the rows of one table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Errors against the ray tracer.
    Errors,
    /// Times of each pass.
    Times,
    /// Times as one quantity grows.
    Growth,
    /// Times of pairs that papers compare.
    Claims,
    /// Flicker and lag.
    Motion,
    /// `multi_view` with many views.
    Views,
    /// Exhibits of the papers.
    Papers,
}

impl Part {
    /// All parts, in the order in which they run.
    pub const ALL: [Self; 7] =
        [Self::Errors, Self::Times, Self::Growth, Self::Claims, Self::Motion, Self::Views, Self::Papers];

    /// Returns the first part of its jobs' names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Errors => "errors",
            Self::Times => "times",
            Self::Growth => "growth",
            Self::Claims => "claims",
            Self::Motion => "motion",
            Self::Views => "views",
            Self::Papers => "papers",
        }
    }
}

/// Jobs with one scene and size.
#[derive(Clone, Debug)]
pub struct Group {
    /// Part of the suite.
    pub part: Part,
    /// Name of the scene, without `builtin:`.
    pub scene: &'static str,
    /// Width and height, pixels.
    pub size_px: UVec2,
    /// Factor of the light's size.
    pub light_scale: f32,
    /// Kind of measurement.
    pub work: Work,
    /// Jobs: last part of the name, and technique.
    pub jobs: Vec<(String, TechniqueChoice)>,
}

/// Kind of measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Error against the truth, time and memory.
    Error,
    /// Time and memory.
    Time,
    /// Flicker and lag.
    Motion(Motion),
}

impl Group {
    /// Returns a job's name in the results: `errors/overlap/pcss`.
    pub fn id(&self, job: &str) -> String {
        match self.work {
            Work::Motion(motion) => format!("{}/{}/{}/{job}", self.part.name(), self.scene, motion.name()),
            _ => format!("{}/{}/{job}", self.part.name(), self.scene),
        }
    }
}

/// Claim of a paper that one technique takes less time than another.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Description in words.
    pub what: &'static str,
    /// Side claimed to be faster.
    pub ours: Side,
    /// Side claimed to be slower.
    pub against: Side,
    /// Width and height, pixels.
    pub size_px: (u32, u32),
}

/// Side of a claim.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Name of the scene, without `builtin:`.
    pub scene: &'static str,
    /// Name of the technique.
    pub technique: &'static str,
    /// Parameters of the technique.
    pub settings: &'static [(&'static str, &'static str)],
}

impl Side {
    /// Returns the technique with its parameters.
    ///
    /// # Panics
    /// If there is no technique of this name.
    pub fn choice(&self) -> TechniqueChoice {
        let kind = TechniqueKind::from_name(self.technique).expect("the suite's techniques exist");
        let settings = self.settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        TechniqueChoice::with_settings(kind, settings.collect())
    }
}

/// Scenes of the table of errors.
pub const ERROR_SCENES: [&str; 7] =
    ["overlap", "lantern-wall", "leaning-plank", "stacked-panels", "window", "columns", "tree"];
/// Scenes of the table of times: few triangles, many thin objects, one dense closed mesh.
pub const TIME_SCENES: [&str; 3] = ["columns", "shanty", "knot"];
/// Scenes of the table of `multi_view` with many views.
pub const MANY_VIEW_SCENES: [&str; 20] = [
    "overlap",
    "lantern-wall",
    "leaning-plank",
    "stacked-panels",
    "window",
    "columns",
    "knot",
    "ten-knots",
    "tilted-planes",
    "spheres",
    "checker-far",
    "bench-under-tree",
    "tree",
    "tree-alpha",
    "shanty",
    "street",
    "fence-geometry",
    "fence-alpha",
    "hairball",
    "ring-in-grass",
];
/// Scene of the table of motion.
pub const MOTION_SCENE: &str = "lantern-wall";

/// Step of a quantity in the table of growth; everything else has its default.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Description, also used in the jobs' names.
    pub name: &'static str,
    /// Amount: texels, pixels, triangles, or factor of the light's size.
    pub amount: f64,
    scene: &'static str,
    size_px: (u32, u32),
    light_scale: f32,
    /// Width of the light maps; `None` uses the technique's default.
    map_px: Option<u32>,
}

impl Step {
    /// Returns a job's name within the table.
    pub fn job(&self, technique: &str) -> String {
        format!("{}/{technique}", self.name)
    }

    /// Returns a job's name in the results.
    pub fn id(&self, technique: &str) -> String {
        format!("{}/{}/{}", Part::Growth.name(), self.scene, self.job(technique))
    }

    fn choice(&self, kind: TechniqueKind) -> TechniqueChoice {
        let sizes = kind.param_specs().iter().filter(|spec| MAP_SIZES.contains(&spec.key));
        let settings = self
            .map_px
            .into_iter()
            .flat_map(|map_px| sizes.clone().map(move |spec| (spec.key.to_owned(), map_px.to_string())));
        TechniqueChoice::with_settings(kind, settings.collect())
    }
}

const AS_IT_COMES: Step =
    Step { name: "", amount: 1.0, scene: "columns", size_px: (320, 180), light_scale: 1.0, map_px: None };

const fn map_step(name: &'static str, map_px: u32) -> Step {
    let amount = map_px as f64 * map_px as f64;
    Step { name, amount, map_px: Some(map_px), ..AS_IT_COMES }
}

const fn light_step(name: &'static str, light_scale: f32) -> Step {
    Step { name, amount: light_scale as f64, light_scale, ..AS_IT_COMES }
}

const fn triangle_step(name: &'static str, scene: &'static str, triangles: f64) -> Step {
    Step { name, amount: triangles, scene, ..AS_IT_COMES }
}

const fn pixel_step(name: &'static str, size_px: (u32, u32)) -> Step {
    Step { name, amount: size_px.0 as f64 * size_px.1 as f64, size_px, ..AS_IT_COMES }
}

/// Growing quantities, each in steps of a constant factor.
pub const GROWTH: [(&str, [Step; 3]); 4] = [
    ("map's texels", [map_step("512²", 512), map_step("1024²", 1024), map_step("2048²", 2048)]),
    ("light's size", [light_step("× ½", 0.5), light_step("× 1", 1.0), light_step("× 2", 2.0)]),
    (
        "triangles of `knot`",
        [
            triangle_step("6 250", "knot?triangles=6250", 6_250.0),
            triangle_step("25 000", "knot?triangles=25000", 25_000.0),
            triangle_step("100 000", "knot?triangles=100000", 100_000.0),
        ],
    ),
    (
        "pixels",
        [pixel_step("160 × 90", (160, 90)), pixel_step("320 × 180", (320, 180)), pixel_step("640 × 360", (640, 360))],
    ),
];

/// Parameters that set the width of light maps.
const MAP_SIZES: [&str; 2] = ["map_size", "view_size"];

const REPROJECTION: &str = "reprojection";
const VIEWS: &str = "multi_view";
const MAPS_512: &[(&str, &str)] = &[("view_size", "512")];
const POINTS_256: &[(&str, &str)] = &[("samples", "256")];

/// Claims of the papers; both sides are measured one after the other.
pub const CLAIMS: &[Claim] = &[
    Claim {
        what: "64 depth maps of 512², 23 490 triangles (Marrs et al. 2014)",
        ours: Side { scene: "shanty", technique: REPROJECTION, settings: MAPS_512 },
        against: Side { scene: "shanty", technique: VIEWS, settings: MAPS_512 },
        size_px: (640, 360),
    },
    Claim {
        what: "the same, 100 000 triangles",
        ours: Side { scene: "knot", technique: REPROJECTION, settings: MAPS_512 },
        against: Side { scene: "knot", technique: VIEWS, settings: MAPS_512 },
        size_px: (640, 360),
    },
    Claim {
        what: "the same, a million",
        ours: Side { scene: "ten-knots", technique: REPROJECTION, settings: MAPS_512 },
        against: Side { scene: "ten-knots", technique: VIEWS, settings: MAPS_512 },
        size_px: (640, 360),
    },
    Claim {
        what: "256 light points, 840 triangles (Sintorn et al. 2008)",
        ours: Side { scene: "columns", technique: "sample_based", settings: POINTS_256 },
        against: Side { scene: "columns", technique: VIEWS, settings: POINTS_256 },
        size_px: (320, 180),
    },
    Claim {
        what: "the same, 100 000 triangles",
        ours: Side { scene: "knot", technique: "sample_based", settings: POINTS_256 },
        against: Side { scene: "knot", technique: VIEWS, settings: POINTS_256 },
        size_px: (320, 180),
    },
    Claim {
        what: "`lvsm`, a lookup of 14 layers against 2 (Lauritzen and McCool 2008)",
        ours: Side {
            scene: "columns",
            technique: "lvsm",
            settings: &[("map_size", "16"), ("kernel_size", "1"), ("layers", "14")],
        },
        against: Side {
            scene: "columns",
            technique: "lvsm",
            settings: &[("map_size", "16"), ("kernel_size", "1"), ("layers", "2")],
        },
        size_px: (640, 360),
    },
    Claim {
        what: "`essm`, tiles against one float table, 1024² (Shen et al. 2013)",
        ours: Side { scene: "street", technique: "essm", settings: &[("table", "tiles")] },
        against: Side { scene: "street", technique: "essm", settings: &[("table", "float")] },
        size_px: (320, 180),
    },
];

/// Jobs of the suite.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Groups of BENCHMARKS' own tables.
    pub groups: Vec<Group>,
    /// Rows of the papers' exhibits.
    pub papers: Vec<PaperRow>,
}

/// Row of a paper's exhibit.
#[derive(Clone, Debug)]
pub struct PaperRow {
    /// Name of the exhibit, `marrs-2014/figure3`.
    pub exhibit: String,
    /// Index of the row in the exhibit.
    pub number: usize,
    /// Row to run.
    pub row: &'static Row,
}

impl PaperRow {
    /// Returns the row's name in the results: `papers/marrs-2014/figure4/reprojection`.
    pub fn id(&self) -> String {
        format!("{}/{}/{}", Part::Papers.name(), self.exhibit, self.row.what)
    }

    /// Returns the stored result, with a description of the row, because rows of later commits may differ under the same name.
    pub fn kept(&self, here: &str) -> Value {
        json!({
            "exhibit": self.exhibit,
            "number": self.number,
            "row": self.row.what,
            "technique": self.row.technique,
            "paper": self.row.measure.paper_text(),
            "here": here,
        })
    }
}

impl Plan {
    /// Returns the whole suite, cheap groups first.
    pub fn whole() -> Self {
        let rows = |(exhibit, rows): (String, &'static [Row])| {
            rows.iter().enumerate().map(move |(number, row)| PaperRow { exhibit: exhibit.clone(), number, row })
        };
        Self {
            groups: groups(),
            papers: exhibits().map(|(name, _, exhibit)| (name, exhibit.rows)).flat_map(rows).collect(),
        }
    }

    /// Returns the plan restricted to some parts.
    #[must_use]
    pub fn only(mut self, parts: &[Part]) -> Self {
        self.groups.retain(|group| parts.contains(&group.part));
        if !parts.contains(&Part::Papers) {
            self.papers.clear();
        }
        self
    }

    /// Returns the names of all jobs.
    pub fn ids(&self) -> impl Iterator<Item = String> {
        let own = self.groups.iter().flat_map(|group| group.jobs.iter().map(|(job, _)| group.id(job)));
        own.chain(self.papers.iter().map(PaperRow::id))
    }
}

fn groups() -> Vec<Group> {
    let all = || -> Vec<(String, TechniqueChoice)> {
        TechniqueKind::ALL.iter().map(|kind| (kind.name().to_owned(), TechniqueChoice::default_of(*kind))).collect()
    };
    let group = |part, scene, size_px: (u32, u32), work, jobs| Group {
        part,
        scene,
        size_px: size_px.into(),
        light_scale: 1.0,
        work,
        jobs,
    };
    let errors = ERROR_SCENES.map(|scene| group(Part::Errors, scene, (320, 180), Work::Error, all()));
    let times = TIME_SCENES.map(|scene| group(Part::Times, scene, (640, 360), Work::Time, all()));
    let motions = Motion::ALL.map(|motion| group(Part::Motion, MOTION_SCENE, (320, 180), Work::Motion(motion), all()));
    let claims = CLAIMS.iter().enumerate().flat_map(|(i, claim)| {
        [("ours", claim.ours), ("against", claim.against)].map(|(side, run)| {
            let jobs = vec![(claim_job(i, side), run.choice())];
            group(Part::Claims, run.scene, claim.size_px, Work::Time, jobs)
        })
    });
    let views = MANY_VIEW_SCENES.map(|scene| {
        let choice = TechniqueChoice::with_settings(TechniqueKind::MultiView, vec![("samples".into(), "256".into())]);
        group(Part::Views, scene, (640, 360), Work::Error, vec![("multi_view".into(), choice)])
    });
    let growth = GROWTH.iter().flat_map(|(_, steps)| steps).map(|step| {
        let jobs = TechniqueKind::ALL.iter().map(|kind| (step.job(kind.name()), step.choice(*kind)));
        Group {
            light_scale: step.light_scale,
            ..group(Part::Growth, step.scene, step.size_px, Work::Time, jobs.collect())
        }
    });
    errors.into_iter().chain(times).chain(growth).chain(claims).chain(motions).chain(views).collect()
}

/// Returns the name of a claim's job: `3-ours`.
pub(super) fn claim_job(claim: usize, side: &str) -> String {
    format!("{claim}-{side}")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use antumbra_scene::builtin;

    use super::*;

    #[test]
    fn every_job_can_be_made_and_has_a_name_of_its_own() {
        let plan = Plan::whole();
        let ids: BTreeSet<_> = plan.ids().collect();
        assert_eq!(ids.len(), plan.ids().count(), "two jobs have one name");
        for group in plan.groups {
            let scene = group.scene.split('?').next().unwrap();
            assert!(builtin::NAMES.iter().any(|info| info.name == scene), "{scene}");
            for (job, choice) in &group.jobs {
                for (key, value) in &choice.settings {
                    choice.kind.check(key, value).unwrap_or_else(|error| panic!("{}: {error}", group.id(job)));
                }
            }
        }
        assert!(ids.contains("errors/tree/sample_based") && ids.contains("motion/lantern-wall/light/pcss"));
        assert!(ids.iter().any(|id| id.starts_with("papers/marrs-2014/")));
        for (what, steps) in GROWTH {
            let by = steps[1].amount / steps[0].amount;
            assert!(by > 1.5 && (steps[2].amount / steps[1].amount / by - 1.0).abs() < 1e-9, "{what}");
            assert!(steps.iter().all(|step| ids.contains(&step.id("pcss"))), "{what}");
        }
    }
}
