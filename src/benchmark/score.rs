//! The table of a challenge: what answers are worth, from key and answers alone.

use super::key::{Answer, Case, CaseKind, StrengthLevel};
use super::scored_case::{ScoredCase, score_case};
use super::statistics::{Bin, Mean, Share, area, brier, calibration, mean};
use crate::effects::LIBRARY;
use crate::gap::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;

/// A scored challenge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    pub cases: usize,
    /// Cases without an answer: they count as wrong.
    pub failed: usize,
    /// One effect, pairs and sensors that are medium or strong.
    pub headline: Accuracy,
    pub by_kind: Vec<ScoreRow>,
    /// One effect, pairs and sensors by strength over the repeatability.
    pub by_level: Vec<ScoreRow>,
    /// Cases with an effect, by each effect that they have.
    pub by_effect: Vec<ScoreRow>,
    /// Of the cases without a gap, those that were said to have one.
    pub false_alarms: Share,
    /// Probability of "unknown": how well it parts unknown effects from all else, and those of medium and strong level
    /// from all else.
    pub unknown_area: Option<Mean>,
    pub unknown_area_clear: Option<Mean>,
    /// Over all cases and effects of the library, and the same of one who always says how often an effect occurs.
    pub brier: Option<Mean>,
    pub brier_of_prevalence: Option<f64>,
    pub calibration: Vec<Bin>,
    /// Places that are said of effects which are named.
    pub places: Share,
    /// Share of the local gap where the truth acts, and what a map without knowledge would have there.
    pub overlap: Option<Mean>,
    pub overlap_by_chance: Option<Mean>,
    /// Strength intervals (90 %) that hold the truth, of effects that are named.
    pub coverage: Share,
    pub closed: Option<Mean>,
    pub closed_oracle: Option<Mean>,
    pub closed_placebo: Option<Mean>,
    pub closed_black_box: Option<Mean>,
    pub each: Vec<CaseRow>,
}

/// How often the truth is first, and among the first three.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    pub top_1: Share,
    pub top_3: Share,
    pub top_1_group: Share,
    pub top_3_group: Share,
    pub probability: Option<Mean>,
}

/// Accuracy of some cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoreRow {
    pub name: String,
    pub accuracy: Accuracy,
}

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseRow {
    pub name: String,
    pub kind: CaseKind,
    pub truth: Vec<String>,
    pub strength_over_floor: f64,
    pub level: Option<StrengthLevel>,
    pub answered: bool,
    #[serde(flatten)]
    pub scored: ScoredCase,
}

/// Scores answers by the name of their case; a case without one is a failure.
pub fn score(cases: &[Case], answers: &BTreeMap<String, Answer>) -> Score {
    let nothing = Answer::default();
    let answer = |case: &Case| answers.get(&case.name).unwrap_or(&nothing);
    let all: Vec<(&Case, ScoredCase)> = cases.iter().map(|case| (case, score_case(case, answer(case)))).collect();
    let some = |keep: &dyn Fn(&Case) -> bool| -> Accuracy {
        accuracy(&all.iter().filter(|(c, _)| keep(c)).map(|(_, j)| j).collect::<Vec<_>>())
    };
    let clear = |c: &Case| matches!(c.level, Some(StrengthLevel::Medium | StrengthLevel::Strong));
    let values = |of: &dyn Fn(&Case, &ScoredCase) -> Option<f64>| {
        mean(&all.iter().filter_map(|(c, j)| of(c, j)).collect::<Vec<_>>())
    };
    let unknown = |keep: &dyn Fn(&Case) -> bool| -> Vec<f64> {
        all.iter().filter(|(c, _)| keep(c)).map(|(_, j)| j.unknown).collect()
    };
    let others = unknown(&|c| c.kind != CaseKind::Unknown);
    let (forecasts, prevalence) = forecasts(cases, &answer);
    let mut effects: Vec<&str> = cases.iter().flat_map(|c| c.truth.iter().map(|t| t.effect.as_str())).collect();
    effects.sort_unstable();
    effects.dedup();
    Score {
        cases: cases.len(),
        failed: cases.iter().filter(|c| !answers.contains_key(&c.name)).count(),
        headline: some(&|c| c.kind.nameable() && clear(c)),
        by_kind: CaseKind::ALL
            .into_iter()
            .map(|kind| ScoreRow { name: kind.name().to_owned(), accuracy: some(&|c| c.kind == kind) })
            .collect(),
        by_level: StrengthLevel::ALL
            .into_iter()
            .map(|level| ScoreRow {
                name: level.name().to_owned(),
                accuracy: some(&|c| c.kind.nameable() && c.level == Some(level)),
            })
            .collect(),
        by_effect: effects
            .into_iter()
            .map(|effect| ScoreRow {
                name: effect.to_owned(),
                accuracy: some(&|c| c.truth.iter().any(|t| t.effect == effect)),
            })
            .collect(),
        false_alarms: Share::of_all(
            all.iter().filter(|(c, _)| c.kind == CaseKind::None).map(|(_, j)| j.verdict != Some(Verdict::None)),
        ),
        unknown_area: area(&unknown(&|c| c.kind == CaseKind::Unknown), &others),
        unknown_area_clear: area(&unknown(&|c| c.kind == CaseKind::Unknown && clear(c)), &others),
        brier: brier(&forecasts),
        brier_of_prevalence: brier(&prevalence).map(|m| m.value),
        calibration: calibration(&forecasts),
        places: Share::of_all(all.iter().flat_map(|(_, j)| j.placed.iter().copied())),
        overlap: values(&|_, j| j.overlap.map(|o| o.0)),
        overlap_by_chance: values(&|_, j| j.overlap.map(|o| o.1)),
        coverage: Share::of_all(all.iter().flat_map(|(_, j)| j.covered.iter().copied())),
        closed: values(&|c, j| j.closed.filter(|_| c.kind.nameable())),
        closed_oracle: values(&|c, j| c.oracle.filter(|_| c.kind.nameable() && j.closed.is_some())),
        closed_placebo: values(&|c, j| j.closed_placebo.filter(|_| c.kind.nameable() && j.closed.is_some())),
        closed_black_box: values(&|c, j| j.closed_black_box.filter(|_| c.kind.nameable() && j.closed.is_some())),
        each: all
            .iter()
            .map(|(case, scored)| CaseRow {
                name: case.name.clone(),
                kind: case.kind,
                truth: case.truth.iter().map(|t| t.effect.clone()).collect(),
                strength_over_floor: case.strength_over_floor,
                level: case.level,
                answered: answers.contains_key(&case.name),
                scored: scored.clone(),
            })
            .collect(),
    }
}

fn accuracy(all: &[&ScoredCase]) -> Accuracy {
    let within = |of: fn(&ScoredCase) -> usize, most: usize| Share::of_all(all.iter().map(|j| of(j) <= most));
    Accuracy {
        top_1: within(|j| j.rank.exact, 1),
        top_3: within(|j| j.rank.exact, 3),
        top_1_group: within(|j| j.rank.group, 1),
        top_3_group: within(|j| j.rank.group, 3),
        probability: mean(&all.iter().map(|j| j.probability).collect::<Vec<_>>()),
    }
}

/// Probabilities, and whether they came true.
type Forecasts = Vec<(f64, bool)>;

/// Probability and presence of each effect of the library in each case, and the same with each effect's share of the
/// cases for probability.
fn forecasts<'a>(cases: &[Case], answer: &impl Fn(&Case) -> &'a Answer) -> (Forecasts, Forecasts) {
    let present =
        |case: &Case, effect: &str| case.kind != CaseKind::Unknown && case.truth.iter().any(|t| t.effect == effect);
    let (mut said, mut usual) = (Vec::new(), Vec::new());
    for effect in LIBRARY {
        let how_often = cases.iter().filter(|c| present(c, effect.name())).count() as f64 / cases.len().max(1) as f64;
        for case in cases {
            said.push((answer(case).probability(effect.name()), present(case, effect.name())));
            usual.push((how_often, present(case, effect.name())));
        }
    }
    (said, usual)
}
