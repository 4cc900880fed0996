//! The places that a track leaves for equipment: which kinds, how many, in which order, and where each may begin.

use super::footprint::{Footprint, Line, conveyor};
use super::shadow::{band, shadow};
use crate::geometry::{Point, Track};
use crate::model::{Declared, EquipmentSide, EquipmentType, Layout, Stands, StraightPlace};

/// Between two stretches in what counts along the loop, m: more than any room reaches.
const APART: f64 = 1e4;

/// A straight, or the part of one before or behind the layout's start, in driving order.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    pub section: usize,
    /// Where the middle of what stands on it may lie, m along the straight.
    pub from: f64,
    pub to: f64,
    /// What counts along the loop is this and the distance along the straight, m.
    pub offset: f64,
}

/// What keeps equipment from a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// By index into the layout's obstacles.
    Obstacle(usize),
    Building,
    /// Another piece of the track, by its index.
    Track(usize),
    /// Equipment whose place is given, by its index among what is declared.
    Equipment(usize),
}

/// Begins that are kept from, m along the straight: open at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    pub low: f64,
    pub high: f64,
    pub cause: Cause,
}

/// Sides that one piece of equipment stands on together: +1 left, -1 right.
pub type Sides = &'static [f64];

pub const LEFT: Sides = &[1.0];
pub const RIGHT: Sides = &[-1.0];
pub const BOTH: Sides = &[1.0, -1.0];

/// A place to begin at: a stretch of the loop and sides, with the begins that are free, m along the straight.
#[derive(Clone, Debug)]
pub struct Room {
    pub stretch: usize,
    pub sides: Sides,
    /// Without what is in the way.
    pub reach: (f64, f64),
    pub blocks: Vec<Block>,
    /// Closed, ascending.
    pub free: Vec<(f64, f64)>,
}

/// Equipment of one declaration that stands freely.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index among what the layout declares.
    pub declared: usize,
    pub of: EquipmentType,
    pub count: usize,
    pub fed: Option<Point>,
    /// Where a conveyor begins that has a price.
    pub priced_from: Option<Point>,
    /// Groups that have to be placed as a whole before.
    pub behind: Vec<usize>,
    /// In driving order.
    pub rooms: Vec<Room>,
}

/// Everything that a search for places goes by.
#[derive(Clone, Debug)]
pub struct Task {
    pub lines: Vec<Line>,
    pub half: f64,
    pub stretches: Vec<Stretch>,
    pub groups: Vec<Group>,
    /// Equipment whose place the layout gives, with its sides.
    pub given: Vec<Given>,
}

/// Equipment at the place that the layout gives it.
#[derive(Clone, Debug)]
pub struct Given {
    pub declared: usize,
    pub number: usize,
    pub place: StraightPlace,
    pub sides: Sides,
    pub footprint: Footprint,
}

impl Task {
    pub fn new(layout: &Layout, track: &Track) -> Task {
        let half = layout.width.value / 2.0;
        let lines: Vec<Line> = (0..layout.vertices.len()).map(|i| Line::of(track.straight(i))).collect();
        let stretches = stretches(layout, &lines);
        let mut task = Task { lines, half, stretches, groups: Vec::new(), given: Vec::new() };
        for (i, declared) in layout.equipment.declared.iter().enumerate() {
            // Of two sides that it may stand on, what the layout places stands on the outer one.
            let Some(&sides) = sides(declared.of.side, track).first() else { continue };
            task.given.extend(declared.given().into_iter().enumerate().map(|(number, place)| {
                let begin = place.at - 0.5 * declared.of.stretch;
                let footprint = Footprint::new(&declared.of, &task.lines[place.section], begin, sides, half);
                Given { declared: i, number, place, sides, footprint }
            }));
        }
        let free: Vec<usize> = (0..layout.equipment.declared.len())
            .filter(|i| matches!(layout.equipment.declared[*i].stands, Stands::Free { .. }))
            .collect();
        for &i in &free {
            let group = task.group(layout, track, i, &free);
            task.groups.push(group);
        }
        task.order_alike(layout);
        task
    }

    /// Of groups that nothing tells apart, one may be placed before the next: exchanging two of their pieces changes nothing.
    fn order_alike(&mut self, layout: &Layout) {
        let declared = |g: usize| &layout.equipment.declared[self.groups[g].declared];
        let alike = |a: usize, b: usize| {
            let (x, y) = (&self.groups[a], &self.groups[b]);
            let alone = |name: &str| {
                let names = |d: &Declared| match &d.stands {
                    Stands::Free { after, before, .. } => after.iter().chain(before).any(|n| n == name),
                    _ => false,
                };
                !layout.equipment.declared.iter().any(names)
            };
            let on = |g: usize| match &declared(g).stands {
                Stands::Free { on, after, before, .. } if after.is_empty() && before.is_empty() => Some(on.clone()),
                _ => None,
            };
            x.of == y.of
                && x.fed.is_none()
                && y.fed.is_none()
                && on(a).is_some()
                && on(a) == on(b)
                && alone(&declared(a).name)
                && alone(&declared(b).name)
        };
        let n = self.groups.len();
        let pairs: Vec<(usize, usize)> =
            (0..n).filter_map(|b| (0..b).rev().find(|a| alike(*a, b)).map(|a| (a, b))).collect();
        for (a, b) in pairs {
            self.groups[b].behind.push(a);
        }
    }

    fn group(&self, layout: &Layout, track: &Track, index: usize, free: &[usize]) -> Group {
        let all = &layout.equipment.declared;
        let declared = &all[index];
        let none = Vec::new();
        let (count, on, after, before) = match &declared.stands {
            Stands::Free { count, on, after, before } => (*count, on, after, before),
            _ => (0, &none, &Vec::new(), &Vec::new()),
        };
        let precedes = |a: usize| {
            let named = after.contains(&all[a].name);
            let names = matches!(&all[a].stands, Stands::Free { before, .. } if before.contains(&declared.name));
            named || names
        };
        let behind = (0..free.len()).filter(|g| precedes(free[*g])).collect();
        let mut between = (f64::NEG_INFINITY, f64::INFINITY);
        for (name, x) in self.known(layout) {
            if after.contains(&name) {
                between.0 = between.0.max(x);
            }
            if before.contains(&name) {
                between.1 = between.1.min(x);
            }
        }
        let mut rooms = Vec::new();
        for (k, stretch) in self.stretches.iter().enumerate() {
            if !on.is_empty() && !on.contains(&stretch.section) {
                continue;
            }
            for sides in sides(declared.of.side, track) {
                rooms.extend(self.room(layout, track, &declared.of, (k, sides), between));
            }
        }
        Group {
            declared: index,
            of: declared.of.clone(),
            count,
            fed: declared.fed,
            priced_from: declared.priced_from(),
            behind,
            rooms,
        }
    }

    /// What has a given place, by name, with where that is along the loop, m.
    fn known(&self, layout: &Layout) -> Vec<(String, f64)> {
        let equipment = &layout.equipment;
        // Without what another placement has filled in.
        let free = |name: &str| equipment.declared.iter().any(|d| d.name == name);
        let inductions = equipment.inductions.iter().filter(|i| !free(&i.name));
        let own = inductions.map(|i| (i.name.clone(), i.place));
        let rows = equipment.chutes.iter().filter(|c| !free(&c.name)).flat_map(|c| {
            c.rows().flat_map(|row| row.places()).map(|place| (c.name.clone(), place)).collect::<Vec<_>>()
        });
        let given = self.given.iter().map(|g| (equipment.declared[g.declared].name.clone(), g.place));
        own.chain(rows).chain(given).map(|(name, place)| (name, self.along_loop(place))).collect()
    }

    /// How far along the loop from the layout's start a place lies, m, as stretches count it.
    pub fn along_loop(&self, place: StraightPlace) -> f64 {
        let of_section = self.stretches.iter().filter(|s| s.section == place.section);
        let holds = of_section.clone().find(|s| s.from <= place.at && place.at <= s.to);
        holds.or_else(|| of_section.clone().next()).map_or(0.0, |s| s.offset + place.at)
    }

    fn room(
        &self,
        layout: &Layout,
        track: &Track,
        of: &EquipmentType,
        (k, sides): (usize, Sides),
        between: (f64, f64),
    ) -> Option<Room> {
        let stretch = self.stretches[k];
        let line = &self.lines[stretch.section];
        let middle = 0.5 * of.stretch;
        let low = of.from_curve.max(stretch.from - middle).max(between.0 - stretch.offset - middle);
        let high = (line.length - of.stretch - of.from_curve)
            .min(stretch.to - middle)
            .min(between.1 - stretch.offset - middle);
        if low > high + 1e-9 {
            return None;
        }
        let reach = (low, high.max(low));
        let mut blocks = Vec::new();
        let seen = (low - of.service - 1.0, high + of.stretch + of.service + 1.0);
        for side in sides {
            let strip = (side * self.half, side * (self.half + of.depth + of.aisle));
            let mut add = |points: &[Point], strip, around: f64, outside, cause| {
                for (a, b) in shadow(points, line, strip, seen, outside) {
                    blocks.push(Block { low: a - of.stretch - around, high: b + around, cause });
                }
            };
            for (i, obstacle) in layout.obstacles.iter().enumerate() {
                add(obstacle.polygon.points(), strip, of.service, false, Cause::Obstacle(i));
            }
            if let Some(building) = &layout.building {
                add(building.polygon.points(), strip, of.service, true, Cause::Building);
            }
            for (i, piece) in track.pieces.iter().enumerate() {
                if i != 2 * stretch.section && piece.length > 1e-9 {
                    add(&band(piece, self.half), strip, of.service, false, Cause::Track(i));
                }
            }
            let covered = (side * self.half, side * (self.half + of.depth));
            for given in &self.given {
                let cause = Cause::Equipment(given.declared);
                given.footprint.covers.iter().for_each(|r| add(r, strip, of.service, false, cause));
                given.footprint.room.iter().for_each(|r| add(r, covered, 0.0, false, cause));
            }
        }
        let free = without(reach, &blocks);
        Some(Room { stretch: k, sides, reach, blocks, free })
    }

    /// The room for a kind on one straight, wherever the layout's start lies.
    pub fn whole_room(
        &self,
        layout: &Layout,
        track: &Track,
        of: &EquipmentType,
        section: usize,
        sides: Sides,
    ) -> Option<Room> {
        let to = self.lines[section].length;
        let task = Task { stretches: vec![Stretch { section, from: 0.0, to, offset: 0.0 }], ..self.clone() };
        task.room(layout, track, of, (0, sides), (f64::NEG_INFINITY, f64::INFINITY))
    }

    /// What the conveyor to a group's equipment costs that begins so far along its straight, EUR.
    pub fn price(&self, group: &Group, room: &Room, begin: f64) -> f64 {
        let Some(from) = group.fed else { return 0.0 };
        let line = &self.lines[self.stretches[room.stretch].section];
        group.of.conveyor * conveyor(&group.of, line, begin, room.sides, self.half, from)
    }

    /// Where along a straight the conveyor would be shortest, m.
    pub fn nearest(&self, group: &Group, room: &Room) -> Option<f64> {
        let from = group.priced_from?;
        let line = &self.lines[self.stretches[room.stretch].section];
        Some(line.local(from).x - 0.5 * group.of.stretch)
    }

    pub fn footprint(&self, group: &Group, room: &Room, begin: f64) -> Footprint {
        Footprint::new(&group.of, &self.lines[self.stretches[room.stretch].section], begin, room.sides, self.half)
    }
}

/// What is left of an interval without open ones, ascending.
pub fn without(reach: (f64, f64), blocks: &[Block]) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> = blocks.iter().map(|b| (b.low, b.high)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut free = Vec::new();
    let mut from = reach.0;
    for (low, high) in sorted {
        if low >= from {
            if low <= reach.1 {
                free.push((from, low));
            } else {
                break;
            }
        }
        from = from.max(high);
    }
    if from <= reach.1 {
        free.push((from, reach.1));
    }
    free
}

/// The straights in driving order from the layout's start on. The one that it lies on is there twice.
fn stretches(layout: &Layout, lines: &[Line]) -> Vec<Stretch> {
    let n = lines.len();
    let start = layout.equipment.start;
    let first = start.map_or(0, |place| place.section);
    let at = start.map_or(0.0, |place| place.at.clamp(0.0, lines[first].length.max(0.0)));
    let mut stretches = Vec::new();
    for k in 0..=n {
        let section = (first + k) % n;
        let from = if k == 0 { at } else { 0.0 };
        let to = if k == n { at } else { lines[section].length };
        if to - from > 1e-9 {
            stretches.push(Stretch { section, from, to, offset: k as f64 * APART });
        }
    }
    stretches
}

/// The sides of travel that a side of the loop is, each a way to stand.
fn sides(side: EquipmentSide, track: &Track) -> Vec<Sides> {
    let turned: f64 = track.fillets.iter().map(|f| f.turn).sum();
    let (outer, inner) = if turned < 0.0 { (LEFT, RIGHT) } else { (RIGHT, LEFT) };
    match side {
        EquipmentSide::Left => vec![LEFT],
        EquipmentSide::Right => vec![RIGHT],
        EquipmentSide::Outer => vec![outer],
        EquipmentSide::Inner => vec![inner],
        EquipmentSide::Either => vec![outer, inner],
        EquipmentSide::Both => vec![BOTH],
    }
}
