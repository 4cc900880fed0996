//! Studies: many tasks that differ in their parameters, planned, done wherever there is room, and collected.
//!
//! 1. `file` reads a `study.toml`, `axis` multiplies the values of its parameters, and [`plan`] makes tasks of them, each
//!    with a hash of all that its result depends on,
//! 2. [`place`] is the folder of results: what is done, what failed, what somebody is at,
//! 3. [`run`] does tasks here, by [`process`],
//! 4. [`slurm`] has a cluster do them,
//! 5. [`table`] merges what was found, of which [`values`] tells the numbers.
//!
//! A step of a task is a verb of the command line, and it runs as a process of its own: this program, started anew. So
//! a step that crashes or takes all the memory ends its own task and no other, what it writes is what a user gets who
//! types the same line, and a stopped identification or diagnosis goes on where it was, as it does there. Starting a
//! process takes some milliseconds, a task seconds to hours.
//!
//! Nothing but the folder of results says how far a study is. A task's result takes its place last and whole; before it
//! is there the task is open, and whoever comes by does it, whether this process, another one, or another host. Results
//! hold no times, so that the same tasks give the same table, whatever order they were done in.

mod axis;
mod content;
mod file;
pub mod place;
pub mod plan;
pub mod process;
pub mod run;
mod schema;
pub mod slurm;
pub mod table;
#[cfg(test)]
mod tests;
pub mod values;
mod verb;

pub use file::{StudyFile, Sweep, read};
pub use place::{Place, State};
pub use plan::{Plan, Task};
pub use schema::schema;
pub use verb::Verb;

/// Tasks of a study at most.
pub const MOST_TASKS: usize = 100_000;

/// Of what a task's hash is made and of what a result holds: raised where either changes.
pub const FORMAT: u32 = 1;
