//! What of a layout's equipment finds no place, what is in the way, and the smallest change that makes room.

use super::place;
use super::task::{Block, Cause, Group, Room, Task};
use super::ways::{Lacking, up};
use crate::base::number::trimmed;
use crate::base::words::list;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::Track;
use crate::model::{EquipmentKind, EquipmentType, Layout, Stands, TOLERANCE};
use crate::source::Span;

/// An error for each declaration that is not placed as a whole, and for equipment that stands in something where the layout
/// puts it.
pub fn findings(layout: &Layout, track: &Track) -> Vec<Diagnostic> {
    if layout.equipment.declared.is_empty() {
        return Vec::new();
    }
    let task = Task::new(layout, track);
    let mut said = all_given(layout, track, &task);
    if !said.is_empty() {
        return said;
    }
    let placement = place(layout, track);
    for &(declared, lacking) in &placement.missing {
        if let Some(group) = task.groups.iter().find(|group| group.declared == declared) {
            let lacking = Lacking { layout, track, task: &task, group, count: lacking, missing: &placement.missing };
            said.push(missing(&lacking, placement.whole));
        }
    }
    said
}

/// An error for each declaration that stands in something where the layout puts it, and for what that is: of two that stand
/// in each other, once.
fn all_given(layout: &Layout, track: &Track, task: &Task) -> Vec<Diagnostic> {
    let mut said = Vec::new();
    let mut told: Vec<(usize, Option<Cause>)> = Vec::new();
    for (i, own) in task.given.iter().enumerate() {
        let Some((cause, diagnostic)) = given(layout, track, task, i) else { continue };
        let other = match cause {
            Some(Cause::Equipment(other)) => Some((other, Some(Cause::Equipment(own.declared)))),
            _ => None,
        };
        if !told.iter().any(|pair| *pair == (own.declared, cause) || Some(*pair) == other) {
            said.push(diagnostic);
        }
        told.push((own.declared, cause));
    }
    said
}

/// What stands in something where the layout puts it, and what that is: `None` for a curve that is too near.
fn given(layout: &Layout, track: &Track, task: &Task, i: usize) -> Option<(Option<Cause>, Diagnostic)> {
    let own = &task.given[i];
    let declared = &layout.equipment.declared[own.declared];
    let of = &declared.of;
    let others = task.given.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, g)| g.clone()).collect();
    let others = Task { given: others, groups: Vec::new(), ..task.clone() };
    let middle = 0.5 * of.stretch;
    let begin = own.place.at - middle;
    let line = &task.lines[own.place.section];
    let name = format!("{} `{}`", of.kind.word(), declared.one(own.number));
    let room = others.whole_room(layout, track, of, own.place.section, own.sides);
    let free = room
        .as_ref()
        .is_some_and(|room| room.free.iter().any(|f| f.0 - TOLERANCE <= begin && begin <= f.1 + TOLERANCE));
    if free {
        return None;
    }
    let nearest = room.iter().flat_map(|room| &room.free).map(|f| begin.clamp(f.0, f.1));
    let nearest = nearest.min_by(|a, b| (a - begin).abs().total_cmp(&(b - begin).abs()));
    let help = match (&declared.stands, nearest) {
        (Stands::Row(row), _) if row.every + TOLERANCE < of.stretch => {
            format!("each of the row is {} m long: write `every {} m` at least", trimmed(of.stretch, 3), up(of.stretch))
        }
        (Stands::Row(row), Some(at)) => {
            let from = row.place.at + at - begin;
            format!("there is room for this one where the row begins at another place: `from {} m`", trimmed(from, 3))
        }
        (_, Some(at)) => {
            let way = if at > begin { "on" } else { "back" };
            format!("{} m {way} there is room: `at {} m`", up((at - begin).abs()), trimmed(at + middle, 3))
        }
        (_, None) => format!("there is no room for it anywhere on {}", layout.section_name(own.place.section)),
    };
    let stands = |what: &str| format!("{name} stands in {what}, or too near to it");
    let blocks: Vec<&Block> = room
        .iter()
        .flat_map(|r| &r.blocks)
        .filter(|b| b.low + TOLERANCE < begin && begin < b.high - TOLERANCE)
        .collect();
    let diagnostic = match blocks.first() {
        Some(block) => {
            let (what, span) = cause(layout, track, block.cause);
            let diagnostic = Diagnostic::new(Code::E0606, stands(&what), declared.span, "is in the way of something");
            let diagnostic = Diagnostic {
                label: crate::diagnostic::Label { text: format!("{what} is in its way"), ..diagnostic.label.clone() },
                ..diagnostic
            };
            match span.filter(|span| *span != declared.span) {
                Some(span) => diagnostic.related(span, "this is in its way"),
                None => diagnostic,
            }
        }
        None => {
            let (expected, found) = straight(of, line.length, own.place.at);
            let covers = (trimmed(begin, 3), trimmed(begin + of.stretch, 3));
            let label = format!("covers {} m to {} m along the straight", covers.0, covers.1);
            let message = format!("{name} is too near to a curve");
            Diagnostic::new(Code::E0606, message, declared.span, label).expected(expected, found)
        }
    };
    Some((blocks.first().map(|block| block.cause), diagnostic.help(help)))
}

/// What a straight has to be like for equipment with its middle so far along it, and what it is like.
fn straight(of: &EquipmentType, length: f64, at: f64) -> (String, String) {
    let (first, last) = (of.from_curve + 0.5 * of.stretch, length - 0.5 * of.stretch - of.from_curve);
    if first <= last {
        let between = format!("a middle between {} m and {} m", trimmed(first, 3), trimmed(last, 3));
        return (between, format!("`at {} m`", trimmed(at, 3)));
    }
    (format!("a straight of {} m at least", up(2.0 * first)), format!("one of {} m", trimmed(length, 3)))
}

/// What finds no place.
fn missing(lacking: &Lacking, whole: bool) -> Diagnostic {
    let Lacking { layout, track, group, count: lacks, .. } = *lacking;
    let declared = &layout.equipment.declared[group.declared];
    let (count, of) = (group.count, &group.of);
    let needed = count as f64 * of.stretch + (count - 1) as f64 * of.service;
    let free: f64 = group.rooms.iter().map(|room| covered(room, of.stretch)).sum();
    let what = if of.kind == EquipmentKind::Chute && count > 1 { "chutes" } else { of.kind.word() };
    let message = match (count, whole) {
        (_, false) => format!("no places were found for {lacks} of {count} {what} `{}`", declared.name),
        (1, true) => format!("there is no room for {} `{}`", of.kind.word(), declared.name),
        (_, true) => format!("there is room for {} of {count} {what} `{}`", count - lacks, declared.name),
    };
    let label = if count == 1 {
        format!("takes {} m of straight", trimmed(needed, 3))
    } else {
        format!("take {} m of straight", trimmed(needed, 3))
    };
    let mut diagnostic = Diagnostic::new(Code::E0606, message, declared.span, label);
    diagnostic = diagnostic.expected(
        format!("{} m of straight for {count}, {} m each", trimmed(needed, 3), trimmed(of.stretch, 3)),
        format!("{} m that are free on the straights that it may stand on", trimmed(free, 3)),
    );
    let causes = causes(group);
    for (block, metres) in causes.iter().take(4) {
        let (what, span) = cause(layout, track, *block);
        // Where it has but one place, no metres are taken.
        let over = if *metres < 0.005 { String::new() } else { format!(" over {} m", trimmed(*metres, 2)) };
        if let Some(span) = span.filter(|span| *span != declared.span) {
            diagnostic = diagnostic.related(span, format!("{what} is in the way{over}"));
        }
    }
    let causes: Vec<Cause> = causes.into_iter().map(|(cause, _)| cause).collect();
    let ways = lacking.ways(&causes);
    diagnostic.help(match ways.len() {
        0 => "no change of this line alone, or of one obstacle or straight, was found that is enough".to_owned(),
        1 => format!("a way out: {}", ways[0]),
        _ => format!("ways out, any of which is enough: {}", list(&ways, "or")),
    })
}

/// How much of a straight is free for equipment of such a stretch, m.
fn covered(room: &Room, stretch: f64) -> f64 {
    let add =
        |(sum, end): (f64, f64), (begin, last): &(f64, f64)| (sum + last + stretch - end.max(*begin), last + stretch);
    room.free.iter().fold((0.0, f64::NEG_INFINITY), add).0
}

/// What is in a group's way, with how many metres of straights it takes, the most first.
fn causes(group: &Group) -> Vec<(Cause, f64)> {
    let mut causes: Vec<(Cause, f64)> = Vec::new();
    for room in &group.rooms {
        for block in &room.blocks {
            if block.low >= room.reach.1 || block.high <= room.reach.0 {
                continue;
            }
            let metres = block.high.min(room.reach.1) - block.low.max(room.reach.0);
            match causes.iter_mut().find(|(cause, _)| *cause == block.cause) {
                Some((_, sum)) => *sum += metres,
                None => causes.push((block.cause, metres)),
            }
        }
    }
    causes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    causes
}

/// A cause in words, with its place.
pub(super) fn cause(layout: &Layout, track: &Track, cause: Cause) -> (String, Option<Span>) {
    match cause {
        Cause::Obstacle(i) => (format!("the obstacle `{}`", layout.obstacles[i].name), Some(layout.obstacles[i].span)),
        Cause::Building => ("the building's wall".to_owned(), layout.building.as_ref().map(|b| b.span)),
        Cause::Track(i) => {
            let piece = &track.pieces[i];
            let vertex = &layout.vertices[piece.vertex];
            let what = match i % 2 {
                0 => format!("the track on {}", layout.section_name(piece.vertex)),
                _ => format!("the curve at {}", vertex.name),
            };
            (what, Some(vertex.span))
        }
        Cause::Equipment(i) => {
            let declared = &layout.equipment.declared[i];
            (format!("the {} `{}`", declared.of.kind.word(), declared.name), Some(declared.span))
        }
    }
}
