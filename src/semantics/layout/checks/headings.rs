//! Headings that lines hold and that no whole number of the catalogue's angle steps joins. Every turn of a layout on the
//! grid is a multiple of the step, so all its headings are one heading and multiples.

use super::Facts;
use super::fixed::held;
use crate::base::number::{shortest, trimmed};
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::Track;
use crate::model::{Constraint, ConstraintKind, FixKind, Formula, HEADING_TOLERANCE, TOLERANCE, Unit, Vertex};
use crate::semantics::layout::Geometry;
use crate::semantics::scope::Context;
use crate::source::Span;

/// A heading that lines hold.
struct Held {
    /// rad
    heading: f64,
    /// The line to look at, and another one that it takes to hold the heading.
    span: Span,
    with: Option<Span>,
    /// The section where a `fix` holds it; else a `require` does.
    section: Option<usize>,
}

impl Held {
    /// How far from the grid counted from another heading it may be, rad.
    fn slack(&self, other: &Held) -> f64 {
        if self.section.is_some() && other.section.is_some() { HEADING_TOLERANCE } else { 2.0 * TOLERANCE }
    }
}

/// The catalogue's angle step.
struct Grid {
    /// rad
    step: f64,
    span: Span,
}

impl Grid {
    /// How far an angle is from the nearest multiple of the step, rad.
    fn off(&self, angle: f64) -> f64 {
        (angle - (angle / self.step).round() * self.step).abs()
    }

    /// The multiples of the step around an angle, counted from `origin`: `10 deg or 12.5 deg`.
    fn around(&self, angle: f64, origin: f64) -> [f64; 2] {
        let below = ((angle - origin) / self.step).floor();
        [below, below + 1.0].map(|steps| origin + steps * self.step)
    }
}

impl Context<'_> {
    /// Compares all headings and turns that lines hold with the catalogue's grid.
    pub fn check_headings(&self, constraints: &[Constraint], vertices: &[Vertex], geometry: &Geometry, facts: &Facts) {
        let (Some(track), Some(catalog)) = (&geometry.track, facts.catalog) else { return };
        let grid = Grid { step: catalog.curve.angle_step, span: catalog.span };
        // What is compiled as written may have any turn, and where the step does not divide a full turn there is no grid.
        if facts.as_written() || grid.off(trig::TAU) > TOLERANCE {
            return;
        }
        let mut held = fixed_headings(constraints, vertices.len(), track);
        for constraint in constraints {
            let ConstraintKind::Require { formula, low, high, unit: Unit::Radian } = &constraint.kind else { continue };
            let stated = low == high && !matches!(formula, Formula::Constant(_));
            let Some(sum) = AngleSum::of(formula).filter(|_| stated) else { continue };
            let angle = low - sum.constant;
            match sum.headings {
                0 => self.check_turn(constraint, angle, &grid),
                1 | -1 => held.push(Held {
                    heading: trig::wrap(angle * f64::from(sum.headings)),
                    span: constraint.span,
                    with: None,
                    section: None,
                }),
                _ => {}
            }
        }
        held.sort_by_key(|h| (h.span.file.0, h.span.start));
        let joins = |a: &Held, b: &Held| grid.off(a.heading - b.heading) <= a.slack(b);
        let joined = |a: &Held| held.iter().filter(|b| joins(a, b)).count();
        // The grid that most lines share; of as many, the first one's.
        let most = held.iter().map(joined).max().unwrap_or(0);
        let Some(anchor) = held.iter().find(|h| joined(h) == most) else { return };
        for off in held.iter().filter(|h| !joins(anchor, h)) {
            self.report_off(off, anchor, vertices, &grid);
        }
    }

    fn report_off(&self, off: &Held, anchor: &Held, vertices: &[Vertex], grid: &Grid) {
        let next = |i: usize| (i + 1) % vertices.len();
        let name = |i: usize| format!("`{}..{}`", vertices[i].name, vertices[next(i)].name);
        let what = match off.section {
            Some(i) => format!("the heading of {} is fixed", name(i)),
            None => "this holds a heading".to_owned(),
        };
        let near = grid.around(off.heading, anchor.heading);
        let counted = match anchor.section {
            Some(i) => format!("headings are counted from here: {} at {}", name(i), shown(anchor.heading)),
            None => format!("headings are counted from here: {}", shown(anchor.heading)),
        };
        let mut diagnostic = Diagnostic::new(
            Code::E0502,
            format!("{what} off the grid of headings"),
            off.span,
            format!("at {}", shown(off.heading)),
        )
        .expected(
            format!("{} or {}, as turns are multiples of {}", shown(near[0]), shown(near[1]), shown(grid.step)),
            shown(off.heading),
        )
        .related(anchor.span, counted);
        for span in off.with.iter().chain(&anchor.with) {
            diagnostic = diagnostic.related(*span, "holds the other end");
        }
        let help = match off.section {
            Some(i) => {
                let shared = anchor.section == Some(next(i));
                let moved = if shared { i } else { next(i) };
                let places =
                    near.map(|heading| format!("`{}` for {}", placed(vertices, i, shared, heading), shown(heading)));
                format!(
                    "put `{}` at {}, or at {}; or leave one of the two headings free",
                    vertices[moved].name, places[0], places[1]
                )
            }
            None => format!("write {} or {}", shown(near[0]), shown(near[1])),
        };
        self.report(diagnostic.related(grid.span, "the catalogue's angle step").help(help));
    }

    /// A sum of turns, or a difference of headings.
    fn check_turn(&self, constraint: &Constraint, angle: f64, grid: &Grid) {
        if grid.off(angle) <= TOLERANCE {
            return;
        }
        let near = grid.around(angle, 0.0).map(shown);
        self.report(
            Diagnostic::new(
                Code::E0501,
                "no turns on the catalogue's grid make this angle",
                constraint.span,
                format!("wants {}", shown(angle)),
            )
            .expected(
                format!("{} or {}, as turns are multiples of {}", near[0], near[1], shown(grid.step)),
                shown(angle),
            )
            .related(grid.span, "the catalogue's angle step")
            .help(format!("write {} or {}, or a range with `>=` and `<=`", near[0], near[1])),
        );
    }
}

/// Headings of sections that are fixed: by `fix rotation`, or at both ends.
fn fixed_headings(constraints: &[Constraint], n: usize, track: &Track) -> Vec<Held> {
    let ends = held(constraints, n);
    let rotation = |i: usize| {
        constraints.iter().find(|c| {
            matches!(&c.kind, ConstraintKind::FixSection { target, kinds }
                if target.from == i && kinds.contains(&FixKind::Rotation))
        })
    };
    let of = |i: usize| {
        let (span, with) = match (rotation(i), ends[i], ends[(i + 1) % n]) {
            (Some(constraint), ..) => (constraint.span, None),
            (None, Some(a), Some(b)) => (a.max(b), Some(a.min(b)).filter(|_| a != b)),
            _ => return None,
        };
        Some(Held { heading: track.straight(i).heading, span, with, section: Some(i) })
    };
    (0..n).filter_map(of).collect()
}

/// Where a vertex of a section lies for a heading of it: `(3 m + 20 m * cos(15 deg), 4 m + 20 m * sin(15 deg))`.
fn placed(vertices: &[Vertex], section: usize, first: bool, heading: f64) -> String {
    let next = (section + 1) % vertices.len();
    let (from, sign) = if first { (next, '-') } else { (section, '+') };
    let point = vertices[from].point;
    let length = trimmed(vertices[section].point.distance(vertices[next].point), 3);
    let at = |start: f64, function: &str| {
        format!("{} m {sign} {length} m * {function}({})", shortest(start), shown(heading))
    };
    format!("({}, {})", at(point.x, "cos"), at(point.y, "sin"))
}

/// As exact as a heading has to be: `12.5 deg`.
fn shown(angle: f64) -> String {
    format!("{} deg", trimmed(angle.to_degrees(), 9))
}

/// A whole number of headings, and whole numbers of turns and a constant beside them.
#[derive(Clone, Copy)]
struct AngleSum {
    headings: i32,
    /// rad
    constant: f64,
}

impl AngleSum {
    fn of(formula: &Formula) -> Option<AngleSum> {
        let plain = |headings: i32, constant: f64| Some(AngleSum { headings, constant });
        match formula {
            Formula::Constant(value) => plain(0, *value),
            Formula::Heading(_) => plain(1, 0.0),
            Formula::Angle(_) => plain(0, 0.0),
            Formula::Negative(inner) => AngleSum::of(inner).map(|sum| sum.times(-1)),
            Formula::Sum(terms) => terms.iter().try_fold(AngleSum { headings: 0, constant: 0.0 }, |all, term| {
                let one = AngleSum::of(term)?;
                Some(AngleSum { headings: all.headings + one.headings, constant: all.constant + one.constant })
            }),
            Formula::Product(factors) => match &factors[..] {
                [Formula::Constant(k), inner] | [inner, Formula::Constant(k)] if k.fract() == 0.0 && k.abs() < 1e6 => {
                    AngleSum::of(inner).map(|sum| sum.times(*k as i32))
                }
                _ => None,
            },
            _ => None,
        }
    }

    fn times(self, k: i32) -> AngleSum {
        AngleSum { headings: self.headings * k, constant: self.constant * f64::from(k) }
    }
}
