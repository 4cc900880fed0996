//! What a line would have to give way by, in words.

use super::lines::{Kind, Line, Lines};
use crate::emit::number::trimmed;
use crate::geometry::trig::PI;
use crate::model::{Constraint, ConstraintKind, Layout, Unit};
use crate::problem::LEVER;

/// `5.193 m`, `0.21 mm`: rounded up, so that giving way by it is enough.
pub fn metres(amount: f64) -> String {
    match amount {
        a if a < 0.01 => format!("{} mm", up(a * 1e3)),
        a => format!("{} m", up(a)),
    }
}

fn degrees(amount: f64) -> String {
    format!("{}°", up(amount / LEVER * 180.0 / PI))
}

/// Rounded up to three decimals.
fn up(value: f64) -> String {
    trimmed((value * 1e3 - 1e-3).ceil() / 1e3, 3)
}

/// How far a line must give way while the others of its set hold.
pub fn alone(layout: &Layout, lines: &Lines, line: &Line, amount: Option<f64>) -> String {
    let Some(amount) = amount else {
        return "no change of this line alone was found that would do".to_owned();
    };
    match line.kind {
        Kind::Turns => format!("turns {} beyond these limits would do", degrees(amount)),
        Kind::Radii => format!("radii {} beyond these limits would do", metres(amount)),
        Kind::Building => format!("walls {} further out would do", metres(amount)),
        Kind::Obstacle => format!("{} closer would do", metres(amount)),
        Kind::Room => format!("{} less room would do", metres(amount)),
        Kind::Fix => format!("{} off its written place would do", metres(amount)),
        Kind::Require => require(layout, lines, line, amount),
    }
}

fn require(layout: &Layout, lines: &Lines, line: &Line, amount: f64) -> String {
    let unit = layout.constraints.iter().find(|c| c.span == line.span).map(unit);
    let size = match unit {
        Some(Unit::Radian) => degrees(amount),
        Some(Unit::Metre) => metres(amount),
        Some(Unit::SquareMetre) => format!("{} m²", up(amount)),
        _ => up(amount),
    };
    let row = match line.rows[..] {
        [row] => lines.row(row),
        _ => return format!("{size} off would do"),
    };
    if row.low.is_finite() { format!("{size} less would do") } else { format!("{size} more would do") }
}

fn unit(constraint: &Constraint) -> Unit {
    match constraint.kind {
        ConstraintKind::Require { unit, .. } => unit,
        _ => Unit::Metre,
    }
}
