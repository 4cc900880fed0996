//! Ways from one place to another around obstacles: lines that are taut about circles, shortest first.
//!
//! A shortest line that keeps a distance from polygons is made of tangents between circles about their corners, and of
//! arcs on these (Lozano-Pérez and Wesley 1979 for points among polygons). In such a graph every path is taut, and two
//! taut paths between the same places pass some obstacle on different sides: the shortest paths are the shortest of
//! each way around. They are found in order of their length (Dijkstra 1959, with the paths to each link kept apart).

use super::dubins::Pose;
use super::plane::Plane;
use crate::base::trig;
use crate::geometry::Point;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// An arc this close to a full turn is none, rad.
const FULL: f64 = 1e-6;
/// Most of a turn about a corner and where a way begins or ends, rad.
const ABOUT_CORNER: f64 = trig::PI + 1e-6;
const AT_END: f64 = 1.8 * trig::PI;
/// Most steps of a search.
const STEPS: usize = 1_000_000;

/// A circle that is driven around in one direction; a place is one without a radius.
#[derive(Clone, Copy, Debug)]
struct Disc {
    centre: Point,
    radius: f64,
    /// 1 for a left turn, -1 for a right one.
    hand: f64,
    /// What it is a circle about, for the two directions alike.
    about: usize,
}

/// A straight from circle to circle.
#[derive(Clone, Copy, Debug)]
struct Link {
    from: usize,
    to: usize,
    /// Unit vector.
    along: Point,
    length: f64,
}

/// Where a way may begin or end.
#[derive(Clone, Copy, Debug)]
pub struct Port {
    centre: Point,
    radius: f64,
    hand: f64,
    /// Direction of travel; of a place, none.
    direction: Option<Point>,
    /// What is driven beyond it, m.
    cost: f64,
}

impl Port {
    /// A place that is left or reached in any direction.
    pub fn place(point: Point) -> Port {
        Port { centre: point, radius: 0.0, hand: 1.0, direction: None, cost: 0.0 }
    }

    /// A turn that begins, or ends, at a pose, after `cost` metres.
    pub fn turn(pose: Pose, hand: f64, radius: f64, cost: f64) -> Port {
        let centre = pose.point + pose.direction.left() * (hand * radius);
        Port { centre, radius, hand, direction: Some(pose.direction), cost }
    }
}

/// A turn of a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    pub centre: Point,
    pub radius: f64,
    pub hand: f64,
    /// Direction of travel where it begins.
    pub from: Point,
    /// rad, at least 0
    pub turn: f64,
}

#[derive(Clone, Debug)]
pub struct Way {
    /// m
    pub length: f64,
    /// The first where it begins, the last where it ends; corners between. Of places, corners only.
    pub arcs: Vec<Arc>,
    /// Which corners it bends about, and how.
    pub word: Vec<i64>,
}

/// Tangents between the circles about all corners.
pub struct Tangents<'a> {
    plane: &'a Plane,
    discs: Vec<Disc>,
    /// By the circle that they leave.
    links: Vec<Vec<Link>>,
}

impl<'a> Tangents<'a> {
    pub fn new(plane: &'a Plane) -> Self {
        let discs: Vec<Disc> = plane
            .corners()
            .iter()
            .enumerate()
            .flat_map(|(about, &(centre, radius))| [1.0, -1.0].map(|hand| Disc { centre, radius, hand, about }))
            .collect();
        let links = (0..discs.len()).map(|from| tangents(plane, &discs, from, 0..discs.len())).collect();
        Tangents { plane, discs, links }
    }

    /// Length of the shortest line between two places, m; none is infinite.
    pub fn distance(&self, from: Point, to: Point) -> f64 {
        if self.plane.is_clear(from, to) {
            return from.distance(to);
        }
        let (ways, whole) = self.search(&[Port::place(from)], &[Port::place(to)], 1);
        match ways.first() {
            Some(way) => way.length,
            None if whole => f64::INFINITY,
            // Not known: no shorter than straight on, in any case.
            None => from.distance(to),
        }
    }

    /// The shortest ways, at most so many, each different in what it bends about.
    pub fn ways(&self, from: &[Port], to: &[Port], most: usize) -> Vec<Way> {
        self.search(from, to, most).0
    }

    /// The same, and whether the search was not cut.
    fn search(&self, from: &[Port], to: &[Port], most: usize) -> (Vec<Way>, bool) {
        let fixed = self.discs.len();
        let mut discs = self.discs.clone();
        let port = |k: usize, p: &Port| Disc { centre: p.centre, radius: p.radius, hand: p.hand, about: fixed + k };
        discs.extend(from.iter().chain(to).enumerate().map(|(k, p)| port(k, p)));
        let (begin, end) = (fixed..fixed + from.len(), fixed + from.len()..discs.len());
        let mut links: Vec<Link> = self.links.iter().flatten().copied().collect();
        let onward: Vec<usize> = (0..fixed).chain(end.clone()).collect();
        for k in begin.clone() {
            links.extend(tangents(self.plane, &discs, k, onward.iter().copied()));
        }
        for k in 0..fixed {
            links.extend(tangents(self.plane, &discs, k, end.clone()));
        }
        let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); discs.len()];
        links.iter().enumerate().for_each(|(i, link)| leaving[link.from].push(i));
        let port_of = |disc: usize| if disc < end.start { &from[disc - fixed] } else { &to[disc - end.start] };

        let mut heap = BinaryHeap::new();
        let mut steps: Vec<Step> = Vec::new();
        let mut arrivals = vec![0usize; links.len()];
        for (i, link) in links.iter().enumerate().filter(|(_, l)| begin.contains(&l.from)) {
            let port = port_of(link.from);
            let Some(turn) = self.arc(&discs[link.from], port.direction.unwrap_or(link.along), link.along, AT_END)
            else {
                continue;
            };
            push(&mut heap, &mut steps, port.cost + turn * port.radius + link.length, i, None, turn);
        }
        let (mut found, mut whole): (Vec<Way>, bool) = (Vec::new(), true);
        while let Some(Next { cost, step }) = heap.pop() {
            let Step { link, done, .. } = steps[step];
            if done {
                let way = self.way(&steps, step, &links, &discs, port_of, cost);
                if !found.iter().any(|f| f.word == way.word) {
                    found.push(way);
                }
                if found.len() == most {
                    break;
                }
                continue;
            }
            arrivals[link] += 1;
            if arrivals[link] > most {
                continue;
            }
            if steps.len() > STEPS {
                whole = false;
                break;
            }
            let at = links[link];
            if end.contains(&at.to) {
                let port = port_of(at.to);
                let direction = port.direction.unwrap_or(at.along);
                if let Some(turn) = self.arc(&discs[at.to], at.along, direction, AT_END) {
                    let cost = cost + turn * port.radius + port.cost;
                    steps.push(Step { link, before: Some(step), turn, done: true });
                    heap.push(Next { cost, step: steps.len() - 1 });
                }
                continue;
            }
            for &next in &leaving[at.to] {
                let onward = links[next];
                if arrivals[next] >= most || self.visited(&steps, step, &links, &discs, discs[onward.to].about) {
                    continue;
                }
                let Some(turn) = self.arc(&discs[at.to], at.along, onward.along, ABOUT_CORNER) else { continue };
                let cost = cost + turn * discs[at.to].radius + onward.length;
                push(&mut heap, &mut steps, cost, next, Some(step), turn);
            }
        }
        (found, whole)
    }

    /// The turn on a circle from one direction to another, rad, if it is no larger than `most` and clear.
    fn arc(&self, disc: &Disc, from: Point, to: Point, most: f64) -> Option<f64> {
        if disc.radius == 0.0 {
            return Some(0.0);
        }
        let turn = (disc.hand * trig::atan2(from.cross(to), from.dot(to))).rem_euclid(trig::TAU);
        let turn = if turn > trig::TAU - FULL { 0.0 } else { turn };
        let clear = || turn < FULL || self.plane.arc_is_clear(disc.centre, disc.radius, disc.hand, from, turn);
        (turn <= most && clear()).then_some(turn)
    }

    /// Whether a path has been at a corner already.
    fn visited(&self, steps: &[Step], last: usize, links: &[Link], discs: &[Disc], about: usize) -> bool {
        let mut at = Some(last);
        while let Some(step) = at {
            if discs[links[steps[step].link].to].about == about {
                return true;
            }
            at = steps[step].before;
        }
        false
    }

    fn way<'p>(
        &self,
        steps: &[Step],
        last: usize,
        links: &[Link],
        discs: &[Disc],
        port_of: impl Fn(usize) -> &'p Port,
        length: f64,
    ) -> Way {
        let mut chain = vec![last];
        while let Some(before) = chain.last().and_then(|&s| steps[s].before) {
            chain.push(before);
        }
        chain.reverse();
        let mut arcs = Vec::new();
        let mut word = Vec::new();
        for &step in &chain {
            let Step { link, done, turn, .. } = steps[step];
            let link = links[link];
            let index = if done { link.to } else { link.from };
            let disc = discs[index];
            let port = index >= self.discs.len();
            // The turn before a link, or behind the last one.
            let from = match (done, port) {
                (true, _) => link.along,
                (false, true) => port_of(index).direction.unwrap_or(link.along),
                (false, false) => steps[step].before.map_or(link.along, |b| links[steps[b].link].along),
            };
            if disc.radius > 0.0 {
                arcs.push(Arc { centre: disc.centre, radius: disc.radius, hand: disc.hand, from, turn });
            }
            word.push(if port { disc.hand as i64 } else { (2 + index) as i64 });
        }
        Way { length, arcs, word }
    }
}

/// A link of a path, and the path before it.
#[derive(Clone, Copy)]
struct Step {
    link: usize,
    before: Option<usize>,
    /// The turn before the link, or when it is `done`, behind it.
    turn: f64,
    done: bool,
}

#[derive(PartialEq)]
struct Next {
    cost: f64,
    step: usize,
}

impl Eq for Next {}

impl Ord for Next {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.step.cmp(&self.step))
    }
}

impl PartialOrd for Next {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

fn push(heap: &mut BinaryHeap<Next>, steps: &mut Vec<Step>, cost: f64, link: usize, before: Option<usize>, turn: f64) {
    steps.push(Step { link, before, turn, done: false });
    heap.push(Next { cost, step: steps.len() - 1 });
}

/// Clear straights from a circle to others.
fn tangents(plane: &Plane, discs: &[Disc], from: usize, to: impl Iterator<Item = usize>) -> Vec<Link> {
    let a = discs[from];
    let link = |to: usize| {
        let b = discs[to];
        let between = b.centre - a.centre;
        let distance = between.norm();
        if a.about == b.about || distance < 1e-9 {
            return None;
        }
        // The line has the circles' centres this much farther to its left at the end than at the begin.
        let across = b.hand * b.radius - a.hand * a.radius;
        if across.abs() > distance {
            return None;
        }
        let heading = between.heading() - trig::asin(across / distance);
        let along = Point::unit(heading);
        let (p, q) = (a.centre - along.left() * (a.hand * a.radius), b.centre - along.left() * (b.hand * b.radius));
        plane.is_clear(p, q).then(|| Link {
            from,
            to,
            along,
            length: libm::sqrt((distance * distance - across * across).max(0.0)),
        })
    };
    to.filter_map(link).collect()
}
