//! One answer against its truth.

use super::key::{Answer, Case, CaseKind, Named, Truth};
use crate::effects::LIBRARY;
use crate::gap::Verdict;
use serde::Serialize;

/// Effects at least this probable are claimed to be present.
const CLAIMED: f64 = 0.5;
/// How far a place may be off, m: two carts' length or so, over which means are taken.
const NEAR: f64 = 2.5;
/// How far a wavelength may be off, as a share.
const ALIKE: f64 = 0.2;
/// A part of the gap that is longer than this share of the longest belongs to no place.
const LOCAL: f64 = 0.6;

/// Rank among what may be answered, from 1: effects, no gap, and unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rank {
    pub exact: usize,
    /// With effects that the answer says it cannot tell apart as one.
    pub group: usize,
}

/// What an answer is worth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoredCase {
    /// The worst of the truth's effects, each ranked without the others.
    pub rank: Rank,
    /// What stands first and second, with probabilities.
    pub first: Vec<(String, f64)>,
    /// On what is true; the mean over a pair.
    pub probability: f64,
    pub unknown: f64,
    pub verdict: Option<Verdict>,
    /// Of each claimed true effect's strengths, whether the interval holds the truth.
    pub covered: Vec<bool>,
    /// Of each claimed true effect with a place, whether the answer names it.
    pub placed: Vec<bool>,
    /// Share of the local gap that lies where the truth acts, and the share of the track that this is.
    pub overlap: Option<(f64, f64)>,
    pub closed: Option<f64>,
    pub closed_placebo: Option<f64>,
    pub closed_black_box: Option<f64>,
}

/// What may be answered, most probable first, and of equals by name: name, group, probability.
fn ranking(answer: &Answer) -> Vec<(&str, &str, f64)> {
    let number = |p: Option<f64>| p.filter(|p| p.is_finite()).unwrap_or(0.0);
    let mut all: Vec<(&str, &str, f64)> = answer
        .effects
        .iter()
        .map(|e| (e.name.as_str(), if e.group.is_empty() { &*e.name } else { &*e.group }, e.chance()))
        .collect();
    all.push(("no gap", "no gap", number(answer.none_probability)));
    all.push(("unknown", "unknown", number(answer.unknown_probability)));
    all.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(b.0)));
    all
}

/// Names that would be right.
fn right(case: &Case) -> Vec<&str> {
    match case.kind {
        CaseKind::None => vec!["no gap"],
        CaseKind::Unknown => vec!["unknown"],
        _ => case.truth.iter().map(|t| t.effect.as_str()).collect(),
    }
}

/// The rank of `name` among what is neither right otherwise nor without any probability.
fn rank(all: &[(&str, &str, f64)], name: &str, others: &[&str]) -> Rank {
    let missed = all.len().max(LIBRARY.len() + 2) + 1;
    let Some(own) = all.iter().find(|(n, _, p)| *n == name && *p > 0.0) else {
        return Rank { exact: missed, group: missed };
    };
    let rivals = || all.iter().filter(|(n, _, _)| *n == name || !others.contains(n));
    let exact = rivals().position(|(n, _, _)| *n == name).map_or(missed, |k| k + 1);
    let mut groups: Vec<&str> = Vec::new();
    for (_, group, _) in rivals() {
        if !groups.contains(group) {
            groups.push(group);
        }
    }
    Rank { exact, group: groups.iter().position(|g| *g == own.1).map_or(missed, |k| k + 1) }
}

/// Judges an answer; none at all is one that says nothing.
pub fn score_case(case: &Case, answer: &Answer) -> ScoredCase {
    let all = ranking(answer);
    let right = right(case);
    let ranks: Vec<Rank> = right.iter().map(|name| rank(&all, name, &right)).collect();
    let worst = |of: fn(&Rank) -> usize| ranks.iter().map(of).max().unwrap_or(usize::MAX);
    let chance = |name: &&str| all.iter().find(|(n, _, _)| n == name).map_or(0.0, |x| x.2);
    let claimed: Vec<(&Truth, &Named)> = if case.kind.nameable() {
        case.truth
            .iter()
            .filter_map(|t| Some((t, answer.find(&t.effect)?)))
            .filter(|(_, n)| n.chance() >= CLAIMED)
            .collect()
    } else {
        Vec::new()
    };
    let named: Vec<&Named> = answer.effects.iter().filter(|e| e.chance() >= CLAIMED).collect();
    ScoredCase {
        rank: Rank { exact: worst(|r| r.exact), group: worst(|r| r.group) },
        first: all.iter().take(2).map(|(name, _, p)| ((*name).to_owned(), *p)).collect(),
        probability: right.iter().map(chance).sum::<f64>() / right.len().max(1) as f64,
        unknown: chance(&"unknown"),
        verdict: answer.verdict,
        covered: claimed.iter().flat_map(|(truth, named)| covered(truth, named)).collect(),
        placed: claimed.iter().filter(|(truth, _)| !truth.fixed.is_empty()).map(|(t, n)| placed(t, n)).collect(),
        overlap: overlap(case, answer),
        closed: answer.gap_closed,
        closed_placebo: named.iter().filter_map(|e| e.gap_closed_placebo).reduce(f64::max),
        closed_black_box: answer.gap_closed_black_box,
    }
}

fn covered(truth: &Truth, named: &Named) -> Vec<bool> {
    let each = truth.strengths.iter().filter_map(|(name, x)| {
        let interval = named.strength.get(name)?;
        Some(interval.low.is_some_and(|low| low <= *x) && interval.high.is_some_and(|high| *x <= high))
    });
    each.collect()
}

fn placed(truth: &Truth, named: &Named) -> bool {
    truth.fixed.iter().all(|(name, x)| {
        named.fixed.get(name).is_some_and(|y| match name.as_str() {
            "at" => (x - y).abs() <= NEAR,
            "wavelength" => (x - y).abs() <= ALIKE * x.abs(),
            _ => (x - y).abs() < 0.5,
        })
    })
}

/// Of the parts that belong to a place, how much lies on or beside the stretches where effects act; and how much of the
/// track those stretches are.
fn overlap(case: &Case, answer: &Answer) -> Option<(f64, f64)> {
    let stretches: Vec<(f64, f64)> =
        case.truth.iter().map(|t| t.place.map(|(a, b)| (a - NEAR, b + NEAR))).collect::<Option<Vec<_>>>()?;
    let parts: Vec<(f64, f64, f64)> = answer
        .places
        .iter()
        .filter_map(|p| Some((p.from_m?, p.to_m?, p.share?)))
        .filter(|p| p.1 > p.0 && p.2 > 0.0)
        .collect();
    let extent = parts.iter().map(|p| p.1).fold(0.0, f64::max);
    let local: Vec<_> = parts.into_iter().filter(|p| p.1 - p.0 <= LOCAL * extent).collect();
    let all: f64 = local.iter().map(|p| p.2).sum();
    if stretches.is_empty() || all <= 0.0 {
        return None;
    }
    let within = |from: f64, to: f64| {
        let common = stretches.iter().map(|(a, b)| (to.min(*b) - from.max(*a)).max(0.0)).sum::<f64>();
        common.min(to - from)
    };
    let hit: f64 = local.iter().map(|(from, to, share)| share * within(*from, *to) / (to - from)).sum();
    Some((hit / all, within(0.0, extent) / extent))
}
