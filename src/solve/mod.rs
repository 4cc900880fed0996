//! Solves a layout's optimisation problem in the thesis' three stages (§3.3).

mod active_set;
mod certificate;
mod complex;
mod conflict;
mod convex;
mod discrete;
mod exact;
mod freedom;
mod goals;
mod left_over;
mod multipliers;
mod null_space;
mod options;
mod outcome;
mod pareto;
pub mod polygon;
mod report;
pub mod sqp;
mod stages;
mod stop;
mod subproblem;
mod unsupported;
mod violations;

pub use certificate::{Certificate, Counted, Part};
pub use conflict::{Assumed, Conflict, Decides, LineKind, Member, Proof, Relaxed, Within, implied};
pub use exact::{discretise, worth};
pub use freedom::{ActiveRow, Freedom, Hold, VertexFreedom, freedom};
pub use goals::{solve, solve_with};
pub use left_over::left_over;
pub use options::{Discretise, Discretised, Effort, Options, Progress, Solver};
pub use outcome::{Stage, Status, Violation};
pub use pareto::{Trade, objective, pareto};
pub use report::{conflicts, diagnose, unclosed};
pub use stages::MOST_OPEN;
pub use stop::{Cut, Stop};
pub use unsupported::unsupported;
