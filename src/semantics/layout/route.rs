//! `section` and `route`: straight parts with places of their own, and the request to find the loop through them.

use std::collections::BTreeMap;

use super::draft::{Draft, Placed};
use super::vertices::Geometry;
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Constraint, ConstraintKind, Route, TrackSection, Vertex};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::Bounds;
use crate::semantics::scope::Context;
use crate::semantics::value::{degrees, metres};
use crate::syntax::tree::{Name, PlacedSection, Section, Statement};

/// Sections of a route, at most.
const MOST: usize = 40;
/// A section is longer than this, m.
const SHORTEST: f64 = 0.001;
/// How exactly the vertices of a section hold its heading, rad: as fixed headings on the catalogue's grid do.
const HEADING: f64 = 1e-8;

/// A section with the statement's other parts.
struct Stated<'t> {
    part: TrackSection,
    name: &'t Name,
    on: Option<&'t Section>,
}

impl<'t> Context<'t> {
    /// The sections and the route, unless one has a mistake; the constraints where the layout has vertices.
    pub(super) fn route(&self, draft: &Draft<'t>, geometry: &Geometry<'t>) -> Option<(Option<Route>, Vec<Constraint>)> {
        let before = self.sink.borrow().errors();
        let mut stated = Vec::new();
        let mut sound = true;
        for placed in &draft.statements {
            if let Statement::Section(section) = placed.statement {
                match self.track_section(placed, section) {
                    Some(section) => stated.push(section),
                    None => sound = false,
                }
            }
        }
        let route = draft.once("route").map(|placed| self.requested(placed, &stated, sound));
        let mut constraints = Vec::new();
        if route.is_none() {
            for section in &stated {
                constraints.extend(self.on_track(section, geometry));
            }
        }
        (sound && self.sink.borrow().errors() == before).then_some((route.flatten(), constraints))
    }

    fn track_section(&self, placed: &Placed<'t>, section: &'t PlacedSection) -> Option<Stated<'t>> {
        let PlacedSection { name, length, from, to, either_way, on } = section;
        let (a, b) = (self.point(placed, from), self.point(placed, to));
        let wanted = match length {
            Some(expr) => {
                let bounds = Bounds::above(0.0, 1e4);
                Some(self.bounded_constant(&placed.env, expr, Dimension::LENGTH, "the section's length", bounds)?)
            }
            None => None,
        };
        let (a, b) = (a?, b?);
        let room = a.distance(b);
        let what = &name.text;
        if room < SHORTEST {
            let message = format!("the section `{what}` has no direction");
            self.report(
                Diagnostic::new(Code::E0412, message, to.span, "the same point again")
                    .related(from.span, "its other end")
                    .expected("two points that differ", format!("{} between them", metres(room))),
            );
            return None;
        }
        if let Some(wanted) = wanted.filter(|w| w.value > room + 1e-9) {
            let message = format!("the section `{what}` is longer than the line that it lies on");
            self.report(
                Diagnostic::new(
                    Code::E0412,
                    message,
                    wanted.span,
                    format!("longer by {}", metres(wanted.value - room)),
                )
                .related(from.span.to(to.span), format!("{} long", metres(room)))
                .expected(format!("at most {}", metres(room)), metres(wanted.value)),
            );
            return None;
        }
        if let (true, Some(on)) = (*either_way, on) {
            let message = format!("the section `{what}` lies on a track that is driven one way");
            self.report(
                Diagnostic::new(Code::E0412, message, on.span, "driven one way")
                    .expected("its ends in driving order", "`either way`")
                    .help("leave out `either way`"),
            );
            return None;
        }
        let part = TrackSection {
            name: what.clone(),
            from: a,
            to: b,
            length: wanted.map(|w| w.value),
            either_way: *either_way,
            from_span: from.span,
            to_span: to.span,
            span: placed.span,
        };
        Some(Stated { part, name, on: on.as_ref() })
    }

    /// What `route` asks for.
    fn requested(&self, placed: &Placed<'t>, stated: &[Stated<'t>], complete: bool) -> Option<Route> {
        let Statement::Route { sections, any_order } = placed.statement else { return None };
        let mut named: BTreeMap<&str, &Name> = BTreeMap::new();
        let mut found = Vec::new();
        for name in sections {
            if let Some(first) = named.insert(&name.text, name) {
                let message = format!("the route passes `{}` twice", name.text);
                self.report(
                    Diagnostic::new(Code::E0213, message, name.span, "named again")
                        .related(first.span, "first named here")
                        .help("a loop passes each section once"),
                );
                continue;
            }
            match stated.iter().find(|s| s.name.text == name.text) {
                Some(section) => found.push(section.part.clone()),
                None if complete => {
                    let message = format!("there is no section `{}`", name.text);
                    let diagnostic = Diagnostic::new(Code::E0206, message, name.span, "not a section")
                        .help(format!("for example `section {} (5 m, 2 m)..(35 m, 2 m)`", name.text));
                    self.report(self.with_nearest(diagnostic, name, stated.iter().map(|s| s.name.text.as_str())));
                }
                None => {}
            }
        }
        if found.len() > MOST {
            self.report(
                Diagnostic::new(Code::E0309, "the route has too many sections", placed.span, "too many")
                    .expected(format!("at most {MOST}"), found.len().to_string()),
            );
        }
        for section in stated {
            if !named.contains_key(section.name.text.as_str()) {
                let message = format!("the route leaves out the section `{}`", section.name.text);
                self.report(
                    Diagnostic::new(Code::E0412, message, section.part.span, "not in the route")
                        .related(placed.span, "the route")
                        .help("name it there, or remove it"),
                );
            }
            if let Some(on) = section.on {
                let message = format!("the section `{}` lies on vertices that are to be found", section.name.text);
                self.report(
                    Diagnostic::new(Code::E0412, message, on.span, "no vertices yet")
                        .related(placed.span, "asks for them")
                        .help("leave out `on`: the route finds the vertices; or remove the route and write them"),
                );
            }
        }
        Some(Route { sections: found, any_order: *any_order, span: placed.span })
    }

    /// The constraint of a section in a layout with vertices.
    fn on_track(&self, section: &Stated<'t>, geometry: &Geometry<'t>) -> Option<Constraint> {
        let part = &section.part;
        let Some(on) = section.on else {
            let message = format!("it is not said where on the track the section `{}` lies", part.name);
            self.report(
                Diagnostic::new(Code::E0412, message, part.span, "without a place on the track")
                    .expected("`on` and two vertices", "none")
                    .help("end the line with, for example, `on P1..P2`; or write `route` instead of the vertices"),
            );
            return None;
        };
        let from = self.section(&geometry.named, on)?;
        if let Some(vertices) = &geometry.vertices {
            self.check_heading(part, on, vertices, from);
        }
        let kind = ConstraintKind::Holds { section: from, part: Box::new(part.clone()) };
        Some(Constraint { kind, span: part.span, reason: None })
    }

    fn check_heading(&self, part: &TrackSection, on: &Section, vertices: &[Vertex], from: usize) {
        let (a, b) = (&vertices[from], &vertices[(from + 1) % vertices.len()]);
        if a.point.distance(b.point) < SHORTEST {
            return;
        }
        let (asked, written) = (part.direction().heading(), (b.point - a.point).heading());
        let off = trig::wrap(asked - written).abs();
        if off <= HEADING {
            return;
        }
        let names = format!("{}..{}", a.name, b.name);
        let message = format!("the section `{}` has another heading than {names}", part.name);
        let diagnostic = Diagnostic::new(Code::E0412, message, on.span, format!("heads {}", degrees(written)))
            .related(part.from_span.to(part.to_span), format!("heads {}", degrees(asked)))
            .expected(format!("a straight that heads {}", degrees(asked)), degrees(written));
        self.report(match off > trig::PI - HEADING {
            true => {
                let ends = [part.to_span, part.from_span].map(|span| self.sources.text(span).trim_end());
                let whole = part.from_span.to(part.to_span);
                diagnostic.help("a section runs in driving order: swap its ends").fix(whole, ends.join(".."))
            }
            false => diagnostic.help(format!("write vertices {names} on the section's line, to nine decimals")),
        });
    }
}
