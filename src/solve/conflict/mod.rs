//! Why no layout meets the constraints, and which of them say nothing: answers in lines of source.
//!
//! Solvers here are local, so each statement says what stands behind it. A set of lines is in conflict when no layout
//! that meets it was found from any start, or when a relaxation [proves](proof) that there is none. Whatever is said of
//! a single line has a layout behind it that was checked: without the line, and with the line given way by the stated
//! amount. A line follows from others when the solver cannot break it from any start.

mod grid;
mod implied;
mod lines;
mod proof;
mod search;
mod words;

pub use grid::conflicts as grid;
pub use implied::implied;
pub use lines::LineKind;
pub use words::diagnostic as said;

use crate::geometry::clearance::lateral_offset;
use crate::geometry::{Corner, Track};
use crate::model::{ConstraintKind, Layout, Side, Unit};
use crate::problem::measures::{to_corners, to_variables};
use crate::problem::{LEVER, Problem, Scope};
use crate::solve::sqp::Solution;
use crate::solve::violations::off_grid;
use crate::solve::{Stage, discrete};
use crate::source::Span;
use lines::{Lines, Role, SourceLine};
use search::{Core, Search, Set, only};

/// Conflicts that are named, at most: lines of one may be in others, too.
const MOST: usize = 3;
/// Vertices of a layout whose lines are asked how far they give way on the grid, at most: a solve takes about the cube
/// of them, and there are over a hundred for each line.
const MOST_ON_GRID: usize = 24;

/// Lines that cannot hold together, with what was confirmed of them.
#[derive(Clone, Debug)]
pub struct Conflict {
    /// In the order of the source. None where no layout of these vertices is within what the catalogue offers.
    pub members: Vec<Member>,
    /// All members together, each giving way by as much; the layout meets the members only.
    pub together: Option<Relaxed>,
    pub proof: Proof,
    /// From how many starts a layout was looked for.
    pub starts: usize,
    /// Whether it is the catalogue's grid that no layout is found on.
    pub on_grid: bool,
    /// Of the layout's first vertex.
    pub span: Span,
}

/// What stands behind a conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// A relaxation for every range of headings has no solution.
    Bounds,
    /// The search over the grid has left nothing out.
    Grid,
    /// The same, of the whole layout; not of these lines alone.
    GridOfAll,
    /// Nothing but that no layout was found.
    NotFound,
}

/// A line of a conflict.
#[derive(Clone, Debug)]
pub struct Member {
    pub kind: LineKind,
    pub span: Span,
    /// The side that an obstacle is taken to lie on.
    pub assumed: Option<Assumed>,
    /// Whether the line sets a lower limit, where it sets one only.
    pub lower: Option<bool>,
    /// Of room for equipment of which there are several.
    pub pieces: Option<Pieces>,
    /// What `without` and `relaxed` were checked against.
    pub within: Within,
    /// A layout that meets all but this line.
    pub without: Option<Vec<Corner>>,
    /// A layout with this line given way.
    pub relaxed: Option<Relaxed>,
    /// The same on the catalogue's grid, where a layout was looked for on it.
    pub on_grid: Option<Relaxed>,
}

/// Equipment that a line asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pieces {
    pub count: usize,
    /// From one to the next where they stand closest, m.
    pub pitch: f64,
}

/// The side that an obstacle is taken to lie on, and what says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumed {
    /// Of the obstacle.
    pub name: String,
    pub side: Side,
    pub by: Decides,
    /// m
    pub clearance: f64,
}

/// What decides on which side an obstacle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decides {
    Pass,
    Written,
    /// `pass ... either`: the other side was tried, too.
    Neither,
}

/// The lines that a layout meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Within {
    /// All others of the source.
    Layout,
    /// The others of the conflict: the layout has a further one.
    Members,
}

/// What giving way comes to.
#[derive(Clone, Debug)]
pub struct Relaxed {
    /// Rounded up; m or what the line measures, angles in rad.
    pub amount: f64,
    pub text: String,
    /// A layout with the limits moved by as much.
    pub corners: Vec<Corner>,
}

/// Why a stage found no layout: smallest sets of lines that no layout was found for. None where they are not found.
pub fn conflicts(layout: &Layout, failed: &Stage) -> Vec<Conflict> {
    let open: Vec<Span> = layout.obstacles.iter().filter(|o| o.side == Side::Either).map(|o| o.span).collect();
    let layout = &decided(layout, failed);
    let problem = Problem::new(layout, Scope::Obstacles);
    let lines = Lines::new(layout, &problem);
    let search = Search::thorough(layout, &problem, &lines, &to_variables(&failed.corners));
    let all: Set = (0..lines.list.len()).collect();
    // Stage 1 knows no obstacles, so it fails without any.
    let obstacle = |i: &usize| lines.list[*i].kind == LineKind::Obstacle;
    let first: Set = all.iter().copied().filter(|i| failed.name != "stage1" || !obstacle(i)).collect();
    let mut cores: Vec<(Core, Vec<Member>)> = Vec::new();
    let mut next = vec![first];
    while let Some(within) = next.pop() {
        let Some(core) = search.conflict(&within) else { continue };
        if cores.iter().any(|(known, _)| known.set == core.set) {
            continue;
        }
        let examiner = Examiner { layout, lines: &lines, search: &search, all: &all, open: &open };
        let members: Vec<Member> = core.set.iter().map(|&line| examiner.member(&core, line)).collect();
        // Without a member something else is in conflict.
        if let Some((&line, _)) = core.set.iter().zip(&members).find(|(_, m)| m.within == Within::Members) {
            let others = all.iter().copied().filter(|&i| i != line).collect();
            next.push(others);
        }
        cores.push((core, members));
        if cores.len() >= MOST {
            break;
        }
    }
    // A layout that was found on the way may meet them all the same.
    cores.retain(|(core, _)| search.layout(&core.set).is_none());
    let mut found: Vec<Conflict> =
        cores.into_iter().map(|(core, members)| conclude(layout, &lines, &search, &core.set, members)).collect();
    found.sort_by_key(|conflict| conflict.members.first().map(|m| (m.span.file.0, m.span.start)));
    found
}

/// A start for a stage that found no layout, from a wider search; `None` where that finds none either.
pub fn another_start(layout: &Layout, scope: Scope, failed: &[f64]) -> Option<Vec<f64>> {
    let problem = Problem::new(layout, scope);
    let lines = Lines::new(layout, &problem);
    let search = Search::thorough(layout, &problem, &lines, failed);
    search.layout(&(0..lines.list.len()).collect())
}

/// The layout with a side for every obstacle: where that is left open, the one that the failed layout has.
fn decided(layout: &Layout, failed: &Stage) -> Layout {
    let mut layout = layout.clone();
    let track = Track::new(&failed.corners);
    for obstacle in layout.obstacles.iter_mut().filter(|o| o.side == Side::Either) {
        let offset = obstacle.polygon.points().first().and_then(|&p| lateral_offset(&track, p));
        obstacle.side = if offset.is_some_and(|left| left < 0.0) { Side::Right } else { Side::Left };
    }
    layout
}

fn conclude(layout: &Layout, lines: &Lines, search: &Search, set: &Set, mut members: Vec<Member>) -> Conflict {
    let least = search.alike(set);
    let together = least.and_then(|l| confirm(search, Unit::Metre, l.amount, &l.at, &only(set, Role::Gives)));
    let proven = proof::infeasible(&lines.given_way(0.0, only(set, Role::Holds)));
    members.sort_by_key(|m| (m.span.file.0, m.span.start));
    Conflict {
        members,
        together,
        proof: if proven { Proof::Bounds } else { Proof::NotFound },
        starts: search.starts(),
        on_grid: false,
        span: layout.vertices.first().map_or(layout.span, |v| v.span),
    }
}

/// Confirms what is said of a conflict's lines.
struct Examiner<'a> {
    layout: &'a Layout,
    lines: &'a Lines,
    search: &'a Search<'a>,
    all: &'a Set,
    /// Obstacles whose side is left open.
    open: &'a [Span],
}

impl Examiner<'_> {
    fn member(&self, core: &Core, line: usize) -> Member {
        let without = |set: &Set| -> Set { set.iter().copied().filter(|&i| i != line).collect() };
        let mut others = without(self.all);
        let mut layout = self.search.layout(&others);
        let within = if layout.is_some() { Within::Layout } else { Within::Members };
        if layout.is_none() {
            others = without(&core.set);
            layout = core.without.get(&line).cloned();
        }
        let relaxed = layout.as_deref().and_then(|near| self.relaxed(line, &others, near));
        let on_grid = relaxed.as_ref().and_then(|relaxed| self.relaxed_on_grid(line, &others, &relaxed.corners));
        // The least amount is a local optimum; a layout on the grid is one off it, too.
        let relaxed = relaxed.into_iter().chain(on_grid.clone()).min_by(|a, b| a.amount.total_cmp(&b.amount));
        Member { on_grid, ..self.told(line, within, layout.map(|x| to_corners(&x)), relaxed) }
    }

    fn told(&self, line: usize, within: Within, without: Option<Vec<Corner>>, relaxed: Option<Relaxed>) -> Member {
        let stated = &self.lines.list[line];
        Member {
            kind: stated.kind,
            span: stated.span,
            assumed: self.assumed(stated),
            lower: match stated.rows[..] {
                [row] => Some(self.lines.row(row).low.is_finite()),
                _ => None,
            },
            pieces: self.pieces(stated),
            within,
            without,
            relaxed,
            on_grid: None,
        }
    }

    /// How far a line must give way for the others to hold.
    fn relaxed(&self, line: usize, others: &Set, near: &[f64]) -> Option<Relaxed> {
        let role = |i: usize| match others.contains(&i) {
            _ if i == line => Role::Gives,
            true => Role::Holds,
            false => Role::Left,
        };
        let least = self.search.minimum_near(&self.lines.problem(role), near)?;
        confirm(self.search, unit(self.layout, &self.lines.list[line]), least.amount, &least.at, &role)
    }

    /// How far a line must give way for the others to hold on the catalogue's grid: what giving way costs is minimised
    /// there as length is otherwise. `None` where that finds no layout, or where the line's limits are the grid's own.
    fn relaxed_on_grid(&self, line: usize, others: &Set, near: &[Corner]) -> Option<Relaxed> {
        let stated = &self.lines.list[line];
        let limits = matches!(stated.kind, LineKind::Turns | LineKind::Radii);
        if limits || near.len() > MOST_ON_GRID {
            return None;
        }
        let role = |i: usize| match others.contains(&i) {
            _ if i == line => Role::Gives,
            true => Role::Holds,
            false => Role::Left,
        };
        let elastic = self.lines.problem(role);
        let settings = search::settings();
        let start = Solution::at(&elastic, &search::slacken(&elastic, &to_variables(near)).0);
        let found = discrete::discretise(self.layout, &elastic, &start, &settings);
        let mut x = found.variables;
        x.pop();
        let relaxed = grid::confirm_held(self, line, found.length, &x, role)?;
        let problem = Problem::new(self.layout, Scope::Obstacles);
        let on_grid = off_grid(self.layout, &problem, &to_variables(&relaxed.corners), settings.feasibility).is_empty();
        on_grid.then_some(relaxed)
    }

    fn pieces(&self, line: &SourceLine) -> Option<Pieces> {
        let mut declared = self.layout.equipment.declared.iter();
        let own = declared.find(|d| line.kind == LineKind::Room && d.span == line.span && d.count() > 1)?;
        Some(Pieces { count: own.count(), pitch: own.of.stretch + own.of.service })
    }

    fn assumed(&self, line: &SourceLine) -> Option<Assumed> {
        let obstacle = self.layout.obstacles.iter().find(|o| line.kind == LineKind::Obstacle && o.span == line.span)?;
        let by = match obstacle.pass {
            _ if self.open.contains(&obstacle.span) => Decides::Neither,
            Some(_) => Decides::Pass,
            None => Decides::Written,
        };
        Some(Assumed { name: obstacle.name.clone(), side: obstacle.side, by, clearance: obstacle.clearance })
    }
}

/// An amount rounded up until a layout with the limits moved by as much is found.
fn confirm(search: &Search, unit: Unit, amount: f64, near: &[f64], role: &impl Fn(usize) -> Role) -> Option<Relaxed> {
    (0..3).find_map(|more| {
        let stated = words::stated(unit, amount, more);
        let x = search.given_way(role, stated.slack, near)?;
        let amount = if unit == Unit::Radian { stated.slack / LEVER } else { stated.slack };
        Some(Relaxed { amount, text: stated.text, corners: to_corners(&x) })
    })
}

/// What a line's limits are in.
fn unit(layout: &Layout, line: &SourceLine) -> Unit {
    let written = layout.constraints.iter().find(|c| c.span == line.span).map(|c| &c.kind);
    match (line.kind, written) {
        (LineKind::Turns, _) => Unit::Radian,
        (LineKind::Require, Some(ConstraintKind::Require { unit, .. })) => *unit,
        _ => Unit::Metre,
    }
}
