//! The problem as text, for `--emit problem`.

use super::{ConstraintRow, Function, Problem};
use crate::model::{Formula, Unit};
use crate::source::SourceMap;
use std::fmt::Write;

/// Every variable, row and region, each with its line of source.
pub fn print(problem: &Problem, sources: &SourceMap) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "problem {}", problem.layout);
    let _ = writeln!(out, "\nminimise\n  {}", problem.minimises);
    let _ = writeln!(out, "\nvariables (m), written value in [low, high]");
    for (k, bound) in problem.bounds.iter().enumerate() {
        let name = problem.variable_name(k);
        let value = number(problem.start[k]);
        let _ = if bound.low == bound.high {
            writeln!(out, "  {name:<12} = {value}")
        } else if bound.low.is_infinite() {
            writeln!(out, "  {name:<12} {value:>12}  free")
        } else {
            writeln!(out, "  {name:<12} {value:>12}  in [{}, {}]", number(bound.low), number(bound.high))
        };
    }
    let _ = writeln!(out, "\nrows (m, angles in deg)");
    for row in &problem.rows {
        let _ = write!(out, "  {:<36} {:<44}", relation(problem, row), row.label);
        let _ = write!(out, "  // {}", sources.place(row.span));
        let _ = match &row.reason {
            Some(reason) => writeln!(out, " \"{reason}\""),
            None => writeln!(out),
        };
    }
    let width = number(2.0 * problem.half_width);
    let _ = writeln!(out, "\nkeep strands of the track at least {width} m apart, its width");
    if !problem.keepouts.is_empty() {
        let _ =
            writeln!(out, "\nkeep the centre line away from (m; a row for every place where the track comes close)");
        for keepout in &problem.keepouts {
            let lies = if keepout.region.lies > 0.0 { "left" } else { "right" };
            let what = if keepout.region.outside { "beyond the walls of" } else { "" };
            let name = format!("{what} {}", keepout.name);
            let _ = writeln!(
                out,
                "  {:<36} >= {:<12} lies {lies} of travel  // {}",
                name.trim(),
                number(keepout.distance),
                sources.place(keepout.span)
            );
        }
    }
    out
}

/// A row as text: `length(P7..P8) >= 18`; angles in degrees.
pub fn relation(problem: &Problem, row: &ConstraintRow) -> String {
    let scale = if row.unit == Unit::Radian { 180.0 / crate::base::trig::PI } else { 1.0 };
    let name = match &row.function {
        Function::Turn(i) => format!("turn({})", problem.vertices[*i]),
        Function::Section(i) => format!("length({})", problem.section_name(*i)),
        Function::Straight(i) => format!("length(straight({}))", problem.section_name(*i)),
        Function::Linear(terms) => terms
            .iter()
            .map(|&(k, c)| format!("{} {}", number(c), problem.variable_name(k)))
            .collect::<Vec<_>>()
            .join(" + "),
        Function::StraightMiddle { section, direction } => format!(
            "middle(straight({})) along ({}, {})",
            problem.section_name(*section),
            number(direction.x),
            number(direction.y)
        ),
        Function::StraightEnd { section, end, direction } => format!(
            "{}(straight({})) along ({}, {})",
            if *end { "end" } else { "begin" },
            problem.section_name(*section),
            number(direction.x),
            number(direction.y)
        ),
        Function::Formula(f) => formula(problem, f),
    };
    let (low, high) = (number(row.low * scale), number(row.high * scale));
    match (row.low == row.high, row.low.is_finite(), row.high.is_finite()) {
        (true, ..) => format!("{name} = {low}"),
        (_, true, true) => format!("{low} <= {name} <= {high}"),
        (_, true, false) => format!("{name} >= {low}"),
        _ => format!("{name} <= {high}"),
    }
}

fn formula(p: &Problem, f: &Formula) -> String {
    let list = |terms: &[Formula], with: &str| terms.iter().map(|t| formula(p, t)).collect::<Vec<_>>().join(with);
    let vertex = |i: &usize| p.vertices[*i].clone();
    match f {
        Formula::Constant(value) => number(*value),
        Formula::X(i) => format!("x({})", vertex(i)),
        Formula::Y(i) => format!("y({})", vertex(i)),
        Formula::Radius(i) => format!("radius({})", vertex(i)),
        Formula::Length(t) if t.straight => format!("length(straight({}))", p.section_name(t.from)),
        Formula::Length(t) => format!("length({})", p.section_name(t.from)),
        Formula::Heading(i) => format!("heading({})", p.section_name(*i)),
        Formula::Angle(i) => format!("angle({})", vertex(i)),
        Formula::DistanceVertices(a, b) => format!("distance({}, {})", vertex(a), vertex(b)),
        Formula::DistanceObstacle(i, k) => {
            let keepout = p.keepouts.iter().filter(|k| !k.region.outside).nth(*k);
            format!("distance({}, {})", vertex(i), keepout.map_or("obstacle", |k| &k.name))
        }
        Formula::DistanceBuilding(i) => format!("distance({}, building)", vertex(i)),
        Formula::Sum(terms) => format!("({})", list(terms, " + ")),
        Formula::Product(terms) => list(terms, " * "),
        Formula::Negative(f) => format!("-{}", formula(p, f)),
        Formula::Reciprocal(f) => format!("1 / {}", formula(p, f)),
        Formula::Absolute(f) => format!("abs({})", formula(p, f)),
        Formula::SquareRoot(f) => format!("sqrt({})", formula(p, f)),
        Formula::Smallest(terms) => format!("min({})", list(terms, ", ")),
        Formula::Largest(terms) => format!("max({})", list(terms, ", ")),
    }
}

/// Up to nine decimals, trimmed.
fn number(value: f64) -> String {
    if value.is_infinite() {
        return if value > 0.0 { "inf".into() } else { "-inf".into() };
    }
    let text = format!("{value:.9}");
    let trimmed = text.trim_end_matches('0').trim_end_matches('.');
    if trimmed == "-0" { "0".into() } else { trimmed.into() }
}
