//! Constraints that follow from the other lines.
//!
//! A constraint follows from others when they alone keep it: with it taken away, nothing that meets the rest breaks it
//! by any amount. For every limit of a line the solver is asked to break it by a little while the rest holds; the line
//! is reported when no limit gives at all from any start, and the lines whose rows resist are what it follows from.
//! Where a problem is not convex a search that gets stuck proves little, so a line is reported only where it and all
//! that resists are equations, whose gradients are then dependent, or linear, which makes the answer exact.

use super::lines::{LineKind, Lines, Role};
use super::search::Search;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::Layout;
use crate::problem::measures::to_variables;
use crate::problem::{Problem, RowKey, RowValue, Scope};
use crate::solve::Stage;
use crate::solve::null_space::null_space;
use nalgebra::DVector;
use std::collections::BTreeSet;

/// By how much a limit is to be broken, m, and what of it may remain, relative.
const BREACH: f64 = 0.01;
const STUCK: f64 = 1e-3;
/// Share of a gradient that others may leave unexplained.
const DEPENDENT: f64 = 1e-6;

/// A warning for each constraint that follows from others, as written. None where nothing was optimised.
pub fn implied(layout: &Layout, stages: &[Stage]) -> Vec<Diagnostic> {
    let Some(solved) = stages.iter().rfind(|stage| matches!(stage.name, "stage1" | "stage2")) else {
        return Vec::new();
    };
    let problem = Problem::new(layout, Scope::Building);
    let lines = Lines::new(layout, &problem);
    let search = Search::new(layout, &problem, &lines, &to_variables(&solved.corners));
    let mut gone = BTreeSet::new();
    let mut said = Vec::new();
    // Of two lines that say the same, the later one is reported; it is then no reason for the other.
    let user = |i: &usize| matches!(lines.list[*i].kind, LineKind::Fix | LineKind::Require);
    let mut order: Vec<usize> = (0..lines.list.len()).filter(user).collect();
    order.sort_by_key(|&i| std::cmp::Reverse((lines.list[i].span.file.0, lines.list[i].span.start)));
    for i in order {
        let Some(reasons) = follows(&search, i, &gone) else { continue };
        gone.insert(i);
        let mut diagnostic =
            Diagnostic::new(Code::W0705, "this follows from other lines", lines.list[i].span, "says nothing new");
        for &reason in &reasons {
            diagnostic = diagnostic.related(lines.list[reason].span, "with this, it holds already");
        }
        said.push(diagnostic.help("remove it, or one of the lines that it follows from"));
    }
    said.reverse();
    said
}

/// The lines that a line follows from, if it does: as few as will do.
fn follows(search: &Search, line: usize, gone: &BTreeSet<usize>) -> Option<BTreeSet<usize>> {
    let others = |i: &usize| *i != line && !gone.contains(i);
    let mut reasons: BTreeSet<usize> = (0..search.lines.list.len()).filter(others).collect();
    // Most lines end here, without a solve.
    let alone = |&limit: &usize| {
        let problem = search.lines.broken(limit, BREACH, |_| Role::Holds);
        let found = Resistance { problem, limit, at: search.found().to_vec(), rows: Vec::new() };
        !depends(search, &found, &reasons)
    };
    if search.lines.list[line].rows.iter().any(alone) {
        return None;
    }
    let owners = |resistance: &[Resistance]| {
        let mut all: BTreeSet<usize> = resistance.iter().flat_map(|r| search.owners(&r.rows)).collect();
        all.remove(&line);
        all
    };
    let core = owners(&resistance(search, line, &reasons)?);
    if resistance(search, line, &core).is_some() {
        reasons = core;
    }
    for reason in reasons.clone() {
        let mut without = reasons.clone();
        without.remove(&reason);
        if resistance(search, line, &without).is_some() {
            reasons = without;
        }
    }
    let proven = |r: &Resistance| depends(search, r, &reasons);
    (!reasons.is_empty() && resistance(search, line, &reasons)?.iter().all(proven)).then_some(reasons)
}

/// What keeps a limit from being broken.
struct Resistance {
    problem: Problem,
    limit: usize,
    at: Vec<f64>,
    rows: Vec<RowKey>,
}

/// What keeps each limit of a line from being broken while a set of lines holds; `None` if one of them can be.
fn resistance(search: &Search, line: usize, holding: &BTreeSet<usize>) -> Option<Vec<Resistance>> {
    let enough = BREACH * (1.0 - STUCK);
    let resists = |&row: &usize| {
        let role = |i: usize| if holding.contains(&i) { Role::Holds } else { Role::Left };
        let problem = search.lines.broken(row, BREACH, role);
        let least = search.minimum(&problem, enough).filter(|least| least.amount > enough)?;
        Some(Resistance { problem, limit: row, at: least.at, rows: least.against })
    };
    search.lines.list[line].rows.iter().map(resists).collect()
}

/// Whether a limit's gradient is made of those of equations among the reasons, so that they leave it no choice; or, if
/// it is linear, of those of linear rows.
fn depends(search: &Search, resistance: &Resistance, reasons: &BTreeSet<usize>) -> bool {
    let (lines, problem) = (search.lines, &resistance.problem);
    let mut x = resistance.at.clone();
    x.push(0.0);
    let vertices = resistance.at.len();
    let here = problem.evaluate(&x, 0.0);
    let gradient = |row: &RowValue| {
        let mut gradient = DVector::zeros(vertices);
        let entries = row.expansion.variables.iter().zip(&row.expansion.gradient);
        entries.filter(|(k, _)| **k < vertices).for_each(|(&k, &g)| gradient[k] = g);
        gradient
    };
    let linear = |row: &RowValue| search.linear(problem, &[row.key]);
    let Some(limit) = here.rows.iter().find(|row| row.key == RowKey::Listed(resistance.limit)) else { return false };
    let made_of = |takes: &dyn Fn(usize, &RowValue) -> bool| {
        let owned = |row: &&RowValue| {
            let owner = lines.owner(row.key).filter(|owner| reasons.contains(owner));
            owner.is_some_and(|owner| takes(owner, row))
        };
        let free = null_space(vertices, here.rows.iter().filter(owned).map(gradient));
        let target = gradient(limit);
        free.iter().all(|direction| direction.dot(&target).abs() <= DEPENDENT * target.norm())
    };
    made_of(&|owner, _| lines.is_equality(owner)) || linear(limit) && made_of(&|_, row| linear(row))
}
