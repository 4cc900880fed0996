//! From vertices and radii to a centre line of straights and tangent arcs (thesis §3.2).

use serde::{Deserialize, Serialize};

use super::Point;
use crate::base::trig;

/// A vertex' numbers: three design variables of the thesis, P_i(x_i, y_i, R_i).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Corner {
    pub point: Point,
    /// Fillet radius, m.
    pub radius: f64,
}

/// The arc that rounds a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fillet {
    /// Signed turn, rad in (-π, π), left positive.
    pub turn: f64,
    pub radius: f64,
    pub centre: Point,
    /// Distance from the vertex to each tangent point, R tan(|turn|/2), m.
    pub tangent: f64,
    /// Where the arc begins and ends.
    pub begin: Point,
    pub end: Point,
}

impl Fillet {
    /// m
    pub fn length(&self) -> f64 {
        self.radius * self.turn.abs()
    }

    /// Whether the ray from the centre along `direction` meets the arc.
    pub fn faces(&self, direction: Point) -> bool {
        let slack = -1e-12 * (1.0 + direction.x.abs() + direction.y.abs());
        let side = if self.turn < 0.0 { -1.0 } else { 1.0 };
        side * (self.begin - self.centre).cross(direction) >= slack
            && side * direction.cross(self.end - self.centre) >= slack
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PieceKind {
    /// The straight of the section that begins at vertex `from`. Its length may be 0 (or negative in an infeasible
    /// layout, where fillets overlap).
    Straight,
    /// The fillet of vertex `from`.
    Arc { centre: Point, radius: f64, turn: f64 },
}

/// A straight or an arc of the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    pub kind: PieceKind,
    /// Vertex whose section (straight) or fillet (arc) it is.
    pub vertex: usize,
    pub begin: Point,
    pub end: Point,
    /// Heading where it begins, rad.
    pub heading: f64,
    /// Arc length where it begins, measured from vertex 0's outgoing tangent point, m.
    pub s: f64,
    /// m
    pub length: f64,
}

impl Piece {
    /// Position and heading at distance `d` from the piece's begin.
    pub fn at(&self, d: f64) -> (Point, f64) {
        match self.kind {
            PieceKind::Straight => (self.begin + Point::unit(self.heading) * d, self.heading),
            PieceKind::Arc { centre, radius, turn } => {
                let heading = self.heading + turn.signum() * d / radius;
                let outward = Point::unit(heading).left() * -turn.signum();
                (centre + outward * radius, heading)
            }
        }
    }
}

/// The closed centre line of a layout in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    pub corners: Vec<Corner>,
    /// One a vertex.
    pub fillets: Vec<Fillet>,
    /// In driving order: straight of section 0, arc of vertex 1, straight of section 1, ..., arc of vertex 0.
    pub pieces: Vec<Piece>,
    /// m
    pub length: f64,
}

impl Track {
    /// Builds the centre line of at least three corners. Neighbouring points must differ.
    pub fn new(corners: &[Corner]) -> Self {
        let n = corners.len();
        let fillets: Vec<Fillet> =
            (0..n).map(|i| fillet(corners[(i + n - 1) % n].point, corners[i], corners[(i + 1) % n].point)).collect();
        let mut pieces = Vec::with_capacity(2 * n);
        let mut s = 0.0;
        for i in 0..n {
            let j = (i + 1) % n;
            let direction = corners[j].point - corners[i].point;
            let length = direction.norm() - fillets[i].tangent - fillets[j].tangent;
            let heading = direction.heading();
            let (begin, end) = (fillets[i].end, fillets[j].begin);
            pieces.push(Piece { kind: PieceKind::Straight, vertex: i, begin, end, heading, s, length });
            s += length;
            let arc = fillets[j];
            let kind = PieceKind::Arc { centre: arc.centre, radius: arc.radius, turn: arc.turn };
            let (begin, end, length) = (arc.begin, arc.end, arc.length());
            pieces.push(Piece { kind, vertex: j, begin, end, heading, s, length });
            s += length;
        }
        Track { corners: corners.to_vec(), fillets, pieces, length: s }
    }

    /// The straight of the section that begins at vertex `i`.
    pub fn straight(&self, i: usize) -> &Piece {
        &self.pieces[2 * i]
    }

    /// Position and heading at arc length `s` (taken modulo the length).
    pub fn at(&self, s: f64) -> (Point, f64) {
        let s = s.rem_euclid(self.length);
        let i = self.pieces.partition_point(|p| p.s <= s).max(1) - 1;
        self.pieces[i].at(s - self.pieces[i].s)
    }

    /// Floor covered by a band of this width about the centre line, m²: Σ w·l, and for an arc tighter than
    /// half the width the sector of its outer edge.
    pub fn footprint(&self, width: f64) -> f64 {
        let half = width / 2.0;
        self.pieces
            .iter()
            .map(|p| match p.kind {
                PieceKind::Arc { radius, turn, .. } if radius < half => {
                    (radius + half) * (radius + half) * turn.abs() / 2.0
                }
                _ => width * p.length,
            })
            .sum()
    }
}

/// The fillet at `corner` between the lines from `before` and to `after`.
fn fillet(before: Point, corner: Corner, after: Point) -> Fillet {
    let (a, b) = (corner.point - before, after - corner.point);
    let turn = trig::atan2(a.cross(b), a.dot(b));
    let (u, v) = (a * (1.0 / a.norm()), b * (1.0 / b.norm()));
    let radius = corner.radius;
    let tangent = radius * trig::tan(turn.abs() / 2.0);
    let begin = corner.point - u * tangent;
    let side = if turn < 0.0 { -1.0 } else { 1.0 };
    Fillet { turn, radius, centre: begin + u.left() * (side * radius), tangent, begin, end: corner.point + v * tangent }
}
