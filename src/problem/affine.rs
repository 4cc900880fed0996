//! Sums of variables, to which rows of both file formats are reduced where they are linear.

use std::collections::BTreeMap;

/// Σ k·variable + constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    /// By the variable's index.
    pub terms: BTreeMap<usize, f64>,
    pub constant: f64,
}

impl Affine {
    /// This and so many times the other.
    pub fn plus(mut self, k: f64, other: &Affine) -> Self {
        self.constant += k * other.constant;
        for (&variable, &coefficient) in &other.terms {
            *self.terms.entry(variable).or_insert(0.0) += k * coefficient;
        }
        self
    }
}
