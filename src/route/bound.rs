//! How short a loop through the sections can be at best, whatever its curves.
//!
//! Between two sections a track is no shorter than the shortest path of bounded curvature without obstacles (Dubins
//! 1957), and no shorter than the shortest line that keeps its distance from all obstacles. The longer of the two counts.
//!
//! A section of length L that begins between a and b past its limit is replaced by one of length L − (b − a) from b to
//! a + L: whatever leaves the section from s + L also leaves it from a + L, after s − a more metres along its line, and
//! likewise where it is reached. So the sum for the shortened sections is a lower bound for every place between, and
//! halving the ranges closes in on the best (branch and bound, Land and Doig 1960).

use super::dubins::{Pose, shortest};
use super::round::Round;
use super::ways::Tangents;
use crate::geometry::Point;
use std::cell::RefCell;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

/// Ranges that are not halved any more, m in sum.
const FINE: f64 = 0.02;
/// Taken off for rounding, relative: a straight of no length is the root of a difference of numbers of that size.
const ROUNDING: f64 = 1e-7;

/// Where each section begins past its `from`, m, from and to.
pub type Places = Vec<(f64, f64)>;

pub struct Bounds<'a> {
    pub rounds: &'a [Round],
    pub tangents: &'a Tangents<'a>,
    /// Smallest radius, m.
    pub radius: f64,
    /// Whether a section's straight is clear.
    pub is_clear: &'a dyn Fn(Point, Point) -> bool,
    distances: RefCell<BTreeMap<[u64; 4], f64>>,
}

/// Some places of a round's sections.
struct Node {
    bound: f64,
    round: usize,
    places: Places,
    /// Whether obstacles are counted.
    full: bool,
    number: usize,
}

impl<'a> Bounds<'a> {
    pub fn new(
        rounds: &'a [Round],
        tangents: &'a Tangents<'a>,
        radius: f64,
        is_clear: &'a dyn Fn(Point, Point) -> bool,
    ) -> Self {
        Bounds { rounds, tangents, radius, is_clear, distances: RefCell::default() }
    }

    /// A lower bound of every loop of a round, m, with the places where it is the lowest; infinite where there is none.
    pub fn of_round(&self, round: usize, nodes: usize) -> (f64, Places) {
        self.search(&[round], f64::INFINITY, nodes)
    }

    /// A lower bound of every loop of any round, m, given that there is one no longer than `known`.
    pub fn of_all(&self, known: f64, nodes: usize) -> f64 {
        let all: Vec<usize> = (0..self.rounds.len()).collect();
        self.search(&all, known, nodes).0.min(known)
    }

    fn search(&self, rounds: &[usize], known: f64, most: usize) -> (f64, Places) {
        let mut heap = BinaryHeap::new();
        for (number, &round) in rounds.iter().enumerate() {
            let places: Places = self.rounds[round].sections.iter().map(|s| (0.0, s.freedom())).collect();
            heap.push(Node { bound: self.lower(round, &places, false), round, places, full: false, number });
        }
        let mut number = rounds.len();
        let mut nodes = 0;
        while let Some(node) = heap.pop() {
            let widths = node.places.iter().map(|p| p.1 - p.0);
            let done = node.full && (widths.clone().sum::<f64>() <= FINE || nodes >= most);
            if done || node.bound >= known {
                return (node.bound * (1.0 - ROUNDING), node.places);
            }
            if !node.full {
                let bound = self.lower(node.round, &node.places, true);
                if bound.is_finite() {
                    heap.push(Node { bound: bound.max(node.bound), full: true, ..node });
                }
                continue;
            }
            nodes += 1;
            let widest = widths.enumerate().fold((0, 0.0), |best, (k, w)| if w > best.1 { (k, w) } else { best }).0;
            let (low, high) = node.places[widest];
            let middle = (low + high) / 2.0;
            for half in [(low, middle), (middle, high)] {
                let mut places = node.places.clone();
                places[widest] = half;
                let bound = self.lower(node.round, &places, false).max(node.bound);
                heap.push(Node { bound, round: node.round, places, full: false, number });
                number += 1;
            }
        }
        (f64::INFINITY, Vec::new())
    }

    /// A lower bound for some places, m; infinite where a section cannot lie at any of them.
    fn lower(&self, round: usize, places: &Places, obstacles: bool) -> f64 {
        let sections = &self.rounds[round].sections;
        let n = sections.len();
        let pose = |k: usize, along: f64| {
            let direction = sections[k].direction();
            Pose { point: sections[k].from + direction * along, direction }
        };
        let (mut sum, mut narrow) = (0.0, vec![false; n]);
        for (k, section) in sections.iter().enumerate() {
            let ((low, high), length) = (places[k], section.length());
            sum += length - (high - low);
            narrow[k] = high - low <= length;
            let (begin, end) = (pose(k, high).point, pose(k, low + length).point);
            if obstacles && narrow[k] && !(self.is_clear)(begin, end) {
                return f64::INFINITY;
            }
        }
        for k in 0..n {
            let next = (k + 1) % n;
            let from = pose(k, places[k].0 + sections[k].length());
            let to = pose(next, places[next].1);
            let mut between = shortest(from, to, self.radius);
            if obstacles && narrow[k] && narrow[next] {
                between = between.max(self.distance(from.point, to.point));
            }
            sum += between;
        }
        sum
    }

    fn distance(&self, from: Point, to: Point) -> f64 {
        let key = [from.x, from.y, to.x, to.y].map(f64::to_bits);
        if let Some(known) = self.distances.borrow().get(&key) {
            return *known;
        }
        let found = self.tangents.distance(from, to);
        self.distances.borrow_mut().insert(key, found);
        found
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl Ord for Node {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
