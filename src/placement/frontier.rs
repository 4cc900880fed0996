//! States of the program along the loop, of which only those are kept that no other one of the same count is no worse than.

use super::task::{Sides, Task};

/// What two that are alike differ by at most, m.
const ALIKE: f64 = 1e-9;
/// Most that are kept of one count of everything.
const MOST_KEPT: usize = 3000;
/// What came in is compared once it is so many.
const MOST_WAITING: usize = 100_000;

/// One piece of equipment that was placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Put {
    pub group: usize,
    /// Index into the group's rooms.
    pub room: usize,
    /// m along the straight
    pub begin: f64,
}

impl Put {
    /// Of its conveyor, EUR.
    pub fn price(&self, task: &Task) -> f64 {
        let group = &task.groups[self.group];
        task.price(group, &group.rooms[self.room], self.begin)
    }
}

/// What was placed so far, in the order of middles.
#[derive(Clone, Copy, Debug)]
pub struct Label {
    /// EUR
    pub cost: f64,
    /// `cost`, and what the rest costs at least, EUR.
    pub least: f64,
    /// How far the left and the right side are taken, m along the loop.
    pub end: [f64; 2],
    /// The room that is to be kept behind that, m.
    pub service: [f64; 2],
    /// Where the last middle lies, m along the loop.
    pub middle: f64,
    pub last: Option<Last>,
    /// Index of the label without the last.
    pub before: usize,
}

impl Label {
    /// Nothing is placed.
    pub fn first() -> Label {
        let nowhere = f64::NEG_INFINITY;
        let (end, service) = ([nowhere; 2], [0.0; 2]);
        Label { cost: 0.0, least: 0.0, end, service, middle: nowhere, last: None, before: 0 }
    }
}

/// The last that was placed.
#[derive(Clone, Copy, Debug)]
pub struct Last {
    pub put: Put,
    pub sides: Sides,
    /// m
    pub stretch: f64,
}

/// Sides as indices: 0 left, 1 right.
pub fn indices(sides: Sides) -> impl Iterator<Item = usize> {
    sides.iter().map(|side| usize::from(*side < 0.0))
}

/// Labels with as many pieces of each group.
#[derive(Default)]
pub struct Frontier {
    kept: Vec<Label>,
    waiting: Vec<Label>,
    dropped: bool,
}

impl Frontier {
    pub fn add(&mut self, label: Label) {
        self.waiting.push(label);
        if self.waiting.len() >= MOST_WAITING {
            self.compare();
        }
    }

    /// Those that no other is no worse than, the cheapest first, and whether some were dropped for want of memory.
    pub fn into_labels(mut self) -> (Vec<Label>, bool) {
        self.compare();
        (self.kept, self.dropped)
    }

    /// In the order of costs, no label costs more than one behind it, and what is left to compare are two ends: a staircase
    /// for all labels of one shape, as their last middle follows from an end (Kung, Luccio and Preparata 1975).
    fn compare(&mut self) {
        let mut all = std::mem::take(&mut self.kept);
        all.append(&mut self.waiting);
        let keys = |l: &Label| [l.cost, l.end[0], l.end[1], l.service[0], l.service[1], l.middle];
        // Stable: of those alike, the first that came.
        all.sort_by(|a, b| {
            let pairs = keys(a).into_iter().zip(keys(b));
            pairs.fold(std::cmp::Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b)))
        });
        let mut shapes: Vec<(Shape, Staircase)> = Vec::new();
        for label in all {
            if shapes.iter().any(|(shape, stairs)| stairs.reach(shape.most(&label))) {
                continue;
            }
            if self.kept.len() >= MOST_KEPT {
                self.dropped = true;
                break;
            }
            let shape = Shape::of(&label);
            let at = shapes.iter().position(|(other, _)| *other == shape).unwrap_or(shapes.len());
            if at == shapes.len() {
                shapes.push((shape, Staircase::default()));
            }
            shapes[at].1.insert(label.end);
            self.kept.push(label);
        }
    }
}

/// What labels have in common that differ by their ends alone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    service: [f64; 2],
    /// Sides of the last, and its stretch, m.
    last: Option<(Sides, f64)>,
}

impl Shape {
    fn of(label: &Label) -> Shape {
        Shape { service: label.service, last: label.last.map(|last| (last.sides, last.stretch)) }
    }

    /// How far a label of this shape may reach on either side that is no worse than another one, m.
    fn most(&self, other: &Label) -> [f64; 2] {
        let mut most = [0, 1].map(|k| other.end[k] + (other.service[k] - self.service[k]).min(0.0));
        if let Some((sides, stretch)) = self.last {
            for k in indices(sides) {
                most[k] = most[k].min(other.middle + 0.5 * stretch);
            }
        }
        most.map(|most| most + ALIKE)
    }
}

/// Pairs of which none is no more than another in both: the first ascends, the second descends.
#[derive(Default)]
struct Staircase(Vec<[f64; 2]>);

impl Staircase {
    /// Whether one of them is no more than these.
    fn reach(&self, most: [f64; 2]) -> bool {
        let up_to = self.0.partition_point(|step| step[0] <= most[0]);
        up_to > 0 && self.0[up_to - 1][1] <= most[1]
    }

    fn insert(&mut self, ends: [f64; 2]) {
        if self.reach(ends) {
            return;
        }
        let from = self.0.partition_point(|step| step[0] < ends[0]);
        let to = from + self.0[from..].partition_point(|step| step[1] >= ends[1]);
        self.0.splice(from..to, [ends]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;
    use crate::placement::task::{BOTH, LEFT, RIGHT};

    fn drawn(random: &mut Random) -> Label {
        let mut up_to = |most: usize| (random.uniform() * most as f64).floor();
        let sides = [LEFT, RIGHT, BOTH][up_to(3) as usize];
        let stretch = 0.5 + up_to(2);
        let mut end = [up_to(6), up_to(6)];
        let last = indices(sides).map(|k| end[k]).fold(0.0, f64::max);
        indices(sides).for_each(|k| end[k] = last);
        let put = Put { group: 0, room: 0, begin: last - stretch };
        Label {
            cost: up_to(4),
            end,
            service: [0.1 * up_to(2), 0.1 * up_to(2)],
            middle: last - 0.5 * stretch,
            last: Some(Last { put, sides, stretch }),
            ..Label::first()
        }
    }

    /// Written for any two labels, where the frontier compares shapes.
    fn is_no_worse(a: &Label, b: &Label) -> bool {
        let side = |k: usize| a.end[k] <= b.end[k] && a.end[k] + a.service[k] <= b.end[k] + b.service[k];
        a.cost <= b.cost && a.middle <= b.middle && side(0) && side(1)
    }

    #[test]
    fn what_is_dropped_is_no_better_than_something_kept() {
        let mut random = Random::new(11);
        for _ in 0..300 {
            let all: Vec<Label> = (0..40).map(|_| drawn(&mut random)).collect();
            let mut frontier = Frontier::default();
            all.iter().for_each(|label| frontier.add(*label));
            let (kept, dropped) = frontier.into_labels();
            assert!(!dropped);
            assert!(all.iter().all(|label| kept.iter().any(|known| is_no_worse(known, label))));
            for (i, label) in kept.iter().enumerate() {
                assert!(!kept.iter().enumerate().any(|(j, known)| i != j && is_no_worse(known, label)), "{kept:?}");
            }
        }
    }
}
