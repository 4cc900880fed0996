//! Rounds: in which order, and which way along each, a loop may pass the sections.

use crate::model::{Route, TrackSection};

/// Sections in driving order, each the way it is driven.
#[derive(Clone, Debug)]
pub struct Round {
    pub sections: Vec<TrackSection>,
}

/// How many rounds a route has; the first section stands first in all of them.
pub fn count(route: &Route) -> f64 {
    let n = route.sections.len();
    let orders: f64 = if route.any_order { (1..n).map(|k| k as f64).product() } else { 1.0 };
    orders * route.sections.iter().map(|s| if s.either_way { 2.0 } else { 1.0 }).product::<f64>()
}

/// All rounds of a route.
pub fn rounds(route: &Route) -> Vec<Round> {
    let n = route.sections.len();
    let mut orders: Vec<Vec<usize>> = vec![vec![0]];
    for _ in 1..n {
        orders = orders
            .iter()
            .flat_map(|order| {
                let next: Vec<usize> = match route.any_order {
                    true => (1..n).filter(|k| !order.contains(k)).collect(),
                    false => vec![order.len()],
                };
                next.into_iter().map(|k| [&order[..], &[k]].concat()).collect::<Vec<_>>()
            })
            .collect();
    }
    let open: Vec<usize> = (0..n).filter(|&k| route.sections[k].either_way).collect();
    let driven = |k: usize, ways: usize| {
        let section = &route.sections[k];
        let back = open.iter().position(|&o| o == k).is_some_and(|bit| ways >> bit & 1 == 1);
        TrackSection { either_way: false, ..if back { section.reversed() } else { section.clone() } }
    };
    orders
        .iter()
        .flat_map(|order| {
            (0..1usize << open.len())
                .map(|ways| Round { sections: order.iter().map(|&k| driven(k, ways)).collect() })
                .collect::<Vec<_>>()
        })
        .collect()
}
