//! Layouts with the verdict's effects added.

use crate::base::json;
use crate::base::number::shortest;
use crate::cli::identify::fitted::import;
use crate::cli::{MessageFormat, Outcome, layouts, read};
use crate::gap::chain::Chains;
use crate::gap::{Diagnosis, Finding, Id, RunId};
use crate::identify::cases::Case;
use crate::model::effect_definitions::{named, spelled};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// For each layout `NAME-gap.json`, and `NAME-gap.lss` where it came as `.lss`: the layout with the effects of the
/// verdict.
pub fn files(
    cases: &[Case],
    chains: &Chains,
    found: &Diagnosis,
    output: &Path,
) -> Result<Vec<(String, Vec<u8>)>, Outcome> {
    let effects = &found.named()[..];
    let mut out: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let names = layouts::names(cases.iter().map(|c| c.layout.as_path()), "-gap");
    for (run, case) in cases.iter().enumerate() {
        let Some(own_name) = names.get(&case.layout) else { continue };
        let mut simulation = chains.simulation(RunId::new(run)).clone();
        simulation.effects.extend(effects.iter().flat_map(|finding| finding.declared()));
        let name = format!("{own_name}-gap");
        out.entry(format!("{name}.json")).or_insert_with(|| json::to_json(&simulation));
        if case.layout.extension().is_some_and(|e| e == "lss") && !out.contains_key(&format!("{name}.lss")) {
            let layout = read::read(&case.layout, None, MessageFormat::Text)?.layout;
            let (import, copy) = import(&case.layout, output, own_name);
            if let Some(bytes) = copy {
                out.insert(import.clone(), bytes);
            }
            out.insert(format!("{name}.lss"), text(&layout.name, &import, effects).into_bytes());
        }
    }
    Ok(out.into_iter().collect())
}

fn text(layout: &str, import: &str, effects: &[&Finding]) -> String {
    let mut out = format!(
        "// `{layout}` with what `lss gap diagnose` found.\n\nuse \"{import}\"\n\n\
         layout {layout}_gap from {layout} {{\n"
    );
    for (finding, at) in effects.iter().flat_map(|f| f.places().map(move |at| (f, at))) {
        let strength = at.strength.iter().map(|(name, a)| {
            let unit = if a.unit.is_empty() { String::new() } else { format!(" {}", spelled(&a.unit)) };
            format!("{name}: {}{unit}", shortest(a.value))
        });
        let place = at.fixed.iter().map(|(name, x)| {
            let unit = named(&finding.name).and_then(|e| e.place_unit(name)).unwrap_or_default();
            format!("{name}: {} {unit}", shortest(*x)).trim_end().to_owned()
        });
        let all: Vec<String> = strength.chain(place).collect();
        for (name, own) in at.strength.iter().filter(|(_, own)| !own.by_run.is_empty()) {
            let each = own.by_run.iter().map(|(run, x)| format!("{} {} in {run}", shortest(*x), own.unit));
            let _ = writeln!(out, "  // {name} of each run: {}", each.collect::<Vec<_>>().join(", "));
        }
        let _ = writeln!(out, "  effect {}({})", finding.name, all.join(", "));
    }
    out.push_str("}\n");
    out
}
