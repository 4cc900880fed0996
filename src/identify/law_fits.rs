//! The fits of a campaign's runs in one law: each run on its own, then what all of them share. Fits may be kept on the
//! disk, so that a study that was stopped goes on where it was.

use super::cases::Case;
use super::reports::law_name;
use super::share::{Shared, combine};
use super::study::{self, RunFit, carry, fit_run};
use super::{Counter, FitSettings, Measured, Model, Parameter};
use crate::base::{json, parallel};
use crate::chain_input::ContactLaw;
use crate::dynamics::Width;
use crate::source::disk::Files;
use crate::source::{SIZE_LIMIT, root, shown};
use std::path::{Path, PathBuf};

/// How the runs of a campaign are fitted in one law.
pub struct LawFits<'a> {
    pub law: ContactLaw,
    pub settings: FitSettings,
    pub width: Width,
    /// Those of the first law.
    pub first: Option<&'a [RunFit]>,
    /// The folder of outputs in which fits are kept.
    pub kept_in: Option<&'a Path>,
    /// Whether fits that were kept may be used.
    pub trusted: bool,
}

/// How many kept fits are looked at again.
const ASKED_AGAIN: usize = 2;

impl LawFits<'_> {
    /// A run's fit: from the disk when it is there and nothing has changed, else made and kept. What is simulated is counted.
    ///
    /// # Errors
    ///
    /// In words.
    pub fn fit(&self, case: &Case, counter: &Counter) -> Result<RunFit, String> {
        let (subject, width) = (&case.subject, self.width);
        let start = self.first.and_then(|fits| fits.iter().find(|f| f.run == subject.name));
        if let Some(carried) = start.and_then(|from| carry(subject, from, self.law, &self.settings, width)) {
            return Ok(carried);
        }
        let held = start.map_or_else(String::new, |s| s.key.clone());
        let key = study::key(subject, self.law, &self.settings, &held);
        self.kept(&subject.name, &key, || {
            // Within another law's bounds the run says what it said before: nothing is left to search.
            let within = start.and_then(|s| study::within(subject, s, self.law, &self.settings, width));
            if let Some(at) = within {
                let settings = FitSettings { steps: 0, ..self.settings };
                return fit_run(subject, self.law, Some((self.law, &at)), &settings, (width, counter), key.clone());
            }
            let from = start.map(|s| (s.law, s.at()));
            let from = from.as_ref().map(|(law, at)| (*law, at));
            fit_run(subject, self.law, from, &self.settings, (width, counter), key.clone())
        })
    }

    fn folder(&self) -> Option<PathBuf> {
        self.kept_in.map(|output| output.join("fits").join(law_name(self.law)))
    }

    /// A fit on the disk, if it came from the same.
    fn known(&self, name: &str, key: &str) -> Option<RunFit> {
        let bytes = root::read_given(&self.folder()?.join(format!("{name}.json")), SIZE_LIMIT).ok()?;
        let known: RunFit = serde_json::from_slice(&bytes).ok()?;
        (known.key == key && known.is_whole()).then_some(known)
    }

    /// Whether a few of the kept fits still are what this program would say.
    pub fn confirmed(&self, cases: &[Case]) -> bool {
        let known = cases.iter().filter_map(|case| {
            let key = study::key(&case.subject, self.law, &self.settings, "");
            Some((case, self.known(&case.subject.name, &key)?))
        });
        known.take(ASKED_AGAIN).all(|(case, fit)| study::is_confirmed(&case.subject, &fit, self.width))
    }

    fn kept(&self, name: &str, key: &str, make: impl FnOnce() -> Result<RunFit, String>) -> Result<RunFit, String> {
        let (Some(output), Some(folder)) = (self.kept_in, self.folder()) else { return make() };
        root::below(output, &folder).map_err(|why| format!("{}: {why}", shown(&folder)))?;
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
    ///
    /// # Errors
    ///
    /// In words.
    pub fn share(
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
            models.push((Model::new(&case.subject.simulation, self.law, &measured, self.width), fit.fit()));
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
                fit_run(
                    &case.subject,
                    self.law,
                    Some((self.law, &at)),
                    &settings,
                    (self.width, &Counter::default()),
                    key.clone(),
                )
            })
        });
        *fits = again.into_iter().collect::<Result<_, String>>()?;
        Ok(Some(shared))
    }
}
