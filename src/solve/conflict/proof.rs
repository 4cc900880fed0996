//! Proofs that no layout meets a problem's rows.
//!
//! With the headings of sections within narrow ranges, what a loop is made of is nearly linear in straights, radii and
//! tangent lengths: the vector along a section lies in a thin cone. The relaxation of a box of headings is a linear
//! program; where it has no solution, multipliers say so (Farkas' lemma), and they are checked in the arithmetic of
//! this file, whatever the solver claims. Boxes are halved until every one is refuted (branch and bound; Tawarmalani
//! and Sahinidis 2002). Rows that are not linear in these terms, obstacles and the track's own width are left out,
//! which is safe: with them there are fewer layouts still.

use crate::base::trig;
use crate::geometry::Point;
use crate::model::Formula;
use crate::problem::measures::{radius, x, y};
use crate::problem::{Function, Keepout, Problem};
use crate::solve::convex::{Quadratic, Symmetric};
use crate::solve::subproblem::{self, LinearRow};

/// Most boxes of headings that are looked at.
const BOXES: usize = 400;
/// A box this narrow that is not refuted ends the search, rad.
const NARROW: f64 = 0.01;
/// All coordinates are this near to the written ones, and all straights this short, m.
const REACH: f64 = 5_000.0;
/// What rows may be off by, m or rad, so that nothing that would be called feasible is refuted.
const TOLERANCE: f64 = 1e-5;
/// Directions by which the length of a vector is bounded where its heading is known badly.
const COMPASS: usize = 8;

/// Whether no layout meets the problem, with turns in their written directions and as often around as written.
pub fn infeasible(problem: &Problem) -> bool {
    let Some(root) = Headings::new(problem) else { return true };
    let loops = Loop::new(problem);
    let mut open = vec![root];
    let mut looked_at = 0;
    while let Some(at) = open.pop() {
        looked_at += 1;
        if looked_at > BOXES {
            return false;
        }
        if loops.refuted(&at) {
            continue;
        }
        let widest = (0..at.ranges.len()).max_by(|&a, &b| at.width(a).total_cmp(&at.width(b)).then(b.cmp(&a)));
        let Some(widest) = widest.filter(|&i| at.width(i) > NARROW) else { return false };
        open.extend(at.halves(widest, &loops.turns, loops.around));
    }
    true
}

/// Ranges of unwrapped headings by section, rad: each turn leads from the range of one section to the next, and the
/// last one to the first a winding later.
#[derive(Clone, Debug)]
struct Headings {
    ranges: Vec<(f64, f64)>,
}

impl Headings {
    /// All that the limits of turns and the fixed headings leave; `None` where that is nothing.
    fn new(problem: &Problem) -> Option<Self> {
        let n = problem.vertices.len();
        let all = if absolute(problem) { (-trig::PI, trig::PI) } else { (0.0, 0.0) };
        let mut ranges = vec![(-1e3, 1e3); n];
        ranges[0] = all;
        let (turns, around) = (turns(problem), winding(problem));
        let mut headings = Headings { ranges }.narrowed(&turns, around)?;
        for &section in &problem.rotations {
            let written = heading(problem, section);
            let (low, high) = headings.ranges[section];
            let first = ((low - TOLERANCE - written) / trig::TAU).ceil();
            let last = ((high + TOLERANCE - written) / trig::TAU).floor();
            if first > last {
                return None;
            }
            headings.ranges[section] = (written + trig::TAU * first, written + trig::TAU * last);
        }
        headings.narrowed(&turns, around)
    }

    fn width(&self, i: usize) -> f64 {
        self.ranges[i].1 - self.ranges[i].0
    }

    /// Without what the turns to and from the neighbours rule out.
    fn narrowed(mut self, turns: &[(f64, f64)], around: f64) -> Option<Self> {
        let n = self.ranges.len();
        for _ in 0..2 {
            for k in (0..2 * n).chain((0..2 * n).rev()) {
                let i = k % n;
                let before = (i + n - 1) % n;
                let lap = if i == 0 { around } else { 0.0 };
                let (from, to) = (self.ranges[before], self.ranges[i]);
                let (low, high) = turns[i];
                let onward = (from.0 + low - lap, from.1 + high - lap);
                let back = (to.0 - high + lap, to.1 - low + lap);
                self.ranges[i] = (to.0.max(onward.0 - SLACK), to.1.min(onward.1 + SLACK));
                self.ranges[before] = (from.0.max(back.0 - SLACK), from.1.min(back.1 + SLACK));
            }
        }
        self.ranges.iter().all(|r| r.0 <= r.1).then_some(self)
    }

    fn halves(&self, i: usize, turns: &[(f64, f64)], around: f64) -> Vec<Self> {
        let (low, high) = self.ranges[i];
        let middle = f64::midpoint(low, high);
        let half = |range: (f64, f64)| {
            let mut half = self.clone();
            half.ranges[i] = range;
            half.narrowed(turns, around)
        };
        [half((low, middle)), half((middle, high))].into_iter().flatten().collect()
    }
}

/// What narrowing leaves on either side, rad: a tenth of what rows may be off by.
const SLACK: f64 = 1e-6;

/// Signed turns at vertices, rad: what the rows of turns and angles allow.
fn turns(problem: &Problem) -> Vec<(f64, f64)> {
    let mut turns: Vec<(f64, f64)> = problem.signs.iter().map(|_| (0.0, trig::PI)).collect();
    for row in problem.rows.iter().filter(|row| row.weight.is_none()) {
        let (vertex, low, high) = match row.function {
            Function::Turn(i) => (i, row.low, row.high),
            Function::Formula(Formula::Angle(i)) if problem.signs[i] < 0.0 => (i, -row.high, -row.low),
            Function::Formula(Formula::Angle(i)) => (i, row.low, row.high),
            _ => continue,
        };
        let turn = &mut turns[vertex];
        *turn = (turn.0.max(low - TOLERANCE), turn.1.min(high + TOLERANCE));
    }
    let signed = |((low, high), sign): ((f64, f64), &f64)| if *sign < 0.0 { (-high, -low) } else { (low, high) };
    turns.into_iter().zip(&problem.signs).map(signed).collect()
}

/// The sum of all written turns, rad.
fn winding(problem: &Problem) -> f64 {
    let n = problem.vertices.len();
    let turn = |i: usize| trig::wrap(heading(problem, i) - heading(problem, (i + n - 1) % n));
    ((0..n).map(turn).sum::<f64>() / trig::TAU).round() * trig::TAU
}

/// The written heading of a section, rad.
fn heading(problem: &Problem, section: usize) -> f64 {
    let (from, to) = (section, (section + 1) % problem.vertices.len());
    let at = |i: usize| Point::new(problem.start[x(i)], problem.start[y(i)]);
    (at(to) - at(from)).heading()
}

/// Whether any row tells one direction of the plan from another.
fn absolute(problem: &Problem) -> bool {
    let tells = |function: &Function| match function {
        Function::Turn(_) | Function::Section(_) | Function::Straight(_) => false,
        Function::Linear(terms) => terms.iter().any(|(k, _)| k % 3 != 2),
        Function::StraightMiddle { .. } | Function::StraightEnd { .. } => true,
        Function::Formula(formula) => !relative(formula),
    };
    let limits = |low: f64, high: f64| low.is_finite() || high.is_finite();
    let place = |k: usize| k % 3 != 2 && limits(problem.bounds[k].low, problem.bounds[k].high);
    problem.keepouts.iter().any(|k| k.distance.is_finite())
        || problem.rows.iter().any(|row| limits(row.low, row.high) && tells(&row.function))
        || !problem.rotations.is_empty()
        || (0..3 * problem.vertices.len()).any(place)
}

fn relative(formula: &Formula) -> bool {
    match formula {
        Formula::Constant(_) | Formula::Radius(_) | Formula::Length(_) | Formula::Angle(_) => true,
        Formula::DistanceVertices(..) => true,
        Formula::Sum(terms) | Formula::Product(terms) => terms.iter().all(relative),
        Formula::Negative(inner) => relative(inner),
        _ => false,
    }
}

/// A linear expression over the program's variables.
#[derive(Clone, Debug, Default)]
struct Linear {
    terms: Vec<(usize, f64)>,
    constant: f64,
}

impl Linear {
    fn of(k: usize) -> Self {
        Linear { terms: vec![(k, 1.0)], constant: 0.0 }
    }

    fn and(mut self, other: Linear, by: f64) -> Self {
        self.terms.extend(other.terms.into_iter().map(|(k, a)| (k, by * a)));
        self.constant += by * other.constant;
        self
    }

    fn scaled(self, by: f64) -> Self {
        Linear::default().and(self, by)
    }
}

/// The program's variables of a vertex and the section that begins there: x, y and radius of the vertex, its tangent
/// length, the section's straight and heading, and vectors along what they lie on: the tangent before the vertex, the
/// one behind it, and the straight.
const EACH: usize = 12;
const TANGENT: usize = 3;
const STRAIGHT: usize = 4;
const HEADING: usize = 5;
const BEFORE: usize = 6;
const BEHIND: usize = 8;
const ALONG: usize = 10;

struct Loop<'a> {
    problem: &'a Problem,
    turns: Vec<(f64, f64)>,
    around: f64,
}

/// low <= expression <= high
struct Limit {
    expression: Linear,
    low: f64,
    high: f64,
}

impl<'a> Loop<'a> {
    fn new(problem: &'a Problem) -> Self {
        Loop { problem, turns: turns(problem), around: winding(problem) }
    }

    fn len(&self) -> usize {
        self.problem.vertices.len()
    }

    fn next(&self, i: usize) -> usize {
        (i + 1) % self.len()
    }

    fn variable(&self, i: usize, which: usize) -> Linear {
        Linear::of(EACH * i + which)
    }

    /// A component along `direction` of a vector of two variables.
    fn component(&self, i: usize, which: usize, direction: Point) -> Linear {
        let k = EACH * i + which;
        Linear { terms: vec![(k, direction.x), (k + 1, direction.y)], constant: 0.0 }
    }

    fn section(&self, i: usize) -> Linear {
        let tangents = self.variable(i, TANGENT).and(self.variable(self.next(i), TANGENT), 1.0);
        self.variable(i, STRAIGHT).and(tangents, 1.0)
    }

    /// The signed turn at a vertex, rad.
    fn turn(&self, i: usize) -> Linear {
        let before = (i + self.len() - 1) % self.len();
        let lap = if i == 0 { self.around } else { 0.0 };
        let mut turn = self.variable(i, HEADING).and(self.variable(before, HEADING), -1.0);
        turn.constant += lap;
        turn
    }

    /// What a row measures, where that is linear.
    fn function(&self, function: &Function) -> Option<Linear> {
        match function {
            Function::Turn(i) => Some(self.turn(*i).scaled(self.problem.signs[*i])),
            Function::Section(i) => Some(self.section(*i)),
            Function::Straight(i) => Some(self.variable(*i, STRAIGHT)),
            Function::Linear(terms) => {
                let term = |sum: Linear, &(k, by): &(usize, f64)| sum.and(self.variable(k / 3, k % 3), by);
                Some(terms.iter().fold(Linear::default(), term))
            }
            Function::StraightMiddle { section, direction } => {
                let next = self.next(*section);
                let begin =
                    self.component(*section, 0, *direction).and(self.component(*section, BEHIND, *direction), 1.0);
                let end = self.component(next, 0, *direction).and(self.component(next, BEFORE, *direction), -1.0);
                Some(begin.and(end, 1.0).scaled(0.5))
            }
            Function::StraightEnd { section, end, direction } => {
                let (vertex, beside, by) =
                    if *end { (self.next(*section), BEFORE, -1.0) } else { (*section, BEHIND, 1.0) };
                Some(self.component(vertex, 0, *direction).and(self.component(vertex, beside, *direction), by))
            }
            Function::Formula(formula) => self.formula(formula),
        }
    }

    fn formula(&self, formula: &Formula) -> Option<Linear> {
        match formula {
            Formula::Constant(value) => Some(Linear { terms: Vec::new(), constant: *value }),
            Formula::X(i) => Some(self.variable(*i, 0)),
            Formula::Y(i) => Some(self.variable(*i, 1)),
            Formula::Radius(i) => Some(self.variable(*i, 2)),
            Formula::Length(target) if target.straight => Some(self.variable(target.from, STRAIGHT)),
            Formula::Length(target) => Some(self.section(target.from)),
            Formula::Angle(i) => Some(self.turn(*i)),
            Formula::Negative(inner) => Some(self.formula(inner)?.scaled(-1.0)),
            Formula::Sum(terms) => {
                terms.iter().try_fold(Linear::default(), |sum, term| Some(sum.and(self.formula(term)?, 1.0)))
            }
            Formula::Product(terms) => {
                let one = Linear { terms: Vec::new(), constant: 1.0 };
                terms.iter().try_fold(one, |product, term| {
                    let factor = self.formula(term)?;
                    match (product.terms.is_empty(), factor.terms.is_empty()) {
                        (true, _) => Some(factor.scaled(product.constant)),
                        (false, true) => Some(product.scaled(factor.constant)),
                        (false, false) => None,
                    }
                })
            }
            _ => None,
        }
    }

    /// Whether no loop with these headings meets the rows.
    fn refuted(&self, at: &Headings) -> bool {
        let mut limits = Vec::new();
        for i in 0..self.len() {
            self.shape(i, at, &mut limits);
        }
        for row in &self.problem.rows {
            if let Some(expression) = self.function(&row.function).filter(|_| row.weight.is_none()) {
                limits.push(Limit { expression, low: row.low, high: row.high });
            }
        }
        for keepout in self.problem.keepouts.iter().filter(|k| k.region.outside && k.distance.is_finite()) {
            self.walls(keepout, at, &mut limits);
        }
        limits.retain(|l| (l.low.is_finite() || l.high.is_finite()) && !l.expression.terms.is_empty());
        contradictory(&limits, &self.boxes(at))
    }

    /// Limits of every variable.
    fn boxes(&self, at: &Headings) -> Vec<(f64, f64)> {
        let mut boxes = Vec::new();
        for i in 0..self.len() {
            let bound = |k: usize| {
                let (bound, written) = (self.problem.bounds[k], self.problem.start[k]);
                (bound.low.max(written - REACH), bound.high.min(written + REACH))
            };
            let (length, vector) = ((-TOLERANCE, REACH), (-REACH, REACH));
            boxes.extend([bound(x(i)), bound(y(i)), bound(radius(i)), length, length, at.ranges[i]]);
            boxes.extend([vector; 6]);
        }
        boxes
    }

    /// How a vertex and the section behind it hang together.
    fn shape(&self, i: usize, at: &Headings, limits: &mut Vec<Limit>) {
        let (n, next) = (self.len(), self.next(i));
        let before = (i + n - 1) % n;
        let mut equal = |expression: Linear| limits.push(Limit { expression, low: 0.0, high: 0.0 });
        for axis in [Point::new(1.0, 0.0), Point::new(0.0, 1.0)] {
            let gap = self.component(next, 0, axis).and(self.component(i, 0, axis), -1.0);
            let along = self.component(i, BEHIND, axis).and(self.component(i, ALONG, axis), 1.0);
            equal(gap.and(along.and(self.component(next, BEFORE, axis), 1.0), -1.0));
        }
        self.cone(i, TANGENT, BEFORE, at.ranges[before], limits);
        self.cone(i, TANGENT, BEHIND, at.ranges[i], limits);
        self.cone(i, STRAIGHT, ALONG, at.ranges[i], limits);
        // The tangent length is R tan(turn / 2).
        let lap = if i == 0 { self.around } else { 0.0 };
        let turns = (at.ranges[i].0 - at.ranges[before].1 + lap, at.ranges[i].1 - at.ranges[before].0 + lap);
        let turns = (turns.0.max(self.turns[i].0), turns.1.min(self.turns[i].1));
        let sizes = if self.problem.signs[i] < 0.0 { (-turns.1, -turns.0) } else { turns };
        let tangent = |turn: f64| self.variable(i, TANGENT).and(self.variable(i, 2), -trig::tan(turn / 2.0));
        limits.push(Limit { expression: tangent(sizes.0.max(0.0)), low: 0.0, high: f64::INFINITY });
        if sizes.1 < trig::PI - NARROW {
            limits.push(Limit { expression: tangent(sizes.1.max(0.0)), low: f64::NEG_INFINITY, high: 0.0 });
        }
    }

    /// A vector whose length is one variable and whose heading is within a range.
    fn cone(&self, i: usize, length: usize, vector: usize, (low, high): (f64, f64), limits: &mut Vec<Limit>) {
        let width = high - low;
        let part = |direction: Point| self.component(i, vector, direction);
        let mut at_least = |expression: Linear| limits.push(Limit { expression, low: 0.0, high: f64::INFINITY });
        let length = || self.variable(i, length);
        if width < trig::PI - NARROW {
            at_least(part(Point::unit(low).left()));
            at_least(part(-Point::unit(high).left()));
            let middle = Point::unit(f64::midpoint(low, high));
            at_least(part(middle).and(length(), -trig::cos(width / 2.0)));
            for heading in [low, f64::midpoint(low, high), high] {
                at_least(length().and(part(Point::unit(heading)), -1.0));
            }
        } else {
            for k in 0..COMPASS {
                let heading = trig::TAU * k as f64 / COMPASS as f64;
                at_least(length().and(part(Point::unit(heading)), -1.0));
            }
        }
    }

    /// Tangent points within the building's hull, and arcs where they surely face a wall.
    fn walls(&self, keepout: &Keepout, at: &Headings, limits: &mut Vec<Limit>) {
        for (through, outward) in hull(keepout.region.polygon.points()) {
            let high = outward.dot(through) - keepout.distance;
            let mut inside = |expression: Linear| limits.push(Limit { expression, low: f64::NEG_INFINITY, high });
            for i in 0..self.len() {
                let vertex = self.component(i, 0, outward);
                let begin = vertex.clone().and(self.component(i, BEFORE, outward), -1.0);
                let end = vertex.and(self.component(i, BEHIND, outward), 1.0);
                let before = at.ranges[(i + self.len() - 1) % self.len()];
                let lap = if i == 0 { self.around } else { 0.0 };
                let before = (before.0 - lap, before.1 - lap);
                let sign = self.problem.signs[i];
                if faces(before, at.ranges[i], sign, outward.heading()) {
                    for (point, range) in [(&begin, before), (&end, at.ranges[i])] {
                        let deep = least_cosine(range, outward.heading() - sign * trig::PI / 2.0);
                        inside(point.clone().and(self.variable(i, 2), 1.0 + deep));
                    }
                }
                inside(begin);
                inside(end);
            }
        }
    }
}

/// Whether an arc between headings within these ranges has a spot whose outward normal is along `outward` (rad).
fn faces(before: (f64, f64), behind: (f64, f64), sign: f64, outward: f64) -> bool {
    // Travel there is square to the normal, so that the arc's centre lies behind.
    let heading = outward + sign * trig::PI / 2.0;
    let (low, high) = if sign > 0.0 { (before.1, behind.0) } else { (behind.1, before.0) };
    let turned = heading + trig::TAU * ((low - heading) / trig::TAU).ceil();
    turned <= high
}

/// The least of cos(heading − towards) over a range of headings, rad.
fn least_cosine((low, high): (f64, f64), towards: f64) -> f64 {
    let (low, high) = (low - towards, high - towards);
    let opposite = trig::PI + trig::TAU * ((low - trig::PI) / trig::TAU).ceil();
    if opposite <= high { -1.0 } else { trig::cos(low).min(trig::cos(high)) }
}

/// The edges of the convex hull of points, each as a point on it and the outward normal (Andrew's monotone chain).
fn hull(points: &[Point]) -> Vec<(Point, Point)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).cross(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut corners = chain(&mut sorted.iter().copied());
    corners.extend(chain(&mut sorted.iter().rev().copied()));
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        (a, -((b - a) * (1.0 / a.distance(b))).left())
    };
    (0..corners.len()).map(edge).collect()
}

/// Whether multipliers show that no point of the boxes meets the limits. They come from the program of violating them
/// as little as possible; whatever they are, they prove what is computed from them.
fn contradictory(limits: &[Limit], boxes: &[(f64, f64)]) -> bool {
    let row = |limit: &Limit| {
        let constant = limit.expression.constant;
        LinearRow {
            coefficients: collected(&limit.expression.terms),
            low: limit.low - constant,
            high: limit.high - constant,
            price: Some(1.0),
        }
    };
    let rows: Vec<LinearRow> = limits.iter().map(row).collect();
    let model = Quadratic { matrix: Symmetric::new(boxes.len()), linear: vec![0.0; boxes.len()] };
    let (low, high): (Vec<f64>, Vec<f64>) = boxes.iter().copied().unzip();
    let Some(step) = subproblem::solve(&model, &low, &high, &rows) else { return false };
    let mut weighted = vec![0.0; boxes.len()];
    let (mut most, mut slack) = (0.0, 0.0);
    for (row, &weight) in rows.iter().zip(&step.multipliers) {
        let limit = if weight > 0.0 { row.high } else { row.low };
        // An infinite limit takes no part, whatever the solver says of it.
        if limit.is_finite() {
            row.coefficients.iter().for_each(|&(k, a)| weighted[k] += weight * a);
            most += weight * limit;
            slack += weight.abs();
        }
    }
    let least: f64 = weighted.iter().zip(boxes).map(|(c, b)| (c * b.0).min(c * b.1)).sum();
    least > most + TOLERANCE * slack + 1e-9 * (1.0 + most.abs())
}

/// Terms with each variable once.
fn collected(terms: &[(usize, f64)]) -> Vec<(usize, f64)> {
    let mut sum = std::collections::BTreeMap::new();
    for &(k, a) in terms {
        *sum.entry(k).or_insert(0.0) += a;
    }
    sum.into_iter().filter(|(_, a)| *a != 0.0).collect()
}

#[cfg(test)]
mod tests;
