//! The least amount by which lines must give way, and the smallest set of lines that cannot hold together.
//!
//! The elastic filter (Chinneck and Dravnieks 1991) gives a small set at once: where giving way is at its minimum, the
//! rows with a multiplier contradict each other by themselves. The deletion filter (Chinneck 2008, §6.2) then leaves a
//! line out for good where the others cannot hold without it either; the set that is left is irreducible, and every line
//! of it was left out once with a layout that meets the rest.

use super::lines::{Lines, Role};
use crate::model::Layout;
use crate::problem::{LEVER, Problem, RowKey, RowValue};
use crate::solve::perturbed;
use crate::solve::sqp::{self, Settings, Solution};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// Limits that give way by less than this hold, m.
pub const HOLDS: f64 = 1e-6;
/// Iterations of one solve, and solves of one search.
const ITERATIONS: usize = 120;
const SOLVES: usize = 400;
/// A row with a multiplier below this is no reason; the multipliers of elastic rows add up to 1.
const NO_WEIGHT: f64 = 1e-4;
/// Rough starts beside the written and the failed layout: noise (m) and seeds.
const NOISE: f64 = 1.0;
const SEEDS: [u64; 2] = [1, 2];

/// Solves for the least giving way, from several starts.
pub struct Search<'a> {
    pub lines: &'a Lines,
    starts: Vec<Vec<f64>>,
    solves: Cell<usize>,
}

/// A layout for which limits give way as little as was found.
#[derive(Clone, Debug)]
pub struct Least {
    /// m, angles by [`LEVER`](crate::problem::LEVER).
    pub amount: f64,
    /// The problem's variables there.
    pub at: Vec<f64>,
    /// The rows that forbid less.
    pub against: Vec<RowKey>,
}

/// Lines that cannot hold together.
#[derive(Clone, Debug)]
pub struct Conflict {
    /// Indices into [`Lines::list`].
    pub set: Vec<usize>,
    /// How far all of them must give way alike, m.
    pub apart: f64,
    /// How far each must give way while the others hold, m; `None` where none was found that does.
    pub alone: Vec<Option<f64>>,
    /// Whether a layout was found for every set that one of them is missing from.
    pub confirmed: bool,
}

impl<'a> Search<'a> {
    /// `found` is the least infeasible layout so far.
    pub fn new(layout: &Layout, problem: &Problem, lines: &'a Lines, found: &[f64]) -> Self {
        let rough = SEEDS.map(|seed| perturbed(layout, problem, NOISE, seed));
        let starts = [found.to_vec(), problem.start.clone()].into_iter().chain(rough).collect();
        Search { lines, starts, solves: Cell::new(0) }
    }

    /// The least amount by which a problem's elastic limits give way. Stops at the first start from which `enough` is
    /// reached, or where two starts end alike. `None` where the other rows are met from no start, or out of solves.
    pub fn minimum(&self, problem: &Problem, enough: f64) -> Option<Least> {
        let mut best: Option<Solution> = None;
        for start in &self.starts {
            if self.solves.get() >= SOLVES {
                return None;
            }
            self.solves.set(self.solves.get() + 1);
            let solution = give_way(problem, start);
            if solution.max_violation > HOLDS {
                continue;
            }
            let alike = |known: &Solution| (known.length - solution.length).abs() <= HOLDS;
            let settled = solution.length <= enough || best.as_ref().is_some_and(alike);
            if best.as_ref().is_none_or(|known| solution.length < known.length) {
                best = Some(solution);
            }
            if settled {
                break;
            }
        }
        best.map(|mut solution| {
            solution.variables.pop();
            let weighs = |m: &f64| m.abs() > NO_WEIGHT;
            let against = solution.multipliers.iter().filter(|(_, m)| weighs(m)).map(|(key, _)| *key).collect();
            Least { amount: solution.length, at: solution.variables, against }
        })
    }

    /// The same beginning at a layout that meets the other rows: what the limits give way by there is enough in any case.
    fn minimum_near(&self, problem: &Problem, witness: &[f64]) -> Option<f64> {
        let (x, slack) = slacken(problem, witness);
        let meets = problem.evaluate(&x, 0.0).rows.iter().all(|row| row.violation() <= HOLDS);
        let near = give_way(problem, witness);
        let near = (near.max_violation <= HOLDS).then_some(near.length);
        let far = self.minimum(problem, HOLDS).map(|least| least.amount);
        let known = meets.then_some(slack);
        [known, near, far].into_iter().flatten().min_by(f64::total_cmp)
    }

    /// The layout that the search was given.
    pub fn found(&self) -> &[f64] {
        &self.starts[0]
    }

    /// The lines that rows belong to.
    pub fn owners(&self, keys: &[RowKey]) -> BTreeSet<usize> {
        keys.iter().filter_map(|&key| self.lines.owner(key)).collect()
    }

    /// Whether these rows are linear, as far as their second derivatives at the starts tell.
    pub fn linear(&self, problem: &Problem, keys: &[RowKey]) -> bool {
        self.starts.iter().all(|start| {
            let mut x = start.clone();
            x.push(0.0);
            let here = problem.evaluate(&x, 0.0);
            let straight = |key: &RowKey| {
                let row = here.rows.iter().find(|row| row.key == *key);
                row.is_some_and(|row| row.expansion.hessian.iter().all(|second| *second == 0.0))
            };
            keys.iter().all(straight)
        })
    }

    /// Lets all lines of a set give way alike, others left out.
    fn alike(&self, set: &BTreeSet<usize>) -> Option<Least> {
        let role = |i: usize| if set.contains(&i) { Role::Gives } else { Role::Left };
        self.minimum(&self.lines.problem(role), HOLDS)
    }

    /// The smallest set of lines in conflict; `None` where all of them can hold, or no answer was found.
    pub fn conflict(&self) -> Option<Conflict> {
        let all: BTreeSet<usize> = (0..self.lines.list.len()).collect();
        let holds = |least: &Least| least.amount <= HOLDS;
        let mut least = self.alike(&all).filter(|least| !holds(least))?;
        let mut set = all;
        let core = self.owners(&least.against);
        if let Some(apart) = self.alike(&core).filter(|least| !core.is_empty() && !holds(least)) {
            (set, least) = (core, apart);
        }
        // Limits of the catalogue and the building come first in the list, so a user's own words stay if they can. A
        // layout that meets all but one line of a set is a start for letting that line alone give way.
        let mut witnesses = BTreeMap::new();
        for line in set.clone() {
            let mut without = set.clone();
            without.remove(&line);
            match self.alike(&without) {
                Some(apart) if !holds(&apart) && !without.is_empty() => (set, least) = (without, apart),
                Some(witness) => {
                    witnesses.insert(line, witness.at);
                }
                None => {}
            }
        }
        let alone = set.iter().map(|&line| {
            let role = |i: usize| match set.contains(&i) {
                true if i == line => Role::Gives,
                true => Role::Holds,
                false => Role::Left,
            };
            self.minimum_near(&self.lines.problem(role), witnesses.get(&line)?)
        });
        let alone = alone.collect();
        let confirmed = set.iter().all(|line| witnesses.contains_key(line));
        Some(Conflict { set: set.into_iter().collect(), apart: least.amount, alone, confirmed })
    }
}

/// A start with a slack that every elastic row holds with; the other rows may not.
fn slacken(problem: &Problem, start: &[f64]) -> (Vec<f64>, f64) {
    let mut x = start.to_vec();
    x.push(0.0);
    let needs = |row: &RowValue| row.violation() * if problem.unit(row.key) == "rad" { LEVER } else { 1.0 };
    let slack = problem.evaluate(&x, 0.0).rows.iter().map(needs).fold(0.0, f64::max);
    if let Some(last) = x.last_mut() {
        *last = slack;
    }
    (x, slack)
}

fn give_way(problem: &Problem, start: &[f64]) -> Solution {
    // Short steps: a long one may take the track across itself or an obstacle, where rows no longer lead back.
    let settings = Settings { iterations: ITERATIONS, radius: 0.5, largest_radius: 1.0, ..Settings::default() };
    sqp::minimise(problem, &slacken(problem, start).0, &settings, &|_, _, _| {})
}
