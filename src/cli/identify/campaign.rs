//! `lss identify CAMPAIGN`: every run, every law.

use super::{fitted, table};
use crate::base::{json, parallel};
use crate::chain_input::ContactLaw;
use crate::cli::cases::cases;
use crate::cli::progress::Line;
use crate::cli::{Outcome, OutputFormat, could_not, limits, report};
use crate::dynamics::Width;
use crate::emit::Files;
use crate::identify::cases::{Case, common_track};
use crate::identify::groups::{RunGroup, SetPoint};
use crate::identify::law_fits::LawFits;
use crate::identify::reports::{LawReport, Study, law_name, laws_named};
use crate::identify::share::Shared;
use crate::identify::study::{RunFit, fit_run};
use crate::identify::{Counter, FitSettings, Parameter};
use crate::report::identification;
use crate::source::shown;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[derive(Debug, clap::Args)]
pub struct Campaign {
    /// Folder of a campaign, its campaign.toml, or a single data file.
    #[arg(required = true)]
    campaign: Option<PathBuf>,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR", required = true)]
    output: Option<PathBuf>,
    /// Layout of all runs, .lss or simulation.json, instead of those that campaign and sidecars name.
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Damping law, or `all`.
    #[arg(long, value_name = "NAME", default_value = "herbert_mcwhannell", value_parser = laws)]
    law: Laws,
    /// Parameters to fit; all when not given. The others keep the layout's and the sidecar's values.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    free: Vec<Parameter>,
    /// Parameters that all runs have in common.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    share: Vec<Parameter>,
    /// Only say what the runs can tell of the parameters, without fitting them.
    #[arg(long)]
    identifiability: bool,
    /// Where in a pitch simulations start and which noise they get: another seed, another answer that is as good.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How the result is written to standard output: json is one object a line, a law each.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

/// Laws to fit, the first as it is, the others from it.
#[derive(Clone, Debug)]
struct Laws(Vec<ContactLaw>);

fn laws(text: &str) -> Result<Laws, String> {
    laws_named(text).map(Laws)
}

impl Campaign {
    pub fn run(&self) -> Outcome {
        let (Some(folder), Some(output)) = (&self.campaign, &self.output) else { return Outcome::CouldNotRun };
        if let Some(p) = self.share.iter().find(|p| !self.free.is_empty() && !self.free.contains(p)) {
            report::error(&format!("{p} cannot be shared, as it is not fitted: add it to --free"));
            return Outcome::CouldNotRun;
        }
        let (cases, broken) = match cases(folder, self.layout.as_deref()) {
            Ok(found) => found,
            Err(outcome) => return outcome,
        };
        if cases.is_empty() {
            report::error("no run is left to fit");
            return Outcome::Problems;
        }
        let threads = limits::threads();
        let free = std::array::from_fn(|k| self.free.is_empty() || self.free.contains(&Parameter::ALL[k]));
        let settings =
            FitSettings { free, seed: self.seed, threads: (threads / cases.len()).max(1), ..FitSettings::default() };
        if self.identifiability {
            return self.tell(&cases, &settings, threads, broken);
        }
        let begin = LawFits {
            law: self.law.0[0],
            settings,
            width: Width::used(),
            first: None,
            kept_in: Some(output),
            trusted: true,
        };
        let trusted = begin.confirmed(&cases);
        if !trusted {
            report::warning("a fit that was kept here comes out otherwise now: all fits are made anew");
        }
        let under_way = Arc::new(UnderWay::default());
        let watched = under_way.clone();
        let whole = (cases.len() * self.law.0.len()) as u64;
        let line = Line::watched(whole, "fits", move || watched.fits());
        let mut done: Vec<(ContactLaw, Vec<RunFit>, Vec<Shared>)> = Vec::new();
        let mut failed = broken;
        for &law in &self.law.0 {
            let first = done.first().map(|(_, fits, _)| fits.clone());
            let work = LawFits { law, first: first.as_deref(), trusted, ..begin };
            let results = parallel::map(&cases, threads, |case| {
                let fit = under_way.watch(|counter| work.fit(case, counter));
                line.step(|| format!("{}, {}", case.subject.name, law_name(law)));
                fit
            });
            let mut fits = Vec::new();
            for (case, result) in cases.iter().zip(results) {
                match result {
                    Ok(fit) => fits.push(fit),
                    Err(why) => {
                        failed = true;
                        report::error(&format!("{}, {}: {why}", case.subject.name, law_name(law)));
                    }
                }
            }
            let shared = match work.share(&cases, &mut fits, &self.share, threads) {
                Ok(shared) => shared,
                Err(why) => {
                    failed = true;
                    report::error(&why);
                    None
                }
            };
            done.push((law, fits, shared.into_iter().collect()));
        }
        line.finish();
        let points: Vec<SetPoint> = cases.iter().map(|case| case.set_point.clone()).collect();
        let groups = RunGroup::all(&points);
        let reports: Vec<LawReport> =
            done.iter().map(|(law, fits, shared)| LawReport::new(*law, fits, shared)).collect();
        let study = Study::new(&reports, &groups);
        let mut files = Files::default();
        for law in &reports {
            files.push(format!("{}.json", law.law), json::to_json(law));
        }
        files.push("identification.json", json::to_json(&study));
        let pages: Vec<(ContactLaw, &[RunFit])> = done.iter().map(|(law, fits, _)| (*law, fits.as_slice())).collect();
        files.push("identification.html", identification::page(&pages, &self.share, &groups, common_track(&cases)));
        if let Some((_, fits, _)) = done.first() {
            match fitted::files(&cases, &groups, fits, output) {
                Ok(more) => files.extend(more),
                Err(outcome) => return outcome,
            }
        }
        if let Err(error) = files.write_set(output, "identify") {
            return could_not("write", &error.path, &error.reason);
        }
        study.warnings().iter().for_each(|warning| report::warning(warning));
        report::print(&match self.format {
            OutputFormat::Json => {
                let line = |law: &LawReport| serde_json::to_string(law).unwrap_or_default() + "\n";
                reports.iter().map(line).collect::<String>()
            }
            OutputFormat::Text => format!("{}written to {}\n", table::text(&reports, &groups), shown(output)),
        });
        if failed { Outcome::Problems } else { Outcome::Clean }
    }

    /// What the runs can tell, before anything is fitted.
    fn tell(&self, cases: &[Case], settings: &FitSettings, threads: usize, broken: bool) -> Outcome {
        let settings = FitSettings { steps: 0, ..*settings };
        let law = self.law.0[0];
        let results = parallel::map(cases, threads, |case| {
            fit_run(&case.subject, law, None, &settings, (Width::used(), &Counter::default()), String::new())
        });
        let mut failed = broken;
        let mut text = String::new();
        for (case, result) in cases.iter().zip(results) {
            match result {
                Ok(fit) => text.push_str(&table::identifiability(&fit)),
                Err(why) => {
                    failed = true;
                    report::error(&format!("{}: {why}", case.subject.name));
                }
            }
        }
        report::print(&text);
        if failed { Outcome::Problems } else { Outcome::Clean }
    }
}

/// The fits that were begun: how much each has simulated, and whether it has ended.
#[derive(Default)]
struct UnderWay(Mutex<Vec<(Counter, bool)>>);

/// Simulations of a fit, until one has ended that made some.
const USUAL: f64 = 80.0;
/// Share of a fit that is done at most before it has ended, as some take more simulations than others.
const NEARLY: f64 = 0.9;

impl UnderWay {
    /// Does a fit, which counts its simulations.
    fn watch<T>(&self, fit: impl FnOnce(&Counter) -> T) -> T {
        let counter = Counter::default();
        let number = {
            let mut all = self.all();
            all.push((counter.clone(), false));
            all.len() - 1
        };
        let made = fit(&counter);
        if let Some((_, ended)) = self.all().get_mut(number) {
            *ended = true;
        }
        made
    }

    /// What is done of those that have not ended, in fits.
    fn fits(&self) -> f64 {
        let all = self.all();
        let made = |wanted: bool| {
            let of = all.iter().filter(move |(_, ended)| *ended == wanted);
            of.map(|(counter, _)| counter.effort().simulations as f64).filter(|made| *made > 0.0)
        };
        // Those that were kept or carried over made none.
        let (count, sum) = made(true).fold((0.0, 0.0), |(count, sum), made| (count + 1.0, sum + made));
        let each = if count > 0.0 { sum / count } else { USUAL };
        made(false).map(|made| (made / each).min(NEARLY)).sum()
    }

    fn all(&self) -> MutexGuard<'_, Vec<(Counter, bool)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_that_were_kept_say_nothing_of_how_long_others_take() {
        let fits = UnderWay::default();
        let simulate = |counter: &Counter, times: usize| (0..times).for_each(|_| counter.add(1.0));
        fits.watch(|counter| {
            simulate(counter, 40);
            assert_eq!(fits.fits(), 0.5, "of the usual number");
        });
        assert_eq!(fits.fits(), 0.0);
        fits.watch(|_| ());
        fits.watch(|counter| {
            simulate(counter, 10);
            assert_eq!(fits.fits(), 0.25, "of the first's");
            simulate(counter, 90);
            assert_eq!(fits.fits(), NEARLY);
        });
    }
}
