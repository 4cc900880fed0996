//! Sections of known heading: each loop has their straights, and a way to and from them.
//!
//! *At a vertex* V whose place is known, too, the track turns by τ with a radius R from the section's heading, goes on
//! along v for s at least, and comes to P = V + (t + s) v, where t = R tan(τ/2). So what it has beyond the section up to
//! V and beyond u · (P − V) is R τ − t + s − (t + s) u · v, the least over all turns and radii that it may have.
//!
//! *On a straight* that may lie within a rectangle, from X to X′, its heading h is β off u. With a curvature of 1/R at
//! most that costs R (β − sin β) more than the way along u (as [`super::turning`] has it for either side of a bend), and
//! what u and h weigh X and X′ with has its least value at a corner of what is possible.

use crate::base::trig;
use crate::geometry::{Point, Track, distance_to_segment, segments_meet};

/// Ends of rays that go on, m: beyond any hall.
const FAR: f64 = 1e5;
/// What rounding may put a corner of a range beyond it, m.
const FITS: f64 = 1e-9;
/// A range of headings that is one heading, rad.
const NARROW: f64 = 1e-9;

/// A section of known heading.
#[derive(Clone, Debug)]
pub struct Held {
    pub section: usize,
    /// rad
    pub heading: f64,
    pub place: Place,
}

/// Where a section is.
#[derive(Clone, Debug)]
pub enum Place {
    /// Between these vertices.
    Known([End; 2]),
    Within(Range),
}

/// What a track does beyond a vertex whose place is known.
#[derive(Clone, Debug)]
pub struct End {
    pub vertex: Point,
    /// +1 where it turns left.
    pub sign: f64,
    pub turns: Vec<Turn>,
}

/// Where a straight may begin and end, m: along its heading, and across to its left.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    pub begin: (f64, f64),
    pub end: (f64, f64),
    pub across: (f64, f64),
    /// The least length of the straight.
    pub shortest: f64,
}

/// A curve at a vertex and how far the track is straight behind it at least.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// R τ − t + s, m
    ahead: f64,
    /// t, m
    tangent: f64,
    /// t + s, m
    reach: f64,
    /// Unit vector at the angle τ.
    to: Point,
}

impl Range {
    /// Where it begins and ends at the corners of what is possible; none where nothing is.
    pub fn corners(&self) -> impl Iterator<Item = (f64, f64)> {
        let ((a, b), (c, d), l) = (self.begin, self.end, self.shortest);
        let all = [(a, c), (a, d), (b, c), (b, d), (a, a + l), (b, b + l), (c - l, c), (d - l, d)];
        all.into_iter().filter(move |(x, y)| {
            let within = |value: f64, low: f64, high: f64| low - FITS <= value && value <= high + FITS;
            within(*x, a, b) && within(*y, c, d) && y - x >= l - FITS
        })
    }
}

impl Turn {
    /// Of a radius, m, by an angle, rad, before a straight of at least so much, m.
    pub fn new(radius: f64, angle: f64, straight: f64) -> Self {
        let tangent = radius * trig::tan(0.5 * angle);
        let ahead = radius * angle - tangent + straight;
        Turn { ahead, tangent, reach: tangent + straight, to: Point::unit(angle) }
    }

    /// Its direction behind the curve, seen away from the section along `out`; the sign is that of the turn, seen so.
    fn along(&self, out: Point, sign: f64) -> Point {
        out * self.to.x + out.left() * (sign * self.to.y)
    }
}

impl End {
    /// What the way up to P has beyond that along a direction, which is so far (rad) to the side the track turns to.
    fn beyond(&self, turned: f64) -> f64 {
        let along = Point::unit(turned);
        self.turns.iter().map(|turn| turn.ahead - turn.reach * turn.to.dot(along)).fold(f64::INFINITY, f64::min)
    }
}

impl Held {
    /// What stands for its ends: its vertices, or the ends of the straight of a track.
    pub fn at(&self, track: &Track) -> [Point; 2] {
        match &self.place {
            Place::Known(ends) => [ends[0].vertex, ends[1].vertex],
            Place::Within(_) => [track.straight(self.section).begin, track.straight(self.section).end],
        }
    }

    /// What its begin (0) or end (1) adds where u beside it is `direction`, and u on it is its heading, m: without what
    /// the radius `of_straight` on a straight costs.
    pub fn beyond(&self, end: usize, direction: f64, of_straight: f64) -> f64 {
        let off = self.off(end, direction);
        match &self.place {
            Place::Known(ends) => ends[end].beyond(ends[end].sign * off),
            Place::Within(_) => of_straight * (off.abs() - trig::sin(off.abs())),
        }
    }

    /// How far the track turns to the left between u beside an end and the section, in driving order, rad.
    fn off(&self, end: usize, direction: f64) -> f64 {
        trig::wrap(if end == 0 { self.heading - direction } else { direction - self.heading })
    }

    /// By how much u is off at an end where that costs a radius, rad.
    pub fn bent(&self, end: usize, direction: f64) -> f64 {
        match self.place {
            Place::Known(_) => 0.0,
            Place::Within(_) => self.off(end, direction).abs(),
        }
    }

    /// What another place than from `at[0]` to `at[1]` takes off at most, where u is `before` and `after` beside it, m.
    pub fn elsewhere(&self, at: [Point; 2], before: f64, after: f64) -> f64 {
        let Place::Within(range) = self.place else { return 0.0 };
        let (h, n) = (Point::unit(self.heading), Point::unit(self.heading).left());
        let [a, b] = [before, after].map(Point::unit);
        let (begin, end, across) = ((a - h).dot(h), (h - b).dot(h), (a - b).dot(n));
        let along = |(x, y): (f64, f64)| begin * (x - h.dot(at[0])) + end * (y - h.dot(at[1]));
        let beside = [range.across.0, range.across.1].map(|c| across * (c - n.dot(at[0])));
        let least = range.corners().map(along).fold(f64::INFINITY, f64::min);
        least + beside.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Whether a point is among those where its straight may lie: the class of a loop would then hang on where that is.
    pub fn may_hold(&self, point: Point) -> bool {
        let Place::Within(range) = self.place else { return false };
        let h = Point::unit(self.heading);
        let inside = |value: f64, (low, high): (f64, f64)| low <= value && value <= high;
        inside(h.dot(point), (range.begin.0, range.end.1)) && inside(h.left().dot(point), range.across)
    }

    /// Convex polygons that have the straight in them and the way up to each P, wherever they are.
    fn hulls(&self) -> Vec<Vec<Point>> {
        let (h, n) = (Point::unit(self.heading), Point::unit(self.heading).left());
        match &self.place {
            Place::Within(range) => {
                let corner = |along: f64, across: f64| h * along + n * across;
                let ((a, b), (c, d)) = ((range.begin.0, range.end.1), range.across);
                vec![vec![corner(a, c), corner(b, c), corner(b, d), corner(a, d)]]
            }
            Place::Known(ends) => {
                let mut hulls = vec![vec![ends[0].vertex, ends[1].vertex]];
                for (end, to) in ends.iter().zip([-1.0, 1.0]) {
                    let out = h * to;
                    hulls.extend(end.turns.iter().map(|turn| {
                        let to = turn.along(out, end.sign * to);
                        vec![end.vertex - out * turn.tangent, end.vertex, end.vertex + to * turn.reach]
                    }));
                }
                hulls
            }
        }
    }

    /// Whether no ray from a point towards any of some headings comes to the section or its ways.
    pub fn is_clear_of(&self, from: Point, headings: (f64, f64)) -> bool {
        let ends = [headings.0, headings.1].map(Point::unit);
        let single = headings.1 - headings.0 < NARROW;
        let inside = |p: &Point| !single && ends[0].cross(*p - from) >= 0.0 && ends[1].cross(*p - from) <= 0.0;
        self.hulls().iter().all(|hull| {
            let edges = || hull.iter().zip(hull.iter().cycle().skip(1));
            let crossed = |end: &Point| edges().any(|(a, b)| segments_meet(from, from + *end * FAR, *a, *b));
            !hull.iter().any(inside) && !ends.iter().any(crossed)
        })
    }

    /// The least distance from where its begin (0) or end (1) leaves it to rays from a point, m.
    pub fn room(&self, end: usize, from: Point, headings: (f64, f64)) -> f64 {
        let rays = [headings.0, headings.1].map(|heading| from + Point::unit(heading) * FAR);
        let to_rays =
            |p: &Point| rays.iter().map(|far| distance_to_segment(*p, from, *far)).fold(f64::INFINITY, f64::min);
        match &self.place {
            Place::Known(ends) => {
                let (h, to) = (Point::unit(self.heading), if end == 0 { -1.0 } else { 1.0 });
                let own = &ends[end];
                let last = |turn: &Turn| own.vertex + turn.along(h * to, own.sign * to) * turn.reach;
                own.turns.iter().map(|turn| to_rays(&last(turn))).fold(f64::INFINITY, f64::min)
            }
            Place::Within(_) => {
                let hulls = self.hulls();
                let edges = hulls.iter().flat_map(|hull| hull.iter().zip(hull.iter().cycle().skip(1)));
                let apart = edges.map(|(a, b)| to_rays(a).min(distance_to_segment(from, *a, *b)));
                apart.fold(f64::INFINITY, f64::min)
            }
        }
    }
}
