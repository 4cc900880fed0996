//! The least amount by which lines must give way, and smallest sets of lines that cannot hold together.
//!
//! The elastic filter (Chinneck and Dravnieks 1991) gives a small set at once: where giving way is at its minimum, the
//! rows with a multiplier contradict each other by themselves. The deletion filter (Chinneck 2008, §6.2) then leaves a
//! line out for good where no layout was found without it either. Every line that stays was left out once with a layout
//! that meets the rest. Solvers are local, so a layout that turns up later may meet a set that was taken for
//! contradictory: every layout found is kept, and the filter runs again where one of them does.

use super::lines::{Lines, Role};
use crate::geometry::{Fillet, Point, Track};
use crate::model::{Layout, TOLERANCE};
use crate::problem::measures::{radius, to_corners, x, y};
use crate::problem::{Keepout, LEVER, Problem, RowKey, RowValue, perturbed};
use crate::solve::sqp::{self, Solution, SqpSettings};
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

/// Limits that give way by less than this hold, m.
pub const HOLDS: f64 = TOLERANCE;
/// Iterations of one solve.
const ITERATIONS: usize = 120;
/// Solves of one search.
const SOLVES: usize = 400;
/// The same of a thorough one of up to [`SMALL`] vertices. A solve takes about the cube of them, so larger layouts get
/// fewer.
const THOROUGH: usize = 400;
const FEWEST: usize = 6;
const SMALL: usize = 10;
/// A row with a multiplier below this is no reason; the multipliers of elastic rows add up to 1.
const NO_WEIGHT: f64 = 1e-4;
/// Rough starts beside the written and the failed layout: noise (m) and seeds.
const NOISE: f64 = 1.0;
const SEEDS: [u64; 2] = [1, 2];
/// More of them for what is to be confirmed: with nothing fixed, and the written layout scaled about its middle.
const WIDE: [(f64, u64); 2] = [(3.0, 3), (6.0, 4)];
const SCALES: [f64; 2] = [1.5, 0.75];
/// How often the filter begins again.
const ROUNDS: usize = 3;
/// Lines that give way by no more than this nearly hold, m: worth a solve that lets none give way.
const NEARLY: f64 = 0.05;
/// Starts of a set while lines are left out.
const FEW: usize = 4;
/// Of the layouts found, those from which others are tried.
const RECENT: usize = 2;

/// Indices into [`Lines::list`].
pub type Set = BTreeSet<usize>;

/// Solves for the least giving way, from several starts.
pub struct Search<'a> {
    pub lines: &'a Lines,
    starts: Vec<Vec<f64>>,
    /// Layouts that met some lines.
    known: RefCell<Vec<Vec<f64>>>,
    /// Sets for which no start led to a layout.
    unmet: RefCell<BTreeSet<Set>>,
    solves: Cell<usize>,
    most: usize,
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

/// Lines for which no layout was found.
#[derive(Clone, Debug)]
pub struct Core {
    pub set: Set,
    /// By line, a layout that meets the others of the set.
    pub without: BTreeMap<usize, Vec<f64>>,
}

impl<'a> Search<'a> {
    /// `found` is the least infeasible layout so far.
    pub fn new(layout: &Layout, problem: &Problem, lines: &'a Lines, found: &[f64]) -> Self {
        let rough = SEEDS.map(|seed| perturbed(layout, problem, NOISE, seed));
        let starts = [found.to_vec(), problem.start.clone()].into_iter().chain(rough).collect();
        Search {
            lines,
            starts,
            known: RefCell::default(),
            unmet: RefCell::default(),
            solves: Cell::new(0),
            most: SOLVES,
        }
    }

    /// The same from more starts, for what is to be confirmed.
    pub fn thorough(layout: &Layout, problem: &Problem, lines: &'a Lines, found: &[f64]) -> Self {
        let mut search = Search::new(layout, problem, lines, found);
        let n = problem.vertices.len().max(SMALL);
        search.most = (THOROUGH * SMALL * SMALL * SMALL / (n * n * n)).max(FEWEST);
        let unfixed = lines.unfixed(problem);
        search.starts.extend(SCALES.map(|by| scaled(&unfixed, by)));
        search.starts.extend(WIDE.map(|(noise, seed)| perturbed(layout, &unfixed, noise, seed)));
        search
    }

    /// From how many starts a set was tried before it is said that no layout was found; 0 where the solves ran out.
    pub fn starts(&self) -> usize {
        if self.is_spent() { 0 } else { self.starts.len() }
    }

    fn is_spent(&self) -> bool {
        self.solves.get() > self.most
    }

    fn spent(&self) -> bool {
        let solves = self.solves.get();
        self.solves.set(solves + 1);
        solves >= self.most
    }

    /// The least amount by which a problem's elastic limits give way. Stops at the first start from which `enough` is
    /// reached, or where two starts end alike. `None` where the other rows are met from no start, or out of solves.
    pub fn minimum(&self, problem: &Problem, enough: f64) -> Option<Least> {
        let mut best: Option<Solution> = None;
        for start in &self.starts {
            if self.spent() {
                return None;
            }
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
        best.map(least)
    }

    /// The same beginning at a layout that meets the other rows: what the limits give way by there is enough in any
    /// case.
    pub fn minimum_near(&self, problem: &Problem, witness: &[f64]) -> Option<Least> {
        let (x, slack) = slacken(problem, witness);
        let meets = problem.evaluate(&x, 0.0).rows.iter().all(|row| row.violation() <= HOLDS);
        let known = meets.then(|| Least { amount: slack, at: witness.to_vec(), against: Vec::new() });
        let near = give_way(problem, witness);
        let near = (near.max_violation <= HOLDS).then(|| least(near));
        let far = self.minimum(problem, HOLDS);
        let sound = |least: &Least| uncrossed(problem, &least.at);
        [known, near, far].into_iter().flatten().filter(sound).min_by(|a, b| a.amount.total_cmp(&b.amount))
    }

    /// The layout that the search was given.
    pub fn found(&self) -> &[f64] {
        &self.starts[0]
    }

    /// The lines that rows belong to.
    pub fn owners(&self, keys: &[RowKey]) -> Set {
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
    pub fn alike(&self, set: &Set) -> Option<Least> {
        self.minimum(&self.lines.problem(only(set, Role::Gives)), HOLDS)
    }

    /// A layout that meets the lines of a set, whatever the others; `None` where none was found from any start.
    pub fn layout(&self, set: &Set) -> Option<Vec<f64>> {
        self.layout_from(set, self.starts.len())
    }

    /// The same from the first few starts only, unless that is all of them.
    fn layout_from(&self, set: &Set, starts: usize) -> Option<Vec<f64>> {
        let hard = self.lines.given_way(0.0, only(set, Role::Holds));
        let known = self.known.borrow().clone();
        if let Some(x) = known.iter().find(|x| meets(&hard, x)) {
            return Some(x.clone());
        }
        if self.unmet.borrow().contains(set) {
            return None;
        }
        let elastic = self.lines.problem(only(set, Role::Gives));
        let recent = &known[known.len().saturating_sub(RECENT)..];
        for start in self.starts.iter().take(starts).chain(recent) {
            if self.spent() {
                return None;
            }
            let mut x = least(give_way(&elastic, start));
            if !meets(&hard, &x.at) && x.amount <= NEARLY {
                x.at = settle(&hard, &x.at);
            }
            if meets(&hard, &x.at) {
                return Some(self.keep(x.at));
            }
        }
        if starts < self.starts.len() {
            return None;
        }
        // Shorter tracks lead elsewhere than limits that give way.
        for start in self.starts.iter().take(2) {
            let x = settle(&hard, start);
            if !self.spent() && meets(&hard, &x) {
                return Some(self.keep(x));
            }
        }
        self.unmet.borrow_mut().insert(set.clone());
        None
    }

    fn keep(&self, x: Vec<f64>) -> Vec<f64> {
        self.known.borrow_mut().push(x.clone());
        x
    }

    /// A layout that meets the lines of a set with one more that gives way by a fixed amount, near one that does so
    /// already.
    pub fn given_way(&self, role: impl Fn(usize) -> Role, amount: f64, near: &[f64]) -> Option<Vec<f64>> {
        Search::reach(&self.lines.given_way(amount, role), near)
    }

    /// The nearest layout that a solve finds to meet a problem in which nothing gives way: the given one if it does.
    pub fn reach(hard: &Problem, near: &[f64]) -> Option<Vec<f64>> {
        // The centre line stays out of obstacles, however close.
        if hard.keepouts.iter().any(|k| !k.region.outside && k.distance.is_finite() && k.distance < 0.0) {
            return None;
        }
        if meets(hard, near) {
            return Some(near.to_vec());
        }
        let x = settle(hard, near);
        meets(hard, &x).then_some(x)
    }

    /// A smallest set of lines among `within` for which no layout was found; `None` where one meets them all.
    pub fn conflict(&self, within: &Set) -> Option<Core> {
        if self.layout(within).is_some() {
            return None;
        }
        let rows = self.alike(within).map(|least| least.against).unwrap_or_default();
        let core: Set = self.owners(&rows).intersection(within).copied().collect();
        let first = if !core.is_empty() && self.layout(&core).is_none() { &core } else { within };
        for _ in 0..ROUNDS {
            let core = self.filter(first);
            if self.is_spent() && core.without.is_empty() {
                return None;
            }
            if self.layout(&core.set).is_none() {
                return Some(core);
            }
        }
        self.layout(within).is_none().then(|| Core { set: within.clone(), without: BTreeMap::new() })
    }

    /// Limits of the catalogue and the building come first in the list, so a user's own words stay if they can.
    fn filter(&self, first: &Set) -> Core {
        let mut core = Core { set: first.clone(), without: BTreeMap::new() };
        for &line in first {
            let mut without = core.set.clone();
            without.remove(&line);
            // Quickly: what is left in the end is tried from all starts.
            match self.layout_from(&without, FEW) {
                Some(x) => {
                    core.without.insert(line, x);
                }
                None if self.is_spent() => {}
                None => core.set = without,
            }
        }
        core
    }
}

/// The role of the lines of a set, others left out.
pub fn only(set: &Set, role: Role) -> impl Fn(usize) -> Role {
    let set = set.clone();
    move |i| if set.contains(&i) { role } else { Role::Left }
}

/// Whether a layout meets every row of a problem in which nothing gives way, does not cross itself, and drives the way
/// that fixed sections are written.
pub fn meets(problem: &Problem, x: &[f64]) -> bool {
    let at = problem.evaluate(x, 0.0);
    at.rows.iter().all(|row| row.violation() <= HOLDS)
        && problem.crossings(&at.track).is_empty()
        && problem.keepouts.iter().all(|keepout| within(keepout, &at.track))
        && problem.rotations.iter().all(|&section| along(problem, x, section) > 0.0)
}

/// Whether the ends of all arcs are within a building; rows watch how near the walls are.
fn within(keepout: &Keepout, track: &Track) -> bool {
    let inside = |f: &Fillet| [f.begin, f.end].iter().all(|&p| keepout.region.polygon.contains(p));
    !(keepout.region.outside && keepout.distance > 0.0) || track.fillets.iter().all(inside)
}

fn uncrossed(problem: &Problem, x: &[f64]) -> bool {
    problem.crossings(&Track::new(&to_corners(x))).is_empty()
}

/// How far a section goes along its written direction, as a multiple of its written length, m.
fn along(problem: &Problem, at: &[f64], section: usize) -> f64 {
    let next = (section + 1) % problem.vertices.len();
    let vector = |v: &[f64]| Point::new(v[x(next)] - v[x(section)], v[y(next)] - v[y(section)]);
    vector(at).dot(vector(&problem.start))
}

/// A start with a slack that every elastic row holds with; the other rows may not.
pub fn slacken(problem: &Problem, start: &[f64]) -> (Vec<f64>, f64) {
    let mut x = start.to_vec();
    x.push(0.0);
    let needs = |row: &RowValue| row.violation() * if problem.unit(row.key) == "rad" { LEVER } else { 1.0 };
    let slack = problem.evaluate(&x, 0.0).rows.iter().map(needs).fold(0.0, f64::max);
    if let Some(last) = x.last_mut() {
        *last = slack;
    }
    (x, slack)
}

// Short steps: a long one may take the track across itself or an obstacle, where rows no longer lead back.
pub fn settings() -> SqpSettings {
    SqpSettings { iterations: ITERATIONS, radius: 0.5, largest_radius: 1.0, ..SqpSettings::default() }
}

fn give_way(problem: &Problem, start: &[f64]) -> Solution {
    sqp::minimise(problem, &slacken(problem, start).0, &settings(), &|_, _, _| {})
}

/// The end of a solve in which nothing gives way.
fn settle(problem: &Problem, start: &[f64]) -> Vec<f64> {
    let mut x = start.to_vec();
    x.push(0.0);
    let mut x = sqp::minimise(problem, &x, &settings(), &|_, _, _| {}).variables;
    x.pop();
    x
}

fn least(mut solution: Solution) -> Least {
    solution.variables.pop();
    let weighs = |m: &f64| m.abs() > NO_WEIGHT;
    let against = solution.multipliers.iter().filter(|(_, m)| weighs(m)).map(|(key, _)| *key).collect();
    Least { amount: solution.length, at: solution.variables, against }
}

/// The written layout, larger or smaller about the middle of its vertices, where nothing is fixed.
fn scaled(problem: &Problem, by: f64) -> Vec<f64> {
    let n = problem.vertices.len();
    let mean = |of: fn(usize) -> usize| (0..n).map(|i| problem.start[of(i)]).sum::<f64>() / n as f64;
    let middle = [mean(x), mean(y)];
    let mut start = problem.start.clone();
    for i in 0..n {
        start[x(i)] = middle[0] + by * (start[x(i)] - middle[0]);
        start[y(i)] = middle[1] + by * (start[y(i)] - middle[1]);
        let limits = problem.bounds[radius(i)];
        start[radius(i)] = (by * start[radius(i)]).clamp(limits.low, limits.high);
    }
    start
}
