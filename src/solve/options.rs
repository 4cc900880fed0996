//! How a layout is to be solved, and what a solve tells while it goes on.

use super::sqp::{Solution, SqpSettings};
use super::{Certificate, Stop, Violation};
use crate::model::Layout;
use crate::problem::Problem;

/// Which solver runs the continuous stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Solver {
    /// Sequential quadratic programming on Clarabel.
    #[default]
    Sqp,
    /// Box's complex method.
    Complex,
}

/// How a layout is solved.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub solver: Solver,
    /// Start from the written layout with noise of this size (m) and seed.
    pub perturb: Option<(f64, u64)>,
    /// Threads that may run; the result does not depend on it.
    pub threads: usize,
    /// When the search of stage 3 ends.
    pub effort: Effort,
    /// When all of it ends with the best so far.
    pub stop: Stop,
}

impl Default for Options {
    fn default() -> Self {
        Options { solver: Solver::Sqp, perturb: None, threads: 2, effort: Effort::default(), stop: Stop::NEVER }
    }
}

/// What a solve tells while it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// A step of a continuous method.
    Iteration {
        stage: &'static str,
        iteration: usize,
        /// m
        length: f64,
        /// m or rad
        max_violation: f64,
    },
    /// A node of the search on the catalogue's grid.
    Node {
        nodes: usize,
        /// The search ends after so many.
        most: usize,
        /// No layout that is still open is better than the best known by more than this; `None` while that is not known.
        gap: Option<f64>,
        /// Of the gap: m or EUR.
        unit: &'static str,
    },
}

/// Takes what a solve tells while it goes on; any thread may tell.
pub type Tell<'a> = &'a (dyn Fn(Progress) + Sync);

/// Takes a continuous optimum to the catalogue's grid. Stages do not know which method does.
pub type Discretise = fn(&Layout, &Problem, &Solution, &SqpSettings, &Effort, Tell) -> Discretised;

/// A layout on the grid, with what was proven of it.
#[derive(Clone, Debug)]
pub struct Discretised {
    pub solution: Solution,
    pub certificate: Option<Certificate>,
    /// Why the grid itself admits no layout.
    pub refused: Vec<Violation>,
    /// Whether it is proven that there is no layout on the grid.
    pub refuted: bool,
}

/// By less than this two layouts do not differ, m or EUR.
const BETTER: f64 = 1e-6;

impl Discretised {
    /// Whether a better layout may exist on the grid than was found, for all that was searched.
    pub fn is_open(&self) -> bool {
        self.refused.is_empty() && !self.refuted && self.certificate.as_ref().is_none_or(|c| !c.proven)
    }

    /// Whether it is a layout that meets every row within a tolerance, m.
    pub fn fits(&self, tolerance: f64) -> bool {
        self.solution.max_violation <= tolerance
    }

    /// The better of two, with what both prove; the first where the other is better by rounding alone.
    pub fn or(self, other: Discretised, tolerance: f64) -> Discretised {
        let worth = |d: &Discretised| match &d.certificate {
            Some(certificate) if d.fits(tolerance) => certificate.value,
            _ => f64::INFINITY,
        };
        let (mut best, less) = if worth(&other) < worth(&self) - BETTER { (other, self) } else { (self, other) };
        if let (Some(own), Some(less)) = (best.certificate.as_mut(), less.certificate) {
            own.and(less);
        }
        best
    }
}

impl From<Solution> for Discretised {
    /// A layout of which nothing was proven.
    fn from(solution: Solution) -> Self {
        Discretised { solution, certificate: None, refused: Vec::new(), refuted: false }
    }
}

impl Options {
    /// For one of several solves that prove something together.
    pub fn of_all(&self) -> Options {
        Options { effort: Effort { class: false, ..self.effort }, ..*self }
    }
}

/// A search of more vertices takes fewer nodes.
const FEW: usize = 24;

impl Effort {
    /// For a layout of so many vertices: a node takes so much longer with them that all of them together take no longer.
    pub fn of(&self, vertices: usize) -> Effort {
        let fewer = FEW as f64 / vertices.max(FEW) as f64;
        let cube = fewer * fewer * fewer;
        Effort { nodes: ((self.nodes as f64 * cube * cube) as usize).max(1), ..*self }
    }
}

/// When a search ends, and what it may prove.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Relative gap that is good enough; 0 for the optimum.
    pub gap: f64,
    /// Most nodes for layouts of up to [`FEW`] vertices.
    pub nodes: usize,
    /// Whether a bound of the loops that can be moved from the built one is enough. Several solves that prove something
    /// together may build loops of several classes, so they need bounds of all.
    pub class: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Effort { gap: 0.0, nodes: 6_000, class: true }
    }
}
