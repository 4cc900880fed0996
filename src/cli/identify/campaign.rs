//! `lss identify CAMPAIGN`: every run, every law.

use super::reports::{LawReport, Study};
use super::{fitted, table};
use crate::base::{json, parallel};
use crate::chain_input::{ContactLaw, Track};
use crate::cli::cases::{Case, cases};
use crate::cli::identify::reports::law_name;
use crate::cli::progress::Line;
use crate::cli::{Outcome, OutputFormat, could_not, limits, report};
use crate::dynamics::Width;
use crate::emit::Files;
use crate::identify::groups::{RunGroup, SetPoint};
use crate::identify::share::{Shared, combine};
use crate::identify::study::{self, RunFit, carry, fit_run};
use crate::identify::{FitSettings, Measured, Model, Parameter};
use crate::report::identification;
use crate::source::{SIZE_LIMIT, root, shown};
use clap::ValueEnum;
use std::path::{Path, PathBuf};

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
    if text == "all" {
        let mut all = vec![ContactLaw::default()];
        all.extend(ContactLaw::value_variants().iter().filter(|l| **l != ContactLaw::default()));
        return Ok(Laws(all));
    }
    ContactLaw::from_str(text, false).map(|law| Laws(vec![law])).map_err(|_| {
        let names: Vec<String> = ContactLaw::value_variants().iter().map(|l| law_name(*l)).collect();
        format!("there is no law {text}; take `all` or one of {}", names.join(", "))
    })
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
        let trusted =
            Work { output, law: self.law.0[0], settings, first: None, line: None, trusted: true }.confirmed(&cases);
        if !trusted {
            report::warning("a fit that was kept here comes out otherwise now: all fits are made anew");
        }
        let line = Line::steps((cases.len() * self.law.0.len()) as u64, "fits");
        let mut done: Vec<(ContactLaw, Vec<RunFit>, Vec<Shared>)> = Vec::new();
        let mut failed = broken;
        for &law in &self.law.0 {
            let first = done.first().map(|(_, fits, _)| fits.clone());
            let work = Work { output, law, settings, first: first.as_deref(), line: Some(&line), trusted };
            let results = parallel::map(&cases, threads, |case| work.fit(case));
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
        files.push("identification.html", identification::page(&pages, &self.share, &groups, common(&cases)));
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
            fit_run(&case.subject, law, None, &settings, Width::used(), String::new())
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

/// The fits of one law.
struct Work<'a> {
    output: &'a Path,
    law: ContactLaw,
    settings: FitSettings,
    /// Those of the first law.
    first: Option<&'a [RunFit]>,
    line: Option<&'a Line>,
    /// Whether fits that were kept may be used.
    trusted: bool,
}

/// How many kept fits are looked at again.
const ASKED_AGAIN: usize = 2;

impl Work<'_> {
    /// A run's fit: from the disk when it is there and nothing has changed, else made and kept.
    fn fit(&self, case: &Case) -> Result<RunFit, String> {
        let subject = &case.subject;
        let start = self.first.and_then(|fits| fits.iter().find(|f| f.run == subject.name));
        let carried = start.and_then(|from| carry(subject, from, self.law, &self.settings, Width::used()));
        let fit = match carried {
            Some(carried) => Ok(carried),
            None => {
                let held = start.map_or_else(String::new, |s| s.key.clone());
                let key = study::key(subject, self.law, &self.settings, &held);
                self.kept(&subject.name, &key, || {
                    // Within another law's bounds the run says what it said before: nothing is left to search.
                    let within = start.and_then(|s| study::within(subject, s, self.law, &self.settings, Width::used()));
                    if let Some(at) = within {
                        let settings = FitSettings { steps: 0, ..self.settings };
                        return fit_run(
                            subject,
                            self.law,
                            Some((self.law, &at)),
                            &settings,
                            Width::used(),
                            key.clone(),
                        );
                    }
                    let from = start.map(|s| (s.law, s.at()));
                    let from = from.as_ref().map(|(law, at)| (*law, at));
                    fit_run(subject, self.law, from, &self.settings, Width::used(), key.clone())
                })
            }
        };
        if let Some(line) = self.line {
            line.step(|| format!("{}, {}", subject.name, law_name(self.law)));
        }
        fit
    }

    fn folder(&self) -> PathBuf {
        self.output.join("fits").join(law_name(self.law))
    }

    /// A fit on the disk, if it came from the same.
    fn known(&self, name: &str, key: &str) -> Option<RunFit> {
        let bytes = root::read_given(&self.folder().join(format!("{name}.json")), SIZE_LIMIT).ok()?;
        let known: RunFit = serde_json::from_slice(&bytes).ok()?;
        (known.key == key && known.is_whole()).then_some(known)
    }

    /// Whether a few of the kept fits of the first law still are what this program would say.
    fn confirmed(&self, cases: &[Case]) -> bool {
        let known = cases.iter().filter_map(|case| {
            let key = study::key(&case.subject, self.law, &self.settings, "");
            Some((case, self.known(&case.subject.name, &key)?))
        });
        known.take(ASKED_AGAIN).all(|(case, fit)| study::is_confirmed(&case.subject, &fit, Width::used()))
    }

    fn kept(&self, name: &str, key: &str, make: impl FnOnce() -> Result<RunFit, String>) -> Result<RunFit, String> {
        let folder = self.folder();
        root::below(self.output, &folder).map_err(|why| format!("{}: {why}", shown(&folder)))?;
        if let Some(known) = self.known(name, key).filter(|_| self.trusted) {
            return Ok(known);
        }
        let made = make()?;
        let bytes = json::to_json(&made);
        let mut files = Files::default();
        files.push(format!("{name}.json"), bytes.as_slice());
        files.write(&folder).map_err(|error| error.to_string())?;
        // What was kept and what was made read the same.
        serde_json::from_slice(&bytes).map_err(|why| why.to_string())
    }

    /// Fits what is shared over all runs, and the rest of each run anew with it.
    fn share(
        &self,
        cases: &[Case],
        fits: &mut Vec<RunFit>,
        names: &[Parameter],
        threads: usize,
    ) -> Result<Option<Shared>, String> {
        if names.is_empty() || fits.is_empty() {
            return Ok(None);
        }
        let case_of = |fit: &RunFit| cases.iter().find(|c| c.subject.name == fit.run);
        let mut models = Vec::new();
        for fit in fits.iter() {
            let Some(case) = case_of(fit) else { continue };
            let lap = case.subject.simulation.chain.track_length_m;
            let measured = Measured::new(&case.subject.run, &case.subject.simulation, lap)?;
            models.push((Model::new(&case.subject.simulation, self.law, &measured, Width::used()), fit.fit()));
        }
        let pairs: Vec<_> = models.iter().map(|(model, fit)| (model, fit)).collect();
        let shared = combine(names, &pairs).ok_or("what the runs say of shared parameters cannot be combined")?;
        let settings = FitSettings {
            free: std::array::from_fn(|k| self.settings.free[k] && !names.contains(&Parameter::ALL[k])),
            ..self.settings
        };
        let again = parallel::map(fits, threads, |fit| {
            let case = case_of(fit).ok_or("the run is gone")?;
            let mut at = fit.at();
            for (p, x) in shared.parameters.iter().zip(&shared.at) {
                at[p.index()] = *x;
            }
            let key = study::key(&case.subject, self.law, &settings, &format!("{at:?}"));
            let name = format!("{}-shared", fit.run);
            self.kept(&name, &key, || {
                fit_run(&case.subject, self.law, Some((self.law, &at)), &settings, Width::used(), key.clone())
            })
        });
        *fits = again.into_iter().collect::<Result<_, String>>()?;
        Ok(Some(shared))
    }
}

/// The track of all runs, where they have one.
fn common(cases: &[Case]) -> Option<&Track> {
    let (first, rest) = cases.split_first()?;
    let track = &first.subject.simulation.track;
    rest.iter().all(|case| case.subject.simulation.track == *track).then_some(track)
}
