//! What a layout violates, and a solution with that as a stage.

use super::sqp::{Solution, SqpSettings};
use super::{Stage, Status, Violation};
use crate::geometry::Track;
use crate::model::Layout;
use crate::problem::measures::{radius as radius_of, to_corners};
use crate::problem::{Function, Problem, RowKey, RowValue};
use std::time::Instant;

/// Turns and radii that are not the catalogue's. A radius that the layout fixes is the user's own choice.
pub(super) fn off_grid(layout: &Layout, problem: &Problem, x: &[f64], tolerance: f64) -> Vec<Violation> {
    let step = layout.catalog.curve.angle_step;
    let track = Track::new(&to_corners(x));
    let mut out = Vec::new();
    for (i, fillet) in track.fillets.iter().enumerate() {
        let (name, span) = (&layout.vertices[i].name, problem.vertex_span(i));
        let turn = (fillet.turn - (fillet.turn / step).round() * step).abs();
        if turn > tolerance {
            out.push(Violation { row: format!("angle step of the turn at {name}"), span, amount: turn, unit: "rad" });
        }
        let distance = |r: &f64| (r - fillet.radius).abs();
        let radius = layout.catalog.curve.radii.iter().map(distance).fold(f64::INFINITY, f64::min);
        let bound = problem.bounds[radius_of(i)];
        if radius > tolerance && bound.low < bound.high {
            out.push(Violation { row: format!("standard radius at {name}"), span, amount: radius, unit: "m" });
        }
    }
    out
}

pub(super) fn stage(
    name: &'static str,
    problem: &Problem,
    s: &Solution,
    settings: &SqpSettings,
    clock: Instant,
) -> Stage {
    let violations = violations(problem, &s.variables, settings.feasibility, |_| true);
    let max_violation = violations.iter().map(|v| v.amount).fold(s.max_violation, f64::max);
    let status = match (max_violation <= settings.feasibility, s.converged) {
        (true, true) => Status::Local,
        (true, false) => Status::Feasible,
        _ => Status::Infeasible,
    };
    Stage {
        name,
        corners: to_corners(&s.variables),
        length: problem.evaluate(&s.variables, 0.0).length,
        max_violation,
        violations,
        iterations: s.iterations,
        starts: 1,
        seconds: clock.elapsed().as_secs_f64(),
        status,
        cut: None,
        certificate: None,
        refuted: false,
    }
}

/// The written layout. Turns and straights that the catalogue lacks are not violations here: elements report them.
pub(super) fn as_written(problem: &Problem) -> Stage {
    // Rows begin with a turn and a straight a vertex; later ones on straights are the user's.
    let from_catalog = |key: RowKey| match key {
        RowKey::Listed(i) => {
            let catalogue = 2 * problem.vertices.len();
            i < catalogue && matches!(problem.rows[i].function, Function::Turn(_) | Function::Straight(_))
        }
        RowKey::Clearance(..) | RowKey::Own(..) | RowKey::Gap(..) => false,
    };
    let violations = violations(problem, &problem.start, SqpSettings::default().feasibility, |key| !from_catalog(key));
    Stage {
        name: "written",
        corners: to_corners(&problem.start),
        length: problem.evaluate(&problem.start, 0.0).length,
        max_violation: violations.iter().map(|v| v.amount).fold(0.0, f64::max),
        violations,
        iterations: 0,
        starts: 1,
        seconds: 0.0,
        status: Status::AsWritten,
        cut: None,
        certificate: None,
        refuted: false,
    }
}

/// Rows that are violated by more than `tolerance`, the worst first; several places of one obstacle count once.
fn violations(problem: &Problem, x: &[f64], tolerance: f64, counts: impl Fn(RowKey) -> bool) -> Vec<Violation> {
    let at = problem.evaluate(x, 0.0);
    let mut out: Vec<Violation> = Vec::new();
    let mut rows: Vec<&RowValue> = at.rows.iter().filter(|r| counts(r.key) && r.violation() > tolerance).collect();
    rows.sort_by(|a, b| b.violation().total_cmp(&a.violation()).then(a.key.cmp(&b.key)));
    for row in rows {
        let (label, span) = problem.describe(row.key);
        if out.iter().all(|v| v.row != label || v.span != span) {
            out.push(Violation { row: label, span, amount: row.violation(), unit: problem.unit(row.key) });
        }
    }
    // Rows watch where strands come close; strands that have crossed are beyond them.
    let pieces = &at.track.pieces;
    for (i, j) in problem.crossings(&at.track) {
        let (first, second) = (problem.piece_name(&pieces[i]), problem.piece_name(&pieces[j]));
        let row = format!("the loop crosses itself: {first} and {second}");
        let span = problem.vertex_span(pieces[i].vertex);
        out.push(Violation { row, span, amount: 2.0 * problem.half_width, unit: "m" });
    }
    out
}
