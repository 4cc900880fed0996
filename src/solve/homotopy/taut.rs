//! The shortest closed line of a class: pulled tight around points, and through those that it has to pass.

use crate::base::trig;
use crate::geometry::Point;

/// Most points that are taken off a line.
const MOST: usize = 100_000;
/// How far a line beside its points is from them, m: far less than these are apart.
const BESIDE: f64 = 1e-9;

/// Where a taut line bends: around a point that lies to the left (+1) or right (-1), or, to either side, where it has to
/// pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    pub at: Point,
    /// The point's index; none where the line has to pass.
    pub point: Option<usize>,
    /// +1 where the line has to pass.
    pub side: f64,
}

/// A closed polygon that turns around each of its points towards the side where the point lies.
#[derive(Clone, Debug)]
pub struct Taut {
    pub bends: Vec<Bend>,
}

impl Taut {
    pub fn len(&self) -> usize {
        self.bends.len()
    }

    /// The edge from a bend to the next.
    pub fn edge(&self, from: usize) -> Point {
        self.bends[(from + 1) % self.len()].at - self.bends[from % self.len()].at
    }

    /// How far it turns towards the point of a bend, or to the left where it has to pass, rad.
    pub fn turn(&self, bend: usize) -> f64 {
        let (into, out) = (self.edge(bend + self.len() - 1), self.edge(bend));
        self.bends[bend].side * trig::atan2(into.cross(out), into.dot(out))
    }

    /// Away from the point of a bend, by which the line passes: a unit vector that halves the angle between its edges.
    pub fn outward(&self, bend: usize) -> Point {
        let middle = self.edge(bend).heading() - 0.5 * self.bends[bend].side * self.turn(bend);
        Point::unit(middle).left() * -self.bends[bend].side
    }

    /// The line a little beside its points.
    pub fn beside(&self) -> Vec<Point> {
        let at = |k: usize| match self.bends[k].point {
            Some(_) => self.bends[k].at + self.outward(k) * BESIDE,
            None => self.bends[k].at,
        };
        (0..self.len()).map(at).collect()
    }

    /// Bends where it has to pass.
    pub fn kept(&self) -> Vec<usize> {
        (0..self.len()).filter(|&k| self.bends[k].point.is_none()).collect()
    }
}

/// What a line is pulled over: of its own points, or one that it goes around.
#[derive(Clone, Copy)]
struct Knot {
    at: Point,
    around: Option<(usize, f64)>,
    kept: bool,
}

/// Pulls a closed line tight, which keeps some of its own points (`kept`, ascending): a knot between two others goes,
/// and what lies in the triangle of the three holds the line instead. None where nothing holds it.
pub fn pulled(line: &[Point], kept: &[usize], points: &[Point]) -> Option<Taut> {
    let knot = |(i, &at): (usize, &Point)| Knot { at, around: None, kept: kept.binary_search(&i).is_ok() };
    let mut knots: Vec<Knot> = line.iter().enumerate().map(knot).collect();
    let (mut i, mut kept) = (0, 0);
    for _ in 0..MOST {
        let n = knots.len();
        if n < 3 {
            return None;
        }
        if kept >= n {
            let bend = |knot: &Knot| {
                let (point, side) = knot.around.map_or((None, 1.0), |(point, side)| (Some(point), side));
                Bend { at: knot.at, point, side }
            };
            return Some(Taut { bends: knots.iter().map(bend).collect() });
        }
        i %= n;
        let (before, knot, after) = (knots[(i + n - 1) % n], knots[i], knots[(i + 1) % n]);
        let turn = (knot.at - before.at).cross(after.at - knot.at);
        if knot.kept || knot.around.is_some_and(|(_, side)| side * turn >= 0.0) {
            (i, kept) = (i + 1, kept + 1);
            continue;
        }
        let held = chain([before, knot, after], turn.signum(), points);
        let count = held.len();
        knots.splice(i..=i, held);
        // The one before has another neighbour now.
        (i, kept) = ((i + knots.len() - 1) % knots.len().max(1), 0);
        // Twice around the same point is once.
        let alike = |a: &Knot, b: &Knot| a.around.is_some() && a.around == b.around;
        if count == 0 && knots.len() > 2 {
            let next = (i + 1) % knots.len();
            if alike(&knots[i], &knots[next]) {
                knots.remove(next);
                i = i.min(knots.len() - 1);
            }
        }
    }
    None
}

/// The points within a triangle that a line from its first to its last corner bends around, with the middle one gone.
fn chain([a, middle, b]: [Knot; 3], side: f64, points: &[Point]) -> Vec<Knot> {
    let own: Vec<usize> = [a, middle, b].iter().filter_map(|k| k.around.map(|(point, _)| point)).collect();
    let within = |p: Point| {
        let edges = [(a.at, middle.at), (middle.at, b.at), (b.at, a.at)];
        edges.iter().all(|(from, to)| side * (*to - *from).cross(p - *from) >= 0.0)
    };
    let inside = |k: &usize| !own.contains(k) && side != 0.0 && within(points[*k]);
    let found: Vec<usize> = (0..points.len()).filter(inside).collect();
    let knot = |k: usize| Knot { at: points[k], around: Some((k, side)), kept: false };
    let mut hull: Vec<Knot> = Vec::new();
    let mut at = a.at;
    // Jarvis' march: the next one has all others on the side of the points.
    loop {
        let left = found.iter().filter(|&&k| !hull.iter().any(|h| h.around.is_some_and(|(point, _)| point == k)));
        let next =
            left.fold(b, |best, &k| if side * (best.at - at).cross(points[k] - at) < 0.0 { knot(k) } else { best });
        if next.around == b.around && next.at == b.at {
            return hull;
        }
        at = next.at;
        hull.push(next);
    }
}
