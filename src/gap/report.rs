//! The judged hypotheses as a diagnosis: probabilities, closures on runs left out, places, words.

use super::court::{Court, Judged};
use super::diagnosis::{Amount, Diagnosis, Finding, Group, Overlay, Place, RunGap, Verdict};
use super::evidence::Evidence;
use super::judge;
use super::looks::UNSETTLED;
use super::screen::explain;
use super::significance::Score;
use super::simulator::{Band, Frame};
use super::words;
use crate::emit::number::tidy;
use crate::geometry::trig;
use nalgebra::DVector;
use std::collections::{BTreeMap, BTreeSet};

/// Deviations of a normal distribution's 90 % interval.
const NINETY: f64 = 1.644_853_627;

/// Effects whose signatures are so nearly parallel are not told apart, unless the logarithms of their weights differ by this much (a factor
/// of 20: strong evidence, Kass and Raftery 1995).
const PARALLEL: f64 = 0.92;
const APART: f64 = 3.0;

/// Share of what is left of the gap, as an amplitude, that is believed to be the effect's own.
const MISSED: f64 = 0.5;

/// A score from which on the closure along a signature is told.
const CLEAR: f64 = 3.0;

/// Logarithm of how much less likely an effect with all its strengths may be that they are told together, and one at a place beside that was
/// really fitted that it is told instead.
const NOT_MUCH: f64 = 3.0;
const HARDLY: f64 = 1.0;

/// Places that are told.
const PLACES: usize = 24;

pub fn report(court: &Court) -> Diagnosis {
    let logs = [trig::ln(judge::NONE) + judge::likelihood(court.excess, court.freedom), court.unknown];
    let weights: Vec<f64> = logs.into_iter().chain(once(court)).collect();
    let probability = judge::normalised(&weights);
    let (none, unknown) = (probability[0], probability[1]);
    let of = |wanted: &dyn Fn(&Judged) -> bool| -> f64 {
        court.judged.iter().zip(&probability[2..]).filter(|(j, _)| wanted(j)).map(|(_, p)| p).sum()
    };
    let alone = of(&|j| j.fitted.hypothesis.members.len() == 1);
    let pair = of(&|j| j.fitted.hypothesis.members.len() == 2);
    let best = |members: usize| {
        court.judged.iter().find(|j| j.fitted.hypothesis.members.len() == members).map(|j| as_fitted(court, j))
    };
    let candidates = court.candidates();
    let (verdict, chosen) = match [none, unknown, alone, pair] {
        [n, u, a, p] if n >= u && n >= a && n >= p => (Verdict::None, best(1)),
        [_, u, a, p] if u >= a && u >= p => (Verdict::Unknown, best(1)),
        [_, _, a, p] if p > a => (Verdict::Pair, best(2)),
        _ => {
            let sensor = best(1).is_some_and(|j| candidates[j.fitted.hypothesis.members[0]].sensor);
            (if sensor { Verdict::Sensor } else { Verdict::Effect }, best(1))
        }
    };
    let names: BTreeSet<&str> = candidates.iter().map(|c| c.effect.as_str()).collect();
    let mut effects: Vec<Finding> = names
        .into_iter()
        .map(|name| {
            let has = |j: &Judged| j.fitted.hypothesis.members.iter().any(|c| candidates[*c].effect == name);
            // What the effect does alone, unless the verdict has it beside another one.
            let alone = |j: &&Judged| has(j) && j.fitted.hypothesis.members.len() == 1;
            let alone = || court.judged.iter().find(alone).map(|j| as_fitted(court, j));
            let told = chosen.filter(|j| has(j)).or_else(alone);
            let mut finding = finding(court, name, told);
            finding.probability = tidy(of(&has));
            finding
        })
        .collect();
    // Of effects that are equally sure, the one that closes more alone comes first.
    let alone = |f: &Finding| {
        let has = |j: &&Judged| {
            let members = &j.fitted.hypothesis.members;
            members.len() == 1 && candidates[members[0]].effect == f.name
        };
        court.judged.iter().find(has).map_or(f64::INFINITY, |j| j.excess)
    };
    let sure = |f: &Finding| (20.0 * f.probability).round();
    effects.sort_by(|a, b| {
        let by = sure(b).total_cmp(&sure(a)).then(if sure(a) > 0.0 {
            alone(a).total_cmp(&alone(b))
        } else {
            std::cmp::Ordering::Equal
        });
        by.then(b.probability.total_cmp(&a.probability))
    });
    let groups = groups(court, &mut effects);
    let shown = chosen.filter(|_| !matches!(verdict, Verdict::None));
    let closed = shown.and_then(|j| closed(court, j, false));
    let mut out = Diagnosis {
        verdict,
        summary: String::new(),
        places: places(court, shown.filter(|_| verdict != Verdict::Unknown)),
        unknown_probability: tidy(unknown),
        none_probability: tidy(none),
        floor: floor(court.simulator.frames()),
        next_experiment: String::new(),
        groups,
        runs: runs(court, shown),
        gap_closed_black_box: black_box(court).map(tidy),
        gap_closed: closed.map(tidy),
        gap_closed_channels: shown.map_or_else(BTreeMap::new, |j| by_channel(court, j)),
        lost: Vec::new(),
        overlays: overlays(court, shown),
        axis: "m".into(),
        effects,
    };
    out.summary = words::summary(&out);
    out.next_experiment = words::next_experiment(&out);
    out
}

fn finding(court: &Court, name: &str, best: Option<&Judged>) -> Finding {
    let mut out = Finding {
        name: name.to_owned(),
        group: name.to_owned(),
        probability: 0.0,
        strength: BTreeMap::new(),
        gap_closed: None,
        gap_closed_placebo: None,
        place: String::new(),
        fixed: BTreeMap::new(),
    };
    let Some(judged) = best else { return out };
    let candidates = court.candidates();
    // Strengths are told with those beside them that may be there, too.
    let told = whole(court, judged);
    let fitted = &told.fitted;
    // A gap that is left makes every strength less sure.
    let scale = told.excess.max(1.0).sqrt() * court.evidence.first().map_or(1.0, |e| e.honest.max(0.3)).sqrt();
    // What the effect's equation misses of its own pattern may be as much of its strength.
    let missed = MISSED * ((told.excess - 1.0) / (court.excess - 1.0).max(1e-9)).clamp(0.0, 1.0).sqrt();
    for (i, k) in fitted.hypothesis.signatures.iter().enumerate() {
        let signature = &court.signatures[*k];
        let candidate = &candidates[signature.candidate];
        if candidate.effect != name {
            continue;
        }
        let strength = &candidate.strengths[signature.strength];
        let value = fitted.strengths[i];
        let own = scale * told.covariance()[(i, i)].max(0.0).sqrt();
        let own = own.max(scattered(court, &fitted.columns[i]));
        let half = NINETY * trig::hypot(own, trig::hypot(missed, candidate.doubt) * value);
        let amount = Amount {
            value: tidy(value),
            low: tidy((value - half).max(strength.low)),
            high: tidy((value + half).min(strength.high)),
            unit: strength.unit.clone(),
        };
        out.strength.insert(strength.name.clone(), amount);
        out.place.clone_from(&candidate.place);
        out.fixed = candidate.fixed.iter().cloned().collect();
    }
    if judged.fitted.features.is_some() || court.excess <= 1.0 && court.score(&judged.fitted).z() > CLEAR {
        out.gap_closed = closed(court, judged, false).map(tidy);
        out.gap_closed_placebo = closed(court, judged, true).map(tidy);
    }
    out
}

/// The same effects where they were really fitted, if that is hardly less likely: only that says how much of the gap they close.
fn as_fitted<'a>(court: &'a Court, judged: &'a Judged) -> &'a Judged {
    let likely = |j: &&Judged| judged.weight - j.weight < HARDLY;
    let mut fitted = court.judged.iter().take_while(likely).filter(|j| j.fitted.simulated());
    fitted.find(|j| sites(court, j) == sites(court, judged)).unwrap_or(judged)
}

/// Where a hypothesis' effects are.
fn sites(court: &Court, judged: &Judged) -> BTreeSet<usize> {
    judged.fitted.hypothesis.members.iter().map(|c| court.place(*c)).collect()
}

/// Logarithms of the hypotheses' weights. Of all ways to have the same effects at the same places only the likeliest counts, as an effect with
/// many strengths is no likelier before the runs than one with few.
fn once(court: &Court) -> Vec<f64> {
    let mut met = BTreeSet::new();
    let weight = |j: &Judged| if met.insert(sites(court, j)) { j.weight } else { f64::NEG_INFINITY };
    court.judged.iter().map(weight).collect()
}

/// The same effects with more of their strengths, where that is not much less likely.
fn whole<'a>(court: &'a Court, judged: &'a Judged) -> &'a Judged {
    let one = &judged.fitted.hypothesis;
    let more = |j: &&Judged| {
        let other = &j.fitted.hypothesis;
        other.members == one.members && other.signatures.len() > one.signatures.len()
    };
    court.judged.iter().find(more).filter(|j| judged.weight - j.weight < NOT_MUCH).unwrap_or(judged)
}

/// Share of the gap that a hypothesis closes on runs left out of fitting its strengths; of a placebo, its signature moved along by half.
fn closed(court: &Court, judged: &Judged, placebo: bool) -> Option<f64> {
    let after = left_out(court, judged, placebo)?;
    if judged.fitted.features.is_none() {
        return along(court, judged, &after);
    }
    share(&court.evidence, |run| judged.excess_of(court, run, &after[run]))
}

/// The same of a gap that is seen only along the hypothesis' signature: squares of scores along it, of which chance makes 1.
fn along(court: &Court, judged: &Judged, after: &[DVector<f64>]) -> Option<f64> {
    let direction = judged.fitted.direction();
    let (mut before_sum, mut after_sum) = (0.0, 0.0);
    for (run, evidence) in court.evidence.iter().enumerate() {
        let score = |residual: &DVector<f64>| {
            let one = |x: &DVector<f64>| [x.clone()];
            Score::new(std::slice::from_ref(evidence), &one(residual), &one(&direction[run])).z()
        };
        let (before, after) = (score(&evidence.residual), score(&after[run]));
        before_sum += before * before - 1.0;
        after_sum += after * after - 1.0;
    }
    (before_sum > 0.0).then(|| (1.0 - after_sum / before_sum).clamp(-9.0, 1.0))
}

/// How far a strength is off by what scatters along its signature.
fn scattered(court: &Court, column: &[DVector<f64>]) -> f64 {
    let square: f64 = column.iter().map(DVector::norm_squared).sum();
    Score::new(&court.evidence, &court.residuals(), column).deviation / square.max(1e-300)
}

/// What is left of each run by strengths fitted to the others.
fn left_out(court: &Court, judged: &Judged, placebo: bool) -> Option<Vec<DVector<f64>>> {
    let evidence = judged.evidence(court);
    let runs = evidence.len();
    if runs < 2 {
        return None;
    }
    let fitted = &judged.fitted;
    let candidates = court.candidates();
    let bounds = fitted.hypothesis.bounds(candidates, &court.signatures);
    let (residuals, columns, bounds) = match placebo {
        false => {
            let moved = bounds.iter().zip(&fitted.strengths).map(|((low, high), x)| (low - x, high - x));
            (judged.residuals().to_vec(), judged.columns().to_vec(), moved.collect::<Vec<(f64, f64)>>())
        }
        true => {
            let columns = fitted.hypothesis.signatures.iter().map(|k| {
                let change = &court.signatures[*k].change;
                let moved = |run: usize| evidence[run].column(&moved(&court.simulator.frames()[run], &change[run]));
                (0..runs).map(moved).collect()
            });
            let residuals: Vec<DVector<f64>> = evidence.iter().map(|e| e.residual.clone()).collect();
            (residuals, columns.collect::<Vec<Vec<DVector<f64>>>>(), bounds)
        }
    };
    let by: Vec<&[DVector<f64>]> = columns.iter().map(|c| &c[..]).collect();
    Some((0..runs).map(|run| explain(&residuals, &by, &bounds, Some(run)).residuals.swap_remove(run)).collect())
}

/// 1 − (after − floor)/(before − floor), over all runs.
fn share(evidence: &[Evidence], after: impl Fn(usize) -> f64) -> Option<f64> {
    let (mut before_sum, mut after_sum) = (0.0, 0.0);
    for (run, evidence) in evidence.iter().enumerate() {
        before_sum += evidence.excess(&evidence.residual) - 1.0;
        after_sum += after(run) - 1.0;
    }
    (before_sum > 0.05 * evidence.len() as f64).then(|| (1.0 - after_sum / before_sum).clamp(-9.0, 1.0))
}

/// A change with each channel's and band's part moved along by half of it.
fn moved(frame: &Frame, change: &[f64]) -> Vec<f64> {
    let mut groups: BTreeMap<(&str, Band), Vec<usize>> = BTreeMap::new();
    for (k, label) in frame.labels.iter().enumerate() {
        groups.entry((&label.channel, label.band)).or_default().push(k);
    }
    let mut out = vec![0.0; change.len()];
    for rows in groups.values() {
        for (i, row) in rows.iter().enumerate() {
            out[*row] = change[rows[(i + rows.len() / 2) % rows.len()]];
        }
    }
    out
}

/// What a model of residuals that names nothing closes: the other runs' mean residual, feature by feature.
fn black_box(court: &Court) -> Option<f64> {
    let frames = court.simulator.frames();
    let same = frames.windows(2).all(|w| w[0].labels == w[1].labels);
    if frames.len() < 2 || !same {
        return None;
    }
    let residuals: Vec<Vec<f64>> = frames.iter().map(|f| f.residual(&f.nominal)).collect();
    let after = |run: usize| {
        let others: Vec<&Vec<f64>> = (0..frames.len()).filter(|k| *k != run).map(|k| &residuals[k]).collect();
        let mean: Vec<f64> = (0..frames[run].labels.len())
            .map(|k| {
                let known: Vec<f64> = others.iter().map(|r| r[k]).filter(|x| x.is_finite()).collect();
                known.iter().sum::<f64>() / known.len().max(1) as f64
            })
            .collect();
        let evidence = &court.evidence[run];
        evidence.excess(&(&evidence.residual - evidence.column(&mean)))
    };
    share(&court.evidence, after)
}

/// Excess of each channel before, and what the hypothesis closes of it on runs left out.
fn by_channel(court: &Court, judged: &Judged) -> BTreeMap<String, f64> {
    let Some(after) = left_out(court, judged, false) else { return BTreeMap::new() };
    let mut sums: BTreeMap<String, [f64; 3]> = BTreeMap::new();
    for (run, frame) in court.simulator.frames().iter().enumerate() {
        let evidence = &judged.evidence(court)[run];
        for ((k, x), (_, y)) in evidence.each(&evidence.residual).zip(evidence.each(&after[run])) {
            let sum = sums.entry(frame.labels[k].channel.clone()).or_default();
            *sum = [sum[0] + x * x / evidence.honest, sum[1] + y * y / evidence.honest, sum[2] + 1.0];
        }
    }
    let clear = sums.into_iter().filter(|(_, [before, _, n])| *before > 1.2 * n);
    clear.map(|(c, [before, after, n])| (c, tidy((1.0 - (after - n) / (before - n)).clamp(-9.0, 1.0)))).collect()
}

/// Where the gap lies: of each channel and band, stretches of neighbouring features with their share of all that is over the floor.
///
/// With the verdict's effects known, nuisances are where these put them; else where the nominal model does.
fn places(court: &Court, shown: Option<&Judged>) -> Vec<Place> {
    let mut excess: BTreeMap<(String, Band, u64, u64), f64> = BTreeMap::new();
    let mut total = 0.0;
    for (run, frame) in court.simulator.frames().iter().enumerate() {
        let evidence = &shown.map_or(&court.evidence[..], |j| j.evidence(court))[run];
        let residual = match shown {
            Some(j) => &j.residuals()[run] + evidence.long(&j.fitted.changes[run]),
            None => evidence.residual.clone(),
        };
        for (k, x) in evidence.each(&residual) {
            let label = &frame.labels[k];
            let over = (x * x / evidence.honest - 1.0).max(0.0);
            total += over;
            *excess.entry((label.channel.clone(), label.band, label.from, label.to)).or_default() += over;
        }
    }
    let mut found: Vec<Place> = Vec::new();
    let mut last: Option<(String, Band)> = None;
    let mean = total / excess.len().max(1) as f64;
    for ((channel, band, from, to), over) in excess {
        let place = Place {
            from_m: tidy(from as f64 / 1e3),
            to_m: tidy(to as f64 / 1e3),
            band: band.name().to_owned(),
            share: over / total.max(1e-12),
            channel: channel.clone(),
        };
        let key = (channel, band);
        // A stretch goes on while the gap is more than usual.
        match found.last_mut() {
            Some(open)
                if last.as_ref() == Some(&key)
                    && (open.to_m - place.from_m).abs() < 1e-6
                    && (over > mean) == (open.share * total > mean) =>
            {
                open.to_m = place.to_m;
                open.share += place.share;
            }
            _ => found.push(place),
        }
        last = Some(key);
    }
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found.truncate(PLACES);
    found.iter_mut().for_each(|p| p.share = tidy(p.share));
    if court.excess > 1.0 { found } else { Vec::new() }
}

/// Of each channel, the root mean square of the floor of its means along the track.
fn floor(frames: &[Frame]) -> BTreeMap<String, f64> {
    let mut sums: BTreeMap<String, (f64, f64)> = BTreeMap::new();
    for frame in frames {
        for (label, variance) in frame.labels.iter().zip(&frame.laps.variance) {
            if label.band == Band::Track && variance.is_finite() && *variance > 0.0 {
                let sum = sums.entry(label.channel.clone()).or_default();
                *sum = (sum.0 + variance, sum.1 + 1.0);
            }
        }
    }
    sums.into_iter().map(|(c, (sum, n))| (c, tidy((sum / n).sqrt()))).collect()
}

fn runs(court: &Court, shown: Option<&Judged>) -> Vec<RunGap> {
    let gap = |(run, frame): (usize, &Frame)| {
        let evidence = &court.evidence[run];
        let before = evidence.excess(&evidence.residual);
        RunGap {
            run: frame.run.clone(),
            before: tidy(before),
            after: tidy(shown.map_or(before, |j| j.excess_of(court, run, &j.residuals()[run]))),
            honest: 1.0,
            honest_high: tidy(evidence.honest_high / evidence.honest),
        }
    };
    court.simulator.frames().iter().enumerate().map(gap).collect()
}

/// Effects that cannot be told apart: their weights are alike, and their signatures are parallel or both leave nothing to choose by.
fn groups(court: &Court, effects: &mut [Finding]) -> Vec<Group> {
    let candidates = court.candidates();
    let single = |name: &str| {
        court.judged.iter().find(|j| {
            let members = &j.fitted.hypothesis.members;
            members.len() == 1 && candidates[members[0]].effect == name
        })
    };
    let mut out: Vec<Group> = Vec::new();
    let mut grouped: BTreeSet<String> = BTreeSet::new();
    for i in 0..effects.len().min(8) {
        let Some(own) = single(&effects[i].name) else { continue };
        let likely = effects[i].probability > 0.05;
        let explains = |j: &Judged| j.excess < 0.5 * (court.excess + 1.0);
        if !likely || grouped.contains(&effects[i].name) || !explains(own) {
            continue;
        }
        let mut members = vec![effects[i].name.clone()];
        for other in effects.iter().skip(i + 1) {
            let Some(judged) = single(&other.name) else { continue };
            let near = (own.weight - judged.weight).abs() < APART;
            let settled = explains(judged) && own.excess.max(judged.excess) < UNSETTLED;
            if near && (settled || alike(&own.fitted.direction(), &judged.fitted.direction()) > PARALLEL) {
                members.push(other.name.clone());
            }
        }
        if members.len() > 1 {
            grouped.extend(members.iter().cloned());
            let experiment = words::separate(&members);
            out.push(Group { name: effects[i].name.clone(), members, experiment });
        }
    }
    for finding in effects {
        if let Some(group) = out.iter().find(|g| g.members.contains(&finding.name)) {
            finding.group.clone_from(&group.name);
        }
    }
    out
}

/// Cosine between what two hypotheses change, over all runs.
fn alike(a: &[DVector<f64>], b: &[DVector<f64>]) -> f64 {
    let dot = |x: &[DVector<f64>], y: &[DVector<f64>]| x.iter().zip(y).map(|(x, y)| x.dot(y)).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(1e-300)
}

/// Means of the channels with the largest gaps.
fn overlays(court: &Court, shown: Option<&Judged>) -> Vec<Overlay> {
    let mut gaps: BTreeMap<(usize, String), f64> = BTreeMap::new();
    let frames = court.simulator.frames();
    for (run, frame) in frames.iter().enumerate() {
        let evidence = &court.evidence[run];
        for (k, x) in evidence.each(&evidence.residual).filter(|(k, _)| frame.labels[*k].band == Band::Track) {
            *gaps.entry((run, frame.labels[k].channel.clone())).or_default() += x * x;
        }
    }
    let mut worst: Vec<((usize, String), f64)> = gaps.into_iter().collect();
    worst.sort_by(|a, b| b.1.total_cmp(&a.1));
    let one = |((run, channel), _): ((usize, String), f64)| {
        let frame = &frames[run];
        let rows: Vec<usize> = (0..frame.labels.len())
            .filter(|k| frame.labels[*k].band == Band::Track && frame.labels[*k].channel == channel)
            .collect();
        let pick = |x: &dyn Fn(usize) -> f64| rows.iter().map(|k| tidy(x(*k))).collect::<Vec<f64>>();
        let steps = DVector::from_vec(court.evidence[run].steps(&vec![0.0; frame.nominal.len()]));
        let shift = &frame.slopes * steps;
        let after = shown.and_then(|j| j.fitted.features.as_ref()).map(|f| &f[run]);
        Overlay {
            run: frame.run.clone(),
            unit: words::unit(&channel).to_owned(),
            at: pick(&|k| 0.5e-3 * (frame.labels[k].from + frame.labels[k].to) as f64),
            measured: pick(&|k| frame.measured[k]),
            before: pick(&|k| frame.nominal[k] + shift[k]),
            after: pick(&|k| after.map_or(frame.nominal[k] + shift[k], |f| f[k])),
            floor: pick(&|k| frame.laps.variance[k].sqrt()),
            channel,
        }
    };
    worst.into_iter().take(4).map(one).collect()
}
