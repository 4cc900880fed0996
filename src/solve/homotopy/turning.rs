//! How much longer than the taut polygon a track is that stays away from its points and turns with a radius.
//!
//! Let a loop cross rays from points c_1 … c_n in this order, at X_j = c_j + t_j g_j with t_j ≥ ρ_j, and let u_j be unit
//! vectors of one's choice. Its length between X_j and X_j+1 is ∫ ds = u_j · (X_j+1 − X_j) + ∫ (1 − cos α) ds, where α is
//! the angle between it and u_j. Where u turns by θ = 2 b at c_j, its heading at X_j is off by angles of b and b at least
//! together, and the curvature 1/R is the most by which it comes nearer to u: with b of R on either side, by integration
//! and as α − sin α is convex, that costs R (θ − 2 sin(θ/2)) at least. So it is no shorter than
//!
//! Σ u_j · (c_j+1 − c_j) + Σ ρ_j g_j · (u_j−1 − u_j) + Σ R_j (θ_j − 2 sin(θ_j/2)),
//!
//! whatever the u are, if g_j · (u_j−1 − u_j) ≥ 0, 0 ≤ θ_j ≤ π, and R_j b_j + R_j+1 b_j+1 is no more than the loop's length
//! between two rays. For ρ = R = 0 and along the polygon that is its length.
//!
//! *Rays.* In the universal cover of the plane without its obstacles the taut line is a geodesic. A ray that leaves a
//! bend on its free side at a right angle or more to both edges, or goes from a point beside an edge across it at a
//! right angle, separates the line's ends; two of them never meet, as angles of a triangle would be too large there. So
//! each loop of the class crosses all of them, in their order, and two neighbours are as far apart as along the edge.
//!
//! *Sections.* Where a loop has a straight of known heading, u is that along it, and what its ends add takes the place of
//! what turning at a ray adds ([`super::held`]). Only rays count that stay away from all places where it may be.

use super::taut::Taut;
use super::{Held, Peg};
use crate::base::trig;
use crate::geometry::{Point, Track};

/// Points beside an edge count up to this distance more than what is kept from them, m.
const NEAR: f64 = 1.0;
/// Steps by which directions are turned, rad, each a quarter of the last, and how often all may be turned by one.
const COARSEST: f64 = 0.1;
const FINEST: f64 = 1e-7;
const ROUNDS: usize = 200;
/// What a point must add, m, to be taken in or left out.
const WORTH: f64 = 1e-4;
/// A turn the wrong way that is rounding, rad.
const LEVEL: f64 = 1e-12;
/// What rounding can have added, as a share of the length.
const ROUNDING: f64 = 1e-12;

/// What the line has at some place. Headings go on along it, without a jump at a half turn.
#[derive(Clone, Copy, Debug)]
struct Stop {
    at: Point,
    kind: Kind,
    /// Heading of the edge behind it, rad.
    heading: f64,
    /// Where it leaves the polygon: edge and m from the edge's begin.
    place: (usize, f64),
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// A point with its ray.
    Ray {
        /// +1 where the point lies to the left of the loop.
        side: f64,
        distance: f64,
        /// Headings to which it may stand at a right angle, towards the free side, rad.
        across: (f64, f64),
    },
    /// The begin (0) or the end (1) of a section.
    Section(usize, usize),
}

impl Stop {
    fn side(&self) -> f64 {
        if let Kind::Ray { side, .. } = self.kind { side } else { 1.0 }
    }

    /// Headings of the rays, if it has any.
    fn rays(&self) -> Option<(f64, f64)> {
        let Kind::Ray { side, across, .. } = self.kind else { return None };
        let [a, b] = [across.0, across.1].map(|heading| heading - 0.5 * side * trig::PI);
        Some((a, b))
    }
}

/// The largest bound over points beside the line and over the directions.
pub fn longest_bound(taut: &Taut, pegs: &[Peg], radius: f64, (track, sections): (&Track, &[Held])) -> f64 {
    let (stops, beside) = stops(taut, pegs, track, sections);
    if stops.len() < 2 {
        return f64::NEG_INFINITY;
    }
    let mut best = Bound::new(stops, taut, radius, sections);
    best.climb(0..best.stops.len());
    for k in 0..best.stops.len() {
        for with in best.narrowed(k) {
            if with.value() > best.value() + WORTH {
                best = with;
            }
        }
    }
    for ray in beside {
        let at = best.stops.partition_point(|r| r.place < ray.place);
        let with = best.with(at, ray);
        if with.value() > best.value() + WORTH {
            best = with;
        }
    }
    for k in (0..best.stops.len()).rev() {
        if best.stops.len() > 3 && best.stops[k].rays().is_some() {
            let without = best.without(k);
            if without.value() > best.value() + WORTH {
                best = without;
            }
        }
    }
    best.value() * (1.0 - ROUNDING) - ROUNDING
}

/// What the line passes at its bends, and rays of the points near an edge.
fn stops(taut: &Taut, pegs: &[Peg], track: &Track, sections: &[Held]) -> (Vec<Stop>, Vec<Stop>) {
    let n = taut.len();
    let (mut bends, mut beside) = (Vec::new(), Vec::new());
    let mut heading = taut.edge(n - 1).heading();
    let mut ends = 0;
    for (k, bend) in taut.bends.iter().enumerate() {
        let before = heading;
        heading += bend.side * taut.turn(k);
        let (edge, next) = (taut.edge(k), taut.bends[(k + 1) % n].point);
        match bend.point {
            Some(point) => {
                let across = (before.min(heading), before.max(heading));
                let kind = Kind::Ray { side: bend.side, distance: pegs[point].distance, across };
                let stop = Stop { at: bend.at, kind, heading, place: (k, 0.0) };
                bends.extend(clear(stop, sections));
            }
            None => {
                let (held, end) = (ends / 2, ends % 2);
                ends += 1;
                let at = sections[held].at(track)[end];
                bends.push(Stop { at, kind: Kind::Section(held, end), heading, place: (k, 0.0) });
                if end == 0 {
                    continue;
                }
            }
        }
        let (length, along) = (edge.norm(), edge * (1.0 / edge.norm()));
        for peg in (0..pegs.len()).filter(|i| Some(*i) != bend.point && Some(*i) != next).map(|i| pegs[i]) {
            let from = peg.at - bend.at;
            let (foot, off) = (along.dot(from), along.cross(from));
            if foot > 0.0 && foot < length && off.abs() < peg.distance + NEAR {
                let kind = Kind::Ray { side: off.signum(), distance: peg.distance, across: (heading, heading) };
                let stop = Stop { at: peg.at, kind, heading, place: (k, foot) };
                beside.extend(clear(stop, sections));
            }
        }
    }
    (bends, beside)
}

/// A stop whose rays stay away from all sections: all of its rays, or those at one end of their headings, or none.
fn clear(stop: Stop, sections: &[Held]) -> Option<Stop> {
    let Kind::Ray { side, distance, across } = stop.kind else { return Some(stop) };
    [across, (across.0, across.0), (across.1, across.1)].into_iter().find_map(|across| {
        let stop = Stop { kind: Kind::Ray { side, distance, across }, ..stop };
        let rays = stop.rays()?;
        sections.iter().all(|held| held.is_clear_of(stop.at, rays)).then_some(stop)
    })
}

/// The bound of some stops, with the direction behind each.
#[derive(Clone)]
struct Bound<'a> {
    taut: &'a Taut,
    sections: &'a [Held],
    /// The smallest radius, m.
    radius: f64,
    /// How far the loop turns in all, rad.
    winding: f64,
    stops: Vec<Stop>,
    /// Of u between a stop and the next, rad.
    directions: Vec<f64>,
    /// From a stop to the next at least, m: along the polygon between rays.
    apart: Vec<f64>,
}

impl<'a> Bound<'a> {
    fn new(stops: Vec<Stop>, taut: &'a Taut, radius: f64, sections: &'a [Held]) -> Self {
        let directions = stops.iter().map(|r| r.heading).collect();
        let winding = (0..taut.len()).map(|k| taut.bends[k].side * taut.turn(k)).sum();
        let mut bound = Bound { taut, sections, radius, winding, stops, directions, apart: Vec::new() };
        bound.measure();
        bound
    }

    fn measure(&mut self) {
        let mut edges = Vec::with_capacity(self.taut.len());
        let mut length = 0.0;
        for k in 0..self.taut.len() {
            edges.push(length);
            length += self.taut.edge(k).norm();
        }
        let n = self.stops.len();
        let at =
            |j: usize| edges[self.stops[j % n].place.0] + self.stops[j % n].place.1 + if j < n { 0.0 } else { length };
        let apart = |j: usize| {
            let (stop, next) = (&self.stops[j], &self.stops[(j + 1) % n]);
            match (stop.kind, stop.rays(), next.kind, next.rays()) {
                (_, Some(_), _, Some(_)) => at(j + 1) - at(j),
                (Kind::Section(held, end), _, _, Some(rays)) => self.sections[held].room(end, next.at, rays),
                (_, Some(rays), Kind::Section(held, end), _) => self.sections[held].room(end, stop.at, rays),
                // On a section, or between two.
                _ => 0.0,
            }
        };
        self.apart = (0..n).map(apart).collect();
    }

    /// With one more ray, before stop `at`.
    fn with(&self, at: usize, ray: Stop) -> Self {
        let mut other = self.clone();
        other.stops.insert(at, ray);
        other.directions.insert(at, self.before(at));
        other.measure();
        let n = other.stops.len();
        other.climb(at + n - 1..at + n + 2);
        other
    }

    /// With rays at one end only of the headings that a stop beside a section has: they may be farther from that.
    fn narrowed(&self, k: usize) -> Vec<Self> {
        let n = self.stops.len();
        let beside = [(k + n - 1) % n, (k + 1) % n].iter().any(|&j| self.stops[j].rays().is_none());
        let Kind::Ray { side, distance, across } = self.stops[k].kind else { return Vec::new() };
        let ends = if beside && across.0 < across.1 { vec![across.0, across.1] } else { Vec::new() };
        let with = |heading: f64| {
            let mut other = self.clone();
            other.stops[k].kind = Kind::Ray { side, distance, across: (heading, heading) };
            other.measure();
            other.climb(k + 2 * n - 2..k + 2 * n + 3);
            other
        };
        ends.into_iter().map(with).collect()
    }

    fn without(&self, k: usize) -> Self {
        let mut other = self.clone();
        let middle = 0.5 * (self.before(k) + self.directions[k]);
        other.stops.remove(k);
        other.directions.remove(k);
        let last = other.stops.len() - 1;
        other.directions[k.checked_sub(1).unwrap_or(last)] = if k == 0 { middle + self.winding } else { middle };
        other.measure();
        let n = other.stops.len();
        other.climb(k + 2 * n - 2..k + 2 * n + 1);
        other
    }

    /// Direction before a stop.
    fn before(&self, j: usize) -> f64 {
        if j == 0 { self.directions[self.stops.len() - 1] - self.winding } else { self.directions[j - 1] }
    }

    /// How far u turns towards the point of a ray, rad.
    fn turn(&self, j: usize) -> f64 {
        self.stops[j].side() * (self.directions[j] - self.before(j))
    }

    /// By how much u is off the heading at a stop, at least, where that costs a radius, rad.
    fn bent(&self, j: usize) -> f64 {
        match self.stops[j].kind {
            Kind::Ray { .. } => 0.5 * self.turn(j).max(0.0),
            Kind::Section(held, end) => self.sections[held].bent(end, self.free(j, end)),
        }
    }

    /// The direction beside an end of a section.
    fn free(&self, j: usize, end: usize) -> f64 {
        if end == 0 { self.before(j) } else { self.directions[j] }
    }

    /// Whether u behind a stop is a section's.
    fn is_known(&self, j: usize) -> bool {
        matches!(self.stops[j].kind, Kind::Section(_, 0))
    }

    /// What u between a stop and the next adds, m.
    fn along(&self, j: usize) -> f64 {
        let next = self.stops[(j + 1) % self.stops.len()].at;
        Point::unit(self.directions[j]).dot(next - self.stops[j].at)
    }

    /// What turning at a stop adds, m; nothing can be said where it turns the wrong way.
    fn bending(&self, j: usize) -> f64 {
        let n = self.stops.len();
        let share = |apart: f64, other: f64| apart / (self.bent(j) + other).max(f64::MIN_POSITIVE);
        let behind = || share(self.apart[(j + n - 1) % n], self.bent((j + n - 1) % n));
        let ahead = || share(self.apart[j], self.bent((j + 1) % n));
        let (side, distance, across) = match self.stops[j].kind {
            Kind::Ray { side, distance, across } => (side, distance, across),
            Kind::Section(held, end) => {
                let radius = self.radius.min(if end == 0 { behind() } else { ahead() });
                let own = self.sections[held].beyond(end, self.free(j, end), radius);
                return own + if end == 0 { self.elsewhere(j, held) } else { 0.0 };
            }
        };
        let turn = side * (self.directions[j] - self.before(j));
        if !(0.0..=trig::PI).contains(&turn) {
            return if turn > -LEVEL && turn < 0.0 { 0.0 } else { f64::NEG_INFINITY };
        }
        let radius = self.radius.min(behind()).min(ahead());
        let middle = 0.5 * (self.directions[j] + self.before(j));
        let off = middle - middle.clamp(across.0, across.1);
        if off.abs() > 0.5 * trig::PI {
            return f64::NEG_INFINITY;
        }
        let chord = 2.0 * trig::sin(0.5 * turn);
        distance * chord * trig::cos(off) + radius * (turn - chord)
    }

    /// What another place of a section takes off, of which this is the begin.
    fn elsewhere(&self, j: usize, held: usize) -> f64 {
        let end = (j + 1) % self.stops.len();
        self.sections[held].elsewhere([self.stops[j].at, self.stops[end].at], self.before(j), self.directions[end])
    }

    fn value(&self) -> f64 {
        (0..self.stops.len()).map(|j| self.along(j) + self.bending(j)).sum()
    }

    /// What hangs on one direction.
    fn near(&self, j: usize) -> f64 {
        let n = self.stops.len();
        let bending = (j + n - 1..j + n + 3).map(|k| self.bending(k % n)).sum::<f64>();
        self.along(j) + bending
    }

    /// Turns one direction after the other, beginning with some, as long as the bound grows; those at the ends of a section
    /// together, too.
    fn climb(&mut self, from: std::ops::Range<usize>) {
        let n = self.stops.len();
        let mut moved = vec![false; n];
        from.for_each(|k| moved[k % n] = true);
        let mut step = COARSEST;
        while step > FINEST {
            let mut waiting = moved.clone();
            for _ in 0..ROUNDS {
                let turns: Vec<usize> = (0..n).filter(|&j| waiting[j]).collect();
                if turns.is_empty() {
                    break;
                }
                waiting.fill(false);
                for j in turns {
                    if self.turned(j, step) {
                        (j + 2 * n - 3..j + 2 * n + 4).for_each(|k| (waiting[k % n], moved[k % n]) = (true, true));
                    }
                }
            }
            step *= 0.25;
        }
    }

    /// Turns a direction by a step if the bound grows by it. That along a section is known: those before and behind it
    /// are turned instead.
    fn turned(&mut self, j: usize, step: f64) -> bool {
        let n = self.stops.len();
        if !self.is_known(j) {
            let (was, now) = (self.directions[j], self.near(j));
            for by in [step, -step] {
                self.directions[j] = was + by;
                if self.near(j) > now {
                    return true;
                }
            }
            self.directions[j] = was;
            return false;
        }
        let ends = [(j + n - 1) % n, (j + 1) % n];
        let (was, now) = (ends.map(|k| self.directions[k]), self.value());
        for (a, b) in [(step, step), (step, -step), (-step, step), (-step, -step)] {
            (self.directions[ends[0]], self.directions[ends[1]]) = (was[0] + a, was[1] + b);
            if self.value() > now {
                return true;
            }
        }
        (self.directions[ends[0]], self.directions[ends[1]]) = (was[0], was[1]);
        false
    }
}
