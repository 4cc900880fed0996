//! Equipment along the loop in the order of its middles: a dynamic program over how much of each group there is, how far
//! each side of the track is taken, and where the last middle lies.

use super::frontier::{Frontier, Label, Last, Put, indices};
use super::task::{Group, Room, Task};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What conveyors' ends are a multiple of apart, along a straight, m.
pub const STEP: f64 = 0.1;
/// Most labels with as many pieces placed, of all counts.
pub const MOST_OPEN: usize = 20_000;
/// What is cheaper is so by this at least, EUR.
const CHEAPER: f64 = 1e-6;

/// Labels with as many pieces placed, by how many of each group: indices into all of them.
pub type Layer = BTreeMap<Vec<usize>, Range<usize>>;

/// What a place with a conveyor is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// The earliest of all: what conveyors cost is left out.
    Room,
    /// Itself.
    Places,
    /// The cheapest and the earliest of its cell at once.
    Cells,
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

/// Whether what was placed leaves room for so many of each group.
pub type LeavesRoom<'a> = dyn Fn(&[usize], &Label) -> bool + 'a;

/// What to look for.
pub struct Program<'a> {
    task: &'a Task,
    free: &'a Free,
    count: Count,
    /// What costs as much, EUR, is not looked for.
    known: f64,
    /// Labels with as many pieces placed, at most.
    most: usize,
    /// Whether a label leaves room for so many of each group: what does not is not looked at.
    leaves_room: Option<&'a LeavesRoom<'a>>,
}

/// All labels, in the order of how many pieces are placed.
pub struct Run {
    pub labels: Vec<Label>,
    pub by_placed: Layer,
    /// Those with the most pieces.
    last: Layer,
    pub whole: bool,
    count: Count,
}

impl<'a> Program<'a> {
    /// As much as fits, as early as it can.
    pub fn of_room(task: &'a Task, free: &'a Free) -> Self {
        Program { task, free, count: Count::Room, known: f64::INFINITY, most: MOST_OPEN, leaves_room: None }
    }

    /// What costs less than `known`, EUR, of at most so many labels a layer.
    pub fn of_cost(task: &'a Task, free: &'a Free, count: Count, known: f64, most: usize) -> Self {
        Program { task, free, count, known, most, leaves_room: None }
    }

    /// Without what leaves no room for the rest.
    pub fn leaving_room(self, leaves_room: &'a LeavesRoom<'a>) -> Self {
        Program { leaves_room: Some(leaves_room), ..self }
    }

    pub fn run(&self) -> Run {
        let groups = &self.task.groups;
        let none = vec![0; groups.len()];
        let first: Layer = BTreeMap::from([(none, 0..1)]);
        let mut run =
            Run { labels: vec![Label::first()], by_placed: first.clone(), last: first, whole: true, count: self.count };
        loop {
            let mut next: BTreeMap<Vec<usize>, Frontier> = BTreeMap::new();
            for (placed, of) in &run.last {
                for (g, group) in groups.iter().enumerate() {
                    if placed[g] < group.count && group.behind.iter().all(|b| placed[*b] == groups[*b].count) {
                        let mut key = placed.clone();
                        key[g] += 1;
                        let left: Vec<usize> = groups.iter().zip(&key).map(|(group, n)| group.count - n).collect();
                        let found = next.entry(key).or_default();
                        of.clone().for_each(|from| self.extend(&run.labels, (g, from), &left, found));
                    }
                }
            }
            let mut found: Vec<(Vec<usize>, Vec<Label>)> = Vec::new();
            for (placed, frontier) in next {
                let (of, dropped) = frontier.into_labels();
                run.whole &= !dropped;
                if !of.is_empty() {
                    found.push((placed, of));
                }
            }
            if found.is_empty() {
                return run;
            }
            run.whole &= !thinned(&mut found, self.most);
            run.last = BTreeMap::new();
            for (placed, of) in found {
                let from = run.labels.len();
                run.labels.extend(of);
                run.by_placed.insert(placed.clone(), from..run.labels.len());
                run.last.insert(placed, from..run.labels.len());
            }
        }
    }

    /// Adds the labels with one more of a group, of which so many of each group are left then.
    fn extend(&self, labels: &[Label], (g, from): (usize, usize), left: &[usize], found: &mut Frontier) {
        let Program { task, free, .. } = self;
        for mut label in ways(task, (g, &task.groups[g]), &free[g], (from, &labels[from]), self.count) {
            if self.count != Count::Room {
                label.least = label.cost + rest(task, free, left, label.middle);
            }
            let roomy = || self.leaves_room.is_none_or(|leaves_room| leaves_room(left, &label));
            if label.least < self.known - CHEAPER && roomy() {
                found.add(label);
            }
        }
    }
}

impl Run {
    /// Of the labels with the most pieces, the cheapest.
    pub fn best(&self, task: &Task) -> Along {
        let all = self.last.iter().flat_map(|(placed, of)| of.clone().map(move |label| (placed, label)));
        let better = |a: &(&Vec<usize>, usize), b: &(&Vec<usize>, usize)| {
            let (a, b) = (&self.labels[a.1], &self.labels[b.1]);
            a.cost.total_cmp(&b.cost).then(a.middle.total_cmp(&b.middle))
        };
        let (placed, end) = match all.min_by(better) {
            Some((placed, end)) => (placed.clone(), end),
            None => (vec![0; task.groups.len()], 0),
        };
        let mut puts = Vec::new();
        let mut at = end;
        while let Some(last) = self.labels[at].last {
            puts.push(last.put);
            at = self.labels[at].before;
        }
        puts.reverse();
        let missing = task.groups.iter().zip(&placed).map(|(group, placed)| group.count - placed).collect();
        let cost = match self.count {
            Count::Room => puts.iter().map(|put| put.price(task)).sum(),
            _ => self.labels[end].cost,
        };
        Along { puts, missing, cost, whole: self.whole }
    }
}

/// What conveyors to what is left cost at least, EUR, with every middle behind this one: infinite where there is no place.
fn rest(task: &Task, free: &Free, left: &[usize], middle: f64) -> f64 {
    let least = |(g, left): (usize, &usize)| {
        let group = &task.groups[g];
        let of_room = |(r, room): (usize, &Room)| {
            let earliest = middle - 0.5 * group.of.stretch - task.stretches[room.stretch].offset;
            let nearest = task.nearest(group, room).unwrap_or(0.0);
            let behind = free[g][r].iter().filter(|(_, high)| *high >= earliest - 1e-9);
            let price =
                |(low, high): &(f64, f64)| task.price(group, room, nearest.clamp(low.max(earliest).min(*high), *high));
            behind.map(price).fold(f64::INFINITY, f64::min)
        };
        let least = group.rooms.iter().enumerate().map(of_room).fold(f64::INFINITY, f64::min);
        *left as f64 * least
    };
    let priced = left.iter().enumerate().filter(|(g, left)| **left > 0 && task.groups[*g].priced_from.is_some());
    priced.map(least).sum()
}

/// Keeps the cheapest and earliest labels where there are too many; whether there were.
fn thinned(found: &mut Vec<(Vec<usize>, Vec<Label>)>, most: usize) -> bool {
    let mut all: Vec<(f64, f64, usize, usize)> = Vec::new();
    for (k, (_, of)) in found.iter().enumerate() {
        all.extend(of.iter().enumerate().map(|(i, label)| (label.least, label.middle, k, i)));
    }
    if all.len() <= most {
        return false;
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then((a.2, a.3).cmp(&(b.2, b.3))));
    let kept: BTreeSet<(usize, usize)> = all.into_iter().take(most).map(|(_, _, k, i)| (k, i)).collect();
    for (k, (_, of)) in found.iter_mut().enumerate() {
        let mut i = 0;
        of.retain(|_| {
            i += 1;
            kept.contains(&(k, i - 1))
        });
    }
    found.retain(|(_, of)| !of.is_empty());
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
        for k in indices(room.sides) {
            earliest = earliest.max(label.end[k] + label.service[k].max(group.of.service));
        }
        let earliest = earliest - stretch.offset;
        let nearest = task.nearest(group, room).filter(|_| count != Count::Room);
        let places = match nearest {
            None => first(&free[r], earliest).map(|begin| (begin, 0.0)).into_iter().collect(),
            Some(nearest) => {
                let price = |begin: f64| task.price(group, room, begin);
                places(&free[r], earliest, nearest, &price, count)
            }
        };
        for (begin, price) in places {
            let x = stretch.offset + begin;
            let (mut end, mut service) = (label.end, label.service);
            for k in indices(room.sides) {
                (end[k], service[k]) = (x + group.of.stretch, group.of.service);
            }
            let middle = x + 0.5 * group.of.stretch;
            let put = Put { group: g, room: r, begin };
            let last = Some(Last { put, sides: room.sides, stretch: group.of.stretch });
            ways.push(Label { cost: label.cost + price, least: 0.0, end, service, middle, last, before });
            if nearest.is_none() {
                settled.push(room.sides);
            }
        }
    }
    ways
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
        if count == Count::Cells {
            places.extend(cuts.windows(2).map(|cell| (cell[0], price(cell[1]))));
            places.push((to, price(to)));
        } else {
            places.extend(cuts.into_iter().map(|begin| (begin, price(begin))));
        }
        if high >= nearest {
            break;
        }
    }
    places
}
