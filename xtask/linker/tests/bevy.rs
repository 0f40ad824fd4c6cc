//! Tests of the Bevy plugin's shaders and of its patch of Bevy's shader that do not build Bevy, which takes a quarter of an hour and a
//! newer compiler: `cargo xtask bevy` does the rest.

use std::path::{Path, PathBuf};

use naga::valid::{Capabilities, ValidationFlags, Validator};
use wesl::{ModulePath, Wesl};

#[path = "../../../bevy_antumbra/src/patched.rs"]
mod patched;

fn plugin() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bevy_antumbra")
}

/// Parses and validates a shader; panics with its first fault.
fn validate(name: &str, text: &str) -> naga::Module {
    let module =
        naga::front::wgsl::parse_str(text).unwrap_or_else(|fault| panic!("{name}: {}", fault.emit_to_string(text)));
    let outcome = Validator::new(ValidationFlags::all(), Capabilities::default()).validate(&module);
    outcome.unwrap_or_else(|fault| panic!("{name}: {}", fault.emit_to_string(text)));
    module
}

fn files_in(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|fault| panic!("{}: {fault}", folder.display()));
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("a folder that can be read").path()) {
        if path.is_dir() {
            files.extend(files_in(&path, ending));
        } else if path.extension().is_some_and(|of| of == ending) {
            files.push(path);
        }
    }
    files
}

#[test]
fn the_plugins_own_shaders_are_valid() {
    let files = files_in(&plugin().join("src"), "wgsl");
    assert!(files.len() >= 4, "{files:?}");
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a shader that can be read");
        let module = validate(&file.display().to_string(), &text);
        assert!(!module.entry_points.is_empty(), "{} has no entry point", file.display());
    }
}

/// Declarations of Bevy that the patch uses.
const BINDINGS: &str = "
struct Light { flags: u32, shadow_depth_bias: f32 }
struct Clustered { data: array<Light, 4> }
struct Lights { directional_lights: array<Light, 4> }
struct View { viewport: vec4<f32> }
@group(0) @binding(0) var<storage, read> clustered_lights: Clustered;
@group(0) @binding(1) var<uniform> view: View;
@group(0) @binding(2) var<storage, read> lights: Lights;
@if(NO_ARRAY_TEXTURES_SUPPORT)
@group(0) @binding(3) var directional_shadow_textures: texture_depth_2d;
@if(!NO_ARRAY_TEXTURES_SUPPORT)
@group(0) @binding(3) var directional_shadow_textures: texture_depth_2d_array;
@if(!MULTISAMPLED)
@group(0) @binding(4) var depth_prepass_texture: texture_depth_2d;
@if(MULTISAMPLED)
@group(0) @binding(4) var depth_prepass_texture: texture_depth_multisampled_2d;
";
const TYPES: &str = "
const POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT: u32 = 1u;
const DIRECTIONAL_LIGHT_FLAGS_SHADOWS_ENABLED_BIT: u32 = 2u;
";
/// Shader with the lines that are patched, in Bevy's order.
const LIGHTING: &str = "
import package::bindings as view_bindings;
import package::types as mesh_view_types;
const MESH_FLAGS_SHADOW_RECEIVER_BIT: u32 = 1u;
struct In { frag_coord: vec4<f32>, flags: u32 }
struct Rectangle { range: f32 }
// mesh_view_bindings as view_bindings
fn lit(in: In, light_id: u32, i: u32, light: Rectangle, light_contrib: vec3<f32>, shadow: f32) -> vec3<f32> {
    var direct_light = vec3<f32>(0.0);
    direct_light += light_contrib * shadow;
    direct_light += light_contrib * shadow;
    direct_light += light_contrib * shadow;
    direct_light += light_contrib;
    return direct_light;
}
@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(lit(In(position, 1u), 0u, 1u, Rectangle(3.0), vec3<f32>(1.0), 0.5), 1.0);
}
";

#[test]
fn the_patch_links_in_every_way_that_bevy_compiles_its_shader() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bevy_patch");
    std::fs::create_dir_all(&folder).expect("a folder for shaders");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a shader to write");
    write("bindings.wesl", BINDINGS);
    write("types.wesl", TYPES);
    write("lighting.wesl", &patched::patched(LIGHTING).expect("a shader like Bevy's"));
    let lighting: ModulePath = "package::lighting".parse().expect("a module");
    for features in 0..8u32 {
        let mut compiler = Wesl::new(&folder);
        for (i, feature) in ["DEPTH_PREPASS", "MULTISAMPLED", "NO_ARRAY_TEXTURES_SUPPORT"].iter().enumerate() {
            compiler.set_feature(feature, features & (1 << i) != 0);
        }
        let linked = compiler.compile(&lighting).unwrap_or_else(|fault| panic!("features {features:03b}: {fault}"));
        let text = linked.to_string();
        validate(&format!("features {features:03b}"), &text);
        // Masks are read with a prepass and array textures; otherwise everything is lit.
        let has_masks = features & 0b101 == 0b001;
        assert_eq!(text.contains("textureLoad"), has_masks, "features {features:03b}");
    }
}

/// Returns the version of a package in the plugin's lock file.
fn locked(package: &str) -> String {
    let lock = std::fs::read_to_string(plugin().join("Cargo.lock")).expect("the plugin's lock file");
    let after = lock.split(&format!("name = \"{package}\"\nversion = \"")).nth(1).expect("a locked package");
    after.split('"').next().expect("a version").to_owned()
}

#[test]
fn the_patch_fits_bevys_own_shader() {
    let version = locked("bevy_pbr");
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| std::env::var_os("HOME").map(|home| Path::new(&home).join(".cargo")));
    let registries = home.and_then(|home| std::fs::read_dir(home.join("registry/src")).ok());
    let shader = format!("bevy_pbr-{version}/src/render/pbr_functions.wesl");
    let text = registries
        .into_iter()
        .flatten()
        .flatten()
        .find_map(|registry| std::fs::read_to_string(registry.path().join(&shader)).ok());
    let Some(text) = text else {
        return antumbra_testing::skip("the sources of Bevy are not here: `cargo fetch` in bevy_antumbra brings them");
    };
    let patched = patched::patched(&text).unwrap_or_else(|fault| panic!("{shader}: {fault}"));
    assert_eq!(patched.matches("antumbra_visibility(antumbra_mask_of").count(), 4);
}
