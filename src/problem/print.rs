//! The problem as text, for `--emit problem`.

use super::{ConstraintRow, Function, Problem};
use crate::model::Formula;
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

/// A row as text: `length(P7..P8) >= 18 m`; angles in degrees.
pub fn relation(problem: &Problem, row: &ConstraintRow) -> String {
    // A difference is compared with nothing: both sides read better.
    if let Function::Formula(Formula::Sum(terms)) = &row.function
        && let [a, Formula::Negative(b)] = terms.as_slice()
        && is_zero(row)
    {
        let sign = if row.low == row.high {
            "="
        } else if row.low.is_finite() {
            ">="
        } else {
            "<="
        };
        let b = formula(problem, b, row.angle);
        let b = b.strip_prefix('(').and_then(|b| b.strip_suffix(')')).unwrap_or(&b);
        return format!("{} {sign} {b}", formula(problem, a, row.angle));
    }
    let name = limited(problem, row);
    let unit = unit(row.angle);
    let [low, high] = [row.low, row.high].map(|limit| format!("{} {unit}", number(limit * scale(row.angle))));
    match (row.low == row.high, row.low.is_finite(), row.high.is_finite()) {
        (true, ..) => format!("{name} = {low}"),
        (_, true, true) => format!("{low} <= {name} <= {high}"),
        (_, true, false) => format!("{name} >= {low}"),
        _ => format!("{name} <= {high}"),
    }
}

fn scale(angle: bool) -> f64 {
    if angle { 180.0 / crate::base::trig::PI } else { 1.0 }
}

fn unit(angle: bool) -> &'static str {
    if angle { "deg" } else { "m" }
}

/// What a row limits: `length(P7..P8)`.
pub fn limited(problem: &Problem, row: &ConstraintRow) -> String {
    match &row.function {
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
        Function::Formula(Formula::Sum(terms)) => sum(problem, terms, row.angle),
        Function::Formula(f) => formula(problem, f, row.angle),
    }
}

/// Whether a row's only limit is zero.
fn is_zero(row: &ConstraintRow) -> bool {
    let limits = [row.low, row.high].into_iter().filter(|limit| limit.is_finite());
    limits.clone().count() > 0 && limits.into_iter().all(|limit| limit == 0.0)
}

/// `angle`: what is added is an angle, and else a length.
fn sum(p: &Problem, terms: &[Formula], angle: bool) -> String {
    let mut out = String::new();
    for (k, term) in terms.iter().enumerate() {
        let constant = |value: f64| format!("{} {}", number(value.abs() * scale(angle)), unit(angle));
        let (minus, text) = match term {
            Formula::Constant(value) => (*value < 0.0, constant(*value)),
            Formula::Negative(term) => match term.as_ref() {
                Formula::Constant(value) => (*value >= 0.0, constant(*value)),
                term => (true, formula(p, term, angle)),
            },
            term => (false, formula(p, term, angle)),
        };
        out += match (k, minus) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        out += &text;
    }
    out
}

fn formula(p: &Problem, f: &Formula, angle: bool) -> String {
    let list =
        |terms: &[Formula], with: &str| terms.iter().map(|t| formula(p, t, angle)).collect::<Vec<_>>().join(with);
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
            format!("distance({}, {})", vertex(i), p.places.names.get(*k).map_or("obstacle", String::as_str))
        }
        Formula::DistanceBuilding(i) => format!("distance({}, building)", vertex(i)),
        Formula::Sum(terms) => format!("({})", sum(p, terms, angle)),
        Formula::Product(terms) => list(terms, " * "),
        Formula::Negative(f) => format!("-{}", formula(p, f, angle)),
        Formula::Reciprocal(f) => format!("1 / {}", formula(p, f, angle)),
        Formula::Absolute(f) => format!("abs({})", formula(p, f, angle)),
        Formula::SquareRoot(f) => format!("sqrt({})", formula(p, f, angle)),
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
