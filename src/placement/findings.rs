//! What of a layout's equipment finds no place, what is in the way, and the smallest change that makes room.

use super::footprint::Line;
use super::place;
use super::task::{Block, Cause, Group, Room, Task};
use crate::base::number::trimmed;
use crate::base::words::list;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::clearance::Region;
use crate::geometry::{Point, Polygon, Track};
use crate::model::{Declared, EquipmentKind, EquipmentSide, Layout, Side, Stands, TOLERANCE};
use crate::source::Span;

/// An error for each declaration that is not placed as a whole, and for equipment that stands in something where the layout
/// puts it.
pub fn findings(layout: &Layout, track: &Track) -> Vec<Diagnostic> {
    if layout.equipment.declared.is_empty() {
        return Vec::new();
    }
    let task = Task::new(layout, track);
    let mut said: Vec<Diagnostic> = (0..task.given.len()).filter_map(|i| given(layout, track, &task, i)).collect();
    if !said.is_empty() {
        return said;
    }
    let placement = place(layout, track);
    for &(declared, lacking) in &placement.missing {
        if let Some(group) = task.groups.iter().find(|group| group.declared == declared) {
            said.push(missing(layout, track, &task, (group, lacking), placement.whole));
        }
    }
    said
}

/// What stands in something where the layout puts it.
fn given(layout: &Layout, track: &Track, task: &Task, i: usize) -> Option<Diagnostic> {
    let own = &task.given[i];
    let declared = &layout.equipment.declared[own.declared];
    let of = &declared.of;
    let others = task.given.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, g)| g.clone()).collect();
    let others = Task { given: others, groups: Vec::new(), ..task.clone() };
    let begin = own.place.at - 0.5 * of.stretch;
    let line = &task.lines[own.place.section];
    let name = format!("{} `{}`", of.kind.word(), declared.one(own.number));
    let room = others.whole_room(layout, track, of, own.place.section, own.sides);
    let last = line.length - of.stretch - of.from_curve;
    let free = room
        .as_ref()
        .is_some_and(|room| room.free.iter().any(|f| f.0 - TOLERANCE <= begin && begin <= f.1 + TOLERANCE));
    if free {
        return None;
    }
    let nearest = room.iter().flat_map(|room| &room.free).map(|f| begin.clamp(f.0, f.1));
    let nearest = nearest.min_by(|a, b| (a - begin).abs().total_cmp(&(b - begin).abs()));
    let help = match nearest {
        Some(at) => {
            let way = if at > begin { "on" } else { "back" };
            let middle = at + 0.5 * of.stretch;
            format!("{} m {way} there is room: `at {} m`", up((at - begin).abs()), trimmed(middle, 3))
        }
        None => format!("there is no room for it anywhere on {}", layout.section_name(own.place.section)),
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
        None => Diagnostic::new(
            Code::E0606,
            format!("{name} is too near to a curve"),
            declared.span,
            format!("begins {} m along the straight", trimmed(begin, 3)),
        )
        .expected(
            format!("a begin between {} m and {} m", trimmed(of.from_curve, 3), trimmed(last, 3)),
            format!("{} m", trimmed(begin, 3)),
        ),
    };
    Some(diagnostic.help(help))
}

/// What finds no place.
fn missing(layout: &Layout, track: &Track, task: &Task, (group, lacking): (&Group, usize), whole: bool) -> Diagnostic {
    let declared = &layout.equipment.declared[group.declared];
    let (count, of) = (group.count, &group.of);
    let pitch = of.stretch + of.service;
    let needed = count as f64 * of.stretch + (count - 1) as f64 * of.service;
    let free: f64 = group.rooms.iter().flat_map(|r| &r.free).map(|f| f.1 - f.0 + of.stretch).sum();
    let what = if of.kind == EquipmentKind::Chute && count > 1 { "chutes" } else { of.kind.word() };
    let message = match (count, whole) {
        (_, false) => format!("no places were found for {lacking} of {count} {what} `{}`", declared.name),
        (1, true) => format!("there is no room for {} `{}`", of.kind.word(), declared.name),
        (_, true) => format!("there is room for {} of {count} {what} `{}`", count - lacking, declared.name),
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
        if let Some(span) = span.filter(|span| *span != declared.span) {
            diagnostic = diagnostic.related(span, format!("{what} is in the way over {} m", trimmed(*metres, 2)));
        }
    }
    let mut ways = Vec::new();
    let obstacles = causes.iter().filter_map(|(c, _)| if let Cause::Obstacle(i) = c { Some(*i) } else { None });
    let moved = obstacles.filter_map(|i| Some((i, moved(layout, track, task, group, i)?)));
    if let Some((i, by)) = moved.min_by(|a, b| a.1.total_cmp(&b.1)) {
        ways.push(format!("move `{}` {} m away from the track", layout.obstacles[i].name, up(by)));
    }
    ways.extend(other_ways(layout, track, group.declared));
    if count > 1 {
        ways.push(format!("ask for {} fewer", lacking));
    }
    ways.push(format!("make {} m more of straight for it", up(lacking as f64 * pitch)));
    diagnostic.help(format!(
        "{}: {}",
        if ways.len() == 1 { "a way out" } else { "ways out, any of which is enough" },
        list(&ways, "or")
    ))
}

/// What is in a group's way, with how many metres of straights it takes, the most first.
fn causes(group: &Group) -> Vec<(Cause, f64)> {
    let mut causes: Vec<(Cause, f64)> = Vec::new();
    for room in &group.rooms {
        for block in &room.blocks {
            let metres = (block.high.min(room.reach.1) - block.low.max(room.reach.0)).max(0.0);
            if metres <= 0.0 {
                continue;
            }
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
fn cause(layout: &Layout, track: &Track, cause: Cause) -> (String, Option<Span>) {
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

/// How far an obstacle has to be moved away from one of the straights, m, so that everything finds room, if that is enough
/// and leaves the track its clearance.
fn moved(layout: &Layout, track: &Track, task: &Task, group: &Group, obstacle: usize) -> Option<f64> {
    let own = &layout.obstacles[obstacle];
    let blocked = |room: &&Room| room.blocks.iter().any(|b| b.cause == Cause::Obstacle(obstacle));
    let shift = |room: &Room| {
        let line: &Line = &task.lines[task.stretches[room.stretch].section];
        let side = *room.sides.first()?;
        let far = task.half + group.of.depth + group.of.aisle;
        let near = own.polygon.points().iter().map(|p| side * line.local(*p).y).fold(f64::INFINITY, f64::min);
        (near < far).then(|| (far - near, line.along.left() * side))
    };
    let mut tried: Vec<(f64, Point)> = group.rooms.iter().filter(blocked).filter_map(shift).collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    tried.into_iter().find_map(|(by, out)| {
        let points = own.polygon.points().iter().map(|p| *p + out * by).collect();
        let mut changed = layout.clone();
        changed.obstacles[obstacle].polygon = Polygon::new(points).ok()?;
        let lies = if own.side == Side::Right { -1.0 } else { 1.0 };
        let region = Region { polygon: changed.obstacles[obstacle].polygon.clone(), outside: false, lies };
        let clear = region.distance(track) >= task.half + own.clearance - TOLERANCE;
        (clear && place(&changed, track).is_whole()).then_some(by)
    })
}

/// Other changes of the declaration that are enough.
fn other_ways(layout: &Layout, track: &Track, index: usize) -> Vec<String> {
    let fits = |change: &dyn Fn(&mut Declared)| {
        let mut changed = layout.clone();
        change(&mut changed.equipment.declared[index]);
        place(&changed, track).is_whole()
    };
    let declared = &layout.equipment.declared[index];
    let mut ways = Vec::new();
    if let Stands::Free { on, after, before, .. } = &declared.stands {
        let anywhere = |d: &mut Declared| {
            if let Stands::Free { on, .. } = &mut d.stands {
                on.clear();
            }
        };
        if !on.is_empty() && fits(&anywhere) {
            ways.push("let it stand `anywhere`".to_owned());
        }
        let unordered = |d: &mut Declared| {
            if let Stands::Free { after, before, .. } = &mut d.stands {
                after.clear();
                before.clear();
            }
        };
        if !(after.is_empty() && before.is_empty()) && fits(&unordered) {
            ways.push("leave out `after` and `before`".to_owned());
        }
    }
    let side = declared.of.side;
    if !matches!(side, EquipmentSide::Either | EquipmentSide::Both) && fits(&|d| d.of.side = EquipmentSide::Either) {
        ways.push("let it stand on either side, with `side = either`".to_owned());
    }
    ways
}

/// To the centimetre, upwards.
fn up(metres: f64) -> String {
    trimmed((metres * 100.0 - 1e-4).ceil() / 100.0, 2)
}
