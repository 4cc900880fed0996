//! What is told beside a verdict: the error of single samples before and after, and the nuisances with their intervals.

use super::fit::{self, FittedPart, left};
use super::model_error::{fast, unpredicted};
use super::protocol::Nuisance;
use super::shared::Joint;
use super::windows::Kind;
use super::{Outside, Rows};
use crate::base::number::{significant, tidy};
use crate::gap::{Amount, Bound, Diagnosis, OutsideModel, SampleError};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Of a normal distribution's 90 %, in deviations to one side.
const NINETY: f64 = 1.644_854;

/// A nuisance of a run.
struct Own {
    run: String,
    value: f64,
    deviation: f64,
    /// Values by which stretches of the run would fit best.
    within: Vec<f64>,
    /// Their deviations.
    uncertain: Vec<f64>,
}

/// A nuisance that is another elsewhere.
struct Drift {
    /// Within a run, or from run to run.
    within: bool,
    /// By how much of itself.
    size: f64,
    words: String,
}

impl Outside {
    /// What is known beside a diagnosis of these runs.
    pub fn told(&self, found: &Diagnosis) -> OutsideModel {
        let shown = if found.shown.is_empty() { Vec::new() } else { self.best(found) };
        let with = self.with(&shown);
        let nominal: Vec<&Rows> = self.rows.iter().collect();
        let rows: Vec<&Rows> = match &with {
            Some(with) => with.iter().map(|part| &part.rows).collect(),
            None => nominal.clone(),
        };
        let sample_error = self.sample_errors(&nominal, &rows);
        let mut out = OutsideModel { sample_error, remarks: self.remarks.clone(), ..OutsideModel::default() };
        let mut drifts: Vec<Drift> = Vec::new();
        let enough = self.settings.fitting.along_enough;
        let joint = self.has_shared().then(|| self.fit_jointly(&shown, self.fitted.to_vec(), enough).ok()).flatten();
        for (k, nuisance) in self.description.nuisances.iter().enumerate() {
            if nuisance.shared {
                let own = self.shared_amount(k, &joint);
                own.into_iter().for_each(|amount| {
                    let all = out.nuisances.entry("all runs".to_owned()).or_default();
                    all.insert(nuisance.name.clone(), amount);
                });
                continue;
            }
            let each = self.parts.iter().zip(with.iter().flatten());
            let own: Vec<Own> = each.map(|(part, fitted)| self.own(&part.name, fitted, k)).collect();
            for one in &own {
                let amount = amount(nuisance, one.value, one.deviation);
                out.nuisances.entry(one.run.clone()).or_default().insert(nuisance.name.clone(), amount);
            }
            drifts.extend(self.drift(&nuisance.name, &nuisance.unit, &own));
        }
        // What drifts most; a gap that is left moves the others along.
        for within in [true, false] {
            let own = drifts.iter().filter(|d| d.within == within);
            out.remarks.extend(own.max_by(|a, b| a.size.total_cmp(&b.size)).map(|d| d.words.clone()));
        }
        out
    }

    /// A nuisance that all runs share.
    fn shared_amount(&self, k: usize, joint: &Option<Joint>) -> Option<Amount> {
        let nuisance = &self.description.nuisances[k];
        let joint = joint.as_ref()?;
        let value = fit::value(nuisance, *joint.at.first()?.get(k)?);
        Some(amount(nuisance, value, (nuisance.high - nuisance.low) * joint.deviation[k]))
    }

    fn sample_errors(&self, before: &[&Rows], after: &[&Rows]) -> BTreeMap<String, SampleError> {
        let of = |c: usize, rows: &[&Rows]| {
            let each = self.parts.iter().zip(rows).map(|(part, rows)| {
                let left = part.channels[c].iter().zip(&rows[c]).map(|(m, s)| m - s);
                left.collect::<Vec<f64>>()
            });
            root_mean_square(each.flatten())
        };
        let noise = |c: usize| {
            let each = self.parts.iter().zip(after).zip(&self.windows).map(|((part, rows), windows)| {
                let noise = unpredicted(&left(part, rows), rows, &self.settings.model_error);
                match windows.kind {
                    Kind::Means => windows.within(&noise[c]).sqrt(),
                    Kind::Samples => {
                        let fast = fast(&noise[c], part.time.len() / self.settings.noise.slow);
                        root_mean_square(fast.into_iter())
                    }
                }
            });
            root_mean_square(each)
        };
        let compared = self.windows.first().map_or("", |windows| windows.kind.words());
        let error = |(c, (name, unit)): (usize, (&String, &String))| {
            let error = SampleError {
                before: tidy(of(c, before)),
                after: tidy(of(c, after)),
                noise: tidy(noise(c)),
                unit: unit.clone(),
                compared: compared.to_owned(),
            };
            (name.clone(), error)
        };
        self.channels.iter().enumerate().map(error).collect()
    }

    /// A nuisance of a fitted part, and where stretches of it would have it.
    fn own(&self, run: &str, fitted: &FittedPart, k: usize) -> Own {
        let nuisance = &self.description.nuisances[k];
        let range = nuisance.high - nuisance.low;
        let weights: Vec<f64> = fitted
            .measured
            .iter()
            .zip(&fitted.nominal)
            .zip(&fitted.repeatability.variance)
            .map(|((m, s), v)| if (m - s).is_finite() && *v > 0.0 { 1.0 / v } else { 0.0 })
            .collect();
        let count = fitted.windows.count();
        let parts = self.settings.fitting.stretches.max(1);
        // All channels of a stretch in time.
        let stretch = |q: usize| move |i: usize| (i % count) * parts / count.max(1) == q;
        let whole = solved(fitted, &weights, &|_| true, k);
        let each: Vec<(f64, f64)> = (0..parts).map(|q| solved(fitted, &weights, &stretch(q), k)).collect();
        Own {
            run: run.to_owned(),
            value: fit::value(nuisance, fitted.at[k]),
            deviation: range * whole.1,
            within: each.iter().map(|(by, _)| fit::value(nuisance, fitted.at[k] + by)).collect(),
            uncertain: each.iter().map(|(_, deviation)| range * deviation).collect(),
        }
    }

    /// A sentence where a nuisance is another in other runs or in other stretches of one, by more than its noise.
    fn drift(&self, name: &str, unit: &str, own: &[Own]) -> Option<Drift> {
        let settings = &self.settings.fitting;
        let said = |x: f64| format!("{} {unit}", significant(x, 3)).trim_end().to_owned();
        let apart = |x: &[(f64, f64)]| {
            let least = x.iter().copied().reduce(|a, b| if b.0 < a.0 { b } else { a })?;
            let most = x.iter().copied().reduce(|a, b| if b.0 > a.0 { b } else { a })?;
            let noise = (least.1 * least.1 + most.1 * most.1).sqrt();
            let size = least.0.abs().max(most.0.abs());
            let clear = most.0 - least.0 > settings.drift * noise && most.0 - least.0 > settings.drift_share * size;
            clear.then_some((most.0 - least.0) / size)
        };
        let within = own.iter().find_map(|o| {
            let each: Vec<(f64, f64)> = o.within.iter().copied().zip(o.uncertain.iter().copied()).collect();
            Some((o, apart(&each)?))
        });
        if let Some((o, size)) = within {
            let each: Vec<String> = o.within.iter().map(|x| said(*x)).collect();
            let words = format!(
                "The nuisance {name} drifts within run {}: successive stretches ask for {}. A parameter that drifts is \
                 itself a gap: list its drift as an effect, or split the run.",
                o.run,
                each.join(", ")
            );
            return Some(Drift { within: true, size, words });
        }
        let each: Vec<(f64, f64)> = own.iter().map(|o| (o.value, o.deviation)).collect();
        let size = apart(&each)?;
        let each: Vec<String> = own.iter().map(|o| format!("{} in {}", said(o.value), o.run)).collect();
        let words = format!(
            "The nuisance {name} differs between the runs by more than its noise: {}. If nothing was changed between \
             them, it hides a gap.",
            each.join(", ")
        );
        Some(Drift { within: false, size, words })
    }
}

fn amount(nuisance: &Nuisance, value: f64, deviation: f64) -> Amount {
    let at = |x: f64| x.clamp(nuisance.low, nuisance.high);
    let at_bound = match value {
        x if x <= nuisance.low => Some(Bound::Lower),
        x if x >= nuisance.high => Some(Bound::Upper),
        _ => None,
    };
    Amount {
        value: tidy(value),
        low: tidy(at(value - NINETY * deviation)),
        high: tidy(at(value + NINETY * deviation)),
        unit: nuisance.unit.clone(),
        at_bound,
        by_run: BTreeMap::new(),
    }
}

/// The step of a nuisance that some features ask for, with all others free, and its deviation; in shares of its range.
fn solved(fitted: &FittedPart, weights: &[f64], some: &dyn Fn(usize) -> bool, k: usize) -> (f64, f64) {
    let n = fitted.at.len();
    // The prior is as wide as the range.
    let (mut a, mut g) = (DMatrix::<f64>::identity(n, n), DVector::<f64>::zeros(n));
    for (i, weight) in weights.iter().enumerate().filter(|(i, w)| **w > 0.0 && some(*i)) {
        let row = fitted.slopes.row(i);
        a += row.transpose() * row * *weight;
        g += row.transpose() * ((fitted.measured[i] - fitted.nominal[i]) * weight);
    }
    match a.try_inverse() {
        Some(inverse) => ((&inverse * g)[k], inverse[(k, k)].max(0.0).sqrt()),
        None => (0.0, f64::INFINITY),
    }
}

/// Of what is finite; 0 where nothing is.
pub(super) fn root_mean_square(x: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for x in x.filter(|x| x.is_finite()) {
        (sum, count) = (sum + x * x, count + 1.0);
    }
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}
