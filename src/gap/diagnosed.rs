//! A campaign of runs on chains of carts, diagnosed: once, and again with the runs fitted with what was found.

use super::chain::{Chains, Work};
use super::cost::Cost;
use super::diagnosis::{Diagnosis, Lost};
use super::scored::Explanation;
use super::settings::Settings;
use crate::identify::study::Subject;

/// What a diagnosis found, how it came to it, and what it cost.
pub struct Answer {
    pub found: Diagnosis,
    pub explained: Vec<Explanation>,
    pub cost: Cost,
}

/// Fits the nominal model to each run, and diagnoses; where that names a cause, fits with it and diagnoses again. `tell`
/// is told of each run that is fitted; `diagnose` is given the runs with the number of the round, 1 or 2. What is
/// returned is the answer that leaves less, with its runs, but no unknown one where the first named something.
///
/// # Errors
///
/// The run and why it cannot be used, or that the work was stopped. Once it is stopped while it diagnoses, nothing more
/// is simulated, and the answer is none: who stops it knows that.
pub fn diagnose_runs(
    subjects: &[Subject],
    settings: &Settings,
    work: Work,
    tell: &(dyn Fn(&str) + Sync),
    diagnose: &mut dyn FnMut(&Chains, usize) -> Answer,
) -> Result<(Chains, Answer), (String, String)> {
    let mut chains = Chains::new(subjects, settings, work, tell)?;
    let mut answer = diagnose(&chains, 1);
    if let Some(next) = chains.anew(subjects, &answer.found, settings, tell) {
        let again = diagnose(&next, 2);
        let as_sure = !again.found.named().is_empty() || answer.found.named().is_empty();
        let better = again.found.left() < answer.found.left() && as_sure;
        let cost = again.cost.clone();
        if better {
            (chains, answer) = (next, again);
        }
        answer.cost = cost;
    }
    answer.found.lost.extend(chains.lost().into_iter().map(Lost::data));
    Ok((chains, answer))
}
