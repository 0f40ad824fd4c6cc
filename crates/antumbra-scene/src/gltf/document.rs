//! Parsing of JSON into the typed document of the `gltf` crate, and checks of the document as a whole.
//!
//! The crate's own validation is not used: it refuses files that the extensions read here allow, and refuses where a
//! repair would do. Every index and range is checked where it is used instead.

use gltf::json::Root;
use serde_json::Value;

use super::fault::{Fault, Result, quoted};

/// Extensions that this loader implements.
const HONOURED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that change neither geometry nor shadows, and may be ignored even if a file requires them.
const HARMLESS: &[&str] = &[
    "EXT_lights_ies",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_xmp_json_ld",
];

/// Parses a document; checks version and required extensions.
pub(super) fn parse(json: &[u8]) -> Result<Root> {
    let text = std::str::from_utf8(json).map_err(|e| {
        Fault::new(format!("JSON byte {}", e.valid_up_to()), "is not UTF-8", "the document must be UTF-8 text")
    })?;
    check_depth(text)?;
    let root = match serde_json::from_str::<Root>(text) {
        Ok(root) => root,
        Err(first) => retry_leniently(text).ok_or_else(|| {
            let place = format!("JSON line {}, column {}", first.line(), first.column());
            let message = first.to_string();
            let problem = message.rsplit_once(" at line ").map_or(message.as_str(), |(problem, _)| problem);
            Fault::new(place, problem.replace('\n', " "), "the file must contain a glTF 2.0 document")
        })?,
    };
    check_version(&root)?;
    if let Some(unknown) = root
        .extensions_required
        .iter()
        .find(|name| !HONOURED.contains(&name.as_str()) && !HARMLESS.contains(&name.as_str()))
    {
        return Err(Fault::new(
            "extensionsRequired",
            format!("requires {}, which is not supported", quoted(unknown)),
            "export the file without this extension (for Draco, decompress it first)",
        ));
    }
    Ok(root)
}

/// Warning about animations of other things than nodes, which [`retry_leniently`] leaves out.
pub(super) fn unread_animations(root: &Root) -> Option<String> {
    let name = "KHR_animation_pointer";
    let is_used = root.extensions_used.iter().any(|used| used == name);
    is_used.then(|| format!("{name} is not supported; properties that it animates keep their values"))
}

/// Refuses documents nested so deeply that reading them could exhaust the stack.
fn check_depth(text: &str) -> Result<()> {
    /// Largest depth, as serde_json's own limit, which does not apply to data that it skips.
    const DEEPEST: usize = 128;
    let (mut depth, mut in_string, mut escaped) = (0usize, false, false);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => in_string = !in_string,
            b'[' | b'{' if !in_string => depth += 1,
            b']' | b'}' if !in_string => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEEPEST {
            let remedy = format!("at most {DEEPEST} levels are supported");
            return Err(Fault::new("JSON", "arrays and objects are nested too deeply", remedy));
        }
    }
    Ok(())
}

/// Reads what the specification allows but the typed document refuses: whole numbers written as `1.0` (equal in JSON),
/// scenes without `nodes`, animation channels whose target is not a node.
fn retry_leniently(text: &str) -> Option<Root> {
    let mut value: Value = serde_json::from_str(text).ok()?;
    make_whole(&mut value);
    for scene in value.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        scene.as_object_mut()?.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    for animation in value.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
        let channels = animation.get_mut("channels").and_then(Value::as_array_mut)?;
        channels.retain(|channel| channel.get("target").is_none_or(|target| target.get("node").is_some()));
    }
    serde_json::from_value(value).ok()
}

/// Turns whole floats into integers. [`check_depth`] bounds the recursion.
fn make_whole(value: &mut Value) {
    /// Largest number up to which all whole numbers are exact in an f64.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    match value {
        Value::Array(items) => items.iter_mut().for_each(make_whole),
        Value::Object(map) => map.values_mut().for_each(make_whole),
        Value::Number(n) if n.is_f64() => {
            if let Some(v) = n.as_f64().filter(|v| v.fract() == 0.0 && v.abs() <= EXACT) {
                *n = (v as i64).into();
            }
        }
        _ => {}
    }
}

fn check_version(root: &Root) -> Result<()> {
    let parse = |text: &str| {
        let (major, minor) = text.split_once('.')?;
        Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
    };
    // Later versions 2.x can be read as 2.0, without their additions (section 3.2).
    let version = parse(&root.asset.version);
    let least = root.asset.min_version.as_deref().map_or(Some((2, 0)), parse);
    let ok = matches!((version, least), (Some(version @ (2, _)), Some(least @ (2, _))) if least <= version);
    let wanted = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    if ok {
        Ok(())
    } else {
        Err(Fault::new("asset", format!("version {}", quoted(wanted)), "only glTF 2.0 is supported: convert the file"))
    }
}
