//! What fits amount to: a law's runs one by one, and the study in summary, by set point.

use super::groups::{RunGroup, quartiles};
use super::lack_of_fit::{Warning, at_bounds, warning};
use super::share::Shared;
use super::study::{CONFIDENCE, Estimate, RunFit};
use super::{Parameter, interval};
use crate::base::number::tidy;
use crate::chain_input::ContactLaw;
use clap::ValueEnum;
use serde::Serialize;
use std::collections::BTreeMap;

/// What a law's fits amount to: the interface of `--format json`.
#[derive(Serialize)]
pub struct LawReport<'a> {
    pub law: String,
    /// Root mean square over runs.
    pub objective: f64,
    pub shared: BTreeMap<String, Estimate>,
    pub runs: BTreeMap<&'a str, &'a RunFit>,
}

impl<'a> LawReport<'a> {
    pub fn new(law: ContactLaw, fits: &'a [RunFit], shared: &[Shared]) -> LawReport<'a> {
        let squares: f64 = fits.iter().map(|f| f.objective * f.objective).sum();
        let mut estimates = BTreeMap::new();
        for shared in shared {
            for (i, p) in shared.parameters.iter().enumerate() {
                // Every run keeps the shared value, so any of them has it.
                let Some(own) = fits.first().and_then(|f| f.parameters.get(p.name())) else { continue };
                let bounds = p.bounds(own.value);
                let (a, b) =
                    interval(shared.at[i], shared.deviation[i], (f64::NEG_INFINITY, f64::INFINITY), CONFIDENCE);
                let value = |x: f64| p.value(law, x, if p.is_restitution() { bounds } else { (f64::MIN, f64::MAX) });
                let (a, b) = (value(a), value(b));
                let at_bound = shared.bound[i] != 0;
                estimates.insert(
                    p.name().to_owned(),
                    Estimate { value: own.value, low: a.min(b), high: a.max(b), at_bound, fitted: true },
                );
            }
        }
        LawReport {
            law: law_name(law),
            objective: crate::base::number::tidy((squares / fits.len().max(1) as f64).sqrt()),
            shared: estimates,
            runs: fits.iter().map(|f| (f.run.as_str(), f)).collect(),
        }
    }

    /// The fits of a group's runs.
    pub fn of<'b>(&'b self, group: &'b RunGroup) -> impl Iterator<Item = &'a RunFit> + 'b {
        self.runs.values().copied().filter(|fit| group.has(&fit.run))
    }
}

/// The study in summary: `identification.json`.
#[derive(Serialize)]
pub struct Study {
    laws: BTreeMap<String, LawSummary>,
    /// The law that was fitted first.
    first: String,
}

#[derive(Serialize)]
struct LawSummary {
    /// Root mean square over all runs.
    objective: f64,
    /// By layout, speed and tension, which no statistic mixes.
    groups: Vec<GroupSummary>,
    warnings: Vec<Warning>,
}

#[derive(Serialize)]
struct GroupSummary {
    #[serde(flatten)]
    group: RunGroup,
    /// Of these runs, those that the model does not fit.
    do_not_fit: Vec<String>,
    objective: Spread,
    parameters: BTreeMap<&'static str, Spread>,
}

/// A value over the runs of a group.
#[derive(Serialize)]
struct Spread {
    median: f64,
    lower_quartile: f64,
    upper_quartile: f64,
    /// Runs in which it is at a bound.
    at_bound: usize,
}

impl Spread {
    fn new(values: impl Iterator<Item = f64>, at_bound: usize) -> Spread {
        let [lower_quartile, median, upper_quartile] = quartiles(values).map(tidy);
        Spread { median, lower_quartile, upper_quartile, at_bound }
    }
}

impl GroupSummary {
    fn new(law: &LawReport, group: &RunGroup) -> GroupSummary {
        let parameter = |p: Parameter| {
            let values = law.of(group).filter_map(|fit| fit.parameters.get(p.name())).map(|e| e.value);
            let held = law.of(group).filter(|fit| at_bounds(fit).contains(&p.name())).count();
            (p.name(), Spread::new(values, held))
        };
        GroupSummary {
            group: group.clone(),
            do_not_fit: law.of(group).filter(|fit| !fit.fits()).map(|fit| fit.run.clone()).collect(),
            objective: Spread::new(law.of(group).map(|fit| fit.objective), 0),
            parameters: Parameter::ALL.into_iter().map(parameter).collect(),
        }
    }
}

impl Study {
    pub fn new(laws: &[LawReport], groups: &[RunGroup]) -> Study {
        let summary = |law: &LawReport| {
            let with_fits = groups.iter().filter(|group| law.of(group).next().is_some());
            let summary = LawSummary {
                objective: law.objective,
                groups: with_fits.map(|group| GroupSummary::new(law, group)).collect(),
                warnings: law.runs.values().filter_map(|fit| warning(fit)).collect(),
            };
            (law.law.clone(), summary)
        };
        let first = laws.first().map_or_else(String::new, |law| law.law.clone());
        Study { laws: laws.iter().map(summary).collect(), first }
    }

    /// Warnings of the first law one by one, of the others how many there are.
    pub fn warnings(&self) -> Vec<String> {
        let mut said = Vec::new();
        if let Some(first) = self.laws.get(&self.first) {
            said.extend(first.warnings.iter().map(|w| format!("{}, {}: {}", w.run, self.first, w.lines())));
        }
        for (name, law) in self.laws.iter().filter(|(name, law)| **name != self.first && !law.warnings.is_empty()) {
            let runs: usize = law.groups.iter().map(|group| group.group.runs.len()).sum();
            said.push(format!(
                "{name}: of {runs} {} {} not fitted or at a bound; identification.json says which",
                if runs == 1 { "run" } else { "runs" },
                law.warnings.len()
            ));
        }
        said
    }
}

/// A law as files and options call it.
pub fn law_name(law: ContactLaw) -> String {
    law.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())
}

/// The law of a name, or of `all` each of them, the default one first.
///
/// # Errors
/// In words with the names that there are.
pub fn laws_named(text: &str) -> Result<Vec<ContactLaw>, String> {
    let every = || {
        let others = ContactLaw::value_variants().iter().copied().filter(|law| *law != ContactLaw::default());
        std::iter::once(ContactLaw::default()).chain(others)
    };
    if text == "all" {
        return Ok(every().collect());
    }
    match every().find(|law| law_name(*law) == text) {
        Some(law) => Ok(vec![law]),
        None => {
            let names: Vec<String> = ContactLaw::value_variants().iter().map(|law| law_name(*law)).collect();
            Err(format!("there is no law {text}; take `all` or one of {}", names.join(", ")))
        }
    }
}
