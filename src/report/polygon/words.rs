//! What cancels what, in sentences.

use super::{CurveReport, Straight, angle};
use crate::base::number::{fixed, trimmed};
use crate::base::trig;
use crate::base::words::list;
use crate::kinematics::polygon::{Action, Phasor, PolygonObjective};
use maud::{Markup, html};

/// A curve this far below its most has ends that cancel.
const OWN: f64 = 0.35;
/// Two curves cancel where less than this part of both remains, and add where more than the other does.
const CANCELS: f64 = 0.4;
const ADDS: f64 = 0.92;
/// Pairs that are said, the strongest first.
const PAIRS: usize = 6;
/// A share that is worth a word.
const SHARE: f64 = 0.05;

/// Sentences about one layout.
pub fn notes(
    curves: &[CurveReport],
    straights: &[Straight],
    parts: &[Vec<Phasor>],
    action: &Action,
    objective: PolygonObjective,
) -> Vec<String> {
    let mut out = Vec::new();
    out.extend(roughest(straights));
    out.extend(alone(curves));
    out.extend(pairs(curves, parts));
    out.extend(weight(curves, objective));
    out.extend(beyond_first(action, objective));
    out
}

/// Words with what stands between backticks as code.
pub fn with_code(words: &str) -> Markup {
    html! {
        @for (k, part) in words.split('`').enumerate() {
            @if k % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

fn mm(value: f64) -> String {
    format!("{} mm", fixed(value, 2))
}

fn roughest(straights: &[Straight]) -> Option<String> {
    let by_rms = |a: &&Straight, b: &&Straight| a.rms_mm.total_cmp(&b.rms_mm);
    let (most, least) = (straights.iter().max_by(by_rms)?, straights.iter().min_by(by_rms)?);
    Some(format!(
        "The chain runs roughest on {}: {} in the mean of all starts, {} from {}. It runs most evenly on {}, {}.",
        most.name,
        mm(most.rms_mm),
        mm(most.worst_mm),
        most.worst_from,
        least.name,
        mm(least.rms_mm)
    ))
}

/// Curves whose own ends cancel.
fn alone(curves: &[CurveReport]) -> Option<String> {
    let quiet: Vec<String> = curves
        .iter()
        .filter_map(|c| c.most_mm.filter(|most| c.alone_mm < OWN * most).map(|most| (c, most)))
        .map(|(c, most)| format!("{} ({} carts long: {} of {})", c.name, fixed(c.carts, 2), mm(c.alone_mm), mm(most)))
        .collect();
    let verb = if quiet.len() == 1 {
        "does little by itself, because its ends cancel"
    } else {
        "do little by themselves, because their ends cancel"
    };
    (!quiet.is_empty()).then(|| format!("{} {verb}.", list(&quiet, "and")))
}

/// Neighbours that cancel or add.
fn pairs(curves: &[CurveReport], parts: &[Vec<Phasor>]) -> Vec<String> {
    let n = curves.len();
    if n < 2 {
        return Vec::new();
    }
    // Seen from the straight ahead of curve k, the chain passes k first and then k − 1.
    let mut found: Vec<(f64, String)> = (0..n)
        .filter_map(|k| {
            let (front, back) = (parts[(k + 1) % n][0], parts[(k + 1) % n][1]);
            let size = |h: Phasor| 2e3 * h.norm_sqr().sqrt();
            let both = size(front) + size(back);
            let left = size(front + back);
            let (a, b) = (&curves[(k + n - 1) % n], &curves[k]);
            let carts = angle(back, front).abs() / trig::TAU;
            let of = format!("{} ({}) and {} ({})", a.name, mm(size(back)), b.name, mm(size(front)));
            let apart = format!("{} of a cart apart in phase", trimmed(carts, 2));
            let smaller = size(front).min(size(back));
            if both <= 0.0 || smaller < 0.1 * both {
                None
            } else if left < CANCELS * both {
                Some((both - left, format!("{of} cancel, {apart}: {} remain.", mm(left))))
            } else if left > ADDS * both {
                Some((left - both * ADDS, format!("{of} add up, {apart}: {} together.", mm(left))))
            } else {
                None
            }
        })
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(PAIRS);
    found.into_iter().map(|(_, text)| text).collect()
}

/// Which curves make the objective what it is.
fn weight(curves: &[CurveReport], objective: PolygonObjective) -> Vec<String> {
    let mut order: Vec<&CurveReport> = curves.iter().collect();
    order.sort_by(|a, b| b.share.total_cmp(&a.share));
    let said = |c: &&CurveReport| format!("{} ({} %)", c.name, fixed(100.0 * c.share, 0));
    let most: Vec<String> = order.iter().filter(|c| c.share > SHARE).take(3).map(said).collect();
    let less: Vec<String> = order.iter().rev().filter(|c| c.share < -SHARE).take(3).map(said).collect();
    let mut out = Vec::new();
    if !most.is_empty() {
        out.push(format!("Most of `{}` comes from {}.", objective.name(), list(&most, "and")));
    }
    if !less.is_empty() {
        out.push(format!("{} make{} it less.", list(&less, "and"), if less.len() == 1 { "s" } else { "" }));
    }
    out
}

/// What lies beyond the first harmonic, where that is a good part.
fn beyond_first(action: &Action, objective: PolygonObjective) -> Option<String> {
    let (value, first) = (action.value(objective), action.smooth(objective));
    (value > 0.0 && first < 0.7 * value).then(|| {
        let percent = fixed(100.0 * (1.0 - first / value), 0);
        format!("First harmonics are mostly cancelled: {percent} % of `{}` lies beyond them.", objective.name())
    })
}
