//! The measures of a layout as expressions: the same quantities that [`Measures`](super::super::measures::Measures) has
//! as numbers (thesis §3.2).

use super::super::measures::{radius, x, y};
use super::graph::{Graph, Id, Operator, Plane};

/// What belongs to a vertex.
#[derive(Clone, Copy, Debug)]
pub struct AtVertex {
    /// σ·turn, rad.
    pub turn: Id,
    /// R tan(σ·turn/2), m.
    pub tangent: Id,
    pub radius: Id,
    pub centre: Plane,
    pub begin: Plane,
    pub end: Plane,
}

/// What belongs to the section from a vertex to the next.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    pub from: Plane,
    /// From vertex to vertex.
    pub along: Plane,
    /// m
    pub length: Id,
    /// Unit vector.
    pub direction: Plane,
}

#[derive(Debug)]
pub struct Shapes {
    pub graph: Graph,
    pub points: Vec<Plane>,
    pub sections: Vec<Section>,
    pub vertices: Vec<AtVertex>,
}

impl Shapes {
    /// `signs` are the written turn directions, +1 left and -1 right.
    pub fn new(signs: &[f64]) -> Self {
        let n = signs.len();
        let mut graph = Graph::default();
        let points: Vec<Plane> = (0..n).map(|i| Plane { x: graph.variable(x(i)), y: graph.variable(y(i)) }).collect();
        let sections: Vec<Section> = (0..n).map(|i| section(&mut graph, points[i], points[(i + 1) % n])).collect();
        let vertices = (0..n)
            .map(|i| at_vertex(&mut graph, i, points[i], &sections[(i + n - 1) % n], &sections[i], signs[i]))
            .collect();
        Shapes { graph, points, sections, vertices }
    }

    pub fn next(&self, i: usize) -> usize {
        (i + 1) % self.points.len()
    }

    /// Length of the straight that remains between the tangent points of a section, m.
    pub fn straight(&mut self, i: usize) -> Id {
        let (before, after) = (self.vertices[i].tangent, self.vertices[self.next(i)].tangent);
        let rest = self.graph.subtract(self.sections[i].length, before);
        self.graph.subtract(rest, after)
    }

    /// Length of the centre line: Σ sections + Σ R turn − 2 tangent, m.
    pub fn track_length(&mut self) -> Id {
        let mut terms: Vec<Id> = self.sections.iter().map(|s| s.length).collect();
        for vertex in &self.vertices {
            let arc = self.graph.multiply(vertex.radius, vertex.turn);
            let cut = self.graph.scale(2.0, vertex.tangent);
            terms.push(self.graph.subtract(arc, cut));
        }
        self.graph.list(Operator::Sum, terms)
    }
}

fn section(graph: &mut Graph, from: Plane, to: Plane) -> Section {
    let along = graph.between(from, to);
    let length = graph.norm(along);
    let mut per_length = |a: Id| graph.apply(Operator::Divide, [a, length]);
    let direction = Plane { x: per_length(along.x), y: per_length(along.y) };
    Section { from, along, length, direction }
}

fn at_vertex(graph: &mut Graph, i: usize, point: Plane, before: &Section, after: &Section, sign: f64) -> AtVertex {
    let (u, v) = (before.direction, after.direction);
    let (sine, cosine) = (graph.cross(u, v), graph.dot(u, v));
    let sine = graph.scale(sign, sine);
    let turn = graph.apply(Operator::ArcTangent, [sine, cosine]);
    let half = graph.scale(0.5, turn);
    let slope = graph.apply(Operator::Tangent, [half]);
    let radius = graph.variable(radius(i));
    let tangent = graph.multiply(radius, slope);
    let mut moved = |by: Id, along: Plane, from: Plane, operator: Operator| {
        let (dx, dy) = (graph.multiply(by, along.x), graph.multiply(by, along.y));
        Plane { x: graph.apply(operator, [from.x, dx]), y: graph.apply(operator, [from.y, dy]) }
    };
    let begin = moved(tangent, u, point, Operator::Subtract);
    let end = moved(tangent, v, point, Operator::Add);
    // The centre lies beside the begin, R to the inner side: begin + σ R (−u_y, u_x).
    let (left, right) =
        if sign < 0.0 { (Operator::Subtract, Operator::Add) } else { (Operator::Add, Operator::Subtract) };
    let (rx, ry) = (graph.multiply(radius, u.y), graph.multiply(radius, u.x));
    let centre = Plane { x: graph.apply(right, [begin.x, rx]), y: graph.apply(left, [begin.y, ry]) };
    AtVertex { turn, tangent, radius, centre, begin, end }
}
