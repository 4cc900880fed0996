//! What makes a route impossible, said before or after looking for it.

use super::plane::{Plane, between};
use super::round::{self, rounds};
use super::ways::Tangents;
use crate::base::number::trimmed;
use crate::base::trig;
use crate::base::words::list;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Goal, Layout, TrackSection};
use crate::source::Span;

/// Most orders and ways along the sections.
const MOST_ROUNDS: f64 = 10_000.0;
/// Places along its line at which a sliding section is looked at.
const PLACES: usize = 400;

/// What is wrong with a route before any loop is looked for.
pub fn refuse(layout: &Layout) -> Vec<Diagnostic> {
    let Some(route) = &layout.route else { return Vec::new() };
    let mut said = Vec::new();
    if layout.objective.terms.is_empty() {
        let span = layout.objective.span.unwrap_or(layout.span);
        said.push(
            Diagnostic::new(Code::E0414, "a route is optimised, and the layout optimises nothing", span, "nothing")
                .related(route.span, "asks for a loop")
                .expected("`optimise length` or `optimise cost`", "`optimise nothing`"),
        );
    }
    if layout.objective.within.is_some() || layout.objective.terms.iter().any(|(_, g)| *g == Goal::PolygonAction) {
        let span = layout.objective.span.unwrap_or(layout.span);
        said.push(
            Diagnostic::new(
                Code::E0650,
                "a route under this goal is checked, but not built yet",
                span,
                "not built yet",
            )
            .help("to build now, write `optimise length`, and optimise the layout that is found"),
        );
    }
    let count = round::count(route);
    if count > MOST_ROUNDS {
        said.push(
            Diagnostic::new(Code::E0650, "so many orders are checked, but not built yet", route.span, "not built yet")
                .expected(format!("at most {MOST_ROUNDS} orders and ways along the sections"), trimmed(count, 0))
                .help("fix the order by leaving out `in any order`, or the way along some sections"),
        );
    }
    let plane = Plane::new(layout);
    for section in &route.sections {
        said.extend(misplaced(section, &plane, layout));
    }
    said.extend(overlapping(&route.sections, layout.width.value));
    said.extend(off_grid(&route.sections, layout));
    said
}

/// A section that is clear of obstacles nowhere.
fn misplaced(section: &TrackSection, plane: &Plane, layout: &Layout) -> Option<Diagnostic> {
    let direction = section.direction();
    let at = |k: usize| {
        let begin = section.from + direction * (section.freedom() * k as f64 / PLACES as f64);
        (begin, begin + direction * section.length())
    };
    let count = if section.freedom() > 0.0 { PLACES } else { 0 };
    if (0..=count).any(|k| plane.is_clear(at(k).0, at(k).1)) {
        return None;
    }
    let (begin, end) = at(0);
    let blocking = plane.blocking(begin, end)?;
    let half = trimmed(layout.width.value / 2.0, 3);
    let asked = trimmed(blocking.distance, 3);
    let near = blocking.polygon.edges().map(|(c, d)| between(begin, end, c, d)).fold(f64::INFINITY, f64::min);
    let across = near < 1e-9 || blocking.polygon.contains(begin) != blocking.inside;
    let touches = if across { "it lies across it".to_owned() } else { format!("{} m", trimmed(near, 3)) };
    let place = if section.length.is_some() { "at no place on its line" } else { "not" };
    let message = format!("the section `{}` is {place} clear of `{}`", section.name, blocking.name);
    Some(
        Diagnostic::new(Code::E0412, message, section.from_span.to(section.to_span), "too near")
            .related(blocking.span, "what it is too near to")
            .expected(
                format!("{asked} m from the track's middle: {half} m of half its width, and the clearance"),
                touches,
            )
            .help("move the section, or let it slide: `section NAME LENGTH within (x, y)..(x, y)`"),
    )
}

/// Two fixed sections on the same floor.
fn overlapping(sections: &[TrackSection], width: f64) -> Vec<Diagnostic> {
    let mut said = Vec::new();
    for (k, a) in sections.iter().enumerate().filter(|(_, s)| s.length.is_none()) {
        for b in sections[k + 1..].iter().filter(|s| s.length.is_none()) {
            let near = between(a.from, a.to, b.from, b.to);
            // Sections that follow each other on one line may touch.
            let follow = (a.to.distance(b.from) < 1e-9 || b.to.distance(a.from) < 1e-9)
                && a.direction().dot(b.direction()) > 1.0 - 1e-12;
            if near < width - 1e-6 && !follow {
                let message = format!("the sections `{}` and `{}` need the same floor", a.name, b.name);
                said.push(
                    Diagnostic::new(Code::E0412, message, b.from_span.to(b.to_span), "too near")
                        .related(a.from_span.to(a.to_span), "the other section")
                        .expected(
                            format!("{} m between them, the track's width", trimmed(width, 3)),
                            format!("{} m", trimmed(near, 3)),
                        )
                        .help("move one of the two"),
                );
            }
        }
    }
    said
}

/// Sections whose headings the catalogue's curves cannot join.
fn off_grid(sections: &[TrackSection], layout: &Layout) -> Option<Diagnostic> {
    let first = sections.first()?;
    let step = layout.catalog.curve.angle_step;
    sections[1..].iter().find_map(|section| {
        let angle = trig::wrap(section.direction().heading() - first.direction().heading());
        let off = (angle / step - (angle / step).round()).abs() * step;
        (off > 1e-8).then(|| {
            let degrees = |a: f64| trimmed(a * 180.0 / trig::PI, 6);
            let message =
                format!("no curves of the catalogue join the headings of `{}` and `{}`", first.name, section.name);
            Diagnostic::new(
                Code::E0414,
                message,
                section.from_span.to(section.to_span),
                format!("{} deg from the other", degrees(angle)),
            )
            .related(first.from_span.to(first.to_span), "the other heading")
            .expected(format!("a multiple of {} deg between them", degrees(step)), format!("{} deg", degrees(angle)))
            .help(format!("turn one of them by {} deg", degrees(off)))
        })
    })
}

/// There is no line at all from some section to the next.
pub fn no_way(layout: &Layout, plane: &Plane) -> Diagnostic {
    let Some(route) = &layout.route else { return Diagnostic::new(Code::E0414, "no route", layout.span, "here") };
    let tangents = Tangents::new(plane);
    let width = trimmed(layout.width.value, 3);
    for round in rounds(route) {
        let n = round.sections.len();
        for k in 0..n {
            let (a, b) = (&round.sections[k], &round.sections[(k + 1) % n]);
            let (from, to) = (a.to, b.from);
            if tangents.distance(from, to).is_finite() {
                continue;
            }
            let open = |i: &usize| {
                let without = plane.without(*i);
                Tangents::new(&without).distance(from, to).is_finite()
            };
            let ways: Vec<usize> = (0..plane.keepouts.len()).filter(open).collect();
            let names: Vec<String> = ways.iter().map(|&i| format!("`{}`", plane.keepouts[i].name)).collect();
            let message = format!("there is no way from `{}` to `{}` for a track {width} m wide", a.name, b.name);
            let mut said = Diagnostic::new(Code::E0414, message, b.span, "not reached").related(a.span, "from here");
            for &i in &ways {
                said = said.related(plane.keepouts[i].span, "in the way");
            }
            return match names.is_empty() {
                true => said.help("several obstacles are in the way together: move them, or a section"),
                false => said.help(format!("without {} there is one: move it, or a section", list(&names, "or"))),
            };
        }
    }
    Diagnostic::new(Code::E0414, "the sections leave no place for each other", route.span, "this route")
        .help("move a section, or give it more freedom to slide")
}

/// Ways there are, but no layout of the catalogue's curves was found on any.
pub fn no_loop(layout: &Layout, tried: usize) -> Diagnostic {
    let span: Span = layout.route.as_ref().map_or(layout.span, |r| r.span);
    let found = match tried {
        0 => "every loop crosses itself, or passes an obstacle on the other side".to_owned(),
        1 => "the only loop that does not cross itself cannot be built".to_owned(),
        n => format!("{n} loops that do not cross themselves, none of which can be built"),
    };
    Diagnostic::new(
        Code::E0414,
        "no loop of the catalogue's curves was found through these sections",
        span,
        "this route",
    )
    .expected("a loop within the limits of turns and radii that keeps its distances", found)
    .help(
        "allow smaller radii, let a section slide (`within`) or be driven `either way`, or pass the sections \
             `in any order`",
    )
}
