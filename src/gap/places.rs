//! Where a gap lies, and what is left of it.

use super::comparison::Comparison;
use super::diagnosis::{Extent, GapPlace, RunGap, Unexplained};
use super::ids::RunId;
use super::scored::Scored;
use super::simulator::{Axis, Band};
use crate::base::number::tidy;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// Where the gap lies: of each channel and band, stretches of neighbouring features with their share of all that is
/// over the repeatability.
///
/// With the verdict's effects known, nuisances are where these put them; else where the nominal model does.
pub fn places(comparison: &Comparison, shown: Option<&Scored>, axis: Axis) -> Vec<GapPlace> {
    let of = |run: RunId| match shown {
        Some(j) => {
            let observation = &j.observations(&comparison.observations)[run];
            &j.residuals()[run] + observation.long(&j.fitted.changes[run])
        }
        None => comparison.observations[run].residual.clone(),
    };
    stretches(comparison, shown, &of, axis)
}

/// What a hypothesis leaves, and where; nothing lies anywhere where it leaves no run over its limit.
pub fn unexplained(comparison: &Comparison, shown: Option<&Scored>, runs: &[RunGap], axis: Axis) -> Unexplained {
    let worst = runs.iter().max_by(|a, b| (a.after / a.replicate_high).total_cmp(&(b.after / b.replicate_high)));
    let beyond = |of: fn(&RunGap) -> f64| runs.iter().map(|run| (of(run) - 1.0).max(0.0)).sum::<f64>();
    let of = |run: RunId| match shown {
        Some(j) => j.residuals()[run].clone(),
        None => comparison.observations[run].residual.clone(),
    };
    let left = runs.iter().any(|run| !run.settled());
    Unexplained {
        share: runs.iter().any(RunGap::over).then(|| tidy(beyond(|run| run.after) / beyond(|run| run.before))),
        times_repeatability: worst.map_or(1.0, |run| run.after),
        run: worst.map_or_else(String::new, |run| run.run.clone()),
        places: if left { stretches(comparison, shown, &of, axis) } else { Vec::new() },
    }
}

/// Stretches of neighbouring features with their share of all that residuals are over the repeatability.
fn stretches(
    comparison: &Comparison,
    shown: Option<&Scored>,
    residual: &dyn Fn(RunId) -> DVector<f64>,
    axis: Axis,
) -> Vec<GapPlace> {
    let mut mean_square: BTreeMap<(String, Band, i64, i64), f64> = BTreeMap::new();
    let mut total = 0.0;
    for (run, frame) in comparison.simulator.frames().with_ids() {
        let observation = &shown.map_or(&comparison.observations, |j| j.observations(&comparison.observations))[run];
        for (k, x) in observation.each(&residual(run)) {
            let label = &frame.labels[k];
            let over = (x * x / observation.replicate - 1.0).max(0.0);
            total += over;
            *mean_square.entry((label.channel.clone(), label.band, label.from, label.to)).or_default() += over;
        }
    }
    let mut found: Vec<GapPlace> = Vec::new();
    let mut last: Option<(String, Band)> = None;
    let mean = total / mean_square.len().max(1) as f64;
    for ((channel, band, from, to), over) in mean_square {
        let place = GapPlace {
            extent: Extent::new(axis, tidy(from as f64 / 1e3), tidy(to as f64 / 1e3)),
            band: band.name().to_owned(),
            share: over / total.max(1e-12),
            channel: channel.clone(),
        };
        let key = (channel, band);
        // A stretch goes on while the gap is more than the usual.
        match found.last_mut() {
            Some(open)
                if last.as_ref() == Some(&key)
                    && (open.extent.ends().1 - place.extent.ends().0).abs() < 1e-6
                    && (over > mean) == (open.share * total > mean) =>
            {
                open.extent = Extent::new(axis, open.extent.ends().0, place.extent.ends().1);
                open.share += place.share;
            }
            _ => found.push(place),
        }
        last = Some(key);
    }
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found.truncate(comparison.settings.reporting.places);
    found.iter_mut().for_each(|p| p.share = tidy(p.share));
    found
}
