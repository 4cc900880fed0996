//! Layouts that no other one beats in two or three measures: tracks that trade what a track decides, and on them whatever
//! components the layout leaves open.

use super::candidate::{Candidate, Requirement};
use super::find::{self, Chosen, TooMany};
use super::refused::words;
use super::tracks::{self, Track};
use super::trade::{Measure, front};
use crate::compiled::Compiled;
use crate::model::{Layout, Objective, Stands};
use crate::solve::{Certificate, Counted, End, Options, Tell};

/// One of them.
#[derive(Clone, Debug)]
pub struct Traded {
    /// With its components.
    pub compiled: Compiled,
    /// In the order of the measures.
    pub values: Vec<f64>,
    /// What its track is the best of, as far as is known; `certificate` is of that.
    pub objective: Objective,
    /// The end whose radii it keeps.
    pub radii: Option<End>,
    pub certificate: Option<Certificate>,
    /// Its components, in words, where the layout leaves some open.
    pub choice: Option<String>,
}

/// How good the best layout in one measure is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    pub value: f64,
    /// No layout on the grid has less; `None` where nothing is proven of this measure.
    pub bound: Option<f64>,
    /// Whether it is known to be the best without a bound: every component was looked at, and no track matters.
    pub proven: bool,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Pareto {
    pub measures: Vec<Measure>,
    /// By the first measure, the best first.
    pub layouts: Vec<Traded>,
    /// Of each measure; empty where there is no layout.
    pub ends: Vec<Best>,
    /// Tracks that were found, and layouts on them that do what is required.
    pub tracks: usize,
    pub candidates: usize,
    /// A measure that none of them has.
    pub lacking: Option<Measure>,
    /// Whether the time was up before all was done.
    pub cut: bool,
}

/// Trades these measures. Components that the layout leaves open with `choose` are chosen in closed form, and do what is
/// required in it; others are as written.
///
/// # Errors
/// [`TooMany`]
pub fn pareto(layout: &Layout, measures: &[Measure], options: &Options, watch: Tell) -> Result<Pareto, TooMany> {
    let open = layout.choice.is_open();
    let by_cart = open && measures.iter().any(|m| matches!(m, Measure::Price | Measure::Smoothness));
    let asked = tracks::asked(layout, by_cart).len();
    find::few_enough(layout, asked)?;
    let tracks = tracks::traded(layout, &ends(measures), by_cart, options, watch);
    let fitted = find::fitted(layout, &tracks, options.threads);
    let candidates = find::candidates(layout, &tracks, &fitted, None);
    // What only a choice has to do is not asked of components that are as written.
    let held = |requirement: Requirement| open || requirement == Requirement::Capacity;
    let serves = |c: &Candidate| c.shortfalls.iter().all(|s| !held(s.requirement));
    let order: Vec<usize> = (0..candidates.len()).filter(|k| serves(&candidates[*k])).collect();
    let chosen = Chosen::of(layout, tracks, fitted, candidates, order);
    let row = |k: &usize| Some((*k, measures.iter().map(|m| m.of(&chosen, *k)).collect::<Option<Vec<f64>>>()?));
    let rows: Vec<(usize, Vec<f64>)> = chosen.order.iter().filter_map(row).collect();
    let missing = |m: &&Measure| !chosen.order.is_empty() && chosen.order.iter().all(|k| m.of(&chosen, *k).is_none());
    // What stands where along the loop is then the same on every track, and so is what it takes.
    let settled = !layout.equipment.declared.iter().any(|d| matches!(d.stands, Stands::Free { .. }))
        && variants(&chosen) == asked
        && options.stop.cut().is_none();
    let best = |i: usize, measure: Measure| {
        let values = rows.iter().map(|(_, values)| values[i]);
        let value = if measure.is_gain() { values.reduce(f64::max) } else { values.reduce(f64::min) };
        value.map(|value| Best {
            proven: measure == Measure::Capacity && settled,
            value,
            bound: bound(&chosen, measure, asked).filter(|_| measure != Measure::Price || !open),
        })
    };
    let gains = measures.iter().map(|m| m.is_gain()).collect();
    let stepped = |values: &[f64]| values.iter().zip(measures).map(|(v, m)| (v / m.step()).round()).collect();
    // Of those that are alike, the first of all.
    let alike = front(rows.iter().enumerate().map(|(i, (_, values))| (i, stepped(values))).collect(), gains);
    let traded = |(i, _): &(usize, Vec<f64>)| {
        let (k, values) = &rows[*i];
        let candidate = &chosen.candidates[*k];
        let track: &Track = chosen.track(candidate);
        Some(Traded {
            compiled: chosen.built(candidate)?,
            values: values.clone(),
            objective: track.objective.clone(),
            radii: track.radii,
            certificate: track.compiled.stages.last().and_then(|stage| stage.certificate.clone()),
            choice: open.then(|| words(&chosen, candidate)),
        })
    };
    Ok(Pareto {
        layouts: alike.iter().filter_map(traded).collect(),
        ends: measures.iter().enumerate().filter_map(|(i, m)| best(i, *m)).collect(),
        lacking: measures.iter().find(missing).copied(),
        cut: options.stop.cut().is_some(),
        measures: measures.to_vec(),
        tracks: chosen.tracks.len(),
        candidates: rows.len(),
    })
}

/// How many of what was asked for have a track.
fn variants(chosen: &Chosen) -> usize {
    let mut seen: Vec<&Track> = Vec::new();
    for track in &chosen.tracks {
        let same = |other: &&Track| {
            (other.radius, other.length, other.left_over) == (track.radius, track.length, track.left_over)
                && other.counts == track.counts
        };
        if !seen.iter().any(same) {
            seen.push(track);
        }
    }
    seen.len()
}

/// What tracks have to be best in.
fn ends(measures: &[Measure]) -> Vec<End> {
    let end = |measure: &Measure| match measure {
        Measure::Price => Some(End::TotalPrice),
        Measure::Cost => Some(End::Cost),
        // The floor of a band and what a chain takes to run grow with the length.
        Measure::Footprint | Measure::Energy | Measure::Length => Some(End::Length),
        Measure::Smoothness => Some(End::PolygonAction),
        Measure::Capacity => None,
    };
    let mut ends: Vec<End> = Vec::new();
    for end in measures.iter().filter_map(end) {
        if !ends.contains(&end) {
            ends.push(end);
        }
    }
    // A track there has to be.
    if ends.is_empty() {
        ends.push(End::TotalPrice);
    }
    ends
}

/// What no layout on the grid has less of, as far as is proven: the least of what is proven of each track that is asked
/// for. A price is proven with the components that are written only.
fn bound(chosen: &Chosen, measure: Measure, asked: usize) -> Option<f64> {
    let is_end = |c: &Certificate| match measure {
        Measure::Length | Measure::Footprint => c.counted == Counted::Length,
        Measure::Cost => c.counted == (Counted::Price { metre: 0.0 }) && !c.in_all,
        Measure::Price => c.in_all,
        Measure::Capacity | Measure::Smoothness | Measure::Energy => false,
    };
    let of = |track: &Track| {
        let certificate = track.compiled.stages.last()?.certificate.as_ref()?;
        (certificate.budget.is_none() && is_end(certificate)).then_some(certificate.lower_bound)
    };
    let bounds: Vec<f64> = chosen.tracks.iter().filter_map(of).collect();
    let least = bounds.iter().copied().reduce(f64::min).filter(|_| bounds.len() == asked)?;
    Some(if measure == Measure::Footprint { least * chosen.layout.width.value } else { least })
}
