//! What rows are made of, with exact derivatives: section lengths, turns, tangent lengths and arc centres of a
//! layout at given variables (thesis §3.2). Computed once an evaluation, shared by every row.

use super::expansion::Expansion;
use super::jet::{Jet, Vector};
use crate::geometry::{Corner, Point};

/// Variables of vertex `i`: x, y and radius stand at `3 i`, `3 i + 1`, `3 i + 2`.
pub fn x(i: usize) -> usize {
    3 * i
}

pub fn y(i: usize) -> usize {
    3 * i + 1
}

pub fn radius(i: usize) -> usize {
    3 * i + 2
}

/// Corners to the problem's variables.
pub fn to_variables(corners: &[Corner]) -> Vec<f64> {
    corners.iter().flat_map(|c| [c.point.x, c.point.y, c.radius]).collect()
}

/// The problem's variables to corners.
pub fn to_corners(variables: &[f64]) -> Vec<Corner> {
    variables.chunks_exact(3).map(|v| Corner { point: Point::new(v[0], v[1]), radius: v[2] }).collect()
}

/// Derivatives at one vertex by (x, y) of the vertex before, (x, y, R) of itself, (x, y) of the one after.
#[derive(Clone, Debug)]
pub struct AtVertex {
    pub variables: [usize; 7],
    /// σ·turn, rad: positive while the turn keeps its written direction σ.
    pub turn: Jet<7>,
    /// R tan(σ·turn/2), m.
    pub tangent: Jet<7>,
    pub centre: Vector<7>,
    /// Unit directions of the sections before and after.
    pub incoming: Vector<7>,
    pub outgoing: Vector<7>,
    pub begin: Vector<7>,
    pub end: Vector<7>,
}

/// All vertices and sections of a closed layout.
#[derive(Clone, Debug)]
pub struct Measures {
    pub corners: Vec<Corner>,
    pub vertices: Vec<AtVertex>,
    /// Length of the section from each vertex to the next, by (x, y) of both.
    pub sections: Vec<Jet<4>>,
}

impl Measures {
    /// `signs` are the written turn directions, +1 left and -1 right.
    pub fn new(variables: &[f64], signs: &[f64]) -> Self {
        let corners = to_corners(variables);
        let n = corners.len();
        let vertices = (0..n)
            .map(|i| {
                let (a, b) = ((i + n - 1) % n, (i + 1) % n);
                at_vertex(variables, [x(a), y(a), x(i), y(i), radius(i), x(b), y(b)], signs[i])
            })
            .collect();
        let sections = (0..n)
            .map(|i| {
                let [from, to] = section_ends(variables, i, n);
                (to - from).norm()
            })
            .collect();
        Measures { corners, vertices, sections }
    }

    pub fn len(&self) -> usize {
        self.corners.len()
    }

    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    pub fn next(&self, i: usize) -> usize {
        (i + 1) % self.corners.len()
    }

    pub fn section_variables(&self, i: usize) -> [usize; 4] {
        let j = self.next(i);
        [x(i), y(i), x(j), y(j)]
    }

    /// Length of a section between vertices, m.
    pub fn section(&self, i: usize) -> Expansion {
        Expansion::from_jet(&self.sections[i], &self.section_variables(i))
    }

    pub fn at(&self, i: usize, pick: impl Fn(&AtVertex) -> Jet<7>) -> Expansion {
        Expansion::from_jet(&pick(&self.vertices[i]), &self.vertices[i].variables)
    }

    /// Length of the straight that remains between the tangent points of a section, m.
    pub fn straight(&self, i: usize) -> Expansion {
        let tangent = |v| self.at(v, |m| m.tangent);
        self.section(i).sub(&tangent(i)).sub(&tangent(self.next(i)))
    }

    /// Length of the centre line: Σ sections + Σ R (turn − 2 tan(turn/2)), m.
    pub fn track_length(&self) -> Vec<Expansion> {
        let n = self.len();
        let fillet = |i: usize| {
            self.at(i, |m| {
                let r = Jet::variable(self.corners[i].radius, 4);
                r * m.turn - m.tangent.scale(2.0)
            })
        };
        (0..n).map(|i| self.section(i)).chain((0..n).map(fillet)).collect()
    }

    /// Vertex `i` as jets over its section's four variables, with the next vertex.
    pub fn section_ends(&self, i: usize) -> [Vector<4>; 2] {
        let (a, b) = (self.corners[i].point, self.corners[self.next(i)].point);
        ends([a.x, a.y, b.x, b.y])
    }
}

fn section_ends(v: &[f64], i: usize, n: usize) -> [Vector<4>; 2] {
    let j = (i + 1) % n;
    ends([v[x(i)], v[y(i)], v[x(j)], v[y(j)]])
}

fn ends(v: [f64; 4]) -> [Vector<4>; 2] {
    let variable = |k: usize| Jet::variable(v[k], k);
    [Vector { x: variable(0), y: variable(1) }, Vector { x: variable(2), y: variable(3) }]
}

fn at_vertex(values: &[f64], variables: [usize; 7], sign: f64) -> AtVertex {
    let variable = |k: usize| Jet::<7>::variable(values[variables[k]], k);
    let before = Vector { x: variable(0), y: variable(1) };
    let vertex = Vector { x: variable(2), y: variable(3) };
    let after = Vector { x: variable(5), y: variable(6) };
    let r = variable(4);
    let (a, b) = (vertex - before, after - vertex);
    let (u, v) = (a.times(&a.norm().reciprocal()), b.times(&b.norm().reciprocal()));
    let turn = u.cross(&v).scale(sign).atan2(&u.dot(&v));
    let tangent = r * turn.scale(0.5).tan();
    let begin = vertex - u.times(&tangent);
    AtVertex {
        variables,
        turn,
        tangent,
        centre: begin + u.left().times(&r.scale(sign)),
        incoming: u,
        outgoing: v,
        begin,
        end: vertex + v.times(&tangent),
    }
}
