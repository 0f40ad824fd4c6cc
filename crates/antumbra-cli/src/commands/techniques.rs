//! `antumbra techniques [NAME]`.

use antumbra::{Quality, TechniqueKind};

use crate::args::TechniquesArgs;
use crate::failure::Failure;
use crate::stdout::say;
use crate::table;
use crate::technique_text::plain;

/// Lists the techniques, or what is to be known of one.
pub fn techniques(args: &TechniquesArgs) -> Result<(), Failure> {
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
    print_printed(kind);
    say!("\nSet them with --set KEY=VALUE (render) or --set {kind}.KEY=VALUE (compare, bench).");
}

/// Where it departs from its paper, and what turns that off.
fn print_printed(kind: TechniqueKind) {
    let Some(printed) = kind.printed() else { return };
    say!("\nAs published: {kind}:{}. What ours does instead:", Quality::Paper);
    let set = kind.quality_settings(Quality::Paper);
    for departure in printed.departures {
        let value = set.iter().find(|(key, _)| *key == departure.key).map(|(_, value)| value.to_string());
        say!("  {} = {}", departure.key, value.unwrap_or_default());
        say!("      {}", departure.ours);
    }
    if !printed.kept.is_empty() {
        say!("\nDepartures that no parameter turns off:");
        printed.kept.iter().for_each(|text| say!("  {text}"));
    }
}
