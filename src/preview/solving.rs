//! Solving for a picture that has to be there at once, and for the whole of a layout.

use crate::compiled::{Compiled, solved};
use crate::diagnostic::Diagnostic;
use crate::model::{Goal, Layout, Objective};
use crate::solve::{self, Discretise, Options, Stage, Stop, unsupported};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long a picture while somebody drags may take.
const QUICK: Duration = Duration::from_millis(600);

/// The continuous stages of a layout, which take milliseconds: what it comes to before it is put on the catalogue's
/// grid. Where something else than length or cost is optimised, by length. `None` where there are no such stages.
pub fn quick(layout: &Layout, threads: usize) -> Option<Compiled> {
    if layout.vertices.is_empty() || !unsupported(layout).is_empty() {
        return None;
    }
    let mut layout = layout.clone();
    let other = |(_, goal): &(f64, Goal)| *goal == Goal::PolygonAction;
    if layout.objective.within.is_some() || layout.objective.terms.iter().any(other) {
        layout.objective = Objective { terms: vec![(1.0, Goal::Length)], within: None, ..layout.objective };
    }
    let nothing: Discretise = |_, _, solution, _, _, _| solution.clone().into();
    let options = Options { threads, stop: Stop::after(QUICK), ..Options::default() };
    let mut stages: Vec<Stage> = solve::solve_with(&layout, &options, nothing, &|_| ());
    // The last one is off the grid, as nothing put it there.
    stages.retain(|stage| stage.name != "stage3");
    Some(Compiled::new(layout, stages))
}

/// A layout as a build solves it, within a time, and what a build says of it. `None` where `ended` came first.
pub fn whole(
    layout: &Layout,
    threads: usize,
    limit: Duration,
    ended: &'static AtomicBool,
) -> Option<(Result<Compiled, String>, Vec<Diagnostic>)> {
    let stop = Stop::after_or(limit, ended);
    let (result, said) = solved(layout, &Options { threads, stop, ..Options::default() });
    if stop.cut().is_some() && ended.load(Ordering::Relaxed) {
        return None;
    }
    Some((result, said))
}

/// A layout whose text changed but not what it says, with the stages that are known.
pub fn again(layout: &Layout, stages: Vec<Stage>) -> (Result<Compiled, String>, Vec<Diagnostic>) {
    let compiled = Compiled::new(layout.clone(), stages);
    let mut said = Vec::new();
    compiled.tell(&mut said);
    (Ok(compiled), said)
}
