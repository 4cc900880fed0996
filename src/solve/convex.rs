//! The Hessian of the Lagrangian, made convex for the quadratic subproblem without losing its curvature where the
//! step may go.
//!
//! Adding ρ a aᵀ for a row a·d = b that stays active changes nothing on that row's plane when the linear term
//! moves with it (Nocedal and Wright 2006, §17.3), so curvature that is negative only across active rows costs no
//! convergence. What is left negative is flattened by its eigenvectors, or in large problems lifted by τ I.
//! Definiteness is read off a factorisation: Cholesky's of a small matrix, a sparse LDLᵀ of a large one.

use clarabel::algebra::CscMatrix;
use clarabel::qdldl::{QDLDLFactorisation, QDLDLSettingsBuilder};
use nalgebra::{Cholesky, DMatrix, SymmetricEigen};
use std::collections::BTreeMap;

/// A symmetric matrix by its upper triangle.
#[derive(Clone, Debug)]
pub struct Symmetric {
    pub size: usize,
    entries: Entries,
}

#[derive(Clone, Debug)]
enum Entries {
    /// Column after column, each down to its diagonal.
    Dense(Vec<f64>),
    /// (column, row) to value.
    Sparse(BTreeMap<(usize, usize), f64>),
}

/// An active row of the subproblem: a·d = target, as (index, coefficient).
pub struct ActiveRow {
    pub coefficients: Vec<(usize, f64)>,
    pub target: f64,
}

/// A convex quadratic model ½ dᵀPd + q·d.
pub struct Quadratic {
    pub matrix: Symmetric,
    pub linear: Vec<f64>,
}

impl Symmetric {
    pub fn new(size: usize) -> Self {
        let entries = if size <= DENSE {
            Entries::Dense(vec![0.0; size * (size + 1) / 2])
        } else {
            Entries::Sparse(BTreeMap::new())
        };
        Symmetric { size, entries }
    }

    /// Adds to entry (i, j); call once for each pair in either order, or for both triangles with `i <= j` only.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        if i > j {
            return;
        }
        match &mut self.entries {
            Entries::Dense(values) => values[j * (j + 1) / 2 + i] += value,
            Entries::Sparse(entries) => *entries.entry((j, i)).or_insert(0.0) += value,
        }
    }

    /// What is not zero, as (row, column, value), by columns.
    fn each(&self, mut what: impl FnMut(usize, usize, f64)) {
        match &self.entries {
            Entries::Dense(values) => {
                let mut values = values.iter();
                for j in 0..self.size {
                    for i in 0..=j {
                        match values.next() {
                            Some(&value) if value != 0.0 => what(i, j, value),
                            _ => {}
                        }
                    }
                }
            }
            Entries::Sparse(entries) => entries.iter().for_each(|(&(j, i), &value)| what(i, j, value)),
        }
    }

    /// xᵀ M x
    pub fn quadratic_form(&self, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each(|i, j, value| sum += if i == j { value * x[i] * x[i] } else { 2.0 * value * x[i] * x[j] });
        sum
    }

    /// Upper triangle in compressed columns, with `extra` further empty columns.
    pub fn to_csc(&self, extra: usize) -> CscMatrix<f64> {
        let size = self.size + extra;
        let mut starts = vec![0; size + 1];
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        self.each(|i, j, value| {
            starts[j + 1] += 1;
            rows.push(i);
            values.push(value);
        });
        for j in 0..size {
            starts[j + 1] += starts[j];
        }
        CscMatrix::new(size, size, starts, rows, values)
    }

    /// The whole matrix.
    pub fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.size, self.size);
        self.each(|i, j, value| {
            dense[(i, j)] = value;
            dense[(j, i)] = value;
        });
        dense
    }

    /// The same matrix with every negative eigenvalue made slightly positive: a step along it goes to the trust
    /// region's edge, and directions of little curvature keep theirs, which a lift of all would take away.
    fn flattened(&self) -> Self {
        let eigen = SymmetricEigen::new(self.dense());
        let mut out = self.clone();
        for k in 0..self.size {
            let missing = FLAT - eigen.eigenvalues[k];
            if missing <= 0.0 {
                continue;
            }
            let v = eigen.eigenvectors.column(k);
            for i in 0..self.size {
                for j in i..self.size {
                    let value = missing * v[i] * v[j];
                    if value != 0.0 {
                        out.add(i, j, value);
                    }
                }
            }
        }
        out
    }

    pub fn is_positive_definite(&self) -> bool {
        if self.size <= DENSE {
            let factor = Cholesky::new(self.dense());
            return factor.is_some_and(|f| f.l_dirty().diagonal().iter().all(|&l| l * l > LEAST_PIVOT));
        }
        let Ok(settings) = QDLDLSettingsBuilder::default().regularize_enable(false).build() else { return false };
        QDLDLFactorisation::new(&self.to_csc(0), Some(settings)).is_ok_and(|f| f.D.iter().all(|&d| d > LEAST_PIVOT))
    }
}

/// Up to this size matrices are dense, and negative curvature is removed direction by direction.
pub const DENSE: usize = 75;
/// A matrix whose pivots are not above this is not definite, 1/m.
const LEAST_PIVOT: f64 = 1e-9;
/// Curvature that is left of a negative one, 1/m.
pub const FLAT: f64 = 1e-5;

/// The model with Hessian `hessian` and gradient `gradient`, made strictly convex.
pub fn convexify(hessian: &Symmetric, gradient: &[f64], active: &[ActiveRow]) -> Quadratic {
    for penalty in [0.0, 1.0, 10.0, 100.0, 1000.0] {
        let model = augmented(hessian, gradient, active, penalty, 1e-8);
        if model.matrix.is_positive_definite() {
            return model;
        }
    }
    if hessian.size <= DENSE {
        let mut model = augmented(hessian, gradient, active, 10.0, 0.0);
        model.matrix = model.matrix.flattened();
        return model;
    }
    let mut lift = 1e-3;
    loop {
        let model = augmented(hessian, gradient, active, 10.0, lift);
        if lift > 1e9 || model.matrix.is_positive_definite() {
            return model;
        }
        lift *= 5.0;
    }
}

/// The model with penalties of active rows, and curvature `lift` (1/m) added all over.
pub fn augmented(hessian: &Symmetric, gradient: &[f64], active: &[ActiveRow], penalty: f64, lift: f64) -> Quadratic {
    let mut matrix = hessian.clone();
    let mut linear = gradient.to_vec();
    for k in 0..matrix.size {
        matrix.add(k, k, lift);
    }
    if penalty > 0.0 {
        for row in active {
            for &(i, a) in &row.coefficients {
                linear[i] -= penalty * row.target * a;
                for &(j, b) in &row.coefficients {
                    matrix.add(i, j, penalty * a * b);
                }
            }
        }
    }
    Quadratic { matrix, linear }
}
