//! The rows of a problem linearised: what straights a layout with held turns may have.
//!
//! With turns held, sections move parallel to themselves, and every length is linear in the coordinates that are left.
//! Rows of equality take directions away (their null space remains); the others are half-spaces in it.

use crate::problem::measures::Measures;
use crate::problem::{Expansion, Problem};
use crate::solve::convex::{Quadratic, Symmetric};
use crate::solve::subproblem::{self, LinearRow};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Directions whose equalities change by less than this, relative to the stiffest, are free.
const FREE: f64 = 1e-12;
/// A coefficient below this is none.
const NONE: f64 = 1e-9;

/// a·z ≤ b
struct Half {
    a: DVector<f64>,
    b: f64,
}

/// Layouts near a base, as base + N z.
pub struct Polytope {
    /// Variables of the problem that may move.
    free: Vec<usize>,
    base: Vec<f64>,
    /// Orthonormal columns.
    null: DMatrix<f64>,
    halves: Vec<Half>,
    /// Length of each straight at the base, and its slope by z, m.
    straights: (DVector<f64>, DMatrix<f64>),
}

impl Polytope {
    /// Linearised at `base`, which meets the equalities. `reach` says how far rows around it are looked for, m.
    pub fn new(problem: &Problem, base: &[f64], reach: f64) -> Self {
        let free = problem.free();
        let here = problem.evaluate(base, 2.0 * reach);
        let gradient = |e: &Expansion| -> DVector<f64> {
            let mut out: DVector<f64> = DVector::zeros(free.len());
            for (v, g) in e.variables.iter().zip(&e.gradient) {
                if let Ok(k) = free.binary_search(v) {
                    out[k] += g;
                }
            }
            out
        };
        let mut normal: DMatrix<f64> = DMatrix::zeros(free.len(), free.len());
        let (mut equal, mut sides) = (0.0f64, Vec::new());
        for row in &here.rows {
            let g = gradient(&row.expansion);
            let size = g.norm();
            if size < NONE {
                continue;
            }
            let g: DVector<f64> = g / size;
            if row.low == row.high {
                normal += &g * g.transpose();
                equal += 1.0;
                continue;
            }
            for (limit, sign) in [(row.high, 1.0), (row.low, -1.0)] {
                if limit.is_finite() {
                    sides.push((&g * sign, ((limit - row.expansion.value) * sign / size).max(0.0)));
                }
            }
        }
        for (k, &v) in free.iter().enumerate() {
            let bound = problem.bounds[v];
            for (limit, sign) in [(bound.high, 1.0), (bound.low, -1.0)] {
                if limit.is_finite() {
                    let mut g: DVector<f64> = DVector::zeros(free.len());
                    g[k] = sign;
                    sides.push((g, ((limit - base[v]) * sign).max(0.0)));
                }
            }
        }
        let eigen = SymmetricEigen::new(normal);
        let slack = FREE * equal.max(1.0);
        let columns: Vec<DVector<f64>> = (0..free.len())
            .filter(|&k| eigen.eigenvalues[k] < slack)
            .map(|k| eigen.eigenvectors.column(k).into_owned())
            .collect();
        let null = if columns.is_empty() { DMatrix::zeros(free.len(), 0) } else { DMatrix::from_columns(&columns) };
        let halves = sides
            .into_iter()
            .map(|(g, b)| Half { a: null.transpose() * g, b })
            .filter(|half| half.a.norm() > NONE)
            .collect();
        let measures = Measures::new(base, &problem.signs);
        let n = measures.len();
        let lengths: Vec<Expansion> = (0..n).map(|k| measures.straight(k)).collect();
        let mut slopes: DMatrix<f64> = DMatrix::zeros(n, null.ncols());
        for (k, e) in lengths.iter().enumerate() {
            slopes.row_mut(k).copy_from(&(null.transpose() * gradient(e)).transpose());
        }
        let values = DVector::from_iterator(n, lengths.iter().map(|e| e.value));
        Polytope { free, base: base.to_vec(), null, halves, straights: (values, slopes) }
    }

    /// Degrees of freedom.
    pub fn dimension(&self) -> usize {
        self.null.ncols()
    }

    /// Lengths of the straights at z, m.
    pub fn straights(&self, z: &DVector<f64>) -> DVector<f64> {
        &self.straights.0 + &self.straights.1 * z
    }

    /// Their slope along a direction.
    pub fn along(&self, direction: &DVector<f64>) -> DVector<f64> {
        &self.straights.1 * direction
    }

    /// The direction of least size that changes straight k by itself as far as can be.
    pub fn towards(&self, k: usize) -> DVector<f64> {
        self.straights.1.row(k).transpose()
    }

    /// The problem's variables at z.
    pub fn variables(&self, z: &DVector<f64>) -> Vec<f64> {
        let mut out = self.base.clone();
        let moved = &self.null * z;
        self.free.iter().zip(moved.iter()).for_each(|(&v, d)| out[v] += d);
        out
    }

    /// From where to where a line from z stays inside.
    pub fn chord(&self, z: &DVector<f64>, direction: &DVector<f64>) -> (f64, f64) {
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for half in &self.halves {
            let (slope, room) = (half.a.dot(direction), (half.b - half.a.dot(z)).max(0.0));
            if slope > NONE {
                to = to.min(room / slope);
            } else if slope < -NONE {
                from = from.max(room / slope);
            }
        }
        (from.min(0.0), to.max(0.0))
    }

    /// The middle of the largest ball inside (Chebyshev), by linear programming; the base where there is none.
    pub fn centre(&self) -> DVector<f64> {
        let m = self.dimension();
        let mut matrix = Symmetric::new(m + 1);
        (0..m).for_each(|k| matrix.add(k, k, 1e-6));
        let mut linear = vec![0.0; m + 1];
        linear[m] = -1.0;
        let wide = 100.0;
        let rows: Vec<LinearRow> = self
            .halves
            .iter()
            .map(|half| {
                let own = half.a.iter().enumerate().map(|(k, a)| (k, *a));
                let coefficients = own.chain([(m, half.a.norm())]).collect();
                LinearRow { coefficients, low: f64::NEG_INFINITY, high: half.b, price: None }
            })
            .collect();
        let (mut low, high) = (vec![-wide; m + 1], vec![wide; m + 1]);
        low[m] = 0.0;
        match subproblem::solve(&Quadratic { matrix, linear }, &low, &high, &rows) {
            Some(step) => DVector::from_iterator(m, step.d.into_iter().take(m)),
            None => DVector::zeros(m),
        }
    }
}
