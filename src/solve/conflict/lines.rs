//! A problem's limits by the line of source that sets them, each of which can be left out or made to give way. What the
//! catalogue offers always holds, and so do the track's own width and the order of tangent points.

use crate::geometry::{Point, Polygon};
use crate::model::{Constraint, ConstraintKind, FixKind, Interval, Layout, Unit};
use crate::problem::measures::{radius, x, y};
use crate::problem::{ConstraintRow, Elastic, Function, LEVER, Problem, RowKey};
use crate::source::Span;

/// What kind of statement a line is, which decides how a message speaks of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineKind {
    /// Limits of turns or radii that the layout narrows.
    Turns,
    Radii,
    Building,
    Obstacle,
    /// Room for equipment on a straight.
    Room,
    Fix,
    Require,
}

/// A statement, with the limits it sets.
#[derive(Clone, Debug)]
pub struct SourceLine {
    pub kind: LineKind,
    pub span: Span,
    pub rows: Vec<usize>,
    pub keepouts: Vec<usize>,
}

/// A problem with every limit a user can change in a row of one side, and what line it is from.
#[derive(Clone, Debug)]
pub struct Lines {
    /// Ordered by kind, then as written.
    pub list: Vec<SourceLine>,
    problem: Problem,
    /// Sections whose heading a line holds.
    headings: Vec<(Span, usize)>,
}

/// What becomes of a line in a problem made from some of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Left,
    Holds,
    Gives,
}

impl Lines {
    pub fn new(layout: &Layout, problem: &Problem) -> Self {
        let mut lines = Lines { list: Vec::new(), problem: problem.clone(), headings: headings(layout) };
        let n = problem.vertices.len();
        let user = |span: Span| layout.constraints.iter().find(|c| c.span == span);
        let offered = &layout.catalog.curve;
        for i in 0..problem.rows.len() {
            let (kind, span) = match user(problem.rows[i].span) {
                Some(c) if i >= 2 * n => (kind_of(&c.kind), c.span),
                _ if i < n && layout.turns.value != offered.turns => {
                    let mut any = problem.rows[i].clone();
                    (any.low, any.high) = (offered.turns.low, offered.turns.high);
                    lines.problem.rows.push(any);
                    (LineKind::Turns, layout.turns.span)
                }
                _ if i < 2 * n => continue,
                _ => (LineKind::Room, problem.rows[i].span),
            };
            lines.limit(kind, span, i);
        }
        lines.free_fixed(layout, problem);
        let range = |edge: Option<&f64>, or: f64| edge.copied().unwrap_or(or);
        for i in 0..n {
            let bound = problem.bounds[radius(i)];
            let (low, high) = (range(offered.radii.first(), bound.low), range(offered.radii.last(), bound.high));
            // A radius that the layout fixes may be one that the catalogue lacks.
            lines.problem.bounds[radius(i)] = Interval { low: low.min(bound.low), high: high.max(bound.high) };
            if bound.low < bound.high && (bound.low > low || bound.high < high) {
                let label = format!("radius at {}", problem.vertices[i]);
                let row = lines.variable(radius(i), bound.low, bound.high, label, layout.radii.span);
                lines.limit(LineKind::Radii, layout.radii.span, row);
            }
        }
        for (k, keepout) in problem.keepouts.iter().enumerate() {
            let kind = if keepout.region.outside { LineKind::Building } else { LineKind::Obstacle };
            lines.line(kind, keepout.span).keepouts.push(k);
        }
        let slack = Interval { low: 0.0, high: f64::INFINITY };
        lines.problem.bounds.push(slack);
        lines.problem.start.push(0.0);
        lines.list.sort_by_key(|line| (line.kind, line.span.file.0, line.span.start));
        lines
    }

    /// Coordinates and radii that a statement fixes become rows.
    fn free_fixed(&mut self, layout: &Layout, problem: &Problem) {
        for constraint in &layout.constraints {
            let fixed = match &constraint.kind {
                ConstraintKind::FixVertex { vertex } => vec![x(*vertex), y(*vertex)],
                ConstraintKind::FixRadius { vertex } => vec![radius(*vertex)],
                ConstraintKind::FixSection { target, kinds } if !target.straight && kinds.len() == 4 => {
                    let next = layout.next(target.from);
                    vec![x(target.from), y(target.from), x(next), y(next)]
                }
                _ => continue,
            };
            for k in fixed {
                let value = problem.start[k];
                let label = format!("fix {}", problem.variable_name(k));
                let row = self.variable(k, value, value, label, constraint.span);
                self.limit(LineKind::Fix, constraint.span, row);
                let bound = &mut self.problem.bounds[k];
                (bound.low, bound.high) = (f64::NEG_INFINITY, f64::INFINITY);
            }
        }
    }

    fn variable(&mut self, k: usize, low: f64, high: f64, label: String, span: Span) -> usize {
        let function = Function::Linear(vec![(k, 1.0)]);
        self.problem.rows.push(ConstraintRow::hard(function, (low, high), label, span));
        self.problem.rows.len() - 1
    }

    fn line(&mut self, kind: LineKind, span: Span) -> &mut SourceLine {
        let at = match self.list.iter().position(|l| l.span == span && l.kind == kind) {
            Some(at) => at,
            None => {
                self.list.push(SourceLine { kind, span, rows: Vec::new(), keepouts: Vec::new() });
                self.list.len() - 1
            }
        };
        &mut self.list[at]
    }

    /// Gives a row to its line; one with two limits is split.
    fn limit(&mut self, kind: LineKind, span: Span, row: usize) {
        let (low, high) = (self.problem.rows[row].low, self.problem.rows[row].high);
        self.line(kind, span).rows.push(row);
        if low.is_finite() && high.is_finite() {
            let mut upper = self.problem.rows[row].clone();
            upper.low = f64::NEG_INFINITY;
            self.problem.rows[row].high = f64::INFINITY;
            self.problem.rows.push(upper);
            let row = self.problem.rows.len() - 1;
            self.line(kind, span).rows.push(row);
        }
    }

    /// A line's row, of whose limits one is infinite.
    pub fn row(&self, row: usize) -> &ConstraintRow {
        &self.problem.rows[row]
    }

    /// The written variables, with no limit on those that a statement fixes: for starts that move them.
    pub fn unfixed(&self, problem: &Problem) -> Problem {
        let bounds = self.problem.bounds[..problem.bounds.len()].to_vec();
        Problem { bounds, ..problem.clone() }
    }

    /// The line that a row or a region belongs to.
    pub fn owner(&self, key: RowKey) -> Option<usize> {
        self.list.iter().position(|line| match key {
            RowKey::Listed(i) => line.rows.contains(&i),
            RowKey::Clearance(k, ..) => line.keepouts.contains(&k),
            RowKey::Own(..) | RowKey::Gap(..) => false,
        })
    }

    /// Whether a line's rows come in pairs that leave nothing between them.
    pub fn is_equality(&self, line: usize) -> bool {
        let limit = |low: bool| {
            let rows = self.list[line].rows.iter().map(|&row| &self.problem.rows[row]);
            let mut limits: Vec<f64> =
                rows.map(|row| if low { row.low } else { row.high }).filter(|limit| limit.is_finite()).collect();
            limits.sort_by(f64::total_cmp);
            limits
        };
        self.list[line].keepouts.is_empty() && limit(true) == limit(false)
    }

    /// The problem of breaking a limit of a line that is left out by `breach`, as far as the lines that hold let it.
    pub fn broken(&self, row: usize, breach: f64, role: impl Fn(usize) -> Role) -> Problem {
        let mut problem = self.problem(role);
        let own = &self.problem.rows[row];
        let by = if own.unit == Unit::Radian { breach / LEVER } else { breach };
        let broken = &mut problem.rows[row];
        (broken.low, broken.high) = match own.low.is_finite() {
            true => (f64::NEG_INFINITY, own.low - by),
            false => (own.high + by, f64::INFINITY),
        };
        problem.elastic = Some(Elastic { rows: [row].into(), ..Elastic::default() });
        problem
    }

    /// The problem in which the lines that give way do so by a fixed amount (m, angles by [`LEVER`]) while others hold.
    pub fn given_way(&self, amount: f64, role: impl Fn(usize) -> Role) -> Problem {
        let mut problem = self.problem(role);
        let Some(gives) = problem.elastic.take() else { return problem };
        for &row in &gives.rows {
            let row = &mut problem.rows[row];
            let by = if row.unit == Unit::Radian { amount / LEVER } else { amount };
            (row.low, row.high) = (row.low - by, row.high + by);
        }
        for &k in &gives.keepouts {
            let keepout = &mut problem.keepouts[k];
            // Walls move as they are; past a corner of the hall its outline is no measure of how far out the track is.
            let moved = keepout.region.outside.then(|| further_out(&keepout.region.polygon, amount)).flatten();
            match moved {
                Some(polygon) => keepout.region.polygon = polygon,
                None => keepout.distance -= amount,
            }
        }
        if let Some(slack) = problem.bounds.last_mut() {
            (slack.low, slack.high) = (0.0, 0.0);
        }
        problem
    }

    /// The problem of making the lines that give way do so as little as possible while others hold.
    pub fn problem(&self, role: impl Fn(usize) -> Role) -> Problem {
        let mut problem = self.problem.clone();
        let mut elastic = Elastic::default();
        for (i, line) in self.list.iter().enumerate() {
            match role(i) {
                Role::Holds => {}
                Role::Gives => {
                    elastic.rows.extend(&line.rows);
                    elastic.keepouts.extend(&line.keepouts);
                }
                Role::Left => {
                    for &row in &line.rows {
                        (problem.rows[row].low, problem.rows[row].high) = (f64::NEG_INFINITY, f64::INFINITY);
                    }
                    line.keepouts.iter().for_each(|&k| problem.keepouts[k].distance = f64::NEG_INFINITY);
                    problem.rotations.retain(|section| !self.headings.contains(&(line.span, *section)));
                }
            }
        }
        problem.elastic = Some(elastic);
        problem
    }
}

/// A polygon with every edge moved out by as much, m; `None` where it would cross itself.
fn further_out(polygon: &Polygon, by: f64) -> Option<Polygon> {
    let points = polygon.points();
    let n = points.len();
    let along = |i: usize| Point::unit((points[(i + 1) % n] - points[i]).heading());
    let corner = |i: usize| {
        let (before, behind) = (along((i + n - 1) % n), along(i));
        // Both edges' outward normals have a product of `by` with the shift.
        let out = -(before.left() + behind.left());
        points[i] + out * (by / (1.0 + before.dot(behind)))
    };
    Polygon::new((0..n).map(corner).collect()).ok()
}

/// The sections whose heading a statement holds, with its place.
fn headings(layout: &Layout) -> Vec<(Span, usize)> {
    let held = |constraint: &Constraint| match &constraint.kind {
        ConstraintKind::FixSection { target, kinds } if kinds.contains(&FixKind::Rotation) => {
            Some((constraint.span, target.from))
        }
        _ => None,
    };
    layout.constraints.iter().filter_map(held).collect()
}

fn kind_of(constraint: &ConstraintKind) -> LineKind {
    match constraint {
        ConstraintKind::Require { .. } => LineKind::Require,
        _ => LineKind::Fix,
    }
}
