//! A large Hessian made convex term by term.
//!
//! The Lagrangian of a loop is a sum of terms of a few neighbouring variables each (a partially separable function,
//! Griewank and Toint 1982). Where the sum is not convex, the convex part of each term is: that costs as much as there
//! are terms, changes nothing at other places of the loop, and leaves directions in which nothing bends without
//! curvature, which one lift of the whole matrix would not.

use super::convex::{ActiveRow, FLAT, Quadratic, Symmetric, augmented};
use crate::problem::Expansion;
use nalgebra::{DMatrix, SymmetricEigen};
use std::collections::BTreeMap;

/// Penalties of active rows with which the whole is looked at first.
const PENALTIES: [f64; 3] = [0.0, 10.0, 100.0];

/// What terms are put together by: those of one section's end, or of the same variables.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Group<'a> {
    Section(usize),
    Variables(&'a [usize]),
}

/// A symmetric matrix of a few variables.
pub struct Element {
    /// Ascending.
    variables: Vec<usize>,
    /// By `variables` twice.
    matrix: DMatrix<f64>,
}

/// Elements of a sum of weighted terms; those of one section go together, and those of the same variables. `place` has
/// the index of each of the problem's variables among the free ones.
pub fn elements<'a>(
    terms: impl Iterator<Item = (&'a Expansion, f64, Option<usize>)>,
    place: &[Option<usize>],
) -> Vec<Element> {
    let mut groups: BTreeMap<Group, Vec<(&Expansion, f64)>> = BTreeMap::new();
    for (expansion, weight, section) in terms {
        let group = section.map_or(Group::Variables(&expansion.variables), Group::Section);
        groups.entry(group).or_default().push((expansion, weight));
    }
    groups.into_values().filter_map(|terms| element(&terms, place)).collect()
}

/// `None` where nothing bends.
fn element(terms: &[(&Expansion, f64)], place: &[Option<usize>]) -> Option<Element> {
    // Only what bends.
    let bends = |e: &Expansion, i: usize| {
        let k = e.variables.len();
        e.hessian[i * k..(i + 1) * k].iter().any(|h| *h != 0.0)
    };
    let of = |e: &Expansion| -> Vec<Option<usize>> {
        (0..e.variables.len()).map(|i| place[e.variables[i]].filter(|_| bends(e, i))).collect()
    };
    let mut variables: Vec<usize> = terms.iter().flat_map(|(e, _)| of(e)).flatten().collect();
    variables.sort_unstable();
    variables.dedup();
    let mut matrix = DMatrix::zeros(variables.len(), variables.len());
    for (expansion, weight) in terms {
        let k = expansion.variables.len();
        let here: Vec<Option<usize>> =
            of(expansion).into_iter().map(|v| v.and_then(|v| variables.binary_search(&v).ok())).collect();
        for (i, p) in here.iter().enumerate() {
            for (j, q) in here.iter().enumerate() {
                if let (Some(p), Some(q)) = (p, q) {
                    matrix[(*p, *q)] += weight * expansion.hessian[i * k + j];
                }
            }
        }
    }
    (!variables.is_empty()).then_some(Element { variables, matrix })
}

impl Element {
    /// Adds the part of it that curves upwards.
    fn add_convex(&self, sum: &mut Symmetric) {
        let eigen = SymmetricEigen::new(self.matrix.clone());
        for (k, curvature) in eigen.eigenvalues.iter().enumerate().filter(|(_, c)| **c > 0.0) {
            let along = eigen.eigenvectors.column(k);
            for (i, &v) in self.variables.iter().enumerate() {
                for (j, &w) in self.variables.iter().enumerate().skip(i) {
                    sum.add(v, w, curvature * along[i] * along[j]);
                }
            }
        }
    }
}

/// The model with Hessian `hessian`, the sum of `elements`, and gradient `gradient`, made strictly convex.
pub fn convexify(hessian: &Symmetric, elements: &[Element], gradient: &[f64], active: &[ActiveRow]) -> Quadratic {
    for penalty in PENALTIES {
        let model = augmented(hessian, gradient, active, penalty, 1e-8);
        if model.matrix.is_positive_definite() {
            return model;
        }
    }
    let mut convex = Symmetric::new(hessian.size);
    elements.iter().for_each(|element| element.add_convex(&mut convex));
    augmented(&convex, gradient, active, 0.0, FLAT)
}
