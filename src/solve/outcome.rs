//! What a solve returns: plain data, best layout first, and what is wrong with it if anything is.

use super::{Certificate, Cut};
use crate::geometry::Corner;
use crate::source::Span;
use schemars::JsonSchema;
use serde::Serialize;

/// How a stage ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// A local optimum, feasible to 1e-6: nothing near it is better.
    Local,
    /// The best that a search over the catalogue's grid came by; something better may be left.
    BestFound,
    /// Nothing on the catalogue's grid is better, as its certificate has it.
    Proven,
    /// Feasible, but a limit of iterations or of time came first.
    Feasible,
    /// No feasible layout found; the corners are the least infeasible ones.
    Infeasible,
    /// Nothing was optimised.
    AsWritten,
}

impl Status {
    /// For people; `cut` where a limit of time ended the solve.
    pub fn words(self, cut: bool) -> &'static str {
        match self {
            Status::Local => "local optimum",
            Status::BestFound => "best found",
            Status::Proven => "proven",
            Status::Feasible if cut => "feasible, not optimal",
            Status::Feasible => "feasible, but out of iterations before it was a local optimum",
            Status::Infeasible => "NOT FEASIBLE",
            Status::AsWritten => "as written",
        }
    }
}

/// A row that the layout does not meet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// As the problem prints it: `clearance of column_a to the straight P4..P5`.
    pub row: String,
    pub span: Span,
    /// How far, in the row's unit.
    pub amount: f64,
    /// `m`, `rad` or `m^2`; empty for a number without unit, and for another dimension in SI units.
    pub unit: &'static str,
}

/// The result of one stage.
#[derive(Clone, Debug, Serialize)]
pub struct Stage {
    /// `stage1`, `stage2`, `stage3`; `written` for `optimise nothing`.
    pub name: &'static str,
    pub corners: Vec<Corner>,
    /// m
    pub length: f64,
    /// Largest violation, m (angles as rad).
    pub max_violation: f64,
    pub violations: Vec<Violation>,
    pub iterations: usize,
    /// From how many starts the stage's optimum was looked for, where from more than one.
    #[serde(skip_serializing_if = "crate::base::number::is_one")]
    pub starts: usize,
    /// Wall time; never in an output file.
    #[serde(skip)]
    pub seconds: f64,
    pub status: Status,
    /// What ended the solve before it was done, of its last stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut: Option<Cut>,
    /// What a search over the catalogue's grid proved; never in an output file, as seconds are.
    #[serde(skip)]
    pub certificate: Option<Certificate>,
    /// Whether the search over the catalogue's grid proved that there is no layout on it.
    #[serde(skip)]
    pub refuted: bool,
}
