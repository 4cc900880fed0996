//! Objective and rows of a problem as expressions.
//!
//! What the optimiser chooses anew at every point is chosen once here, at `at`: which corners and edges of a region and
//! which parts of the track a clearance row is about, the full turns of a heading, the part of a polygon's outline that
//! is nearest to a vertex.

use super::super::clearance::{ClearanceForm, Spot};
use super::super::formula::{Nearest, nearest};
use super::super::measures::to_corners;
use super::super::{ConstraintRow, Function, Problem, RowKey};
use super::graph::{Graph, Id, Operator, Plane};
use super::shapes::Shapes;
use crate::base::trig;
use crate::geometry::{Point, Polygon, Track};
use crate::model::{Formula, Target};

/// Clearance rows closer to their limit than this where they were chosen are in the file, m.
pub const REACH: f64 = 3.0;

/// `low <= body <= high`.
#[derive(Debug)]
pub struct Written {
    pub key: RowKey,
    pub body: Id,
    pub low: f64,
    pub high: f64,
}

/// A problem whose choices are made.
#[derive(Debug)]
pub struct Frozen {
    pub graph: Graph,
    pub objective: Id,
    pub rows: Vec<Written>,
}

impl Frozen {
    pub fn new(problem: &Problem, at: &[f64]) -> Self {
        let here = problem.evaluate(at, REACH);
        let mut writer = Writer { problem, track: Track::new(&to_corners(at)), shapes: Shapes::new(&problem.signs) };
        let objective = writer.shapes.track_length();
        let mut rows = Vec::with_capacity(here.rows.len());
        for row in &here.rows {
            let body = match (row.key, problem.clearance(row.key, &here.track)) {
                (RowKey::Listed(i), _) => writer.listed(&problem.rows[i], row.expansion.value),
                (_, Some((form, _))) => writer.clearance(&form),
                (_, None) => continue,
            };
            rows.push(Written { key: row.key, body, low: row.low, high: row.high });
        }
        Frozen { graph: writer.shapes.graph, objective, rows }
    }
}

struct Writer<'p> {
    problem: &'p Problem,
    /// Where choices are made.
    track: Track,
    shapes: Shapes,
}

impl Writer<'_> {
    fn graph(&mut self) -> &mut Graph {
        &mut self.shapes.graph
    }

    /// `value` is the row's where choices are made.
    fn listed(&mut self, row: &ConstraintRow, value: f64) -> Id {
        match &row.function {
            Function::Turn(i) => self.shapes.vertices[*i].turn,
            Function::Section(i) => self.shapes.sections[*i].length,
            Function::Straight(i) => self.shapes.straight(*i),
            Function::Linear(terms) => {
                let terms = terms.iter().map(|&(k, c)| {
                    let variable = self.shapes.graph.variable(k);
                    self.shapes.graph.scale(c, variable)
                });
                let terms = terms.collect();
                self.graph().list(Operator::Sum, terms)
            }
            Function::StraightMiddle { section, direction } => {
                let (begin, end) =
                    (self.shapes.vertices[*section].end, self.shapes.vertices[self.shapes.next(*section)].begin);
                let (begin, end) = (self.component(begin, *direction), self.component(end, *direction));
                let sum = self.graph().add(begin, end);
                self.graph().scale(0.5, sum)
            }
            Function::StraightEnd { section, end, direction } => {
                let point = if *end {
                    self.shapes.vertices[self.shapes.next(*section)].begin
                } else {
                    self.shapes.vertices[*section].end
                };
                self.component(point, *direction)
            }
            Function::Formula(formula @ Formula::Heading(i)) => {
                let heading = self.formula(formula);
                let plain = self.track.straight(*i).heading;
                let turns = ((value - plain) / trig::TAU).round();
                if turns == 0.0 {
                    return heading;
                }
                let shift = self.graph().number(turns * trig::TAU);
                self.graph().add(heading, shift)
            }
            Function::Formula(formula) => self.formula(formula),
        }
    }

    /// Component of a point along a unit direction.
    fn component(&mut self, p: Plane, direction: Point) -> Id {
        let (x, y) = (self.graph().scale(direction.x, p.x), self.graph().scale(direction.y, p.y));
        self.graph().add(x, y)
    }

    fn constant(&mut self, p: Point) -> Plane {
        Plane { x: self.graph().number(p.x), y: self.graph().number(p.y) }
    }

    fn clearance(&mut self, form: &ClearanceForm) -> Id {
        match *form {
            ClearanceForm::CornerAtLine { section, corner, lies } => {
                let corner = self.constant(corner);
                self.beside(section, corner, lies)
            }
            ClearanceForm::CornerAtCircle { vertex, corner, lies } => {
                let corner = self.constant(corner);
                let at = self.shapes.vertices[vertex];
                let from = self.graph().between(corner, at.centre);
                let out = self.graph().norm(from);
                let inside = self.graph().subtract(at.radius, out);
                self.shapes.graph.scale(lies * self.problem.signs[vertex], inside)
            }
            ClearanceForm::ArcOverEdge { vertex, edge, spot } => {
                let begin = self.constant(edge.begin);
                let (point, radius) = self.spot(vertex, spot);
                let from = self.graph().between(begin, point);
                let height = self.component(from, edge.normal);
                self.less(height, radius)
            }
            ClearanceForm::ArcAtLine { arc, section, side, spot } => {
                let (point, radius) = self.spot(arc, spot);
                let beside = self.beside(section, point, side);
                self.less(beside, radius)
            }
            ClearanceForm::Arcs { arc, other, within } => {
                let (a, b) = (self.shapes.vertices[arc], self.shapes.vertices[other]);
                let between = self.graph().between(b.centre, a.centre);
                let between = self.graph().norm(between);
                let (more, fewer) = if within { (b.radius, between) } else { (between, b.radius) };
                let rest = self.graph().subtract(more, fewer);
                self.graph().subtract(rest, a.radius)
            }
        }
    }

    /// A spot of an arc, and the radius by which its crest lies beyond it.
    fn spot(&self, vertex: usize, spot: Spot) -> (Plane, Option<Id>) {
        let at = &self.shapes.vertices[vertex];
        match spot {
            Spot::Crest => (at.centre, Some(at.radius)),
            Spot::Begin => (at.begin, None),
            Spot::End => (at.end, None),
        }
    }

    fn less(&mut self, value: Id, by: Option<Id>) -> Id {
        match by {
            Some(by) => self.graph().subtract(value, by),
            None => value,
        }
    }

    /// Offset of a point from a section's line, positive on one side of it (+1 left).
    fn beside(&mut self, section: usize, point: Plane, side: f64) -> Id {
        let section = self.shapes.sections[section];
        let from = self.graph().between(section.from, point);
        let lateral = self.graph().cross(section.direction, from);
        self.graph().scale(side, lateral)
    }

    fn formula(&mut self, formula: &Formula) -> Id {
        match formula {
            Formula::Constant(value) => self.graph().number(*value),
            Formula::X(i) => self.shapes.points[*i].x,
            Formula::Y(i) => self.shapes.points[*i].y,
            Formula::Radius(i) => self.shapes.vertices[*i].radius,
            Formula::Length(Target { from, straight: false }) => self.shapes.sections[*from].length,
            Formula::Length(Target { from, straight: true }) => self.shapes.straight(*from),
            Formula::Heading(i) => {
                let along = self.shapes.sections[*i].along;
                self.graph().apply(Operator::ArcTangent, [along.y, along.x])
            }
            Formula::Angle(i) => {
                let (turn, sign) = (self.shapes.vertices[*i].turn, self.problem.signs[*i]);
                self.graph().scale(sign, turn)
            }
            Formula::DistanceVertices(a, b) => {
                let (a, b) = (self.shapes.points[*a], self.shapes.points[*b]);
                let between = self.graph().between(a, b);
                self.graph().norm(between)
            }
            Formula::DistanceObstacle(i, k) => match self.problem.places.obstacles.get(*k) {
                Some(polygon) => self.outline_distance(*i, polygon, 1.0),
                None => self.graph().number(f64::INFINITY),
            },
            Formula::DistanceBuilding(i) => match &self.problem.places.building {
                Some(walls) => self.outline_distance(*i, walls, -1.0),
                None => self.graph().number(f64::INFINITY),
            },
            Formula::Sum(terms) => self.list(Operator::Sum, terms),
            Formula::Product(factors) => {
                let first = self.graph().number(1.0);
                factors.iter().fold(first, |product, factor| {
                    let factor = self.formula(factor);
                    if product == first { factor } else { self.graph().multiply(product, factor) }
                })
            }
            Formula::Negative(inner) => self.one(Operator::Negate, inner),
            Formula::Reciprocal(inner) => {
                let (one, inner) = (self.graph().number(1.0), self.formula(inner));
                self.graph().apply(Operator::Divide, [one, inner])
            }
            Formula::Absolute(inner) => self.one(Operator::Absolute, inner),
            Formula::SquareRoot(inner) => self.one(Operator::SquareRoot, inner),
            Formula::Smallest(terms) => self.list(Operator::Least, terms),
            Formula::Largest(terms) => self.list(Operator::Greatest, terms),
        }
    }

    fn one(&mut self, operator: Operator, inner: &Formula) -> Id {
        let inner = self.formula(inner);
        self.graph().apply(operator, [inner])
    }

    fn list(&mut self, operator: Operator, terms: &[Formula]) -> Id {
        let terms = terms.iter().map(|term| self.formula(term)).collect();
        self.graph().list(operator, terms)
    }

    fn outline_distance(&mut self, vertex: usize, polygon: &Polygon, side: f64) -> Id {
        let Some(Nearest { foot, normal, sign }) = nearest(polygon, self.track.corners[vertex].point) else {
            return self.graph().number(f64::INFINITY);
        };
        let foot = self.constant(foot);
        let from = self.shapes.graph.between(foot, self.shapes.points[vertex]);
        let distance = match normal {
            Some(normal) => self.component(from, normal),
            None => self.graph().norm(from),
        };
        self.graph().scale(sign * side, distance)
    }
}
