//! What a solve has to say to the user: rows that no layout meets, as diagnostics on the lines they come from.

use super::{Stage, Status, Violation, conflict};
use crate::diagnostic::{Code, Diagnostic};
use crate::emit::number::trimmed;
use crate::geometry::trig::PI;
use crate::model::Layout;

/// Rows named in one message besides the worst.
const MOST_RELATED: usize = 7;

/// Diagnostics of the last stage: none for a clean result. Where constraints contradict each other, the lines that do.
pub fn diagnose(layout: &Layout, stages: &[Stage]) -> Vec<Diagnostic> {
    let Some(last) = stages.last() else { return Vec::new() };
    let continuous = matches!(last.name, "stage1" | "stage2");
    if last.status == Status::Infeasible
        && continuous
        && let Some(conflict) = conflict::conflict(layout, last)
    {
        return vec![conflict];
    }
    let (code, message) = match last.status {
        Status::Infeasible => {
            let what = match last.name {
                "stage1" => "no layout meets the constraints and the building",
                "stage2" => "no layout meets the constraints and passes every obstacle",
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
        _ => {
            "the best layout found is written, marked NOT FEASIBLE; relax one of these lines by at least what it lacks"
        }
    };
    vec![diagnostic.help(help)]
}

/// `clearance of column_a to the straight P4..P5: 0.214 m short`
fn said(violation: &Violation) -> String {
    let (amount, unit) = match violation.unit {
        "rad" => (violation.amount * 180.0 / PI, "°"),
        unit => (violation.amount, unit),
    };
    let size = if amount < 1e-4 { format!("{amount:.1e}") } else { trimmed(amount, 4) };
    let space = if unit == "°" { "" } else { " " };
    format!("{}: off by {size}{space}{unit}", violation.row)
}
