//! `antumbra techniques [NAME]`.

use antumbra::contract::{ParamSpec, ParamValue};
use antumbra::{Quality, TechniqueKind};
use serde_json::{Map, Value, json};

use crate::args::TechniquesArgs;
use crate::failure::Failure;
use crate::stdout::say;
use crate::table;
use crate::technique_text::plain;

/// Lists the techniques, or describes one.
pub fn techniques(args: &TechniquesArgs) -> Result<(), Failure> {
    if args.json {
        let value = args.name.map_or_else(|| TechniqueKind::ALL.iter().map(|kind| json_of(*kind)).collect(), json_of);
        say!("{value:#}");
        return Ok(());
    }
    match args.name {
        Some(kind) => print_one(kind),
        None => {
            let mut rows = vec![["NAME", "GOOD FOR", "FAILS WHERE"].map(str::to_owned).to_vec()];
            rows.extend(TechniqueKind::ALL.iter().map(|kind| {
                let facts = kind.facts();
                [facts.name, facts.good_for, facts.fails_where].map(plain).to_vec()
            }));
            table::print(&rows);
            say!("\n`antumbra techniques NAME` shows a technique's source, parameters and qualities.");
        }
    }
    Ok(())
}

fn print_one(kind: TechniqueKind) {
    let facts = kind.facts();
    say!("{kind}: {}\n{}\n", facts.title, facts.source);
    say!("  penumbra     {}", plain(facts.penumbra));
    say!("  shadow maps  {}", plain(facts.light_maps));
    say!("  good for     {}", plain(facts.good_for));
    say!("  fails where  {}", plain(facts.fails_where));
    say!("  worst on     builtin:{}: {}\n", facts.worst_scene, plain(facts.worst_case));
    for spec in kind.param_specs() {
        say!("  {}  ({})", spec.key, spec.meaning.trim_end_matches('.'));
        let unit = if spec.unit.is_empty() { String::new() } else { format!(", {}", spec.unit) };
        say!("      {}{unit}; default {}", spec.expected(), spec.default);
        say!("      {}", spec.more);
    }
    say!("\nQualities, for example {kind}:{}:", Quality::Fast);
    for quality in Quality::LADDER {
        let set: Vec<_> =
            kind.quality_settings(quality).iter().map(|(key, value)| format!("{key} = {value}")).collect();
        let set = match quality {
            Quality::Balanced => "the defaults".to_owned(),
            _ if set.is_empty() => format!("as {}", Quality::Balanced),
            _ => set.join(", "),
        };
        say!("  {:9} {set}", quality.name());
    }
    print_departures(kind);
    say!("\nSet them with --set KEY=VALUE (render) or --set {kind}.KEY=VALUE (compare, bench).");
}

/// Prints a technique's departures from its paper, and the settings that undo them.
fn print_departures(kind: TechniqueKind) {
    let Some(printed) = kind.published() else { return };
    say!("\nAs published: {kind}:{}. Its settings, and what ours does instead:", Quality::Paper);
    let set = kind.quality_settings(Quality::Paper);
    for departure in printed.departures {
        let value = set.iter().find(|(key, _)| *key == departure.key).map(|(_, value)| value.to_string());
        say!("  {} = {}", departure.key, value.unwrap_or_default());
        say!("      {}", departure.ours);
    }
    if !printed.kept.is_empty() {
        say!("\nDepartures from the paper without a parameter:");
        printed.kept.iter().for_each(|text| say!("  {text}"));
    }
}

/// Returns a technique's description, parameters and qualities.
fn json_of(kind: TechniqueKind) -> Value {
    let facts = kind.facts();
    let qualities: Map<String, Value> = Quality::LADDER
        .iter()
        .map(|quality| {
            let set = kind.quality_settings(*quality);
            let set: Map<String, Value> =
                set.iter().map(|(key, value)| ((*key).to_owned(), number_of(value))).collect();
            (quality.name().to_owned(), set.into())
        })
        .collect();
    json!({
        "name": kind.name(),
        "title": facts.title,
        "source": facts.source,
        "penumbra": plain(facts.penumbra),
        "shadow_maps": plain(facts.light_maps),
        "good_for": plain(facts.good_for),
        "fails_where": plain(facts.fails_where),
        "worst_scene": format!("builtin:{}", facts.worst_scene),
        "parameters": kind.param_specs().iter().map(json_of_parameter).collect::<Vec<_>>(),
        "qualities": qualities,
    })
}

fn json_of_parameter(spec: &ParamSpec) -> Value {
    json!({
        "key": spec.key,
        "meaning": plain(spec.meaning),
        "unit": spec.unit,
        "range": spec.range.map(|(low, high)| [low, high]),
        "choices": spec.choices,
        "default": number_of(&spec.default),
        "more": plain(spec.more),
    })
}

/// Returns numbers and switches as JSON values, other values as text.
fn number_of(value: &ParamValue) -> Value {
    match value {
        ParamValue::Bool(value) => json!(value),
        // Parsing the text keeps 0.1 as it is; converting the `f32` to a double would add digits.
        ParamValue::U32(_) | ParamValue::F32(_) => {
            let text = value.to_string();
            serde_json::from_str(&text).unwrap_or(Value::String(text))
        }
        _ => value.to_string().into(),
    }
}
