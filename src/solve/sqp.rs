//! Sequential quadratic programming with exact second derivatives: the Sℓ₁QP trust-region method of Fletcher (1987,
//! §12.4) with second-order correction, on subproblems solved by Clarabel.
//!
//! Merit is length + μ Σ violation, rows scaled to unit gradient, so lengths and angles weigh alike. A step is refused
//! that would flip a turn or come near a half turn, where a vertex runs to infinity and the model is
//! unbounded below.

use super::Stop;
use super::active_set::{self, ActiveSet, Limit};
use super::convex::{ActiveRow, DENSE, Quadratic, Symmetric, convexify};
use super::elements::{self, Element};
use super::subproblem::{self, LinearRow, SubproblemSolution};
use crate::model::TOLERANCE;
use crate::problem::{Aim, Evaluation, Expansion, Problem, RowKey, RowValue, measures};
use std::collections::BTreeMap;

/// Limits of a run; the defaults are what stages use.
#[derive(Clone, Copy, Debug)]
pub struct SqpSettings {
    pub iterations: usize,
    /// First trust radius, m.
    pub radius: f64,
    /// Largest trust radius, m.
    pub largest_radius: f64,
    /// Largest violation of a feasible result, m (and rad).
    pub feasibility: f64,
    /// How dear a metre of violation may become before a run gives up on feasibility.
    pub dearest: f64,
    /// When a run that is feasible ends early.
    pub stop: Stop,
}

impl Default for SqpSettings {
    fn default() -> Self {
        SqpSettings {
            iterations: 200,
            radius: 1.0,
            largest_radius: 4.0,
            feasibility: TOLERANCE,
            dearest: 2e5,
            stop: Stop::NEVER,
        }
    }
}

/// Where a run ended.
#[derive(Clone, Debug)]
pub struct Solution {
    pub variables: Vec<f64>,
    /// The objective, m: the track's length unless the problem aims at something else.
    pub length: f64,
    /// Largest violation of a hard row, m or rad.
    pub max_violation: f64,
    pub iterations: usize,
    /// First-order optimal, rather than out of iterations.
    pub converged: bool,
    /// λ of each active row, L = f + Σ λ c, m a unit of the row.
    pub multipliers: BTreeMap<RowKey, f64>,
}

impl Solution {
    /// Variables as they are.
    pub fn at(problem: &Problem, variables: &[f64]) -> Self {
        let at = problem.evaluate(variables, 0.0);
        let soft = |r: &&RowValue| matches!(r.key, RowKey::Listed(i) if problem.rows[i].weight.is_some());
        Solution {
            variables: variables.to_vec(),
            length: at.value(),
            max_violation: at.rows.iter().filter(|r| !soft(r)).map(RowValue::violation).fold(0.0, f64::max),
            iterations: 0,
            converged: true,
            multipliers: BTreeMap::new(),
        }
    }
}

/// What a run tells while it goes on: iteration, length (m), largest violation.
pub type Watch<'a> = &'a (dyn Fn(usize, f64, f64) + Sync);

/// Least and largest turn that a step may lead to, rad.
const TURN_FLOOR: f64 = 0.01;
const TURN_CEILING: f64 = 2.8;
/// First price of a metre of violation, and the factor by which it rises when a minimum is not feasible.
const PRICE: f64 = 20.0;
const DEARER: f64 = 10.0;
/// A step shorter than this ends a run, m.
const STEP: f64 = 1e-9;
/// A violation below this is rounding.
const ROUNDING: f64 = 1e-11;

/// Minimises the problem from `start`. Where that takes many steps, or vertices are many, with headings and lengths of
/// sections as variables of their own ([`Problem::lift`]): the same layouts are stationary, and fewer steps lead there.
pub fn minimise(problem: &Problem, start: &[f64], settings: &SqpSettings, watch: Watch) -> Solution {
    let plain = problem.elastic.is_some() || matches!(problem.aim, Aim::Near(_)) || settings.iterations <= FEW;
    if plain {
        return run(problem, start, settings, watch);
    }
    let mut start = start.to_vec();
    let mut first = 0;
    if problem.free().len() <= DENSE {
        let short = run(problem, &start, &SqpSettings { iterations: FEW, ..*settings }, watch);
        if short.converged || settings.stop.now() && short.max_violation <= settings.feasibility {
            return short;
        }
        (start, first) = (short.variables, short.iterations);
    }
    let watch_on: Watch = &|iteration, length, violation| watch(first + iteration, length, violation);
    let lifted = run(&problem.lift(), &measures::lift(&start), settings, watch_on);
    let here = Solution {
        variables: lifted.variables[..start.len()].to_vec(),
        multipliers: lifted.multipliers.into_iter().filter(|(key, _)| !matches!(key, RowKey::Gap(..))).collect(),
        iterations: first + lifted.iterations,
        converged: lifted.converged,
        ..Solution::at(problem, &lifted.variables[..start.len()])
    };
    let done = here.converged && here.max_violation <= settings.feasibility;
    if done && settings.stop.now() {
        return here;
    }
    // A few steps take off what rounding of the ends of sections left; without an end, all of them.
    let iterations = if done { POLISH } else { settings.iterations };
    let watch_on: Watch = &|iteration, length, violation| watch(here.iterations + iteration, length, violation);
    let mut last = run(problem, &here.variables, &SqpSettings { iterations, ..*settings }, watch_on);
    last.iterations += here.iterations;
    let feasible = last.max_violation <= settings.feasibility;
    if done && !(last.converged && feasible) { Solution { iterations: last.iterations, ..here } } else { last }
}

/// Steps by coordinates of vertices alone, of a small problem.
const FEW: usize = 60;
/// Steps by coordinates of vertices from where a lifted problem is stationary.
const POLISH: usize = 8;

fn run(problem: &Problem, start: &[f64], settings: &SqpSettings, watch: Watch) -> Solution {
    let mut run = Run::new(problem, start, settings);
    let mut iterations = 0;
    let mut converged = false;
    while iterations < settings.iterations {
        // Before that there would be nothing to keep.
        if run.max_violation(&run.here) <= settings.feasibility && settings.stop.now() {
            break;
        }
        iterations += 1;
        watch(iterations, run.here.length, run.max_violation(&run.here));
        match run.step() {
            Progress::Moved => {}
            // At a minimum of the merit that is not feasible: violation was too cheap.
            Progress::Stopped
                if run.max_violation(&run.here) > settings.feasibility && run.price < settings.dearest =>
            {
                run.price *= DEARER;
                run.radius = settings.radius;
            }
            Progress::Stopped => {
                converged = true;
                break;
            }
        }
    }
    Solution {
        length: run.here.value(),
        max_violation: run.max_violation(&run.here),
        variables: run.x,
        iterations,
        converged,
        multipliers: run.multipliers,
    }
}

enum Progress {
    Moved,
    Stopped,
}

struct Run<'p> {
    problem: &'p Problem,
    settings: &'p SqpSettings,
    /// Indices of the free variables, and each variable's index among them.
    free: Vec<usize>,
    place: Vec<Option<usize>>,
    /// Scale of each listed row: 1 / largest entry of its first gradient.
    scales: Vec<f64>,
    price: f64,
    radius: f64,
    x: Vec<f64>,
    here: Evaluation,
    multipliers: BTreeMap<RowKey, f64>,
    /// The limits that the last subproblem ended on: of rows, and of the box around the free variables.
    limits: (BTreeMap<RowKey, Limit>, Vec<Limit>),
}

impl<'p> Run<'p> {
    fn new(problem: &'p Problem, start: &[f64], settings: &'p SqpSettings) -> Self {
        let free = problem.free();
        let mut place = vec![None; problem.bounds.len()];
        free.iter().enumerate().for_each(|(k, &v)| place[v] = Some(k));
        let x: Vec<f64> = start.iter().zip(&problem.bounds).map(|(v, b)| v.clamp(b.low, b.high)).collect();
        let here = problem.evaluate(&x, reach(settings.radius));
        let scales = here.rows[..problem.rows.len()].iter().map(unit_gradient).collect();
        let radius = settings.radius;
        let limits = (BTreeMap::new(), vec![Limit::None; free.len()]);
        let multipliers = BTreeMap::new();
        Run { problem, settings, free, place, scales, price: PRICE, radius, x, here, multipliers, limits }
    }

    fn scale(&self, key: RowKey) -> f64 {
        match key {
            RowKey::Listed(i) => self.scales[i],
            RowKey::Clearance(..) | RowKey::Own(..) | RowKey::Gap(..) => 1.0,
        }
    }

    /// What a unit of violation of a row costs.
    fn row_price(&self, key: RowKey) -> f64 {
        match key {
            RowKey::Listed(i) => self.problem.rows[i].weight.unwrap_or(self.price * self.scales[i]),
            RowKey::Clearance(..) | RowKey::Own(..) | RowKey::Gap(..) => self.price,
        }
    }

    fn is_soft(&self, key: RowKey) -> bool {
        matches!(key, RowKey::Listed(i) if self.problem.rows[i].weight.is_some())
    }

    fn max_violation(&self, at: &Evaluation) -> f64 {
        at.rows.iter().filter(|r| !self.is_soft(r.key)).map(RowValue::violation).fold(0.0, f64::max)
    }

    fn merit(&self, at: &Evaluation) -> f64 {
        at.value() + at.rows.iter().map(|r| self.row_price(r.key) * r.violation()).sum::<f64>()
    }

    /// One iteration: subproblems on a shrinking trust region until a step is accepted or none is left.
    fn step(&mut self) -> Progress {
        let hessian = self.lagrangian_hessian();
        let gradient = self.objective_gradient();
        let model = match self.problem.lifted {
            true => elements::convexify(&hessian, &self.elements(), &gradient, &self.active_rows()),
            false => convexify(&hessian, &gradient, &self.active_rows()),
        };
        let merit = self.merit(&self.here);
        loop {
            let rows = self.linear_rows(None);
            let Some(step) = self.subproblem(&model, &rows) else {
                if self.shrink(0.5) { continue } else { return Progress::Stopped }
            };
            let size = norm(&step.d);
            let predicted = self.predicted(&hessian, &gradient, &model, &rows, &step.d);
            if size < STEP || predicted <= 1e-13 * merit.abs() {
                self.remember(&rows, &step);
                return Progress::Stopped;
            }
            let mut trial = self.trial(&step.d);
            let mut gained = trial.as_ref().map_or(f64::NEG_INFINITY, |(_, e)| merit - self.merit(e));
            if gained < 0.75 * predicted
                && let Some((_, at)) = &trial
            {
                // Second-order correction: the rows as they are at the trial point (Fletcher 1987, §14.4).
                let corrected = self.linear_rows(Some((at, &step.d)));
                let again = self.subproblem(&model, &corrected);
                let again = again.and_then(|s| self.trial(&s.d));
                let better = again.as_ref().map_or(f64::NEG_INFINITY, |(_, e)| merit - self.merit(e));
                if better > gained {
                    (trial, gained) = (again, better);
                }
            }
            // Close to the end the merit's own rounding hides the gain.
            let rounding = 1e-13 * merit.abs();
            match trial {
                Some((x, _)) if gained >= 0.1 * predicted - rounding => {
                    self.remember(&rows, &step);
                    if gained > 0.75 * predicted && size > 0.9 * self.radius {
                        self.radius = (2.0 * self.radius).min(self.settings.largest_radius);
                    } else if gained < 0.25 * predicted {
                        self.radius = 0.5 * size.min(self.radius);
                    }
                    self.radius = self.radius.max(1e3 * STEP);
                    self.here = self.problem.evaluate(&x, reach(self.radius));
                    self.x = x;
                    return Progress::Moved;
                }
                _ => {
                    self.radius = self.radius.min(size);
                    if !self.shrink(0.3) {
                        return Progress::Stopped;
                    }
                }
            }
        }
    }

    fn shrink(&mut self, factor: f64) -> bool {
        self.radius *= factor;
        self.radius > STEP
    }

    fn remember(&mut self, rows: &[(RowKey, LinearRow)], step: &SubproblemSolution) {
        self.multipliers = rows
            .iter()
            .zip(&step.multipliers)
            .filter(|(_, m)| m.abs() > 1e-7)
            .map(|((key, _), m)| (*key, m * self.scale(*key)))
            .collect();
    }

    /// By the active set of the last one if that is near enough, and else by an interior-point method.
    fn subproblem(&mut self, model: &Quadratic, rows: &[(RowKey, LinearRow)]) -> Option<SubproblemSolution> {
        let limit = |k: usize, low: bool| {
            let (v, bound) = (self.free[k], self.problem.bounds[self.free[k]]);
            if low { (bound.low - self.x[v]).max(-self.radius) } else { (bound.high - self.x[v]).min(self.radius) }
        };
        let low: Vec<f64> = (0..self.free.len()).map(|k| limit(k, true)).collect();
        let high: Vec<f64> = (0..self.free.len()).map(|k| limit(k, false)).collect();
        let linear: Vec<LinearRow> = rows.iter().map(|(_, row)| row.clone()).collect();
        let bounds = [&low[..], &high[..]];
        let guess = ActiveSet {
            rows: rows.iter().map(|(key, _)| self.limits.0.get(key).copied().unwrap_or_default()).collect(),
            bounds: self.limits.1.clone(),
        };
        let quick = if self.free.len() <= DENSE { active_set::solve(model, bounds, &linear, guess) } else { None };
        let (solution, set) = quick.or_else(|| {
            let solution = subproblem::solve(model, &low, &high, &linear)?;
            let set = ActiveSet::of(&solution, bounds, &linear);
            Some((solution, set))
        })?;
        self.limits = (rows.iter().map(|(key, _)| *key).zip(set.rows).collect(), set.bounds);
        Some(solution)
    }

    /// The variables after a step with their evaluation; `None` where the model does not hold.
    fn trial(&self, d: &[f64]) -> Option<(Vec<f64>, Evaluation)> {
        let mut x = self.x.clone();
        for (k, &v) in self.free.iter().enumerate() {
            x[v] = (x[v] + d[k]).clamp(self.problem.bounds[v].low, self.problem.bounds[v].high);
        }
        let at = self.problem.evaluate_like(&x, &self.here);
        let turns = |x: &[f64], at: &Evaluation| match self.problem.lifted {
            true => measures::turns(x, &self.problem.signs),
            false => at.track.fillets.iter().zip(&self.problem.signs).map(|(fillet, s)| fillet.turn * s).collect(),
        };
        let sound = turns(&x, &at)
            .iter()
            .zip(turns(&self.x, &self.here))
            .all(|(to, from)| *to > TURN_FLOOR.min(from) && *to < TURN_CEILING.max(from));
        (sound && at.value().is_finite()).then_some((x, at))
    }

    /// Rows within reach of the trust region, scaled and linearised; around a trial point's values if one is given.
    fn linear_rows(&self, correction: Option<(&Evaluation, &[f64])>) -> Vec<(RowKey, LinearRow)> {
        let mut out = Vec::with_capacity(self.here.rows.len());
        for (r, row) in self.here.rows.iter().enumerate() {
            let scale = self.scale(row.key);
            let coefficients: Vec<(usize, f64)> = row
                .expansion
                .variables
                .iter()
                .zip(&row.expansion.gradient)
                .filter_map(|(&v, &g)| self.place[v].map(|k| (k, g * scale)))
                .collect();
            let mut value = row.expansion.value;
            if let Some((at, d)) = correction {
                let linear: f64 = coefficients.iter().map(|&(k, a)| a / scale * d[k]).sum();
                value = at.rows[r].expansion.value - linear;
            }
            let (mut low, mut high) = ((row.low - value) * scale, (row.high - value) * scale);
            let swing = self.radius * coefficients.iter().map(|(_, a)| a.abs()).sum::<f64>();
            if low < -swing {
                low = f64::NEG_INFINITY;
            }
            if high > swing {
                high = f64::INFINITY;
            }
            if low.is_infinite() && high.is_infinite() || coefficients.is_empty() {
                continue;
            }
            let holds = low <= ROUNDING && high >= -ROUNDING && correction.is_none() && !self.is_soft(row.key);
            if holds {
                (low, high) = (low.min(0.0), high.max(0.0));
            }
            let price = (!holds).then(|| self.row_price(row.key) / scale);
            out.push((row.key, LinearRow { coefficients, low, high, price }));
        }
        out
    }

    /// Rows that the last subproblem ended on, for [`convexify`].
    fn active_rows(&self) -> Vec<ActiveRow> {
        let mut active = Vec::new();
        for (key, row) in self.linear_rows(None) {
            let Some(multiplier) = self.multipliers.get(&key) else { continue };
            let target = if *multiplier > 0.0 { row.high } else { row.low };
            if target.is_finite() {
                active.push(ActiveRow { coefficients: row.coefficients, target });
            }
        }
        active
    }

    fn objective_gradient(&self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.free.len()];
        for term in &self.here.objective {
            for (&v, &g) in term.variables.iter().zip(&term.gradient) {
                if let Some(k) = self.place[v] {
                    gradient[k] += g;
                }
            }
        }
        gradient
    }

    /// Terms of the Lagrangian with their weights, and the section whose end a term is of.
    fn lagrangian(&self) -> impl Iterator<Item = (&Expansion, f64, Option<usize>)> {
        let objective = self.here.objective.iter().map(|e| (e, 1.0, None));
        let rows = self.here.rows.iter().filter_map(|row| {
            let section = if let RowKey::Gap(section, _) = row.key { Some(section) } else { None };
            Some((&row.expansion, *self.multipliers.get(&row.key)?, section))
        });
        objective.chain(rows)
    }

    fn elements(&self) -> Vec<Element> {
        elements::elements(self.lagrangian(), &self.place)
    }

    fn lagrangian_hessian(&self) -> Symmetric {
        let mut hessian = Symmetric::new(self.free.len());
        for (expansion, weight, _) in self.lagrangian() {
            let k = expansion.variables.len();
            for (i, &v) in expansion.variables.iter().enumerate() {
                for (j, &w) in expansion.variables.iter().enumerate() {
                    if let (Some(p), Some(q)) = (self.place[v], self.place[w]) {
                        hessian.add(p, q, weight * expansion.hessian[i * k + j]);
                    }
                }
            }
        }
        hessian
    }

    /// How much the model of the merit falls over a step.
    fn predicted(
        &self,
        hessian: &Symmetric,
        gradient: &[f64],
        model: &Quadratic,
        rows: &[(RowKey, LinearRow)],
        d: &[f64],
    ) -> f64 {
        let dot = |a: &[f64]| a.iter().zip(d).map(|(a, b)| a * b).sum::<f64>();
        let curvature = hessian.quadratic_form(d);
        let relief: f64 = rows
            .iter()
            .map(|(key, row)| {
                let price = row.price.unwrap_or(self.row_price(*key) / self.scale(*key));
                let at = |value: f64| (row.low - value).max(value - row.high).max(0.0);
                let moved = row.coefficients.iter().map(|&(k, a)| a * d[k]).sum::<f64>();
                price * (at(0.0) - at(moved))
            })
            .sum();
        let exact = relief - dot(gradient) - 0.5 * curvature;
        // Along negative curvature the convex model is the more careful of the two.
        let convex = relief - dot(&model.linear) - 0.5 * model.matrix.quadratic_form(d);
        if curvature < 0.0 && convex > 0.0 { exact.min(convex) } else { exact }
    }
}

/// How far beyond its limit an approach counts, for a trust radius, m.
fn reach(radius: f64) -> f64 {
    4.0 * radius + 0.5
}

fn unit_gradient(row: &RowValue) -> f64 {
    let largest = row.expansion.gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    if largest > 1e-9 { 1.0 / largest } else { 1.0 }
}

fn norm(d: &[f64]) -> f64 {
    d.iter().fold(0.0, |m, v| m.max(v.abs()))
}
