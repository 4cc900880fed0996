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

use super::Peg;
use super::taut::Taut;
use crate::base::trig;
use crate::geometry::Point;

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

/// A point with its ray. Headings go on along the line, without a jump at a half turn.
#[derive(Clone, Copy, Debug)]
struct Ray {
    at: Point,
    /// +1 where the point lies to the left of the loop.
    side: f64,
    distance: f64,
    /// Headings to which it may stand at a right angle, towards the free side, rad.
    across: (f64, f64),
    /// Heading of the edge behind it, rad.
    heading: f64,
    /// Where it leaves the polygon: edge and m from the edge's begin.
    place: (usize, f64),
}

/// The largest bound over points beside the line and over the directions.
pub fn longest_bound(taut: &Taut, pegs: &[Peg], radius: f64) -> f64 {
    let (bends, beside) = rays(taut, pegs);
    let mut best = Bound::new(bends, taut, radius);
    best.climb(0..best.rays.len());
    for ray in beside {
        let at = best.rays.partition_point(|r| r.place < ray.place);
        let with = best.with(at, ray);
        if with.value() > best.value() + WORTH {
            best = with;
        }
    }
    for k in (0..best.rays.len()).rev() {
        if best.rays.len() > 3 {
            let without = best.without(k);
            if without.value() > best.value() + WORTH {
                best = without;
            }
        }
    }
    best.value() * (1.0 - ROUNDING) - ROUNDING
}

/// Rays of the bends, and of the points near an edge.
fn rays(taut: &Taut, pegs: &[Peg]) -> (Vec<Ray>, Vec<Ray>) {
    let n = taut.len();
    let (mut bends, mut beside) = (Vec::new(), Vec::new());
    let mut heading = taut.edge(n - 1).heading();
    for (k, bend) in taut.bends.iter().enumerate() {
        let before = heading;
        heading += bend.side * taut.turn(k);
        let across = (before.min(heading), before.max(heading));
        let distance = pegs[bend.point].distance;
        bends.push(Ray { at: bend.at, side: bend.side, distance, across, heading, place: (k, 0.0) });
        let (edge, next) = (taut.edge(k), taut.bends[(k + 1) % n].point);
        let (length, along) = (edge.norm(), edge * (1.0 / edge.norm()));
        for peg in (0..pegs.len()).filter(|i| *i != bend.point && *i != next).map(|i| pegs[i]) {
            let from = peg.at - bend.at;
            let (foot, off) = (along.dot(from), along.cross(from));
            if foot > 0.0 && foot < length && off.abs() < peg.distance + NEAR {
                let (at, side, distance) = (peg.at, off.signum(), peg.distance);
                beside.push(Ray { at, side, distance, across: (heading, heading), heading, place: (k, foot) });
            }
        }
    }
    (bends, beside)
}

/// The bound of some rays, with the direction behind each.
#[derive(Clone)]
struct Bound<'a> {
    taut: &'a Taut,
    /// The smallest radius, m.
    radius: f64,
    /// How far the loop turns in all, rad.
    winding: f64,
    rays: Vec<Ray>,
    /// Of u between a ray and the next, rad.
    directions: Vec<f64>,
    /// Along the polygon from a ray to the next, m.
    apart: Vec<f64>,
}

impl<'a> Bound<'a> {
    fn new(rays: Vec<Ray>, taut: &'a Taut, radius: f64) -> Self {
        let directions = rays.iter().map(|r| r.heading).collect();
        let winding = (0..taut.len()).map(|k| taut.bends[k].side * taut.turn(k)).sum();
        let mut bound = Bound { taut, radius, winding, rays, directions, apart: Vec::new() };
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
        let n = self.rays.len();
        let at =
            |j: usize| edges[self.rays[j % n].place.0] + self.rays[j % n].place.1 + if j < n { 0.0 } else { length };
        self.apart = (0..n).map(|j| at(j + 1) - at(j)).collect();
    }

    /// With one more ray, behind ray `at` - 1: the first is a bend's.
    fn with(&self, at: usize, ray: Ray) -> Self {
        let mut other = self.clone();
        other.rays.insert(at, ray);
        other.directions.insert(at, self.directions[at - 1]);
        other.measure();
        let n = other.rays.len();
        other.climb(at + n - 1..at + n + 2);
        other
    }

    fn without(&self, k: usize) -> Self {
        let mut other = self.clone();
        let middle = 0.5 * (self.before(k) + self.directions[k]);
        other.rays.remove(k);
        other.directions.remove(k);
        let last = other.rays.len() - 1;
        other.directions[k.checked_sub(1).unwrap_or(last)] = if k == 0 { middle + self.winding } else { middle };
        other.measure();
        let n = other.rays.len();
        other.climb(k + n - 2..k + n + 1);
        other
    }

    /// Direction before a ray.
    fn before(&self, j: usize) -> f64 {
        if j == 0 { self.directions[self.rays.len() - 1] - self.winding } else { self.directions[j - 1] }
    }

    /// How far u turns towards the point of a ray, rad.
    fn turn(&self, j: usize) -> f64 {
        self.rays[j].side * (self.directions[j] - self.before(j))
    }

    /// What u between a ray and the next adds, m.
    fn along(&self, j: usize) -> f64 {
        let next = self.rays[(j + 1) % self.rays.len()].at;
        Point::unit(self.directions[j]).dot(next - self.rays[j].at)
    }

    /// What turning at a ray adds, m; nothing can be said where it turns the wrong way.
    fn bending(&self, j: usize) -> f64 {
        let (n, ray, turn) = (self.rays.len(), &self.rays[j], self.turn(j));
        if !(0.0..=trig::PI).contains(&turn) {
            return if turn > -LEVEL && turn < 0.0 { 0.0 } else { f64::NEG_INFINITY };
        }
        let [behind, ahead] = [(j + n - 1) % n, (j + 1) % n].map(|k| self.turn(k).max(0.0));
        let share = |apart: f64, other: f64| 2.0 * apart / (turn + other).max(f64::MIN_POSITIVE);
        let radius = self.radius.min(share(self.apart[(j + n - 1) % n], behind)).min(share(self.apart[j], ahead));
        let middle = 0.5 * (self.directions[j] + self.before(j));
        let off = middle - middle.clamp(ray.across.0, ray.across.1);
        if off.abs() > 0.5 * trig::PI {
            return f64::NEG_INFINITY;
        }
        let chord = 2.0 * trig::sin(0.5 * turn);
        ray.distance * chord * trig::cos(off) + radius * (turn - chord)
    }

    fn value(&self) -> f64 {
        (0..self.rays.len()).map(|j| self.along(j) + self.bending(j)).sum()
    }

    /// What hangs on one direction.
    fn near(&self, j: usize) -> f64 {
        let n = self.rays.len();
        let bending = (j + n - 1..j + n + 3).map(|k| self.bending(k % n)).sum::<f64>();
        self.along(j) + bending
    }

    /// Turns one direction after the other, beginning with some, as long as the bound grows.
    fn climb(&mut self, from: std::ops::Range<usize>) {
        let n = self.rays.len();
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
                    let (was, now) = (self.directions[j], self.near(j));
                    for by in [step, -step] {
                        self.directions[j] = was + by;
                        if self.near(j) > now {
                            (j + n - 2..j + n + 3).for_each(|k| (waiting[k % n], moved[k % n]) = (true, true));
                            break;
                        }
                        self.directions[j] = was;
                    }
                }
            }
            step *= 0.25;
        }
    }
}
