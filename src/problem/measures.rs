//! What rows are made of, with exact derivatives: section lengths, turns, tangent lengths and arc centres of a
//! layout at given variables (thesis §3.2). Computed once an evaluation, shared by every row.

use super::expansion::Expansion;
use super::jet::{Jet, Vector};
use crate::base::trig;
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

/// A lifted section's heading is a variable times this, m: a step of it moves the end of a section of that length as far.
const LEVER: f64 = 20.0;

/// Where the heading and the length of section `i` of `n` stand among lifted variables.
pub fn lifted(n: usize, i: usize) -> [usize; 2] {
    [3 * n + 2 * i, 3 * n + 2 * i + 1]
}

/// Variables with the headings (times [`LEVER`]) and lengths of all sections after them, as the corners have them.
pub fn lift(variables: &[f64]) -> Vec<f64> {
    let corners = to_corners(variables);
    let n = corners.len();
    let mut out = variables.to_vec();
    for i in 0..n {
        let along = corners[(i + 1) % n].point - corners[i].point;
        out.extend([LEVER * trig::atan2(along.y, along.x), along.norm()]);
    }
    out
}

/// Turns by lifted variables, in their written directions, rad.
pub fn turns(variables: &[f64], signs: &[f64]) -> Vec<f64> {
    let n = signs.len();
    let heading = |i: usize| variables[lifted(n, i)[0]] / LEVER;
    (0..n).map(|i| trig::wrap(signs[i] * (heading(i) - heading((i + n - 1) % n)))).collect()
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

/// All vertices and sections of a closed layout. Where it is lifted, a section's heading and length are variables of
/// their own, and stand where the coordinates of its other end do elsewhere.
#[derive(Clone, Debug)]
pub struct Measures {
    pub corners: Vec<Corner>,
    pub vertices: Vec<AtVertex>,
    /// Length of the section from each vertex to the next, by (x, y) of both.
    pub sections: Vec<Jet<4>>,
    /// Headings of sections as variables, times [`LEVER`], where the problem is lifted.
    headings: Option<Vec<f64>>,
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
        Measures { corners, vertices, sections, headings: None }
    }

    /// Of lifted variables ([`lift`]).
    pub fn lifted(variables: &[f64], signs: &[f64]) -> Self {
        let n = signs.len();
        let vertices = (0..n).map(|i| {
            let ([before, _], [after, _]) = (lifted(n, (i + n - 1) % n), lifted(n, i));
            // The lengths of both sections have no part in it.
            lifted_vertex(variables, [before, before + 1, x(i), y(i), radius(i), after, after + 1], signs[i])
        });
        let sections = (0..n).map(|i| Jet::variable(variables[lifted(n, i)[1]], 3));
        Measures {
            corners: to_corners(&variables[..3 * n]),
            vertices: vertices.collect(),
            sections: sections.collect(),
            headings: Some((0..n).map(|i| variables[lifted(n, i)[0]]).collect()),
        }
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
        if self.headings.is_some() {
            let [heading, length] = lifted(self.len(), i);
            return [x(i), y(i), heading, length];
        }
        let j = self.next(i);
        [x(i), y(i), x(j), y(j)]
    }

    /// By how much lifted sections end beside the next vertex, m, x and y of each; none where nothing is lifted.
    pub fn gaps(&self) -> Vec<Expansion> {
        let Some(_) = &self.headings else { return Vec::new() };
        let n = self.len();
        let gap = |i: usize| {
            let end = self.section_ends(i)[1];
            let next = self.corners[self.next(i)].point;
            let variables = self.section_variables(i);
            [(end.x, next.x, x(self.next(i))), (end.y, next.y, y(self.next(i)))]
                .map(|(end, at, k)| Expansion::variable(at, k).sub(&Expansion::from_jet(&end, &variables)))
        };
        (0..n).flat_map(gap).collect()
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
        let Some(headings) = &self.headings else { return ends([a.x, a.y, b.x, b.y]) };
        let from = Vector { x: Jet::variable(a.x, 0), y: Jet::variable(a.y, 1) };
        let unit = Jet::variable(headings[i], 2).scale(1.0 / LEVER).unit();
        [from, from + unit.times(&self.sections[i])]
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

fn lifted_vertex(values: &[f64], variables: [usize; 7], sign: f64) -> AtVertex {
    let variable = |k: usize| Jet::<7>::variable(values[variables[k]], k);
    let (before, after) = (variable(0).scale(1.0 / LEVER), variable(5).scale(1.0 / LEVER));
    let (u, v) = (before.unit(), after.unit());
    let turned = (after - before).scale(sign);
    let turn = turned.shift(trig::wrap(turned.value) - turned.value);
    from_turn(variables, Vector { x: variable(2), y: variable(3) }, variable(4), (u, v), turn, sign)
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
    from_turn(variables, vertex, r, (u, v), turn, sign)
}

fn from_turn(
    variables: [usize; 7],
    vertex: Vector<7>,
    r: Jet<7>,
    (u, v): (Vector<7>, Vector<7>),
    turn: Jet<7>,
    sign: f64,
) -> AtVertex {
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
