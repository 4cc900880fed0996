//! Where equipment of a declared kind stands along a track: positions along straights, on either side of the band.
//!
//! Each piece of equipment covers a rectangle beside a straight, and needs room behind it and at its ends. It keeps its
//! distance from curves, stays within the building, off obstacles, off the rest of the track and off other equipment, and
//! stands in the order that the layout asks for, counted from the layout's start. What is minimised is the price of
//! conveyors ([`footprint::conveyor`]). [`along`] solves one straight after another exactly; [`search`] what is left.

mod along;
mod conveyors;
mod findings;
mod footprint;
mod frontier;
mod latest;
mod nearest;
mod needs;
mod program;
mod search;
mod sequence;
mod shadow;
mod task;
#[cfg(test)]
mod tests;
mod walls;
mod ways;

pub use conveyors::conveyors;
pub use findings::findings;
pub use footprint::{Footprint, Line, Rectangle};
pub use nearest::{Along, HalfSpace, Nearest, Way, nearest};
pub use needs::{Need, least_conveyors, needs, next};
pub use walls::{Wall, walls};

use crate::geometry::Track;
use crate::model::{Chutes, EquipmentKind, Induction, Layout, PlaceRow, StraightPlace};
use task::{Sides, Task};

/// One piece of equipment at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Index among what the layout declares.
    pub declared: usize,
    /// Which of them, from 0 in driving order.
    pub number: usize,
    /// Of its middle.
    pub place: StraightPlace,
    /// +1 left of travel, -1 right; both for what stands on both.
    pub sides: &'static [f64],
    pub footprint: Footprint,
    /// Length of the conveyor that feeds it, m.
    pub conveyor: Option<f64>,
}

/// Where everything stands, and what is proven of that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placement {
    /// In the order of declarations, and then of the loop.
    pub placed: Vec<Placed>,
    /// Index among what the layout declares, and how many of it found no place.
    pub missing: Vec<(usize, usize)>,
    /// Price of the equipment that was placed, EUR.
    pub equipment: f64,
    /// Price of its conveyors, EUR.
    pub conveyors: f64,
    /// No places on this track need cheaper conveyors, EUR: at whatever begins, not only those that were tried.
    pub bound: f64,
    /// Nodes of the search.
    pub nodes: usize,
    /// Whether the search came to its end: what is missing then has no place at all.
    pub whole: bool,
}

impl Placement {
    /// Whether all of it has a place.
    pub fn is_whole(&self) -> bool {
        self.missing.is_empty()
    }

    /// Equipment and conveyors, EUR.
    pub fn price(&self) -> f64 {
        self.equipment + self.conveyors
    }
}

/// The cheapest places of a layout's equipment along a track, and how many found none. What the layout places itself is
/// taken as it is.
pub fn place(layout: &Layout, track: &Track) -> Placement {
    if layout.equipment.declared.is_empty() {
        return Placement::default();
    }
    let task = Task::new(layout, track);
    let found = search::search(&task);
    let mut placed: Vec<Placed> = Vec::new();
    let fed = |declared: usize, place: StraightPlace, sides: Sides| {
        let declared = &layout.equipment.declared[declared];
        let line = &task.lines[place.section];
        let begin = place.at - 0.5 * declared.of.stretch;
        declared.fed.map(|from| footprint::conveyor(&declared.of, line, begin, sides, task.half, from))
    };
    for given in &task.given {
        let (declared, number, place, sides) = (given.declared, given.number, given.place, given.sides);
        let (footprint, conveyor) = (given.footprint.clone(), fed(declared, place, sides));
        placed.push(Placed { declared, number, place, sides, footprint, conveyor });
    }
    for put in &found.along.puts {
        let group = &task.groups[put.group];
        let room = &group.rooms[put.room];
        let (declared, sides) = (group.declared, room.sides);
        let place = StraightPlace {
            section: task.stretches[room.stretch].section,
            at: tidy(put.begin + 0.5 * group.of.stretch),
            span: layout.equipment.declared[declared].span,
        };
        let number = placed.iter().filter(|p| p.declared == declared).count();
        let footprint = task.footprint(group, room, put.begin);
        placed.push(Placed { declared, number, place, sides, footprint, conveyor: fed(declared, place, sides) });
    }
    placed.sort_by_key(|p| (p.declared, p.number));
    let of = |p: &Placed| &layout.equipment.declared[p.declared].of;
    let conveyor = |p: &Placed| p.conveyor.map_or(0.0, |length| length * of(p).conveyor);
    let given = placed.iter().filter(|p| !layout.equipment.declared[p.declared].given().is_empty());
    let lacks = task.groups.iter().zip(&found.along.missing).filter(|(_, n)| **n > 0);
    // An empty sum is -0.
    let conveyors = placed.iter().map(conveyor).sum::<f64>() + 0.0;
    Placement {
        missing: lacks.map(|(group, n)| (group.declared, *n)).collect(),
        equipment: placed.iter().map(|p| of(p).article.price.unwrap_or(0.0)).sum::<f64>() + 0.0,
        // Places are rounded to the micrometre.
        bound: conveyors.min(found.bound + given.map(conveyor).sum::<f64>()),
        conveyors,
        nodes: found.nodes,
        whole: found.along.whole,
        placed,
    }
}

/// To the micrometre, as a layout's text would have it.
fn tidy(at: f64) -> f64 {
    (at * 1e6).round() / 1e6
}

/// The layout with its equipment where it was placed, inductions, rows of chutes and scanners among those that it places
/// itself, in the place of those of another placement.
pub fn fill_in(layout: &mut Layout, placement: &Placement) {
    let declared = &layout.equipment.declared;
    let own = |name: &str| declared.iter().all(|d| d.name != name);
    layout.equipment.inductions.retain(|i| own(&i.name));
    layout.equipment.chutes.retain(|c| own(&c.name));
    layout.capacity.scanners = layout.own_scanners().collect();
    for (i, declared) in layout.equipment.declared.iter().enumerate() {
        let places: Vec<StraightPlace> = placement.placed.iter().filter(|p| p.declared == i).map(|p| p.place).collect();
        match declared.of.kind {
            EquipmentKind::Induction => {
                let inductions = places.iter().map(|place| Induction { name: declared.name.clone(), place: *place });
                layout.equipment.inductions.extend(inductions);
            }
            EquipmentKind::Chute => {
                let mut rows = rows(&places).into_iter();
                if let Some(row) = rows.next() {
                    layout.equipment.chutes.push(Chutes { name: declared.name.clone(), row, more: rows.collect() });
                }
            }
            EquipmentKind::Scanner => layout.capacity.scanners.extend(places),
            EquipmentKind::Gate | EquipmentKind::Lift => {}
        }
    }
}

/// Places at equal distances on one straight are a row.
fn rows(places: &[StraightPlace]) -> Vec<PlaceRow> {
    let mut rows: Vec<PlaceRow> = Vec::new();
    for place in places {
        if let Some(row) = rows.last_mut().filter(|row| row.place.section == place.section) {
            let every = place.at - row.place.at - row.every * (row.count - 1) as f64;
            if every > 1e-9 && (row.count == 1 || (every - row.every).abs() < 2e-6) {
                if row.count == 1 {
                    row.every = every;
                }
                row.count += 1;
                continue;
            }
        }
        rows.push(PlaceRow { place: *place, every: 1.0, count: 1 });
    }
    rows
}
