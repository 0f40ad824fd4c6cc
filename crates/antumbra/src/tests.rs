//! Tests of the whole library: every shader is valid, every declaration is complete.

use antumbra_light::LightShape;
use glam::{Vec2, Vec3};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::TechniqueKind;
use crate::contract::{MapSize, ParamValue, Quality};
use crate::gpu::shared_constants::constant_of;
use crate::techniques::summed::Basis;
use crate::{receivers, shaders, techniques};

mod loops;

fn module(path: &str, wgsl: &str) -> naga::Module {
    naga::front::wgsl::parse_str(wgsl)
        .unwrap_or_else(|error| panic!("{path}:\n{}", error.emit_to_string_with_path(wgsl, path)))
}

#[test]
fn every_shader_is_valid_without_native_features() {
    for (path, wgsl) in shaders::ALL {
        let module = module(path, &shaders::text_of(wgsl));
        // 16-bit floats packed in words are core WGSL; naga asks for the capability because OpenGL lacks them.
        let core = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        let validated = Validator::new(ValidationFlags::all(), core).validate(&module);
        assert!(validated.is_ok(), "{path}: {:?}", validated.err());
        for entry in &module.entry_points {
            let size: u32 = entry.workgroup_size.iter().product();
            assert!(size <= 256, "{path}: {} has {size} invocations, above WebGPU's 256", entry.name);
        }
    }
}

/// Asserts that at least one shader has a constant of this name, and that it has this value in each of them.
fn assert_in_shaders(name: &str, value: u32) {
    let holders = shaders::ALL.iter().filter(|(_, wgsl)| wgsl.contains(name));
    let values: Vec<_> = holders.filter_map(|(path, wgsl)| Some((path, constant_of(wgsl, name)?))).collect();
    assert!(!values.is_empty(), "no shader has {name}");
    for (path, in_shader) in values {
        assert_eq!(in_shader, f64::from(value), "{path}: {name}");
    }
}

#[test]
fn kinds_have_the_shaders_numbers() {
    let sun = LightShape::Sun { angular_diameter_rad: 0.01 };
    let kinds = [
        ("KIND_RECTANGLE", LightShape::Rectangle { size_m: Vec2::ONE }),
        ("KIND_DISK", LightShape::Disk { radius_m: 1.0 }),
        ("KIND_SPHERE", LightShape::Sphere { radius_m: 1.0 }),
        ("KIND_ELLIPSOID", LightShape::Ellipsoid { radii_m: Vec3::ONE }),
        ("KIND_SUN", sun),
        ("KIND_POINTS", LightShape::Points { positions_m: vec![Vec3::ZERO] }),
    ];
    for (name, shape) in kinds {
        assert_in_shaders(name, receivers::inputs::kind_of(&shape));
    }
    for (name, basis) in [
        ("BASIS_TILES", Basis::Tiles),
        ("BASIS_EXPONENTIAL", Basis::Exponential),
        ("BASIS_VARIANCE", Basis::Variance),
        ("BASIS_EXPONENTIAL_VARIANCE", Basis::ExponentialVariance),
        ("BASIS_MOMENT", Basis::Moment),
        ("BASIS_CONVOLUTION", Basis::Convolution),
    ] {
        assert_in_shaders(name, basis as u32);
    }
}

#[test]
fn every_declaration_is_complete_and_holds_its_own_default() {
    for kind in TechniqueKind::ALL {
        assert_eq!(TechniqueKind::from_name(kind.name()), Some(*kind));
        for spec in kind.param_specs() {
            assert!(!spec.meaning.is_empty() && spec.more.ends_with('.'), "{kind}.{}", spec.key);
            match (spec.default, spec.range) {
                (ParamValue::U32(v), Some((low, high))) => assert!((low..=high).contains(&f64::from(v))),
                (ParamValue::F32(v), Some((low, high))) => assert!((low..=high).contains(&f64::from(v))),
                (ParamValue::Choice(v), _) => assert!(spec.choices.contains(&v)),
                (ParamValue::Bool(_) | ParamValue::List(_), None) => {}
                other => panic!("{kind}.{}: {other:?}", spec.key),
            }
        }
    }
}

/// Qualities set what the declarations allow. Each step differs from the one below it, except for exact hard shadows, which have
/// one quality.
#[test]
fn qualities_are_within_ranges_and_differ() {
    for kind in TechniqueKind::ALL {
        let steps = Quality::LADDER.map(|quality| kind.quality_settings(quality));
        for (key, value) in steps.iter().flatten() {
            kind.check(key, &value.to_string()).unwrap_or_else(|error| panic!("{error}"));
        }
        assert!(steps[1].is_empty(), "{kind}: what is balanced are the defaults");
        let has_steps = *kind != TechniqueKind::AliasFree;
        assert!(steps.windows(2).all(|pair| (pair[0] != pair[1]) == has_steps), "{kind}: {steps:?}");
    }
}

/// Published settings are valid and differ from the defaults, each with a text on what the default does instead.
#[test]
fn published_settings_are_valid_and_differ_from_defaults() {
    let mut printed_count = 0;
    for kind in TechniqueKind::ALL {
        let set = kind.quality_settings(Quality::Paper);
        let Some(printed) = kind.published() else {
            assert!(set.is_empty() && !kind.has_quality(Quality::Paper), "{kind}");
            continue;
        };
        printed_count += 1;
        let keys: Vec<_> = set.iter().map(|(key, _)| *key).collect();
        for (key, value) in &set {
            kind.check(key, &value.to_string()).unwrap_or_else(|error| panic!("{error}"));
        }
        for departure in printed.departures {
            let times = printed.departures.iter().filter(|other| other.key == departure.key).count();
            assert!(times == 1 && keys.contains(&departure.key), "{kind}.{}: as it comes", departure.key);
        }
        assert_eq!(keys.len(), printed.departures.len(), "{kind}");
        let texts = printed.departures.iter().map(|departure| departure.ours).chain(printed.kept.iter().copied());
        assert!(texts.clone().all(|text| text.ends_with('.')), "{kind}: {:?}", texts.collect::<Vec<_>>());
    }
    // The papers' own techniques and those that they compare with, `vssm` and `cssm` among them.
    assert_eq!(printed_count, 12);
}

#[test]
fn parameters_say_what_they_take() {
    use crate::contract::Params;
    let mut params = techniques::single_map::pcf::PcfParams::default();
    let message = |result: Result<(), crate::contract::ParamError>| result.unwrap_err().to_string();
    assert!(message(params.set("pcf", "size", "3")).contains("available: map_size, kernel"));
    assert!(message(params.set("pcf", "map_size", "7")).contains("a whole number from 16 to 8192"));
    assert!(message(params.set("pcf", "map_size", "-7")).contains("a whole number"));
    assert!(message(params.set("pcf", "kernel_size", "NaN")).contains("a number from 1 to 127"));
    assert!(message(params.set("pcf", "kernel", "gauss")).contains("one of box, poisson, vogel"));
    params.set("pcf", "kernel", "vogel").expect("a choice");
    assert_eq!(params.get("kernel"), Some(ParamValue::Choice("vogel")));
    params.set_value("pcf", "map_size", 2048).expect("a number in range");
    params.set_value("pcf", "Kernel", "box").expect("a choice");
    assert_eq!((params.map_size, params.get("kernel")), (MapSize::Texels(2048), Some(ParamValue::Choice("box"))));
    assert!(message(params.set_value("pcf", "map_size", 7)).contains("a whole number from 16 to 8192"));
    assert!(message(params.set_value("pcf", "map_size", 64.0)).contains("a whole number from 16 to 8192"));
    assert!(message(params.set_value("pcf", "kernel_size", f32::NAN)).contains("a number from 1 to 127"));
    assert!(message(params.set_value("pcf", "kernel", "gauss")).contains("one of box, poisson, vogel"));
    assert!(message(params.set_value("pcf", "rotate", 1)).contains("true or false"));
    params.kernel_size = 1000.0;
    assert!(params.validate("pcf").is_err());
}

/// Shaders and Rust agree on the number of runs of casters in a dispatch.
#[test]
fn tables_of_runs_are_as_long_as_the_shaders_say() {
    for name in ["light_map/caster_triangles/gather", "techniques/receiver_lists/triangles/count"] {
        let (_, wgsl) = crate::shaders::ALL.iter().find(|(path, _)| *path == name).expect("a listed shader");
        let module = naga::front::wgsl::parse_str(&shaders::text_of(wgsl)).expect("valid");
        let runs = module.global_variables.iter().find(|(_, variable)| {
            // The linker puts a module's path before names of another module.
            variable.name.as_deref().is_some_and(|name| name == "runs" || name.ends_with("_runs"))
        });
        let (_, runs) = runs.unwrap_or_else(|| panic!("{name} has no table `runs`"));
        let naga::TypeInner::Array { size: naga::ArraySize::Constant(length), .. } = module.types[runs.ty].inner else {
            panic!("{name}: `runs` has no constant length");
        };
        assert_eq!(length.get() as usize, crate::light_map::caster_triangles::runs::MAX_RUNS, "{name}");
    }
}
