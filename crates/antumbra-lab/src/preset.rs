//! Preset: a technique with its parameters in a file. `advise` writes it, and it is accepted wherever a technique is named.
//!
//! ```toml
//! technique = "pcss"     # or with a quality, "pcss:fast", whose parameters apply first
//!
//! [parameters]           # others keep their defaults
//! map_size = 2048
//! means = "ranges"
//! ```

use std::path::Path;

use antumbra::contract::ParamValue;
use antumbra::{Quality, TechniqueKind};
use toml::{Table, Value};

use crate::output_files::{FileError, one_line};
use crate::technique_run::TechniqueChoice;

const REMEDY: &str =
    "a preset has `technique = \"NAME\"` and a table [parameters]; `antumbra techniques NAME` lists them";

/// Reads a preset.
///
/// # Errors
/// If the file cannot be read, is no preset, or has an unknown technique or parameter.
pub fn read_preset(path: &Path) -> Result<TechniqueChoice, FileError> {
    let text = std::fs::read_to_string(path).map_err(|error| FileError::from_read(path, &error))?;
    parse(&text).map_err(|why| FileError::bad_content(path, why, REMEDY))
}

/// Returns the text of a preset.
pub fn preset_toml(choice: &TechniqueChoice) -> String {
    let mut text = format!("technique = \"{}\"\n\n[parameters]\n", choice.name());
    for (key, value) in &choice.settings {
        let spec = choice.kind.param_specs().iter().find(|spec| spec.key == key);
        let is_name = spec.is_none_or(|spec| spec.choices.iter().any(|name| name.eq_ignore_ascii_case(value)));
        let value = match spec.map(|spec| spec.default) {
            _ if is_name => Value::String(value.clone()).to_string(),
            Some(ParamValue::List(_)) => format!("[{value}]"),
            _ => value.clone(),
        };
        text += &format!("{key} = {value}\n");
    }
    text
}

fn parse(text: &str) -> Result<TechniqueChoice, String> {
    let table: Table = text.parse().map_err(|error: toml::de::Error| one_line(error.message()))?;
    if let Some(other) = table.keys().find(|key| !["technique", "parameters"].contains(&key.as_str())) {
        return Err(format!("unknown key `{other}`"));
    }
    let name = table.get("technique").and_then(Value::as_str).ok_or("`technique` is missing")?;
    let (name, quality) = name.split_once(':').map_or((name, None), |(name, quality)| (name, Some(quality)));
    let kind = TechniqueKind::from_name(name).ok_or_else(|| format!("there is no technique `{name}`"))?;
    let quality = match quality {
        None => Quality::default(),
        Some(name) => Quality::from_name(name).ok_or_else(|| format!("there is no quality `{name}`"))?,
    };
    let mut choice = TechniqueChoice::of_quality(kind, quality);
    match table.get("parameters") {
        None => {}
        Some(Value::Table(parameters)) => {
            for (key, value) in parameters {
                let value =
                    text_of(value).ok_or_else(|| format!("`{key}` is not a number, Boolean, string or list"))?;
                let (spec, value) = kind.read(key, &value).map_err(|error| error.to_string())?;
                choice.settings.push((spec.key.to_owned(), value.to_string()));
            }
        }
        Some(_) => return Err("`parameters` is not a table".into()),
    }
    Ok(choice)
}

/// Returns a parameter's value in the syntax of `--set`.
fn text_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Integer(v) => Some(v.to_string()),
        Value::Float(v) => Some(v.to_string()),
        Value::Boolean(v) => Some(v.to_string()),
        Value::Array(values) => values.iter().map(text_of).collect::<Option<Vec<_>>>().map(|values| values.join(",")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let settings = [("bias_scale", "0.667"), ("map_size", "2048"), ("means", "ranges"), ("rotate", "false")];
        let settings = settings.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec();
        let choice =
            TechniqueChoice { quality: Quality::Fast, ..TechniqueChoice::with_settings(TechniqueKind::Pcss, settings) };
        let text = preset_toml(&choice);
        assert!(text.starts_with("technique = \"pcss:fast\"\n") && text.contains("means = \"ranges\""), "{text}");
        assert_eq!(parse(&text), Ok(choice));
        let auto = TechniqueChoice::with_settings(TechniqueKind::Smrt, vec![("map_size".into(), "auto".into())]);
        assert_eq!(parse(&preset_toml(&auto)), Ok(auto));
        let lists = "technique = \"lvsm\"\n[parameters]\nsplit_depths = [1.5, 4]\nmsaa = 4\n";
        let choice = parse(lists).unwrap();
        assert_eq!(choice.settings[1], ("split_depths".to_owned(), "1.5,4".to_owned()));
        assert_eq!(parse(&preset_toml(&choice)), Ok(choice));
    }

    #[test]
    fn names_are_read_in_any_case() {
        let read = parse("technique = \"PCSS:Fast\"\n[parameters]\nMap_Size = 512\nmeans = \"Ranges\"\n").unwrap();
        assert_eq!(Ok(read), parse("technique = \"pcss:fast\"\n[parameters]\nmap_size = 512\nmeans = \"ranges\"\n"));
    }

    #[test]
    fn other_files_are_told_in_one_line() {
        for (text, part) in [
            ("", "`technique` is missing"),
            ("technique = 3", "`technique` is missing"),
            ("technique = \"pscs\"", "no technique `pscs`"),
            ("technique = \"pcss:quick\"", "no quality `quick`"),
            ("technique = \"pcss\"\nsize = 3", "unknown key `size`"),
            ("technique = \"pcss\"\nparameters = 3", "not a table"),
            ("technique = \"pcss\"\n[parameters]\nmap_size = 7", "map_size"),
            ("technique = \"pcss\"\n[parameters]\nmap_siz = 512", "map_siz"),
            ("technique = \"pcss\"\n[parameters]\nmap_size = { a = 1 }", "`map_size` is not a number"),
            ("technique = ", "string"),
        ] {
            let why = parse(text).unwrap_err();
            assert!(why.contains(part) && !why.contains('\n'), "{text}: {why}");
        }
        let missing = read_preset(Path::new("no-such.toml")).unwrap_err();
        assert!(missing.is_bad_input && missing.to_string().contains("no such file"));
    }
}
