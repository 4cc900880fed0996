//! Scanners that fail: while some are down, a sorter is one with those that work.

use super::flow::{Flow, Most};
use super::sorter::{Scanner, Sorter};

/// States that are thought of at most, the likeliest: with n scanners there are 2ⁿ, each of which costs a closed form.
const MOST: usize = 64;

/// A sorter while some of its scanners are down.
pub(super) struct State {
    /// Share of time.
    share: f64,
    /// With the scanners that work; with all where none does.
    sorter: Sorter,
    /// Whether any works, if there are any.
    reads: bool,
}

/// Its states, the one in which all scanners work first. Each scanner works for its availability, whatever the others do.
pub(super) fn states(sorter: &Sorter) -> Vec<State> {
    let mut states = vec![(1.0, Vec::<Scanner>::new())];
    for scanner in &sorter.scanners {
        let mut down = Vec::new();
        if let Some(fails) = &scanner.fails {
            let available = fails.available();
            down = states.iter().map(|(share, working)| (share * (1.0 - available), working.clone())).collect();
            states.iter_mut().for_each(|(share, _)| *share *= available);
        }
        states.iter_mut().for_each(|(_, working)| working.push(scanner.clone()));
        states.append(&mut down);
        states[1..].sort_by(|a, b| b.0.total_cmp(&a.0));
        states.truncate(MOST);
    }
    let all: f64 = states.iter().map(|(share, _)| share).sum();
    let state = |(share, scanners): (f64, Vec<Scanner>)| {
        let reads = !scanners.is_empty() || sorter.scanners.is_empty();
        let scanners = if reads { scanners } else { sorter.scanners.clone() };
        State { share: share / all, sorter: Sorter { scanners, ..sorter.clone() }, reads }
    };
    states.into_iter().map(state).collect()
}

/// What goes over a sorter with these shares of the chutes, in the mean over its states; the rest is that of the first.
/// Where no scanner works, items leave after the laps that are allowed, or none does. `None` as in [`Flow::new`].
pub(super) fn mean(states: &[State], shares: &[f64], most: impl Fn(&Flow) -> Option<Most>) -> Option<Most> {
    let mut found: Option<Most> = None;
    for State { share, sorter, reads } in states {
        if !reads && sorter.items.most_laps == usize::MAX {
            continue;
        }
        let own = most(&Flow::new(sorter, shares, *reads)?)?;
        match &mut found {
            None => found = Some(Most { throughput: share * own.throughput, ..own }),
            Some(mean) => mean.throughput += share * own.throughput,
        }
    }
    found
}
