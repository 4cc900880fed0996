//! The noise found again: what the nominal model leaves may swing by a misfit, so once a best hypothesis is known, noise
//! is what that one leaves.

use super::fit::{FittedPart, Reference};
use super::{Error, Outside, Rows};
use crate::gap::{Applied, Diagnosis, Finding, Frame, PerRun};
use std::collections::BTreeMap;

impl Outside {
    /// The same model and runs with the noise that the best hypothesis of a diagnosis leaves; `None` where that is about
    /// the noise that was counted, or cannot be simulated.
    ///
    /// # Errors
    ///
    /// As those of [`Outside::open`], where the nominal model was simulated before and cannot be any more.
    pub fn anew(&self, found: &Diagnosis) -> Result<Option<Outside>, Error> {
        let best = self.best(found);
        if best.is_empty() {
            return Ok(None);
        }
        let Some(with) = self.with(&best) else { return Ok(None) };
        let mut next = self.bare();
        for ((part, at), with) in self.parts.iter().zip(&self.fitted).zip(with) {
            let reference = Reference { rows: with.rows };
            let fitted = self.fit(part, &[], Some(at), Some(&reference)).map_err(|error| error.in_run(&part.name))?;
            next.keep(part.clone(), fitted);
            next.references.push(reference.rows);
        }
        let changed = self.frames.iter().zip(&next.frames).any(|(before, after)| {
            let same = before.labels == after.labels;
            let ratio = noise(after) / noise(before);
            let about = 1.0 / self.settings.noise.anew..self.settings.noise.anew;
            !same || !about.contains(&ratio)
        });
        Ok(changed.then_some(next))
    }

    /// The same with other accuracies, by a factor.
    ///
    /// # Errors
    ///
    /// As those of [`Outside::anew`].
    pub fn with_accuracy(&self, factor: f64) -> Result<Outside, Error> {
        let mut next = Outside { accuracy: factor, references: self.references.clone(), ..self.bare() };
        for (k, (part, at)) in self.parts.iter().zip(&self.fitted).enumerate() {
            let reference = self.references.get(k).map(|rows| Reference { rows: rows.clone() });
            let fitted = next.fit(part, &[], Some(at), reference.as_ref()).map_err(|error| error.in_run(&part.name))?;
            next.keep(part.clone(), fitted);
        }
        Ok(next)
    }

    /// How closely the model is believed to follow each channel, in the first run.
    pub fn accuracies(&self) -> BTreeMap<String, f64> {
        let Some(frame) = self.frames.first() else { return BTreeMap::new() };
        let of = |channel: &String| {
            let own = frame.labels.iter().position(|label| label.channel == *channel)?;
            let most = frame.discrepancies.iter().filter_map(|d| d.get(own)).fold(0.0, |a: f64, x| a.max(*x));
            Some((channel.clone(), crate::base::number::tidy(most)))
        };
        self.names.iter().filter_map(of).collect()
    }

    /// Whether the accuracies make so much of the repeatability that a verdict may hang on them.
    pub fn hangs_on_accuracy(&self) -> bool {
        let accuracies = self.accuracies();
        let mut squares: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
        for (label, variance) in self.frames.iter().flat_map(|f| f.labels.iter().zip(&f.laps.variance)) {
            if variance.is_finite() {
                let sum = squares.entry(&label.channel).or_default();
                *sum = (sum.0 + variance, sum.1 + 1.0);
            }
        }
        let share = |(channel, (sum, n)): (&str, (f64, f64))| {
            accuracies.get(channel).map_or(0.0, |x| x * x / (sum / n).max(1e-300))
        };
        squares.into_iter().map(share).fold(0.0, f64::max) > self.settings.noise.accuracy_share
    }

    /// The effects that a diagnosis shows, or the likeliest one, with their strengths.
    pub(super) fn best(&self, found: &Diagnosis) -> Vec<Applied> {
        let shown = found.with();
        let some: Vec<&Finding> = if shown.is_empty() { found.effects.iter().take(1).collect() } else { shown };
        let applied = |finding: &Finding| {
            let own = self.description.effects.with_ids();
            let mut own = own.filter(|(_, c)| c.effect == finding.name && c.place == finding.place);
            let (candidate, effect) = own.next()?;
            let strength = |name: &String| finding.strength.get(name).map_or(0.0, |amount| amount.value);
            let strengths: Vec<f64> = effect.strengths.iter().map(|s| strength(&s.name)).collect();
            strengths.iter().any(|x| *x != 0.0).then_some(Applied { candidate, strengths })
        };
        some.into_iter().filter_map(applied).collect()
    }

    /// All parts fitted with effects; `None` where one of them cannot be simulated so.
    pub(super) fn with(&self, effects: &[Applied]) -> Option<Vec<FittedPart>> {
        let at = match self.has_shared() {
            true => self.fit_jointly(effects, self.fitted.to_vec(), self.settings.fitting.along_enough).ok()?.at,
            false => self.fitted.to_vec(),
        };
        let each = self.parts.iter().zip(&at);
        let fitted: Vec<FittedPart> =
            each.map(|(part, at)| self.fit(part, effects, Some(at), None).ok()).collect::<Option<_>>()?;
        if self.has_shared() {
            return Some(fitted);
        }
        let starts = self.starts(fitted.iter().map(|part| &part.at));
        let again = self.parts.iter().zip(fitted);
        Some(again.map(|(part, fitted)| self.restarted(part, effects, fitted, &starts)).collect())
    }

    /// The same runs with the shared nuisances at what fits all of them, which single runs leave there.
    pub(super) fn with_shared(self) -> Result<Outside, Error> {
        let begin = self.at_mean(&self.fitted);
        let told = |error: Error| error.in_run("all runs");
        let joint = self.fit_jointly(&[], begin, self.settings.fitting.enough).map_err(told)?;
        let mut next = Outside { held: self.shared(), ..self.bare() };
        for (part, at) in self.parts.iter().zip(&joint.at) {
            let fitted = next.fit(part, &[], Some(at), None).map_err(|error| error.in_run(&part.name))?;
            next.keep(part.clone(), fitted);
        }
        Ok(next)
    }

    /// Which nuisances are fitted to each run.
    pub(super) fn free(&self) -> Vec<usize> {
        (0..self.held.len()).filter(|k| !self.held[*k]).collect()
    }

    /// The same program and campaign without runs.
    fn bare(&self) -> Outside {
        Outside {
            pool: self.pool.clone(),
            description: self.description.clone(),
            channels: self.channels.clone(),
            names: self.names.clone(),
            parts: PerRun::default(),
            windows: PerRun::default(),
            fitted: PerRun::default(),
            frames: PerRun::default(),
            rows: PerRun::<Rows>::default(),
            lost: Vec::new(),
            origin: self.origin.clone(),
            counter: self.counter.clone(),
            failed: std::sync::Mutex::default(),
            settings: self.settings.clone(),
            may_lack: self.may_lack,
            held: self.held.clone(),
            joint: std::sync::Mutex::default(),
            slopes: std::sync::Mutex::default(),
            accuracy: self.accuracy,
            references: Vec::new(),
            remarks: self.remarks.clone(),
            random: self.random,
        }
    }
}

/// Root of the mean logarithm of the features' variances, by channel: the ratio of two does not hang on units.
fn noise(frame: &Frame) -> f64 {
    let mut logs: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for (label, variance) in frame.labels.iter().zip(&frame.laps.variance) {
        if variance.is_finite() && *variance > 0.0 {
            let sum = logs.entry(&label.channel).or_default();
            *sum = (sum.0 + crate::base::trig::ln(*variance), sum.1 + 1.0);
        }
    }
    let mean = logs.values().map(|(sum, n)| sum / n).sum::<f64>() / logs.len().max(1) as f64;
    crate::base::trig::exp(0.5 * mean)
}
