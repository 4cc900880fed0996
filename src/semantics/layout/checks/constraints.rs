//! Constraints that contradict each other or say nothing, as far as that shows without solving.

use std::collections::BTreeMap;

use super::Facts;
use super::range::Known;
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Constraint, ConstraintKind, FixKind, Formula, Interval, TOLERANCE, Unit, Vertex};
use crate::semantics::dimension::Dimension;
use crate::semantics::layout::Geometry;
use crate::semantics::scope::Context;
use crate::semantics::value::{number, shown};
use crate::source::Span;

/// Rounding of written numbers, relative.
const SLACK: f64 = 1e-9;

/// What `fix` may hold, once.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Held {
    Section(usize, bool, FixKind),
    Vertex(usize),
    Radius(usize),
}

/// The bounds that lines before have set on one formula.
#[derive(Clone, Copy)]
struct Bounded {
    low: (f64, Span),
    high: (f64, Span),
}

impl Context<'_> {
    pub fn check_constraints(
        &self,
        constraints: &[Constraint],
        vertices: &[Vertex],
        geometry: &Geometry,
        facts: &Facts,
    ) {
        let n = vertices.len();
        let name = |i: usize| vertices[i % n].name.as_str();
        let held = self.check_fixes(constraints, n, &name);
        let (Some(track), Some(limits)) = (&geometry.track, facts.limits) else { return };
        let mut known = Known {
            vertices,
            track,
            obstacles: &geometry.obstacles,
            building: geometry.building.as_ref(),
            limits,
            as_written: facts.as_written(),
            fixed_vertices: BTreeMap::new(),
            fixed_radii: BTreeMap::new(),
            fixed_lengths: BTreeMap::new(),
            fixed_headings: BTreeMap::new(),
        };
        for (what, span) in &held {
            match what {
                Held::Vertex(i) => known.fixed_vertices.insert(*i, *span),
                Held::Radius(i) => known.fixed_radii.insert(*i, *span),
                Held::Section(i, straight, FixKind::Length) => known.fixed_lengths.insert((*i, *straight), *span),
                Held::Section(i, _, FixKind::Rotation) => known.fixed_headings.insert(*i, *span),
                Held::Section(..) => None,
            };
        }
        let mut bounded: BTreeMap<String, Bounded> = BTreeMap::new();
        for constraint in constraints {
            let ConstraintKind::Require { formula, low, high, unit } = &constraint.kind else { continue };
            let wanted = Interval { low: *low, high: *high };
            if !self.check_range(constraint, formula, wanted, *unit, &known, facts) {
                continue;
            }
            let key = format!("{formula:?}");
            self.check_bounds(constraint, &key, wanted, *unit, &mut bounded);
        }
    }

    /// Warns of what is fixed twice; gives everything that is fixed, with the first statement that does it.
    fn check_fixes<'v>(
        &self,
        constraints: &[Constraint],
        n: usize,
        name: &dyn Fn(usize) -> &'v str,
    ) -> BTreeMap<Held, Span> {
        let mut held: BTreeMap<Held, Span> = BTreeMap::new();
        for constraint in constraints {
            let (items, what): (Vec<Held>, String) = match &constraint.kind {
                ConstraintKind::FixSection { target, kinds } => {
                    let section = format!("{}..{}", name(target.from), name(target.from + 1));
                    let what = if target.straight { format!("straight({section})") } else { section };
                    (kinds.iter().map(|k| Held::Section(target.from, target.straight, *k)).collect(), what)
                }
                ConstraintKind::FixVertex { vertex } => (vec![Held::Vertex(*vertex)], name(*vertex).to_string()),
                ConstraintKind::FixRadius { vertex } => {
                    (vec![Held::Radius(*vertex)], format!("the radius of {}", name(*vertex)))
                }
                ConstraintKind::Holds { .. } | ConstraintKind::Require { .. } => continue,
            };
            let repeated: Vec<(&Held, Span)> = items.iter().filter_map(|i| Some((i, *held.get(i)?))).collect();
            if let Some((_, first)) = repeated.first() {
                let kinds: Vec<&str> = repeated.iter().filter_map(|(item, _)| kind_name(item)).collect();
                let message = match (kinds.len(), items.len()) {
                    (some, all) if some < all => format!("{} of `{what}` is fixed already", kinds.join(" and ")),
                    _ => format!("`{what}` is fixed already"),
                };
                let diagnostic = Diagnostic::new(Code::W0704, message, constraint.span, "says nothing new")
                    .related(*first, "fixed here")
                    .help("remove one of the two");
                self.report(match repeated.len() == items.len() {
                    true => diagnostic.fix(constraint.span, ""),
                    false => diagnostic,
                });
            }
            for item in &items {
                held.entry(*item).or_insert(constraint.span);
            }
            // A section that is fixed altogether holds both its vertices.
            if let ConstraintKind::FixSection { target, kinds } = &constraint.kind
                && kinds.len() == 4
                && !target.straight
            {
                for vertex in [target.from, (target.from + 1) % n] {
                    held.entry(Held::Vertex(vertex)).or_insert(constraint.span);
                }
            }
        }
        held
    }

    /// Compares a row with what its formula can reach; false when it can never hold.
    fn check_range(
        &self,
        constraint: &Constraint,
        formula: &Formula,
        wanted: Interval,
        unit: Unit,
        known: &Known,
        facts: &Facts,
    ) -> bool {
        let mut holds = Vec::new();
        let reach = turned(formula, known.range(formula, &mut holds), wanted);
        let constant = matches!(formula, Formula::Constant(_));
        // What is compiled as written may come from a solver.
        let missed = |bound: f64| if known.as_written { TOLERANCE } else { slack(bound) };
        let never = reach.low > wanted.high + missed(wanted.high) || reach.high < wanted.low - missed(wanted.low);
        let always = wanted.low <= reach.low + slack(reach.low) && reach.high <= wanted.high + slack(wanted.high);
        if !never && (!always || known.as_written && !constant) {
            return true;
        }
        let found = match reach.low == reach.high {
            true => value(reach.low, unit),
            false => interval(reach, unit),
        };
        let mut diagnostic = match never {
            true => {
                Diagnostic::new(Code::E0501, "this can never hold", constraint.span, format!("the value is {found}"))
                    .expected(interval(wanted, unit), found)
            }
            false => {
                Diagnostic::new(Code::W0704, "this always holds", constraint.span, format!("the value is {found}"))
                    .expected("a constraint that rules something out", interval(wanted, unit))
                    .help("remove it, or tighten it")
                    .fix(constraint.span, "")
            }
        };
        holds.sort();
        holds.dedup();
        let (turns, radii) = (known.limits.turns.span, known.limits.radii.span);
        for (of, span) in [(Formula::Radius as fn(usize) -> Formula, radii), (Formula::Angle, turns)] {
            if holds.is_empty() && mentions(formula, &of) && !known.as_written {
                diagnostic = diagnostic.related(span, facts.source_of(span));
            }
        }
        for span in holds {
            diagnostic = diagnostic.related(span, "held here");
        }
        if let Some(reason) = constraint.reason.as_ref().filter(|_| never) {
            diagnostic = diagnostic.help(format!("its reason: {reason}"));
        }
        self.report(diagnostic);
        !never
    }

    /// Compares a row with the lines before on the same formula.
    fn check_bounds(
        &self,
        constraint: &Constraint,
        key: &str,
        wanted: Interval,
        unit: Unit,
        bounded: &mut BTreeMap<String, Bounded>,
    ) {
        let span = constraint.span;
        let Some(before) = bounded.get_mut(key) else {
            bounded.insert(key.to_string(), Bounded { low: (wanted.low, span), high: (wanted.high, span) });
            return;
        };
        let contradiction = if wanted.low > before.high.0 + slack(wanted.low) {
            Some((before.high.1, Interval { low: f64::NEG_INFINITY, high: before.high.0 }))
        } else if wanted.high < before.low.0 - slack(wanted.high) {
            Some((before.low.1, Interval { low: before.low.0, high: f64::INFINITY }))
        } else {
            None
        };
        if let Some((other, bound)) = contradiction {
            let mut diagnostic = Diagnostic::new(
                Code::E0502,
                "this contradicts another line",
                span,
                format!("wants {}", interval(wanted, unit)),
            )
            .related(other, format!("wants {}", interval(bound, unit)))
            .expected(interval(bound, unit), interval(wanted, unit));
            if let Some(reason) = &constraint.reason {
                diagnostic = diagnostic.help(format!("its reason: {reason}"));
            }
            self.report(diagnostic);
            return;
        }
        if before.low.0 >= wanted.low && before.high.0 <= wanted.high {
            let first = if before.low.0 > f64::NEG_INFINITY { before.low.1 } else { before.high.1 };
            self.report(
                Diagnostic::new(Code::W0704, "another line asks for this already", span, "says nothing new")
                    .related(first, "asks for as much")
                    .help("remove it")
                    .fix(span, ""),
            );
        }
        if wanted.low > before.low.0 {
            before.low = (wanted.low, span);
        }
        if wanted.high < before.high.0 {
            before.high = (wanted.high, span);
        }
    }
}

/// What a formula can reach, by whole turns nearer to what is wanted where it is a direction.
fn turned(formula: &Formula, reach: Interval, wanted: Interval) -> Interval {
    let (middle, aim) = ((reach.low + reach.high) / 2.0, (wanted.low + wanted.high) / 2.0);
    if !formula.is_heading() || !middle.is_finite() || !aim.is_finite() {
        return reach;
    }
    let by = aim + trig::wrap(middle - aim) - middle;
    Interval { low: reach.low + by, high: reach.high + by }
}

/// What a bound may be missed by.
fn slack(bound: f64) -> f64 {
    if bound.is_finite() { SLACK * bound.abs().max(1.0) } else { 0.0 }
}

fn kind_name(held: &Held) -> Option<&'static str> {
    match held {
        Held::Section(_, _, FixKind::Length) => Some("the length"),
        Held::Section(_, _, FixKind::Rotation) => Some("the rotation"),
        Held::Section(_, _, FixKind::Parallel) => Some("the parallel shift"),
        Held::Section(_, _, FixKind::Perpendicular) => Some("the perpendicular shift"),
        Held::Vertex(_) | Held::Radius(_) => None,
    }
}

/// Whether a formula asks for that quantity of any vertex.
fn mentions(formula: &Formula, of: &dyn Fn(usize) -> Formula) -> bool {
    match formula {
        Formula::Radius(i) | Formula::Angle(i) => *formula == of(*i),
        Formula::Sum(items) | Formula::Product(items) | Formula::Smallest(items) | Formula::Largest(items) => {
            items.iter().any(|item| mentions(item, of))
        }
        Formula::Negative(inner)
        | Formula::Reciprocal(inner)
        | Formula::Absolute(inner)
        | Formula::SquareRoot(inner) => mentions(inner, of),
        _ => false,
    }
}

fn value(value: f64, unit: Unit) -> String {
    match unit {
        Unit::Metre => shown(value, Dimension::LENGTH),
        Unit::Radian => shown(value, Dimension::ANGLE),
        Unit::SquareMetre => shown(value, Dimension::AREA),
        Unit::One | Unit::Other => number(value),
    }
}

/// `at least 3 m`, `3 m .. 8 m`.
fn interval(range: Interval, unit: Unit) -> String {
    match (range.low.is_finite(), range.high.is_finite()) {
        (true, true) if range.low == range.high => value(range.low, unit),
        (true, true) => format!("{} .. {}", value(range.low, unit), value(range.high, unit)),
        (true, false) => format!("at least {}", value(range.low, unit)),
        (false, true) => format!("at most {}", value(range.high, unit)),
        (false, false) => "anything".to_string(),
    }
}
