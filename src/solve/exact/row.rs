//! Rows that are linear in positions, straights and radii once headings are chosen.

use super::grid::Grid;
use crate::geometry::Point;
use crate::model::{Formula, Target};
use crate::problem::measures::{radius, x, y};
use crate::problem::{Function, Problem};

/// `value >= low`, or `value == low`. Every list is by stage. V is a vertex, u and n the unit vector along a section
/// and its left normal, t = R tan(turn/2) the tangent length at a vertex, s the straight of a section.
#[derive(Clone, Debug, Default)]
pub struct GridRow {
    /// g·V; stage n is the first vertex, after the way around.
    pub at: Vec<(usize, Point)>,
    /// a s
    pub straight: Vec<(usize, f64)>,
    /// b (s + t + t'), the length from vertex to vertex
    pub length: Vec<(usize, f64)>,
    /// r R
    pub radius: Vec<(usize, f64)>,
    /// t g·u of the section before
    pub into: Vec<(usize, Point)>,
    /// t g·u of the section after
    pub out: Vec<(usize, Point)>,
    /// R g·n of the section before
    pub normal: Vec<(usize, Point)>,
    /// g·(p − V), p being where the track has a given heading
    pub touch: Vec<Touch>,
    pub low: f64,
    pub equal: bool,
    /// Which of the variables that cost something each it may be short by.
    pub relief: Option<usize>,
}

/// The point p with a given heading on one of consecutive arcs that all turn in the same direction. The track there is
/// convex, so that p is its extreme point in the direction of the normal.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// The arcs, by vertex stage 1..=n; V is the first one's vertex.
    pub from: usize,
    pub to: usize,
    /// In steps.
    pub heading: f64,
    /// Left normal of that heading.
    pub normal: Point,
    pub pull: Point,
}

impl Touch {
    /// Whether a section's heading is beyond it.
    pub fn passed(&self, heading: i32, sign: i32) -> bool {
        f64::from(sign) * (f64::from(heading) - self.heading) >= 0.0
    }

    /// What the arc at a stage adds, for each metre of its tangent length and of its radius; u and v are the unit
    /// vectors before and after, with their headings. Beyond p nothing counts; before it, the whole way.
    pub fn arc(&self, k: usize, sign: i32, (h, u): (i32, Point), (t, v): (i32, Point)) -> (f64, f64) {
        let first = k == self.from;
        if self.passed(h, sign) {
            (0.0, 0.0)
        } else if self.passed(t, sign) {
            let back = if first { -self.pull.dot(u) } else { 0.0 };
            (back, f64::from(sign) * self.pull.dot(u.left() - self.normal))
        } else {
            (self.pull.dot(if first { v } else { u + v }), 0.0)
        }
    }

    /// What the straight of a stage adds for each metre.
    pub fn straight(&self, k: usize, sign: i32, (h, u): (i32, Point)) -> f64 {
        let counts = self.from <= k && k < self.to && !self.passed(h, sign);
        if counts { self.pull.dot(u) } else { 0.0 }
    }
}

impl GridRow {
    /// Whether nothing but lengths of straights counts.
    pub fn is_of_straights(&self) -> bool {
        let places = self.at.is_empty() && self.length.is_empty() && self.touch.is_empty();
        places && [self.into.len(), self.out.len(), self.normal.len(), self.radius.len()] == [0; 4]
    }

    /// The same function with the opposite sign, `>= low`.
    fn negated(&self, low: f64) -> GridRow {
        let scalars = |list: &[(usize, f64)]| list.iter().map(|&(k, a)| (k, -a)).collect();
        let points = |list: &[(usize, Point)]| list.iter().map(|&(k, g)| (k, -g)).collect();
        GridRow {
            at: points(&self.at),
            straight: scalars(&self.straight),
            length: scalars(&self.length),
            radius: scalars(&self.radius),
            into: points(&self.into),
            out: points(&self.out),
            normal: points(&self.normal),
            touch: self.touch.iter().map(|t| Touch { pull: -t.pull, ..*t }).collect(),
            low,
            equal: false,
            relief: None,
        }
    }

    fn add(&mut self, other: GridRow, factor: f64) {
        let scalars = |list: Vec<(usize, f64)>| list.into_iter().map(move |(k, a)| (k, a * factor));
        let points = |list: Vec<(usize, Point)>| list.into_iter().map(move |(k, g)| (k, g * factor));
        self.at.extend(points(other.at));
        self.straight.extend(scalars(other.straight));
        self.length.extend(scalars(other.length));
        self.radius.extend(scalars(other.radius));
        self.into.extend(points(other.into));
        self.out.extend(points(other.out));
        self.normal.extend(points(other.normal));
        self.touch.extend(other.touch.into_iter().map(|t| Touch { pull: t.pull * factor, ..t }));
    }

    /// Counts positions from the last known vertex before them rather than from the first vertex. Returns the constant
    /// that this takes out of the row.
    pub fn anchor(&mut self, fixed: &[(usize, Point)]) -> f64 {
        let mut constant = 0.0;
        for i in 0..self.at.len() {
            let (k, g) = self.at[i];
            if let Some(&(from, p)) = fixed.iter().rev().find(|f| f.0 <= k) {
                self.at.push((from, -g));
                constant += g.dot(p);
            }
        }
        constant
    }

    /// g·(the centre of the fillet at a vertex), c = V − t u + σ R n.
    pub fn centre(&mut self, grid: &Grid, stage: usize, g: Point) {
        self.at.push((stage, g));
        self.into.push((stage, -g));
        self.normal.push((stage, g * f64::from(grid.signs[stage])));
    }
}

/// What a problem says apart from its regions, in rows; what has no such form is left out, which only weakens a bound.
pub struct Stated {
    pub rows: Vec<GridRow>,
    /// Limits of each straight, m, by stage.
    pub straights: Vec<(f64, f64)>,
    /// Vertices whose position is known, by stage, ascending.
    pub fixed: Vec<(usize, Point)>,
    /// How many of the first rows only close the loop.
    pub closing: usize,
    /// Whether anything was left out.
    pub partial: bool,
}

/// What straights lie between, m, by stage: within these limits, as far as rows of a single straight say.
pub fn straights(rows: &[GridRow], limits: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut within = limits.to_vec();
    for row in rows {
        if let ([(k, weight)], true) = (row.straight.as_slice(), row.is_of_straights()) {
            let bound = row.low / weight;
            let own = &mut within[*k];
            if *weight > 0.0 || row.equal {
                own.0 = own.0.max(bound);
            }
            if *weight < 0.0 || row.equal {
                own.1 = own.1.min(bound);
            }
        }
    }
    within
}

/// Translates a problem.
pub fn state(problem: &Problem, grid: &Grid) -> Stated {
    let n = grid.len();
    let mut out = Stated {
        rows: Vec::new(),
        straights: vec![(0.0, f64::INFINITY); n],
        fixed: Vec::new(),
        closing: 0,
        partial: false,
    };
    let is_fixed = |k: usize| problem.bounds[k].low == problem.bounds[k].high;
    for k in 0..n {
        let v = grid.vertex(k);
        if is_fixed(x(v)) && is_fixed(y(v)) {
            out.fixed.push((k, Point::new(problem.start[x(v)], problem.start[y(v)])));
        }
    }
    closing(grid, &mut out);
    out.closing = out.rows.len();
    for row in problem.rows.iter().filter(|row| row.weight.is_none()) {
        let stated = match &row.function {
            Function::Turn(_) => None,
            Function::Straight(i) => {
                let limits = &mut out.straights[grid.stage(*i)];
                *limits = (limits.0.max(row.low), limits.1.min(row.high));
                None
            }
            Function::Section(i) => Some((GridRow { length: vec![(grid.stage(*i), 1.0)], ..GridRow::default() }, 0.0)),
            Function::Linear(terms) => linear(terms, grid, problem).map(|row| (row, 0.0)),
            Function::StraightMiddle { section, direction } => {
                let (k, half) = (grid.stage(*section), *direction * 0.5);
                let next = (k + 1) % n;
                let at = vec![(k, half), (next, half)];
                Some((GridRow { at, out: vec![(k, half)], into: vec![(next, -half)], ..GridRow::default() }, 0.0))
            }
            Function::StraightEnd { section, end, direction } => {
                let k = grid.stage(*section);
                let next = (k + 1) % n;
                let row = if *end {
                    GridRow { at: vec![(next, *direction)], into: vec![(next, -*direction)], ..GridRow::default() }
                } else {
                    GridRow { at: vec![(k, *direction)], out: vec![(k, *direction)], ..GridRow::default() }
                };
                Some((row, 0.0))
            }
            Function::Formula(f) => {
                let row = formula(f, grid);
                out.partial |= row.is_none();
                row
            }
        };
        let Some((stated, constant)) = stated else { continue };
        let (mut stated, constant) = (stated, constant);
        let constant = constant + stated.anchor(&out.fixed);
        let (low, high) = (row.low - constant, row.high - constant);
        if low == high {
            out.rows.push(GridRow { low, equal: true, ..stated });
            continue;
        }
        if high.is_finite() {
            out.rows.push(stated.negated(-high));
        }
        if low.is_finite() {
            out.rows.push(GridRow { low, ..stated });
        }
    }
    out
}

/// From each known vertex to the next, and around.
fn closing(grid: &Grid, out: &mut Stated) {
    let n = grid.len();
    let mut stops: Vec<(usize, Option<Point>)> = out.fixed.iter().map(|&(k, p)| (k, Some(p))).collect();
    if stops.first().is_none_or(|s| s.0 != 0) {
        stops.insert(0, (0, None));
    }
    let begin = stops[0].1;
    stops.push((n, begin));
    for pair in stops.windows(2) {
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        let between = |g: Point| vec![(to, g), (from, -g)];
        let (low, known) = match (a, b) {
            (Some(a), Some(b)) => (b - a, true),
            // Around, from and to the same vertex.
            (None, None) => (Point::default(), true),
            _ => (Point::default(), false),
        };
        if known && to == from + 1 && grid.headings[from].len() == 1 {
            let along = grid.unit(grid.headings[from][0]);
            out.rows.push(GridRow {
                length: vec![(from, 1.0)],
                low: along.dot(low),
                equal: true,
                ..GridRow::default()
            });
            continue;
        }
        for g in [Point::new(1.0, 0.0), Point::new(0.0, 1.0)] {
            let row = match (known, a, b) {
                (true, ..) => GridRow { at: between(g), low: g.dot(low), ..GridRow::default() },
                (false, None, Some(b)) => GridRow { at: vec![(to, g)], low: g.dot(b), ..GridRow::default() },
                (false, Some(_), _) | (false, None, None) => {
                    GridRow { at: vec![(n, g), (0, -g)], low: 0.0, ..GridRow::default() }
                }
            };
            out.rows.push(GridRow { equal: true, ..row });
        }
    }
}

fn linear(terms: &[(usize, f64)], grid: &Grid, problem: &Problem) -> Option<GridRow> {
    let n = grid.len();
    let mut row = GridRow::default();
    let mut pulls = vec![Point::default(); n];
    for &(variable, factor) in terms {
        let (v, k) = (variable / 3, grid.stage(variable / 3));
        if variable == x(v) {
            pulls[k].x += factor;
        } else if variable == y(v) {
            pulls[k].y += factor;
        } else if variable == radius(v) {
            row.radius.push((k, factor));
        }
    }
    let moved: Vec<usize> = (0..n).filter(|&k| pulls[k] != Point::default()).collect();
    // The two ends of a section of known heading against each other: its length, or nothing at all.
    if let [a, b] = moved[..] {
        let from = if (a + 1) % n == b { a } else { b };
        let to = (from + 1) % n;
        let opposite = (pulls[from] + pulls[to]).norm() < 1e-12 && (to == a || to == b);
        if opposite && grid.headings[from].len() == 1 && problem.rotations.contains(&grid.vertex(from)) {
            let along = grid.unit(grid.headings[from][0]).dot(pulls[to]);
            if along.abs() < 1e-9 && row.radius.is_empty() {
                return None;
            }
            if (along.abs() - pulls[to].norm()).abs() < 1e-12 {
                row.length.push((from, along));
                return Some(row);
            }
        }
    }
    row.at = moved.into_iter().map(|k| (k, pulls[k])).collect();
    Some(row)
}

/// A formula as a row and a constant, if it is linear once headings are chosen.
fn formula(f: &Formula, grid: &Grid) -> Option<(GridRow, f64)> {
    let at = |i: &usize, g| GridRow { at: vec![(grid.stage(*i), g)], ..GridRow::default() };
    let row = match f {
        Formula::Constant(value) => return Some((GridRow::default(), *value)),
        Formula::X(i) => at(i, Point::new(1.0, 0.0)),
        Formula::Y(i) => at(i, Point::new(0.0, 1.0)),
        Formula::Radius(i) => GridRow { radius: vec![(grid.stage(*i), 1.0)], ..GridRow::default() },
        Formula::Length(Target { from, straight: false }) => {
            GridRow { length: vec![(grid.stage(*from), 1.0)], ..GridRow::default() }
        }
        Formula::Length(Target { from, straight: true }) => {
            GridRow { straight: vec![(grid.stage(*from), 1.0)], ..GridRow::default() }
        }
        Formula::Sum(terms) => {
            let mut sum = (GridRow::default(), 0.0);
            for term in terms {
                let (row, constant) = formula(term, grid)?;
                sum.0.add(row, 1.0);
                sum.1 += constant;
            }
            return Some(sum);
        }
        Formula::Negative(f) => {
            let (row, constant) = formula(f, grid)?;
            return Some((row.negated(0.0), -constant));
        }
        Formula::Product(terms) => {
            let constant = |t: &Formula| if let Formula::Constant(c) = t { Some(*c) } else { None };
            let factor: f64 = terms.iter().filter_map(constant).product();
            let mut others = terms.iter().filter(|t| constant(t).is_none());
            let (Some(other), None) = (others.next(), others.next()) else { return None };
            let (row, constant) = formula(other, grid)?;
            let mut scaled = GridRow::default();
            scaled.add(row, factor);
            return Some((scaled, constant * factor));
        }
        _ => return None,
    };
    Some((row, 0.0))
}
