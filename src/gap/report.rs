//! The scored hypotheses as a diagnosis: probabilities, closures on runs left out, places, words.

use super::amounts::amounts;
use super::comparison::{Compared, Comparison};
use super::diagnosis::{Amount, Diagnosis, Elsewhere, Finding, Group, Lost, RunGap, Verdict};
use super::hypothesis::room;
use super::ids::{CandidateId, PerRun, RunId, SignatureId};
use super::observation::Observation;
use super::overlays::overlays;
use super::places::{places, unexplained};
use super::predictive::predictive_check;
use super::scored::Scored;
use super::shape::shape;
use super::signature::explain;
use super::simulator::{Band, Frame};
use super::untested::Untested;
use super::{likelihood, words};
use crate::base::number::tidy;
use crate::base::trig;
use nalgebra::DVector;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// The answer. Hypotheses of which a member may be absent are not held as such: a pair without one of its members is
/// the other one alone.
pub fn report(mut compared: Compared, lost: Vec<Lost>) -> Diagnosis {
    let untested = compared.untested();
    loop {
        let chosen = choose(&compared, &untested);
        match chosen.absent {
            Some(at) => compared = compared.without(at),
            None => return told(&compared, &chosen, &untested, lost),
        }
    }
}

/// Probabilities, and what they choose.
struct Choice {
    verdict: Verdict,
    /// Of no gap, something unknown, each hypothesis, and each effect that was not tested.
    none: f64,
    unknown: f64,
    scored: Vec<f64>,
    untested: Vec<f64>,
    /// The hypothesis that is shown, and one that is none, as a member of it may be absent.
    shown: Option<usize>,
    absent: Option<usize>,
}

fn choose(compared: &Compared, untested: &[Untested]) -> Choice {
    let settings = compared.comparison.likelihood();
    let probability = probabilities(compared, untested);
    let (none, unknown) = (probability[0], probability[1]);
    let (scored, untested) = probability[2..].split_at(compared.scored.len());
    let count = |j: &Scored| compared.comparison.effects(&j.fitted.hypothesis).len();
    let of = |members: usize| -> f64 {
        compared.scored.iter().zip(scored).filter(|(j, _)| count(j) == members).map(|(_, p)| p).sum()
    };
    let (alone, pair) = (of(1), of(2));
    let best = |members: usize| {
        let first = compared.scored.iter().position(|j| count(j) == members)?;
        Some((first, as_fitted(compared, first)))
    };
    let candidates = compared.comparison.candidates();
    // Many pairs may be as likely together as none of them is: then only what they have in common is known.
    let likely = |name: &str| {
        let has = |j: &Scored| compared.comparison.effects(&j.fitted.hypothesis).contains(&name);
        compared.scored.iter().zip(scored).filter(|(j, _)| has(j)).map(|(_, p)| p).sum::<f64>() >= settings.told
    };
    let told = |(_, k): (usize, usize)| {
        compared.comparison.effects(&compared.scored[k].fitted.hypothesis).into_iter().all(likely)
    };
    let (verdict, chosen) = match [none, unknown, alone, pair] {
        [n, u, a, p] if n >= u && n >= a && n >= p => (Verdict::None, best(1)),
        [_, u, a, p] if u >= a && u >= p => (Verdict::Unknown, explains_most(compared).or_else(|| best(1))),
        [_, _, a, p] if p > a && best(2).is_some_and(told) => (Verdict::Pair, best(2)),
        _ => {
            let first = best(1).map(|(_, k)| compared.scored[k].fitted.hypothesis.members[0]);
            let sensor = first.is_some_and(|c| candidates[c].sensor);
            (if sensor { Verdict::Sensor } else { Verdict::Effect }, best(1))
        }
    };
    let named = chosen.filter(|_| !matches!(verdict, Verdict::None | Verdict::Unknown));
    let absent = named.and_then(|(first, fitted)| [fitted, first].into_iter().find(|k| may_lack(compared, *k)));
    let (scored, untested) = (scored.to_vec(), untested.to_vec());
    Choice { verdict, none, unknown, scored, untested, shown: chosen.map(|(_, k)| k), absent }
}

/// As they are reported: of no gap, something unknown, each hypothesis, and each effect that was not tested.
fn probabilities(compared: &Compared, untested: &[Untested]) -> Vec<f64> {
    let comparison = &compared.comparison;
    let settings = comparison.likelihood();
    let none = trig::ln(settings.prior_none);
    // Each before the runs and after them. What does not count after them did not count before.
    let of_none = (none, none + settings.log_likelihood(comparison.mean_square, comparison.degrees_of_freedom));
    let of_unknown = (trig::ln(settings.prior_unknown), compared.unknown);
    let before = |j: &Scored, after: f64| if after.is_finite() { j.terms.prior } else { after };
    let tested = compared.scored.iter().zip(once(compared)).map(|(j, after)| (before(j, after), after));
    let untested = untested.iter().map(|u| (u.prior, u.log_posterior));
    let each = [of_none, of_unknown].into_iter().chain(tested).chain(untested);
    let (before, after): (Vec<f64>, Vec<f64>) = each.unzip();
    settings.calibrated(&likelihood::normalised(&after), &likelihood::normalised(&before))
}

/// The effect that explains most by the runs alone, at whichever of its places: where none is believed, what was
/// believed of it before tells nothing of what it leaves. Only what was simulated and is there.
fn explains_most(compared: &Compared) -> Option<(usize, usize)> {
    let by_runs = |k: &usize| {
        let terms = &compared.scored[*k].terms;
        terms.log_posterior() - terms.prior
    };
    let comparison = &compared.comparison;
    let alone = |k: &usize| {
        let Scored { fitted, mean_square, .. } = &compared.scored[*k];
        comparison.effects(&fitted.hypothesis).len() == 1 && fitted.simulated() && comparison.explains(*mean_square)
    };
    let mut each: Vec<usize> = (0..compared.scored.len()).filter(alone).collect();
    each.sort_by(|a, b| by_runs(b).total_cmp(&by_runs(a)));
    each.into_iter().find(|k| !may_lack(compared, *k)).map(|k| (k, k))
}

/// Whether a member of a hypothesis may be absent: the intervals of all its strengths hold 0.
fn may_lack(compared: &Compared, scored: usize) -> bool {
    let scored = &compared.scored[scored];
    let members = scored.fitted.hypothesis.members.iter();
    let mut each = members.map(|member| amounts(&compared.comparison, whole(compared, scored), *member));
    each.any(|own| !own.is_empty() && own.values().all(Amount::may_be_zero))
}

fn told(compared: &Compared, choice: &Choice, untested: &[Untested], lost: Vec<Lost>) -> Diagnosis {
    let candidates = compared.comparison.candidates();
    let chosen = choice.shown.map(|k| &compared.scored[k]);
    let of = |wanted: &dyn Fn(&Scored) -> bool| -> f64 {
        compared.scored.iter().zip(&choice.scored).filter(|(j, _)| wanted(j)).map(|(_, p)| p).sum()
    };
    let never = |name: &str| -> f64 {
        let own = untested.iter().zip(&choice.untested).filter(|(u, _)| candidates[u.candidate].effect == name);
        own.map(|(_, p)| p).sum()
    };
    let names: BTreeSet<&str> = candidates.iter().map(|c| c.effect.as_str()).collect();
    let mut effects: Vec<Finding> = names
        .into_iter()
        .map(|name| {
            let has = |j: &Scored| j.fitted.hypothesis.members.iter().any(|c| candidates[*c].effect == name);
            // What the effect does alone, unless the verdict has it beside another one.
            let alone = || alone(compared, name).map(|k| &compared.scored[as_fitted(compared, k)]);
            let told = chosen.filter(|j| has(j)).or_else(alone);
            let mut finding = finding(compared, name, told);
            finding.untested_probability = tidy(never(name));
            finding.probability = tidy(of(&has) + never(name));
            finding
        })
        .collect();
    // Of effects that are equally sure to be there, the one that closes more alone comes first.
    let left = |f: &Finding| alone(compared, &f.name).map_or(f64::INFINITY, |k| compared.scored[k].mean_square);
    let present = |f: &Finding| f.probability >= compared.comparison.likelihood().told;
    let sure = |f: &Finding| if present(f) { (20.0 * f.probability).round() / 20.0 } else { f.probability };
    effects.sort_by(|a, b| {
        let closes = if present(a) && present(b) { left(a).total_cmp(&left(b)) } else { Ordering::Equal };
        sure(b).total_cmp(&sure(a)).then(closes).then(b.probability.total_cmp(&a.probability))
    });
    let groups = groups(compared, &mut effects);
    let verdict = choice.verdict;
    let shown = chosen.filter(|_| !matches!(verdict, Verdict::None));
    let axis = compared.comparison.simulator.axis();
    let runs = runs(&compared.comparison, shown);
    let gap = runs.iter().any(RunGap::over);
    let closed = shown.filter(|_| gap).and_then(|j| closed(&compared.comparison, j, false));
    let places = places(&compared.comparison, shown.filter(|_| verdict != Verdict::Unknown), axis);
    let with = shown.map_or_else(Vec::new, |j| compared.comparison.effects(&j.fitted.hypothesis));
    let mut out = Diagnosis {
        verdict,
        summary: String::new(),
        shown: with.into_iter().map(str::to_owned).collect(),
        overlays: overlays(&compared.comparison, shown, &places),
        places: if compared.comparison.mean_square > 1.0 { places } else { Vec::new() },
        unknown_probability: tidy(choice.unknown),
        none_probability: tidy(choice.none),
        untested_probability: tidy(choice.untested.iter().sum()),
        repeatability: repeatability(compared.comparison.simulator.frames()),
        next_experiment: String::new(),
        groups,
        gap_closed_black_box: black_box(&compared.comparison).filter(|_| gap).map(tidy),
        gap_closed: closed.map(tidy),
        unexplained: unexplained(&compared.comparison, shown, &runs, axis),
        predictive_check: predictive_check(&compared.comparison, shown),
        noise: compared.comparison.simulator.noise(),
        gap_closed_channels: shown.filter(|_| gap).map_or_else(BTreeMap::new, |j| by_channel(&compared.comparison, j)),
        runs,
        lost,
        axis,
        effects,
        outside: None,
    };
    out.summary = words::summary(&out);
    out.next_experiment = words::next_experiment(&out);
    out
}

fn finding(compared: &Compared, name: &str, best: Option<&Scored>) -> Finding {
    let mut out = Finding {
        name: name.to_owned(),
        group: name.to_owned(),
        probability: 0.0,
        untested_probability: 0.0,
        strength: BTreeMap::new(),
        gap_closed: None,
        gap_closed_placebo: None,
        place: String::new(),
        fixed: BTreeMap::new(),
        shape: None,
        elsewhere: Vec::new(),
    };
    let Some(scored) = best else { return out };
    let own = |c: &&CandidateId| compared.comparison.candidates()[**c].effect == name;
    for (n, member) in scored.fitted.hypothesis.members.iter().filter(own).enumerate() {
        // Strengths are told with those beside them that may be there, too.
        let strength = amounts(&compared.comparison, whole(compared, scored), *member);
        let candidate = &compared.comparison.candidates()[*member];
        let (place, fixed) = (candidate.place.clone(), candidate.fixed.iter().cloned().collect());
        if n > 0 {
            out.elsewhere.push(Elsewhere { place, fixed, strength });
            continue;
        }
        out.shape = shape(compared.comparison.simulator, *member, &strength);
        (out.place, out.fixed, out.strength) = (place, fixed, strength);
    }
    let gap = compared.comparison.observations.ids().any(|run| over(&compared.comparison, run));
    if gap && scored.fitted.features.is_some() {
        out.gap_closed = closed(&compared.comparison, scored, false).map(tidy);
        out.gap_closed_placebo = closed(&compared.comparison, scored, true).map(tidy);
    }
    out
}

/// Where the likeliest hypothesis stands of which an effect is the only member.
fn alone(compared: &Compared, name: &str) -> Option<usize> {
    let candidates = compared.comparison.candidates();
    compared.scored.iter().position(|j| match j.fitted.hypothesis.members[..] {
        [own] => candidates[own].effect == name,
        _ => false,
    })
}

/// The same effects where they were really fitted, if that is hardly less likely: only that says how much of the gap
/// they close.
fn as_fitted(compared: &Compared, first: usize) -> usize {
    let scored = &compared.scored[first];
    let likely = |(_, j): &(usize, &Scored)| {
        scored.log_posterior() - j.log_posterior() < compared.comparison.settings.reporting.fitted
    };
    let mut fitted = compared.scored.iter().enumerate().take_while(likely).filter(|(_, j)| j.fitted.simulated());
    fitted
        .find(|(_, j)| sites(&compared.comparison, j) == sites(&compared.comparison, scored))
        .map_or(first, |(k, _)| k)
}

/// Where a hypothesis' effects are.
fn sites(comparison: &Comparison, scored: &Scored) -> BTreeSet<CandidateId> {
    scored.fitted.hypothesis.members.iter().map(|c| comparison.place(*c)).collect()
}

/// Log posteriors of the hypotheses. Of all ways to have the same effects at the same places only the likeliest counts,
/// as an effect with many strengths is no likelier before the runs than one with few.
fn once(compared: &Compared) -> Vec<f64> {
    let mut met = BTreeSet::new();
    let log_posterior =
        |j: &Scored| if met.insert(sites(&compared.comparison, j)) { j.log_posterior() } else { f64::NEG_INFINITY };
    compared.scored.iter().map(log_posterior).collect()
}

/// The same effects with more of their strengths, where that is not much less likely. What is looked for only beside
/// others is told only where it makes a hypothesis likelier.
fn whole<'a>(compared: &'a Compared, scored: &'a Scored) -> &'a Scored {
    let one = &scored.fitted.hypothesis;
    let more = |j: &&Scored| {
        let other = &j.fitted.hypothesis;
        let known = |k: &SignatureId| one.signatures.contains(k) || !compared.comparison.is_beside(*k);
        other.members == one.members
            && other.signatures.len() > one.signatures.len()
            && other.signatures.iter().all(known)
    };
    compared
        .scored
        .iter()
        .find(more)
        .filter(|j| scored.log_posterior() - j.log_posterior() < compared.comparison.settings.reporting.whole)
        .unwrap_or(scored)
}

/// Share of the gap that a hypothesis closes on runs left out of fitting its strengths; of a placebo, its signature
/// moved along by half.
fn closed(comparison: &Comparison, scored: &Scored, placebo: bool) -> Option<f64> {
    let after = left_out(comparison, scored, placebo)?;
    share(&comparison.observations, |run| scored.mean_square_of(&comparison.observations, run, &after[run]))
}

/// What is left of each run by strengths fitted to the others.
fn left_out(comparison: &Comparison, scored: &Scored, placebo: bool) -> Option<PerRun<DVector<f64>>> {
    let observations = scored.observations(&comparison.observations);
    if observations.len() < 2 {
        return None;
    }
    let fitted = &scored.fitted;
    let candidates = comparison.candidates();
    let bounds = fitted.hypothesis.bounds(candidates, &comparison.signatures);
    let (residuals, columns, bounds) = match placebo {
        false => (scored.residuals().clone(), scored.columns().to_vec(), room(&bounds, &fitted.strengths)),
        true => {
            let columns = fitted.hypothesis.signatures.iter().map(|k| {
                let change = &comparison.signatures[*k].change;
                let moved =
                    |run: RunId| observations[run].column(&moved(&comparison.simulator.frames()[run], &change[run]));
                observations.ids().map(moved).collect()
            });
            let residuals: PerRun<DVector<f64>> = observations.iter().map(|o| o.residual.clone()).collect();
            (residuals, columns.collect::<Vec<PerRun<DVector<f64>>>>(), bounds)
        }
    };
    let by: Vec<&PerRun<DVector<f64>>> = columns.iter().collect();
    let without = |run: RunId| explain(&residuals, &by, &bounds, Some(run)).residuals[run].clone();
    Some(observations.ids().map(without).collect())
}

/// 1 − (after − repeatability)/(before − repeatability), over all runs.
fn share(observations: &PerRun<Observation>, after: impl Fn(RunId) -> f64) -> Option<f64> {
    let (mut before_sum, mut after_sum) = (0.0, 0.0);
    for (run, observation) in observations.with_ids() {
        before_sum += observation.mean_square(&observation.residual) - 1.0;
        after_sum += after(run) - 1.0;
    }
    (before_sum > 0.05 * observations.len() as f64).then(|| (1.0 - after_sum / before_sum).clamp(-9.0, 1.0))
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
fn black_box(comparison: &Comparison) -> Option<f64> {
    let frames = comparison.simulator.frames();
    let same = frames.windows(2).all(|w| w[0].labels == w[1].labels);
    if frames.len() < 2 || !same {
        return None;
    }
    let residuals: PerRun<Vec<f64>> = frames.iter().map(|f| f.residual(&f.nominal)).collect();
    let after = |run: RunId| {
        let others: Vec<&Vec<f64>> = frames.ids().filter(|k| *k != run).map(|k| &residuals[k]).collect();
        let mean: Vec<f64> = (0..frames[run].labels.len())
            .map(|k| {
                let known: Vec<f64> = others.iter().map(|r| r[k]).filter(|x| x.is_finite()).collect();
                known.iter().sum::<f64>() / known.len().max(1) as f64
            })
            .collect();
        let observation = &comparison.observations[run];
        observation.mean_square(&(&observation.residual - observation.column(&mean)))
    };
    share(&comparison.observations, after)
}

/// Excess of each channel before, and what the hypothesis closes of it on runs left out.
fn by_channel(comparison: &Comparison, scored: &Scored) -> BTreeMap<String, f64> {
    let Some(after) = left_out(comparison, scored, false) else { return BTreeMap::new() };
    let mut sums: BTreeMap<String, [f64; 3]> = BTreeMap::new();
    for (run, frame) in comparison.simulator.frames().with_ids() {
        let observation = &scored.observations(&comparison.observations)[run];
        for ((k, x), (_, y)) in observation.each(&observation.residual).zip(observation.each(&after[run])) {
            let sum = sums.entry(frame.labels[k].channel.clone()).or_default();
            *sum = [sum[0] + x * x / observation.replicate, sum[1] + y * y / observation.replicate, sum[2] + 1.0];
        }
    }
    let clear = sums.into_iter().filter(|(_, [before, _, n])| *before > 1.2 * n);
    clear.map(|(c, [before, after, n])| (c, tidy((1.0 - (after - n) / (before - n)).clamp(-9.0, 1.0)))).collect()
}

/// Of each channel, the root mean square of the repeatability of its means along the track.
fn repeatability(frames: &PerRun<Frame>) -> BTreeMap<String, f64> {
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

/// Whether a run is farther off than 95 % of repeated measurements.
fn over(comparison: &Comparison, run: RunId) -> bool {
    let observation = &comparison.observations[run];
    observation.mean_square(&observation.residual) > observation.replicate_high / observation.replicate
}

fn runs(comparison: &Comparison, shown: Option<&Scored>) -> Vec<RunGap> {
    let gap = |(run, frame): (RunId, &Frame)| {
        let observation = &comparison.observations[run];
        let before = observation.mean_square(&observation.residual);
        RunGap {
            run: frame.run.clone(),
            before: tidy(before),
            after: tidy(shown.map_or(before, |j| j.mean_square_of(&comparison.observations, run, &j.residuals()[run]))),
            replicate: 1.0,
            replicate_high: tidy(observation.replicate_high / observation.replicate),
        }
    };
    comparison.simulator.frames().with_ids().map(gap).collect()
}

/// Effects that cannot be told apart: their log posteriors are alike, and their signatures are parallel or both leave
/// nothing to choose by.
fn groups(compared: &Compared, effects: &mut [Finding]) -> Vec<Group> {
    let settings = compared.comparison.settings;
    let single = |name: &str| alone(compared, name).map(|k| &compared.scored[k]);
    let mut out: Vec<Group> = Vec::new();
    let mut grouped: BTreeSet<String> = BTreeSet::new();
    for i in 0..effects.len().min(8) {
        let Some(own) = single(&effects[i].name) else { continue };
        let likely = effects[i].probability > 0.05;
        let explains = |j: &Scored| j.mean_square < 0.5 * (compared.comparison.mean_square + 1.0);
        if !likely || effects[i].may_be_absent() || grouped.contains(&effects[i].name) || !explains(own) {
            continue;
        }
        let mut members = vec![effects[i].name.clone()];
        for other in effects.iter().skip(i + 1) {
            let Some(scored) = single(&other.name) else { continue };
            let near = (own.log_posterior() - scored.log_posterior()).abs() < settings.reporting.apart;
            if other.may_be_absent() {
                continue;
            }
            let settled = explains(scored) && own.mean_square.max(scored.mean_square) < settings.selection.unsettled;
            if near
                && (settled || alike(&own.fitted.direction(), &scored.fitted.direction()) > settings.reporting.parallel)
            {
                members.push(other.name.clone());
            }
        }
        if members.len() > 1 {
            grouped.extend(members.iter().cloned());
            let experiment = words::separate(&members, compared.comparison.simulator.axis());
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
fn alike(a: &PerRun<DVector<f64>>, b: &PerRun<DVector<f64>>) -> f64 {
    let dot = |x: &PerRun<DVector<f64>>, y: &PerRun<DVector<f64>>| x.iter().zip(y).map(|(x, y)| x.dot(y)).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(1e-300)
}
