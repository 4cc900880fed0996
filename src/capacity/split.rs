//! In which proportions the inductions together get most items onto a sorter.
//!
//! Each stretch, induction and chute limits a weighted sum of what the inductions put on carriers an hour, so the most is that
//! of a linear program. Inductions that always have items find other proportions by themselves: each fills what the ones
//! before it leave free. None of them gets more on than the program does.

use super::flow::{Flow, Most};
use crate::base::linear_program::{Row, maximise};

/// What goes round because of failures depends on the throughput, and this on what goes round: so often it is worked out anew.
const ROUNDS: usize = 20;
/// Until it changes by no more, relatively.
const SAME: f64 = 1e-9;

/// The most of all proportions; `None` where no items can come.
pub(super) fn most(flow: &Flow) -> Option<Most> {
    let mut best: Option<Most> = None;
    let mut round = 0.0;
    for _ in 0..ROUNDS {
        let most = flow.most(&proportions(flow, round)?)?;
        let change = (most.round - round).abs();
        round = most.round;
        if best.as_ref().is_none_or(|best| most.throughput > best.throughput) {
            best = Some(most);
        }
        if change <= SAME * round {
            break;
        }
    }
    best
}

/// What each induction puts on carriers, as shares of those that pass, while each item uses `round` carriers more.
fn proportions(flow: &Flow, round: f64) -> Option<Vec<f64>> {
    let sorter = flow.sorter;
    let count = sorter.inductions.len();
    let passing = sorter.carriers_per_hour();
    let mut rows: Vec<Row> = Vec::new();
    for at in 0..count {
        let coefficients = (0..count).map(|from| (from, flow.used[from][at] + round)).collect();
        rows.push(Row { coefficients, most: flow.carriers() / passing });
    }
    for (i, induction) in sorter.inductions.iter().enumerate() {
        // No more than a carrier that passes, whatever the stretches say.
        let most = sorter.most_of(induction).min(passing) / passing;
        rows.push(Row { coefficients: vec![(i, 1.0)], most });
    }
    // What a chute does not take waits on carriers, if a wave that empties it comes.
    let mut variables = count;
    let mut waits = Vec::new();
    for (c, chute) in sorter.chutes.iter().enumerate() {
        let Some(hourly) = sorter.most_into(chute) else { continue };
        let mut coefficients: Vec<(usize, f64)> = (0..count).map(|i| (i, flow.to[i][c])).collect();
        if sorter.waves.is_some() {
            coefficients.push((variables, -1.0));
            waits.push((variables, 1.0));
            variables += 1;
        }
        rows.push(Row { coefficients, most: hourly / passing });
    }
    if !waits.is_empty() {
        rows.push(Row { coefficients: waits, most: flow.waiting() / passing });
    }
    let mut objective = vec![0.0; variables];
    objective[..count].fill(1.0);
    let mut found = maximise(&objective, &rows)?;
    found.truncate(count);
    Some(found)
}
