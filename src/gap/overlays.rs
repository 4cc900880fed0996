//! What is drawn: of the channels that have most of the gap, the kind of deviation that has most of it, in the run that
//! is off most.

use super::comparison::Comparison;
use super::diagnosis::{GapPlace, Overlay, ranked};
use super::ids::{PerRun, RunId};
use super::scored::Scored;
use super::simulator::{Band, Frame};
use crate::base::number::tidy;
use crate::signal::Channel;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// The first channels of where the gap lies.
pub fn overlays(comparison: &Comparison, shown: Option<&Scored>, places: &[GapPlace]) -> Vec<Overlay> {
    let channels = ranked(places).into_iter();
    channels
        .filter_map(|(channel, _)| overlay(comparison, shown, places, &channel))
        .take(comparison.settings.reporting.drawn)
        .collect()
}

fn overlay(comparison: &Comparison, shown: Option<&Scored>, places: &[GapPlace], channel: &str) -> Option<Overlay> {
    let frames = comparison.simulator.frames();
    let band = band(frames, places, channel)?;
    let run = worst(comparison, channel, band)?;
    let frame = &frames[run];
    let rows = fewer(rows(frame, channel, band), comparison, run);
    let steps = DVector::from_vec(comparison.observations[run].steps(&vec![0.0; frame.nominal.len()]));
    let shift = &frame.slopes * steps;
    let after = shown.and_then(|j| j.fitted.features.as_ref()).map(|f| &f[run]);
    let pick = |x: &dyn Fn(usize) -> f64| rows.iter().map(|k| tidy(x(*k))).collect::<Vec<f64>>();
    // Features of one stretch follow each other in it.
    let mut ranks: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    rows.iter().for_each(|k| ranks.entry((frame.labels[*k].from, frame.labels[*k].to)).or_default().push(*k));
    let middle = |k: usize| {
        let (from, to) = (frame.labels[k].from, frame.labels[k].to);
        let alike = ranks.get(&(from, to)).map_or(&[][..], Vec::as_slice);
        let rank = alike.iter().position(|other| *other == k).unwrap_or(0) as f64;
        1e-3 * (from as f64 + (rank + 0.5) / alike.len().max(1) as f64 * (to - from) as f64)
    };
    let numbers = || (1..=rows.len()).map(|n| n as f64).collect();
    Some(Overlay {
        run: frame.run.clone(),
        band: band.name().to_owned(),
        unit: Channel::unit_of(channel).to_owned(),
        at: if placed(band) { pick(&middle) } else { numbers() },
        measured: pick(&|k| frame.measured[k]),
        before: pick(&|k| frame.nominal[k] + shift[k]),
        after: pick(&|k| after.map_or(frame.nominal[k] + shift[k], |f| f[k])),
        repeatability: pick(&|k| frame.laps.variance[k].sqrt()),
        channel: channel.to_owned(),
    })
}

/// As many neighbouring rows as can be drawn: those of which most is left.
fn fewer(rows: Vec<usize>, comparison: &Comparison, run: RunId) -> Vec<usize> {
    const DRAWN: usize = 600;
    if rows.len() <= DRAWN {
        return rows;
    }
    let observation = &comparison.observations[run];
    let left: BTreeMap<usize, f64> = observation.each(&observation.residual).map(|(k, x)| (k, x * x)).collect();
    let sums: Vec<f64> = rows.windows(DRAWN).map(|some| some.iter().filter_map(|k| left.get(k)).sum::<f64>()).collect();
    let worst = (0..sums.len()).max_by(|a, b| sums[*a].total_cmp(&sums[*b])).unwrap_or(0);
    rows[worst..worst + DRAWN].to_vec()
}

/// Whether features of a kind belong to places.
fn placed(band: Band) -> bool {
    matches!(band, Band::Track | Band::Fluctuation)
}

/// The kind of deviation with most of a channel's share, of those that can be drawn as a curve: features of one unit, and
/// so not slow changes, which are powers and a mean.
fn band(frames: &PerRun<Frame>, places: &[GapPlace], channel: &str) -> Option<Band> {
    let mut shares: BTreeMap<&str, f64> = BTreeMap::new();
    let own = places.iter().filter(|p| p.channel == channel);
    own.for_each(|p| *shares.entry(&p.band).or_default() += p.share);
    let drawn = |band: &Band| *band != Band::Drift && frames.iter().any(|f| rows(f, channel, *band).len() > 1);
    let share = |band: &Band| shares.get(band.name()).copied().unwrap_or(0.0);
    Band::ALL.into_iter().filter(drawn).max_by(|a, b| share(a).total_cmp(&share(b)))
}

/// The run in which it is off most.
fn worst(comparison: &Comparison, channel: &str, band: Band) -> Option<RunId> {
    let off = |run: RunId| {
        let (observation, labels) = (&comparison.observations[run], &comparison.simulator.frames()[run].labels);
        let own = |k: usize| labels[k].channel == channel && labels[k].band == band;
        observation.each(&observation.residual).filter(|(k, _)| own(*k)).map(|(_, x)| x * x).sum::<f64>()
    };
    comparison.observations.ids().max_by(|a, b| off(*a).total_cmp(&off(*b)))
}

/// Features of a channel and kind along their axis. Where some belong to short stretches and some to long ones, the
/// short ones.
fn rows(frame: &Frame, channel: &str, band: Band) -> Vec<usize> {
    let labels = &frame.labels;
    let own = (0..labels.len()).filter(|k| labels[*k].channel == channel && labels[*k].band == band);
    let own = own.filter(|k| frame.laps.variance[*k].is_finite());
    let mut rows: Vec<usize> = own.collect();
    if placed(band) {
        let length = |k: &usize| labels[*k].to - labels[*k].from;
        let shortest = rows.iter().map(length).min().unwrap_or(0);
        rows.retain(|k| length(k) <= 2 * shortest.max(1));
        rows.sort_by_key(|k| labels[*k].from);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::simulator::Label;

    #[test]
    fn features_of_several_units_are_not_drawn_as_a_curve() {
        let mut frame = Frame::bare(vec![0.0; 6], vec![vec![1.0; 6], vec![-1.0; 6]]);
        let label = |(k, (channel, band)): (usize, (&str, Band))| Label {
            channel: channel.to_owned(),
            band,
            index: k,
            from: 0,
            to: 1000,
        };
        let bands = [("speed", Band::Drift), ("steer_left", Band::Drift), ("steer_left", Band::Cart)];
        frame.labels = bands.into_iter().flat_map(|own| [own; 2]).enumerate().map(label).collect();
        let frames: PerRun<Frame> = vec![frame].into();
        assert_eq!(band(&frames, &[], "speed"), None);
        assert_eq!(band(&frames, &[], "steer_left"), Some(Band::Cart));
    }
}
