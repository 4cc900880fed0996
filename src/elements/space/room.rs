//! Room that climbs need, as bounds on a plan's lengths, for a plan that is still to be found.

use super::climb::plan;
use super::heights::{changes, sections, way};
use crate::geometry::Track;
use crate::model::{Formula, Layout, Target};
use crate::source::Span;

/// A length of the plan that a climb bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    pub what: Length,
    /// m
    pub low: f64,
    pub high: f64,
    /// `the climb on P3..P4`.
    pub label: String,
    /// The line that asks for it.
    pub span: Span,
}

/// A part of the plan, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Length {
    /// The straight of a section.
    Straight(usize),
    /// Several straights with the curves between them.
    Run(Formula),
}

/// What a solver may miss a bound by must not make a climb too long, m.
const MARGIN: f64 = 1e-5;

/// The rows of every climb. A climb whose statements contradict each other has none: building says so.
///
/// On one straight, a climb of given slope and radius takes a fixed length of plan. Over several, the slope is as
/// gentle as the run allows; the catalogue's steepest bounds the run from below, and the vertical curves at that slope,
/// the longest there can be, the straights at its ends.
pub fn rooms(layout: &Layout, written: &Track) -> Vec<Room> {
    let (given, _) = sections(layout);
    let mut rooms = Vec::new();
    for (between, rise, next) in changes(layout, &given) {
        let Ok(way) = way(layout, &|i| written.straight(i).length, (&between, rise, next)) else { continue };
        let Some(slope) = way.slope.or(way.steepest) else { continue };
        let (Some(&first), Some(&last)) = (way.run.first(), way.run.last()) else { continue };
        let from = way.from.unwrap_or(0.0);
        // Of several radii the one that takes the least room will do.
        let sizes = way.radii.iter().map(|radius| plan(rise, *radius, slope));
        let Some((whole, curve)) = sizes.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let name = match way.run.len() {
            1 => layout.section_name(first),
            _ => format!("{}..{}", layout.vertices[first].name, layout.vertices[layout.next(last)].name),
        };
        let mut bound = |what, low: f64, high: f64, part: &str| {
            let label = format!("room for {part} on {name}");
            rooms.push(Room { what, low, high, label, span: way.span });
        };
        let free = f64::INFINITY;
        if way.run.len() == 1 {
            bound(Length::Straight(first), from + whole + MARGIN, free, "the climb");
            continue;
        }
        bound(Length::Straight(first), from + curve + MARGIN, free, "the vertical curve that begins the climb");
        bound(Length::Straight(last), curve + MARGIN, free, "the vertical curve that ends the climb");
        bound(Length::Run(along(&way.run, true, written)), from + whole + MARGIN, free, "the climb");
        if way.slope.is_some() {
            // With a slope given it ends where it ends, which has to be on the last straight.
            let reach = from + whole - curve - MARGIN;
            bound(Length::Run(along(&way.run, false, written)), -free, reach, "the end of the climb");
        }
    }
    rooms
}

/// Length of a run of sections, with or without the last straight.
fn along(run: &[usize], whole: bool, written: &Track) -> Formula {
    let n = written.corners.len();
    let mut terms = Vec::new();
    for (k, &section) in run.iter().enumerate() {
        if k > 0 {
            // The fillet between two sections; no solver flips its turn.
            let vertex = section;
            let side = if written.fillets[vertex].turn < 0.0 { -1.0 } else { 1.0 };
            terms.push(Formula::Product(vec![
                Formula::Constant(side),
                Formula::Radius(vertex),
                Formula::Angle(vertex),
            ]));
        }
        if whole || k + 1 < run.len() {
            terms.push(Formula::Length(Target { from: section % n, straight: true }));
        }
    }
    Formula::Sum(terms)
}
