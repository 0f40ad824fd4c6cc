//! `antumbra techniques [NAME]`.

use antumbra::{Quality, TechniqueKind};

use crate::args::TechniquesArgs;
use crate::failure::Failure;
use crate::stdout::say;
use crate::table;

/// Lists the techniques, or the parameters of one.
pub fn techniques(args: &TechniquesArgs) -> Result<(), Failure> {
    match args.name {
        Some(kind) => print_one(kind),
        None => {
            let mut rows = vec![["NAME", "TECHNIQUE", "SOURCE", "PARAMETERS"].map(str::to_owned).to_vec()];
            rows.extend(TechniqueKind::ALL.iter().map(|kind| {
                let keys: Vec<_> = kind.param_specs().iter().map(|spec| spec.key).collect();
                vec![kind.name().into(), kind.title().into(), kind.source().into(), keys.join(" ")]
            }));
            table::print(&rows);
            say!("\n`antumbra techniques NAME` explains the parameters.");
        }
    }
    Ok(())
}

fn print_one(kind: TechniqueKind) {
    say!("{kind}: {}\n{}\n", kind.title(), kind.source());
    for spec in kind.param_specs() {
        say!("  {}  ({})", spec.key, spec.meaning.trim_end_matches('.'));
        let unit = if spec.unit.is_empty() { String::new() } else { format!(", {}", spec.unit) };
        say!("      {}{unit}; default {}", spec.expected(), spec.default);
        say!("      {}", spec.more);
    }
    say!("\nQualities, as in {kind}:{}:", Quality::Fast);
    for quality in Quality::ALL {
        let set: Vec<_> =
            kind.quality_settings(quality).iter().map(|(key, value)| format!("{key} = {value}")).collect();
        let set = match quality {
            Quality::Balanced => "the defaults".to_owned(),
            _ if set.is_empty() => format!("as {}", Quality::Balanced),
            _ => set.join(", "),
        };
        say!("  {:9} {set}", quality.name());
    }
    say!("\nSet them with --set KEY=VALUE (render) or --set {kind}.KEY=VALUE (compare, bench).");
}
