//! Box's complex method (Box 1965), the thesis' second solver, for comparison: no derivatives, constraints through a
//! penalty.
//!
//! A set of twice as many points as free variables; the worst is reflected through the centroid of the others by 1.3
//! and drawn half-way back towards it for as long as it stays the worst. Linear equalities (`fix length, rotation`)
//! have no inside to sample from: every point is projected onto them.

use super::sqp::{Solution, SqpSettings, Watch};
use crate::base::random::Random;
use crate::problem::{Evaluation, Function, Problem, RowKey, RowValue};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Reflection factor of Box.
const REFLECTION: f64 = 1.3;
/// Half-width of the box about the start that first points are drawn from, m.
const SPREAD: f64 = 1.0;
/// Reflections a free variable.
const REFLECTIONS: usize = 1500;
/// Price of a metre of violation.
const PRICE: f64 = 50.0;
/// The points have come together, m.
const TOGETHER: f64 = 1e-7;
/// How often a point is drawn back before it is given up.
const RETREATS: usize = 40;

struct Complex<'p> {
    problem: &'p Problem,
    free: Vec<usize>,
    start: &'p [f64],
    plane: Plane,
    value: Value<'p>,
    /// Free variables and merit.
    points: Vec<(Vec<f64>, f64)>,
    evaluations: usize,
}

/// Minimises the problem from `start` with a fixed seed. `iterations` of the result counts evaluations.
pub fn minimise(problem: &Problem, start: &[f64], settings: &SqpSettings, watch: Watch) -> Solution {
    minimise_of(problem, start, settings, Draw { seed: 1, most: usize::MAX }, &|at| at.value(), watch)
}

/// A repetition.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    pub seed: u64,
    /// Evaluations it may take.
    pub most: usize,
}

/// What is minimised, of a problem that is evaluated.
pub type Value<'v> = &'v dyn Fn(&Evaluation) -> f64;

/// The same of any value.
pub fn minimise_of(
    problem: &Problem,
    start: &[f64],
    settings: &SqpSettings,
    draw: Draw,
    value: Value,
    watch: Watch,
) -> Solution {
    let free = problem.free();
    let n = free.len();
    let plane = Plane::new(problem, &free, start);
    let mut complex = Complex { problem, free, start, plane, value, points: Vec::new(), evaluations: 0 };
    complex.scatter(draw.seed);
    let mut converged = n == 0;
    for round in 0..REFLECTIONS * n {
        complex.points.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (&complex.points[0], &complex.points[complex.points.len() - 1]);
        if round % 100 == 0 {
            let at = complex.at(&best.0);
            watch(complex.evaluations, at.length, violation(problem, &at));
        }
        let size = best.0.iter().zip(&worst.0).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        if size < TOGETHER {
            converged = true;
            break;
        }
        if complex.evaluations >= draw.most {
            break;
        }
        complex.reflect_worst();
    }
    complex.points.sort_by(|a, b| a.1.total_cmp(&b.1));
    let variables = complex.points.first().map_or(start.to_vec(), |p| complex.spread(&p.0));
    let at = problem.evaluate(&variables, 0.0);
    let max_violation = violation(problem, &at);
    Solution {
        length: value(&at),
        max_violation,
        variables,
        iterations: complex.evaluations,
        converged: converged && max_violation <= settings.feasibility,
        multipliers: BTreeMap::new(),
    }
}

/// The linear equalities A p = b of a problem, over its free variables.
struct Plane {
    a: DMatrix<f64>,
    b: DVector<f64>,
    /// (A Aᵀ)⁻¹; `None` without equalities, or when they depend on each other.
    inverse: Option<DMatrix<f64>>,
}

impl Plane {
    fn new(problem: &Problem, free: &[usize], start: &[f64]) -> Self {
        let equalities: Vec<_> = problem
            .rows
            .iter()
            .filter(|r| r.low == r.high && r.weight.is_none())
            .filter_map(|r| if let Function::Linear(terms) = &r.function { Some((terms, r.low)) } else { None })
            .collect();
        let mut a: DMatrix<f64> = DMatrix::zeros(equalities.len(), free.len());
        let mut b: DVector<f64> = DVector::zeros(equalities.len());
        for (row, (terms, value)) in equalities.into_iter().enumerate() {
            b[row] = value;
            for &(variable, k) in terms {
                match free.binary_search(&variable) {
                    Ok(column) => a[(row, column)] += k,
                    Err(_) => b[row] -= k * start[variable],
                }
            }
        }
        let inverse = if b.is_empty() { None } else { (&a * a.transpose()).try_inverse() };
        Plane { a, b, inverse }
    }

    /// The nearest point on the plane.
    fn project(&self, point: &[f64]) -> Vec<f64> {
        let Some(inverse) = &self.inverse else { return point.to_vec() };
        let p = DVector::from_column_slice(point);
        let off = &self.a * &p - &self.b;
        (p - self.a.transpose() * (inverse * off)).as_slice().to_vec()
    }
}

impl Complex<'_> {
    fn spread(&self, point: &[f64]) -> Vec<f64> {
        let mut x = self.start.to_vec();
        for (&v, value) in self.free.iter().zip(&self.plane.project(point)) {
            x[v] = value.clamp(self.problem.bounds[v].low, self.problem.bounds[v].high);
        }
        x
    }

    fn at(&self, point: &[f64]) -> Evaluation {
        self.problem.evaluate(&self.spread(point), 0.0)
    }

    /// Length plus penalties; infinite where a turn is flipped.
    fn merit(&mut self, point: &[f64]) -> f64 {
        self.evaluations += 1;
        let at = self.at(point);
        let flipped = at.track.fillets.iter().zip(&self.problem.signs).any(|(f, s)| f.turn * s <= 0.0);
        let value = if flipped { f64::INFINITY } else { (self.value)(&at) };
        if !value.is_finite() {
            return f64::INFINITY;
        }
        let price = |row: &RowValue| match row.key {
            RowKey::Listed(i) => self.problem.rows[i].weight.unwrap_or(PRICE),
            RowKey::Clearance(..) | RowKey::Own(..) | RowKey::Gap(..) => PRICE,
        };
        value + at.rows.iter().map(|r| price(r) * r.violation()).sum::<f64>()
    }

    fn scatter(&mut self, seed: u64) {
        let first: Vec<f64> = self.free.iter().map(|&v| self.start[v]).collect();
        let mut random = Random::new(seed);
        for k in 0..2 * self.free.len() {
            let mut point = first.clone();
            if k > 0 {
                point.iter_mut().for_each(|p| *p += SPREAD * (2.0 * random.uniform() - 1.0));
            }
            let mut merit = self.merit(&point);
            // Towards the written layout until no turn is flipped.
            for _ in 0..RETREATS {
                if merit.is_finite() {
                    break;
                }
                point.iter_mut().zip(&first).for_each(|(p, f)| *p = 0.5 * (*p + f));
                merit = self.merit(&point);
            }
            self.points.push((point, merit));
        }
    }

    /// Replaces the last point, the worst of the sorted ones.
    fn reflect_worst(&mut self) {
        let Some((worst, worst_merit)) = self.points.pop() else { return };
        let count = self.points.len() as f64;
        let centre: Vec<f64> =
            (0..worst.len()).map(|k| self.points.iter().map(|(p, _)| p[k]).sum::<f64>() / count).collect();
        let second = self.points.last().map_or(worst_merit, |p| p.1);
        let best = self.points[0].0.clone();
        let mut point: Vec<f64> = centre.iter().zip(&worst).map(|(c, w)| c + REFLECTION * (c - w)).collect();
        let mut merit = self.merit(&point);
        for k in 0..RETREATS {
            if merit < second {
                break;
            }
            // Half-way to the centroid, and more and more to the best point, lest the centroid itself is bad
            // (Guin 1968).
            let to_best = k as f64 / RETREATS as f64;
            for (i, p) in point.iter_mut().enumerate() {
                let aim = centre[i] + to_best * (best[i] - centre[i]);
                *p = 0.5 * (*p + aim);
            }
            merit = self.merit(&point);
        }
        self.points.push((point, merit));
    }
}

fn violation(problem: &Problem, at: &Evaluation) -> f64 {
    let hard = |r: &&RowValue| !matches!(r.key, RowKey::Listed(i) if problem.rows[i].weight.is_some());
    at.rows.iter().filter(hard).map(RowValue::violation).fold(0.0, f64::max)
}
