//! The left and the right side of a track: closed outlines of lines and true arcs (thesis §3.3.1, G_d).
//!
//! A side is the centre line moved by half the width along its normal. Its *inside* is the region that the loop
//! encloses, grown by the half band of the track on an outer side and shrunk by it on an inner side. This is exact for
//! every simple loop and every half width, also where an arc of radius R is tighter than the half width h on the side
//! of its centre, for the following reason.
//!
//! Such an arc has no offset; its place is taken by two spokes, from the end of the straight's offset to the arc's
//! centre and out again to the next offset. The half band of each piece is then a region with a counter-clockwise
//! boundary (a rectangle, a ring's sector or, for a tight arc, a sector), and the boundaries between consecutive half
//! bands cancel. Hence, for a counter-clockwise loop, the winding number of the side about a point is that of the
//! centre line minus (inner side) or plus (outer side) the number of half bands that cover the point. *Winding number
//! at least one* therefore is the rule that gives the region: what the side's overlapping ends enclose beyond it
//! (swallowtails) has a winding number of zero or less on an inner side, of two or more on an outer one. A clockwise
//! loop is the mirror image: winding number at most minus one.

use super::polygon::bounds;
use super::{Piece, PieceKind, Point, Track};
use crate::base::trig;

/// Left or right of the driving direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Hand {
    Left,
    Right,
}

impl Hand {
    /// +1 to the left, -1 to the right.
    pub fn sign(self) -> f64 {
        match self {
            Hand::Left => 1.0,
            Hand::Right => -1.0,
        }
    }

    pub fn opposite(self) -> Hand {
        match self {
            Hand::Left => Hand::Right,
            Hand::Right => Hand::Left,
        }
    }
}

/// A directed line segment or circular arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    Segment {
        begin: Point,
        end: Point,
    },
    Arc {
        begin: Point,
        end: Point,
        centre: Point,
        /// m, > 0
        radius: f64,
        /// Angle of `begin` seen from the centre, rad.
        start: f64,
        /// Angle from begin to end, counter-clockwise positive, rad.
        sweep: f64,
    },
}

impl From<&Piece> for Curve {
    fn from(piece: &Piece) -> Self {
        let (begin, end) = (piece.begin, piece.end);
        match piece.kind {
            PieceKind::Arc { centre, radius, turn } if radius > 0.0 && turn != 0.0 => {
                let start = piece.heading - turn.signum() * trig::FRAC_PI_2;
                Curve::Arc { begin, end, centre, radius, start, sweep: turn }
            }
            _ => Curve::Segment { begin, end },
        }
    }
}

impl Curve {
    pub fn begin(&self) -> Point {
        match *self {
            Curve::Segment { begin, .. } | Curve::Arc { begin, .. } => begin,
        }
    }

    pub fn end(&self) -> Point {
        match *self {
            Curve::Segment { end, .. } | Curve::Arc { end, .. } => end,
        }
    }

    /// m
    pub fn length(&self) -> f64 {
        match *self {
            Curve::Segment { begin, end } => begin.distance(end),
            Curve::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// Distance along the curve, m, of its point whose normal passes through `p` (on an arc: of the nearer of the
    /// two); `None` where that point lies beyond the ends.
    pub fn foot(&self, p: Point) -> Option<f64> {
        match *self {
            Curve::Segment { begin, end } => {
                let (d, length) = (end - begin, begin.distance(end));
                let along = (p - begin).dot(d) / length;
                (0.0..=length).contains(&along).then_some(along)
            }
            Curve::Arc { centre, radius, start, sweep, .. } => {
                let angle = ((p - centre).heading() - start) * sweep.signum();
                let angle = angle.rem_euclid(trig::TAU);
                (angle <= sweep.abs()).then_some(angle * radius)
            }
        }
    }

    /// The point at distance `along` from the begin, m.
    pub fn at(&self, along: f64) -> Point {
        match *self {
            Curve::Segment { begin, end } => {
                let length = begin.distance(end);
                if length > 0.0 { begin.lerp(end, along / length) } else { begin }
            }
            Curve::Arc { centre, radius, start, sweep, .. } => {
                centre + Point::unit(start + sweep.signum() * along / radius) * radius
            }
        }
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> (Point, Point) {
        let ends = [self.begin(), self.end()].into_iter();
        match *self {
            Curve::Segment { .. } => bounds(ends),
            Curve::Arc { centre, radius, start, sweep, .. } => {
                let extremes = quarters(start, sweep).map(|q| centre + quarter_point(q) * radius);
                bounds(ends.chain(extremes))
            }
        }
    }
}

/// The multiples of a right angle strictly within an arc, in its direction.
fn quarters(start: f64, sweep: f64) -> impl Iterator<Item = i64> {
    let quarter = |angle: f64| angle / trig::FRAC_PI_2;
    let step = if sweep < 0.0 { -1 } else { 1 };
    let (from, to) = (quarter(start) * step as f64, quarter(start + sweep) * step as f64);
    // Headings are within a turn or two of zero; the bound keeps a nonsensical arc from a long count.
    let first = (from.floor() as i64).saturating_add(1);
    (first..first.saturating_add(8)).take_while(move |&q| (q as f64) < to).map(move |q| q * step)
}

/// The unit vector at `q` right angles, exactly.
fn quarter_point(q: i64) -> Point {
    match q.rem_euclid(4) {
        0 => Point::new(1.0, 0.0),
        1 => Point::new(0.0, 1.0),
        2 => Point::new(-1.0, 0.0),
        _ => Point::new(0.0, -1.0),
    }
}

/// One side of a track as a closed curve; see the module for what its inside is.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// In driving order; each begins where the one before ends.
    pub pieces: Vec<Curve>,
    /// +1 for a loop driven counter-clockwise, -1 clockwise.
    orientation: i32,
    strands: Vec<Strand>,
}

impl Outline {
    /// The side of `track` at `half_width` ≥ 0, m, to the `hand` of its centre line.
    ///
    /// Its inside is exact when the centre line is simple. About an infeasible centre line (fillets that overlap, a
    /// loop that crosses itself) it still is a closed curve, and the winding number's rule still says what is inside.
    pub fn side(track: &Track, half_width: f64, hand: Hand) -> Outline {
        let offset = hand.sign() * half_width;
        // One point a joint, so that pieces meet bit by bit and winding numbers have no gaps.
        let joints: Vec<Point> =
            track.pieces.iter().map(|p| p.begin + Point::unit(p.heading).left() * offset).collect();
        let mut pieces = Vec::with_capacity(joints.len());
        let mut push = |curve: Curve| {
            if curve.begin() != curve.end() {
                pieces.push(curve);
            }
        };
        for (i, piece) in track.pieces.iter().enumerate() {
            let (begin, end) = (joints[i], joints[(i + 1) % joints.len()]);
            match piece.kind {
                PieceKind::Arc { centre, radius, turn } if turn != 0.0 => {
                    let start = piece.heading - turn.signum() * trig::FRAC_PI_2;
                    let radius = radius - offset * turn.signum();
                    if radius > 0.0 {
                        push(Curve::Arc { begin, end, centre, radius, start, sweep: turn });
                    } else {
                        push(Curve::Segment { begin, end: centre });
                        push(Curve::Segment { begin: centre, end });
                    }
                }
                _ => push(Curve::Segment { begin, end }),
            }
        }
        let turn: f64 = track.fillets.iter().map(|f| f.turn).sum();
        let strands = pieces.iter().flat_map(strands).collect();
        Outline { pieces, orientation: if turn < 0.0 { -1 } else { 1 }, strands }
    }

    /// +1 for a loop driven counter-clockwise, -1 clockwise (the sign of its total turn).
    pub fn orientation(&self) -> i32 {
        self.orientation
    }

    /// How often the outline runs counter-clockwise around the point (arcs are exact; undecided on the outline).
    pub fn winding(&self, p: Point) -> i32 {
        self.strands.iter().filter(|s| s.x0 <= p.x && p.x < s.x1 && s.y(p.x) < p.y).map(|s| s.winding).sum()
    }

    /// Whether the point lies inside (undecided on the outline).
    pub fn contains(&self, p: Point) -> bool {
        self.encloses(self.winding(p))
    }

    /// The inside's rule: whether a point with this winding number lies inside.
    pub(super) fn encloses(&self, winding: i32) -> bool {
        winding * self.orientation >= 1
    }

    pub(super) fn strands(&self) -> &[Strand] {
        &self.strands
    }
}

/// A part of a curve over which x only grows (or only shrinks): y is a function of x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strand {
    /// x0 ≤ x1, alike only where a segment is vertical.
    pub x0: f64,
    pub x1: f64,
    pub shape: StrandShape,
    /// What the winding number gains when this strand is crossed upwards: +1 when it is driven towards +x.
    pub winding: i32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StrandShape {
    /// The heights at x0 and x1.
    Line { y0: f64, y1: f64 },
    /// The half of a circle above or below its centre.
    Arc { centre: Point, radius: f64, upper: bool },
}

impl Strand {
    /// A segment's strand; that of a vertical one only marks its x.
    pub fn line(begin: Point, end: Point) -> Strand {
        let (a, b, winding) = if begin.x < end.x { (begin, end, 1) } else { (end, begin, -1) };
        Strand { x0: a.x, x1: b.x, shape: StrandShape::Line { y0: a.y, y1: b.y }, winding }
    }

    /// Height at `x`, which is clamped to the strand.
    pub fn y(&self, x: f64) -> f64 {
        match self.shape {
            StrandShape::Line { y0, y1 } => {
                let t = ((x - self.x0) / (self.x1 - self.x0)).clamp(0.0, 1.0);
                y0 + (y1 - y0) * t
            }
            StrandShape::Arc { centre, radius, upper } => centre.y + rise(x - centre.x, radius, upper),
        }
    }

    /// Smallest and largest height.
    pub fn y_range(&self) -> (f64, f64) {
        match self.shape {
            StrandShape::Line { y0, y1 } => (y0.min(y1), y0.max(y1)),
            StrandShape::Arc { centre, .. } => {
                let heights = [self.x0, centre.x.clamp(self.x0, self.x1), self.x1].map(|x| self.y(x));
                (
                    heights.into_iter().fold(f64::INFINITY, f64::min),
                    heights.into_iter().fold(f64::NEG_INFINITY, f64::max),
                )
            }
        }
    }

    /// ∫ (y - base) dx from `a` to `b`, m²: the trapezoid below the chord, and an arc's circular segment on top.
    pub fn area_above(&self, base: f64, a: f64, b: f64) -> f64 {
        match self.shape {
            StrandShape::Line { .. } => (b - a) * ((self.y(a) - base) + (self.y(b) - base)) / 2.0,
            StrandShape::Arc { centre, radius, upper } => {
                // Both ends are put on the circle, so that rounding where it is steep moves an end along the
                // circle and not off it.
                let [p, q] = [a, b].map(|x| {
                    let u = (x - centre.x).clamp(-radius, radius);
                    Point::new(u, rise(u, radius, upper))
                });
                let trapezoid = (q.x - p.x) * ((p.y + q.y) / 2.0 + (centre.y - base));
                let sine = p.cross(q).abs();
                let segment = (radius * radius * trig::atan2(sine, p.dot(q)) - sine) / 2.0;
                if upper { trapezoid + segment } else { trapezoid - segment }
            }
        }
    }
}

/// Height of a half circle over its centre at `u` from it.
fn rise(u: f64, radius: f64, upper: bool) -> f64 {
    let rise = ((radius - u) * (radius + u)).max(0.0).sqrt();
    if upper { rise } else { -rise }
}

/// Cuts a curve where its tangent is vertical.
fn strands(curve: &Curve) -> Vec<Strand> {
    match *curve {
        Curve::Segment { begin, end } => vec![Strand::line(begin, end)],
        Curve::Arc { begin, end, centre, radius, start, sweep } => {
            let mut cuts = vec![(begin.x, start)];
            for q in quarters(start, sweep).filter(|q| q % 2 == 0) {
                cuts.push((centre.x + quarter_point(q).x * radius, q as f64 * trig::FRAC_PI_2));
            }
            cuts.push((end.x, start + sweep));
            let strand = |pair: &[(f64, f64)]| {
                let &[(from, begin), (to, end)] = pair else { return None };
                let upper = trig::sin((begin + end) / 2.0) > 0.0;
                let (x0, x1, winding) = if from < to { (from, to, 1) } else { (to, from, -1) };
                (x0 < x1).then_some(Strand { x0, x1, shape: StrandShape::Arc { centre, radius, upper }, winding })
            };
            cuts.windows(2).filter_map(strand).collect()
        }
    }
}
