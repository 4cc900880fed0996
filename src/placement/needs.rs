//! How much straight equipment needs on any track: what every placement has to have, whatever the track.

use super::footprint::Line;
use super::sequence::{Part, least_length};
use crate::geometry::{Track, distance_to_segment};
use crate::model::{ConstraintKind, Declared, EquipmentSide, EquipmentType, Layout, Stands};
use crate::source::Span;

/// `Σ lengths of these straights >= low`, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Need {
    pub sections: Vec<usize>,
    pub low: f64,
    pub label: String,
    pub span: Span,
}

/// With the sections that it may stand on, and how much of it stands on the left and on the right: 0 where it chooses.
type Member<'a> = (&'a Declared, (Vec<usize>, f64, f64));

/// Footprints on one side of the track do not overlap, so that the straights of a side are no shorter in all than what has
/// to stand on them, with the room between two and to curves. On one straight that is the least over all orders that may
/// be ([`least_length`]). With n on k of several straights there are n − k gaps and 2 k ends; the least of that over k
/// counts. What chooses its side has both of each straight, and half of that is enough. One row for each set of straights
/// that a declaration names. The written layout says which way the loop turns, as ever.
pub fn needs(layout: &Layout, written: &Track) -> Vec<Need> {
    let all: Vec<usize> = (0..layout.vertices.len()).collect();
    // The sections that it may stand on, and its sides.
    let of = |declared: &Declared| -> (Vec<usize>, f64, f64) {
        let mut on = match &declared.stands {
            Stands::Free { on, .. } if on.is_empty() => all.clone(),
            Stands::Free { on, .. } => on.clone(),
            Stands::At(place) => vec![place.section],
            Stands::Row(row) => vec![row.place.section],
        };
        on.sort_unstable();
        on.dedup();
        let (left, right) = sides(&declared.of, written);
        (on, left, right)
    };
    let declared: Vec<Member> = layout.equipment.declared.iter().map(|d| (d, of(d))).collect();
    let mut sets: Vec<Vec<usize>> = declared.iter().map(|(_, (on, ..))| on.clone()).chain([all]).collect();
    sets.sort();
    sets.dedup();
    let mut needs: Vec<Need> = Vec::new();
    for set in &sets {
        let within: Vec<&Member> = declared.iter().filter(|(_, (on, ..))| on.iter().all(|s| set.contains(s))).collect();
        let mut rows: Vec<(f64, Vec<&Declared>)> = Vec::new();
        for side in [0, 1] {
            let members: Vec<&Declared> =
                within.iter().filter(|(_, (_, l, r))| [*l, *r][side] > 0.0).map(|(d, _)| *d).collect();
            let low = match set[..] {
                [section] => least_length(&parts(&members, is_split(layout, section))),
                _ => side_by_side(&members, set.len()),
            };
            rows.push((low, members));
        }
        if within.iter().any(|(_, (_, l, r))| l + r == 0.0) {
            let members: Vec<&Declared> = within.iter().map(|(d, _)| *d).collect();
            let on_both = within.iter().filter(|(_, (_, l, r))| l + r > 1.0).map(|(d, _)| *d);
            let on_sides: Vec<&Declared> = members.iter().copied().chain(on_both).collect();
            rows.push((0.5 * side_by_side(&on_sides, 2 * set.len()), members));
        }
        let is_free = |d: &&Declared| matches!(d.stands, Stands::Free { .. });
        rows.retain(|(low, members)| *low > 0.0 && members.iter().any(is_free));
        let best = rows.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((low, members)) = best else { continue };
        let names: Vec<String> = members.iter().map(|d| format!("{} {}", d.of.kind.word(), d.name)).collect();
        // The message is about what takes the most.
        let takes = |d: &Declared| d.count() as f64 * d.of.stretch;
        let most = members.iter().copied().filter(is_free).max_by(|a, b| takes(a).total_cmp(&takes(b)));
        let Some(most) = most else { continue };
        let sections: Vec<String> = set.iter().map(|s| layout.section_name(*s)).collect();
        let label = format!("room for {} on the straights {}", names.join(", "), sections.join(", "));
        needs.push(Need { sections: set.clone(), low, label, span: most.span });
    }
    needs
}

/// How much of equipment stands on the left and on the right: 0 where it chooses. The written track says which is outside.
pub(super) fn sides(of: &EquipmentType, written: &Track) -> (f64, f64) {
    let turned: f64 = written.fillets.iter().map(|f| f.turn).sum();
    let outer = if turned < 0.0 { 1.0 } else { -1.0 };
    match of.side {
        EquipmentSide::Left => (1.0, 0.0),
        EquipmentSide::Right => (0.0, 1.0),
        EquipmentSide::Outer => (f64::from(outer > 0.0), f64::from(outer < 0.0)),
        EquipmentSide::Inner => (f64::from(outer < 0.0), f64::from(outer > 0.0)),
        EquipmentSide::Either => (0.0, 0.0),
        EquipmentSide::Both => (1.0, 1.0),
    }
}

/// Whether the loop begins in the middle of a section, so that what comes first may stand behind what comes last.
pub(super) fn is_split(layout: &Layout, section: usize) -> bool {
    layout.equipment.start.is_some_and(|start| start.section == section && start.at > 1e-9)
}

/// What stands on one side of a straight, in the order that is asked for where it is not split.
pub(super) fn parts(members: &[&Declared], split: bool) -> Vec<Part> {
    let names = |names: &[String], of: &Declared| names.contains(&of.name);
    let precedes = |a: &Declared, b: &Declared| {
        let after = matches!(&b.stands, Stands::Free { after, .. } if names(after, a));
        after || matches!(&a.stands, Stands::Free { before, .. } if names(before, b))
    };
    let part = |own: &&Declared| Part {
        count: own.count(),
        stretch: own.of.stretch,
        service: own.of.service,
        from_curve: own.of.from_curve,
        behind: (0..members.len()).filter(|k| !split && precedes(members[*k], own)).collect(),
    };
    members.iter().map(part).collect()
}

/// What equipment takes on so many sides of straights at least, m. Of the services of those on one straight, all but the
/// least are kept ([`least_length`]).
fn side_by_side(members: &[&Declared], sides: usize) -> f64 {
    let services: Vec<f64> = members.iter().flat_map(|d| std::iter::repeat_n(d.of.service, d.count())).collect();
    if services.is_empty() {
        return 0.0;
    }
    let mut largest = services.clone();
    largest.sort_by(|a, b| b.total_cmp(a));
    let all: f64 = services.iter().sum();
    let stretches: f64 = members.iter().map(|d| d.count() as f64 * d.of.stretch).sum();
    let least = |of: fn(&Declared) -> f64| members.iter().map(|d| of(d)).fold(f64::INFINITY, f64::min);
    let (service, from_curve) = (least(|d| d.of.service), least(|d| d.of.from_curve));
    let between = |k: usize| {
        let gaps = (all - largest[..k].iter().sum::<f64>()).max((services.len() - k) as f64 * service);
        gaps + 2.0 * from_curve * k as f64
    };
    stretches + (1..=sides.min(services.len())).map(between).fold(f64::INFINITY, f64::min)
}

/// The least length of a straight on which one more of a kind finds room on a side than on one of `length`, m.
pub fn next(of: &EquipmentType, length: f64) -> (usize, f64) {
    let room = length - 2.0 * of.from_curve + of.service + 1e-6;
    let count = (room / (of.stretch + of.service)).floor().max(0.0);
    (count as usize, (count + 1.0) * of.stretch + count * of.service + 2.0 * of.from_curve)
}

/// How long the conveyor to each piece of a declaration is at least on any track, m, by declaration: where it may stand only
/// on sections whose two vertices are fixed, to the nearest point of their lines; of all others nothing is known.
pub fn least_conveyors(layout: &Layout, written: &Track) -> Vec<f64> {
    let fixed = |section: usize| {
        let ends = [section, layout.next(section)];
        let vertex = |i: usize| {
            layout.constraints.iter().any(|c| match &c.kind {
                ConstraintKind::FixVertex { vertex } => *vertex == i,
                ConstraintKind::FixSection { target, kinds } => {
                    !target.straight && kinds.len() == 4 && (target.from == i || layout.next(target.from) == i)
                }
                _ => false,
            })
        };
        ends.into_iter().all(vertex)
    };
    let half = layout.width.value / 2.0;
    let one = |declared: &Declared| {
        let (Stands::Free { on, .. }, Some(from)) = (&declared.stands, declared.fed) else { return 0.0 };
        if on.is_empty() || !on.iter().all(|s| fixed(*s)) {
            return 0.0;
        }
        let edge = half + declared.of.depth;
        let distance = |section: &usize| {
            let (a, b) = (written.corners[*section].point, written.corners[layout.next(*section)].point);
            let length = a.distance(b);
            let line = Line { begin: a, along: (b - a) * (1.0 / length), length };
            let side = |side: f64| distance_to_segment(from, line.at(0.0, side * edge), line.at(length, side * edge));
            side(1.0).min(side(-1.0))
        };
        on.iter().map(distance).fold(f64::INFINITY, f64::min)
    };
    layout.equipment.declared.iter().map(one).collect()
}
