//! Fits that grow with the run. Where a channel oscillates, a phase that is off by more than half a period has no way
//! downhill, and a fit to the whole of a long run stays far off. On its beginning the phase is near, and what fits there
//! is near for a longer stretch (as in multiple shooting; Bock 1981).

use super::data::RunPart;
use super::fit::{FittedPart, left};
use super::shared::{self, Joint};
use super::{Error, Outside};
use crate::gap::{Applied, Frame};
use std::collections::BTreeMap;

impl Outside {
    /// A part fitted to growing stretches from its beginning on, if a fit to the whole went astray and that leaves less.
    pub(super) fn grown(&self, part: &RunPart, effects: &[Applied], fitted: FittedPart) -> FittedPart {
        if !self.went_astray(part, &fitted) {
            return fitted;
        }
        let mut at = self.nominal_start();
        for share in self.settings.fitting.stretching {
            let first = part.first(share);
            // What is too short or was not measured tells nothing.
            if let Ok(fit) = self.fit(&first, effects, Some(&at), None) {
                at = fit.at;
            }
        }
        let grown = self.fit(part, effects, Some(&at), None).ok();
        fitted.or(grown, part)
    }

    /// All runs fitted together in that way.
    pub(super) fn grown_jointly(
        &self,
        effects: &[Applied],
        joint: Joint,
        begin: Vec<Vec<f64>>,
        enough: f64,
    ) -> Result<Joint, Error> {
        let mut at = begin;
        for share in self.settings.fitting.stretching {
            at = self.fit_until(share, effects, at, enough)?.at;
        }
        let grown = self.fit_until(1.0, effects, at, enough)?;
        Ok(if grown.cost < joint.cost { grown } else { joint })
    }

    /// Whether so much is left that the fit looks astray; with effects, more than the nominal model leaves, too.
    pub(super) fn went_astray_jointly(&self, effects: &[Applied], joint: &Joint) -> bool {
        let each = self.frames.iter().zip(&joint.features);
        let most = each.map(|(frame, features)| unexplained_features(frame, features)).fold(0.0, f64::max);
        let nominal = || self.frames.iter().map(|frame| shared::left(frame, &frame.nominal, 1.0).norm_squared()).sum();
        most > self.settings.fitting.astray && (effects.is_empty() || joint.cost > nominal())
    }

    fn went_astray(&self, part: &RunPart, fitted: &FittedPart) -> bool {
        let settings = &self.settings.fitting;
        let left = left(part, &fitted.rows);
        fitted.mean_square() >= settings.restart && unexplained(part, &left) > settings.astray
    }
}

/// Share of a channel's squares about their mean that is left, of the channel where it is largest.
fn unexplained(part: &RunPart, left: &[Vec<f64>]) -> f64 {
    let of = |(measured, left): (&Vec<f64>, &Vec<f64>)| share(measured.iter().copied().zip(left.iter().copied()));
    part.channels.iter().zip(left).map(of).fold(0.0, f64::max)
}

/// The same of features.
fn unexplained_features(frame: &Frame, features: &[f64]) -> f64 {
    let mut channels: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for ((label, measured), simulated) in frame.labels.iter().zip(&frame.measured).zip(features) {
        channels.entry(&label.channel).or_default().push((*measured, measured - simulated));
    }
    channels.into_values().map(|pairs| share(pairs.into_iter())).fold(0.0, f64::max)
}

/// Squares of what is left over those of what was measured about its mean.
fn share(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let known: Vec<(f64, f64)> = pairs.filter(|(measured, left)| (measured - left).is_finite()).collect();
    let mean = known.iter().map(|(m, _)| m).sum::<f64>() / known.len().max(1) as f64;
    let moved: f64 = known.iter().map(|(m, _)| (m - mean) * (m - mean)).sum();
    let left: f64 = known.iter().map(|(_, l)| l * l).sum();
    if moved > 0.0 { left / moved } else { 0.0 }
}
