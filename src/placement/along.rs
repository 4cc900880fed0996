//! The cheapest places along the loop, exactly, where only what stands beside each other on one straight may be in each
//! other's way: a dynamic program.
//!
//! Equipment is placed in the order of its middles. What matters of what was placed is how much of each group there is, how
//! far each side of the track is taken, and where the last middle lies. What has no conveyor stands as early as it can:
//! with the order kept, moving it back costs nothing and leaves no less room behind. What has one stands at its
//! earliest place, at a multiple of [`STEP`] up to where its conveyor is shortest, or there: the conveyor's length is convex
//! along a straight, so that nothing beyond is cheaper.
//!
//! The same program bounds the cost of *any* places from below: a place between two multiples takes the room of the first
//! and costs what the second does ([`Count::Cells`]).

use super::task::{Group, Room, Task};
use std::collections::{BTreeMap, BTreeSet};

/// What conveyors' ends are a multiple of apart, along a straight, m.
pub const STEP: f64 = 0.1;
/// Most labels of one count of everything.
const MOST_LABELS: usize = 3000;

/// Most labels with as many pieces placed, of all counts.
const MOST_OPEN: usize = 20_000;

/// What a place with a conveyor is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Itself.
    Places,
    /// The cheapest and the earliest of its cell at once.
    Cells,
}

/// One piece of equipment that was placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Put {
    pub group: usize,
    /// Index into the group's rooms.
    pub room: usize,
    /// m along the straight
    pub begin: f64,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Along {
    /// In driving order.
    pub puts: Vec<Put>,
    /// Of each group, how many found no place.
    pub missing: Vec<usize>,
    /// EUR
    pub cost: f64,
    /// Whether nothing was left out for want of memory.
    pub whole: bool,
}

impl Along {
    pub fn lacking(&self) -> usize {
        self.missing.iter().sum()
    }
}

/// The begins that are open, by group and room: closed intervals, ascending.
pub type Free = Vec<Vec<Vec<(f64, f64)>>>;

#[derive(Clone, Copy, Debug)]
struct Label {
    cost: f64,
    /// How far the left and the right side are taken, and the room that is to be kept behind that, m along the loop.
    end: [f64; 2],
    service: [f64; 2],
    middle: f64,
    put: Option<Put>,
    before: usize,
}

impl Label {
    fn is_no_worse_than(&self, other: &Label) -> bool {
        let side = |k: usize| {
            self.end[k] <= other.end[k] + 1e-9
                && self.end[k] + self.service[k] <= other.end[k] + other.service[k] + 1e-9
        };
        self.cost <= other.cost + 1e-9 && self.middle <= other.middle + 1e-9 && side(0) && side(1)
    }
}

/// The most that fits, and of that the cheapest.
pub fn cheapest(task: &Task, free: &Free, count: Count) -> Along {
    let nowhere = [f64::NEG_INFINITY; 2];
    let start = Label { cost: 0.0, end: nowhere, service: [0.0; 2], middle: f64::NEG_INFINITY, put: None, before: 0 };
    let mut labels = vec![start];
    let mut layer: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::from([(vec![0; task.groups.len()], vec![0])]);
    let mut whole = true;
    loop {
        let mut next: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
        for (placed, of) in &layer {
            for (g, group) in task.groups.iter().enumerate() {
                let open = placed[g] < group.count && group.behind.iter().all(|b| placed[*b] == task.groups[*b].count);
                if !open {
                    continue;
                }
                let mut key = placed.clone();
                key[g] += 1;
                let found = next.entry(key).or_default();
                for &from in of {
                    for label in ways(task, (g, group), &free[g], (from, &labels[from]), count) {
                        whole &= add(&mut labels, found, label);
                    }
                }
            }
        }
        next.retain(|_, of| !of.is_empty());
        if next.is_empty() {
            break;
        }
        whole &= !thinned(&labels, &mut next);
        layer = next;
    }
    let all = layer.iter().flat_map(|(placed, of)| of.iter().map(move |label| (placed, *label)));
    let better = |a: &(&Vec<usize>, usize), b: &(&Vec<usize>, usize)| {
        let (a, b) = (&labels[a.1], &labels[b.1]);
        a.cost.total_cmp(&b.cost).then(a.middle.total_cmp(&b.middle))
    };
    let Some((placed, last)) = all.min_by(better) else {
        return Along { puts: Vec::new(), missing: Vec::new(), cost: 0.0, whole };
    };
    let mut puts = Vec::new();
    let mut at = last;
    while let Some(put) = labels[at].put {
        puts.push(put);
        at = labels[at].before;
    }
    puts.reverse();
    let missing = task.groups.iter().zip(placed).map(|(group, placed)| group.count - placed).collect();
    Along { puts, missing, cost: labels[last].cost, whole }
}

/// Keeps the cheapest and earliest labels where there are too many; whether there were.
fn thinned(labels: &[Label], layer: &mut BTreeMap<Vec<usize>, Vec<usize>>) -> bool {
    let mut all: Vec<usize> = layer.values().flatten().copied().collect();
    if all.len() <= MOST_OPEN {
        return false;
    }
    all.sort_by(|a, b| {
        let (x, y) = (&labels[*a], &labels[*b]);
        x.cost.total_cmp(&y.cost).then(x.middle.total_cmp(&y.middle)).then(a.cmp(b))
    });
    let kept: BTreeSet<usize> = all.into_iter().take(MOST_OPEN).collect();
    layer.values_mut().for_each(|of| of.retain(|label| kept.contains(label)));
    layer.retain(|_, of| !of.is_empty());
    true
}

/// Adds a label unless another is no worse; whether nothing was dropped for want of memory.
fn add(labels: &mut Vec<Label>, found: &mut Vec<usize>, label: Label) -> bool {
    if found.iter().any(|known| labels[*known].is_no_worse_than(&label)) {
        return true;
    }
    found.retain(|known| !label.is_no_worse_than(&labels[*known]));
    if found.len() >= MOST_LABELS {
        return false;
    }
    found.push(labels.len());
    labels.push(label);
    true
}

/// The ways to place one more of a group behind what a label has.
fn ways(
    task: &Task,
    (g, group): (usize, &Group),
    free: &[Vec<(f64, f64)>],
    (before, label): (usize, &Label),
    count: Count,
) -> Vec<Label> {
    let mut ways = Vec::new();
    // Without a conveyor, the first place on each of the sides is the best one there.
    let mut settled: Vec<&[f64]> = Vec::new();
    for (r, room) in group.rooms.iter().enumerate() {
        if settled.contains(&room.sides) {
            continue;
        }
        let stretch = &task.stretches[room.stretch];
        let mut earliest = label.middle - 0.5 * group.of.stretch;
        for k in sides(room) {
            earliest = earliest.max(label.end[k] + label.service[k].max(group.of.service));
        }
        let earliest = earliest - stretch.offset;
        let places = match task.nearest(group, room) {
            None => first(&free[r], earliest).map(|begin| (begin, 0.0)).into_iter().collect(),
            Some(nearest) => {
                let price = |begin: f64| task.price(group, room, begin);
                places(&free[r], earliest, nearest, &price, count)
            }
        };
        for (begin, price) in places {
            let x = stretch.offset + begin;
            let (mut end, mut service) = (label.end, label.service);
            for k in sides(room) {
                (end[k], service[k]) = (x + group.of.stretch, group.of.service);
            }
            let middle = x + 0.5 * group.of.stretch;
            let put = Some(Put { group: g, room: r, begin });
            ways.push(Label { cost: label.cost + price, end, service, middle, put, before });
            if task.nearest(group, room).is_none() {
                settled.push(room.sides);
            }
        }
    }
    ways
}

fn sides(room: &Room) -> impl Iterator<Item = usize> + '_ {
    room.sides.iter().map(|side| usize::from(*side < 0.0))
}

fn first(free: &[(f64, f64)], earliest: f64) -> Option<f64> {
    free.iter().find(|(_, high)| *high >= earliest - 1e-9).map(|(low, _)| low.max(earliest))
}

/// Begins with their prices, up to where the price is least and the first one behind that.
fn places(
    free: &[(f64, f64)],
    earliest: f64,
    nearest: f64,
    price: &dyn Fn(f64) -> f64,
    count: Count,
) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    for &(low, high) in free.iter().filter(|(_, high)| *high >= earliest - 1e-9) {
        let from = low.max(earliest);
        let to = high.min(nearest);
        if to <= from {
            places.push((from, price(from)));
            if from >= nearest {
                break;
            }
            continue;
        }
        let mut cuts = vec![from];
        let mut k = (from / STEP).floor() + 1.0;
        while k * STEP < to - 1e-9 {
            if k * STEP > from + 1e-9 {
                cuts.push(k * STEP);
            }
            k += 1.0;
        }
        cuts.push(to);
        match count {
            Count::Places => places.extend(cuts.into_iter().map(|begin| (begin, price(begin)))),
            Count::Cells => {
                places.extend(cuts.windows(2).map(|cell| (cell[0], price(cell[1]))));
                places.push((to, price(to)));
            }
        }
        if high >= nearest {
            break;
        }
    }
    places
}
