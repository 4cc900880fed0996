//! Solves a layout's optimisation problem in the thesis' three stages (§3.3).

mod complex;
mod conflict;
mod convex;
mod discrete;
mod freedom;
mod outcome;
mod perturb;
pub mod polygon;
mod report;
pub mod sqp;
mod stages;
mod subproblem;

pub use conflict::implied;
pub use discrete::discretise;
pub use freedom::{ActiveRow, Freedom, Hold, VertexFreedom, freedom};
pub use outcome::{Stage, Status, Violation};
pub use perturb::perturbed;
pub use report::diagnose;
pub use stages::{Discretise, Options, Progress, Solver, solve, solve_with};
