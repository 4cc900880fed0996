//! What a layout measures as it is written, and as it was solved.

use super::solutions::{Known, Solutions, Solved};
use crate::base::number::trimmed;
use crate::geometry::Track;
use crate::model::Layout;
use crate::semantics::Checked;
use crate::semantics::names::{NameKind, Occurrence};
use std::path::Path;

/// A layout around a place in its text.
pub struct Measures<'a> {
    layout: &'a Layout,
    /// `None` where it asks for its vertices.
    written: Option<Track>,
    known: Known<'a>,
}

/// A section as numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// From vertex to vertex, m.
    pub length: f64,
    /// Between the curves, m.
    pub straight: f64,
    /// deg
    pub heading: f64,
}

impl<'a> Measures<'a> {
    /// Of the layout around a byte of a document; `None` outside of one, and of one with mistakes.
    pub fn new(solutions: &'a Solutions, place: &Path, checked: &'a Checked, offset: usize) -> Option<Self> {
        let study = checked.study.as_ref()?;
        let around = study.names.layout_at(checked.main, offset as u32)?;
        let layout = study.analysis.layouts.iter().find(|l| l.name == around.name)?;
        let written = (layout.vertices.len() >= 3).then(|| Track::new(&layout.corners()));
        Some(Measures { layout, written, known: solutions.of(place, layout) })
    }

    /// The solved layout, if one is known, and whether it is of the text as it is now.
    pub fn solved(&self) -> Option<(&'a Solved, bool)> {
        match self.known {
            Known::Solved(solved) => Some((solved, true)),
            Known::Stale(solved) => Some((solved, false)),
            Known::No | Known::Refused(_) => None,
        }
    }

    fn vertex(&self, name: &str) -> Option<usize> {
        self.layout.vertices.iter().position(|v| v.name == name)
    }

    /// The section from one vertex to the next as it was solved.
    pub fn solved_section(&self, from: &str, to: &str) -> Option<(Measured, bool)> {
        let (solved, current) = self.solved()?;
        let names = &solved.compiled.layout.vertices;
        let i = names.iter().position(|v| v.name == from)?;
        (names.get((i + 1) % names.len())?.name == to).then(|| (measured(&solved.compiled.track, i), current))
    }

    /// A table of the section.
    pub fn section(&self, from: &str, to: &str) -> Option<String> {
        let i = self.vertex(from)?;
        if self.layout.vertices.get(self.layout.next(i))?.name != to {
            return None;
        }
        let written = measured(self.written.as_ref()?, i);
        let solved = self.solved_section(from, to).map(|(measured, _)| measured);
        let row = |what: &str, unit: &str, of: fn(Measured) -> f64| {
            let solved = solved.map_or_else(|| "–".to_owned(), |m| format!("{} {unit}", trimmed(of(m), 4)));
            format!("| {what} | {} {unit} | {solved} |", trimmed(of(written), 4))
        };
        let rows = [
            row("length", "m", |m| m.length),
            row("straight part", "m", |m| m.straight),
            row("heading", "deg", |m| m.heading),
        ];
        Some(format!("section `{from}..{to}`\n\n{}\n{}\n\n{}", HEAD, rows.join("\n"), self.state()))
    }

    /// What a name measures, if it does.
    pub fn of(&self, name: &Occurrence, text: &str) -> Option<String> {
        match name.kind {
            NameKind::Vertex => self.corner(text),
            NameKind::Layout if name.declares() => Some(self.whole()),
            _ => None,
        }
    }

    fn corner(&self, name: &str) -> Option<String> {
        let i = self.vertex(name)?;
        let solved = self.solved().and_then(|(solved, _)| {
            let at = solved.compiled.layout.vertices.iter().position(|v| v.name == name)?;
            Some((&solved.compiled.track, at))
        });
        let written = self.written.as_ref()?;
        let row = |what: &str, unit: &str, of: &dyn Fn(&Track, usize) -> f64| {
            let solved = solved.map_or_else(|| "–".to_owned(), |(t, i)| format!("{} {unit}", trimmed(of(t, i), 4)));
            format!("| {what} | {} {unit} | {solved} |", trimmed(of(written, i), 4))
        };
        let rows = [
            row("x", "m", &|t, i| t.corners[i].point.x),
            row("y", "m", &|t, i| t.corners[i].point.y),
            row("radius", "m", &|t, i| t.corners[i].radius),
            row("turn", "deg", &|t, i| t.fillets[i].turn.to_degrees()),
        ];
        Some(format!("{HEAD}\n{}\n\n{}", rows.join("\n"), self.state()))
    }

    /// Length and bill.
    pub fn whole(&self) -> String {
        let mut lines = Vec::new();
        if let Some(written) = &self.written {
            lines.push(format!("- as written: {} m", trimmed(written.length, 3)));
        }
        if let Some((solved, _)) = self.solved() {
            let compiled = &solved.compiled;
            lines.push(format!("- as solved: {} m", trimmed(compiled.length(), 3)));
            if !compiled.failed() {
                let bill = &compiled.bill;
                lines.push(format!("- {} elements, {:.2} EUR, {} kg", bill.count, bill.price, trimmed(bill.mass, 1)));
                if let Some(fit) = compiled.chain {
                    let over = trimmed(1e3 * fit.left_over, 1);
                    lines.push(format!("- {} carts, {over} mm left over", fit.carts));
                }
            }
        }
        format!("layout `{}`\n\n{}\n\n{}", self.layout.name, lines.join("\n"), self.state())
    }

    /// `solved`, or why not.
    fn state(&self) -> String {
        match &self.known {
            Known::Solved(solved) => format!("solved: {}", solved.state()),
            Known::Stale(_) => "not solved yet since the last change; what is shown is from before it".to_owned(),
            Known::No => "not solved yet".to_owned(),
            Known::Refused(why) => format!("not solved: {why}"),
        }
    }
}

const HEAD: &str = "| | as written | as solved |\n|---|---|---|";

fn measured(track: &Track, i: usize) -> Measured {
    let straight = track.straight(i);
    let next = (i + 1) % track.corners.len();
    Measured {
        length: track.corners[i].point.distance(track.corners[next].point),
        straight: straight.length,
        heading: straight.heading.to_degrees(),
    }
}

/// The section `P4..P5` that a vertex' name stands in, and its bytes.
pub fn section_at(checked: &Checked, name: &Occurrence) -> Option<(String, String, (usize, usize))> {
    if name.kind != NameKind::Vertex {
        return None;
    }
    let text = checked.text(name.span.file);
    let (start, end) = (name.span.start as usize, name.span.end as usize);
    let own = &text[start..end];
    let blank = |c: char| c == ' ' || c == '\t';
    if let Some(rest) = text[end..].trim_start_matches(blank).strip_prefix("..") {
        let rest = rest.trim_start_matches(blank);
        let (at, other) = super::text::word_at(text, text.len() - rest.len());
        if !other.is_empty() {
            return Some((own.to_owned(), other.to_owned(), (start, at + other.len())));
        }
    }
    let before = text[..start].trim_end_matches(blank).strip_suffix("..")?.trim_end_matches(blank);
    let (at, other) = super::text::word_at(text, before.len());
    (!other.is_empty()).then(|| (other.to_owned(), own.to_owned(), (at, end)))
}
