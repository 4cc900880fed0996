//! The stages' problems as files that other solvers read.

use crate::compiled::Compiled;
use crate::problem::measures::to_variables;
use crate::problem::{Problem, Scope, mps, nl};
use crate::solve::Stage;

/// `stage1.nl` and `stage2.nl` with their names. Each begins where the stage did: as written, and at stage 1's result.
/// Its clearance rows are those at the stage's own result, or at the last one there is.
pub fn nl_files(compiled: &Compiled) -> Vec<(String, Vec<u8>)> {
    let corners = |stage: &Stage| to_variables(&stage.corners);
    let written = to_variables(&compiled.layout.corners());
    let result = |name: &str| compiled.stages.iter().find(|s| s.name == name).map(corners);
    let first = result("stage1").unwrap_or_else(|| written.clone());
    let second = result("stage2").unwrap_or_else(|| first.clone());
    [("stage1", Scope::Building, &written, &first), ("stage2", Scope::Obstacles, &first, &second)]
        .into_iter()
        .flat_map(|(name, scope, start, at)| {
            let nl = nl::write(&Problem::new(&compiled.layout, scope), start, at);
            [("nl", nl.model), ("row", nl.rows), ("col", nl.columns)]
                .map(|(kind, text)| (format!("{name}.{kind}"), text.into_bytes()))
        })
        .collect()
}

/// `stage3.mps`. The result, where it is feasible, says how long a section may be.
pub fn mps_files(compiled: &Compiled) -> Vec<(String, Vec<u8>)> {
    let problem = Problem::new(&compiled.layout, Scope::Building);
    let written = problem.evaluate(&problem.start, 0.0).length;
    let longest = match compiled.stages.last() {
        Some(stage) if !compiled.failed() => stage.length,
        // Nothing feasible is known: twice what was written is room for whatever a relaxed line needs.
        _ => 2.0 * written,
    };
    vec![("stage3.mps".to_owned(), mps::write(&compiled.layout, &problem, longest).into_bytes())]
}
