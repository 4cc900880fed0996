//! What conveyors that feed equipment go through: they are counted as straight lines, whatever lies on them.

use super::findings::cause;
use super::footprint::Line;
use super::shadow::{band, shadow};
use super::task::Cause;
use super::{Placed, Placement};
use crate::base::number::trimmed;
use crate::base::words::list;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Point, Track};
use crate::model::{Declared, Layout, TOLERANCE};

/// Half the width of the strip that is looked at, m: the line itself.
const HALF: f64 = 0.005;
/// Less than this of a conveyor in something is a touch, m.
const TOUCH: f64 = 0.05;

/// A warning for each declaration whose conveyors go through something, begin outside the building, or have no price.
pub fn conveyors(layout: &Layout, track: &Track, placement: &Placement) -> Vec<Diagnostic> {
    let mut said = Vec::new();
    for (i, declared) in layout.equipment.declared.iter().enumerate() {
        let Some(from) = declared.fed else { continue };
        let own: Vec<&Placed> = placement.placed.iter().filter(|p| p.declared == i).collect();
        let length: f64 = own.iter().filter_map(|p| p.conveyor).sum();
        if length <= 0.0 {
            continue;
        }
        let mut through: Vec<(Cause, f64)> = Vec::new();
        for placed in own {
            add(&mut through, crossed(layout, track, placement, placed, from));
        }
        // To the millimetre, so that what is as long has the order of its causes.
        through.iter_mut().for_each(|(_, metres)| *metres = (*metres * 1e3).round() / 1e3);
        through.retain(|(_, metres)| *metres > TOUCH);
        through.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        said.extend(goes_through(layout, track, (declared, from, length), &through));
        if declared.of.conveyor == 0.0 {
            said.push(without_price(declared, length));
        }
    }
    said
}

fn add(all: &mut Vec<(Cause, f64)>, more: Vec<(Cause, f64)>) {
    for (cause, metres) in more {
        match all.iter_mut().find(|(known, _)| *known == cause) {
            Some((_, sum)) => *sum += metres,
            None => all.push((cause, metres)),
        }
    }
}

/// How many metres of the conveyor to a piece of equipment lie in what.
fn crossed(layout: &Layout, track: &Track, placement: &Placement, own: &Placed, from: Point) -> Vec<(Cause, f64)> {
    let Some(end) = own.footprint.conveyor_end(from) else { return Vec::new() };
    let length = end.distance(from);
    if length <= TOUCH {
        return Vec::new();
    }
    let line = Line { begin: from, along: (end - from) * (1.0 / length), length };
    let within = |points: &[Point], outside: bool| -> f64 {
        shadow(points, &line, (-HALF, HALF), (0.0, length), outside).iter().map(|(a, b)| b - a).sum()
    };
    let mut found = Vec::new();
    let half = layout.width.value / 2.0;
    for (i, obstacle) in layout.obstacles.iter().enumerate() {
        found.push((Cause::Obstacle(i), within(obstacle.polygon.points(), false)));
    }
    if let Some(building) = &layout.building {
        found.push((Cause::Building, within(building.polygon.points(), true)));
    }
    for (i, piece) in track.pieces.iter().enumerate().filter(|(_, piece)| piece.length > 1e-9) {
        found.push((Cause::Track(i), within(&band(piece, half), false)));
    }
    for other in placement.placed.iter().filter(|other| (other.declared, other.number) != (own.declared, own.number)) {
        let metres = other.footprint.covers.iter().map(|r| within(r, false)).sum();
        add(&mut found, vec![(Cause::Equipment(other.declared), metres)]);
    }
    found
}

fn goes_through(
    layout: &Layout,
    track: &Track,
    (declared, from, length): (&Declared, Point, f64),
    through: &[(Cause, f64)],
) -> Option<Diagnostic> {
    if through.is_empty() {
        return None;
    }
    let polygon = layout.building.as_ref().map(|building| &building.polygon);
    let outside = polygon.is_some_and(|p| !p.contains(from) && p.distance_to_outline(from) > TOLERANCE);
    let name = format!("{} `{}`", declared.of.kind.word(), declared.name);
    let message = match outside {
        true => format!("the conveyor to {name} begins outside the building"),
        false => format!("the conveyor to {name} goes through what is in its way"),
    };
    let words = |(what, metres): &(Cause, f64)| match what {
        Cause::Building => format!("{} m outside the building", trimmed(*metres, 2)),
        _ => format!("{} m in {}", trimmed(*metres, 2), cause(layout, track, *what).0),
    };
    let parts: Vec<String> = through.iter().map(words).collect();
    let label = format!("{} m, of which {}", trimmed(length, 2), list(&parts, "and"));
    let mut diagnostic = Diagnostic::new(Code::W0713, message, declared.span, label);
    for (what, _) in through {
        let (words, span) = cause(layout, track, *what);
        if let Some(span) = span.filter(|span| *span != declared.span) {
            diagnostic = diagnostic.related(span, format!("{words} is in its way"));
        }
    }
    Some(diagnostic.help(
        "its length and price are those of the straight line: let it begin elsewhere with `fed from`, or reckon with a way \
         around, over or under",
    ))
}

fn without_price(declared: &Declared, length: f64) -> Diagnostic {
    let (kind, name) = (declared.of.kind.word(), &declared.of.name);
    let message = format!("the conveyor to {kind} `{}` costs nothing", declared.name);
    let label = format!("{} m, as `{name}` has no price for them", trimmed(length, 2));
    Diagnostic::new(Code::W0713, message, declared.span, label).help(format!(
        "give a metre a price: `equipment {name}_fed from {name} {{ conveyor = 950 EUR/m }}`, or leave out `fed from`"
    ))
}
