//! Rows of a search for an even run: its budget of length, and the closing of the chain by the series of what curves cut
//! off.

use crate::geometry::Track;
use crate::model::{Constraint, ConstraintKind, Formula, Layout, Target, Unit};
use crate::problem::measures::to_corners;
use crate::source::Span;

/// The chain closes with so many carts, to `slack`, m, where it leaves `beyond`, m, over more than the series says.
pub fn closing(layout: &Layout, carts: f64, (slack, beyond): (f64, f64), span: Span) -> Constraint {
    let pitch = layout.cart.length;
    let middle = carts * pitch - beyond;
    let limits = (middle - slack, middle + slack);
    row(chain_path(layout, pitch), limits, span, format!("the chain closes with {carts} carts"))
}

/// A formula between limits, m.
pub fn row(formula: Formula, (low, high): (f64, f64), span: Span, reason: String) -> Constraint {
    let kind = ConstraintKind::Require { formula, low, high, unit: Unit::Metre };
    Constraint { kind, span, reason: Some(reason) }
}

/// Length of the track less what chords of this length cut off: Σ θL²/(24R) − L³/(120R²) (design: chain model), m.
pub fn chain_path(layout: &Layout, pitch: f64) -> Formula {
    let n = layout.vertices.len();
    let square = pitch * pitch;
    let mut terms = Vec::new();
    for i in 0..n {
        let turn = || Formula::Absolute(Box::new(Formula::Angle(i)));
        let bend = || Formula::Reciprocal(Box::new(Formula::Radius(i)));
        terms.push(Formula::Length(Target { from: i, straight: true }));
        terms.push(Formula::Product(vec![Formula::Radius(i), turn()]));
        if pitch > 0.0 {
            terms.push(Formula::Product(vec![Formula::Constant(-square / 24.0), turn(), bend()]));
            terms.push(Formula::Product(vec![Formula::Constant(square * pitch / 120.0), bend(), bend()]));
        }
    }
    Formula::Sum(terms)
}

/// The same as a number.
pub fn path(variables: &[f64], pitch: f64) -> f64 {
    let track = Track::new(&to_corners(variables));
    let excess = |f: &crate::geometry::Fillet| {
        pitch * pitch * (f.turn.abs() / (24.0 * f.radius) - pitch / (120.0 * f.radius * f.radius))
    };
    track.length - track.fillets.iter().map(excess).sum::<f64>()
}
