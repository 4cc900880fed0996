//! What a solve has to say to the user: rows that no layout meets, as diagnostics on the lines they come from.

use super::conflict::{self, Conflict};
use super::left_over::lengthen;
use super::{Stage, Status, Violation};
use crate::base::number::trimmed;
use crate::base::trig::PI;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{CentreLine, Track};
use crate::kinematics::{Fit, fit};
use crate::model::Layout;

/// Rows named in one message besides the worst.
const MOST_RELATED: usize = 7;

/// Diagnostics of the last stage: none for a clean result. Where constraints contradict each other, the lines that do.
pub fn diagnose(layout: &Layout, stages: &[Stage]) -> Vec<Diagnostic> {
    let Some(last) = stages.last() else { return Vec::new() };
    let conflicts = conflicts(layout, stages);
    if !conflicts.is_empty() {
        return conflicts.iter().map(conflict::said).collect();
    }
    let (code, message) = match last.status {
        Status::Infeasible => {
            let what = match last.name {
                "stage1" => "no layout was found that meets the constraints and the building",
                "stage2" => "no layout was found that meets the constraints and passes every obstacle",
                _ => "no layout on the catalogue's grid was found that meets every constraint",
            };
            (Code::E0601, what.to_owned())
        }
        Status::AsWritten if !last.violations.is_empty() => {
            (Code::E0602, "the written layout does not meet its constraints".to_owned())
        }
        _ => return Vec::new(),
    };
    let Some((worst, others)) = last.violations.split_first() else { return Vec::new() };
    let mut diagnostic = Diagnostic::new(code, message, worst.span, said(worst));
    for other in others.iter().take(MOST_RELATED) {
        diagnostic = diagnostic.related(other.span, said(other));
    }
    let help = match last.status {
        Status::AsWritten => "move the vertices, or let the compiler do it: `optimise length`",
        _ if last.refuted => {
            "the search over the catalogue's grid has proven that there is none, for turns that go the way they are \
             written and as often around. The best layout found is written, marked NOT FEASIBLE"
        }
        _ if last.cut.is_some() => {
            "the limit of time ended the search for one: give it more. The best layout found is written, marked NOT \
             FEASIBLE"
        }
        _ => {
            "that none was found is no proof that there is none. The best layout found is written, marked NOT \
             FEASIBLE: \
             relaxing one of these lines by at least what it lacks may help, or vertices written nearer to what is \
             wanted"
        }
    };
    vec![diagnostic.help(help)]
}

/// Why the last stage found no layout: smallest sets of lines that no layout was found for. None where they are not
/// found, or where a limit of time ended the search over the grid: nothing contradicts then.
pub fn conflicts(layout: &Layout, stages: &[Stage]) -> Vec<Conflict> {
    match stages.last() {
        Some(last) if last.status == Status::Infeasible => match last.name {
            "stage1" | "stage2" => conflict::conflicts(layout, last),
            "stage3" if last.cut.is_none() => conflict::grid(layout, stages),
            _ => Vec::new(),
        },
        _ => Vec::new(),
    }
}

/// Why the chain does not close on a solved layout, if closing is asked for: by how much, and which sections to change.
pub fn unclosed(layout: &Layout, track: &Track, line: &CentreLine) -> Option<Diagnostic> {
    let closes = layout.chain.closes_within.as_ref()?;
    let pitch = layout.cart.length;
    let Some(Fit { carts, left_over }) = fit(line, pitch) else {
        let message = "no chain of these carts closes on this track";
        let label = format!("carts of {} mm", trimmed(1e3 * pitch, 1));
        let help = "use shorter carts, or a longer track";
        return Some(Diagnostic::new(Code::E0603, message, closes.span, label).help(help));
    };
    if (Fit { carts, left_over }).is_within(closes.value) {
        return None;
    }
    let within = trimmed(1e3 * closes.value, 1);
    let message = format!("no whole number of carts closes the chain within {within} mm");
    let too = if left_over > 0.0 { "long" } else { "short" };
    let label = format!("for {carts} carts, the track is {} mm too {too}", trimmed(1e3 * left_over.abs(), 1));
    let help = lengthen(layout, track, left_over)
        .unwrap_or_else(|| "give a section some freedom, so that the track can be lengthened".to_owned());
    Some(Diagnostic::new(Code::E0603, message, closes.span, label).help(help))
}

/// `clearance of column_a to the straight P4..P5: 0.214 m short`
fn said(violation: &Violation) -> String {
    let (amount, unit) = match violation.unit {
        "rad" => (violation.amount * 180.0 / PI, "°"),
        unit => (violation.amount, unit),
    };
    let size = if amount < 1e-4 { format!("{amount:.1e}") } else { trimmed(amount, 4) };
    let space = if matches!(unit, "°" | "") { "" } else { " " };
    format!("{}: off by {size}{space}{unit}", violation.row)
}
