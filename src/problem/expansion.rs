//! The value of a row with its derivatives by the problem's variables.

use super::jet::Jet;

/// A second-order expansion in a few of the problem's variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    pub value: f64,
    /// Indices of the variables it depends on, ascending.
    pub variables: Vec<usize>,
    /// By `variables`.
    pub gradient: Vec<f64>,
    /// Row-major, by `variables` twice; symmetric.
    pub hessian: Vec<f64>,
}

impl Expansion {
    pub fn constant(value: f64) -> Self {
        Expansion { value, variables: Vec::new(), gradient: Vec::new(), hessian: Vec::new() }
    }

    pub fn variable(value: f64, index: usize) -> Self {
        Expansion { value, variables: vec![index], gradient: vec![1.0], hessian: vec![0.0] }
    }

    /// Σ k·x + constant, given as (index, k, value of x).
    pub fn linear(constant: f64, terms: &[(usize, f64, f64)]) -> Self {
        let mut sum = Expansion::constant(constant);
        for &(index, k, value) in terms {
            sum = sum.add(&Expansion::variable(value, index).scale(k));
        }
        sum
    }

    /// A jet whose local variable `i` is the problem's `variables[i]`; repetitions are merged.
    pub fn from_jet<const N: usize>(jet: &Jet<N>, variables: &[usize; N]) -> Self {
        let mut sorted = variables.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        let k = sorted.len();
        let place: [usize; N] = std::array::from_fn(|i| sorted.partition_point(|&v| v < variables[i]));
        let mut gradient = vec![0.0; k];
        let mut hessian = vec![0.0; k * k];
        for i in 0..N {
            gradient[place[i]] += jet.gradient[i];
            for j in 0..N {
                hessian[place[i] * k + place[j]] += jet.hessian[i][j];
            }
        }
        Expansion { value: jet.value, variables: sorted, gradient, hessian }
    }

    /// The same expansion over a superset of its variables.
    fn widen(&self, variables: &[usize]) -> Self {
        if self.variables == variables {
            return self.clone();
        }
        let k = variables.len();
        let place: Vec<usize> = self.variables.iter().map(|v| variables.partition_point(|w| w < v)).collect();
        let mut out = Expansion {
            value: self.value,
            variables: variables.to_vec(),
            gradient: vec![0.0; k],
            hessian: vec![0.0; k * k],
        };
        for (i, &p) in place.iter().enumerate() {
            out.gradient[p] = self.gradient[i];
            for (j, &q) in place.iter().enumerate() {
                out.hessian[p * k + q] = self.hessian[i * place.len() + j];
            }
        }
        out
    }

    fn align(&self, other: &Self) -> (Self, Self) {
        let mut all: Vec<usize> = self.variables.iter().chain(&other.variables).copied().collect();
        all.sort_unstable();
        all.dedup();
        (self.widen(&all), other.widen(&all))
    }

    pub fn add(&self, other: &Self) -> Self {
        let (mut a, b) = self.align(other);
        a.value += b.value;
        a.gradient.iter_mut().zip(&b.gradient).for_each(|(x, y)| *x += y);
        a.hessian.iter_mut().zip(&b.hessian).for_each(|(x, y)| *x += y);
        a
    }

    pub fn sub(&self, other: &Self) -> Self {
        self.add(&other.scale(-1.0))
    }

    pub fn scale(&self, k: f64) -> Self {
        self.chain(self.value * k, k, 0.0)
    }

    pub fn shift(mut self, by: f64) -> Self {
        self.value += by;
        self
    }

    pub fn mul(&self, other: &Self) -> Self {
        let (a, b) = self.align(other);
        let k = a.variables.len();
        let mut out = a.clone();
        out.value = a.value * b.value;
        for i in 0..k {
            out.gradient[i] = a.value * b.gradient[i] + b.value * a.gradient[i];
            for j in 0..k {
                out.hessian[i * k + j] = a.value * b.hessian[i * k + j]
                    + b.value * a.hessian[i * k + j]
                    + a.gradient[i] * b.gradient[j]
                    + a.gradient[j] * b.gradient[i];
            }
        }
        out
    }

    /// The square root, its slope kept finite at 0.
    pub fn square_root(&self) -> Self {
        let root = self.value.max(0.0).sqrt();
        let safe = root.max(1e-12);
        self.chain(root, 0.5 / safe, -0.25 / (safe * safe * safe))
    }

    /// f(self) from f and its first two derivatives at `self.value`.
    pub fn chain(&self, f: f64, f1: f64, f2: f64) -> Self {
        let k = self.variables.len();
        let mut out = self.clone();
        out.value = f;
        for i in 0..k {
            out.gradient[i] = f1 * self.gradient[i];
            for j in 0..k {
                out.hessian[i * k + j] = f1 * self.hessian[i * k + j] + f2 * self.gradient[i] * self.gradient[j];
            }
        }
        out
    }
}
